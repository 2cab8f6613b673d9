"""The numbers behind the figures that ``upglow-study`` draws, as arrays, for any cube or contract.

    >>> import upglow
    >>> from upglow import figures
    >>> diagram = figures.chromaticity(upglow.Contract(space="rec2020"))
    >>> diagram.locus_xy.shape
    (311, 2)

With matplotlib, figure 10a is ``plt.pcolormesh(f.red, f.green, f.kind[0])`` of
``f = figures.reachability(blue=0.0)``, and the diagram is ``plt.plot(*diagram.locus_xy.T)``.

======================  ====================================================================
function                figures of ``upglow-study figures``
======================  ====================================================================
`chromaticity`          the diagram of 1e, 1f and 2a: spectral locus, primaries, white
`node_colors`           1e, 1f: colors of all nodes, and their errors for a histogram
`dyes`                  2: spectra of dyes, and the chromaticities of their emissions
`layer`                 1, 3, 6, 7: a layer of nodes; 8, 9: colors between them, and errors
`mixed_reflectances`    5: reflectances interpolated between two
`reachability`          10: which colors of a space some material can reproduce
`color_solid`           none: the surface of the solid of these colors, in XYZ and CIELAB
======================  ====================================================================

Figure 4 is a sketch of three numbers and has no data. The colors are linear RGB in the cube's space;
converting them for a display is up to the caller. ``threads`` is a number of threads, by default one
per core; no result depends on it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _upglow
from ._contract import Contract
from ._cube import Cube
from ._kinds import instance, real, whole
from ._models import Dyes
from ._observer import Observer
from ._standing import standing
from ._wavelengths import FINE_NM

__all__ = [
    "KONIG_2020",
    "ChromaticityDiagram",
    "ColorSolid",
    "DyeSpectra",
    "Layer",
    "NodeColors",
    "Reachability",
    "chromaticity",
    "color_solid",
    "dyes",
    "layer",
    "mixed_reflectances",
    "node_colors",
    "reachability",
]

_MOST_POINTS = 2048
"""Most points along an axis: more would fill the memory, and are a typing error."""


class ChromaticityDiagram(NamedTuple):
    """The fixed parts of a chromaticity diagram: spectral locus, primaries and white."""

    locus_nm: NDArray[np.float64]
    """Wavelengths of the spectral locus, nm; shape (n,)."""
    locus_xy: NDArray[np.float64]
    """Chromaticities there, for the contract's observer; shape (n, 2)."""
    primaries_xy: NDArray[np.float64]
    """Chromaticities of the space's red, green and blue; shape (3, 2)."""
    white_xy: NDArray[np.float64]
    """Chromaticity of the perfect diffuser under the light, sums over 1 nm; shape (2,)."""


def chromaticity(contract: Contract | None = None) -> ChromaticityDiagram:
    """Spectral locus (390 to 700 nm by 1 nm), primaries and white; by default of ACEScg under D65."""
    nm, locus, primaries, white = _upglow.chromaticity_diagram(Contract._or_default(contract)._native)
    return ChromaticityDiagram(nm, locus, primaries, white[0])


class NodeColors(NamedTuple):
    """The colors of a cube's nodes, ``[blue][green][red]``."""

    rgb: NDArray[np.float64]
    """Linear RGB that each node stands for; shape (n, n, n, 3)."""
    xyz: NDArray[np.float64]
    """XYZ of its material, sums over 5 nm; shape (n, n, n, 3)."""
    xy: NDArray[np.float64]
    """Chromaticity of the same; NaN for black; shape (n, n, n, 2)."""
    de2000: NDArray[np.float32]
    """CIEDE2000 between `rgb` and `xyz`, as the cube stores it; shape (n, n, n)."""

    def bright_xy(self, least: float = 1.5) -> NDArray[np.float64]:
        """Chromaticities of the colors with X + Y + Z of at least ``least``; shape (k, 2).

        With 1.5 they are the dots of figures 1e and 1f.
        """
        chosen: NDArray[np.float64] = self.xy[self.xyz.sum(axis=-1) >= least]
        return chosen


def node_colors(cube: Cube, *, threads: int | None = None) -> NodeColors:
    """The color of every node's material, and the color that it stands for.

    ``numpy.histogram(figures.node_colors(cube).de2000)`` is the distribution of its errors.
    """
    n = instance("cube", cube, Cube).resolution
    xyz, xy = _upglow.node_colors(cube._native, threads)
    axis = np.linspace(0.0, 1.0, n)
    blue, green, red = np.meshgrid(axis, axis, axis, indexing="ij")
    return NodeColors(
        np.stack([red, green, blue], axis=-1),
        xyz.reshape(n, n, n, 3),
        xy.reshape(n, n, n, 2),
        cube.nodes.de2000,
    )


