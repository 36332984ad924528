//! Harmonic balance of a case: from a steady flow over few harmonics to as many as are asked for.
use std::path::Path;

use num_complex::Complex64;
use serde::Serialize;

use super::RunError;
use super::marching_check::{MarchingCheck, marched_on};
use super::outputs;
use super::periodic::Sample;
use super::persist::Position;
use super::run_recorder::RunRecorder;
use super::setup::{Solver, harmonic_control};
use super::snapshot::Units;
use super::solve::{Solved, Start, coefficients};
use crate::case::{Case, HarmonicCount, Harmonics};
use crate::math::Vector;
use crate::math::fourier::{Instances, Series};
use crate::math::sweep::sum;
use crate::motion::BodyMotion;
use crate::observe::loads::Coefficients;
use crate::observe::table::{Entry, write_csv};
use crate::observe::vtk::{Column, write_points};
use crate::scheme::{CloudMotion, Fluid, Frame};
use crate::system::{Implicit, Instant, System};
use crate::time::harmonic::HarmonicBalance;
use crate::time::relax::{Relax, Resume};

/// Harmonics at which `number = "auto"` begins, and what it adds.
const FIRST: usize = 1;
const MORE: usize = 2;
/// Iterations over which loads must not change.
const WINDOW: usize = 5;
/// First harmonic over the largest one above which a load counts: symmetry leaves others at round-off.
const PRESENT: f64 = 1e-3;
/// Orders by which the residual must have fallen before loads are looked at.
const FALLEN: f64 = 2.0;
/// Least change of the loads that ends a relaxation with fewer harmonics than are wanted.
const EARLY_TOLERANCE: f64 = 3e-3;
/// Iterations without a new smallest residual, smaller by the part `PROGRESS`, after which a relaxation is given up.
const PATIENCE: u32 = 50;
/// See `PATIENCE`.
const PROGRESS: f64 = 0.97;
/// Samples of the loops.
const SAMPLES: usize = 256;
/// Part of a length or radian by which a motion may miss itself a period later.
const REPEATS: f64 = 1e-9;
/// Relative error of the wall velocity above which a run warns.
const WALL_ERROR: f64 = 0.01;

/// What a harmonic balance found about itself.
#[derive(Clone, Debug, Serialize)]
pub struct BalanceReport {
    /// Number of harmonics N.
    pub harmonics: usize,
    /// Instances at which the equations were evaluated.
    pub instances: usize,
    /// Part of the last harmonic in all harmonics of the loads; absent with one harmonic.
    pub tail_loads: Option<f64>,
    /// The same of the density, root mean square over the volume.
    pub tail_density: Option<f64>,
    /// |ωD x − ẋ|/|ẋ| of the walls, root mean squares over walls and instances: what the harmonics lose of the motion.
    pub wall_velocity_error: f64,
    /// Evaluations of the residual of one instance.
    pub evaluations: u64,
    /// How far a march from there ends from it, where `check` asks for one.
    pub march: Option<MarchingCheck>,
}

