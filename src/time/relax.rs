//! Relaxation to a steady state, R(u) = 0.
//!
//! Newton's method on the pseudo-time step (1/Δτ + J) δu = R(u), J = −∂R/∂u, with Δτ = CFL/rate particle by particle. J v is
//! a difference of residuals; GMRES solves, preconditioned by sweeps over the first-order linearisation on a hierarchy of
//! levels (Knoll and Keyes 2004). The Courant number follows the residual (Mulder and van Leer 1985). Steps that make a
//! state unphysical or the residual jump are taken back and tried again with a smaller one. The same loop with the linear
//! solve replaced by the sweeps alone is the LU-SGS method; with neither it is explicit Runge-Kutta with local steps.
use super::control::{Control, Method, Phase};
use super::{Step, TimeError};
use crate::math::block_matrix::BlockMatrix;
use crate::math::incomplete::Incomplete;
use crate::math::krylov::Gmres;
use crate::math::multilevel::Multilevel;
use crate::math::sweep::sum;
use crate::system::{Moment, System};

/// Drop of the residual below which the flow counts as settled.
const SETTLED: f64 = 3e-3;
/// Iterations without a new smallest residual after which the flow counts as settled.
const PATIENCE: u32 = 10;
/// Fewest iterations of sweeps alone before patience is counted.
const SHORTEST_START: u32 = 20;
/// Courant number below which Newton's method is given up for a while.
const LOST_CFL: f64 = 5.0;
/// Courant number with which either phase begins.
const RESTART_CFL: f64 = 20.0;
/// Greatest Courant number of sweeps alone.
const START_CFL_MAX: f64 = 200.0;
/// Largest ratio of residuals of successive steps while shocks travel.
const START_JUMP: f64 = 4.0;
/// Largest ratio of residuals of successive Newton steps.
const NEWTON_JUMP: f64 = 1.1;
/// Step lengths that are tried before the Courant number is lowered: 1, 1/2, 1/4.
const SHORTER_STEPS: i32 = 3;
/// Courant number below which the relaxation gives up.
const SMALLEST_CFL: f64 = 1e-3;
/// Largest relative change of density and pressure in one step.
const LARGEST_CHANGE: f64 = 0.3;
/// Smallest fraction of a step that is worth taking.
const SMALLEST_FRACTION: f64 = 0.05;
/// Courant number of the explicit method.
const EXPLICIT_CFL: f64 = 1.5;
/// Scaled residual that is round-off: a relative change of the density in one local time.
const ROUND_OFF: f64 = 1e-15;
/// Courant number of Newton's method at the start of a step in time over that of a steady flow: the guess is good, and the
/// term of time is a pseudo time of its own.
const STEP_CFL: f64 = 1000.0;
/// Part of the fall that a step in time still needs which its next linear solve is asked for.
const SHARE: f64 = 0.6;
/// Smallest and largest reduction asked of those solves: beyond the first, what Newton's method leaves is larger.
const REDUCTION: [f64; 2] = [0.04, 0.5];
/// Iterations after which a linear solve with the incomplete factorisation is given up: its step is taken, and those after
/// it use the levels.
const MOST_NARROW: usize = 16;
/// Iterations of a linear solve up to which its preconditioner goes on to serve in the next step.
const EASY: usize = 4;
/// Fall of the residual in an iteration of a step in time with which the preconditioner goes on to serve.
const GOOD_FALL: f64 = 2.0;
/// Stages of the explicit method.
const STAGES: [f64; 5] = [0.25, 1.0 / 6.0, 0.375, 0.5, 1.0];

