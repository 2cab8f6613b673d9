/// What a surface that changes wavelengths tells an integrator. Mitsuba's own interface of BSDFs has
/// no place for it: an integrator asks a BSDF for this one by `dynamic_cast`.

#pragma once

#include <mitsuba/render/interaction.h>

namespace upglow_mitsuba {

/// A BSDF whose light may leave at another wavelength than it came in.
///
/// Reflection and fluorescence share their directions: at any wavelength the BSDF's value, cosine
/// included, is its `pdf()` times what the surface reflects, and the same `pdf()` times what it
/// re-radiates. An integrator draws a direction from the BSDF and wavelengths from here.
template <typename Float, typename Spectrum> class Fluorescence {
public:
    using Wavelength           = mitsuba::wavelength_t<Spectrum>;
    using SurfaceInteraction3f = mitsuba::SurfaceInteraction<Float, Spectrum>;

    /// Incident wavelengths that were drawn, one for each that leaves.
    struct Draw {
        /// Wavelengths of the incident light, nm.
        Wavelength incident_nm;
        /// What the surface carries from there, divided by how likely the draw was; 0 where it
        /// carries nothing.
        Spectrum weight;
    };

    /// Draws incident wavelengths for light that leaves at `si.wavelengths`: each is kept, or changed
    /// by fluorescence. `choice` and `u` are uniform in 0 to 1, 1 excluded.
    virtual Draw draw_incident(const SurfaceInteraction3f &si, const Wavelength &choice,
                               const Wavelength &u) const = 0;

    /// The same by fluorescence alone: no wavelength is kept.
    virtual Draw draw_fluorescent(const SurfaceInteraction3f &si, const Wavelength &choice,
                                  const Wavelength &u) const = 0;

    virtual ~Fluorescence() = default;
};

}  // namespace upglow_mitsuba