class Layer(NamedTuple):
    """The colors that a cube's materials have at one blue."""

    blue: float
    """Blue, 0 to 1."""
    axis: NDArray[np.float64]
    """Red of the columns and green of the rows, 0 to 1; shape (side,)."""
    rgb: NDArray[np.float64]
    """Linear RGB of the materials, ``[green][red]``; any finite numbers; shape (side, side, 3)."""
    de2000: NDArray[np.float64]
    """CIEDE2000 to the color that each material stands for, sums over 5 nm; shape (side, side)."""
    has_exact_nodes: NDArray[np.bool_]
    """Whether all nodes that are mixed match their colors within 0.01; shape (side, side)."""


def layer(
    cube: Cube,
    blue: float,
    *,
    side: int | None = None,
    interpolation: str = "blend",
    threads: int | None = None,
) -> Layer:
    """The colors of a cube's materials at one blue, and their errors.

    Parameters
    ----------
    cube
        The cube.
    blue
        Blue, 0 to 1. Without ``side``, the nearest layer of nodes is used.
    side
        Colors along red and along green, 2 to 2048; by default the nodes themselves.
    interpolation
        How nodes are interpolated: ``blend`` (ours), or ``none``, ``coefficients``, ``features`` and
        ``hybrid`` of König et al. It has no effect without ``side``.

    Raises
    ------
    ValueError
        If a number is out of range or the interpolation is unknown.
    """
    colors = None if side is None else whole("side", side)
    native = _upglow.layer(
        instance("cube", cube, Cube)._native, real("blue", blue), colors, interpolation, threads
    )
    at, rgb, de2000, has_exact_nodes = native
    count = colors or cube.resolution
    square = (count, count)
    return Layer(
        at,
        np.linspace(0.0, 1.0, count),
        rgb.reshape(*square, 3),
        de2000.reshape(square),
        has_exact_nodes.reshape(square),
    )


KONIG_2020 = Dyes(
    set="konig8", accounting="energy", mixing="pooled", quantum_yield=1.0, optical_density=None
)
"""The dyes of König et al. 2020: thin solutions that give back all absorbed energy."""


class DyeSpectra(NamedTuple):
    """Dyes in ring order."""

    names: list[str]
    """The dyes' names."""
    nm: NDArray[np.float64]
    """``upglow.FINE_NM``."""
    absorption: NDArray[np.float64]
    """Share of the light absorbed at full concentration, 0 to 1; shape (dyes, 531)."""
    emission: NDArray[np.float64]
    """Emission of unit area, 1/nm; shape (dyes, 531)."""
    absorption_peak_nm: NDArray[np.float64]
    """Wavelength of the absorption's peak, nm; shape (dyes,)."""
    emission_peak_nm: NDArray[np.float64]
    """Wavelength of the emission's peak, nm; shape (dyes,)."""
    emission_xy: NDArray[np.float64]
    """Chromaticity of the emission, without reflected light; shape (dyes, 2)."""


def dyes(source: Dyes | Cube | None = None, *, observer: Any = None) -> DyeSpectra:
    """Spectra of the dyes of a model or of a cube, and chromaticities of their emissions.

    Parameters
    ----------
    source
        `Dyes`, by default those of König et al. 2020, or a `Cube` with dyes.
    observer
        An `Observer`, or what one is made from; by default the cube's, or CIE 1931 2°.

    Raises
    ------
    ValueError
        If the cube has no dyes.
    """
    if isinstance(source, Cube):
        native, own = source._native.model(), source.contract.observer
    else:
        model = KONIG_2020 if source is None else instance("source", source, Dyes, "Dyes or a Cube")
        native, own = model._native(), Observer("cie-1931-2deg")
    seen_by = own if observer is None else Observer(observer)
    names, absorption, emission, peaks, xy = _upglow.dye_spectra(native, seen_by._native)
    return DyeSpectra(names, FINE_NM, absorption, emission, peaks[:, 0], peaks[:, 1], xy)


