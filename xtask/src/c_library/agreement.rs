//! Whether a C program and `upglow color` say the same of a color.

use serde_json::Value;

/// Between look-ups in single and in double precision, by the promise of the run-time library.
const SINGLE: f64 = 1e-5;

/// How many lines of the example carry a number that the program knows: 8 reflectances, 4 at once,
/// 4 one by one, and the color.
const COMPARED: usize = 17;

/// What the example printed that the program's report does not say, one line each.
pub(super) fn differences(printed: &str, report: &Value) -> Vec<String> {
    let lines = printed.lines().filter_map(|line| Some((line, expected(line, report)?)));
    let compared: Vec<_> = lines.collect();
    let mut problems: Vec<String> = compared
        .iter()
        .filter(|(line, expected)| !agree(line, expected))
        .map(|(line, expected)| format!("`{line}`, but `upglow color` says {expected:?}"))
        .collect();
    if compared.len() != COMPARED {
        problems.push(format!("{} numbers to compare, expected {COMPARED}", compared.len()));
    }
    problems
}

/// What the last words of a line should be; `None` where the report has no such number.
fn expected(line: &str, report: &Value) -> Option<Vec<f64>> {
    let (kind, rest) = line.split_once(' ')?;
    match kind {
        "reflectance" | "four" | "one" => {
            let nm: f64 = rest.split(' ').next()?.parse().ok()?;
            let place = numbers(&report["curves"]["wavelengths_nm"]).position(|at| at == nm)?;
            Some(vec![numbers(&report["curves"]["reflectance"]).nth(place)?])
        }
        "xyz" => Some(numbers(&report["lights"][0]["xyz"]).collect()),
        _ => None,
    }
}

fn numbers(array: &Value) -> impl Iterator<Item = f64> + '_ {
    array.as_array().into_iter().flatten().filter_map(Value::as_f64)
}

fn agree(line: &str, expected: &[f64]) -> bool {
    let words: Vec<f64> = line.split(' ').filter_map(|word| word.parse().ok()).collect();
    let found = words.get(words.len().saturating_sub(expected.len())..).unwrap_or_default();
    found.len() == expected.len()
        && found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() <= SINGLE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn report() -> Value {
        json!({
            "curves": { "wavelengths_nm": [400.0, 500.0], "reflectance": [0.25, 0.5] },
            "lights": [{ "xyz": [0.1, 0.2, 0.3] }],
        })
    }

    fn printed() -> String {
        "space acescg\n".to_owned() + &"reflectance 500 0.5\n".repeat(16) + "xyz 0.1 0.2 0.300001\n"
    }

    #[test]
    fn the_same_numbers_agree() {
        assert_eq!(differences(&printed(), &report()), Vec::<String>::new());
    }

    #[test]
    fn a_wrong_number_is_named() {
        let printed = printed().replace("0.300001", "0.3001");
        assert_eq!(
            differences(&printed, &report()),
            ["`xyz 0.1 0.2 0.3001`, but `upglow color` says [0.1, 0.2, 0.3]"]
        );
        let printed = printed.replacen("500 0.5", "400 0.5", 1);
        assert_eq!(differences(&printed, &report()).len(), 2);
    }

    #[test]
    fn what_is_not_printed_or_no_number_does_not_agree() {
        assert_eq!(differences("", &report()), ["0 numbers to compare, expected 17"]);
        assert_eq!(differences(&printed().replacen("0.5", "nan", 1), &report()).len(), 1);
    }
}
