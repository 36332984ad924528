//! From a case to a structure of particles.
use std::path::Path;

use super::super::error::RunError;
use super::cut::{Cut, cuts};
use super::filling::{Part, Plan};
use super::material::material;
use super::probes::probes;
use super::size::{Factors, Wanted, fit, together};
use crate::case::formula::Formula;
use crate::case::{Body, Case, Domain, PlaneState, Solid as Data, SolidPlace, Temporal};
use crate::geometry::load_surface;
use crate::math::Vector;
use crate::physics::solid::{Law, Material};
use crate::solid::particles::Particles;
use crate::solid::{Action, Contact, Damping, Load, Parts, Plane, RigidPlane, Solid, Structure, Support, held_on_axis};

/// Artificial viscosity of explicit marches in which something yields or meets something.
const SHOCKED: f64 = 0.1;
/// α of the stabilisation in the plane and in space, where a particle has three times as many neighbours: cantilevers of five
/// particles through the thickness are off by 1.4 and 0.6 %.
const STABILISATION: [f64; 2] = [0.3, 0.4];

/// A structure with what is asked of it.
pub(crate) struct Built<const D: usize> {
    /// The structure.
    pub(crate) structure: Structure<D>,
    /// Names of the bodies.
    pub(crate) bodies: Vec<String>,
    /// Thickness of plane bodies, whose equations are those of one unit of length: what is told of masses, forces and energies is of so much. One
    /// in space and of bodies of revolution.
    pub(crate) thickness: f64,
    /// Points whose displacements are told: name, nearest particle and place.
    pub(crate) probes: Vec<(String, usize, Vector<D>)>,
    /// Velocity of each particle at the start.
    pub(crate) velocity: Vec<[f64; D]>,
    /// Area of each particle on the surface that gas may touch: not on planes of symmetry, nor outside the domain of the gas.
    pub(crate) wetted: Vec<Vector<D>>,
    /// What is worth knowing.
    pub(crate) notes: Vec<String>,
    /// What makes results doubtful.
    pub(crate) warnings: Vec<String>,
}

/// What is known of the particles of bodies before they are made.
pub(crate) struct Expected {
    /// Their number.
    pub(crate) particles: f64,
    /// Greatest memory of a process that studies the bodies alone.
    pub(crate) bytes: f64,
    /// Thickness of the thinnest body, in distances of its particles.
    pub(crate) through: f64,
}

/// Which bodies of a case are filled with particles, and how.
#[derive(Clone, Copy)]
pub(crate) struct Filling<'a> {
    case: &'a Case,
    /// Folder that file names of the case refer to.
    input: &'a Path,
    /// The only body that is filled; all without it.
    only: Option<usize>,
    /// True for states that last whatever the case computes with them.
    at_rest: bool,
    /// Factor on the distance of particles.
    factor: f64,
}

impl<'a> Filling<'a> {
    /// All bodies of a case, whose files lie in `input`.
    pub(crate) fn of(case: &'a Case, input: &'a Path) -> Self {
        Self { case, input, only: None, at_rest: false, factor: 1.0 }
    }

    /// One body alone, for states that last.
    pub(super) fn of_body_at_rest(self, body: usize) -> Self {
        Self { only: Some(body), at_rest: true, ..self }
    }

    /// The same with `factor` times the distance of particles.
    pub(crate) fn coarser(self, factor: f64) -> Self {
        Self { factor: factor * self.factor, ..self }
    }

    /// The bodies that are filled, with their numbers.
    fn bodies(&self) -> Vec<(usize, &'a Body, &'a Data)> {
        match self.only {
            Some(only) => self.case.bodies_of_particles().filter(|(k, ..)| *k == only).collect(),
            None => self.case.solids().collect(),
        }
    }

    /// What will fill the bodies, before a particle is made. Refuses what memory does not hold.
    pub(crate) fn expected<const D: usize>(&self) -> Result<Expected, RunError> {
        let plans = plans::<D>(self, &mut Vec::new())?;
        let (wanted, factors) = (wanted(&plans), Factors::of(self.case, D));
        fit(&wanted, &factors)?;
        let size = together(&wanted);
        let through = plans.iter().map(Plan::through).fold(f64::INFINITY, f64::min);
        Ok(Expected { particles: size.particles, bytes: factors.process(&size), through })
    }

