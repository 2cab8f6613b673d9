"""The spectral power of a scene's lights."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._wavelengths import FINE_NM
from ._children import children
from ._host import dr, is_scalar, mi

_BY_LAMPS = 0.5
"""Share of the draws of the analytic model that follow the lamps. A larger share is noisier where
lamps are broad or fluorescent light excites; a smaller one where lamps are narrow."""

_FROM_LAMPS = 0.75
"""Share of the light on a surface that is assumed to come directly from lamps. A larger share is
noisier where fluorescent light excites; a smaller one where lamps are narrow."""

_EXPECTED_FROM_LAMPS = 0.5
"""Share of a wavelength's expected light that depends on the lamps. A larger share is noisier where
fluorescent light passes from surface to surface; a smaller one where lamps are narrow."""


class Lamps:
    """The spectral power of a scene's lights, as a density of wavelengths to draw from."""

    def __init__(self, scene: Any) -> None:
        power = np.zeros(FINE_NM.size)
        for emitter in scene.emitters():
            power += _relative(_power(emitter))
        if not power.any():
            power += 1
        self._power = power
        ends = [float(FINE_NM[0]), float(FINE_NM[-1])]
        values = power.tolist() if is_scalar() else mi.Float(power.astype(np.float32))
        self._density = mi.ContinuousDistribution(ends, values)

    def spread_power(self) -> NDArray[np.float64]:
        """Expected power on a surface at each nm: that of the lamps, and a constant part."""
        return _FROM_LAMPS * _relative(self._power) + (1 - _FROM_LAMPS) / self._power.size

    def expected(self, nm: Any) -> Any:
        """Expected light at a wavelength, 1 on average over 300 to 830 nm; more than 0."""
        share = self._density.eval_pdf_normalized(nm) * float(FINE_NM[-1] - FINE_NM[0])
        return _EXPECTED_FROM_LAMPS * share + (1 - _EXPECTED_FROM_LAMPS)

    def draw(self, choice: Any, u: Any) -> tuple[Any, Any, Any]:
        """Whether a draw follows the lamps; the wavelength if so; `choice` rescaled to 0 to 1."""
        follows = choice < _BY_LAMPS
        rest = dr.select(follows, choice / _BY_LAMPS, (choice - _BY_LAMPS) / (1 - _BY_LAMPS))
        return follows, self._density.sample(u), rest

    def pdf(self, nm: Any, other: Any) -> Any:
        """Density of a draw, 1/nm; `other` is the density of draws that do not follow the lamps."""
        return _BY_LAMPS * self._density.eval_pdf_normalized(nm) + (1 - _BY_LAMPS) * other


def _power(emitter: Any) -> NDArray[np.float64]:
    """The power of a light at each wavelength, up to a factor; zeros if it exposes no spectrum."""
    power = np.zeros(FINE_NM.size)
    for _, part in children(emitter):
        if isinstance(part, mi.Texture):
            power += _spectrum(part)
    return power


def _spectrum(texture: Any) -> NDArray[np.float64]:
    si = dr.zeros(mi.SurfaceInteraction3f)
    if not is_scalar():
        nm = mi.Float(FINE_NM.astype(np.float32))
        si.wavelengths = mi.Spectrum(nm)
        return np.array(texture.eval(si)[0], dtype=np.float64) + np.zeros(FINE_NM.size)
    values = []
    for nm in FINE_NM.tolist():
        si.wavelengths = mi.Spectrum(nm)
        values.append(texture.eval(si)[0])
    return np.array(values)


def _relative(power: NDArray[np.float64]) -> NDArray[np.float64]:
    total = power.sum()
    return power / total if total > 0 else power
