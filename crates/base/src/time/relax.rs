//! Relaxation to a steady state, R(u) = 0.
//!
//! Newton's method in pseudo time, (1/Δτ + J) δu = R(u) with J = −∂R/∂u and a local time step Δτ = CFL/rate for each
//! particle. The product J v is a difference of residuals. GMRES solves the linear system, preconditioned by multilevel
//! sweeps over the first-order linearisation (Knoll and Keyes 2004). The Courant number follows the residual (Mulder
//! and van Leer 1985). A step that leads to an unphysical state or to a jump of the residual is rejected and repeated
//! with a smaller Courant number. If the preconditioner alone replaces the linear solve, this is the LU-SGS method;
//! without either, it is the explicit Runge-Kutta method with local time steps.
mod line_search;
mod newton;

use std::sync::Arc;

use newton::sweep_fields;

use super::control::{Control, Method, Phase};
use super::formula::Formula;
use super::norm::{norm, weigh};
use super::preconditioning::Preconditioning;
use super::{Cost, Integrator, Mark, Memory, Standing, Step, TimeError};
use crate::math::krylov::Gmres;
use crate::math::parallel::{sweep, sweep_rows};
use crate::math::reduce::largest;
use crate::system::{Fault, Hierarchy, Implicit, Instant, Reach, Shift, placed, rows};

/// Ratio of the residual to its first value below which the flow pattern is regarded as developed, so that Newton's
/// method can begin.
const SETTLED: f64 = 3e-3;
/// Ratio of the residual to its first value below which the phase of sweeps alone ends as soon as they increase the
/// residual by more than [`WORN_RISE`]. Near the solution, the first-order operator overshoots, and each further sweep
/// makes the state worse.
const NEAR: f64 = 2e-2;
const WORN_RISE: f64 = 1.5;
/// Number of iterations without a new minimum of the residual after which the flow pattern is regarded as developed.
const PATIENCE: u32 = 10;
/// Ratio of the residual after a step of sweeps alone to the minimum before it, above which sweeps at their maximum
/// Courant number are regarded as too slow.
const SLOW: f64 = 0.93;
/// Minimum number of iterations of sweeps alone before iterations without progress are counted.
const SHORTEST_START: u32 = 20;
/// Courant number below which Newton's method is suspended and sweeps alone continue.
const LOST_CFL: f64 = 5.0;
/// Courant number at the start of either phase.
const RESTART_CFL: f64 = 20.0;
/// Maximum Courant number of sweeps alone.
const START_CFL_MAX: f64 = 200.0;
/// Courant number below which the relaxation stops with an error.
const SMALLEST_CFL: f64 = 1e-3;
/// Minimum fraction of a step that is accepted.
const SMALLEST_FRACTION: f64 = 0.05;
/// Courant number of the explicit method.
const EXPLICIT_CFL: f64 = 1.5;
/// Scaled residual at round-off level: a relative change of the density within one local time.
const ROUND_OFF: f64 = 1e-15;
/// Scaled initial residual at the round-off level of the sums over neighbours: the initial state is already steady.
const STEADY_ALREADY: f64 = 1e-13;
/// Ratio of the initial Courant number of Newton's method in a time step to that of a steady flow. It is large because
/// the initial guess is good and the time derivative acts like a pseudo-time term.
const STEP_CFL: f64 = 1000.0;
/// Number of unknowns above which GMRES stores fewer basis vectors, and that number of vectors. For large systems the
/// basis determines the peak of memory, and a less exact solution of a Newton step also needs fewer products.
const LARGE: usize = 1 << 22;
const LARGE_BASIS: usize = 14;
/// Stage coefficients of the explicit method.
const STAGES: [f64; 5] = [0.25, 1.0 / 6.0, 0.375, 0.5, 1.0];

