//! How the cloud gets where it is at a time.
//!
//! A cloud at rest shares one shape for ever; a rigid one keeps it and turns the axes that states are looked at in; any other
//! motion moves the particles and fits their weights anew on the same lists.
//!
//! Velocities come from positions: with the difference formula that time marching or harmonic balance applies to the state,
//! w = Σ c_k x(t_k), or, within a step of an explicit method, along straight lines x = (1 − θ) x(t) + θ x(t + Δt). Uniform
//! flow and a linear field at rest are then kept to round-off, whatever the motion.
use std::sync::Arc;

use super::deforming_surface::{DeformingSurface, SurfaceStrain};
use super::frame::{Discretisation, Frame};
use super::travel::Travel;
use super::wall_fits::WallFits;
use super::wall_motion::{WallMotion, rotation_rate};
use crate::math::Vector;
use crate::math::jet::Jet;
use crate::math::parallel::{sweep, sweep_slots};
use crate::math::square::times;
use crate::motion::{BodyMotion, RigidPose, positions};
use crate::system::{Instant, Rate, Term};

/// Where particle number `i`, at `x` before any motion, is at one time.
pub type Places<'a, const D: usize> = Box<dyn Fn(usize, &Vector<D>) -> Vector<D> + Send + Sync + 'a>;

/// Places of particles as a function of time and of their place before any motion.
pub trait Path<const D: usize>: Send + Sync {
    /// Places at time `t`, at which coordinates of bodies that are unknowns are `jets`.
    fn at(&self, t: f64, jets: &[Jet]) -> Places<'_, D>;
    /// The place before any motion of what is at `x` then.
    fn origin(&self, x: &Vector<D>, t: f64, jets: &[Jet]) -> Vector<D>;
}

/// How particles move.
#[derive(Clone)]
pub enum CloudMotion<const D: usize> {
    /// Not at all.
    Still,
    /// As one with a body.
    Rigid(BodyMotion<D>),
    /// Along paths of their own, the walls with their bodies.
    Along {
        /// Places of the particles.
        path: Arc<dyn Path<D>>,
        /// Motion of each body.
        laws: Vec<BodyMotion<D>>,
        /// How the surfaces of bodies bend.
        deforming_surface: Arc<DeformingSurface<D>>,
    },
    /// With the fluid.
    Travel(Travel<D>),
}

impl<const D: usize> CloudMotion<D> {
    /// Brings `frame` to a moment; `origin` is the shape before any motion.
    pub fn place(&self, origin: &Arc<Discretisation<D>>, at: &Instant<'_>, frame: &mut Frame<D>) {
        frame.time = at.time;
        frame.jets = jets(at);
        match self {
            Self::Still => {}
            Self::Rigid(law) => place_rigid(law, origin, at, frame),
            Self::Along { path, laws, deforming_surface } => {
                place_along(path.as_ref(), origin, at, frame);
                let laws: Vec<_> = laws.iter().map(|l| l.momentary(at.time, &frame.jets).into_owned()).collect();
                turn_walls((&laws, deforming_surface), origin, at.time, frame);
                if origin.operators.conservative {
                    let Discretisation { cloud, operators, .. } = Arc::make_mut(&mut frame.discretisation);
                    operators.metric_update(cloud, &origin.operators, &origin.cloud);
                }
            }
            Self::Travel(travel) => travel.place(origin, at, frame),
        }
    }

    /// The place before any motion of what is at `x` at time `t`, at which coordinates that are unknowns are `jets`.
    pub fn origin(&self, x: &Vector<D>, t: f64, jets: &[Jet]) -> Vector<D> {
        match self {
            Self::Still | Self::Travel(_) => *x,
            Self::Rigid(law) => law.momentary(t, jets).pose(t).inverse_point(x),
            Self::Along { path, .. } => path.origin(x, t, jets),
        }
    }

    /// Pose of a body at time `t`, at which coordinates that are unknowns are `jets`; its modes are left aside.
    pub fn body(&self, body: usize, t: f64, jets: &[Jet]) -> RigidPose<D> {
        let pose = |law: &BodyMotion<D>| law.momentary(t, jets).pose(t);
        match self {
            Self::Still => RigidPose::identity(),
            Self::Rigid(law) => pose(law),
            Self::Along { laws, .. } | Self::Travel(Travel { laws, .. }) => {
                laws.get(body).map_or_else(RigidPose::identity, pose)
            }
        }
    }

    /// Motion of the first body: the one that angles and displacements in histories belong to.
    pub fn law(&self) -> Option<&BodyMotion<D>> {
        match self {
            Self::Still => None,
            Self::Rigid(law) => Some(law),
            Self::Along { laws, .. } | Self::Travel(Travel { laws, .. }) => {
                laws.iter().find(|law| !law.is_fixed()).or(laws.first())
            }
        }
    }

