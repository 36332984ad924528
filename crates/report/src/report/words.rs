//! Numbers as pages tell them.
use serde_json::Value;

use crate::math::digits::fixed;

/// Decimals of a load whose error nobody knows: as the terminal tells it.
const OF_LOADS: usize = 5;

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

/// A number without zeros behind its last digit: what is given or counted, not computed.
pub(super) fn plain(value: f64) -> String {
    let text = number(value);
    let fraction = text.contains('.') && !text.contains('e');
    if fraction { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A load coefficient whose error is not known.
pub(super) fn load(value: f64) -> String {
    if value.is_finite() { fixed(value, OF_LOADS).replace('-', "\u{2212}") } else { "–".to_owned() }
}

/// A value with its error bar, both to the second digit of the bar.
pub(super) fn with_bar(value: f64, bar: f64) -> String {
    let decimals = (1.0 - bar.log10().floor()).clamp(2.0, 7.0) as usize;
    format!("{} ± {}", fixed(value, decimals), fixed(bar, decimals)).replace('-', "\u{2212}")
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_ends_with_the_second_digit_of_its_bar() {
        assert_eq!(with_bar(0.286541, 2.245e-5), "0.286541 ± 0.000022");
        assert_eq!(with_bar(-0.35673, 0.0031), "\u{2212}0.3567 ± 0.0031");
        assert_eq!(with_bar(0.0, 0.0), "0.0000000 ± 0.0000000");
        assert_eq!(with_bar(-1.2e-6, 0.0017), "0.0000 ± 0.0017");
    }

    #[test]
    fn what_is_given_has_no_zeros_behind_it_and_no_zero_a_sign() {
        assert_eq!([0.3, -4.0, 1.25, -0.0, 4.0].map(plain), ["0.3", "\u{2212}4", "1.25", "0", "4"]);
        assert_eq!([0.286_514, -1e-9, -0.003].map(load), ["0.28651", "0.00000", "\u{2212}0.00300"]);
        assert_eq!(load(f64::NAN), "–");
    }
}
