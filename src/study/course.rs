//! The course of a run through its stages: points of a polar, which leave something to one another, and the way back.
//!
//! Where the last cloud of a family has no steady flow, the run goes back to the one before, whose flow came to rest: to the state that was
//! kept of it, on the cloud of the sources that were kept of it.
//!
//! A polar is steady states at many free streams in one run.
//! The clouds do not depend on the free stream, so each is built once and kept. Every point goes through the stages of a case: from
//! its coarsest cloud to its finest. The coarsest starts from the point before it, or at the first angle of a Mach number from the
//! first angle of the Mach number before; two points at one Mach number are carried on along the line through them,
//!
//! u = u₁ + (u₁ − u₂)(α − α₁)/(α₁ − α₂).
//!
//! A finer cloud h starts from the coarser one H of the same point, which knows where its shocks are, with what the finer cloud changed
//! at the point before it: u = T u_H + (u₁ − T u₁,H), T the transfer by the solver's own fit. The state of the point before alone serves
//! worse: its shocks have to travel.
//!
//! A point that fails or does not converge from there is tried once from rest; one that does not from rest is told with its reason,
//! and the polar goes on.
use std::sync::Arc;

use super::look::{GasView, load_axes, momentum};
use super::recipe;
use super::record::Log;
use super::record::family;
use super::record::saved::{Kept, raised};
use super::setup::Solver;
use super::stage::Stage;
use super::studies::Reached;
use crate::case::Polar;
use crate::cloud::sources::Source;
use crate::observe::convergence::Convergence;
use crate::problem::coarser::times_the_spacing;
use crate::problem::{ProblemIn, RunError, in_stream, spacing};
use crate::record::summary::PolarPoint;
use crate::scheme::HasGas;
use crate::system::{Instant, System};

/// What the points of a polar leave to one another; a single case is one point, which nothing is kept for.
pub(crate) struct Course<S, const D: usize> {
    /// The problem at each point.
    points: Vec<Arc<ProblemIn<D>>>,
    /// Angles at each Mach number.
    angles: usize,
    /// Solvers on the clouds that all points share, with the factor on their spacing.
    shelf: Vec<(f64, Solver<S, D>)>,
    /// States of points that are over.
    kept: Vec<Kept>,
    /// Why the last point that failed did.
    failure: Option<RunError>,
}

/// What follows a stage.
pub(crate) enum Next<const D: usize> {
    /// A stage that goes on from it, or none where it is the last one.
    Stage(usize),
    /// A new stage, on the cloud before, and the sources of that cloud.
    Back(Stage, Vec<Source<D>>),
    /// The first stage of a point of a polar.
    Point(usize),
}

/// The coarser cloud that a stage comes from.
pub(crate) struct Coarser<'a> {
    /// Factor on its spacing.
    pub(crate) factor: f64,
    /// The state that was reached there.
    pub(crate) state: &'a [f64],
    /// Takes a state from there to the cloud of the stage.
    pub(crate) carry: &'a dyn Fn(&[f64]) -> Vec<f64>,
}

impl<S: HasGas<D>, const D: usize> Course<S, D> {
    /// The points of a problem, with the states that a checkpoint kept.
    pub(crate) fn of(problem: &ProblemIn<D>, kept: Vec<Kept>) -> Self {
        let angles = problem.case().polar.as_ref().map_or(1, Polar::angles);
        let points = problem.points().into_iter().map(Arc::new).collect();
        Self { points, angles, shelf: Vec::new(), kept, failure: None }
    }

    /// The problem at the point of a stage.
    pub(crate) fn problem(&self, stage: &Stage) -> Arc<ProblemIn<D>> {
        Arc::clone(&self.points[stage.point.unwrap_or(0)])
    }

    /// States of points that are over.
    pub(crate) fn kept(&self) -> &[Kept] {
        &self.kept
    }

    /// The state that a stage starts from, where a neighbouring point says more of it than the coarser cloud alone.
    pub(crate) fn guess(
        &self,
        stage: &Stage,
        system: &S,
        coarser: Option<&Coarser<'_>>,
        log: &Log<'_>,
    ) -> Option<Vec<f64>> {
        // what a damaged checkpoint kept of another cloud is no start
        let on_cloud = |k: &&Kept| k.state.len() == system.len();
        if stage.back {
            return self.own(stage).filter(on_cloud).map(|k| k.state.clone());
        }
        if log.record.polar.from_rest {
            return None;
        }
        let near = self.neighbour(stage).filter(on_cloud)?;
        let sound = |u: &Vec<f64>| system.check(&system.frame(&Instant::still(0.0), u), u).is_ok();
        match coarser {
            None => Some(self.along(stage, near).filter(sound).unwrap_or_else(|| near.state.clone())),
            Some(coarser) => self.corrected(stage, near, coarser).filter(sound),
        }
    }

