"""Conversion between arrays of any leading shape and the rows that the native half takes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _upglow
from ._kinds import wrong
from ._materials import Materials, ModelName

Shape = tuple[int, ...]

Threads = int | None
"""A number of threads; one per core by default."""

Of = ArrayLike | Materials
"""What is evaluated: linear RGB of shape (..., 3), or materials."""

Nm = ArrayLike
"""One wavelength or an array of them, nm."""


def numbers(what: str, values: Any) -> NDArray[np.float64]:
    """The numbers that a caller gives, in double precision."""
    return _numeric(what, values).astype(np.float64, copy=False)


def _numeric(what: str, values: Any) -> NDArray[Any]:
    """The numbers that a caller gives. Masked arrays are refused, because an array loses the mask."""
    parts = values if isinstance(values, (list, tuple)) else (values,)
    if any(isinstance(part, np.ma.MaskedArray) for part in parts):
        raise TypeError(f"{what} is a masked array, expected one without mask: see filled()")
    try:
        array = np.asarray(values)
    except ValueError:
        raise ValueError(f"{what} has rows of different lengths, expected an array") from None
    if array.dtype.kind == "O" and not isinstance(values, (list, tuple, np.ndarray)):
        raise wrong(what, values, "numbers")
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{what} has dtype {array.dtype}, expected numbers")
    return array


def rgb_array(rgb: ArrayLike) -> NDArray[Any]:
    """RGB of shape (..., 3): float32 stays float32, all other types become float64."""
    array = _numeric("rgb", rgb)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"rgb has shape {array.shape}, expected (..., 3)")
    return array if array.dtype == np.float32 else array.astype(np.float64, copy=False)


def within(rgb: ArrayLike, outside: str) -> NDArray[Any]:
    """RGB after the treatment of values outside 0 to 1 that ``outside`` selects."""
    array = rgb_array(rgb)
    if outside == "raise":
        refuse_outside(array, to_fit=False)
        return array
    if outside == "clip":
        clipped: NDArray[Any] = np.clip(array, 0.0, 1.0)
        return clipped
    if outside == "nan":
        return array
    raise ValueError(f"outside is {outside!r}, expected raise, nan or clip")


def refuse_outside(array: NDArray[Any], *, to_fit: bool) -> None:
    """Raises a ValueError that names index and value of the first RGB out of range."""
    found = _upglow.first_outside(rows(array), to_fit)
    if found is not None:
        row, message = found
        index = ", ".join(str(i) for i in np.unravel_index(row, array.shape[:-1]))
        raise ValueError(f"rgb[{index}]: {message}" if index else f"rgb: {message}")


def rows(array: NDArray[Any]) -> NDArray[Any]:
    """The array as contiguous rows of its last axis."""
    return np.ascontiguousarray(array).reshape(-1, array.shape[-1])


def single_rows(array: NDArray[Any]) -> NDArray[np.float32]:
    """RGB as rows in single precision."""
    return rows(array.astype(np.float32, copy=False))


def subjects(of: Of, outside: str, model: ModelName) -> tuple[Any, Shape]:
    """What is evaluated, in the native half's form, and its leading shape."""
    if isinstance(of, Materials):
        return of._rows(model), of.shape
    array = within(of, outside)
    return rows(array), array.shape[:-1]


def broadcast(
    of: Of, outside: str, model: ModelName, *known: ArrayLike
) -> tuple[Any, NDArray[np.float64], Shape]:
    """What is evaluated, a row of numbers for each, and the leading shape of both."""
    subject = of if isinstance(of, Materials) else within(of, outside)
    lead = subject.shape if isinstance(subject, Materials) else subject.shape[:-1]
    arrays = [np.asarray(number, dtype=np.float64) for number in known]
    shape = np.broadcast_shapes(lead, *(array.shape for array in arrays))
    given = rows(np.stack([np.broadcast_to(array, shape) for array in arrays], axis=-1))
    if isinstance(subject, Materials):
        return subject.broadcast_to(shape)._rows(model), given, shape
    return rows(np.broadcast_to(subject, (*shape, 3))), given, shape
