"""The model `dyes` in Dr.Jit. Its formulas: docs/cube-format.md."""

from __future__ import annotations

from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._cube import Cube
from ._host import dr, mi
from ._jit_lookup import Corner

_FIRST_NM, _BINS = 300.0, 530
"""First wavelength of the curves, and their number of steps of 1 nm."""

_OfPair = list[Any]
"""A quantity of a corner's first dye and of its second."""

_Doubles = NDArray[np.float64]


class Dyes:
    """The dyes of a cube in the device's memory.

    `curves` holds absorption (share at concentration 1) and emission (1/nm) of each dye,
    `[dye][2][nm from 300]`, and `numbers` quantum yields and mean emissions (nm), `[dye][2]`.
    """

    def __init__(
        self, curves: _Doubles, numbers: _Doubles, *, is_pooled: bool, is_photon: bool
    ) -> None:
        self._tables = curves, numbers
        self._is_pooled, self._is_photon = is_pooled, is_photon
        self._count = len(curves)
        absorption, emission = np.moveaxis(curves, 1, 0)
        # Each value and its step to the next nm: `[dye][nm from 300][4]`.
        columns = [each for c in (absorption, emission) for each in (c[:, :-1], np.diff(c))]
        self._curves = _on_device(np.stack(columns, axis=-1))
        bins = 0.5 * (absorption[:, 1:] + absorption[:, :-1])
        # Integral of the absorption from 300 nm on: `[dye][nm from 300]`.
        absorbed_nm = np.pad(np.cumsum(bins, axis=1), ((0, 0), (1, 0)))
        self._absorbed_nm = _on_device(absorbed_nm)
        # Quantum yield, mean emission (nm), integral of the absorption (nm), 0: `[dye][4]`.
        integral = absorbed_nm[:, -1:]
        self._numbers = _on_device(np.concatenate([numbers, integral, 0 * integral], axis=1))

    @classmethod
    def of(cls, cube: Cube) -> Dyes:
        """The dyes of a cube with the model `dyes`."""
        model, numbers = cube.header["model"], cube._native.dye_numbers()
        is_pooled, is_photon = model["mixing"] == "pooled", model["accounting"] == "photon"
        return cls(cube.dye_curves, numbers, is_pooled=is_pooled, is_photon=is_photon)

    def lit_by(self, power: _Doubles) -> Dyes:
        """Lossless dyes whose absorption is this one times a power, given by 1 nm."""
        curves, numbers = self._tables
        lit = np.stack([curves[:, 0] * power, curves[:, 1]], axis=1)
        return Dyes(lit, numbers, is_pooled=self._is_pooled, is_photon=False)

    def absorbed(self, corner: Corner, nm: Any, active: Any) -> Any:
        """Share of the light at nm that a corner absorbs, 0 to 1."""
        absorption, _ = self._curves_at(corner, nm, active)
        return corner.numbers.y * _mix(absorption, corner)

    def reradiation(self, corner: Corner, in_nm: Any, out_nm: Any, active: Any) -> tuple[Any, Any]:
        """Re-radiation of a corner, 1/nm; and the same if no energy were lost to longer waves."""
        yields, mean_nm, _ = self._numbers_of(corner, active)
        absorption, _ = self._curves_at(corner, in_nm, active)
        _, emission = self._curves_at(corner, out_nm, active)
        factors = yields, absorption, emission
        kept = self._kept_energy(corner, in_nm, mean_nm)
        return self._product(corner, *factors, kept), self._product(corner, *factors)

    def lossless_emission(self, corner: Corner, out_nm: Any, active: Any) -> Any:
        """Integral of the lossless re-radiation over incident wavelengths."""
        yields, _, absorbed_nm = self._numbers_of(corner, active)
        _, emission = self._curves_at(corner, out_nm, active)
        return self._product(corner, yields, absorbed_nm, emission)

    def draw(self, corner: Corner, out_nm: Any, choice: Any, u: Any, active: Any) -> Any:
        """An incident wavelength (nm), drawn in proportion to the corner's absorption.

        `choice`, in 0 to 1, selects one of the corner's dyes, and `u`, in 0 to 1, the wavelength.
        """
        yields, _, parts = self._numbers_of(corner, active)
        if not self._is_pooled:
            _, emission = self._curves_at(corner, out_nm, active)
            parts = [parts[i] * yields[i] * emission[i] for i in range(2)]
        first, second = (1 - corner.numbers.x) * parts[0], corner.numbers.x * parts[1]
        is_first = choice * (first + second) < first
        pair = self._pair(corner)
        return self._quantile(dr.select(is_first, pair[0], pair[1]), u, active)

    def _product(self, corner: Corner, *factors: _OfPair) -> Any:
        """The product of the factors of a corner's dyes, times its concentration.

        Pooled, the two dyes act as one: the means of each factor are multiplied. Separate, each dye's
        factors are multiplied, and the products averaged.
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
        """Absorptions at concentration 1, and emissions (1/nm), interpolated linearly.

        They are 0 outside 300 to 830 nm.
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
        """The wavelength (nm) below which the share u of a dye's absorption lies."""
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

    def _kept_energy(self, corner: Corner, nm: Any, mean_nm: _OfPair) -> _OfPair:
        """Share of the energy absorbed at nm that each dye can re-emit, given the accounting."""
        if not self._is_photon:
            return [mi.Float(1), mi.Float(1)]
        if self._is_pooled:
            mean_nm = [_mix(mean_nm, corner)] * 2
        return [dr.minimum(nm / each, 1) for each in mean_nm]


def _on_device(table: _Doubles) -> Any:
    return mi.Float(table.astype(np.float32).ravel())


def _mix(of_pair: _OfPair, corner: Corner) -> Any:
    return dr.lerp(of_pair[0], of_pair[1], corner.numbers.x)
