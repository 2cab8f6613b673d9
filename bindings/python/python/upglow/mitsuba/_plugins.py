"""Registration of the plugins with Mitsuba."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

from ._bsdf import bsdf_class
from ._host import mi, what_is_missing
from ._integrator import integrator_class

BSDF, INTEGRATOR = "upglow", "upglow_path"

_in_variants: set[str] = set()


@cache
def register() -> None:
    """Registers the BSDF `upglow` and the integrator `upglow_path` with Mitsuba.

    It applies to the current variant and to all that are set later. Importing `upglow.mitsuba` calls
    it; a second call has no effect.
    """
    mi.detail.add_variant_callback(_on_variant)
    if mi.variant() is not None:
        _on_variant(None, mi.variant())


def _on_variant(_: str | None, variant: str) -> None:
    if variant in _in_variants:
        return
    _in_variants.add(variant)
    mi.register_bsdf(BSDF, _maker(bsdf_class))
    mi.register_integrator(INTEGRATOR, _maker(integrator_class))


def _maker(class_of_variant: Callable[[], Any]) -> Callable[[Any], Any]:
    missing = what_is_missing()
    if missing:
        return partial(_refuse, missing)
    plugin = class_of_variant()
    return lambda props: plugin(props)


def _refuse(missing: str, _: Any) -> Any:
    raise ValueError(missing)
