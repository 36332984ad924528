//! A session: a case in, fields and loads out.
//!
//! A run is a plain list of [stages](super::stage): coarse clouds that give a steady case its start, the cloud of the case, one
//! cloud for each cycle of adaptation, a march, more and more harmonics. Every stage builds its cloud, takes over the state of
//! the one before by the solver's own fit, and is driven. A session opens no file but those that the case names, unless it keeps
//! its run in a folder.
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::accuracy;
use super::at_end::{AtEnd, Bars, Outcome, Then};
use super::cost;
use super::course::{Coarser, Course, Next};
use super::disk;
use super::doubts;
use super::error::RunError;
use super::files;
use super::folder::{self, Hold};
use super::found::{Found, Names, Spent};
use super::look::{GasView, Snapshot, WallSnapshot, field, load_axes, momentum, span_load, span_loads, wake_planes};
use super::monitor::Monitor;
use super::recipe;
use super::record::saved::{Kept, Position, Saved, flatten};
use super::record::summary::{Clock, Summary};
use super::record::{Described, IterationHistory, Log, Scales, SolidEnd};
use super::setup::{self, Site, Solver, check_motion};
use super::solids::{snapshot, with_own_modes};
use super::stage::{Stage, Task, describe};
use super::studies::{self, Reached, SmallMotion, Start, Turn};
use super::time_left::Portion;
use crate::case::{self, Case};
use crate::cloud::Cloud;
use crate::cloud::sources::Source;
use crate::coupling::solids::OnCloud;
use crate::coupling::{Coupled, Marches};
use crate::geometry::{Surface, dimension};
use crate::observe::loads::Coefficients;
use crate::scheme::{Fluid, HasGas};
use crate::system::{Instant, System};
use crate::verify::{Loops, wall::Wall};

/// What a run begins with.
pub(crate) enum Origin {
    /// The case alone.
    Case,
    /// Its own checkpoint.
    Own(Box<Saved<'static>>),
    /// The last state of another run.
    Other(Box<Saved<'static>>),
}

/// A case that is solved in memory.
///
/// ```no_run
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let case = alula::case::read("title = \"cylinder\"\n[flow]\nmach = 0.3\n[[body]]\ncircle = { radius = 0.5 }\n", "case")?;
/// let mut session = alula::run::Session::open(&case, ".")?;
/// session.solve(&mut alula::run::Silent)?;
/// println!("{:?}", session.loads());
/// # Ok(())
/// # }
/// ```
pub struct Session {
    case: Case,
    input: PathBuf,
    out: Option<PathBuf>,
    held: Option<Hold>,
    origin: Origin,
    solution: Option<Solution>,
}

/// What a run begins with, and what is done at its end.
type Way<'a> = (Origin, AtEnd<'a>);

/// What a session has found.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Loads, and what it took.
    pub summary: Summary,
    /// The solution on all particles, in the units of the case.
    pub field: Snapshot,
    /// The solution on the walls, in the units of the case.
    pub walls: WallSnapshot,
    /// Particles of bodies made of particles at the end, in the units of the case; `None` without such bodies.
    pub solid: Option<Snapshot>,
    /// What every iteration left.
    pub history: IterationHistory,
    /// Loads over the last period of a motion, empty where there is none.
    pub loops: Loops,
}

impl Session {
    /// Opens a case whose file names refer to the folder `input`.
    pub fn open(case: &Case, input: impl Into<PathBuf>) -> Result<Self, RunError> {
        setup::supported(case)?;
        let input = input.into();
        let case = with_own_modes(case, &input)?;
        Ok(Self { case, input, out: None, held: None, origin: Origin::Case, solution: None })
    }

    /// The same with a folder for tables, checkpoints, fields and pictures, which is made and gets the resolved case. Fails where
    /// it holds an earlier run already.
    pub fn keep_in(self, out: impl AsRef<Path>, monitor: &mut dyn Monitor) -> Result<Self, RunError> {
        let out = out.as_ref();
        folder::check_compared(&self.case, &self.input)?;
        let (again, held) = folder::create(&self.case, &self.input, out)?;
        if again {
            let out = out.display();
            monitor.note(&format!("the run in `{out}` was stopped before its first checkpoint: it begins again"));
        }
        Ok(self.kept_in(out, held))
    }

