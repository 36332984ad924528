//! A gas whose structures are led along a given periodic motion: what its forces are there.
//!
//! The coordinates q of the structures are those of the motion, R = ∂q/∂t + ω (q(t) − q) with ∂/∂t by the formula that serves the state, so
//! that nothing else decides on them; the gas is as it is beside any structure.
use std::ops::Range;

use super::{Coupled, CoupledPreconditioner, Frame, Work};
use crate::structure::limit_cycle::Periodic;
use crate::system::{
    Fault, Field, Hierarchy, Implicit, Instant, Name, Period, Preconditioner, Ranges, RightHandSide, Shift, System,
};

/// A gas and structures that are led.
pub struct Led<'a, const D: usize> {
    coupled: &'a Coupled<D>,
    /// Unknowns of the structures about which they move.
    rest: Vec<f64>,
    motion: &'a Periodic,
    omega: f64,
}

impl<'a, const D: usize> Led<'a, D> {
    /// The structures of `coupled` in the motion `motion` of angular frequency `omega` about their coordinates in the state `state`.
    pub fn new(coupled: &'a Coupled<D>, state: &[f64], motion: &'a Periodic, omega: f64) -> Self {
        Self { coupled, rest: state[coupled.unknowns_of(Name::Structure)].to_vec(), motion, omega }
    }

    /// Coordinate `k` and its rate at the time `t`.
    fn at(&self, k: usize, t: f64) -> [f64; 2] {
        let phase = self.omega * t;
        let rate = |(n, q): (usize, &Vec<num_complex::Complex64>)| {
            let w = (n + 1) as f64;
            let turned = q[k] * num_complex::Complex64::cis(w * phase);
            -w * self.omega * turned.im
        };
        let speed: f64 = self.motion.harmonics.iter().enumerate().map(rate).sum();
        [self.rest[2 * k] + self.motion.at(k, phase), speed]
    }

    fn own(&self) -> Range<usize> {
        self.coupled.unknowns_of(Name::Structure)
    }

    /// Puts R of the structures in the frame `frame` at the state `u`.
    fn lead_rates(&self, frame: &Frame<D>, u: &[f64], du: &mut [f64]) {
        let (own, fast) = (self.own(), self.coupled.fastest);
        for (k, (row, change)) in u[own.clone()].chunks_exact(2).zip(du[own].chunks_exact_mut(2)).enumerate() {
            let wanted = self.at(k, frame.gas.time);
            let jet =
                frame.gas.jets.get(k).copied().unwrap_or(crate::math::jet::Jet { value: 0.0, first: 0.0, second: 0.0 });
            change[0] = jet.first + fast * (wanted[0] - row[0]);
            change[1] = jet.second + fast * (wanted[1] - row[1]);
        }
    }
}

impl<const D: usize> System for Led<'_, D> {
    type Frame = Frame<D>;
    type Work = Work<D>;

    fn fields(&self) -> &[Field] {
        self.coupled.fields()
    }

    fn placing(&self) -> &Ranges {
        self.coupled.placing()
    }

    fn work(&self) -> Work<D> {
        self.coupled.work()
    }

    fn frame(&self, at: &Instant<'_>, u: &[f64]) -> Frame<D> {
        self.coupled.frame(at, u)
    }

    fn place(&self, at: &Instant<'_>, frame: &mut Frame<D>) {
        self.coupled.place(at, frame);
    }

    fn prescribe(&self, time: f64, u: &mut [f64]) {
        for (k, row) in u[self.own()].chunks_exact_mut(2).enumerate() {
            row.copy_from_slice(&self.at(k, time));
        }
    }

    fn rhs(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, du: &mut [f64]) {
        self.coupled.rhs(frame, u, work, du);
        self.lead_rates(frame, u, du);
    }

    fn jvp(&self, frame: &Frame<D>, at: [&[f64]; 2], work: &mut Work<D>, out: &mut [f64]) {
        self.coupled.jvp(frame, at, work, out);
        let own = self.own();
        out[own.clone()].iter_mut().zip(&at[1][own]).for_each(|(o, v)| *o = -self.coupled.fastest * v);
    }

    fn rates(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, rate: &mut [f64]) {
        self.coupled.rates(frame, u, work, rate);
    }

    fn largest_change(&self, u: &[f64], du: &[f64]) -> f64 {
        self.coupled.largest_change(u, du)
    }

    fn contrast(&self, u: &[f64]) -> f64 {
        self.coupled.contrast(u)
    }

    fn shorten(&self, u: &[f64], du: &mut [f64], largest: f64) {
        self.coupled.shorten(u, du, largest);
    }

    fn check(&self, frame: &Frame<D>, u: &[f64]) -> Result<(), Fault> {
        self.coupled.check(frame, u)
    }

    fn check_frame(&self, frame: &Frame<D>) -> Result<(), Fault> {
        self.coupled.check_frame(frame)
    }

    fn locate(&self, frame: &Frame<D>, row: usize) -> Vec<f64> {
        self.coupled.locate(frame, row)
    }
}

/// The preconditioner of the gas with structures that move freely: their rows have nothing to solve where they are led.
pub struct LedPreconditioner<const D: usize>(CoupledPreconditioner<D>);

impl<const D: usize> Implicit for Led<'_, D> {
    type Preconditioner = LedPreconditioner<D>;

    fn preconditioner(&self, plan: &Hierarchy, period: Option<Period>) -> LedPreconditioner<D> {
        LedPreconditioner(self.coupled.preconditioner(plan, period))
    }
}

impl<const D: usize> Preconditioner<Led<'_, D>> for LedPreconditioner<D> {
    fn begin(&mut self, points: usize) {
        self.0.begin(points);
    }

    fn add(&mut self, led: &Led<'_, D>, frame: &Frame<D>, u: &[f64], work: &mut Work<D>) {
        self.0.add(led.coupled, frame, u, work);
    }

    fn finish(&mut self, shift: &Shift<'_>) {
        self.0.finish(shift);
    }

    fn apply(&mut self, led: &Led<'_, D>, frames: &[&Frame<D>], r: &RightHandSide<'_>, z: &mut [f64]) {
        self.0.apply(led.coupled, frames, r, z);
    }

    fn bytes(&self) -> usize {
        self.0.bytes()
    }
}