/// Finds the periodic solution; `None` when told to stop. Ends with the state and frame of the first instance.
pub(super) fn balance<const D: usize>(
    plan: &Harmonics,
    solver: &Solver<D>,
    start: Start,
    at: &Position<'_>,
    recorder: &mut RunRecorder<'_>,
) -> Solved<D> {
    let fluid = &solver.fluid;
    let Some(period) = recorder.period else {
        let text = "the motion does not repeat, but `[time] harmonics` finds flows that do\nhint: take out what drifts in \
                    `[motion]`, a translation or a formula that does not return after the period, or march with `[time.dual]`";
        return Err(RunError::Folder(text.into()));
    };
    repeats(&fluid.cloud_motion, period)?;
    let omega = std::f64::consts::TAU / period;
    let (most, auto) = match plan.number {
        HarmonicCount::Fixed(n) => (n as usize, false),
        HarmonicCount::Auto(_) => (plan.most as usize, true),
    };
    let build = |n: usize| HarmonicBalance::new(fluid, Instances::of_harmonics(n), omega, plan.oversample);
    let held = |u: &[f64]| u.len() / fluid.len();
    let (mut n, mut state, mut resume) = match start {
        Start::Resume(s) => (held(&s.state) / 2, s.state, Some((s.relax, Progress::read(&s.past.before)))),
        Start::Fresh(u) if u.len() > fluid.len() => {
            let from = Instances::of_harmonics(held(&u) / 2);
            let n = if auto { from.harmonics().min(most) } else { most };
            (n, build(n).resampled(&u, from), None)
        }
        Start::Fresh(u) if plan.march > 0 => {
            let n = if auto { FIRST } else { most };
            let Some(state) = super::marching_start::marched(plan, &build(n), fluid, u, period, recorder)? else {
                return Ok(None);
            };
            (n, state, None)
        }
        Start::Fresh(u) => (FIRST, build(FIRST).copies(&u), None),
    };
    loop {
        let balance = build(n);
        let last = n >= most;
        let Some(found) = converge((plan, last || auto), &balance, fluid, (state, resume.take()), at, recorder)? else {
            return Ok(None);
        };
        state = found;
        let report = report(&balance, fluid, &state, recorder);
        let tail = report.tail_loads.zip(report.tail_density).map(|(a, b)| a.max(b));
        let short = tail.is_none_or(|t| t > plan.tail);
        if last || (auto && !short) {
            let outcome = Periodic { balance: &balance, fluid, state: &state };
            return outcome.finish((plan, report), solver, period, recorder);
        }
        let next = if auto { (n + MORE).min(most) } else { most };
        recorder.note(&format!("{n} harmonics done, {next} follow"));
        state = build(next).resampled(&state, Instances::of_harmonics(n));
        n = next;
    }
}

/// Says what a user should know of the truncation.
fn tell(plan: &Harmonics, report: &BalanceReport, recorder: &mut RunRecorder<'_>) {
    let n = report.harmonics;
    if let Some(tail) = report.tail_loads.into_iter().chain(report.tail_density).reduce(f64::max)
        && tail > plan.tail
    {
        recorder.note(&format!(
            "warning: the last of {n} harmonics still holds {:.1} % of them: add harmonics, or let `number = \"auto\"` do so",
            100.0 * tail
        ));
    }
    if report.wall_velocity_error > WALL_ERROR {
        recorder.note(&format!(
            "warning: {n} harmonics miss {:.1} % of the velocity of the walls: add harmonics",
            100.0 * report.wall_velocity_error
        ));
    }
}

/// Refuses motions that do not come back after a period.
fn repeats<const D: usize>(cloud_motion: &CloudMotion<D>, period: f64) -> Result<(), RunError> {
    let laws: Vec<&BodyMotion<D>> = match cloud_motion {
        CloudMotion::Rigid(law) => vec![law],
        CloudMotion::Along { laws, .. } => laws.iter().collect(),
        CloudMotion::Still | CloudMotion::Travel(_) => Vec::new(),
    };
    for (body, law) in laws.iter().enumerate() {
        for part in [0.0, 0.13, 0.41, 0.77] {
            let (a, b) = (law.pose(part * period), law.pose((part + 1.0) * period));
            let places = std::iter::once(Vector::ZERO).chain((0..D).map(Vector::axis));
            let miss = places.map(|x| (a.point(&x) - b.point(&x)).norm()).fold(0.0, f64::max);
            let (p, q) = (law.coordinates(part * period), law.coordinates((part + 1.0) * period));
            let bend = p.iter().zip(&q).zip(law.shapes()).map(|((p, q), shape)| (p - q).abs() * shape.size());
            let miss = bend.fold(miss, f64::max);
            if miss > REPEATS {
                let hint = "harmonic balance needs a motion that repeats; march with `[time.dual]` instead";
                let text =
                    format!("the motion of body {body} misses itself by {miss:.3e} after a period\nhint: {hint}");
                return Err(RunError::Folder(text));
            }
        }
    }
    Ok(())
}