    /// The same with a folder, which exists.
    pub(crate) fn kept_in(self, out: &Path, held: Hold) -> Self {
        Self { out: Some(out.to_path_buf()), held: Some(held), ..self }
    }

    /// The same from elsewhere than the start of the case.
    pub(crate) fn from(self, origin: Origin) -> Self {
        Self { origin, ..self }
    }

    /// Solves the case, from its start or from where it was stopped; tells how it went. Error bars of marches and balances are found by
    /// [`solve`](super::solve).
    pub fn solve(&mut self, monitor: &mut dyn Monitor) -> Result<Outcome, RunError> {
        self.solve_and(monitor, AtEnd::default())
    }

    /// The same; `then` gets what was found as a source of forces in small motion, before it is looked at and written.
    pub(crate) fn solve_then(&mut self, monitor: &mut dyn Monitor, then: Then<'_>) -> Result<Outcome, RunError> {
        self.solve_and(monitor, AtEnd { then: Some(then), bars: None })
    }

    /// The same with what is done at its end.
    pub(crate) fn solve_and(&mut self, monitor: &mut dyn Monitor, end: AtEnd<'_>) -> Result<Outcome, RunError> {
        let origin = std::mem::replace(&mut self.origin, Origin::Case);
        let work = Run {
            case: &self.case,
            given: &self.case.cloud,
            input: &self.input,
            out: self.out.as_deref(),
            held: end.then.is_some() && !self.case.is_trimmed(),
        };
        let ended = match dimension(&self.case) {
            2 => work.solve::<2>((origin, end), monitor),
            _ => work.solve::<3>((origin, end), monitor),
        };
        self.held = None;
        Ok(match ended? {
            Ok(solution) => {
                let summary = Box::new(solution.summary.clone());
                self.solution = Some(solution);
                Outcome::Finished(summary)
            }
            Err(iteration) => Outcome::Interrupted { iteration },
        })
    }

    /// Where its files lie, and where it is kept.
    pub(crate) fn places(&self) -> (PathBuf, Option<PathBuf>) {
        (self.input.clone(), self.out.clone())
    }

    /// The case.
    pub fn case(&self) -> &Case {
        &self.case
    }

    /// What was found and what it took; `None` before it is solved.
    pub fn summary(&self) -> Option<&Summary> {
        self.solution.as_ref().map(|s| &s.summary)
    }

    /// Loads on all bodies, of pressure and friction; `None` before it is solved.
    pub fn loads(&self) -> Option<Coefficients> {
        self.summary().map(|s| s.loads)
    }

    /// The solution on all particles, in the units of the case; `None` before it is solved.
    pub fn field(&self) -> Option<&Snapshot> {
        self.solution.as_ref().map(|s| &s.field)
    }

    /// The solution on the walls, in the units of the case; `None` before it is solved.
    pub fn walls(&self) -> Option<&WallSnapshot> {
        self.solution.as_ref().map(|s| &s.walls)
    }

    /// Pressure and friction on the walls, as claims are measured on them; `None` before it is solved.
    pub fn wall(&self) -> Option<Wall> {
        self.walls().map(WallSnapshot::measured)
    }

    /// What every iteration left; `None` before it is solved.
    pub fn history(&self) -> Option<&IterationHistory> {
        self.solution.as_ref().map(|s| &s.history)
    }

    /// Loads over the last period of a motion, empty where there is none; `None` before it is solved.
    pub fn loops(&self) -> Option<&Loops> {
        self.solution.as_ref().map(|s| &s.loops)
    }

    /// All that it has found, handed over; `None` before it is solved.
    pub fn into_solution(self) -> Option<Solution> {
        self.solution
    }
}

/// A case on its way through the stages.
struct Run<'a> {
    case: &'a Case,
    /// The cloud as the case file has it.
    given: &'a case::Cloud,
    input: &'a Path,
    out: Option<&'a Path>,
    /// Bodies on springs stay where they begin.
    held: bool,
}

/// A stage that is over: its solver and where it ended.
struct Stood<S: System, const D: usize> {
    stage: Stage,
    solver: Solver<S, D>,
    reached: Reached<S>,
}

/// What a stage begins with.
struct Begun<S, const D: usize> {
    solver: Solver<S, D>,
    start: Start,
}

/// The solution of a run, or the iteration at which it was told to stop.
type Ended = Result<Solution, u64>;

