//! Natural modes: K φ = ω² M φ.
use super::system::Structure;
use crate::math::lanczos;
use crate::math::reduce::{largest, sum};
use crate::system::{Mechanical, Moment, System};

/// What modes are asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// How many.
    pub count: usize,
    /// Those nearest above this angular frequency.
    pub above: f64,
}

/// A natural mode.
#[derive(Clone, Debug)]
pub struct Mode {
    /// Angular frequency; 0 where the body moves as a whole.
    pub omega: f64,
    /// Displacements, the greatest of which is 1.
    pub shape: Vec<f64>,
    /// Σ m φ².
    pub generalised_mass: f64,
    /// What is left of K φ − ω² M φ, over the larger of both.
    pub left: f64,
}

/// Why there are no modes.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoModes {
    /// The matrix is too large.
    #[error(
        "{unknowns} displacements are more than the {most} of which modes are found\nhint: take a larger spacing; modes of a solid converge with its square"
    )]
    TooLarge {
        /// How many there are.
        unknowns: usize,
        /// How many there may be.
        most: usize,
    },
    /// The stiffness is not positive.
    #[error("the structure has buckled: its stiffness is not positive in the state at hand\nhint: lower the load")]
    Buckled,
}

/// Shift in units of what is fast in a structure: free bodies have zero frequencies, for which K alone cannot be factored.
const SHIFT: f64 = 1e-9;
/// What a mode may leave of its equation.
const TOLERANCE: f64 = 1e-9;
/// Frequencies below this part of the fastest are motions as a whole.
const RIGID: f64 = 1e-6;

/// The lowest modes around the state `u`.
pub fn modes<const D: usize>(structure: &Structure<D>, u: &[f64], wanted: &Wanted) -> Result<Vec<Mode>, NoModes> {
    let n = structure.displacements();
    if n > structure.largest_factored() {
        return Err(NoModes::TooLarge { unknowns: n, most: structure.largest_factored() });
    }
    let at = Moment { time: 0.0, step: 0.0, displacement: &u[..n], velocity: &u[n..2 * n], history: &u[2 * n..] };
    let stiffness = structure.linearise(&at, [1.0, 0.0]);
    let fastest = 1.0 / structure.solid.undamped_step(u[..n].as_chunks().0);
    let shift = SHIFT * fastest * fastest;
    let factors = structure.matrix(&stiffness, 1.0, shift).factor().ok_or(NoModes::Buckled)?;
    let root: Vec<f64> = (0..n).map(|k| structure.mass(k).sqrt()).collect();
    let mask = |x: &mut [f64]| (0..n).filter(|k| structure.is_held(*k)).for_each(|k| x[k] = 0.0);
    let scale = |x: &mut [f64]| x.chunks_exact_mut(n).for_each(|x| x.iter_mut().zip(&root).for_each(|(x, r)| *x *= r));
    let apply = |x: &mut [f64]| {
        scale(x);
        x.chunks_exact_mut(n).for_each(mask);
        factors.solve(x);
        scale(x);
    };
    let skipped = if wanted.above > 0.0 { 2 * wanted.count + 32 } else { 0 };
    let count = (wanted.count + skipped).min(n);
    let found = lanczos::largest(n, count, (TOLERANCE, 12 * count + 120), mask, apply);
    let mut work = structure.work();
    let all = found.values.iter().zip(&found.vectors).map(|(value, vector)| {
        let square = 1.0 / value - shift;
        let mut shape: Vec<f64> = vector.iter().zip(&root).map(|(x, r)| x / r).collect();
        let largest = largest(n, |k| shape[k].abs()).map_or(0.0, |(k, _)| shape[k]);
        shape.iter_mut().for_each(|x| *x /= largest);
        let omega = if square > (RIGID * fastest).powi(2) { square.sqrt() } else { 0.0 };
        let mut force = vec![0.0; n];
        structure.stiffness(&stiffness, &shape, &mut work, &mut force);
        mask(&mut force);
        let inertia = |k: usize| omega * omega * structure.mass(k) * shape[k];
        let left = sum(n, |k| (force[k] - inertia(k)).powi(2));
        let whole = sum(n, |k| force[k].powi(2).max(inertia(k).powi(2)));
        let generalised_mass = sum(n, |k| structure.mass(k) * shape[k] * shape[k]);
        Mode { omega, shape, generalised_mass, left: (left / whole.max(f64::MIN_POSITIVE)).sqrt() }
    });
    Ok(all.filter(|mode| mode.omega >= wanted.above).take(wanted.count).collect())
}