/// Loads at the instances where the equations are evaluated.
fn loads<const D: usize>(
    balance: &HarmonicBalance<'_, Fluid<D>>,
    fluid: &Fluid<D>,
    (frames, state): (&[Frame<D>], &[f64]),
    work: &mut crate::scheme::Work<D>,
    recorder: &RunRecorder<'_>,
) -> Option<[Series; 3]> {
    let mut all = [Vec::new(), Vec::new(), Vec::new()];
    let mut one = vec![0.0; fluid.len()];
    for (n, frame) in frames.iter().enumerate() {
        balance.look(state, n, &mut one);
        let c = coefficients(fluid, recorder.axes(), frame, &one, work)?;
        [c.cl, c.cd, c.cm].into_iter().zip(&mut all).for_each(|(v, all)| all.push(v));
    }
    let series = all.map(|values| Series::of_values(&values).ok());
    let [a, b, c] = series;
    Some([a?, b?, c?])
}

/// f_1, f_2, … of a series.
pub(super) fn terms(series: &Series) -> Vec<Complex64> {
    let (c, n) = (series.coefficients(), series.instances().harmonics());
    (1..=n).map(|m| Complex64::new(c[m], -c[n + m])).collect()
}

/// Relaxes until the residual has fallen, or the loads no longer change.
fn converge<const D: usize>(
    (plan, last): (&Harmonics, bool),
    balance: &HarmonicBalance<'_, Fluid<D>>,
    fluid: &Fluid<D>,
    (state, resume): (Vec<f64>, Option<(Resume, Progress)>),
    at: &Position<'_>,
    recorder: &mut RunRecorder<'_>,
) -> Result<Option<Vec<f64>>, RunError> {
    let fresh = resume.is_none();
    let (resume, mut progress) = resume.unzip();
    let progress = progress.get_or_insert_with(|| Progress { earlier: recorder.evaluations, ..Progress::default() });
    recorder.evaluations = progress.earlier;
    let origin = balance.copies(&fluid.start());
    let mut relax = Relax::new(balance, harmonic_control(plan, D), state, &origin, resume);
    drop(origin);
    let orders = if last { plan.orders } else { plan.orders.min(FALLEN + 1.0) };
    let goal = 10f64.powf(-orders);
    let tolerance = if last { plan.tolerance } else { plan.tolerance.max(EARLY_TOLERANCE) };
    if fresh {
        recorder.save_with(at, 0.0, (&relax.u, relax.resume()), progress.kept(&relax))?;
    }
    let mut work = fluid.work();
    relax.evaluations = progress.evaluations;
    let instances = balance.times().len();
    recorder.work.begin(relax.evaluations);
    // a checkpoint may have been written by the very iteration that ended the relaxation, or before the first one
    let mut reached = relax.iteration > 0 && progress.reached(relax.drop(), goal, tolerance);
    while !reached && relax.iteration < plan.iterations && !progress.stalls(relax.iteration) {
        let step = match relax.advance() {
            Ok(step) => step,
            Err(e) => {
                recorder.save_with(at, 0.0, (&relax.u, relax.resume()), progress.kept(&relax))?;
                return Err(recorder.failed(e));
            }
        };
        recorder.count();
        recorder.work.add(relax.evaluations, instances * fluid.discretisation.cloud.n_fluid);
        let (frames, _, state) = relax.parts();
        let series = loads(balance, fluid, (frames, state), &mut work, recorder);
        let mean = series.as_ref().map(|s| {
            let [cl, cd, cm] = s.each_ref().map(|s| s.coefficients()[0]);
            Coefficients { cl, cd, cm }
        });
        recorder.record((0, 0), &step, mean, (orders, -step.residual.log10()), fluid)?;
        if let Some(series) = &series {
            progress.recent.push(series.iter().flat_map(|s| s.coefficients().to_vec()).collect());
        }
        if step.residual < PROGRESS * progress.best.0 {
            progress.best = (step.residual, relax.iteration);
        }
        if recorder.due(relax.iteration) {
            recorder.save_with(at, 0.0, (&relax.u, relax.resume()), progress.kept(&relax))?;
        }
        reached = progress.reached(step.residual, goal, tolerance);
        if recorder.stopped() && !reached {
            recorder.save_with(at, 0.0, (&relax.u, relax.resume()), progress.kept(&relax))?;
            return Ok(None);
        }
    }
    if !reached && progress.stalls(relax.iteration) {
        recorder.note(&stalled(relax.drop(), balance.instances().harmonics(), &relax.worst()));
    }
    (recorder.drop, recorder.converged) = (relax.drop(), reached);
    (recorder.bytes, recorder.linear) = (relax.bytes(), relax.linear);
    recorder.evaluations += relax.evaluations * instances as u64;
    recorder.save_with(at, 0.0, (&relax.u, relax.resume()), progress.kept(&relax))?;
    Ok(Some(relax.u))
}

