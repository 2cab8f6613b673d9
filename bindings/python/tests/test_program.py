"""The package and the program `upglow` give the same numbers."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

import upglow

# The program prints doubles in full; colors come in single precision here.
ROUNDING = 1e-12
SINGLE = 1e-6
# The last is a little beyond the colors of reflectances.
COLORS = [
    (0.9, 0.1, 0.8),
    (0.5, 0.5, 0.5),
    (0.2, 0.7, 0.1),
    (0.0, 1.0, 0.0),
    (0.13, 0.57, 0.91),
    (0.6337, 0.5123, 0.0043),
]


@pytest.fixture(scope="module")
def file(program: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("cubes") / "cube.safetensors"
    run(program, "build", "--resolution", "5", "--output", str(path))
    return path


def run(program: str, *args: str) -> dict:
    done = subprocess.run(
        [program, "--json", "--quiet", *args], check=True, capture_output=True, text=True
    )
    return json.loads(done.stdout)


def test_both_build_the_same_bytes(file: Path) -> None:
    assert upglow.build(resolution=5).to_bytes() == file.read_bytes()


@pytest.mark.parametrize("rgb", COLORS)
def test_both_find_the_same_material(program: str, file: Path, rgb) -> None:
    cube = upglow.Cube.read(file)
    told = run(program, "color", str(file), *map(str, rgb))
    curves = told["curves"]
    reflectance = cube.reflectance(rgb, curves["wavelengths_nm"])
    assert np.abs(reflectance - curves["reflectance"]).max() < ROUNDING
    assert np.abs(cube.contract.xyz_from_rgb @ rgb - told["xyz"]).max() < ROUNDING
    check = cube.check(rgb)
    # Rounding of the color to single precision, in units of ΔE00.
    assert abs(check.de2000 - told["de2000"]) < 1e-4
    kinds = {"reflectance": 0, "needs_fluorescence": 1, "unreachable": 2}
    standing = told["standing"]
    assert check.kind == kinds[standing.pop("kind")]
    told_beyond = list(standing.values()) or [0.0, 0.0]
    assert np.allclose([check.distance, check.nearest_de2000], told_beyond, rtol=0, atol=ROUNDING)
    weights = np.array([part["weight"] for part in told["parts"]])
    ours = cube.corners(rgb).weights
    assert np.allclose(ours[ours > 0], weights, atol=ROUNDING)


@pytest.mark.parametrize("rgb", COLORS)
def test_both_compute_the_same_color_under_every_light(program: str, file: Path, rgb) -> None:
    cube = upglow.Cube.read(file)
    for light in run(program, "color", str(file), *map(str, rgb))["lights"]:
        is_lamp = light["name"] == "365 nm lamp"
        lamp = upglow.Illuminant.line(365.0, 12.0) if is_lamp else light["name"]
        scale = "power" if is_lamp else "white"
        xyz = cube.xyz(rgb, light=lamp, scale=scale)
        assert np.abs(xyz - light["xyz"]).max() < SINGLE, light["name"]
        found = cube.rgb_under(rgb, lamp, scale=scale)
        assert np.abs(found - light["rgb"]).max() < 4 * SINGLE, light["name"]


def test_both_relight_alike(program: str, file: Path) -> None:
    cube = upglow.Cube.read(file)
    lights = ["D65", "A", "M1"]
    words = [word for light in lights for word in ("--light", light)]
    for observer in ("cie-1931-2deg", "cie-1964-10deg"):
        given = *map(str, COLORS[0]), *words, "--observer", observer
        told = run(program, "relight", str(file), *given)
        relit = cube.relight([COLORS[0]], lights, observer=observer)
        assert relit.xyz.shape == relit.lab.shape == relit.rgb.shape == (3, 1, 3)
        for i, view in enumerate(told["views"]):
            (color,) = view["colors"]
            assert relit.is_adapted[i] == view["is_adapted"]
            assert relit.white[i].tolist() == view["white"]
            assert relit.xyz[i, 0].tolist() == color["xyz"]
            assert relit.rgb[i, 0].tolist() == color["rgb"]
            assert relit.lab[i, 0].tolist() == list(color["lab"].values())
            assert relit.de2000[i, 0] == color["de2000"]
            assert relit.fluorescent_share[i, 0] == color["fluorescent_share"]
            assert np.isnan(relit.whiteness[i, 0]) == (color["whiteness"] is None)


@pytest.mark.parametrize("answer", ["single", "mixture"])
@pytest.mark.parametrize("kind", ["any", "fluorescent"])
def test_both_find_the_same_metamers(program: str, file: Path, tmp_path: Path, kind, answer) -> None:
    rgb, a = [0.9, 0.3, 0.02], [0.8, 0.3, 0.05]
    written = tmp_path / "paint.safetensors"
    words = ["--kind", kind, "--answer", answer, "--output", str(written)]
    words += ["--known", "A", *map(str, a), "--light", "A", "--light", "E"]
    told = run(program, "color", str(file), *map(str, rgb), *words)
    found = upglow.metamers(rgb, known={"A": a}, kind=kind)
    assert found.fluorescent_probability == told["paint"]["fluorescent_probability"]
    material = getattr(found, answer)
    assert [light["name"] for light in told["lights"]] == ["D65", "A", "E"]
    for light in told["lights"]:
        seen = material.relight([light["name"]])
        assert np.abs(seen.xyz[0] - light["xyz"]).max() < ROUNDING
        assert abs(seen.fluorescent_share[0] - light["fluorescent_share"]) < ROUNDING
        assert found.band(light["name"], light["xyz"]) == light["band_de2000"]
    curves = told["curves"]
    reflectance = material.reflectance(curves["wavelengths_nm"])
    assert np.abs(reflectance - curves["reflectance"]).max() < ROUNDING
    assert found.single.cube().to_bytes() == written.read_bytes()


def test_both_show_the_same_band(program: str, file: Path) -> None:
    rgb = [0.4, 0.2, 0.05]
    told = run(program, "relight", str(file), *map(str, rgb), "--band", "--light", "D65", "--light", "A")
    stages: list[tuple[str, int, int]] = []
    relit = upglow.Cube.read(file).relight(
        [rgb], ["D65", "A"], band=True, progress=lambda *stage: stages.append(stage)
    )
    bands = [view["colors"][0]["band_de2000"] for view in told["views"]]
    assert relit.band_de2000[:, 0].tolist() == bands
    assert stages == [("searching materials", 0, 1)]
    assert np.isnan(upglow.Cube.read(file).relight(rgb, ["A"]).band_de2000).all()


def test_both_fit_the_same_material(program: str, file: Path) -> None:
    cube = upglow.Cube.read(file)
    told = run(program, "color", str(file), "0.9", "0.1", "0.8", "--direct")
    fit = cube.fit([0.9, 0.1, 0.8])
    curves = told["curves"]
    # The package's materials are stored in single precision.
    found = cube.reflectance(fit, curves["wavelengths_nm"])
    assert np.abs(found - curves["reflectance"]).max() < 1e-5
    assert abs(fit.de2000 - told["de2000"]) < 1e-4


def test_both_verify_alike(program: str, file: Path) -> None:
    told = run(program, "verify", str(file), "--points", "2000", "--seed", "3")
    report = upglow.Cube.read(file).verify(points=2000, seed=3)
    assert report.holds == told["holds"]
    for ours, theirs in zip(report.checks, told["checks"], strict=True):
        assert (ours.name, ours.verdict, ours.checked) == (
            theirs["name"], theirs["verdict"], theirs["checked"],
        )
        assert ours.value == pytest.approx(theirs["value"], rel=1e-12, nan_ok=True)


def test_both_refuse_in_the_same_words(program: str, file: Path) -> None:
    done = subprocess.run(
        [program, "build", "--resolution", "2", "--output", "x", "--slope-max-per-nm", "1"],
        capture_output=True, text=True, check=False,
    )
    with pytest.raises(ValueError) as refused:
        upglow.build(resolution=2, slope_max_per_nm=1.0)
    assert str(refused.value) in done.stderr
