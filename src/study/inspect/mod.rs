//! What is known of a problem before it is solved: its cloud, what was understood of its case, what a run takes.
mod pilot;
mod solids;
mod trial;
mod understood;

use std::time;

use serde::Serialize;

pub use solids::{SolidReport, inspect_structure};
pub use understood::{Aeroelastic, BodyBox, Understood, UnderstoodFlutter, UnderstoodGaf, UnderstoodStructure};

use super::accuracy;
use super::cost::{Cost, OF_COLUMN, Sized};
use super::look::load_axes;
use super::look::raster::pixels;
use super::setup::{self, Solver};
use super::stage::Stage;
use crate::case::{Case, GafMethod};
use crate::cloud::layout::{capped, count};
use crate::cloud::{Cloud, CloudSpec};
use crate::geometry::Surface;
use crate::math::reduce::maximum;
use crate::problem::{ProblemIn, Remark, RunError, check_motion, numerics, rough, spacing};
use crate::scheme::{Fluid, Frame};
use crate::system::{Instant, System};

/// Evaluations timed for the estimate.
const TIMED: u32 = 10;

/// Particles in space beyond which `check` looks at a coarser cloud: a second or two to build.
const QUICK: f64 = 30_000.0;
/// Factors on the spacing of such a cloud.
const COARSER: [f64; 4] = [4.0 / 3.0, 2.0, 8.0 / 3.0, 4.0];
/// Work of a steady flow that small motions are about, which comes to rest by more orders than others, over that of a usual one.
const SETTLED: f64 = 1.4;
/// Equilibria that the static trim of a flutter boundary seeks, about.
const TRIMS: f64 = 4.0;

/// What is known of a cloud before a run.
#[derive(Clone, Debug, Serialize)]
pub struct CloudReport {
    /// Particles without images.
    pub particles: usize,
    /// Fluid particles.
    pub fluid: usize,
    /// Interface particles.
    pub interface: usize,
    /// Particles on the sides of the domain.
    pub outer: usize,
    /// Neighbours of a particle.
    pub neighbours: NeighbourCount,
    /// Distances between neighbours.
    pub spacing: SpacingRange,
    /// Largest condition number of a fit.
    pub worst_condition: f64,
    /// What was understood of the case: stream, reference values, bodies, times.
    pub understood: Understood,
    /// Seconds that building took.
    pub seconds: f64,
    /// What a run will take; where it may end on a coarser cloud because the loads are known well enough, what it takes at most.
    pub cost: Cost,
    /// What such a run takes at least.
    pub least: Option<Cost>,
    /// Bodies made of particles; absent where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub structure: Option<solids::SolidReport>,
    /// What `alula gaf` will take, where the case asks for it.
    pub gaf: Option<Cost>,
    /// What `alula flutter` will take, where the case asks for it.
    pub flutter: Option<Cost>,
    /// Factor on the spacing of the cloud that neighbours and conditioning were seen on, where that is a coarser one than the case's own,
    /// whose particles were counted on its background.
    pub seen_on: Option<f64>,
    /// What was repaired or assumed.
    pub notes: Vec<String>,
    /// What makes the results of a run doubtful.
    pub warnings: Vec<String>,
}

/// Neighbours of a particle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NeighbourCount {
    /// Least.
    pub least: usize,
    /// Mean.
    pub mean: f64,
    /// Most.
    pub most: usize,
}

/// Distances between neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SpacingRange {
    /// Smallest.
    pub finest: f64,
    /// Largest.
    pub coarsest: f64,
}

impl NeighbourCount {
    fn of<const D: usize>(cloud: &Cloud<D>) -> Self {
        let counts: Vec<usize> = (0..cloud.n_rows()).map(|i| cloud.neighbours.of(i).len()).collect();
        Self {
            least: counts.iter().copied().min().unwrap_or(0),
            mean: counts.iter().sum::<usize>() as f64 / counts.len().max(1) as f64,
            most: counts.iter().copied().max().unwrap_or(0),
        }
    }
}

