"""Threads in processes that were forked."""

from __future__ import annotations

import multiprocessing
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import upglow

NM = np.arange(380.0, 781.0, 10.0)


def questions(cube: upglow.Cube) -> dict[str, Callable[[], Any]]:
    """Calls that work on threads, with enough colors for several of them."""
    rgb = np.random.default_rng(1).random((40_000, 3))
    matrix = upglow.DonaldsonMatrix(NM, NM, 0.5 * np.eye(41), unit="per band")
    return {
        "xyz": lambda: cube.xyz(rgb),
        "two threads": lambda: cube.xyz(rgb, threads=2),
        "check": lambda: cube.check(rgb).de2000,
        "relight": lambda: cube.relight(rgb[:2000], ["A"]).xyz,
        "reflectance": lambda: cube.reflectance(rgb, [500.0, 600.0]),
        "sample_incident": lambda: cube.sample_incident(rgb, 500.0, [0.5, 0.5]).nm,
        "material": lambda: cube.material(rgb[:3000]).reflectance,
        "fit": lambda: cube.fit(rgb[:20]).reflectance,
        "build": lambda: upglow.build(resolution=3).nodes.reflectance,
        "verify": lambda: np.array([check.value for check in cube.verify(points=500).checks]),
        "standing": lambda: upglow.standing(rgb).distance,
        "fit_matrix": lambda: upglow.fit_matrix(matrix, dyes="konig8").matrix.per_band,
        "node_colors": lambda: upglow.figures.node_colors(cube).xyz,
        "layer": lambda: upglow.figures.layer(cube, 0.5, side=64).rgb,
        "color_solid": lambda: upglow.figures.color_solid(steps=16).xyz,
    }


def forked(work: Callable[[], Any]) -> int | None:
    """The exit code of a forked process that does the work; None if it hangs."""
    process = multiprocessing.get_context("fork").Process(target=work)
    with warnings.catch_warnings():
        # Later versions of Python say what this test is about: the parent has threads.
        warnings.simplefilter("ignore", DeprecationWarning)
        process.start()
    process.join(60.0)
    if process.is_alive():
        process.kill()
        process.join()
        return None
    return process.exitcode


@pytest.mark.skipif(
    "fork" not in multiprocessing.get_all_start_methods(), reason="no fork on this platform"
)
@pytest.mark.parametrize("generations", [1, 2])
def test_after_a_fork_everything_works_as_before(cube: upglow.Cube, generations: int) -> None:
    asked = questions(cube)
    expected = {name: ask() for name, ask in asked.items()}

    def ask_again(generation: int = generations) -> None:
        for name, ask in asked.items():
            assert np.array_equal(ask(), expected[name], equal_nan=True), name
        if generation > 1:
            assert forked(lambda: ask_again(generation - 1)) == 0

    assert forked(ask_again) == 0
