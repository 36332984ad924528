//! Loops of the loads over one period, and how two of them differ.
use super::curve::{Table, TableError};

/// Lift and drag over the last period of a run, equally spaced in phase from zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loops {
    /// Lift coefficient.
    pub cl: Vec<f64>,
    /// Drag coefficient.
    pub cd: Vec<f64>,
}

impl Loops {
    /// Reads the file `loops.csv` of a run.
    pub fn parse(text: &str) -> Result<Self, TableError> {
        let table = Table::parse(text)?;
        Ok(Self { cl: table.column("cl")?, cd: table.column("cd")? })
    }
}

/// Root mean square of `a − b` over half the range of `b`; `None` unless both have equally many samples and `b` varies.
pub fn loop_difference(a: &[f64], b: &[f64]) -> Option<f64> {
    if a.len() != b.len() || a.is_empty() {
        return None;
    }
    let low = b.iter().copied().fold(f64::INFINITY, f64::min);
    let high = b.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (high > low).then(|| (square / a.len() as f64).sqrt() / (0.5 * (high - low)))
}

/// Greatest |value − reference| at the phases (parts of a period) of a reference; `None` without samples.
pub fn greatest_difference(samples: &[f64], phase: &[f64], reference: &[f64]) -> Option<f64> {
    let n = samples.len();
    let at = |phase: f64| {
        let place = phase.rem_euclid(1.0) * n as f64;
        let (k, part) = (place as usize, place.fract());
        (1.0 - part) * samples[k % n] + part * samples[(k + 1) % n]
    };
    let worst = phase.iter().zip(reference).map(|(p, r)| (at(*p) - r).abs()).reduce(f64::max);
    worst.filter(|_| n > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_loops() {
        let wave = |shift: f64| -> Vec<f64> {
            (0..64).map(|k| (k as f64 / 64.0 * std::f64::consts::TAU).cos() + shift).collect()
        };
        assert!((loop_difference(&wave(0.1), &wave(0.0)).unwrap() - 0.1).abs() < 1e-12);
        assert_eq!(loop_difference(&wave(0.0), &wave(0.0)[1..]), None);
        assert_eq!(loop_difference(&[1.0, 1.0], &[1.0, 1.0]), None);
        let worst = greatest_difference(&wave(0.0), &[0.0, 0.5, -0.25, 1.0 - 1e-12], &[1.0, -0.9, 0.0, 1.0]).unwrap();
        assert!((worst - 0.1).abs() < 1e-12, "{worst}");
        assert_eq!(greatest_difference(&wave(0.0), &[], &[]), None);
        let read = Loops::parse("phase,cl,cd\n0,1,3\n0.5,2,4\n").unwrap();
        assert_eq!(read, Loops { cl: vec![1.0, 2.0], cd: vec![3.0, 4.0] });
    }
}
