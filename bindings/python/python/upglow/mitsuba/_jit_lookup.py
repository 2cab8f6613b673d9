"""Look-up of the four materials that a color's material is mixed of, in Dr.Jit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._host import dr, mi


@dataclass
class Corner:
    """One of the four materials of a color."""

    weight: Any
    """Its weight, 0 to 1."""
    parabola: Any
    """The reflectance of the packed layout in docs/cube-format.md."""
    numbers: Any
    """The fluorescence of the same; None if the cube has no fluorescence."""


class Lattice:
    """The packed nodes of a cube in the device's memory."""

    def __init__(self, resolution: int, packed: NDArray[np.float32], is_fluorescent: bool) -> None:
        self.resolution = resolution
        self.parabola = mi.Float(packed[:, :4].ravel())
        self.fluorescence = mi.Float(packed[:, 4:].ravel()) if is_fluorescent else None

    def look_up(self, color: Any, active: Any) -> list[Corner]:
        """The corners of the tetrahedron around a color, whose components are clamped to 0 to 1.

        The first step from the dark corner of the color's cell is along the axis of the greatest
        fraction; the last step to the bright corner is along that of the least.
        """
        n = self.resolution
        scaled = [(n - 1) * dr.clip(color[axis], 0.0, 1.0) for axis in range(3)]
        low = [dr.minimum(mi.UInt32(value), n - 2) for value in scaled]
        r, g, b = (value - mi.Float(floor) for value, floor in zip(scaled, low, strict=True))
        greatest, least = dr.maximum(dr.maximum(r, g), b), dr.minimum(dr.minimum(r, g), b)
        middle = dr.maximum(dr.minimum(r, g), dr.minimum(dr.maximum(r, g), b))
        steps = [mi.UInt32(1), mi.UInt32(n), mi.UInt32(n * n)]
        first = _choice((r >= g) & (r >= b), g >= b, steps)
        last = _choice((r < g) & (r < b), g < b, steps)
        dark = low[0] + n * (low[1] + n * low[2])
        bright = dark + (1 + n + n * n)
        return [
            self._corner(1 - greatest, dark, active),
            self._corner(greatest - middle, dark + first, active),
            self._corner(middle - least, bright - last, active),
            self._corner(least, bright, active),
        ]

    def _corner(self, weight: Any, node: Any, active: Any) -> Corner:
        numbers = None
        if self.fluorescence is not None:
            numbers = dr.gather(mi.Vector4f, self.fluorescence, node, active)
        return Corner(weight, dr.gather(mi.Vector4f, self.parabola, node, active), numbers)


def _choice(is_red: Any, is_green: Any, steps: list[Any]) -> Any:
    return dr.select(is_red, steps[0], dr.select(is_green, steps[1], steps[2]))
