"""The package as a user meets it: documentation, types, examples."""

from __future__ import annotations

import doctest
import importlib
import inspect
import pkgutil
import re
import runpy
import subprocess
import sys
import warnings
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import BISPECTRAL

import upglow

FOLDER = Path(__file__).resolve().parents[1]
MODULES = ["upglow", *(f"upglow.{m.name}" for m in pkgutil.iter_modules(upglow.__path__))]


def test_everything_public_is_documented() -> None:
    for name in upglow.__all__:
        thing = getattr(upglow, name)
        if not (inspect.isclass(thing) or inspect.isfunction(thing)):
            continue
        assert thing.__doc__, name
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                is_method = inspect.isfunction(value) or isinstance(
                    value, (property, classmethod, staticmethod)
                )
                if is_method and not member.startswith("_"):
                    assert getattr(thing, member).__doc__ or value.__doc__, f"{name}.{member}"


def test_the_native_half_is_documented() -> None:
    from upglow import _upglow

    for name, thing in vars(_upglow).items():
        if not name.startswith("_") and callable(thing):
            assert thing.__doc__, name


@pytest.mark.parametrize("name", MODULES)
def test_examples_in_the_documentation_are_right(name: str) -> None:
    if name == "upglow.mitsuba":
        pytest.importorskip("mitsuba", reason="needs the package mitsuba")
    assert doctest.testmod(importlib.import_module(name)).failed == 0


def test_stubs_are_the_native_module(tmp_path: Path) -> None:
    check([sys.executable, "-m", "mypy.stubtest", "upglow._upglow"], tmp_path)


def test_the_package_keeps_its_types(tmp_path: Path) -> None:
    check([sys.executable, "-m", "mypy", "--strict", "--package", "upglow"], tmp_path)


def test_the_package_says_that_it_is_typed() -> None:
    assert (Path(upglow.__file__).parent / "py.typed").exists()


def test_signatures_and_representations_are_short() -> None:
    things = [getattr(upglow, name) for name in upglow.__all__]
    functions = [upglow.build, upglow.standing, upglow.fit_matrix, upglow.metamers]
    for owner in (thing for thing in things if inspect.isclass(thing)):
        functions += [f for f in vars(owner).values() if inspect.isfunction(f)]
    functions += [getattr(upglow.figures, name) for name in upglow.figures.__all__]
    for function in functions:
        if callable(function):
            for parameter in inspect.signature(function).parameters.values():
                assert len(repr(parameter.default)) < 60, function
    nm = np.arange(380.0, 781.0, 10.0)
    matrix = upglow.DonaldsonMatrix(nm, nm, 0.5 * np.eye(41), unit="per band")
    cube = upglow.build(model=upglow.Reflectance(), resolution=3)
    dye = upglow.Dye(name="x", absorption=(nm, nm), emission=(nm, nm))
    paint = upglow.metamers([0.9, 0.3, 0.02])
    shown = [cube, cube.verify(points=5), cube.contract, cube.nodes, matrix, upglow.fit_matrix(matrix), dye]
    shown += [paint, paint.mixture]
    for thing in (*shown, upglow.Illuminant("A"), upglow.Observer("cie-2015-2deg")):
        assert len(repr(thing)) < 140 and "\n" not in repr(thing), repr(thing)
    assert repr(cube.nodes[0]) == "Materials(reflectance, shape (3, 3))"
    assert repr(matrix) == "DonaldsonMatrix(41 outgoing x 41 incident bands, together)"


def test_notebooks_show_what_things_are() -> None:
    contract = upglow.Contract(illuminant="FL11")
    cube = upglow.build(contract, model=upglow.Reflectance(), resolution=3)
    odd = upglow.Illuminant((upglow.FINE_NM, np.ones(531)), name="<lamp> & co")
    for thing, told in (
        (contract, ["acescg", "FL11", "CIE 1931 2°", "bradford"]),
        (cube.verify(points=5), ["Every law holds for 27 nodes", "energy", "holds, "]),
        (cube, ["Cube of 3³ nodes", "FL11", "reflectance", "27, "]),
        (upglow.Illuminant("FL11"), ["FL11", "380 to 780 nm", "<polyline"]),
        (upglow.Observer("cie-1964-10deg"), ["CIE 1964 10°", "<polyline"]),
        (odd, ["&lt;lamp&gt; &amp; co"]),
    ):
        html = thing._repr_html_()
        # It is well formed, and small.
        ElementTree.fromstring(html.replace("<br>", "<br/>"))
        assert all(words in html for words in told) and len(html) < 30_000, html[:200]


