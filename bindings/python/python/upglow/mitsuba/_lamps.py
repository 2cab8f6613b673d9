"""Which wavelengths the lights of a scene send."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._wavelengths import FINE_NM
from ._children import children
from ._host import dr, is_scalar, mi

_BY_LAMPS = 0.5
"""Share of the draws for bells that follow the lamps. More is noise where lamps are broad or
fluorescent light excites; less is noise where lamps are narrow."""

_FROM_LAMPS = 0.75
"""Share of the light that is taken to come straight from lamps, and not from what fluoresces. More is
noise where fluorescent light excites; less where lamps are narrow."""


_WORTH_BY_LAMPS = 0.5
"""Share of a wavelength's worth that the lamps decide. More is noise where fluorescent light goes from
surface to surface; less is noise where lamps are narrow."""


class Lamps:
    """The wavelengths of a scene's lights as a density to draw from."""

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
        """Power at each nm to expect on a surface: the lamps', and some at every wavelength."""
        return _FROM_LAMPS * _relative(self._power) + (1 - _FROM_LAMPS) / self._power.size

    def worth(self, nm: Any) -> Any:
        """How much light to expect at a wavelength, 1 on average from 300 to 830 nm; more than 0."""
        share = self._density.eval_pdf_normalized(nm) * float(FINE_NM[-1] - FINE_NM[0])
        return _WORTH_BY_LAMPS * share + (1 - _WORTH_BY_LAMPS)

    def draw(self, choice: Any, u: Any) -> tuple[Any, Any, Any]:
        """Whether a draw follows the lamps; the wavelength if so; what is left of the choice."""
        follows = choice < _BY_LAMPS
        rest = dr.select(follows, choice / _BY_LAMPS, (choice - _BY_LAMPS) / (1 - _BY_LAMPS))
        return follows, self._density.sample(u), rest

    def pdf(self, nm: Any, other: Any) -> Any:
        """The density of a draw, 1/nm, of which that by what is absorbed is `other`."""
        return _BY_LAMPS * self._density.eval_pdf_normalized(nm) + (1 - _BY_LAMPS) * other


def _power(emitter: Any) -> NDArray[np.float64]:
    """The power of a light at each wavelength, up to a factor; zeros where it does not say."""
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
