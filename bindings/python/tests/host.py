"""The renderer Mitsuba 3 for the tests, where it and a compiler for it are installed."""

from __future__ import annotations

import glob
import os
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest

import upglow

LLVM, SCALAR = "llvm_ad_spectral", "scalar_spectral"

# LLVM 15 aborts the process when it compiles the minimum of two numbers: tried in a separate process.
TRIAL = """
import drjit, mitsuba
mitsuba.set_variant("llvm_ad_spectral")
drjit.eval(drjit.minimum(mitsuba.Float([1.0, 2.0]), mitsuba.Float(1.5)))
"""

# Greatest error of a mean in standard errors: one in 16 000 exceeds it, and seeds are fixed.
ERRORS = 4.0
# Sums over 1 nm against the renderer's interpolation of curves over 5 nm.
QUADRATURE = 5e-4


def candidates() -> Iterator[str | None]:
    """Where LLVM may be: the environment's, Debian's, or the one that the renderer finds."""
    if "DRJIT_LIBLLVM_PATH" in os.environ:
        yield os.environ["DRJIT_LIBLLVM_PATH"]
        return
    for pattern in ("/usr/lib/*/libLLVM.so.[12]*", "/usr/lib/*/libLLVM-1[6-9].so*"):
        yield from sorted(glob.glob(pattern), reverse=True)
    yield None


@cache
def llvm_is_missing() -> bool:
    """Whether no LLVM works; the first that does is set for this process."""
    for path in candidates():
        told = {} if path is None else {"DRJIT_LIBLLVM_PATH": path}
        environment = {**os.environ, **told}
        trial = [sys.executable, "-c", TRIAL]
        if subprocess.run(trial, env=environment, capture_output=True, check=False).returncode == 0:
            os.environ.update(told)
            return False
    return True


def renderer(variant: str = LLVM) -> Any:
    """The package mitsuba with this variant and upglow's plugins; skips the test without it."""
    reason = "needs the package mitsuba"
    mi = pytest.importorskip("mitsuba", reason=reason)
    if variant.startswith("llvm") and llvm_is_missing():
        pytest.skip("needs an LLVM that Mitsuba can use, such as Debian's libllvm19")
    mi.set_variant(variant)
    import upglow.mitsuba  # noqa: F401

    return mi


def plane(bsdf: dict[str, Any], light: dict[str, Any], **integrator: Any) -> dict[str, Any]:
    """A plane that fills the picture, under light from all directions."""
    return {
        "type": "scene",
        "integrator": {"type": "upglow_path", "max_depth": 2, **integrator},
        "sensor": sensor([0, 0, 2]),
        "light": {"type": "constant", "radiance": light},
        "plane": {"type": "rectangle", "to_world": _scaled(5), "bsdf": bsdf},
    }


def sensor(origin: list[float], size: int = 16) -> dict[str, Any]:
    """A camera that looks down at the center, with a film of XYZ and no filter between pixels."""
    import mitsuba as mi

    film = {
        "type": "hdrfilm",
        "width": size,
        "height": size,
        "pixel_format": "xyz",
        "component_format": "float32",
        "rfilter": {"type": "box"},
    }
    look = mi.ScalarTransform4f().look_at(origin, [0, 0, 0], [0, 1, 0])
    return {"type": "perspective", "fov": 30, "to_world": look, "film": film}


def _scaled(factor: float) -> Any:
    import mitsuba as mi

    return mi.ScalarTransform4f().scale(factor)


def picture(scene: Any, spp: int = 256, seed: int = 0) -> np.ndarray:
    """X, Y, Z of each pixel, shape (pixels, 3)."""
    import mitsuba as mi

    loaded = mi.load_dict(scene) if isinstance(scene, dict) else scene
    return np.array(mi.render(loaded, spp=spp, seed=seed), dtype=np.float64).reshape(-1, 3)


def xyz_of(spectrum: np.ndarray) -> np.ndarray:
    """X, Y, Z, as the renderer's films define them, of radiance over ``upglow.FINE_NM``."""
    import mitsuba as mi

    if mi.variant().startswith("scalar"):
        observer = np.array([list(mi.cie1931_xyz(nm)) for nm in upglow.FINE_NM.tolist()]).T
    else:
        observer = np.array(mi.cie1931_xyz(mi.Float(upglow.FINE_NM.astype(np.float32))))
    return observer.astype(np.float64) @ spectrum * mi.MI_CIE_Y_NORMALIZATION


def light_of(spectrum: dict[str, Any]) -> np.ndarray:
    """The radiance of `upglow.mitsuba.spectrum` over ``upglow.FINE_NM``."""
    return np.array([float(value) for value in spectrum["values"].split(",")])


def assert_mean(pixels: np.ndarray, expected: np.ndarray) -> None:
    """Asserts that the mean of the pixels is the color, within the noise that they show."""
    error = pixels.std(axis=0, ddof=1) / len(pixels) ** 0.5
    away = np.abs(pixels.mean(axis=0) - expected)
    allowed = ERRORS * error + QUADRATURE * np.abs(expected).max()
    assert (away < allowed).all(), f"{pixels.mean(axis=0)} ± {error}, expected {expected}"
    assert (error < 0.05 * np.abs(expected).max()).all(), f"too noisy to say anything: {error}"
