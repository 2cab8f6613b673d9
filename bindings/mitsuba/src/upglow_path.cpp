/// The plugin `upglow_path`: path tracing in which wavelengths may change.

#include <map>

#include <mitsuba/core/properties.h>
#include <mitsuba/core/ray.h>
#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/emitter.h>
#include <mitsuba/render/integrator.h>
#include <mitsuba/render/records.h>
#include <mitsuba/render/sampler.h>
#include <mitsuba/render/scene.h>

#include "fluorescence.h"
#include "fluorescent_sides.h"
#include "variants.h"

namespace upglow_mitsuba {

using namespace mitsuba;

/// Greatest survival probability in Russian roulette, so that a path without losses ends too. A
/// greater one makes paths longer, a smaller one pictures noisier. Mitsuba's `path` has the same.
constexpr float GREATEST_SURVIVAL = 0.95f;

/// Path tracing with emitter sampling, combined by multiple importance sampling with the power
/// heuristic.
///
/// Each ray carries four wavelengths, which share the geometry. A fluorescent surface may change each
/// of them independently; re-radiation has the same distribution of directions as reflection. The
/// weights of the two strategies depend on directions only, so they are valid for any wavelengths.
///
/// # Source
///
/// `mojzik`, for the estimators; `veach`, section 9.2, for the heuristic.
template <typename Float, typename Spectrum>
class FluorescentPath final : public MonteCarloIntegrator<Float, Spectrum> {
public:
    MI_IMPORT_BASE(MonteCarloIntegrator, m_max_depth, m_rr_depth, m_hide_emitters)
    MI_IMPORT_TYPES(Scene, Sensor, Sampler, Medium, BSDF, Emitter)
    using Sides   = FluorescentSides<Float, Spectrum>;
    using Surface = typename Sides::Surface;

    explicit FluorescentPath(const Properties &props) : Base(props) {}

    using Base::render;

    TensorXf render(Scene *scene, Sensor *sensor, UInt32 seed, uint32_t spp, bool develop,
                    bool evaluate) override {
        find_fluorescence(*scene);
        TensorXf image = Base::render(scene, sensor, seed, spp, develop, evaluate);
        m_sides.clear();  // Another scene may have a BSDF at the same address.
        return image;
    }

    std::pair<Spectrum, Mask> sample(const Scene *scene, Sampler *sampler,
                                     const RayDifferential3f &ray, const Medium *, Float *,
                                     Mask) const override {
        Walk walk(ray);
        bool opaque = scene->environment() && !m_hide_emitters;
        while (walk.depth < m_max_depth) {
            SurfaceInteraction3f si = intersect(*scene, walk);
            walk.radiance += emitted(*scene, si, walk);
            if (!si.is_valid())
                break;
            if (++walk.depth >= m_max_depth)
                break;
            walk.radiance += walk.throughput * lit_by_emitters(*scene, *sampler, si);
            bool goes_on = scatter(*sampler, si, walk);
            opaque |= !walk.is_null;
            if (!goes_on || !survives(*sampler, walk))
                break;
        }
        return { walk.radiance, opaque };
    }

    std::string to_string() const override {
        return tfm::format("FluorescentPath[\n  max_depth = %i,\n  rr_depth = %i\n]",
                           int(m_max_depth), int(m_rr_depth));
    }

    MI_DECLARE_CLASS(FluorescentPath)

private:
    /// The state of a path.
    struct Walk {
        explicit Walk(const RayDifferential3f &camera) : ray(Ray3f(camera)) {}

        /// The next ray, with the current wavelengths; the film keeps the camera's.
        Ray3f ray;
        Spectrum radiance   = 0.f;
        Spectrum throughput = 1.f;
        /// Product of the relative indices of refraction so far.
        float eta = 1.f;
        /// Number of surfaces so far.
        uint32_t depth = 0;
        /// The last surface, and the density of the ray's direction that its BSDF drew.
        Interaction3f from = dr::zeros<Interaction3f>();
        float density      = 1.f;
        /// Whether that direction came from a Dirac delta, which emitter sampling never finds.
        bool is_delta = true;
        /// Whether the path passed straight through the surface.
        bool is_null = true;
    };

    SurfaceInteraction3f intersect(const Scene &scene, const Walk &walk) const {
        if (walk.depth == 0 && m_hide_emitters)
            return this->skip_area_emitters(&scene, walk.ray, true)
                .compute_surface_interaction(walk.ray, uint32_t(RayFlags::All));
        return scene.ray_intersect(walk.ray, uint32_t(RayFlags::All), walk.depth == 0);
    }

    /// Radiance from an emitter that the ray hits.
    Spectrum emitted(const Scene &scene, const SurfaceInteraction3f &si, const Walk &walk) const {
        const Emitter *emitter = si.emitter(&scene);
        if (!emitter || (walk.depth == 0 && m_hide_emitters))
            return 0.f;
        float other = 0.f;
        if (!walk.is_delta)
            other = scene.pdf_emitter_direction(walk.from, DirectionSample3f(&scene, si, walk.from));
        return walk.throughput * emitter->eval(si) * power_weight(walk.density, other);
    }

