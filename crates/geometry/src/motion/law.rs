//! The motion of one body.
//!
//! x(t) = R(θ(t)) (X + Σ q_m(t) φ_m(X) − p) + p + d(t): the body deforms by its modes φ_m with the coordinates q_m and
//! rotates by θ about an axis a through its pivot p, which moves with the displacement d; X is the position before any
//! motion. With v = X − p and its part along the axis, P v = a (a·v), Rodrigues' formula is R v = P v + cos θ (v − P v)
//! + sin θ (a × v). In 2-D, a points away from the reader, so that positive angles are clockwise: nose up for a stream
//! along +x. In 3-D the default is a = +y, nose up for lift along +z. θ and d are sums of [`TimeFunction`]s; velocity
//! and acceleration follow from the same code with [`Jet`]s.
use std::borrow::Cow;
use std::sync::Arc;

use super::freedom::{Freedom, Role};
use super::mode::ModeShape;
use super::pose::RigidPose;
use super::surface_net::{NetDisplacement, SurfaceNet};
use super::time_function::{Repeat, TimeFunction, common, total, total_with_rates};
use crate::math::Vector;
use crate::math::jet::{Jet, Scalar};
use crate::math::rotation::rotate;

/// Motion of one body.
#[derive(Clone, Debug)]
pub struct BodyMotion<const D: usize> {
    pivot: Vector<D>,
    /// Rows of P, the projection onto the axis; zero in 2-D.
    along: [Vector<D>; D],
    /// Rows of the matrix of the cross product a ×.
    across: [Vector<D>; D],
    turn: Vec<TimeFunction>,
    shift: Vec<[TimeFunction; D]>,
    modes: Vec<(Arc<ModeShape<D>>, TimeFunction)>,
    /// Rotation vector θ of a body with free attitude in 3-D; empty for all other bodies.
    attitude: Vec<TimeFunction>,
    /// Relation between unknown coordinates and the motion of the body.
    freedom: Option<Arc<Freedom<D>>>,
    /// Surface of a solid of particles, and its displacement.
    net: Option<(Arc<SurfaceNet<D>>, NetDisplacement<D>)>,
}

/// Position, velocity and acceleration of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematics<const D: usize> {
    /// Position.
    pub position: Vector<D>,
    /// Velocity.
    pub velocity: Vector<D>,
    /// Acceleration.
    pub acceleration: Vector<D>,
}

impl<const D: usize> BodyMotion<D> {
    /// A body at rest.
    pub fn fixed() -> Self {
        Self::about(Vector::ZERO, None)
    }

