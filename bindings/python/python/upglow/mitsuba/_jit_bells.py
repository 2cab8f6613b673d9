"""The model `analytic` in Dr.Jit. Its formulas: docs/cube-format.md."""

from __future__ import annotations

from typing import Any

from ._host import dr
from ._jit_lookup import Corner

_UNIT_BELL_FWHM = 1.4447034489
"""Full width at half maximum of the cubic B-spline of unit step."""

_PEAK_SCALE = 1.5
"""One over the peak of the B-spline: an absorption is 1 at its peak."""

_NEWTON_STEPS = 3
"""From a start within 0.004, each step squares the error: the third is below rounding."""


class Bells:
    """Absorption and emission of a cube with the model `analytic`, as its header describes it."""

    def __init__(self, model: dict[str, Any]) -> None:
        self._absorption_step_nm = model["absorption_fwhm_nm"] / _UNIT_BELL_FWHM
        self._emission_step_nm = model["emission_fwhm_nm"] / _UNIT_BELL_FWHM
        self._quantum_yield = model["quantum_yield"]
        self._is_photon = model["accounting"] == "photon"

    def absorbed(self, corner: Corner, nm: Any, active: Any) -> Any:
        """Share of the light at nm that a corner absorbs, 0 to 1."""
        u = (nm - corner.numbers.w) / self._absorption_step_nm
        return corner.numbers.y * _PEAK_SCALE * bell(u)

    def reradiation(self, corner: Corner, in_nm: Any, out_nm: Any, active: Any) -> tuple[Any, Any]:
        """Re-radiation of a corner, 1/nm; and the same if no energy were lost to longer waves, in
        proportion to which incident wavelengths are drawn."""
        absorbed = self._quantum_yield * self.absorbed(corner, in_nm, active)
        lossless = absorbed * self._emission(corner, out_nm)
        if not self._is_photon:
            return lossless, lossless
        # Corners that do not fluoresce have a peak of 0, by which nothing may be divided.
        return dr.minimum(in_nm / dr.maximum(corner.numbers.x, 1), 1) * lossless, lossless

    def drawn_total(self, corner: Corner, out_nm: Any, active: Any) -> Any:
        """Integral over incident wavelengths of what they are drawn in proportion to."""
        # Slot z of the numbers is not it: it has the integral after photon losses.
        absorbed_nm = corner.numbers.y * _PEAK_SCALE * self._absorption_step_nm
        return self._quantum_yield * absorbed_nm * self._emission(corner, out_nm)

    def draw(self, corner: Corner, out_nm: Any, choice: Any, u: Any, active: Any) -> Any:
        """An incident wavelength (nm), drawn in proportion to the corner's absorption."""
        return dr.fma(quantile(u), self._absorption_step_nm, corner.numbers.w)

    def _emission(self, corner: Corner, nm: Any) -> Any:
        u = (nm - corner.numbers.x) / self._emission_step_nm
        return bell(u) / self._emission_step_nm


def bell(u: Any) -> Any:
    """The cubic B-spline of unit step and area around 0."""
    v = dr.abs(u)
    tail = dr.maximum(2 - v, 0)
    return dr.select(v < 1, 2 / 3 + v * v * (0.5 * v - 1), tail * tail * tail / 6)


def quantile(u: Any) -> Any:
    """The position below which the share u of the B-spline's area lies."""
    lower = dr.minimum(u, 1 - u)
    y = 0.5 - lower
    # Two terms of the inverse series, and a third fitted to the start of the tail.
    v = y * (1.5 + y * y * (1.6875 + y * y * 7.42))
    for _ in range(_NEWTON_STEPS):
        area = v * (2 / 3 + v * v * (v / 8 - 1 / 3))
        v += (y - area) / dr.maximum(bell(v), 1 / 12)
    v = dr.select(lower > 1 / 24, v, 2 - dr.sqrt(dr.sqrt(24 * lower)))
    return dr.select(u < 0.5, -v, v)
