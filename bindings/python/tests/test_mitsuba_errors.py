"""Messages of the plugins for scenes that they cannot render."""

from __future__ import annotations

import subprocess

import host
import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="needs the package mitsuba")

COLOR = '<vector name="color" value="0.9, 0.5, 0.4"/>'


@pytest.fixture
def path(cube, tmp_path) -> str:
    host.renderer(host.SCALAR)
    cube.write(tmp_path / "cube.safetensors")
    return str(tmp_path / "cube.safetensors")


def message(made) -> str:
    """The last line of what loading raises."""
    with pytest.raises(Exception) as raised:  # noqa: PT011
        mi.load_dict(made) if isinstance(made, dict) else mi.load_string(made)
    return str(raised.value).strip().splitlines()[-1]


def xml(inside: str) -> str:
    return f'<scene version="3.0.0"><bsdf type="upglow">{inside}</bsdf></scene>'


def test_xml_and_dictionaries_take_the_same_parameters(path) -> None:
    text = xml(f'<string name="cube" value="{path}"/>{COLOR}')
    bsdf = mi.load_string(text).shapes() or mi.load_dict(
        {"type": "upglow", "cube": path, "color": [0.9, 0.5, 0.4]}
    )
    assert "color = [0.9, 0.5, 0.4]" in str(bsdf) and path in str(bsdf)
    vector = mi.ScalarVector3f(0.9, 0.5, 0.4)
    assert str(mi.load_dict({"type": "upglow", "cube": path, "color": vector})) == str(bsdf)


def test_an_invalid_cube_is_named(path, tmp_path) -> None:
    bsdf = {"type": "upglow", "color": [0.9, 0.5, 0.4]}
    assert message(bsdf).endswith("no cube, expected the path of a cube's file")
    missing = message({**bsdf, "cube": "no-such.safetensors"})
    assert "no-such.safetensors: No such file" in missing
    (tmp_path / "text").write_text("hello")
    assert f"cube {tmp_path / 'text'}: " in message({**bsdf, "cube": str(tmp_path / "text")})
    assert "cube is of type float, expected a path" in message({**bsdf, "cube": 1.0})


@pytest.mark.parametrize(
    ("inside", "told"),
    [
        ("", "no color, expected three numbers linear in acescg"),
        ('<vector name="color" value="0.9, 1.5, 0.4"/>', "color is 0.9, 1.5, 0.4, expected 0 to 1"),
        ('<vector name="color" value="0.9, nan, 0.4"/>', "color is 0.9, nan, 0.4, expected 0 to 1"),
        ('<rgb name="color" value="0.9, 0.5, 0.4"/>', "color is an rgb value, which the renderer"),
        ('<spectrum name="color" value="0.5"/>', "color is a spectrum, which the renderer"),
        ('<float name="color" value="0.5"/>', "color is the number 0.5, expected three numbers"),
        ('<bsdf name="color" type="diffuse"/>', "color is a SmoothDiffuse, expected three numbers"),
        ('<string name="color" value="red"/>', "color is of type String, expected three numbers"),
    ],
)
def test_an_invalid_color_is_refused_in_one_line(path, inside, told) -> None:
    assert told in message(xml(f'<string name="cube" value="{path}"/>{inside}'))


def bitmap(*texels, raw: bool = True) -> dict:
    """A picture of one row."""
    return {"type": "bitmap", "raw": raw, "bitmap": mi.Bitmap(np.array([texels], np.float32))}


def normals(count: int) -> np.ndarray:
    """A normal map of a sphere, in 8 bits."""
    x, y = np.mgrid[-0.7 : 0.7 : count * 1j, -0.7 : 0.7 : count * 1j]
    directions = np.stack([x, y, np.sqrt(1 - x**2 - y**2)], axis=-1)
    return np.round(255 * (0.5 + 0.5 * directions)) / 255


RGB = [0.9, 0.5, 0.4]
SAMPLES = {"wavelength_min": 300.0, "wavelength_max": 830.0, "values": "0.5, 0.5"}
SPECTRA = [
    {"type": "uniform", "value": 0.5},
    {"type": "regular", **SAMPLES},
    {"type": "irregular", "wavelengths": "300, 830", "values": "0.5, 0.5"},
    {"type": "d65"},
    {"type": "blackbody", "temperature": 3000.0},
    {"type": "srgb", "color": RGB},
]
NOT_COLORS = [
    *((spectrum, "color is a spectrum") for spectrum in SPECTRA),
    ({"type": "rgb", "value": RGB}, "which the renderer has already upsampled"),
    (0.5, "color is the number 0.5"),
    (bitmap(RGB, raw=False), "color is a bitmap without raw=true, which the renderer has already"),
    (bitmap([0.5], raw=True), "color is a bitmap of one channel"),
    (bitmap([0.5], raw=False), "color is a bitmap of one channel"),
    ({"type": "checkerboard"}, "color is a Checkerboard, which has no colors of three numbers"),
    ({"type": "rawconstant", "value": 0.5}, "color is a texture of one number"),
    ({"type": "rawconstant", "value": [0.9, 2.0, 0.4]}, "0.9, 2, 0.4 in texel [0], outside 0 to 1"),
    (bitmap(RGB, [0.2, 1.5, 0.6]), "a texture with 0.2, 1.5, 0.6 in texel [0, 1], outside 0 to 1"),
    (bitmap(RGB, [-0.1, 1, 0.6]), "a texture with -0.1, 1, 0.6 in texel [0, 1], outside 0 to 1"),
    (bitmap([0.2, np.nan, 0.6]), "a texture with 0.2, nan, 0.6 in texel [0, 0], outside 0 to 1"),
    (bitmap([np.inf, 0, 0]), "a texture with inf, 0, 0 in texel [0, 0], outside 0 to 1"),
    ({"type": "mesh_attribute", "name": "vertex_color"}, "(vertex_rgb would keep its numbers)"),
    (bitmap(*normals(9).reshape(-1, 3)), "color is a normal map: its texels are vectors of length"),
]


