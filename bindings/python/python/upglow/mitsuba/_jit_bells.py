"""Bells, the model `analytic`, in Dr.Jit. Their form: docs/cube-format.md."""

from __future__ import annotations

from typing import Any

from ._host import dr
from ._jit_lookup import Corner
from ._node_arrays import BellArrays

_PEAK_SCALE = 1.5
"""One over the peak of the bell: an absorption is 1 at its peak."""

_NEWTON_STEPS = 3
"""From a start within 0.004, each step squares the error: the third is below rounding."""


class Bells:
    """The bells of a cube."""

    def __init__(self, arrays: BellArrays, is_photon: bool) -> None:
        self._arrays, self._is_photon = arrays, is_photon
        self._quantum_yield = arrays.quantum_yield

    def absorbed(self, corner: Corner, nm: Any, active: Any) -> Any:
        """Share of the light at nm that a corner absorbs, 0 to 1."""
        u = (nm - corner.numbers.w) / self._arrays.absorption_step_nm
        return corner.numbers.y * _PEAK_SCALE * bell(u)

    def returned(self, corner: Corner, nm: Any, active: Any) -> Any:
        """Share of the light at nm that a corner gives back by fluorescence, 0 to 1."""
        share = self._quantum_yield * self._share(nm, corner)
        return share * self.absorbed(corner, nm, active)

    def moved(self, corner: Corner, in_nm: Any, out_nm: Any, active: Any) -> tuple[Any, Any]:
        """What a corner moves from one wavelength to another, 1/nm; and if no energy were lost."""
        absorbed = self._quantum_yield * self.absorbed(corner, in_nm, active)
        whole = absorbed * self._emission(corner, out_nm)
        return self._share(in_nm, corner) * whole, whole

    def leaving(self, corner: Corner, out_nm: Any, active: Any) -> Any:
        """What leaves at out_nm of light that is 1 everywhere, were no energy lost."""
        # Slot z of the numbers has the integral with what photons lose.
        absorbed_nm = corner.numbers.y * _PEAK_SCALE * self._arrays.absorption_step_nm
        return self._quantum_yield * absorbed_nm * self._emission(corner, out_nm)

    def draw(self, corner: Corner, out_nm: Any, choice: Any, u: Any, active: Any) -> Any:
        """An incident wavelength (nm) with the density of what a corner absorbs."""
        return dr.fma(quantile(u), self._arrays.absorption_step_nm, corner.numbers.w)

    def _emission(self, corner: Corner, nm: Any) -> Any:
        step_nm = self._arrays.emission_step_nm
        return bell((nm - corner.numbers.x) / step_nm) / step_nm

    def _share(self, nm: Any, corner: Corner) -> Any:
        # Corners that do not fluoresce have no peak: nothing may be divided by it.
        return dr.minimum(nm / dr.maximum(corner.numbers.x, 1), 1) if self._is_photon else 1


def bell(u: Any) -> Any:
    """The cubic B-spline of unit step and area around 0."""
    v = dr.abs(u)
    tail = dr.maximum(2 - v, 0)
    return dr.select(v < 1, 2 / 3 + v * v * (0.5 * v - 1), tail * tail * tail / 6)


def quantile(u: Any) -> Any:
    """The place below which u of the bell's area lies."""
    lower = dr.minimum(u, 1 - u)
    y = 0.5 - lower
    # Two terms of the inverse series, and a third that is right where the tail begins.
    v = y * (1.5 + y * y * (1.6875 + y * y * 7.42))
    for _ in range(_NEWTON_STEPS):
        area = v * (2 / 3 + v * v * (v / 8 - 1 / 3))
        v += (y - area) / dr.maximum(bell(v), 1 / 12)
    v = dr.select(lower > 1 / 24, v, 2 - dr.sqrt(dr.sqrt(24 * lower)))
    return dr.select(u < 0.5, -v, v)
