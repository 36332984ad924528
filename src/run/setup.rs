//! From case to solver: surface, stages, cloud, fluid, state at the start.
use std::path::Path;
use std::sync::Arc;

use super::RunError;
use super::forces::ForceModes;
use crate::case::{Body, Case, Dual, Harmonics, Initial, Length, ParticleMotion, Steady, SteadyMethod, Temporal, Wall};
use crate::cloud::conservative::conservative as conserve;
use crate::cloud::sources::Source;
use crate::cloud::travel::BackgroundDomain;
use crate::cloud::{Cloud, Operators};
use crate::geometry::{GeometryError, Surface, load_surface};
use crate::math::multilevel::Cycle;
use crate::math::{Bounds, Vector};
use crate::motion::{BodyMotion, ModeShape, Motions};
use crate::physics::{Conserved, Gas, Newtonian};
use crate::scheme::motion_blending::MotionBlending;
use crate::scheme::probe::Probe;
use crate::scheme::reconstruct::Reconstruction;
use crate::scheme::start::{Stream, initial};
use crate::scheme::{
    CloudMotion, DeformingSurface, Discretisation, Fluid, ParticleKinematics, Travel, ViscousModel, WallCondition,
};
use crate::system::{Instant, System};
use crate::time::control::{Control, Method};
use crate::time::dual::Plan;

/// Particles above which a steady case is started on one coarser cloud, and on two; in 2-D and 3-D.
const START: [[usize; 2]; 2] = [[2_500, 9_000], [15_000, 80_000]];

/// Exactly conservative coefficients unless the case says otherwise: they cost a few per cent of a run.
const CONSERVATIVE: bool = true;

/// Relative difference of entropy that counts as none.
const ONE_ENTROPY: f64 = 1e-6;

/// Extents of a body by which the points of a mode may lie beside it.
const OFF: f64 = 0.5;
/// Least extent of the points of a mode over that of the body: a scale of ten, thousand or 25.4 shows.
const SMALL: f64 = 0.2;

/// Greatest one: a mode of a whole aircraft may carry a flap.
const LARGE: f64 = 100.0;

/// Greatest number of iterations of the relaxation before a march.
const PRELUDE_ITERATIONS: u32 = 500;

/// Orders of magnitude of that relaxation: the motion soon moves loads by more than what is left.
const PRELUDE_ORDERS: f64 = 3.0;

/// The same where a march leads to a harmonic balance.
const LEAD_ITERATIONS: u32 = 60;

/// Refuses what a case file can say but the solver cannot compute yet; each line goes when its solver comes.
pub(super) fn supported(case: &Case) -> Result<(), RunError> {
    let travels = case.moves() && case.particles() == ParticleMotion::Lagrangian;
    let layered = travels && case.cloud.wall_layers.is_some();
    let bare = case.moves() && case.bodies.is_empty() && case.particles() == ParticleMotion::Deforming;
    let balanced = travels && case.scheme.conservative == Some(true);
    let slow = case.scheme.low_mach && !conserves(case);
    let asks = [
        (!case.structures.is_empty(), "bodies on springs in a stream (`[structure]`)"),
        (layered, "wall layers of particles that travel with the fluid (`wall_layers`, `particles = \"lagrangian\"`)"),
        (bare, "a deforming cloud without bodies (`particles = \"deforming\"`)"),
        (slow, "slow flow without conservative coefficients (`low_mach = true` needs `conservative = true`)"),
        (balanced, "conservative coefficients of particles that travel with the fluid (`conservative = true`)"),
    ];
    let missing: Vec<&str> = asks.iter().filter(|a| a.0).map(|a| a.1).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let list = missing.join(", ");
    let hint = "`alula check` and `alula cloud` accept the case; `alula run` does not yet";
    Err(RunError::Unsupported(format!("this version cannot compute {list}\nhint: {hint}")))
}

/// Exactly conservative coefficients? Not where particles travel with the fluid and their lists are made anew again and again; and
/// not where wall layers move: weights that are exact for linear fields serve as well or better there.
fn conserves(case: &Case) -> bool {
    let travels = case.moves() && case.particles() == ParticleMotion::Lagrangian;
    let layered = case.moves() && case.cloud.wall_layers.is_some();
    case.scheme.conservative.unwrap_or(CONSERVATIVE && !travels && !layered)
}

