//! The circulation of a start, taken out.
use super::fluid::{Fluid, Work};
use super::frame::Frame;
use crate::math::parallel::sweep_rows;
use crate::physics::{Conserved, Primitive, n_variables};

/// Least part of the square of the speed of sound that is left.
const LEAST: f64 = 0.1;

impl<const D: usize> Fluid<D> {
    /// The state `u` without the circulation around bodies that have no edge to give them one.
    ///
    /// Steps of a relaxation are not those of a flow set going from rest (Kelvin 1869), whose circulation stays zero: they leave
    /// some, which no equation of a steady inviscid flow takes away. The vortex of the lift is taken from the velocity, at the
    /// same total enthalpy and entropy.
    pub fn without_circulation(&self, frame: &Frame<D>, work: &mut Work<D>, u: &mut [f64]) {
        if self.viscous_model.is_some() {
            return;
        }
        self.fill_states(frame, u, work);
        let force = self.pressure_force(frame, work);
        let cooling = 0.5 * (self.gas.gamma - 1.0);
        sweep_rows(u, n_variables(D), |i, row| {
            let Some(stray) = self.far_field.stray_velocity(&frame.place(i), &force) else { return };
            let q = self.gas.primitive(&Conserved::of_row(row, 0));
            let (velocity, sound2) = (q.velocity - stray, self.gas.gamma * q.pressure / q.density);
            let change = cooling * (q.velocity.norm_squared() - velocity.norm_squared()) / sound2;
            let warmer = (1.0 + change).max(LEAST);
            let density = q.density * warmer.powf(1.0 / (self.gas.gamma - 1.0));
            let pressure = q.pressure * (density / q.density) * warmer;
            self.gas.conserved(&Primitive { density, velocity, pressure }).store(row);
        });
    }
}
