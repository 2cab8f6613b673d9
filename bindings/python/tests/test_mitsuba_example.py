"""The Cornell box, and the program in docs/mitsuba.md."""

from __future__ import annotations

import re
import runpy
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


def test_the_scene_in_the_documentation_loads(cube, tmp_path, monkeypatch) -> None:
    mi = host.renderer(host.SCALAR)
    monkeypatch.chdir(tmp_path)
    cube.write("acescg.safetensors")
    blocks = re.findall(r"```xml\n(.*?)```", DOCUMENT.read_text(), re.DOTALL)
    (tmp_path / "scene.xml").write_text(blocks[0])
    assert "UpglowBSDF" in str(mi.load_file(str(tmp_path / "scene.xml")))