/// A relaxation in progress.
pub struct Relax<'a, S: System> {
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
    work: S::Work,
    residual: Vec<f64>,
    trial: Vec<f64>,
    trial_residual: Vec<f64>,
    scale: Vec<f64>,
    rate: Vec<f64>,
    step: Vec<f64>,
    phase: Phase,
    levels: Option<Multilevel>,
    factors: Incomplete,
    gmres: Option<Gmres>,
    time: Option<TimeTerm>,
    /// The preconditioner was made for this step in time or one not long before, and still serves.
    prepared: bool,
    /// It was made within an iteration.
    remade: bool,
    /// Iterations of the longest linear solve of this step in time.
    longest: usize,
    /// Residual over its first value that the step in time is after.
    pub goal: f64,
    /// Linear systems of steps in time need the levels: the incomplete factorisation alone was too slow.
    pub broad: bool,
    /// Linear iterations so far.
    pub linear: u32,
    /// Evaluations of the residual so far.
    pub evaluations: u64,
}

/// ∂U/∂t as a difference formula, rate·U + rest: what a step in time adds to the equations that are relaxed.
#[derive(Clone, Debug)]
pub struct TimeTerm {
    /// Coefficient of the state that is sought.
    pub rate: f64,
    /// Contribution of the states before it.
    pub rest: Vec<f64>,
}

/// What a relaxation needs to go on where it stopped.
#[derive(Clone, Debug)]
pub struct Resume {
    /// Iterations done.
    pub iteration: u32,
    /// Courant number.
    pub cfl: f64,
    /// Size of the first residual.
    pub first_norm: f64,
    /// Linear iterations done.
    pub linear: u32,
    /// Phase of the relaxation.
    pub phase: Phase,
    /// Time scales of the particles that the residual is measured with.
    pub scale: Vec<f64>,
}

impl<'a, S: System> Relax<'a, S> {
    /// Starts from the state `u`, or goes on from `resume`. The residual is measured against that of the state `origin`
    /// (the free stream), so that a good guess counts for what it is worth.
    pub fn new(system: &'a S, control: Control, u: Vec<f64>, origin: &[f64], resume: Option<Resume>) -> Self {
        let n = u.len();
        let mut work = system.work();
        let frame = system.frame(&Moment::At { time: 0.0 }, origin);
        let mut rate = vec![0.0; n / system.block()];
        system.spectral_radius(&frame, origin, &mut work, &mut rate);
        let implicit = control.method != Method::RungeKutta;
        let times = system.in_time();
        let block = system.block() / times.map_or(1, |(t, _)| t.count());
        let levels = implicit.then(|| {
            let (first, index) = system.graph();
            let levels =
                Multilevel::new(BlockMatrix::new(block, system.parts(), first, index), control.group, control.cycle);
            match times {
                Some((instances, omega)) => levels.in_time(instances, omega),
                None => levels,
            }
        });
        let basis = (control.method == Method::NewtonKrylov).then(|| Gmres::new(n, control.basis));
        let scale = match &resume {
            Some(r) => r.scale.clone(),
            None => rate.iter().map(|r| 1.0 / r).collect(),
        };
        let mut all = Self {
            system,
            control,
            frame,
            work,
            rate,
            scale,
            u,
            levels,
            factors: Incomplete::default(),
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
            prepared: false,
            remade: false,
            longest: 0,
            goal: 0.0,
            broad: false,
            evaluations: 0,
        };
        if resume.is_none() {
            all.system.rhs(&all.frame, origin, &mut all.work, &mut all.residual);
        }
        all.first_norm = resume.map_or_else(|| all.norm_of(&all.residual).max(f64::MIN_POSITIVE), |r| r.first_norm);
        all.system.follow(&all.u, &mut all.work, &mut all.frame);
        all.system.rhs(&all.frame, &all.u, &mut all.work, &mut all.residual);
        all.norm = all.norm_of(&all.residual);
        all
    }

    /// Brings the frame to a moment.
    pub fn look(&mut self, moment: &Moment<'_>) {
        self.system.place(moment, &mut self.frame);
        self.system.follow(&self.u, &mut self.work, &mut self.frame);
    }

    /// Lets particles that follow the state choose where they go; see [`System::set_off`].
    pub fn set_off(&mut self, step: f64) -> f64 {
        self.system.set_off(step, &self.u, &mut self.work, &mut self.frame)
    }

