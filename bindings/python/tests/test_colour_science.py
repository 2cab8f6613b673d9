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


def test_lights_go_there_and_come_back() -> None:
    narrow = upglow.Illuminant.line(500.0, 0.5)
    lights = [upglow.Illuminant(name) for name in (*upglow.Illuminant.names(), "3000K", "D6200K")]
    for light in (*lights, narrow):
        sd = light.to_colour()
        first, last = light.given_nm
        assert (sd.name, sd.shape) == (light.name, colour.SpectralShape(first, last, 1))
        assert upglow.Illuminant(sd, ends="zero") == light


def test_observers_go_there_and_come_back() -> None:
    for name in upglow.Observer.names():
        observer = upglow.Observer(name)
        msds = observer.to_colour()
        assert (msds.name, msds.labels) == (observer.name, ["x_bar", "y_bar", "z_bar"])
        assert upglow.Observer(msds) == observer
    seen = upglow.Observer("cie-1931-2deg").to_colour()
    assert np.abs(seen.values - TWO_DEGREES.values).max() < 1e-12
    with warnings.catch_warnings():
        # It says that it aligns the light with the observer.
        warnings.simplefilter("ignore")
        white = colour.sd_to_XYZ(colour.sd_ones(seen.shape), seen, upglow.Illuminant("A").to_colour())
    # Sums over 5 nm here.
    assert np.abs(white / 100.0 - upglow.Contract(illuminant="A").white_xyz).max() < GRID


def test_a_distribution_of_another_kind_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="illuminant is XYZ_.*a colour.SpectralDistr"):
        upglow.Illuminant(TWO_DEGREES)
    with pytest.raises(TypeError, match=r"observer is SpectralDistribution.* a colour.MultiSpectral"):
        upglow.Observer(colour.SDS_ILLUMINANTS["A"])


def test_its_spectra_are_taken_as_measured_reflectances() -> None:
    nm = np.arange(380.0, 781.0, 10.0)
    apart = colour.SpectralDistribution(np.full(41, 0.3), nm)
    make = lambda reflectance: upglow.DonaldsonMatrix(  # noqa: E731
        nm, nm, 0.5 * np.eye(41), unit="per band", reflectance=reflectance
    )
    assert np.array_equal(make(apart).per_band, 0.3 * np.eye(41))
    light = upglow.Illuminant("A").to_colour()
    lit = make(apart).color(light, TEN_DEGREES)
    assert np.abs(lit - make((nm, apart.values)).color("A", "cie-1964-10deg")).max() < 1e-12
    with pytest.raises(TypeError, match="reflectance has 41 items, expected a pair"):
        make([(n, 0.3) for n in nm])


def test_spectra_of_many_colors_are_those_of_each(cube) -> None:
    picture = COLORS[:4].reshape(2, 2, 3)
    for quantity in ("radiance_factor", "reflectance"):
        many = cube.spectral_distributions(picture, quantity=quantity)
        assert many.labels == ["0", "1", "2", "3"]
        for label, rgb in zip(many.labels, COLORS, strict=False):
            one = cube.spectral_distribution(rgb, quantity=quantity)
            assert np.array_equal(many.signals[label].values, one.values)
    # What the dyes of a strong magenta emit.
    emitted = cube.spectral_distribution(COLORS[0]) - cube.spectral_distribution(COLORS[0], quantity="reflectance")
    assert emitted.values.min() > -1e-12 and emitted.values.max() > 0.05


def test_spectra_of_materials_are_taken(cube) -> None:
    fitted = cube.fit(COLORS)
    nm = np.arange(400.0, 701.0, 20.0)
    many = cube.spectral_distributions(fitted, nm, quantity="reflectance")
    assert np.array_equal(many.values.T, cube.reflectance(fitted, nm))
    one = cube.spectral_distribution(fitted[1], nm, light="A")
    assert np.array_equal(one.values, cube.radiance_factor(fitted[1], nm, light="A"))


def test_one_color_a_spectrum(cube) -> None:
    with pytest.raises(ValueError, match=r"of has shape \(5,\) of colors, expected one: see"):
        cube.spectral_distribution(COLORS)
    with pytest.raises(ValueError, match="expected radiance_factor or reflectance"):
        cube.spectral_distribution(COLORS[0], quantity="albedo")
    with pytest.raises(ValueError, match="light with the quantity reflectance"):
        cube.spectral_distribution(COLORS[0], quantity="reflectance", light="A")


def test_without_colour_science_the_package_is_named(cube, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "colour", None)
    for ask in (
        lambda: cube.spectral_distribution(COLORS[0]),
        lambda: cube.spectral_distributions(COLORS),
        upglow.Illuminant("A").to_colour,
        upglow.Observer("cie-1931-2deg").to_colour,
    ):
        with pytest.raises(ImportError, match="^this needs colour-science: pip install colour-science$"):
            ask()
