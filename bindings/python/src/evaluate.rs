//! What a looked-up material answers, in single or double precision.

use upglow::{Blend, Draw, Mixture, Sample};

use crate::rows::Number;

/// Which wavelength of light is drawn; the other one is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// That of incident light: the camera's way.
    Incident,
    /// That of the light that leaves: the light's way.
    Outgoing,
}

/// A material that answers in numbers of type `T`; albedo and re-radiation have one name in both.
pub(crate) trait Evaluate<T: Number> {
    /// The reflectance at each wavelength, nm.
    fn reflectances(&self, wavelengths_nm: &[T], out: &mut [T]);
    /// A wavelength drawn from two numbers in 0..1; `None` where nothing comes back.
    fn sample(&self, way: Way, known_nm: T, u: [T; 2]) -> Option<Sample<T>>;
    /// The density of a wavelength drawn, 1/nm.
    fn pdf_per_nm(&self, way: Way, in_nm: T, out_nm: T) -> T;
    /// How likely the wavelength is kept.
    fn elastic_probability(&self, way: Way, known_nm: T) -> T;
}

macro_rules! evaluate {
    ($material:ident, $number:ty, $reflectances:path) => {
        impl Evaluate<$number> for $material<'_> {
            fn reflectances(&self, wavelengths_nm: &[$number], out: &mut [$number]) {
                $reflectances(self, wavelengths_nm, out);
            }

            fn sample(
                &self,
                way: Way,
                known_nm: $number,
                u: [$number; 2],
            ) -> Option<Sample<$number>> {
                match way {
                    Way::Incident => self.sample_incident(known_nm, u),
                    Way::Outgoing => self.sample_outgoing(known_nm, u),
                }
            }

            fn pdf_per_nm(&self, way: Way, in_nm: $number, out_nm: $number) -> $number {
                match way {
                    Way::Incident => self.incident_pdf_per_nm(in_nm, out_nm),
                    Way::Outgoing => self.outgoing_pdf_per_nm(in_nm, out_nm),
                }
            }

            fn elastic_probability(&self, way: Way, known_nm: $number) -> $number {
                match way {
                    Way::Incident => self.incident_elastic_probability(known_nm),
                    Way::Outgoing => self.outgoing_elastic_probability(known_nm),
                }
            }
        }
    };
}

evaluate!(Mixture, f64, one_by_one);
evaluate!(Blend, f32, eight_by_eight);

fn one_by_one(mixture: &Mixture<'_>, wavelengths_nm: &[f64], out: &mut [f64]) {
    for (out, nm) in out.iter_mut().zip(wavelengths_nm) {
        *out = mixture.reflectance(*nm);
    }
}

fn eight_by_eight(blend: &Blend<'_>, wavelengths_nm: &[f32], out: &mut [f32]) {
    for (out, nm) in out.chunks_mut(8).zip(wavelengths_nm.chunks(8)) {
        let mut eight = [nm[0]; 8];
        eight[..nm.len()].copy_from_slice(nm);
        out.copy_from_slice(&blend.reflectance8(eight)[..nm.len()]);
    }
}

/// Wavelength, throughput, probability or density, and 1 where the wavelength was kept.
pub(crate) fn numbers_of<T: Number>(sample: Option<Sample<T>>) -> [T; 4] {
    let [zero, one] = [0.0, 1.0].map(T::from_double);
    match sample {
        None => [T::NAN, zero, zero, zero],
        Some(Sample { nm, throughput, draw: Draw::Elastic { probability } }) => {
            [nm, throughput, probability, one]
        }
        Some(Sample { nm, throughput, draw: Draw::Fluorescent { per_nm } }) => {
            [nm, throughput, per_nm, zero]
        }
    }
}
