//! A gas that keeps its entropy.
//!
//! Where no stream passes through, any distribution of entropy that rests in the gas is a periodic solution of the Euler
//! equations, and a harmonic balance finds one of them that depends on the way to it. The entropy is then held: the energy of
//! a particle is drawn to that of the free stream's entropy, p = p∞ (ρ/ρ∞)^γ, at the rate c/h at which sound crosses its
//! spacing h,
//!
//! S_E = (c/h) (p∞ (ρ/ρ∞)^γ − p)/(γ − 1).
//!
//! In smooth flow the equation of energy asks for the same, so that S_E is as small as the error of the scheme.
use super::fluid::{Fluid, Work};
use super::frame::Frame;
use super::lanes::Number;
use crate::math::Vector;
use crate::math::block_matrix::Rows;
use crate::math::parallel::sweep_rows;
use crate::physics::{Conserved, n_variables};

impl<const D: usize> Fluid<D> {
    /// Rate c/h of particle `i`.
    fn drawn<S: Number>(&self, frame: &Frame<D>, work: &Work<D, S>, i: usize) -> S {
        self.gas.sound_speed(&work.state[i]) * (1.0 / frame.discretisation.cloud.spacing[i])
    }

    /// p∞ (ρ/ρ∞)^γ, in units in which ρ∞ = 1 and p∞ = 1/γ.
    fn held_pressure<S: Number>(&self, density: S) -> S {
        density.powf(self.gas.gamma) * (1.0 / self.gas.gamma)
    }

    /// Adds S_E to the rate of change of every fluid particle.
    pub(super) fn hold_entropy<S: Number>(&self, frame: &Frame<D>, work: &Work<D, S>, du: &mut [f64]) {
        sweep_rows(du, n_variables(D), |i, row| {
            let q = &work.state[i];
            let missing = (self.held_pressure(q.density) - q.pressure) * (1.0 / (self.gas.gamma - 1.0));
            let energy = (self.drawn(frame, work, i) * missing).told();
            Conserved { density: 0.0, momentum: Vector::<D>::ZERO, energy }.add_to(row);
        });
    }

    /// Adds −∂S_E/∂U of particle `i`, c/h fixed.
    pub(super) fn hold_entropy_block(&self, (frame, work): (&Frame<D>, &Work<D>), i: usize, rows: &mut Rows<'_>) {
        let (q, rate) = (&work.state[i], self.drawn(frame, work, i));
        let g1 = self.gas.gamma - 1.0;
        let stiffness = self.gas.gamma * self.held_pressure(q.density) / q.density;
        let slope = |c: usize| match c {
            0 => stiffness / g1 - 0.5 * q.velocity.norm_squared(),
            c if c <= D => q.velocity[c - 1],
            _ => -1.0,
        };
        rows.add(i, i, |r, c| if r == D + 1 { -rate * slope(c) } else { 0.0 });
    }
}
