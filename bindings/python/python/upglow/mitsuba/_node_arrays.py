"""What a cube's file holds, in the numbers that evaluation needs, as arrays for a device."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._cube import Cube
from .._materials import Materials
from .._wavelengths import FINE_NM

_UNIT_BELL_FWHM = 1.4447034489
"""Full width at half maximum of the cubic B-spline of unit step (docs/cube-format.md)."""

_PEAK_SCALE = 1.5
"""One over the peak of the bell: an absorption is 1 at its peak."""

_Singles = NDArray[np.float32]
_Doubles = NDArray[np.float64]


@dataclass(frozen=True)
class Bells:
    """The model `analytic`, beside its nodes."""

    absorption_step_nm: float
    """Knot step of every absorption."""
    emission_step_nm: float
    """Knot step of every emission."""


@dataclass(frozen=True)
class DyeArrays:
    """The model `dyes`, beside its nodes."""

    is_pooled: bool
    """Whether two dyes are one absorber and one emitter."""
    count: int
    """Dyes in the ring."""
    curves: _Singles
    """Absorption, its step to the next nm, emission (1/nm), its step: ``[dye][nm from 300][4]``."""
    absorbed_nm: _Singles
    """Integral of the absorption from 300 nm on: ``[dye][nm from 300]``."""
    numbers: _Singles
    """Quantum yield, mean emission (nm), integral of the absorption (nm), 0: ``[dye][4]``."""


@dataclass(frozen=True)
class NodeArrays:
    """A cube as arrays; nodes are ``[blue][green][red]``, red runs fastest."""

    resolution: int
    """Nodes along each axis."""
    is_photon: bool
    """Whether re-radiation is accounted photon by photon."""
    parabola: _Singles
    """Edge (nm), and the coefficients of 1, d and d² at the distance d from it: ``[node][4]``."""
    fluorescence: _Singles
    """``[node][4]``. Dyes: share of the second, concentration, 0, number of the first.

    Bells: emission peak (nm), concentration, what comes back of light that is 1 at every wavelength
    if no energy is lost (nm), absorption peak (nm).
    """
    shape: DyeArrays | Bells | None
    """What the model has beside its nodes; None where nothing fluoresces."""


def node_arrays(cube: Cube) -> NodeArrays:
    """The arrays of a cube."""
    nodes = cube.nodes[...]
    model = cube.header["model"]
    shape: DyeArrays | Bells | None = None
    fluorescence = np.zeros((1, 4), np.float32)
    if model["kind"] == "dyes":
        shape = _dye_arrays(cube)
        fluorescence = _dye_nodes(nodes)
    elif model["kind"] == "analytic":
        shape = Bells(
            absorption_step_nm=model["absorption_fwhm_nm"] / _UNIT_BELL_FWHM,
            emission_step_nm=model["emission_fwhm_nm"] / _UNIT_BELL_FWHM,
        )
        carried = model["quantum_yield"] * _PEAK_SCALE * shape.absorption_step_nm
        fluorescence = _bell_nodes(nodes, carried)
    return NodeArrays(
        resolution=cube.resolution,
        is_photon=model.get("accounting") == "photon",
        parabola=_parabolas(nodes),
        fluorescence=fluorescence,
        shape=shape,
    )


def _parabolas(nodes: Materials) -> _Singles:
    edge, level, slope = np.moveaxis(nodes.reflectance.reshape(-1, 3).astype(np.float64), 1, 0)
    t = 1 + level**2
    return _single([edge, level, 2 * slope * t**1.5, 6 * slope**2 * level * t**2])


def _bell_nodes(nodes: Materials, carried_nm: float) -> _Singles:
    rows = nodes.fluorescence.reshape(-1, 3).astype(np.float64)
    peak, stokes_shift, concentration = np.moveaxis(rows, 1, 0)
    return _single([peak, concentration, concentration * carried_nm, peak - stokes_shift])


def _dye_nodes(nodes: Materials) -> _Singles:
    weight, concentration, _ = np.moveaxis(
        nodes.fluorescence.reshape(-1, 3).astype(np.float64), 1, 0
    )
    return _single([weight, concentration, 0 * weight, nodes.dye.reshape(-1).astype(np.float64)])


def _dye_arrays(cube: Cube) -> DyeArrays:
    absorption, emission = np.moveaxis(cube.dye_curves, 1, 0)
    model = cube.header["model"]
    return _with_absorption(
        absorption,
        emission,
        _quantum_yields(model),
        emission @ FINE_NM,
        model["mixing"] == "pooled",
    )


def lit_by(dyes: DyeArrays, power: _Doubles) -> DyeArrays:
    """The dyes as they were if their absorption were what they absorb of such light over 1 nm."""
    first, step, emission, emission_step = np.moveaxis(dyes.curves.astype(np.float64), 2, 0)
    quantum_yield, mean_nm, _, _ = np.moveaxis(dyes.numbers.astype(np.float64), 1, 0)
    absorption = np.concatenate([first, (first + step)[:, -1:]], axis=1)
    emission = np.concatenate([emission, (emission + emission_step)[:, -1:]], axis=1)
    return _with_absorption(absorption * power, emission, quantum_yield, mean_nm, dyes.is_pooled)


def _with_absorption(
    absorption: _Doubles,
    emission: _Doubles,
    quantum_yield: _Doubles,
    mean_nm: _Doubles,
    is_pooled: bool,
) -> DyeArrays:
    steps = [np.diff(curve, axis=1) for curve in (absorption, emission)]
    curves = np.stack([absorption[:, :-1], steps[0], emission[:, :-1], steps[1]], axis=-1)
    bins = 0.5 * (absorption[:, 1:] + absorption[:, :-1])
    integral = np.concatenate([np.zeros((len(bins), 1)), np.cumsum(bins, axis=1)], axis=1)
    return DyeArrays(
        is_pooled=is_pooled,
        count=len(absorption),
        curves=curves.astype(np.float32),
        absorbed_nm=integral.astype(np.float32),
        numbers=_single([quantum_yield, mean_nm, integral[:, -1], 0 * mean_nm]),
    )


def _quantum_yields(model: dict[str, object]) -> _Doubles:
    dyes: list[dict[str, float | None]] = model["dyes"]  # type: ignore[assignment]
    told = model["quantum_yield"]
    if told != "measured":
        return np.full(len(dyes), float(str(told)))
    # Where no yield is published, it counts as 1 (docs/cube-format.md).
    published = (dye["measured_quantum_yield"] for dye in dyes)
    return np.array([1.0 if value is None else value for value in published])


def _single(columns: list[_Doubles]) -> _Singles:
    return np.ascontiguousarray(np.stack(columns, axis=-1), dtype=np.float32)
