"""Rendered colors against the library's, and the integrator against the renderer's own."""

from __future__ import annotations

import gc
import sys

import host
import numpy as np
import pytest

import upglow

mi = pytest.importorskip("mitsuba", reason="needs the package mitsuba")

MINT, MAGENTA = [0.4, 1.0, 0.8], [0.9, 0.1, 0.8]
LAMP = upglow.Illuminant.line(385.0, 12.0)
# The same sums in another order.
SAME_TOL = 1e-5


@pytest.fixture(autouse=True)
def variant() -> None:
    host.renderer()


@pytest.fixture(scope="session")
def gray_cube() -> upglow.Cube:
    """A cube that does not fluoresce."""
    return upglow.build(model=upglow.Reflectance(), resolution=9)


def surface(cube: upglow.Cube, color) -> dict:
    return {"type": "upglow", "cube": upglow.mitsuba.in_memory(cube), "color": color}


def lights() -> dict[str, dict]:
    return {
        "D65": upglow.mitsuba.spectrum("D65"),
        "lamp": upglow.mitsuba.spectrum(LAMP, 20, by="power"),
    }


def leaving(cube: upglow.Cube, color, light: dict, bounces: int = 1) -> np.ndarray:
    """Radiance over 1 nm of a wall that sees nothing but such light, or such walls."""
    matrix = cube.reradiation_matrix(color, upglow.FINE_NM)
    return np.linalg.matrix_power(matrix, bounces) @ host.light_of(light)


@pytest.mark.parametrize("name", ["D65", "lamp"])
@pytest.mark.parametrize("color", [MINT, MAGENTA], ids=["mint", "magenta"])
def test_a_lit_plane_has_the_color_of_the_library(cube, name, color) -> None:
    light = lights()[name]
    expected = host.xyz_of(leaving(cube, color, light))
    host.assert_mean(host.picture(host.plane(surface(cube, color), light)), expected)
    if name == "D65":
        # The renderer's observer is a table over 5 nm.
        assert np.abs(expected - cube.xyz(color, step_nm=1)).max() < 2e-3


def test_paths_follow_a_narrow_lamp(cube) -> None:
    spp = 64
    luminance = host.picture(host.plane(surface(cube, MINT), lights()["lamp"]), spp=spp)[:, 1]
    noise = luminance.std() / luminance.mean() * spp**0.5
    # Of one sample. It is 0.8 by the wavelengths of the camera that carry no glow; and 4.0 where reflection
    # or fluorescence is chosen without a look at the lamps.
    assert noise < 2


def test_a_cube_without_fluorescence_shows_its_reflectance(gray_cube) -> None:
    light = lights()["D65"]
    expected = host.xyz_of(leaving(gray_cube, MINT, light))
    host.assert_mean(host.picture(host.plane(surface(gray_cube, MINT), light)), expected)


def test_the_renderer_s_own_integrator_shows_the_elastic_part(cube) -> None:
    light = lights()["D65"]
    elastic = cube.reflectance(MINT, upglow.FINE_NM) * host.light_of(light)
    pixels = host.picture(host.plane(surface(cube, MINT), light, type="path"))
    host.assert_mean(pixels, host.xyz_of(elastic))
    assert leaving(cube, MINT, light).sum() > 1.1 * elastic.sum()


def furnace(cube: upglow.Cube, color, light: dict, depth: int) -> dict:
    """A sphere of one material that glows inside, seen from there."""
    return {
        "type": "scene",
        "integrator": {"type": "upglow_path", "max_depth": depth, "rr_depth": 2},
        "sensor": host.sensor([0, 0, 0.5]),
        "wall": {
            "type": "sphere",
            "flip_normals": True,
            "bsdf": surface(cube, color),
            "emitter": {"type": "area", "radiance": light},
        },
    }


@pytest.mark.parametrize("name", ["D65", "lamp"])
def test_a_closed_furnace_has_the_series_of_its_bounces(cube, name) -> None:
    light = lights()[name]
    depth = 4
    total = sum(leaving(cube, MINT, light, bounces) for bounces in range(depth))
    pixels = host.picture(furnace(cube, MINT, light, depth), spp=512)
    host.assert_mean(pixels, host.xyz_of(total))


def series(matrix: np.ndarray, light: np.ndarray, depth: int) -> np.ndarray:
    return sum(np.linalg.matrix_power(matrix, bounces) @ light for bounces in range(depth))


