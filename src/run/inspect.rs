//! A cloud without a run: what `check` and `cloud` tell.
use std::time;

use super::outputs::{View, bytes_of};
use super::{Places, RunError, pictures, setup};
use crate::case::{Case, HarmonicCount, Temporal};
use crate::cloud::Diagnosis;
use crate::geometry::dimension;
use crate::observe::table::write_json;
use crate::observe::vtk::{Column, write_points};
use crate::system::{Instant, System};

/// Residual evaluations of a typical steady run, per particle, and their growth with the number of particles.
const EVALUATIONS: f64 = 1200.0;
/// The same for one implicit step in time.
const STEP_EVALUATIONS: f64 = 110.0;
/// Evaluations timed for the estimate.
const TIMED: u32 = 5;

/// What is known of a cloud before a run.
#[derive(Clone, Debug)]
pub struct CloudReport {
    /// Particles without images.
    pub particles: usize,
    /// Fluid particles.
    pub fluid: usize,
    /// Interface particles.
    pub interface: usize,
    /// Particles on the sides of the domain.
    pub outer: usize,
    /// Least, mean and most neighbours.
    pub neighbours: (usize, f64, usize),
    /// Finest and coarsest spacing.
    pub spacing: (f64, f64),
    /// Largest condition number of a fit.
    pub worst_condition: f64,
    /// Seconds that building took.
    pub seconds: f64,
    /// Memory that a run will need.
    pub memory_bytes: usize,
    /// Wall seconds that a run will take, from a timed residual.
    pub expected_seconds: f64,
    /// What was repaired or assumed.
    pub notes: Vec<String>,
}

/// Builds the cloud of a case and judges it; with `files`, writes it into the folder `places.out`.
pub fn inspect(case: &Case, places: &Places, files: bool) -> Result<CloudReport, RunError> {
    match dimension(case) {
        2 => look::<2>(case, places, files),
        _ => look::<3>(case, places, files),
    }
}

fn look<const D: usize>(case: &Case, places: &Places, files: bool) -> Result<CloudReport, RunError> {
    let began = time::Instant::now();
    let (surface, mut notes) = setup::surface::<D>(case, &places.input)?;
    let motions = setup::motions(case, &places.input, surface.as_ref())?;
    let stage = setup::Stage { factor: 1.0, cycle: 0, march: false };
    let solver = setup::solver(case, &stage, surface.as_ref(), (&[], &motions), None)?;
    let seconds = began.elapsed().as_secs_f64();
    let (fluid, u) = (&solver.fluid, &solver.fluid.start());
    let (mut work, mut du) = (fluid.work(), vec![0.0; u.len()]);
    let frame = fluid.frame(&Instant::still(0.0), u);
    let timer = time::Instant::now();
    (0..TIMED).for_each(|_| fluid.rhs(&frame, u, &mut work, &mut du));
    let evaluation = timer.elapsed().as_secs_f64() / f64::from(TIMED);
    let cloud = &fluid.discretisation.cloud;
    let counts: Vec<usize> = (0..cloud.n_rows()).map(|i| cloud.neighbours.of(i).len()).collect();
    notes.extend(cloud.notes.iter().cloned().chain(cloud.early_ends()));
    notes.extend(super::motion_feasibility::check(case, cloud, &motions)?);
    let report = CloudReport {
        particles: cloud.n_real(),
        fluid: cloud.n_fluid,
        interface: cloud.interface.len(),
        outer: cloud.outer.len(),
        neighbours: (
            counts.iter().copied().min().unwrap_or(0),
            counts.iter().sum::<usize>() as f64 / counts.len().max(1) as f64,
            counts.iter().copied().max().unwrap_or(0),
        ),
        spacing: cloud.spacing.iter().fold((f64::INFINITY, 0.0), |(l, h), s| (s.min(l), s.max(h))),
        worst_condition: fluid.discretisation.operators.condition.iter().fold(0.0, |m, c| c.max(m)),
        seconds,
        memory_bytes: bytes_of(fluid, integrator_bytes(case, fluid)),
        expected_seconds: evaluation * evaluations(case, fluid, &frame, (u, motions.period())),
        notes,
    };
    if files {
        write(case, places, &solver, &mut work, surface.as_ref())?;
    }
    Ok(report)
}

/// Residual evaluations that the run will spend.
fn evaluations<const D: usize>(
    case: &Case,
    fluid: &crate::scheme::Fluid<D>,
    frame: &crate::scheme::Frame<D>,
    (u, period): (&[f64], Option<f64>),
) -> f64 {
    match &case.time {
        Temporal::Steady(_) => EVALUATIONS * f64::from(1 + case.adapt.cycles),
        Temporal::Dual(dual) => {
            let steps = dual.end(period).zip(dual.step_length(period)).map_or(0.0, |(end, step)| end / step);
            EVALUATIONS + STEP_EVALUATIONS * steps
        }
        Temporal::Harmonics(h) => {
            let count = match h.number {
                HarmonicCount::Fixed(n) => n,
                HarmonicCount::Auto(_) => 3,
            };
            EVALUATIONS * f64::from(2 + 2 * count)
        }
        Temporal::Explicit(e) => {
            let mut rate = vec![0.0; fluid.discretisation.cloud.n_fluid];
            fluid.rates(frame, u, &mut fluid.work(), &mut rate);
            let fastest = rate.iter().fold(0.0f64, |m, r| m.max(*r));
            3.5 * e.end(period).unwrap_or_default() * fastest / e.cfl
        }
    }
}

/// Bytes of the integrator: matrix of blocks with its hierarchy and Krylov vectors, or the stages of a march.
fn integrator_bytes<const D: usize>(case: &Case, fluid: &crate::scheme::Fluid<D>) -> usize {
    let n = fluid.len();
    match &case.time {
        Temporal::Explicit(_) => 3 * 8 * n,
        Temporal::Steady(_) | Temporal::Dual(_) | Temporal::Harmonics(_) => {
            let block = D + 2;
            let entries = fluid.discretisation.cloud.neighbours.index.len() + fluid.discretisation.cloud.n_fluid;
            8 * entries * block * block * 4 / 6 + 4 * 17 * n + 8 * 8 * n
        }
    }
}

fn write<const D: usize>(
    case: &Case,
    places: &Places,
    solver: &setup::Solver<D>,
    work: &mut crate::scheme::Work<D>,
    surface: Option<&crate::geometry::Surface<D>>,
) -> Result<(), RunError> {
    super::folder::create(case, places)?;
    let fluid = &solver.fluid;
    let frame = fluid.frame(&Instant::still(0.0), &solver.fluid.start());
    fluid.fill_states(&frame, &solver.fluid.start(), work);
    let cloud = &fluid.discretisation.cloud;
    let n = cloud.n_real();
    let points: Vec<[f64; 3]> = cloud.x[..n].iter().map(crate::math::Vector::to_3d).collect();
    let mut condition = fluid.discretisation.operators.condition.clone();
    condition.resize(n, 1.0);
    let columns = [
        Column { name: "spacing", components: 1, values: &cloud.spacing[..n] },
        Column { name: "volume", components: 1, values: &cloud.volume[..n] },
        Column { name: "condition", components: 1, values: &condition },
    ];
    write_points(&places.out.join("cloud.vtu"), &points, &columns)?;
    write_json(&places.out.join("doctor.json"), &Diagnosis::of(cloud, fluid.discretisation.walls.n_linear))?;
    let view = View { case, out: &places.out, fluid, work, surface };
    pictures::write_cloud(&view)
}