    /// Motions of bodies by which particles go along paths that are known in advance: that of the only body where all move
    /// as one. None where nothing moves or particles travel with the fluid.
    pub fn laws(&self) -> &[BodyMotion<D>] {
        match self {
            Self::Still | Self::Travel(_) => &[],
            Self::Rigid(law) => std::slice::from_ref(law),
            Self::Along { laws, .. } => laws,
        }
    }

    /// Motion by which particles on the wall of a body go, see [`Self::laws`].
    pub fn law_of(&self, body: usize) -> Option<&BodyMotion<D>> {
        match self {
            Self::Rigid(law) => Some(law),
            _ => self.laws().get(body),
        }
    }

    /// Particles that travel with the fluid.
    pub fn travel(&self) -> Option<&Travel<D>> {
        match self {
            Self::Travel(travel) => Some(travel),
            _ => None,
        }
    }

    /// True when nothing moves.
    pub fn is_still(&self) -> bool {
        matches!(self, Self::Still)
    }
}

/// Turns the axes; the difference formula applies to poses, which positions are affine in.
fn place_rigid<const D: usize>(
    law: &BodyMotion<D>,
    origin: &Arc<Discretisation<D>>,
    at: &Instant<'_>,
    frame: &mut Frame<D>,
) {
    let t = at.time;
    let (law, template) = (law.momentary(t, &frame.jets), law);
    let law = law.as_ref();
    let pose = law.pose(t);
    let x = &origin.cloud.x;
    let velocity = Arc::make_mut(&mut frame.velocity);
    velocity.resize(x.len(), Vector::ZERO);
    match at.rate {
        Rate::Formula(rate) => {
            let poses: Vec<(f64, RigidPose<D>)> = rate.iter().map(|r| (r.coefficient, pose_of(template, r))).collect();
            let rows = std::array::from_fn(|r| poses.iter().fold(Vector::ZERO, |s, (c, p)| s + p.rotation[r] * *c));
            let shift = poses.iter().fold(Vector::ZERO, |s, (c, p)| s + p.shift * *c);
            let drift = RigidPose { rotation: rows, shift };
            sweep(velocity, |i| pose.inverse_direction(&drift.point(&x[i])));
        }
        Rate::Still | Rate::Within { .. } => {
            sweep(velocity, |i| pose.inverse_direction(&law.velocity(t, &x[i])));
        }
    }
    let gradient = rotation_rate(law, t);
    let inward = |v: &Vector<D>| pose.inverse_direction(v);
    // Rᵀ G R: the rate of rotation seen in the axes of the body
    let columns: [Vector<D>; D] = std::array::from_fn(|j| inward(&times(&gradient, &pose.direction(&Vector::axis(j)))));
    let wall_velocity_gradient = std::array::from_fn(|i| Vector::from_fn(|j| columns[j][i]));
    let first = origin.cloud.n_fluid;
    let still = WallMotion { wall_velocity_gradient, acceleration: Vector::ZERO };
    let walls = Arc::make_mut(&mut frame.walls);
    walls.resize(origin.cloud.interface.len(), still);
    sweep(walls, |w| WallMotion {
        wall_velocity_gradient,
        acceleration: inward(&law.kinematics(t, &x[first + w]).acceleration),
    });
    frame.turn = Some(pose);
}

/// Coordinates of bodies that are unknowns, with rates and accelerations: by the formula that serves all positions.
fn jets(at: &Instant<'_>) -> Vec<Jet> {
    let mut all = positions(at.coordinates);
    match at.rate {
        Rate::Still => {}
        Rate::Within { step, fraction, ends: [from, to], .. } => {
            let pairs = from.chunks_exact(2).zip(to.chunks_exact(2));
            for (jet, (from, to)) in all.iter_mut().zip(pairs) {
                // straight from one end to the other, as particles go
                jet.value = from[0] + fraction * (to[0] - from[0]);
                jet.first = (to[0] - from[0]) / step;
            }
        }
        Rate::Formula(terms) => {
            for (k, jet) in all.iter_mut().enumerate() {
                let difference = |part: usize| {
                    let term = |t: &Term<'_>| t.coefficient * t.coordinates.get(2 * k + part).copied().unwrap_or(0.0);
                    terms.iter().map(term).sum()
                };
                (jet.first, jet.second) = (difference(0), difference(1));
            }
        }
    }
    all
}

/// Where a body is at a time of a formula.
fn pose_of<const D: usize>(law: &BodyMotion<D>, term: &Term<'_>) -> RigidPose<D> {
    law.momentary(term.time, &positions(term.coordinates)).pose(term.time)
}

