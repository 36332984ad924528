//! Marching and equilibrium of structures alone: what is recorded on the way, and checkpoints.
use super::super::monitor::{MarchTick, Monitor, Tick};
use super::super::record::saved::require;
use super::super::time_left::Portion;
use super::super::watch::{Ending, Now, Observer, Wish, drive};
use super::keeper::{SolidKeeper, Standing};
use super::pace::Pace;
use super::record::{PeriodicRow, ProbeHarmonic, Row, Work};
use crate::case::{Case, Temporal};
use crate::math::Vector;
use crate::math::reduce::sum;
use crate::problem::RunError;
use crate::problem::solids::Built;
use crate::solid::Structure;
use crate::solid::forces::State;
use crate::time::structural::{Equilibrium, GeneralisedAlpha, LoadPlan, Newton, Plan};
use crate::time::symplectic::{self, Symplectic};
use crate::time::{Integrator, Mark, Memory, Past, Step};

/// Rows of `history.csv`, about.
const ROWS: f64 = 1000.0;
/// What equilibrium may leave of the largest force.
const EQUILIBRIUM: f64 = 1e-9;
/// Newton's iterations in a step of the load.
const ITERATIONS: u32 = 25;

/// A structure that is studied.
pub(crate) struct Study<'a, const D: usize> {
    pub(crate) case: &'a Case,
    pub(crate) built: &'a Built<D>,
    pub(crate) keeper: Option<&'a dyn SolidKeeper<D>>,
}

/// Mean and harmonics of a probe.
pub(crate) type Waves = (Vec<f64>, Vec<ProbeHarmonic>);

/// Where a march ended.
pub(crate) struct Marched {
    pub(crate) state: Vec<f64>,
    pub(crate) time: f64,
    pub(crate) iteration: u64,
    pub(crate) rows: Vec<Row>,
    pub(crate) stopped: bool,
    pub(crate) halved: u32,
    pub(crate) residual: Option<f64>,
    /// Of a periodic motion: how it was found, and mean and harmonics of each probe.
    pub(crate) periodic: Option<(PeriodicRow, Vec<Waves>)>,
}

impl Marched {
    /// A structure that stays where it is.
    pub(crate) fn at_rest<const D: usize>(_: &Built<D>, state: Vec<f64>) -> Self {
        Self {
            state,
            time: 0.0,
            iteration: 0,
            rows: Vec::new(),
            stopped: false,
            halved: 0,
            residual: None,
            periodic: None,
        }
    }
}

/// Forces and displacements at the start of a step, for the work within it.
struct Before<const D: usize> {
    outside: Vec<[f64; D]>,
    displacement: Vec<[f64; D]>,
    damped: f64,
}

