//! What a run will take: memory of the process and time, from its number of particles and a timed residual.
//!
//! Fitted to runs on one core of an AMD EPYC and two of an Intel Xeon (November 2026): NACA 0012 from Mach 0.5 to 0.8 on 4,000 to 36,000
//! particles, a sphere on 35,000, sections in pitch with 64 steps a period, with one to four harmonics and with explicit steps, and
//! those of `tests/nightly/estimate.py`.
//! A step in time or an iteration costs a number of residuals that depends little on the case; how many are needed grows slowly
//! with the number of particles, and is scaled by what a pilot took. A family of clouds may end early: its cost is that of
//! its last cloud at most, and of its third at least. Shocks that move and separated flow take more than this.
use serde::Serialize;

use super::accuracy;
use super::disk;
use super::stage::{Stage, Task};
use super::time_left::Portion;
use crate::case::{Case, LoadErrors, Polar, Temporal};
use crate::math::parallel::threads;
use crate::problem::bytes_each;
use crate::problem::numerics::harmonics;
use crate::problem::spacing;

/// Bytes of a process that computes nothing.
const PROGRAM: f64 = 11.4e6;
/// Bytes that pictures and report take at their peak: always, with each pixel of a picture, with each of it and each thread, with
/// each particle.
const PICTURES_BYTES: [f64; 4] = [50e6, 7.0, 33.0, 350.0];
/// Seconds that they take on one thread: of a flow that stands, and of one that moves.
const PICTURES_SECONDS: [f64; 2] = [0.5, 2.2];
/// What they take beyond that in space, always and with each particle: walls, planes and sections.
const SPACE_PICTURES_SECONDS: [f64; 2] = [1.5, 7e-5];
/// Residuals that a steady state takes on a plane cloud of [`USUAL`] particles, and in space.
const STEADY: [f64; 2] = [570.0, 520.0];
/// Growth of that number with the number of particles, in the plane and in space.
const GROWTH: [f64; 2] = [-0.09, 0.05];
/// Time of a pilot in the plane over a usual one beyond which a flow is hard, and growth of its residuals beyond the usual: detached
/// shocks settle the more slowly the finer they are drawn. In supersonic streams flows are hard from less on, and how hard pilots do not
/// tell: at Mach 1.5, 2, 3 and 6 that of a circle takes 1.65, 1.4, 2.6 and 2.9 times the usual, and all clouds 12, 10, 8 and 12 s.
const HARD: [f64; 2] = [1.4, 1.33];
const HARD_GROWTH: f64 = 0.4;
const SUPERSONIC_PACE: f64 = 1.7;
const USUAL: f64 = 4000.0;
/// Time of a family in space that follows detached shocks over that of one that does not and has as many particles. Of a sphere at
/// Mach 3.
const FOLLOWING: f64 = 6.6;
/// Residuals of an implicit step in time on a cloud of [`USUAL`] particles, and growth of that number and of those of a balance: the
/// finer the cloud, the more cells a sound wave passes in a step.
const STEP: f64 = 28.0;
const STEP_GROWTH: f64 = 0.5;
/// Residuals that a cloud takes the time of to be built, in the plane and in space.
const BUILDING: [f64; 2] = [120.0, 230.0];
/// Residuals of an implicit step in the shares of a run whose steps nobody has tried: of long ones, so that what is left rather falls than
/// rises when the march begins.
const LONG_STEP: f64 = 150.0;
/// Steps of a march that a harmonic balance begins from, about.
const LEAD_STEPS: f64 = 100.0;
/// Residuals of a harmonic balance without and with each harmonic, its start included.
const BALANCE: [f64; 2] = [300.0, 850.0];
/// Residuals of a step of an explicit method, part of a stable step lost included, at rest and in motion.
const EXPLICIT: [f64; 2] = [3.5, 7.0];
/// Residuals that the linear system of one column of forces in small motion takes the time of, in the plane and in space.
pub(crate) const OF_COLUMN: [f64; 2] = [600.0, 250.0];
/// Growth of a cloud in a cycle of adaptation, and work of a steady state that begins from that of the cycle before over that of
/// one that begins anew.
const ADAPTED: f64 = 1.4;
const AGAIN: f64 = 0.3;
/// Work of a point of a polar after the first, which begins from the one before.
const NEXT_POINT: f64 = 0.5;

/// Time of the runs that error bars of a march or a balance take over its own: on a cloud with twice the spacing, in the plane and in space;
/// with twice the step, with half an explicit step, with another number of harmonics.
const ON_COARSER: [f64; 2] = [0.25, 0.1];
const STEPPED: f64 = 0.75;
const STEPPED_EXPLICIT: f64 = 2.0;
const OTHER_HARMONICS: f64 = 1.0;

