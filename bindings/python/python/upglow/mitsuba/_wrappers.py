"""Fluorescence through Mitsuba's BSDFs that contain other BSDFs."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

from ._children import children
from ._host import dr, mi
from ._lamps import Lamps

Fluorescence = Callable[[Any, Any, Any], tuple[Any, Any]]
"""Takes a surface interaction, two numbers and a mask; see `UpglowBSDF.fluorescence`."""


def fluorescent_surfaces(scene: Any, lamps: Lamps) -> list[tuple[Any, Fluorescence]]:
    """The BSDFs of a scene that fluoresce, each with the function that draws its fluorescence.

    Warns of BSDFs that contain a fluorescent one and are not supported.
    """
    answers = [(surface, _fluorescence(surface, lamps)) for surface in _surfaces(scene)]
    return [(surface, answer) for surface, answer in answers if answer is not None]


def _fluorescence(surface: Any, lamps: Lamps) -> Fluorescence | None:
    if hasattr(surface, "fluorescence"):
        answer: Fluorescence = surface.fluorescence(lamps)
        return answer if surface.is_fluorescent else None
    inner = {name: each for name, each in children(surface) if isinstance(each, mi.BSDF)}
    answers = {name: _fluorescence(each, lamps) for name, each in inner.items()}
    if all(each is None for each in answers.values()):
        return None
    kind = surface.class_name()
    if kind not in _THROUGH:
        warnings.warn(
            f"fluorescence inside {kind} is lost: upglow_path supports it in upglow itself and in "
            f"{', '.join(_THROUGH)}",
            stacklevel=2,
        )
        return None
    return _THROUGH[kind](dict(children(surface)), answers)


def _two_sided(parts: dict[str, Any], inner: dict[str, Fluorescence | None]) -> Fluorescence:
    front = inner["brdf_0"]
    # The same BSDF on both sides is evaluated once.
    back = front if parts.get("brdf_1") is parts["brdf_0"] else inner.get("brdf_1")

    def answer(si: Any, u: Any, active: Any) -> tuple[Any, Any]:
        is_front = mi.Frame3f.cos_theta(si.wi) > 0
        turned = mi.SurfaceInteraction3f(si)
        turned.wi.z = dr.abs(si.wi.z)
        if back is front:
            return _drawn(front, turned, u, active)
        ahead = _drawn(front, turned, u, active & is_front)
        behind = _drawn(back, turned, u, active & (is_front ^ True))
        return _select(is_front, ahead, behind)

    return answer


def _masked(parts: dict[str, Any], inner: dict[str, Fluorescence | None]) -> Fluorescence:
    opacity, nested = parts["opacity"], inner["nested_bsdf"]

    def answer(si: Any, u: Any, active: Any) -> tuple[Any, Any]:
        throughput, nm = _drawn(nested, si, u, active)
        return throughput * dr.clip(opacity.eval_1(si, active), 0, 1), nm

    return answer


def _blended(parts: dict[str, Any], inner: dict[str, Fluorescence | None]) -> Fluorescence:
    weight, first, second = parts["weight"], inner["bsdf_0"], inner["bsdf_1"]

    def answer(si: Any, u: Any, active: Any) -> tuple[Any, Any]:
        w = dr.clip(weight.eval_1(si, active), 0, 1)
        is_second = u.x < w
        # Rescaled, the number that chose the BSDF serves as the choice inside it.
        rest = dr.select(is_second, u.x / dr.maximum(w, 1e-7), (u.x - w) / dr.maximum(1 - w, 1e-7))
        inside = mi.Point2f(dr.clip(rest, 0, 1), u.y)
        ahead = _drawn(second, si, inside, active & is_second)
        behind = _drawn(first, si, inside, active & (is_second ^ True))
        return _select(is_second, ahead, behind)

    return answer


_THROUGH: dict[str, Callable[..., Fluorescence]] = {
    "TwoSidedBRDF": _two_sided,
    "MaskBSDF": _masked,
    "BlendBSDF": _blended,
}


def _drawn(answer: Fluorescence | None, si: Any, u: Any, active: Any) -> tuple[Any, Any]:
    return no_fluorescence(si) if answer is None else answer(si, u, active)


def no_fluorescence(si: Any) -> tuple[Any, Any]:
    """The result for a surface that does not fluoresce."""
    return mi.Spectrum(0), mi.Spectrum(si.wavelengths)


def _select(mask: Any, ahead: tuple[Any, Any], behind: tuple[Any, Any]) -> tuple[Any, Any]:
    return dr.select(mask, ahead[0], behind[0]), dr.select(mask, ahead[1], behind[1])


def _surfaces(scene: Any) -> list[Any]:
    """Every BSDF of the scene's shapes, in the scene's order."""
    found: list[Any] = []
    seen: list[Any] = []
    waiting = [scene]
    while waiting:
        each = waiting.pop(0)
        if any(each is other for other in seen):
            continue
        seen.append(each)
        if isinstance(each, mi.BSDF):
            found.append(each)
        else:
            waiting.extend(child for _, child in children(each))
    return found
