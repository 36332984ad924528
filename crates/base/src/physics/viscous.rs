//! Viscous stress and heat conduction of a Newtonian gas.
//!
//! With the strain rate ε = (∇v + ∇vᵀ)/2, the viscous stress is τ = 2μ (ε − ⅓ tr ε I) (Stokes: no bulk viscosity). The
//! heat flux is q = −μ/((γ − 1) Pr) ∇θ with θ = γp/ρ, which is the temperature relative to that of the free stream if ρ
//! and c are normalised by their free-stream values. The viscous flux of mass, momentum and energy across an area n is
//! (0, τ·n, v·τ·n − q·n), which is subtracted from the inviscid flux.
use super::{Conserved, Gas, Primitive};
use crate::math::Vector;
use crate::math::blocks::array;
use crate::math::jet::Scalar;

/// Rows ∂v_i/∂x of the velocity gradient, or any tensor.
pub type Tensor<const D: usize, S = f64> = [Vector<D, S>; D];

/// Viscosity and heat conduction of a Newtonian gas, in units of the solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newtonian {
    /// Dynamic viscosity of the free stream, divided by its density, its sound speed and the unit of length.
    pub viscosity: f64,
    /// Constant S/T∞ of Sutherland's law; `None`: constant viscosity.
    pub sutherland: Option<f64>,
    /// Prandtl number μ c_p/λ.
    pub prandtl: f64,
}

/// Velocity, temperature and their gradients at one point, from which viscous fluxes follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slopes<const D: usize, S = f64> {
    /// Velocity of the gas.
    pub velocity: Vector<D, S>,
    /// Temperature θ = γp/ρ.
    pub temperature: S,
    /// Velocity gradient, rows ∂v_i/∂x.
    pub velocity_gradient: Tensor<D, S>,
    /// Temperature gradient ∂θ/∂x.
    pub temperature_gradient: Vector<D, S>,
}

impl Gas {
    /// Temperature divided by that of the free stream, θ = γp/ρ.
    #[inline(always)]
    pub fn temperature<const D: usize, S: Scalar>(&self, q: &Primitive<D, S>) -> S {
        q.pressure * self.gamma / q.density
    }
}

/// Strain rate ε = (∇v + ∇vᵀ)/2 — eq. (4).
#[doc(alias = "eq4")]
#[inline(always)]
pub fn strain_rate<const D: usize, S: Scalar>(gradient: &Tensor<D, S>) -> Tensor<D, S> {
    array(|i| Vector::from_fn(|j| (gradient[i][j] + gradient[j][i]) * 0.5))
}

/// Viscous stress τ = 2μ (ε − ⅓ tr ε I) for the viscosity `mu`; the total stress is σ = τ − p I, eq. (5).
#[doc(alias = "eq5")]
#[inline(always)]
pub fn viscous_stress<const D: usize, S: Scalar>(mu: S, gradient: &Tensor<D, S>) -> Tensor<D, S> {
    let strain = strain_rate(gradient);
    let third = (1..D).fold(strain[0][0], |sum, d| sum + strain[d][d]) / S::constant(3.0);
    let deviator = |i: usize, j: usize| strain[i][j] - if i == j { third } else { S::constant(0.0) };
    array(|i| Vector::from_fn(|j| mu * 2.0 * deviator(i, j)))
}

impl Newtonian {
    /// Viscosity at the temperature θ: μ∞ θ^1.5 (1 + S)/(θ + S), or μ∞ when it is constant.
    #[inline(always)]
    pub fn at<S: Scalar>(&self, temperature: S) -> S {
        let law = |s: f64| temperature * temperature.sqrt() * (1.0 + s) / (temperature + s);
        self.sutherland.map_or(S::constant(1.0), law) * self.viscosity
    }

    /// Thermal conductivity with respect to θ for the viscosity `mu`, μ/((γ − 1) Pr).
    #[inline(always)]
    pub fn conductivity<S: Scalar>(&self, gas: &Gas, mu: S) -> S {
        mu / S::constant((gas.gamma - 1.0) * self.prandtl)
    }

    /// Greatest diffusivity at the state `q`, μ/ρ max(4/3, γ/Pr); divided by h², it is the decay rate of a difference
    /// over the distance h.
    #[inline(always)]
    pub fn diffusivity<const D: usize>(&self, gas: &Gas, q: &Primitive<D>) -> f64 {
        self.at(gas.temperature(q)) / q.density * f64::max(4.0 / 3.0, gas.gamma / self.prandtl)
    }

