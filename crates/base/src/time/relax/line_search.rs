//! Line search: the accepted fraction of a step, and the Courant number of the next one.
use super::super::control::Method;
use super::newton::{put, shift, sweep_fields};
use super::{Relax, START_CFL_MAX};
use crate::math::parallel::{sweep, sweep_rows};
use crate::system::{Implicit, Reach};

/// Maximum deviation of the residual from the prediction of the linear system, relative to the residual before the
/// step, at which the Courant number still grows, and the minimum growth in this case. Near a flow that is steady but
/// unstable, the residual rises as predicted in pseudo time. Smaller steps would then only follow the instability in
/// time.
const TRUSTED: f64 = 0.5;
const TRUSTED_GROWTH: f64 = 1.5;
/// Maximum ratio of the residuals of successive steps while shocks move.
const START_JUMP: f64 = 4.0;
/// Maximum ratio of the residuals of successive Newton steps within a time step.
const NEWTON_JUMP: f64 = 1.1;
/// Maximum ratio of the residuals of successive Newton steps towards a steady flow. When a shock moves to the next row
/// of particles, the residual grows several times before it falls; with a smaller limit, steps would be cut at every
/// row.
const SHOCK_JUMP: f64 = 10.0;
/// Maximum ratio of the residuals of successive Newton steps around strong shocks: a bow shock at Mach 10 does not
/// recover from larger ones.
const STRONG_SHOCK_JUMP: f64 = 2.0;
/// Minimum growth of the Courant number after a full step towards a steady flow while the residual is above its
/// minimum, and around strong shocks. If the Courant number only grew when the residual falls, shocks would move as
/// slowly as in physical time.
const LEAST_GROWTH: f64 = 3.0;
const STRONG_SHOCK_GROWTH: f64 = 1.0;
/// Ratio of maximum to minimum pressure above which shocks may be strong: it is 3 to 6 around transonic aerofoils and
/// above 100 behind a bow shock at Mach 3.
const STRONG_SHOCKS: f64 = 10.0;
/// Minimum growth of the Courant number after a full Newton step within a time step.
const LEAST_GROWTH_IN_TIME: f64 = 0.5;
/// Number of step lengths that are tried before the Courant number is reduced: 1, 1/2, 1/4.
const SHORTER_STEPS: i32 = 3;
/// Maximum relative change of density and pressure in a step that is scaled as a whole.
const LARGEST_CHANGE: f64 = 0.3;
/// Maximum relative change of a particle in a step that is scaled row by row, and the maximum change of the unscaled
/// step for which this is done. Larger steps are scaled as a whole, because a strong shock does not remain a valid flow
/// if its rows are scaled separately.
const LARGEST_ROW_CHANGE: f64 = 0.5;
const MILD_CHANGE: f64 = 1.0;
/// Reduction factor of the residual in an iteration of a time step above which the preconditioner remains in use.
const GOOD_FALL: f64 = 2.0;

/// Limits of a line search.
#[derive(Clone, Copy)]
struct Search {
    /// Maximum ratio of the residual after a step to that before it.
    jump: f64,
    /// Minimum growth of the Courant number after a full Newton step.
    growth: f64,
}

