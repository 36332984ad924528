//! Orthotropic elasticity: three planes of symmetry, as in wood and laminates.
//!
//! In axes fixed to the undeformed material, S = C : E relates the Green-Lagrange strain to the second Piola-Kirchhoff
//! stress (Saint-Venant-Kirchhoff law with nine constants), for small strains and any rotation; P = F S. The
//! engineering constants are defined by (Jones 1999, *Mechanics of Composite Materials*, eq. 2.24) ε₁ = σ₁/E₁ − ν₁₂
//! σ₂/E₁ − ν₁₃ σ₃/E₁ and so on, γ₁₂ = τ₁₂/G₁₂.
use super::elastic::{Moduli, green_strain};
use super::tensor::{self, Tensor};
use crate::math::Vector;
use crate::math::jet::Scalar;

/// Stiffness of an orthotropic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orthotropic {
    /// Stiffness matrix of the normal strains along the material axes; symmetric.
    pub normal: [[f64; 3]; 3],
    /// Shear moduli G₁₂, G₂₃ and G₃₁.
    pub shear: [f64; 3],
    /// Unit vectors of the material axes.
    pub axes: [[f64; 3]; 3],
}

/// Engineering constants of an orthotropic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constants {
    /// Young's moduli E₁, E₂ and E₃.
    pub young: [f64; 3],
    /// Poisson's ratios ν₁₂, ν₁₃ and ν₂₃.
    pub poisson: [f64; 3],
    /// Shear moduli G₁₂, G₁₃ and G₂₃.
    pub shear: [f64; 3],
}

impl Orthotropic {
    /// The material with these constants, whose first axis is along `first` and whose third axis is as close as
    /// possible to `third`; `None` when the stiffness is not positive definite or the directions are parallel.
    pub fn new(constants: &Constants, first: [f64; 3], third: [f64; 3]) -> Option<Self> {
        let Constants { young: [e1, e2, e3], poisson: [n12, n13, n23], shear: [g12, g13, g23] } = *constants;
        let s = [[1.0 / e1, -n12 / e1, -n13 / e1], [-n12 / e1, 1.0 / e2, -n23 / e2], [-n13 / e1, -n23 / e2, 1.0 / e3]];
        let determinant = tensor::determinant(&s);
        let minor = s[0][0] * s[1][1] - s[0][1] * s[0][1];
        let positive = [e1, e2, e3, g12, g13, g23].iter().all(|x| 0.0 < *x && x.is_finite());
        if !(positive && minor > 0.0 && determinant > 0.0) {
            return None;
        }
        let cofactor = tensor::cofactor(&s);
        let first = Vector(first).unit();
        let third = (Vector(third) - first * first.dot(&Vector(third))).unit();
        if !(first.is_finite() && third.is_finite() && (third.norm() - 1.0).abs() < 1e-6) {
            return None;
        }
        let [[a, b, c], [d, e, f]] = [third.0, first.0];
        let second = [b * f - c * e, c * d - a * f, a * e - b * d];
        Some(Self {
            normal: tensor::of(|i, j| cofactor[i][j] / determinant),
            shear: [g12, g23, g13],
            axes: [first.0, second, third.0],
        })
    }

    /// Isotropic moduli of similar magnitude, for wave speeds and stabilisation.
    pub fn mean(&self) -> Moduli {
        let bulk = self.normal.iter().flatten().sum::<f64>() / 9.0;
        Moduli { shear: self.shear.iter().sum::<f64>() / 3.0, bulk }
    }

    /// Second Piola-Kirchhoff stress C : E of a symmetric strain.
    #[inline(always)]
    pub fn second<S: Scalar>(&self, strain: &Tensor<S>) -> Tensor<S> {
        let own = self.turned(strain, |a, i| self.axes[a][i]);
        let along =
            |i: usize| own[0][0] * self.normal[i][0] + own[1][1] * self.normal[i][1] + own[2][2] * self.normal[i][2];
        let stress = tensor::of(|i, j| if i == j { along(i) } else { own[i][j] * (2.0 * self.shear_of(i, j)) });
        self.turned(&stress, |i, a| self.axes[a][i])
    }

