//! From a case to a structure of particles.
use std::path::Path;

use super::super::error::RunError;
use super::material::material;
use crate::case::formula::Formula;
use crate::case::{Body, Case, Domain, PlaneState, Shape, Side, Solid as Data, SolidFill, SolidPlace, Temporal};
use crate::cloud::CloudSpec;
use crate::geometry::{Surface, load_surface};
use crate::math::{Bounds, Vector};
use crate::physics::solid::{Law, Material};
use crate::solid::fill::{Lattice, relaxed};
use crate::solid::particles::{Fill, Particles};
use crate::solid::{Action, Contact, Damping, Load, Parts, Plane, RigidPlane, Solid, Structure, Support, held_on_axis};

/// Artificial viscosity of explicit marches in which something yields or meets something.
const SHOCKED: f64 = 0.1;
/// α of the stabilisation in the plane and in space, where a particle has three times as many neighbours: cantilevers of five
/// particles through the thickness are off by 1.4 and 0.6 %.
const STABILISATION: [f64; 2] = [0.3, 0.4];
/// Particles through the thickness where nothing is said: frequencies to half a per cent.
const USUAL: f64 = 9.0;
/// Particles through the thickness below which frequencies are off by more than one per cent.
const FEW: usize = 5;

/// A structure with what is asked of it.
pub(in crate::run) struct Built<const D: usize> {
    /// The structure.
    pub(in crate::run) structure: Structure<D>,
    /// Names of the bodies.
    pub(in crate::run) bodies: Vec<String>,
    /// Thickness of plane bodies, whose equations are those of one unit of length: what is told of masses, forces and energies is of so much. One
    /// in space and of bodies of revolution.
    pub(in crate::run) thickness: f64,
    /// Points whose displacements are told: name, nearest particle and place.
    pub(in crate::run) probes: Vec<(String, usize, Vector<D>)>,
    /// Velocity of each particle at the start.
    pub(in crate::run) velocity: Vec<[f64; D]>,
    /// Area of each particle on the surface that gas may touch: not on planes of symmetry, nor outside the domain of the gas.
    pub(in crate::run) wetted: Vec<Vector<D>>,
    /// What is worth knowing.
    pub(in crate::run) notes: Vec<String>,
    /// What makes results doubtful.
    pub(in crate::run) warnings: Vec<String>,
}

/// One body on its way.
struct Part<'a, const D: usize> {
    data: &'a Data,
    name: String,
    fill: Fill<D>,
    led: bool,
    cuts: Vec<Cut>,
}

/// The structure of a case whose bodies are made of particles.
pub(in crate::run) fn build<const D: usize>(case: &Case, input: &Path) -> Result<Built<D>, RunError> {
    let (mut notes, mut warnings) = (Vec::new(), Vec::new());
    let mut parts = Vec::new();
    for (number, body, data) in case.solids() {
        let name = body.name.clone().unwrap_or_else(|| format!("body {}", number + 1));
        let (surface, said) = load_surface::<D>(std::slice::from_ref(body), input)?;
        notes.extend(said);
        let cuts = cuts(case, &surface.bounds());
        let (fill, rows) = filled((body, data), &surface, &name, &cuts)?;
        warnings.extend(thin(&fill, rows, &name)?);
        let fill = if data.plane == PlaneState::Axisymmetric { turned(fill, &name)? } else { fill };
        // without supports a body with a prescribed motion is led as a whole
        let led = case.motion_of(number).is_some() && data.supports.is_empty();
        parts.push(Part { data, name, fill, led, cuts });
    }
    let owner: Vec<u16> = parts.iter().zip(0..).flat_map(|(p, k)| std::iter::repeat_n(k, p.fill.x.len())).collect();
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
    let (mut materials, of) = materials(&parts, &particles, &owner)?;
    if lasts(case) {
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
    let first = parts[0].data;
    let shocked =
        case.has_gas() || case.contact.is_some() || materials.iter().any(|m| matches!(m.law, Law::Plastic(_)));
    let usual = if shocked && matches!(case.time, Temporal::Explicit(_)) { SHOCKED } else { 0.0 };
    let probes = probes(&parts, &particles, &owner);
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
    let bodies = parts.iter().map(|p| p.name.clone()).collect();
    let thickness = first.thickness.0;
    Ok(Built { structure: Structure::new(solid), bodies, thickness, probes, velocity, wetted, notes, warnings })
}

/// The section of a body, turned about the y axis, which it must not cross.
fn turned<const D: usize>(fill: Fill<D>, name: &str) -> Result<Fill<D>, RunError> {
    /// How far beyond the axis a particle may be by round-off, in spacings.
    const ROUND_OFF: f64 = 1e-9;
    let least = fill.x.iter().min_by(|a, b| a[0].total_cmp(&b[0])).filter(|x| x[0] < -ROUND_OFF * fill.spacing);
    if let Some(x) = least {
        return Err(RunError::Solid {
            what: format!("`{name}` reaches ({:.6}, {:.6}), beyond the axis of revolution x = 0", x[0], x[1]),
            hint: "x is the radius of an axisymmetric body: give the half of its section with x ≥ 0, or `translate` it"
                .into(),
        });
    }
    let fill = fill.turned();
    match (0..fill.x.len()).find(|i| !(fill.turn[*i] > 0.0 && fill.volume[*i] > 0.0)) {
        None => Ok(fill),
        Some(i) => Err(RunError::Solid {
            what: format!("a particle of `{name}` at ({:.6}, {:.6}) has no volume", fill.x[i][0], fill.x[i][1]),
            hint: "take a smaller `spacing`: at sharp edges of the section it decides".into(),
        }),
    }
}

/// A plane of symmetry that cuts a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    /// Across which axis.
    pub(super) axis: usize,
    /// Its coordinate there.
    pub(super) place: f64,
    /// The body is on the side of smaller coordinates.
    pub(super) below: bool,
}

