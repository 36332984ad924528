//! Periodic motion of a forced structure: damped Newton-GMRES, with continuation in the load if it does not converge.
//!
//! Let r(u) be the residual of the equations of [`super::vibration`] and u₀ the initial state (the equilibrium under
//! the mean load). The equation r(u) = (1 − s) r(u₀) is solved for s = 1, or first for smaller s, which corresponds to
//! the fraction s of the loads and support motions. A Newton step δ is shortened until ‖P⁻¹r‖ decreases, where P is the
//! preconditioner at the start of the step: the natural monotonicity test (Deuflhard 2004, *Newton Methods for
//! Nonlinear Problems*, section 3.3), which measures displacements independently of the stiffness. GMRES is
//! preconditioned from the left and therefore measures displacements too.
use super::vibration::Vibration;
use crate::math::krylov::{Gmres, Goal, Numbers, System};
use crate::math::reduce::{dot, maximum};
use crate::system::Mechanical;

/// Convergence criteria of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Orders of magnitude by which ‖P⁻¹r‖ must fall.
    pub orders: f64,
    /// Maximum ratio of ‖P⁻¹r‖ to the displacements.
    pub tolerance: f64,
    /// Maximum number of iterations.
    pub iterations: u32,
}

/// State of a search, from which a later search continues with identical results.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Place {
    /// Displacements at all instances.
    pub u: Vec<f64>,
    /// Displacements of the last load fraction that was solved.
    pub last_good: Vec<f64>,
    /// Residual r(u₀) at the start of the search.
    pub start: Vec<f64>,
    /// Largest load fraction that was solved, 0 to 1.
    pub reached: f64,
    /// Load fraction that is being solved, 0 to 1.
    pub sought: f64,
    /// ‖P⁻¹r‖ at the start of the search for that fraction.
    pub first: f64,
    /// Number of iterations since the start of the search for that fraction.
    pub within: u32,
    /// Total number of Newton iterations.
    pub iterations: u32,
    /// Total number of linear iterations.
    pub linear: u32,
    /// Number of times that the load increment was halved.
    pub halved: u32,
}

/// Result of one iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// Ratio of ‖P⁻¹r‖ to its first value.
    pub residual: f64,
    /// Fraction of the Newton step that was applied; 0 if no fraction was acceptable.
    pub taken: f64,
}

/// Reason why no periodic motion was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotFound {
    /// A linear system is singular.
    #[error(
        "the linear systems of the periodic motion have no solution: a harmonic of the excitation is a natural frequency of the structure, or the structure has no supports\nhint: add damping (`damping`, `stiffness_damping`) or supports, or choose another frequency"
    )]
    Singular,
    /// Newton's method does not converge.
    #[error(
        "no periodic motion was found beyond {:.1} % of the load, after {iterations} iterations{}\nhint: the solution branch may have a turning point there, as near the resonance of stiffening structures: use more damping (`damping`, `stiffness_damping`), another frequency or a smaller load, or march in time with `[time.newmark]`",
        100.0 * .reached, .fault.as_ref().map(|f| format!(": {f}")).unwrap_or_default()
    )]
    Stuck {
        /// Fraction of the load that was solved.
        reached: f64,
        /// Number of iterations.
        iterations: u32,
        /// Fault of the last trial state, if it was not physical.
        fault: Option<String>,
    },
    /// The maximum number of iterations is reached.
    #[error(
        "no periodic motion was found in {iterations} iterations; the search reached {:.1} % of the load\nhint: raise `time.harmonics.iterations` and continue with `alula resume`",
        100.0 * .reached
    )]
    Exhausted {
        /// Fraction of the load that was solved.
        reached: f64,
        /// Number of iterations.
        iterations: u32,
    },
}

