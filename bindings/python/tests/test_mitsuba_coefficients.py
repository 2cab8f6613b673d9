"""Tables of coefficients that `upglow export` writes, in Mitsuba's own upsampling."""

from __future__ import annotations

import json
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

RESOLUTION = 64
"""That of Mitsuba's own table, so that both have the same number of nodes."""

COLORS = 400
"""Number of random colors, of all brightnesses and saturations."""

OTHER_SUMS = 1.25
"""Each table is exact at its nodes by the sums that it was fitted to: ours by 5 nm, Mitsuba's over
straight lines between those. By the other's sums nodes of saturated colors are up to 1e-3 off, next
to 2e-3 that interpolation adds at most to either. Measured, ours over Mitsuba's: by 1 nm 1.10 on
average and 1.14 at most, by 5 nm 0.49 and 1.16."""


pytest.importorskip("mitsuba", reason="needs the package mitsuba")


@pytest.fixture(scope="module")
def table(program: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with `data/srgb.coeff`, made as a user makes it."""
    folder = tmp_path_factory.mktemp("table")
    cube, output = folder / "srgb.safetensors", folder / "data" / "srgb.coeff"
    output.parent.mkdir()
    # The export fits a new table for the cube's RGB space. Mitsuba's table has no slope limit.
    fitted = ["--space", "srgb", "--model", "reflectance", "--slope-max-per-nm", "none"]
    build = [program, "build", "-q", *fitted, "--resolution", "2", "--output", cube]
    subprocess.run(build, check=True, capture_output=True)
    export = [program, "export", "-q", cube, output, "--resolution", str(RESOLUTION)]
    subprocess.run(export, check=True, capture_output=True)
    return folder


def upsampled(folder: str | Path, colors: NDArray[Any], tmp_path: Path) -> list[dict[str, Any]]:
    """Mitsuba's upsampling of colors in a new process, with the table in a folder or its own."""
    listed = tmp_path / "colors.txt"
    np.savetxt(listed, colors)
    program = [sys.executable, Path(__file__).with_name("upsampling.py"), folder, listed]
    run = subprocess.run(program, check=True, capture_output=True, text=True)
    answers: list[dict[str, Any]] = json.loads(run.stdout)
    return answers


def node(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
    """A color on a node of a table, red its greatest component; and the node's coefficients."""
    content = path.read_bytes()
    magic, n = struct.unpack_from("<4sI", content)
    assert (magic, n) == (b"SPEC", RESOLUTION)
    scale = np.frombuffer(content, np.float32, n, 8)
    values = np.frombuffer(content, np.float32, 3 * n**3 * 3, 8 + 4 * n).reshape(3, n, n, n, 3)
    z, y, x = 40, 20, 10
    color = scale[z] * np.array([1, x / (n - 1), y / (n - 1)])
    return color, values[0, z, y, x]


def test_mitsuba_reads_our_table_in_place_of_its_own(table: Path, tmp_path: Path) -> None:
    color, coefficients = node(table / "data" / "srgb.coeff")
    (ours,) = upsampled(table, color[None], tmp_path)
    (its,) = upsampled("-", color[None], tmp_path)
    # At a node, interpolation only rounds. The two tables differ in the third digit.
    np.testing.assert_allclose(ours["coefficients"], coefficients, rtol=1e-5)
    assert not np.allclose(its["coefficients"], coefficients, rtol=1e-4)


def test_colors_come_back_as_well_as_from_mitsubas_own_table(table: Path, tmp_path: Path) -> None:
    colors = np.random.default_rng(20260101).uniform(size=(COLORS, 3))
    off = {}
    for name, folder in [("ours", table), ("its own", "-")]:
        answers = upsampled(folder, colors, tmp_path)
        for sums in ["1 nm", "5 nm"]:
            error = abs(np.array([answer[sums] for answer in answers]) - colors)
            off[name, sums] = np.array([error.mean(), error.max()])
            mean, greatest = off[name, sums]
            print(f"{name}, by {sums}: linear sRGB off by {mean:.2e}, at most {greatest:.2e}")
    assert (off["ours", "1 nm"] <= OTHER_SUMS * off["its own", "1 nm"]).all(), off
    assert (off["ours", "5 nm"] <= OTHER_SUMS * off["its own", "5 nm"]).all(), off
    # For the sums that ours was fitted to, it has the smaller error.
    assert off["ours", "5 nm"][0] < off["its own", "5 nm"][0], off
