//! Words and numbers of the page.

/// `text` where markup would be read as such; characters that XML forbids become a replacement.
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

/// A count with its thousands apart.
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

pub(super) fn plural(count: u64, one: &str, many: &str) -> String {
    format!("{} {}", grouped(count), if count == 1 { one } else { many })
}

/// A share that says "0 %" only of none and "100 %" only of all.
pub(super) fn percent(part: u64, whole: u64) -> String {
    match part {
        0 => "0 %".into(),
        _ if part == whole => "100 %".into(),
        _ => percent_of(part as f64 / whole as f64),
    }
}

/// A share between none and all.
pub(super) fn percent_of(share: f64) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_none_is_zero_percent_and_only_all_is_a_hundred() {
        assert_eq!((percent(0, 9), percent(9, 9)), ("0 %".into(), "100 %".into()));
        assert_eq!(percent(1, 1_000_000), "less than 0.01 %");
        assert_eq!(percent(999_999, 1_000_000), "more than 99.99 %");
        assert_eq!((percent(1, 3), percent(1, 300)), ("33.3 %".into(), "0.33 %".into()));
    }

    #[test]
    fn thousands_stand_apart() {
        assert_eq!(grouped(16_777_216), "16\u{202F}777\u{202F}216");
        assert_eq!((grouped(0), grouped(999)), ("0".into(), "999".into()));
    }

    #[test]
    fn odd_values_have_names() {
        assert_eq!([f32::NAN, f32::INFINITY, f32::NEG_INFINITY].map(value), ["NaN", "∞", "−∞"]);
        assert_eq!([0.5, -0.0001, 65504.0].map(value), ["0.500", "−1.0e−4", "6.6e4"]);
    }
}
