"""The native half of upglow; use the package itself."""

import os
from collections.abc import Callable, Sequence
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Colors",
    "Contract",
    "Cube",
    "DonaldsonMatrix",
    "DyeSet",
    "Illuminant",
    "MatrixFit",
    "Metamers",
    "Model",
    "Observer",
    "Reduced",
    "__version__",
    "answer",
    "build",
    "chromaticity_diagram",
    "colors",
    "corners",
    "dye_spectra",
    "first_outside",
    "fit",
    "fit_matrix",
    "layer",
    "matrix_like",
    "metamers",
    "mixed_reflectances",
    "node_colors",
    "polish",
    "relight",
    "reradiation_matrix",
    "solid_surface",
    "spectrum",
    "standing",
    "verify",
]

__version__: Final[str]

_Doubles = NDArray[np.float64]
_Singles = NDArray[np.float32]
_Limit = tuple[float | None]
_Stored = tuple[_Singles, NDArray[np.uint8], _Singles]
_Subjects = _Singles | _Doubles | _Stored
_Materials = tuple[_Singles, NDArray[np.uint8], _Singles, _Singles]
_Threads = int | None
_Report = Callable[[str, int, int], Any]
_Check = tuple[str, str, str, float, float | None, str, int, int, str | None]
_Dye = tuple[str, list[float], list[float], list[float], float | None]

@final
class Illuminant:
    @staticmethod
    def names() -> list[str]: ...
    @staticmethod
    def named(name: str) -> Illuminant: ...
    @staticmethod
    def from_csv(name: str, text: str, ends: str | None = None) -> Illuminant: ...
    @staticmethod
    def from_csv_file(
        path: str | os.PathLike[str], text: str, ends: str | None = None
    ) -> Illuminant: ...
    @staticmethod
    def from_samples(
        name: str, wavelengths_nm: _Doubles, power: _Doubles, ends: str | None = None
    ) -> Illuminant: ...
    @staticmethod
    def line(name: str, peak_nm: float, fwhm_nm: float) -> Illuminant: ...
    def power_in_bands(self, grid_nm: Sequence[int], observer: Observer) -> _Doubles: ...
    @staticmethod
    def wavelengths_nm() -> _Doubles: ...
    name: Final[str]
    power: Final[_Doubles]
    given_nm: Final[list[int]]

@final
class Observer:
    @staticmethod
    def names() -> list[str]: ...
    @staticmethod
    def named(name: str) -> Observer: ...
    @staticmethod
    def from_csv(name: str, text: str) -> Observer: ...
    @staticmethod
    def from_csv_file(path: str | os.PathLike[str], text: str) -> Observer: ...
    @staticmethod
    def from_samples(name: str, wavelengths_nm: _Doubles, matching: _Doubles) -> Observer: ...
    name: Final[str]
    matching: Final[_Doubles]

@final
class DonaldsonMatrix:
    @staticmethod
    def from_samples(
        incident_nm: _Doubles,
        outgoing_nm: _Doubles,
        values: _Doubles,
        unit: str,
        reflectance: list[tuple[float, float]] | None = None,
    ) -> DonaldsonMatrix: ...
    @staticmethod
    def from_bfc(text: str) -> DonaldsonMatrix: ...
    @staticmethod
    def from_csv(text: str) -> DonaldsonMatrix: ...
    def color(self, light: Illuminant, observer: Observer) -> list[float]: ...
    def difference(
        self, fitted: DonaldsonMatrix, light: Illuminant
    ) -> tuple[list[float], list[float], float, float, bool]: ...
    def missing_ultraviolet(self, light: Illuminant) -> str | None: ...
    incident_nm: Final[_Doubles]
    outgoing_nm: Final[_Doubles]
    per_band: Final[_Doubles]
    diagonal: Final[str]
    noise: Final[list[float] | None]

@final
class MatrixFit:
    matrix: Final[DonaldsonMatrix]
    def cube(self) -> Cube: ...

def fit_matrix(
    measured: DonaldsonMatrix,
    dyes: DyeSet | None,
    all_dyes: bool,
    count: int | None,
    reflectance: str | None,
) -> MatrixFit: ...

@final
class Contract:
    def __new__(
        cls,
        space: str | Sequence[float],
        illuminant: Illuminant,
        observer: Observer,
        adaptation: str,
    ) -> Contract: ...
    @staticmethod
    def spaces() -> list[str]: ...
    space: Final[str]
    primaries_xy: Final[_Doubles]
    white_xy: Final[_Doubles]
    illuminant: Final[Illuminant]
    observer: Final[Observer]
    adaptation: Final[str]
    white_xyz: Final[_Doubles]
    xyz_from_rgb: Final[_Doubles]
    rgb_from_xyz: Final[_Doubles]

@final
class DyeSet:
    @staticmethod
    def names() -> list[str]: ...
    @staticmethod
    def named(name: str) -> DyeSet: ...
    @staticmethod
    def from_folder(path: str | os.PathLike[str], normalize: bool) -> DyeSet: ...
    @staticmethod
    def from_samples(name: str, dyes: Sequence[_Dye], normalize: bool) -> DyeSet: ...
    name: Final[str]
    dyes: Final[list[str]]

@final
class Model:
    @staticmethod
    def reflectance() -> Model: ...
    @staticmethod
    def analytic(
        absorption_fwhm_nm: float, emission_fwhm_nm: float, accounting: str, quantum_yield: float
    ) -> Model: ...
    @staticmethod
    def dyes(
        set: DyeSet,
        accounting: str,
        mixing: str,
        quantum_yield: float | str,
        optical_density: float | None,
    ) -> Model: ...
    @staticmethod
    def of_preset(preset: str) -> Model: ...
    @staticmethod
    def film(set: DyeSet, accounting: str, quantum_yield: float | str) -> Model: ...
    def missing_ultraviolet(self, light: Illuminant) -> str | None: ...
    name: Final[str]
    without_published_yield: Final[list[str]]