/// A relaxation in progress.
pub struct Relax<'a, S: Implicit> {
    system: &'a S,
    control: Control,
    /// Number of iterations done.
    pub iteration: u32,
    /// Courant number of the next step.
    pub cfl: f64,
    /// Norm of the first residual.
    pub first_norm: f64,
    /// Norm of the latest residual.
    pub norm: f64,
    /// Current state u.
    pub u: Vec<f64>,
    frame: S::Frame,
    /// Additional frame for trial states, if frames depend on the state.
    beside: Option<S::Frame>,
    work: S::Work,
    residual: Vec<f64>,
    trial: Vec<f64>,
    trial_residual: Vec<f64>,
    /// Local time scale of each row, weighted so that all fields contribute equally.
    scale: Arc<[f64]>,
    rate: Vec<f64>,
    step: Vec<f64>,
    phase: Phase,
    preconditioning: Option<Preconditioning<S::Preconditioner>>,
    gmres: Option<Gmres>,
    time: Option<TimeTerm>,
    /// Ratio of the residual to its first value at which the relaxation or the time step ends.
    pub goal: f64,
    /// Total number of linear iterations.
    pub linear: u32,
    /// Total number of evaluations of the residual.
    pub evaluations: u64,
}

/// Difference formula of ∂U/∂t, c·U + rest, which a time step adds to the relaxed equations.
#[derive(Clone, Debug)]
pub struct TimeTerm {
    /// Difference formula, with the coordinates of bodies at its times.
    pub formula: Formula,
    /// Contribution of the earlier states to ∂U/∂t.
    pub rest: Vec<f64>,
}

impl TimeTerm {
    /// Coefficient c of the new state.
    fn rate(&self) -> f64 {
        self.formula.coefficient(0)
    }
}

/// Data that an interrupted relaxation needs to continue with identical results.
#[derive(Clone, Debug)]
pub struct Resume {
    /// Number of iterations done.
    pub iteration: u32,
    /// Courant number of the next step.
    pub cfl: f64,
    /// Number of linear iterations done.
    pub linear: u32,
    /// Phase of the relaxation.
    pub phase: Phase,
    /// Local time scales of the rows, with which the residual is normalised.
    pub scale: Arc<[f64]>,
}

impl<S: Implicit> Integrator<S> for Relax<'_, S> {
    fn advance(&mut self) -> Result<Step, TimeError> {
        Relax::advance(self)
    }

    /// True if the goal is reached. A given initial state is relaxed at least once, unless its residual is at
    /// round-off.
    fn finished(&self) -> bool {
        self.iteration > 0 && (self.drop() <= self.goal || self.began_steady() && self.norm <= STEADY_ALREADY)
    }

    fn mark(&self) -> Mark {
        Mark { iteration: self.iteration, residual: self.drop(), resting: self.resting(), ..Mark::default() }
    }

    fn standing(&mut self) -> Standing<'_, S> {
        Standing { system: self.system, frame: &self.frame, work: &mut self.work, state: &self.u }
    }

    fn memory(&self) -> Memory {
        Memory::Relaxation(self.resume())
    }

    fn cost(&self) -> Cost {
        let (evaluations, linear, bytes) = (self.evaluations, self.linear, self.bytes());
        Cost { evaluations, linear, bytes, ..Cost::default() }
    }
}

impl<'a, S: Implicit> Relax<'a, S> {
    /// Starts from the state `u`, or continues from `resume`. The residual is normalised by that of the state `origin`
    /// (the free stream), so that a good initial guess starts with a small relative residual.
    pub fn new(system: &'a S, control: Control, u: Vec<f64>, origin: &[f64], resume: Option<Resume>) -> Self {
        let n = u.len();
        let mut work = system.work();
        let frame = system.frame(&Instant::still(0.0).with(&system.placing().values(origin)), origin);
        let mut rate = vec![0.0; rows(system.fields())];
        system.rates(&frame, origin, &mut work, &mut rate);
        let implicit = control.method != Method::RungeKutta;
        let hierarchy = Hierarchy { group: control.group, cycle: control.cycle };
        let preconditioning = implicit.then(|| Preconditioning::new(system.preconditioner(&hierarchy, None)));
        let most = if n > LARGE { control.basis.min(LARGE_BASIS) } else { control.basis };
        let basis = (control.method == Method::NewtonKrylov).then(|| Gmres::new(n, most));
        let scale = match &resume {
            Some(r) => Arc::clone(&r.scale),
            None => rate.iter().map(|r| 1.0 / r).collect(),
        };
        let mut all = Self {
            system,
            control,
            frame,
            beside: None,
            work,
            rate,
            scale,
            u,
            preconditioning,
            iteration: resume.as_ref().map_or(0, |r| r.iteration),
            cfl: resume.as_ref().map_or(control.cfl, |r| r.cfl),
            linear: resume.as_ref().map_or(0, |r| r.linear),
            phase: resume.as_ref().map_or(Phase::default(), |r| r.phase),
            first_norm: 0.0,
            norm: 0.0,
            residual: vec![0.0; n],
            trial: vec![0.0; n],
            trial_residual: vec![0.0; n],
            step: vec![0.0; n],
            gmres: basis,
            time: None,
            goal: 0.0,
            evaluations: 0,
        };
        all.measure_from(origin, resume.is_some());
        all
    }

