"""Tasks of a plan on two workers of Dask write what one run of the program writes."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from upglow import farm

COUNT = 200


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
        yield client


@pytest.fixture
def desk(program: str, tmp_path: Path) -> Path:
    """A cube, small pictures of which no two are the same, the files of one run, and a plan."""
    image = pytest.importorskip("PIL.Image")
    (tmp_path / "in").mkdir()
    for i in range(COUNT):
        picture(image, tmp_path, i, i)
    run(program, tmp_path, "build", "--preset", "konig2020", "--resolution", "4", "-o", "cube")
    run(program, tmp_path, "bake", "cube", "in", *READ, "-o", "one")
    run(program, tmp_path, "bake", "cube", "in", *READ, "-o", "out", "--plan", "plan.json")
    return tmp_path


READ = ["--space", "srgb", "--encoding", "srgb"]


def picture(image: Any, folder: Path, number: int, red: int) -> None:
    image.new("RGB", (5, 4), (red, 40, 90)).save(folder / "in" / f"{number:04}.png")


def run(program: str, folder: Path, *words: str) -> None:
    subprocess.run([program, "--quiet", *words], cwd=folder, check=True, capture_output=True)


def content(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.glob("[!.]*")}


def test_two_workers_write_what_one_run_writes(program: str, client: Any, desk: Path) -> None:
    plan = desk / "plan.json"
    assert farm.bake(client, plan, together=20, program=program) == (COUNT, 0, {})
    assert content(desk / "out") == content(desk / "one")
    assert farm.bake(client, plan, program=program) == (0, COUNT, {})

    picture(pytest.importorskip("PIL.Image"), desk, 7, 250)
    told = farm.bake(client, plan, threads=1, program=program)
    assert (told.done, told.unchanged) == (0, COUNT - 1)
    assert [*told.failed] == ["in/0007.png"]
    assert "changed since the plan" in told.failed["in/0007.png"]
    run(program, desk, "bake", "cube", "in", *READ, "-o", "out", "--plan", "plan.json")
    assert farm.bake(client, plan, program=program) == (1, COUNT - 1, {})


@pytest.mark.skipif(os.name != "posix", reason="needs the signal 9")
def test_the_work_of_a_killed_worker_is_done(program: str, client: Any, desk: Path) -> None:
    def kill() -> None:
        while len(content(desk / "out")) < COUNT // 8:
            time.sleep(0.001)
        os.kill(workers[0], signal.SIGKILL)

    workers = [*client.run(os.getpid).values()]
    killer = threading.Thread(target=kill, daemon=True)
    killer.start()
    told = farm.bake(client, desk / "plan.json", together=20, threads=1, program=program)
    killer.join()
    assert told.failed == {} and told.done + told.unchanged == COUNT
    assert content(desk / "out") == content(desk / "one")
    assert workers[0] not in client.run(os.getpid).values()


def test_what_is_not_a_plan_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    for text in ["", "{}", '{"count":"x","tasks":[\n]}', "\x00"]:
        path.write_text(text)
        with pytest.raises(ValueError, match="expected a plan made by"):
            farm.bake(None, path)
    with pytest.raises(ValueError, match="together is 0, expected 1 or more"):
        farm.bake(None, path, together=0)
