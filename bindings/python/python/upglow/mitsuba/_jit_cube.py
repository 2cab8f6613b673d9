"""A cube in Dr.Jit: reflectance and re-radiation of its materials, and draws of wavelengths.

Wavelengths (nm) are arrays of type `mi.Float`, or spectra of them; results have the same type. Colors
are linear, in the cube's RGB space, and their components are clamped to 0 to 1.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .._cube import Cube
from ._host import dr, mi, spectrum_of
from ._jit_bells import Bells
from ._jit_dyes import Dyes
from ._jit_film import Film
from ._jit_guide import ByAbsorption, ByLampsToo, guide
from ._jit_lookup import Corner, Lattice
from ._lamps import Lamps

Fluorescence = Callable[..., tuple[Any, Any]]
"""Takes a color, wavelengths, two numbers and a mask; see `JitCube.fluorescence`."""


class JitCube:
    """A cube in the memory of the variant's device."""

    def __init__(self, cube: Cube) -> None:
        model, packed = cube.header["model"], cube._native.packed_nodes()
        self._dyes: Dyes | Film | Bells | None = None
        if model["kind"] == "dyes":
            self._dyes = Dyes.of(cube)
        elif model["kind"] == "film":
            self._dyes = Film.of(cube)
        elif model["kind"] == "analytic":
            self._dyes = Bells(model)
        self._lattice = Lattice(cube.resolution, packed, self._dyes is not None)

    @property
    def is_fluorescent(self) -> bool:
        """Whether any material may fluoresce."""
        return self._dyes is not None

    def reflectance(self, color: Any, nm: Any, active: Any = True) -> Any:
        """Share of the light at nm that is reflected at the same wavelength, 0 to 1."""
        corners = self._lattice.look_up(color, active)
        return _each(lambda at: self._reflectance(corners, at, active), nm)

    def reradiation(self, color: Any, in_nm: Any, out_nm: Any, active: Any = True) -> Any:
        """Energy re-radiated per nm at out_nm, per unit of energy incident at in_nm; 1/nm."""
        corners = self._lattice.look_up(color, active)
        return _each(lambda i, o: self._reradiation(corners, i, o, active), in_nm, out_nm)

    def fluorescence(self, lamps: Lamps | None = None) -> Fluorescence:
        """A function that draws the incident wavelength of light that leaves by fluorescence.

        It takes a color, the wavelengths (nm) that leave, two independent numbers in 0 to 1, and a
        mask. It returns throughput and incident wavelength; where nothing fluoresces, 0 and the
        wavelength that leaves. The expected value of the throughput times the light at the drawn
        wavelength is the integral of the re-radiation times that light.

        Draws follow the absorption of light from the `lamps`, or of any light.
        """
        draws = None if self._dyes is None else guide(self._dyes, lamps)

        def drawn(color: Any, out_nm: Any, choice: Any, u: Any, active: Any = True) -> Any:
            if draws is None:
                return 0 * out_nm, out_nm
            corners = self._lattice.look_up(color, active)
            if dr.depth_v(out_nm) == 1:
                return self._drawn(draws, corners, out_nm, choice, u, active)
            # Shifted copies of two numbers: each is uniform, and together they are spread evenly.
            count = len(out_nm)
            each = []
            for i in range(count):
                numbers = _shifted(choice, i, count), _shifted(u, i, count)
                each.append(self._drawn(draws, corners, out_nm[i], *numbers, active))
            return spectrum_of([one[0] for one in each]), spectrum_of([one[1] for one in each])

        return drawn

    def _drawn(
        self,
        draws: ByAbsorption | ByLampsToo,
        corners: list[Corner],
        out_nm: Any,
        choice: Any,
        u: Any,
        active: Any,
    ) -> tuple[Any, Any]:
        with dr.suspend_grad():
            nm, pdf = draws.draw(corners, out_nm, choice, u, active)
        reradiated = self._reradiation(corners, nm, out_nm, active)
        is_drawn = pdf > 0
        return dr.select(is_drawn, reradiated / pdf, 0), dr.select(is_drawn, nm, out_nm)

    def _reflectance(self, corners: list[Corner], nm: Any, active: Any) -> Any:
        total = mi.Float(0)
        for corner in corners:
            d = nm - corner.parabola.x
            x = dr.fma(d, dr.fma(d, corner.parabola.w, corner.parabola.z), corner.parabola.y)
            part = corner.weight * dr.fma(0.5, x * dr.rsqrt(dr.fma(x, x, 1)), 0.5)
            if self._dyes is not None:
                part *= 1 - self._dyes.absorbed(corner, nm, active)
            total += part
        return dr.clip(total, 0, 1)

    def _reradiation(self, corners: list[Corner], in_nm: Any, out_nm: Any, active: Any) -> Any:
        total = mi.Float(0)
        if self._dyes is not None:
            for corner in corners:
                total += corner.weight * self._dyes.reradiation(corner, in_nm, out_nm, active)[0]
        return total


def _each(function: Callable[..., Any], *nm: Any) -> Any:
    """A function of wavelengths, for each of the wavelengths of a spectrum."""
    if dr.depth_v(nm[0]) == 1:
        return function(*nm)
    return spectrum_of([function(*one) for one in zip(*nm, strict=True)])


def _shifted(u: Any, step: int, steps: int) -> Any:
    moved = u + step / steps
    return dr.select(moved >= 1, moved - 1, moved)
