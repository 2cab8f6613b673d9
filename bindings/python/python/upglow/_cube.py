"""Cubes: a material for any RGB color."""

from __future__ import annotations

import hashlib
import json
import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _upglow
from ._arrays import (
    Nm,
    Of,
    Shape,
    Threads,
    broadcast,
    numbers,
    refuse_outside,
    rgb_array,
    rows,
    single_rows,
    subjects,
    within,
)
from ._contract import Contract
from ._html import table
from ._illuminant import Illuminant, warn_of_ultraviolet
from ._kinds import instance, real, whole, wrong
from ._materials import Corners, Materials, ModelName
from ._models import Model
from ._observer import Observer
from ._progress import Report, reporting
from ._spectra import distribution, distributions
from ._standing import standing
from ._verify import Check, VerifyReport
from ._wavelengths import FIT_NM, grid, nanometers, wavelength_list

if TYPE_CHECKING:
    import colour

_REMEMBERED_LIGHTS = 8
"""Lights whose colors a cube keeps; each takes 16 bytes per node."""


class Samples(NamedTuple):
    """Wavelengths drawn from materials; each array has the leading shape of the arguments."""

    nm: NDArray[Any]
    """The wavelengths drawn, nm; NaN where the light is absorbed."""
    throughput: NDArray[Any]
    """Factor for the path's throughput: the material's value divided by ``pdf``."""
    pdf: NDArray[Any]
    """Probability, 0 to 1, of keeping the wavelength where it was kept; elsewhere density, 1/nm."""
    is_elastic: NDArray[np.bool_]
    """Whether the wavelength was kept."""


class CubeCheck(NamedTuple):
    """How well a cube reproduces colors, and how well any material could; arrays of shape (...)."""

    kind: NDArray[np.uint8]
    """A `Kind` for each color."""
    distance: NDArray[np.float64]
    """As in `Standing`."""
    nearest_de2000: NDArray[np.float64]
    """CIEDE2000 to the nearest color that a material can reproduce, as in `Standing`."""
    de2000: NDArray[np.float32]
    """CIEDE2000 of the cube's material against the color, sums over 5 nm."""


class Relit(NamedTuple):
    """How colors look under n lights; arrays of shape (n, ...) or (n, ..., 3), NaN where not defined."""

    xyz: NDArray[np.float64]
    """XYZ; Y = 1 is white under each light, but under one that nobody can adapt to, such as an
    ultraviolet lamp: there it is white under the contract's light, at equal power."""
    lab: NDArray[np.float64]
    """CIELAB relative to ``white``."""
    rgb: NDArray[np.float64]
    """Linear RGB in the contract's space; not limited to 0 to 1."""
    de2000: NDArray[np.float64]
    """CIEDE2000 from the color under the contract's light, each as seen by an observer adapted to the
    light."""
    fluorescent_share: NDArray[np.float64]
    """Share of Y that dyes emit, 0 to 1."""
    whiteness: NDArray[np.float64]
    """Whiteness of the CIE, for whites under light like D65."""
    tint: NDArray[np.float64]
    """Tint of the CIE, where ``whiteness`` is defined."""
    band_de2000: NDArray[np.float64]
    """How far the color may be off: the CIEDE2000 within which nine of ten materials are that may have the color
    under the contract's light, by their probabilities; with ``band=True``."""
    white: NDArray[np.float64]
    """XYZ of what the observer sees as white; shape (n, 3)."""
    is_adapted: NDArray[np.bool_]
    """Whether that is the white of the light; shape (n,)."""


@dataclass(frozen=True)
class CubeSummary:
    """How well the nodes of a cube match their colors."""

    nodes: int
    """Nodes of the cube."""
    exact: int
    """Nodes within 0.01 CIEDE2000 of their color."""
    within_1: int
    """Nodes within 1 CIEDE2000."""
    within_2: int
    """Nodes within 2 CIEDE2000."""
    mean_de2000: float
    """Mean CIEDE2000 over the nodes."""
    p95_de2000: float
    """95th percentile of CIEDE2000 over the nodes."""
    max_de2000: float
    """Greatest CIEDE2000 of a node."""
    fluorescent: int
    """Nodes whose material fluoresces."""
    kinds: dict[str, int]
    """Nodes by kind of material: ``reflectance`` alone, ``dyed`` (both within the slope limits),
    ``steep`` (steeper than these), ``missed`` (more than 0.01 CIEDE2000 from their color)."""