    /// Viscous flux of mass, momentum and energy across the area vector n: (0, τ·n, v·τ·n − q·n).
    #[inline(always)]
    pub fn flux<const D: usize, S: Scalar>(&self, gas: &Gas, at: &Slopes<D, S>, n: &Vector<D, S>) -> Conserved<D, S> {
        let mu = self.at(at.temperature);
        let stress = viscous_stress(mu, &at.velocity_gradient);
        let momentum = Vector::from_fn(|i| stress[i].dot(n));
        let heat = self.conductivity(gas, mu) * at.temperature_gradient.dot(n);
        Conserved { density: S::constant(0.0), momentum, energy: at.velocity.dot(&momentum) + heat }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AIR: Gas = Gas { gamma: 1.4 };
    const MEDIUM: Newtonian = Newtonian { viscosity: 0.02, sutherland: Some(110.4 / 288.15), prandtl: 0.72 };
    const SLOPES: Slopes<3> = Slopes {
        velocity: Vector([0.4, -0.2, 0.1]),
        temperature: 1.3,
        velocity_gradient: [Vector([0.3, -1.0, 0.5]), Vector([0.7, 0.2, -0.4]), Vector([-0.6, 0.9, 0.8])],
        temperature_gradient: Vector([0.2, -0.5, 0.3]),
    };

    #[test] // eq4
    fn the_strain_rate_is_symmetric_and_blind_to_rotation() {
        let strain = strain_rate(&SLOPES.velocity_gradient);
        assert!((0..3).all(|i| (0..3).all(|j| strain[i][j] == strain[j][i])));
        let spin = [Vector([0.0, -2.0]), Vector([2.0, 0.0])];
        assert_eq!(strain_rate(&spin), [Vector::ZERO; 2]);
    }

    #[test] // eq5
    fn the_stress_of_pure_shear_is_viscosity_times_rate_and_its_trace_is_zero() {
        let shear = [Vector([0.0, 3.0]), Vector::ZERO];
        assert_eq!(viscous_stress(0.5, &shear), [Vector([0.0, 1.5]), Vector([1.5, 0.0])]);
        let stress = viscous_stress(0.5, &SLOPES.velocity_gradient);
        assert!((0..3).map(|d| stress[d][d]).sum::<f64>().abs() < 1e-15);
    }

    #[test]
    fn the_momentum_flux_does_not_depend_on_the_observer_and_energy_takes_the_work() {
        let n = Vector([0.3, -0.4, 1.1]);
        let drift = Vector([2.0, 1.0, -3.0]);
        let own = MEDIUM.flux(&AIR, &SLOPES, &n);
        let seen = MEDIUM.flux(&AIR, &Slopes { velocity: SLOPES.velocity + drift, ..SLOPES }, &n);
        assert_eq!(own.momentum, seen.momentum);
        assert!((seen.energy - own.energy - drift.dot(&own.momentum)).abs() < 1e-14);
    }

    #[test]
    fn heat_flows_down_the_slope_of_temperature() {
        let still = Slopes { velocity: Vector::ZERO, velocity_gradient: [Vector::ZERO; 3], ..SLOPES };
        let n = Vector([1.0, 0.0, 0.0]);
        let flux = MEDIUM.flux(&AIR, &still, &n);
        // λ ∂T/∂x with λ = μ c_p/Pr and c_p = 1/(γ − 1) in these units
        let expected = MEDIUM.at(1.3) / 0.72 / 0.4 * 0.2;
        assert!((flux.energy - expected).abs() < 1e-15 && flux.momentum == Vector::ZERO);
    }

    #[test] // U.S. Standard Atmosphere (1976), table I: 1.7894e-5 at 288.15 K, 1.4216e-5 kg/(m s) at 216.65 K
    fn sutherlands_law_agrees_with_the_standard_atmosphere() {
        assert!((MEDIUM.at(1.0) - 0.02).abs() < 1e-17);
        let ratio = MEDIUM.at(216.65 / 288.15) / MEDIUM.at(1.0);
        assert!((ratio - 1.4216 / 1.7894).abs() < 1e-4, "{ratio}");
    }
}