    /// Evaluates the residual of the state and that of `origin`, by which it is normalised. A continued relaxation
    /// (`goes_on`) uses the stored time scales of the rows and recomputes everything else.
    fn measure_from(&mut self, origin: &[f64], goes_on: bool) {
        let system = self.system;
        system.rhs(&self.frame, origin, &mut self.work, &mut self.trial_residual);
        if self.moves() {
            system.place(&Instant::still(0.0).with(&system.placing().values(&self.u)), &mut self.frame);
        }
        system.rhs(&self.frame, &self.u, &mut self.work, &mut self.residual);
        if !goes_on {
            // the residual of a structure in the free stream is no measure of its size: each field is measured in its
            // own units
            weigh(system.fields(), Arc::make_mut(&mut self.scale), &[]);
        }
        self.first_norm = self.norm_of(&self.trial_residual).max(f64::MIN_POSITIVE);
        self.norm = self.norm_of(&self.residual);
    }

    /// True if frames depend on the state.
    fn moves(&self) -> bool {
        !self.system.placing().is_empty()
    }

    /// Moves the frame to the instant `at`.
    pub fn set_frame(&mut self, at: &Instant<'_>) {
        self.system.place(at, &mut self.frame);
    }

    /// Plans the next displacement of Lagrangian particles; see
    /// [`plan_lagrangian_step`](crate::system::System::plan_lagrangian_step).
    pub fn plan_lagrangian_step(&mut self, step: f64) -> f64 {
        self.system.plan_lagrangian_step(step, &self.u, &mut self.work, &mut self.frame)
    }

    /// Returns an error if the positions of particles have made the cloud unusable.
    pub fn check_frame(&self) -> Result<(), Fault> {
        self.system.check_frame(&self.frame)
    }

    /// Maximum relative change of density and pressure from the state `before` to the current state.
    pub fn changed_since(&mut self, before: &[f64]) -> f64 {
        let u = &self.u;
        sweep(&mut self.trial, |k| u[k] - before[k]);
        self.system.largest_change(before, &self.trial)
    }

    /// Updates the internal variables of materials after an accepted step.
    pub fn settle(&mut self) {
        self.system.settle(&self.frame, &mut self.work, &mut self.u);
    }

    /// True if the state `u` is physical.
    pub fn is_sound(&self, u: &[f64]) -> bool {
        self.system.check(&self.frame, u).is_ok()
    }

    /// Range of coupling of the linear systems of time steps.
    pub fn reach(&self) -> Reach {
        self.preconditioning.as_ref().map_or(Reach::Near, |p| p.reach)
    }

    /// Sets the range of coupling of the linear systems of time steps.
    pub fn set_reach(&mut self, reach: Reach) {
        if let Some(p) = self.preconditioning.as_mut() {
            p.reach = reach;
        }
    }

    /// Builds the preconditioner of time steps from the state `u`, the frame at `at` and the coefficient `rate` of the
    /// new state. It depends on these alone, so that a resumed run can rebuild it.
    pub fn prepare_at(&mut self, at: &Instant<'_>, u: &[f64], rate: f64) {
        let Some(preconditioning) = self.preconditioning.as_mut() else { return };
        preconditioning.drop();
        if self.control.method != Method::NewtonKrylov || preconditioning.reach == Reach::Far {
            return;
        }
        self.system.place(at, &mut self.frame);
        self.system.rates(&self.frame, u, &mut self.work, &mut self.rate);
        let cfl = (STEP_CFL * self.control.cfl).min(self.control.cfl_max);
        let shift = Shift { rates: &self.rate, cfl, coefficient: rate, reach: Reach::Near };
        preconditioning.make_ahead(self.system, (&self.frame, u), &mut self.work, &shift);
    }

    /// Discards the preconditioner, so that the next iteration builds a new one.
    pub fn drop_preconditioner(&mut self) {
        if let Some(p) = self.preconditioning.as_mut() {
            p.drop();
        }
    }

