"""Prints what Mitsuba makes of sRGB colors, as JSON. A program, as Mitsuba reads its table once a
process. Arguments: a folder to look for `data/srgb.coeff` in first, or `-`; a file of colors."""

from __future__ import annotations

import json
import sys
from functools import cache
from typing import Any

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

NM = np.arange(360.0, 831.0)
"""Where Mitsuba has an observer and D65, nm."""

STEPS_NM = [1, 5]
"""Sums over 1 nm are what renders converge to, straight lines between the data included; sums over
5 nm use the data alone."""


@cache
def weights(step_nm: int) -> NDArray[np.float64]:
    """XYZ of the light that each wavelength of `NM` reflects under D65."""
    observer = np.array([mi.cie1931_xyz(float(nm)) for nm in NM]).reshape(-1, 3)
    light = np.array([mi.cie_d65(float(nm)) for nm in NM]).reshape(-1, 1)
    taken = observer * light * (NM % step_nm == 0)[:, None]
    return taken / taken[:, 1].sum()


def reflectances(spectrum: Any) -> NDArray[np.float64]:
    """A spectrum at `NM`; a point of a surface has four wavelengths."""
    si, found = mi.SurfaceInteraction3f(), []
    for start in range(0, NM.size, 4):
        si.wavelengths = np.resize(NM[start : start + 4], 4)
        found.extend(spectrum.eval(si))
    return np.array(found[: NM.size])


def main(folder: str, colors: str) -> None:
    mi.set_variant("scalar_spectral")
    if folder != "-":
        mi.file_resolver().prepend(folder)
    answers = []
    for color in np.loadtxt(colors, ndmin=2):
        spectrum = mi.load_dict({"type": "rgb", "value": color.tolist()})
        reflectance = reflectances(spectrum)
        answer = {"coefficients": np.ravel(spectrum.eval_3(mi.SurfaceInteraction3f())).tolist()}
        for step_nm in STEPS_NM:
            xyz = mi.Color3f(*(reflectance @ weights(step_nm)))
            answer[f"{step_nm} nm"] = np.ravel(mi.xyz_to_srgb(xyz)).tolist()
        answers.append(answer)
    json.dump(answers, sys.stdout)


if __name__ == "__main__":
    main(*sys.argv[1:])