    /// First Piola-Kirchhoff stress P = F S at the deformation gradient `f`.
    #[inline(always)]
    pub fn stress<S: Scalar>(&self, f: &Tensor<S>) -> Tensor<S> {
        tensor::product(f, &self.second(&green_strain(f)))
    }

    /// Stored energy ½ E : C : E per undeformed volume.
    #[inline(always)]
    pub fn energy<S: Scalar>(&self, f: &Tensor<S>) -> S {
        let strain = green_strain(f);
        tensor::contraction(&strain, &self.second(&strain)) * 0.5
    }

    fn shear_of(&self, i: usize, j: usize) -> f64 {
        match i + j {
            1 => self.shear[0],
            3 => self.shear[1],
            _ => self.shear[2],
        }
    }

    /// The product q a qᵀ.
    #[inline(always)]
    fn turned<S: Scalar>(&self, a: &Tensor<S>, q: impl Fn(usize, usize) -> f64) -> Tensor<S> {
        let half = tensor::of(|i, j| a[0][j] * q(i, 0) + a[1][j] * q(i, 1) + a[2][j] * q(i, 2));
        tensor::of(|i, j| half[i][0] * q(j, 0) + half[i][1] * q(j, 1) + half[i][2] * q(j, 2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::solid::{saint_venant_kirchhoff, tensor};

    const WOOD: Constants = Constants { young: [12.0, 1.0, 0.8], poisson: [0.35, 0.4, 0.45], shear: [0.9, 0.7, 0.2] };

    #[test]
    fn equal_constants_are_the_isotropic_law_in_any_axes() {
        let (e, nu) = (3.0, 0.3);
        let g = 0.5 * e / (1.0 + nu);
        let same = Constants { young: [e; 3], poisson: [nu; 3], shear: [g; 3] };
        let solid = Orthotropic::new(&same, [1.0, 2.0, -0.5], [0.3, 0.1, 1.0]).unwrap();
        let f = [[1.1, 0.2, -0.1], [0.05, 0.9, 0.15], [0.0, -0.2, 1.05]];
        let (own, exact) = (solid.stress(&f), saint_venant_kirchhoff(&Moduli::of_young(e, nu), &f));
        for (a, b) in own.iter().flatten().zip(exact.iter().flatten()) {
            assert!((a - b).abs() < 1e-13, "{a} {b}");
        }
    }

    #[test]
    fn a_bar_pulled_along_an_axis_has_the_modulus_of_that_axis() {
        let solid = Orthotropic::new(&WOOD, [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]).unwrap();
        let strain = 1e-3;
        // along the first axis, y, with the contraction of a free bar
        let e = tensor::of(|i, j| match (i, j) {
            (1, 1) => strain,
            (0, 0) => -WOOD.poisson[0] * strain,
            (2, 2) => -WOOD.poisson[1] * strain,
            _ => 0.0,
        });
        let stress = solid.second(&e);
        assert!(
            (stress[1][1] / strain - 12.0).abs() < 1e-12 && stress[0][0].abs() < 1e-15 && stress[2][2].abs() < 1e-15
        );
        let sheared = tensor::of(|i, j| if i + j == 1 { 0.5 * strain } else { 0.0 });
        assert!((solid.second(&sheared)[0][1] / strain - 0.9).abs() < 1e-12);
    }

    #[test]
    fn stress_is_the_derivative_of_energy() {
        let solid = Orthotropic::new(&WOOD, [1.0, 1.0, 0.2], [0.0, 0.0, 1.0]).unwrap();
        let f = [[1.02, 0.1, -0.05], [0.03, 0.97, 0.08], [0.01, -0.06, 1.01]];
        let stress = solid.stress(&f);
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let at = |h: f64| {
                let mut g = f;
                g[i][j] += h;
                solid.energy(&g)
            };
            assert!((stress[i][j] - (at(1e-6) - at(-1e-6)) / 2e-6).abs() < 1e-8);
        }
    }

    #[test]
    fn constants_without_energy_are_refused() {
        let wrong = Constants { poisson: [4.0, 0.4, 0.45], ..WOOD };
        assert_eq!(Orthotropic::new(&wrong, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), None);
        assert_eq!(Orthotropic::new(&WOOD, [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]), None);
    }
}
