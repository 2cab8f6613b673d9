//! CIEDE2000 against its authors' test pairs.

use upglow_color::{Lab, ciede2000};

/// Half a unit of the fourth printed digit.
const PRINTED_DIGITS: f64 = 0.5e-4;

#[test]
fn all_34_pairs_agree_to_their_printed_digits_in_both_orders() {
    let mut pairs = 0;
    for line in include_str!("data/ciede2000_pairs.csv").lines().skip(3) {
        let v: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let first = Lab { l: v[0], a: v[1], b: v[2] };
        let second = Lab { l: v[3], a: v[4], b: v[5] };
        for found in [ciede2000(first, second), ciede2000(second, first)] {
            assert!((found - v[6]).abs() <= PRINTED_DIGITS * 1.000_1, "{line}: {found}");
        }
        pairs += 1;
    }
    assert_eq!(pairs, 34);
}
