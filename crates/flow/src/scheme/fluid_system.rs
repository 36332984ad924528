//! The gas on a cloud as a system of ordinary differential equations.
use std::sync::Arc;

use super::discretisation::CloudMotion;
use super::fluid::{Fluid, Work};
use super::frame::{Frame, LagrangianStep};
use crate::math::parallel::sweep_rows;
use crate::math::reduce::{first, maximum, minimum};
use crate::physics::Conserved;
use crate::system::{Fault, Field as Unknowns, Instant, Rate, System};

/// Times that an update is shortened, and the part of the change that is asked for that each of them aims at.
const SHORTENINGS: usize = 8;
const SHORTER: f64 = 0.95;

impl<const D: usize> Fluid<D> {
    /// Relative change of the density or the pressure of a particle by `part` of an update; infinite if NaN.
    #[inline(always)]
    fn change(&self, own: &Conserved<D>, update: &Conserved<D>, part: f64) -> f64 {
        let (old, new) = (self.gas.primitive(own), self.gas.primitive(&own.plus(part, update)));
        let change = (new.density / old.density - 1.0).abs().max((new.pressure / old.pressure - 1.0).abs());
        if change.is_finite() { change } else { f64::INFINITY }
    }
}

impl<const D: usize> System for Fluid<D> {
    type Frame = Frame<D>;
    type Work = Work<D>;

    fn fields(&self) -> &[Unknowns] {
        &self.fields
    }

    fn frame(&self, at: &Instant<'_>, _: &[f64]) -> Frame<D> {
        let cloud = &self.discretisation.cloud;
        let mut frame = Frame {
            time: at.time,
            discretisation: Arc::clone(&self.discretisation),
            turn: None,
            jets: Vec::new(),
            taken: Arc::default(),
            velocity: Arc::default(),
            walls: Arc::default(),
            lagrangian_step: LagrangianStep::default(),
            held: (0..cloud.outer.len()).map(|k| cloud.beside(k).map(|i| (self.held)(&cloud.x[i]))).collect(),
        };
        self.place(at, &mut frame);
        frame
    }

    fn place(&self, at: &Instant<'_>, frame: &mut Frame<D>) {
        self.cloud_motion.place(&self.discretisation, at, frame);
        if matches!(at.rate, Rate::Still) {
            frame.velocity = Arc::default();
            frame.walls = Arc::default();
        }
        if !self.cloud_motion.is_still() {
            self.hold_start(frame);
        }
    }

    fn plan_lagrangian_step(&self, step: f64, u: &[f64], work: &mut Work<D>, frame: &mut Frame<D>) -> f64 {
        if matches!(self.cloud_motion, CloudMotion::Travel(_)) {
            self.choose_ways(step, u, work, frame)
        } else {
            f64::INFINITY
        }
    }

    fn work(&self) -> Work<D> {
        Work::new(self.discretisation.cloud.len())
    }

    fn rhs(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, du: &mut [f64]) {
        self.fill_states(frame, u, work);
        self.residual(frame, work, du);
    }

    fn jvp(&self, frame: &Frame<D>, at: [&[f64]; 2], work: &mut Work<D>, out: &mut [f64]) {
        self.residual_change(frame, at, work, out);
    }

    fn rates(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, rate: &mut [f64]) {
        self.fill_fluid(frame, u, work);
        self.fill_rates(frame, work, rate);
    }

    fn largest_change(&self, u: &[f64], du: &[f64]) -> f64 {
        let change = |i: usize| self.change(&Conserved::of_row(u, i), &Conserved::of_row(du, i), 1.0);
        maximum(self.discretisation.cloud.n_fluid, change)
    }

    fn contrast(&self, u: &[f64]) -> f64 {
        let (n, pressure) =
            (self.discretisation.cloud.n_fluid, |i: usize| self.gas.primitive(&Conserved::<D>::of_row(u, i)).pressure);
        maximum(n, pressure) / minimum(n, pressure)
    }

    fn shorten(&self, u: &[f64], du: &mut [f64], largest: f64) {
        sweep_rows(du, D + 2, |i, du| {
            let (own, update) = (Conserved::<D>::of_row(u, i), Conserved::of_row(du, 0));
            let mut part = 1.0;
            // the density changes in proportion, the pressure nearly so
            for _ in 0..SHORTENINGS {
                let change = self.change(&own, &update, part);
                if change <= largest || !change.is_finite() {
                    break;
                }
                part *= SHORTER * largest / change;
            }
            if part < 1.0 {
                du.iter_mut().for_each(|du| *du *= part);
            }
        });
    }

    fn check(&self, frame: &Frame<D>, u: &[f64]) -> Result<(), Fault> {
        let bad = |i: usize| !self.gas.primitive(&Conserved::<D>::of_row(u, i)).is_physical();
        let Some(i) = first(self.discretisation.cloud.n_fluid, bad) else { return Ok(()) };
        let q = self.gas.primitive(&Conserved::<D>::of_row(u, i));
        let reason = format!("density {:.4e}, pressure {:.4e} (both must be positive)", q.density, q.pressure);
        Err(Fault { particle: i, place: frame.place(i).0.to_vec(), reason })
    }

    fn check_frame(&self, frame: &Frame<D>) -> Result<(), Fault> {
        self.volume_ratio_check(frame).map_or(Ok(()), Err)
    }

    fn locate(&self, frame: &Frame<D>, particle: usize) -> Vec<f64> {
        frame.place(particle).0.to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scheme::built;

    #[test]
    fn a_long_update_of_one_particle_holds_back_no_other() {
        let fluid: Fluid<2> =
            built::fluid("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.125\nfar_field = 4\n");
        let u = fluid.start();
        let mut du: Vec<f64> = u.iter().map(|u| 0.1 * u).collect();
        du[4..8].iter_mut().zip(&u[4..8]).for_each(|(du, u)| *du = 0.9 * u);
        let short = du.clone();
        fluid.shorten(&u, &mut du, 0.5);
        let change = fluid.change(&Conserved::of_row(&u, 1), &Conserved::of_row(&du, 1), 1.0);
        assert!((0.4..=0.5).contains(&change), "{change}");
        assert_eq!(du[..4], short[..4]);
        assert_eq!(du[8..], short[8..]);
    }
}
