"""The integrator `upglow_path`: path tracing in which wavelengths may change.

A path from the camera carries four wavelengths, as Mitsuba's own paths do. At a fluorescent surface
each of them is kept, or replaced by a shorter one from which the surface re-radiates to it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ._glow import Glow, fluorescent_surfaces, no_fluorescence
from ._host import dr, is_scalar, mi, ratio
from ._lamps import Lamps

_ENDLESS = 2**31 - 1
"""The depth of paths that only Russian roulette ends."""

_MOST_LIKELY = 0.95
"""Russian roulette ends at least one path in twenty, as in Mitsuba's own integrators."""

_Facts = tuple[Lamps, list[Glow]]
"""The lamps of a scene, and its fluorescent BSDFs."""


def integrator_class() -> Any:
    """The class for the current variant: each variant has its own base class."""

    class UpglowPath(mi.SamplingIntegrator):  # type: ignore[misc]
        """Unidirectional path tracing with emitter sampling, for fluorescent surfaces."""

        def __init__(self, props: Any) -> None:
            mi.SamplingIntegrator.__init__(self, props)
            self._max_depth = _depth(props, "max_depth", -1, 0)
            self._rr_depth = _depth(props, "rr_depth", 5, 1)
            self._hides = props.get("hide_emitters", False)
            self._seen: tuple[Any, _Facts] | None = None

        def sample(
            self, scene: Any, sampler: Any, ray: Any, medium: Any = None, active: Any = True
        ) -> tuple[Any, Any, list[Any]]:
            if self._max_depth == 0:
                return mi.Spectrum(0), mi.Bool(False), []
            walk = _Walk(self, scene, sampler)
            state = walk.start(ray, active)
            if is_scalar():
                while state.active:
                    state = walk.step(state)
            else:
                state = _loop(walk, state, self._max_depth)
            return state.radiance, state.is_valid, []

        def to_string(self) -> str:
            return (
                f"UpglowPath[\n  max_depth = {self._max_depth},\n  rr_depth = {self._rr_depth},\n"
                f"  hide_emitters = {self._hides}\n]"
            )

        def _facts(self, scene: Any) -> _Facts:
            """The lamps and fluorescent BSDFs of a scene.

            Scalar variants need them for every ray, so they are kept. The scene is not: it refers to
            the integrator, and neither would ever be freed.
            """
            if not is_scalar():
                return _facts(scene)
            parts = scene.shapes(), scene.emitters()
            if self._seen is None or self._seen[0] != parts:
                self._seen = parts, _facts(scene)
            return self._seen[1]

    return UpglowPath


def _facts(scene: Any) -> _Facts:
    lamps = Lamps(scene)
    return lamps, fluorescent_surfaces(scene, lamps)


def _depth(props: Any, name: str, default: int, least: int) -> int:
    depth = int(props.get(name, default))
    if depth < least and not (name == "max_depth" and depth == -1):
        also = " or -1 for no limit" if name == "max_depth" else ""
        raise ValueError(f"{name} is {depth}, expected {least} or more{also}")
    return _ENDLESS if depth < 0 else depth


def _loop(walk: _Walk, state: _State, max_depth: int) -> _State:
    def body(state: _State, sampler: Any) -> tuple[_State, Any]:
        return walk.step(state), sampler

    done: tuple[_State, Any] = dr.while_loop(
        (state, walk.sampler),
        lambda state, _: state.active,
        body,
        label="upglow_path",
        max_iterations=max_depth if max_depth < _ENDLESS else None,
    )
    return done[0]


@dataclass
class _State:
    """The state of a path."""

    ray: Any
    """The next ray, with its wavelengths."""
    radiance: Any
    """Radiance so far, for each wavelength of the camera."""
    throughput: Any
    """Factor for radiance from the next ray."""
    eta: Any
    """Product of the relative indices of refraction so far."""
    depth: Any
    """Number of surfaces so far."""
    si: Any
    """Interaction with the last surface."""
    pdf: Any
    """Density (1/sr) of the ray's direction there."""
    is_delta: Any
    """Whether that direction came from a Dirac delta."""
    is_valid: Any
    """Whether the camera sees anything."""
    active: Any
    """Whether the path continues."""


@dataclass
class _Moved:
    """What a surface re-radiates to the wavelengths of a path."""

    throughput: Any
    """Factors of the light at `nm`, of the whole hemisphere."""
    nm: Any
    """Wavelengths of that light, nm."""
    part: Any
    """The BSDF in the surface that re-radiates, by its number in `Glow`."""


