"""Fluorescence of a scene's BSDFs, directly or inside Mitsuba's BSDFs that contain others.

A BSDF like `bumpmap` or `blendbsdf` evaluates the BSDFs inside it with frames and weights of its own.
The lobe of fluorescence passes through it as that of reflection does: it is what the outer BSDF returns
while the inner one answers with its cosine, over pi, and the others with nothing.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from ._children import children
from ._host import dr, mi
from ._lamps import Lamps

Draw = Callable[[Any, Any, Any], tuple[Any, Any]]
"""Takes a surface interaction, two numbers and a mask; see `UpglowBSDF.fluorescence`."""

_FLUORESCENCE = 1 << 31
"""The type of the lobe, beside those of `mitsuba.BSDFFlags`: a BSDF of Mitsuba finds none of its own
lobes enabled and returns 0, except `principled`, which does not look."""


class _Asked(threading.local):
    """The BSDF that answers with its lobe; scalar variants render in many threads."""

    part: Any = None


_asked = _Asked()


def is_fluorescence(context: Any) -> bool:
    """Whether a BSDF is asked for the lobe of fluorescence, instead of reflection."""
    return int(context.type_mask) == _FLUORESCENCE


def is_asked(part: Any) -> bool:
    """Whether it is this BSDF's lobe of fluorescence that is asked for."""
    return _asked.part is part


class Glow:
    """The fluorescence of one BSDF of a scene, from one or more BSDFs `upglow` in it.

    One of those is drawn at each point, in proportion to its share of the light that leaves.
    """

    def __init__(self, surface: Any, parts: list[Any], lamps: Lamps) -> None:
        self.surface, self._parts = surface, parts
        self._draws: list[Draw] = [part.fluorescence(lamps) for part in parts]
        self._context = mi.BSDFContext()
        self._context.type_mask = _FLUORESCENCE

    def draw(self, si: Any, u: Any, active: Any) -> tuple[Any, Any, Any]:
        """Throughputs, the wavelengths (nm) of incident light, and the number of the drawn part.

        A throughput is that of the whole hemisphere, as a reflectance is.
        """
        if len(self._parts) == 1:
            return *self._draws[0](si, u, active), mi.UInt32(0)
        # The direction of the path itself is on the right side of every frame.
        shares = [self._part_lobe(part, si, si.wi, active)[0] for part in self._parts]
        rest, total = u.x * sum(shares), sum(shares)
        throughput, nm = no_fluorescence(si)
        number, is_found = mi.UInt32(0), mi.Bool(False)
        for i, (draw, share) in enumerate(zip(self._draws, shares, strict=True)):
            is_here = active & (share > 0) & (is_found ^ True) & (rest < share)
            # Rescaled, the number that chose the part serves as the choice inside it.
            some = dr.select(share > 0, share, 1)
            inside = mi.Point2f(dr.clip(rest / some, 0, 1), u.y)
            moved, moved_nm = draw(si, inside, is_here)
            throughput = dr.select(is_here, moved * total / some, throughput)
            nm, number = dr.select(is_here, moved_nm, nm), dr.select(is_here, i, number)
            rest, is_found = rest - share, is_found | is_here
        return throughput, nm, number

    def lobe(self, si: Any, wo: Any, number: Any, active: Any) -> Any:
        """The lobe of the drawn part with its cosine, 1/sr."""
        lobe = mi.Spectrum(0)
        for i, part in enumerate(self._parts):
            lobe = dr.select(number == i, self._part_lobe(part, si, wo, active), lobe)
        return lobe

    def _part_lobe(self, part: Any, si: Any, wo: Any, active: Any) -> Any:
        with _asking(part):
            answered = self.surface.eval(self._context, si, wo, active)
        # What others answer although they should not.
        with _asking(None):
            return answered - self.surface.eval(self._context, si, wo, active)


@contextmanager
def _asking(part: Any) -> Iterator[None]:
    _asked.part = part
    try:
        yield
    finally:
        _asked.part = None


def fluorescent_surfaces(scene: Any, lamps: Lamps) -> list[Glow]:
    """The BSDFs of a scene that fluoresce."""
    found = ((surface, _fluorescent_parts(surface)) for surface in _surfaces(scene))
    return [Glow(surface, parts, lamps) for surface, parts in found if parts]


def no_fluorescence(si: Any) -> tuple[Any, Any]:
    """Throughputs and wavelengths of a surface that does not fluoresce."""
    return mi.Spectrum(0), mi.Spectrum(si.wavelengths)


def _fluorescent_parts(surface: Any) -> list[Any]:
    """Every fluorescent BSDF in a BSDF, each once."""
    return [
        part
        for part in _reached(surface, lambda _: True)
        if hasattr(part, "fluorescence") and part.is_fluorescent
    ]


def _surfaces(scene: Any) -> list[Any]:
    """Every BSDF of the scene's shapes, in the scene's order."""
    reached = _reached(scene, lambda each: not isinstance(each, mi.BSDF))
    return [each for each in reached if isinstance(each, mi.BSDF)]


def _reached(start: Any, opens: Callable[[Any], bool]) -> list[Any]:
    """An object and what is in it, and in those of its parts that it opens; each once."""
    found: list[Any] = []
    waiting = [start]
    while waiting:
        each = waiting.pop(0)
        if any(each is other for other in found):
            continue
        found.append(each)
        if opens(each):
            waiting.extend(child for _, child in children(each))
    return found