    /// Fills the bodies.
    pub(crate) fn build<const D: usize>(&self) -> Result<Built<D>, RunError> {
        build(self)
    }

    /// True for steady and periodic states in a gas: they last, and metals that bear them do not yield.
    fn lasts(&self) -> bool {
        let marches = matches!(self.case.time, Temporal::Explicit(_) | Temporal::Dual(_));
        self.case.has_gas() && (self.at_rest || !marches)
    }

    /// Refuses materials that remember where a gas leaves no steps to remember.
    pub(crate) fn remembers<const D: usize>(&self, built: &Built<D>) -> Result<(), RunError> {
        if !self.lasts() || !built.structure.solid.remembers() {
            return Ok(());
        }
        Err(RunError::Solid {
            what: "a material that remembers (viscoelastic, hypoelastic) has no steady and no periodic state by itself: in a gas it marches in time".into(),
            hint: "use `[time.dual]` or `[time.explicit]`, or an elastic law: `linear`, `saint_venant_kirchhoff`, `neo_hookean`".into(),
        })
    }
}

/// The structure of bodies made of particles.
fn build<const D: usize>(filling: &Filling<'_>) -> Result<Built<D>, RunError> {
    let case = filling.case;
    let (mut notes, mut warnings) = (Vec::new(), Vec::new());
    let parts = parts::<D>(filling, &mut notes, &mut warnings)?;
    let owner: Vec<u16> = parts.iter().zip(0..).flat_map(|(p, k)| std::iter::repeat_n(k, p.fill.x.len())).collect();
    let particles = particles_of(&parts, &mut notes)?;
    let (mut materials, of) = materials(&parts, &particles, &owner)?;
    if filling.lasts() {
        materials.iter_mut().for_each(|m| *m = m.as_elastic());
        notes.extend(materials.iter().filter_map(|m| m.elastic_limit).map(|limit| {
            format!(
                "a metal is computed as elastic, which holds up to its yield stress of {limit:.4e}: only marches yield"
            )
        }));
    }
    let omega = frequency(case);
    let (mut supports, loads) =
        (supports(&parts, &particles, &owner, omega)?, loads(&parts, &particles, &owner, omega)?);
    if let Some(support) = held_on_axis(&particles) {
        let held = support.particles.len();
        notes.push(format!("{held} particles on the axis of revolution, x = 0, are held along the radius"));
        supports.push(support);
    }
    let first = parts[0].plan.data;
    let shocked =
        case.has_gas() || case.contact.is_some() || materials.iter().any(|m| matches!(m.law, Law::Plastic(_)));
    let usual = if shocked && matches!(case.time, Temporal::Explicit(_)) { SHOCKED } else { 0.0 };
    let (probes, beside) = probes(&parts, &particles, &owner)?;
    warnings.extend(beside);
    let velocity = velocities(&parts, &particles, &owner);
    let plane = match first.plane {
        PlaneState::Strain => Plane::Strain,
        PlaneState::Stress => Plane::Stress,
        PlaneState::Axisymmetric => Plane::Axisymmetric,
    };
    let wetted = wetted(case, &parts, &particles, &owner);
    let solid = Solid::new(Parts {
        body: owner,
        materials,
        material: of,
        plane,
        gravity: Vector::from_fn(|d| first.gravity.get(d).map_or(0.0, |g| g.0)),
        damping: Damping {
            stabilisation: first.stabilisation.unwrap_or(STABILISATION[D - 2]),
            viscosity: first.viscosity.unwrap_or(usual),
            mass: first.damping.0,
            stiffness: first.stiffness_damping.0,
        },
        supports,
        loads,
        contact: contact(case),
        ramped: !case.has_gas() && matches!(case.time, Temporal::Steady(_) | Temporal::Modes(_)),
        particles,
    });
    let bodies = parts.iter().map(|p| p.plan.name.clone()).collect();
    let thickness = first.thickness.0;
    Ok(Built { structure: Structure::new(solid), bodies, thickness, probes, velocity, wetted, notes, warnings })
}