def test_the_readme_runs(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (FOLDER / "README.md").read_text(), re.DOTALL)
    assert blocks
    for block in blocks:
        with warnings.catch_warnings():
            # tqdm warns that it has no widgets.
            warnings.simplefilter("ignore")
            exec(compile(block, "README.md", "exec"), {})  # noqa: S102
    assert (tmp_path / "acescg.safetensors").exists()


def test_the_tour_runs(capsys) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        runpy.run_path(str(FOLDER / "examples" / "tour.py"))
    told = capsys.readouterr().out
    for line in ("brown: reflectance, ", "mint: needs fluorescence, ", "green: unreachable, "):
        assert line in told


@pytest.mark.parametrize("with_plots", [True, False], ids=["plots", "no plots"])
def test_the_measured_matrix_runs(tmp_path, monkeypatch, capsys, with_plots: bool) -> None:
    if with_plots:
        pytest.importorskip("matplotlib", reason="needs the package matplotlib")
        monkeypatch.setenv("MPLBACKEND", "Agg")
    else:
        monkeypatch.setitem(sys.modules, "matplotlib", None)
    told = run_the_measured_matrix(tmp_path, monkeypatch, capsys, [])
    assert (tmp_path / "measured_matrix.png").exists() == with_plots
    assert ("no plots: they need matplotlib" in told) == (not with_plots)
    # A sigmoid and a dye of the matrix, fitted to what is a sigmoid and a dye with noise.
    assert all(de2000 < 1.0 for de2000 in fitted_de2000(told))
    whiteness = {line.split("  ")[0]: line.split()[-2] for line in told.splitlines()}
    assert float(whiteness["D65"]) > float(whiteness["D65 without UV"]) and whiteness["M1"] == "nan"
    assert_colors_are_predicted(told)
    difference = re.search(r"greatest difference in XYZ: (\S+)", told)
    # Single precision here.
    assert difference is not None and float(difference[1]) < 1e-4


@pytest.mark.skipif(not BISPECTRAL.is_dir(), reason="no ../shared/data/bispectral")
def test_the_measured_matrix_takes_a_file(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    file = str(BISPECTRAL / "TEXTYELL.BFC")
    told = run_the_measured_matrix(tmp_path, monkeypatch, capsys, [file])
    assert all(de2000 < 1.5 for de2000 in fitted_de2000(told))
    assert_colors_are_predicted(told)


def run_the_measured_matrix(tmp_path, monkeypatch, capsys, arguments: list[str]) -> str:
    program = FOLDER / "examples" / "measured_matrix.py"
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(program), *arguments])
    with warnings.catch_warnings():
        # Lamps without ultraviolet; and what colour-science lacks.
        warnings.simplefilter("ignore")
        runpy.run_path(str(program))
    return capsys.readouterr().out


def fitted_de2000(told: str) -> list[float]:
    """ΔE00 of the material under each of the seven lights."""
    table = told[told.index("light  ") :].splitlines()[1:8]
    return [float(line.split()[-2]) for line in table]


def assert_colors_are_predicted(told: str) -> None:
    """Metamers of the colors of the matrix, under five lights, by one known color and by two."""
    table = told[told.index("light, known") :].splitlines()[1:11]
    numbers = np.array([line.split()[-5:] for line in table], dtype=float)
    single, band, mixture = numbers[:, 2], numbers[:, 3], numbers[:, 4]
    # Nine of ten is what a band promises.
    assert np.sum(single <= band) >= 9
    for de2000 in (single, mixture):
        assert de2000[1::2].mean() < de2000[0::2].mean()


def test_the_benchmark_runs(monkeypatch, capsys) -> None:
    program = FOLDER / "benches" / "arrays.py"
    monkeypatch.setattr(sys, "argv", [str(program), "--colors", "1000", "--resolution", "3"])
    runpy.run_path(str(program), run_name="__main__")
    told = capsys.readouterr().out.splitlines()
    assert [line.split("  ")[0] for line in told[1:]] == [
        "xyz, float32",
        "xyz, float64",
        "reflectance, 31 wavelengths",
        "sample_incident",
    ]


def test_the_readme_names_what_there_is() -> None:
    text = (FOLDER / "README.md").read_text()
    for name in (m for m in vars(upglow.Cube) if not m.startswith("_")):
        assert name in text, name


def check(command: list[str], folder: Path) -> None:
    """Runs a command in a folder in which it may leave files."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
