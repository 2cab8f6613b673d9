//! Checks the samples of a spectral file.

use upglow_color::BispectralUnit;

use super::channels::{ListedChannel, band, bands_nm};
use super::findings::{Lint, Rule};
use crate::exr::error::ExrError;
use crate::exr::header::Sample;
use crate::exr::reader::ExrReader;
use crate::spectral::channel::{SpectralChannel, stated_unit};

/// Tolerance for sums of half-precision samples, which are rounded by 2⁻¹² each.
const HALF_SLACK: f64 = 5e-4;
/// Tolerance for sums of hundreds of single-precision samples.
const FLOAT_SLACK: f64 = 1e-5;

/// The invalid values of one kind.
#[derive(Clone, Debug, Default)]
struct Occurrences {
    count: u64,
    /// Column, row, channel and value of the first.
    first: Option<(usize, usize, String, f64)>,
    /// The largest value.
    most: f64,
}

impl Occurrences {
    fn add(&mut self, [x, y]: [usize; 2], name: &str, value: f64) {
        self.count += 1;
        self.most = self.most.max(value);
        if self.first.is_none() {
            self.first = Some((x, y, name.into(), value));
        }
    }

    fn report(&self, what: &str) -> Option<String> {
        let (x, y, name, value) = self.first.as_ref()?;
        Some(format!("{} {what}, the first {value} in {name} at {x},{y}", self.count))
    }
}

pub(super) fn check_samples(
    reader: &mut ExrReader,
    channels: &[ListedChannel],
    lint: &mut Lint,
) -> Result<(), ExrError> {
    let sums = EnergySums::new(reader, channels);
    let [mut broken, mut negative, mut bright] = std::array::from_fn(|_| Occurrences::default());
    let numbers: Vec<usize> = channels.iter().map(|found| found.number).collect();
    for [columns, rows] in reader.pieces(numbers.len()) {
        let place = Place { left: columns.start, top: rows.start, width: columns.len() };
        let planes = reader.read_region(columns, rows, &numbers)?;
        check_signs(place, channels, &planes, [&mut broken, &mut negative]);
        sums.check(place, &planes, &mut bright);
    }
    if let Some(found) = broken.report("samples that are not finite numbers") {
        lint.add(Rule::Finite, found, "finite numbers");
    }
    if let Some(found) = negative.report("negative samples") {
        lint.add(Rule::Negative, found, "0 or more");
    }
    if let Some(found) = bright.report("sums of outgoing light above 1") {
        let found = format!("{found}, the largest {}", bright.most);
        lint.add(Rule::Energy, found, "at most 1 for each incident wavelength");
    }
    Ok(())
}

/// Where some samples are in the image.
#[derive(Clone, Copy, Debug)]
struct Place {
    left: usize,
    top: usize,
    width: usize,
}

impl Place {
    /// Column and row of the pixel with this number.
    fn at(self, i: usize) -> [usize; 2] {
        [self.left + i % self.width, self.top + i / self.width]
    }
}

fn check_signs(
    place: Place,
    channels: &[ListedChannel],
    planes: &[Vec<f32>],
    [broken, negative]: [&mut Occurrences; 2],
) {
    for (found, plane) in channels.iter().zip(planes) {
        let signed = matches!(found.channel, SpectralChannel::Radiance { stokes: 1.., .. });
        for (i, &value) in plane.iter().enumerate() {
            if !value.is_finite() {
                broken.add(place.at(i), &found.name, f64::from(value));
            } else if value < 0.0 && !signed {
                negative.add(place.at(i), &found.name, f64::from(value));
            }
        }
    }
}

/// Sums of the outgoing light of each incident band.
struct EnergySums {
    /// The `T.` channel of each band.
    name: Vec<String>,
    /// For each band the planes that are added, and their weights.
    terms: Vec<Vec<(usize, f64)>>,
    /// Greatest valid sum.
    most: f64,
}

impl EnergySums {
    fn new(reader: &ExrReader, channels: &[ListedChannel]) -> Self {
        let bands = bands_nm(channels);
        let unit = stated_unit(reader.attributes());
        let mut terms = vec![Vec::new(); bands.len()];
        for (plane, found) in channels.iter().enumerate() {
            let (in_nm, weight) = match (found.channel, unit) {
                (SpectralChannel::Reflectance { nm }, _) => (nm, 1.0),
                (SpectralChannel::Reradiation { in_nm, .. }, Some(BispectralUnit::PerBand)) => {
                    (in_nm, 1.0)
                }
                (SpectralChannel::Reradiation { in_nm, out_nm }, Some(BispectralUnit::PerNm)) => {
                    (in_nm, band(&bands, out_nm).map_or(0.0, |o| band_width_nm(&bands, o)))
                }
                // Re-radiation of an unknown unit cannot be added: only the diagonal is checked.
                _ => continue,
            };
            if let Some(incident) = band(&bands, in_nm) {
                terms[incident].push((plane, weight));
            }
        }
        let half = channels.iter().any(|found| found.sample == Sample::Half);
        let name = bands.iter().map(|&nm| SpectralChannel::Reflectance { nm }.to_string());
        let most = 1.0 + if half { HALF_SLACK } else { FLOAT_SLACK };
        Self { name: name.collect(), terms, most }
    }

    fn check(&self, place: Place, planes: &[Vec<f32>], bright: &mut Occurrences) {
        for (name, terms) in self.name.iter().zip(&self.terms) {
            let pixels = terms.first().map_or(0, |(plane, _)| planes[*plane].len());
            for i in 0..pixels {
                let sum: f64 =
                    terms.iter().map(|&(plane, w)| w * f64::from(planes[plane][i])).sum();
                if sum > self.most {
                    bright.add(place.at(i), name, sum);
                }
            }
        }
    }
}

/// The mean distance to the neighboring bands; 0 for a single band.
fn band_width_nm(bands: &[f64], index: usize) -> f64 {
    let after = bands.get(index + 1).map(|next| next - bands[index]);
    let before = index.checked_sub(1).map(|i| bands[index] - bands[i]);
    let (before, after) = (before.or(after), after.or(before));
    before.zip(after).map_or(0.0, |(before, after)| (before + after) / 2.0)
}
