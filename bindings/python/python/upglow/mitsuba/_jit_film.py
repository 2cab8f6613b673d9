"""The model `film` in Dr.Jit. Its formulas: docs/cube-format.md."""

from __future__ import annotations

from math import log
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._cube import Cube
from ._host import dr, mi
from ._jit_curves import DyeTable, OfPair, Quantiles, on_device, place
from ._jit_lookup import Corner

_LN_10 = log(10)

_THIN = 0.1
"""Below this optical density the closed form of what a film absorbs cancels more digits than the first
five terms of its series leave out, 9e-7 of it."""

_SAMPLES = 531
"""Samples of a curve, by 1 nm."""

_Doubles = NDArray[np.float64]


class Film:
    """The dyes of a film in the device's memory.

    `curves` and `numbers` are those of `DyeTable`. `proposed` holds what each dye by itself returns at
    four optical densities, `levels`: `[dye][level][nm from 300]`. Incident wavelengths are drawn from
    it.
    """

    def __init__(
        self,
        curves: _Doubles,
        numbers: _Doubles,
        levels: list[float],
        proposed: _Doubles,
        *,
        is_photon: bool,
    ) -> None:
        self._tables = curves, numbers, levels, proposed
        self._is_photon, self._levels = is_photon, levels
        self._dyes = DyeTable(curves, numbers)
        # `[dye][nm from 300][level]`
        self._proposed = on_device(np.moveaxis(proposed, 1, 2))
        self._quantiles = Quantiles(proposed.reshape(-1, _SAMPLES))

    @classmethod
    def of(cls, cube: Cube) -> Film:
        """The dyes of a cube with the model `film`."""
        numbers, found = cube._native.dye_numbers(), cube._native.film_proposals()
        assert found is not None, "the cube's model is a film"
        levels, alone = found
        proposed = numbers[:, :1, None] * alone
        is_photon = cube.header["model"]["accounting"] == "photon"
        return cls(cube.dye_curves, numbers, levels, proposed, is_photon=is_photon)

    def lit_by(self, power: _Doubles) -> Film:
        """The same film; draws follow the dyes' curves times a power, given by 1 nm."""
        curves, numbers, levels, proposed = self._tables
        return Film(curves, numbers, levels, proposed * power, is_photon=self._is_photon)

    def absorbed(self, corner: Corner, nm: Any, active: Any) -> Any:
        """Share of the light at nm that a corner absorbs, 0 to 1."""
        first, second = self._densities_at(corner, nm, active)
        return 1 - dr.exp(-_LN_10 * (first + second))

    def reradiation(self, corner: Corner, in_nm: Any, out_nm: Any, active: Any) -> tuple[Any, Any]:
        """Re-radiation of a corner, 1/nm; and that in proportion to which incident wavelengths are
        drawn."""
        pair = _pair(corner)
        own = self._densities_at(corner, in_nm, active)
        absorbed = _absorbed_per_density(own[0] + own[1])
        yields, mean_nm = self._dyes.numbers_of(pair, active)
        _, emission = self._dyes.curves_at(pair, out_nm, active)
        proposed = [
            self._proposed_by(dye, density, in_nm, active)
            for dye, density in zip(pair, _densities(corner), strict=True)
        ]
        moved, drawn = mi.Float(0), mi.Float(0)
        for i in range(2):
            kept = dr.minimum(in_nm / mean_nm[i], 1) if self._is_photon else 1
            moved += own[i] * absorbed * yields[i] * kept * emission[i]
            drawn += proposed[i] * emission[i]
        return moved, drawn

    def drawn_total(self, corner: Corner, out_nm: Any, active: Any) -> Any:
        """Integral over incident wavelengths of what they are drawn in proportion to."""
        first, second = self._drawn_totals(corner, out_nm, active)
        return first + second

    def draw(self, corner: Corner, out_nm: Any, choice: Any, u: Any, active: Any) -> Any:
        """An incident wavelength (nm), drawn in proportion to what the corner's dyes propose.

        `choice`, in 0 to 1, selects one of the corner's dyes, and `u`, in 0 to 1, the density level and
        the wavelength.
        """
        totals = self._drawn_totals(corner, out_nm, active)
        is_first = choice * (totals[0] + totals[1]) < totals[0]
        pair, densities = _pair(corner), _densities(corner)
        dye = dr.select(is_first, pair[0], pair[1])
        areas = self._level_areas(dye, dr.select(is_first, densities[0], densities[1]), active)
        rest = u * (areas[0] + areas[1] + areas[2] + areas[3])
        level, area = mi.UInt32(0), areas[0]
        for k in range(1, 4):
            is_beyond = (rest >= area) & (areas[k] > 0)
            rest = dr.select(is_beyond, rest - area, rest)
            area = dr.select(is_beyond, areas[k], area)
            level = dr.select(is_beyond, k, level)
        share = dr.select(area > 0, rest / area, 0)
        return self._quantiles.quantile(4 * dye + level, share, active)

    def _densities_at(self, corner: Corner, nm: Any, active: Any) -> OfPair:
        """The optical density of each dye at nm."""
        absorption, _ = self._dyes.curves_at(_pair(corner), nm, active)
        return [a * density for a, density in zip(absorption, _densities(corner), strict=True)]

    def _drawn_totals(self, corner: Corner, out_nm: Any, active: Any) -> OfPair:
        """What each dye adds to `drawn_total`."""
        pair = _pair(corner)
        _, emission = self._dyes.curves_at(pair, out_nm, active)
        areas = [
            self._level_areas(dye, density, active)
            for dye, density in zip(pair, _densities(corner), strict=True)
        ]
        return [sum(areas[i]) * emission[i] for i in range(2)]

    def _proposed_by(self, dye: Any, density: Any, nm: Any, active: Any) -> Any:
        """What a dye proposes at nm: mixed of the two nearest levels, scaled below the first."""
        bin_, t, is_inside = place(nm, active)
        at = dye * _SAMPLES + bin_
        low, high = (
            dr.gather(mi.Vector4f, self._proposed, row, is_inside) for row in (at, at + 1)
        )
        levels = dr.lerp(low, high, t)
        shares = self._shares(density)
        return sum(share * level for share, level in zip(shares, levels, strict=True))

    def _level_areas(self, dye: Any, density: Any, active: Any) -> list[Any]:
        """The integral of what a dye proposes, nm, by level."""
        shares = enumerate(self._shares(density))
        return [share * self._quantiles.total(4 * dye + k, active) for k, share in shares]

    def _shares(self, density: Any) -> list[Any]:
        """The share of each level in the curve of a density."""
        below = [0.0, *self._levels[:-1]]
        bounds = zip(below, self._levels, strict=True)
        reached = [dr.clip((density - low) / (high - low), 0, 1) for low, high in bounds]
        return [reached[0] - reached[1], reached[1] - reached[2], reached[2] - reached[3], reached[3]]


def _pair(corner: Corner) -> tuple[Any, Any]:
    return mi.UInt32(corner.numbers.w), mi.UInt32(corner.numbers.z)


def _densities(corner: Corner) -> OfPair:
    return [corner.numbers.y, corner.numbers.x]


def _absorbed_per_density(density: Any) -> Any:
    """What a film absorbs over its optical density; ln 10 for a thin one."""
    z = _LN_10 * density
    series = _LN_10 * (1 - z * (1 / 2 - z * (1 / 6 - z * (1 / 24 - z / 120))))
    closed = (1 - dr.exp(-z)) / dr.maximum(density, _THIN)
    return dr.select(density < _THIN, series, closed)
