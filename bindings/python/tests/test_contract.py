"""What RGB means: spaces, lights, adaptation."""

from __future__ import annotations

import numpy as np
import pytest

import upglow

ROUNDING = 1e-12


def test_white_is_the_perfect_diffuser_in_every_space() -> None:
    for space in upglow.Contract.spaces():
        contract = upglow.Contract(space=space, illuminant="D50")
        white = contract.xyz_from_rgb @ np.ones(3)
        assert np.abs(white - contract.white_xyz).max() < ROUNDING, space


def test_without_adaptation_the_diffuser_has_the_published_acescg_values() -> None:
    contract = upglow.Contract(adaptation="none")
    diffuser = contract.rgb_from_xyz @ contract.white_xyz
    # Five printed digits.
    assert np.abs(diffuser - [0.97748, 1.00279, 1.07919]).max() < 1e-5


def test_eight_numbers_are_a_space() -> None:
    rec709 = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290]
    custom, srgb = upglow.Contract(space=rec709), upglow.Contract(space="sRGB")
    assert custom.space == "custom"
    assert np.array_equal(custom.xyz_from_rgb, srgb.xyz_from_rgb)
    assert np.array_equal(custom.primaries_xy, np.reshape(rec709[:6], (3, 2)))
    assert np.array_equal(custom.white_xy, rec709[6:])


def test_a_light_is_a_name_a_file_or_samples(tmp_path) -> None:
    d50 = upglow.Illuminant("d50")
    path = tmp_path / "D50.csv"
    rows = "\n".join(f"{nm},{p!r}" for nm, p in zip(upglow.FINE_NM, d50.power.tolist()))
    path.write_text(f"wavelength_nm,power\n{rows}\n")
    from_file = upglow.Illuminant(path)
    from_arrays = upglow.Illuminant((upglow.FINE_NM, d50.power), name="D50")
    assert d50 == from_file == from_arrays == upglow.Illuminant(d50)
    assert len({d50, from_file, from_arrays}) == 1
    assert upglow.Contract(illuminant=str(path)).illuminant.name == "D50"


def test_a_light_of_other_numbers_never_has_a_built_in_name(tmp_path) -> None:
    flat = (upglow.FINE_NM, np.ones(upglow.FINE_NM.size))
    path = tmp_path / "A.csv"
    path.write_text("wavelength_nm,power\n" + "".join(f"{nm:g},1\n" for nm in flat[0]))
    assert upglow.Illuminant(path).name == "A.csv"
    assert upglow.Illuminant(path, name="lamp").name == "lamp"
    for make in (
        lambda: upglow.Illuminant(flat, name="a"),
        lambda: upglow.Illuminant(path, name="D65"),
        lambda: upglow.Illuminant.line(450, 20, name="E"),
    ):
        with pytest.raises(ValueError, match="is a built-in illuminant whose power at 300 nm is"):
            make()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: upglow.Contract(space="x"), 'unknown RGB space "x", expected acescg, '),
        (lambda: upglow.Contract(space=[1, 2]), "space has 2 numbers, expected a name or eight"),
        (lambda: upglow.Contract(space=[0.3] * 8), "the three primaries lie on one line"),
        (lambda: upglow.Contract(adaptation="x"), 'unknown adaptation "x", expected bradford or'),
        (lambda: upglow.Contract(illuminant="F11"), 'unknown illuminant "F11", expected D50, '),
        (lambda: upglow.Illuminant(([380, 780], [1, 1])), "custom: sample 1: 780 nm after"),
        (
            lambda: upglow.Illuminant((upglow.FIT_NM[16:], np.ones(91))),
            "custom: covers 380 to 830 nm, expected at least 300 to 830 nm",
        ),
        (lambda: upglow.Illuminant((upglow.FIT_NM, -np.ones(107))), "custom: sample 0: -1 in"),
        (lambda: upglow.Illuminant((upglow.FIT_NM, np.ones(3))), "illuminant: wavelengths of shape"),
        (lambda: upglow.Illuminant((upglow.FIT_NM, np.zeros(107))), "custom: no power"),
        (lambda: upglow.Illuminant.line(float("nan"), 10), "peak_nm is NaN, expected a finite"),
        (lambda: upglow.Illuminant.line(365, 0), "fwhm_nm is 0, expected 0.001 or more"),
        (lambda: upglow.Illuminant.line(-1e9, 1), "no power between 360 and 830 nm"),
    ],
)
def test_an_invalid_contract_is_refused(make, message) -> None:
    with pytest.raises(ValueError) as found:
        make()
    assert str(found.value).startswith(message), found.value


def test_another_type_than_a_spectrum_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="illuminant is int, expected a name, a path, an Illuminant, a pair"):
        upglow.Illuminant(7)
    with pytest.raises(FileNotFoundError):
        upglow.Illuminant("no/such/light.csv")


def test_a_light_that_ends_early_needs_ends(tmp_path) -> None:
    nm = np.arange(380.0, 781.0, 5.0)
    path = tmp_path / "lamp.csv"
    rows = "\n".join(f"{each:g},2" for each in nm)
    path.write_text(f"wavelength_nm,power\n{rows}\n")
    hint = '; Illuminant(…, ends="zero") or "hold" says what is beyond'
    for source, place in (((nm, 2 * np.ones(81)), "custom"), (path, str(path))):
        with pytest.raises(ValueError) as found:
            upglow.Illuminant(source)
        told = "covers 380 to 780 nm, expected at least 300 to 830 nm"
        assert str(found.value) == f"{place}: {told}{hint}"
        zero, hold = (upglow.Illuminant(source, ends=ends) for ends in ("zero", "hold"))
        assert (zero.given_nm, hold.given_nm) == ((380, 780), (300, 830))
        assert zero.power.sum() == 2 * 401 and (hold.power == 2).all()
    for source in ("D65", upglow.Illuminant("D65")):
        with pytest.raises(ValueError, match="ends='zero' with D65, expected samples or a file"):
            upglow.Illuminant(source, ends="zero")
        with pytest.raises(ValueError, match="name='lamp' with D65, expected samples or a file"):
            upglow.Illuminant(source, name="lamp")
        assert upglow.Illuminant(source, name="D65").name == "D65"
    with pytest.raises(ValueError, match='unknown ends "flat", expected zero or hold'):
        upglow.Illuminant((nm, np.ones(81)), ends="flat")


def test_a_light_without_ultraviolet_is_named_in_a_warning() -> None:
    told = "FL11 is given from 380 nm on: what dyes absorb below is not counted"
    with pytest.warns(UserWarning, match=told):
        cube = upglow.build(upglow.Contract(illuminant="FL11"), resolution=2)
    with pytest.warns(UserWarning, match=told):
        cube.xyz([0.9, 0.0, 0.9])
    with pytest.warns(UserWarning, match=told):
        cube.radiance_factor([0.9, 0.0, 0.9])
    # Neither the light nor the model has anything to say; pytest turns warnings into errors.
    cube.xyz([0.9, 0.0, 0.9], light="ID65")
    flat = upglow.build(model=upglow.Reflectance(), resolution=2)
    flat.xyz([0.5, 0.5, 0.5], light="FL11")


def test_a_broken_file_is_named(tmp_path) -> None:
    path = tmp_path / "light.csv"
    path.write_text("nm,power\n")
    with pytest.raises(ValueError, match='light.csv: header "nm,power", expected "wavelength_nm,p'):
        upglow.Contract(illuminant=path)
