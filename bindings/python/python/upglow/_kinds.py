"""Kinds of arguments: errors name the argument, and say what was found and what is expected."""

from __future__ import annotations

import operator
from contextlib import suppress
from typing import Any, TypeVar

Kind = TypeVar("Kind")


def instance(what: str, value: Any, kind: type[Kind], expected: str = "") -> Kind:
    """The value, if it is of this kind."""
    if isinstance(value, kind):
        return value
    raise wrong(what, value, expected or f"a {kind.__name__}")


def whole(what: str, value: Any) -> int:
    """A whole number, 0 or more."""
    try:
        number = operator.index(value)
    except TypeError:
        raise wrong(what, value, "a whole number") from None
    if number < 0:
        raise ValueError(f"{what} is {number}, expected 0 or more")
    return number


def real(what: str, value: Any, expected: str = "a number") -> float:
    """A number; texts are none."""
    if not isinstance(value, (str, bytes)):
        with suppress(TypeError):
            return float(value)
    raise wrong(what, value, expected)


def wrong(what: str, value: Any, expected: str) -> TypeError:
    """The error for a value of another kind; a class in place of one of its objects is named as such."""
    found = f"the class {value.__name__}" if isinstance(value, type) else type(value).__name__
    return TypeError(f"{what} is {found}, expected {expected}")