/// What a run takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// Greatest memory of the process.
    pub bytes: f64,
    /// Seconds on this machine, with as many threads as now.
    pub seconds: f64,
    /// Bytes that its folder holds at most.
    pub disk: f64,
}

/// What the steady flow of a case took on a coarser cloud, solved for this alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pilot {
    /// Its particles.
    pub(crate) particles: f64,
    /// Seconds from its start to its end.
    pub(crate) seconds: f64,
    /// Particles of a cloud that follows its shocks over those of one that does not.
    pub(crate) following: f64,
    /// Seconds of an implicit step in time on that cloud, where some were taken.
    pub(crate) step: Option<f64>,
}

/// A case on a cloud.
pub(crate) struct Sized<'a> {
    /// The case.
    pub(crate) case: &'a Case,
    /// Particles of its own cloud.
    pub(crate) particles: usize,
    /// Particles of the cloud with a factor on its spacing.
    pub(crate) sizes: &'a dyn Fn(f64) -> f64,
    /// 2 or 3.
    pub(crate) dimension: usize,
    /// Period of the motion in the time of the solver.
    pub(crate) period: Option<f64>,
    /// Pixels of a picture of the flow.
    pub(crate) pixels: f64,
    /// Seconds of a residual on that cloud.
    pub(crate) evaluation: f64,
    /// The steady flow on a coarser cloud, where it was tried.
    pub(crate) pilot: Option<Pilot>,
}

impl Sized<'_> {
    /// What `alula run` takes; `fastest` gives the largest rate of change on the cloud.
    pub(crate) fn cost(&self, fastest: impl FnOnce() -> f64) -> Cost {
        self.on(&self.sizes(), fastest)
    }

    /// What it takes where the first clouds that give an error bar are fine enough; `None` where it goes on to its last cloud anyway.
    pub(crate) fn least(&self) -> Option<Cost> {
        let sizes = self.sizes();
        let enough = accuracy::CLOUDS[self.dimension - 2];
        (spacing::asked(self.case).is_some() && sizes.len() > enough).then(|| self.on(&sizes[..enough], || 0.0))
    }

    /// What it takes on clouds of these numbers of particles.
    fn on(&self, sizes: &[f64], fastest: impl FnOnce() -> f64) -> Cost {
        let points = 1.0 + NEXT_POINT * (self.case.polar.as_ref().map_or(1, Polar::len) as f64 - 1.0);
        let largest = sizes.iter().fold(0.0, |m: f64, n| m.max(*n));
        let each = self.evaluation / self.particles.max(1) as f64;
        let again = if spacing::asked(self.case).is_some() { 1.0 } else { AGAIN };
        let states =
            sizes.iter().enumerate().map(|(k, n)| if k == 0 { 1.0 } else { again } * n * each * self.steady(*n));
        let relaxed = self.pace() * points * states.sum::<f64>();
        let marched = largest * each * self.in_time(largest, fastest);
        let starts = !matches!(self.case.time, Temporal::Explicit(_) | Temporal::Harmonics(_));
        let solved = (marched + if starts { relaxed } else { 0.0 }) * (1.0 + self.further_runs());
        let bytes = PROGRAM + largest * bytes_each(self.case, self.dimension);
        let disk = disk::bytes(self.case, largest, self.dimension, self.period);
        if !self.case.output.report {
            return Cost { bytes, seconds: solved, disk };
        }
        let shared = threads() as f64;
        let [always, pixel, thread, each] = PICTURES_BYTES;
        let pictures = always + self.pixels * (pixel + shared * thread) + largest * each;
        let [first, of_particle] = SPACE_PICTURES_SECONDS;
        let of_space = if self.dimension == 3 { first + of_particle * largest } else { 0.0 };
        let seconds = solved + (PICTURES_SECONDS[usize::from(self.case.moves())] + of_space) / shared;
        Cost { bytes: bytes.max(pictures), seconds, disk }
    }

    /// Time that error bars of a march or a balance take, over its own.
    fn further_runs(&self) -> f64 {
        let error = self.case.accuracy.filter(|_| self.case.is_unsteady()).map_or(LoadErrors::None, |a| a.error);
        let coarser = ON_COARSER[self.dimension - 2];
        let other = match &self.case.time {
            Temporal::Explicit(_) => STEPPED_EXPLICIT,
            Temporal::Harmonics(_) => OTHER_HARMONICS,
            _ => STEPPED,
        };
        match error {
            LoadErrors::None => 0.0,
            LoadErrors::Cloud => coarser,
            LoadErrors::Step | LoadErrors::Harmonics => other,
            LoadErrors::All => coarser + other,
        }
    }

    /// Particles of the clouds of the run, one after another.
    fn sizes(&self) -> Vec<f64> {
        let n = self.particles as f64;
        let following = |cycle: u32| if cycle == 0 { 1.0 } else { self.pilot.map_or(1.0, |p| p.following) };
        match spacing::asked(self.case) {
            Some(asked) => {
                let family = accuracy::family(self.case, &asked, self.sizes, self.dimension);
                let size = |stage: &Stage| following(stage.cycle) * (self.sizes)(stage.factor);
                family.iter().map(size).collect()
            }
            None => (0..=self.case.adapt.cycles).map(|k| n * ADAPTED.powi(k as i32)).collect(),
        }
    }

    /// Time that the flow takes, over that of a usual flow of so many particles, by the pilot.
    fn pace(&self) -> f64 {
        self.pilot.map_or(1.0, |pilot| {
            let each = self.evaluation / self.particles.max(1) as f64;
            let pace = pilot.seconds / (pilot.particles * each * self.usual(pilot.particles));
            match self.dimension {
                2 if self.is_supersonic() && pace > HARD[1] => SUPERSONIC_PACE,
                3 if pilot.following > 1.0 => FOLLOWING * pace,
                _ => pace,
            }
        })
    }

    fn is_supersonic(&self) -> bool {
        self.case.flow.reference().mach > 1.0
    }

    /// Residuals of a usual steady state of `n` particles.
    fn usual(&self, n: f64) -> f64 {
        usual(n, self.dimension)
    }

    /// Residuals of a steady state of `n` particles, over what a pilot has seen of it.
    fn steady(&self, n: f64) -> f64 {
        let hard = HARD[usize::from(self.is_supersonic())];
        let beyond = self.pilot.filter(|_| self.dimension == 2 && self.pace() > hard).map_or(1.0, |p| n / p.particles);
        self.usual(n) * beyond.powf(HARD_GROWTH)
    }

    /// Residuals of an implicit step in time of `n` particles: by the steps of a pilot, where it has taken some.
    fn residuals_of_step(&self, n: f64) -> f64 {
        let each = self.evaluation / self.particles.max(1) as f64;
        let seen = self.pilot.and_then(|p| Some((p.particles, p.step? / (p.particles * each))));
        let (few, residuals) = seen.unwrap_or((USUAL, STEP));
        residuals * (n / few).powf(STEP_GROWTH)
    }

    /// Residuals of what follows a steady start.
    fn in_time(&self, n: f64, fastest: impl FnOnce() -> f64) -> f64 {
        let end = self.case.end(self.period).unwrap_or_default();
        match &self.case.time {
            Temporal::Steady(_) | Temporal::Newmark(_) | Temporal::Modes(_) => 0.0,
            Temporal::Dual(_) => {
                let each = self.residuals_of_step(n);
                self.case.step_length(self.period).map_or(0.0, |step| each * end / step)
            }
            Temporal::Harmonics(_) => {
                let [alone, each] = BALANCE;
                (alone + each * f64::from(harmonics(self.case))) * (n / USUAL).powf(STEP_GROWTH)
            }
            Temporal::Explicit(plan) => EXPLICIT[usize::from(self.case.moves())] * end * fastest() / plan.cfl,
        }
    }
}