/// Says that a relaxation was given up.
fn stalled(drop: f64, harmonics: usize, (particle, place): &(usize, String)) -> String {
    format!(
        "the residual has not fallen for {PATIENCE} iterations at {:.2} orders: with {harmonics} harmonics the flow has no \
         periodic state that the relaxation can find; it is largest at particle {particle}{place}",
        -drop.log10()
    )
}

/// What the end of a relaxation depends on beside its state.
#[derive(Clone, Debug)]
struct Progress {
    /// Coefficients in time of the loads after each iteration, the last ones at least.
    recent: Vec<Vec<f64>>,
    /// Smallest residual, and when that was.
    best: (f64, u32),
    /// Evaluations of the residual.
    evaluations: u64,
    /// Evaluations by relaxations with fewer harmonics, of one instance.
    earlier: u64,
}

impl Default for Progress {
    fn default() -> Self {
        Self { recent: Vec::new(), best: (f64::INFINITY, 0), evaluations: 0, earlier: 0 }
    }
}

impl Progress {
    /// As numbers for a checkpoint.
    fn kept<S: Implicit>(&self, relax: &Relax<'_, S>) -> Vec<f64> {
        let window = &self.recent[self.recent.len().saturating_sub(WINDOW + 1)..];
        let width = window.first().map_or(0, Vec::len) as f64;
        let numbers = [self.best.0, f64::from(self.best.1), relax.evaluations as f64, self.earlier as f64, width];
        numbers.into_iter().chain(window.iter().flatten().copied()).collect()
    }

    /// From the numbers of a checkpoint.
    fn read(kept: &[f64]) -> Self {
        let [best, when, evaluations, earlier, width, recent @ ..] = kept else { return Self::default() };
        let recent = recent.chunks_exact((*width as usize).max(1)).map(<[f64]>::to_vec).collect();
        Self { recent, best: (*best, *when as u32), evaluations: *evaluations as u64, earlier: *earlier as u64 }
    }

    /// No new smallest residual for too long.
    fn stalls(&self, iteration: u32) -> bool {
        iteration > self.best.1 + PATIENCE
    }

    /// The residual has fallen far enough and the loads have settled: a small motion hardly shows in the residual.
    fn reached(&self, residual: f64, goal: f64, tolerance: f64) -> bool {
        (residual <= goal && still(&self.recent, 1, tolerance))
            || (residual <= 10f64.powf(-FALLEN) && still(&self.recent, WINDOW, tolerance))
    }
}

/// True when over a number of iterations no mean and no harmonic of a load has changed by more than `tolerance` times the
/// first harmonic of that load, for loads that the motion makes at all; bodies without loads are always still.
fn still(recent: &[Vec<f64>], iterations: usize, tolerance: f64) -> bool {
    let Some(last) = recent.last() else { return true };
    if recent.len() <= iterations {
        return false;
    }
    let count = last.len() / 3;
    let window = &recent[recent.len() - 1 - iterations..];
    let part = |v: &[f64], load: usize, k: usize| v[load * count + k];
    let first = |load: usize| part(last, load, 1).hypot(part(last, load, 1 + count / 2));
    let largest = (0..3).map(first).fold(0.0, f64::max);
    (0..3).filter(|load| first(*load) > PRESENT * largest).all(|load| {
        let bound = tolerance * first(load);
        (0..count).all(|k| window.iter().all(|v| (part(v, load, k) - part(last, load, k)).abs() < bound))
    })
}

