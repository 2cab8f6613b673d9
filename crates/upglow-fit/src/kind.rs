//! Kinds of material, as reports count them.

use upglow::{Cube, FitRecord, Mixture, Node};
use upglow_color::choices;

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

impl MaterialKind {
    /// The kind of a stored material of `cube`. One whose difference is NaN was not measured, and is not
    /// counted as missed.
    pub fn of_node(node: &Node, cube: &Cube) -> Self {
        let glows = node.material(cube.model()).fluorescence.dose() > 0.0;
        Self::of([(node.edge().slope_per_nm.abs(), glows)], node.de2000.into(), cube.fit())
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
        let kind_of_part = |(slope_per_nm, glows): (f64, bool)| {
            let limit = if glows { fit.slope_under_dyes_per_nm } else { fit.slope_max_per_nm };
            match limit {
                Some(limit) if slope_per_nm > limit => Self::Steep,
                _ if glows => Self::Dyed,
                _ => Self::Reflectance,
            }
        };
        let kinds = parts.into_iter().map(kind_of_part);
        kinds.max_by_key(|kind| *kind as u8).unwrap_or(Self::Reflectance)
    }
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
        let counts: KindCounts = [Steep, Missed, Dyed, Missed, Reflectance].into_iter().collect();
        assert_eq!(counts.each().map(|(_, count)| count), [1, 1, 1, 2]);
    }
}
