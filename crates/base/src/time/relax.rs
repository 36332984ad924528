//! Relaxation to a steady state, R(u) = 0.
//!
//! Newton's method on the pseudo-time step (1/Δτ + J) δu = R(u), J = −∂R/∂u, with Δτ = CFL/rate particle by particle. J v is
//! a difference of residuals; GMRES solves, preconditioned by sweeps over the first-order linearisation on a hierarchy of
//! levels (Knoll and Keyes 2004). The Courant number follows the residual (Mulder and van Leer 1985). Steps that make a
//! state unphysical or the residual jump are taken back and tried again with a smaller one. The same loop with the linear
//! solve replaced by the sweeps alone is the LU-SGS method; with neither it is explicit Runge-Kutta with local steps.
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

/// Drop of the residual below which the flow counts as settled.
const SETTLED: f64 = 3e-3;
/// Drop of the residual after which sweeps alone are over as soon as they make it grow by more than [`WORN_RISE`]: near the solution
/// the first-order operator overshoots, and leaves a worse state the longer it goes on.
const NEAR: f64 = 2e-2;
const WORN_RISE: f64 = 1.5;
/// Iterations without a new smallest residual after which the flow counts as settled.
const PATIENCE: u32 = 10;
/// Residual after a step of sweeps alone over the smallest before it, beyond which they are too slow at their greatest Courant number.
const SLOW: f64 = 0.93;
/// Fewest iterations of sweeps alone before patience is counted.
const SHORTEST_START: u32 = 20;
/// Courant number below which Newton's method is given up for a while.
const LOST_CFL: f64 = 5.0;
/// Courant number with which either phase begins.
const RESTART_CFL: f64 = 20.0;
/// Greatest Courant number of sweeps alone.
const START_CFL_MAX: f64 = 200.0;
/// Courant number below which the relaxation gives up.
const SMALLEST_CFL: f64 = 1e-3;
/// Smallest fraction of a step that is worth taking.
const SMALLEST_FRACTION: f64 = 0.05;
/// Courant number of the explicit method.
const EXPLICIT_CFL: f64 = 1.5;
/// Scaled residual that is round-off: a relative change of the density in one local time.
const ROUND_OFF: f64 = 1e-15;
/// Scaled first residual that is round-off of the sums over neighbours: no flow is sought from there.
const STEADY_ALREADY: f64 = 1e-13;
/// Courant number of Newton's method at the start of a step in time over that of a steady flow: the guess is good, and the
/// term of time is a pseudo time of its own.
const STEP_CFL: f64 = 1000.0;
/// Unknowns beyond which GMRES keeps fewer basis vectors, and how many: those of large systems are the peak of memory, and a Newton
/// step that is solved less far costs fewer products too.
const LARGE: usize = 1 << 22;
const LARGE_BASIS: usize = 14;
/// Stages of the explicit method.
const STAGES: [f64; 5] = [0.25, 1.0 / 6.0, 0.375, 0.5, 1.0];

/// A relaxation in progress.
pub struct Relax<'a, S: Implicit> {
    system: &'a S,
    control: Control,
    /// Iterations done.
    pub iteration: u32,
    /// Courant number of the next step.
    pub cfl: f64,
    /// Size of the first residual.
    pub first_norm: f64,
    /// Size of the last residual.
    pub norm: f64,
    /// State.
    pub u: Vec<f64>,
    frame: S::Frame,
    /// Frame beside that of the state, where frames depend on the state.
    beside: Option<S::Frame>,
    work: S::Work,
    residual: Vec<f64>,
    trial: Vec<f64>,
    trial_residual: Vec<f64>,
    /// Local time of each row, weighted so that all fields count alike.
    scale: Arc<[f64]>,
    rate: Vec<f64>,
    step: Vec<f64>,
    phase: Phase,
    preconditioning: Option<Preconditioning<S::Preconditioner>>,
    gmres: Option<Gmres>,
    time: Option<TimeTerm>,
    /// Residual over its first value that the relaxation, or the step in time, is after.
    pub goal: f64,
    /// Linear iterations so far.
    pub linear: u32,
    /// Evaluations of the residual so far.
    pub evaluations: u64,
}