/// Residuals of a usual steady state of `n` particles.
fn usual(n: f64, dimension: usize) -> f64 {
    STEADY[dimension - 2] * (n / USUAL).powf(GROWTH[dimension - 2])
}

/// Stage `k` as a part of the run of a case whose own cloud has `particles`; `period` is that of the motion in the time of the solver.
pub(crate) fn portion(
    case: &Case,
    (k, stages): (usize, &[Stage]),
    particles: Option<usize>,
    (dimension, period): (usize, Option<f64>),
) -> Portion {
    let n = particles.map_or(USUAL, |n| n as f64);
    // the cloud of the case itself is built before the first stage
    let opening = n * BUILDING[dimension - 2];
    let work: Vec<f64> = [opening].into_iter().chain(of_stages(case, stages, n, (dimension, period))).collect();
    let family = spacing::asked(case).is_some();
    let may_end_early = family && k + 1 < stages.len();
    let is_even = stages.get(k).is_some_and(|stage| stage.task == Task::March);
    Portion { may_end_early, is_even, ..Portion::of(k + 1, &work) }
}

/// Work of the stages, in residuals of a particle.
fn of_stages(case: &Case, stages: &[Stage], n: f64, (dimension, period): (usize, Option<f64>)) -> Vec<f64> {
    let adapted = spacing::asked(case).is_none();
    let work = |stage: &Stage| {
        let n =
            n * spacing::alike(stage.factor, dimension) * if adapted { ADAPTED.powi(stage.cycle as i32) } else { 1.0 };
        let finer = (n / USUAL).powf(STEP_GROWTH);
        let each = match stage.task {
            Task::Relax if stage.cycle > 0 && adapted => AGAIN * usual(n, dimension),
            Task::Relax if stage.factor == 1.0 && stage.cycle == 0 => usual(n, dimension) - BUILDING[dimension - 2],
            Task::Relax => usual(n, dimension),
            Task::March => LONG_STEP * finer * steps(case, period),
            Task::Lead => LONG_STEP * finer * LEAD_STEPS,
            Task::Balance { harmonics } => (BALANCE[0] + BALANCE[1] * harmonics as f64) * finer,
        };
        n * each * if stage.point.unwrap_or(0) == 0 { 1.0 } else { NEXT_POINT }
    };
    stages.iter().map(work).collect()
}