/// The bodies of a case with the particles that fill them.
fn parts<'a, const D: usize>(
    filling: &Filling<'a>,
    notes: &mut Vec<String>,
    warnings: &mut Vec<String>,
) -> Result<Vec<Part<'a, D>>, RunError> {
    let plans = plans::<D>(filling, notes)?;
    fit(&wanted(&plans), &Factors::of(filling.case, D))?;
    plans.into_iter().map(|plan| plan.filled(warnings)).collect()
}

/// What is to fill the bodies of a case.
fn plans<'a, const D: usize>(filling: &Filling<'a>, notes: &mut Vec<String>) -> Result<Vec<Plan<'a, D>>, RunError> {
    let Filling { case, input, factor, .. } = *filling;
    let mut plans = Vec::new();
    for (number, body, data) in filling.bodies() {
        let name = body.name.clone().unwrap_or_else(|| format!("body {}", number + 1));
        let (surface, said) = load_surface::<D>(std::slice::from_ref(body), input)?;
        notes.extend(said);
        let cuts = cuts(case, &surface.bounds());
        let mut plan = Plan::new((body, data, factor), name, surface, cuts)?;
        // without supports a body with a prescribed motion is led as a whole
        plan.led = case.motion_of(number).is_some() && data.supports.is_empty();
        plans.push(plan);
    }
    Ok(plans)
}