    /// The first particle that the frame puts where the cloud no longer serves.
    pub fn misplaced(&self) -> Option<crate::system::Fault> {
        self.system.misplaced(&self.frame)
    }

    /// Largest relative change of density and pressure since the state was `before`.
    pub fn changed_since(&mut self, before: &[f64]) -> f64 {
        let u = &self.u;
        crate::math::sweep::sweep(&mut self.trial, |k| u[k] - before[k]);
        self.system.largest_change(before, &self.trial)
    }

    /// True when the state `u` is physical.
    pub fn is_sound(&self, u: &[f64]) -> bool {
        self.system.fault(&self.frame, u).is_none()
    }

    /// Makes the preconditioner of steps in time from the state `u` in the frame of `moment` with the coefficient `rate` of the
    /// state that is sought: a function of these alone, so that a run that is resumed can make it again.
    pub fn prepare_at(&mut self, moment: &Moment<'_>, u: &[f64], rate: f64) {
        self.drop_preconditioner();
        if self.control.method != Method::NewtonKrylov || self.broad {
            return;
        }
        let Some(levels) = self.levels.as_mut() else { return };
        self.system.place(moment, &mut self.frame);
        self.system.follow(u, &mut self.work, &mut self.frame);
        self.system.spectral_radius(&self.frame, u, &mut self.work, &mut self.rate);
        let cfl = (STEP_CFL * self.control.cfl).min(self.control.cfl_max);
        let shift: Vec<f64> = self.rate.iter().map(|r| r / cfl + rate).collect();
        self.system.linearise(&self.frame, u, &mut self.work, levels.finest());
        levels.finest().shift(&shift);
        self.factors.factor(levels.finest());
        self.prepared = true;
    }

    /// Has the next iteration make its preconditioner.
    pub fn drop_preconditioner(&mut self) {
        (self.prepared, self.remade) = (false, false);
    }

    /// True while what [`Self::prepare_at`] made serves.
    pub fn still_serves(&self) -> bool {
        self.prepared && !self.remade && self.longest <= EASY
    }

    /// Turns to the equations of a step in time, R(U) − rate·U − rest = 0 in the frame of `moment`, from the guess in `u`.
    ///
    /// The residual is measured against the size of ∂U/∂t, or against itself at the guess if that is larger.
    ///
    /// What [`Self::prepare_at`] made goes on to serve.
    pub fn begin_step(&mut self, moment: &Moment<'_>, term: TimeTerm) {
        self.system.place(moment, &mut self.frame);
        self.system.follow(&self.u, &mut self.work, &mut self.frame);
        self.system.spectral_radius(&self.frame, &self.u, &mut self.work, &mut self.rate);
        let rate = &self.rate;
        crate::math::sweep::sweep(&mut self.scale, |i| 1.0 / (rate[i] + term.rate));
        self.system.rhs(&self.frame, &self.u, &mut self.work, &mut self.residual);
        self.evaluations += 1;
        let u = &self.u;
        crate::math::sweep::sweep(&mut self.trial, |k| term.rate * u[k] + term.rest[k]);
        let change = self.norm_of(&self.trial);
        let trial = &self.trial;
        crate::math::sweep::sweep_rows(&mut self.residual, 1, |k, r| r[0] -= trial[k]);
        self.norm = self.norm_of(&self.residual);
        self.first_norm = self.norm.max(change).max(f64::MIN_POSITIVE);
        let newton = self.control.method == Method::NewtonKrylov;
        let start = if newton { STEP_CFL * self.control.cfl } else { self.control.cfl };
        self.cfl = start.min(self.control.cfl_max);
        (self.iteration, self.longest) = (0, 0);
        self.phase = Phase { newton, ..Phase::default() };
        self.time = Some(term);
    }