/// Maximum number of basis vectors of GMRES, and its relative reduction of the residual.
const BASIS: usize = 80;
const LEFT: f64 = 1e-3;
/// Minimum fraction of a Newton step, and maximum number of iterations for one load fraction.
const LEAST: f64 = 1.0 / 64.0;
const MOST: u32 = 25;
/// Minimum increment of the load fraction.
const LEAST_LOAD: f64 = 1.0 / 256.0;
/// Tolerance for intermediate load fractions, relative to the displacements.
const ROUGH: f64 = 1e-2;
/// Residual relative to the forces that counts as zero, and that which is accepted as round-off if Newton's method
/// makes no further progress.
const NOTHING: f64 = 1e-13;
const ROUND_OFF: f64 = 1e-6;

/// A search for a periodic motion.
pub struct Forced<'v, 'a, S: Mechanical> {
    vibration: &'v mut Vibration<'a, S>,
    stop: Stop,
    /// State of the search.
    pub place: Place,
    gmres: Gmres,
}

/// Evaluation of a trial state.
struct Tried {
    /// Norm ‖P⁻¹r‖ of the preconditioned residual.
    level: f64,
    /// Maximum component of r relative to the maximum force.
    left: f64,
}

impl<'v, 'a, S: Mechanical> Forced<'v, 'a, S> {
    /// Starts a search from the displacements `u`.
    pub fn new(vibration: &'v mut Vibration<'a, S>, stop: Stop, mut u: Vec<f64>) -> Result<Self, NotFound> {
        vibration.hold(&mut u);
        let mut start = vec![0.0; u.len()];
        let lost = |f: crate::system::Fault| NotFound::Stuck { reached: 0.0, iterations: 0, fault: Some(f.reason) };
        vibration.residual(&u, &mut start).map_err(lost)?;
        let place = Place { last_good: u.clone(), u, start, sought: 1.0, ..Place::default() };
        Ok(Self::at(vibration, stop, place))
    }

    /// Continues a search from the state `place`.
    pub fn at(vibration: &'v mut Vibration<'a, S>, stop: Stop, place: Place) -> Self {
        let gmres = Gmres::new(place.u.len(), BASIS);
        Self { vibration, stop, place, gmres }
    }

    /// True if the periodic motion is found.
    pub fn finished(&self) -> bool {
        self.place.reached >= 1.0
    }

    /// Residual at `u` for the current load fraction; returns the maximum force.
    fn left(&mut self, u: &[f64], out: &mut [f64]) -> Result<f64, String> {
        let scale = self.vibration.residual(u, out).map_err(|f| f.reason)?;
        let part = 1.0 - self.place.sought;
        out.iter_mut().zip(&self.place.start).for_each(|(r, start)| *r -= part * start);
        Ok(scale)
    }

    /// Evaluates the state `u` and writes P⁻¹r to `z`.
    fn look(&mut self, u: &[f64], z: &mut [f64]) -> Result<Tried, String> {
        let mut r = vec![0.0; u.len()];
        let scale = self.left(u, &mut r)?;
        let largest = maximum(r.len(), |k| r[k].abs());
        self.vibration.precondition(&r, z);
        let level = rms(z);
        match level.is_finite() {
            true => Ok(Tried { level, left: if scale > 0.0 { largest / scale } else { 0.0 } }),
            false => Err("a displacement is not finite".into()),
        }
    }

