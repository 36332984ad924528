//! The gas as it stands at a moment, for those who look: pictures, probes, loads, balances, checkpoints.
//!
//! A [`View`] ties the equations ([`Fluid`]), the cloud at a time ([`Frame`]) and the states on it ([`Work`]) together and
//! answers in the axes of the case, whatever the axes of the frame: where particles are, what the gas does there and what it
//! does to walls. It copies nothing and changes nothing. Of the cloud itself ([`View::cloud`]) only what does not depend on
//! axes should be taken: lists, spacings, volumes, lengths.
use super::fluid::{Fluid, Work};
use super::frame::Frame;
use super::lanes::Number;
use super::viscous::WallSlopes;
use super::wall_fits::lowest_two;
use crate::cloud::Cloud;
use crate::math::Vector;
use crate::physics::Primitive;

/// The gas at a moment.
#[derive(Clone, Copy)]
pub struct View<'a, const D: usize> {
    /// The equations.
    pub fluid: &'a Fluid<D>,
    /// The cloud at the time.
    pub frame: &'a Frame<D>,
    /// States of all particles and, where slopes are asked for, their gradients, in the axes of the frame.
    pub work: &'a Work<D>,
}

impl<const D: usize> Fluid<D> {
    /// The gas with the state `u` in `frame`; fills `work`.
    pub fn view<'a>(&'a self, frame: &'a Frame<D>, u: &[f64], work: &'a mut Work<D>) -> View<'a, D> {
        self.fill_states(frame, u, work);
        self.fill_gradients(frame, work);
        View::new(self, frame, work)
    }
}

impl<const D: usize> Fluid<D> {
    /// Force of the gas on interface particle `w`, whose state and gradients are in `work`, in the axes of the case: pressure beyond that of
    /// the far field, and friction (per unit span in 2-D); with numbers that carry their change, how it changes.
    pub fn wall_force<S: Number>(&self, (frame, work): (&Frame<D>, &Work<D, S>), w: usize) -> Vector<D, S> {
        if let Some(taken) = frame.taken.get(w).filter(|t| t.area > 0.0) {
            return frame.to_inertial_axes(&Vector::constant(&taken.force));
        }
        let cloud = &frame.discretisation.cloud;
        let wall = &cloud.interface[w];
        let beyond = S::constant(self.far_field.pressure()) - work.state[cloud.n_fluid + w].pressure;
        let push = Vector::constant(&wall.area) * beyond;
        let rub = self.wall_slopes((cloud, work), w, frame.walls.get(w));
        let rub = rub.map_or(Vector::zero(), |at| at.stress.times(wall.area.norm()));
        frame.to_inertial_axes(&(push + rub))
    }
}

impl<'a, const D: usize> View<'a, D> {
    /// Looks at the states and gradients in `work`, which are those of `frame`.
    pub fn new(fluid: &'a Fluid<D>, frame: &'a Frame<D>, work: &'a Work<D>) -> Self {
        Self { fluid, frame, work }
    }

    /// Time.
    pub fn time(&self) -> f64 {
        self.frame.time
    }

