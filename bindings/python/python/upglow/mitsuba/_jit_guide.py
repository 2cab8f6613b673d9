"""Draws of the incident wavelengths of fluorescence, in Dr.Jit.

A dye absorbs over a hundred nanometers, a lamp may emit in ten of them. Drawn in proportion to the
absorption alone, few wavelengths would be lit, and the picture would be noisy. For measured dyes,
draws follow the product of absorption and lamps. The analytic model has no tables to multiply: some
of its draws follow the lamps alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ._host import dr, mi
from ._jit_bells import Bells
from ._jit_dyes import Dyes
from ._jit_film import Film
from ._jit_lookup import Corner
from ._lamps import Lamps

_BELOW_ONE = 0.99999994
"""The greatest single-precision number below 1: a choice of 1 would select no corner."""


def guide(dyes: Dyes | Film | Bells, lamps: Lamps | None) -> ByAbsorption | ByLampsToo:
    """The strategy of draws for a cube's dyes, under the lamps of a scene or under any light."""
    if lamps is None:
        return ByAbsorption(dyes)
    if not isinstance(dyes, Bells):
        return ByAbsorption(dyes.lit_by(lamps.spread_power()))
    return ByLampsToo(ByAbsorption(dyes), lamps)


@dataclass
class ByAbsorption:
    """Draws in proportion to the absorption; in a film, to what each dye by itself would return."""

    dyes: Dyes | Film | Bells

    def draw(
        self, corners: list[Corner], out_nm: Any, choice: Any, u: Any, active: Any
    ) -> tuple[Any, Any]:
        """An incident wavelength (nm) and its density (1/nm), which is 0 where nothing is drawn."""
        parts = [c.weight * self.dyes.drawn_total(c, out_nm, active) for c in corners]
        corner, rest = _chosen(corners, parts, choice)
        nm = self.dyes.draw(corner, out_nm, rest, u, active)
        return nm, self.pdf(corners, nm, out_nm, active)

    def pdf(self, corners: list[Corner], nm: Any, out_nm: Any, active: Any) -> Any:
        """The density of a draw, 1/nm."""
        total, whole = mi.Float(0), mi.Float(0)
        for corner in corners:
            total += corner.weight * self.dyes.drawn_total(corner, out_nm, active)
            whole += corner.weight * self.dyes.reradiation(corner, nm, out_nm, active)[1]
        return dr.select(total > 0, whole / total, 0)


@dataclass
class ByLampsToo:
    """Draws in proportion to the absorption, and some in proportion to the lamps' power."""

    other: ByAbsorption
    lamps: Lamps

    def draw(
        self, corners: list[Corner], out_nm: Any, choice: Any, u: Any, active: Any
    ) -> tuple[Any, Any]:
        """As `ByAbsorption.draw`."""
        follows, lit_nm, rest = self.lamps.draw(choice, u)
        nm, pdf = self.other.draw(corners, out_nm, rest, u, active)
        # A density of 0 means that nothing fluoresces at out_nm.
        is_drawn = pdf > 0
        nm = dr.select(follows, lit_nm, nm)
        pdf = self.lamps.pdf(nm, self.other.pdf(corners, nm, out_nm, active))
        return nm, dr.select(is_drawn, pdf, 0)


def _chosen(corners: list[Corner], parts: list[Any], choice: Any) -> tuple[Corner, Any]:
    """The corner that `choice` selects in proportion to `parts`, and `choice` rescaled to 0 to 1."""
    rest = dr.minimum(choice, _BELOW_ONE) * (parts[0] + parts[1] + parts[2] + parts[3])
    numbers, part = corners[0].numbers, parts[0]
    for corner, next_part in zip(corners[1:], parts[1:], strict=True):
        is_beyond = (rest >= part) & (next_part > 0)
        rest = dr.select(is_beyond, rest - part, rest)
        numbers = dr.select(is_beyond, corner.numbers, numbers)
        part = dr.select(is_beyond, next_part, part)
    share = dr.select(part > 0, dr.clip(rest / part, 0, _BELOW_ONE), 0)
    return Corner(mi.Float(1), corners[0].parabola, numbers), share
