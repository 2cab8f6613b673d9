"""The Cornell box, and the program in docs/mitsuba.md."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys

import host
import numpy as np
import pytest
from conftest import REPOSITORY

import upglow

pytest.importorskip("mitsuba", reason="needs the package mitsuba")

EXAMPLE = REPOSITORY / "bindings" / "python" / "examples" / "cornell_box.py"
DOCUMENT = REPOSITORY / "docs" / "mitsuba.md"


def test_the_box_shines_only_with_fluorescence(tmp_path, monkeypatch, capsys) -> None:
    image = pytest.importorskip("PIL.Image", reason="needs the package pillow")
    pytest.importorskip("colour", reason="needs the package colour-science")
    host.renderer()
    out = tmp_path / "box.png"
    options = ["--spp", "2", "--size", "24", "--resolution", "9", "--out", str(out)]
    monkeypatch.setattr(sys, "argv", [str(EXAMPLE), *options, "--exr", str(tmp_path)])
    runpy.run_path(str(EXAMPLE), run_name="__main__")
    told = capsys.readouterr().out
    assert "magenta [0.94, 0.2, 0.46]: needs_fluorescence" in told
    measured = dict(re.findall(r"(.*?): magenta wall XYZ \[[\d.]+, ([\d.]+)", told))
    glow = float(measured["upglow, fluorescence, lamp"])
    assert glow > 10 * float(measured["upglow, reflectance, lamp"])
    assert len(list(tmp_path.glob("*.exr"))) == 6
    sheet = np.asarray(image.open(out), dtype=np.float64)
    height, width = sheet.shape[:2]
    lower = sheet[height // 2 :]
    assert lower[:, 2 * width // 3 :].std() > lower[:, width // 8 : width // 3].std()


def test_the_program_in_the_documentation_runs(tmp_path, monkeypatch) -> None:
    host.renderer()
    monkeypatch.chdir(tmp_path)
    upglow.build(resolution=5).write("acescg.safetensors")
    blocks = re.findall(r"```python\n(.*?)```", DOCUMENT.read_text(), re.DOTALL)
    assert blocks
    for block in blocks:
        exec(compile(block, DOCUMENT.name, "exec"), {})  # noqa: S102
    assert (tmp_path / "sphere.exr").exists()


def test_the_scene_in_the_documentation_renders_by_both_commands(cube, tmp_path) -> None:
    mi = host.renderer()
    cube.write(tmp_path / "acescg.safetensors")
    document = DOCUMENT.read_text()
    (scene,) = re.findall(r"```xml\n(.*?)```", document, re.DOTALL)
    (command,) = re.findall(r"^    python (-m upglow.mitsuba .*)$", document, re.MULTILINE)
    (tmp_path / "scene.xml").write_text(scene)
    run([sys.executable, *command.split()], tmp_path)
    by_command = np.array(mi.Bitmap(str(tmp_path / "scene.exr")), dtype=np.float64)
    by_function = np.array(mi.render(mi.load_file(str(tmp_path / "scene.xml"))), dtype=np.float64)
    # The same samples; the file has half precision.
    assert np.allclose(by_command, by_function, rtol=2e-3, atol=1e-4)
    red, green, blue = by_function[96:160, 96:160].mean(axis=(0, 1))
    assert green > blue > 2 * red


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["no.xml"], "no.xml: no such file, expected a scene in XML"),
        (["scene.xml", "--sensor", "1"], "--sensor is 1, expected less than 1, the scene's sensors"),
        (["scene.xml", "--output", "no/x.exr"], "--output is no/x.exr, expected a path in a folder"),
        (["scene.xml", "--define", "color"], "--define is color, expected KEY=VALUE"),
        (["scene.xml", "--mode", "rgb"], "--mode is rgb, expected one of scalar_rgb"),
        (
            ["scene.xml", "--define", "color=0.9,2,0.4"],
            "scene.xml: color is 0.9, 2, 0.4, expected 0 to 1 in each channel",
        ),
    ],
)
def test_what_the_command_cannot_render_is_said_in_one_line(cube, tmp_path, options, told) -> None:
    cube.write(tmp_path / "cube.safetensors")
    (tmp_path / "scene.xml").write_text(
        '<scene version="3.0.0"><default name="color" value="1, 1, 1"/><sensor type="perspective"/>'
        '<shape type="sphere"><bsdf type="upglow"><string name="cube" value="cube.safetensors"/>'
        '<vector name="color" value="$color"/></bsdf></shape></scene>'
    )
    options = ["--mode", host.SCALAR, *options]
    with pytest.raises(subprocess.CalledProcessError) as failed:
        run([sys.executable, "-m", "upglow.mitsuba", *options], tmp_path)
    assert failed.value.returncode in (1, 2)
    assert told in failed.value.stderr.strip().splitlines()[-1]


def run(command: list[str], folder) -> None:
    subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True)
