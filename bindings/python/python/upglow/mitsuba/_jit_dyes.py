"""Measured dyes, pooled or separate, in Dr.Jit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ._host import dr, mi
from ._jit_lookup import Corner
from ._node_arrays import DyeArrays

_FIRST_NM, _BINS = 300.0, 530
"""Where the curves begin, and the steps of 1 nm that they have."""


@dataclass
class _Curves:
    absorption: Any
    """Share of the light absorbed at concentration 1."""
    emission: Any
    """1/nm."""


class Dyes:
    """The dyes of a cube in the device's memory."""

    def __init__(self, arrays: DyeArrays, is_photon: bool) -> None:
        self.arrays = arrays
        self._is_pooled, self._is_photon = arrays.is_pooled, is_photon
        self._count = len(arrays.absorption)
        self._curves = mi.Float(arrays.curves().ravel())
        self._absorbed_nm = mi.Float(arrays.absorbed_nm().ravel())
        self._numbers = mi.Float(arrays.numbers().ravel())

    def absorbed(self, corner: Corner, nm: Any, active: Any) -> Any:
        """Share of the light at nm that a corner absorbs, 0 to 1."""
        first, second = (self._curves_at(dye, nm, active) for dye in self._pair(corner))
        return corner.numbers.y * _mix([first.absorption, second.absorption], corner)

    def returned(self, corner: Corner, nm: Any, active: Any) -> Any:
        """Share of the light at nm that a corner gives back by fluorescence, 0 to 1."""
        pair = self._pair(corner)
        numbers = [self._numbers_of(dye, active) for dye in pair]
        curves = [self._curves_at(dye, nm, active) for dye in pair]
        if self._is_pooled:
            quantum_yield = _mix([numbers[0].x, numbers[1].x], corner)
            mean_nm = _mix([numbers[0].y, numbers[1].y], corner)
            absorption = _mix([curve.absorption for curve in curves], corner)
            share = quantum_yield * absorption * self._share(nm, mean_nm)
        else:
            alone = [
                each.x * curve.absorption * self._share(nm, each.y)
                for each, curve in zip(numbers, curves, strict=True)
            ]
            share = _mix(alone, corner)
        return corner.numbers.y * share

    def moved(self, corner: Corner, in_nm: Any, out_nm: Any, active: Any) -> tuple[Any, Any]:
        """What a corner moves from one wavelength to another, 1/nm; and if no energy were lost."""
        pair = self._pair(corner)
        numbers = [self._numbers_of(dye, active) for dye in pair]
        absorption = [self._curves_at(dye, in_nm, active).absorption for dye in pair]
        emission = [self._curves_at(dye, out_nm, active).emission for dye in pair]
        if self._is_pooled:
            quantum_yield = _mix([numbers[0].x, numbers[1].x], corner)
            mean_nm = _mix([numbers[0].y, numbers[1].y], corner)
            whole = quantum_yield * _mix(absorption, corner) * _mix(emission, corner)
            found = self._share(in_nm, mean_nm) * whole, whole
        else:
            alone = [numbers[i].x * absorption[i] * emission[i] for i in range(2)]
            shared = [self._share(in_nm, numbers[i].y) * alone[i] for i in range(2)]
            found = _mix(shared, corner), _mix(alone, corner)
        return corner.numbers.y * found[0], corner.numbers.y * found[1]

    def leaving(self, corner: Corner, out_nm: Any, active: Any) -> Any:
        """What leaves at out_nm of light that is 1 everywhere, were no energy lost."""
        pair = self._pair(corner)
        numbers = [self._numbers_of(dye, active) for dye in pair]
        emission = [self._curves_at(dye, out_nm, active).emission for dye in pair]
        if self._is_pooled:
            quantum_yield = _mix([numbers[0].x, numbers[1].x], corner)
            absorbed_nm = _mix([numbers[0].z, numbers[1].z], corner)
            return corner.numbers.y * quantum_yield * absorbed_nm * _mix(emission, corner)
        alone = [numbers[i].x * numbers[i].z * emission[i] for i in range(2)]
        return corner.numbers.y * _mix(alone, corner)

    def draw(self, corner: Corner, out_nm: Any, choice: Any, u: Any, active: Any) -> Any:
        """An incident wavelength (nm) with the density of what a corner absorbs.

        `choice` is between the corner's dyes; it and `u` are in 0 to 1.
        """
        pair = self._pair(corner)
        numbers = [self._numbers_of(dye, active) for dye in pair]
        carried = [numbers[i].z for i in range(2)]
        if not self._is_pooled:
            emission = [self._curves_at(dye, out_nm, active).emission for dye in pair]
            carried = [carried[i] * numbers[i].x * emission[i] for i in range(2)]
        first, second = (1 - corner.numbers.x) * carried[0], corner.numbers.x * carried[1]
        is_first = choice * (first + second) < first
        return self._quantile(dr.select(is_first, pair[0], pair[1]), u, active)

    def _pair(self, corner: Corner) -> tuple[Any, Any]:
        first = mi.UInt32(corner.numbers.w)
        return first, dr.select(first + 1 < self._count, first + 1, 0)

    def _numbers_of(self, dye: Any, active: Any) -> Any:
        return dr.gather(mi.Vector4f, self._numbers, dye, active)

    def _curves_at(self, dye: Any, nm: Any, active: Any) -> _Curves:
        """Straight lines between samples, zero beyond the last."""
        place = nm - _FIRST_NM
        is_inside = active & (place >= 0) & (place <= _BINS)
        bin_ = dr.minimum(mi.UInt32(dr.clip(place, 0, _BINS)), _BINS - 1)
        t = place - mi.Float(bin_)
        texel = dr.gather(mi.Vector4f, self._curves, dye * _BINS + bin_, is_inside)
        return _Curves(dr.fma(t, texel.y, texel.x), dr.fma(t, texel.w, texel.z))

    def _quantile(self, dye: Any, u: Any, active: Any) -> Any:
        """The wavelength below which the share u of a dye's absorption lies."""
        start = dye * (_BINS + 1)
        area = u * dr.gather(mi.Float, self._absorbed_nm, start + _BINS, active)

        def is_below(at: Any) -> Any:
            return dr.gather(mi.Float, self._absorbed_nm, start + at, active) <= area

        above = dr.binary_search(0, _BINS, is_below)
        bin_ = dr.clip(above, 1, _BINS) - 1
        rest = area - dr.gather(mi.Float, self._absorbed_nm, start + bin_, active)
        texel = dr.gather(mi.Vector4f, self._curves, dye * _BINS + bin_, active)
        root = dr.sqrt(dr.maximum(dr.square(texel.x) + 2 * rest * texel.y, 0))
        below = texel.x + root
        t = dr.select(below > 0, dr.clip(2 * rest / below, 0, 1), 0)
        return _FIRST_NM + mi.Float(bin_) + t

    def _share(self, nm: Any, mean_nm: Any) -> Any:
        return dr.minimum(nm / mean_nm, 1) if self._is_photon else 1


def _mix(of_pair: list[Any], corner: Corner) -> Any:
    return dr.lerp(of_pair[0], of_pair[1], corner.numbers.x)
