//! How the residual changes with the state: ∂R/∂U v, to rounding.
//!
//! The residual is evaluated with numbers that carry their change along v ([`Dual`]): gradients and fits are linear, and the formulas at
//! particles, walls, sides and edges give the derivative that belongs to their value. What states change of the boundary (the far
//! field's circulation) is in it. Where a formula has a kink (a limiter's bound, an upwind choice), the side counts on which the state is.
use super::fluid::{Fluid, Work};
use super::frame::Frame;
use crate::math::Vector;
use crate::math::dual::Dual;
use crate::physics::Conserved;

impl<const D: usize> Fluid<D> {
    /// out = ∂R/∂U v at the state `u`.
    pub(super) fn residual_change(&self, frame: &Frame<D>, [u, v]: [&[f64]; 2], work: &mut Work<D>, out: &mut [f64]) {
        let fresh = || Box::new(Work::new(self.discretisation.cloud.len()));
        let mut storage = work.changing.take().unwrap_or_else(fresh);
        let changing = &mut *storage;
        changing.frozen.clone_from(&work.frozen);
        self.fill_rows(frame, |i| along(&Conserved::of_row(u, i), &Conserved::of_row(v, i)), changing);
        self.fill_walls(frame, changing);
        self.hold_sides(frame, changing);
        self.fill_outside(frame, changing);
        self.residual(frame, changing, out);
        work.changing = Some(storage);
    }
}

/// `u` that changes by `v`.
fn along<const D: usize>(u: &Conserved<D>, v: &Conserved<D>) -> Conserved<D, Dual> {
    let number = |value: f64, derivative: f64| Dual { value, derivative };
    Conserved {
        density: number(u.density, v.density),
        momentum: Vector::from_fn(|d| number(u.momentum[d], v.momentum[d])),
        energy: number(u.energy, v.energy),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Flux, Limiter};
    use crate::math::reduce::norm;
    use crate::motion::{BodyMotion, TimeFunction};
    use crate::scheme::{CloudMotion, built};
    use crate::system::{Instant, System, Term};

    /// A section in an uneven flow whose pressure is steep somewhere.
    fn section(keys: &str) -> Fluid<2> {
        built::fluid(&format!(
            "[flow]\nmach = 0.7\nalpha = \"2 deg\"\n{keys}\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n\
             domain = {{ min = [-3.2, -3.2], max = [3.2, 3.2] }}\n"
        ))
    }

    fn uneven(fluid: &Fluid<2>) -> Vec<f64> {
        let mut u = fluid.start();
        for (row, x) in u.chunks_mut(4).zip(&fluid.discretisation.cloud.x) {
            let wave = 0.2 * (3.0 * x[0]).sin() * (2.0 * x[1]).cos();
            let fall = if x[0] > 0.5 { 0.4 } else { 0.0 };
            row[0] *= 1.0 + wave;
            row[1] *= 1.0 - wave;
            row[2] += 0.3 * wave;
            row[3] *= 1.0 + 0.5 * wave + fall;
        }
        u
    }

    /// Difference between the derivative along a direction that reaches everywhere and a central difference, over its size; with
    /// `at` the frame.
    fn error(fluid: &Fluid<2>, at: &Instant<'_>, frozen: bool) -> f64 {
        let u = uneven(fluid);
        let v: Vec<f64> = u.iter().enumerate().map(|(k, u)| (1.7 * k as f64).sin() * (0.1 + u.abs())).collect();
        let (frame, mut work) = (fluid.frame(at, &u), fluid.work());
        if frozen {
            fluid.freeze_limiter(&frame, &u, &mut work);
        }
        let mut exact = vec![0.0; u.len()];
        fluid.jvp(&frame, [&u, &v], &mut work, &mut exact);
        let mut beside = |step: f64| {
            let moved: Vec<f64> = u.iter().zip(&v).map(|(u, v)| u + step * v).collect();
            let mut du = vec![0.0; u.len()];
            fluid.rhs(&frame, &moved, &mut work, &mut du);
            du
        };
        let step = 1e-7;
        let (a, b) = (beside(step), beside(-step));
        let wrong: Vec<f64> =
            exact.iter().zip(a.iter().zip(&b)).map(|(e, (a, b))| e - (a - b) / (2.0 * step)).collect();
        norm(&wrong) / norm(&exact)
    }

    #[test]
    fn the_derivative_is_that_of_the_residual_for_every_flux_and_limiter() {
        let still = Instant::still(0.0);
        for flux in [Flux::Hllc, Flux::Roe, Flux::AusmPlusUp, Flux::Rusanov] {
            for limiter in [Limiter::None, Limiter::VanAlbada, Limiter::Venkatakrishnan] {
                let fluid = Fluid { flux, limiter, ..section("") };
                let found = error(&fluid, &still, false);
                assert!(found < 1e-6, "{flux:?} {limiter:?} {found}");
            }
        }
    }

    #[test]
    fn the_derivative_is_that_of_the_residual_in_all_that_the_scheme_can_be() {
        let law = BodyMotion::about(Vector([0.2, 0.3]), None).with_angle(TimeFunction::Steady(0.4));
        let h = 1e-4;
        let rate = [Term::of_time(0.5 / h, 0.1 + h), Term::of_time(-0.5 / h, 0.1 - h)];
        for keys in
            ["", "reynolds = 500\nviscosity_law = \"constant\"", "reynolds = 500\n[scheme]\nconservative = false"]
        {
            for frozen in [false, true] {
                let fluid = section(keys);
                let slow = crate::scheme::reconstruct::Reconstruction { low_mach: true, ..fluid.reconstruction };
                let fluid = Fluid { reconstruction: slow, isentropic: frozen, ..fluid };
                let found = error(&fluid, &Instant::still(0.0), frozen);
                assert!(found < 1e-6, "{keys} {frozen} {found}");
                let cloud = &fluid.discretisation.cloud;
                let ways = [CloudMotion::Rigid(law.clone()), CloudMotion::deforming(cloud, vec![law.clone()], 1.0)];
                for cloud_motion in ways {
                    let moving = Fluid { cloud_motion, ..section(keys) };
                    let found = error(&moving, &Instant::formula(0.1, &rate), frozen);
                    assert!(found < 1e-6, "{keys} {frozen} moving {found}");
                }
            }
        }
    }
}
