/// The interface between fluorescent surfaces and integrators. Mitsuba's own interface of BSDFs does
/// not support changes of wavelength: an integrator gets this one from a BSDF by `dynamic_cast`.

#pragma once

#include <mitsuba/render/interaction.h>

namespace upglow_mitsuba {

/// A BSDF that re-radiates light at other wavelengths.
///
/// Reflection and fluorescence have the same distribution of directions: the BSDF's value, including
/// the cosine, is its `pdf()` times the reflectance, and for fluorescence the same `pdf()` times the
/// re-radiation. An integrator draws a direction from the BSDF and wavelengths from this interface.
template <typename Float, typename Spectrum> class Fluorescence {
public:
    using Wavelength           = mitsuba::wavelength_t<Spectrum>;
    using SurfaceInteraction3f = mitsuba::SurfaceInteraction<Float, Spectrum>;

    /// Incident wavelengths, one drawn for each that leaves.
    struct Draw {
        /// Wavelengths of the incident light, nm.
        Wavelength incident_nm;
        /// The surface's value divided by the probability or density of the draw; 0 for absorption.
        Spectrum weight;
    };

    /// The events to draw from.
    enum class Events { ReflectionAndFluorescence, FluorescenceAlone };

    /// Draws incident wavelengths for light that leaves at `si.wavelengths`. `choice` and `u` are
    /// uniform in 0 to 1, 1 excluded.
    virtual Draw draw_incident(Events events, const SurfaceInteraction3f &si,
                               const Wavelength &choice, const Wavelength &u) const = 0;

    virtual ~Fluorescence() = default;
};

}  // namespace upglow_mitsuba
