//! Walls in a motion of small size, with the unsteady pressure on them: what a mode of flutter looks like from the gas.
//!
//! A wall particle goes from X to X + Re(d e^{iωt}) with d = Σ q̂_k ∂x/∂q_k, and the pressure on it changes by Re(Δp e^{iωt}) with
//! Δp = Σ q̂_k p̂_k(ω), where p̂_k is what the linear system of the gas has for coordinate k at this frequency. Between two frequencies
//! at which the gas was solved, p̂_k is taken to be linear.
use num_complex::Complex64;

use super::super::studies::MovingWalls;
use super::shapes::amplitudes;
use crate::record::flutter::{Share, WallMotion};

/// The pressures of one frequency: of each coordinate those of all wall particles, in units of the solver.
pub(super) type Pressures = (f64, Vec<Vec<Complex64>>);

/// The motion of the shape `shape`, whose coordinates are counted in `units`, at the angular frequency `omega` in a stream of the
/// Mach number `mach`; `None` where no pressures are known, or walls whose cloud is too large to be drawn.
pub(super) fn wall_motion(
    walls: &MovingWalls,
    (shape, units): (&[Share], &[f64]),
    known: &[Pressures],
    (omega, mach): (f64, f64),
) -> Option<WallMotion> {
    if walls.lines.is_empty() && walls.triangles.is_empty() {
        return None;
    }
    let [(low, below), (high, above)] = around(known, omega)?;
    let part = if high > low { ((omega - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
    let q: Vec<Complex64> = amplitudes(shape).iter().zip(units).map(|(q, unit)| q * unit).collect();
    let sum = |of: &dyn Fn(usize) -> Complex64| q.iter().enumerate().map(|(k, q)| q * of(k)).sum::<Complex64>();
    let parts = |z: Complex64| [z.re, z.im];
    // ρ∞ = a∞ = 1 in the solver
    let dynamic = 0.5 * mach * mach;
    let pressure = |w: usize| sum(&|k| (below[k][w] * (1.0 - part) + above[k][w] * part) / dynamic);
    let moved = |w: usize, d: usize| sum(&|k| Complex64::from(walls.moves[k][w][d]));
    let n = walls.points.len();
    Some(WallMotion {
        points: walls.points.clone(),
        lines: walls.lines.clone(),
        triangles: walls.triangles.clone(),
        displacement: (0..n).map(|w| [0, 1, 2].map(|d| parts(moved(w, d)))).collect(),
        cp: (0..n).map(|w| parts(pressure(w))).collect(),
    })
}

/// A frequency, and the pressures of every coordinate on the walls.
type AtFrequency<'a> = (f64, &'a [Vec<Complex64>]);

/// The nearest known frequencies on either side; the last one twice beyond it.
fn around(known: &[Pressures], omega: f64) -> Option<[AtFrequency<'_>; 2]> {
    let entry = |k: usize| known.get(k).map(|(w, p)| (*w, &p[..]));
    let above = known.partition_point(|(w, _)| *w < omega).min(known.len().checked_sub(1)?);
    Some([entry(above.saturating_sub(1))?, entry(above)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressures_are_those_of_the_motion_between_two_frequencies() {
        let walls = MovingWalls {
            points: vec![[0.0; 3], [1.0, 0.0, 0.0]],
            lines: vec![vec![0, 1]],
            triangles: Vec::new(),
            moves: vec![vec![[0.0, 1.0, 0.0]; 2], vec![[0.0, 0.0, 0.0], [0.0, -1.0, 0.0]]],
        };
        let at = |omega: f64, p: f64| (omega, vec![vec![Complex64::from(p); 2], vec![Complex64::new(0.0, p); 2]]);
        let known = [at(0.0, 1.0), at(1.0, 3.0)];
        let share = |amplitude, phase_deg| Share { coordinate: String::new(), amplitude, phase_deg };
        let shape = [share(1.0, 0.0), share(0.5, 90.0)];
        let found = wall_motion(&walls, (&shape, &[0.5, 1.0]), &known, (0.25, 2.0)).unwrap();
        // q = (0.5, 0.5i), p between 1 and 3 a quarter of the way, over ½ M² = 2
        let expected = (0.5 * 1.5 - 0.5 * 1.5) / 2.0;
        assert!(found.cp.iter().all(|cp| (cp[0] - expected).abs() < 1e-15 && cp[1].abs() < 1e-15), "{:?}", found.cp);
        assert!((found.displacement[1][1][0] - 0.5).abs() < 1e-15 && (found.displacement[1][1][1] + 0.5).abs() < 1e-15);
        let beyond = wall_motion(&walls, (&shape[..1], &[1.0]), &known, (5.0, 2.0)).unwrap();
        assert_eq!(beyond.cp[0], [1.5, 0.0]);
        assert!(wall_motion(&walls, (&shape, &[0.5, 1.0]), &[], (0.25, 2.0)).is_none());
    }
}
