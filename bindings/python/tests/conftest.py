"""Cubes that the tests share: small ones, built once."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import upglow

REPOSITORY = Path(__file__).resolve().parents[3]

BISPECTRAL = REPOSITORY.parent / "shared" / "data" / "bispectral"
"""Measured matrices; tests that read them skip by name where they are absent."""


@pytest.fixture(scope="session")
def cube() -> upglow.Cube:
    """ACEScg under D65, the dyes and limits of König et al. 2020."""
    return upglow.build(preset="konig2020", resolution=9)


@pytest.fixture(
    scope="session",
    params=[
        upglow.Dyes(),
        upglow.Dyes(accounting="photon", mixing="separate", quantum_yield=0.8, optical_density=2),
        upglow.Film(quantum_yield=0.8),
        upglow.Film(accounting="energy"),
        upglow.Analytic(accounting="photon", quantum_yield=0.9),
        upglow.Reflectance(),
    ],
    ids=["pooled", "separate", "film", "film_energy", "analytic", "reflectance"],
)
def any_cube(request: pytest.FixtureRequest) -> upglow.Cube:
    """A cube of each kind of model."""
    return upglow.build(preset="konig2020", model=request.param, resolution=5)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20260101)


@pytest.fixture(scope="session")
def program() -> str:
    """The program `upglow`, which `cargo xtask check` builds and names."""
    path = os.environ.get("UPGLOW_PROGRAM")
    if path is None:
        pytest.skip("UPGLOW_PROGRAM names no program `upglow`")
    return path


@pytest.fixture(scope="session")
def study_program(program: str) -> str:
    """The program `upglow-study`, which lies beside `upglow`."""
    path = Path(program)
    study = path.with_name(f"upglow-study{path.suffix}")
    if not study.is_file():
        pytest.skip("no program `upglow-study` beside `upglow`")
    return str(study)


@pytest.fixture(scope="session")
def blender_python() -> str:
    """A Python with Blender's package bpy, which needs another numpy than we do."""
    path = os.environ.get("UPGLOW_BLENDER_PYTHON")
    if path is None:
        pytest.skip("UPGLOW_BLENDER_PYTHON names no Python with bpy")
    return path