fn report<const D: usize>(
    balance: &HarmonicBalance<'_, Fluid<D>>,
    fluid: &Fluid<D>,
    state: &[f64],
    recorder: &RunRecorder<'_>,
) -> BalanceReport {
    let (held, mut work) = (balance.instances(), fluid.work());
    let frames = balance.frame(&Instant::still(0.0), state);
    let series = loads(balance, fluid, (&frames, state), &mut work, recorder);
    let n = held.harmonics();
    let part = |s: &Series| {
        let terms = terms(s);
        let all: f64 = terms.iter().take(n).map(|t| t.norm()).sum();
        if all > 0.0 { terms[n - 1].norm() / all } else { 0.0 }
    };
    let tail_loads = series.filter(|_| n > 1).map(|s| part(&s[0]).max(part(&s[2])));
    BalanceReport {
        harmonics: n,
        instances: frames.len(),
        tail_loads,
        tail_density: (n > 1).then(|| density_tail(fluid, held, state)),
        wall_velocity_error: wall_velocity_error(fluid, &frames),
        evaluations: recorder.evaluations,
        march: None,
    }
}

/// Part of the last harmonic of the density in all of them.
fn density_tail<const D: usize>(fluid: &Fluid<D>, held: Instances, state: &[f64]) -> f64 {
    let (n, b) = (held.harmonics(), D + 2);
    let forth = held.to_coefficients();
    let volume = fluid.volumes();
    let size = |m: usize| {
        let square = |i: usize| {
            let all = &state[i * b * held.count()..(i + 1) * b * held.count()];
            let coefficient =
                |row: usize| -> f64 { forth.row(row).iter().zip(all.chunks_exact(b)).map(|(e, u)| e * u[0]).sum() };
            volume[i] * (coefficient(m).powi(2) + coefficient(n + m).powi(2))
        };
        sum(volume.len(), square).sqrt()
    };
    let all: f64 = (1..=n).map(size).sum();
    if all > 0.0 { size(n) / all } else { 0.0 }
}

/// |w − ẋ|/|ẋ| of the walls.
fn wall_velocity_error<const D: usize>(fluid: &Fluid<D>, frames: &[Frame<D>]) -> f64 {
    let cloud = &fluid.discretisation.cloud;
    let (mut miss, mut size) = (0.0, 0.0);
    for frame in frames {
        for (i, wall) in cloud.interface_range().zip(&cloud.interface) {
            let law = match &fluid.cloud_motion {
                CloudMotion::Rigid(law) => Some(law),
                CloudMotion::Along { laws, .. } => laws.get(usize::from(wall.body)),
                CloudMotion::Still | CloudMotion::Travel(_) => None,
            };
            let Some(law) = law else { continue };
            let exact = law.velocity(frame.time, &cloud.x[i]);
            miss += (frame.to_inertial_axes(&frame.velocity_of(i)) - exact).norm().powi(2);
            size += exact.norm().powi(2);
        }
    }
    if size > 0.0 { (miss / size).sqrt() } else { 0.0 }
}

/// A converged solution.
struct Periodic<'a, const D: usize> {
    balance: &'a HarmonicBalance<'a, Fluid<D>>,
    fluid: &'a Fluid<D>,
    state: &'a [f64],
}

