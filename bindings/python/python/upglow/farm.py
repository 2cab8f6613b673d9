"""Bakes the tasks of a plan on the workers of a Dask client.

The program ``upglow`` makes the plan and does the tasks. It must be installed on the workers, which must reach
the plan and its files under the same names. After
``upglow bake acescg.safetensors textures -o baked --plan plan.json``::

    from distributed import Client
    from upglow import farm

    farm.bake(Client("scheduler:8786"), "plan.json")

A task that is done already stays as it is, so a job is run again by the same call, and Dask may give the work of a
worker that died to another.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any, NamedTuple

__all__ = ["Baked", "bake"]

TOGETHER = 50
"""Tasks that a worker does at a time: with fewer, starting the program takes longer than baking small pictures."""


class Baked(NamedTuple):
    """What became of the tasks of a plan."""

    done: int
    """Files that were written."""
    unchanged: int
    """Files that an earlier run wrote."""
    failed: dict[str, str]
    """Pictures that could not be baked, and why."""


def bake(
    client: Any,
    plan: str | os.PathLike[str],
    *,
    together: int = TOGETHER,
    threads: int | None = None,
    program: str = "upglow",
) -> Baked:
    """Does all tasks of a plan on the workers of a ``distributed.Client``, and waits for them.

    A worker runs ``program`` for ``together`` tasks at a time, with ``threads`` threads, by default one per core.

    Raises ``ValueError`` if the file is not a plan, and ``RuntimeError`` with the program's own message if it refuses
    the plan as a whole.
    """
    if together < 1:
        raise ValueError(f"together is {together}, expected 1 or more")
    path = Path(plan).absolute()
    count = _count(path)
    firsts = range(1, count + 1, together)
    chunks = [f"{first}-{min(first + together - 1, count)}" for first in firsts]
    words = [program, "--json", "--quiet", "bake", str(path)]
    if threads is not None:
        words += ["--threads", str(threads)]
    # Not pure: the same call may have other files to write tomorrow.
    parts = client.gather(client.map(_bake, chunks, words=words, pure=False))
    failed = {file: error for part in parts for file, error in part.failed.items()}
    return Baked(sum(part.done for part in parts), sum(part.unchanged for part in parts), failed)


def _count(path: Path) -> int:
    """The number of tasks, which the first line of a plan has; the rest may be large."""
    with path.open(encoding="utf-8", errors="replace") as file:
        head = file.readline(1 << 20)
    try:
        return int(json.loads(head.rstrip() + "]}")["count"])
    except (KeyError, TypeError, ValueError):
        raise ValueError(f"{path}: expected a plan made by `upglow bake --plan`") from None


def _bake(tasks: str, words: list[str]) -> Baked:
    """Does some tasks on this machine."""
    run = subprocess.run([*words, "--task", tasks], capture_output=True, text=True, check=False)
    if not run.stdout:
        raise RuntimeError(run.stderr.strip() or f"{words[0]} ended with {run.returncode}")
    told = json.loads(run.stdout)
    failed = {failure["file"]: failure["error"] for failure in told["failed"]}
    return Baked(len(told["pictures"]), len(told["unchanged"]), failed)