    /// The state of the coarser cloud with what the finer one changed at `near`; `None` where that is no point of the same row.
    fn corrected(&self, stage: &Stage, near: &Kept, coarser: &Coarser<'_>) -> Option<Vec<f64>> {
        let on_cloud = |k: &&Kept| k.factor == coarser.factor && k.state.len() == coarser.state.len();
        let same = |k: &&Kept| on_cloud(k) && k.point == near.point;
        let before = self.kept.iter().find(same).filter(|_| self.in_row(stage, near))?;
        let [own, other] = [coarser.state, &before.state].map(|u| (coarser.carry)(u));
        Some(own.iter().zip(&near.state).zip(&other).map(|((own, near), other)| own + (near - other)).collect())
    }

    /// True for a point at the Mach number of a stage.
    fn in_row(&self, stage: &Stage, kept: &Kept) -> bool {
        stage.point.is_some_and(|point| point / self.angles == kept.point / self.angles)
    }

    /// The last point of the row before that of a stage whose state on its cloud is known, else the first of the row before.
    fn neighbour(&self, stage: &Stage) -> Option<&Kept> {
        let point = stage.point.filter(|_| stage.cycle == 0)?;
        let on_cloud = || self.kept.iter().filter(|k| k.factor == stage.factor && k.point < point);
        let row = on_cloud().filter(|k| k.point / self.angles == point / self.angles);
        row.max_by_key(|k| k.point).or_else(|| on_cloud().min_by_key(|k| k.point))
    }

    /// The line through `near` and the point before it, at the angle of a stage; `None` across Mach numbers.
    fn along(&self, stage: &Stage, near: &Kept) -> Option<Vec<f64>> {
        let on_cloud = |k: &&Kept| k.factor == stage.factor && k.state.len() == near.state.len();
        let line = |k: &&Kept| on_cloud(k) && k.point < near.point && self.in_row(stage, k);
        let before = self.kept.iter().filter(line).max_by_key(|k| k.point)?;
        let angle = |point: usize| self.points[point].case().flow.alpha.0;
        let part = (angle(stage.point?) - angle(near.point)) / (angle(near.point) - angle(before.point));
        Some(near.state.iter().zip(&before.state).map(|(a, b)| a + part * (a - b)).collect())
    }

    /// What is kept of the flow of a stage on its cloud.
    fn own(&self, stage: &Stage) -> Option<&Kept> {
        self.kept.iter().find(|k| k.factor == stage.factor && k.point == stage.point.unwrap_or(0))
    }

    /// Keeps the state at the end of stage `k`, and the `sources` of its cloud: for points to come, or to go back to from the last
    /// cloud of a family.
    pub(crate) fn keep(&mut self, k: usize, stages: &[Stage], reached: &Reached<S>, sources: &[f64]) {
        let stage = &stages[k];
        let kept = |state: &[f64]| Kept {
            factor: stage.factor,
            point: stage.point.unwrap_or(0),
            state: state.to_vec(),
            sources: sources.to_vec(),
        };
        let Some(point) = stage.point else {
            if k + 1 < stages.len() {
                let end = reached.end.as_ref().filter(|_| spacing::asked(self.points[0].case()).is_some());
                self.kept = end.map(|(_, state)| kept(state)).into_iter().collect();
            }
            return;
        };
        if stage.cycle > 0 {
            return;
        }
        self.kept.retain(|k| k.factor != stage.factor || k.point != point);
        self.kept.push(kept(&reached.state));
        // the first of a row serves the next row, the last two of the row the next points
        let (row, on) = (point - point % self.angles, stage.factor);
        let first = self.kept.iter().filter(|k| k.factor == on && k.point >= row).map(|k| k.point).min();
        let mut last: Vec<usize> = self.kept.iter().filter(|k| k.factor == on).map(|k| k.point).collect();
        last.sort_unstable();
        let last = last.split_off(last.len().saturating_sub(2));
        self.kept.retain(|k| k.factor != on || Some(k.point) == first || last.contains(&k.point));
    }