@pytest.mark.parametrize("name", ["D65", "A", "FL11"])
def test_matrices_of_four_numbers_follow_light_from_wall_to_wall(cube, name) -> None:
    colour = pytest.importorskip("colour", reason="needs the package colour-science")
    depth = 4
    light = cube.reduced_light(name)
    white = np.array(cube.contract.white_xyz)
    spectrum = upglow.mitsuba.spectrum(name)
    scale = light[1] / host.xyz_of(host.light_of(spectrum))[1]

    def lab(xyz: np.ndarray) -> np.ndarray:
        # The sum of all bounces of white is `depth` times the light.
        return colour.XYZ_to_Lab(xyz / depth, colour.XYZ_to_xy(light[:3]))

    for color in [MINT, MAGENTA, [0.9, 0.5, 0.1], [0.3, 0.5, 0.4]]:
        rendered = scale * host.picture(furnace(cube, color, spectrum, depth), spp=512).mean(axis=0)
        four = series(cube.reduced_matrix(color), light, depth)[:3]
        to_rgb = cube.contract.rgb_from_xyz
        seen = to_rgb @ np.array(cube.xyz(color)) / (to_rgb @ white)
        three = np.linalg.inv(to_rgb) @ series(np.diag(seen), to_rgb @ light[:3], depth)
        of_four, of_three = (
            float(colour.delta_E(lab(found), lab(rendered), method="CIE 2000"))
            for found in (four, three)
        )
        print(f"furnace of {color} under {name}: 4×4 {of_four:.1f}, RGB {of_three:.1f} ΔE00")
        # What four numbers cannot tell of a spectrum: at most 2.5 was found, and no law says how much.
        assert of_four < 3.0 and of_four < of_three


def texture(numbers: np.ndarray) -> dict:
    """A picture of numbers, which reaches from end to end without repeating."""
    bitmap = mi.Bitmap(np.ascontiguousarray(numbers, np.float32))
    return {"type": "bitmap", "raw": True, "bitmap": bitmap, "wrap_mode": "clamp"}


def facing(normal: list[float], inner: dict) -> dict:
    """A surface with a constant normal other than that of its shape."""
    numbers = np.full((2, 2, 3), 0.5 + 0.5 * np.array(normal))
    return {"type": "normalmap", "normalmap": texture(numbers), "bsdf": inner}


def bumpy(heights: np.ndarray, inner: dict) -> dict:
    return {"type": "bumpmap", "arbitrary": texture(heights[..., None]), "bsdf": inner}


FLAT = np.ones((2, 2))
WRAPPED = {
    "twosided": lambda inner, _: ({"type": "twosided", "bsdf": inner}, 1.0),
    "twosided back": lambda inner, black: ({"type": "twosided", "a": black, "b": inner}, 1.0),
    "blendbsdf": lambda inner, black: (
        {"type": "blendbsdf", "weight": 0.25, "a": inner, "b": black},
        0.75,
    ),
    "mask": lambda inner, _: ({"type": "mask", "opacity": 0.5, "bsdf": inner}, 0.5),
    "twosided blend": lambda inner, _: (
        {
            "type": "twosided",
            "x": {"type": "blendbsdf", "weight": 0.5, "a": inner, "b": {**inner}},
        },
        1.0,
    ),
    "bumpmap": lambda inner, _: (bumpy(FLAT, inner), 1.0),
    "normalmap": lambda inner, _: (facing([0, 0, 1], inner), 1.0),
    "masked blend of bumps": lambda inner, black: (
        {
            "type": "mask",
            "opacity": 0.5,
            "x": {
                "type": "blendbsdf",
                "weight": 0.25,
                "a": bumpy(FLAT, inner),
                "b": facing([0, 0, 1], {"type": "twosided", "a": inner, "b": black}),
            },
        },
        0.5,
    ),
}
"""Surfaces in others, from one that fluoresces and a black one; and the share of the first in the result."""


@pytest.mark.parametrize("kind", WRAPPED)
@pytest.mark.parametrize("name", ["D65", "lamp"])
def test_fluorescence_reaches_through_the_renderer_s_wrappers(cube, kind, name) -> None:
    light = lights()[name]
    bsdf, share = WRAPPED[kind](surface(cube, MINT), {"type": "diffuse", "reflectance": 0.0})
    scene = host.plane(bsdf, light, max_depth=3)
    if kind == "twosided back":
        scene["plane"]["flip_normals"] = True
    behind = host.light_of(light) * 0.5 if "mask" in kind else 0
    expected = host.xyz_of(share * leaving(cube, MINT, light) + behind)
    host.assert_mean(host.picture(scene), expected)


def from_the_side(bsdf: dict, light: dict, **integrator) -> dict:
    """A plane under light of one direction, 37 degrees from its normal."""
    scene = host.plane(bsdf, light, **integrator)
    scene["light"] = {"type": "directional", "irradiance": light, "direction": [-0.6, 0, -0.8]}
    return scene