class _Walk:
    """Path tracing in one scene."""

    def __init__(self, integrator: Any, scene: Any, sampler: Any) -> None:
        self.scene, self.sampler = scene, sampler
        facts: _Facts = integrator._facts(scene)
        self.lamps, self.fluorescent = facts
        self.max_depth, self.rr_depth = integrator._max_depth, integrator._rr_depth
        self.hides = integrator._hides
        self.context = mi.BSDFContext()

    def start(self, ray: Any, active: Any) -> _State:
        ray, active = mi.Ray3f(ray), mi.Bool(active)
        if self.hides:
            ray = _past_emitters(self.scene, ray, active)
        shows_background = not self.hides and self.scene.environment() is not None
        return _State(
            ray=ray,
            radiance=mi.Spectrum(0),
            throughput=mi.Spectrum(1),
            eta=mi.Float(1),
            depth=mi.UInt32(0),
            si=dr.zeros(mi.SurfaceInteraction3f),
            pdf=mi.Float(1),
            is_delta=mi.Bool(True),
            is_valid=mi.Bool(shows_background),
            active=active,
        )

    def step(self, state: _State) -> _State:
        """Traces the next ray and scatters at the surface that it meets."""
        si = self.scene.ray_intersect(
            state.ray, mi.RayFlags.All, state.depth == 0, active=state.active
        )
        radiance = state.radiance + self._emitted(state, si)
        going = state.active & si.is_valid() & (state.depth + 1 < self.max_depth)
        if is_scalar() and not going:
            # Scalar variants must not access the BSDF of a ray that met no surface.
            state.radiance, state.active = radiance, False
            return state
        bsdf = si.bsdf(state.ray)
        moved = self._fluorescence(bsdf, si, going)
        lit = self._lit(state, si, bsdf, moved, going)
        after = self._scattered(state, si, bsdf, moved, going)
        after.radiance = radiance + lit
        return after

    def _emitted(self, state: _State, si: Any) -> Any:
        """Light that the surface itself emits, weighted against sampling it as an emitter."""
        emitter = si.emitter(self.scene, state.active)
        is_there = state.active & (emitter != None)  # noqa: E711
        if self.hides:
            is_there &= state.depth > 0
        if is_scalar() and not is_there:
            return mi.Spectrum(0)
        ds = mi.DirectionSample3f(self.scene, si, state.si)
        sampled = is_there & (state.is_delta ^ True)
        light_pdf = self.scene.pdf_emitter_direction(state.si, ds, sampled)
        weight = _weight(state.pdf, dr.select(sampled, light_pdf, 0))
        return dr.select(is_there, state.throughput * weight * emitter.eval(si, is_there), 0)

    def _fluorescence(self, bsdf: Any, si: Any, active: Any) -> _Moved:
        """What the surface re-radiates to the wavelengths of the path."""
        if not self.fluorescent:
            return _Moved(*no_fluorescence(si), mi.UInt32(0))
        u = self.sampler.next_2d()
        moved = _Moved(*_called(bsdf, self._drawn, si, u, active))
        moved.throughput = dr.select(active, moved.throughput, 0)
        moved.nm = dr.select(active, moved.nm, si.wavelengths)
        return moved

    def _drawn(self, bsdf: Any, si: Any, u: Any, active: Any) -> tuple[Any, Any, Any]:
        for glow in self.fluorescent:
            if glow.surface is bsdf:
                return glow.draw(si, u, active)
        return *no_fluorescence(si), mi.UInt32(0)

    def _lobe(self, bsdf: Any, si: Any, wo: Any, part: Any, active: Any) -> Any:
        for glow in self.fluorescent:
            if glow.surface is bsdf:
                return glow.lobe(si, wo, part, active)
        return mi.Spectrum(0)

    def _lit(self, state: _State, si: Any, bsdf: Any, moved: _Moved, active: Any) -> Any:
        """Light directly from an emitter: the reflected and the re-radiated part together."""
        active = active & mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth)
        ds, light = self.scene.sample_emitter_direction(si, self.sampler.next_2d(), True, active)
        active = active & (ds.pdf != 0)
        if is_scalar() and not active:
            return mi.Spectrum(0)
        wo = si.to_local(ds.d)
        value, pdf = bsdf.eval_pdf(self.context, si, wo, active)
        total = value * light
        if self.fluorescent:
            incident = mi.SurfaceInteraction3f(si)
            incident.wavelengths = moved.nm
            exciting = self.scene.eval_emitter_direction(incident, ds, active) / ds.pdf
            lobe = _called(bsdf, self._lobe, si, wo, moved.part, active)
            total += lobe * moved.throughput * dr.select(active, exciting, 0)
        weight = dr.select(ds.delta, 1, _weight(ds.pdf, pdf))
        return dr.select(active, state.throughput * weight * total, 0)

    def _scattered(
        self, state: _State, si: Any, bsdf: Any, moved: _Moved, active: Any
    ) -> _State:
        """The state after scattering: one direction for all wavelengths, each kept or replaced."""
        drawn, weight = bsdf.sample(
            self.context, si, self.sampler.next_1d(), self.sampler.next_2d(), active
        )
        is_delta = mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Delta)
        is_through = mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Null)
        is_valid = state.is_valid | (active & (is_through ^ True))
        ray = si.spawn_ray(si.to_world(drawn.wo))
        if self.fluorescent:
            lobe = _called(bsdf, self._lobe, si, drawn.wo, moved.part, active)
            share = dr.select(is_delta, 0, moved.throughput * lobe * ratio(1, drawn.pdf))
            choice = self.sampler.next_1d()
            weight, ray.wavelengths = self._chosen(weight, si.wavelengths, share, moved.nm, choice)
        throughput = state.throughput * weight
        eta = state.eta * drawn.eta
        most = dr.max(self._expected(throughput, ray.wavelengths))
        active = active & (most != 0)
        chance = dr.minimum(dr.detach(most * dr.square(eta)), _MOST_LIKELY)
        is_risked = state.depth + 1 >= self.rr_depth
        is_kept = (is_risked ^ True) | (self.sampler.next_1d() < chance)
        active = active & is_kept
        risk = dr.select(is_risked & active, ratio(1, chance), 1)
        return _State(
            ray=ray,
            radiance=state.radiance,
            throughput=throughput * risk,
            eta=eta,
            depth=dr.select(si.is_valid(), state.depth + 1, state.depth),
            si=dr.detach(si),
            pdf=dr.detach(drawn.pdf),
            is_delta=is_delta,
            is_valid=is_valid,
            active=active,
        )

    def _chosen(
        self, kept: Any, nm: Any, moved: Any, moved_nm: Any, choice: Any
    ) -> tuple[Any, Any]:
        """For each wavelength, reflection or fluorescence, in proportion to the light expected."""
        weights, wavelengths = [], []
        kept_light, moved_light = self._expected(kept, nm), self._expected(moved, moved_nm)
        for i in range(len(nm)):
            total = kept_light[i] + moved_light[i]
            likely = dr.select(total > 0, ratio(kept_light[i], total), 1)
            u = choice + i / len(nm)
            u = dr.select(u >= 1, u - 1, u)
            is_kept = (u < likely) | (moved[i] <= 0)
            throughput = dr.select(is_kept, kept[i], moved[i])
            chance = dr.select(is_kept, likely, 1 - likely)
            weights.append(ratio(throughput, chance))
            wavelengths.append(dr.select(is_kept, nm[i], moved_nm[i]))
        return mi.Spectrum(*weights), mi.Spectrum(*wavelengths)

    def _expected(self, throughput: Any, nm: Any) -> Any:
        """The expected light after these throughputs at these wavelengths, up to a factor."""
        throughput = dr.detach(throughput)
        if not self.fluorescent:
            return throughput
        return throughput * mi.Spectrum(*(self.lamps.expected(dr.detach(each)) for each in nm))


def _past_emitters(scene: Any, ray: Any, active: Any) -> Any:
    """A ray from the camera that starts behind the emitters hidden from it."""

    def on(ray: Any, active: Any) -> tuple[Any, Any]:
        si = scene.ray_intersect(ray, mi.RayFlags.Minimal, True, active=active)
        if is_scalar() and not si.is_valid():
            return ray, False
        active = active & si.is_valid() & si.shape.is_emitter()
        return dr.select(active, si.spawn_ray(ray.d), ray), active

    if not is_scalar():
        return dr.while_loop((ray, active), lambda _, active: active, on, label="hidden")[0]
    while active:
        ray, active = on(ray, active)
    return ray


def _called(bsdf: Any, function: Any, *arguments: Any) -> Any:
    """A function of a BSDF and further arguments, for the BSDF of each ray."""
    if is_scalar():
        return function(bsdf, *arguments)
    return dr.dispatch(bsdf, function, *arguments)


def _weight(pdf: Any, other: Any) -> Any:
    """The weight of the power heuristic for two densities."""
    a, b = dr.square(pdf), dr.square(other)
    weight = dr.detach(ratio(a, a + b))
    return dr.select(dr.isfinite(weight), weight, 0)
