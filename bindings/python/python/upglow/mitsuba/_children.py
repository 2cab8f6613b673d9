"""The parts of Mitsuba's objects."""

from __future__ import annotations

from functools import cache
from typing import Any

from ._host import mi


def children(parent: Any) -> list[tuple[str, Any]]:
    """The parts that an object of Mitsuba exposes, by name.

    Do not keep them longer than the object itself: a light that outlives its shape crashes the next
    rendering.
    """
    parts = _collector(mi.variant())()
    parent.traverse(parts)
    found: list[tuple[str, Any]] = parts.found
    return found


@cache
def _collector(_variant: str) -> Any:
    """One class per variant. A class per call would be freed late, and with it what it refers to."""

    class Parts(mi.TraversalCallback):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__()
            self.found: list[tuple[str, Any]] = []

        def put(self, name: str, value: Any, *_: Any) -> None:
            if isinstance(value, mi.Object):
                self.found.append((name, value))

    return Parts