/// Share of the work that a steady flow takes of that and `columns` of forces in small motion about it.
pub(crate) fn share_of_steady(dimension: usize, columns: usize) -> f64 {
    let steady = usual(USUAL, dimension);
    steady / (steady + columns as f64 * OF_COLUMN[dimension - 2])
}

/// Steps of an implicit march; of an explicit one, which is no stage among others, none are counted.
fn steps(case: &Case, period: Option<f64>) -> f64 {
    let step = case.step_length(period).filter(|step| *step > 0.0);
    step.zip(case.end(period)).map_or(1.0, |(step, end)| end / step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cost(more: &str, particles: usize) -> Cost {
        let text = format!(
            "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.015625\n{more}{}",
            if more.contains("[output]") { "" } else { "[output]\nreport = false\n" }
        );
        let case = crate::case::read(&text, "t").unwrap();
        Sized {
            case: &case,
            particles,
            sizes: &|factor| particles as f64 / factor.powi(2),
            dimension: 2,
            period: Some(10.0),
            pixels: 486e3,
            evaluation: 9.3e-8 * particles as f64,
            pilot: None,
        }
        .cost(|| 1.0)
    }

    #[test]
    fn pictures_count_where_they_are_drawn() {
        let (with, without) = (cost("[output]\nreport = true\n", 4000), cost("", 4000));
        assert!(with.bytes > without.bytes + 4e7 && with.seconds > without.seconds, "{with:?} {without:?}");
    }

    #[test]
    fn parts_of_a_run_are_shared_out_over_clouds_points_and_time() {
        let case = |more: &str| crate::case::read(&format!("[flow]\nmach = 0.5\n{more}"), "t").unwrap();
        let section = "[[body]]\nnaca = \"0012\"\n";
        let part = |case: &Case, k: usize, stages: &[Stage]| portion(case, (k, stages), Some(4111), (2, Some(10.0)));
        let cloud = |factor: f64| Stage { factor, ..Stage::PLAIN };
        // a cloud with half the spacing takes about four times as long, and the run may end before the last one
        let (family, clouds) = (case(section), [cloud(4.0), cloud(2.0), cloud(1.0)]);
        let [first, second, last] = [0, 1, 2].map(|k| part(&family, k, &clouds));
        assert!(first.before < 0.2 && (last.before + last.own - 1.0).abs() < 1e-12, "{first:?} {last:?}");
        assert!((2.5..4.5).contains(&(last.own / second.own)) && second.may_end_early && !last.may_end_early);
        // of a march the start is a small part
        let moved = "[cloud]\nspacing = 0.015625\n[motion]\nreduced_frequency = 0.3\nplunge = 0.01\n[time.dual]\nsteps_per_period = 64\n\
                     periods = 4\n";
        let march = Stage { task: Task::March, ..Stage::PLAIN };
        let marched = part(&case(&format!("{section}{moved}")), 1, &[Stage::PLAIN, march]);
        assert!(marched.own > 0.85 && !marched.may_end_early, "{marched:?}");
    }

    #[test] // greatest resident memory and processor seconds of the runs the numbers are fitted to
    fn measured_runs_are_met() {
        let moved = "[motion]\nreduced_frequency = 0.3\nplunge = 0.01\n";
        let balance = |n: usize| format!("{moved}[time]\nharmonics = {n}\n");
        for (more, particles, megabytes, seconds) in [
            ("", 5699, 22.0, 0.35),
            ("", 8864, 26.9, 0.57),
            (balance(1).as_str(), 4111, 29.3, 0.73),
            (&balance(2), 4111, 35.8, 1.54),
            (&balance(4), 4111, 49.6, 2.52),
            (&format!("{moved}[time.dual]\nsteps_per_period = 64\nperiods = 1\n"), 4111, 22.1, 1.38),
        ] {
            let found = cost(more, particles);
            assert!((found.bytes / (1e6 * megabytes) - 1.0).abs() < 0.15, "{more}: {found:?}");
            assert!((found.seconds / seconds - 1.0).abs() < 0.5, "{more}: {found:?}");
        }
    }
}
