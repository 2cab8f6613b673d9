"""The scene of docs/blender.md: Blender with maps of matrices, beside `upglow_path`."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import host
import numpy as np
import pytest
from conftest import REPOSITORY

EXAMPLE = REPOSITORY / "examples" / "blender"
SIZE, SAMPLES = 48, 128

# Mean over the lit pixels. It is what the page promises, with the noise of few samples in it.
DIFFERENCE = 1.0
# Sums in single precision of numbers up to 10, which Cycles adds up in any order.
SINGLE = 1e-5


@pytest.fixture(scope="module")
def compare() -> ModuleType:
    for package in ("mitsuba", "colour", "PIL"):
        pytest.importorskip(package, reason=f"needs the package {package}")
    host.renderer()
    spec = importlib.util.spec_from_file_location("compare", EXAMPLE / "compare.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["compare"] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def told(compare, blender_python, tmp_path_factory) -> tuple[Path, str]:
    """The folder of files, and what the program prints."""
    import upglow

    folder = tmp_path_factory.mktemp("blender")
    upglow.build(resolution=9).write(folder / "cube.safetensors")
    options = ["--size", SIZE, "--samples", SAMPLES, "--passes", 2]
    command = [sys.executable, EXAMPLE / "compare.py", folder / "cube.safetensors", *options]
    command += ["--blender-python", blender_python, "--out", folder]
    done = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return folder, done.stdout


def test_matrices_in_blender_are_near_the_spectral_render(told) -> None:
    rows = re.findall(r"^(.+?)((?: \| \d+\.\d\d){6})$", told[1], re.MULTILINE)
    found = {name: [float(number) for number in numbers.split(" | ")[1:]] for name, numbers in rows}
    assert len(found) == 4, told[1]
    for name, (_, matrix, _, fluorescent, cycles, mitsuba) in found.items():
        assert matrix < DIFFERENCE, f"{name}: {told[1]}"
        assert fluorescent < 2 * DIFFERENCE, f"{name}: {told[1]}"
        assert max(cycles, mitsuba) < DIFFERENCE / 2, f"too noisy to say anything: {told[1]}"
    plain, matrix, *_ = found["lamp of 365 nm"]
    assert plain > 5 * matrix, told[1]


def test_the_compositor_multiplies_light_by_the_maps(compare, told) -> None:
    layers = compare.read(told[0] / "render.exr")
    for lamp in compare.LAMPS:
        light = layers[f"{lamp}.light"]
        arriving = [*np.moveaxis(light, -1, 0), layers[f"{lamp}.ultraviolet"][..., 0]]
        maps = [layers[f"map.{incident}"] for incident in compare.INCIDENT]
        expected = sum(each[..., None] * map for each, map in zip(arriving, maps, strict=True))
        assert np.abs(layers[f"{lamp}.seen"] - expected).max() < SINGLE
        assert expected.max() > 0.1


def test_two_renders_of_one_seed_are_equal_within_rounding(compare, told, blender_python) -> None:
    renders = []
    for _ in range(2):
        options = ["--size", "16", "--samples", "8"]
        command = [blender_python, str(EXAMPLE / "scene.py"), str(told[0]), *options]
        subprocess.run(command, capture_output=True, check=True)
        renders.append(compare.read(told[0] / "render.exr"))
    for name, layer in renders[0].items():
        assert np.abs(layer - renders[1][name]).max() < SINGLE, name


def test_the_maps_are_those_of_the_program(compare, told, program) -> None:
    import mitsuba as mi

    folder, cube = told[0], told[0] / "cube.safetensors"
    options = ["--as", "rgbu", "--engine", compare.SPACE, "--space", compare.SPACE]
    command = [program, "bake", cube, folder / "bands.exr", "-o", folder / "program.exr", *options]
    command += ["--sample", "float"]
    subprocess.run([str(word) for word in command], capture_output=True, check=True)
    for incident in compare.INCIDENT:
        baked, ours = (
            np.array(mi.Bitmap(str(folder / f"{name}.{incident}.exr")))
            for name in ("program", "bands")
        )
        assert np.abs(baked[..., :3] - ours).max() < SINGLE, incident


def test_a_python_without_blender_is_told(compare, told, monkeypatch) -> None:
    command = ["compare.py", str(told[0] / "cube.safetensors"), "--out", str(told[0])]
    monkeypatch.setattr(sys, "argv", [*command, "--blender-python", sys.executable])
    with pytest.raises(SystemExit, match="could not render scene.py: .*bpy"):
        compare.main()
