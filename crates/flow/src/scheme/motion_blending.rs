//! Motion of the cloud with moving bodies, decaying to zero far away.
//!
//! A particle at X before any motion is at x(t) = X + Σ_b φ_b(X) (P_b(t) X − X), where P_b is the motion of body b. For
//! one body, φ = ψ(d) with the distance d to it: 1 near the body, 0 far away, a quintic in between with two continuous
//! derivatives. Several bodies are weighted by inverse distance (Shepard 1968): φ_b = ψ(d_b) d_b⁻³ / Σ_c d_c⁻³, so that
//! φ of a body is 1 on its own surface. All x(t) are linear in the poses, so that differences of positions are exact. A
//! deforming body maps X to P_b(t) (X + Σ_m q_m(t) φ_m(X)), where its modes φ_m are continued into the field by their
//! own interpolation.
//!
//! Around solids of particles, the cloud slides along planes of symmetry: the displacement normal to a plane decays to
//! zero where a particle is nearer to it than to the body, and these planes do not limit the extent of the motion.
use crate::cloud::Cloud;
use crate::math::jet::Jet;
use crate::math::parallel::sweep_slots;
use crate::math::{Bounds, Vector};
use crate::motion::{BodyMotion, Carried, PointTrajectory, RigidPose, SurfaceNet};

use super::discretisation::{Path, Places};

/// Distance from a body, in body lengths, within which particles move with it.
const INNER: f64 = 1.0;
/// Distance beyond which particles are at rest: in body lengths, or in greatest displacements if this is more.
const OUTER: f64 = 8.0;
/// Number of times at which displacements are sampled.
const TIMES: usize = 256;
/// Greatest fraction of the distance to the sides of the domain over which particles move.
const REACH: f64 = 0.9;
/// Exponent of the inverse distance in the weights of several bodies.
const POWER: i32 = 3;
/// Number of points on a body for the computation of distances; more are not necessary.
const SAMPLES: usize = 2000;
/// Greatest number of iterations for the position before any motion.
const ROUNDS: usize = 60;

/// Data of one body.
struct Body<const D: usize> {
    /// Trajectories of the particles that follow it.
    trajectory: PointTrajectory<D>,
    points: Vec<Vector<D>>,
    inner: f64,
    outer: f64,
    /// True for a solid of particles.
    soft: bool,
}

/// Motion of the bodies continued into the cloud.
pub struct MotionBlending<const D: usize> {
    bodies: Vec<Body<D>>,
    /// Weight φ of each particle and body.
    share: Vec<f32>,
    /// Planes of symmetry: axis and coordinate.
    planes: Vec<(usize, f64)>,
    /// Factor on each component of the displacement by solids of particles; empty when there are none.
    sliding: Vec<Vector<D>>,
}

impl<const D: usize> MotionBlending<D> {
    /// Prepares the motion of the bodies, one for each, until the time `until`.
    pub fn new(cloud: &Cloud<D>, laws: &[BodyMotion<D>], until: f64) -> Self {
        let bodies: Vec<Body<D>> = laws.iter().enumerate().map(|(b, law)| body(cloud, (b, law), until)).collect();
        let (share, planes) = (vec![0.0; cloud.n_real() * bodies.len()], planes(cloud));
        let mut all = Self { share, bodies, planes, sliding: Vec::new() };
        if all.bodies.iter().any(|b| b.soft) {
            let mut sliding = vec![Vector::from_fn(|_| 1.0); cloud.n_real()];
            sweep_slots(&mut sliding, |i, slot| {
                if !cloud.interface_range().contains(&i) {
                    *slot = all.slides(&cloud.x[i]);
                }
            });
            all.sliding = sliding;
        }
        let n = all.bodies.len();
        let mut rows: Vec<Vec<f64>> = vec![Vec::new(); cloud.n_real()];
        sweep_slots(&mut rows, |i, row| *row = all.own_shares(cloud, i));
        for (i, row) in rows.iter().enumerate() {
            all.share[i * n..(i + 1) * n].iter_mut().zip(row).for_each(|(s, r)| *s = *r as f32);
        }
        let real = &cloud.x[..cloud.n_real()];
        for (b, law) in laws.iter().enumerate() {
            let moves = |i: usize| all.share[i * n + b] > 0.0;
            let trajectory = PointTrajectory::of_those(law, real, moves);
            all.bodies[b].trajectory = match law.net() {
                Some(net) => trajectory.carried_by(carried(cloud, (b, net), moves)),
                None => trajectory,
            };
        }
        all
    }