    /// The cloud; places and directions in it are in the axes of the frame.
    pub fn cloud(&self) -> &'a Cloud<D> {
        &self.frame.discretisation.cloud
    }

    /// Particles before any motion.
    pub fn reference(&self) -> &'a Cloud<D> {
        &self.fluid.discretisation.cloud
    }

    /// Place of particle `i`.
    pub fn place(&self, i: usize) -> Vector<D> {
        self.frame.place(i)
    }

    /// Velocity of particle `i` itself.
    pub fn velocity(&self, i: usize) -> Vector<D> {
        self.frame.to_inertial_axes(&self.frame.velocity_of(i))
    }

    /// State at particle `i`.
    #[inline]
    pub fn state(&self, i: usize) -> Primitive<D> {
        self.turned(&self.work.state[i])
    }

    /// Curl of the velocity at particle `i`, along the third axis in plane flow; gradients must be known. Zero where the scheme
    /// has no slope.
    pub fn vorticity(&self, i: usize) -> [f64; 3] {
        let slope = &self.work.gradient[i].velocity;
        let turning = |a: usize, b: usize| if a < D && b < D { slope[b][a] - slope[a][b] } else { 0.0 };
        if D < 3 {
            return [0.0, 0.0, turning(0, 1)];
        }
        let curl = [turning(1, 2), turning(2, 0), turning(0, 1)];
        self.frame.to_inertial_axes(&Vector::from_fn(|d| curl[d])).to_3d()
    }

    /// A state in the axes of the frame, seen in those of the case.
    #[inline]
    pub fn turned(&self, q: &Primitive<D>) -> Primitive<D> {
        Primitive { velocity: self.frame.to_inertial_axes(&q.velocity), ..*q }
    }

    /// Normal of interface particle `w`, into the gas.
    pub fn normal(&self, w: usize) -> Vector<D> {
        self.frame.to_inertial_axes(&self.cloud().interface[w].normal)
    }

    /// Area vector of interface particle `w`, into the gas.
    pub fn area(&self, w: usize) -> Vector<D> {
        self.frame.to_inertial_axes(&self.cloud().interface[w].area)
    }

    /// Force of the pressure beyond that of the far field on interface particle `w`.
    pub fn pressure_force(&self, w: usize) -> Vector<D> {
        let (cloud, far) = (self.cloud(), self.fluid.far_field.pressure());
        self.frame.to_inertial_axes(&(cloud.interface[w].area * (far - self.work.state[cloud.n_fluid + w].pressure)))
    }

    /// Force of the viscous stress on interface particle `w`; `None` where the gas slides.
    pub fn friction_force(&self, w: usize) -> Option<Vector<D>> {
        Some(self.wall_slopes(w)?.stress * self.cloud().interface[w].area.norm())
    }

    /// Force of the gas on interface particle `w`: pressure beyond that of the far field, and friction (per unit span in 2-D).
    pub fn wall_force(&self, w: usize) -> Vector<D> {
        self.fluid.wall_force((self.frame, self.work), w)
    }

    /// Stress and heat on the wall of interface particle `w`; `None` where the gas slides.
    pub fn wall_slopes(&self, w: usize) -> Option<WallSlopes<D>> {
        let found = self.fluid.wall_slopes((self.cloud(), self.work), w, self.frame.walls.get(w))?;
        Some(WallSlopes { stress: self.frame.to_inertial_axes(&found.stress), ..found })
    }

    /// Distance of the first particle from the wall in viscous lengths, y⁺ = η √(ρ |τ|)/μ; `None` where the gas slides.
    pub fn y_plus(&self, w: usize) -> Option<f64> {
        let (gas, cloud) = (&self.fluid.gas, self.cloud());
        let stress = self.wall_slopes(w)?.stress.norm();
        let height = lowest_two(cloud, w).map_or(cloud.spacing[cloud.n_fluid + w], |(_, heights)| heights[0]);
        let wall = &self.work.state[cloud.n_fluid + w];
        let viscosity = self.fluid.viscous_model.as_ref()?.medium.at(gas.temperature(wall));
        Some(height * (wall.density * stress).sqrt() / viscosity)
    }

    /// The place before any motion of what is at `x`.
    pub fn origin(&self, x: &Vector<D>) -> Vector<D> {
        let unmoved = || self.fluid.cloud_motion.origin(x, self.frame.time, &self.frame.jets);
        self.frame.turn.as_ref().map_or_else(unmoved, |pose| pose.inverse_point(x))
    }

    /// The point `x` in the axes of the frame.
    pub(super) fn in_frame(&self, x: &Vector<D>) -> Vector<D> {
        self.frame.turn.as_ref().map_or(*x, |pose| pose.inverse_point(x))
    }

    /// Where the point `x` of body number `body`, as that stood before any motion, is.
    pub fn carried(&self, body: usize, x: &Vector<D>) -> Vector<D> {
        let (motion, time, jets) = (&self.fluid.cloud_motion, self.frame.time, &self.frame.jets);
        match motion.law_of(body).filter(|law| law.net().is_some()) {
            Some(law) => law.momentary(time, jets).places(time)(x),
            None => motion.body(body, time, jets).point(x),
        }
    }

    /// A direction on body number `body`, as that stood before any motion.
    pub fn carried_direction(&self, body: usize, v: &Vector<D>) -> Vector<D> {
        self.fluid.cloud_motion.body(body, self.frame.time, &self.frame.jets).direction(v)
    }

    /// Volumes for totals and means, see [`Fluid::volumes`].
    pub fn volumes(&self) -> Vec<f64> {
        self.fluid.volumes_of(self.cloud())
    }
}