impl<const D: usize> Study<'_, D> {
    fn structure(&self) -> &Structure<D> {
        &self.built.structure
    }

    /// The method of the case.
    fn integrator(&self, past: Past, u: Vec<f64>) -> Box<dyn Integrator<Structure<D>> + '_> {
        let system = self.structure();
        match &self.case.time {
            Temporal::Explicit(e) => {
                let until = e.until.map_or(0.0, |t| t.0);
                Box::new(Symplectic::new(system, symplectic::Plan { cfl: e.cfl, until }, past, u))
            }
            Temporal::Newmark(n) => {
                let newton = Newton { tolerance: n.tolerance, iterations: n.iterations };
                let plan = Plan { step: n.step.0, until: n.until.0, radius: n.rho_infinity, newton };
                Box::new(GeneralisedAlpha::new(system, plan, past, u))
            }
            other => {
                let steps = if let Temporal::Steady(s) = other { s.load_steps.unwrap_or(1) } else { 1 };
                let newton = Newton { tolerance: EQUILIBRIUM, iterations: ITERATIONS };
                Box::new(Equilibrium::new(system, LoadPlan { steps, newton }, past, u))
            }
        }
    }

    /// Marches from the state `u`, or from where a checkpoint has it.
    pub(crate) fn march(&self, u: Vec<f64>, monitor: &mut dyn Monitor) -> Result<Marched, RunError> {
        let before = self.keeper.map_or(Ok(None), |keeper| keeper.standing(self.case, self.built))?;
        let Standing { past, u, mut rows, work } = match before {
            Some(standing) => standing,
            None => Standing { past: Past::default(), u, rows: Vec::new(), work: Work::default() },
        };
        let pace = Pace::new(&self.case.output, u64::from(past.iteration));
        let begins = past.iteration == 0 && rows.is_empty();
        let mut integrator = self.integrator(past, u);
        let present = self.row(&mut Now::at(integrator.as_mut()), &work);
        match begins {
            true => rows.push(present),
            false => leads_to(&rows, &present)?,
        }
        let mut log = SolidLog { study: self, rows, work, monitor };
        let mut energies = Energies { before: self.before(&mut Now::at(integrator.as_mut())) };
        let mut checkpoint = SolidCheckpoint { pace };
        let all: &mut [&mut dyn Observer<_, SolidLog<'_, D>>] =
            &mut [&mut energies, &mut History, &mut Frames, &mut checkpoint];
        let ending = drive(integrator.as_mut(), all, &mut log)?;
        let rows = log.rows;
        self.history(&rows)?;
        match ending {
            Ending::Failed(problem) => {
                let checkpoint = self.keeper.map(SolidKeeper::checkpoint_name);
                Err(RunError::Time { source: Box::new(problem), reached: String::new(), checkpoint })
            }
            ending => Ok(self.ended(integrator.as_mut(), rows, matches!(ending, Ending::Stopped))),
        }
    }

    /// Hands the history over.
    pub(crate) fn history(&self, rows: &[Row]) -> Result<(), RunError> {
        self.keeper.map_or(Ok(()), |keeper| keeper.history(self.built, rows))
    }

    /// Where a march stands that is over, or stopped.
    fn ended(&self, integrator: &mut (dyn Integrator<Structure<D>> + '_), rows: Vec<Row>, stopped: bool) -> Marched {
        let (mark, cost) = (integrator.mark(), integrator.cost());
        let residual = matches!(self.case.time, Temporal::Steady(_) | Temporal::Modes(_)).then_some(mark.residual);
        Marched {
            state: integrator.standing().state.to_vec(),
            time: mark.time,
            iteration: u64::from(mark.iteration),
            rows,
            stopped,
            halved: cost.halved,
            residual,
            periodic: None,
        }
    }

    /// True after steps that make a row of `history.csv`.
    fn is_recorded(&self, mark: &Mark) -> bool {
        let row = |time: f64| (time / self.until() * ROWS).floor();
        mark.time >= self.until() || row(mark.time) > row(mark.time - mark.last)
    }

    /// What is told of a step.
    fn tick(&self, mark: &Mark) -> Tick {
        let until = self.until();
        Tick {
            iteration: u64::from(mark.iteration),
            portion: Portion::even((mark.time / until).clamp(0.0, 1.0)),
            residual: mark.residual,
            cfl: 1.0,
            loads: None,
            particles: self.structure().solid.len(),
            march: Some(MarchTick { time: mark.time, until, period: None, angle: None, lift_before: None }),
            point: None,
        }
    }

    /// Time at the end.
    fn until(&self) -> f64 {
        match &self.case.time {
            Temporal::Explicit(e) => e.until.map_or(0.0, |t| t.0),
            Temporal::Newmark(n) => n.until.0,
            _ => 1.0,
        }
    }

    fn state<'s>(&self, time: f64, u: &'s [f64]) -> State<'s, D> {
        self.structure().state(time, u)
    }

    fn before(&self, now: &mut Now<'_, Structure<D>>) -> Before<D> {
        let time = now.mark().time;
        let u = now.standing().state;
        let state = self.state(time, u);
        let solid = &self.structure().solid;
        let mut outside = vec![[0.0; D]; solid.len()];
        solid.outside(&state, &mut outside);
        Before { outside, displacement: state.displacement.to_vec(), damped: solid.damped(&state) }
    }

    /// Adds the work of a step by the mean of the forces at its ends; what the next step begins with.
    fn add_work(&self, now: &mut Now<'_, Structure<D>>, before: &Before<D>, work: &mut Work) -> Before<D> {
        let mark = now.mark();
        let after = self.before(now);
        let solid = &self.structure().solid;
        let state = self.state(mark.time, now.standing().state);
        let outside = &after.outside;
        let moved = |i: usize, a: usize| state.displacement[i][a] - before.displacement[i][a];
        let by_loads = |i: usize, a: usize| 0.5 * (outside[i][a] + before.outside[i][a]) * moved(i, a);
        let free = |i: usize, a: usize| if solid.is_held(i, a) { 0.0 } else { by_loads(i, a) };
        work.loads += sum(solid.len(), |i| (0..D).map(|a| free(i, a)).sum());
        if !matches!(self.case.time, Temporal::Steady(_) | Temporal::Modes(_)) {
            work.damped += 0.5 * mark.last * (before.damped + after.damped);
        }
        if solid.is_moved() {
            // what holds is what the neighbours pull, and inertia; the latter is in the kinetic energy of what is led
            let mut storage = solid.work();
            let mut scratch = vec![0.0; state.history.len()];
            let mut force = vec![[0.0; D]; solid.len()];
            solid.stress(&state, &mut storage, &mut scratch);
            solid.forces(&state, &storage, &mut force);
            let held = |i: usize, a: usize| if solid.is_held(i, a) { force[i][a] * moved(i, a) } else { 0.0 };
            work.supports -= sum(solid.len(), |i| (0..D).map(|a| held(i, a)).sum());
        }
        after
    }

    /// What is recorded of a moment.
    fn row(&self, now: &mut Now<'_, Structure<D>>, work: &Work) -> Row {
        let mark = now.mark();
        let state = self.state(mark.time, now.standing().state);
        let (energy, probes) = (self.structure().solid.energy(&state), self.probes(&state));
        let thickness = self.built.thickness;
        Row {
            step: mark.iteration,
            time: mark.time,
            energy: energy.times(thickness),
            work: work.times(thickness),
            probes,
        }
    }

    /// Displacements of the probes.
    pub(crate) fn probes(&self, state: &State<'_, D>) -> Vec<[f64; 3]> {
        let solid = &self.structure().solid;
        let probe = |(_, i, at): &(String, usize, Vector<D>)| {
            let f = solid.deformation(*i, state.displacement);
            let d = *at - solid.particles.x[*i];
            std::array::from_fn(|a| match a < D {
                true => {
                    let slope = |b: usize| (f[a][b] - if a == b { 1.0 } else { 0.0 }) * d[b];
                    state.displacement[*i][a] + (0..D).map(slope).sum::<f64>()
                }
                false => 0.0,
            })
        };
        self.built.probes.iter().map(probe).collect()
    }

    /// A field file at times that the case asks for.
    fn frame(&self, now: &mut Now<'_, Structure<D>>, time: f64, last: f64) -> Result<(), RunError> {
        let Some(interval) = self.case.output.field_interval.map(|t| t.0) else { return Ok(()) };
        let number = (time / interval * (1.0 + 1e-12)).floor();
        if number <= ((time - last) / interval * (1.0 + 1e-12)).floor() {
            return Ok(());
        }
        let state = now.standing().state;
        self.keeper.map_or(Ok(()), |keeper| keeper.frame(number as usize, time, self.built, state))
    }
}