    /// Weights of particle `i`; on a surface only its own body has one.
    fn own_shares(&self, cloud: &Cloud<D>, i: usize) -> Vec<f64> {
        if cloud.interface_range().contains(&i) {
            let own = usize::from(cloud.interface[i - cloud.n_fluid].body);
            return (0..self.bodies.len()).map(|b| f64::from(u8::from(b == own))).collect();
        }
        self.shares(&cloud.x[i])
    }

    /// Factor on each component of the displacement at `x` by solids of particles.
    fn slides(&self, x: &Vector<D>) -> Vector<D> {
        let near = self.bodies.iter().filter(|b| b.soft).map(|b| b.distance(x)).fold(f64::INFINITY, f64::min);
        let mut left = Vector::from_fn(|_| 1.0);
        for (axis, place) in &self.planes {
            let s = ((x[*axis] - place).abs() / near.max(f64::MIN_POSITIVE)).min(1.0);
            left[*axis] *= s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        }
        left
    }

    fn shares(&self, x: &Vector<D>) -> Vec<f64> {
        let distance: Vec<f64> = self.bodies.iter().map(|b| b.distance(x)).collect();
        let near = |d: f64| d.max(f64::MIN_POSITIVE).powi(-POWER).min(1e30);
        let total: f64 = distance.iter().map(|d| near(*d)).sum();
        self.bodies.iter().zip(&distance).map(|(b, d)| b.fade(*d) * near(*d) / total).collect()
    }
}

impl<const D: usize> Body<D> {
    fn distance(&self, x: &Vector<D>) -> f64 {
        self.points.iter().map(|p| (*p - *x).norm_squared()).fold(f64::INFINITY, f64::min).sqrt()
    }

    /// Decay function ψ(d).
    fn fade(&self, d: f64) -> f64 {
        let s = ((d - self.inner) / (self.outer - self.inner)).clamp(0.0, 1.0);
        1.0 - s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
    }
}

/// Relation between the particles that move with body number `b`, a solid of particles, and its surface.
fn carried<const D: usize>(
    cloud: &Cloud<D>,
    (b, net): (usize, &SurfaceNet<D>),
    moves: impl Fn(usize) -> bool + Sync,
) -> Vec<(Carried<D>, bool)> {
    let mut all = vec![(Carried::default(), false); cloud.n_real()];
    let first = cloud.n_fluid;
    sweep_slots(&mut all, |i, slot| {
        let own = cloud.interface_range().contains(&i) && usize::from(cloud.interface[i - first].body) == b;
        if own {
            *slot = (net.on_surface(&cloud.x[i], &cloud.interface[i - first].normal), true);
        } else if moves(i) {
            *slot = (net.around(&cloud.x[i]), false);
        }
    });
    all
}

fn body<const D: usize>(cloud: &Cloud<D>, (b, law): (usize, &BodyMotion<D>), until: f64) -> Body<D> {
    let first = cloud.n_fluid;
    let own = cloud.interface.iter().enumerate().filter(|(_, w)| usize::from(w.body) == b);
    let all: Vec<Vector<D>> = own.map(|(w, _)| cloud.x[first + w]).collect();
    let every = all.len().div_ceil(SAMPLES).max(1);
    let bounds = Bounds::around(&all);
    let length = bounds.extent().max_abs();
    // sides that cut through the body (planes of symmetry), or lie behind it, do not limit the motion
    let domain = Bounds::around(&cloud.x[..cloud.n_fluid]);
    let soft = law.net().is_some();
    let slides = |d: usize, side: f64| {
        let on = |(axis, place): &(usize, f64)| *axis == d && (place - side).abs() < 0.01 * length;
        soft && planes(cloud).iter().any(on)
    };
    let gaps = (0..D).flat_map(|d| {
        let all = &cloud.tree.bounds();
        let sides = [(bounds.min[d] - domain.min[d], all.min[d]), (domain.max[d] - bounds.max[d], all.max[d])];
        sides.into_iter().filter(move |(_, side)| !slides(d, *side)).map(|(gap, _)| gap).collect::<Vec<f64>>()
    });
    let room = gaps.filter(|g| *g > 0.1 * length).fold(f64::INFINITY, f64::min);
    let outer = (OUTER * length.max(displacement(&bounds, law, until))).min(REACH * room);
    let points = all.into_iter().step_by(every).collect();
    Body { trajectory: PointTrajectory::new(law, &[]), points, inner: (INNER * length).min(0.25 * outer), outer, soft }
}