    /// True while the preconditioner of [`Self::prepare_at`] remains in use.
    pub fn still_serves(&self) -> bool {
        self.preconditioning.as_ref().is_some_and(Preconditioning::still_serves)
    }

    /// Storage for [`TimeTerm::rest`], reused from the step before.
    pub fn spare_rest(&mut self) -> Vec<f64> {
        self.time.take().map_or_else(|| vec![0.0; self.u.len()], |term| term.rest)
    }

    /// Starts a time step: solves R(U) − c·U − rest = 0 at the end of the step from the initial guess in `u`.
    ///
    /// The residual is normalised by the norm of ∂U/∂t, or by its own initial value if that is larger. The
    /// preconditioner of [`Self::prepare_at`] remains in use.
    pub fn begin_step(&mut self, term: TimeTerm) {
        let (system, placing) = (self.system, self.system.placing());
        system.prescribe(term.formula.time(), &mut self.u);
        term.formula.at(&placing.values(&self.u), |at| system.place(at, &mut self.frame));
        system.rhs(&self.frame, &self.u, &mut self.work, &mut self.residual);
        system.rates(&self.frame, &self.u, &mut self.work, &mut self.rate);
        let (rate, coefficient) = (&self.rate, term.rate());
        sweep(Arc::make_mut(&mut self.scale), |i| 1.0 / (rate[i] + coefficient));
        self.evaluations += 1;
        let u = &self.u;
        sweep(&mut self.trial, |k| coefficient * u[k] + term.rest[k]);
        let trial = &self.trial;
        sweep_rows(&mut self.residual, 1, |k, r| r[0] -= trial[k]);
        weigh(system.fields(), Arc::make_mut(&mut self.scale), &[&self.trial, &self.residual]);
        let change = self.norm_of(&self.trial);
        self.norm = self.norm_of(&self.residual);
        self.first_norm = self.norm.max(change).max(f64::MIN_POSITIVE);
        let newton = self.control.method == Method::NewtonKrylov;
        let start = if newton { STEP_CFL * self.control.cfl } else { self.control.cfl };
        self.cfl = start.min(self.control.cfl_max);
        self.iteration = 0;
        if let Some(p) = self.preconditioning.as_mut() {
            p.begin_step();
        }
        self.phase = Phase { newton, ..Phase::default() };
        self.time = Some(term);
    }

    /// Starts Newton's method at once, at its initial Courant number, because the state is near a solution.
    pub fn begin_with_newton(&mut self) {
        self.phase = Phase { newton: true, ..Phase::default() };
    }

    /// Final frame, working storage and state; releases all other storage.
    pub fn into_end(self) -> (S::Frame, S::Work, Vec<f64>) {
        (self.frame, self.work, self.u)
    }

    /// Data, beside the state, from which a later run continues with identical results.
    pub fn resume(&self) -> Resume {
        Resume {
            iteration: self.iteration,
            cfl: self.cfl,
            linear: self.linear,
            phase: self.phase,
            scale: Arc::clone(&self.scale),
        }
    }

    /// Number of Newton iterations on a steady state since the last minimum of the residual.
    pub fn resting(&self) -> u32 {
        if self.phase.newton { self.phase.age - self.phase.best_age } else { 0 }
    }

    /// Ratio of the residual to its first value.
    pub fn drop(&self) -> f64 {
        self.norm / self.first_norm
    }

    /// True if the first residual is at round-off: the initial state is a steady flow, and nothing has to converge.
    pub fn began_steady(&self) -> bool {
        self.first_norm <= STEADY_ALREADY
    }

    /// Residual R(u) of the last accepted state.
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// True if the residual, relative to its first value, is at round-off, so that it cannot decrease further.
    pub fn settled(&self) -> bool {
        self.norm <= ROUND_OFF
    }

    /// Memory of the implicit solver (bytes).
    pub fn bytes(&self) -> usize {
        8 * (5 * self.u.len() + 2 * self.rate.len())
            + self.preconditioning.as_ref().map_or(0, Preconditioning::bytes::<S>)
            + self.gmres.as_ref().map_or(0, Gmres::bytes)
    }

    /// Root mean square over the rows of the residual `r` times the local time.
    fn norm_of(&self, r: &[f64]) -> f64 {
        norm(self.system.fields(), r, &self.scale)
    }

