//! At which wavelengths a light is summed, and how much of it each stands for.

use crate::donaldson_matrix::bands_nm;
use crate::grid::Grid;
use crate::illuminant::Illuminant;
use crate::observer::Observer;

/// A light as a sum over bands, and how an observer sees it.
///
/// A smooth light is sampled at the wavelengths of a grid. A light with structure between them, such
/// as the lines of a mercury lamp, is integrated: as many wavelengths are placed where the light needs
/// them, and each of its 1 nm samples is divided between the two around it, the nearer one getting
/// more. That is exact for materials that are linear between these wavelengths.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LightBands {
    pub(crate) wavelengths_nm: Vec<f64>,
    /// Relative power of each band, `[wavelength]`.
    pub(crate) power: Vec<f64>,
    /// Mean x̄, ȳ, z̄ of the light of each band, `[wavelength][x̄ ȳ z̄]`.
    pub(crate) seen: Vec<[f64; 3]>,
    pub(crate) summation: Summation,
}

/// How the power of a band is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Summation {
    /// At the band's wavelength.
    Sampled,
    /// From all 1 nm samples in the band.
    Integrated,
}

/// A light is smooth on a grid of 5 nm if sampling moves at most this share of its power, and of its X,
/// Y and Z, from band to band; no material's X, Y or Z is then off by more. Daylights, A and E move
/// 0.7 % at most, a line of 5 nm moves half of its power. With a larger limit, faint lines are sampled;
/// with a smaller one, daylights have other sums than in the literature. On other grids the limit is as
/// the square of the step, because that is how much a smooth light moves.
const MOVED_LIMIT: f64 = 0.01;

/// Wavelengths of integration are at most this many steps of the grid apart. With more, materials are
/// hardly sampled where the light is faint; with fewer, less are left for lines.
const WIDEST_STEPS: usize = 4;

/// All observers see nothing below this wavelength, nm. The number of wavelengths on either side is
/// that of the grid: the sums of fits have room for no more.
const FIRST_VISIBLE_NM: u32 = 360;

/// The power of a 1 nm sample, and its X, Y, Z.
type Amounts = [f64; 4];

impl LightBands {
    pub(crate) fn new(light: &Illuminant, observer: &Observer, grid: Grid) -> Self {
        let sampled = Self {
            wavelengths_nm: grid.wavelengths_nm().collect(),
            power: grid.wavelengths_nm().map(|nm| light.power().at(nm)).collect(),
            seen: observer.on(grid),
            summation: Summation::Sampled,
        };
        if grid.step_nm() == Grid::FINE.step_nm() {
            return sampled;
        }
        let fine = fine_amounts(light, observer, grid);
        if sampled.moves_little(&fine, grid) {
            sampled
        } else {
            Self::integrated(&fine, observer, grid)
        }
    }

    /// Power of each band of a grid, in units of the light's 1 nm samples.
    pub(crate) fn power_on(light: &Illuminant, observer: &Observer, grid: Grid) -> Vec<f64> {
        let bands = Self::new(light, observer, grid);
        if bands.summation == Summation::Sampled {
            return bands.power;
        }
        let sums = divided(&fine_amounts(light, observer, grid), &regular(grid));
        sums.iter().map(|[power, ..]| power / f64::from(grid.step_nm())).collect()
    }

    /// Power in the band around each of at least two ascending wavelengths, nm, in units of the light's
    /// 1 nm samples. On a grid it is that of [`LightBands::power_on`], times the step. Elsewhere each
    /// nanometer of the light is divided between the two wavelengths around it, or, where these lie nearer
    /// than that, the light is sampled.
    pub(crate) fn power_around(light: &Illuminant, observer: &Observer, axis: &[f64]) -> Vec<f64> {
        if let Some(grid) = Grid::of(axis) {
            let step_nm = f64::from(grid.step_nm());
            return Self::power_on(light, observer, grid).iter().map(|p| p * step_nm).collect();
        }
        if axis.windows(2).any(|pair| pair[1] - pair[0] < f64::from(Grid::FINE.step_nm())) {
            let bands = bands_nm(axis);
            return axis.iter().zip(bands).map(|(nm, band)| light.power().at(*nm) * band).collect();
        }
        let mut sums = vec![0.0; axis.len()];
        for (nm, power) in light.power().grid().wavelengths_nm().zip(light.power().values()) {
            let above = axis.partition_point(|at| *at < nm);
            if above == axis.len() || above == 0 && axis[0] > nm {
                continue;
            }
            let below = above.saturating_sub(1);
            let width = axis[above] - axis[below];
            let share = if width > 0.0 { (nm - axis[below]) / width } else { 1.0 };
            sums[below] += power * (1.0 - share);
            sums[above] += power * share;
        }
        sums
    }

