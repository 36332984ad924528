//! From case to solver: surface, stages, cloud, fluid, state at the start.
mod bodies;
mod modes;
mod motion_feasibility;
mod refinement;
mod sanity;
mod scales;
mod shock_layer;
mod size;
mod solids;

use std::path::Path;
use std::sync::Arc;

pub(crate) use self::solids::solids;
pub(crate) use bodies::{bodies, check_equilibrium, described};
pub(crate) use modes::{judged as judged_modes, told_of as told_of_modes};
pub(crate) use motion_feasibility::check as check_motion;
pub(crate) use refinement::{adapted, behind_shocks};
pub(crate) use sanity::{rough, sane};
pub(crate) use size::spec;

use super::accuracy;
use super::error::RunError;
use super::folder;
use super::look::forces::ForceModes;
use super::look::reference::chord;
use super::recipe;
use super::stage::Stage;
use crate::case::{Case, ParticleMotion, RungeKutta, Temporal};
use crate::cloud::conservative::conservative as conserve;
use crate::cloud::sources::Source;
use crate::cloud::travel::BackgroundDomain;
use crate::cloud::{Cloud, Operators};
use crate::geometry::{GeometryError, Surface, load_surface};
use crate::math::fourier::Instances;
use crate::math::{Bounds, Vector};
use crate::motion::{BodyMotion, Motions};
use crate::physics::{Conserved, Gas, n_variables};
use crate::scheme::fluid::FarField;
use crate::scheme::probe::Probe;
use crate::scheme::reconstruct::Reconstruction;
use crate::scheme::start::{FreeStream, Stream, initial};
use crate::scheme::{CloudMotion, Discretisation, Fluid, Frame, HasGas, ParticleKinematics, Travel, ViscousModel};
use crate::system::{Instant, System, placed};
use crate::time::harmonic::HarmonicBalance;

/// Exactly conservative coefficients unless the case says otherwise: they cost a few per cent of a run.
const CONSERVATIVE: bool = true;

/// Relative difference of entropy that counts as none.
const ONE_ENTROPY: f64 = 1e-6;

/// Refuses what a case file can say but the solver cannot compute yet; each line goes when its solver comes.
pub(crate) fn supported(case: &Case) -> Result<(), RunError> {
    super::solids::with_gas(case)?;
    let travels = case.moves() && case.particles() == ParticleMotion::Lagrangian;
    let layered = travels && case.cloud.wall_layers.is_some();
    let bare = case.moves() && case.bodies.is_empty() && case.particles() == ParticleMotion::Deforming;
    let balanced = travels && case.scheme.conservative == Some(true);
    let slow = case.scheme.low_mach && !conserves(case);
    let sprung = !case.structures.is_empty();
    let explicit = sprung && matches!(case.time, Temporal::Explicit(_));
    let soft = case.has_gas() && case.solids().next().is_some();
    let carried = (sprung || soft) && case.particles() == ParticleMotion::Lagrangian;
    let march = if let Temporal::Explicit(plan) = &case.time { Some(plan) } else { None };
    let fourth = soft && march.is_some_and(|plan| plan.method == RungeKutta::Rk4);
    let unfaced = soft && march.is_some() && !conserves(case);
    let asks = [
        (
            explicit,
            "bodies on springs with explicit steps (`[structure]` needs `[time.steady]`, `[time.dual]` or `harmonics`)",
        ),
        (fourth, "bodies made of particles with `method = \"rk4\"` (leave it out)"),
        (
            unfaced,
            "bodies made of particles with explicit steps and without conservative coefficients (take `[time.dual]`, or leave out \
             `conservative` and `wall_layers`)",
        ),
        (
            carried,
            "bodies on springs, or made of particles, among particles that travel with the fluid (`particles = \"lagrangian\"`)",
        ),
        (layered, "wall layers of particles that travel with the fluid (`wall_layers`, `particles = \"lagrangian\"`)"),
        (bare, "a deforming cloud without bodies (`particles = \"deforming\"`)"),
        (slow, "slow flow without conservative coefficients (`low_mach = true` needs `conservative = true`)"),
        (balanced, "conservative coefficients of particles that travel with the fluid (`conservative = true`)"),
    ];
    let missing: Vec<&str> = asks.iter().filter(|a| a.0).map(|a| a.1).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let what = format!("this version cannot compute {}", missing.join(", "));
    Err(RunError::Unsupported {
        what,
        hint: "`alula cloud` builds the cloud of such a case, but no flow is computed on it",
    })
}

