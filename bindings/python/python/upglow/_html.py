"""What notebooks show of lights, observers, contracts and cubes."""

from __future__ import annotations

from html import escape

import numpy as np
from numpy.typing import NDArray

WIDTH, HEIGHT = 240.0, 60.0
"""Size of a drawing, in pixels."""


def table(title: str, rows: dict[str, str], drawing: str = "") -> str:
    """A title, a drawing, and names with what they are."""
    lines = "".join(f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in rows.items())
    return f"<div><b>{escape(title)}</b><br>{drawing}<table>{lines}</table></div>"


def curves(nm: NDArray[np.float64], *values: NDArray[np.float64], colors: tuple[str, ...]) -> str:
    """A drawing of curves over wavelength on one scale, which begins at 0."""
    most = max(float(each.max()) for each in values)
    across = WIDTH * (nm - nm[0]) / (nm[-1] - nm[0])
    drawn = ""
    for each, color in zip(values, colors, strict=True):
        down = HEIGHT * (1.0 - each / most)
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across, down, strict=True))
        drawn += f'<polyline points="{points}" fill="none" stroke="{color}"/>'
    size = f'width="{WIDTH:g}" height="{HEIGHT:g}" viewBox="-1 -1 {WIDTH + 2:g} {HEIGHT + 2:g}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{drawn}</svg>'
