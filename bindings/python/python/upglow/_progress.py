"""Progress of long work, for notebooks, terminals and programs."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

Report = Callable[[str, int, int], Any]
"""Takes the name of a stage, the units done and the total."""


@contextmanager
def reporting(progress: bool | Report) -> Iterator[Report | None]:
    """The function to which the native half reports progress."""
    if callable(progress):
        yield progress
        return
    bar = _bar() if progress else None
    try:
        yield bar
    finally:
        if bar is not None:
            bar.close()


def _bar() -> _Tqdm | _Plain | None:
    """A bar of tqdm, which supports notebooks; without tqdm, plain text if stderr is a terminal."""
    try:
        return _Tqdm(import_module("tqdm.auto").tqdm)
    except ImportError:
        return _Plain() if sys.stderr.isatty() else None


class _Tqdm:
    def __init__(self, tqdm: Any) -> None:
        self._tqdm: Any = tqdm
        self._bar: Any = None

    def __call__(self, stage: str, done: int, total: int) -> None:
        if self._bar is None or self._bar.desc.rstrip(": ") != stage:
            self.close()
            self._bar = self._tqdm(total=total, desc=stage, unit=" colors", unit_scale=True)
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None


class _Plain:
    def __call__(self, stage: str, done: int, total: int) -> None:
        sys.stderr.write(f"\r{stage} {100 * done // max(total, 1)} %   ")
        sys.stderr.flush()

    def close(self) -> None:
        sys.stderr.write("\r\x1b[K")
