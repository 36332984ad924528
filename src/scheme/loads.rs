//! Forces of the gas on the walls.
use crate::math::Vector;

use super::discretisation::Frame;
use super::fluid::{Fluid, Work};

impl<const D: usize> Fluid<D> {
    /// Force of the gas on the piece of wall of interface particle `w`, in the axes of the case: pressure above that far away, and
    /// friction; from the states and, with viscosity, the gradients in `work` (per unit span in 2-D).
    pub fn wall_force(&self, frame: &Frame<D>, work: &Work<D>, w: usize) -> Vector<D> {
        let cloud = &frame.discretisation.cloud;
        let wall = &cloud.interface[w];
        let push = wall.area * (self.far_field.pressure() - work.state[cloud.n_fluid + w].pressure);
        let rub = self.wall_slopes((cloud, &frame.walls), work, w);
        let rub = rub.map_or(Vector::ZERO, |at| at.stress * wall.area.norm());
        frame.to_inertial_axes(&(push + rub))
    }
}