/// Moves the particles and fits their weights anew.
fn place_along<const D: usize>(
    path: &dyn Path<D>,
    origin: &Arc<Discretisation<D>>,
    at: &Instant<'_>,
    frame: &mut Frame<D>,
) {
    let reference = &origin.cloud;
    let n = reference.n_real();
    let velocity = Arc::make_mut(&mut frame.velocity);
    velocity.resize(reference.len(), Vector::ZERO);
    let discretisation = Arc::make_mut(&mut frame.discretisation);
    let before = |i: usize| &reference.x[i];
    let (x, w) = (&mut discretisation.cloud.x[..n], &mut velocity[..n]);
    match at.rate {
        Rate::Still => {
            let now = path.at(at.time, &frame.jets);
            sweep(x, |i| now(i, before(i)));
            sweep(w, |_| Vector::ZERO);
        }
        Rate::Formula(rate) => {
            let now = path.at(at.time, &frame.jets);
            sweep(x, |i| now(i, before(i)));
            let terms: Vec<(f64, Places<'_, D>)> =
                rate.iter().map(|r| (r.coefficient, path.at(r.time, &positions(r.coordinates)))).collect();
            sweep(w, |i| terms.iter().fold(Vector::ZERO, |s, (c, place)| s + place(i, before(i)) * *c));
        }
        Rate::Within { start, step, fraction, ends } => {
            let jets = ends.map(positions);
            let (from, to) = (path.at(start, &jets[0]), path.at(start + step, &jets[1]));
            sweep(w, |i| (to(i, before(i)) - from(i, before(i))) * (1.0 / step));
            let w = &*w;
            sweep(x, |i| from(i, before(i)) + w[i] * (fraction * step));
        }
    }
    for (k, image) in reference.ghosts.iter().enumerate() {
        let (t, s) = (&reference.transforms[image.transform as usize], image.source as usize);
        discretisation.cloud.x[n + k] = t.point(&discretisation.cloud.x[s]);
        velocity[n + k] = t.direction(&velocity[s]);
    }
}

/// Bends and turns the surface vectors with the bodies and fits all weights to where particles are.
fn turn_walls<const D: usize>(
    (laws, deforming_surface): (&[BodyMotion<D>], &DeformingSurface<D>),
    origin: &Arc<Discretisation<D>>,
    t: f64,
    frame: &mut Frame<D>,
) {
    let reference = &origin.cloud;
    let discretisation = Arc::make_mut(&mut frame.discretisation);
    let poses: Vec<RigidPose<D>> = laws.iter().map(|l| l.pose(t)).collect();
    let rates: Vec<[Vector<D>; D]> = laws.iter().map(|l| rotation_rate(l, t)).collect();
    let body = |w: usize| usize::from(reference.interface[w].body);
    let carried = deforming_surface.carried(&frame.jets);
    let mut strains: Vec<Option<SurfaceStrain<D>>> = (0..carried.len()).map(|_| None).collect();
    sweep_slots(&mut strains, |w, slot| {
        *slot = deforming_surface.carried_strain(w, &carried, &reference.interface[w]);
    });
    let strained = |w: usize| strains.get(w).and_then(Option::as_ref);
    sweep_slots(&mut discretisation.cloud.interface, |w, slot| {
        *slot = reference.interface[w];
        if let Some(at) = strained(w) {
            slot.deform(&at.strain);
        } else if let Some((pose, law)) = poses.get(body(w)).zip(laws.get(body(w))) {
            if let Some(surface_strain) = deforming_surface.surface_strain(w, law, t) {
                slot.deform(&surface_strain.strain);
            }
            slot.turn(&pose.rotation);
        }
    });
    let walls = Arc::make_mut(&mut frame.walls);
    walls.resize(reference.interface.len(), WallMotion::AT_REST);
    sweep(walls, |w| {
        let Some(law) = laws.get(body(w)) else { return WallMotion::AT_REST };
        if let Some(at) = strained(w) {
            return WallMotion { wall_velocity_gradient: at.rate, acceleration: carried[w][2] };
        }
        let x = &reference.x[reference.n_fluid + w];
        let (wall_velocity_gradient, pose) = (rates[body(w)], &poses[body(w)]);
        let Some(surface_strain) = deforming_surface.surface_strain(w, law, t) else {
            return WallMotion { wall_velocity_gradient, acceleration: law.kinematics_of(t, x, &[]).acceleration };
        };
        let stretch = WallMotion { wall_velocity_gradient: surface_strain.rate, acceleration: Vector::ZERO };
        let stretch = stretch.turned(|v| pose.direction(v), |v| pose.inverse_direction(v));
        WallMotion {
            wall_velocity_gradient: std::array::from_fn(|i| {
                wall_velocity_gradient[i] + stretch.wall_velocity_gradient[i]
            }),
            acceleration: law.kinematics_of(t, x, &surface_strain.shifts).acceleration,
        }
    });
    discretisation.operators.refit(&discretisation.cloud);
    discretisation.walls = WallFits::new(&discretisation.cloud);
}
