"""The model `dyes` in Dr.Jit. Its formulas: docs/cube-format.md."""

from __future__ import annotations

from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._cube import Cube
from ._host import dr, mi
from ._jit_curves import DyeTable, OfPair, Quantiles
from ._jit_lookup import Corner

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
        self._dyes = DyeTable(curves, numbers)
        self._absorbed = Quantiles(curves[:, 0])

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
        absorption, _ = self._dyes.curves_at(self._pair(corner), nm, active)
        return corner.numbers.y * _mix(absorption, corner)

    def reradiation(self, corner: Corner, in_nm: Any, out_nm: Any, active: Any) -> tuple[Any, Any]:
        """Re-radiation of a corner, 1/nm; and the same if no energy were lost to longer waves, in
        proportion to which incident wavelengths are drawn."""
        pair = self._pair(corner)
        yields, mean_nm = self._dyes.numbers_of(pair, active)
        absorption, _ = self._dyes.curves_at(pair, in_nm, active)
        _, emission = self._dyes.curves_at(pair, out_nm, active)
        factors = yields, absorption, emission
        kept = self._kept_energy(corner, in_nm, mean_nm)
        return self._product(corner, *factors, kept), self._product(corner, *factors)

    def drawn_total(self, corner: Corner, out_nm: Any, active: Any) -> Any:
        """Integral over incident wavelengths of what they are drawn in proportion to."""
        pair = self._pair(corner)
        yields, _ = self._dyes.numbers_of(pair, active)
        absorbed_nm = [self._absorbed.total(dye, active) for dye in pair]
        _, emission = self._dyes.curves_at(pair, out_nm, active)
        return self._product(corner, yields, absorbed_nm, emission)

    def draw(self, corner: Corner, out_nm: Any, choice: Any, u: Any, active: Any) -> Any:
        """An incident wavelength (nm), drawn in proportion to the corner's absorption.

        `choice`, in 0 to 1, selects one of the corner's dyes, and `u`, in 0 to 1, the wavelength.
        """
        pair = self._pair(corner)
        parts = [self._absorbed.total(dye, active) for dye in pair]
        if not self._is_pooled:
            yields, _ = self._dyes.numbers_of(pair, active)
            _, emission = self._dyes.curves_at(pair, out_nm, active)
            parts = [parts[i] * yields[i] * emission[i] for i in range(2)]
        first, second = (1 - corner.numbers.x) * parts[0], corner.numbers.x * parts[1]
        is_first = choice * (first + second) < first
        return self._absorbed.quantile(dr.select(is_first, pair[0], pair[1]), u, active)

    def _product(self, corner: Corner, *factors: OfPair) -> Any:
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

    def _kept_energy(self, corner: Corner, nm: Any, mean_nm: OfPair) -> OfPair:
        """Share of the energy absorbed at nm that each dye can re-emit, given the accounting."""
        if not self._is_photon:
            return [mi.Float(1), mi.Float(1)]
        if self._is_pooled:
            mean_nm = [_mix(mean_nm, corner)] * 2
        return [dr.minimum(nm / each, 1) for each in mean_nm]


def _mix(of_pair: OfPair, corner: Corner) -> Any:
    return dr.lerp(of_pair[0], of_pair[1], corner.numbers.x)
