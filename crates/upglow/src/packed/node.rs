//! The packed layout of a material, which look-up tables, shaders and bindings read.

use upglow_color::rounding::to_single;

use crate::cube::{Cube, Node};
use crate::material::Fluorescence;
use crate::material::edge::Edge;
use crate::material::model::Model;

/// One material as devices read it: eight numbers in single precision, all finite.
///
/// This is the one packed layout; `docs/cube-format.md` describes it for other languages.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub struct PackedNode {
    /// Wavelength e (nm), then the coefficients of 1, d and d² in x, with d = λ − e: the reflectance
    /// is ½ + x / (2·√(1 + x²)).
    pub reflectance: [f32; 4],
    /// Ring of dyes: weight of the second, concentration, ∫ returned dλ (nm), number of the first.
    /// Film: optical density of the second dye, of the first, number of the second, of the first.
    /// Bells: emission peak (nm), concentration, ∫ returned dλ (nm), absorption peak (nm). Zeros where
    /// nothing fluoresces; otherwise the second number is above 0.
    pub fluorescence: [f32; 4],
}

macro_rules! packed {
    ($(#[$doc:meta])+ $packed:ident { $($(#[$field_doc:meta])+ $field:ident),+ }) => {
        $(#[$doc])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub(crate) struct $packed<T> {
            $($(#[$field_doc])+ pub(crate) $field: T,)+
        }

        impl<T> From<[T; 4]> for $packed<T> {
            #[inline(always)]
            fn from([$($field),+]: [T; 4]) -> Self {
                Self { $($field),+ }
            }
        }

        impl<T> From<$packed<T>> for [T; 4] {
            #[inline(always)]
            fn from(packed: $packed<T>) -> Self {
                [$(packed.$field),+]
            }
        }
    };
}

packed! {
    /// The reflectance of a [`PackedNode`] by name; `T` is one number, or one for each of several
    /// nodes.
    PackedReflectance {
        /// The wavelength that distances are taken from, nm.
        edge_nm,
        /// x there.
        constant,
        /// Coefficient of d, 1/nm.
        linear,
        /// Coefficient of d², 1/nm².
        quadratic
    }
}

packed! {
    /// The fluorescence of a [`PackedNode`] in a model of dyes.
    PackedDyes {
        /// Share of the second dye, 0..=1.
        weight,
        /// Share of the light at the absorption's peak that is absorbed, 0..=1.
        concentration,
        /// ∫ returned dλ over all incident wavelengths, nm.
        returned_nm,
        /// The first dye's number in the ring.
        first
    }
}

packed! {
    /// The fluorescence of a [`PackedNode`] in a film.
    PackedFilm {
        /// Optical density of the second dye, 0..=6.
        second_density,
        /// Optical density of the first dye, not below the second's.
        first_density,
        /// The second dye's number.
        second,
        /// The first dye's number.
        first
    }
}

packed! {
    /// The fluorescence of a [`PackedNode`] in a model of bells.
    PackedBells {
        /// Wavelength of the emission's peak, nm.
        emission_nm,
        /// Share of the light at the absorption's peak that is absorbed, 0..=1.
        concentration,
        /// ∫ returned dλ over all incident wavelengths, nm.
        returned_nm,
        /// Wavelength of the absorption's peak, nm.
        absorption_nm
    }
}

/// Edges beyond this, nm, are restated around [`CENTER_NM`]: distances from them lose all digits in
/// single precision.
const FARTHEST_EDGE_NM: f64 = 1e5;
const CENTER_NM: f64 = 550.0;

/// Greatest coefficients of 1, d and d². Larger ones overflow when the parabola is squared at the
/// greatest distances; smaller ones bend reflectances that rise within one step of a wavelength in
/// single precision, 6e-5 nm.
const GREATEST_COEFFICIENTS: [f64; 3] = [1e18, 1e12, 1e8];

impl Cube {
    /// The nodes in the packed layout, `[blue][green][red]`.
    pub fn packed_nodes(&self) -> impl ExactSizeIterator<Item = PackedNode> + '_ {
        self.nodes().iter().map(|node| PackedNode::new(node, self.model()))
    }
}

impl PackedNode {
    /// The material of a node under a model.
    pub fn new(node: &Node, model: &Model) -> Self {
        Self {
            reflectance: single(bounded_parabola(node.edge()).into()),
            fluorescence: single(packed_fluorescence(node.material(model).fluorescence, model)),
        }
    }
}

fn packed_fluorescence(fluorescence: Fluorescence, model: &Model) -> [f64; 4] {
    let returned_nm = fluorescence.lobes(model).map(|lobe| lobe.proposed_total_nm()).sum();
    match fluorescence {
        Fluorescence::None => [0.0; 4],
        Fluorescence::Dyes { first, weight, concentration } => {
            PackedDyes { weight, concentration, returned_nm, first: first as f64 }.into()
        }
        Fluorescence::Film { dyes, densities: [first_density, second_density] } => {
            let [first, second] = dyes.map(|dye| dye as f64);
            PackedFilm { second_density, first_density, second, first }.into()
        }
        Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, concentration } => {
            let absorption_nm = emission_peak_nm - stokes_shift_nm;
            let emission_nm = emission_peak_nm;
            PackedBells { emission_nm, concentration, returned_nm, absorption_nm }.into()
        }
    }
}

/// The parabola of an edge for evaluation in single precision: an edge far from all light is
/// restated around 550 nm, coefficients that would overflow are bounded, and NaN becomes a bound.
fn bounded_parabola(edge: Edge) -> PackedReflectance<f64> {
    let ([mut constant, mut linear, quadratic], mut edge_nm) = (edge.parabola(), edge.edge_nm);
    if edge_nm.abs() > FARTHEST_EDGE_NM {
        let d = CENTER_NM - edge_nm;
        constant += d * (linear + d * quadratic);
        linear += 2.0 * d * quadratic;
        edge_nm = CENTER_NM;
    }
    let [c, l, q] = GREATEST_COEFFICIENTS;
    // `max` takes the limit where the value is NaN.
    let within = |value: f64, limit: f64| value.max(-limit).min(limit);
    PackedReflectance {
        edge_nm,
        constant: within(constant, c),
        linear: within(linear, l),
        quadratic: within(quadratic, q),
    }
}

/// The nearest numbers in single precision; 0 if one is not finite.
fn single(numbers: [f64; 4]) -> [f32; 4] {
    numbers.map(to_single).map(|value| if value.is_finite() { value } else { 0.0 })
}
