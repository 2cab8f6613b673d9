"""Messages of the plugins for scenes that they cannot render."""

from __future__ import annotations

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
        ("", "no color, expected three numbers linear in the cube's RGB"),
        ('<vector name="color" value="0.9, 1.5, 0.4"/>', "color is 0.9, 1.5, 0.4, expected 0 to 1"),
        ('<vector name="color" value="0.9, nan, 0.4"/>', "color is 0.9, nan, 0.4, expected 0 to 1"),
        ('<rgb name="color" value="0.9, 0.5, 0.4"/>', "color is an rgb value, which the renderer"),
        ('<spectrum name="color" value="0.5"/>', "color is a spectrum, which the renderer"),
        ('<float name="color" value="0.5"/>', "color is of type Float, expected three numbers"),
        ('<string name="color" value="red"/>', "color is of type String, expected three numbers"),
    ],
)
def test_an_invalid_color_is_refused_in_one_line(path, inside, told) -> None:
    assert told in message(xml(f'<string name="cube" value="{path}"/>{inside}'))


@pytest.mark.parametrize("variant", [host.SCALAR, host.LLVM])
def test_a_bitmap_that_is_not_raw_is_refused(path, variant) -> None:
    host.renderer(variant)
    for channels, raw in ((3, False), (1, True)):
        bitmap = mi.Bitmap(np.full((2, 2, channels), 0.5, np.float32))
        color = {"type": "bitmap", "bitmap": bitmap, "raw": raw}
        told = message({"type": "upglow", "cube": path, "color": color})
        assert "color is a bitmap of spectra or without three channels, expected three" in told
        assert "channels and raw=true" in told


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