class Reachability(NamedTuple):
    """What kind of material can reproduce the colors of layers of a space."""

    blue: NDArray[np.float64]
    """Blue of each layer, 0 to 1; shape (layers,)."""
    axis: NDArray[np.float64]
    """Red of the columns and green of the rows, 0 to 1; shape (side,)."""
    kind: NDArray[np.uint8]
    """An `upglow.Kind` for each color, ``[layer][green][red]``; shape (layers, side, side)."""

    def shares(self) -> NDArray[np.float64]:
        """Share of each `upglow.Kind` in each layer; shape (layers, 3)."""
        return np.stack([(self.kind == kind).mean(axis=(1, 2)) for kind in range(3)], axis=-1)


def reachability(
    contract: Contract | None = None,
    *,
    blue: ArrayLike | None = None,
    side: int = 32,
    threads: int | None = None,
) -> Reachability:
    """Which colors of a space some material can reproduce: the limit of physics, not of a fit.

    For each color the kind that `upglow.standing` finds, in layers of constant blue.

    Parameters
    ----------
    contract
        What RGB means; ACEScg under D65 by default.
    blue
        Blue of the layers, 0 to 1; by default ``side`` layers from 0 to 1.
    side
        Colors along red and along green, 2 to 2048.
    """
    if not 2 <= side <= _MOST_POINTS:
        raise ValueError(f"side is {side}, expected 2 to {_MOST_POINTS}")
    axis = np.linspace(0.0, 1.0, side)
    blues = axis if blue is None else np.asarray(blue, dtype=np.float64).ravel()
    layers = []
    for each in blues.tolist():
        if not 0 <= each <= 1:
            raise ValueError(f"blue is {each:g}, expected 0 to 1")
        rgb = np.stack([*np.meshgrid(axis, axis), np.full((side, side), each)], axis=-1)
        layers.append(standing(rgb, contract, threads=threads).kind)
    return Reachability(blues, axis, np.stack(layers))


class ColorSolid(NamedTuple):
    """The surface of a color solid: rows from pole to pole, columns around; closed."""

    xyz: NDArray[np.float64]
    """XYZ; Y = 1 is the perfect diffuser; shape (steps + 1, 2·steps + 1, 3)."""
    lab: NDArray[np.float64]
    """CIELAB relative to the perfect diffuser; the same shape."""


def color_solid(
    contract: Contract | None = None,
    *,
    materials: str = "reflectance",
    steps: int = 32,
    threads: int | None = None,
) -> ColorSolid:
    """The surface of the solid of all colors that materials can have under the contract's light.

    Each point is the color furthest in one direction of XYZ. To plot it:
    ``axes.plot_surface(*numpy.moveaxis(solid.xyz, -1, 0))``.

    Parameters
    ----------
    contract
        Light and observer; D65 and CIE 1931 2° by default.
    materials
        ``reflectance``: MacAdam's solid. ``fluorescence``: at most one photon is re-emitted per
        photon absorbed, at no shorter wavelength.
    steps
        Steps from pole to pole, 2 to 2048; twice as many around.
    """
    native = Contract._or_default(contract)._native
    xyz, lab = _upglow.solid_surface(native, materials, whole("steps", steps), threads)
    shape = (steps + 1, 2 * steps + 1, 3)
    return ColorSolid(xyz.reshape(shape), lab.reshape(shape))


def mixed_reflectances(
    first: Sequence[float],
    second: Sequence[float],
    *,
    mixing: str = "spectra",
    shares: ArrayLike = (0.0, 0.25, 0.5, 0.75, 1.0),
) -> NDArray[np.float64]:
    """Reflectances interpolated between two, over ``upglow.FINE_NM``.

    Parameters
    ----------
    first, second
        Shift (nm), width (nm, > 0) and slope (1/nm, not 0) of each; figure 5 has
        (450, 45, -0.009) and (620, 60, -0.008).
    mixing
        What is interpolated: ``coefficients`` of the polynomial, ``spectra``, or ``features`` (shift,
        width and slope).
    shares
        Shares of the second, 0 to 1; shape (n,).

    Returns
    -------
    float64 array of shape (n, 531)
    """
    weights = np.atleast_1d(np.asarray(shares, dtype=np.float64))
    if weights.ndim != 1 or not ((weights >= 0) & (weights <= 1)).all():
        raise ValueError(f"shares is {shares!r}, expected numbers from 0 to 1 of shape (n,)")
    ends = [[float(v) for v in end] for end in (first, second)]
    for end in ends:
        if len(end) != 3:
            raise ValueError(f"{len(end)} features, expected shift, width and slope")
    return _upglow.mixed_reflectances(ends[0], ends[1], mixing, weights.tolist())
