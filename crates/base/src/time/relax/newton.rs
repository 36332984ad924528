//! One step of a relaxation: the linear system (1/Δτ + c − ∂R/∂U) δU = R(U) − ∂U/∂t.
//!
//! Products with the matrix are differences of residuals (Knoll and Keyes 2004). If bodies move with the state, the
//! frame is displaced too, so that the product includes the effect of body motion on the gas. GMRES solves the system
//! only as accurately as Newton's method needs.
use super::super::preconditioning::Preconditioning;
use super::{Relax, TimeTerm};
use crate::math::krylov::{Gmres, Goal, Numbers, System as Linear};
use crate::math::parallel::{sweep, sweep_rows};
use crate::math::reduce::sum;
use crate::system::{Implicit, Instant, Reach, RightHandSide, Shift, System, placed};

/// Fraction of the remaining reduction of a time step (in orders of magnitude) that the next linear solve has to
/// achieve.
const SHARE: f64 = 0.6;
/// Minimum and maximum reduction of those solves: below the minimum, the nonlinear error of Newton's method dominates.
const REDUCTION: [f64; 2] = [0.04, 0.5];
/// Reduction of the linear solves of a steady flow while the residual does not fall: shocks are moving, and an exact
/// solution gains nothing.
const WANDERING: f64 = 0.3;

impl<S: Implicit> Relax<'_, S> {
    /// Range of coupling of the current linear system; a short time step couples neighbours only.
    fn system_reach(&self) -> Reach {
        if self.time.is_some() && self.phase.newton { self.reach() } else { Reach::Far }
    }

    /// Builds the preconditioner, unless the existing one of this time step remains in use.
    fn prepare(&mut self, preconditioning: &mut Preconditioning<S::Preconditioner>) {
        let kept = preconditioning.is_kept() && self.phase.newton;
        // at the initial guess of a time step, the rates are already computed
        if !kept && (self.time.is_none() || self.iteration > 1) {
            self.system.rates(&self.frame, &self.u, &mut self.work, &mut self.rate);
        }
        if !kept {
            let (reach, keep) = (self.system_reach(), self.time.is_some());
            let shift = shift((&self.rate, self.cfl), self.time.as_ref(), reach);
            preconditioning.make(self.system, (&self.frame, &self.u), &mut self.work, (&shift, keep));
        }
    }

    /// Computes a step of Newton's method, or of the preconditioner alone.
    pub(super) fn implicit_step(&mut self) {
        let reach = self.system_reach();
        let Some(mut preconditioning) = self.preconditioning.take() else { return };
        self.prepare(&mut preconditioning);
        match self.gmres.take() {
            Some(mut gmres) if self.phase.newton => {
                let iterations = self.newton_step(&mut gmres, &mut preconditioning, reach);
                preconditioning.served(reach, iterations);
                self.gmres = Some(gmres);
            }
            gmres => {
                let right = RightHandSide::Plain(&self.residual);
                preconditioning.apply(self.system, &self.frame, &right, &mut self.step);
                self.linear += 1;
                self.gmres = gmres;
            }
        }
        self.preconditioning = Some(preconditioning);
    }

    /// Reduction and maximum number of iterations of the next linear solve.
    fn asked(&self, reach: Reach) -> Goal {
        if self.time.is_none() {
            let wanders = self.norm > self.phase.best;
            let tolerance = if wanders { self.control.tolerance.max(WANDERING) } else { self.control.tolerance };
            return Goal { tolerance, most: usize::MAX };
        }
        let tolerance = (SHARE * self.goal / self.drop()).clamp(REDUCTION[0], REDUCTION[1]);
        Goal { tolerance, most: Preconditioning::<S::Preconditioner>::most(reach) }
    }

    /// Computes a step of Newton's method and returns its number of linear iterations.
    fn newton_step(
        &mut self,
        gmres: &mut Gmres,
        preconditioning: &mut Preconditioning<S::Preconditioner>,
        reach: Reach,
    ) -> usize {
        let goal = self.asked(reach);
        let size = (sum(self.u.len(), |k| self.u[k] * self.u[k]) / self.u.len() as f64).sqrt();
        let moves = self.moves();
        let mut beside = moves.then(|| self.beside.take().unwrap_or_else(|| self.frame.clone()));
        let (system, frame, work, u, residual) = (self.system, &self.frame, &mut self.work, &self.u, &self.residual);
        let (trial, scale, time) = (&mut self.trial, &*self.scale, self.time.as_ref());
        // rows are scaled by the local time, so that small particles do not dominate the norm
        sweep_fields(system, &mut self.trial_residual, |i, at, b| {
            b.iter_mut().zip(&residual[at..]).for_each(|(b, r)| *b = r * scale[i]);
        });
        let shift = shift((&self.rate, self.cfl), time, reach);
        let product = |v: &[f64], out: &mut [f64]| {
            let length = (sum(v.len(), |k| v[k] * v[k]) / v.len() as f64).sqrt();
            if length == 0.0 {
                return out.fill(0.0);
            }
            let eps = 1e-7 * (1.0 + size) / length;
            let inverse = 1.0 / eps;
            sweep(trial, |k| u[k] + eps * v[k]);
            if let Some(beside) = beside.as_mut() {
                put(system, time, trial, beside);
            }
            system.rhs(beside.as_ref().unwrap_or(frame), trial, work, out);
            // the residual includes the time term at u, which is equal on both sides; its change is part of the shift
            let base = |k: usize| residual[k] + time.map_or(0.0, |t| t.rate() * u[k] + t.rest[k]);
            sweep_fields(system, out, |i, at, out| {
                for (k, o) in (at..).zip(out) {
                    *o = ((base(k) - *o) * inverse + shift.of(i) * v[k]) * scale[i];
                }
            });
        };
        let precondition = |r: Numbers<'_>, z: &mut [f64]| {
            preconditioning.apply(system, frame, &RightHandSide::Scaled { values: r, scale }, z);
        };
        let linear = Linear { product, precondition };
        let solved = gmres.solve(&mut self.trial_residual, &mut self.step, goal, linear);
        self.beside = beside;
        self.linear += solved.iterations as u32;
        self.evaluations += solved.iterations as u64;
        solved.iterations
    }
}

/// Diagonal shift for rows with the given rates of change and Courant number.
pub(super) fn shift<'a>((rates, cfl): (&'a [f64], f64), time: Option<&TimeTerm>, reach: Reach) -> Shift<'a> {
    Shift { rates, cfl, coefficient: time.map_or(0.0, TimeTerm::rate), reach }
}

/// Moves the frame to the positions that the state `u` determines.
pub(super) fn put<S: System>(system: &S, time: Option<&TimeTerm>, u: &[f64], frame: &mut S::Frame) {
    let coordinates = &system.placing().values(u);
    match time {
        Some(term) => term.formula.at(coordinates, |at| system.place(at, frame)),
        None => system.place(&Instant::still(0.0).with(coordinates), frame),
    }
}

/// Calls `f` for every row of all fields, with the index of the row, the index of its first unknown, and its entries in
/// `out`.
pub(super) fn sweep_fields<S: System>(system: &S, out: &mut [f64], f: impl Fn(usize, usize, &mut [f64]) + Sync) {
    for at in placed(system.fields()) {
        let (row, unknown, n) = (at.rows.start, at.unknowns.start, at.field.block);
        sweep_rows(&mut out[at.unknowns], n, |i, out| f(row + i, unknown + i * n, out));
    }
}
