"""Materials in the numbers that cubes store."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

_Change = Callable[[NDArray[Any]], NDArray[Any]]


@dataclass(frozen=True, kw_only=True)
class Materials:
    """An array of materials, each in six numbers at most, which properties name one by one.

    What they mean: docs/cube-format.md. Index it as an array: ``materials[..., 0]``. `Cube` methods
    take it in place of RGB.

    Attributes
    ----------
    reflectance
        `edge_nm`, `level` and `slope_per_nm` as a cube's file has them; float32 (..., 3).
    dye
        Number of the first dye in the ring, from 0; uint8 (...).
    fluorescence
        ``dyes``: `weight`, `concentration`, 0. ``analytic``: `emission_peak_nm`, `stokes_shift_nm`,
        `concentration`. Zeros where nothing fluoresces; float32 (..., 3).
    de2000
        CIEDE2000 of each material against its color, sums over 5 nm; float32 (...).
    model
        ``reflectance``, ``dyes`` or ``analytic``.
    """

    reflectance: NDArray[np.float32]
    dye: NDArray[np.uint8]
    fluorescence: NDArray[np.float32]
    de2000: NDArray[np.float32]
    model: str

    @classmethod
    def _of(cls, arrays: tuple[Any, Any, Any, Any], shape: tuple[int, ...], model: str) -> Materials:
        reflectance, dye, fluorescence, de2000 = arrays
        return cls(
            reflectance=reflectance.reshape(*shape, 3),
            dye=dye.reshape(shape),
            fluorescence=fluorescence.reshape(*shape, 3),
            de2000=de2000.reshape(shape),
            model=model,
        )

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array of materials."""
        return self.dye.shape

    @property
    def edge_nm(self) -> NDArray[np.float32]:
        """Wavelength at which the reflectance is steepest, nm; shape (...)."""
        return self.reflectance[..., 0]

    @property
    def level(self) -> NDArray[np.float32]:
        """The parabola in the sigmoid there; shape (...)."""
        return self.reflectance[..., 1]

    @property
    def slope_per_nm(self) -> NDArray[np.float32]:
        """Slope of the reflectance there, the steepest of all, 1/nm; shape (...)."""
        return self.reflectance[..., 2]

    @property
    def weight(self) -> NDArray[np.float32]:
        """Of ``dyes``: share of the second of the two dyes, 0 to 1; shape (...)."""
        return self._fluorescence("weight", dyes=0)

    @property
    def emission_peak_nm(self) -> NDArray[np.float32]:
        """Of ``analytic``: wavelength of the emission's peak, nm; shape (...)."""
        return self._fluorescence("emission peak", analytic=0)

    @property
    def stokes_shift_nm(self) -> NDArray[np.float32]:
        """Of ``analytic``: distance from the absorption's peak to the emission's, nm; shape (...)."""
        return self._fluorescence("Stokes shift", analytic=1)

    @property
    def concentration(self) -> NDArray[np.float32]:
        """Share of the light at the absorption's peak that is absorbed, 0 to 1; shape (...)."""
        return self._fluorescence("concentration", reflectance=1, dyes=1, analytic=2)

    def _fluorescence(self, name: str, **columns: int) -> NDArray[np.float32]:
        """The column that a number has in each model; ``AttributeError`` in others."""
        if self.model not in columns:
            raise AttributeError(f"materials of the model {self.model} have no {name}")
        return self.fluorescence[..., columns[self.model]]

    def __getitem__(self, index: Any) -> Materials:
        lead = index if isinstance(index, tuple) else (index,)
        has_ellipsis = any(part is Ellipsis for part in lead)
        triple = (*lead, slice(None)) if has_ellipsis else (*lead, Ellipsis, slice(None))
        return self._each(lambda numbers: np.asarray(numbers[index]), lambda rows: rows[triple])

    def broadcast_to(self, shape: tuple[int, ...]) -> Materials:
        """The same materials repeated to a larger shape, by numpy's rules."""
        return self._each(
            lambda numbers: np.broadcast_to(numbers, shape),
            lambda rows: np.broadcast_to(rows, (*shape, 3)),
        )

    def _each(self, of_number: _Change, of_three: _Change) -> Materials:
        """The materials after a change of the arrays with a number, and of those with three."""
        return Materials(
            reflectance=of_three(self.reflectance),
            dye=of_number(self.dye),
            fluorescence=of_three(self.fluorescence),
            de2000=of_number(self.de2000),
            model=self.model,
        )

    def _rows(self) -> tuple[NDArray[np.float32], NDArray[np.uint8], NDArray[np.float32]]:
        return (
            np.ascontiguousarray(self.reflectance, dtype=np.float32).reshape(-1, 3),
            np.ascontiguousarray(self.dye, dtype=np.uint8).reshape(-1),
            np.ascontiguousarray(self.fluorescence, dtype=np.float32).reshape(-1, 3),
        )


class Corners(NamedTuple):
    """The four nodes around each color, whose materials are mixed by weight."""

    nodes: NDArray[np.intp]
    """Blue, green and red index of each node; shape (..., 4, 3)."""
    weights: NDArray[np.float64]
    """Share of each node, 0 to 1, 1 in all; shape (..., 4). Not-a-number outside the cube."""
