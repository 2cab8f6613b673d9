"""A cube in Dr.Jit: what its materials reflect and re-radiate, and draws of wavelengths.

Wavelengths are arrays of type `mi.Float`, or spectra of such, in nm. Results are theirs in kind. Colors
are linear, in the cube's RGB space; components count as the nearer end of 0 to 1.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .._cube import Cube
from ._host import dr, mi, spectrum_of
from ._jit_bells import Bells
from ._jit_dyes import Dyes
from ._jit_guide import Guide, guide
from ._jit_lookup import Corner, Lattice
from ._lamps import Lamps
from ._node_arrays import DyeArrays, node_arrays

Fluorescence = Callable[..., tuple[Any, Any]]
"""Takes a color, wavelengths, two numbers and a mask; see `JitCube.fluorescence`."""


class JitCube:
    """A cube in the memory of the variant's device."""

    def __init__(self, cube: Cube) -> None:
        arrays = node_arrays(cube)
        self._lattice = Lattice(arrays)
        self._dyes: Dyes | Bells | None = None
        if isinstance(arrays.shape, DyeArrays):
            self._dyes = Dyes(arrays.shape, arrays.is_photon)
        elif arrays.shape is not None:
            self._dyes = Bells(arrays.shape, arrays.is_photon)

    @property
    def is_fluorescent(self) -> bool:
        """Whether any material may fluoresce."""
        return self._dyes is not None

    def reflectance(self, color: Any, nm: Any, active: Any = True) -> Any:
        """Share of the light at nm that is reflected at the same wavelength, 0 to 1."""
        corners = self._lattice.look_up(color, active)
        return _each(lambda at: self._reflected(corners, at, active), nm)

    def albedo(self, color: Any, nm: Any, active: Any = True) -> Any:
        """Share of the light at nm that comes out at any wavelength, 0 to 1."""
        corners = self._lattice.look_up(color, active)

        def at(nm: Any) -> Any:
            total = self._reflected(corners, nm, active)
            if self._dyes is not None:
                for corner in corners:
                    total += corner.weight * self._dyes.returned(corner, nm, active)
            return dr.minimum(total, 1)

        return _each(at, nm)

    def reradiation(self, color: Any, in_nm: Any, out_nm: Any, active: Any = True) -> Any:
        """Energy that leaves per nm at out_nm by fluorescence, per unit that came at in_nm; 1/nm."""
        corners = self._lattice.look_up(color, active)
        return _each(lambda i, o: self._moved(corners, i, o, active), in_nm, out_nm)

    def fluorescence(self, lamps: Lamps | None = None) -> Fluorescence:
        """Draws of the wavelength of light that comes in, of what leaves by fluorescence.

        The function takes a color, the wavelengths (nm) that leave, two independent numbers in 0 to
        1, and a mask. It returns the throughput and the wavelength that comes in; 0 and the one that
        leaves where nothing fluoresces. Over the two numbers, the mean of the throughput times light
        at the wavelength is the integral of the re-radiation times that light.

        Draws follow what is absorbed of the light of the `lamps`, or of any light.
        """
        draws = None if self._dyes is None else guide(self._dyes, lamps)

        def drawn(color: Any, out_nm: Any, choice: Any, u: Any, active: Any = True) -> Any:
            if draws is None:
                return 0 * out_nm, out_nm
            corners = self._lattice.look_up(color, active)
            if dr.depth_v(out_nm) == 1:
                return self._drawn(draws, corners, out_nm, choice, u, active)
            # Shifted copies of one draw: alike for each wavelength, and spread over the wavelengths.
            count = len(out_nm)
            each = []
            for i in range(count):
                numbers = _shifted(choice, i, count), _shifted(u, i, count)
                each.append(self._drawn(draws, corners, out_nm[i], *numbers, active))
            return spectrum_of([one[0] for one in each]), spectrum_of([one[1] for one in each])

        return drawn

    def _drawn(
        self, draws: Guide, corners: list[Corner], out_nm: Any, choice: Any, u: Any, active: Any
    ) -> tuple[Any, Any]:
        with dr.suspend_grad():
            nm, pdf = draws.draw(corners, out_nm, choice, u, active)
        moved = self._moved(corners, nm, out_nm, active)
        is_drawn = pdf > 0
        return dr.select(is_drawn, moved / pdf, 0), dr.select(is_drawn, nm, out_nm)

    def _reflected(self, corners: list[Corner], nm: Any, active: Any) -> Any:
        total = mi.Float(0)
        for corner in corners:
            d = nm - corner.parabola.x
            x = dr.fma(d, dr.fma(d, corner.parabola.w, corner.parabola.z), corner.parabola.y)
            part = corner.weight * dr.fma(0.5, x * dr.rsqrt(dr.fma(x, x, 1)), 0.5)
            if self._dyes is not None:
                part *= 1 - self._dyes.absorbed(corner, nm, active)
            total += part
        return dr.clip(total, 0, 1)

    def _moved(self, corners: list[Corner], in_nm: Any, out_nm: Any, active: Any) -> Any:
        total = mi.Float(0)
        if self._dyes is not None:
            for corner in corners:
                total += corner.weight * self._dyes.moved(corner, in_nm, out_nm, active)[0]
        return total


def _each(function: Callable[..., Any], *nm: Any) -> Any:
    """A function of wavelengths, for each of the wavelengths of a spectrum."""
    if dr.depth_v(nm[0]) == 1:
        return function(*nm)
    return spectrum_of([function(*one) for one in zip(*nm, strict=True)])


def _shifted(u: Any, step: int, steps: int) -> Any:
    moved = u + step / steps
    return dr.select(moved >= 1, moved - 1, moved)
