"""The BSDF `upglow`: a diffuse surface with a cube's material."""

from __future__ import annotations

from typing import Any

from ._color import Color
from ._cube_source import cube_named, on_device
from ._glow import Draw, is_asked, is_fluorescence
from ._host import dr, mi
from ._lamps import Lamps


def bsdf_class() -> Any:
    """The class for the current variant: each variant has its own base class."""

    class UpglowBSDF(mi.BSDF):  # type: ignore[misc]
        """A diffuse reflector whose reflectance is looked up in a cube.

        Mitsuba's BSDF interface has the same wavelength on both sides of a reflection, so its
        methods return the reflected part only. `fluorescence` has the rest, for `upglow_path`.
        """

        def __init__(self, props: Any) -> None:
            mi.BSDF.__init__(self, props)
            if "cube" not in props:
                raise ValueError("no cube, expected the path of a cube's file")
            self._source = props["cube"]
            cube = cube_named(self._source)
            self._cube, self._color = on_device(cube), Color(props, cube)
            flags = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide
            if self._color.is_textured:
                flags = flags | mi.BSDFFlags.SpatiallyVarying
            self.m_components, self.m_flags = [flags], flags

        @property
        def is_fluorescent(self) -> bool:
            """Whether the cube has fluorescent materials."""
            return self._cube.is_fluorescent

        def fluorescence(self, lamps: Lamps | None) -> Draw:
            """A function that draws fluorescence of this surface in a scene with these lamps.

            It takes a surface interaction, two random numbers in 0 to 1, and a mask. For the
            wavelengths of the interaction, which leave, it returns throughputs and the wavelengths
            (nm) of incident light. A throughput is that of the whole hemisphere, as a reflectance
            is. `eval` has the lobe of directions, where a context asks for it.
            """
            draw = self._cube.fluorescence(lamps)

            def drawn(si: Any, u: Any, active: Any) -> tuple[Any, Any]:
                color = self._color.at(si, active)
                moved: tuple[Any, Any] = draw(color, si.wavelengths, u.x, u.y, active)
                return moved

            return drawn

        def sample(
            self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True
        ) -> tuple[Any, Any]:
            cos_i = mi.Frame3f.cos_theta(si.wi)
            drawn = dr.zeros(mi.BSDFSample3f)
            active = active & (cos_i > 0) & self._is_enabled(ctx)
            drawn.wo = mi.warp.square_to_cosine_hemisphere(sample2)
            drawn.pdf = dr.select(active, mi.warp.square_to_cosine_hemisphere_pdf(drawn.wo), 0)
            drawn.eta = 1
            drawn.sampled_type = mi.UInt32(+mi.BSDFFlags.DiffuseReflection)
            drawn.sampled_component = 0
            weight = self._reflectance(si, active)
            return drawn, dr.select(active & (drawn.pdf > 0), weight, 0)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            is_glow = is_fluorescence(ctx)
            is_answer = is_asked(self) if is_glow else self._is_enabled(ctx)
            active = active & is_answer & _are_in_front(si, wo)
            share = mi.Spectrum(1) if is_glow else self._reflectance(si, active)
            return dr.select(active, share * (mi.Frame3f.cos_theta(wo) / dr.pi), 0)

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            active = active & self._is_enabled(ctx) & _are_in_front(si, wo)
            return dr.select(active, mi.warp.square_to_cosine_hemisphere_pdf(wo), 0)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> tuple[Any, Any]:
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def eval_diffuse_reflectance(self, si: Any, active: Any = True) -> Any:
            return self._reflectance(si, active)

        def traverse(self, callback: Any) -> None:
            self._color.traverse(callback)

        def to_string(self) -> str:
            color = str(self._color).replace("\n", "\n  ")
            return f"UpglowBSDF[\n  cube = {self._source!r},\n  color = {color}\n]"

        def _reflectance(self, si: Any, active: Any) -> Any:
            return self._cube.reflectance(self._color.at(si, active), si.wavelengths, active)

        def _is_enabled(self, ctx: Any) -> bool:
            return bool(ctx.is_enabled(mi.BSDFFlags.DiffuseReflection))

    return UpglowBSDF


def _are_in_front(si: Any, wo: Any) -> Any:
    return (mi.Frame3f.cos_theta(si.wi) > 0) & (mi.Frame3f.cos_theta(wo) > 0)