/// One cloud of a run.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Stage {
    /// Factor on every spacing of the case: 1 except for the clouds that a steady case starts on.
    pub(super) factor: f64,
    /// Cycle of adaptation, 0 before any.
    pub(super) cycle: u32,
    /// Marches in time; else relaxes to a steady state.
    #[serde(default)]
    pub(super) march: bool,
}

impl Stage {
    /// The cloud of the case itself.
    pub(super) fn is_plain(&self) -> bool {
        self.factor == 1.0 && self.cycle == 0
    }

    /// True when both stand on the same cloud.
    pub(super) fn shares_cloud(&self, other: &Self) -> bool {
        self.factor == other.factor && self.cycle == other.cycle
    }
}

/// The stages of a case whose own cloud has `n` fluid particles.
pub(super) fn stages(case: &Case, n: usize, dimension: usize) -> Vec<Stage> {
    let mut all = Vec::new();
    // a march from a given field starts from that field itself
    let given = super::marches(case) && !matches!(case.initial, Initial::FreeStream);
    let relaxes = !matches!(case.time, Temporal::Explicit(_)) && !case.bodies.is_empty() && !given;
    let steady = |factor: f64, cycle: u32| Stage { factor, cycle, march: false };
    if relaxes {
        let limits = START[dimension - 2];
        if n > limits[1] {
            all.push(steady(4.0, 0));
        }
        if n > limits[0] {
            all.push(steady(2.0, 0));
        }
    }
    if relaxes || matches!(case.time, Temporal::Steady(_)) {
        all.extend((0..=case.adapt.cycles).map(|cycle| steady(1.0, cycle)));
    }
    if super::marches(case) {
        let cycle = all.last().map_or(0, |s: &Stage| s.cycle);
        all.push(Stage { factor: 1.0, cycle, march: true });
    }
    all
}

/// A cloud with its equations and its state at the start.
pub(super) struct Solver<const D: usize> {
    /// Equations.
    pub(super) fluid: Fluid<D>,
    /// The bodies, where pictures are drawn on the way.
    pub(super) film: Option<Surface<D>>,
    /// Modes that a harmonic balance computes forces on.
    pub(super) force_modes: Option<ForceModes<D>>,
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
    (sources, motions): (&[Source<D>], &Motions<D>),
    ready: Option<Cloud<D>>,
) -> Result<Solver<D>, RunError> {
    let scaled = coarsened(case, stage.factor);
    let sources = if stage.cycle > 0 { sources } else { &[] };
    let mut cloud = match ready {
        Some(cloud) => cloud,
        None => Cloud::build(&scaled, surface, sources)?,
    };
    let field = initial::<D>(case)?;
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
    let centre = surface.map_or(Vector::ZERO, |s| vortex_centre(&s.bounds()));
    let fluid = Fluid {
        fields: Fluid::unknowns(&cloud),
        gas,
        isentropic: case.flow.isentropic,
        flux: scheme.flux,
        limiter: scheme.limiter,
        reconstruction: Reconstruction {
            second_order: scheme.order == 2,
            kappa: scheme.kappa,
            low_mach: scheme.low_mach,
            threshold: scheme.limiter_threshold,
        },
        conservative,
        viscous_model: viscous_model(case, surface).map(Arc::new),
        far_field: Arc::new(Stream::new(case, &centre, surface.is_some_and(|s| !s.sharp.is_empty()))),
        held: field,
        cloud_motion: cloud_motion(case, surface, &cloud, motions)?,
        before: None,
        discretisation: Arc::new(Discretisation::new(cloud, operators)),
    };
    if case.flow.isentropic {
        at_one_entropy(&fluid)?;
    }
    let film = surface.filter(|_| D == 2 && case.output.report && motions.period().is_some()).cloned();
    let force_modes = ForceModes::of(case, &fluid, motions);
    Ok(Solver { fluid, film, force_modes })
}

/// Refuses a cloud without conservative coefficients.
fn unsound<const D: usize>(x: &Vector<D>) -> RunError {
    let place: Vec<String> = x.0.iter().map(|c| format!("{c:.4}")).collect();
    RunError::Unsupported(format!(
        "there are no conservative coefficients for the particles at ({}): mostly a crevice narrower than the spacing\nhint: \
         refine there with a `cloud.box`, widen or round the crevice, or compute without them, `scheme.conservative = false`",
        place.join(", ")
    ))
}

