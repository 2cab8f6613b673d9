/// The plugin `upglow_path`: path tracing in which a wavelength may change on its way.

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

#if defined(__x86_64__) && !defined(__AVX2__)
#  error "expected -march=haswell: Mitsuba's wheel passes packets of numbers in AVX registers"
#endif

namespace upglow_mitsuba {

using namespace mitsuba;

/// Paths that survive a draw survive it with at most this probability, so that even a path that loses
/// nothing ends. Nearer to 1 paths are longer, further from it noisier. Mitsuba's `path` has the same.
constexpr float GREATEST_SURVIVAL = 0.95f;

/// Path tracing with emitter sampling, both combined by multiple importance sampling with the power
/// heuristic.
///
/// Each ray carries four wavelengths, and a fluorescent surface may change each without the others:
/// they share their geometry, and all lobes that re-radiate are those that reflect. Directions alone
/// decide the weights of the two strategies, so that they stay right whatever wavelengths are drawn.
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
    /// A path on its way from the camera.
    struct Walk {
        explicit Walk(const RayDifferential3f &camera) : ray(Ray3f(camera)) {}

        /// Where it goes next. Its wavelengths are the current ones; the film keeps the camera's.
        Ray3f ray;
        Spectrum radiance   = 0.f;
        Spectrum throughput = 1.f;
        /// Product of the relative indices of refraction so far.
        float eta = 1.f;
        /// Surfaces met so far.
        uint32_t depth = 0;
        /// The last surface, and the density with which its BSDF drew the ray's direction.
        Interaction3f from = dr::zeros<Interaction3f>();
        float density      = 1.f;
        /// Whether no emitter's sample could have found that direction.
        bool is_delta = true;
        /// Whether the surface was one to go straight through.
        bool is_null = true;
    };

    SurfaceInteraction3f intersect(const Scene &scene, const Walk &walk) const {
        if (walk.depth == 0 && m_hide_emitters)
            return this->skip_area_emitters(&scene, walk.ray, true)
                .compute_surface_interaction(walk.ray, uint32_t(RayFlags::All));
        return scene.ray_intersect(walk.ray, uint32_t(RayFlags::All), walk.depth == 0);
    }

    /// What an emitter that the path ran into adds.
    Spectrum emitted(const Scene &scene, const SurfaceInteraction3f &si, const Walk &walk) const {
        const Emitter *emitter = si.emitter(&scene);
        if (!emitter || (walk.depth == 0 && m_hide_emitters))
            return 0.f;
        float other = 0.f;
        if (!walk.is_delta)
            other = scene.pdf_emitter_direction(walk.from, DirectionSample3f(&scene, si, walk.from));
        return walk.throughput * emitter->eval(si) * power_weight(walk.density, other);
    }

    /// The light that an emitter's sample sends through the surface towards the camera.
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
            light += density * shifted(scene, sampler, si, *surface, u);
        if (sample.pdf == 0.f || dr::all(light == 0.f) || scene.ray_test(si.spawn_ray_to(sample.p)))
            return 0.f;
        return light * (sample.delta ? 1.f : power_weight(sample.pdf, density));
    }

    /// The same emitter's light that the surface moves to the path's wavelengths. The direction of an
    /// emitter's sample does not depend on wavelengths, so it is drawn once more for other ones.
    Spectrum shifted(const Scene &scene, Sampler &sampler, const SurfaceInteraction3f &si,
                     const Surface &surface, const Point2f &u) const {
        Point2f v  = sampler.next_2d();
        auto drawn = surface.draw_fluorescent(si, spread(v.x()), spread(v.y()));
        if (dr::all(drawn.weight == 0.f))
            return 0.f;
        SurfaceInteraction3f incident = si;
        incident.wavelengths          = drawn.incident_nm;
        return drawn.weight * scene.sample_emitter_direction(incident, u, false).second;
    }

    /// Draws the next direction, and the next wavelengths; whether there is anything left to follow.
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
            auto drawn = surface->draw_incident(si, spread(v.x()), spread(v.y()));
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

    /// Ends paths that carry little, at random and without bias, once they are `rr_depth` long.
    bool survives(Sampler &sampler, Walk &walk) const {
        if (walk.depth < m_rr_depth)
            return true;
        float carried     = dr::max(walk.throughput) * walk.eta * walk.eta;
        float probability = std::min(carried, GREATEST_SURVIVAL);
        walk.throughput /= probability;
        return sampler.next_1d() < probability;
    }

    /// One random number for each wavelength, a quarter apart: each is uniform, and together they
    /// leave no part of the choice unseen, which is less noise than four that know nothing of another.
    static Wavelength spread(float u) {
        Wavelength numbers = dr::arange<Wavelength>() / float(Wavelength::Size) + u;
        return numbers - dr::floor(numbers);
    }

    /// Weight of a sample, given its density and that of the other strategy for the same direction.
    static float power_weight(float density, float other) {
        float ratio = other / density;
        return 1.f / (1.f + ratio * ratio);
    }

    /// Notes the fluorescent surfaces of a scene's shapes, and warns of those it cannot reach.
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

    /// The fluorescent surface that the path met, if it is one.
    const Surface *surface_at(const BSDF *bsdf, const SurfaceInteraction3f &si) const {
        auto found = m_sides.find(bsdf);
        // Shapes in groups are not among the scene's, and `sample` can be called without `render`.
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