/// Greatest displacement of the corners of the bounding box of a body and of its modes until the time `until`.
fn displacement<const D: usize>(bounds: &Bounds<D>, law: &BodyMotion<D>, until: f64) -> f64 {
    let corner = |k: usize| Vector::from_fn(|d| if k >> d & 1 == 0 { bounds.min[d] } else { bounds.max[d] });
    let far = |pose: RigidPose<D>| (0..1 << D).map(|k| (pose.point(&corner(k)) - corner(k)).norm()).fold(0.0, f64::max);
    let bend =
        |t: f64| law.coordinates(t).iter().zip(law.shapes()).map(|(q, shape)| q.abs() * shape.size()).sum::<f64>();
    let at = |t: f64| far(law.pose(t)) + bend(t);
    (0..=TIMES).map(|k| at(until * k as f64 / TIMES as f64)).fold(0.0, f64::max)
}

/// x + Σ_b φ_b (x_b − x), where body number b moves x to x_b = `carried(b)` and `left` are the factors on the
/// components.
fn blended<const D: usize>(
    x: &Vector<D>,
    share: impl Iterator<Item = f64>,
    carried: impl Fn(usize) -> Vector<D>,
    left: impl Fn(usize) -> Option<Vector<D>>,
) -> Vector<D> {
    share.enumerate().filter(|(_, s)| *s > 0.0).fold(*x, |sum, (b, s)| {
        let moved = (carried(b) - *x) * s;
        sum + left(b).map_or(moved, |left| Vector::from_fn(|d| moved[d] * left[d]))
    })
}

/// Planes of symmetry of a cloud: axis and coordinate.
fn planes<const D: usize>(cloud: &Cloud<D>) -> Vec<(usize, f64)> {
    let mut all: Vec<(usize, f64)> = Vec::new();
    for t in &cloud.transforms {
        let mirrored: Vec<usize> = (0..D).filter(|d| t.sign[*d] < 0.0).collect();
        if let [axis] = mirrored[..] {
            all.push((axis, 0.5 * t.offset[axis]));
        }
    }
    all
}

impl<const D: usize> Path<D> for MotionBlending<D> {
    fn at(&self, t: f64, jets: &[Jet]) -> Places<'_, D> {
        let trajectories: Vec<_> = self.bodies.iter().map(|b| b.trajectory.with(t, jets)).collect();
        let n = self.bodies.len();
        Box::new(move |i, x| {
            let share = self.share[i * n..(i + 1) * n].iter().map(|s| f64::from(*s));
            let left = |b: usize| if self.bodies[b].soft { self.sliding.get(i).copied() } else { None };
            blended(x, share, |b| trajectories[b](i, x), left)
        })
    }

    fn origin(&self, x: &Vector<D>, t: f64, jets: &[Jet]) -> Vector<D> {
        let laws: Vec<_> = self.bodies.iter().map(|b| b.trajectory.law().momentary(t, jets)).collect();
        let places: Vec<_> = laws.iter().map(|law| law.places(t)).collect();
        let mut before = *x;
        for _ in 0..ROUNDS {
            let left = |b: usize| self.bodies[b].soft.then(|| self.slides(&before));
            let miss = *x - blended(&before, self.shares(&before).into_iter(), |b| places[b](&before), left);
            before += miss;
            if miss.max_abs() < 1e-12 {
                break;
            }
        }
        before
    }
}
