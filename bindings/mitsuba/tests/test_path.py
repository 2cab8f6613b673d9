"""The integrator `upglow_path`: films agree with the cube's colors."""

from __future__ import annotations

import os
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
import pytest
import upglow
from numpy.typing import NDArray
from plane import NM, film, mean_and_error, normalized, observer, pixels, scene, sky

pytestmark = pytest.mark.usefixtures("scalar")

GREEN, MAGENTA, GRAY = (0.05, 0.9, 0.1), (0.9, 0.05, 0.8), (0.4, 0.4, 0.4)
COLORS = [GREEN, MAGENTA, GRAY]

ERRORS = 4
"""Greatest error of a mean in standard errors: one run in 16,000 exceeds it by chance. The seeds are
fixed, so that results are reproducible."""

OBSERVER = 4e-4
"""Greatest error of Mitsuba's linear interpolation between an observer's values by 5 nm."""

LAMP = upglow.Illuminant.line(385, 15)


def lamp_power() -> NDArray[np.float64]:
    """The lamp with the power that D65 has when a white plane under it has Y = 1."""
    return LAMP.power * normalized(upglow.Illuminant("D65")).sum() / LAMP.power.sum()


def surface(cube_file: str, color: Any) -> dict[str, Any]:
    return {"type": "upglow", "cube": cube_file, "color": list(color)}


def assert_mean(samples: NDArray[np.float64], expected: NDArray[Any]) -> None:
    mean, error = mean_and_error(samples)
    assert (abs(mean - expected) <= ERRORS * error + OBSERVER).all(), (mean, error, expected)


@pytest.mark.parametrize("color", COLORS)
def test_under_daylight_a_plane_has_the_cubes_color(
    color: Any, cube: upglow.Cube, cube_file: str
) -> None:
    light = sky(normalized(upglow.Illuminant("D65")))
    found = pixels(scene(surface(cube_file, color), light, {"type": "upglow_path"}))
    assert_mean(found, cube.xyz(color, step_nm=1))


@pytest.mark.parametrize("color", COLORS)
def test_under_an_ultraviolet_lamp_a_plane_glows_as_the_cube_says(
    color: Any, cube: upglow.Cube, cube_file: str
) -> None:
    light = sky(lamp_power())
    found = pixels(scene(surface(cube_file, color), light, {"type": "upglow_path"}), spp=128)
    assert_mean(found, cube.xyz(color, light=LAMP, scale="power", step_nm=1))


def test_light_from_one_direction_is_shifted_as_well(cube: upglow.Cube, cube_file: str) -> None:
    """Such light is found by emitter sampling only; rays also hit the sky of other tests."""
    spectrum = sky(normalized(upglow.Illuminant("D65")))["radiance"]
    light = {"type": "directional", "direction": [0, 0, -1], "irradiance": spectrum}
    found = pixels(scene(surface(cube_file, GREEN), light, {"type": "upglow_path"}))
    assert_mean(found * np.pi, cube.xyz(GREEN, step_nm=1))


def test_mitsubas_own_integrator_renders_the_reflected_part_alone(
    cube: upglow.Cube, cube_file: str
) -> None:
    power = normalized(upglow.Illuminant("D65"))
    elastic = (cube.reflectance(GREEN, NM) * power) @ observer()
    assert abs(elastic - cube.xyz(GREEN)).max() > 0.05, "the color does not fluoresce"
    found = pixels(scene(surface(cube_file, GREEN), sky(power), {"type": "path"}))
    assert_mean(found, elastic)


def test_inside_a_glowing_box_each_bounce_shifts_what_the_last_one_left(
    cube: upglow.Cube, cube_file: str
) -> None:
    """The series is known: the emission of the walls, after none, one, two and three bounces.

    It is a box because inside a sphere Mitsuba's own `path` is 2 % too bright."""
    moved = cube.reradiation_matrix(GREEN, upglow.FINE_NM)
    light, total = normalized(upglow.Illuminant("D65")), np.zeros(3)
    emitter = {"type": "area", "radiance": sky(light)["radiance"]}
    for _ in range(4):
        total += light @ observer()
        light = moved @ light
    box = {
        "type": "cube",
        "flip_normals": True,
        "emitter": emitter,
        "bsdf": surface(cube_file, GREEN),
    }
    to_world = mi.ScalarTransform4f().look_at([0.3, 0.1, 0], [1, 0.2, 0.4], [0, 0, 1])
    sensor = {"type": "perspective", "to_world": to_world, "film": film(32)}
    integrator = {"type": "upglow_path", "max_depth": 4, "rr_depth": 2}
    made = {"type": "scene", "integrator": integrator, "sensor": sensor, "box": box}
    assert_mean(pixels(mi.load_dict(made), spp=128), total)


