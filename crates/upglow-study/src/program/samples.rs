//! Measured surfaces: sets of samples whose colors under any light are known.

use upglow_color::{
    Adaptation, BispectralUnit, Contract, ContractError, DonaldsonMatrix, Grid, Illuminant, Lab,
    MatrixSums, Xyz,
};

/// A measured surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sample {
    /// The column of its table, or the name of its file without the suffix.
    pub(crate) name: String,
    matrix: DonaldsonMatrix,
}

/// What is promised of every sample.
const IS_SEEN: &str = "D65 reaches the matrix";

impl Sample {
    /// A surface from what of each band of light leaves in each band.
    ///
    /// # Errors
    ///
    /// [`ContractError`] if nothing of D65 is seen on the axes of the matrix.
    pub(crate) fn try_new(name: String, matrix: DonaldsonMatrix) -> Result<Self, ContractError> {
        matrix.seen_under(&Contract::default(), &Illuminant::default())?;
        Ok(Self { name, matrix })
    }

    /// What of each band of light leaves in each band.
    pub(crate) fn matrix(&self) -> &DonaldsonMatrix {
        &self.matrix
    }

    /// The color under a light, for an observer who sees this `white`. Sums over other wavelengths than
    /// those of the sample have slightly other whites; in each a gray is a gray.
    pub(crate) fn color(&self, light: &Illuminant, white: Xyz) -> Xyz {
        let sums = self.sums(light);
        let adapted = Adaptation::Bradford.target_from_source(sums.white(), white);
        Xyz(adapted * sums.color(&self.matrix).0)
    }

    /// The sums under a light for an observer who is adapted to it, or to D65 if it is too dark for that.
    pub(crate) fn sums(&self, light: &Illuminant) -> MatrixSums {
        self.matrix.seen_under(&Contract::default(), light).expect(IS_SEEN)
    }
}

/// Samples of one kind.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SampleSet {
    /// What reports call it.
    pub(crate) name: &'static str,
    pub(crate) samples: Vec<Sample>,
}

impl SampleSet {
    /// The 99 object colors of CIE 224:2017.
    pub(crate) fn object_colors() -> Self {
        Self::of_reflectances("99 object colors", include_str!("../../data/ces.csv"))
    }

    /// The paints of the `ColorChecker` chart as ISO 17321-1 has them.
    pub(crate) fn paints() -> Self {
        Self::of_reflectances("24 paints", include_str!("../../data/color_checker.csv"))
    }

    /// Measured fluorescent materials.
    pub(crate) fn fluorescent(measured: &[Sample]) -> Self {
        Self { name: "fluorescent materials", samples: measured.to_vec() }
    }

    /// Surfaces of which no light leaves at another wavelength. Light arrives from 300 nm on, as for measured
    /// fluorescent materials, so that a dye in their place shows.
    fn of_reflectances(name: &'static str, text: &str) -> Self {
        let (names, rows) = table(text);
        let nm: Vec<f64> = rows.iter().map(|row| row[0]).collect();
        let dark_nm = (60..76).map(|fives| f64::from(5 * fives));
        let incident_nm: Vec<f64> = dark_nm.chain(nm.iter().copied()).collect();
        let dark = incident_nm.len() - nm.len();
        let sample = |column: usize| {
            let row = |o: usize| {
                let mut row = vec![0.0; incident_nm.len()];
                row[dark + o] = rows[o][column];
                row
            };
            let values = (0..rows.len()).map(row).collect();
            let (incident_nm, unit) = (incident_nm.clone(), BispectralUnit::PerBand);
            let matrix = DonaldsonMatrix::try_new(incident_nm, nm.clone(), values, unit)
                .expect("the table holds reflectances from 380 to 780 nm");
            Sample::try_new(names[column].into(), matrix).expect(IS_SEEN)
        };
        Self { name, samples: (1..names.len()).map(sample).collect() }
    }
}

/// Colors of the border of Pointer's gamut, the most saturated surfaces ever measured, under the light of
/// `contract`: adapted from illuminant C after Bradford.
pub(crate) fn pointers_border(contract: &Contract) -> Vec<Xyz> {
    /// Illuminant C, `cie015`, table T.3.
    const C: Xyz = Xyz([0.980_74, 1.0, 1.182_32]);
    let white = contract.on(Grid::FIT).white();
    let adapted = Adaptation::Bradford.target_from_source(C, white);
    let (_, rows) = table(include_str!("../../data/pointer_gamut.csv"));
    let lab = rows.into_iter().map(|row| {
        let (sin, cos) = row[2].to_radians().sin_cos();
        Lab { l: row[0], a: row[1] * cos, b: row[1] * sin }
    });
    lab.map(|lab| Xyz(adapted * upglow_color::xyz_from_lab(lab, C).0)).collect()
}

/// A table that is part of the program: the names of its columns, and the numbers of its rows.
fn table(text: &str) -> (Vec<&str>, Vec<Vec<f64>>) {
    let mut lines = text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(','));
    let names = lines.next().into_iter().flatten().collect();
    let number = |cell: &str| cell.parse().expect("the table holds numbers");
    (names, lines.map(|cells| cells.map(number).collect()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_have_as_many_samples_as_their_names_say() {
        let count = |set: SampleSet| set.samples.len();
        assert_eq!(count(SampleSet::object_colors()), 99);
        assert_eq!(count(SampleSet::paints()), 24);
        assert_eq!(pointers_border(&Contract::default()).len(), 576);
    }

    #[test]
    fn reflectances_are_shares() {
        for set in [SampleSet::object_colors(), SampleSet::paints()] {
            for Sample { name, matrix } in &set.samples {
                for (o, row) in matrix.factors().iter().enumerate() {
                    assert!((0.0..=1.0).contains(&row[16 + o]), "{name} {o}");
                    assert!((row.iter().sum::<f64>() - row[16 + o]).abs() <= 0.0, "{name} {o}");
                }
                assert_eq!(matrix.diagonal_bands().count(), 81);
            }
        }
    }

    #[test]
    fn the_white_paint_has_the_published_color() {
        // ISO 17321-1's figures under D50 after the maker: L* 96.5, a* -0.4, b* 1.2; charts differ by 1.
        let light = Illuminant::named("D50").unwrap();
        let white = Xyz([0.964_21, 1.0, 0.825_19]);
        let color = SampleSet::paints().samples[18].color(&light, white);
        let Lab { l, a, b } = upglow_color::lab_from_xyz(color, white);
        assert!(
            (l - 96.5).abs() < 1.5 && (a + 0.4).abs() < 1.0 && (b - 1.2).abs() < 2.0,
            "{l} {a} {b}"
        );
    }
}
