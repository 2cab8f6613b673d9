"""Arguments of another kind are errors that name them and say what is expected."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import upglow

GRAY = [0.5, 0.5, 0.5]
CURVE = (upglow.FIT_NM, np.ones(107))
BANDS = np.arange(380.0, 781.0, 10.0)
CUBE = upglow.build(model=upglow.Reflectance(), resolution=2)


def dye(**changes: Any) -> upglow.Dye:
    return upglow.Dye(**({"name": "x", "absorption": CURVE, "emission": CURVE} | changes))


def matrix(**changes: Any) -> upglow.DonaldsonMatrix:
    given = {"values": np.eye(41), "unit": "per band"} | changes
    return upglow.DonaldsonMatrix(BANDS, BANDS, **given)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: upglow.Contract(space=3), "space is int, expected a name or eight numbers"),
        (lambda: upglow.Contract(space=["a"] * 8), "space has dtype <U1, expected numbers"),
        (lambda: upglow.Contract(adaptation=1), "adaptation is int, expected bradford or none"),
        (lambda: upglow.Contract(illuminant=None), "illuminant is NoneType, expected a name, a path"),
        (lambda: upglow.Contract(observer=upglow.Illuminant("A")), "observer is Illuminant, expected"),
        (lambda: upglow.Illuminant({400: 1, 500: 2}), "illuminant is dict, expected a name, a path"),
        (lambda: upglow.Illuminant([1, 2, 3]), "illuminant has 3 items, expected a name, a path"),
        (lambda: upglow.Illuminant(CURVE, name=1), "name is int, expected a text"),
        (lambda: upglow.Illuminant(CURVE, ends=1), "ends is int, expected zero or hold"),
        (lambda: upglow.Illuminant.line("x", 2), "peak_nm is str, expected a number"),
        (lambda: upglow.build("acescg"), "contract is str, expected a Contract"),
        (lambda: upglow.build(model="film"), "model is str, expected Film(…), Dyes(…), Analytic"),
        (lambda: upglow.build(model=upglow.Film), "model is the class Film, expected Film(…), "),
        (lambda: upglow.build(resolution=9.0), "resolution is float, expected a whole number"),
        (lambda: upglow.build(preset=1), "preset is int, expected natural, konig2020, jung2019 or"),
        (lambda: upglow.build(slope_max_per_nm=[1]), "slope_max_per_nm is list, expected a number, No"),
        (lambda: upglow.build(relaxed="yes"), "relaxed is str, expected a bool"),
        (lambda: upglow.build(sweeps="2"), "sweeps is str, expected a whole number"),
        (lambda: upglow.build(metric=2), "metric is int, expected de2000, de76 or rgb"),
        (lambda: upglow.build(threads="2"), "threads is str, expected a whole number or None"),
        (lambda: upglow.standing(GRAY, "srgb"), "contract is str, expected a Contract"),
        (lambda: upglow.standing(GRAY, threads=1.0), "threads is float, expected a whole number or"),
        (lambda: CUBE.xyz("abc"), "rgb has dtype <U3, expected numbers"),
        (lambda: CUBE.xyz(None), "rgb is NoneType, expected numbers"),
        (lambda: CUBE.xyz(CUBE.nodes), "rgb is Materials, expected numbers"),
        (lambda: CUBE.xyz(GRAY, light=65), "illuminant is int, expected a name, a path"),
        (lambda: CUBE.xyz(GRAY, scale=1), "scale is int, expected white or power"),
        (lambda: CUBE.xyz(GRAY, step_nm="5"), "step_nm is str, expected a whole number"),
        (lambda: CUBE.relight(GRAY, "FL2"), "lights is str, expected a list of lights"),
        (lambda: CUBE.relight(GRAY, upglow.Illuminant("A")), "lights is Illuminant, expected a list"),
        (lambda: CUBE.relight(GRAY, ["A"], band=1), "band is int, expected a bool"),
        (lambda: upglow.metamers(None), "rgb is NoneType, expected numbers"),
        (lambda: upglow.metamers(GRAY, "srgb"), "contract is str, expected a Contract"),
        (lambda: upglow.metamers(GRAY, known="A"), "known is str, expected {light: rgb} or a list"),
        (lambda: upglow.metamers(GRAY, known=["A"]), "known[0] is str, expected a pair (light, rgb)"),
        (lambda: upglow.metamers(GRAY, known={"A": "abc"}), "the color under A has dtype <U3, expected n"),
        (lambda: upglow.metamers(GRAY, kind=1), "kind of paint is int, expected any, ordinary or"),
        (lambda: upglow.metamers(GRAY, dyes=3), "the set of dyes is int, expected a name, a folder"),
        (lambda: CUBE.reflectance(GRAY, None), "wavelengths_nm is NoneType, expected numbers"),
        (lambda: CUBE.reradiation(GRAY, "a", 3.0), "in_nm has dtype <U1, expected numbers"),
        (lambda: CUBE.verify(points="1"), "points is str, expected a whole number"),
        (lambda: CUBE.verify(interpolation=2), "interpolation is int, expected blend, none, coeff"),
        (lambda: upglow.Film(set=3).names(), "the set of dyes is int, expected a name, a folder or"),
        (lambda: upglow.Film(set=["a"]).names(), "dye 0 is str, expected a Dye"),
        (lambda: upglow.Film(set=[dye(absorption=1)]).names(), "absorption of x is int, expected a pa"),
        (lambda: upglow.Film(set=[dye(name=3)]).names(), "name of a dye is int, expected a text"),
        (
            lambda: upglow.build(model=upglow.Film(quantum_yield=None)),
            "quantum_yield is NoneType, expected a number or 'measured'",
        ),
        (
            lambda: upglow.build(model=upglow.Dyes(optical_density="x")),
            "optical_density is str, expected a number or None",
        ),
        (
            lambda: upglow.build(model=upglow.Analytic(emission_fwhm_nm="x")),
            "emission_fwhm_nm is str, expected a number",
        ),
        (lambda: matrix(unit=3), "unit of re-radiation is int, expected per band or per nm"),
        (lambda: matrix(values="x"), "values has dtype <U1, expected numbers"),
        (lambda: matrix(reflectance=3), "reflectance is int, expected a pair (wavelengths_nm, values)"),
        (lambda: upglow.fit_matrix(np.eye(3)), "measured is ndarray, expected a DonaldsonMatrix"),
        (lambda: upglow.figures.layer(3, 0.5), "cube is int, expected a Cube"),
        (lambda: upglow.figures.node_colors(3), "cube is int, expected a Cube"),
        (lambda: upglow.figures.dyes("x"), "source is str, expected Dyes or a Cube"),
    ],
)
def test_another_kind_is_a_type_error(make: Callable[[], Any], message: str) -> None:
    with pytest.raises(TypeError) as found:
        make()
    assert str(found.value).startswith(message), found.value


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: upglow.build(resolution=-1), "resolution is -1, expected 0 or more"),
        (lambda: CUBE.xyz(GRAY, threads=-1), "threads is -1, expected 1 to 1024"),
        (lambda: CUBE.verify(seed=-1), "seed is -1, expected 0 or more"),
        (lambda: CUBE.xyz([[0.1, 0.2, 0.3], [0.1]]), "rgb has rows of different lengths, expected"),
    ],
)
def test_a_number_out_of_range_is_a_value_error(make: Callable[[], Any], message: str) -> None:
    with pytest.raises(ValueError) as found:
        make()
    assert str(found.value).startswith(message), found.value


def test_numbers_of_numpy_are_numbers() -> None:
    cube = upglow.build(model=upglow.Reflectance(), resolution=np.int64(2), sweeps=np.uint8(1))
    assert cube.resolution == 2
    lamp = upglow.Illuminant.line(np.float32(450.0), np.int64(10))
    assert lamp == upglow.Illuminant.line(450.0, 10.0)
