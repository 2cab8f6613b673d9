"""What kind of material can show a color at all."""

from __future__ import annotations

from enum import IntEnum
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _upglow
from ._arrays import rgb_array, rows
from ._contract import Contract


class Kind(IntEnum):
    """The least that it takes to show a color."""

    REFLECTANCE = 0
    """Some reflectance shows it."""
    NEEDS_FLUORESCENCE = 1
    """No reflectance shows it, some fluorescent material does."""
    UNREACHABLE = 2
    """No material shows it."""


class Standing(NamedTuple):
    """Where colors stand among those that materials can show."""

    kind: NDArray[np.uint8]
    """A `Kind` for each color; shape (...)."""
    distance: NDArray[np.float64]
    """Distance in XYZ to the nearest color of any reflectance or, where the color is unreachable, of
    any material; 0 for a reflectance."""
    de2000: NDArray[np.float64]
    """CIEDE2000 to that color; 0 for a reflectance."""


@cache
def _default_contract() -> Contract:
    """Kept, because a contract remembers where it found colors to stand."""
    return Contract()


def standing(
    rgb: ArrayLike, contract: Contract | None = None, *, threads: int | None = None
) -> Standing:
    """Where colors stand: the limit of physics, not of a fit.

    Some material that nobody can make may be the one that shows a color: these limits know no slope
    limit and no dyes. They count photons.

    Parameters
    ----------
    rgb
        Linear RGB, shape (..., 3); any finite numbers.
    contract
        What RGB means; ACEScg under D65 by default.
    threads
        Threads; one for each core by default.

    Raises
    ------
    ValueError
        If a component is not a finite number.

    Examples
    --------
    >>> import upglow
    >>> upglow.standing([[0.5, 0.4, 0.3], [0.9, 0.0, 0.9], [0.0, 1.0, 0.0]]).kind.tolist()
    [0, 1, 2]
    """
    array = rgb_array(rgb).astype(np.float64, copy=False)
    if not np.isfinite(array).all():
        raise ValueError("rgb has a component that is not finite, expected finite numbers")
    native = (contract or _default_contract())._native
    shape = array.shape[:-1]
    kind, distance, de2000 = _upglow.standing(native, rows(array), threads)
    return Standing(kind.reshape(shape), distance.reshape(shape), de2000.reshape(shape))