    fn integrated(fine: &[Amounts], observer: &Observer, grid: Grid) -> Self {
        let places = placed(fine, grid);
        let nm: Vec<f64> =
            places.iter().map(|&at| f64::from(grid.first_nm()) + at as f64).collect();
        let sums = divided(fine, &places);
        let seen = |(&[power, x, y, z], &nm): (&Amounts, &f64)| match power > 0.0 {
            true => [x, y, z].map(|v| v / power),
            false => observer.matching().each_ref().map(|curve| curve.at(nm)),
        };
        Self {
            power: sums.iter().map(|[power, ..]| *power).collect(),
            seen: sums.iter().zip(&nm).map(seen).collect(),
            wavelengths_nm: nm,
            summation: Summation::Integrated,
        }
    }

    /// Whether sampling moves little of the light from band to band.
    fn moves_little(&self, fine: &[Amounts], grid: Grid) -> bool {
        let (mut moved, mut all) = ([0.0; 4], [0.0; 4]);
        for (band, there) in divided(fine, &regular(grid)).into_iter().enumerate() {
            let step_nm = f64::from(grid.step_nm()) * share_inside(grid, band);
            let [x, y, z] = self.seen[band];
            for (k, seen) in [1.0, x, y, z].into_iter().enumerate() {
                moved[k] += (self.power[band] * seen * step_nm - there[k]).abs();
                all[k] += there[k];
            }
        }
        let steps = f64::from(grid.step_nm()) / f64::from(Grid::FIT.step_nm());
        let limit = MOVED_LIMIT * steps * steps;
        moved.iter().zip(all).all(|(moved, all)| *moved <= limit * all)
    }
}

/// The sum of the power of a light's bands. Where one of two lights was sampled and the `other`
/// integrated, both are counted to the ends of the grid; else as sums of colors count them.
pub(crate) fn total(grid: Grid, power: &[f64], own: Summation, other: Summation) -> f64 {
    let is_cut = own == Summation::Sampled && other == Summation::Integrated;
    let share = |band| if is_cut { share_inside(grid, band) } else { 1.0 };
    power.iter().enumerate().map(|(band, p)| p * share(band)).sum()
}

/// How much of a sampled band lies inside the grid. One at an end stands for a whole step, of which half
/// lies outside, but for half a nanometer that sums over 1 nm count as well.
fn share_inside(grid: Grid, band: usize) -> f64 {
    let is_end = band == 0 || band + 1 == grid.len();
    if is_end { (1.0 + 1.0 / f64::from(grid.step_nm())) / 2.0 } else { 1.0 }
}

/// The light at each nanometer of a grid's range.
fn fine_amounts(light: &Illuminant, observer: &Observer, grid: Grid) -> Vec<Amounts> {
    let at = |nm: u32| {
        let (nm, power) = (f64::from(nm), light.power().at(f64::from(nm)));
        let [x, y, z] = observer.matching().each_ref().map(|curve| curve.at(nm));
        [1.0, x, y, z].map(|seen| power * seen)
    };
    (grid.first_nm()..=grid.last_nm()).map(at).collect()
}

/// The grid's own wavelengths, as indices of `fine`.
fn regular(grid: Grid) -> Vec<usize> {
    (0..=(grid.last_nm() - grid.first_nm()) as usize).step_by(grid.step_nm() as usize).collect()
}

/// The amounts at each nanometer, divided between the places around it.
fn divided(fine: &[Amounts], places: &[usize]) -> Vec<Amounts> {
    let mut sums = vec![[0.0; 4]; places.len()];
    sums[0] = fine[places[0]];
    for (band, ends) in places.windows(2).enumerate() {
        let width = (ends[1] - ends[0]) as f64;
        for at in ends[0] + 1..=ends[1] {
            let above = (at - ends[0]) as f64 / width;
            for k in 0..4 {
                sums[band][k] += fine[at][k] * (1.0 - above);
                sums[band + 1][k] += fine[at][k] * above;
            }
        }
    }
    sums
}

/// As many places as the grid has wavelengths, where they make the error of [`divided`] small: the
/// ends of the grid, 360 nm, and the best between them.
fn placed(fine: &[Amounts], grid: Grid) -> Vec<usize> {
    let all = fine.iter().fold([0.0; 4], |all, amounts| [0, 1, 2, 3].map(|k| all[k] + amounts[k]));
    let importance = |amounts: &Amounts| {
        (0..4).map(|k| if all[k] > 0.0 { amounts[k] / all[k] } else { 0.0 }).sum()
    };
    let importance: Vec<f64> = fine.iter().map(importance).collect();
    let own = regular(grid);
    let visible = |at: &usize| grid.first_nm() as usize + at >= FIRST_VISIBLE_NM as usize;
    let first_visible = own.iter().position(visible).unwrap_or(0);
    let widest = WIDEST_STEPS * grid.step_nm() as usize;
    let mut places = vec![0];
    for range in [&own[..=first_visible], &own[first_visible..]] {
        if let [start, .., end] = *range {
            let found = best_places(&importance[start..=end], range.len() - 1, widest);
            places.extend(found.into_iter().skip(1).map(|at| start + at));
        }
    }
    places
}

