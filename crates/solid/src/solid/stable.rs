//! Stable time step of explicit integration.
//!
//! The Verlet method is stable up to the step 2/ω of the fastest vibration, and up to (2/ω)(√(1 + ξ²) − ξ) where this
//! vibration is damped by the fraction ξ of critical damping (Belytschko, Liu and Moran 2000, *Nonlinear Finite
//! Elements*, section 6.6.5). ω is found by power iteration. On a lattice it is 1.7 to 1.82 c/h, but a surface particle
//! in an unfavourable position may vibrate twice as fast.
use super::body::Solid;
use super::forces::State;
use crate::math::Vector;
use crate::math::parallel::sweep_slots;
use crate::math::reduce::{maximum, sum};

/// Number of iterations, and the factor applied to their estimate, which approaches ω² from below.
const ITERATIONS: usize = 60;
const ABOVE: f64 = 1.03;

impl<const D: usize> Solid<D> {
    /// The longest stable step of the undeformed solid as a multiple of the smallest h/c of its particles, with and
    /// without damping.
    pub(super) fn step_factors(&self) -> [f64; 2] {
        *self.factor.get_or_init(|| {
            let wave = maximum(self.len(), |i| self.material_of(i).pressure_wave_speed() / self.particles.spacing[i]);
            let still = vec![[0.0; D]; self.len()];
            let history = self.virgin();
            let state = State { time: 0.0, step: 0.0, displacement: &still, velocity: &still, history: &history };
            let (mut tangents, mut work) = (self.tangents(), self.work());
            self.linearise(&state, [1.0, 0.0], &mut tangents);
            let elastic = self.largest(|w, out| self.stiffness(&tangents, w, &mut work, out));
            let viscous = self.damping.mass
                + match self.is_viscous() {
                    true => {
                        self.linearise(&state, [0.0, 1.0], &mut tangents);
                        self.largest(|w, out| self.stiffness(&tangents, w, &mut work, out))
                    }
                    false => 0.0,
                };
            let omega = (ABOVE * (elastic + self.fastest_contact())).sqrt();
            let damping = 0.5 * ABOVE * viscous / omega;
            let undamped = 2.0 / omega * wave;
            // √(1 + ξ²) − ξ, written so that no digits cancel where ξ is large
            [undamped / ((1.0 + damping * damping).sqrt() + damping), undamped]
        })
    }

    /// Largest eigenvalue of M⁻¹A on the free displacements, by power iteration from a pseudo-random vector.
    fn largest(&self, mut product: impl FnMut(&[[f64; D]], &mut [[f64; D]])) -> f64 {
        let n = self.len();
        let free = |i: usize, v: &mut [f64; D]| {
            (0..D).filter(|a| self.is_held(i, *a)).for_each(|a| v[a] = 0.0);
        };
        let noise = |k: usize| (k as f64 * 0.754_877_666).fract() - 0.5;
        let mut v = vec![[0.0; D]; n];
        sweep_slots(&mut v, |i, v| {
            *v = std::array::from_fn(|a| noise(D * i + a));
            free(i, v);
        });
        let (mut out, mut value) = (v.clone(), 0.0);
        for _ in 0..ITERATIONS {
            let size = sum(n, |i| self.mass[i] * Vector(v[i]).norm_squared()).sqrt();
            if !(size > 0.0) {
                return 0.0;
            }
            sweep_slots(&mut v, |_, v| *v = v.map(|v| v / size));
            product(&v, &mut out);
            value = sum(n, |i| Vector(v[i]).dot(&Vector(out[i])));
            sweep_slots(&mut v, |i, v| {
                *v = out[i].map(|f| f / self.mass[i]);
                free(i, v);
            });
        }
        value
    }

    /// Upper bound of the contribution of contact to ω²: a particle is pushed from at most two sides.
    fn fastest_contact(&self) -> f64 {
        let Some(contact) = &self.contact else { return 0.0 };
        let of = |i: usize| match self.is_on_surface(i) {
            true => self.contact_stiffness(i, contact.stiffness) / self.mass[i],
            false => 0.0,
        };
        2.0 * maximum(self.len(), of)
    }
}
