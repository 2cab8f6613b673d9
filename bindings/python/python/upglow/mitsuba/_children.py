"""The parts of the renderer's objects."""

from __future__ import annotations

from functools import cache
from typing import Any

from ._host import mi


def children(parent: Any) -> list[tuple[str, Any]]:
    """The parts that an object of the renderer shows, by name.

    They are not to be kept longer than what they are parts of: a light alone, when its shape is gone,
    ends the next rendering with a crash.
    """
    parts = _collector(mi.variant())()
    parent.traverse(parts)
    found: list[tuple[str, Any]] = parts.found
    return found


@cache
def _collector(_variant: str) -> Any:
    """One class for each variant: a class is freed late, and with it all that it refers to."""

    class Parts(mi.TraversalCallback):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__()
            self.found: list[tuple[str, Any]] = []

        def put(self, name: str, value: Any, *_: Any) -> None:
            if isinstance(value, mi.Object):
                self.found.append((name, value))

    return Parts
