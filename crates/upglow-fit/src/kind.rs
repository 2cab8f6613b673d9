//! Kinds of material, as reports count them.

use rayon::prelude::*;
use upglow::{Cube, FitRecord, LookupError, Mixture, ModelOnGrid, Node};
use upglow_color::{Colorimetry, Grid, LinearRgb, Xyz, choices, ciede2000};

use crate::fit::{EXACT, Fit};

/// What a color needed, under the limits that a cube was fitted with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MaterialKind {
    /// A reflectance alone, no steeper than the limit.
    Reflectance,
    /// Fluorescence over a reflectance no steeper than the limit under dyes.
    Dyed,
    /// A reflectance steeper than its limit, with fluorescence or without.
    Steep,
    /// None matches: the material is more than 0.01 ΔE00 from its color.
    Missed,
}

choices!(
    MaterialKind,
    "kind of material",
    Reflectance = "reflectance",
    Dyed = "dyed",
    Steep = "steep",
    Missed = "missed",
);

/// How many materials of each kind there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[must_use]
pub struct KindCounts {
    /// [`MaterialKind::Reflectance`].
    pub reflectance: u64,
    /// [`MaterialKind::Dyed`].
    pub dyed: u64,
    /// [`MaterialKind::Steep`].
    pub steep: u64,
    /// [`MaterialKind::Missed`].
    pub missed: u64,
}

/// The kinds of the blends of a cube, which are counted for each texel of a picture.
///
/// A blend is of the kind of its last node in the order of [`MaterialKind`]: with dyes if one of up to
/// four nodes has dyes, steeper if one is steeper than its limit. Where the nodes match their colors, so
/// do their blends. Where one misses, the blend is measured: it is missed if it is more than
/// 0.01 ΔE00 from its own color.
#[derive(Clone, Debug)]
#[must_use]
pub struct BlendKinds<'c> {
    cube: &'c Cube,
    colorimetry: Colorimetry,
    /// `[blue][green][red]`.
    parts: Vec<BlendPart>,
    /// The kind of all blends in a cell, by its darkest node, if its nodes match and are of one kind. Most
    /// cells are so, and their colors need neither weights nor differences.
    cells: Vec<Option<MaterialKind>>,
}

/// A node, as a part of blends.
#[derive(Clone, Copy, Debug)]
struct BlendPart {
    /// The kind of the node if it matches its color.
    kind: MaterialKind,
    is_missed: bool,
    /// The color; zero, and never read, if no cell around the node has one that misses.
    color: Xyz,
}

impl MaterialKind {
    /// The kind of a material of `cube`: a node, or the single material that was found for a texel. One
    /// whose difference is NaN was not measured, and is not counted as missed.
    pub fn of_node(node: &Node, cube: &Cube) -> Self {
        Self::of([Self::slope_and_glow(node, cube)], node.de2000.into(), cube.fit())
    }

    fn slope_and_glow(node: &Node, cube: &Cube) -> (f64, bool) {
        let glows = node.material(cube.model()).fluorescence.dose() > 0.0;
        (node.edge().slope_per_nm.abs(), glows)
    }

    /// The kind of a fit under the limits of `record`.
    pub fn of_fit(fit: &Fit, record: &FitRecord) -> Self {
        let glows = fit.fluorescence.dose() > 0.0;
        Self::of([(fit.reflectance.slope_per_nm.abs(), glows)], fit.de2000, record)
    }

    /// The kind of a mixture of materials that were fitted as `fit` says, at this CIEDE2000 from its
    /// color: that of the steepest part, and dyed if any part is.
    pub fn of_mixture(mixture: &Mixture<'_>, de2000: f64, fit: &FitRecord) -> Self {
        let used = mixture.parts().filter(|(weight, _)| *weight > 0.0);
        let parts = used.map(|(_, material)| {
            (material.reflectance.steepest_slope_per_nm(), material.fluorescence.dose() > 0.0)
        });
        Self::of(parts, de2000, fit)
    }