/// Refuses a start whose entropy is not that of the free stream, which an isentropic gas has everywhere.
fn at_one_entropy<const D: usize>(fluid: &Fluid<D>) -> Result<(), RunError> {
    let cloud = &fluid.discretisation.cloud;
    let stray = |x: &&Vector<D>| (fluid.gas.gamma * fluid.gas.entropy(&(fluid.held)(x)) - 1.0).abs() > ONE_ENTROPY;
    let Some(x) = cloud.x[..cloud.n_fluid].iter().find(stray) else { return Ok(()) };
    let times = fluid.gas.gamma * fluid.gas.entropy(&(fluid.held)(x));
    Err(RunError::Unsupported(format!(
        "the entropy p/\u{3c1}^\u{3b3} of the start is {times:.6} times that of the free stream at {:?}, but the gas is isentropic\nhint: \
         start with p/\u{3c1}^\u{3b3} = 1/\u{3b3}, or take out `isentropic`",
        x.0
    )))
}

/// Viscosity of a case in the units of the solver, and what the gas does on each body.
fn viscous_model<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> Option<ViscousModel> {
    let extent = surface.map_or(1.0, |s| s.bounds().extent()[0]);
    let chord = case.reference.chord.map_or(extent, |c| c.0);
    let viscous = case.flow.viscous(chord)?;
    let scales = case.flow.reference();
    let kelvin = if case.flow.is_dimensional() { case.flow.kelvin() } else { 1.0 };
    let wall_condition = |body: &Body| match case.flow.wall(body) {
        Wall::Slip => WallCondition::Slip,
        Wall::Adiabatic => WallCondition::Adiabatic,
        Wall::Temperature { value } => WallCondition::Temperature(value.0 / kelvin),
    };
    let viscosity = viscous.viscosity / (scales.density * scales.sound_speed);
    let medium = Newtonian { viscosity, sutherland: viscous.sutherland, prandtl: viscous.prandtl };
    Some(ViscousModel { medium, wall_conditions: case.bodies.iter().map(wall_condition).collect() })
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
        let domain = Arc::new(BackgroundDomain::new(case, surface, cloud)?);
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
        ParticleMotion::Rigid => CloudMotion::Rigid(motions.cloud().clone()),
        _ => {
            let until = motions.period().or_else(|| case.time.end(None)).unwrap_or_default();
            let (laws, deforming_surface) = (laws(), Arc::new(DeformingSurface::new(cloud, &laws())));
            CloudMotion::Along { path: Arc::new(MotionBlending::new(cloud, &laws, until)), laws, deforming_surface }
        }
    })
}

/// The motions of a case.
pub(super) fn motions<const D: usize>(
    case: &Case,
    input: &Path,
    surface: Option<&Surface<D>>,
) -> Result<Motions<D>, RunError> {
    let extent = surface.map_or(1.0, |s| s.bounds().extent()[0]);
    let chord = case.reference.chord.map_or(extent, |c| c.0);
    let read = |name: &str| super::folder::text(input, name);
    let motions = Motions::new(case, chord, &read).map_err(|e| RunError::Folder(e.to_string()))?;
    if let Some(surface) = surface {
        for (b, name) in surface.bodies.iter().enumerate().take(motions.len()) {
            let bounds = surface.bounds_of(b);
            motions.of(b).shapes().try_for_each(|shape| lies_on((&format!("`{name}`"), &bounds), shape))?;
        }
        let whole = surface.bounds();
        motions.shapes_of_forces().iter().try_for_each(|shape| lies_on(("the bodies", &whole), shape))?;
    }
    Ok(motions)
}

