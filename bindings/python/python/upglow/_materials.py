"""Materials, as the numbers that cubes store."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

_Change = Callable[[NDArray[Any]], NDArray[Any]]


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class Materials:
    """An array of materials, each of at most six numbers, which the properties return by name.

    Their meaning is defined in docs/cube-format.md. It is indexed as an array is:
    ``materials[..., 0]``. `Cube` methods take it in place of RGB.

    Attributes
    ----------
    reflectance
        `edge_nm`, `level` and `slope_per_nm`; float32 (..., 3).
    dyes
        Numbers of dyes in the set, from 0; uint8 (..., 2). ``dyes``: of the first in the ring, 0.
        ``film``: of both, the denser first; the same twice for a single dye.
    fluorescence
        ``dyes``: `weight`, `concentration`, 0. ``film``: both `densities`, 0. ``analytic``: `emission_peak_nm`, `stokes_shift_nm`,
        `concentration`. Zeros for a material that does not fluoresce; float32 (..., 3).
    de2000
        CIEDE2000 of each material against its color, sums over 5 nm; float32 (...).
    model
        ``reflectance``, ``dyes``, ``film`` or ``analytic``.
    model_id
        Digest of the model with its dyes and rules. A cube of another model refuses the materials, whose
        numbers would mean something else there. ``None`` where it is not known, as for numbers of
        your own.
    """

    reflectance: NDArray[np.float32]
    dyes: NDArray[np.uint8]
    fluorescence: NDArray[np.float32]
    de2000: NDArray[np.float32]
    model: str
    model_id: str | None = None

    @classmethod
    def _of(
        cls, arrays: tuple[Any, Any, Any, Any], shape: tuple[int, ...], model: ModelName
    ) -> Materials:
        names = "reflectance", "dyes", "fluorescence", "de2000"
        numbers = dict(zip(names, arrays, strict=True))
        flat = cls(**numbers, model=model.kind, model_id=model.digest)
        return flat._each(lambda a: a.reshape(shape), lambda a: a.reshape(*shape, a.shape[-1]))

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array of materials."""
        return self.de2000.shape

    @property
    def edge_nm(self) -> NDArray[np.float32]:
        """Wavelength e at which the reflectance is steepest, nm; shape (...)."""
        return self.reflectance[..., 0]

    @property
    def level(self) -> NDArray[np.float32]:
        """Value P at `edge_nm` of the parabola inside the sigmoid; shape (...)."""
        return self.reflectance[..., 1]

    @property
    def slope_per_nm(self) -> NDArray[np.float32]:
        """Slope s of the reflectance at `edge_nm`, its steepest, 1/nm; shape (...)."""
        return self.reflectance[..., 2]

    @property
    def weight(self) -> NDArray[np.float32]:
        """Model ``dyes``: share of the second of the two dyes, 0 to 1; shape (...)."""
        return self._fluorescence("weight", dyes=0)

    @property
    def densities(self) -> NDArray[np.float32]:
        """Model ``film``: optical density of each of the two dyes, 0 to 6; shape (..., 2)."""
        self._fluorescence("optical densities", film=0)
        return self.fluorescence[..., :2]

    @property
    def emission_peak_nm(self) -> NDArray[np.float32]:
        """Model ``analytic``: wavelength of the emission's peak, nm; shape (...)."""
        return self._fluorescence("emission peak", analytic=0)

    @property
    def stokes_shift_nm(self) -> NDArray[np.float32]:
        """Model ``analytic``: emission peak minus absorption peak, nm; shape (...)."""
        return self._fluorescence("Stokes shift", analytic=1)

    @property
    def concentration(self) -> NDArray[np.float32]:
        """Concentration c of what fluoresces, 0 to 1; shape (...)."""
        return self._fluorescence("concentration", reflectance=1, dyes=1, analytic=2)

    @property
    def dose(self) -> NDArray[np.float32]:
        """How much fluoresces: the sum of `densities`, or the `concentration`; shape (...)."""
        if self.model == "film":
            dose: NDArray[np.float32] = self.densities.sum(axis=-1)
            return dose
        return self.concentration

    def _fluorescence(self, name: str, **columns: int) -> NDArray[np.float32]:
        """The column of this number; ``AttributeError`` for models not in ``columns``."""
        if self.model not in columns:
            raise AttributeError(f"materials of the model {self.model} have no {name}")
        return self.fluorescence[..., columns[self.model]]

    def __getitem__(self, index: Any) -> Materials:
        lead = index if isinstance(index, tuple) else (index,)
        has_ellipsis = any(part is Ellipsis for part in lead)
        triple = (*lead, slice(None)) if has_ellipsis else (*lead, Ellipsis, slice(None))
        return self._each(lambda numbers: np.asarray(numbers[index]), lambda rows: rows[triple])

    def broadcast_to(self, shape: tuple[int, ...]) -> Materials:
        """The same materials, broadcast to a larger shape by numpy's rules."""
        return self._each(
            lambda numbers: np.broadcast_to(numbers, shape),
            lambda rows: np.broadcast_to(rows, (*shape, rows.shape[-1])),
        )

    def _each(self, of_number: _Change, of_rows: _Change) -> Materials:
        """A copy with a change applied to the array of shape (...), and one to those of (..., n)."""
        return replace(
            self,
            reflectance=of_rows(self.reflectance),
            dyes=of_rows(self.dyes),
            fluorescence=of_rows(self.fluorescence),
            de2000=of_number(self.de2000),
        )

    def __eq__(self, other: object) -> bool:
        """Whether both are the same array of materials of the same model."""
        if not isinstance(other, Materials):
            return NotImplemented
        mine, theirs = vars(self), vars(other)
        return all(np.array_equal(mine[name], theirs[name]) for name in mine)

    def __repr__(self) -> str:
        return f"Materials({self.model}, shape {self.shape})"

    def _rows(
        self, model: ModelName
    ) -> tuple[NDArray[np.float32], NDArray[np.uint8], NDArray[np.float32]]:
        """One row for each material, for a cube of this model."""
        if self.model != model.kind or self.model_id not in (None, model.digest):
            found = ModelName(self.model, self.model_id)
            raise ValueError(f"materials of another cube: their model is {found}, expected {model}")
        return (
            np.ascontiguousarray(self.reflectance, dtype=np.float32).reshape(-1, 3),
            np.ascontiguousarray(self.dyes, dtype=np.uint8).reshape(-1, 2),
            np.ascontiguousarray(self.fluorescence, dtype=np.float32).reshape(-1, 3),
        )


class ModelName(NamedTuple):
    """What tells the model of a cube from all others."""

    kind: str
    digest: str | None

    def __str__(self) -> str:
        return f"{self.kind} {self.digest[:8]}" if self.digest else self.kind


class Corners(NamedTuple):
    """The four nodes around each color, and the weights that their materials are mixed by."""

    nodes: NDArray[np.intp]
    """Blue, green and red index of each node; shape (..., 4, 3)."""
    weights: NDArray[np.float64]
    """Weight of each node, 0 to 1, adding up to 1; shape (..., 4). NaN outside the cube."""
