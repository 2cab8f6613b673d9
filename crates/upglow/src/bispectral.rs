//! The trait by which a renderer evaluates and samples a material.

/// Wavelengths are clamped to this, nm: beyond it, parabolas overflow in single precision.
pub const FARTHEST_NM: f32 = 1e4;

/// A material that reflects and re-radiates: [`crate::Mixture`] in double precision,
/// [`crate::PackedMixture`] in single.
///
/// # Which wavelengths
///
/// Any number is a wavelength. Those outside 0 to 10 000 nm count as the nearer end. For NaN every function returns NaN,
/// and the samplers draw nothing. Shares are in 0..=1 to the last bit, in double precision and in single, and so is the
/// throughput of a path from the light where the table of a dye holds its whole emission. Nothing panics.
///
/// # Drawing wavelengths
///
/// A path from the camera knows the outgoing wavelength and draws the incident one; a path from the
/// light knows the incident wavelength and draws the outgoing one. The elastic part is a Dirac
/// delta: it has a probability, not a density. The fluorescent part has a density per nm, which
/// combines with those of other strategies by multiple importance sampling.
///
/// # Examples
///
/// ```
/// use upglow::{Bispectral, Draw, DyeModel, DyeOptions, DyeSet, Fluorescence};
/// use upglow::{Material, Mixture, Model, Sigmoid};
///
/// let model = Model::Dyes(DyeModel::new(DyeSet::named("konig8")?, DyeOptions::default())?);
/// let fluorescence = Fluorescence::Dyes { first: 2, weight: 0.5, concentration: 0.8 };
/// let reflectance = Sigmoid::flat(0.5);
/// let mixture = Mixture::of(&model, Material { reflectance, fluorescence });
/// let sample = mixture.sample_incident(540.0, [0.9, 0.5]).ok_or("absorbs everything")?;
/// if let Draw::Fluorescent { per_nm } = sample.draw {
///     // The balance heuristic weighs this draw against one from the light's side.
///     let from_light_per_nm = mixture.outgoing_pdf_per_nm(sample.nm, 540.0);
///     let weight = per_nm / (per_nm + from_light_per_nm);
///     assert!(weight > 0.0 && weight <= 1.0);
///     assert_eq!(per_nm, mixture.incident_pdf_per_nm(sample.nm, 540.0));
/// }
/// let sample = mixture.sample_outgoing(500.0, [0.1, 0.5]).ok_or("absorbs everything")?;
/// // They differ by the part of a measured emission that lies outside its table.
/// assert!((sample.throughput / mixture.albedo(500.0) - 1.0).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Bispectral {
    /// `f32` or `f64`.
    type Real: Copy;

    /// Whether any light is re-emitted at another wavelength.
    fn is_fluorescent(&self) -> bool;

    /// Share of incident light at `lambda_nm` that is reflected at the same wavelength, 0..=1:
    /// (1 − c·a(λ))·r(λ).
    fn reflectance(&self, lambda_nm: Self::Real) -> Self::Real;

    /// [`Bispectral::reflectance`] at each of `lambda_nm`, up to the length of `shares`.
    fn reflectances(&self, lambda_nm: &[Self::Real], shares: &mut [Self::Real]) {
        for (share, nm) in shares.iter_mut().zip(lambda_nm) {
            *share = self.reflectance(*nm);
        }
    }

    /// Energy re-emitted per nm at `out_nm` by fluorescence, per unit of incident energy at `in_nm`;
    /// 1/nm. Reflection at the same wavelength is [`Bispectral::reflectance`].
    fn reradiation_per_nm(&self, in_nm: Self::Real, out_nm: Self::Real) -> Self::Real;

    /// Share of the incident energy at `in_nm` that leaves at any wavelength, 0..=1.
    fn albedo(&self, in_nm: Self::Real) -> Self::Real;

    /// Draws the incident wavelength for a known outgoing one: for a path from the camera. `u` are
    /// two independent numbers in 0..1; the first chooses between reflection and fluorescence, the
    /// second draws the wavelength.
    ///
    /// `None` if no light can leave at `out_nm`.
    fn sample_incident(&self, out_nm: Self::Real, u: [Self::Real; 2])
    -> Option<Sample<Self::Real>>;

    /// The density, 1/nm, with which [`Bispectral::sample_incident`] draws `in_nm` by fluorescence.
    fn incident_pdf_per_nm(&self, in_nm: Self::Real, out_nm: Self::Real) -> Self::Real;

    /// The probability, 0..=1, that [`Bispectral::sample_incident`] keeps the wavelength.
    fn incident_elastic_probability(&self, out_nm: Self::Real) -> Self::Real;

    /// Draws the outgoing wavelength for a known incident one: for a path from the light. `u` are
    /// two independent numbers in 0..1; the first chooses between reflection and fluorescence, the
    /// second draws the wavelength.
    ///
    /// `None` if all light at `in_nm` is absorbed.
    fn sample_outgoing(&self, in_nm: Self::Real, u: [Self::Real; 2]) -> Option<Sample<Self::Real>>;

    /// The density, 1/nm, with which [`Bispectral::sample_outgoing`] draws `out_nm` by fluorescence.
    fn outgoing_pdf_per_nm(&self, in_nm: Self::Real, out_nm: Self::Real) -> Self::Real;

    /// The probability, 0..=1, that [`Bispectral::sample_outgoing`] keeps the wavelength.
    fn outgoing_elastic_probability(&self, in_nm: Self::Real) -> Self::Real;
}

/// A wavelength drawn from a material, in double or single precision.
#[must_use]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T> {
    /// The wavelength drawn, nm.
    pub nm: T,
    /// Factor of the path's throughput: reflectance or re-radiation divided by the probability or
    /// density of the draw. It depends on the known wavelength only, except for the incident wavelengths
    /// of films: their densities are near to what returns, not equal to it.
    pub throughput: T,
    /// How the wavelength was drawn and how likely it was.
    pub draw: Draw<T>,
}

/// How a wavelength was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Draw<T> {
    /// The wavelength was kept.
    Elastic {
        /// The probability of that, 0..=1.
        probability: T,
    },
    /// The wavelength was changed.
    Fluorescent {
        /// The density of the wavelength drawn, 1/nm. Its integral is 1 less the probability of the
        /// elastic draw.
        per_nm: T,
    },
}
