"""Cubes in Dr.Jit against the library: values, and draws of wavelengths."""

from __future__ import annotations

import host
import numpy as np
import pytest
from reader import rewritten

import upglow

mi = pytest.importorskip("mitsuba", reason="needs the package mitsuba")

COUNT = 4000
DRAWS = 200_000
# Single precision, a sum of four materials: half a dozen roundings of a number up to 1.
VALUE_TOL = 1e-6
# Edge (nm), level and slope (1/nm) for which single precision overflows or cancels all digits, up to the
# greatest that a file may hold.
STRANGE = [
    (-3e5, 1.0, 1e-6),
    (1.5e5, 1.0, 1e-6),
    (2e6, 1.0, 1e-6),
    (550.0, 1e10, 0.01),
    (550.0, -1e10, -0.01),
    (9.9e17, 0.5, 0.01),
    (550.0, 0.5, 1e3),
    (-9.9e17, -1e10, 1e3),
]
# Single precision of numbers near 10 under the root.
STRANGE_TOL = 1e-5
# The same of densities up to 0.03 per nm.
DENSITY_TOL = 1e-7
# Draws in 53 bins: the worst bin exceeds this many standard errors once in 10 000 runs.
WORST_BIN = 4.8


@pytest.fixture(autouse=True)
def variant() -> None:
    host.renderer()


@pytest.fixture
def jit_cube(any_cube):
    from upglow.mitsuba._jit_cube import JitCube

    return JitCube(any_cube)


def colors(rng: np.random.Generator) -> tuple[np.ndarray, object]:
    """Random colors, of which some lie on borders between tetrahedra, as arrays of both kinds."""
    rgb = rng.random((COUNT, 3), dtype=np.float32)
    rgb[:100] = np.round(rgb[:100] * 8) / 8
    rgb[100:120] = rgb[100:120, :1]
    return rgb.astype(np.float64), mi.Color3f(np.ascontiguousarray(rgb.T))


def wavelengths(rng: np.random.Generator) -> tuple[np.ndarray, object]:
    nm = rng.uniform(290, 840, COUNT).astype(np.float32)
    return nm.astype(np.float64), mi.Float(nm)


def test_reflectance_is_the_library_s(any_cube, jit_cube, rng) -> None:
    (rgb, color), (nm, at) = colors(rng), wavelengths(rng)
    ask = any_cube.reflectance
    expected = np.array([ask(one, one_nm) for one, one_nm in zip(rgb, nm, strict=True)])
    found = np.array(jit_cube.reflectance(color, at))
    assert np.abs(found - expected).max() < VALUE_TOL


def test_edges_far_from_all_light_and_huge_levels_are_the_library_s(rng) -> None:
    from upglow.mitsuba._jit_cube import JitCube

    content = upglow.build(model=upglow.Reflectance(), resolution=2).to_bytes()
    nodes = np.array(STRANGE, np.float32).reshape(2, 2, 2, 3)
    cube = upglow.Cube.from_bytes(rewritten(content, reflectance=nodes))
    jit = JitCube(cube)
    corners = np.array([[r, g, b] for b in (0, 1) for g in (0, 1) for r in (0, 1)], np.float32)
    for rgb in (*corners, *rng.random((100, 3), dtype=np.float32)):
        nm = rng.uniform(300, 830, 50).astype(np.float32)
        expected = cube.reflectance(rgb, nm)
        found = np.array(jit.reflectance(mi.Color3f(*rgb.tolist()), mi.Float(nm)))
        assert np.abs(found - expected).max() < STRANGE_TOL, rgb
    # For edges that are merely far away, double precision agrees.
    exact = cube.reflectance(corners[:3].astype(np.float64), [300.0, 550.0, 830.0])
    assert np.abs(cube.reflectance(corners[:3], [300, 550, 830]) - exact).max() < STRANGE_TOL


def test_reradiation_is_the_library_s(any_cube, jit_cube, rng) -> None:
    (rgb, color), (in_nm, start), (out_nm, end) = colors(rng), wavelengths(rng), wavelengths(rng)
    expected = any_cube.reradiation(rgb, in_nm, out_nm)
    found = np.array(jit_cube.reradiation(color, start, end)) + np.zeros(COUNT)
    assert np.abs(found - expected).max() < DENSITY_TOL
    assert expected.max() > 1e-3 or any_cube.model == "reflectance"


def test_the_answer_for_a_spectrum_is_that_for_each_wavelength(jit_cube, rng) -> None:
    color, nm = mi.Color3f(0.4, 1.0, 0.8), mi.Spectrum(420, 480, 540, 600)
    ask = jit_cube.reflectance
    for one, whole in zip(nm, ask(color, nm), strict=True):
        assert np.array(ask(color, mi.Float(one))) == np.array(whole)


@pytest.mark.parametrize("lamp_nm", [None, 450.0])
def test_draws_are_worth_the_reradiation(any_cube, jit_cube, rng, lamp_nm) -> None:
    lamps = None if lamp_nm is None else lamps_of(upglow.Illuminant.line(lamp_nm, 20.0))
    out_nm, bins = 600.0, np.arange(300, 831, 10)
    u = rng.random((2, DRAWS), dtype=np.float32)
    known = out_nm + mi.Float(np.zeros(DRAWS, np.float32))
    color = mi.Color3f(0.9, 0.1, 0.8)
    drawn = jit_cube.fluorescence(lamps)(color, known, mi.Float(u[0]), mi.Float(u[1]))
    throughput, nm = (np.array(part, dtype=np.float64) for part in drawn)
    if any_cube.model == "reflectance":
        assert not throughput.any() and (nm == out_nm).all()
        return
    assert np.isfinite(throughput).all() and throughput.min() >= 0
    at = np.arange(300, 830.1, 0.25)
    density = any_cube.reradiation([0.9, 0.1, 0.8], at, out_nm)
    areas = np.concatenate([[0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(at))])
    expected = np.diff(np.interp(bins, at, areas))
    sums = np.histogram(nm, bins, weights=throughput)[0] / DRAWS
    squares = np.histogram(nm, bins, weights=throughput**2)[0] / DRAWS
    error = np.sqrt(np.maximum(squares - sums**2, 0) / DRAWS)
    # Only bins with a thousandth of the draws: in others the standard error is not reliable.
    is_filled = np.histogram(nm, bins)[0] > DRAWS / 1000
    assert is_filled.sum() >= 3
    away = np.abs(sums - expected) - VALUE_TOL
    assert (away < WORST_BIN * error)[is_filled].all()
    assert expected[~is_filled].sum() < 0.05 * expected.sum()


def lamps_of(light: upglow.Illuminant):
    """The lamps of a scene with one light."""
    from upglow.mitsuba import spectrum
    from upglow.mitsuba._lamps import Lamps

    radiance = spectrum(light)
    return Lamps(mi.load_dict({"type": "scene", "e": {"type": "constant", "radiance": radiance}}))
