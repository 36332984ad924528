//! From case to solver: surface, stages, cloud, fluid, state at the start.
use std::path::Path;

use super::RunError;
use crate::case::{Case, Length, Steady, SteadyMethod, Temporal};
use crate::cloud::conservative::conservative as conserve;
use crate::cloud::sources::Source;
use crate::cloud::{Cloud, Operators};
use crate::geometry::{GeometryError, Surface, load_surface};
use crate::math::multilevel::Cycle;
use crate::math::{Bounds, Vector};
use crate::physics::{Conserved, Gas};
use crate::scheme::Fluid;
use crate::scheme::boundary::WallFits;
use crate::scheme::probe::Probe;
use crate::scheme::reconstruct::Reconstruction;
use crate::scheme::start::{Stream, initial};
use crate::system::System;
use crate::time::relax::{Control, Method};

/// Particles above which a steady case is started on one coarser cloud, and on two; in 2-D and 3-D.
const START: [[usize; 2]; 2] = [[2_500, 9_000], [15_000, 80_000]];

/// Exactly conservative coefficients unless the case says otherwise: they cost a few per cent of a run.
const CONSERVATIVE: bool = true;

/// One cloud of a run.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Stage {
    /// Factor on every spacing of the case: 1 except for the clouds that a steady case starts on.
    pub(super) factor: f64,
    /// Cycle of adaptation, 0 before any.
    pub(super) cycle: u32,
}

impl Stage {
    /// The cloud of the case itself.
    pub(super) fn is_plain(&self) -> bool {
        self.factor == 1.0 && self.cycle == 0
    }
}

/// The stages of a case whose own cloud has `n` fluid particles.
pub(super) fn stages(case: &Case, n: usize, dimension: usize) -> Vec<Stage> {
    let mut all = Vec::new();
    if matches!(case.time, Temporal::Steady(_)) && !case.bodies.is_empty() {
        let limits = START[dimension - 2];
        if n > limits[1] {
            all.push(Stage { factor: 4.0, cycle: 0 });
        }
        if n > limits[0] {
            all.push(Stage { factor: 2.0, cycle: 0 });
        }
    }
    all.extend((0..=case.adapt.cycles).map(|cycle| Stage { factor: 1.0, cycle }));
    all
}

/// A cloud with its equations and its state at the start.
pub(super) struct Solver<const D: usize> {
    /// Equations.
    pub(super) fluid: Fluid<D>,
    /// State at the start.
    pub(super) initial: Vec<f64>,
}

/// Reads the bodies of a case; `None` when it has none.
pub(super) fn surface<const D: usize>(
    case: &Case,
    input: &Path,
) -> Result<(Option<Surface<D>>, Vec<String>), GeometryError> {
    if case.bodies.is_empty() {
        return Ok((None, Vec::new()));
    }
    let (surface, notes) = load_surface(case, input)?;
    Ok((Some(surface), notes))
}

/// Builds the solver of one stage; `ready` is its cloud when that exists already.
pub(super) fn solver<const D: usize>(
    case: &Case,
    stage: &Stage,
    surface: Option<&Surface<D>>,
    sources: &[Source<D>],
    ready: Option<Cloud<D>>,
) -> Result<Solver<D>, RunError> {
    let scaled = coarsened(case, stage.factor);
    let sources = if stage.cycle > 0 { sources } else { &[] };
    let mut cloud = match ready {
        Some(cloud) => cloud,
        None => Cloud::build(&scaled, surface, sources)?,
    };
    let field = initial::<D>(case)?;
    let conservative = case.scheme.conservative.unwrap_or(CONSERVATIVE);
    let mut operators = Operators::new(&cloud);
    if conservative {
        conserve(&mut cloud, &mut operators);
    }
    let walls = WallFits::new(&cloud);
    let gas = Gas { gamma: case.flow.gamma };
    let held = cloud.x[cloud.outer_range()].iter().map(&field).collect();
    let mut u = vec![0.0; cloud.n_fluid * (D + 2)];
    for (x, row) in cloud.x.iter().zip(u.chunks_exact_mut(D + 2)) {
        gas.conserved(&field(x)).store(row);
    }
    let scheme = &case.scheme;
    let centre = surface.map_or(Vector::ZERO, |s| vortex_centre(&s.bounds()));
    let fluid = Fluid {
        gas,
        flux: scheme.flux,
        limiter: scheme.limiter,
        reconstruction: Reconstruction {
            second_order: scheme.order == 2,
            kappa: scheme.kappa,
            threshold: scheme.limiter_threshold,
        },
        conservative,
        far_field: Box::new(Stream::new(case, &centre, surface.is_some_and(|s| !s.sharp.is_empty()))),
        held,
        cloud,
        operators,
        walls,
    };
    Ok(Solver { fluid, initial: u })
}

/// Quarter chord of the bodies.
fn vortex_centre<const D: usize>(bounds: &Bounds<D>) -> Vector<D> {
    let mut centre = bounds.centre();
    centre[0] = bounds.min[0] + 0.25 * (bounds.max[0] - bounds.min[0]);
    centre
}

/// The case with every spacing multiplied by `factor`.
fn coarsened(case: &Case, factor: f64) -> Case {
    let mut case = case.clone();
    let scale = |l: &mut Length| l.0 *= factor;
    scale(&mut case.cloud.spacing);
    case.cloud.boxes.iter_mut().for_each(|b| scale(&mut b.spacing));
    if let Some(wake) = case.cloud.wake.as_mut() {
        scale(&mut wake.spacing);
    }
    if let Some(layers) = case.cloud.wall_layers.as_mut() {
        scale(&mut layers.first);
    }
    case
}

/// The state of the previous stage on the particles of the next one, by the solver's own fit.
pub(super) fn transfer<const D: usize>(
    previous: &(Solver<D>, Vec<f64>),
    next: &Solver<D>,
    surface: Option<&Surface<D>>,
) -> Vec<f64> {
    let (old, state) = (&previous.0.fluid, &previous.1);
    let mut work = old.work();
    let frame = old.frame(0.0, state);
    old.fill_states(&frame, state, &mut work);
    old.fill_gradients(&mut work);
    let probe = Probe::new(old, &work, surface);
    let mut u = next.initial.clone();
    let cloud = &next.fluid.cloud;
    crate::math::sweep::sweep_rows(&mut u, D + 2, |i, row| {
        let found = probe.at(&cloud.x[i]).filter(crate::physics::Primitive::is_physical);
        if let Some(q) = found {
            let c: Conserved<D> = old.gas.conserved(&q);
            c.store(row);
        }
    });
    u
}

/// Numbers of the steady relaxation.
pub(super) fn control(steady: &Steady, dimension: usize) -> Control {
    Control {
        method: match steady.method {
            SteadyMethod::NewtonKrylov => Method::NewtonKrylov,
            SteadyMethod::LuSgs => Method::Sweeps,
            SteadyMethod::RungeKutta => Method::RungeKutta,
        },
        cfl: steady.cfl,
        cfl_max: match steady.method {
            SteadyMethod::LuSgs => steady.cfl_max.min(100.0),
            _ => steady.cfl_max,
        },
        growth: 2.0,
        tolerance: 0.1,
        basis: 30,
        group: if dimension == 2 { 4 } else { 8 },
        cycle: Cycle { sweeps: 2, visits: 1, levels: if steady.method == SteadyMethod::LuSgs { 1 } else { 8 } },
    }
}
