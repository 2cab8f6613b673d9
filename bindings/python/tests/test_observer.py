"""Observers: where they come from, what is refused, and what they change."""

from __future__ import annotations

import numpy as np
import pytest

import upglow

ROUNDING = 1e-12
STANDARD = upglow.Observer("cie-1931-2deg")


def bells(nm: np.ndarray) -> np.ndarray:
    """An artificial observer: one Gaussian per channel, shape (n, 3)."""
    return np.exp(-(((nm[:, None] - [600.0, 555.0, 450.0]) / 45.0) ** 2))


@pytest.fixture(scope="module")
def observer() -> upglow.Observer:
    nm = np.arange(380.0, 781.0, 5.0)
    return upglow.Observer((nm, bells(nm)), name="bells")


def test_an_observer_is_a_name_a_file_or_samples(tmp_path) -> None:
    path = tmp_path / "CIE 1931 2°.csv"
    seen = upglow.FINE_NM >= 360
    nm, matching = upglow.FINE_NM[seen], STANDARD.matching[seen]
    rows = "\n".join(f"{n},{x!r},{y!r},{z!r}" for n, (x, y, z) in zip(nm, matching.tolist()))
    path.write_text(f"wavelength_nm,x,y,z\n{rows}\n")
    from_file = upglow.Observer(path)
    from_arrays = upglow.Observer((nm, matching), name=STANDARD.name)
    assert STANDARD == from_file == from_arrays == upglow.Observer(STANDARD)
    assert len({STANDARD, from_file, from_arrays}) == 1
    assert upglow.Contract(observer=str(path)).observer == STANDARD
    assert upglow.Contract().observer.name == "CIE 1931 2°"


def test_functions_are_zero_beyond_the_samples(observer) -> None:
    beyond = (upglow.FINE_NM < 380) | (upglow.FINE_NM > 780)
    assert (observer.matching[beyond] == 0).all() and (observer.matching[~beyond] > 0).any(axis=1).all()


def test_white_is_the_xyz_of_the_light_for_the_observer(observer) -> None:
    contract = upglow.Contract(observer=observer, illuminant="A")
    light = upglow.Illuminant("A").power[::5]
    expected = light @ observer.matching[::5]
    assert np.abs(contract.white_xyz - expected / expected[1]).max() < ROUNDING
    assert np.abs(contract.xyz_from_rgb @ np.ones(3) - contract.white_xyz).max() < ROUNDING


def test_a_cube_matches_its_colors_for_its_observer_and_not_for_another(observer) -> None:
    contract, passive = upglow.Contract(observer=observer), upglow.Reflectance()
    cube = upglow.build(contract, preset="konig2020", resolution=4, model=passive)
    rgb = np.array([0.5, 0.4, 0.3])
    spectrum = cube.reflectance(cube.fit(rgb), upglow.FIT_NM)
    light = upglow.Illuminant("D65").power[::5]
    white = light @ observer.matching[::5]
    seen = (spectrum * light) @ observer.matching[::5] / white[1]
    # The fit counts a color as exact within 0.01 CIEDE2000.
    exact = 2e-5
    assert np.abs(seen - cube.contract.xyz_from_rgb @ rgb).max() < exact
    other = (spectrum * light) @ STANDARD.matching[::5] / (light @ STANDARD.matching[::5, 1])
    assert np.abs(other - upglow.Contract().xyz_from_rgb @ rgb).max() > 1e-3
    assert cube.verify(points=200).holds


def test_grays_are_flat_for_every_observer(observer) -> None:
    cube = upglow.build(upglow.Contract(observer=observer), resolution=3)
    gray = cube.reflectance([0.5, 0.5, 0.5], upglow.FIT_NM)
    assert np.abs(gray - 0.5).max() < 1e-6


def test_the_file_holds_the_observer(observer, tmp_path) -> None:
    contract = upglow.Contract(observer=observer)
    cube = upglow.build(contract, resolution=2, model=upglow.Reflectance())
    path = tmp_path / "cube"
    cube.write(path)
    again = upglow.Cube.read(path)
    assert again.contract.observer == observer and again.to_bytes() == cube.to_bytes()
    from safetensors.numpy import load

    assert np.array_equal(load(cube.to_bytes())["observer"], observer.matching.T)
    standard = upglow.build(resolution=2, model=upglow.Reflectance())
    assert np.array_equal(load(standard.to_bytes())["observer"], standard.contract.observer.matching.T)


NM = np.arange(380.0, 781.0, 5.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: upglow.Observer("hawk"), 'unknown observer "hawk", expected cie-1931-2deg, cie-1964'),
        (lambda: upglow.Observer((NM, np.ones(81))), "observer: wavelengths of shape (81,) and"),
        (lambda: upglow.Observer((NM[9:], bells(NM[9:]))), "custom: covers 425 to 780 nm, expected"),
        (lambda: upglow.Observer((NM[::2], bells(NM[::2]))), "custom: sample 1: 390 nm after 380 nm"),
        (lambda: upglow.Observer((NM, -bells(NM))), "custom: sample 0: -4.1"),
        (lambda: upglow.Observer((NM - 30, bells(NM))), "custom: sample 0: 4.1"),
        (lambda: upglow.Observer((NM, np.ones((81, 3)))), "custom: x, y and z are linearly dependent"),
        (
            lambda: upglow.Contract(
                observer=(NM, bells(NM)), illuminant=upglow.Illuminant.line(365.0, 0.5)
            ),
            "the observer custom sees nothing of the light 365 nm line in sums over 5 nm",
        ),
    ],
)
def test_an_invalid_observer_is_refused(make, message) -> None:
    with pytest.raises(ValueError) as found:
        make()
    assert str(found.value).startswith(message), found.value


def test_another_type_than_a_table_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="observer is int, expected a name, .* a pair .*MultiSpectral"):
        upglow.Observer(7)
    with pytest.raises(FileNotFoundError):
        upglow.Observer("no/such/eye.csv")


def test_a_broken_file_is_named(tmp_path) -> None:
    path = tmp_path / "eye.csv"
    path.write_text("nm,x,y,z\n")
    with pytest.raises(ValueError, match='eye.csv: header "nm,x,y,z", expected "wavelength_nm,x,y'):
        upglow.Contract(observer=path)