/// Refuses a mode whose points lie off the body: those of another placement, or in other units.
fn lies_on<const D: usize>((name, body): (&str, &Bounds<D>), shape: &ModeShape<D>) -> Result<(), RunError> {
    let [min, max] = shape.corners();
    let (points, reach) = (Bounds { min, max }, OFF * body.extent().max_abs());
    let far = (0..D).any(|d| points.min[d] > body.max[d] + reach || points.max[d] < body.min[d] - reach);
    let large = points.extent().max_abs() > LARGE * body.extent().max_abs();
    let small = points.extent().max_abs() < SMALL * body.extent().max_abs() && points.extent().max_abs() > 0.0;
    if !far && !small && !large {
        return Ok(());
    }
    let place = |b: &Bounds<D>| format!("{:?} to {:?}", b.min.0, b.max.0);
    Err(RunError::Motion(format!(
        "the points of a mode reach from {}, but {name} from {}\nhint: points of a mode are those of the body where it is \
         placed, in the units of the case",
        place(&points),
        place(body)
    )))
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
    let frame = old.frame(&Instant::still(0.0), state);
    old.fill_states(&frame, state, &mut work);
    old.fill_gradients(&frame, &mut work);
    let probe = Probe::new(old, &work, surface);
    let mut u = next.fluid.start();
    let cloud = &next.fluid.discretisation.cloud;
    crate::math::sweep::sweep_rows(&mut u, D + 2, |i, row| {
        let found = probe.at(&cloud.x[i]).filter(crate::physics::Primitive::is_physical);
        if let Some(q) = found {
            let c: Conserved<D> = old.gas.conserved(&q);
            c.store(row);
        }
    });
    u
}

/// The last state of another run as the start of this one. A harmonic balance takes all instances of another one; others take
/// the first, at phase zero.
pub(super) fn taken_over<const D: usize>(case: &Case, solver: &Solver<D>, u: Vec<f64>) -> Result<Vec<f64>, RunError> {
    let (own, n) = (solver.fluid.len(), D + 2);
    let count = u.len() / own.max(1);
    if own == 0 || u.len() != count * own || count.is_multiple_of(2) {
        let hint = "the version that wrote it may have built its cloud differently";
        let text =
            format!("the other run holds {} numbers where {own} of each instance are needed\nhint: {hint}", u.len());
        return Err(RunError::Folder(text));
    }
    if count == 1 || matches!(case.time, Temporal::Harmonics(_)) {
        return Ok(u);
    }
    Ok(u.chunks_exact(n * count).flat_map(|row| row[..n].to_vec()).collect())
}

/// The relaxation that gives a march its start.
pub(super) fn prelude(dual: &Dual) -> Steady {
    Steady { method: dual.method, iterations: PRELUDE_ITERATIONS, orders: PRELUDE_ORDERS, ..Steady::default() }
}

/// The relaxation that gives a harmonic balance its start.
pub(super) fn harmonic_prelude(plan: &Harmonics) -> Steady {
    let iterations = if plan.march > 0 { LEAD_ITERATIONS } else { PRELUDE_ITERATIONS };
    Steady { method: plan.method, iterations, orders: PRELUDE_ORDERS, ..Steady::default() }
}

/// Numbers of a harmonic balance.
pub(super) fn harmonic_control(plan: &Harmonics, dimension: usize) -> Control {
    let steady = Steady { cfl: plan.cfl, cfl_max: plan.cfl_max, ..harmonic_prelude(plan) };
    control(&steady, dimension)
}

/// Numbers of an implicit march.
pub(super) fn plan(dual: &Dual, period: Option<f64>) -> Result<Plan, RunError> {
    let wrong = || RunError::Folder("`[time.dual]` counts periods of a motion that has none".into());
    Ok(Plan {
        until: dual.end(period).ok_or_else(wrong)?,
        step: dual.step_length(period).ok_or_else(wrong)?,
        order: dual.order,
        orders: dual.orders,
        iterations: dual.inner_iterations,
        adaptive: dual.adaptive,
    })
}

/// Numbers of the relaxation within a step in time.
pub(super) fn inner_control(dual: &Dual, dimension: usize) -> Control {
    let steady = Steady { cfl: dual.cfl, cfl_max: dual.cfl_max, ..prelude(dual) };
    control(&steady, dimension)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crevice_without_conservative_coefficients_is_refused_with_its_place() {
        let built = |more: &str| {
            let text = format!(
                "title = \"t\"\n[flow]\nmach = 0.3\nreynolds = 1000\n[[body]]\npolygon = [[-0.5, -0.5], [0.5, -0.5], \
                 [0.5, 0.5], [0.079, 0.5], [0, -0.1], [-0.079, 0.5], [-0.5, 0.5]]\n[cloud]\nspacing = 0.03\nfar_field = 4\n\
                 wall_layers = {{ first = 0.004 }}\n[scheme]\n{more}"
            );
            let case = crate::case::read(&text, "t").unwrap();
            crate::run::build_solver::<2>(&case, Path::new("")).map_err(|e| e.to_string())
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
            supported(&crate::case::read(&text, "t").unwrap()).map_err(|e| e.to_string())
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
