"""The parameter `color`: three numbers, or a texture of them."""

from __future__ import annotations

import math
import re
from pathlib import PurePath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._cube import Cube
from ._host import dr, is_scalar, mi

_ENCODED = (".png", ".jpg", ".jpeg", ".bmp", ".tga")
"""Suffixes of pictures whose numbers are encoded for a screen; with `raw` they are not decoded."""

_EXR = b"\x76\x2f\x31\x01"
_CHROMATICITIES = b"\0chromaticities\0chromaticities\0"
"""The end of the attribute before, and the name and type of the one that is searched for; four bytes of size follow."""

_REC709 = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329]

_HEADER = 1 << 16
"""Bytes of a file in which its attributes are searched for."""

_BEYOND = 0.05
"""How far a texel may be outside 0 to 1, where it is clamped. Half precision, filters that sharpen and
colors that no material shows leave a few percent: a smaller number would refuse such pictures, a
greater one would accept light and heights for colors."""

_UNIT = 0.02
"""How far the length of a normal may be from 1 in a normal map: 8 bits and three channels round by up to
0.014. With a greater number, pictures of colors would be refused."""

_ROUGH = 0.3
"""The least range of red and of green for which lengths of 1 can only be those of normals: in a smaller
range, colors next to (0.5, 0.5, 1) have them as well."""

_MOST = 0.99
"""The share of the texels that are normals in a normal map; lossy compression changes some."""

_SAMPLED = 100_000
"""Texels looked at for normals, evenly spread: more only take longer."""


class Color:
    """A color in the cube's RGB space, where a ray meets a surface."""

    def __init__(self, props: Any, cube: Cube) -> None:
        self.is_textured = False
        kind = str(props.type("color")).split(".")[-1] if "color" in props else None
        if kind == "Vector":
            self._value = _constant(list(props["color"]))
            return
        found = None if kind is None else _found(kind, props["color"], cube)
        if kind is None or found is not None:
            raise ValueError(
                f"{'no color' if found is None else f'color is {found}'}, expected three numbers "
                f"linear in {cube.contract.space} "
                '(<vector name="color" value="0.9, 0.2, 0.4"/>) or a bitmap of them with raw=true'
            )
        self._value, self.is_textured = props["color"], True

    def at(self, si: Any, active: Any) -> Any:
        """Linear RGB, 0 to 1; a texture is filtered before the look-up."""
        found = self._value.eval_3(si, active) if self.is_textured else self._value
        return dr.clip(mi.Color3f(found), 0, 1)

    def traverse(self, callback: Any) -> None:
        """Exposes the color to `mitsuba.traverse`."""
        callback.put("color", self._value, mi.ParamFlags.Differentiable)

    def __str__(self) -> str:
        return str(self._value)


def _constant(rgb: list[float]) -> Any:
    if not all(math.isfinite(value) and 0 <= value <= 1 for value in rgb):
        told = ", ".join(f"{value:g}" for value in rgb)
        raise ValueError(f"color is {told}, expected 0 to 1 in each channel")
    color = mi.Color3f(*rgb)
    if not is_scalar():
        # As an input of the compiled code, not a literal in it: another color needs no compilation.
        dr.make_opaque(color)
    return color


def _found(kind: str, value: Any, cube: Cube) -> str | None:
    """What a value of another type than a vector is; None if it is a texture of colors."""
    if kind in ("Color", "Spectrum"):
        article = "an rgb value" if kind == "Color" else "a spectrum"
        return f"{article}, which the renderer has already upsampled"
    if kind in ("Integer", "Float"):
        return f"the number {value:g}"
    if not isinstance(value, mi.Object):
        return f"of type {kind}"
    name = value.class_name()
    if not isinstance(value, mi.Texture):
        return f"a {name}"
    if name == "MeshAttribute":  # It has no numbers before the mesh has it.
        return _upsampled_attribute(_name(value))
    if name == "RawConstantTexture":
        numbers = np.ravel(mi.traverse(value)["value"])
        return "a texture of one number" if numbers.size == 1 else _problem(numbers[None])
    if not value.is_spatially_varying():
        return f"a spectrum ({name})"
    try:
        value.eval_3(dr.zeros(mi.SurfaceInteraction3f))
    except RuntimeError:
        return _without_colors(value)
    grids = (np.asarray(grid) for key, grid in mi.traverse(value).items() if key.endswith("data"))
    told = _encoded(value, cube) or _converted(value, cube)
    return told or next(filter(None, map(_problem, grids)), None)


