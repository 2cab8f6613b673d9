"""What evaluation needs of a cube, as arrays for a device."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .._cube import Cube

_UNIT_BELL_FWHM = 1.4447034489
"""Full width at half maximum of the cubic B-spline of unit step (docs/cube-format.md)."""

_Singles = NDArray[np.float32]
_Doubles = NDArray[np.float64]


@dataclass(frozen=True)
class BellArrays:
    """The model `analytic`, beside its nodes."""

    absorption_step_nm: float
    """Knot step of every absorption."""
    emission_step_nm: float
    """Knot step of every emission."""
    quantum_yield: float
    """Share of the absorbed light that comes out."""


@dataclass(frozen=True)
class DyeArrays:
    """The model `dyes`, beside its nodes."""

    is_pooled: bool
    """Whether two dyes are one absorber and one emitter."""
    absorption: _Doubles
    """Share of the light absorbed at concentration 1: ``[dye][nm from 300]``."""
    emission: _Doubles
    """1/nm, likewise."""
    quantum_yield: _Doubles
    """Of each dye."""
    mean_emission_nm: _Doubles
    """Of each dye."""

    def lit_by(self, power: _Doubles) -> DyeArrays:
        """The dyes as they were if their absorption were what they absorb of such light over 1 nm."""
        return replace(self, absorption=self.absorption * power)

    def curves(self) -> _Singles:
        """Absorption, its step to the next nm, emission, its step: ``[dye][nm from 300][4]``."""
        pairs = [(curve[:, :-1], np.diff(curve)) for curve in (self.absorption, self.emission)]
        return _single([*pairs[0], *pairs[1]])

    def absorbed_nm(self) -> _Singles:
        """Integral of the absorption from 300 nm on: ``[dye][nm from 300]``."""
        bins = 0.5 * (self.absorption[:, 1:] + self.absorption[:, :-1])
        return np.pad(np.cumsum(bins, axis=1), ((0, 0), (1, 0))).astype(np.float32)

    def numbers(self) -> _Singles:
        """Quantum yield, mean emission (nm), integral of the absorption (nm), 0: ``[dye][4]``."""
        absorbed = self.absorbed_nm()[:, -1]
        return _single([self.quantum_yield, self.mean_emission_nm, absorbed, 0 * absorbed])


@dataclass(frozen=True)
class NodeArrays:
    """A cube as arrays; nodes are ``[blue][green][red]``, red runs fastest."""

    resolution: int
    """Nodes along each axis."""
    is_photon: bool
    """Whether re-radiation is accounted photon by photon."""
    reflectance: _Singles
    """The first half of the packed layout in docs/cube-format.md: ``[node][4]``."""
    fluorescence: _Singles
    """The second half: ``[node][4]``."""
    shape: DyeArrays | BellArrays | None
    """What the model has beside its nodes; None where nothing fluoresces."""


def node_arrays(cube: Cube) -> NodeArrays:
    """The arrays of a cube."""
    model, packed = cube.header["model"], cube._native.packed_nodes()
    shape: DyeArrays | BellArrays | None = None
    if model["kind"] == "dyes":
        absorption, emission = np.moveaxis(cube.dye_curves, 1, 0)
        yields, means_nm = cube._native.dye_numbers().T
        shape = DyeArrays(model["mixing"] == "pooled", absorption, emission, yields, means_nm)
    elif model["kind"] == "analytic":
        shape = BellArrays(
            absorption_step_nm=model["absorption_fwhm_nm"] / _UNIT_BELL_FWHM,
            emission_step_nm=model["emission_fwhm_nm"] / _UNIT_BELL_FWHM,
            quantum_yield=model["quantum_yield"],
        )
    return NodeArrays(
        resolution=cube.resolution,
        is_photon=model.get("accounting") == "photon",
        reflectance=packed[:, :4],
        fluorescence=packed[:, 4:],
        shape=shape,
    )


def _single(columns: list[NDArray[np.floating]]) -> _Singles:
    return np.ascontiguousarray(np.stack(columns, axis=-1), dtype=np.float32)