/// Refuses a history that does not lead to the moment at which the march stands, whose energies, work and probes are computed from its state anew.
fn leads_to(rows: &[Row], present: &Row) -> Result<(), RunError> {
    require(rows.windows(2).all(|w| w[0].is_before(&w[1])), "its history does not run forwards")?;
    let leads = rows.last().is_some_and(|last| last == present || last.is_before(present));
    require(leads, "its history does not lead to its state")
}

/// What a march of a structure finds on its way.
struct SolidLog<'a, const D: usize> {
    study: &'a Study<'a, D>,
    /// Rows of the history.
    rows: Vec<Row>,
    /// Work since the start.
    work: Work,
    monitor: &'a mut dyn Monitor,
}

impl<const D: usize> SolidLog<'_, D> {
    /// Keeps a checkpoint.
    fn keep(&self, now: &mut Now<'_, Structure<D>>) -> Result<(), RunError> {
        let Some(keeper) = self.study.keeper else { return Ok(()) };
        let Memory::March(past) = now.memory() else { return Err(RunError::NoStage) };
        keeper.keep_march(past, now.standing().state, &self.rows, &self.work)
    }
}

/// Adds up the work of every step.
struct Energies<const D: usize> {
    before: Before<D>,
}

impl<const D: usize> Observer<Structure<D>, SolidLog<'_, D>> for Energies<D> {
    fn step(&mut self, _: &Step, now: &mut Now<'_, Structure<D>>, log: &mut SolidLog<'_, D>) -> Result<(), RunError> {
        self.before = log.study.add_work(now, &self.before, &mut log.work);
        Ok(())
    }
}

/// Keeps rows of the history, and tells of them.
struct History;

impl<const D: usize> Observer<Structure<D>, SolidLog<'_, D>> for History {
    fn step(&mut self, _: &Step, now: &mut Now<'_, Structure<D>>, log: &mut SolidLog<'_, D>) -> Result<(), RunError> {
        let mark = now.mark();
        if log.study.is_recorded(&mark) {
            log.rows.push(log.study.row(now, &log.work));
            log.monitor.tick(&log.study.tick(&mark));
        }
        Ok(())
    }
}

/// Writes fields at times that the case asks for.
struct Frames;

impl<const D: usize> Observer<Structure<D>, SolidLog<'_, D>> for Frames {
    fn step(&mut self, _: &Step, now: &mut Now<'_, Structure<D>>, log: &mut SolidLog<'_, D>) -> Result<(), RunError> {
        let mark = now.mark();
        log.study.frame(now, mark.time, mark.last)
    }
}

/// Keeps checkpoints at intervals, when asked for, and where a march stops; stops it when the monitor says so.
struct SolidCheckpoint {
    pace: Pace,
}

impl<const D: usize> Observer<Structure<D>, SolidLog<'_, D>> for SolidCheckpoint {
    fn wish(&mut self, _: &mut Now<'_, Structure<D>>, log: &SolidLog<'_, D>) -> Option<Wish> {
        log.monitor.stop().then_some(Wish::Stop)
    }

    fn step(&mut self, _: &Step, now: &mut Now<'_, Structure<D>>, log: &mut SolidLog<'_, D>) -> Result<(), RunError> {
        let step = u64::from(now.mark().iteration);
        match log.monitor.checkpoint() || self.pace.is_due(step) {
            true => self.pace.write(step, || log.keep(now)),
            false => Ok(()),
        }
    }

    fn end(
        &mut self,
        ending: &Ending,
        now: &mut Now<'_, Structure<D>>,
        log: &mut SolidLog<'_, D>,
    ) -> Result<(), RunError> {
        match ending {
            Ending::Stopped | Ending::Failed(_) => log.keep(now),
            _ => Ok(()),
        }
    }
}
