"""Comparison with colour-science, an independent implementation."""

from __future__ import annotations

import sys
import warnings

import numpy as np
import pytest

import upglow

with warnings.catch_warnings():
    # It says which of its optional packages are missing.
    warnings.simplefilter("ignore")
    import colour

# Single precision here; chromaticities of whites, and powers of D65, to their printed digits.
COLOR = 1e-4
# Sums over 5 nm against sums over 1 nm.
GRID = 5e-4
COLORS = np.array(
    [[0.9, 0.1, 0.8], [0.5, 0.5, 0.5], [0.2, 0.7, 0.1], [1.0, 1.0, 1.0], [0.9, 0.45, 0.05]]
)


TWO_DEGREES = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
TEN_DEGREES = colour.MSDS_CMFS["CIE 1964 10 Degree Standard Observer"]


def integrated(
    sd: colour.SpectralDistribution,
    light: np.ndarray,
    functions: colour.MultiSpectralDistributions = TWO_DEGREES,
) -> np.ndarray:
    """XYZ of a spectrum under a light, both over 1 nm; the observer begins at 360 nm."""
    shape = colour.SpectralShape(360, 830, 1)
    observer = functions.copy().align(shape)
    illuminant = colour.SpectralDistribution(light, upglow.FINE_NM).align(shape)
    with warnings.catch_warnings():
        # It says that it aligns the light with the observer.
        warnings.simplefilter("ignore")
        return colour.sd_to_XYZ(sd.copy().align(shape), observer, illuminant) / 100.0


@pytest.mark.parametrize("name", ["D65", "A", "E", "D50"])
@pytest.mark.parametrize("rgb", COLORS)
def test_spectra_integrate_to_the_same_color(cube, rgb, name) -> None:
    light = upglow.Illuminant(name)
    sd = cube.spectral_distribution(rgb, upglow.FINE_NM, light=light)
    assert isinstance(sd, colour.SpectralDistribution)
    expected = integrated(sd, light.power)
    assert np.abs(cube.xyz(rgb, light=light, step_nm=1) - expected).max() < COLOR


@pytest.fixture(scope="module")
def cube_10deg() -> upglow.Cube:
    """ACEScg under D65 for colour-science's 10° observer."""
    return upglow.build(upglow.Contract(observer=TEN_DEGREES), resolution=5)


@pytest.mark.parametrize("name", ["D65", "A"])
@pytest.mark.parametrize("rgb", COLORS)
def test_its_observers_see_the_same_color(cube_10deg, rgb, name) -> None:
    light = upglow.Illuminant(name)
    sd = cube_10deg.spectral_distribution(rgb, upglow.FINE_NM, light=light)
    expected = integrated(sd, light.power, TEN_DEGREES)
    found = cube_10deg.xyz(rgb, light=light, step_nm=1)
    assert np.abs(found - expected).max() < COLOR
    # The colors differ from those of the 2° observer, except black.
    assert np.abs(found - integrated(sd, light.power)).max() > 10 * COLOR


def test_its_observers_keep_their_names_and_whites() -> None:
    contract = upglow.Contract(observer=TEN_DEGREES)
    assert contract.observer.name == TEN_DEGREES.name
    white = contract.white_xyz / contract.white_xyz.sum()
    published = colour.CCS_ILLUMINANTS[TEN_DEGREES.name]["D65"]
    # Sums over 5 nm here, over 5 nm from 380 to 780 nm there.
    assert np.abs(white[:2] - published).max() < 2 * COLOR


def test_its_observer_is_ours() -> None:
    theirs = upglow.Observer(TWO_DEGREES)
    assert np.abs(theirs.matching - upglow.Contract().observer.matching).max() < 1e-12


def test_sums_over_5_nm_are_near_sums_over_1_nm(cube) -> None:
    assert np.abs(cube.xyz(COLORS) - cube.xyz(COLORS, step_nm=1)).max() < GRID


def test_d65_is_colour_sciences() -> None:
    theirs = colour.SDS_ILLUMINANTS["D65"]
    ours = np.interp(theirs.wavelengths, upglow.FINE_NM, upglow.Illuminant("D65").power)
    # Powers up to 118 in six printed digits, one of them rounded otherwise.
    assert np.abs(theirs.values - ours).max() < 1e-3


def test_its_lamps_and_observers_are_ours() -> None:
    lamps = [name for name in upglow.Illuminant.names() if name in colour.SDS_ILLUMINANTS]
    lamps = [name for name in lamps if name[0] in "FHLI"]
    assert len(lamps) == 43
    for name in lamps:
        ours = upglow.Illuminant(name)
        theirs = upglow.Illuminant(colour.SDS_ILLUMINANTS[name], ends="zero")
        assert (theirs.name, theirs.given_nm) == (name, ours.given_nm)
        assert np.abs(theirs.power - ours.power).max() < 1e-9
    for ours, theirs in (
        ("cie-1964-10deg", "CIE 1964 10 Degree Standard Observer"),
        ("cie-2015-2deg", "CIE 2015 2 Degree Standard Observer"),
        ("cie-2015-10deg", "CIE 2015 10 Degree Standard Observer"),
    ):
        difference = upglow.Observer(colour.MSDS_CMFS[theirs]).matching
        assert np.abs(difference - upglow.Observer(ours).matching).max() < 1e-12


def test_the_contract_is_colour_sciences(cube) -> None:
    space = colour.RGB_COLOURSPACES["ACEScg"]
    assert np.allclose(cube.contract.primaries_xy, space.primaries)
    assert np.allclose(cube.contract.white_xy, space.whitepoint, atol=1e-5)
    expected = colour.RGB_to_XYZ(
        COLORS, space, illuminant=cube.contract.white_xyz[:2] / cube.contract.white_xyz.sum(),
        chromatic_adaptation_transform="Bradford", apply_cctf_decoding=False,
    )
    # Chromaticities of the white to the digits that they are printed with.
    assert np.abs(COLORS @ cube.contract.xyz_from_rgb.T - expected).max() < COLOR


def test_its_lights_are_taken_once_they_cover_the_range(cube) -> None:
    light = colour.SDS_ILLUMINANTS["D65"]
    with pytest.raises(ValueError, match="D65: covers 300 to 780 nm, expected at least"):
        upglow.Contract(illuminant=light)
    longer = upglow.Illuminant(light, ends="hold")
    # From 781 nm on it is not D65.
    assert longer.name == f"{light.name} (samples)"
    assert np.abs(cube.xyz(COLORS, light=longer) - cube.xyz(COLORS)).max() < COLOR


def test_its_spectra_are_taken_as_dyes() -> None:
    nm = np.arange(300.0, 831.0)
    bell = lambda center: np.exp(-(((nm - center) / 25) ** 2))  # noqa: E731
    sd = lambda center: colour.SpectralDistribution(bell(center), nm)  # noqa: E731
    dye = upglow.Dye(name="x", absorption=sd(500.0), emission=sd(540.0), quantum_yield=0.9)
    cube = upglow.build(model=upglow.Dyes(set=[dye], quantum_yield="measured"), resolution=2)
    assert cube.dye_names == ["x"]
    assert np.allclose(cube.dye_curves[0, 0], bell(500.0))


def test_one_color_a_spectrum(cube) -> None:
    with pytest.raises(ValueError, match=r"rgb has shape \(5, 3\), expected \(3,\)"):
        cube.spectral_distribution(COLORS)


def test_without_colour_science_the_package_is_named(cube, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "colour", None)
    with pytest.raises(ImportError, match="needs the package colour-science"):
        cube.spectral_distribution(COLORS[0])