@pytest.mark.parametrize("hidden", [False, True])
def test_where_nothing_fluoresces_it_is_mitsubas_own_path_tracer(hidden: bool) -> None:
    """Mitsuba's Cornell box with a ball of glass and a mask with holes; alpha as well as XYZ."""
    box = mi.cornell_box()
    box["large-box"]["bsdf"] = {"type": "dielectric"}
    gray = {"type": "diffuse", "reflectance": {"type": "uniform", "value": 0.5}}
    box["small-box"]["bsdf"] = {
        "type": "mask",
        "opacity": 0.5,
        "bsdf": {"type": "twosided", "one": gray},
    }
    del box["back"]
    box["sensor"]["film"] = film(16) | {"pixel_format": "xyza"}
    means = {}
    for name in ["path", "upglow_path"]:
        box["integrator"] = {"type": name, "hide_emitters": hidden, "max_depth": 8, "rr_depth": 3}
        made = mi.load_dict(box)
        # Pixels have different colors: the error is that between pictures.
        pictures = [np.array(mi.render(made, spp=32, seed=seed)) for seed in range(24)]
        means[name] = mean_and_error(np.array([p.mean(axis=(0, 1)) for p in pictures], dtype=float))
    (one, error), (other, other_error) = means.values()
    assert (abs(one - other) <= ERRORS * np.hypot(error, other_error)).all(), means


@pytest.mark.parametrize("tilt", [0, 180])
def test_both_sides_of_a_twosided_plane_glow(
    tilt: float, cube: upglow.Cube, cube_file: str
) -> None:
    sides = {
        "type": "twosided",
        "front": surface(cube_file, GREEN),
        "back": surface(cube_file, MAGENTA),
    }
    expected = cube.xyz(GREEN if tilt == 0 else MAGENTA, step_nm=1)
    light = sky(normalized(upglow.Illuminant("D65")))
    made = scene(sides, light, {"type": "upglow_path"}, tilt=tilt)
    assert_mean(pixels(made), expected)


def test_fluorescence_behind_another_wrapper_is_warned_of(
    cube_file: str, capfd: pytest.CaptureFixture[str]
) -> None:
    masked = {"type": "mask", "opacity": 1.0, "bsdf": surface(cube_file, GREEN)}
    light = sky(normalized(upglow.Illuminant("D65")))
    pixels(scene(masked, light, {"type": "upglow_path"}, size=2), spp=1)
    out, err = capfd.readouterr()
    assert "fluorescence inside" in out + err


def test_lights_can_be_hidden(cube_file: str) -> None:
    light = sky(normalized(upglow.Illuminant("D65")))
    integrator = {"type": "upglow_path", "hide_emitters": True, "max_depth": 1}
    assert pixels(scene(surface(cube_file, GRAY), light, integrator, size=4)).max() == 0


def test_a_texture_of_one_color_is_that_color(cube_file: str) -> None:
    light, integrator = sky(normalized(upglow.Illuminant("D65"))), {"type": "upglow_path"}
    picture = mi.Bitmap(np.full((2, 2, 3), GREEN, dtype=np.float32))
    texture = {"type": "bitmap", "raw": True, "bitmap": picture}
    constant = pixels(scene(surface(cube_file, GREEN), light, integrator, size=8))
    textured = {"type": "upglow", "cube": cube_file, "color": texture}
    # The texture's filter rounds the color in its last digit.
    np.testing.assert_allclose(
        pixels(scene(textured, light, integrator, size=8)), constant, rtol=1e-5
    )


def test_the_same_seed_gives_the_same_picture_for_any_number_of_threads(cube_file: str) -> None:
    # By default Mitsuba divides a picture by the number of threads, and seeds its parts.
    integrator = {"type": "upglow_path", "block_size": 8}
    light = sky(normalized(upglow.Illuminant("D65")))
    made = scene(surface(cube_file, MAGENTA), light, integrator)
    pictures = []
    for threads in [1, 4]:
        dr.set_thread_count(threads)
        pictures.append(pixels(made, spp=8))
    dr.set_thread_count(os.cpu_count() or 1)
    assert (pictures[0] == pictures[1]).all()
    assert (pixels(made, spp=8, seed=2) != pictures[0]).any()
