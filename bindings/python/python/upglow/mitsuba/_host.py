"""The renderer: `mi` and `dr` are the packages mitsuba and drjit.

They are untyped here: what they hold depends on the variant that is set.
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
    """Whether the variant works on one ray at a time."""
    return str(mi.variant()).startswith("scalar")


def what_is_missing() -> str | None:
    """Why the variant that is set cannot show spectral materials, if it cannot."""
    if not mi.is_spectral:
        lack = "has no wavelengths"
    elif mi.is_polarized:
        lack = "tracks polarization, which fluorescence here does not"
    else:
        return None
    return f"variant {mi.variant()} {lack}, expected llvm_ad_spectral or another *_spectral"


def spectrum_of(values: Any) -> Any:
    """A value for each wavelength of a ray."""
    return mi.Spectrum(*values)


def ratio(part: Any, whole: Any) -> Any:
    """A quotient, 0 where the whole is not positive: a scalar variant must not even try."""
    is_some = whole > 0
    return dr.select(is_some, part / dr.select(is_some, whole, 1), 0)