impl SpacingRange {
    /// The range of a cloud whose spacing is smaller by `factor`.
    fn finer(self, factor: f64) -> Self {
        Self { finest: self.finest / factor, ..self }
    }

    fn of(spacing: &[f64]) -> Self {
        let widen = |s: Self, h: &f64| Self { finest: h.min(s.finest), coarsest: h.max(s.coarsest) };
        spacing.iter().fold(Self { finest: f64::INFINITY, coarsest: 0.0 }, widen)
    }
}

/// A problem that was looked at.
pub(crate) struct Inspected<const D: usize> {
    /// What is known of it.
    pub(crate) report: CloudReport,
    /// Its equations on the cloud that was seen.
    pub(crate) solver: Solver<Fluid<D>, D>,
}

/// Builds the cloud of a problem and judges it; `quickly`: in space a coarser one where that of the case has many particles.
pub(crate) fn inspect<const D: usize>(
    problem: &ProblemIn<D>,
    quickly: bool,
    began: time::Instant,
) -> Result<Inspected<D>, RunError> {
    let (case, surface, input) = (problem.case(), problem.surface(), problem.input());
    let (mut notes, mut warnings) = remarks(problem)?;
    let alone = &problem.without_structures();
    let motions = alone.motions();
    let seen = if quickly { sample_cloud(alone) } else { SampleCloud::PLAIN };
    let solver = setup::solver(alone, &Stage { factor: seen.factor, ..Stage::PLAIN }, &[], None)?;
    let seconds = began.elapsed().as_secs_f64();
    let (fluid, u) = (&solver.system, &solver.system.start());
    let mut work = fluid.work();
    let frame = fluid.frame(&Instant::still(0.0), u);
    let evaluation = seen.more * seconds_of_evaluation(fluid, &frame, u, &mut work);
    let fastest = || fastest_rate(fluid, &frame, u);
    let cloud = &fluid.discretisation.cloud;
    let n_fluid = (cloud.n_fluid as f64 * seen.more).round() as usize;
    let n_wall = (cloud.interface.len() as f64 * seen.factor.powi(D as i32 - 1)).round() as usize;
    let particles = n_fluid + n_wall + cloud.outer.len();
    notes.extend(seen.told(alone, cloud).into_iter().chain(accuracy::too_few(case, particles)));
    warnings.extend(check_motion(case, cloud, motions)?);
    let structure = solids::inspect_in_gas(case, input)?;
    notes.extend(problem.modes().words());
    warnings.extend(structure.iter().flat_map(|s| s.warnings.iter().cloned()));
    numerics::marching(case, motions.period(), D)?;
    let axes = (!cloud.interface.is_empty()).then(|| load_axes(case, surface).axes(&fluid.view(&frame, u, &mut work)));
    let period = motions.period();
    let pilot = pilot::fly(problem, n_fluid, period);
    let pixels = pixels(surface, &cloud.tree.bounds());
    let sizes = &spacing::sizes(case, surface, particles);
    warnings.extend(rough_on_the_finest(case, surface, sizes));
    let sized = Sized { case, particles, sizes, dimension: D, period, pixels, evaluation, pilot };
    let report = CloudReport {
        understood: Understood::of(case, surface, motions, axes.as_ref(), Aeroelastic::of(problem)),
        particles,
        fluid: n_fluid,
        interface: n_wall,
        outer: cloud.outer.len(),
        neighbours: NeighbourCount::of(cloud),
        spacing: SpacingRange::of(&cloud.spacing).finer(seen.factor),
        worst_condition: fluid.discretisation.operators.condition.iter().fold(0.0, |m, c| f64::from(*c).max(m)),
        seconds,
        cost: sized.cost(fastest),
        least: sized.least(),
        structure,
        gaf: cost_of_gaf(&sized, problem, axes.as_ref().map(|a| a.chord))?,
        flutter: cost_of_flutter(&sized, problem)?,
        seen_on: (seen.factor != 1.0).then_some(seen.factor),
        notes,
        warnings,
    };
    Ok(Inspected { report, solver })
}