    /// What reports for people call it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Reflectance => "reflectance",
            Self::Dyed => "with dye",
            Self::Steep => "steeper",
            Self::Missed => "missed",
        }
    }

    /// From the greatest slope (1/nm) of each part and whether it fluoresces.
    fn of(parts: impl IntoIterator<Item = (f64, bool)>, de2000: f64, fit: &FitRecord) -> Self {
        if de2000 > EXACT {
            return Self::Missed;
        }
        parts.into_iter().map(|part| Self::of_part(part, fit)).fold(Self::Reflectance, Self::or)
    }

    /// The kind of a part that matches.
    fn of_part((slope_per_nm, glows): (f64, bool), fit: &FitRecord) -> Self {
        let limit = if glows { fit.slope_under_dyes_per_nm } else { fit.slope_max_per_nm };
        match limit {
            Some(limit) if slope_per_nm > limit => Self::Steep,
            _ if glows => Self::Dyed,
            _ => Self::Reflectance,
        }
    }

    /// The later of two.
    fn or(self, other: Self) -> Self {
        if other as u8 > self as u8 { other } else { self }
    }
}

impl<'c> BlendKinds<'c> {
    /// Prepares for the colors of a cube, on all threads of the current rayon pool.
    pub fn new(cube: &'c Cube) -> Self {
        let colorimetry = cube.contract().on(Grid::FIT);
        let sums = ModelOnGrid::new(cube.model(), &colorimetry);
        let part = |node: &Node| BlendPart {
            kind: MaterialKind::of_part(MaterialKind::slope_and_glow(node, cube), cube.fit()),
            is_missed: MaterialKind::of_node(node, cube) == MaterialKind::Missed,
            color: Xyz::default(),
        };
        let mut parts: Vec<BlendPart> = cube.nodes().iter().map(part).collect();
        let mut cells = vec![None; parts.len()];
        let mut is_measured = vec![false; parts.len()];
        for (darkest, cell) in cells.iter_mut().enumerate() {
            let Some(nodes) = nodes_of_cell(cube, darkest) else { continue };
            let kind = parts[darkest].kind;
            if nodes.iter().any(|&node| parts[node].is_missed) {
                nodes.iter().for_each(|&node| is_measured[node] = true);
            } else if nodes.iter().all(|&node| parts[node].kind == kind) {
                *cell = Some(kind);
            }
        }
        let measured = parts.par_iter_mut().zip(cube.nodes()).zip(is_measured);
        measured.filter(|(_, is_measured)| *is_measured).for_each(|((part, node), _)| {
            part.color = sums.color(node.material(cube.model()));
        });
        Self { cube, colorimetry, parts, cells }
    }

    /// The kind of the blend of a color.
    ///
    /// # Errors
    ///
    /// [`LookupError::Outside`] if a component is not a number in 0..=1.
    pub fn of(&self, rgb: LinearRgb) -> Result<MaterialKind, LookupError> {
        if let Some(kind) = self.cells[self.cube.cell(rgb)?] {
            return Ok(kind);
        }
        let corners = self.cube.corners(rgb)?;
        let (mut kind, mut may_miss) = (MaterialKind::Reflectance, false);
        for (index, weight) in corners {
            if weight > 0.0 {
                let part = &self.parts[index];
                kind = kind.or(part.kind);
                may_miss |= part.is_missed;
            }
        }
        let is_missed = may_miss && self.de2000(rgb, &corners) > EXACT;
        Ok(if is_missed { MaterialKind::Missed } else { kind })
    }

    /// CIEDE2000 of the blend of `corners` from its color.
    fn de2000(&self, rgb: LinearRgb, corners: &[(usize, f64); 4]) -> f64 {
        let mut blend = Xyz([0.0; 3]);
        for &(index, weight) in corners {
            blend += weight * self.parts[index].color;
        }
        let colors = [self.colorimetry.xyz_from_rgb(rgb), blend];
        let [target, blend] = colors.map(|xyz| self.colorimetry.lab_from_xyz(xyz));
        ciede2000(target, blend)
    }
}

/// The eight nodes of the cell with this darkest node; `None` for nodes that are the darkest of no cell.
fn nodes_of_cell(cube: &Cube, darkest: usize) -> Option<[usize; 8]> {
    let n = cube.resolution();
    let is_darkest = !cube.coordinates(darkest).contains(&(n - 1));
    let node = |i: usize| darkest + (i / 4 * n + i / 2 % 2) * n + i % 2;
    is_darkest.then(|| std::array::from_fn(node))
}

impl KindCounts {
    /// Counts one more material.
    pub fn add(&mut self, kind: MaterialKind) {
        match kind {
            MaterialKind::Reflectance => self.reflectance += 1,
            MaterialKind::Dyed => self.dyed += 1,
            MaterialKind::Steep => self.steep += 1,
            MaterialKind::Missed => self.missed += 1,
        }
    }

