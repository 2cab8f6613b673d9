"""Calls that are too large or too long: an exception of Python's own, and soon."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

import upglow

SOON_S = 20.0
"""Far more than a batch of colors or nodes takes, far less than the whole calls."""


@contextmanager
def ctrl_c_after(seconds: float) -> Iterator[None]:
    """Sends SIGINT to the main thread, also where the tests were started with the signal ignored."""
    main = threading.main_thread().ident
    timer = threading.Timer(seconds, lambda: signal.pthread_kill(main, signal.SIGINT))
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        timer.start()
        yield
    finally:
        timer.cancel()
        timer.join()
        signal.signal(signal.SIGINT, before)


def minutes(cube: upglow.Cube) -> dict[str, Callable[[], Any]]:
    """Calls that take minutes."""
    rgb = np.broadcast_to(np.random.default_rng(1).random((1000, 3)), (4000, 1000, 3))
    return {
        "build": lambda: upglow.build(resolution=128),
        "verify": lambda: cube.verify(points=10**9),
        "material": lambda: cube.material(np.random.default_rng(1).random((10**7, 3))),
        "fit": lambda: cube.fit(rgb),
        "albedo": lambda: cube.albedo(rgb, [400.0, 450.0, 500.0, 550.0, 600.0]),
        "sample_incident": lambda: cube.sample_incident(rgb, 560.0, [0.5, 0.5]),
        "standing": lambda: upglow.standing(np.random.default_rng(1).random((10**7, 3)) * 1.2),
    }


@pytest.mark.parametrize(
    "call", ["build", "verify", "material", "fit", "albedo", "sample_incident", "standing"]
)
def test_ctrl_c_stops_every_long_call(cube: upglow.Cube, call: str) -> None:
    work = minutes(cube)[call]
    start = time.monotonic()
    with ctrl_c_after(0.5), pytest.raises(KeyboardInterrupt):
        work()
    assert time.monotonic() - start < SOON_S


TOO_LARGE = """
import resource
import numpy as np
import upglow

cube = upglow.build(resolution=2, threads=1)
rgb = np.full((200_000, 3), 0.5)
limit = 4 << 30
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
for name, call in {
    "reradiation_matrix": lambda: cube.reradiation_matrix(rgb, threads=1),
    "reflectance": lambda: cube.reflectance(rgb[:, None], np.linspace(400, 700, 5000), threads=1),
    "reduced_matrix": lambda: cube.reduced_matrix(np.full((80_000_000, 3), 0.5, "f4"), threads=1),
}.items():
    try:
        call()
    except MemoryError as error:
        print(name, "MemoryError", str(error)[:60])
"""


@pytest.mark.skipif(sys.platform != "linux", reason="no limit of memory for a process")
def test_what_does_not_fit_in_memory_is_a_memory_error() -> None:
    done = subprocess.run(
        [sys.executable, "-c", TOO_LARGE], capture_output=True, text=True, check=False
    )
    names = [line.split()[0] for line in done.stdout.splitlines()]
    expected = ["reradiation_matrix", "reflectance", "reduced_matrix"]
    assert names == expected, done.stderr
