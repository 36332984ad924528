//! Ordinary differential equations du/dt = f(t, u) as a system: oscillators, circuits, models of few unknowns.
//!
//! Every integrator accepts them as it accepts a gas; implicit integrators solve the linear systems with the dense
//! matrix.
use super::full::Full;
use crate::math::reduce::largest_size;
use crate::system::{Fault, Field, Hierarchy, Implicit, Instant, Name, Period, System};

/// Relative change of a density to which a change of an unknown by one unit is equivalent.
const LARGE: f64 = 1e-3;

/// Ordinary differential equations, all in one row.
pub struct Ordinary<F> {
    fields: [Field; 1],
    rate: f64,
    f: F,
}

impl<F: Fn(f64, &[f64], &mut [f64]) + Sync> Ordinary<F> {
    /// A system of `n` equations, where `f(t, u, du)` writes du/dt. `rate` [1/time] is the maximum rate at which the
    /// unknowns change by themselves; it determines explicit steps and pseudo-time steps.
    pub fn new(n: usize, rate: f64, f: F) -> Self {
        Self { fields: [Field::new(Name::Other("unknowns"), 1, n)], rate, f }
    }
}

impl<F: Fn(f64, &[f64], &mut [f64]) + Sync> System for Ordinary<F> {
    type Frame = f64;
    type Work = ();

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn work(&self) {}

    fn frame(&self, at: &Instant<'_>, _: &[f64]) -> f64 {
        at.time
    }

    fn place(&self, at: &Instant<'_>, time: &mut f64) {
        *time = at.time;
    }

    fn rhs(&self, time: &f64, u: &[f64], (): &mut (), du: &mut [f64]) {
        (self.f)(*time, u, du);
    }

    fn rates(&self, _: &f64, _: &[f64], (): &mut (), rate: &mut [f64]) {
        rate.fill(self.rate);
    }

    fn largest_change(&self, _: &[f64], du: &[f64]) -> f64 {
        LARGE * largest_size(du.len(), |k| du[k])
    }

    fn check(&self, time: &f64, u: &[f64]) -> Result<(), Fault> {
        let stray = u.iter().position(|v| !v.is_finite());
        stray.map_or(Ok(()), |k| {
            let reason = format!("unknown number {k} is not finite at time {time}");
            Err(Fault { particle: 0, place: Vec::new(), reason })
        })
    }
}

impl<F: Fn(f64, &[f64], &mut [f64]) + Sync> Implicit for Ordinary<F> {
    type Preconditioner = Full;

    fn preconditioner(&self, _: &Hierarchy, period: Option<Period>) -> Full {
        Full::new(self, period)
    }
}
