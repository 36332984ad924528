//! Equations of the gas of a problem on a cloud.
use std::sync::Arc;

use super::error::RunError;
use super::in_dimension::ProblemIn;
use super::reference::chord;
use super::size::{spec, spec_of};
use super::spacing;
use super::supported::conserves;
use crate::case::{Case, ParticleMotion};
use crate::cloud::conservative::conservative as conserve;
use crate::cloud::sources::Source;
use crate::cloud::travel::BackgroundDomain;
use crate::cloud::{Cloud, Operators};
use crate::coupling::Coupled;
use crate::coupling::solids::OnCloud;
use crate::geometry::Surface;
use crate::math::{Bounds, Vector};
use crate::motion::{BodyMotion, Motions};
use crate::physics::Gas;
use crate::scheme::fluid::FarField;
use crate::scheme::reconstruct::Reconstruction;
use crate::scheme::start::{FreeStream, Stream, initial};
use crate::scheme::{CloudMotion, Discretisation, Fluid, ParticleKinematics, Travel, ViscousModel};

/// Relative difference of entropy that counts as none.
const ONE_ENTROPY: f64 = 1e-6;

/// Equations of the gas on a cloud with `factor` times the spacing of the case, refined at `sources`; `ready` is that cloud where it exists
/// already.
pub(crate) fn gas<const D: usize>(
    problem: &ProblemIn<D>,
    (factor, sources): (f64, &[Source<D>]),
    ready: Option<Cloud<D>>,
) -> Result<Fluid<D>, RunError> {
    let (case, surface, motions) = (problem.case(), problem.surface(), problem.motions());
    let mut cloud = match ready.filter(|_| sources.is_empty()) {
        Some(cloud) => cloud,
        None => Cloud::build(&spec_of(case, &spacing::of_stage(case, factor)), surface, sources)?,
    };
    let conservative = conserves(case);
    let mut operators = Operators::new(&cloud);
    if conservative {
        let report = conserve(&mut cloud, &mut operators);
        // coarser clouds serve the start alone
        if factor == 1.0 && !report.is_sound() {
            return Err(unsound(&cloud.x[report.worst]));
        }
    }
    let gas = Gas { gamma: case.flow.gamma };
    let scheme = &case.scheme;
    let fluid = Fluid {
        fields: Fluid::unknowns(&cloud),
        gas,
        isentropic: case.flow.isentropic,
        flux: scheme.flux,
        limiter: scheme.limiter,
        reconstruction: Reconstruction::of_scheme::<D>(scheme, case.flow.viscous(1.0).is_some()),
        conservative,
        viscous_model: viscous_model(case, surface).map(Arc::new),
        far_field: far_field(problem),
        held: initial::<D>(case)?,
        cloud_motion: cloud_motion(case, surface, &cloud, motions)?,
        discretisation: Arc::new(Discretisation::new(cloud, operators)),
    };
    if case.flow.isentropic {
        at_one_entropy(&fluid)?;
    }
    Ok(fluid)
}

/// The gas on a cloud with the structures and the bodies made of particles of a problem.
pub(crate) fn coupled<const D: usize>(problem: &ProblemIn<D>, gas: Fluid<D>) -> Coupled<D> {
    let cloud = &gas.discretisation.cloud;
    let walls = &cloud.x[cloud.interface_range()];
    let on = problem.structures().iter().map(|body| body.clone().on(walls)).collect();
    match problem.solids() {
        None => Coupled::new(gas, on),
        Some(solids) => {
            let made = OnCloud::new(Arc::clone(solids), &gas);
            Coupled::new(gas, on).with_solids(made)
        }
    }
}

/// The same gas on the same cloud in the free stream of another problem.
pub(crate) fn in_stream<const D: usize>(problem: &ProblemIn<D>, gas: &Fluid<D>) -> Result<Fluid<D>, RunError> {
    let (case, surface) = (problem.case(), problem.surface());
    Ok(Fluid {
        discretisation: Arc::clone(&gas.discretisation),
        cloud_motion: gas.cloud_motion.clone(),
        viscous_model: viscous_model(case, surface).map(Arc::new),
        far_field: far_field(problem),
        held: initial::<D>(case)?,
        fields: gas.fields,
        ..*gas
    })
}