@pytest.mark.parametrize("kind", ["bumpmap", "normalmap"])
def test_fluorescence_is_shaded_by_the_normals_that_shade_reflection(cube, kind, rng) -> None:
    light, heights = lights()["lamp"], 4 * rng.random((6, 6))

    def turned(inner: dict) -> dict:
        return facing([0.52, 0.2, 0.83], inner) if kind == "normalmap" else bumpy(heights, inner)

    one = {"type": "uniform", "value": 1.0}
    white = {"type": "diffuse", "reflectance": one}
    shading, flat = (
        host.picture(from_the_side(bsdf, one, type="path"))[:, 1:2]
        for bsdf in (turned(white), white)
    )
    cosines = 0.8 * shading / flat
    assert np.abs(cosines - 0.8).mean() > 0.05
    found = host.picture(from_the_side(turned(surface(cube, MINT)), light), spp=1024)
    is_lit = cosines[:, 0] > 0.3
    expected = host.xyz_of(leaving(cube, MINT, light)) / np.pi
    host.assert_mean(found[is_lit] / cosines[is_lit], expected)


@pytest.mark.parametrize(
    "other",
    [
        {"type": "principled", "roughness": 0.3},
        {"type": "roughconductor", "alpha": 0.2},
        {"type": "conductor"},
    ],
    ids=["principled", "roughconductor", "conductor"],
)
def test_a_blend_with_another_kind_of_surface_is_the_sum_of_both(cube, other) -> None:
    light = lights()["lamp"]
    inner = surface(cube, MINT)
    blend = {"type": "blendbsdf", "weight": 0.4, "a": inner, "b": other}
    means, errors = [], []
    for bsdf in (blend, inner, other):
        pixels = host.picture(host.plane(bsdf, light), spp=1024)
        means.append(pixels.mean(axis=0))
        errors.append(pixels.std(axis=0, ddof=1) / len(pixels) ** 0.5)
    shares = np.array([1, -0.6, -0.4])
    allowed = host.ERRORS * np.linalg.norm(shares[:, None] * np.array(errors), axis=0)
    assert (np.abs(shares @ np.array(means)) < allowed).all(), (means, errors)
    assert (allowed < 0.05 * means[0].max()).all(), f"too noisy to say anything: {errors}"


def test_lights_without_size_excite_as_others_do(cube) -> None:
    light = lights()["lamp"]
    scene = host.plane(surface(cube, MINT), light)
    scene["light"] = {"type": "directional", "irradiance": light, "direction": [0, 0, -1]}
    expected = host.xyz_of(leaving(cube, MINT, light)) / np.pi
    host.assert_mean(host.picture(scene), expected)


def box(**replaced) -> dict:
    scene = mi.cornell_box()
    scene["sensor"]["film"] |= {"width": 32, "height": 32, "pixel_format": "rgba"}
    scene["ball"] = {
        "type": "sphere",
        "radius": 0.3,
        "center": [0, 0.4, 0.4],
        "bsdf": {"type": "dielectric"},
    }
    return scene | replaced


@pytest.mark.parametrize("hides", [False, True])
def test_without_fluorescence_it_is_path_sample_by_sample(hides) -> None:
    found = []
    for name in ("path", "upglow_path"):
        integrator = {"type": name, "max_depth": 5, "rr_depth": 3, "hide_emitters": hides}
        scene = mi.load_dict(box(integrator=integrator))
        found.append(np.array(mi.render(scene, spp=4, seed=3)))
    assert np.abs(found[0] - found[1]).max() < SAME_TOL
    assert found[0][..., :3].std() > 0.01


def test_nothing_of_a_scene_is_kept(cube) -> None:
    from upglow.mitsuba._lamps import Lamps
    from upglow.mitsuba._glow import fluorescent_surfaces

    emitter = {"type": "area", "radiance": lights()["D65"]}
    scene = host.plane(surface(cube, MINT), lights()["D65"])
    scene["light"] = {"type": "sphere", "emitter": emitter}
    loaded = mi.load_dict(scene)
    parts = [*loaded.shapes(), *loaded.emitters()]
    counts = [sys.getrefcount(part) for part in parts]
    # What only the collector frees is freed late: a light that outlives its shape crashes the next
    # rendering.
    gc.disable()
    try:
        assert len(fluorescent_surfaces(loaded, Lamps(loaded))) == 1
        assert [sys.getrefcount(part) for part in parts] == counts
    finally:
        gc.enable()


def test_the_same_seed_gives_the_same_bytes(cube) -> None:
    scene = mi.load_dict(host.plane(surface(cube, MINT), lights()["D65"], max_depth=3))
    first, again, other = (host.picture(scene, spp=8, seed=seed) for seed in (1, 1, 2))
    assert first.tobytes() == again.tobytes() != other.tobytes()


