//! Natural modes of a solid: K φ = ω² M φ.
use super::system::Structure;
use crate::math::lanczos;
use crate::math::reduce::{largest, sum};
use crate::system::{Mechanical, Moment, System};

/// Which modes are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeRequest {
    /// Number of modes.
    pub count: usize,
    /// Lower bound of the angular frequency [rad/s]: the modes above it and nearest to it are computed.
    pub above: f64,
}

/// A natural mode of a solid.
#[derive(Clone, Debug)]
pub struct Mode {
    /// Angular frequency [rad/s]; 0 for a rigid-body mode.
    pub omega: f64,
    /// Displacements of all particles, component by component; the greatest magnitude is 1.
    pub shape: Vec<f64>,
    /// Generalised mass Σ m φ² (kg).
    pub generalised_mass: f64,
    /// Relative residual |K φ − ω² M φ|, divided by the larger of the two terms.
    pub left: f64,
}

/// Reason why modes could not be computed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ModesError {
    /// The stiffness matrix is too large to be factored.
    #[error(
        "the solid has {unknowns} displacements, but modes are computed for at most {most}\nhint: use a larger spacing; the error of the modes is proportional to its square"
    )]
    TooLarge {
        /// Number of unknowns.
        unknowns: usize,
        /// Greatest number of unknowns that is factored.
        most: usize,
    },
    /// The tangent stiffness is not positive definite.
    #[error("the structure has buckled: its stiffness is not positive definite in this state\nhint: lower the load")]
    Buckled,
}

/// Shift in units of the square of the highest frequency. Free bodies have zero frequencies, for which K alone cannot
/// be factored.
const SHIFT: f64 = 1e-9;
/// Greatest relative residual of a mode.
const TOLERANCE: f64 = 1e-9;
/// Frequencies below this fraction of the highest one belong to rigid-body modes.
const RIGID: f64 = 1e-6;

/// The lowest modes of small vibrations about the state `u`. Fails when the stiffness matrix is too large or not
/// positive definite.
pub fn modes<const D: usize>(
    structure: &Structure<D>,
    u: &[f64],
    wanted: &ModeRequest,
) -> Result<Vec<Mode>, ModesError> {
    let n = structure.displacements();
    if n > structure.largest_factored() {
        return Err(ModesError::TooLarge { unknowns: n, most: structure.largest_factored() });
    }
    let at = Moment { time: 0.0, step: 0.0, displacement: &u[..n], velocity: &u[n..2 * n], history: &u[2 * n..] };
    let stiffness = structure.linearise(&at, [1.0, 0.0]);
    let fastest = 1.0 / structure.solid.undamped_step(u[..n].as_chunks().0);
    let shift = SHIFT * fastest * fastest;
    let factors = structure.matrix(&stiffness, 1.0, shift).factor().ok_or(ModesError::Buckled)?;
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