    /// What a later run needs, beside the state, to go on to the same bits.
    pub fn resume(&self) -> Resume {
        Resume {
            iteration: self.iteration,
            cfl: self.cfl,
            first_norm: self.first_norm,
            linear: self.linear,
            phase: self.phase,
            scale: self.scale.clone(),
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

    /// Frame, storage and state, for those who watch.
    pub fn parts(&mut self) -> (&S::Frame, &mut S::Work, &[f64]) {
        (&self.frame, &mut self.work, &self.u)
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
            + self.levels.as_ref().map_or(0, Multilevel::bytes)
            + self.factors.bytes()
            + self.gmres.as_ref().map_or(0, Gmres::bytes)
    }

    /// Root mean square over particles of the change that the residual would make in one local time.
    fn norm_of(&self, r: &[f64]) -> f64 {
        let (n, scale) = (self.system.block(), &self.scale);
        let instances = self.system.in_time().map_or(1, |(t, _)| t.count());
        let (width, measured) = (n / instances, self.system.measured());
        let square = |i: usize| {
            let row = r[i * n..(i + 1) * n].chunks_exact(width);
            row.map(|r| r[..measured].iter().map(|r| r * r).sum::<f64>()).sum::<f64>()
        };
        let total = sum(scale.len(), |i| square(i) * scale[i].powi(2));
        (total / (scale.len() * instances) as f64).sqrt()
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
            let change = self.system.largest_change(&self.u, &self.step);
            let fraction = (LARGEST_CHANGE / change).min(1.0);
            if fraction > SMALLEST_FRACTION && self.search(fraction) {
                break;
            }
            self.cfl *= 0.2;
            self.prepared = false;
            if self.cfl < SMALLEST_CFL {
                return Err(self.stalled());
            }
        }
        self.choose_phase();
        Ok(Step { iteration: self.iteration, time: 0.0, cfl: self.cfl, residual: self.drop(), linear: self.linear })
    }

    /// What to say where it cannot go on.
    pub fn stalled(&self) -> TimeError {
        let (particle, place) = self.worst();
        TimeError::Stalled { iteration: self.iteration, cfl: self.cfl, particle, place }
    }

    /// Newton's method once the flow has taken shape; back to sweeps alone when its steps become small.
    ///
    /// While shocks travel the linearisation of the second-order scheme is indefinite and Newton crawls, but the first-order
    /// operator still moves them; near the solution it is the other way round.
    fn choose_phase(&mut self) {
        if self.control.method != Method::NewtonKrylov || self.time.is_some() {
            return;
        }
        let drop = self.drop();
        let phase = &mut self.phase;
        phase.age += 1;
        if self.norm < 0.98 * phase.best {
            (phase.best, phase.best_age) = (self.norm, phase.age);
        }
        let settled = drop < SETTLED || (phase.age > SHORTEST_START && phase.age > phase.best_age + PATIENCE);
        let lost = phase.newton && self.cfl < LOST_CFL && phase.age > SHORTEST_START;
        if (!phase.newton && settled) || lost {
            *phase = Phase { newton: !phase.newton, age: 0, best: self.norm, best_age: 0 };
            self.cfl = self.cfl.clamp(RESTART_CFL, START_CFL_MAX);
        }
    }

    /// Takes the step times `fraction`, or a shorter one when Newton's method overshoots.
    fn search(&mut self, fraction: f64) -> bool {
        if !self.phase.newton {
            return self.accept(fraction, START_JUMP);
        }
        (0..SHORTER_STEPS).any(|k| self.accept(fraction * 0.5f64.powi(k), NEWTON_JUMP))
    }

    /// Takes the step times `fraction` if the new residual is at most `jump` times the old one; sets the next Courant number.
    fn accept(&mut self, fraction: f64, jump: f64) -> bool {
        let (u, step) = (&self.u, &self.step);
        crate::math::sweep::sweep(&mut self.trial, |k| u[k] + fraction * step[k]);
        if self.system.fault(&self.frame, &self.trial).is_some() {
            return false;
        }
        let mut frame = self.frame.clone();
        self.system.follow(&self.trial, &mut self.work, &mut frame);
        self.system.rhs(&frame, &self.trial, &mut self.work, &mut self.trial_residual);
        self.evaluations += 1;
        if let Some(term) = &self.time {
            let trial = &self.trial;
            let change = |k: usize| term.rate * trial[k] + term.rest[k];
            crate::math::sweep::sweep_rows(&mut self.trial_residual, 1, |k, r| r[0] -= change(k));
        }
        let norm = self.norm_of(&self.trial_residual);
        if !norm.is_finite() || norm > jump * self.norm {
            return false;
        }
        self.frame = frame;
        std::mem::swap(&mut self.u, &mut self.trial);
        std::mem::swap(&mut self.residual, &mut self.trial_residual);
        self.cfl = self.next_cfl(fraction, self.norm / norm.max(f64::MIN_POSITIVE));
        self.prepared &= self.norm > GOOD_FALL * norm;
        self.norm = norm;
        true
    }

    /// The Courant number after an accepted step that divided the residual by `ratio`.
    fn next_cfl(&self, fraction: f64, ratio: f64) -> f64 {
        let growth = self.control.growth;
        let factor = match (self.phase.newton, fraction == 1.0) {
            (true, true) => ratio.clamp(0.5, growth),
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

    fn largest_cfl(&self) -> f64 {
        let start = self.control.method == Method::NewtonKrylov && !self.phase.newton;
        if start { self.control.cfl_max.min(START_CFL_MAX) } else { self.control.cfl_max }
    }

    /// True when linear systems are preconditioned with the incomplete factorisation: the term of time couples what is near.
    fn is_narrow(&self) -> bool {
        self.time.is_some() && self.phase.newton && !self.broad
    }

    /// Makes the preconditioner, unless that of this step in time still serves; what is added to the diagonal of each row.
    fn prepare(&mut self, levels: &mut Multilevel) -> Vec<f64> {
        let kept = self.prepared && self.phase.newton;
        // a step in time begins with the rates at its guess
        if !kept && (self.time.is_none() || self.iteration > 1) {
            self.system.spectral_radius(&self.frame, &self.u, &mut self.work, &mut self.rate);
        }
        let (rate, cfl) = (self.time.as_ref().map_or(0.0, |t| t.rate), self.cfl);
        let shift: Vec<f64> = self.rate.iter().map(|r| r / cfl + rate).collect();
        if !kept {
            self.system.linearise(&self.frame, &self.u, &mut self.work, levels.finest());
            levels.finest().shift(&shift);
            if self.is_narrow() {
                self.factors.factor(levels.finest());
            } else {
                levels.refresh();
            }
            (self.prepared, self.remade) = (self.time.is_some(), true);
        }
        shift
    }

    fn implicit_step(&mut self) {
        let Some(mut levels) = self.levels.take() else { return };
        let shift = self.prepare(&mut levels);
        self.solve(&mut levels, &shift);
        self.levels = Some(levels);
    }

    /// Reduction asked of a linear solve, and the greatest number of its iterations.
    fn asked(&self) -> (f64, usize) {
        if self.time.is_none() {
            return (self.control.tolerance, usize::MAX);
        }
        let reduction = (SHARE * self.goal / self.drop()).clamp(REDUCTION[0], REDUCTION[1]);
        (reduction, if self.is_narrow() { MOST_NARROW } else { usize::MAX })
    }

    /// The step of Newton's method, or that of the sweeps alone.
    fn solve(&mut self, levels: &mut Multilevel, shift: &[f64]) {
        let (n, narrow) = (self.system.block(), self.is_narrow());
        let (tolerance, most) = self.asked();
        let Some(gmres) = self.gmres.as_mut().filter(|_| self.phase.newton) else {
            let residual = &self.residual;
            let (system, frame) = (self.system, &self.frame);
            let right = |i: usize, row: &mut [f32]| {
                row.iter_mut().zip(&residual[i * n..]).for_each(|(row, r)| *row = *r as f32);
                system.inward(frame, row);
            };
            levels.apply(right, &mut self.step);
            crate::math::sweep::sweep_rows(&mut self.step, n, |_, row| system.outward(frame, row));
            self.linear += 1;
            return;
        };
        let size = (sum(self.u.len(), |k| self.u[k] * self.u[k]) / self.u.len() as f64).sqrt();
        let (system, frame, work, u, residual) = (self.system, &self.frame, &mut self.work, &self.u, &self.residual);
        let (trial, scale, time) = (&mut self.trial, &self.scale, self.time.as_ref());
        // rows are scaled by the local time, so that small particles do not rule the norm
        let b = &mut self.trial_residual;
        crate::math::sweep::sweep_rows(b, n, |i, b| {
            b.iter_mut().zip(&residual[i * n..]).for_each(|(b, r)| *b = r * scale[i]);
        });
        let product = |v: &[f64], out: &mut [f64]| {
            let length = (sum(v.len(), |k| v[k] * v[k]) / v.len() as f64).sqrt();
            if length == 0.0 {
                return out.fill(0.0);
            }
            let eps = 1e-7 * (1.0 + size) / length;
            let inverse = 1.0 / eps;
            crate::math::sweep::sweep(trial, |k| u[k] + eps * v[k]);
            system.rhs(frame, trial, work, out);
            // the residual holds the time term at u, which is the same in both; its change is in the shift
            let base = |k: usize| residual[k] + time.map_or(0.0, |t| t.rate * u[k] + t.rest[k]);
            crate::math::sweep::sweep_rows(out, n, |i, out| {
                for (k, o) in (i * n..).zip(out) {
                    *o = ((base(k) - *o) * inverse + shift[i] * v[k]) * scale[i];
                }
            });
        };
        let factors = &mut self.factors;
        let precondition = |r: &[f32], z: &mut [f64]| {
            let right = |i: usize, row: &mut [f32]| {
                row.iter_mut().zip(&r[i * n..]).for_each(|(row, r)| *row = (f64::from(*r) / scale[i]) as f32);
                system.inward(frame, row);
            };
            if narrow {
                factors.apply(levels.finest(), right, z)
            } else {
                levels.apply(right, z)
            }
            crate::math::sweep::sweep_rows(z, n, |_, row| system.outward(frame, row));
        };
        let solved = gmres.solve((b, &mut self.step), (tolerance, most), product, precondition);
        if narrow && solved.iterations == most {
            // one that was made for another step is first made anew
            (self.broad, self.prepared) = (self.remade, false);
        }
        self.longest = self.longest.max(solved.iterations);
        self.linear += solved.iterations as u32;
        self.evaluations += solved.iterations as u64;
    }

    fn explicit_step(&mut self) {
        self.system.spectral_radius(&self.frame, &self.u, &mut self.work, &mut self.rate);
        let n = self.system.block();
        self.trial_residual.copy_from_slice(&self.residual);
        for (k, stage) in STAGES.iter().enumerate() {
            let (rate, u, r) = (&self.rate, &self.u, &self.trial_residual);
            let cfl = EXPLICIT_CFL.min(self.cfl);
            crate::math::sweep::sweep_rows(&mut self.step, n, |i, step| {
                let length = stage * cfl / rate[i];
                step.iter_mut().zip(&r[i * n..]).for_each(|(step, r)| *step = length * r);
            });
            if k + 1 < STAGES.len() {
                let step = &self.step;
                crate::math::sweep::sweep(&mut self.trial, |k| u[k] + step[k]);
                self.system.rhs(&self.frame, &self.trial, &mut self.work, &mut self.trial_residual);
                self.evaluations += 1;
            }
        }
    }

    /// The particle with the largest residual, and where it is.
    pub fn worst(&self) -> (usize, String) {
        let n = self.system.block();
        let size =
            |i: usize| self.residual[i * n..(i + 1) * n].iter().fold(0.0, |m: f64, r| m.max(r.abs())) * self.scale[i];
        let particle = (0..self.scale.len()).fold(0, |w, i| if size(i) > size(w) { i } else { w });
        let place = self.system.locate(&self.frame, particle);
        let place: Vec<String> = place.iter().map(|c| format!("{c:.5}")).collect();
        (particle, if place.is_empty() { String::new() } else { format!(" at ({})", place.join(", ")) })
    }
}