    /// Radiance towards the camera due to a sample of an emitter.
    Spectrum lit_by_emitters(const Scene &scene, Sampler &sampler,
                             const SurfaceInteraction3f &si) const {
        const BSDF *bsdf = si.shape->bsdf();
        if (!has_flag(bsdf->flags(), BSDFFlags::Smooth))
            return 0.f;
        Point2f u           = sampler.next_2d();
        auto [sample, kept] = scene.sample_emitter_direction(si, u, false);
        auto [value, density] = bsdf->eval_pdf(BSDFContext(), si, si.to_local(sample.d));
        Spectrum light = value * kept;
        if (const Surface *surface = surface_at(bsdf, si))
            light += density * reradiated(scene, sampler, si, *surface, u);
        if (sample.pdf == 0.f || dr::all(light == 0.f) || scene.ray_test(si.spawn_ray_to(sample.p)))
            return 0.f;
        return light * (sample.delta ? 1.f : power_weight(sample.pdf, density));
    }

    /// The same emitter's light that the surface re-radiates at the path's wavelengths. The direction
    /// of an emitter's sample does not depend on wavelengths: the same `u` gives the same direction.
    Spectrum reradiated(const Scene &scene, Sampler &sampler, const SurfaceInteraction3f &si,
                        const Surface &surface, const Point2f &u) const {
        Point2f v  = sampler.next_2d();
        auto alone = Surface::Events::FluorescenceAlone;
        auto drawn = surface.draw_incident(alone, si, spread(v.x()), spread(v.y()));
        if (dr::all(drawn.weight == 0.f))
            return 0.f;
        SurfaceInteraction3f incident = si;
        incident.wavelengths          = drawn.incident_nm;
        return drawn.weight * scene.sample_emitter_direction(incident, u, false).second;
    }

    /// Draws the next direction and wavelengths; returns whether the path continues.
    bool scatter(Sampler &sampler, const SurfaceInteraction3f &si, Walk &walk) const {
        const BSDF *bsdf = si.shape->bsdf();
        float lobe       = sampler.next_1d();
        auto [sample, weight] = bsdf->sample(BSDFContext(), si, lobe, sampler.next_2d());
        walk.is_null = has_flag(sample.sampled_type, BSDFFlags::Null);
        if (sample.pdf == 0.f)
            return false;
        walk.ray = si.spawn_ray(si.to_world(sample.wo));
        if (const Surface *surface = surface_at(bsdf, si)) {
            Point2f v  = sampler.next_2d();
            auto both  = Surface::Events::ReflectionAndFluorescence;
            auto drawn = surface->draw_incident(both, si, spread(v.x()), spread(v.y()));
            walk.ray.wavelengths = drawn.incident_nm;
            weight               = drawn.weight;
        }
        walk.throughput *= weight;
        walk.eta *= sample.eta;
        walk.from     = si;
        walk.density  = sample.pdf;
        walk.is_delta = has_flag(sample.sampled_type, BSDFFlags::Delta);
        return dr::any(walk.throughput != 0.f);
    }

    /// Russian roulette, from `rr_depth` on; returns whether the path continues.
    bool survives(Sampler &sampler, Walk &walk) const {
        if (walk.depth < m_rr_depth)
            return true;
        float greatest    = dr::max(walk.throughput) * walk.eta * walk.eta;
        float probability = std::min(greatest, GREATEST_SURVIVAL);
        walk.throughput /= probability;
        return sampler.next_1d() < probability;
    }

    /// One random number per wavelength, a quarter apart: each is uniform, and together they are
    /// stratified, which is less noisy than four independent numbers.
    static Wavelength spread(float u) {
        Wavelength numbers = dr::arange<Wavelength>() / float(Wavelength::Size) + u;
        return numbers - dr::floor(numbers);
    }

    /// Weight of a sample, given its density and that of the other strategy for the same direction.
    static float power_weight(float density, float other) {
        float ratio = other / density;
        return 1.f / (1.f + ratio * ratio);
    }

    /// Stores the fluorescent surfaces of a scene's shapes, and warns of those it cannot access.
    void find_fluorescence(const Scene &scene) {
        m_sides.clear();
        for (const auto &shape : scene.shapes()) {
            const BSDF *bsdf = shape->bsdf();
            if (!bsdf || m_sides.count(bsdf))
                continue;
            Sides sides(bsdf);
            if (sides.loses())
                Log(Warn, "upglow_path: fluorescence inside \"%s\" (%s) is not rendered, expected a "
                    "BSDF of type upglow, or one in twosided", bsdf->id(), bsdf->class_name());
            m_sides.emplace(bsdf, sides);
        }
    }

    /// The surface that the path met, if it is fluorescent; otherwise null.
    const Surface *surface_at(const BSDF *bsdf, const SurfaceInteraction3f &si) const {
        auto found = m_sides.find(bsdf);
        // Shapes in groups are not among the scene's, and `sample` may be called without `render`.
        Sides sides = found == m_sides.end() ? Sides(bsdf) : found->second;
        return sides.met_at(Frame3f::cos_theta(si.wi));
    }

    std::map<const BSDF *, Sides> m_sides;

    MI_TRAVERSE_CB(Base)
};

struct PathVariants {
    static constexpr const char *text =
        "scalar_spectral; the Python package upglow.mitsuba has the integrator for others";
};

using Path = FluorescentPath<float, mitsuba::Spectrum<float, 4>>;

}  // namespace upglow_mitsuba

extern "C" MI_EXPORT void init_plugin(std::string_view name, mitsuba::PluginRegisterFn plugin) {
    using namespace upglow_mitsuba;
    const Variant works[] = { { "scalar_spectral", instantiate<Path> } };
    enter<PathVariants>(name, plugin, mitsuba::ObjectType::Integrator, works,
                        std::make_index_sequence<variant_count()>());
}