    /// Computes one iteration of Newton's method.
    pub fn advance(&mut self) -> Result<Told, NotFound> {
        let Place { reached, iterations, .. } = self.place;
        if iterations >= self.stop.iterations {
            return Err(NotFound::Exhausted { reached, iterations });
        }
        let u = self.place.u.clone();
        let linear = self.vibration.linearise(&u);
        if !self.vibration.factor(&linear) {
            return Err(NotFound::Singular);
        }
        self.place.iterations += 1;
        let mut z = vec![0.0; u.len()];
        let before = self.look(&u, &mut z).map_err(|_| NotFound::Singular)?;
        if self.place.within == 0 {
            self.place.first = before.level;
        }
        self.place.within += 1;
        if before.left <= NOTHING {
            self.passed();
            return Ok(Told { residual: NOTHING, taken: 1.0 });
        }
        let mut step = vec![0.0; u.len()];
        let (vibration, mut image) = (&mut *self.vibration, vec![0.0; u.len()]);
        let solved = self.gmres.solve(
            &mut z,
            &mut step,
            Goal { tolerance: LEFT, most: BASIS },
            System {
                product: |v: &[f64], out: &mut [f64]| {
                    vibration.product(&linear, v, &mut image);
                    vibration.precondition(&image, out);
                },
                precondition: |v: Numbers<'_>, out: &mut [f64]| v.each(0, out, |o, v| *o = f64::from(v)),
            },
        );
        self.place.linear += solved.iterations as u32;
        self.take(&u, &step, &before)
    }

    /// Line search: applies the largest fraction of a step that decreases ‖P⁻¹r‖.
    fn take(&mut self, u: &[f64], step: &[f64], before: &Tried) -> Result<Told, NotFound> {
        let (mut part, mut z, mut fault) = (1.0, vec![0.0; u.len()], None);
        while part >= LEAST {
            let trial: Vec<f64> = u.iter().zip(step).map(|(u, s)| u + part * s).collect();
            match self.look(&trial, &mut z) {
                Ok(now) if now.level <= (1.0 - 0.25 * part) * before.level => {
                    let residual = if self.place.first > 0.0 { now.level / self.place.first } else { 0.0 };
                    let solved = self.is_solved(&now, rms(&trial));
                    self.place.u = trial;
                    if solved {
                        self.passed();
                    }
                    return Ok(Told { residual, taken: part });
                }
                Ok(_) => {}
                Err(reason) => fault = Some(reason),
            }
            part *= 0.5;
        }
        if before.left <= ROUND_OFF && self.place.within > 1 {
            self.passed();
            return Ok(Told { residual: before.level / self.place.first, taken: 0.0 });
        }
        self.retreat(fault)
    }

    /// True if the residual is small enough.
    fn is_solved(&self, now: &Tried, size: f64) -> bool {
        let fallen = now.level <= 10f64.powf(-self.stop.orders) * self.place.first;
        match self.place.sought >= 1.0 {
            true => fallen && now.level <= self.stop.tolerance * size,
            false => fallen || now.level <= ROUGH * size,
        }
    }

    /// Accepts the current load fraction as solved, and selects the next one.
    fn passed(&mut self) {
        let place = &mut self.place;
        let step = place.sought - place.reached;
        (place.reached, place.within) = (place.sought, 0);
        place.sought = (place.reached + 2.0 * step).min(1.0);
        place.last_good.copy_from_slice(&place.u);
    }

    /// Returns to the last solved load fraction and halves the increment.
    fn retreat(&mut self, fault: Option<String>) -> Result<Told, NotFound> {
        let place = &mut self.place;
        let step = 0.5 * (place.sought - place.reached);
        place.u.copy_from_slice(&place.last_good);
        place.halved += 1;
        place.within = 0;
        if step < LEAST_LOAD {
            // a later run first tries the full load
            place.sought = 1.0;
            return Err(NotFound::Stuck { reached: place.reached, iterations: place.iterations, fault });
        }
        place.sought = place.reached + step;
        Ok(Told { residual: 1.0, taken: 0.0 })
    }

    /// True if the iterations for the current load fraction are used up.
    fn is_late(&self) -> bool {
        self.place.within >= MOST
    }

    /// Computes one iteration, or reduces the load increment if the current load fraction took too many iterations.
    pub fn step(&mut self) -> Result<Told, NotFound> {
        if self.is_late() { self.retreat(None) } else { self.advance() }
    }
}

/// Root mean square of `x`.
fn rms(x: &[f64]) -> f64 {
    (dot(x, x) / x.len().max(1) as f64).sqrt()
}