/// Exactly conservative coefficients? Not where particles travel with the fluid and their lists are made anew again and again; and
/// not where wall layers move: weights that are exact for linear fields serve as well or better there.
fn conserves(case: &Case) -> bool {
    let travels = case.moves() && case.particles() == ParticleMotion::Lagrangian;
    let layered = case.moves() && case.cloud.wall_layers.is_some();
    case.scheme.conservative.unwrap_or(CONSERVATIVE && !travels && !layered)
}

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

/// What the solvers of all stages are built from.
pub(crate) struct Site<'a, const D: usize> {
    /// The case.
    pub(crate) case: &'a Case,
    /// Its bodies.
    pub(crate) surface: Option<&'a Surface<D>>,
    /// How they move.
    pub(crate) motions: &'a Motions<D>,
}

/// Reads the bodies of a case; `None` when it has none.
pub(crate) fn surface<const D: usize>(
    case: &Case,
    input: &Path,
) -> Result<(Option<Surface<D>>, Vec<String>), GeometryError> {
    if case.bodies.is_empty() {
        return Ok((None, Vec::new()));
    }
    let (surface, notes) = load_surface(&case.bodies, input)?;
    Ok((Some(surface), notes))
}

/// Builds the solver of one stage with the sources of refinement found so far; `ready` is its cloud without any, when that exists
/// already.
pub(crate) fn solver<const D: usize>(
    site: &Site<'_, D>,
    stage: &Stage,
    sources: &[Source<D>],
    ready: Option<Cloud<D>>,
) -> Result<Solver<Fluid<D>, D>, RunError> {
    let Site { case, surface, motions } = *site;
    let scaled = accuracy::scaled(case, stage.factor);
    let sources = if stage.cycle > 0 { sources } else { &[] };
    let mut cloud = match ready.filter(|_| sources.is_empty()) {
        Some(cloud) => cloud,
        None => Cloud::build(&size::spec(&scaled), surface, sources)?,
    };
    let conservative = conserves(case);
    let mut operators = Operators::new(&cloud);
    if conservative {
        let report = conserve(&mut cloud, &mut operators);
        // coarser clouds serve the start alone
        if stage.factor == 1.0 && !report.is_sound() {
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
        far_field: far_field(site),
        held: initial::<D>(case)?,
        cloud_motion: cloud_motion(case, surface, &cloud, motions)?,
        discretisation: Arc::new(Discretisation::new(cloud, operators)),
    };
    if case.flow.isentropic {
        at_one_entropy(&fluid)?;
    }
    let film = surface.filter(|_| D == 2 && case.output.report && motions.period().is_some()).cloned();
    let force_modes = ForceModes::of(case, surface, &fluid, motions);
    Ok(Solver { system: fluid, film, force_modes })
}

/// The same gas on the same cloud in the free stream of the case of `site`.
pub(crate) fn in_stream<const D: usize>(site: &Site<'_, D>, gas: &Fluid<D>) -> Result<Fluid<D>, RunError> {
    let Site { case, surface, .. } = *site;
    Ok(Fluid {
        discretisation: Arc::clone(&gas.discretisation),
        cloud_motion: gas.cloud_motion.clone(),
        viscous_model: viscous_model(case, surface).map(Arc::new),
        far_field: far_field(site),
        held: initial::<D>(case)?,
        fields: gas.fields,
        ..*gas
    })
}

/// What the far field of a case is.
fn far_field<const D: usize>(site: &Site<'_, D>) -> Arc<dyn FarField<D>> {
    let centre = site.surface.map_or(Vector::ZERO, |s| vortex_centre(&s.bounds()));
    let sharp = site.surface.is_some_and(|s| !s.sharp.is_empty());
    Arc::new(Stream::new(&FreeStream::of_case(site.case), &centre, sharp))
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
        let domain = Arc::new(BackgroundDomain::new(&size::spec(case), surface, cloud)?);
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

/// The motions of a case.
pub(crate) fn motions<const D: usize>(
    case: &Case,
    input: &Path,
    surface: Option<&Surface<D>>,
) -> Result<Motions<D>, RunError> {
    let chord = chord(case, surface);
    let read = |name: &str| folder::text(input, name);
    let motions = Motions::of_case(case, chord, &read)?;
    if let Some(surface) = surface {
        let bodies = 0..motions.len().min(surface.bodies.len());
        let led = bodies.flat_map(|b| motions.of(b).shapes().map(move |shape| (Some(b), shape)));
        let all = led.chain(motions.shapes_of_forces().iter().map(|shape| (None, shape)));
        let astray = all.filter_map(|(b, shape)| modes::lies_on(surface, b, shape).err()).collect();
        RunError::all(astray).map_or(Ok(()), Err)?;
    }
    Ok(motions)
}

/// Quarter chord of the bodies.
fn vortex_centre<const D: usize>(bounds: &Bounds<D>) -> Vector<D> {
    let mut centre = bounds.centre();
    centre[0] = bounds.min[0] + 0.25 * (bounds.max[0] - bounds.min[0]);
    centre
}

/// The state of the previous stage on the particles of the next one, by the solver's own fit; that of each instance of a period where it
/// holds more than one.
pub(crate) fn transfer<S: HasGas<D>, const D: usize>(
    previous: &S,
    state: &[f64],
    next: &S,
    site: &Site<'_, D>,
) -> Vec<f64> {
    let count = state.len() / previous.len();
    let Some(period) = site.motions.period().filter(|_| count > 1) else {
        let frame = previous.gas().frame(&Instant::still(0.0), previous.gas_state(state));
        return transfer_one(previous, (&frame, state), next, site.surface);
    };
    let (held, omega) = (Instances::of_harmonics(count / 2), std::f64::consts::TAU / period);
    let (old, new) = (HarmonicBalance::new(previous, held, omega, 1.0), HarmonicBalance::new(next, held, omega, 1.0));
    let (mut one, mut all) = (vec![0.0; previous.len()], vec![0.0; next.len() * count]);
    for (n, frame) in old.frame(&Instant::still(0.0), state).iter().enumerate() {
        old.instance(state, n, &mut one);
        let found = transfer_one(previous, (previous.gas_frame(frame), &one), next, site.surface);
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
    crate::math::sweep::sweep_rows(&mut u, n_variables(D), |i, row| {
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
    if count == 1 || recipe::balance(case).is_some() {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::refusals::as_checked;

    #[test]
    fn a_crevice_without_conservative_coefficients_is_refused_with_its_place() {
        let built = |more: &str| {
            let text = format!(
                "title = \"t\"\n[flow]\nmach = 0.3\nreynolds = 1000\n[[body]]\npolygon = [[-0.5, -0.5], [0.5, -0.5], \
                 [0.5, 0.5], [0.079, 0.5], [0, -0.1], [-0.079, 0.5], [-0.5, 0.5]]\n[cloud]\nspacing = 0.06\nfar_field = 2\n\
                 edge_levels = 1\nwall_layers = {{ first = 0.008 }}\n[scheme]\n{more}"
            );
            let case = crate::case::read(&text, "t").unwrap();
            let seen = crate::run::build_solver::<2>(&case, Path::new(""));
            as_checked(&case, Path::new(""), seen).map_err(|e| e.to_string())
        };
        let message = built("").map(|_| ()).unwrap_err();
        assert!(message.starts_with("there are no conservative coefficients for the particles at ("), "{message}");
        assert!(message.contains("`scheme.conservative = false`"), "{message}");
        assert!(built("conservative = false").is_ok());
    }

    #[test]
    fn slow_flow_is_refused_without_conservative_coefficients() {
        let told = |more: &str| {
            let text = format!(
                "title = \"t\"\n[flow]\nmach = 0.1\n[[body]]\ncircle = {{ radius = 0.5 }}\n[cloud]\nspacing = 0.1\n[scheme]\n\
                 low_mach = true\n{more}"
            );
            let case = crate::case::read(&text, "t").unwrap();
            as_checked(&case, Path::new(""), supported(&case)).map_err(|e| e.to_string())
        };
        assert!(told("").is_ok());
        assert!(told("conservative = false").unwrap_err().contains("`low_mach = true` needs `conservative = true`"));
        let moved = |particles: &str| {
            format!(
                "[motion]\nparticles = \"{particles}\"\nperiod = 10\nplunge = 0.1\n[time.dual]\nsteps_per_period = 20\nperiods = 1"
            )
        };
        assert!(told(&moved("deforming")).is_ok() && told(&moved("rigid")).is_ok());
        assert!(told(&format!("conservative = false\n{}", moved("deforming"))).is_err());
    }
}