def _without_colors(texture: Any) -> str:
    """What a texture is from which three numbers cannot be read."""
    if not texture.class_name().startswith("Bitmap"):
        return f"a {texture.class_name()}, which has no colors of three numbers"
    if mi.traverse(texture)["data"].shape[-1] == 1:
        return "a bitmap of one channel"
    return "a bitmap without raw=true, which the renderer has already upsampled"


def _name(texture: Any) -> str:
    """The name of a bitmap's file or of a mesh's attribute; empty for numbers in memory."""
    found = re.search(r'name = "(.*)"', str(texture))
    return "" if found is None else found[1]


def _upsampled_attribute(name: str) -> str | None:
    """What an attribute is that Mitsuba upsamples because of its name; None for another one."""
    if "color" not in name:
        return None
    return (
        f"the mesh attribute {name}, which the renderer has already upsampled because its name "
        f'contains "color" ({name.replace("color", "rgb")} would keep its numbers)'
    )


def _encoded(texture: Any, cube: Cube) -> str | None:
    """Whether the texture is a file in a format for screens, and how to convert it."""
    name = _name(texture)
    if not name.lower().endswith(_ENCODED):
        return None
    return f"{name}, a picture encoded for a screen ({_conversion(name, cube)})"


def _converted(value: Any, cube: Cube) -> str | None:
    """Whether the renderer has converted the numbers of a file: it does so, also with `raw`, if an OpenEXR file states
    chromaticities. Only the last part of its name is known, so that a file in another folder is not seen."""
    name = _name(value)
    try:
        with open(str(mi.file_resolver().resolve(name)), "rb") as file:
            header = file.read(_HEADER)
    except OSError:
        return None
    at = header.find(_CHROMATICITIES)
    if not header.startswith(_EXR) or at < 0:
        return None
    stated = np.frombuffer(header, "<f4", 8, at + len(_CHROMATICITIES) + 4)
    if np.allclose(stated, _REC709, atol=1e-3):
        return None
    return (
        f"{name}, whose attribute chromaticities makes the renderer convert it to Rec.709 "
        f"({_conversion(name, cube)} to the space of the cube, without that attribute)"
    )


def _conversion(name: str, cube: Cube) -> str:
    is_exr = name.lower().endswith(".exr")
    output = PurePath(name).with_suffix(".baked.exr" if is_exr else ".exr")
    light = cube.contract.illuminant.name
    return f"upglow bake CUBE {name} --output {output} --as radiance --light {light} converts it"


def _problem(texels: NDArray[Any]) -> str | None:
    """Why numbers, shape (..., 3), cannot be colors; None if they can."""
    # A NaN is neither.
    if not (texels.min() >= -_BEYOND and texels.max() <= 1 + _BEYOND):
        is_off = ~((texels >= -_BEYOND) & (texels <= 1 + _BEYOND)).all(axis=-1)
        first = np.unravel_index(int(is_off.argmax()), is_off.shape)
        told = ", ".join(f"{value:g}" for value in texels[first])
        at = ", ".join(str(i) for i in first)
        return f"a texture with {told} in texel [{at}], outside 0 to 1"
    normals = texels.reshape(-1, 3)
    normals = 2 * normals[:: 1 + len(normals) // _SAMPLED].astype(np.float32) - 1
    is_normal = (np.abs(np.linalg.norm(normals, axis=1) - 1) < _UNIT) & (normals[:, 2] > 0)
    if is_normal.mean() > _MOST and np.ptp(normals[:, :2], axis=0).min() > 2 * _ROUGH:
        return "a normal map: its texels are vectors of length 1"
    return None
