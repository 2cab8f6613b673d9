/// The surface in scalar variants, where every call reaches the library: it fluoresces as well.

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
    using Draw = typename Fluorescence<Float, Spectrum>::Draw;

    using Base::Base;

    Draw draw_incident(const SurfaceInteraction3f &si, const Wavelength &choice,
                       const Wavelength &u) const override {
        UpglowMaterial material = material_at(si);
        Draw draw{ si.wavelengths, Spectrum(0.f) };
        for (size_t i = 0; i < Wavelength::Size; ++i) {
            UpglowSample sample = drawn(material, si.wavelengths[i], choice[i], u[i]);
            draw.incident_nm[i] = sample.lambda_nm;
            draw.weight[i]      = sample.throughput;
        }
        return draw;
    }

    Draw draw_fluorescent(const SurfaceInteraction3f &si, const Wavelength &choice,
                          const Wavelength &u) const override {
        UpglowMaterial material = material_at(si);
        Draw draw{ si.wavelengths, Spectrum(0.f) };
        for (size_t i = 0; i < Wavelength::Size; ++i) {
            float kept = elastic_probability(material, si.wavelengths[i]);
            // The library takes reflection where the first number is below `kept`.
            float above         = kept + (1.f - kept) * choice[i];
            UpglowSample sample = drawn(material, si.wavelengths[i], above, u[i]);
            if (sample.draw != UPGLOW_DRAW_FLUORESCENT)
                continue;
            draw.incident_nm[i] = sample.lambda_nm;
            draw.weight[i]      = sample.throughput * (1.f - kept);
        }
        return draw;
    }

private:
    static UpglowSample drawn(const UpglowMaterial &material, float out_nm, float choice, float u) {
        const float numbers[2] = { choice, u };
        UpglowSample sample;
        expect_ok(upglow_sample_incident(&material, out_nm, numbers, &sample));
        return sample;
    }

    static float elastic_probability(const UpglowMaterial &material, float out_nm) {
        float probability;
        expect_ok(upglow_incident_elastic_probability(&material, out_nm, &probability));
        return probability;
    }
};

}  // namespace upglow_mitsuba
