//! A run on its way through its stages.
use std::sync::Arc;

use super::super::accuracy;
use super::super::cost;
use super::super::course::{Course, Next};
use super::super::keeper::{Camera, Keeper};
use super::super::look::load_axes;
use super::super::monitor::Monitor;
use super::super::recipe;
use super::super::record::saved::{Position, flatten};
use super::super::record::work::Clock;
use super::super::record::{Log, Scales};
use super::super::setup::{self, Solver};
use super::super::stage::{Stage, Task, describe};
use super::super::studies::{self, Reached, Start, Turn};
use super::super::time_left::Portion;
use super::end::GasFlow;
use super::start::{Opening, StageStart};
use super::{Origin, Solved, Way};
use crate::case::Case;
use crate::cloud::Cloud;
use crate::cloud::sources::Source;
use crate::coupling::Marches;
use crate::problem::{ProblemIn, RunError, check_motion, numerics, spacing, spec};
use crate::scheme::Fluid;
use crate::system::{Instant, System};

/// Makes the system of a problem from the gas on a cloud.
pub(super) type Assemble<S, const D: usize> = fn(&ProblemIn<D>, Fluid<D>) -> S;

/// The end of a stage: its solver and where it stands.
pub(super) struct StageEnd<S: System, const D: usize> {
    pub(super) stage: Stage,
    pub(super) solver: Solver<S, D>,
    pub(super) reached: Reached<S>,
}

/// All stages of a run.
pub(super) struct Stages<'a, S: Marches<D>, const D: usize> {
    problem: ProblemIn<D>,
    assemble: Assemble<S, D>,
    camera: Option<Arc<dyn Camera<D>>>,
    /// Bodies on springs stay where they begin.
    held: bool,
    /// Share of the work that the flow takes.
    scope: Portion,
    stages: Vec<Stage>,
    /// Number of the present stage.
    present: usize,
    /// What its cloud is refined at.
    sources: Vec<Source<D>>,
    course: Course<S, D>,
    opening: Opening<D>,
    /// Fluid particles of the cloud of the case, where that is built.
    particles: Option<usize>,
    previous: Option<StageEnd<S, D>>,
    log: Log<'a>,
    clock: Clock,
}

impl<'a, S: Marches<D> + 'a, const D: usize> Stages<'a, S, D> {
    /// The stages of a problem, at their beginning or where the run was stopped.
    pub(super) fn begin(
        problem: ProblemIn<D>,
        assemble: Assemble<S, D>,
        (Way { origin, keeper, held, share }, camera): (Way, Option<Arc<dyn Camera<D>>>),
        monitor: &'a mut dyn Monitor,
    ) -> Result<Self, RunError> {
        let clock = Clock::start();
        let (stages, mut opening) = opening(&problem, keeper.as_deref(), origin, monitor)?;
        let case = problem.shared_case();
        let scales = Scales { axes: load_axes(&case, problem.surface()), period: problem.motions().period() };
        let described = problem.described().to_vec();
        let mut log = Log::open(case, keeper, scales, opening.checkpoint(), described, monitor)?;
        if let Some(cloud) = opening.cloud() {
            log.note(&describe(&stages, cloud.n_fluid));
            accuracy::too_few(problem.case(), cloud.n_real()).iter().for_each(|few| log.note(few));
            log.begin_point(true);
        }
        let particles = opening.cloud().map(|cloud| cloud.n_fluid);
        let (present, sources, kept) = opening.standing();
        let course = Course::of(&problem, kept);
        let scope = Portion { own: share, ..Portion::whole(0.0) };
        let previous = None;
        Ok(Self {
            problem,
            assemble,
            camera,
            held,
            scope,
            stages,
            present,
            sources,
            course,
            opening,
            particles,
            previous,
            log,
            clock,
        })
    }

    /// Goes through all of them.
    pub(super) fn solve(mut self) -> Result<Solved<'a>, RunError> {
        while let Some(stage) = self.stages.get(self.present).copied() {
            if !self.stage(&stage)? {
                return Ok(Err(self.log.record.iteration));
            }
        }
        let end = match self.previous.take() {
            Some(end) => end,
            None => self.last_known()?,
        };
        let problem = self.course.problem(&end.stage);
        let before = self.scope.own;
        Ok(Ok(Box::new(GasFlow {
            problem,
            root: self.problem,
            end,
            log: self.log,
            clock: self.clock,
            camera: self.camera,
            before,
        })))
    }

    /// One of them; false when told to stop.
    fn stage(&mut self, stage: &Stage) -> Result<bool, RunError> {
        let problem = self.enter(stage);
        let (sources, assemble) = (std::mem::take(&mut self.sources), self.assemble);
        let build = |ready| Ok(setup::solver(&problem, stage, &sources, ready)?.with(|gas| assemble(&problem, gas)));
        let StageStart { mut solver, start } =
            self.opening.begin((stage, &problem), build, self.previous.take(), &mut self.course, &self.log)?;
        let flat = flatten(&sources);
        self.sources = sources;
        let (stages, kept) = (&self.stages[..], self.course.kept());
        let at = &Position { stage: self.present, stages, sources: &flat, kept };
        let turn = Turn { camera: self.camera.as_deref(), at };
        let reached = match study((self.problem.case(), self.held), &mut solver, start, &turn, &mut self.log) {
            Ok(Some(reached)) => reached,
            Ok(None) => return Ok(false),
            Err(why) => {
                self.course.shelve(stage, solver);
                let multiples = self.problem.motions().multiples();
                let at = (self.present, &mut self.stages);
                self.present = self.course.failed(at, why, &multiples, &mut self.log)?;
                return Ok(true);
            }
        };
        if let Some(next) = turn.next().filter(|next| next.cycle > stage.cycle && !reached.enough) {
            self.sources = setup::adapted(&problem, [stage, next], &solver.system, &reached.state);
        }
        self.course.keep(self.present, &self.stages, &reached, &flat);
        self.follow(StageEnd { stage: *stage, solver, reached })?;
        Ok(true)
    }

    /// A stage begins: the problem at its point.
    fn enter(&mut self, stage: &Stage) -> Arc<ProblemIn<D>> {
        let problem = self.course.problem(stage);
        self.course.enter(stage, &mut self.log);
        self.log.record.warnings.clear();
        let at = (self.present, &self.stages[..]);
        let portion = cost::portion(self.problem.case(), at, self.particles, (D, self.log.period));
        self.log.portion = portion.within(&self.scope);
        let shares = |before: &StageEnd<S, D>| stage.shares_cloud(&before.stage);
        if !self.course.holds(stage) && !self.previous.as_ref().is_some_and(shares) {
            self.log.doing(&stage.building());
        }
        problem
    }

    /// A stage is over: turns to the one that follows.
    fn follow(&mut self, end: StageEnd<S, D>) -> Result<(), RunError> {
        let found = (&end.solver.system, &end.reached);
        match self.course.next(self.present, &self.stages, found, &mut self.log)? {
            Next::Stage(next) => self.present = next,
            Next::Back(back, before) => {
                self.sources = before;
                self.stages.insert(self.present + 1, back);
                self.present += 1;
            }
            Next::Point(first) => {
                self.present = first;
                self.course.shelve(&end.stage, end.solver);
                return Ok(());
            }
        }
        self.previous = Some(end);
        Ok(())
    }

    /// The last point of a polar whose flow is known, where the last one failed.
    fn last_known(&mut self) -> Result<StageEnd<S, D>, RunError> {
        let (stage, state) = self.course.last()?;
        let problem = self.course.problem(&stage);
        self.course.enter(&stage, &mut self.log);
        self.log.forget_clouds();
        let solver = match self.course.take(&stage, &problem)? {
            Some(solver) => solver,
            None => setup::solver(&problem, &stage, &[], None)?.with(|gas| (self.assemble)(&problem, gas)),
        };
        let frame = solver.system.frame(&Instant::still(0.0), &state);
        Ok(StageEnd { stage, solver, reached: Reached::at(frame, state) })
    }
}

