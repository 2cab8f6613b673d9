"""The renderer: `mi` and `dr` are the packages mitsuba and drjit.

They are untyped here, because their content depends on the current variant.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

try:
    mi: Any = import_module("mitsuba")
    dr: Any = import_module("drjit")
except ImportError as error:
    raise ImportError(
        "upglow.mitsuba needs the package mitsuba, 3.9 or later: pip install mitsuba"
    ) from error


def is_scalar() -> bool:
    """Whether the current variant works on one ray at a time."""
    return str(mi.variant()).startswith("scalar")


def what_is_missing() -> str | None:
    """Why the current variant cannot render spectral materials; None if it can."""
    if not mi.is_spectral:
        problem = "has no wavelengths"
    elif mi.is_polarized:
        problem = "tracks polarization, which upglow does not support"
    else:
        return None
    return f"variant {mi.variant()} {problem}, expected llvm_ad_spectral or another *_spectral"


def spectrum_of(values: Any) -> Any:
    """A value for each wavelength of a ray."""
    return mi.Spectrum(*values)


def ratio(part: Any, whole: Any) -> Any:
    """The quotient, 0 where `whole` is not positive; never divides by 0, as scalars would raise."""
    is_some = whole > 0
    return dr.select(is_some, part / dr.select(is_some, whole, 1), 0)
