"""A diffuse plane that fills the picture, under a sky of one color: each pixel is its color."""

from __future__ import annotations

from typing import Any

import mitsuba as mi
import numpy as np
import upglow
from numpy.typing import NDArray

NM = np.arange(300.0, 831.0)
"""Wavelengths of a cube's tables, nm."""


def observer() -> NDArray[np.float64]:
    """Mitsuba's observer at `NM`, scaled so that a sum over power is the film's XYZ."""
    samples = [mi.cie1931_xyz(float(nm)) for nm in NM]
    return np.array(samples).reshape(-1, 3) * mi.MI_CIE_Y_NORMALIZATION


def normalized(light: upglow.Illuminant) -> NDArray[np.float64]:
    """A light's power at `NM`, scaled so that a white plane under it has Y = 1."""
    return light.power / (light.power @ observer()[:, 1])


def sky(power: NDArray[np.float64]) -> dict[str, Any]:
    """Constant light from all directions, at all wavelengths of a cube's tables."""
    values = ",".join(f"{value:.9g}" for value in power)
    ends = {"wavelength_min": NM[0], "wavelength_max": NM[-1]}
    spectrum = {"type": "regular", "values": values} | ends
    return {"type": "constant", "radiance": spectrum}


def film(size: int) -> dict[str, Any]:
    """A film of XYZ in single precision, without a filter between pixels."""
    return {
        "type": "hdrfilm",
        "width": size,
        "height": size,
        "pixel_format": "xyz",
        "component_format": "float32",
        "rfilter": {"type": "box"},
    }


def scene(
    bsdf: dict[str, Any],
    light: dict[str, Any],
    integrator: dict[str, Any],
    *,
    size: int = 32,
    tilt: float = 0,
) -> Any:
    """The plane seen from straight above, after a turn by `tilt` degrees."""
    to_world = mi.ScalarTransform4f
    sensor = {
        "type": "orthographic",
        "to_world": to_world().look_at(origin=[0, 0, 2], target=[0, 0, 0], up=[0, 1, 0]),
        "film": film(size),
        "sampler": {"type": "independent"},
    }
    turned = to_world().rotate([1, 0, 0], tilt).scale(5)
    plane = {"type": "rectangle", "to_world": turned, "bsdf": bsdf}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": integrator,
            "sensor": sensor,
            "light": light,
            "plane": plane,
        }
    )


def pixels(scene: Any, *, spp: int = 64, seed: int = 1) -> NDArray[np.float64]:
    """XYZ of each pixel, shape (pixels, 3)."""
    return np.array(mi.render(scene, spp=spp, seed=seed), dtype=float).reshape(-1, 3)


def mean_and_error(samples: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The mean of all pixels and its standard error."""
    return samples.mean(axis=0), samples.std(axis=0, ddof=1) / np.sqrt(len(samples))
