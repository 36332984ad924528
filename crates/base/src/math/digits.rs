//! Numbers as text in messages, tables and pages: with the significant digits only, and without negative zero.

/// `value` with a fixed number of `decimals`; a value that rounds to zero has no sign.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let zero = text.strip_prefix('-').filter(|rest| rest.bytes().all(|b| b"0.".contains(&b)));
    zero.map_or_else(|| text.clone(), str::to_owned)
}

/// `value` with six significant digits, without trailing zeros.
pub fn short(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    if value == 0.0 || (-4.0..9.0).contains(&exponent) {
        // the addition removes the sign of a zero
        let rounded = format!("{value:.5e}").parse().unwrap_or(value) + 0.0;
        return format!("{rounded}");
    }
    let text = format!("{value:.5e}");
    match text.split_once('e') {
        Some((digits, exponent)) => format!("{}e{exponent}", digits.trim_end_matches('0').trim_end_matches('.')),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_have_no_sign() {
        let all = [(-0.0, 2), (-0.004, 2), (-0.006, 2), (0.004, 3), (-1e-9, 0), (-12.0, 0)].map(|(v, d)| fixed(v, d));
        assert_eq!(all, ["0.00", "0.00", "-0.01", "0.004", "0", "-12"]);
        assert_eq!(fixed(f64::NAN, 2), "NaN");
        assert_eq!([-0.0, 0.1 + 0.2, -1.25, 1e12, 2e-9].map(short), ["0", "0.3", "-1.25", "1e12", "2e-9"]);
    }
}
