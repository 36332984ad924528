//! Roots of scalar functions.

/// Number of bisections after which any interval is smaller than the spacing of `f64`.
const MAX_HALVINGS: usize = 200;

/// Root of `f` in `[low, high]` by bisection, to round-off; `f` must change sign once.
///
/// Without a sign change, the end of the interval nearer to the root of a monotone `f` is returned.
pub(crate) fn bisect(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rising = f(high) > f(low);
    for _ in 0..MAX_HALVINGS {
        let middle = 0.5 * (low + high);
        if middle <= low || high <= middle {
            break;
        }
        if (f(middle) < 0.0) == rising {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_roots_of_rising_and_falling_functions() {
        assert!((bisect(0.0, 2.0, |x| x * x - 2.0) - 2.0_f64.sqrt()).abs() < 1e-15);
        assert!((bisect(0.0, 3.0, f64::cos) - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    }
}
