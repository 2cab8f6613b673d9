//! Cubes that earlier versions of the program wrote; `data/README.md` says how.

use upglow::{Cube, FitRecord, Fluorescence, Model};

const VERSION_1: &[u8] = include_bytes!("data/version1_dyes.safetensors");
const VERSION_2: &[u8] = include_bytes!("data/version2_analytic.safetensors");

/// Magenta: blue 1, green 0, red 1.
const MAGENTA: usize = 5;

#[test]
fn a_cube_of_version_1_has_the_numbers_that_its_program_printed() {
    let cube = Cube::from_bytes(VERSION_1).unwrap();
    let fit = FitRecord {
        preset: None,
        metric: "de2000".into(),
        slope_max_per_nm: Some(0.02),
        slope_under_dyes_per_nm: Some(0.02),
        relaxed: false,
        sweeps: 2,
        method: "search".into(),
        evaluations: 517,
    };
    assert_eq!(cube.fit(), &fit);
    let Model::Dyes(model) = cube.model() else { panic!("{:?}", cube.model()) };
    let yields: Vec<_> = model.curves().iter().map(|dye| dye.quantum_yield).collect();
    assert_eq!(yields, [1.0, 0.8]);
    let node = cube.nodes()[MAGENTA];
    assert_eq!((node.dyes, node.fluorescence), ([0, 0], [1.0, 0.452_294_02, 0.0]));
    assert_eq!(node.de2000, 9.209_492);
}

#[test]
fn a_cube_of_version_2_has_the_numbers_that_its_program_printed() {
    let cube = Cube::from_bytes(VERSION_2).unwrap();
    assert_eq!(cube.contract().observer.name(), "three_bells");
    let fit = cube.fit();
    assert_eq!((fit.slope_max_per_nm, fit.slope_under_dyes_per_nm), (None, None));
    assert_eq!((fit.relaxed, fit.evaluations), (false, 3588));
    let bells = Fluorescence::Analytic {
        emission_peak_nm: f64::from(636.548_03_f32),
        stokes_shift_nm: f64::from(83.271_23_f32),
        concentration: 1.0,
    };
    assert_eq!(cube.node_material(MAGENTA).fluorescence, bells);
}

#[test]
fn they_are_written_in_the_present_version_and_stay_the_same_cubes() {
    for bytes in [VERSION_1, VERSION_2] {
        let cube = Cube::from_bytes(bytes).unwrap();
        assert!(cube.header_json().contains("\"format_version\":3,"));
        assert_eq!(Cube::from_bytes(&cube.to_bytes()).unwrap(), cube);
    }
}
