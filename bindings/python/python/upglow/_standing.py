"""What kind of material can reproduce a color."""

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
    """The simplest kind of material that can reproduce a color."""

    REFLECTANCE = 0
    """A material that only reflects."""
    NEEDS_FLUORESCENCE = 1
    """A fluorescent material, but no reflectance."""
    UNREACHABLE = 2
    """No material at all."""


class Standing(NamedTuple):
    """What kind of material can reproduce colors, and their distance from those of reflectances."""

    kind: NDArray[np.uint8]
    """A `Kind` for each color; shape (...)."""
    distance: NDArray[np.float64]
    """Distance in XYZ to the nearest color of any reflectance or, where the color is unreachable, of
    any material; 0 for a reflectance."""
    de2000: NDArray[np.float64]
    """CIEDE2000 to that color; 0 for a reflectance."""


@cache
def _default_contract() -> Contract:
    """Kept, because a contract caches the geometry that answers this question."""
    return Contract()


def standing(
    rgb: ArrayLike, contract: Contract | None = None, *, threads: int | None = None
) -> Standing:
    """What kind of material can reproduce each color: the limit of physics, not of a fit.

    The limit includes materials that nobody can make: it considers neither a slope limit nor real
    dyes. Fluorescence re-emits at most one photon per photon absorbed.

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
    agreed = _default_contract() if contract is None else Contract._or_default(contract)
    shape = array.shape[:-1]
    kind, distance, de2000 = _upglow.standing(agreed._native, rows(array), threads)
    return Standing(kind.reshape(shape), distance.reshape(shape), de2000.reshape(shape))