    /// Adds the counts of others.
    pub fn join(&mut self, other: &Self) {
        self.reflectance += other.reflectance;
        self.dyed += other.dyed;
        self.steep += other.steep;
        self.missed += other.missed;
    }

    /// The count of each kind, in the order of the rule of choosing.
    pub fn each(&self) -> [(MaterialKind, u64); 4] {
        let Self { reflectance, dyed, steep, missed } = *self;
        [
            (MaterialKind::Reflectance, reflectance),
            (MaterialKind::Dyed, dyed),
            (MaterialKind::Steep, steep),
            (MaterialKind::Missed, missed),
        ]
    }
}

impl FromIterator<MaterialKind> for KindCounts {
    fn from_iter<I: IntoIterator<Item = MaterialKind>>(kinds: I) -> Self {
        let mut counts = Self::default();
        kinds.into_iter().for_each(|kind| counts.add(kind));
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cube::build_cube;
    use crate::preset::Preset;
    use crate::progress::Unwatched;
    use upglow::Interpolation;
    use upglow_color::Contract;

    #[test]
    fn a_kind_follows_from_slope_dye_and_difference() {
        let fit = FitRecord {
            slope_max_per_nm: Some(0.05),
            slope_under_dyes_per_nm: Some(0.02),
            relaxed: true,
            ..FitRecord::default()
        };
        let kind =
            |parts: &[(f64, bool)], de2000| MaterialKind::of(parts.iter().copied(), de2000, &fit);
        assert_eq!(kind(&[(0.05, false)], 0.01), MaterialKind::Reflectance);
        assert_eq!(kind(&[(0.02, true)], 0.0), MaterialKind::Dyed);
        assert_eq!(kind(&[(0.03, true)], 0.0), MaterialKind::Steep);
        assert_eq!(kind(&[(0.06, false)], 0.0), MaterialKind::Steep);
        assert_eq!(kind(&[(0.06, true)], 0.011), MaterialKind::Missed);
        assert_eq!(kind(&[(0.03, false), (0.01, true)], 0.0), MaterialKind::Dyed);
        assert_eq!(kind(&[(0.03, false), (0.03, true)], f64::NAN), MaterialKind::Steep);
        let free = MaterialKind::of([(0.2, true)], 0.0, &FitRecord::default());
        assert_eq!(free, MaterialKind::Dyed);
    }

    #[test]
    fn kinds_are_counted() {
        use MaterialKind::{Dyed, Missed, Reflectance, Steep};
        let mut counts: KindCounts = [Steep, Missed, Dyed, Missed].into_iter().collect();
        counts.join(&[Reflectance, Dyed].into_iter().collect());
        assert_eq!(counts.each().map(|(_, count)| count), [1, 2, 1, 2]);
    }

    #[test]
    fn the_kind_of_a_blend_is_that_of_the_mixture_that_is_looked_up() {
        let preset = Preset::Natural;
        let (model, options) = (preset.model(), preset.options());
        let contract = Contract::default();
        let cube = build_cube(&contract, &model, options, 3, &Unwatched).unwrap();
        let kinds = BlendKinds::new(&cube);
        let colorimetry = contract.on(Grid::FIT);
        let sums = ModelOnGrid::new(&model, &colorimetry);
        let mut counts = KindCounts::default();
        for rgb in (0..1000).map(|i| [i / 100, i / 10 % 10, i % 10].map(|v| f64::from(v) / 9.0)) {
            let rgb = LinearRgb(rgb);
            let mixture = cube.lookup(rgb, Interpolation::Blend).unwrap();
            let colors = [colorimetry.xyz_from_rgb(rgb), mixture.color(&sums)];
            let [target, found] = colors.map(|xyz| colorimetry.lab_from_xyz(xyz));
            let kind = MaterialKind::of_mixture(&mixture, ciede2000(target, found), cube.fit());
            assert_eq!(kinds.of(rgb), Ok(kind), "{rgb:?}");
            counts.add(kind);
        }
        assert!(counts.each().iter().all(|(_, count)| *count > 0), "{counts:?}");
        for (index, node) in cube.nodes().iter().enumerate() {
            let kind = MaterialKind::of_node(node, &cube);
            assert_eq!(kinds.of(cube.node_rgb(index)), Ok(kind), "{index}");
        }
        assert!(kinds.of(LinearRgb([0.5, 1.1, 0.5])).is_err());
    }
}
