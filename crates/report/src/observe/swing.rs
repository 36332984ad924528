//! The last period of an oscillation whose period is about known: its first harmonic, and whether it repeats.
//!
//! The phase φ of the first harmonic of two successive periods T tells the frequency, ω = 2π/T + (φ − φ')/T, with which both are looked at
//! once more.
use serde::{Deserialize, Serialize};

use super::damping::Tail;
use super::harmonics::{Harmonics, Window};

/// Harmonics that are fitted beside the first one.
const HARMONICS: usize = 5;
/// Times the period is found anew.
const LOOKS: usize = 3;

/// The last period of an oscillation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Swing {
    /// Mean.
    pub mean: f64,
    /// Amplitude of the first harmonic.
    pub amplitude: f64,
    /// Its angular frequency.
    pub frequency: f64,
    /// Change of the amplitude since the period before, over it.
    pub change: f64,
}

impl Swing {
    /// The last period of the history `values` at rising `time`s, with a `period` of about this length; `None` where there are no two, and
    /// where nothing swings.
    pub fn of(time: &[f64], values: &[f64], period: f64) -> Option<Self> {
        let Tail { time, values } = Tail { time, values }.rising();
        let (end, mut period) = (*time.last()?, period);
        let mut found = None;
        for _ in 0..LOOKS {
            let window = Window { period, periods: 1.0, harmonics: HARMONICS };
            let earlier = time.partition_point(|t| *t <= (end - period) * (1.0 + f64::EPSILON));
            let last = Harmonics::fit(time, values, &window).ok()?;
            let before = Harmonics::fit(&time[..earlier], &values[..earlier], &window).ok()?;
            let [amplitude, former] = [&last, &before].map(|h| h.term(1).norm());
            if !(amplitude > 0.0 && former > 0.0) {
                return None;
            }
            let frequency = last.omega + (last.term(1) * before.term(1).conj()).arg() / period;
            found = Some(Self { mean: last.mean, amplitude, frequency, change: (former / amplitude - 1.0).abs() });
            period = std::f64::consts::TAU / frequency;
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swing_of_another_period_than_thought_is_found() {
        let time: Vec<f64> = (1..=640).map(|k| 0.1 * f64::from(k)).collect();
        let wave = |t: f64| 0.3 + 2.0 * (1.02 * t).cos() + 0.2 * (3.06 * t + 0.4).sin();
        let values: Vec<f64> = time.iter().map(|t| wave(*t)).collect();
        let found = Swing::of(&time, &values, std::f64::consts::TAU).unwrap();
        assert!((found.frequency - 1.02).abs() < 1e-4, "{found:?}");
        assert!((found.amplitude - 2.0).abs() < 2e-3 && (found.mean - 0.3).abs() < 2e-3, "{found:?}");
        assert!(found.change < 1e-3, "{found:?}");
        // one that grows by a per cent a period
        let growing: Vec<f64> = time.iter().map(|t| (0.01 * t / std::f64::consts::TAU).exp() * t.cos()).collect();
        let found = Swing::of(&time, &growing, std::f64::consts::TAU).unwrap();
        assert!((found.change - 0.01).abs() < 5e-4, "{found:?}");
        assert!(Swing::of(&time[..60], &values[..60], 6.2).is_none() && Swing::of(&[], &[], 1.0).is_none());
        assert!(Swing::of(&time, &vec![0.0; 640], 6.2).is_none());
    }
}
