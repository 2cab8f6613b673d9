/// The plugin `upglow`: a BSDF.

#include <drjit/autodiff.h>
#include <drjit/jit.h>

#include "fluorescent_surface.h"
#include "surface.h"
#include "variants.h"

namespace upglow_mitsuba {

struct SurfaceVariants {
    static constexpr const char *text = "scalar_spectral or llvm_ad_spectral; the Python package "
                                        "upglow.mitsuba has the plugin for others";
};

using Traced = drjit::DiffArray<JitBackend::LLVM, float>;
using Scalar = FluorescentSurface<float, mitsuba::Spectrum<float, 4>>;
using Llvm   = Surface<Traced, mitsuba::Spectrum<Traced, 4>>;

}  // namespace upglow_mitsuba

extern "C" MI_EXPORT void init_plugin(std::string_view name, mitsuba::PluginRegisterFn plugin) {
    using namespace upglow_mitsuba;
    const Variant works[] = { { "scalar_spectral", instantiate<Scalar> },
                              { "llvm_ad_spectral", instantiate<Llvm> } };
    enter<SurfaceVariants>(name, plugin, mitsuba::ObjectType::BSDF, works,
                           std::make_index_sequence<variant_count()>());
}
