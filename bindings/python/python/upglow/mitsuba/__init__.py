"""upglow inside Mitsuba 3: a diffuse BSDF with a cube's materials, and a path tracer that moves light
between wavelengths.

    import mitsuba as mi
    mi.set_variant("llvm_ad_spectral")
    import upglow.mitsuba

The import registers two plugins, whether it comes before or after `set_variant`:

- the BSDF ``upglow`` with the parameters ``cube``, a path, and ``color``: three numbers, linear in
  the cube's RGB space, or a texture of them;
- the integrator ``upglow_path``: Mitsuba's ``path`` plus fluorescence.

Documentation and limits: docs/mitsuba.md.
"""

from ._cube_source import in_memory
from ._light import spectrum
from ._plugins import register

__all__ = ["in_memory", "register", "spectrum"]

register()