def build(
    contract: Contract | None = None,
    *,
    model: Model | None = None,
    resolution: int = 32,
    preset: str = "natural",
    slope_max_per_nm: float | None | Literal["preset"] = "preset",
    slope_under_dyes_per_nm: float | None | Literal["preset"] = "preset",
    relaxed: bool | None = None,
    metric: str | None = None,
    method: str | None = None,
    sweeps: int | None = None,
    threads: Threads = None,
    progress: bool | Report = False,
) -> Cube:
    """Fit a material for every node of a grid over RGB. Ctrl-C stops it.

    Parameters
    ----------
    contract
        What RGB means; ACEScg under D65 by default.
    model
        `Dyes`, `Film`, `Analytic` or `Reflectance`; that of the preset by default.
    resolution
        Nodes along each axis, 2 to 256.
    preset
        Model and options by one word, which the other arguments override: ``natural``,
        ``konig2020``, ``jung2019`` or ``jakob2019``. The first is films of dyes that conserve
        photons, over reflectances no steeper than those of measured surfaces; the others are the
        models of these papers.
    slope_max_per_nm
        Greatest slope of a reflectance without fluorescence, 0.0001 to 0.2 per nm, or ``None`` for
        0.2. A color that such a reflectance matches gets no dye.
    slope_under_dyes_per_nm
        Greatest slope of a reflectance under fluorescence, at most ``slope_max_per_nm``, which it
        follows where the preset has one limit for both.
    relaxed
        Whether a color that no material within the limits matches gets a steeper reflectance.
    metric
        Color difference to minimize: ``de2000`` (default), ``de76`` or ``rgb``.
    method
        ``search`` (ours, the default), ``exhaustive`` (a slower reference for it), ``konig2020`` or
        ``konig2020-features``.
    sweeps
        How often a node that misses its color tries its neighbors' materials; by default 2, and 4
        for the methods of König et al. 2020.
    threads
        Number of threads; one per core by default. The cube does not depend on it.
    progress
        ``True`` shows a progress bar: tqdm's, which supports notebooks, or plain text in a terminal.
        Or a function that takes stage, units done and total.

    Raises
    ------
    ValueError
        If an option is unknown or out of range.

    Examples
    --------
    >>> import upglow
    >>> cube = upglow.build(upglow.Contract(space="rec2020"), resolution=5)
    >>> cube.summary().nodes
    125
    """
    if model is not None and not isinstance(model, Model):
        raise wrong("model", model, "Film(…), Dyes(…), Analytic(…), Reflectance() or None")
    native = _upglow.Model.of_preset(preset) if model is None else model._native()
    if getattr(model, "quantum_yield", None) == "measured" and native.without_published_yield:
        names = ", ".join(native.without_published_yield)
        warnings.warn(f"no published quantum yield, taken as 1: {names}", stacklevel=2)
    slope_max = _limit("slope_max_per_nm", slope_max_per_nm)
    slope_under_dyes = _limit("slope_under_dyes_per_nm", slope_under_dyes_per_nm)
    steeper = None if relaxed is None else instance("relaxed", relaxed, bool)
    tries = None if sweeps is None else whole("sweeps", sweeps)
    options = (preset, metric, slope_max, slope_under_dyes, steeper, method, tries)
    agreed = Contract._or_default(contract)
    nodes = whole("resolution", resolution)
    warn_of_ultraviolet(native, agreed.illuminant)
    with reporting(progress) as report:
        return Cube._of(_upglow.build(agreed._native, native, nodes, options, threads, report))


def _limit(what: str, slope_per_nm: float | str | None) -> tuple[float | None] | None:
    """A slope limit in a tuple, or ``None`` for that of the preset."""
    expected = "a number, None or 'preset'"
    if isinstance(slope_per_nm, str):
        if slope_per_nm != "preset":
            raise ValueError(f"{what} is {slope_per_nm!r}, expected {expected}")
        return None
    return (None if slope_per_nm is None else real(what, slope_per_nm, expected),)


