"""Spectra for Mitsuba's emitters."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._illuminant import Illuminant
from .._wavelengths import FINE_NM
from ._host import is_scalar, mi


def spectrum(
    light: Any, scale: float = 1.0, *, by: str = "white", reference: Any = "D65"
) -> dict[str, Any]:
    """A light as a spectrum for `mitsuba.load_dict`, from 300 to 830 nm by 1 nm.

    Use it as the `radiance`, `irradiance` or `intensity` of an emitter. Mitsuba's own lights (`d65`,
    `rgb` and all based on them) are 0 below 360 nm, where many dyes absorb.

    Parameters
    ----------
    light
        An `upglow.Illuminant`, or what one is made from: a name, a CSV file, arrays, a
        ``colour.SpectralDistribution``.
    scale
        Factor of the light.
    by
        Meaning of a scale of 1. ``white``: the perfect diffuser has Y = 1 under an environment of
        this radiance. ``power``: the power from 300 to 830 nm is that of `reference` at Y = 1; for
        lamps of low luminance, such as ultraviolet ones.
    reference
        The light that ``power`` refers to.

    Examples
    --------
    >>> import mitsuba
    >>> mitsuba.set_variant("scalar_spectral")
    >>> import upglow, upglow.mitsuba
    >>> lamp = upglow.Illuminant.line(385.0, 12.0)
    >>> sorted(upglow.mitsuba.spectrum(lamp, 2.0, by="power"))
    ['type', 'values', 'wavelength_max', 'wavelength_min']
    """
    power = Illuminant(light).power
    if mi.variant() is None:
        raise RuntimeError("no variant is set, expected mitsuba.set_variant first")
    if by == "white":
        factor = scale / _luminance(power)
    elif by == "power":
        measure = Illuminant(reference).power
        factor = scale * measure.sum() / _luminance(measure) / power.sum()
    else:
        raise ValueError(f"by is {by!r}, expected white or power")
    values = ", ".join(f"{value:.9g}" for value in factor * power)
    return {
        "type": "regular",
        "wavelength_min": float(FINE_NM[0]),
        "wavelength_max": float(FINE_NM[-1]),
        "values": values,
    }


def _luminance(power: NDArray[np.float64]) -> float:
    """Y as Mitsuba's films define it: about 1 for a power of 1 at every wavelength."""
    if is_scalar():
        y = np.array([mi.cie1931_y(nm) for nm in FINE_NM.tolist()])
    else:
        y = np.array(mi.cie1931_y(mi.Float(FINE_NM.astype(np.float32))), dtype=np.float64)
    return float(power @ y) * float(mi.MI_CIE_Y_NORMALIZATION)
