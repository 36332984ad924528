//! Solvers of stages: the equations of a problem on the cloud of each, and states that go from one to the next.
mod refinement;
mod shock_layer;

pub(crate) use refinement::{adapted, behind_shocks};

use super::look::forces::ForceModes;
use super::stage::Stage;
use crate::case::Case;
use crate::cloud::Cloud;
use crate::cloud::sources::Source;
use crate::geometry::Surface;
use crate::math::fourier::Instances;
use crate::physics::{Conserved, n_variables};
use crate::problem::{ProblemIn, RunError, gas, numerics};
use crate::scheme::probe::Probe;
use crate::scheme::{Fluid, Frame, HasGas};
use crate::system::{Instant, System, placed};
use crate::time::harmonic::HarmonicBalance;

/// A cloud with its equations, and what only some runs need to know of it.
pub(crate) struct Solver<S, const D: usize> {
    /// Equations.
    pub(crate) system: S,
    /// The bodies, where pictures are drawn on the way.
    pub(crate) film: Option<Surface<D>>,
    /// Modes that a harmonic balance computes forces on.
    pub(crate) force_modes: Option<ForceModes<D>>,
}

impl<const D: usize> Solver<Fluid<D>, D> {
    /// The same with the system that `assemble` makes of the gas.
    pub(crate) fn with<S>(self, assemble: impl Fn(Fluid<D>) -> S) -> Solver<S, D> {
        Solver { system: assemble(self.system), film: self.film, force_modes: self.force_modes }
    }
}

/// Builds the solver of one stage with the sources of refinement found so far; `ready` is its cloud without any, when that exists
/// already.
pub(crate) fn solver<const D: usize>(
    problem: &ProblemIn<D>,
    stage: &Stage,
    sources: &[Source<D>],
    ready: Option<Cloud<D>>,
) -> Result<Solver<Fluid<D>, D>, RunError> {
    let (case, surface, motions) = (problem.case(), problem.surface(), problem.motions());
    let sources = if stage.cycle > 0 { sources } else { &[] };
    let system = gas(problem, (stage.factor, sources), ready)?;
    let film = surface.filter(|_| D == 2 && case.output.report && motions.period().is_some()).cloned();
    let force_modes = ForceModes::of(case, surface, &system, motions);
    Ok(Solver { system, film, force_modes })
}

/// The state of the previous stage on the particles of the next one, by the solver's own fit; that of each instance of a period where it
/// holds more than one.
pub(crate) fn transfer<S: HasGas<D>, const D: usize>(
    previous: &S,
    state: &[f64],
    next: &S,
    problem: &ProblemIn<D>,
) -> Vec<f64> {
    let count = state.len() / previous.len();
    let Some(period) = problem.motions().period().filter(|_| count > 1) else {
        let frame = previous.gas().frame(&Instant::still(0.0), previous.gas_state(state));
        return transfer_one(previous, (&frame, state), next, problem.surface());
    };
    let (held, omega) = (Instances::of_harmonics(count / 2), std::f64::consts::TAU / period);
    let (old, new) = (HarmonicBalance::new(previous, held, omega, 1.0), HarmonicBalance::new(next, held, omega, 1.0));
    let (mut one, mut all) = (vec![0.0; previous.len()], vec![0.0; next.len() * count]);
    for (n, frame) in old.frame(&Instant::still(0.0), state).iter().enumerate() {
        old.instance(state, n, &mut one);
        let found = transfer_one(previous, (previous.gas_frame(frame), &one), next, problem.surface());
        new.set_instance(&found, n, &mut all);
    }
    all
}

fn transfer_one<S: HasGas<D>, const D: usize>(
    previous: &S,
    (frame, state): (&Frame<D>, &[f64]),
    next: &S,
    surface: Option<&Surface<D>>,
) -> Vec<f64> {
    let (old, gas) = (previous.gas(), previous.gas_state(state));
    let mut work = old.work();
    let probe = Probe::before_motion(old.view(frame, gas, &mut work), surface);
    let mut u = next.gas().start();
    let cloud = &next.gas().discretisation.cloud;
    crate::math::parallel::sweep_rows(&mut u, n_variables(D), |i, row| {
        let found = probe.at(&cloud.x[i]).filter(crate::physics::Primitive::is_physical);
        if let Some(q) = found {
            let c: Conserved<D> = old.gas.conserved(&q);
            c.store(row);
        }
    });
    previous.with_gas(state, &u)
}

/// The last state of another run as the start of this one. A harmonic balance takes all instances of another one; others take
/// the first, at phase zero.
pub(crate) fn taken_over<S: System>(case: &Case, system: &S, u: Vec<f64>) -> Result<Vec<f64>, RunError> {
    let own = system.len();
    let count = u.len() / own.max(1);
    if own == 0 || u.len() != count * own || count.is_multiple_of(2) {
        return Err(RunError::OtherRun {
            what: format!("the other run holds {} numbers where {own} of each instance are needed", u.len()),
            hint: "the version that wrote it may have built its cloud differently",
        });
    }
    if count == 1 || numerics::balance(case).is_some() {
        return Ok(u);
    }
    let mut first = vec![0.0; own];
    for at in placed(system.fields()) {
        let (n, all) = (at.field.block, &u[at.unknowns.start * count..at.unknowns.end * count]);
        first[at.unknowns].chunks_exact_mut(n).zip(all.chunks_exact(n * count)).for_each(|(one, all)| {
            one.copy_from_slice(&all[..n]);
        });
    }
    Ok(first)
}
