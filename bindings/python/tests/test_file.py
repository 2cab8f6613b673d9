"""Cubes as files: other programs read them, and results follow the format's documentation."""

from __future__ import annotations

import csv
import hashlib
import pickle

import numpy as np
import pytest
from conftest import REPOSITORY
from reader import NM, Reader, tensors
from safetensors.numpy import load

import upglow

# Both sides compute in double precision from the same stored numbers; the format's documentation
# gives the width of a cubic B-spline in eleven digits.
ROUNDING = 1e-10


def test_numpy_alone_reads_what_nodes_returns(any_cube: upglow.Cube) -> None:
    header, arrays = tensors(any_cube.to_bytes())
    nodes = any_cube.nodes
    assert header["resolution"] == any_cube.resolution
    assert np.array_equal(arrays["reflectance"], nodes.reflectance)
    assert np.array_equal(arrays["de2000"], nodes.de2000)
    if any_cube.model in ("dyes", "film"):
        assert np.array_equal(arrays["dyes"], nodes.dyes)
    if any_cube.model != "reflectance":
        assert np.array_equal(arrays["fluorescence"], nodes.fluorescence)
    assert np.array_equal(arrays["illuminant"], any_cube.contract.illuminant.power)


def test_the_safetensors_package_reads_the_same(cube: upglow.Cube) -> None:
    content = cube.to_bytes()
    for name, array in load(content).items():
        assert np.array_equal(array, tensors(content)[1][name]), name


def test_the_checksum_is_what_the_format_says(cube: upglow.Cube) -> None:
    content = cube.to_bytes()
    arrays = load(content)
    length = int.from_bytes(content[:8], "little")
    import json

    sha = hashlib.sha256(json.loads(content[8 : 8 + length])["__metadata__"]["upglow"].encode())
    for name in sorted(arrays.keys() - {"sha256"}):
        array = arrays[name]
        dtype = array.dtype.str[1].upper() + str(8 * array.itemsize)
        sha.update(f"\n{name} {dtype} {','.join(map(str, array.shape))}\n".encode())
        sha.update(array.tobytes())
    assert sha.digest() == arrays["sha256"].tobytes()


def test_reflectance_is_what_the_format_says(
    any_cube: upglow.Cube, rng: np.random.Generator
) -> None:
    reader, rgb = Reader(any_cube.to_bytes()), rng.random((40, 3))
    found = any_cube.reflectance(rgb, NM)
    expected = np.array([reader.reflectance(color, NM) for color in rgb])
    assert np.abs(found - expected).max() < ROUNDING


def test_reradiation_is_what_the_format_says(
    any_cube: upglow.Cube, rng: np.random.Generator
) -> None:
    reader, rgb = Reader(any_cube.to_bytes()), rng.random((10, 3))
    incident, outgoing = np.arange(301.0, 700.0, 7.5), np.arange(380.0, 780.0, 9.25)[:, None]
    found = any_cube.reradiation(rgb[:, None, None], incident, outgoing)
    expected = np.array([reader.reradiation(color, incident, outgoing) for color in rgb])
    assert np.abs(found - expected).max() < ROUNDING
    if any_cube.model != "reflectance":
        assert expected.max() > 1e-3


def test_numpy_alone_finds_the_color_of_a_node() -> None:
    # The error of single precision; the sums are the same, over 5 nm.
    single = 1e-6
    cube = upglow.build(preset="konig2020", resolution=4)
    reader = Reader(cube.to_bytes())
    with (REPOSITORY / "tables" / "cie_1931_2deg.csv").open() as file:
        lines = csv.reader(line for line in file if not line.startswith("#"))
        table = np.array([[float(cell) for cell in row] for row in list(lines)[1:]])
    nm = np.arange(300.0, 831.0, 5.0)
    matching = np.array([np.interp(nm, table[:, 0], table[:, k], left=0) for k in (1, 2, 3)])
    light = np.interp(nm, NM, reader.arrays["illuminant"])
    light = light / (light @ matching[1])
    for b, g, r in np.ndindex(4, 4, 4):
        rgb = np.array([r, g, b]) / 3
        spectrum = reader.reflectance(rgb, nm) * light
        for k in reader.absorbers((r, g, b)):
            absorbed = k.concentration * k.quantum_yield * (k.absorption(nm) @ light)
            spectrum = spectrum + absorbed * k.emission(nm) / k.emission(nm).sum()
        assert np.abs(matching @ spectrum - cube.xyz(rgb)).max() < single, (r, g, b)


def test_files_and_bytes_round_trip(cube: upglow.Cube, tmp_path) -> None:
    path = tmp_path / "cube.safetensors"
    cube.write(path)
    assert path.read_bytes() == cube.to_bytes()
    for copy in (
        upglow.Cube.read(path),
        upglow.Cube.read(str(path)),
        upglow.Cube.from_bytes(cube.to_bytes()),
        pickle.loads(pickle.dumps(cube)),
    ):
        assert copy.to_bytes() == cube.to_bytes()


def test_a_file_that_cannot_be_read_or_written_is_an_os_error(cube, tmp_path) -> None:
    missing = tmp_path / "no" / "cube.safetensors"
    with pytest.raises(FileNotFoundError) as found:
        upglow.Cube.read(missing)
    assert found.value.filename == str(missing)
    with pytest.raises(FileNotFoundError):
        cube.write(missing)
    with pytest.raises(IsADirectoryError):
        upglow.Cube.read(tmp_path)
    with pytest.raises(ValueError, match=f"^{tmp_path}: a folder, expected a file to write"):
        cube.write(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_damaged_file_is_refused_by_name(cube: upglow.Cube, tmp_path) -> None:
    path = tmp_path / "damaged.safetensors"
    content = bytearray(cube.to_bytes())
    content[-100] ^= 1
    path.write_bytes(content)
    with pytest.raises(ValueError, match="damaged.safetensors: checksum .*altered or damaged"):
        upglow.Cube.read(path)
    with pytest.raises(ValueError, match="not a whole safetensors file"):
        upglow.Cube.from_bytes(b"nothing")


def test_dye_curves_have_unit_area_and_names(cube: upglow.Cube) -> None:
    curves = cube.dye_curves
    assert curves.shape == (8, 2, 531) and len(cube.dye_names) == 8
    assert np.allclose(curves[:, 1].sum(axis=1), 1.0, atol=1e-12)
    assert upglow.build(model=upglow.Reflectance(), resolution=2).dye_curves.shape == (0, 2, 531)
