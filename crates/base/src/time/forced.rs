//! How the periodic motion of a forced structure is found: Newton's method with GMRES, damped, and a homotopy where it does not get on.
//!
//! With r(u) what is left of the equations of [`super::vibration`] and u₀ where the search begins (the equilibrium under the mean
//! load), r(u) = (1 − s) r(u₀) is solved for s = 1, or for smaller s first: under loads and movements of supports in that part. A step δ of
//! Newton's method is taken as far as ‖P⁻¹r‖ falls with it, P being the preconditioner at its start: the natural test of monotonicity
//! (Deuflhard 2004, *Newton Methods for Nonlinear Problems*, section 3.3), which measures displacements, whatever the stiffness. GMRES is
//! preconditioned from the left, so that it measures them too.
use super::vibration::Vibration;
use crate::math::krylov::{Gmres, Goal, Numbers, System};
use crate::math::reduce::{dot, maximum};
use crate::system::Mechanical;

/// When a search ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Orders of magnitude that ‖P⁻¹r‖ must fall.
    pub orders: f64,
    /// Part of the displacements that it may be.
    pub tolerance: f64,
    /// Greatest number of iterations.
    pub iterations: u32,
}

/// Where a search stands: what a later one needs to go on to the same bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Place {
    /// Displacements at all instances.
    pub u: Vec<f64>,
    /// Those that solve the part reached.
    pub last_good: Vec<f64>,
    /// What was left where the search began.
    pub start: Vec<f64>,
    /// The part reached.
    pub reached: f64,
    /// The part sought.
    pub sought: f64,
    /// ‖P⁻¹r‖ where the search for that part began.
    pub first: f64,
    /// Iterations since.
    pub within: u32,
    /// Iterations of Newton's method.
    pub iterations: u32,
    /// Linear iterations.
    pub linear: u32,
    /// Times the part sought was halved.
    pub halved: u32,
}

/// What one iteration did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// ‖P⁻¹r‖ over its first value.
    pub residual: f64,
    /// Part of Newton's step that was taken; 0 where none could be.
    pub taken: f64,
}

/// Why no periodic motion was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotFound {
    /// A linear system has no solution.
    #[error(
        "the linear systems of the periodic motion have no solution: the structure vibrates by itself at a harmonic of its frequency, or nothing holds it\nhint: add damping (`damping`, `stiffness_damping`) or supports, or take another frequency"
    )]
    Singular,
    /// Newton's method does not get on.
    #[error(
        "no periodic motion was found beyond {:.1} % of the load, after {iterations} iterations{}\nhint: the motion may fold back there, as near the resonance of stiffening structures: take more damping (`damping`, `stiffness_damping`), another frequency or a smaller load, or march with `[time.newmark]`",
        100.0 * .reached, .fault.as_ref().map(|f| format!(": {f}")).unwrap_or_default()
    )]
    Stuck {
        /// Part of the load that was reached.
        reached: f64,
        /// Iterations used.
        iterations: u32,
        /// What was wrong with the last state that was tried, where something was.
        fault: Option<String>,
    },
    /// There are no iterations left.
    #[error(
        "no periodic motion was found in {iterations} iterations, only that under {:.1} % of the load\nhint: raise `time.harmonics.iterations` and go on with `alula resume`",
        100.0 * .reached
    )]
    Exhausted {
        /// Part of the load that was reached.
        reached: f64,
        /// Iterations used.
        iterations: u32,
    },
}

/// Greatest number of basis vectors of GMRES, and what it leaves of a linear system.
const BASIS: usize = 80;
const LEFT: f64 = 1e-3;
/// The least part of a step of Newton's method, and the most iterations for a part of the load.
const LEAST: f64 = 1.0 / 64.0;
const MOST: u32 = 25;
/// The least part of the load that is added.
const LEAST_LOAD: f64 = 1.0 / 256.0;
/// What parts of the load that are passed on the way may leave, over the displacements.
const ROUGH: f64 = 1e-2;
/// Parts of the forces: what is as good as nothing, and what round-off may leave where Newton's method gets no further.
const NOTHING: f64 = 1e-13;
const ROUND_OFF: f64 = 1e-6;

/// A search for a periodic motion.
pub struct Forced<'v, 'a, S: Mechanical> {
    vibration: &'v mut Vibration<'a, S>,
    stop: Stop,
    /// Where it stands.
    pub place: Place,
    gmres: Gmres,
}

