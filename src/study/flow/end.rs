//! The end of a flow: forces about it, and what is told of it.
use std::sync::Arc;

use super::super::doubts;
use super::super::found::{Found, Names, Spent};
use super::super::keeper::{Camera, End};
use super::super::look::{GasView, LoadFrame, field, momentum, span_load, span_loads, wake_planes};
use super::super::record::work::Clock;
use super::super::record::{Log, solid_end};
use super::super::solids::snapshot;
use super::super::solution::Solution;
use super::super::studies::{ForceSource, SmallMotion};
use super::super::time_left::Portion;
use super::stages::StageEnd;
use super::{Bars, Ended, Flow};
use crate::claims::Loops;
use crate::coupling::Marches;
use crate::problem::{ProblemIn, RunError, spacing};
use crate::system::System;

/// The flow at the end of a run.
pub(super) struct GasFlow<'a, S: Marches<D>, const D: usize> {
    /// The problem at the last point of a polar, or the only one.
    pub(super) problem: Arc<ProblemIn<D>>,
    /// The problem of the run.
    pub(super) root: ProblemIn<D>,
    pub(super) end: StageEnd<S, D>,
    pub(super) log: Log<'a>,
    pub(super) clock: Clock,
    /// Who writes fields.
    pub(super) camera: Option<Arc<dyn Camera<D>>>,
    /// Share of the work that the flow took.
    pub(super) before: f64,
}

impl<'a, S: Marches<D> + 'a, const D: usize> Flow<'a> for GasFlow<'a, S, D> {
    fn forces(&mut self) -> Result<(Box<dyn ForceSource + '_>, &mut Log<'a>), RunError> {
        let Self { root, end, log, before, .. } = self;
        log.portion = Portion { before: *before, own: 1.0 - *before, ..Portion::whole(0.0) };
        Ok((source(root, end, &log.axes)?, log))
    }

    fn source(&self) -> Result<Box<dyn ForceSource + '_>, RunError> {
        source(&self.root, &self.end, &self.log.axes)
    }

    fn conclude(&mut self, bars: Option<Bars<'_>>) -> Result<Ended, RunError> {
        let Self { problem, root, end, log, clock, camera, .. } = self;
        let (case, surface) = (problem.case(), problem.surface());
        let Some((frame, state)) = &end.reached.end else { return Err(RunError::NoStage) };
        let gas = &GasView::of(&end.solver.system, frame, state);
        let (solved, mut work) = (clock.wall_seconds(), gas.fluid.work());
        let balance = momentum::around(case, &log.axes, gas, &mut work, case.is_unsteady());
        let view = gas.seen(&mut work);
        let (axes, names) = (log.axes.axes(&view), Names::of(surface));
        let wake = match case.is_unsteady() {
            true => Vec::new(),
            false => wake_planes(&view, surface, case, &axes),
        };
        let strips = span_loads(case, &view, surface, &axes);
        let span_load = span_load(case, &view, surface, &strips, &axes);
        let found = Found { case, view, surface, axes, names, balance, strips, span_load, wake };
        let mut summary = found.summary(log, gas.state, &Spent { clock, solved });
        if let Some(bars) = bars
            && !bars(&mut summary, log)?
        {
            return Ok(Err(log.record.iteration));
        }
        let solid = end.solver.system.solid_snapshot(frame, state);
        summary.structures.solid = solid.as_ref().map(|at| solid_end(at, log));
        summary.conditions.cloud = spacing::of_stage(case, end.stage.factor);
        let doubts = doubts::told(case, (&summary, surface), log.record.trace.largest(), solid.as_ref());
        doubts.iter().for_each(|d| log.warn(d));
        summary.convergence.warnings.clone_from(&log.record.warnings);
        let (field, walls) = (field(case, &view), found.walls());
        if let Some(camera) = camera {
            let (chosen, refined) = (summary.conditions.cloud != root.given().cloud, end.stage.cycle > 0);
            let solid = solid.as_ref();
            let end = End { found: &found, field: &field, walls: &walls, solid, chosen, refined };
            camera.end(end, &mut summary, log)?;
        }
        let loops = log.case_period().map_or_else(Loops::default, |p| log.record.trace.loops(p));
        let history = std::mem::take(&mut log.record.history);
        let solid = solid.map(|at| snapshot(at.solid, &at.state()));
        Ok(Ok(Solution { summary, field, walls, solid, history, loops }))
    }
}

/// Forces of small motions about the end of a flow, with coefficients in these axes.
fn source<'s, S: Marches<D>, const D: usize>(
    problem: &ProblemIn<D>,
    end: &'s StageEnd<S, D>,
    axes: &LoadFrame,
) -> Result<Box<dyn ForceSource + 's>, RunError> {
    let (_, state) = end.reached.end.as_ref().ok_or(RunError::NoStage)?;
    Ok(Box::new(SmallMotion::new(&end.solver.system, state, (axes, problem.case().freezes_limiter()))))
}
