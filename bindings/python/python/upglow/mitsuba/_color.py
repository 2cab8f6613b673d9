"""The parameter `color`: three numbers, or a texture of them."""

from __future__ import annotations

import math
from typing import Any

from ._host import dr, is_scalar, mi

_EXPECTED = (
    "expected three numbers linear in the cube's RGB "
    '(<vector name="color" value="0.9, 0.2, 0.4"/>) or a bitmap with raw=true'
)


class Color:
    """A color in the cube's RGB space, where a ray meets a surface."""

    def __init__(self, props: Any) -> None:
        self.is_textured = False
        if "color" not in props:
            raise ValueError(f"no color, {_EXPECTED}")
        kind = str(props.type("color")).split(".")[-1]
        if kind == "Vector":
            self._value = _constant(list(props["color"]))
        elif kind == "Object" and isinstance(props["color"], mi.Texture):
            self._value, self.is_textured = _texture(props["color"]), True
        elif kind in ("Color", "Spectrum"):
            raise ValueError(
                f"color is {'an rgb value' if kind == 'Color' else 'a spectrum'}, "
                f"which the renderer has already upsampled, {_EXPECTED}"
            )
        else:
            raise ValueError(f"color is of type {kind}, {_EXPECTED}")

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


def _texture(texture: Any) -> Any:
    if texture.class_name().startswith("Bitmap"):
        try:
            texture.eval_3(dr.zeros(mi.SurfaceInteraction3f))
        except RuntimeError:
            raise ValueError(
                "color is a bitmap of spectra or without three channels, "
                "expected three channels and raw=true"
            ) from None
    return texture
