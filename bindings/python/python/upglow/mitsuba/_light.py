"""Lights for the renderer's emitters."""

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

    It goes where an emitter takes `radiance`, `irradiance` or `intensity`. The renderer's own lights
    (`d65`, `rgb` and what is made of them) are dark below 360 nm, where many dyes absorb.

    Parameters
    ----------
    light
        An `upglow.Illuminant`, or what one is made from: a name, a CSV file, arrays, a
        ``colour.SpectralDistribution``.
    scale
        Factor of the light.
    by
        What a scale of 1 means. ``white``: the perfect diffuser has Y = 1 under an environment of
        this radiance. ``power``: as much power from 300 to 830 nm as `reference` has at Y = 1; for
        lamps that the eye hardly sees.
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
        raise ValueError(f"by {by!r}, expected white or power")
    values = ", ".join(f"{value:.9g}" for value in factor * power)
    return {
        "type": "regular",
        "wavelength_min": float(FINE_NM[0]),
        "wavelength_max": float(FINE_NM[-1]),
        "values": values,
    }


def _luminance(power: NDArray[np.float64]) -> float:
    """Y as the renderer's films have it: 1 for a power of about 1 at every wavelength."""
    y = np.array([mi.cie1931_y(nm) for nm in FINE_NM.tolist()]) if is_scalar() else _luminosity()
    return float(power @ y) * float(mi.MI_CIE_Y_NORMALIZATION)


def _luminosity() -> NDArray[np.float64]:
    return np.array(mi.cie1931_y(mi.Float(FINE_NM.astype(np.float32))), dtype=np.float64)
