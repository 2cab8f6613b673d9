//! Formatting of texts and numbers.

/// Escapes markup; characters that XML forbids become replacement characters.
pub(super) fn escaped(text: &str) -> String {
    text.chars().fold(String::new(), |mut out, c| {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\u{FFFE}' | '\u{FFFF}' => out.push('\u{FFFD}'),
            c if c.is_control() => out.push('\u{FFFD}'),
            c => out.push(c),
        }
        out
    })
}

/// A count with separated thousands.
pub(super) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202F}');
        }
        out.push(digit);
    }
    out
}

/// A share, 0..=1, as a percentage that is "0 %" only for none and "100 %" only for all.
pub(super) fn percent(share: f64) -> String {
    match share * 100.0 {
        p if p <= 0.0 => "0 %".into(),
        p if p >= 100.0 => "100 %".into(),
        p if p < 0.005 => "less than 0.01 %".into(),
        p if p >= 99.995 => "more than 99.99 %".into(),
        p if (1.0..99.0).contains(&p) => format!("{p:.1} %"),
        p => format!("{p:.2} %"),
    }
}

/// A value of a texel.
pub(super) fn value(v: f32) -> String {
    let number = match v {
        _ if v.is_nan() => "NaN".into(),
        _ if v.is_infinite() => (if v > 0.0 { "∞" } else { "−∞" }).into(),
        _ if v.abs() >= 1000.0 || (v != 0.0 && v.abs() < 5e-4) => format!("{v:.1e}"),
        _ => format!("{v:.3}"),
    };
    number.replace('-', "−")
}

/// A signed number of one decimal.
pub(super) fn signed(v: f64) -> String {
    let text = format!("{v:+.1}");
    if text.ends_with("0.0") && v.abs() < 1.0 { "0.0".into() } else { text.replace('-', "−") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_none_is_zero_percent_and_only_all_is_a_hundred() {
        let percent = |part: u32, whole: u32| percent(f64::from(part) / f64::from(whole));
        assert_eq!((percent(0, 9), percent(9, 9)), ("0 %".into(), "100 %".into()));
        assert_eq!(percent(1, 1_000_000), "less than 0.01 %");
        assert_eq!(percent(999_999, 1_000_000), "more than 99.99 %");
        assert_eq!((percent(1, 3), percent(1, 300)), ("33.3 %".into(), "0.33 %".into()));
    }

    #[test]
    fn thousands_are_separated() {
        assert_eq!(grouped(16_777_216), "16\u{202F}777\u{202F}216");
        assert_eq!((grouped(0), grouped(999)), ("0".into(), "999".into()));
    }

    #[test]
    fn signs_are_shown_but_for_nothing() {
        assert_eq!(
            [1.26, -1.24, 0.04, -0.04, -20.0].map(signed),
            ["+1.3", "−1.2", "0.0", "0.0", "−20.0"]
        );
    }

    #[test]
    fn special_values_have_names() {
        assert_eq!([f32::NAN, f32::INFINITY, f32::NEG_INFINITY].map(value), ["NaN", "∞", "−∞"]);
        assert_eq!([0.5, -0.0001, 65504.0].map(value), ["0.500", "−1.0e−4", "6.6e4"]);
    }
}
