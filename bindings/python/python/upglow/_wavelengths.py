"""Wavelengths of sums and tables."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _upglow
from ._arrays import numbers

FINE_NM: NDArray[np.float64] = _upglow.Illuminant.wavelengths_nm()
"""300, 301 … 830 nm: the wavelengths of every table."""
FINE_NM.flags.writeable = False

FIT_NM: NDArray[np.float64] = FINE_NM[::5]
"""300, 305 … 830 nm: the wavelengths that fits and colors are summed over."""


RANGE_NM = (100.0, 4000.0)
"""The wavelengths that are accepted, from the ultraviolet to the end of tables of sunlight. Numbers outside
are mistakes of the unit: visible light is 0.38 to 0.78 in µm, and 3800 to 7800 in Å."""


def nanometers(what: str, values: ArrayLike) -> NDArray[np.float64]:
    """Wavelengths in nm. NaN stays, as draws have it where light is absorbed."""
    nm = numbers(what, values)
    first, last = RANGE_NM
    outside = nm[(nm < first) | (nm > last)]
    if outside.size:
        found = outside.flat[0]
        units = {"µm": 1e3, "m": 1e9, "Å": 0.1}
        likely = [unit for unit, factor in units.items() if 300 <= found * factor <= 830]
        hint = f"; it looks like {likely[0]}" if likely else ""
        raise ValueError(f"{what} is {found:g}, expected nm, {first:g} to {last:g}{hint}")
    return nm


def wavelength_list(wavelengths_nm: ArrayLike) -> NDArray[np.float64]:
    """One wavelength or a list of them."""
    nm = numbers("wavelengths_nm", wavelengths_nm)
    if nm.ndim > 1:
        raise ValueError(f"wavelengths_nm has shape {nm.shape}, expected (n,) or a number")
    return nanometers("wavelengths_nm", nm)


def grid(wavelengths_nm: ArrayLike) -> list[int]:
    """First, last and step of whole, equally spaced wavelengths."""
    nm = numbers("wavelengths_nm", wavelengths_nm)
    steps: NDArray[Any] = np.diff(nm) if nm.ndim == 1 and nm.size > 1 else np.zeros(1)
    is_whole = bool(np.all(nm == np.floor(nm)) and nm.min(initial=0) >= 0)
    if not is_whole or steps[0] <= 0 or np.any(steps != steps[0]):
        raise ValueError(
            f"wavelengths_nm is {np.array2string(nm, threshold=6)}, "
            "expected whole nm that rise in equal steps"
        )
    nanometers("wavelengths_nm", nm)
    return [int(nm[0]), int(nm[-1]), int(steps[0])]