@pytest.mark.parametrize("variant", [host.SCALAR, host.LLVM])
def test_a_texture_that_cannot_be_a_color_is_refused_in_one_line(path, variant) -> None:
    host.renderer(variant)
    for color, told in NOT_COLORS:
        found = message({"type": "upglow", "cube": path, "color": color})
        assert told in found, (color, found)
        assert "expected three numbers linear in acescg (<vector" in found, found
        assert found.endswith("or a bitmap of them with raw=true"), found


def test_a_picture_that_is_encoded_for_a_screen_is_refused_with_its_conversion(
    path, tmp_path, program
) -> None:
    texels = np.random.default_rng(20260101).integers(0, 256, (8, 8, 3), np.uint8)
    for suffix in ("png", "jpg"):
        file = tmp_path / f"wall.{suffix}"
        mi.Bitmap(texels).write(str(file))
        told = message({"type": "upglow", "cube": path, "color": picture(file)})
        assert f"color is wall.{suffix}, a picture encoded for a screen" in told
    told = message({"type": "upglow", "cube": path, "color": picture(tmp_path / "wall.png")})
    command = told[told.index("(upglow ") + 1 : told.index(" converts it)")].replace("CUBE", path)
    subprocess.run([program, *command.split()[1:]], cwd=tmp_path, check=True, capture_output=True)
    made = {"type": "upglow", "cube": path, "color": picture(tmp_path / "wall.exr")}
    assert "UpglowBSDF" in str(mi.load_dict(made))


def test_a_picture_whose_numbers_the_renderer_converts_is_refused(
    path, tmp_path, monkeypatch
) -> None:
    oiio = pytest.importorskip("OpenImageIO", reason="needs the package OpenImageIO")
    monkeypatch.chdir(tmp_path)
    rec709 = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)
    acescg = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
    texels = np.full((2, 2, 3), 0.5, np.float32)
    for name, chromaticities in [("own.exr", None), ("same.exr", rec709), ("other.exr", acescg)]:
        described = oiio.ImageSpec(2, 2, 3, oiio.HALF)
        if chromaticities:
            kind = oiio.TypeDesc("float[8]")
            described.attribute("chromaticities", kind, chromaticities)
        output = oiio.ImageOutput.create(name)
        output.open(name, described)
        output.write_image(texels)
        output.close()
    made = {"type": "upglow", "cube": path}
    for name in ["own.exr", "same.exr"]:
        assert "UpglowBSDF" in str(mi.load_dict({**made, "color": picture(name)}))
    told = message({**made, "color": picture("other.exr")})
    assert "color is other.exr, whose attribute chromaticities makes the renderer convert" in told
    assert "upglow bake CUBE other.exr --output other.baked.exr --as radiance" in told


def picture(file) -> dict:
    return {"type": "bitmap", "raw": True, "filename": str(file)}


@pytest.mark.parametrize("variant", [host.SCALAR, host.LLVM])
def test_textures_of_colors_load(path, variant) -> None:
    host.renderer(variant)
    near = 0.5 + 0.1 * np.random.default_rng(20260101).uniform(-1, 1, (64, 3))
    grid = mi.VolumeGrid(np.full((2, 2, 2, 3), 0.5, np.float32))
    for color in [
        bitmap(RGB),
        bitmap([*RGB, 0.5]),
        bitmap([-0.02, 1.02, 0.5]),
        # A pale blue that varies: its numbers are near those of normals.
        bitmap(*(near * [1, 1, 0] + [0, 0, 1])),
        {"type": "rawconstant", "value": RGB},
        {"type": "volume", "volume": {"type": "gridvolume", "raw": True, "grid": grid}},
        {"type": "mesh_attribute", "name": "vertex_rgb"},
    ]:
        made = mi.load_dict({"type": "upglow", "cube": path, "color": color})
        assert mi.has_flag(made.flags(), mi.BSDFFlags.SpatiallyVarying)


@pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb", "llvm_ad_spectral_polarized"])
def test_unsupported_variants_are_refused(variant) -> None:
    if variant not in mi.variants():
        pytest.skip(f"this Mitsuba has no variant {variant}")
    host.renderer(variant)
    for plugin in ("upglow", "upglow_path"):
        told = message({"type": plugin})
        assert f"variant {variant} " in told and "expected llvm_ad_spectral" in told


def test_invalid_depths_are_refused() -> None:
    host.renderer(host.SCALAR)
    told = message({"type": "upglow_path", "max_depth": -2})
    assert told.endswith("max_depth is -2, expected 0 or more or -1 for no limit")
    assert message({"type": "upglow_path", "rr_depth": 0}).endswith("expected 1 or more")
