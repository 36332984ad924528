//! Natural modes: K q = ω² M q.
use num_complex::Complex64;

use super::Flutter;

impl Flutter<'_> {
    /// Natural modes without damping, by rising frequency: angular frequency, and amplitudes of the coordinates for generalised mass 1.
    pub fn natural(&self) -> Vec<(f64, Vec<Complex64>)> {
        let Some(modes) = &self.modes else { return Vec::new() };
        let one = |m: usize| {
            let unit: Vec<Complex64> = (0..modes.n).map(|k| Complex64::from(f64::from(u8::from(k == m)))).collect();
            (modes.squares[m].max(0.0).sqrt(), modes.coordinates(&unit))
        };
        (0..modes.n).map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::Matrices;
    use super::*;

    #[test] // K q = ω² M q, qᵀ M q = 1
    fn natural_modes_are_those_of_the_structure() {
        let m = Matrices { mass: vec![2.0, 0.5, 0.5, 1.0], damping: vec![0.0; 4], stiffness: vec![3.0, 0.0, 0.0, 5.0] };
        let forces = |_: f64| Vec::new();
        let found = Flutter::new(&m, &forces).natural();
        assert!(found.len() == 2 && found[0].0 < found[1].0);
        for (omega, q) in &found {
            let of = |a: &[f64], i: usize| a[2 * i] * q[0].re + a[2 * i + 1] * q[1].re;
            assert!((0..2).all(|i| (of(&m.stiffness, i) - omega * omega * of(&m.mass, i)).abs() < 1e-12));
            assert!(((0..2).map(|i| q[i].re * of(&m.mass, i)).sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }
}