/// A state that was tried.
struct Tried {
    /// ‖P⁻¹r‖.
    level: f64,
    /// The largest entry of r over the largest force.
    left: f64,
}

impl<'v, 'a, S: Mechanical> Forced<'v, 'a, S> {
    /// A search from the displacements `u`.
    pub fn new(vibration: &'v mut Vibration<'a, S>, stop: Stop, mut u: Vec<f64>) -> Result<Self, NotFound> {
        vibration.hold(&mut u);
        let mut start = vec![0.0; u.len()];
        let lost = |f: crate::system::Fault| NotFound::Stuck { reached: 0.0, iterations: 0, fault: Some(f.reason) };
        vibration.residual(&u, &mut start).map_err(lost)?;
        let place = Place { last_good: u.clone(), u, start, sought: 1.0, ..Place::default() };
        Ok(Self::at(vibration, stop, place))
    }

    /// A search that goes on.
    pub fn at(vibration: &'v mut Vibration<'a, S>, stop: Stop, place: Place) -> Self {
        let gmres = Gmres::new(place.u.len(), BASIS);
        Self { vibration, stop, place, gmres }
    }

    /// True when the motion is found.
    pub fn finished(&self) -> bool {
        self.place.reached >= 1.0
    }

    /// What is left at `u` of the part that is sought.
    fn left(&mut self, u: &[f64], out: &mut [f64]) -> Result<f64, String> {
        let scale = self.vibration.residual(u, out).map_err(|f| f.reason)?;
        let part = 1.0 - self.place.sought;
        out.iter_mut().zip(&self.place.start).for_each(|(r, start)| *r -= part * start);
        Ok(scale)
    }

    /// Looks at the state `u`; what solves the preconditioner for what is left of it is in `z`.
    fn look(&mut self, u: &[f64], z: &mut [f64]) -> Result<Tried, String> {
        let mut r = vec![0.0; u.len()];
        let scale = self.left(u, &mut r)?;
        let largest = maximum(r.len(), |k| r[k].abs());
        self.vibration.precondition(&r, z);
        let level = rms(z);
        match level.is_finite() {
            true => Ok(Tried { level, left: if scale > 0.0 { largest / scale } else { 0.0 } }),
            false => Err("displacements are no numbers".into()),
        }
    }

    /// One iteration of Newton's method.
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

    /// Takes as much of a step as does good.
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

    /// True where what is left is little enough.
    fn is_solved(&self, now: &Tried, size: f64) -> bool {
        let fallen = now.level <= 10f64.powf(-self.stop.orders) * self.place.first;
        match self.place.sought >= 1.0 {
            true => fallen && now.level <= self.stop.tolerance * size,
            false => fallen || now.level <= ROUGH * size,
        }
    }

    /// The part that was sought is reached.
    fn passed(&mut self) {
        let place = &mut self.place;
        let step = place.sought - place.reached;
        (place.reached, place.within) = (place.sought, 0);
        place.sought = (place.reached + 2.0 * step).min(1.0);
        place.last_good.copy_from_slice(&place.u);
    }

    /// Back to what was reached, to seek less.
    fn retreat(&mut self, fault: Option<String>) -> Result<Told, NotFound> {
        let place = &mut self.place;
        let step = 0.5 * (place.sought - place.reached);
        place.u.copy_from_slice(&place.last_good);
        place.halved += 1;
        place.within = 0;
        if step < LEAST_LOAD {
            // a later run tries all of it at once
            place.sought = 1.0;
            return Err(NotFound::Stuck { reached: place.reached, iterations: place.iterations, fault });
        }
        place.sought = place.reached + step;
        Ok(Told { residual: 1.0, taken: 0.0 })
    }

    /// True where a part of the load has had its iterations.
    fn is_late(&self) -> bool {
        self.place.within >= MOST
    }

    /// One iteration, or a step back where there were too many for a part of the load.
    pub fn step(&mut self) -> Result<Told, NotFound> {
        if self.is_late() { self.retreat(None) } else { self.advance() }
    }
}

/// Root mean square.
fn rms(x: &[f64]) -> f64 {
    (dot(x, x) / x.len().max(1) as f64).sqrt()
}