/// What the far field of a case is.
fn far_field<const D: usize>(problem: &ProblemIn<D>) -> Arc<dyn FarField<D>> {
    let centre = problem.surface().map_or(Vector::ZERO, |s| vortex_centre(&s.bounds()));
    let sharp = problem.surface().is_some_and(|s| !s.sharp.is_empty());
    Arc::new(Stream::new(&FreeStream::of_case(problem.case()), &centre, sharp))
}

/// Refuses a cloud without conservative coefficients.
fn unsound<const D: usize>(x: &Vector<D>) -> RunError {
    let place: Vec<String> = x.0.iter().map(|c| format!("{c:.4}")).collect();
    let place = place.join(", ");
    RunError::Unsupported {
        what: format!(
            "there are no conservative coefficients for the particles at ({place}): mostly a crevice narrower than the spacing"
        ),
        hint: "refine there with a `cloud.box`, widen or round the crevice, or compute without them, `scheme.conservative = false`",
    }
}

/// Refuses a start whose entropy is not that of the free stream, which an isentropic gas has everywhere.
fn at_one_entropy<const D: usize>(fluid: &Fluid<D>) -> Result<(), RunError> {
    let cloud = &fluid.discretisation.cloud;
    let stray = |x: &&Vector<D>| (fluid.gas.gamma * fluid.gas.entropy(&(fluid.held)(x)) - 1.0).abs() > ONE_ENTROPY;
    let Some(x) = cloud.x[..cloud.n_fluid].iter().find(stray) else { return Ok(()) };
    let times = fluid.gas.gamma * fluid.gas.entropy(&(fluid.held)(x));
    Err(RunError::Unsupported {
        what: format!(
            "the entropy p/\u{3c1}^\u{3b3} of the start is {times:.6} times that of the free stream at {x}, but the gas is isentropic"
        ),
        hint: "start with p/\u{3c1}^\u{3b3} = 1/\u{3b3}, or take out `isentropic`",
    })
}

/// Viscosity of a case in the units of the solver, and what the gas does on each body.
fn viscous_model<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> Option<ViscousModel> {
    let chord = chord(case, surface);
    ViscousModel::of_case(case, chord)
}

/// How the particles of a cloud follow the bodies.
fn cloud_motion<const D: usize>(
    case: &Case,
    surface: Option<&Surface<D>>,
    cloud: &Cloud<D>,
    motions: &Motions<D>,
) -> Result<CloudMotion<D>, RunError> {
    let laws = || (0..motions.len()).map(|b| motions.of(b).clone()).collect::<Vec<BodyMotion<D>>>();
    let particles = case.particles();
    if case.moves() && particles == ParticleMotion::Lagrangian {
        let domain = Arc::new(BackgroundDomain::new(&spec(case), surface, cloud)?);
        let places = cloud.x[..cloud.n_rows()].to_vec();
        return Ok(CloudMotion::Travel(Travel {
            domain,
            laws: laws(),
            kinematics: Arc::new(ParticleKinematics { places, ..ParticleKinematics::default() }),
            since: 0.0,
        }));
    }
    Ok(match particles {
        _ if !motions.moves() => CloudMotion::Still,
        ParticleMotion::Rigid if motions.cloud().bends() => {
            return Err(RunError::Motion {
                what: "the body bends, but the cloud moves rigidly (`motion.particles = \"rigid\"`)".into(),
                hint: "use `particles = \"deforming\"`",
            });
        }
        ParticleMotion::Rigid => CloudMotion::Rigid(motions.cloud().clone()),
        _ => {
            let until = motions.period().or_else(|| case.end(None)).unwrap_or_default();
            CloudMotion::deforming(cloud, laws(), until)
        }
    })
}

/// Quarter chord of the bodies.
fn vortex_centre<const D: usize>(bounds: &Bounds<D>) -> Vector<D> {
    let mut centre = bounds.centre();
    centre[0] = bounds.min[0] + 0.25 * (bounds.max[0] - bounds.min[0]);
    centre
}