/// The planes of symmetry at the sides of the domain of the gas that cut a body within `bounds`.
pub(super) fn cuts<const D: usize>(case: &Case, bounds: &Bounds<D>) -> Vec<Cut> {
    if !case.has_gas() {
        return Vec::new();
    }
    let limits = CloudSpec::<D>::of_case(case).limits();
    let b = &case.boundary;
    let sides = [[b.x_min, b.x_max], [b.y_min, b.y_max], [b.z_min, b.z_max]];
    let mut all = Vec::new();
    for axis in 0..D {
        for (below, place) in [(false, limits.min[axis]), (true, limits.max[axis])] {
            let beyond = if below { bounds.max[axis] > place } else { bounds.min[axis] < place };
            if sides[axis][usize::from(below)] == Side::Symmetry && beyond {
                all.push(Cut { axis, place, below });
            }
        }
    }
    all
}

/// The corners of a box along the axes without what is beyond the cuts.
fn cut_off<const D: usize>(corners: Vec<Vector<D>>, cuts: &[Cut], name: &str) -> Result<Vec<Vector<D>>, RunError> {
    let bounds = Bounds::around(&corners);
    let at_end = |x: &Vector<D>, d: usize| x[d] == bounds.min[d] || x[d] == bounds.max[d];
    if !corners.iter().all(|x| (0..D).all(|d| at_end(x, d))) {
        return Err(uncut(name));
    }
    let cut = |mut x: Vector<D>| {
        for c in cuts {
            x[c.axis] = if c.below { x[c.axis].min(c.place) } else { x[c.axis].max(c.place) };
        }
        x
    };
    Ok(corners.into_iter().map(cut).collect())
}