@final
class Cube:
    def model(self) -> Model: ...
    @staticmethod
    def read(path: str | os.PathLike[str]) -> Cube: ...
    @staticmethod
    def from_bytes(content: bytes) -> Cube: ...
    def write(self, path: str | os.PathLike[str]) -> None: ...
    def to_bytes(self) -> bytes: ...
    def contract(self) -> Contract: ...
    resolution: Final[int]
    def header_json(self) -> str: ...
    def missing_ultraviolet(self, light: Illuminant) -> str | None: ...
    def nodes(self) -> _Materials: ...
    def packed_nodes(self) -> _Singles: ...
    def dye_curves(self) -> _Doubles: ...
    def dye_numbers(self) -> _Doubles: ...
    def film_proposals(self) -> tuple[list[float], _Doubles] | None: ...
    def summary(self) -> tuple[int, int, int, int, float, float, float, int, list[int]]: ...

_Answer = tuple[Cube, Cube, list[float]]

@final
class Metamers:
    fluorescent_probability: Final[float]
    def colors(self, light: Illuminant) -> tuple[_Doubles, _Doubles]: ...
    def mean(self, light: Illuminant) -> list[float]: ...
    def band(self, light: Illuminant, answer: Sequence[float], share: float) -> float: ...
    def single(self) -> _Answer: ...
    def mixture(self) -> _Answer: ...
    def missing_ultraviolet(self, light: Illuminant) -> str | None: ...

def metamers(
    contract: Contract,
    lights: Sequence[Illuminant],
    rgb: _Doubles,
    kind: str,
    dyes: DyeSet | None,
    threads: _Threads,
) -> Metamers: ...
def matrix_like(
    cube: Cube, rgb: Sequence[float], measured: DonaldsonMatrix
) -> DonaldsonMatrix: ...
@final
class Colors:
    def xyz(self, rgb: _Singles, threads: _Threads) -> _Singles: ...
    def rgb(self, rgb: _Singles, threads: _Threads) -> _Singles: ...
    def de2000(self, rgb: _Singles, threads: _Threads) -> _Singles: ...

@final
class Reduced:
    def __new__(cls, cube: Cube) -> Reduced: ...
    def light(self, light: Illuminant | None) -> _Doubles: ...
    def matrix(self, cube: Cube, of: _Subjects, threads: _Threads) -> NDArray[Any]: ...
    def without_ultraviolet(self, matrices: _Doubles) -> _Doubles: ...

def build(
    contract: Contract,
    model: Model,
    resolution: int,
    options: tuple[
        str,
        str | None,
        _Limit | None,
        _Limit | None,
        bool | None,
        str | None,
        int | None,
    ],
    threads: _Threads,
    report: _Report | None,
) -> Cube: ...
def fit(cube: Cube, rgb: _Doubles, threads: _Threads, report: _Report | None) -> _Materials: ...
def polish(cube: Cube, rgb: _Singles, threads: _Threads) -> _Materials: ...
def corners(cube: Cube, rgb: _Doubles) -> tuple[NDArray[np.uintp], _Doubles]: ...
def colors(cube: Cube, light: Illuminant | None, scale: str, step_nm: int) -> Colors: ...
def relight(
    cube: Cube,
    rgb: _Doubles,
    lights: Sequence[Illuminant],
    observer: Observer,
    band: bool,
    threads: _Threads,
    report: _Report | None,
) -> tuple[_Doubles, _Doubles, NDArray[np.bool_]]: ...
def first_outside(rgb: _Singles | _Doubles, to_fit: bool) -> tuple[int, str] | None: ...
def spectrum(
    cube: Cube, of: _Subjects, quantity: str, wavelengths_nm: Sequence[float], threads: _Threads
) -> NDArray[Any]: ...
def answer(
    cube: Cube, of: _Subjects, question: str, given: _Doubles, threads: _Threads
) -> NDArray[Any]: ...
def reradiation_matrix(
    cube: Cube, of: _Subjects, grid_nm: Sequence[int], threads: _Threads
) -> _Doubles: ...
def standing(
    contract: Contract, rgb: _Doubles, threads: _Threads
) -> tuple[NDArray[np.uint8], _Doubles, _Doubles]: ...
def verify(
    cube: Cube,
    points: int,
    interpolation: str,
    seed: int,
    threads: _Threads,
    report: _Report | None,
) -> tuple[int, int, bool, list[_Check]]: ...

def chromaticity_diagram(contract: Contract) -> tuple[_Doubles, _Doubles, _Doubles, _Doubles]: ...
def node_colors(cube: Cube, threads: _Threads) -> tuple[_Doubles, _Doubles]: ...
def layer(
    cube: Cube, blue: float, side: int | None, interpolation: str, threads: _Threads
) -> tuple[float, _Doubles, _Doubles, NDArray[np.bool_]]: ...
def dye_spectra(
    model: Model, observer: Observer
) -> tuple[list[str], _Doubles, _Doubles, _Doubles, _Doubles]: ...
def solid_surface(
    contract: Contract, materials: str, steps: int, threads: _Threads
) -> tuple[_Doubles, _Doubles]: ...
def mixed_reflectances(
    first: Sequence[float], second: Sequence[float], mixing: str, shares: Sequence[float]
) -> _Doubles: ...
