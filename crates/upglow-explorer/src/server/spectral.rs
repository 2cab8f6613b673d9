//! Spectra of files: between their bands, as colors, and as curves.

use serde::Serialize;
use tempfile::TempPath;
use upglow_color::rounding::to_single;
use upglow_color::{BispectralUnit, Choice as _, Colorimetry, Grid, Observer, Xyz};
use upglow_image::{Excerpt, FormError, SpectralPicture, SpectralTexel};

use super::answer::Refusal;
use crate::sampled::Sampled;

/// Texels of a preview along a side.
const PREVIEW_SIDE: usize = 256;

/// A dropped file of spectra.
#[derive(Debug)]
pub(super) struct SpectralDrop {
    file: TempPath,
    name: String,
    size: [usize; 2],
    layout: Layout,
}

/// What the page is told of a dropped file of spectra.
#[derive(Debug, Serialize)]
pub(super) struct ToldSpectra {
    pub(super) id: u32,
    width: usize,
    height: usize,
    /// Of the texels of the preview.
    step: usize,
    columns: usize,
    rows: usize,
    kind: &'static str,
    wavelengths_nm: Vec<f64>,
    unit: Option<&'static str>,
    /// What is not shown as it is stored.
    notes: Vec<String>,
}

/// A texel as curves.
#[derive(Debug, Serialize)]
pub(super) struct Pixel {
    #[serde(flatten)]
    sampled: Sampled,
    x: usize,
    y: usize,
    notes: Vec<String>,
}

/// Between which wavelengths the values of a file are, and what they mean.
#[derive(Clone, Debug)]
struct Layout {
    reflectance: Bands,
    /// Incident and outgoing; `None` without re-radiation, or if its unit is unknown.
    moved: Option<[Bands; 2]>,
    unit: Option<BispectralUnit>,
    notes: Vec<String>,
}

/// Ascending wavelengths, between which values are interpolated linearly.
#[derive(Clone, Debug, PartialEq)]
struct Bands(Vec<f64>);

impl Bands {
    fn new(wavelengths_nm: impl Iterator<Item = f64>) -> Self {
        let mut nm: Vec<f64> = wavelengths_nm.collect();
        nm.sort_by(f64::total_cmp);
        nm.dedup();
        Self(nm)
    }

    fn range_nm(&self) -> Option<[f64; 2]> {
        Some([*self.0.first()?, *self.0.last()?])
    }

