//! The spectral locus, primaries and white of a chromaticity diagram.

use upglow_color::{Contract, Grid, Xyz};

/// The spectral locus of a contract's observer, and the contract's primaries and white.
#[derive(Clone, Debug, PartialEq)]
pub struct ChromaticityDiagram {
    /// Wavelengths in nm, in steps of 1 nm, and chromaticities (x, y) of monochromatic light.
    pub locus: Vec<(u32, [f64; 2])>,
    /// Chromaticities of red, green and blue, as the RGB space defines them.
    pub primaries: [[f64; 2]; 3],
    /// Chromaticity of the perfect diffuser under the contract's light.
    pub white: [f64; 2],
}

/// First and last wavelength of the locus, nm: beyond them its points hardly move.
const LOCUS_NM: [u32; 2] = [390, 700];

impl ChromaticityDiagram {
    /// The diagram of a contract, without the wavelengths that its observer does not see.
    pub fn of(contract: &Contract) -> Self {
        let [first, last] = LOCUS_NM;
        let grid = Grid::try_new(first, last, 1).expect("the wavelengths ascend");
        let colors = contract.observer.on(grid);
        let points = (first..).zip(colors).map(|(nm, xyz)| Some((nm, Xyz(xyz).chromaticity()?)));
        let white = contract.on(Grid::FINE).white().chromaticity();
        Self {
            locus: points.flatten().collect(),
            primaries: contract.space.primaries(),
            white: white.expect("a contract's white is bright"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_locus_has_the_published_chromaticities() {
        // `cie015`, table T.6: five printed digits.
        const PUBLISHED: [(u32, [f64; 2]); 3] =
            [(450, [0.156_64, 0.017_71]), (520, [0.074_30, 0.833_80]), (600, [0.627_04, 0.372_49])];
        let diagram = ChromaticityDiagram::of(&Contract::default());
        assert_eq!(diagram.locus.len(), 311);
        for (nm, expected) in PUBLISHED {
            let (_, found) = diagram.locus.iter().find(|(at, _)| *at == nm).unwrap();
            for k in 0..2 {
                assert!((found[k] - expected[k]).abs() < 1e-5, "{nm}: {found:?}");
            }
        }
    }
}