    /// What follows stage `k`.
    pub(crate) fn next(
        &self,
        k: usize,
        stages: &[Stage],
        (system, reached): (&S, &Reached<S>),
        log: &mut Log<'_>,
    ) -> Result<Next<D>, RunError> {
        let last = after(k, stages) == k + 1;
        if !last && !reached.enough {
            return Ok(Next::Stage(k + 1));
        }
        if last && let Some((stage, sources)) = self.back(k, stages, reached, log) {
            return Ok(Next::Back(stage, sources));
        }
        let next = self.over(k, stages, (system, reached), log)?;
        Ok(if next < stages.len() { Next::Point(next) } else { Next::Stage(next) })
    }

    /// The stage that goes back to the cloud before, whose flow came to rest, where on that of stage `k`, the last of its family, it did
    /// not; and the sources of that cloud.
    fn back(
        &self,
        k: usize,
        stages: &[Stage],
        reached: &Reached<S>,
        log: &mut Log<'_>,
    ) -> Option<(Stage, Vec<Source<D>>)> {
        let stage = &stages[k];
        let tried = stage.point.is_none() || log.record.polar.from_rest;
        if !reached.unsteady || !tried || !family::has_steady_before(stage, log) {
            return None;
        }
        let before = |s: &&Stage| s.point == stage.point && s.factor > stage.factor;
        let back = Stage { back: true, ..*stages[..k].iter().rfind(before)? };
        let sources = raised(&self.own(&back)?.sources);
        let why = log.record.reason.clone().unwrap_or_default();
        log.note(&format!("{why}: the run goes back to the cloud before, where the flow came to rest"));
        Some((back, sources))
    }

    /// True where the solver on the cloud of a stage is on the shelf.
    pub(crate) fn holds(&self, stage: &Stage) -> bool {
        stage.cycle == 0 && self.shelf.iter().any(|(factor, _)| *factor == stage.factor)
    }

    /// The solver on the cloud of a stage, where it is on the shelf, in the free stream of its point.
    pub(crate) fn take(&mut self, stage: &Stage, problem: &ProblemIn<D>) -> Result<Option<Solver<S, D>>, RunError> {
        let found = self.shelf.iter().position(|(factor, _)| *factor == stage.factor && stage.cycle == 0);
        let Some((_, mut solver)) = found.map(|k| self.shelf.swap_remove(k)) else { return Ok(None) };
        let gas = in_stream(problem, solver.system.gas())?;
        solver.system.set_gas(gas);
        Ok(Some(solver))
    }

    /// Puts a solver on the shelf, where points to come have a use for it.
    pub(crate) fn shelve(&mut self, stage: &Stage, solver: Solver<S, D>) {
        if stage.point.is_some() && stage.cycle == 0 {
            self.shelf.push((stage.factor, solver));
        }
    }

    /// The next point begins: its first stage.
    fn begin(&self, k: usize, stages: &[Stage], log: &mut Log<'_>) -> usize {
        let next = after(k, stages);
        if next < stages.len() {
            log.begin_point(self.kept.is_empty());
        }
        next
    }

    /// A point begins: what is said and measured from now on is in its free stream.
    pub(crate) fn enter(&self, stage: &Stage, log: &mut Log<'_>) {
        let Some(point) = stage.point else { return };
        let problem = self.problem(stage);
        let axes = load_axes(problem.case(), problem.surface());
        log.turn_to(problem.shared_case(), axes, [point, self.points.len()]);
    }

    /// A stage failed: the next stage, from the start of the case, after a cloud that only gives a start, with a steady flow before any
    /// harmonics, of which the motion has `multiples`; the first stage of the same point of a polar, from rest, or of the next one.
    pub(crate) fn failed(
        &mut self,
        (k, stages): (usize, &mut Vec<Stage>),
        problem: RunError,
        multiples: &[usize],
        log: &mut Log<'_>,
    ) -> Result<usize, RunError> {
        let stage = stages[k];
        if stage.factor > 1.0 && !stage.back && stage.point.is_none() && matches!(problem, RunError::Time { .. }) {
            log.note(&format!(
                "the cloud with {} gives no start, for {}; the next one begins without it",
                times_the_spacing(stage.factor),
                first_line(&problem)
            ));
            if stages.get(k + 1).is_some_and(|next| next.instances() > 1) {
                // the finer clouds have no steady flow to begin a balance with
                stages.truncate(k + 1);
                stages.extend(recipe::balance_from_rest(self.points[0].case(), multiples));
            }
            return Ok(k + 1);
        }
        let (Some(_), RunError::Time { .. }) = (stage.point, &problem) else { return Err(problem) };
        if !log.record.polar.from_rest {
            return Ok(again(k, stages, &first_line(&problem), log));
        }
        let row = PolarPoint { reason: first_line(&problem), ..self.row(&stage, log) };
        self.failure = Some(problem);
        self.tell(row, log)?;
        Ok(self.begin(k, stages, log))
    }

