//! The cloud at one time.
//!
//! A [`Discretisation`] is what the scheme knows of the cloud: positions, weights, fits at the walls. A [`Frame`] is the shape at a
//! time with the velocities of its particles, in axes of its own where the cloud moves as one.
use std::sync::Arc;

use super::wall_fits::WallFits;
use super::wall_motion::WallMotion;
use crate::cloud::operators::WallFace;
use crate::cloud::{Cloud, Operators};
use crate::math::Vector;
use crate::math::jet::{Jet, Scalar};
use crate::motion::RigidPose;
use crate::physics::Primitive;

/// The cloud with the operators that follow from positions.
#[derive(Clone, Debug)]
pub struct Discretisation<const D: usize> {
    /// Particles.
    pub cloud: Cloud<D>,
    /// Weights and edges.
    pub operators: Operators<D>,
    /// Fits of the interface particles.
    pub walls: WallFits,
}

impl<const D: usize> Discretisation<D> {
    /// Fits all weights of a cloud.
    pub fn new(cloud: Cloud<D>, operators: Operators<D>) -> Self {
        let walls = WallFits::new(&cloud);
        Self { cloud, operators, walls }
    }
}

/// What depends on time but is not evolved.
#[derive(Clone, Debug)]
pub struct Frame<const D: usize> {
    /// Time.
    pub time: f64,
    /// The cloud in the axes that states are looked at in.
    pub discretisation: Arc<Discretisation<D>>,
    /// From those axes to those of the case, when they differ.
    pub turn: Option<RigidPose<D>>,
    /// Velocities of all particles in the axes of `discretisation`; empty when nothing moves.
    pub velocity: Arc<Vec<Vector<D>>>,
    /// Spin and acceleration of the wall at each interface particle; empty when nothing moves.
    pub walls: Arc<Vec<WallMotion<D>>>,
    /// How fluid particles that travel go through the step; empty for all others.
    pub lagrangian_step: LagrangianStep<D>,
    /// Coordinates of bodies that are unknowns, with rates and accelerations; empty where all motion is prescribed.
    pub jets: Vec<Jet>,
    /// What walls that another system decides on take; empty where the state of the gas alone says it.
    pub taken: Arc<Vec<Taken<D>>>,
    /// States that sides hold whatever the flow is, in the axes of the case: at each outer particle, at its source and behind that.
    pub held: Vec<[Primitive<D>; 3]>,
}

/// What an interface particle takes in a step, where a structure beside the gas has decided on it.
#[derive(Clone, Copy, Debug)]
pub struct Taken<const D: usize> {
    /// Force of pressure beyond that of the far field, and friction.
    pub force: Vector<D>,
    /// Power of that force.
    pub power: f64,
    /// Area of all pieces of wall that share it; 0 where the state of the gas says what is taken.
    pub area: f64,
}

impl<const D: usize> Taken<D> {
    /// What the state of the gas says.
    pub const BY_STATE: Self = Self { force: Vector::ZERO, power: 0.0, area: 0.0 };
}

impl<const D: usize> Frame<D> {
    /// What the piece of wall `face` takes, where another system has decided on it: force and power beyond the pressure of the far field.
    pub(super) fn taken_by(&self, face: &WallFace<D>) -> Option<(Vector<D>, f64)> {
        if self.taken.is_empty() {
            return None;
        }
        let cloud = &self.discretisation.cloud;
        let source = cloud.source(face.wall as usize);
        let taken = self.taken.get(source.index.checked_sub(cloud.n_fluid)?).filter(|t| t.area > 0.0)?;
        let part = face.area.norm() / taken.area;
        let force = match source.image {
            false => taken.force,
            true => {
                let image = &cloud.ghosts[face.wall as usize - cloud.n_real()];
                cloud.transforms[image.transform as usize].direction(&taken.force)
            }
        };
        Some((force * part, taken.power * part))
    }

    /// Area of all pieces of wall that belong to each interface particle, in itself or as an image of it.
    pub fn wall_areas(&self) -> Vec<f64> {
        let Discretisation { cloud, operators, .. } = self.discretisation.as_ref();
        let mut all = vec![0.0; cloud.interface.len()];
        for face in (0..operators.n_fluid_parts).flat_map(|k| operators.wall_faces(k)) {
            if let Some(slot) =
                cloud.source(face.wall as usize).index.checked_sub(cloud.n_fluid).and_then(|w| all.get_mut(w))
            {
                *slot += face.area.norm();
            }
        }
        all
    }

    /// Velocity of particle `i`.
    #[inline(always)]
    pub fn velocity_of(&self, i: usize) -> Vector<D> {
        if self.velocity.is_empty() { Vector::ZERO } else { self.velocity[i] }
    }

    /// True when particles move.
    #[inline(always)]
    pub fn moves(&self) -> bool {
        !self.velocity.is_empty()
    }

    /// A direction in the axes of `discretisation`, seen in those of the case.
    #[inline(always)]
    pub fn to_inertial_axes<S: Scalar>(&self, v: &Vector<D, S>) -> Vector<D, S> {
        self.turn.as_ref().map_or(*v, |t| t.direction(v))
    }

    /// A direction in the axes of the case, seen in those of `discretisation`.
    #[inline(always)]
    pub fn to_body_axes<S: Scalar>(&self, v: &Vector<D, S>) -> Vector<D, S> {
        self.turn.as_ref().map_or(*v, |t| t.inverse_direction(v))
    }

    /// Place of particle `i` in the axes of the case.
    pub fn place(&self, i: usize) -> Vector<D> {
        let x = &self.discretisation.cloud.x[i];
        self.turn.as_ref().map_or(*x, |t| t.point(x))
    }

    /// Brings the momentum among the unknowns of a particle from the axes of `discretisation` to those of the case.
    pub(super) fn momentum_to_inertial_axes(&self, row: &mut [f64]) {
        if self.turn.is_some() {
            let momentum = self.to_inertial_axes(&Vector::from_fn(|d| row[1 + d]));
            (0..D).for_each(|d| row[1 + d] = momentum[d]);
        }
    }

    /// Brings the momentum among the unknowns of a particle from the axes of the case to those of `discretisation`.
    pub(super) fn momentum_to_body_axes(&self, row: &mut [f32]) {
        if self.turn.is_some() {
            let momentum = self.to_body_axes(&Vector::from_fn(|d| f64::from(row[1 + d])));
            (0..D).for_each(|d| row[1 + d] = momentum[d] as f32);
        }
    }
}

/// How fluid particles that travel go through a step.
#[derive(Clone, Debug, Default)]
pub struct LagrangianStep<const D: usize> {
    /// True once they have chosen where they go; until then they stand where the step before led.
    pub off: bool,
    /// Time at which the step began.
    pub since: f64,
    /// Where they were then.
    pub base: Arc<Vec<Vector<D>>>,
    /// Their straight course in it.
    pub course: Arc<Vec<Vector<D>>>,
    /// Their course in the step before.
    pub before: Arc<Vec<Vector<D>>>,
    /// Velocities of all particles when the step began.
    pub velocity: Arc<Vec<Vector<D>>>,
}