/// The first place, the last, and those between them that make `count` intervals no wider than
/// `widest` with the least error.
///
/// Between places a and b, a material's curve differs from the straight line by up to half of its second
/// derivative times (λ − a)·(b − λ): the error to expect is the sum of that over the light. The best
/// places for each number of intervals follow from those for one interval less.
fn best_places(importance: &[f64], count: usize, widest: usize) -> Vec<usize> {
    let error = |a: usize, b: usize| -> f64 {
        (a + 1..b).map(|at| importance[at] * ((at - a) * (b - at)) as f64).sum()
    };
    let errors: Vec<Vec<f64>> = (0..importance.len())
        .map(|b| (b.saturating_sub(widest)..b).map(|a| error(a, b)).collect())
        .collect();
    let mut least = vec![f64::INFINITY; importance.len()];
    least[0] = 0.0;
    let mut predecessors = Vec::with_capacity(count);
    for _ in 0..count {
        let mut next = vec![f64::INFINITY; importance.len()];
        let mut before = vec![0; importance.len()];
        for b in 1..importance.len() {
            for (a, error) in (b.saturating_sub(widest)..b).zip(&errors[b]) {
                if least[a] + error < next[b] {
                    (next[b], before[b]) = (least[a] + error, a);
                }
            }
        }
        least = next;
        predecessors.push(before);
    }
    let mut places = vec![importance.len() - 1];
    for before in predecessors.iter().rev() {
        let at = places[places.len() - 1];
        places.push(before[at]);
    }
    places.reverse();
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bands(light: &Illuminant, grid: Grid) -> LightBands {
        LightBands::new(light, &Observer::default(), grid)
    }

    #[test]
    fn daylight_and_incandescent_light_are_smooth() {
        const LIGHTS: [&str; 6] = ["D65", "D60", "D55", "D50", "A", "E"];
        // The third is that of measured re-radiation matrices.
        let grids =
            [Grid::FIT, Grid::try_new(300, 830, 10).unwrap(), Grid::try_new(300, 780, 10).unwrap()];
        for (name, grid) in LIGHTS.into_iter().flat_map(|name| grids.map(|g| (name, g))) {
            let light = Illuminant::named(name).unwrap();
            assert_eq!(bands(&light, grid).summation, Summation::Sampled, "{name} {grid:?}");
        }
        // Daylight behind a filter, which ends at a wavelength of the grids.
        let light = Illuminant::default().cut_below("cut", 400.0).unwrap();
        assert_eq!(bands(&light, grids[2]).summation, Summation::Sampled);
    }

    #[test]
    fn a_line_has_the_same_power_and_color_on_all_grids() {
        // Rounding only.
        const ROUNDING: f64 = 1e-12;
        let coarse = Grid::try_new(300, 830, 10).unwrap();
        for peak_nm in [365.0, 546.1, 577.5, 827.0] {
            let line = Illuminant::line("line", peak_nm, 1.5).unwrap();
            let amounts = |grid: Grid| {
                let bands = bands(&line, grid);
                let mut sums = [0.0; 4];
                for (power, [x, y, z]) in bands.power.iter().zip(bands.seen) {
                    [1.0, x, y, z].iter().zip(&mut sums).for_each(|(v, sum)| *sum += v * power);
                }
                sums
            };
            let fine = amounts(Grid::FINE);
            for found in [Grid::FIT, coarse].map(amounts) {
                for k in 0..4 {
                    let error = (found[k] - fine[k]).abs();
                    assert!(error <= ROUNDING * fine[0], "{peak_nm} {found:?} {fine:?}");
                }
            }
        }
    }

    #[test]
    fn wavelengths_ascend_to_the_ends_of_the_grid_and_are_dense_at_lines() {
        for [first_nm, last_nm, step_nm] in [[300, 830, 5], [310, 700, 10], [400, 800, 20]] {
            let grid = Grid::try_new(first_nm, last_nm, step_nm).unwrap();
            let nm = bands(&Illuminant::line("line", 546.1, 1.5).unwrap(), grid).wavelengths_nm;
            assert_eq!(nm.len(), grid.len());
            assert_eq!([nm[0], nm[nm.len() - 1]], [first_nm, last_nm].map(f64::from));
            let widest = f64::from(step_nm) * WIDEST_STEPS as f64;
            assert!(nm.windows(2).all(|pair| pair[0] < pair[1] && pair[1] - pair[0] <= widest));
            assert!([545.0, 546.0, 547.0].iter().all(|at| nm.contains(at)), "{nm:?}");
        }
    }

    #[test]
    fn fits_have_room_for_the_visible_wavelengths() {
        let visible = |light: &Illuminant| {
            let nm = bands(light, Grid::FIT).wavelengths_nm;
            nm.into_iter().filter(|nm| *nm >= f64::from(FIRST_VISIBLE_NM)).count()
        };
        for peak_nm in [365.0, 546.1] {
            let line = Illuminant::line("line", peak_nm, 1.5).unwrap();
            assert_eq!(visible(&line), visible(&Illuminant::default()));
        }
    }
}
