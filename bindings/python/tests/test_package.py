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

import pytest

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