impl Run<'_> {
    /// The gas alone, or with the structures of the case.
    fn solve<const D: usize>(&self, way: Way<'_>, monitor: &mut dyn Monitor) -> Result<Ended, RunError> {
        let (surface, notes) = setup::surface::<D>(self.case, self.input)?;
        notes.iter().for_each(|n| monitor.note(n));
        let filled = accuracy::with_cloud(self.case, surface.as_ref());
        let run = Run { case: &filled, ..*self };
        run.on(surface.as_ref(), way, monitor)
    }

    /// The same around the bodies, on clouds whose spacing is known.
    fn on<const D: usize>(
        &self,
        surface: Option<&Surface<D>>,
        way: Way<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Ended, RunError> {
        let mut motions = setup::motions(self.case, self.input, surface)?;
        setup::sane(self.case, surface, &motions)?.iter().for_each(|n| monitor.warn(n));
        let bodies = setup::bodies(self.case, self.input, surface, &mut motions)?;
        setup::told_of_modes(surface, &motions, &bodies).tell(monitor);
        if !self.held {
            setup::check_equilibrium(self.case, surface, &bodies)?;
        }
        let first = bodies.last().map_or(0, |b| b.range().end);
        let solids = setup::solids(self.case, self.input, first, &mut motions, monitor)?;
        let site = Site { case: self.case, surface, motions: &motions };
        if bodies.is_empty() && solids.is_none() {
            return self.stages(&site, |gas| gas, Vec::new(), way, monitor);
        }
        let mut described = setup::described(self.case, surface, &bodies);
        let solids = solids.map(|(solids, said)| {
            described.extend(said);
            solids
        });
        let couple = |gas: Fluid<D>| {
            let cloud = &gas.discretisation.cloud;
            let walls = &cloud.x[cloud.interface_range()];
            let on = bodies.iter().map(|body| body.clone().on(walls)).collect();
            match &solids {
                None => Coupled::new(gas, on),
                Some(solids) => {
                    let made = OnCloud::new(Arc::clone(solids), &gas);
                    Coupled::new(gas, on).with_solids(made)
                }
            }
        };
        self.stages(&site, couple, described, way, monitor)
    }

    /// All stages with the system that `assemble` makes from the gas on each cloud.
    fn stages<S: Marches<D>, const D: usize>(
        &self,
        site: &Site<'_, D>,
        assemble: impl Fn(Fluid<D>) -> S,
        structures: Vec<Described>,
        (origin, end): Way<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Ended, RunError> {
        let clock = Clock::start();
        let (mut stages, mut ground) = self.opening(site, origin, monitor)?;
        let scales = Scales { axes: load_axes(self.case, site.surface), period: site.motions.period() };
        let points = self.case.points();
        let mut log = Log::open(self.case, self.out, scales, ground.saved.as_ref(), structures, monitor)?;
        if let Some(cloud) = &ground.ready {
            log.note(&describe(&stages, cloud.n_fluid));
            accuracy::too_few(self.case, cloud.n_real()).iter().for_each(|few| log.note(few));
            log.begin_point(true);
        }
        let particles = ground.ready.as_ref().map(|cloud| cloud.n_fluid);
        let scope = Portion { own: end.then.as_ref().map_or(1.0, |then| then.0), ..Portion::whole(0.0) };
        let (mut k, mut sources, kept) = ground.standing();
        let mut course = Course::of(self.case, &points, kept);
        let mut previous: Option<Stood<S, D>> = None;
        while let Some(stage) = stages.get(k).copied() {
            let (stage, site) = (&stage, Site { case: course.case(&stage), ..*site });
            course.enter(stage, site.surface, &mut log);
            log.record.warnings.clear();
            log.portion = cost::portion(self.case, (k, &stages), particles, (D, log.period)).within(&scope);
            if !course.holds(stage) && !previous.as_ref().is_some_and(|before| stage.shares_cloud(&before.stage)) {
                log.doing(&stage.building());
            }
            let build = |ready| Ok(setup::solver(&site, stage, &sources, ready)?.with(&assemble));
            let Begun { mut solver, start } =
                ground.begin((stage, &site), build, previous.take(), &mut course, &log)?;
            let flat = flatten(&sources);
            let turn = Turn { at: &Position { stage: k, stages: &stages, sources: &flat, kept: course.kept() } };
            let reached = match self.study(&mut solver, start, &turn, &mut log) {
                Ok(Some(reached)) => reached,
                Ok(None) => return Ok(Err(log.record.iteration)),
                Err(problem) => {
                    course.shelve(stage, solver);
                    k = course.failed((k, &mut stages), problem, &site.motions.multiples(), &mut log)?;
                    continue;
                }
            };
            if let Some(next) = turn.next().filter(|next| next.cycle > stage.cycle && !reached.enough) {
                sources = setup::adapted(&site, [stage, next], &solver.system, &reached.state);
            }
            course.keep(k, &stages, &reached, &flat);
            k = match course.next(k, &stages, (&solver.system, &reached), &mut log)? {
                Next::Stage(next) => next,
                Next::Back(back, before) => {
                    sources = before;
                    stages.insert(k + 1, back);
                    k + 1
                }
                Next::Point(first) => {
                    course.shelve(stage, solver);
                    k = first;
                    continue;
                }
            };
            previous = Some(Stood { stage: *stage, solver, reached });
        }
        let stood = previous.map_or_else(|| last_known(&mut course, site, assemble, &mut log), Ok)?;
        if let Some((share, then)) = end.then {
            log.portion = Portion { before: share, own: 1.0 - share, ..Portion::whole(0.0) };
            let (_, state) = stood.reached.end.as_ref().ok_or(RunError::NoStage)?;
            then(
                &mut SmallMotion::new(&stood.solver.system, state, (&log.axes, self.case.freezes_limiter())),
                &mut log,
            )?;
        }
        Run { case: log.case, ..*self }.conclude(&stood, site.surface, &mut log, (&clock, end.bars))
    }

    /// The stages of a run, and what the first of them stands on.
    fn opening<const D: usize>(
        &self,
        site: &Site<'_, D>,
        origin: Origin,
        monitor: &mut dyn Monitor,
    ) -> Result<(Vec<Stage>, Ground<D>), RunError> {
        let (saved, other) = match origin {
            Origin::Own(saved) => {
                return Ok((saved.stages.clone(), Ground { ready: None, saved: Some(*saved), other: None }));
            }
            Origin::Other(other) => (None, Some(*other)),
            Origin::Case => (None, None),
        };
        let cloud = self.cloud(site, monitor)?;
        let stages = match &other {
            Some(o) => recipe::plan_from(self.case, &o.stages[o.stage]),
            None => {
                let sizes = accuracy::sizes(self.case, site.surface, cloud.n_real());
                let harmonics = site.motions.multiples().last().copied().unwrap_or(1);
                recipe::plan(self.case, (cloud.n_fluid, &sizes), D, harmonics)
            }
        };
        Ok((stages, Ground { ready: Some(cloud), saved, other }))
    }

    /// The cloud of the case; tells what is worth knowing of it and of the motion on it.
    fn cloud<const D: usize>(&self, site: &Site<'_, D>, monitor: &mut dyn Monitor) -> Result<Cloud<D>, RunError> {
        monitor.doing("building the cloud of the case", &Portion::whole(0.0));
        let cloud = Cloud::build(&setup::spec(self.case), site.surface, &[])?;
        self.out.map_or(Ok(()), |out| disk::check(self.case, out, cloud.n_real(), D, site.motions.period()))?;
        cloud.notes.iter().cloned().chain(cloud.early_ends()).for_each(|n| monitor.note(&n));
        check_motion(self.case, &cloud, site.motions)?.iter().for_each(|n| monitor.warn(n));
        recipe::marching(self.case, site.motions.period(), D)?;
        Ok(cloud)
    }

    /// Does what a stage is for; `None` when told to stop.
    fn study<S: Marches<D>, const D: usize>(
        &self,
        solver: &mut Solver<S, D>,
        start: Start,
        turn: &Turn<'_>,
        log: &mut Log<'_>,
    ) -> Result<Option<Reached<S>>, RunError> {
        solver.system.hold_bodies(turn.stage().task == Task::Relax && (self.held || self.case.is_unsteady()));
        let plan = || recipe::balance(self.case).ok_or(RunError::NoStage);
        match turn.stage().task {
            Task::Relax => {
                let steady = recipe::relaxation(self.case).ok_or(RunError::NoStage)?;
                studies::relax(&solver.system, &steady, start, turn, log)
            }
            Task::March => {
                let marching = recipe::marching(self.case, log.period, D)?.ok_or(RunError::NoStage)?;
                studies::march(solver, &marching, start, turn, log)
            }
            Task::Lead => {
                let next = turn.next().ok_or(RunError::NoStage)?;
                studies::lead(&solver.system, plan()?, next.instances() / 2, start.into_state(), log)
            }
            Task::Balance { .. } => studies::balance(solver, plan()?, start, turn, log),
        }
    }

    /// Looks at the end of a run, and writes it where there is a folder.
    fn conclude<S: Marches<D>, const D: usize>(
        &self,
        stood: &Stood<S, D>,
        surface: Option<&Surface<D>>,
        log: &mut Log<'_>,
        (clock, bars): (&Clock, Option<Bars<'_>>),
    ) -> Result<Ended, RunError> {
        let Some((frame, state)) = &stood.reached.end else { return Err(RunError::NoStage) };
        let gas = &GasView::of(&stood.solver.system, frame, state);
        let (solved, mut work) = (clock.wall_seconds(), gas.fluid.work());
        let balance = momentum::around(self.case, &log.axes, gas, &mut work, self.case.is_unsteady());
        let view = gas.seen(&mut work);
        let (axes, names) = (log.axes.axes(&view), Names::of(surface));
        let wake = match self.case.is_unsteady() {
            true => Vec::new(),
            false => wake_planes(&view, surface, self.case, &axes),
        };
        let strips = span_loads(self.case, &view, surface, &axes);
        let span_load = span_load(self.case, &view, surface, &strips, &axes);
        let found = Found { case: self.case, view, surface, axes, names, balance, strips, span_load, wake };
        let mut summary = found.summary(log, gas.state, &Spent { clock, solved });
        if let Some(bars) = bars
            && !bars(self.case, &mut summary, log)?
        {
            return Ok(Err(log.record.iteration));
        }
        let solid = stood.solver.system.solid_snapshot(frame, state);
        summary.solid = solid.as_ref().map(|at| SolidEnd::of(at, log));
        summary.cloud = accuracy::scaled(self.case, stood.stage.factor).cloud;
        let doubts = doubts::told(self.case, (&summary, surface), log.record.trace.largest(), solid.as_ref());
        doubts.iter().for_each(|d| log.warn(d));
        summary.warnings.clone_from(&log.record.warnings);
        let (field, walls) = (field(self.case, &view), found.walls());
        if let Some(journal) = &log.journal {
            if summary.cloud != *self.given {
                folder::put_cloud(&summary.cloud, stood.stage.cycle > 0, &journal.out)?;
            }
            files::write_all(&found, &mut summary, (&field, &walls), solid.as_ref(), log, &journal.out)?;
            journal.describe()?;
            folder::finish(&journal.out)?;
        }
        let loops = log.case_period().map_or_else(Loops::default, |p| log.record.trace.loops(p));
        let history = std::mem::take(&mut log.record.history);
        let solid = solid.map(|at| snapshot(at.solid, &at.state()));
        Ok(Ok(Solution { summary, field, walls, solid, history, loops }))
    }
}

/// What the first stage stands on; each thing serves once.
struct Ground<const D: usize> {
    /// The cloud of the case.
    ready: Option<Cloud<D>>,
    /// Where this run stopped.
    saved: Option<Saved<'static>>,
    /// Where another run ended.
    other: Option<Saved<'static>>,
}

impl<const D: usize> Ground<D> {
    /// The stage that a run goes on with, the sources of its cloud, and what was kept of those before it.
    fn standing(&mut self) -> (usize, Vec<Source<D>>, Vec<Kept>) {
        let sources = self.saved.as_ref().or(self.other.as_ref()).map_or_else(Vec::new, Saved::sources);
        let Some(saved) = &mut self.saved else { return (0, sources, Vec::new()) };
        (saved.stage, sources, std::mem::take(&mut saved.kept).into_owned())
    }

    /// The beginning of a stage: at the checkpoint, on the cloud of the stage before it, or on one that `build` makes.
    fn begin<S: HasGas<D>>(
        &mut self,
        (stage, site): (&Stage, &Site<'_, D>),
        build: impl Fn(Option<Cloud<D>>) -> Result<Solver<S, D>, RunError>,
        previous: Option<Stood<S, D>>,
        course: &mut Course<'_, S, D>,
        log: &Log<'_>,
    ) -> Result<Begun<S, D>, RunError> {
        let saved = self.saved.take();
        let stood = match previous {
            Some(stood) if saved.is_none() && stage.shares_cloud(&stood.stage) => {
                return Ok(Begun::fresh(stood.solver, stood.reached.state));
            }
            other => other,
        };
        let solver = match course.take(stage, site)? {
            Some(solver) => solver,
            None => build(if stage.factor == 1.0 { self.ready.take() } else { None })?,
        };
        if let Some(saved) = saved {
            return Begun::resumed(solver, saved);
        }
        let guess = guess(&solver, stage, site, stood.as_ref(), course, log);
        let begun = begun(solver, site, (guess, stood.as_ref()), self.other.take())?;
        stood.into_iter().for_each(|s| course.shelve(&s.stage, s.solver));
        Ok(begun)
    }
}

impl<S, const D: usize> Begun<S, D> {
    fn fresh(solver: Solver<S, D>, state: Vec<f64>) -> Self {
        Self { solver, start: Start::Fresh(state) }
    }
}

impl<S: HasGas<D>, const D: usize> Begun<S, D> {
    /// A stage that goes on where a checkpoint stands.
    fn resumed(mut solver: Solver<S, D>, saved: Saved<'static>) -> Result<Self, RunError> {
        // particles that travel are elsewhere by now
        let travelled = saved.lagrangian.as_ref().map(|r| r.resume(solver.system.gas()));
        if let Some(fluid) = travelled.transpose()?.flatten() {
            solver.system.set_gas(fluid);
        }
        saved.fits(solver.system.fields())?;
        Ok(Self { solver, start: Start::Resume(saved.state.into_owned(), saved.memory) })
    }
}

/// What is guessed of the state of a stage on a cloud of its own.
fn guess<S: HasGas<D>, const D: usize>(
    solver: &Solver<S, D>,
    stage: &Stage,
    site: &Site<'_, D>,
    before: Option<&Stood<S, D>>,
    course: &Course<'_, S, D>,
    log: &Log<'_>,
) -> Option<Vec<f64>> {
    let transfer = |s: &Stood<S, D>, u: &[f64]| setup::transfer(&s.solver.system, u, &solver.system, site);
    let carry = |u: &[f64]| before.map_or_else(Vec::new, |s| transfer(s, u));
    let coarser = before.map(|s| Coarser { factor: s.stage.factor, state: &s.reached.state, carry: &carry });
    course.guess(stage, &solver.system, coarser.as_ref(), log)
}

/// A stage on a cloud of its own: from what is guessed, else from the state of the stage before it, else from the last state of
/// another run, else from the start of the case.
fn begun<S: HasGas<D>, const D: usize>(
    solver: Solver<S, D>,
    site: &Site<'_, D>,
    (guess, before): (Option<Vec<f64>>, Option<&Stood<S, D>>),
    other: Option<Saved<'static>>,
) -> Result<Begun<S, D>, RunError> {
    let state = match (guess, before, other) {
        (Some(guess), ..) => guess,
        (None, Some(before), _) => setup::transfer(&before.solver.system, &before.reached.state, &solver.system, site),
        (None, None, Some(other)) => setup::taken_over(site.case, &solver.system, other.state.into_owned())?,
        (None, None, None) => solver.system.start(),
    };
    Ok(Begun::fresh(solver, state))
}

/// The last point of a polar whose flow is known, where the last one failed.
fn last_known<'a, S: HasGas<D>, const D: usize>(
    course: &mut Course<'a, S, D>,
    site: &Site<'_, D>,
    assemble: impl Fn(Fluid<D>) -> S,
    log: &mut Log<'a>,
) -> Result<Stood<S, D>, RunError> {
    let (stage, state) = course.last()?;
    let site = Site { case: course.case(&stage), ..*site };
    course.enter(&stage, site.surface, log);
    log.forget_clouds();
    let solver = match course.take(&stage, &site)? {
        Some(solver) => solver,
        None => setup::solver(&site, &stage, &[], None)?.with(assemble),
    };
    let frame = solver.system.frame(&Instant::still(0.0), &state);
    Ok(Stood { stage, solver, reached: Reached::at(frame, state) })
}
