"""What the tests share: Mitsuba with the native plugins, and small cubes."""

from __future__ import annotations

import os
from pathlib import Path

import mitsuba as mi
import pytest
import upglow

CUBE_NODES = 9
"""Nodes along each axis: enough for cells of every kind, and built in a tenth of a second."""


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "traced: needs a libLLVM; set on all tests that ask for it")
    config.addinivalue_line("filterwarnings", "error")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if "traced" in getattr(item, "fixturenames", ()):
            item.add_marker("traced")


@pytest.fixture(scope="session")
def plugins() -> Path:
    """The folder whose `plugins` holds what CMake built; `cargo xtask test-mitsuba` names it."""
    folder = os.environ.get("UPGLOW_MITSUBA_PLUGINS")
    if folder is None:
        pytest.skip("UPGLOW_MITSUBA_PLUGINS names no folder of plugins")
    # Mitsuba finds `plugins/x.so` below each folder of its file resolver.
    mi.file_resolver().append(folder)
    return Path(folder)


@pytest.fixture
def scalar(plugins: Path) -> None:
    """The variant in which each evaluation calls the library."""
    mi.set_variant("scalar_spectral")


@pytest.fixture
def traced(plugins: Path) -> None:
    """The variant that traces: it needs a libLLVM, and one that is too old aborts the process."""
    if "DRJIT_LIBLLVM_PATH" not in os.environ:
        pytest.skip("DRJIT_LIBLLVM_PATH names no libLLVM 16 or later")
    mi.set_variant("llvm_ad_spectral")


@pytest.fixture(scope="session")
def cube() -> upglow.Cube:
    """ACEScg under D65, the dyes and limits of König et al. 2020."""
    return upglow.build(preset="konig2020", resolution=CUBE_NODES)


@pytest.fixture(scope="session")
def cube_file(cube: upglow.Cube, tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("cubes") / "acescg.safetensors"
    cube.write(path)
    return str(path)