/// What the bodies take.
fn wanted<'p, const D: usize>(plans: &'p [Plan<'_, D>]) -> Vec<Wanted<'p>> {
    plans.iter().map(|p| Wanted { name: &p.name, spacing: p.spacing, size: p.size() }).collect()
}

/// The particles of all bodies together, with their neighbours and weights.
fn particles_of<const D: usize>(parts: &[Part<'_, D>], notes: &mut Vec<String>) -> Result<Particles<D>, RunError> {
    let particles = Particles::new(parts.iter().map(|p| p.fill.clone()).collect()).map_err(|e| RunError::Solid {
        what: e.to_string(),
        hint: "take a smaller `spacing`: where a body is thin, and at its sharp edges, it decides".into(),
    })?;
    notes.push(format!(
        "{} solid particles with {:.1} neighbours each; the divergence theorem changed gradients by {:.1} % in {} iterations",
        particles.len(),
        particles.mean_neighbours(),
        100.0 * particles.correction,
        particles.iterations
    ));
    Ok(particles)
}

/// Area of each particle that gas may touch.
fn wetted<const D: usize>(
    case: &Case,
    parts: &[Part<'_, D>],
    particles: &Particles<D>,
    owner: &[u16],
) -> Vec<Vector<D>> {
    let mut all = vec![Vector::ZERO; particles.len()];
    let domain = case.cloud.domain.as_ref();
    let outside = |x: &Vector<D>, slack: f64| {
        let beyond = |d: usize, domain: &Domain| {
            let [low, high] = [&domain.min, &domain.max].map(|list| list.get(d).map(|l| l.0));
            low.is_some_and(|low| x[d] < low - slack) || high.is_some_and(|high| x[d] > high + slack)
        };
        domain.is_some_and(|domain| (0..D).any(|d| beyond(d, domain)))
    };
    for facet in &particles.facets {
        let corners = facet.corners();
        let cuts = corners.first().map_or(&[][..], |i| &parts[usize::from(owner[*i as usize])].plan.cuts);
        let on = |cut: &Cut| {
            let off = |i: &u32| (particles.x[*i as usize][cut.axis] - cut.place).abs() < slack(particles, *i as usize);
            corners.iter().all(off)
        };
        let out = corners.iter().any(|i| outside(&particles.x[*i as usize], slack(particles, *i as usize)));
        if !out && !cuts.iter().any(on) {
            facet.shares().for_each(|(i, area)| all[i] += area);
        }
    }
    all
}

/// What touches.
fn contact<const D: usize>(case: &Case) -> Option<Contact<D>> {
    let data = case.contact.as_ref()?;
    let vector = |v: &[f64]| Vector::from_fn(|d| v.get(d).copied().unwrap_or(0.0));
    let planes = data.planes.iter().map(|plane| RigidPlane {
        point: vector(&plane.point.iter().map(|x| x.0).collect::<Vec<_>>()),
        normal: vector(&plane.normal).unit(),
    });
    Some(Contact { planes: planes.collect(), bodies: data.bodies, stiffness: data.stiffness, friction: data.friction })
}

/// Materials of all bodies and regions, and which of them each particle has.
fn materials<const D: usize>(
    parts: &[Part<'_, D>],
    particles: &Particles<D>,
    owner: &[u16],
) -> Result<(Vec<Material>, Vec<u16>), RunError> {
    let mut all = Vec::new();
    let mut of = vec![0u16; particles.len()];
    for (k, part) in parts.iter().enumerate() {
        let own = |i: &usize| usize::from(owner[*i]) == k;
        let number = all.len() as u16;
        all.push(material(&part.plan.data.material, &format!("material of `{}`", part.plan.name))?);
        (0..of.len()).filter(own).for_each(|i| of[i] = number);
        for (r, region) in part.plan.data.regions.iter().enumerate() {
            let number = all.len() as u16;
            all.push(material(&region.material, &format!("material of region {} of `{}`", r + 1, part.plan.name))?);
            let inside = |i: &usize| region.place.contains(&particles.x[*i].0, slack(particles, *i));
            (0..of.len()).filter(own).filter(inside).for_each(|i| of[i] = number);
        }
    }
    Ok((all, of))
}

/// Points this near to a side of a box are inside.
fn slack<const D: usize>(particles: &Particles<D>, i: usize) -> f64 {
    1e-6 * particles.spacing[i]
}

/// A place that holds no particle.
fn empty<const D: usize>(what: &str, name: &str, particles: &Particles<D>, owner: &[u16], body: usize) -> RunError {
    let own: Vec<Vector<D>> =
        (0..particles.len()).filter(|i| usize::from(owner[*i]) == body).map(|i| particles.x[i]).collect();
    let bounds = crate::math::Bounds::around(&own);
    let side = |d: usize| format!("{} from {:.6} to {:.6}", ["x", "y", "z"][d], bounds.min[d], bounds.max[d]);
    RunError::Solid {
        what: format!("{what} of `{name}` is where no particle is"),
        hint: format!("the body has {}", (0..D).map(side).collect::<Vec<_>>().join(", ")),
    }
}

/// A formula in time, as a function of it; `omega` is the angular frequency that it may name.
fn formula(text: &str, omega: Option<f64>) -> Result<impl Fn(f64) -> f64 + Send + Sync + use<>, RunError> {
    let formula = Formula::parse(text)
        .map_err(|e| RunError::Solid { what: format!("`{text}`: {e}"), hint: "write a formula in t".into() })?;
    if omega.is_none() && formula.contains(&Formula::Omega) {
        return Err(RunError::Solid {
            what: format!(
                "`{text}` uses `omega`, but neither `[time.harmonics]` nor `[motion]` has a `frequency` or `period`"
            ),
            hint: "write the frequency as a number, `sin(2 * pi * 5 * t)`".into(),
        });
    }
    let omega = omega.unwrap_or(0.0);
    Ok(move |t| formula.value(t, omega))
}

/// The angular frequency that formulas in time may name.
fn frequency(case: &Case) -> Option<f64> {
    let of_motion = || {
        let law = &case.motion.as_ref()?.law;
        law.frequency.map(|f| f.0).or_else(|| Some(std::f64::consts::TAU / law.period?.0))
    };
    case.balance_frequency().or_else(of_motion)
}

fn supports<const D: usize>(
    parts: &[Part<'_, D>],
    particles: &Particles<D>,
    owner: &[u16],
    omega: Option<f64>,
) -> Result<Vec<Support<D>>, RunError> {
    let mut all = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        if part.plan.led {
            let particles = (0..particles.len()).filter(|i| usize::from(owner[*i]) == k).map(|i| i as u32).collect();
            all.push(Support { particles, fixed: [true; D], motion: None });
        }
        for cut in &part.plan.cuts {
            let on = |i: &usize| {
                let off = (particles.x[*i][cut.axis] - cut.place).abs();
                usize::from(owner[*i]) == k && off < slack(particles, *i)
            };
            let particles = (0..particles.len()).filter(on).map(|i| i as u32).collect();
            all.push(Support { particles, fixed: std::array::from_fn(|d| d == cut.axis), motion: None });
        }
        for (number, data) in part.plan.data.supports.iter().enumerate() {
            let inside = |i: &usize| {
                usize::from(owner[*i]) == k && data.place.contains(&particles.x[*i].0, slack(particles, *i))
            };
            let held: Vec<u32> = (0..particles.len()).filter(inside).map(|i| i as u32).collect();
            if held.is_empty() {
                return Err(empty(&format!("support {}", number + 1), &part.plan.name, particles, owner, k));
            }
            let axes: Vec<usize> = data.axes(D).into_iter().map(|a| a.index()).collect();
            let formulas = data.motion.iter().map(|text| formula(text, omega)).collect::<Result<Vec<_>, _>>()?;
            let led = axes.clone();
            let motion = move |t: f64| {
                let mut moved = Vector::ZERO;
                led.iter().zip(&formulas).for_each(|(a, f)| moved[*a] = f(t));
                moved
            };
            all.push(Support {
                particles: held,
                fixed: std::array::from_fn(|d| axes.contains(&d)),
                motion: if data.motion.is_empty() { None } else { Some(Box::new(motion)) },
            });
        }
    }
    Ok(all)
}

fn loads<const D: usize>(
    parts: &[Part<'_, D>],
    particles: &Particles<D>,
    owner: &[u16],
    omega: Option<f64>,
) -> Result<Vec<Load<D>>, RunError> {
    let mut all = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        for (number, data) in part.plan.data.loads.iter().enumerate() {
            let areas = areas(particles, owner, k, &data.place);
            if areas.is_empty() {
                return Err(empty(&format!("load {}", number + 1), &part.plan.name, particles, owner, k));
            }
            let whole: f64 = areas.iter().map(|(_, a)| a.norm()).sum();
            let vector = |v: &[f64]| Vector::from_fn(|d| v.get(d).copied().unwrap_or(0.0));
            let action = match (&data.pressure, &data.traction, &data.force) {
                (Some(p), ..) => Action::Pressure(p.0),
                (None, Some(t), _) => Action::Traction(vector(&t.iter().map(|t| t.0).collect::<Vec<_>>())),
                (None, None, f) => {
                    let force: Vec<f64> =
                        f.iter().flatten().map(|f| f.0 / (part.plan.data.thickness.0 * whole)).collect();
                    Action::Traction(vector(&force))
                }
            };
            let history = match &data.history {
                None => Box::new(|_: f64| 1.0) as Box<dyn Fn(f64) -> f64 + Send + Sync>,
                Some(text) => Box::new(formula(text, omega)?),
            };
            all.push(Load { areas, action, history });
        }
    }
    Ok(all)
}

/// Areas of the surface of a body in a place: of pieces that lie in it with all their corners.
fn areas<const D: usize>(
    particles: &Particles<D>,
    owner: &[u16],
    body: usize,
    place: &SolidPlace,
) -> Vec<(u32, Vector<D>)> {
    let mut all = vec![Vector::ZERO; particles.len()];
    let inside = |i: &u32| {
        let i = *i as usize;
        usize::from(owner[i]) == body && place.contains(&particles.x[i].0, slack(particles, i))
    };
    for facet in particles.facets.iter().filter(|f| f.corners().iter().all(inside)) {
        facet.shares().for_each(|(i, area)| all[i] += area);
    }
    all.into_iter().zip(0..).filter(|(a, _)| *a != Vector::ZERO).map(|(a, i)| (i, a)).collect()
}

fn velocities<const D: usize>(parts: &[Part<'_, D>], particles: &Particles<D>, owner: &[u16]) -> Vec<[f64; D]> {
    let formulas: Vec<Vec<Formula>> = parts
        .iter()
        .map(|p| p.plan.data.velocity.iter().filter_map(|text| Formula::parse_in(text, D).ok()).collect())
        .collect();
    let of = |i: usize| {
        let own = &formulas[usize::from(owner[i])];
        std::array::from_fn(|d| own.get(d).map_or(0.0, |f| f.value_at(&particles.x[i].0, 0.0, 0.0)))
    };
    (0..particles.len()).map(of).collect()
}