/// Notes and warnings of opening a problem.
fn remarks<const D: usize>(problem: &ProblemIn<D>) -> Result<(Vec<String>, Vec<String>), RunError> {
    let (mut notes, mut warnings) = (Vec::new(), Vec::new());
    for remark in problem.remarks().iter().cloned().chain(problem.remarks_on_gaf_modes()?) {
        match remark {
            Remark::Note(text) => notes.push(text),
            Remark::Warning(text) => warnings.push(text),
        }
    }
    Ok((notes, warnings))
}

/// The cloud that is looked at.
#[derive(Clone, Copy)]
struct SampleCloud {
    /// Factor on the spacing of the case.
    factor: f64,
    /// Particles of the cloud of the case over those of this one.
    more: f64,
}

impl SampleCloud {
    const PLAIN: Self = Self { factor: 1.0, more: 1.0 };

    /// What is told of the cloud of the case: what `cloud` says where it is that one, else what is known without it.
    fn told<const D: usize>(&self, problem: &ProblemIn<D>, cloud: &Cloud<D>) -> Vec<String> {
        if self.factor == 1.0 {
            return [cloud.notes.clone(), cloud.early_ends()].concat();
        }
        problem.surface().and_then(|surface| capped(&CloudSpec::of_case(problem.case()), surface)).into_iter().collect()
    }
}

/// The cloud of the case, or in space a coarser one of its family, where that of the case has many particles and moves nothing: its
/// particles are counted on its background, which is a small part of the cost of the cloud.
fn sample_cloud<const D: usize>(problem: &ProblemIn<D>) -> SampleCloud {
    let case = problem.case();
    let cells = |factor: f64| {
        let spec = CloudSpec::<D>::of(&spacing::of_stage(case, factor), &case.boundary);
        count(&spec, problem.surface(), &[]).ok().map(|cells| cells as f64)
    };
    let moves = case.motion.is_some() || case.bodies.iter().any(|b| b.motion.is_some() || b.solid.is_some());
    if D == 2 || case.bodies.is_empty() || case.is_unsteady() || moves {
        return SampleCloud::PLAIN;
    }
    let Some(own) = cells(1.0).filter(|own| *own > QUICK) else { return SampleCloud::PLAIN };
    let fits = |factor: &f64| numerics::divides(&case.cloud, *factor);
    let all = COARSER.into_iter().filter(fits).filter_map(|factor| Some((factor, cells(factor)?)));
    let all: Vec<(f64, f64)> = all.collect();
    let quick = all.iter().find(|(_, n)| *n <= QUICK).or(all.last());
    quick.map_or(SampleCloud::PLAIN, |(factor, n)| SampleCloud { factor: *factor, more: own / n })
}

/// Time of an evaluation: the shortest of some, as the first one warms caches and threads up and others may be disturbed.
fn seconds_of_evaluation<const D: usize>(
    fluid: &Fluid<D>,
    frame: &Frame<D>,
    u: &[f64],
    work: &mut crate::scheme::Work<D>,
) -> f64 {
    let mut du = vec![0.0; u.len()];
    let one = |_| {
        let timer = time::Instant::now();
        fluid.rhs(frame, u, work, &mut du);
        timer.elapsed().as_secs_f64()
    };
    (0..TIMED).map(one).fold(f64::INFINITY, f64::min)
}

/// Bodies whose loads even the finest cloud of a family leaves a rough guess.
fn rough_on_the_finest<const D: usize>(
    case: &Case,
    surface: Option<&Surface<D>>,
    sizes: &dyn Fn(f64) -> f64,
) -> Vec<String> {
    let family = spacing::asked(case).map(|asked| accuracy::family(case, &asked, sizes, D)).unwrap_or_default();
    let finest = family.last().map(|stage| spacing::of_stage(case, stage.factor));
    finest.iter().flat_map(|on| rough(on, surface)).collect()
}