fn uncut(name: &str) -> RunError {
    RunError::Solid {
        what: format!(
            "a plane of symmetry at a side of the domain cuts `{name}`: only boxes along the axes can be cut"
        ),
        hint: "let the body end before the side, or make it a `box`".into(),
    }
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
        let cuts = corners.first().map_or(&[][..], |i| &parts[usize::from(owner[*i as usize])].cuts);
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

/// The particles of one body, and the least number of them in a row where they are in rows.
fn filled<const D: usize>(
    (body, data): (&Body, &Data),
    surface: &Surface<D>,
    name: &str,
    cuts: &[Cut],
) -> Result<(Fill<D>, Option<usize>), RunError> {
    let corners = match corners(body, surface) {
        Some(corners) if !cuts.is_empty() => Some(cut_off(corners, cuts, name)?),
        None if !cuts.is_empty() => return Err(uncut(name)),
        whole => whole,
    };
    let rows = match data.fill {
        Some(SolidFill::Relaxed) => None,
        Some(SolidFill::Lattice) if corners.is_none() => {
            return Err(RunError::Solid {
                what: format!("`{name}`: rows of particles fill boxes, and polygons of four corners, alone"),
                hint: "leave `fill` out, or write `fill = \"relaxed\"`".into(),
            });
        }
        Some(SolidFill::Lattice) => corners,
        None if matches!(body.shape, Shape::Box { .. }) || D == 2 => corners,
        None => None,
    };
    let shortest = shortest(surface, rows.as_deref());
    let through = |count: u32| shortest / f64::from(count - 1);
    let spacing = data.spacing.map(|s| s.0).or(data.through.map(through)).unwrap_or(shortest / (USUAL - 1.0));
    let Some(corners) = rows else { return Ok((seen(relaxed(surface, spacing), surface), None)) };
    let lattice = Lattice { jitter: data.jitter, ..Lattice::with_spacing(corners, spacing) };
    Ok((lattice.fill(), lattice.counts.iter().copied().min()))
}

/// Without neighbours that do not see one another through the body.
fn seen<const D: usize>(fill: Fill<D>, surface: &Surface<D>) -> Fill<D> {
    /// How far below the surface a particle on it looks from, in spacings, the first of these that is inside: a chord of a hollow side
    /// leaves the body a little, and a sharp edge is thin.
    const BELOW: [f64; 3] = [0.3, 0.1, 0.03];
    let areas = fill.areas();
    let (x, spacing) = (fill.x.clone(), fill.spacing);
    let on = |i: usize| areas[i] != Vector::ZERO;
    let eye = |i: usize| {
        let below = BELOW.iter().map(|part| x[i] - areas[i].unit() * (part * spacing));
        below.into_iter().find(|eye| surface.inside(eye)).unwrap_or(x[i])
    };
    let eyes: Vec<Vector<D>> = (0..x.len()).map(|i| if on(i) { eye(i) } else { x[i] }).collect();
    fill.seen(|i, j| on(i) && on(j) && surface.crosses(&eyes[i], &eyes[j]))
}

/// Corners of a box or a quadrilateral as rows want them; `None` for other shapes.
fn corners<const D: usize>(body: &Body, surface: &Surface<D>) -> Option<Vec<Vector<D>>> {
    let v = &surface.vertices;
    match (&body.shape, D) {
        (Shape::Box { .. } | Shape::Polygon(_), 2) if v.len() == 4 => Some(vec![v[0], v[1], v[3], v[2]]),
        (Shape::Box { size }, 3) => {
            let bounds = surface.bounds();
            let centre = bounds.centre();
            // the three sides that meet in the first corner
            let mut edges: Vec<Vector<D>> = v.iter().map(|x| *x - v[0]).collect();
            edges.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
            let mut sides: Vec<Vector<D>> = Vec::new();
            for edge in edges.into_iter().filter(|e| e.norm() > 0.0) {
                let square = sides.iter().all(|s| s.dot(&edge).abs() < 1e-9 * s.norm() * edge.norm());
                if square && sides.len() < size.len() {
                    sides.push(edge);
                }
            }
            // along the axes as far as they go
            sides.sort_by_key(|s| (0..D).max_by(|a, b| s[*a].abs().total_cmp(&s[*b].abs())));
            let low = centre - sides.iter().fold(Vector::ZERO, |sum: Vector<D>, s| sum + *s * 0.5);
            let corner = |k: usize| (0..3).fold(low, |x, d| if k >> d & 1 == 1 { x + sides[d] } else { x });
            Some((0..8).map(corner).collect())
        }
        _ => None,
    }
}

/// The shortest side of a body.
fn shortest<const D: usize>(surface: &Surface<D>, corners: Option<&[Vector<D>]>) -> f64 {
    match corners {
        Some(corners) => {
            let side = |d: usize| {
                let edges = (0..1usize << D).filter(move |k| k >> d & 1 == 0);
                edges.map(|k| (corners[k | 1 << d] - corners[k]).norm()).fold(0.0, f64::max)
            };
            (0..D).map(side).fold(f64::INFINITY, f64::min)
        }
        None => {
            let extent = surface.bounds().extent();
            (0..D).map(|d| extent[d]).fold(f64::INFINITY, f64::min)
        }
    }
}

/// Refuses a body that is little more than its two skins; says where it is thin.
fn thin<const D: usize>(fill: &Fill<D>, rows: Option<usize>, name: &str) -> Result<Option<String>, RunError> {
    /// Fewer than these through the thickness do not bend.
    const LEAST: f64 = 2.5;
    let whole: f64 = fill.volume.iter().sum();
    let area: f64 = fill.facets.iter().map(|f| f.area.norm()).sum();
    // twice volume over area is the thickness of a plate; of nothing it is no number
    let through = rows.map_or(2.0 * whole / (area * fill.spacing) + 1.0, |n| n as f64);
    if !(through >= LEAST) {
        return Err(RunError::Solid {
            what: format!("`{name}` has {through:.1} particles through its thickness, too few to bend"),
            hint: format!(
                "take a smaller `spacing` (now {:.4e}), five particles through the thickness or more; for thin shells give modes instead: \
                 `[[structure]]` with `model = \"modal\"`",
                fill.spacing
            ),
        });
    }
    Ok((through < FEW as f64 - 0.5).then(|| {
        format!("`{name}` has about {through:.1} particles through its thickness: frequencies are off by one to three per cent")
    }))
}

/// Materials of all bodies and regions, and which of them each particle has.
/// True for steady and periodic states in a gas: they last, and metals that bear them do not yield.
fn lasts(case: &Case) -> bool {
    case.has_gas() && !matches!(case.time, Temporal::Explicit(_) | Temporal::Dual(_))
}

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
        all.push(material(&part.data.material, &format!("material of `{}`", part.name))?);
        (0..of.len()).filter(own).for_each(|i| of[i] = number);
        for (r, region) in part.data.regions.iter().enumerate() {
            let number = all.len() as u16;
            all.push(material(&region.material, &format!("material of region {} of `{}`", r + 1, part.name))?);
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
        if part.led {
            let particles = (0..particles.len()).filter(|i| usize::from(owner[*i]) == k).map(|i| i as u32).collect();
            all.push(Support { particles, fixed: [true; D], motion: None });
        }
        for cut in &part.cuts {
            let on = |i: &usize| {
                let off = (particles.x[*i][cut.axis] - cut.place).abs();
                usize::from(owner[*i]) == k && off < slack(particles, *i)
            };
            let particles = (0..particles.len()).filter(on).map(|i| i as u32).collect();
            all.push(Support { particles, fixed: std::array::from_fn(|d| d == cut.axis), motion: None });
        }
        for (number, data) in part.data.supports.iter().enumerate() {
            let inside = |i: &usize| {
                usize::from(owner[*i]) == k && data.place.contains(&particles.x[*i].0, slack(particles, *i))
            };
            let held: Vec<u32> = (0..particles.len()).filter(inside).map(|i| i as u32).collect();
            if held.is_empty() {
                return Err(empty(&format!("support {}", number + 1), &part.name, particles, owner, k));
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
        for (number, data) in part.data.loads.iter().enumerate() {
            let areas = areas(particles, owner, k, &data.place);
            if areas.is_empty() {
                return Err(empty(&format!("load {}", number + 1), &part.name, particles, owner, k));
            }
            let whole: f64 = areas.iter().map(|(_, a)| a.norm()).sum();
            let vector = |v: &[f64]| Vector::from_fn(|d| v.get(d).copied().unwrap_or(0.0));
            let action = match (&data.pressure, &data.traction, &data.force) {
                (Some(p), ..) => Action::Pressure(p.0),
                (None, Some(t), _) => Action::Traction(vector(&t.iter().map(|t| t.0).collect::<Vec<_>>())),
                (None, None, f) => {
                    let force: Vec<f64> = f.iter().flatten().map(|f| f.0 / (part.data.thickness.0 * whole)).collect();
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

fn probes<const D: usize>(
    parts: &[Part<'_, D>],
    particles: &Particles<D>,
    owner: &[u16],
) -> Vec<(String, usize, Vector<D>)> {
    let mut all = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        for probe in &part.data.probes {
            let at = Vector::from_fn(|d| probe.at.get(d).map_or(0.0, |x| x.0));
            let own = (0..particles.len()).filter(|i| usize::from(owner[*i]) == k);
            let near = |i: &usize| (particles.x[*i] - at).norm_squared();
            let Some(i) = own.min_by(|a, b| near(a).total_cmp(&near(b))) else { continue };
            all.push((probe.name.clone(), i, at));
        }
    }
    all
}

fn velocities<const D: usize>(parts: &[Part<'_, D>], particles: &Particles<D>, owner: &[u16]) -> Vec<[f64; D]> {
    let formulas: Vec<Vec<Formula>> = parts
        .iter()
        .map(|p| p.data.velocity.iter().filter_map(|text| Formula::parse_in(text, D).ok()).collect())
        .collect();
    let of = |i: usize| {
        let own = &formulas[usize::from(owner[i])];
        std::array::from_fn(|d| own.get(d).map_or(0.0, |f| f.value_at(&particles.x[i].0, 0.0, 0.0)))
    };
    (0..particles.len()).map(of).collect()
}
/// Refuses materials that remember where a gas leaves no steps to remember.
pub(in super::super) fn remembers<const D: usize>(case: &Case, built: &Built<D>) -> Result<(), RunError> {
    if !lasts(case) || !built.structure.solid.remembers() {
        return Ok(());
    }
    Err(RunError::Solid {
        what: "a material that remembers (viscoelastic, hypoelastic) has no steady and no periodic state by itself: in a gas it marches in time".into(),
        hint: "use `[time.dual]` or `[time.explicit]`, or an elastic law: `linear`, `saint_venant_kirchhoff`, `neo_hookean`".into(),
    })
}