def test_a_texture_of_one_color_is_that_color(cube) -> None:
    light = lights()["D65"]
    bitmap = mi.Bitmap(np.full((4, 4, 3), MINT, np.float32))
    texture = {"type": "bitmap", "bitmap": bitmap, "raw": True}
    found = [
        host.picture(host.plane(surface(cube, color), light), spp=16) for color in (MINT, texture)
    ]
    assert np.allclose(*found, rtol=1e-4, atol=SAME_TOL)


def test_an_attribute_of_a_mesh_is_a_color_of_the_cube(cube) -> None:
    light = lights()["D65"]
    color = {"type": "mesh_attribute", "name": "vertex_rgb"}
    holder = mi.Properties()
    holder["bsdf"] = mi.load_dict(surface(cube, color))
    mesh = mi.Mesh("triangle", 3, 1, props=holder)
    numbers = mi.traverse(mesh)
    numbers["vertex_positions"], numbers["faces"] = [-9, -5, 0, 9, -5, 0, 0, 9, 0], [0, 1, 2]
    numbers.update()
    mesh.add_attribute("vertex_rgb", 3, MINT * 3)
    scene = host.plane({"type": "diffuse"}, light)
    scene["plane"] = mesh
    host.assert_mean(host.picture(scene), host.xyz_of(leaving(cube, MINT, light)))


def test_textures_are_filtered_first_and_clamped_to_the_cube(cube) -> None:
    light = lights()["D65"]
    texels = np.array([[[0.2, 1.04, 0.6], [0.6, 0.96, 1.0]]], np.float32)
    texture = {"type": "bitmap", "bitmap": mi.Bitmap(texels), "raw": True, "wrap_mode": "clamp"}
    scene = host.plane(surface(cube, texture), light)
    # Seen from so near that all is halfway between the texels.
    scene["sensor"] = host.sensor([0, 0, 0.02])
    expected = host.xyz_of(leaving(cube, [0.4, 1.0, 0.8], light))
    host.assert_mean(host.picture(scene), expected)


def test_a_color_can_be_edited(cube) -> None:
    light = lights()["D65"]
    scene = mi.load_dict(host.plane(surface(cube, MAGENTA), light))
    params = mi.traverse(scene)
    params["plane.bsdf.color"] = mi.Color3f(*MINT)
    params.update()
    host.assert_mean(host.picture(scene), host.xyz_of(leaving(cube, MINT, light)))


def test_gradients_are_those_of_the_library(cube) -> None:
    import drjit as dr

    light, color, step = lights()["D65"], [0.45, 0.9, 0.8], 1e-3
    scene = mi.load_dict(host.plane(surface(cube, color), light))
    params = mi.traverse(scene)
    params["plane.bsdf.color"] = mi.Color3f(*color)
    tint = params["plane.bsdf.color"]
    dr.enable_grad(tint)
    params.update()
    image = mi.render(scene, params, spp=64)
    dr.backward(dr.mean(image[..., 1]))
    found = np.array(dr.grad(tint)).ravel()
    expected = []
    for axis in range(3):
        ends = []
        for sign in (-1, 1):
            moved = np.array(color)
            moved[axis] += sign * step
            ends.append(host.xyz_of(leaving(cube, moved, light))[1])
        expected.append((ends[1] - ends[0]) / (2 * step))
    assert np.allclose(found, expected, atol=0.02 * np.abs(expected).max()), (found, expected)


def test_one_ray_at_a_time_passes_through_wrappers_too(cube) -> None:
    host.renderer(host.SCALAR)
    light = lights()["D65"]
    black = {"type": "diffuse", "reflectance": 0.0}
    bsdf, share = WRAPPED["masked blend of bumps"](surface(cube, MINT), black)
    scene = host.plane(bsdf, light, max_depth=3)
    scene["sensor"] = host.sensor([0, 0, 2], size=8)
    behind = host.light_of(light) * 0.5
    expected = host.xyz_of(share * leaving(cube, MINT, light) + behind)
    host.assert_mean(host.picture(scene, spp=64), expected)


def test_one_ray_at_a_time_agrees_with_many(cube) -> None:
    expected = host.xyz_of(leaving(cube, MINT, lights()["D65"]))
    host.renderer(host.SCALAR)
    scene = host.plane(surface(cube, MINT), lights()["D65"])
    scene["sensor"] = host.sensor([0, 0, 2], size=8)
    host.assert_mean(host.picture(scene, spp=64), expected)
    # Dividing by zero is an error for one ray, and for many it is not.
    scene = box(integrator={"type": "upglow_path", "rr_depth": 2}, white=surface(cube, MINT))
    pixels = np.array(mi.render(mi.load_dict(scene), spp=1))
    assert np.isfinite(pixels).all() and pixels.std() > 0
