//! Spectra in attributes, as `400nm:0.5;410nm:0.6;`.

/// The text of a spectrum, with the shortest decimals that read back as the same numbers.
pub(crate) fn print_spectrum(wavelengths_nm: &[f64], values: &[f64]) -> String {
    let pairs = wavelengths_nm.iter().zip(values);
    pairs.map(|(nm, value)| format!("{nm}nm:{value};")).collect()
}

/// Wavelengths in nm and values of a spectrum; `None` if the text is not one.
pub(crate) fn parse_spectrum(text: &str) -> Option<(Vec<f64>, Vec<f64>)> {
    let pairs = text.strip_suffix(';').unwrap_or(text).split(';').map(|pair| {
        let (nm, value) = pair.split_once(':')?;
        let nm: f64 = nm.strip_suffix("nm")?.parse().ok()?;
        let value: f64 = value.parse().ok()?;
        (nm.is_finite() && value.is_finite()).then_some((nm, value))
    });
    pairs.collect::<Option<Vec<_>>>().map(|pairs| pairs.into_iter().unzip())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_printed_spectrum_is_read_back() {
        let (nm, values) = (vec![400.0, 410.5], vec![0.1, 1.0 / 3.0]);
        let text = print_spectrum(&nm, &values);
        assert_eq!(text, "400nm:0.1;410.5nm:0.3333333333333333;");
        assert_eq!(parse_spectrum(&text), Some((nm, values)));
    }

    #[test]
    fn other_texts_are_refused() {
        for text in ["", ";", "400:1", "400nm", "400nm:x", "400,5nm:1", "400nm:1;;", "infnm:1"] {
            assert_eq!(parse_spectrum(text), None, "{text}");
        }
    }
}
