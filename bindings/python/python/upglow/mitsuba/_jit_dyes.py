"""Measured dyes, pooled or separate, in Dr.Jit."""

from __future__ import annotations

from math import prod
from typing import Any

from ._host import dr, mi
from ._jit_lookup import Corner
from ._node_arrays import DyeArrays

_FIRST_NM, _BINS = 300.0, 530
"""Where the curves begin, and the steps of 1 nm that they have."""


_OfPair = list[Any]
"""A number of a corner's first dye and of its second."""


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
        absorption, _ = self._curves_at(corner, nm, active)
        return corner.numbers.y * _mix(absorption, corner)

    def returned(self, corner: Corner, nm: Any, active: Any) -> Any:
        """Share of the light at nm that a corner gives back by fluorescence, 0 to 1."""
        yields, mean_nm, _ = self._numbers_of(corner, active)
        absorption, _ = self._curves_at(corner, nm, active)
        return self._product(corner, yields, absorption, self._shares(corner, nm, mean_nm))

    def moved(self, corner: Corner, in_nm: Any, out_nm: Any, active: Any) -> tuple[Any, Any]:
        """What a corner moves from one wavelength to another, 1/nm; and if no energy were lost."""
        yields, mean_nm, _ = self._numbers_of(corner, active)
        absorption, _ = self._curves_at(corner, in_nm, active)
        _, emission = self._curves_at(corner, out_nm, active)
        shares = self._shares(corner, in_nm, mean_nm)
        return (
            self._product(corner, yields, absorption, emission, shares),
            self._product(corner, yields, absorption, emission),
        )

    def leaving(self, corner: Corner, out_nm: Any, active: Any) -> Any:
        """What leaves at out_nm of light that is 1 everywhere, were no energy lost."""
        yields, _, absorbed_nm = self._numbers_of(corner, active)
        _, emission = self._curves_at(corner, out_nm, active)
        return self._product(corner, yields, absorbed_nm, emission)

    def draw(self, corner: Corner, out_nm: Any, choice: Any, u: Any, active: Any) -> Any:
        """An incident wavelength (nm) with the density of what a corner absorbs.

        `choice` is between the corner's dyes; it and `u` are in 0 to 1.
        """
        yields, _, carried = self._numbers_of(corner, active)
        if not self._is_pooled:
            _, emission = self._curves_at(corner, out_nm, active)
            carried = [carried[i] * yields[i] * emission[i] for i in range(2)]
        first, second = (1 - corner.numbers.x) * carried[0], corner.numbers.x * carried[1]
        is_first = choice * (first + second) < first
        pair = self._pair(corner)
        return self._quantile(dr.select(is_first, pair[0], pair[1]), u, active)

    def _product(self, corner: Corner, *factors: _OfPair) -> Any:
        """A product of what a corner's dyes have, at its concentration.

        Pooled, two dyes are one: the means are multiplied. Separate, each product is its own.
        """
        if self._is_pooled:
            product = prod(_mix(factor, corner) for factor in factors)
        else:
            product = _mix([prod(each) for each in zip(*factors, strict=True)], corner)
        return corner.numbers.y * product

    def _pair(self, corner: Corner) -> tuple[Any, Any]:
        first = mi.UInt32(corner.numbers.w)
        return first, dr.select(first + 1 < self._count, first + 1, 0)

    def _numbers_of(self, corner: Corner, active: Any) -> tuple[_OfPair, _OfPair, _OfPair]:
        """Quantum yields, mean emissions (nm) and integrals of the absorption (nm)."""
        first, second = (
            dr.gather(mi.Vector4f, self._numbers, dye, active) for dye in self._pair(corner)
        )
        return [first.x, second.x], [first.y, second.y], [first.z, second.z]

    def _curves_at(self, corner: Corner, nm: Any, active: Any) -> tuple[_OfPair, _OfPair]:
        """Absorptions at concentration 1, and emissions (1/nm).

        Straight lines between samples, zero beyond the last.
        """
        place = nm - _FIRST_NM
        is_inside = active & (place >= 0) & (place <= _BINS)
        bin_ = dr.minimum(mi.UInt32(dr.clip(place, 0, _BINS)), _BINS - 1)
        t = place - mi.Float(bin_)
        texels = [
            dr.gather(mi.Vector4f, self._curves, dye * _BINS + bin_, is_inside)
            for dye in self._pair(corner)
        ]
        absorption = [dr.fma(t, texel.y, texel.x) for texel in texels]
        return absorption, [dr.fma(t, texel.w, texel.z) for texel in texels]

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

    def _shares(self, corner: Corner, nm: Any, mean_nm: _OfPair) -> _OfPair:
        """What is left of energy absorbed at nm."""
        if not self._is_photon:
            return [mi.Float(1), mi.Float(1)]
        if self._is_pooled:
            mean_nm = [_mix(mean_nm, corner)] * 2
        return [dr.minimum(nm / each, 1) for each in mean_nm]


def _mix(of_pair: _OfPair, corner: Corner) -> Any:
    return dr.lerp(of_pair[0], of_pair[1], corner.numbers.x)