    /// A body at rest with a pivot and (in 3-D) an axis of rotation; the default axis is +y.
    pub fn about(pivot: Vector<D>, axis: Option<[f64; 3]>) -> Self {
        let a = Vector(if D == 2 { [0.0, 0.0, -1.0] } else { axis.unwrap_or([0.0, 1.0, 0.0]) }).unit();
        let cross = [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]];
        Self {
            pivot,
            along: std::array::from_fn(|i| Vector::from_fn(|j| a[i] * a[j])),
            across: std::array::from_fn(|i| Vector::from_fn(|j| cross[i][j])),
            turn: Vec::new(),
            shift: Vec::new(),
            modes: Vec::new(),
            attitude: Vec::new(),
            freedom: None,
            net: None,
        }
    }

    /// Declares coordinates of the body as unknowns. The body is at rest until their values are given, see
    /// [`Self::momentary`]. Each coordinate of the role [`Role::Mode`] belongs to the next one of `shapes`.
    pub fn with_freedom(mut self, freedom: Freedom<D>, shapes: Vec<Arc<ModeShape<D>>>) -> Self {
        let ease = TimeFunction::Steady(0.0);
        self.modes = shapes.into_iter().map(|shape| (shape, ease.clone())).collect();
        self.freedom = Some(Arc::new(freedom));
        self
    }

    /// Declares the displacements of the surface particles of a solid as unknowns; the motion is then that of its
    /// supports.
    pub fn with_net(self, net: Arc<SurfaceNet<D>>) -> Self {
        Self { net: Some((net, NetDisplacement::default())), ..self }
    }

    /// Surface of a solid of particles, if the body is one.
    pub fn net(&self) -> Option<&Arc<SurfaceNet<D>>> {
        self.net.as_ref().map(|(net, _)| net)
    }

    /// Relation between unknown coordinates and the motion of the body, where there are any.
    pub fn freedom(&self) -> Option<&Freedom<D>> {
        self.freedom.as_deref()
    }

    /// The motion near the time `about`, where `jets` are the unknown coordinates and their rates: position, velocity
    /// and acceleration are exact at that time. A prescribed motion is returned unchanged.
    pub fn momentary(&self, about: f64, jets: &[Jet]) -> Cow<'_, Self> {
        if let Some((net, _)) = &self.net {
            return Cow::Owned(Self { net: Some((Arc::clone(net), net.displacement(jets))), ..self.clone() });
        }
        let Some(freedom) = &self.freedom else { return Cow::Borrowed(self) };
        let mut now = Self { freedom: None, ..self.clone() };
        let mut attitude = [Jet::constant(0.0); 3];
        for (role, jet) in freedom.moves(jets) {
            let function = TimeFunction::Momentary { about, jet };
            match role {
                Role::Turn => now.turn.push(function),
                Role::Shift(direction) => {
                    let along = |d: usize| TimeFunction::Momentary { about, jet: jet * Jet::constant(direction[d]) };
                    now.shift.push(std::array::from_fn(along));
                }
                Role::Attitude(k) => attitude[*k] = jet,
                Role::Mode(m) => now.modes[*m].1 = function,
                Role::Flap { sine, cosine } => {
                    now.modes[*sine].1 = TimeFunction::Momentary { about, jet: jet.sin() };
                    let stretch = jet.cos() - Jet::constant(1.0);
                    now.modes[*cosine].1 = TimeFunction::Momentary { about, jet: stretch };
                }
            }
        }
        if freedom.turns_in_space() {
            now.attitude = attitude.map(|jet| TimeFunction::Momentary { about, jet }).to_vec();
        }
        Cow::Owned(now)
    }

    /// Adds a rotation.
    pub fn with_angle(mut self, function: TimeFunction) -> Self {
        self.turn.push(function);
        self
    }

    /// Adds a displacement.
    pub fn with_shift(mut self, functions: [TimeFunction; D]) -> Self {
        self.shift.push(functions);
        self
    }

    /// Adds a displacement `function` times `direction`, for functions that are proportional to a factor.
    pub(super) fn with_shift_along(self, direction: &Vector<D>, function: impl Fn(f64) -> TimeFunction) -> Self {
        self.with_shift(std::array::from_fn(|d| function(direction[d])))
    }

    /// Adds a mode with the coordinate `function`.
    pub fn with_mode(mut self, shape: Arc<ModeShape<D>>, function: TimeFunction) -> Self {
        self.modes.push((shape, function));
        self
    }

    /// Position at time `t` of the point `x` with the modal displacements `bends`, generic in the scalar.
    fn place<S: Scalar>(&self, t: S, x: &Vector<D>, bends: &[Vector<D>]) -> [S; D] {
        let angle = total(&self.turn, t);
        let (sine, cosine) = (angle.sin(), angle.cos());
        let arm = *x - self.pivot;
        let mut arm: [S; D] = std::array::from_fn(|d| S::constant(arm[d]));
        for (bend, (_, function)) in bends.iter().zip(&self.modes) {
            let q = function.at(t);
            arm = std::array::from_fn(|d| arm[d] + q * S::constant(bend[d]));
        }
        let shift = self.shift_at(t);
        if !self.attitude.is_empty() {
            let turned = self.turned_freely(t, arm);
            return std::array::from_fn(|d| S::constant(self.pivot[d]) + shift[d] + turned[d]);
        }
        let dot =
            |row: &Vector<D>| (1..D).fold(S::constant(row[0]) * arm[0], |sum, d| sum + S::constant(row[d]) * arm[d]);
        std::array::from_fn(|d| {
            let kept = dot(&self.along[d]);
            S::constant(self.pivot[d]) + kept + shift[d] + cosine * (arm[d] - kept) + sine * dot(&self.across[d])
        })
    }

    /// The arm rotated by the rotation vector.
    fn turned_freely<S: Scalar>(&self, t: S, arm: [S; D]) -> [S; D] {
        let theta: [S; 3] = std::array::from_fn(|k| self.attitude[k].at(t));
        let arm: [S; 3] = std::array::from_fn(|d| if d < D { arm[d] } else { S::constant(0.0) });
        let turned = rotate(&theta, &arm);
        std::array::from_fn(|d| turned[d])
    }

    fn shift_at<S: Scalar>(&self, t: S) -> [S; D] {
        std::array::from_fn(|d| self.shift.iter().fold(S::constant(0.0), |sum, functions| sum + functions[d].at(t)))
    }

    /// Rotation and translation at time `t`, without modes.
    pub fn pose(&self, t: f64) -> RigidPose<D> {
        if self.turn.is_empty() && self.shift.is_empty() && self.attitude.is_empty() {
            return RigidPose::identity();
        }
        let origin = Vector(self.place(t, &self.pivot, &[]));
        let columns: [Vector<D>; D] =
            std::array::from_fn(|j| Vector(self.place(t, &(self.pivot + Vector::axis(j)), &[])) - origin);
        let rotation: [Vector<D>; D] = std::array::from_fn(|i| Vector::from_fn(|j| columns[j][i]));
        let turned = Vector::from_fn(|d| rotation[d].dot(&self.pivot));
        RigidPose { rotation, shift: origin - turned }
    }

    /// A function from positions before any motion to positions at time `t`.
    pub fn places(&self, t: f64) -> impl Fn(&Vector<D>) -> Vector<D> + '_ {
        let (pose, coordinates) = (self.pose(t), self.coordinates(t));
        move |x| {
            let bent = coordinates.iter().zip(self.shapes()).fold(*x, |sum, (q, shape)| sum + shape.at(x) * *q);
            match &self.net {
                Some((net, at)) if *at != NetDisplacement::default() => bent + net.around(x).of_groups(at),
                _ => pose.point(&bent),
            }
        }
    }

    /// Position, velocity and acceleration at time `t` of the point that is at `x` before any motion.
    pub fn kinematics(&self, t: f64, x: &Vector<D>) -> Kinematics<D> {
        let bends: Vec<Vector<D>> = self.shapes().map(|shape| shape.at(x)).collect();
        self.kinematics_of(t, x, &bends)
    }

    /// Position, velocity and acceleration with given modal displacements φ_m at `x`; without any, those of the rigid
    /// motion.
    pub fn kinematics_of(&self, t: f64, x: &Vector<D>, bends: &[Vector<D>]) -> Kinematics<D> {
        let place = self.place(Jet::variable(t), x, bends);
        Kinematics {
            position: Vector(place.map(|p| p.value)),
            velocity: Vector(place.map(|p| p.first)),
            acceleration: Vector(place.map(|p| p.second)),
        }
    }

    /// Velocity at time `t` of the point that is at `x` before any motion.
    pub fn velocity(&self, t: f64, x: &Vector<D>) -> Vector<D> {
        self.kinematics(t, x).velocity
    }

    /// Mode shapes of the body.
    pub fn shapes(&self) -> impl Iterator<Item = &ModeShape<D>> {
        self.modes.iter().map(|(shape, _)| shape.as_ref())
    }

    /// Coordinates q_m of the modes.
    pub fn coordinates(&self, t: f64) -> Vec<f64> {
        self.modes.iter().map(|(_, function)| function.at(t)).collect()
    }

    /// Coordinates q_m of the modes with their rates.
    pub fn coordinates_with_rates(&self, t: f64) -> Vec<Jet> {
        self.modes.iter().map(|(_, function)| function.at(Jet::variable(t))).collect()
    }

    /// True when the body deforms.
    pub fn bends(&self) -> bool {
        !self.modes.is_empty() || self.net.is_some()
    }

    /// Angle θ with its rate and acceleration, nose up positive.
    pub fn angle(&self, t: f64) -> Jet {
        total_with_rates(&self.turn, t)
    }

    /// Displacement d of the pivot.
    pub fn displacement(&self, t: f64) -> Vector<D> {
        Vector(self.shift_at(t))
    }

    /// Centre of rotation before any motion.
    pub fn pivot(&self) -> Vector<D> {
        self.pivot
    }

    /// True when the body is at rest.
    pub fn is_fixed(&self) -> bool {
        let rests = self.turn.is_empty() && self.shift.is_empty() && self.attitude.is_empty();
        rests && self.modes.is_empty() && self.freedom.is_none() && self.net.is_none()
    }

    /// True when the body rotates.
    pub fn turns(&self) -> bool {
        let freely = self.freedom.as_ref().is_some_and(|f| f.turns());
        freely || !self.turn.is_empty() || !self.attitude.is_empty()
    }

    /// True when position, velocity and acceleration are finite at time `t`.
    pub fn is_finite(&self, t: f64) -> bool {
        let k = self.kinematics(t, &self.pivot);
        let angle = self.angle(t);
        let bend = self.coordinates_with_rates(t).iter().all(|q| q.value.is_finite() && q.first.is_finite());
        bend && k.position.is_finite() && k.velocity.is_finite() && angle.value.is_finite() && angle.first.is_finite()
    }

    /// Periodicity of the motion; a rotation at a constant rate is periodic with one revolution.
    pub fn repeat(&self) -> Repeat {
        let turns = self.turn.iter().map(|function| match function {
            TimeFunction::Steady(rate) if *rate != 0.0 => Repeat::Every(std::f64::consts::TAU / rate.abs()),
            other => other.repeat(),
        });
        let others = self.shift.iter().flatten().chain(self.modes.iter().map(|(_, function)| function));
        common(turns.chain(others.map(TimeFunction::repeat)))
    }

    /// Angular frequencies of the sines of the motion.
    pub(super) fn frequencies(&self) -> impl Iterator<Item = f64> {
        let modes = self.modes.iter().map(|(_, function)| function);
        self.turn.iter().chain(self.shift.iter().flatten()).chain(modes).filter_map(|function| match function {
            TimeFunction::Sine { amplitude, omega, .. } if *amplitude != 0.0 => Some(*omega),
            _ => None,
        })
    }
}