    /// A point is over, at the end of stage `k`; the stage that follows: the first of the same point where it did not converge from
    /// its neighbour.
    fn over(
        &self,
        k: usize,
        stages: &[Stage],
        (system, reached): (&S, &Reached<S>),
        log: &mut Log<'_>,
    ) -> Result<usize, RunError> {
        let (Some((frame, state)), true) = (&reached.end, stages[k].point.is_some()) else { return Ok(stages.len()) };
        if !log.record.converged && !log.record.polar.from_rest {
            let why = log.record.reason.clone().unwrap_or_default();
            return Ok(again(k, stages, &why, log));
        }
        let stage = &stages[k];
        let (problem, gas) = (self.problem(stage), GasView::of(system, frame, state));
        let case = problem.case();
        let mut work = gas.fluid.work();
        let balance = momentum::around(case, &log.axes, &gas, &mut work, false);
        let axes = log.axes.axes(&gas.walls(&mut work));
        let family = case.accuracy.and_then(|asked| Convergence::of(&log.record.clouds, asked.loads.0));
        let record = &log.record;
        let row = PolarPoint {
            loads: gas.coefficients(&log.axes, &mut work),
            loads_momentum_balance: balance.map(|b| axes.coefficients(&b.load)),
            loads_error: family.as_ref().map(Convergence::half_widths),
            within_accuracy: family.as_ref().map(Convergence::reached),
            long_bars: family.as_ref().map_or_else(Vec::new, Convergence::long_bars),
            particles: gas.fluid.discretisation.cloud.n_real(),
            residual_drop: -record.drop.log10(),
            converged: record.converged,
            reason: record.reason.clone().filter(|_| !record.converged).unwrap_or_default(),
            ..self.row(stage, log)
        };
        self.tell(row, log)?;
        Ok(self.begin(k, stages, log))
    }

    /// What is known of a point however it ends.
    fn row(&self, stage: &Stage, log: &Log<'_>) -> PolarPoint {
        let (iterations, cpu_seconds) = log.record.polar.spent(log.record.iteration, log.seconds()[0]);
        let from_rest = log.record.polar.from_rest;
        PolarPoint { iterations, cpu_seconds, from_rest, ..PolarPoint::of(&self.problem(stage).case().flow) }
    }

    fn tell(&self, row: PolarPoint, log: &mut Log<'_>) -> Result<(), RunError> {
        let number = log.record.polar.points.len() + 1;
        log.note(&format!("point {number} of {}: {}", self.points.len(), row.told()));
        log.end_point(row)
    }

    /// The last point whose flow is known, on the finest cloud that all points share; what made the last one fail where there is none.
    pub(crate) fn last(&mut self) -> Result<(Stage, Vec<f64>), RunError> {
        let fine = |k: &&Kept| (std::cmp::Reverse(k.factor.to_bits()), k.point);
        let Some(kept) = self.kept.iter().max_by_key(fine) else {
            return Err(self.failure.take().unwrap_or(RunError::NoStage));
        };
        let stage = Stage { factor: kept.factor, point: Some(kept.point), ..Stage::PLAIN };
        Ok((stage, kept.state.clone()))
    }
}

/// The point of stage `k` begins again, from rest: its first stage.
fn again(k: usize, stages: &[Stage], why: &str, log: &mut Log<'_>) -> usize {
    log.note(&format!("the point is tried from rest: from its neighbour {why}"));
    log.record.polar.from_rest = true;
    log.forget_clouds();
    stages.iter().position(|s| s.point == stages[k].point).unwrap_or(k)
}

/// Index of the first stage of the point after that of stage `k`.
fn after(k: usize, stages: &[Stage]) -> usize {
    (k..stages.len()).find(|j| stages[*j].point != stages[k].point).unwrap_or(stages.len())
}

fn first_line(problem: &RunError) -> String {
    problem.to_string().lines().next().unwrap_or_default().to_owned()
}