/// Does what a stage is for, with bodies on springs `held` where they begin; `None` when told to stop.
fn study<S: Marches<D>, const D: usize>(
    (case, held): (&Case, bool),
    solver: &mut Solver<S, D>,
    start: Start,
    turn: &Turn<'_, D>,
    log: &mut Log<'_>,
) -> Result<Option<Reached<S>>, RunError> {
    solver.system.hold_bodies(turn.stage().task == Task::Relax && (held || case.is_unsteady()));
    let plan = || numerics::balance(case).ok_or(RunError::NoStage);
    match turn.stage().task {
        Task::Relax => {
            let steady = numerics::relaxation(case).ok_or(RunError::NoStage)?;
            studies::relax(&solver.system, &steady, start, turn, log)
        }
        Task::March => {
            let marching = numerics::marching(case, log.period, D)?.ok_or(RunError::NoStage)?;
            studies::march(solver, &marching, start, turn, log)
        }
        Task::Lead => {
            let next = turn.next().ok_or(RunError::NoStage)?;
            studies::lead(&solver.system, plan()?, next.instances() / 2, start.into_state(), log)
        }
        Task::Balance { .. } => studies::balance(solver, plan()?, start, turn, log),
    }
}

/// The stages of a run, and what the first of them begins with.
fn opening<const D: usize>(
    problem: &ProblemIn<D>,
    keeper: Option<&dyn Keeper>,
    origin: Origin,
    monitor: &mut dyn Monitor,
) -> Result<(Vec<Stage>, Opening<D>), RunError> {
    let other = match origin {
        Origin::Own(saved) => return Ok((saved.stages.clone(), Opening::at_checkpoint(*saved))),
        Origin::Other(other) => Some(*other),
        Origin::Case => None,
    };
    let cloud = cloud(problem, keeper, monitor)?;
    let case = problem.case();
    let stages = match &other {
        Some(o) => recipe::plan_from(case, &o.stages[o.stage]),
        None => {
            let sizes = spacing::sizes(case, problem.surface(), cloud.n_real());
            let harmonics = problem.motions().multiples().last().copied().unwrap_or(1);
            recipe::plan(case, (cloud.n_fluid, &sizes), D, harmonics)
        }
    };
    Ok((stages, Opening::on(cloud, other)))
}

/// The cloud of the case; tells what is worth knowing of it and of the motion on it.
fn cloud<const D: usize>(
    problem: &ProblemIn<D>,
    keeper: Option<&dyn Keeper>,
    monitor: &mut dyn Monitor,
) -> Result<Cloud<D>, RunError> {
    let (case, motions) = (problem.case(), problem.motions());
    monitor.doing("building the cloud of the case", &Portion::whole(0.0));
    let cloud = Cloud::build(&spec(case), problem.surface(), &[])?;
    keeper.map_or(Ok(()), |keeper| keeper.check_room(case, cloud.n_real(), D, motions.period()))?;
    cloud.notes.iter().cloned().chain(cloud.early_ends()).for_each(|n| monitor.note(&n));
    check_motion(case, &cloud, motions)?.iter().for_each(|n| monitor.warn(n));
    numerics::marching(case, motions.period(), D)?;
    Ok(cloud)
}