/// Greatest rate at which signals pass a particle, one over the longest stable step of a march.
fn fastest_rate<const D: usize>(fluid: &Fluid<D>, frame: &Frame<D>, u: &[f64]) -> f64 {
    let mut rate = vec![0.0; fluid.discretisation.cloud.n_fluid];
    fluid.rates(frame, u, &mut fluid.work(), &mut rate);
    maximum(rate.len(), |i| rate[i])
}

/// What the matrices of `[gaf]` take, where the case asks for them: a steady flow and linear systems about it, or two balances for each
/// mode and frequency.
fn cost_of_gaf<const D: usize>(
    own: &Sized<'_>,
    problem: &ProblemIn<D>,
    chord: Option<f64>,
) -> Result<Option<Cost>, RunError> {
    let Some(plan) = own.case.gaf.as_ref() else { return Ok(None) };
    if plan.method == GafMethod::Linear {
        let one = problem.about_steady_flow_of_gaf(plan)?;
        let columns = plan.reduced_frequencies.len() * plan.all_modes().count();
        return Ok(Some(of_small_motions(own, &one, (columns, plan.cloud_error))));
    }
    let mut all = Cost { bytes: 0.0, seconds: 0.0, disk: 0.0 };
    for &k in &plan.reduced_frequencies {
        for mode in plan.all_modes() {
            let length = plan.reduced_length.map_or(0.5 * chord.unwrap_or(1.0), |l| l.0);
            let period = std::f64::consts::TAU * length / (k * own.case.flow.reference().mach);
            let swinging = problem.in_motion_of_gaf(plan, mode, k, 1.0)?;
            let case = swinging.case();
            let one = Sized { case, period: Some(period), ..*own }.cost(|| 0.0);
            let seconds = all.seconds + 2.0 * one.seconds;
            all = Cost { bytes: all.bytes.max(one.bytes), seconds, disk: all.disk.max(one.disk) };
        }
    }
    Ok(Some(all))
}

/// What a flutter boundary takes, where the case asks for one: at each Mach number a steady flow and linear systems about it.
fn cost_of_flutter<const D: usize>(own: &Sized<'_>, problem: &ProblemIn<D>) -> Result<Option<Cost>, RunError> {
    let Some(plan) = problem.given().flutter.as_ref() else { return Ok(None) };
    let mach = plan.mach.first().copied().unwrap_or(problem.reference().mach);
    let one = problem.about_steady_flow(mach)?;
    let coordinates: usize = one.structures().iter().map(|body| body.structure.len()).sum();
    let columns = plan.expected() * coordinates;
    let each = of_small_motions(own, &one, (columns, plan.cloud_error));
    let rounds = plan.mach.len().max(1) as f64 * if plan.trim { TRIMS } else { 1.0 };
    Ok(Some(Cost { seconds: rounds * each.seconds, ..each }))
}

/// What `columns` of forces in small motion take about the steady flow of the case `one`, which is on a cloud of its own, and the same on a
/// coarser cloud where that is asked for an error.
fn of_small_motions<const D: usize>(
    own: &Sized<'_>,
    problem: &ProblemIn<D>,
    (columns, cloud_error): (usize, bool),
) -> Cost {
    let (one, surface) = (problem.given(), problem.surface());
    let cells = |case: &Case| count(&CloudSpec::<D>::of_case(case), surface, &[]).ok();
    let more = cells(one).zip(cells(own.case)).map_or(1.0, |(one, own)| one as f64 / own as f64);
    let particles = (own.particles as f64 * more).round() as usize;
    let (evaluation, sizes) = (own.evaluation * more, spacing::sizes(one, surface, particles));
    let steady = Sized { case: one, particles, sizes: &sizes, period: None, evaluation, ..*own }.cost(|| 0.0);
    let all = SETTLED * steady.seconds + columns as f64 * OF_COLUMN[D - 2] * evaluation;
    Cost { seconds: all * if cloud_error { 1.0 + spacing::alike(2.0, D) } else { 1.0 }, ..steady }
}
