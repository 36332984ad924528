//! How linear systems of the gas are preconditioned.
//!
//! Both ways start from the linearisation of the first-order scheme ([`super::jacobian`]), in the axes of a rigid cloud, so that
//! one goes on to serve while the cloud turns. Where a system reaches across the cloud, sweeps on a hierarchy of levels
//! ([`crate::math::multilevel`]); where the term of time couples what is near, an incomplete factorisation
//! ([`crate::math::incomplete`]). For all instances of a period at once, sweeps harmonic by harmonic.
use crate::math::Vector;
use crate::math::block_matrix::BlockMatrix;
use crate::math::incomplete::Incomplete;
use crate::math::multilevel::Multilevel;
use crate::math::parallel::sweep_rows;
use crate::physics::n_variables;
use crate::system::{Hierarchy, Implicit, Period, Preconditioner, Reach, RightHandSide, Shift};

use super::fluid::{Fluid, Work};
use super::frame::Frame;

/// The linearisation of a gas, and what approximates its inverse.
pub struct FluidPreconditioner {
    levels: Multilevel,
    factors: Incomplete,
    reach: Reach,
    /// Linearisations that are still to come before it is complete.
    mean: bool,
}

impl<const D: usize> Implicit for Fluid<D> {
    type Preconditioner = FluidPreconditioner;

    fn preconditioner(&self, plan: &Hierarchy, period: Option<Period>) -> FluidPreconditioner {
        let (discretisation, block) = (&self.discretisation, n_variables(D));
        let neighbours = &discretisation.cloud.neighbours;
        let parts = discretisation.operators.fluid_parts();
        // momentum counts in that of the stream or of sound, energy in the energy of that
        let stream = self.far_field.state(&Vector::ZERO, &Vector::ZERO);
        let speed = self.gas.sound_speed(&stream).max(stream.velocity.norm());
        let mut scale = vec![speed; block];
        (scale[0], scale[block - 1]) = (1.0, speed * speed);
        let matrix = BlockMatrix::new(block, parts, &neighbours.first, &neighbours.index).scaled(&scale);
        let volume = discretisation.cloud.volume[..discretisation.cloud.n_fluid].to_vec();
        let levels = Multilevel::new(matrix, volume, plan.group, plan.cycle);
        let levels = match period {
            Some(period) => levels.in_time(period.instances, period.omega, period.mean),
            None => levels,
        };
        FluidPreconditioner { levels, factors: Incomplete::default(), reach: Reach::Far, mean: false }
    }
}

impl<const D: usize> Preconditioner<Fluid<D>> for FluidPreconditioner {
    fn begin(&mut self, points: usize) {
        self.mean = points > 1;
        if self.mean {
            self.levels.finest().begin_mean(points);
        }
    }

    fn add(&mut self, fluid: &Fluid<D>, frame: &Frame<D>, u: &[f64], work: &mut Work<D>) {
        fluid.fill_states(frame, u, work);
        super::jacobian::assemble(fluid, frame, work, self.levels.finest());
    }

    fn finish(&mut self, shift: &Shift<'_>) {
        if self.mean {
            self.levels.finest().end_mean();
        }
        self.reach = shift.reach;
        self.levels.finest().shift(|i| shift.of(i));
        match self.reach {
            Reach::Near => self.factors.factor(self.levels.finest()),
            Reach::Far => self.levels.refresh(),
        }
    }

    fn apply(&mut self, _: &Fluid<D>, frames: &[&Frame<D>], r: &RightHandSide<'_>, z: &mut [f64]) {
        let (block, turns) = (n_variables(D), frames.iter().any(|f| f.turn.is_some()));
        let width = block * frames.len();
        let right = |i: usize, row: &mut [f32]| {
            r.row(i, i * width, row);
            if turns {
                row.chunks_exact_mut(block).zip(frames).for_each(|(row, frame)| frame.momentum_to_body_axes(row));
            }
        };
        match self.reach {
            Reach::Near => self.factors.apply(self.levels.finest(), right, z),
            Reach::Far => self.levels.apply(right, z),
        }
        if turns {
            sweep_rows(z, width, |_, row| {
                row.chunks_exact_mut(block).zip(frames).for_each(|(row, frame)| frame.momentum_to_inertial_axes(row));
            });
        }
    }

    fn bytes(&self) -> usize {
        self.levels.bytes() + self.factors.bytes()
    }
}