class Cube:
    """Materials for every node of a regular grid over linear RGB, 0 to 1 in each channel.

    Made by `upglow.build`, `Cube.read` or `Cube.from_bytes`. Between nodes, the materials of the
    four nodes around a color are mixed. If these match their colors, the mixture matches the color
    between them, and it conserves energy and keeps the slope limit everywhere.

    ``of``, the first argument of many methods, is linear RGB of shape (..., 3) in the cube's space,
    or `Materials`, such as ``cube.nodes`` and the results of `material` and `fit`. Other arguments
    broadcast against the leading shape (...) by numpy's rules. Results are float32 for float32 RGB,
    and float64 for all other types.

    ``outside`` selects the treatment of RGB outside 0 to 1: ``raise`` raises a ValueError with index
    and value, ``nan`` returns NaN, ``clip`` takes the nearest color of the cube (NaN stays NaN).

    ``threads`` is a number of threads, by default one per core. No result depends on it.
    """

    __slots__ = ("_colors", "_contract", "_model", "_native", "_reduction")

    _native: _upglow.Cube
    _contract: Contract
    _model: ModelName | None
    _colors: dict[tuple[Illuminant | None, str, int], _upglow.Colors]
    _reduction: _upglow.Reduced | None

    def __init__(self) -> None:
        raise TypeError("a cube comes from upglow.build, Cube.read or Cube.from_bytes")

    @classmethod
    def _of(cls, native: _upglow.Cube) -> Cube:
        cube = cls.__new__(cls)
        cube._native = native
        cube._contract = Contract._of(native.contract())
        cube._colors = {}
        cube._model = None
        cube._reduction = None
        return cube

    # Files

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Cube:
        """Read a cube's file.

        ``OSError`` if it cannot be read; ``ValueError`` if it is not a cube, or is damaged.
        """
        return cls._of(_upglow.Cube.read(path))

    @classmethod
    def from_bytes(cls, content: bytes) -> Cube:
        """Read a cube from the content of its file; ``ValueError`` if it is not one."""
        return cls._of(_upglow.Cube.from_bytes(content))

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the cube's file, completely or, if that fails, not at all (``OSError``)."""
        self._native.write(path)

    def to_bytes(self) -> bytes:
        """The content of the cube's file; the same for equal cubes."""
        return self._native.to_bytes()

    # What it is

    @property
    def contract(self) -> Contract:
        """What RGB means here."""
        return self._contract

    @property
    def resolution(self) -> int:
        """Nodes along each axis."""
        return self._native.resolution

    @property
    def header(self) -> dict[str, Any]:
        """The file's header: contract, model, fit. Its fields: docs/cube-format.md."""
        header: dict[str, Any] = json.loads(self._native.header_json())
        return header

    @property
    def model(self) -> str:
        """``reflectance``, ``dyes``, ``film`` or ``analytic``."""
        kind: str = self.header["model"]["kind"]
        return kind

    def _model_name(self) -> ModelName:
        """What `Materials` of this cube carry with them; made at the first call."""
        if self._model is None:
            stated = self.header["model"]
            content = json.dumps(stated, sort_keys=True).encode() + self.dye_curves.tobytes()
            self._model = ModelName(stated["kind"], hashlib.sha256(content).hexdigest())
        return self._model

    @property
    def nodes(self) -> Materials:
        """A copy of the nodes' materials, ``[blue][green][red]``; shape (n, n, n).

        Node i of an axis of n stands for the linear value i / (n - 1).
        """
        n = self.resolution
        return Materials._of(self._native.nodes(), (n, n, n), self._model_name())

    @property
    def dye_names(self) -> list[str]:
        """The dyes in ring order; empty where the model has none."""
        return [dye["name"] for dye in self.header["model"].get("dyes") or []]

    @property
    def dye_curves(self) -> NDArray[np.float64]:
        """Absorption (0 to 1) and emission (unit area, 1/nm) of each dye, as the model uses them.

        ``[dye][absorption, emission][wavelength]`` over ``upglow.FINE_NM``; shape (dyes, 2, 531).
        """
        return self._native.dye_curves().reshape(-1, 2, 531)

    def summary(self) -> CubeSummary:
        """How well the nodes match their colors, from the differences that the cube stores."""
        found = self._native.summary()
        names = "reflectance", "dyed", "steep", "missed"
        return CubeSummary(*found[:8], dict(zip(names, found[8], strict=True)))

    def __repr__(self) -> str:
        n = self.resolution
        return f"Cube({n}x{n}x{n} {self.model}, {self.contract!r})"

    def _repr_html_(self) -> str:
        n, found = self.resolution, self.summary()
        rows = {"model": ": ".join(filter(None, [self.model, ", ".join(self.dye_names)]))}
        rows |= self.contract._names()
        rows["nodes"] = f"{found.nodes}, {found.exact} exact, {found.fluorescent} fluorescent"
        rows["ΔE00 of the nodes"] = f"mean {found.mean_de2000:.3g}, greatest {found.max_de2000:.3g}"
        return table(f"Cube of {n}³ nodes", rows)

    def __reduce__(self) -> tuple[Any, tuple[bytes]]:
        return Cube.from_bytes, (self.to_bytes(),)

    # Color

    def xyz(
        self,
        rgb: ArrayLike,
        *,
        light: Any = None,
        scale: str = "white",
        step_nm: int = 5,
        outside: str = "raise",
        threads: Threads = None,
    ) -> NDArray[np.float32]:
        """XYZ of the materials, in single precision.

        The first call for a light prepares a table. After that it computes tens of millions of
        colors per second.

        Parameters
        ----------
        rgb
            Linear RGB, shape (..., 3).
        light
            An `Illuminant`, or what one is made from; the contract's by default.
        scale
            ``white``: the perfect diffuser has Y = 1 under any light. ``power``: the light has the
            power of the contract's from 300 to 830 nm; under an ultraviolet lamp, white is nearly
            black and only fluorescence is bright.
        step_nm
            Step of the sums: 5 nm, as in fits and in the stored differences, or 1 nm. For a light with
            lines, the sums over 5 nm have as many wavelengths, placed at the lines.

        Returns
        -------
        float32 array of shape (..., 3)
        """
        array = within(rgb, outside)
        colors = self._colors_under(light, scale, step_nm)
        return colors.xyz(single_rows(array), threads).reshape(array.shape)

    def rgb_under(
        self,
        rgb: ArrayLike,
        light: Any,
        *,
        scale: str = "white",
        step_nm: int = 5,
        outside: str = "raise",
        threads: Threads = None,
    ) -> NDArray[np.float32]:
        """Linear RGB, in the contract's space, of the materials under another light.

        XYZ as in `xyz`, converted to RGB for an observer adapted to that light if the contract
        adapts (``scale="white"``), or to the contract's own light (``scale="power"``).

        Returns
        -------
        float32 array of shape (..., 3); not limited to 0 to 1
        """
        array = within(rgb, outside)
        colors = self._colors_under(light, scale, step_nm)
        return colors.rgb(single_rows(array), threads).reshape(array.shape)

    def relight(
        self,
        rgb: ArrayLike,
        lights: Sequence[Any],
        *,
        observer: Any = None,
        band: bool = False,
        threads: Threads = None,
        progress: bool | Report = False,
    ) -> Relit:
        """How colors look under lights, with all numbers of ``upglow relight``, in double precision.

        ``rgb`` is linear RGB of shape (..., 3), 0 to 1. Each of the n ``lights`` is an `Illuminant`, or what one
        is made from; ``observer`` is an `Observer` or what one is made from, the contract's by default.
        ``band=True`` searches all materials that may have each color, as `upglow.metamers` does, half a second for
        each of at most 1000, and says how far the answer may be off. Ctrl-C stops it.
        """
        array = rgb_array(rgb).astype(np.float64, copy=False)
        refuse_outside(array, to_fit=False)
        if not isinstance(lights, (list, tuple)):
            raise wrong("lights", lights, "a list of lights")
        made = [Illuminant(light) for light in lights]
        for light in made:
            warn_of_ultraviolet(self._native, light)
        seer = self._contract.observer if observer is None else Observer(observer)
        natives = [light._native for light in made]
        searched = instance("band", band, bool)
        with reporting(progress) as report:
            found, white, is_adapted = _upglow.relight(
                self._native, rows(array), natives, seer._native, searched, threads, report
            )
        shape = (len(made), *array.shape[:-1])
        told = found.reshape(*shape, 14)
        return Relit(
            xyz=told[..., 0:3],
            lab=told[..., 3:6],
            rgb=told[..., 6:9],
            de2000=told[..., 9],
            fluorescent_share=told[..., 10],
            whiteness=told[..., 11],
            tint=told[..., 12],
            band_de2000=told[..., 13],
            white=white,
            is_adapted=is_adapted,
        )

    def check(self, rgb: ArrayLike, *, threads: Threads = None) -> CubeCheck:
        """What kind of material can reproduce colors, and how far this cube's are from them.

        ``rgb`` is linear RGB of shape (..., 3); any finite numbers. Outside the cube ``de2000`` is
        NaN.
        """
        array = rgb_array(rgb)
        kind, distance, nearest_de2000 = standing(array, self._contract, threads=threads)
        own = self._colors_under(None, "white", 5)
        de2000 = own.de2000(single_rows(array), threads).reshape(array.shape[:-1])
        return CubeCheck(kind, distance, nearest_de2000, de2000)

    def _colors_under(self, light: Any, scale: str, step_nm: int) -> _upglow.Colors:
        illuminant = None if light is None else Illuminant(light)
        key = (illuminant, scale, step_nm)
        if key not in self._colors:
            native = None if illuminant is None else illuminant._native
            warn_of_ultraviolet(self._native, illuminant or self._contract.illuminant)
            colors = _upglow.colors(self._native, native, scale, whole("step_nm", step_nm))
            while len(self._colors) >= _REMEMBERED_LIGHTS:
                del self._colors[next(iter(self._colors))]
            self._colors[key] = colors
        return self._colors[key]

    # Spectra

    def reflectance(
        self, of: Of, wavelengths_nm: Nm, *, outside: str = "raise", threads: Threads = None
    ) -> NDArray[Any]:
        """Share of incident light that is reflected at the same wavelength, 0 to 1.

        ``wavelengths_nm`` is a list of n wavelengths, or one.

        Returns
        -------
        array of shape (..., n), or (...) for one wavelength
        """
        return self._spectrum("reflectance", of, wavelengths_nm, outside, threads)

    def albedo(
        self, of: Of, wavelengths_nm: Nm, *, outside: str = "raise", threads: Threads = None
    ) -> NDArray[Any]:
        """Share of incident light at each wavelength that leaves at any wavelength, 0 to 1.

        Shapes as in `reflectance`.
        """
        return self._spectrum("albedo", of, wavelengths_nm, outside, threads)

    def reradiation(
        self, of: Of, in_nm: Nm, out_nm: Nm, *, outside: str = "raise", threads: Threads = None
    ) -> NDArray[Any]:
        """Energy re-radiated per nm at ``out_nm``, per unit of energy incident at ``in_nm``; 1/nm.

        Reflection at the same wavelength is `reflectance`. ``in_nm`` and ``out_nm`` broadcast
        against the leading shape of ``of``; the result has that shape.
        """
        return self._number("reradiation_per_nm", of, {"in_nm": in_nm, "out_nm": out_nm}, outside, threads)

    def reradiation_matrix(
        self,
        of: Of,
        wavelengths_nm: ArrayLike | None = None,
        *,
        outside: str = "raise",
        threads: Threads = None,
    ) -> NDArray[np.float64]:
        """The re-radiation (Donaldson) matrix over the bands around n wavelengths.

        Entry ``[..., out, in]`` is the share of the energy incident at wavelength ``in`` that leaves
        within half a step of ``out``; reflectance is on the diagonal. Each column adds up to at most
        1. Wavelengths are whole nm in equal steps; by default ``upglow.FIT_NM``: 300, 305 … 830 nm.

        Returns
        -------
        float64 array of shape (..., n, n)
        """
        native, shape = subjects(of, outside, self._model_name())
        band = grid(FIT_NM if wavelengths_nm is None else wavelengths_nm)
        found = _upglow.reradiation_matrix(self._native, native, band, threads)
        n = (band[1] - band[0]) // band[2] + 1
        return found.reshape(*shape, n, n)

    def reduced_matrix(
        self,
        of: Of,
        *,
        engine: str | Sequence[float] | None = None,
        outside: str = "raise",
        threads: Threads = None,
    ) -> NDArray[Any]:
        """The 4×4 matrix by which a material acts on light given as X, Y, Z and ultraviolet.

        For engines without spectra: ``matrix @ light`` is what leaves, where `reduced_light` gives the
        light's four numbers. It is linear in the material, so that matrices may be interpolated and
        filtered; exact under the contract's light; and it returns no light stronger than it came.
        docs/rgb-engines.md in the repository has the equation and the errors.

        The first call prepares a table for RGB in single precision.

        Parameters
        ----------
        engine
            RGB space that an engine keeps light in, as `Contract` takes it. Light is then linear red, green
            and blue, each 1 under the contract's light, and ultraviolet.

        Returns
        -------
        array of shape (..., 4, 4), ``[..., outgoing, incident]``, each X, Y, Z, U or R, G, B, U

        Examples
        --------
        >>> import upglow
        >>> cube = upglow.build(upglow.Contract(), resolution=2, model=upglow.Reflectance())
        >>> matrix = cube.reduced_matrix([0.5, 0.5, 0.5])
        >>> (matrix @ cube.reduced_light("A")).round(3).tolist()
        [0.549, 0.5, 0.178, 0.083]
        """
        native, shape = subjects(of, outside, self._model_name())
        found = self._reduced().matrix(self._native, native, threads).reshape(*shape, 4, 4)
        if engine is None:
            return found
        rgb_from_xyz = self._engine(engine).astype(found.dtype)
        converted: NDArray[Any] = rgb_from_xyz @ found @ np.linalg.inv(rgb_from_xyz)
        return converted

    def reduced_light(
        self, light: Any = None, *, engine: str | Sequence[float] | None = None
    ) -> NDArray[np.float64]:
        """X, Y, Z and U of a light, or R, G, B and U in the RGB space of an engine; by default of the contract's light.

        Scaled so that a perfect diffuser has Y = 1; light too dark to see by, such as that of an
        ultraviolet lamp, to as much power as the contract's light has. D65 has U = 1.

        Returns
        -------
        float64 array of shape (4,)
        """
        found = self._reduced().light(None if light is None else Illuminant(light)._native)
        return found if engine is None else self._engine(engine) @ found

    def _engine(self, space: str | Sequence[float]) -> NDArray[np.float64]:
        """The matrix from X, Y, Z to linear RGB of an engine, which leaves U alone."""
        own = self.contract
        contract = Contract(
            space=space,
            illuminant=own.illuminant,
            observer=own.observer,
            adaptation=own.adaptation,
        )
        found = np.eye(4)
        found[:3, :3] = contract.rgb_from_xyz
        return found

    def without_ultraviolet(self, matrices: ArrayLike) -> NDArray[np.float64]:
        """3×3 matrices of X, Y, Z from 4×4 ones, for engines that have no fourth channel.

        Blue light then brings as much ultraviolet as the contract's does. Exact under the contract's
        light, and wrong under light that has more ultraviolet or less.

        Parameters
        ----------
        matrices
            What `reduced_matrix` returns, shape (..., 4, 4).

        Returns
        -------
        float64 array of shape (..., 3, 3)
        """
        array = numbers("matrices", matrices)
        if array.shape[-2:] != (4, 4):
            raise ValueError(f"matrices has shape {array.shape}, expected (..., 4, 4)")
        flat = np.ascontiguousarray(array.reshape(-1, 16))
        return self._reduced().without_ultraviolet(flat).reshape(*array.shape[:-2], 3, 3)

    def _reduced(self) -> _upglow.Reduced:
        if self._reduction is None:
            self._reduction = _upglow.Reduced(self._native)
        return self._reduction

    def radiance_factor(
        self,
        of: Of,
        wavelengths_nm: ArrayLike | None = None,
        *,
        light: Any = None,
        outside: str = "raise",
        threads: Threads = None,
    ) -> NDArray[np.float64]:
        """Total radiance factor under a light: light that leaves over light that is incident.

        Reflectance and fluorescence together, as a spectrophotometer with that lamp measures them;
        it may exceed 1. NaN where the light has no power. ``light`` is an `Illuminant`, or what one
        is made from; the contract's by default. Wavelengths as in `reradiation_matrix`; excitation
        outside them is ignored. A light with lines counts with its mean power in the band around each
        wavelength.

        Returns
        -------
        float64 array of shape (..., n)
        """
        wavelengths_nm = FIT_NM if wavelengths_nm is None else wavelengths_nm
        matrix = self.reradiation_matrix(of, wavelengths_nm, outside=outside, threads=threads)
        illuminant = self._contract.illuminant if light is None else Illuminant(light)
        warn_of_ultraviolet(self._native, illuminant)
        first, last, step = grid(wavelengths_nm)
        if first < 300 or last > 830:
            raise ValueError(f"wavelengths {first} to {last} nm, expected within 300 to 830 nm")
        observer = self._contract.observer._native
        power = illuminant._native.power_in_bands((first, last, step), observer)
        leaving = matrix @ power
        factor: NDArray[np.float64] = np.full(leaving.shape, np.nan)
        return np.divide(leaving, power, out=factor, where=power > 0)

    def spectral_distribution(
        self,
        of: Of,
        wavelengths_nm: ArrayLike | None = None,
        *,
        quantity: Literal["radiance_factor", "reflectance"] = "radiance_factor",
        light: Any = None,
        outside: str = "raise",
    ) -> colour.SpectralDistribution:
        """The spectrum of one color or material, as one of colour-science.

        ``quantity`` is what `radiance_factor` returns, or `reflectance`: the same without what dyes emit.
        ``of`` is RGB of shape (3,) or `Materials` of shape (); wavelengths, by default
        ``upglow.FIT_NM``, and ``light`` as there. ``ImportError`` without the package
        ``colour-science``.
        """
        nm, values = self._sampled(of, wavelengths_nm, quantity, light, outside)
        if values.ndim != 1:
            raise ValueError(
                f"of has shape {values.shape[:-1]} of colors, expected one: see spectral_distributions"
            )
        at = "" if isinstance(of, Materials) else f" {tuple(rgb_array(of).tolist())}"
        return distribution(f"{self.contract.space}{at}", nm, values)

    def spectral_distributions(
        self,
        of: Of,
        wavelengths_nm: ArrayLike | None = None,
        *,
        quantity: Literal["radiance_factor", "reflectance"] = "radiance_factor",
        light: Any = None,
        outside: str = "raise",
    ) -> colour.MultiSpectralDistributions:
        """The spectra of colors or materials, as those of colour-science.

        As `spectral_distribution`, for any leading shape. Labels are "0", "1" …, in the order of the
        flattened array.
        """
        nm, values = self._sampled(of, wavelengths_nm, quantity, light, outside)
        columns = values.reshape(-1, nm.size).T
        labels = [str(i) for i in range(columns.shape[1])]
        return distributions(self.contract.space, nm, columns, labels)

    def _sampled(
        self, of: Of, wavelengths_nm: ArrayLike | None, quantity: str, light: Any, outside: str
    ) -> tuple[NDArray[np.float64], NDArray[Any]]:
        """Wavelengths in nm, shape (n,), and what is asked for there, shape (..., n)."""
        nm = wavelength_list(FIT_NM if wavelengths_nm is None else wavelengths_nm)
        if quantity == "radiance_factor":
            return nm, self.radiance_factor(of, nm, light=light, outside=outside)
        if quantity != "reflectance":
            raise ValueError(f"quantity is {quantity!r}, expected radiance_factor or reflectance")
        if light is not None:
            raise ValueError("light with the quantity reflectance, which is the same under all lights")
        return nm, self.reflectance(of, nm, outside=outside)

    # Sampling

    def sample_incident(
        self, of: Of, out_nm: Nm, u: ArrayLike, *, outside: str = "raise", threads: Threads = None
    ) -> Samples:
        """Draw the wavelength of incident light, given that of the light that leaves.

        For paths that start at the camera. ``u`` holds two independent numbers in 0 to 1, 1
        excluded, on its last axis: the first chooses between reflection and fluorescence, the second
        draws the wavelength. ``out_nm`` and ``u[..., 0]`` broadcast against the leading shape of
        ``of``.
        """
        known_nm = nanometers("out_nm", out_nm)
        return self._sample("sample_incident", of, known_nm, u, outside, threads)

    def sample_outgoing(
        self, of: Of, in_nm: Nm, u: ArrayLike, *, outside: str = "raise", threads: Threads = None
    ) -> Samples:
        """Draw the wavelength of the light that leaves, given that of incident light.

        For paths that start at a light; arguments as in `sample_incident`.
        """
        known_nm = nanometers("in_nm", in_nm)
        return self._sample("sample_outgoing", of, known_nm, u, outside, threads)

    def incident_pdf_per_nm(
        self, of: Of, in_nm: Nm, out_nm: Nm, *, outside: str = "raise", threads: Threads = None
    ) -> NDArray[Any]:
        """Density, 1/nm, with which `sample_incident` draws ``in_nm`` by fluorescence.

        Shapes as in `reradiation`.
        """
        return self._number("incident_pdf_per_nm", of, {"in_nm": in_nm, "out_nm": out_nm}, outside, threads)

    def outgoing_pdf_per_nm(
        self, of: Of, in_nm: Nm, out_nm: Nm, *, outside: str = "raise", threads: Threads = None
    ) -> NDArray[Any]:
        """Density, 1/nm, with which `sample_outgoing` draws ``out_nm`` by fluorescence.

        Shapes as in `reradiation`.
        """
        return self._number("outgoing_pdf_per_nm", of, {"in_nm": in_nm, "out_nm": out_nm}, outside, threads)

    def incident_elastic_probability(
        self, of: Of, out_nm: Nm, *, outside: str = "raise", threads: Threads = None
    ) -> NDArray[Any]:
        """Probability, 0 to 1, that `sample_incident` keeps the wavelength."""
        return self._number("incident_elastic_probability", of, {"out_nm": out_nm}, outside, threads)

    def outgoing_elastic_probability(
        self, of: Of, in_nm: Nm, *, outside: str = "raise", threads: Threads = None
    ) -> NDArray[Any]:
        """Probability, 0 to 1, that `sample_outgoing` keeps the wavelength."""
        return self._number("outgoing_elastic_probability", of, {"in_nm": in_nm}, outside, threads)

    def _spectrum(
        self, quantity: str, of: Of, wavelengths_nm: Nm, outside: str, threads: Threads
    ) -> NDArray[Any]:
        native, shape = subjects(of, outside, self._model_name())
        nm = wavelength_list(wavelengths_nm)
        listed = nm.reshape(-1).tolist()
        found = _upglow.spectrum(self._native, native, quantity, listed, threads)
        return _shaped(found, (*shape, *nm.shape))

    def _sample(
        self, question: str, of: Of, known_nm: Nm, u: ArrayLike, outside: str, threads: Threads
    ) -> Samples:
        drawn = numbers("u", u)
        if drawn.ndim == 0 or drawn.shape[-1] != 2:
            raise ValueError(f"u has shape {drawn.shape}, expected (..., 2)")
        if not np.all((drawn >= 0.0) & (drawn < 1.0)):
            raise ValueError("u has a number that is not in 0 to 1, 1 excluded")
        given = (known_nm, drawn[..., 0], drawn[..., 1])
        found, shape = self._answer(question, of, given, outside, threads)
        nm, throughput, pdf, is_elastic = (_shaped(column, shape) for column in found.T)
        return Samples(nm, throughput, pdf, is_elastic == 1.0)

    def _number(
        self, question: str, of: Of, known: dict[str, ArrayLike], outside: str, threads: Threads
    ) -> NDArray[Any]:
        given = [nanometers(name, nm) for name, nm in known.items()]
        return _shaped(*self._answer(question, of, given, outside, threads))

    def _answer(
        self, question: str, of: Of, given: Sequence[ArrayLike], outside: str, threads: Threads
    ) -> tuple[NDArray[Any], Shape]:
        """Each material's answer to its own numbers, one per row, and the leading shape."""
        native, known, shape = broadcast(of, outside, self._model_name(), *given)
        return _upglow.answer(self._native, native, question, known, threads), shape

    # Materials

    def material(
        self, rgb: ArrayLike, *, outside: str = "raise", threads: Threads = None
    ) -> Materials:
        """One material for each color, as a texture stores it, in single precision.

        A few steps of optimization lead from the nodes around a color to a single material that
        matches it. Similar colors get similar materials; grays are flat; the cube's slope limit
        holds. Each call prepares a table first, so pass whole pictures. ``rgb`` has shape (..., 3),
        the result (...).
        """
        array = within(rgb, outside)
        found = _upglow.polish(self._native, single_rows(array), threads)
        return Materials._of(found, array.shape[:-1], self._model_name())

    def fit(
        self, rgb: ArrayLike, *, threads: Threads = None, progress: bool | Report = False
    ) -> Materials:
        """Fit each color as the cube's nodes were fitted, instead of looking it up. Ctrl-C stops it.

        ``rgb`` has shape (..., 3) and may be brighter than white: 0 to 10. It takes about a
        millisecond per color. The result has shape (...).
        """
        array = rgb_array(rgb).astype(np.float64, copy=False)
        refuse_outside(array, to_fit=True)
        with reporting(progress) as report:
            found = _upglow.fit(self._native, rows(array), threads, report)
        return Materials._of(found, array.shape[:-1], self._model_name())

    def corners(self, rgb: ArrayLike, *, outside: str = "raise") -> Corners:
        """The four nodes around each color, and their weights.

        Their materials are ``cube.nodes[tuple(np.moveaxis(cube.corners(rgb).nodes, -1, 0))]``.
        """
        array = within(rgb, outside).astype(np.float64, copy=False)
        number, weights = _upglow.corners(self._native, rows(array))
        shape, n = (*array.shape[:-1], 4), self.resolution
        nodes = np.stack(np.unravel_index(number.reshape(shape), (n, n, n)), axis=-1)
        return Corners(nodes, weights.reshape(shape))

    # Verification

    def verify(
        self,
        *,
        points: int = 1_000_000,
        interpolation: str = "blend",
        seed: int = 0,
        threads: Threads = None,
        progress: bool | Report = False,
    ) -> VerifyReport:
        """Check at every nm all that the cube promises, with independent code. Ctrl-C stops it.

        Parameters
        ----------
        points
            Random colors between the nodes; each takes 15 µs of one core.
        interpolation
            How nodes are interpolated: ``blend``, ``none``, ``coefficients``, ``features`` or
            ``hybrid``.
        seed
            Seed of the random colors.
        progress
            As in `upglow.build`.
        """
        count = whole("points", points)
        with reporting(progress) as report:
            nodes, tried, holds, checks = _upglow.verify(
                self._native, count, interpolation, whole("seed", seed), threads, report
            )
        found = tuple(Check(*check) for check in checks)
        return VerifyReport(nodes=nodes, points=tried, holds=holds, checks=found)


def _shaped(found: NDArray[Any], shape: Shape) -> NDArray[Any]:
    """The numbers in this shape; a scalar for the shape ()."""
    shaped: NDArray[Any] = found.reshape(shape)[()]
    return shaped
