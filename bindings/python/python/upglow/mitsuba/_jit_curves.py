"""Curves of dyes over 300 to 830 nm by 1 nm in the device's memory."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._host import dr, mi

_FIRST_NM, _BINS = 300.0, 530
"""First wavelength of the curves, and their number of steps of 1 nm."""

OfPair = list[Any]
"""A quantity of a corner's first dye and of its second."""

_Doubles = NDArray[np.float64]


class DyeTable:
    """Absorption (0 to 1) and emission (1/nm) of dyes, `[dye][2][nm from 300]`, and their quantum
    yields and mean emissions (nm), `[dye][2]`.
    """

    def __init__(self, curves: _Doubles, numbers: _Doubles) -> None:
        # Each value and its step to the next nm: `[dye][nm from 300][4]`.
        columns = [each for c in np.moveaxis(curves, 1, 0) for each in (c[:, :-1], np.diff(c))]
        self._curves = on_device(np.stack(columns, axis=-1))
        self._numbers = on_device(numbers)

    def curves_at(self, dyes: tuple[Any, Any], nm: Any, active: Any) -> tuple[OfPair, OfPair]:
        """Absorptions and emissions (1/nm), interpolated linearly; 0 outside 300 to 830 nm."""
        bin_, t, is_inside = place(nm, active)
        texels = [
            dr.gather(mi.Vector4f, self._curves, dye * _BINS + bin_, is_inside) for dye in dyes
        ]
        absorption = [dr.fma(t, texel.y, texel.x) for texel in texels]
        return absorption, [dr.fma(t, texel.w, texel.z) for texel in texels]

    def numbers_of(self, dyes: tuple[Any, Any], active: Any) -> tuple[OfPair, OfPair]:
        """Quantum yields and mean emissions (nm)."""
        first, second = (dr.gather(mi.Vector2f, self._numbers, dye, active) for dye in dyes)
        return [first.x, second.x], [first.y, second.y]


class Quantiles:
    """Curves, `[curve][nm from 300]`, to draw wavelengths in proportion to."""

    def __init__(self, curves: _Doubles) -> None:
        # Each value and its step to the next nm: `[curve][nm from 300][2]`.
        self._lines = on_device(np.stack([curves[:, :-1], np.diff(curves)], axis=-1))
        bins = 0.5 * (curves[:, 1:] + curves[:, :-1])
        # Integral from 300 nm on: `[curve][nm from 300]`.
        self._areas = on_device(np.pad(np.cumsum(bins, axis=1), ((0, 0), (1, 0))))

    def total(self, curve: Any, active: Any) -> Any:
        """The integral of a curve, nm times its unit."""
        return dr.gather(mi.Float, self._areas, curve * (_BINS + 1) + _BINS, active)

    def quantile(self, curve: Any, u: Any, active: Any) -> Any:
        """The wavelength (nm) below which the share u of a curve's integral lies."""
        start = curve * (_BINS + 1)
        area = u * self.total(curve, active)

        def is_below(at: Any) -> Any:
            return dr.gather(mi.Float, self._areas, start + at, active) <= area

        above = dr.binary_search(0, _BINS, is_below)
        bin_ = dr.clip(above, 1, _BINS) - 1
        rest = area - dr.gather(mi.Float, self._areas, start + bin_, active)
        line = dr.gather(mi.Vector2f, self._lines, curve * _BINS + bin_, active)
        root = dr.sqrt(dr.maximum(dr.square(line.x) + 2 * rest * line.y, 0))
        below = line.x + root
        t = dr.select(below > 0, dr.clip(2 * rest / below, 0, 1), 0)
        return _FIRST_NM + mi.Float(bin_) + t


def place(nm: Any, active: Any) -> tuple[Any, Any, Any]:
    """The sample before a wavelength, the distance from it in nm, and whether there are any."""
    steps = nm - _FIRST_NM
    is_inside = active & (steps >= 0) & (steps <= _BINS)
    bin_ = dr.minimum(mi.UInt32(dr.clip(steps, 0, _BINS)), _BINS - 1)
    return bin_, steps - mi.Float(bin_), is_inside


def on_device(table: _Doubles) -> Any:
    """An array in single precision in the device's memory, flat."""
    return mi.Float(table.astype(np.float32).ravel())
