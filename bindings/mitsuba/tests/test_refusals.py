"""Invalid parameters and variants raise Mitsuba's own exception with a clear message."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np
import pytest

GREEN = [0.05, 0.9, 0.1]


def refusal(description: dict[str, Any]) -> str:
    with pytest.raises(RuntimeError) as caught:
        mi.load_dict(description)
    return str(caught.value)


@pytest.mark.usefixtures("scalar")
def test_a_missing_file_is_named() -> None:
    text = refusal({"type": "upglow", "cube": "nowhere.safetensors", "color": GREEN})
    assert "upglow: nowhere.safetensors: No such file" in text


@pytest.mark.usefixtures("scalar")
def test_a_missing_parameter_is_named(cube_file: str) -> None:
    assert '"cube"' in refusal({"type": "upglow", "color": GREEN})
    assert '"color"' in refusal({"type": "upglow", "cube": cube_file})


@pytest.mark.usefixtures("scalar")
def test_a_damaged_cube_is_refused_in_the_librarys_words(cube_file: str, tmp_path: Path) -> None:
    content = bytearray(Path(cube_file).read_bytes())
    content[-1000] ^= 1
    damaged = tmp_path / "damaged.safetensors"
    damaged.write_bytes(content)
    text = refusal({"type": "upglow", "cube": str(damaged), "color": GREEN})
    assert "damaged.safetensors: " in text and "checksum" in text
    damaged.write_bytes(content[:100])
    assert "damaged.safetensors: " in refusal(
        {"type": "upglow", "cube": str(damaged), "color": GREEN}
    )


@pytest.mark.usefixtures("scalar")
@pytest.mark.parametrize("color", [[0.5, 1.5, 0], [-0.1, 0, 0], [float("nan"), 0, 0]])
def test_a_color_outside_the_cube_is_refused(color: list[float], cube_file: str) -> None:
    assert "expected 0 to 1" in refusal({"type": "upglow", "cube": cube_file, "color": color})


@pytest.mark.usefixtures("scalar")
def test_a_refused_change_leaves_the_old_color(cube_file: str) -> None:
    bsdf = mi.load_dict({"type": "upglow", "cube": cube_file, "color": GREEN})
    before, parameters = str(bsdf), mi.traverse(bsdf)
    parameters["color"] = [2.0, 0, 0]
    with pytest.raises(RuntimeError, match="expected 0 to 1"):
        parameters.update()
    assert str(bsdf) == before


@pytest.mark.usefixtures("scalar")
def test_colors_that_were_upsampled_are_refused(cube_file: str) -> None:
    picture = mi.Bitmap(np.full((2, 2, 3), 0.5, dtype=np.float32))
    gray = mi.Bitmap(np.full((2, 2, 1), 0.5, dtype=np.float32))
    for color in [
        {"type": "rgb", "value": GREEN},
        {"type": "uniform", "value": 0.5},
        {"type": "bitmap", "raw": False, "bitmap": picture},
        {"type": "bitmap", "raw": True, "bitmap": gray},
        {"type": "checkerboard"},
        0.5,
    ]:
        text = refusal({"type": "upglow", "cube": cube_file, "color": color})
        assert '"color" is a spectrum or not a color, expected three numbers' in text


@pytest.mark.usefixtures("plugins")
@pytest.mark.parametrize("variant", ["scalar_rgb", "scalar_spectral_polarized"])
def test_other_variants_are_named(variant: str, cube_file: str) -> None:
    mi.set_variant(variant)
    text = refusal({"type": "upglow", "cube": cube_file, "color": GREEN})
    assert f"does not work in the variant {variant}, expected scalar_spectral" in text
    text = refusal({"type": "upglow_path"})
    assert f"does not work in the variant {variant}, expected scalar_spectral" in text


@pytest.mark.usefixtures("traced")
def test_the_native_integrator_names_the_python_package_in_traced_variants() -> None:
    assert "upglow.mitsuba has the integrator" in refusal({"type": "upglow_path"})