    /// The share of each band at a wavelength; that of the first or last beyond them.
    fn shares(&self, nm: f64) -> [(usize, f64); 2] {
        let above = self.0.partition_point(|band| *band < nm);
        let (left, right) = (above.saturating_sub(1), above.min(self.0.len().saturating_sub(1)));
        let [from, to] = [self.0[left], self.0[right]];
        let share = if to > from { ((nm - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        [(left, 1.0 - share), (right, share)]
    }

    /// The same, but nothing beyond half a band outside.
    fn shares_inside(&self, nm: f64) -> [(usize, f64); 2] {
        let last = self.0.len() - 1;
        let is_inside = nm >= self.0[0] - 0.5 * self.width_nm(0)
            && nm <= self.0[last] + 0.5 * self.width_nm(last);
        if is_inside { self.shares(nm) } else { [(0, 0.0); 2] }
    }

    /// The width of a band, which reaches half way to its neighbors.
    fn width_nm(&self, band: usize) -> f64 {
        let nm = &self.0;
        match (band.checked_sub(1), nm.get(band + 1)) {
            (Some(before), Some(after)) => 0.5 * (after - nm[before]),
            (Some(before), None) => nm[band] - nm[before],
            (None, Some(after)) => after - nm[band],
            (None, None) => 1.0,
        }
    }

    fn index(&self, nm: f64) -> Option<usize> {
        self.0.iter().position(|band| *band == nm)
    }

    /// What each band is worth in a sum over wavelengths.
    fn worth<const N: usize>(
        &self,
        terms: impl Iterator<Item = (f64, [f64; N])>,
        shares: impl Fn(f64) -> [(usize, f64); 2],
    ) -> Vec<[f64; N]> {
        let mut worth = vec![[0.0; N]; self.0.len()];
        for (nm, term) in terms {
            for (band, share) in shares(nm) {
                worth[band].iter_mut().zip(term).for_each(|(sum, term)| *sum += share * term);
            }
        }
        worth
    }
}

impl Layout {
    /// The layout of a file, from one of its texels; `unit` holds where the file states none.
    fn of(texel: &SpectralTexel, unit: Option<BispectralUnit>) -> Result<Self, Refusal> {
        let reflectance = Bands::new(texel.reflectance.iter().map(|(nm, _)| *nm));
        let Some([first, last]) = reflectance.range_nm() else {
            let error = "spectra of light, expected those of materials, in channels T.";
            return Err(Refusal::unusable(error));
        };
        let mut notes = Vec::new();
        let [low, high] = [Grid::FINE.first_nm(), Grid::FINE.last_nm()].map(f64::from);
        if first > low || last < high {
            notes.push(format!(
                "The file has {first} to {last} nm; beyond, the reflectance is that at its ends, and \
                 nothing is re-emitted."
            ));
        }
        let unit = texel.reradiation_unit.or(unit);
        let has_pairs = !texel.reradiation.is_empty();
        if has_pairs && unit.is_none() {
            notes.push("Its re-radiation is not shown: the file does not state the unit.".into());
        }
        let moved = (has_pairs && unit.is_some()).then(|| {
            let pairs = || texel.reradiation.iter();
            [Bands::new(pairs().map(|(nm, ..)| *nm)), Bands::new(pairs().map(|(_, nm, _)| *nm))]
        });
        Ok(Self { reflectance, moved, unit, notes })
    }

    /// The factor from a stored value to 1/nm.
    fn per_nm(&self, outgoing: &Bands, band: usize) -> f64 {
        match self.unit {
            Some(BispectralUnit::PerNm) => 1.0,
            _ => 1.0 / outgoing.width_nm(band),
        }
    }

    /// Re-radiation in 1/nm, `[incident][outgoing]`.
    fn matrix(&self, texel: &SpectralTexel) -> Option<Vec<Vec<f64>>> {
        let [incident, outgoing] = self.moved.as_ref()?;
        let mut matrix = vec![vec![0.0; outgoing.0.len()]; incident.0.len()];
        for &(in_nm, out_nm, value) in &texel.reradiation {
            if let (Some(i), Some(o)) = (incident.index(in_nm), outgoing.index(out_nm)) {
                matrix[i][o] = finite(value) * self.per_nm(outgoing, o);
            }
        }
        Some(matrix)
    }

    fn sampled(&self, texel: &SpectralTexel, observer: &Observer, label: &str) -> Sampled {
        let values: Vec<f64> = texel.reflectance.iter().map(|(_, v)| finite(*v)).collect();
        let at = |nm: f64| -> f64 {
            self.reflectance.shares(nm).iter().map(|(band, share)| share * values[*band]).sum()
        };
        let matrix = self.matrix(texel).filter(|rows| rows.iter().flatten().any(|v| *v != 0.0));
        let moved = self.moved.as_ref().zip(matrix).map(|([incident, outgoing], matrix)| {
            move |in_nm: f64, out_nm: f64| -> f64 {
                let mut sum = 0.0;
                for (i, from) in incident.shares_inside(in_nm) {
                    for (o, to) in outgoing.shares_inside(out_nm) {
                        sum += from * to * matrix[i][o];
                    }
                }
                sum
            }
        });
        Sampled::of_curves(at, moved, observer, label)
    }
}

/// Invalid numbers count as 0.
fn finite(value: f32) -> f64 {
    if value.is_finite() { value.into() } else { 0.0 }
}

/// What makes the color of a texel: a sum over the values that a file stores.
struct Weights {
    reflectance: Vec<[f64; 3]>,
    /// Of each pair of bands that is stored.
    moved: Vec<[f64; 3]>,
}

impl Weights {
    fn new(layout: &Layout, texel: &SpectralTexel, colorimetry: &Colorimetry) -> Self {
        let lit = || colorimetry.wavelengths_nm().iter().copied();
        let reflectance = &layout.reflectance;
        let own = lit().zip(colorimetry.weights().iter().copied());
        let reflectance = reflectance.worth(own, |nm| reflectance.shares(nm));
        let moved = layout.moved.as_ref().map_or_else(Vec::new, |[incident, outgoing]| {
            let light = lit().zip(colorimetry.irradiance().iter().map(|power| [*power]));
            let light = incident.worth(light, |nm| incident.shares_inside(nm));
            let step_nm = f64::from(Grid::FIT.step_nm());
            let seen = colorimetry.matching().iter().map(|xyz| xyz.map(|v| step_nm * v));
            let seen = Grid::FIT.wavelengths_nm().zip(seen);
            let seen = outgoing.worth(seen, |nm| outgoing.shares_inside(nm));
            let of_pair = |&(in_nm, out_nm, _): &(f64, f64, f32)| match (
                incident.index(in_nm),
                outgoing.index(out_nm),
            ) {
                (Some(i), Some(o)) => {
                    let factor = light[i][0] * layout.per_nm(outgoing, o);
                    seen[o].map(|xyz| xyz * factor)
                }
                _ => [0.0; 3],
            };
            texel.reradiation.iter().map(of_pair).collect()
        });
        Self { reflectance, moved }
    }

    fn color(&self, texel: &SpectralTexel) -> Xyz {
        let mut xyz = [0.0; 3];
        let reflected = texel.reflectance.iter().map(|(_, v)| *v).zip(&self.reflectance);
        let moved = texel.reradiation.iter().map(|(.., v)| *v).zip(&self.moved);
        for (value, weight) in reflected.chain(moved) {
            xyz.iter_mut().zip(weight).for_each(|(sum, w)| *sum += finite(value) * w);
        }
        Xyz(xyz)
    }
}

impl SpectralDrop {
    /// Reads a dropped file: what the page is told of it, and its colors under a light.
    pub(super) fn read(
        id: u32,
        file: TempPath,
        name: &str,
        unit: Option<BispectralUnit>,
        colorimetry: &Colorimetry,
    ) -> Result<(Self, ToldSpectra, Vec<[f32; 3]>), Refusal> {
        let failed = |error: FormError| Refusal::unusable(format!("{name}: {error}"));
        let mut picture = SpectralPicture::open(&file).map_err(failed)?;
        let size @ [width, height] = picture.size();
        super::check_size(name, size)?;
        let step = Excerpt::step(size, PREVIEW_SIDE);
        let mut rgb = Vec::new();
        let mut prepared = None;
        for y in (0..height).step_by(step) {
            let row = picture.row(y, step).map_err(failed)?;
            let (_, weights) = match &prepared {
                Some(prepared) => prepared,
                None => {
                    let layout = Layout::of(&row[0], unit).map_err(|refusal| Refusal {
                        error: format!("{name}: {}", refusal.error),
                        ..refusal
                    })?;
                    let weights = Weights::new(&layout, &row[0], colorimetry);
                    prepared.insert((layout, weights))
                }
            };
            rgb.extend(
                row.iter()
                    .map(|texel| colorimetry.rgb_from_xyz(weights.color(texel)).0.map(to_single)),
            );
        }
        let Some((layout, _)) = prepared else {
            return Err(Refusal::unusable(format!("{name}: no texel")));
        };
        let told = ToldSpectra {
            id,
            width,
            height,
            step,
            columns: width.div_ceil(step),
            rows: height.div_ceil(step),
            kind: if layout.moved.is_some() { "bispectral" } else { "reflectance" },
            wavelengths_nm: layout.reflectance.0.clone(),
            unit: layout.unit.map(BispectralUnit::name),
            notes: layout.notes.clone(),
        };
        Ok((Self { file, name: name.into(), size, layout }, told, rgb))
    }

    /// One texel as curves.
    pub(super) fn pixel(&self, [x, y]: [usize; 2], observer: &Observer) -> Result<Pixel, Refusal> {
        let name = &self.name;
        let [width, height] = self.size;
        if x >= width || y >= height {
            let error = format!("{name}: texel {x},{y}, expected one of {width} × {height}");
            return Err(Refusal::bad(error));
        }
        let read = SpectralPicture::open(&self.file).and_then(|mut picture| picture.at(x, y));
        let texel = read.map_err(|error| Refusal::unusable(format!("{name}: {error}")))?;
        let sampled = self.layout.sampled(&texel, observer, &format!("{name} at {x},{y}"));
        Ok(Pixel { sampled, x, y, notes: self.layout.notes.clone() })
    }
}