impl<S: Implicit> Relax<'_, S> {
    /// Fraction of the step at which the changes of density and pressure stay within their limits. On the way to a
    /// steady flow, moderate steps are scaled row by row instead.
    pub(super) fn fraction(&mut self) -> f64 {
        let change = self.system.largest_change(&self.u, &self.step);
        if self.time.is_some() || !(change <= MILD_CHANGE) {
            return (LARGEST_CHANGE / change).min(1.0);
        }
        if change > LARGEST_ROW_CHANGE {
            self.system.shorten(&self.u, &mut self.step, LARGEST_ROW_CHANGE);
        }
        1.0
    }

    /// Applies the step times `fraction`, or a shorter one if Newton's method overshoots; false if no step was
    /// accepted.
    pub(super) fn search(&mut self, fraction: f64) -> bool {
        if !self.phase.newton {
            return self.accept(fraction, Search { jump: START_JUMP, growth: 1.0 });
        }
        let search = if self.time.is_some() {
            Search { jump: NEWTON_JUMP, growth: LEAST_GROWTH_IN_TIME }
        } else if self.system.contrast(&self.u) > STRONG_SHOCKS {
            Search { jump: STRONG_SHOCK_JUMP, growth: STRONG_SHOCK_GROWTH }
        } else {
            Search { jump: SHOCK_JUMP, growth: LEAST_GROWTH }
        };
        (0..SHORTER_STEPS).any(|k| self.accept(fraction * 0.5f64.powi(k), search))
    }

    /// Accepts the step times `fraction` if the new residual is at most `search.jump` times the old one, and sets the
    /// next Courant number.
    fn accept(&mut self, fraction: f64, search: Search) -> bool {
        let (u, step) = (&self.u, &self.step);
        sweep(&mut self.trial, |k| u[k] + fraction * step[k]);
        if self.system.check(&self.frame, &self.trial).is_err() {
            return false;
        }
        let beside = self.frame_of_trial();
        let frame = beside.as_ref().unwrap_or(&self.frame);
        self.system.rhs(frame, &self.trial, &mut self.work, &mut self.trial_residual);
        self.evaluations += 1;
        if let Some(term) = &self.time {
            let (trial, rate) = (&self.trial, term.rate());
            let change = |k: usize| rate * trial[k] + term.rest[k];
            sweep_rows(&mut self.trial_residual, 1, |k, r| r[0] -= change(k));
        }
        let norm = self.norm_of(&self.trial_residual);
        if !norm.is_finite() || norm > search.jump * self.norm {
            self.beside = beside.or(self.beside.take());
            return false;
        }
        if let Some(frame) = beside {
            self.beside = Some(std::mem::replace(&mut self.frame, frame));
        }
        std::mem::swap(&mut self.u, &mut self.trial);
        std::mem::swap(&mut self.residual, &mut self.trial_residual);
        let steady_newton = self.phase.newton && self.time.is_none();
        let trusted = steady_newton && fraction == 1.0 && self.model_error() < TRUSTED * self.norm;
        let wanders = steady_newton && norm > self.phase.best;
        let growth = if wanders { search.growth } else { search.growth.min(1.0) };
        let least = if trusted { growth.max(TRUSTED_GROWTH) } else { growth };
        self.cfl = self.next_cfl(fraction, self.norm / norm.max(f64::MIN_POSITIVE), least);
        if !(self.norm > GOOD_FALL * norm) {
            self.give_up_preconditioner();
        }
        self.norm = norm;
        true
    }

    /// Frame of the state in `trial`, if frames depend on the state.
    fn frame_of_trial(&mut self) -> Option<S::Frame> {
        if !self.moves() {
            return None;
        }
        let mut frame = self.beside.take().unwrap_or_else(|| self.frame.clone());
        put(self.system, self.time.as_ref(), &self.trial, &mut frame);
        Some(frame)
    }

    /// Norm of the difference between the residual after a full step and the prediction of the linear system, δu/Δτ.
    fn model_error(&mut self) -> f64 {
        let shift = shift((&self.rate, self.cfl), None, Reach::Far);
        let (residual, step) = (&self.residual, &self.step);
        sweep_fields(self.system, &mut self.trial, |i, at, out| {
            for (k, out) in (at..).zip(out) {
                *out = residual[k] - shift.of(i) * step[k];
            }
        });
        self.norm_of(&self.trial)
    }

    /// Courant number after an accepted step whose residual decreased by the factor `ratio`; after a full Newton step
    /// it grows at least by the factor `least`.
    fn next_cfl(&self, fraction: f64, ratio: f64, least: f64) -> f64 {
        let growth = self.control.growth;
        let factor = match (self.phase.newton, fraction == 1.0) {
            (true, true) => ratio.clamp(least, growth.max(least)),
            (true, false) => ratio.clamp(0.5, 1.0),
            (false, true) => {
                if ratio < 1.0 {
                    ratio.max(0.8)
                } else {
                    ratio.clamp(1.0 + 0.5 * (growth - 1.0), growth)
                }
            }
            (false, false) => ratio.clamp(0.8, 1.0),
        };
        (self.cfl * factor).min(self.largest_cfl())
    }

    pub(super) fn largest_cfl(&self) -> f64 {
        let start = self.control.method == Method::NewtonKrylov && !self.phase.newton;
        if start { self.control.cfl_max.min(START_CFL_MAX) } else { self.control.cfl_max }
    }
}
