//! Motion of bodies: x(t), and v(t) derived from it.
//!
//! [`Motions`] holds one [`BodyMotion`] for each body, constructed directly ([`Motions::new`]) or from a case
//! ([`Motions::of_case`]). A [`RigidPose`] is the position and orientation at one time. Velocities are never coded a
//! second time: the time integration takes differences of positions with the same formula as for the state, and
//! velocities at an instant follow from differentiating the same law (`math::jet`).
mod freedom;
mod from_case;
mod law;
mod mode;
mod mode_points;
mod point_trajectory;
mod pose;
mod samples;
mod spline;
mod surface_net;
#[cfg(test)]
mod tests;
mod time_function;

pub use freedom::{Freedom, Role, positions};
pub use from_case::{MotionError, ReadFile, faulty_tables, mode_shape};
pub use law::{BodyMotion, Kinematics};
pub use mode::{Expansion, Hinge, ModeShape};
pub use mode_points::WARNING;
pub use point_trajectory::PointTrajectory;
pub use pose::RigidPose;
pub use spline::Spline;
pub use surface_net::{Carried, NetDisplacement, SurfaceNet, tangents};
pub use time_function::MOST_PERIODS;
pub use time_function::{Repeat, TimeFunction};

/// Relative difference below which two frequencies are equal.
const SAME: f64 = 1e-9;

/// The motions of all bodies, in units of the solver.
#[derive(Clone, Debug)]
pub struct Motions<const D: usize> {
    bodies: Vec<BodyMotion<D>>,
    general: BodyMotion<D>,
    /// Mode shapes on which generalised forces are computed.
    forces: Vec<ModeShape<D>>,
    /// Period of the forces on bodies whose coordinates are unknowns.
    forced: Option<f64>,
}

impl<const D: usize> Motions<D> {
    /// Bodies with these motions.
    pub fn new(bodies: Vec<BodyMotion<D>>) -> Self {
        Self { bodies, general: BodyMotion::fixed(), forces: Vec::new(), forced: None }
    }

    /// `n` bodies at rest.
    pub fn fixed(n: usize) -> Self {
        Self::new(vec![BodyMotion::fixed(); n])
    }

    /// Replaces the motion of a body by one whose coordinates are unknowns, see [`BodyMotion::with_freedom`].
    pub fn free(&mut self, body: usize, motion: BodyMotion<D>) {
        self.bodies[body] = motion;
    }

    /// Sets the period of the forces on bodies whose coordinates are unknowns.
    pub fn force_with(&mut self, period: f64) {
        self.forced = Some(period);
    }

    /// Motion of body number `body`.
    pub fn of(&self, body: usize) -> &BodyMotion<D> {
        &self.bodies[body]
    }

    /// Mode shapes of the flexible modes of `[gaf]`, in their order, where a harmonic balance computes generalised
    /// forces.
    pub fn shapes_of_forces(&self) -> &[ModeShape<D>] {
        &self.forces
    }

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// True when there are no bodies.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Motion of a rigid cloud: the common motion of the bodies, or that of `[motion]` without bodies.
    pub fn cloud(&self) -> &BodyMotion<D> {
        self.bodies.first().unwrap_or(&self.general)
    }

    /// True when a body or the cloud moves.
    pub fn moves(&self) -> bool {
        self.laws().any(|law| !law.is_fixed())
    }

    /// Common period of all motions; `None` when one of them is not periodic, or when nothing moves.
    pub fn period(&self) -> Option<f64> {
        match time_function::common(self.laws().map(BodyMotion::repeat)) {
            Repeat::Every(period) => Some(period),
            Repeat::Constant => self.forced,
            Repeat::Never => None,
        }
    }

    /// Angular frequencies of all sines, ascending and distinct.
    pub fn frequencies(&self) -> Vec<f64> {
        let mut all: Vec<f64> = self.laws().flat_map(BodyMotion::frequencies).collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| (*a - *b).abs() <= SAME * *b);
        all
    }

    /// These frequencies as multiples of the common one, which is the first harmonic of a harmonic balance; ascending,
    /// empty without a common period.
    pub fn multiples(&self) -> Vec<usize> {
        let Some(period) = self.period() else { return Vec::new() };
        self.frequencies().iter().map(|omega| (omega * period / std::f64::consts::TAU).round() as usize).collect()
    }

    fn laws(&self) -> impl Iterator<Item = &BodyMotion<D>> {
        let alone = self.bodies.is_empty().then_some(&self.general);
        self.bodies.iter().chain(alone)
    }
}
