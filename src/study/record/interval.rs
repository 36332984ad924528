//! Intervals of time, counted in spite of round-off.
/// Part of an interval by which a time may fall short of a multiple of it.
pub(crate) const NEARLY: f64 = 1e-6;

/// Whole intervals that have passed at `t`.
pub(crate) fn passed(t: f64, interval: f64) -> u64 {
    (t / interval + NEARLY).floor() as u64
}