/// ∂U/∂t as a difference formula, c·U + rest: what a step in time adds to the equations that are relaxed.
#[derive(Clone, Debug)]
pub struct TimeTerm {
    /// The formula, with the coordinates of bodies at its times.
    pub formula: Formula,
    /// Contribution of the states before the one that is sought.
    pub rest: Vec<f64>,
}

impl TimeTerm {
    /// Coefficient of the state that is sought.
    fn rate(&self) -> f64 {
        self.formula.coefficient(0)
    }
}

/// What a relaxation needs to go on where it stopped.
#[derive(Clone, Debug)]
pub struct Resume {
    /// Iterations done.
    pub iteration: u32,
    /// Courant number.
    pub cfl: f64,
    /// Linear iterations done.
    pub linear: u32,
    /// Phase of the relaxation.
    pub phase: Phase,
    /// Time scales of the rows that the residual is measured with.
    pub scale: Arc<[f64]>,
}

impl<S: Implicit> Integrator<S> for Relax<'_, S> {
    fn advance(&mut self) -> Result<Step, TimeError> {
        Relax::advance(self)
    }

    /// A state that was handed over is relaxed once at least. Round-off falls no further.
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
    /// Starts from the state `u`, or goes on from `resume`. The residual is measured against that of the state `origin`
    /// (the free stream), so that a good guess counts for what it is worth.
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

    /// Finds the residual of the state and that of `origin`, which it is measured against: from the time scales of the rows if it goes on,
    /// so that nothing that was kept is to be believed.
    fn measure_from(&mut self, origin: &[f64], goes_on: bool) {
        let system = self.system;
        system.rhs(&self.frame, origin, &mut self.work, &mut self.trial_residual);
        if self.moves() {
            system.place(&Instant::still(0.0).with(&system.placing().values(&self.u)), &mut self.frame);
        }
        system.rhs(&self.frame, &self.u, &mut self.work, &mut self.residual);
        if !goes_on {
            // what the free stream does to a structure says nothing of its size: each field counts in its own units
            weigh(system.fields(), Arc::make_mut(&mut self.scale), &[]);
        }
        self.first_norm = self.norm_of(&self.trial_residual).max(f64::MIN_POSITIVE);
        self.norm = self.norm_of(&self.residual);
    }

    /// True when frames depend on the state.
    fn moves(&self) -> bool {
        !self.system.placing().is_empty()
    }

    /// Brings the frame to an instant.
    pub fn set_frame(&mut self, at: &Instant<'_>) {
        self.system.place(at, &mut self.frame);
    }

    /// Lets particles that travel choose where they go; see [`plan_lagrangian_step`](crate::system::System::plan_lagrangian_step).
    pub fn plan_lagrangian_step(&mut self, step: f64) -> f64 {
        self.system.plan_lagrangian_step(step, &self.u, &mut self.work, &mut self.frame)
    }

    /// Refuses a frame that puts particles where the cloud no longer serves.
    pub fn check_frame(&self) -> Result<(), Fault> {
        self.system.check_frame(&self.frame)
    }

    /// Largest relative change of density and pressure since the state was `before`.
    pub fn changed_since(&mut self, before: &[f64]) -> f64 {
        let u = &self.u;
        sweep(&mut self.trial, |k| u[k] - before[k]);
        self.system.largest_change(before, &self.trial)
    }

    /// Has what is remembered take in the step that the state has come from.
    pub fn settle(&mut self) {
        self.system.settle(&self.frame, &mut self.work, &mut self.u);
    }

    /// True when the state `u` is physical.
    pub fn is_sound(&self, u: &[f64]) -> bool {
        self.system.check(&self.frame, u).is_ok()
    }

    /// How far the linear systems of steps in time reach.
    pub fn reach(&self) -> Reach {
        self.preconditioning.as_ref().map_or(Reach::Near, |p| p.reach)
    }

    /// Says how far they reach.
    pub fn set_reach(&mut self, reach: Reach) {
        if let Some(p) = self.preconditioning.as_mut() {
            p.reach = reach;
        }
    }

    /// Makes the preconditioner of steps in time from the state `u` in the frame of `at` with the coefficient `rate` of the
    /// state that is sought: a function of these alone, so that a run that is resumed can make it again.
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

    /// Has the next iteration make its preconditioner.
    pub fn drop_preconditioner(&mut self) {
        if let Some(p) = self.preconditioning.as_mut() {
            p.drop();
        }
    }

    /// True while what [`Self::prepare_at`] made serves.
    pub fn still_serves(&self) -> bool {
        self.preconditioning.as_ref().is_some_and(Preconditioning::still_serves)
    }

    /// Storage for [`TimeTerm::rest`]: that of the step before.
    pub fn spare_rest(&mut self) -> Vec<f64> {
        self.time.take().map_or_else(|| vec![0.0; self.u.len()], |term| term.rest)
    }

    /// Turns to the equations of a step in time, R(U) − c·U − rest = 0 at the end of the step, from the guess in `u`.
    ///
    /// The residual is measured against the size of ∂U/∂t, or against itself at the guess if that is larger.
    ///
    /// What [`Self::prepare_at`] made goes on to serve.
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

    /// Goes on with Newton's method at once, at the Courant number that it begins with: the state is near a solution.
    pub fn begin_with_newton(&mut self) {
        self.phase = Phase { newton: true, ..Phase::default() };
    }

    /// Frame, storage and state at the end, without what was needed on the way.
    pub fn into_end(self) -> (S::Frame, S::Work, Vec<f64>) {
        (self.frame, self.work, self.u)
    }

    /// What a later run needs, beside the state, to go on to the same bits.
    pub fn resume(&self) -> Resume {
        Resume {
            iteration: self.iteration,
            cfl: self.cfl,
            linear: self.linear,
            phase: self.phase,
            scale: Arc::clone(&self.scale),
        }
    }

    /// Iterations of Newton's method on a steady state since the residual was last smallest.
    pub fn resting(&self) -> u32 {
        if self.phase.newton { self.phase.age - self.phase.best_age } else { 0 }
    }

    /// Residual over its first value.
    pub fn drop(&self) -> f64 {
        self.norm / self.first_norm
    }

    /// True where the first residual is round-off: the start is a steady flow, and there is nothing to converge.
    pub fn began_steady(&self) -> bool {
        self.first_norm <= STEADY_ALREADY
    }

    /// The residual R(u) of the last accepted state.
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Residual over its first value below which round-off rules: a state that does not change cannot do better.
    pub fn settled(&self) -> bool {
        self.norm <= ROUND_OFF
    }

    /// Bytes held by the implicit machinery.
    pub fn bytes(&self) -> usize {
        8 * (5 * self.u.len() + 2 * self.rate.len())
            + self.preconditioning.as_ref().map_or(0, Preconditioning::bytes::<S>)
            + self.gmres.as_ref().map_or(0, Gmres::bytes)
    }

    /// Root mean square over rows of the change that the residual would make in one local time.
    fn norm_of(&self, r: &[f64]) -> f64 {
        norm(self.system.fields(), r, &self.scale)
    }

    /// One accepted step.
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

    /// What to say where it cannot go on.
    pub fn stalled(&self) -> TimeError {
        TimeError::Stalled { iteration: self.iteration, cfl: self.cfl, place: self.worst() }
    }

    /// Newton's method once the flow has taken shape; back to sweeps alone when its steps become small.
    ///
    /// While shocks travel the linearisation of the second-order scheme is indefinite and Newton crawls, but the first-order
    /// operator still moves them; near the solution it is the other way round.
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

    /// Where the largest residual is: a particle and its place, or a row of another field.
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