impl<const D: usize> Periodic<'_, D> {
    /// Tells, checks and writes what was found; state and frame of the first instance, `None` when told to stop.
    fn finish(
        &self,
        (plan, mut report): (&Harmonics, BalanceReport),
        solver: &Solver<D>,
        period: f64,
        recorder: &mut RunRecorder<'_>,
    ) -> Solved<D> {
        let (balance, fluid) = (self.balance, self.fluid);
        tell(plan, &report, recorder);
        if let Some(series) = self.trace(recorder, period).filter(|_| plan.check > 0) {
            let Some(found) = marched_on(plan, balance, fluid, (self.state, &series), period, recorder)? else {
                return Ok(None);
            };
            recorder.note(&found.told());
            report.march = Some(found);
        }
        if let Some(force_modes) = &solver.force_modes {
            let frames = balance.frame(&Instant::still(0.0), self.state);
            recorder.forces = force_modes.over_a_period(balance, fluid, (&frames, self.state));
        }
        self.compare(recorder)?;
        self.write(recorder, solver, period)?;
        recorder.balance = Some(report);
        let mut first = vec![0.0; fluid.len()];
        balance.instance(self.state, 0, &mut first);
        let frame = balance.with_instant(self.state, 0.0, |at| fluid.frame(at, &first));
        Ok(Some((first, frame)))
    }

    /// Puts the loads of one period where those of the last period of a march would be; gives their series.
    fn trace(&self, recorder: &mut RunRecorder<'_>, period: f64) -> Option<[Series; 3]> {
        let frames = self.balance.frame(&Instant::still(0.0), self.state);
        let series = loads(self.balance, self.fluid, (&frames, self.state), &mut self.fluid.work(), recorder);
        let [cl, cd, cm] = series?;
        recorder.trace.clear();
        for k in 0..=SAMPLES {
            let part = 1.0 + k as f64 / SAMPLES as f64;
            let phase = std::f64::consts::TAU * part;
            let loads = Coefficients { cl: cl.at(phase), cd: cd.at(phase), cm: cm.at(phase) };
            recorder.trace.push(Sample {
                time: part * period,
                loads,
                motion: super::run_recorder::motion(self.fluid, part * period),
            });
        }
        let instance = |frame: &Frame<D>| {
            let phase = std::f64::consts::TAU * frame.time / period;
            let [angle, x, y, z, mode] = super::run_recorder::motion(self.fluid, frame.time);
            let shift = [x, y, z, mode].into_iter().find(|s| s.abs() > 0.0).unwrap_or(0.0);
            [frame.time / period, angle.to_degrees(), shift, cl.at(phase), cd.at(phase), cm.at(phase)]
        };
        recorder.instances = frames.iter().map(instance).collect();
        Some([cl, cd, cm])
    }

    /// Loads at the instances, evaluated twice.
    fn compare(&self, recorder: &mut RunRecorder<'_>) -> Result<(), RunError> {
        let (fluid, held) = (self.fluid, self.balance.instances());
        let (mut one, mut work) = (vec![0.0; fluid.len()], fluid.work());
        for k in 0..held.count() {
            self.balance.instance(self.state, k, &mut one);
            let phase = std::f64::consts::TAU * k as f64 / held.count() as f64;
            let frame = self.balance.with_instant(self.state, phase, |at| fluid.frame(at, &one));
            // a run that is interrupted now does this again
            recorder.compare((1, frame.time), fluid, (&frame, &one, &mut work))?;
        }
        Ok(())
    }

    /// Fields at phases, coefficients in time of walls and field.
    fn write(&self, recorder: &RunRecorder<'_>, solver: &Solver<D>, period: f64) -> Result<(), RunError> {
        let (case, out) = (recorder.case(), recorder.out());
        let rows = recorder.instances.iter().map(|row| row.map(Entry::from).to_vec());
        write_csv(&out.join("instances.csv"), &["phase", "angle_deg", "shift", "cl", "cd", "cm"], rows)?;
        let moment = |part: f64| {
            let phase = std::f64::consts::TAU * part;
            let (mut one, mut work) = (vec![0.0; self.fluid.len()], self.fluid.work());
            self.balance.at_phase(self.state, phase, &mut one);
            let frame = self.balance.with_instant(self.state, phase, |at| self.fluid.frame(at, &one));
            self.fluid.fill_states(&frame, &one, &mut work);
            self.fluid.fill_gradients(&frame, &mut work);
            (frame, work)
        };
        if let Some(interval) = recorder.interval() {
            let count = (period / interval + super::run_recorder::NEARLY).floor() as u64;
            for k in 1..=count {
                let (frame, work) = moment(k as f64 * interval / period);
                outputs::write_series(case, out, self.fluid, (&frame, &work), interval)?;
            }
        }
        if let Some(surface) = &solver.film {
            let parts = u64::from(outputs::FILM);
            super::pictures::together(parts as usize, |k| {
                let (frame, mut work) = moment((k + 1) as f64 / parts as f64);
                outputs::write_film(case, out, (self.fluid, surface), (&frame, &mut work), k as u64 + 1)
            })?;
        }
        self.write_coefficients(case, out)
    }

    /// `field_harmonics.vtu` and `surface_harmonics.csv`: mean and complex harmonics at the particles before any motion.
    fn write_coefficients(&self, case: &Case, out: &Path) -> Result<(), RunError> {
        let (fluid, held) = (self.fluid, self.balance.instances());
        let units = Units::of(case);
        let cloud = &fluid.discretisation.cloud;
        let n = held.harmonics();
        // values of all real particles at the instances that hold the solution: density, velocity, pressure, Cp
        let free = crate::scheme::start::free_stream::<D>(case);
        let rows = cloud.n_real();
        let mut values = vec![vec![Vec::with_capacity(held.count()); rows]; D + 3];
        let (mut one, mut work) = (vec![0.0; fluid.len()], fluid.work());
        for k in 0..held.count() {
            self.balance.instance(self.state, k, &mut one);
            let phase = std::f64::consts::TAU * k as f64 / held.count() as f64;
            let frame = self.balance.with_instant(self.state, phase, |at| fluid.frame(at, &one));
            fluid.fill_states(&frame, &one, &mut work);
            for (i, q) in work.state[..rows].iter().enumerate() {
                let velocity = frame.to_inertial_axes(&q.velocity) * units.speed;
                values[0][i].push(q.density * units.density);
                (0..D).for_each(|d| values[1 + d][i].push(velocity[d]));
                values[D + 1][i].push(q.pressure * units.pressure());
                values[D + 2][i].push(super::snapshot::pressure_coefficient(q, &free));
            }
        }
        let forth = held.to_coefficients();
        let coefficient =
            |row: usize, values: &[f64]| -> f64 { forth.row(row).iter().zip(values).map(|(e, v)| e * v).sum() };
        let bare = ["density", "velocity_x", "velocity_y", "velocity_z", "pressure"];
        let names: Vec<&str> = (0..D + 2).map(|c| if c <= D { bare[c] } else { bare[4] }).collect();
        let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
        for (name, values) in names.iter().zip(&values) {
            let column =
                |row: usize, sign: f64| values.iter().map(|v| sign * coefficient(row, v)).collect::<Vec<f64>>();
            columns.push((format!("{name}_mean"), column(0, 1.0)));
            for m in 1..=n {
                columns.push((format!("{name}_{m}_re"), column(m, 1.0)));
                columns.push((format!("{name}_{m}_im"), column(n + m, -1.0)));
            }
        }
        let points: Vec<[f64; 3]> = cloud.x[..rows].iter().map(Vector::to_3d).collect();
        let columns: Vec<Column<'_>> =
            columns.iter().map(|(name, values)| Column { name, components: 1, values }).collect();
        write_points(&out.join("field_harmonics.vtu"), &points, &columns)?;
        let mut names = ["x", "y", "z", "area", "cp_mean"].map(String::from).to_vec();
        names.extend((1..=n).flat_map(|m| [format!("cp_{m}_re"), format!("cp_{m}_im")]));
        let rows = cloud.interface_range().zip(&cloud.interface).map(|(i, wall)| {
            let cp = &values[D + 2][i];
            let mut row = cloud.x[i].to_3d().map(Entry::from).to_vec();
            row.push(Entry::from(wall.area.norm()));
            row.push(Entry::from(coefficient(0, cp)));
            row.extend((1..=n).flat_map(|m| [coefficient(m, cp), -coefficient(n + m, cp)]).map(Entry::from));
            row
        });
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        Ok(write_csv(&out.join("surface_harmonics.csv"), &names, rows.collect::<Vec<_>>())?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_are_still_when_those_that_are_there_are() {
        // mean, cosine and sine of lift, drag and moment: a piston has drag alone
        let drag = |sine: f64| vec![1e-9, 0.0, 2e-9, 0.1, 0.0, sine, 0.0, 1e-12, 0.0];
        let recent = [drag(0.5), drag(0.4), drag(0.400_01)];
        assert!(still(&recent, 1, 1e-4) && !still(&recent, 2, 1e-4) && !still(&recent, 1, 1e-6));
        assert!(!still(&recent, 3, 1.0), "too few iterations");
        assert!(still(&[], 1, 1e-4) && still(&[vec![0.0; 9], vec![0.0; 9]], 1, 1e-4));
        let lift = |cosine: f64| vec![0.0, cosine, 0.0, 0.0, 0.0, 0.0, 0.0, 0.01, 0.0];
        assert!(!still(&[lift(1.0), lift(1.01)], 1, 1e-4));
    }
}
