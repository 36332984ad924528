//! Numbers as pages tell them.
use serde_json::Value;

/// A number for reading: five significant digits, an exponent for the very large and small.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    let text = if value == 0.0 {
        "0".to_owned()
    } else if !value.is_finite() {
        return "–".to_owned();
    } else if (1e-4..1e7).contains(&size) {
        let decimals = (4.0 - size.log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    };
    text.replace('-', "\u{2212}")
}

/// The same of an entry of a file that may not be one.
pub(super) fn number_of(value: &Value) -> String {
    value.as_f64().map_or("–".to_owned(), number)
}

/// A whole number with thin spaces between thousands.
pub(super) fn grouped(value: f64) -> String {
    let digits = format!("{:.0}", value.abs());
    let mut text = String::from(if value < 0.0 { "\u{2212}" } else { "" });
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}
