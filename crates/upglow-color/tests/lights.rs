//! Built-in lights and observers against the numbers of colour-science and of the standard.

use std::collections::BTreeSet;

use upglow_color::{Contract, Grid, Illuminant, Observer};

/// The cells of each row of a table after its head.
fn rows(text: &'static str) -> impl Iterator<Item = Vec<&'static str>> {
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').collect())
}

fn numbers<const N: usize>(cells: &[&str]) -> [f64; N] {
    let numbers: Vec<f64> = cells.iter().filter_map(|cell| cell.parse().ok()).collect();
    numbers.try_into().expect("each cell is a number")
}

#[test]
fn colors_under_every_light_are_those_of_colour_science() {
    // Constants of nature in five digits there, interpolation of daylight over 5 nm.
    const TOLERANCE: f64 = 1e-4;
    let mut seen = BTreeSet::new();
    for row in rows(include_str!("data/lights.csv")) {
        let illuminant = Illuminant::named(row[0]).unwrap();
        let observer = Observer::named(row[1]).unwrap();
        let contract = Contract { illuminant, observer, ..Contract::default() };
        let reflectance = |nm: f64| match row[2] {
            "white" => 1.0,
            "ramp" => (nm - 300.0) / 530.0,
            _ => 0.5 + 0.4 * (nm / 30.0).sin(),
        };
        let sums = contract.on(Grid::FINE);
        let found =
            sums.xyz_from_reflectance(sums.wavelengths_nm().iter().map(|nm| reflectance(*nm)));
        let expected: [f64; 3] = numbers(&row[3..]);
        for k in 0..3 {
            assert!((found.0[k] - expected[k]).abs() < TOLERANCE, "{row:?} {found:?}");
        }
        seen.insert(row[0]);
    }
    // Two measurement conditions are other names of lights.
    let missing: Vec<_> = Illuminant::names().into_iter().filter(|n| !seen.contains(n)).collect();
    assert_eq!(missing, ["M0", "M1"]);
}

#[test]
fn observers_are_those_of_colour_science() {
    // Nine printed digits.
    const TOLERANCE: f64 = 1e-9;
    let mut seen = BTreeSet::new();
    for row in rows(include_str!("data/observers.csv")) {
        let observer = Observer::named(row[0]).unwrap();
        let [nm, x, y, z] = numbers(&row[1..]);
        for (curve, expected) in observer.matching().iter().zip([x, y, z]) {
            assert!((curve.at(nm) - expected).abs() < TOLERANCE, "{row:?}");
        }
        seen.insert(row[0]);
    }
    assert_eq!(seen.len(), Observer::NAMES.len());
}

#[test]
fn lights_have_the_chromaticities_that_the_standard_prints() {
    // Half a unit of the fourth digit, and of those of the tables.
    const PRINTED_DIGITS: f64 = 6e-5;
    for row in rows(include_str!("data/chromaticities.csv")) {
        let light = Illuminant::named(row[0]).unwrap();
        let observer = Observer::named(row[1]).unwrap();
        // The standard sums over 5 nm for lamps.
        let [first_nm, last_nm] = light.given_nm();
        let step = if last_nm < 830 { 5 } else { 1 };
        let mut sums = [0.0; 3];
        for nm in (first_nm..=last_nm).step_by(step).map(f64::from) {
            for (sum, curve) in sums.iter_mut().zip(observer.matching()) {
                *sum += light.power().at(nm) * curve.at(nm);
            }
        }
        let all: f64 = sums.iter().sum();
        let expected: [f64; 2] = numbers(&row[2..]);
        for k in 0..2 {
            assert!((sums[k] / all - expected[k]).abs() < PRINTED_DIGITS, "{row:?} {sums:?}");
        }
    }
}

#[test]
fn the_list_of_lights_is_that_of_the_names() {
    let mut expected: BTreeSet<String> = BTreeSet::new();
    let families = Illuminant::FAMILIES.split(", ").filter(|family| !family.contains('('));
    for family in families {
        let Some((first, last)) = family.split_once(" to ") else {
            expected.insert(family.into());
            continue;
        };
        let digits = |name: &str| name.chars().rev().take_while(char::is_ascii_digit).count();
        let prefix = &first[..first.len() - digits(first)];
        let number = |name: &str| name[name.len() - digits(name)..].parse::<u32>().unwrap();
        expected.extend((number(first)..=number(last)).map(|i| format!("{prefix}{i}")));
    }
    assert_eq!(expected, Illuminant::names().into_iter().map(str::to_owned).collect());
}

#[test]
fn measurement_conditions_are_lights() {
    let named = |name| Illuminant::named(name).unwrap();
    assert_eq!(named("M0"), named("A"));
    assert_eq!(named("m1"), named("D50"));
    let (m2, d50) = (named("M2"), named("D50"));
    for nm in Grid::FINE.wavelengths_nm() {
        let expected = if nm < 420.0 { 0.0 } else { d50.power().at(nm) };
        assert_eq!(m2.power().at(nm), expected, "{nm}");
    }
    // Behind a filter nothing is missing; a lamp still ends where it ends.
    assert_eq!(m2.missing_ultraviolet(), None);
    let given_nm = |nm| named("FL4").cut_below("filtered", nm).unwrap().given_nm();
    assert_eq!((given_nm(350.0), given_nm(400.0)), ([380, 780], [300, 780]));
}

#[test]
fn a_light_may_be_behind_a_filter_for_ultraviolet() {
    let named = |name: &str| Illuminant::named(name).unwrap();
    for (name, light, nm) in [
        ("D65-cut400", "D65", 400.0),
        ("led-v1-CUT420", "LED-V1", 420.0),
        ("3000k-cut500", "3000K", 500.0),
    ] {
        let filtered = named(name);
        assert_eq!(filtered.power(), named(light).cut_below("filtered", nm).unwrap().power());
        assert_eq!(named(filtered.name()), filtered);
    }
    assert_eq!(named("d65-CUT0400").name(), "D65-cut400");
    let refused = |name| Illuminant::named(name).unwrap_err().to_string();
    for name in ["D65-cut300", "D65-cut501", "D65-cut", "D65-cut400.5", "D65-cut-400"] {
        let expected = "expected a wavelength of 320 to 500 nm behind -cut, as in D65-cut400";
        assert_eq!(refused(name), format!("{name:?}, {expected}"));
    }
    assert!(refused("D66-cut400").starts_with("unknown illuminant"));
}

#[test]
fn temperatures_out_of_range_are_refused_in_one_line() {
    let message = |name: &str| Illuminant::named(name).unwrap_err().to_string();
    assert_eq!(message("500K"), "\"500K\" is a blackbody of 500 K, expected 1000 to 100000 K");
    assert_eq!(message("d3000k"), "\"d3000k\" is daylight of 3000 K, expected 4000 to 25000 K");
    for name in
        ["K", "DK", ".K", "1.2.3K", "-3000K", "1e4K", "infK", "NaNK", "3000", "D62", "6200KD"]
    {
        assert!(message(name).starts_with("unknown illuminant"), "{name}");
    }
    assert_eq!(Illuminant::named("2856.50k").unwrap().name(), "2856.5K");
}

#[test]
fn lamps_say_where_they_are_given() {
    let said = |name: &str| {
        Illuminant::named(name).unwrap().missing_ultraviolet().map(|missing| missing.to_string())
    };
    let fl11 = "FL11 is given from 380 nm on: what dyes absorb below is not counted";
    assert_eq!(said("fl11").as_deref(), Some(fl11));
    for name in ["D65", "A", "E", "ID65", "3000K", "D6200K"] {
        assert_eq!(said(name), None, "{name}");
    }
}

proptest::proptest! {
    #[test]
    fn every_temperature_in_range_makes_a_valid_contract(
        blackbody_k in 1000.0..=100_000.0, daylight_k in 4000.0..=25_000.0,
        observer in 0..Observer::NAMES.len(),
    ) {
        for name in [format!("{blackbody_k}K"), format!("D{daylight_k}K")] {
            let illuminant = Illuminant::named(&name).unwrap();
            proptest::prop_assert_eq!(illuminant.name(), &name);
            proptest::prop_assert!(illuminant.power().values().iter().all(|power| *power >= 0.0));
            let observer = Observer::named(Observer::NAMES[observer]).unwrap();
            let contract = Contract { illuminant, observer, ..Contract::default() };
            proptest::prop_assert_eq!(contract.check(), Ok(()));
        }
    }
}