    /// Computes one accepted step; an error means that no step was accepted.
    pub fn advance(&mut self) -> Result<Step, TimeError> {
        self.iteration += 1;
        loop {
            if self.control.method == Method::RungeKutta {
                self.explicit_step()
            } else {
                self.implicit_step()
            }
            let fraction = self.fraction();
            if fraction > SMALLEST_FRACTION && self.search(fraction) {
                break;
            }
            self.cfl *= 0.2;
            self.give_up_preconditioner();
            if self.cfl < SMALLEST_CFL {
                return Err(self.stalled());
            }
        }
        self.choose_phase();
        Ok(Step { iteration: self.iteration, time: 0.0, cfl: self.cfl, residual: self.drop(), linear: self.linear })
    }

    fn give_up_preconditioner(&mut self) {
        if let Some(p) = self.preconditioning.as_mut() {
            p.give_up();
        }
    }

    /// Error for a relaxation that cannot continue.
    pub fn stalled(&self) -> TimeError {
        TimeError::Stalled { iteration: self.iteration, cfl: self.cfl, place: self.worst() }
    }

    /// Changes to Newton's method when the flow pattern has developed, and back to sweeps alone when Newton steps
    /// become small.
    ///
    /// While shocks move, the linearisation of the second-order scheme is indefinite and Newton's method makes little
    /// progress, but the first-order operator still moves the shocks. Near the solution the opposite holds.
    fn choose_phase(&mut self) {
        if self.control.method != Method::NewtonKrylov || self.time.is_some() {
            return;
        }
        let (drop, fastest) = (self.drop(), self.cfl >= self.largest_cfl());
        let phase = &mut self.phase;
        phase.age += 1;
        let slow = fastest && self.norm > SLOW * phase.best;
        if self.norm < 0.98 * phase.best {
            (phase.best, phase.best_age) = (self.norm, phase.age);
        }
        let worn = phase.best < NEAR * self.first_norm && self.norm > WORN_RISE * phase.best;
        let rests = slow || phase.age > phase.best_age + PATIENCE;
        let settled = drop < SETTLED || worn || (rests && phase.age > SHORTEST_START);
        let lost = phase.newton && self.cfl < LOST_CFL && phase.age > SHORTEST_START;
        if (!phase.newton && settled) || lost {
            *phase = Phase { newton: !phase.newton, age: 0, best: self.norm, best_age: 0 };
            self.cfl = self.cfl.clamp(RESTART_CFL, START_CFL_MAX);
        }
    }

    fn explicit_step(&mut self) {
        self.system.rates(&self.frame, &self.u, &mut self.work, &mut self.rate);
        self.trial_residual.copy_from_slice(&self.residual);
        for (k, stage) in STAGES.iter().enumerate() {
            let (rate, u, r) = (&self.rate, &self.u, &self.trial_residual);
            let cfl = EXPLICIT_CFL.min(self.cfl);
            sweep_fields(self.system, &mut self.step, |i, at, step| {
                let length = stage * cfl / rate[i];
                step.iter_mut().zip(&r[at..]).for_each(|(step, r)| *step = length * r);
            });
            if k + 1 < STAGES.len() {
                let step = &self.step;
                sweep(&mut self.trial, |k| u[k] + step[k]);
                self.system.rhs(&self.frame, &self.trial, &mut self.work, &mut self.trial_residual);
                self.evaluations += 1;
            }
        }
    }

    /// Location of the maximum residual: a particle with its position, or a row of another field.
    pub fn worst(&self) -> String {
        let (mut worst, mut whose) = ((0, -1.0), String::new());
        for at in placed(self.system.fields()) {
            let (n, r, scale) = (at.field.block, &self.residual[at.unknowns], &self.scale[at.rows.clone()]);
            let size = |i: usize| r[i * n..(i + 1) * n].iter().map(|r| r.abs() * scale[i]).reduce(f64::max);
            let found = largest(at.field.rows, |i| size(i).unwrap_or(0.0));
            if let Some((i, size)) = found.filter(|(_, size)| *size > worst.1) {
                worst = (at.rows.start + i, size);
                whose = format!("row {i} of the {}", at.field.name);
            }
        }
        let place = self.system.locate(&self.frame, worst.0);
        let place: Vec<String> = place.iter().map(|c| format!("{c:.5}")).collect();
        if place.is_empty() { whose } else { format!("particle {} at ({})", worst.0, place.join(", ")) }
    }
}
