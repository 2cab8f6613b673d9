/// The surface in scalar variants. They can call the library at every point, so it fluoresces too.

#pragma once

#include "fluorescence.h"
#include "surface.h"

namespace upglow_mitsuba {

template <typename Float, typename Spectrum>
class FluorescentSurface final : public Surface<Float, Spectrum>,
                                 public Fluorescence<Float, Spectrum> {
public:
    MI_IMPORT_BASE(Surface, material_at)
    MI_IMPORT_TYPES()
    using typename Fluorescence<Float, Spectrum>::Draw;
    using typename Fluorescence<Float, Spectrum>::Events;

    using Base::Base;

    Draw draw_incident(Events events, const SurfaceInteraction3f &si, const Wavelength &choice,
                       const Wavelength &u) const override {
        UpglowMaterial material = material_at(si);
        Draw draw{ si.wavelengths, Spectrum(0.f) };
        for (size_t i = 0; i < Wavelength::Size; ++i) {
            float out_nm = si.wavelengths[i], skipped = 0.f;
            if (events == Events::FluorescenceAlone)
                expect_ok(upglow_incident_elastic_probability(&material, out_nm, &skipped));
            // The library draws reflection if the first number is below its probability.
            const float numbers[2] = { skipped + (1.f - skipped) * choice[i], u[i] };
            UpglowSample sample;
            expect_ok(upglow_sample_incident(&material, out_nm, numbers, &sample));
            if (events == Events::FluorescenceAlone && sample.draw != UPGLOW_DRAW_FLUORESCENT)
                continue;
            draw.incident_nm[i] = sample.lambda_nm;
            draw.weight[i]      = sample.throughput * (1.f - skipped);
        }
        return draw;
    }
};

}  // namespace upglow_mitsuba
