//! The gas on a cloud: what its equations are made of.
//!
//! [`Fluid`] holds what does not change in a march; what depends on time is in the [`Frame`](super::Frame), the state is a flat
//! slice, and [`Work`] is where an evaluation keeps what it needs.
use std::sync::Arc;

use super::discretisation::CloudMotion;
use super::frame::Discretisation;
use super::reconstruct::{Factors, Gradient, Reconstruction};
use super::viscous::ViscousModel;
use super::wall_state::WallCondition;
use crate::case::{Flux, Limiter};
use crate::cloud::Cloud;
use crate::math::Vector;
use crate::math::dual::Dual;
use crate::math::jet::Scalar;
use crate::math::parallel::sweep_rows;
use crate::physics::{Gas, Primitive, n_variables};
use crate::system::{Field as Unknowns, Name};

/// A field of states.
pub type Field<const D: usize> = Arc<dyn Fn(&Vector<D>) -> Primitive<D> + Send + Sync>;

/// The compressible Euler equations on a cloud, with friction the Navier-Stokes equations.
pub struct Fluid<const D: usize> {
    /// Particles, weights and fits before any motion.
    pub discretisation: Arc<Discretisation<D>>,
    /// How particles move.
    pub cloud_motion: CloudMotion<D>,
    /// The gas.
    pub gas: Gas,
    /// Upwind flux.
    pub flux: Flux,
    /// Slope limiter.
    pub limiter: Limiter,
    /// Order, κ, threshold.
    pub reconstruction: Reconstruction,
    /// Exactly conservative coefficients.
    pub conservative: bool,
    /// The gas keeps the entropy of the free stream.
    pub isentropic: bool,
    /// Viscosity; `None` for an inviscid gas.
    pub viscous_model: Option<Arc<ViscousModel>>,
    /// State of the far field.
    pub far_field: Arc<dyn FarField<D>>,
    /// The field at the start, which some sides hold for ever.
    pub held: Field<D>,
    /// The unknowns: density, momentum and energy of every fluid particle.
    pub fields: [Unknowns; 1],
}

/// What the far field is, given the force on the bodies.
pub trait FarField<const D: usize>: Send + Sync {
    /// State at `x` when the bodies feel the force `force` (per unit span in 2-D).
    fn state(&self, x: &Vector<D>, force: &Vector<D>) -> Primitive<D>;
    /// The same with the change that goes with a change of the force.
    fn changing(&self, x: &Vector<D>, force: &Vector<D, Dual>) -> Primitive<D, Dual>;
    /// Static pressure far away.
    fn pressure(&self) -> f64;
    /// The velocity at `x` that the circulation of the force adds around bodies that nothing gives one, as they have no edge: such
    /// a circulation is what a start has left behind. `None` around other bodies.
    fn stray_velocity(&self, _x: &Vector<D>, _force: &Vector<D>) -> Option<Vector<D>> {
        None
    }
}

/// Storage of an evaluation.
pub struct Work<const D: usize, S = f64> {
    /// States of all particles, images included.
    pub state: Vec<Primitive<D, S>>,
    /// Gradients of all particles.
    pub gradient: Vec<Gradient<D, S>>,
    /// How steep the pressure is at all particles, from 0 to 1: see `reconstruct`. Speeds of sound while rates are found.
    pub steepness: Vec<S>,
    /// What the limiter and the steepness stay, where they are frozen.
    pub frozen: Option<Arc<Frozen<D>>>,
    /// The same with the change along a direction, once derivatives have been asked for.
    pub changing: Option<Box<Work<D, Dual>>>,
    /// States that sides hold beside the flow at hand, as in [`Frame::held`](super::Frame::held).
    pub held: Vec<[Primitive<D, S>; 3]>,
}

/// What a limiter does in one state.
pub struct Frozen<const D: usize> {
    /// What it leaves of the slopes at the ends of the edges of each part.
    pub factors: Vec<Vec<Factors<D>>>,
    /// How steep the pressure is at all particles.
    pub steepness: Vec<f64>,
}

impl<const D: usize, S: Scalar> Work<D, S> {
    /// Storage for `n` particles.
    pub fn new(n: usize) -> Self {
        let blank = Primitive { density: 1.0, velocity: Vector::ZERO, pressure: 1.0 };
        Self {
            state: vec![Primitive::constant(&blank); n],
            gradient: vec![Gradient::zero(); n],
            steepness: vec![S::constant(0.0); n],
            frozen: None,
            changing: None,
            held: Vec::new(),
        }
    }
}

impl<const D: usize> Fluid<D> {
    /// The unknowns on a cloud: density, momentum and energy of every fluid particle; density measures a residual.
    pub fn unknowns(cloud: &Cloud<D>) -> [Unknowns; 1] {
        [Unknowns::new(Name::Gas, cloud.n_fluid, n_variables(D)).measured_by(1)]
    }

    /// Boundary condition at the body with this number.
    #[inline]
    pub fn wall_condition(&self, body: u16) -> WallCondition {
        self.viscous_model.as_ref().map_or(WallCondition::Slip, |m| m.wall_condition(body))
    }

    /// The state at the start.
    pub fn start(&self) -> Vec<f64> {
        let cloud = &self.discretisation.cloud;
        let mut u = vec![0.0; self.fields.iter().map(Unknowns::len).sum()];
        sweep_rows(&mut u, n_variables(D), |i, row| self.gas.conserved(&(self.held)(&cloud.x[i])).store(row));
        u
    }
}
