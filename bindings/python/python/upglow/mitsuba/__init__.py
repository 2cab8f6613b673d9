"""upglow inside Mitsuba 3: a diffuse BSDF with a cube's materials, and a path tracer that moves light
between wavelengths.

    import mitsuba as mi
    mi.set_variant("llvm_ad_spectral")
    import upglow.mitsuba

Importing it, before or after `set_variant`, registers two plugins:

- the BSDF ``upglow`` with the parameters ``cube``, a path, and ``color``: three numbers linear in the
  cube's RGB, or a texture of such;
- the integrator ``upglow_path``, the renderer's ``path`` plus fluorescence.

All of it, with what the renderer makes impossible: docs/mitsuba.md.
"""

from ._cube_source import in_memory
from ._light import spectrum
from ._plugins import register

__all__ = ["in_memory", "register", "spectrum"]

register()
