//! Transformation of surface data under a smooth map of space, X ↦ x(X), with the deformation gradient F.
//!
//! Area vectors transform by Nanson's formula, S′ = cof F S with cof F = det F F⁻ᵀ, and normals accordingly: n′ =
//! m/|m|, m = F⁻ᵀ n. Differentiating Fᵀ m = n gives ∂m/∂x = F⁻ᵀ (K − Σ_i m_i ∂²x_i/∂X∂X) F⁻¹. Its part along the
//! surface divided by |m| is the curvature tensor of the deformed surface. This is exact for any map with two
//! derivatives.
use super::Interface;
use crate::math::Vector;
use crate::math::square::{cofactors, determinant, times};

/// First and second derivatives of a map of space at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strain<const D: usize> {
    /// Rows of the deformation gradient F = ∂x/∂X.
    pub map: [Vector<D>; D],
    /// Second derivatives ∂²x_i/∂X_j∂X_k [1/length].
    pub second: [[Vector<D>; D]; D],
}

impl<const D: usize> Strain<D> {
    /// Determinant of F, the ratio of volumes.
    pub fn determinant(&self) -> f64 {
        determinant(&self.map)
    }

    /// Rows of the inverse F⁻¹.
    pub fn inverse(&self) -> [Vector<D>; D] {
        let (cofactors, part) = (cofactors(&self.map), 1.0 / self.determinant());
        std::array::from_fn(|i| Vector::from_fn(|j| cofactors[j][i] * part))
    }
}

impl<const D: usize> Interface<D> {
    /// Transforms the normal, the area vector and the curvature tensor under the map.
    pub fn deform(&mut self, strain: &Strain<D>) {
        let (cofactors, inverse) = (cofactors(&strain.map), strain.inverse());
        let part = 1.0 / strain.determinant();
        let lifted = |v: &Vector<D>| times(&cofactors, v);
        self.area = lifted(&self.area);
        let m = lifted(&self.normal) * part;
        let size = m.norm();
        let normal = m * (1.0 / size);
        let bend = |j: usize| (0..D).fold(self.curvature[j], |sum, i| sum - strain.second[i][j] * m[i]);
        let bends: [Vector<D>; D] = std::array::from_fn(bend);
        // columns of F⁻¹ P′, which map directions along the deformed surface back to the original one
        let along: [Vector<D>; D] = std::array::from_fn(|k| {
            let tangent = Vector::axis(k) - normal * normal[k];
            Vector::from_fn(|i| inverse[i].dot(&tangent))
        });
        let bent = |v: &Vector<D>| Vector::from_fn(|j| bends[j].dot(v));
        self.curvature = std::array::from_fn(|r| Vector::from_fn(|c| along[r].dot(&bent(&along[c])) / size));
        self.normal = normal;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interface<const D: usize>(normal: Vector<D>, curvature: [Vector<D>; D]) -> Interface<D> {
        Interface { normal, area: normal * 0.1, curvature, body: 0, tag: 0, piece: 0, arc: 0.0 }
    }

    /// A plane becomes a paraboloid z = (a x² + b y²)/2.
    #[test]
    fn a_plane_bends_into_a_paraboloid() {
        let (a, b, x, y) = (0.7, -1.3, 0.4, 0.2);
        let mut second = [[Vector::ZERO; 3]; 3];
        (second[2][0][0], second[2][1][1]) = (a, b);
        let map = [Vector([1.0, 0.0, 0.0]), Vector([0.0, 1.0, 0.0]), Vector([a * x, b * y, 1.0])];
        let mut wall = interface(Vector([0.0, 0.0, 1.0]), [Vector::ZERO; 3]);
        wall.deform(&Strain { map, second });
        let normal = |x: f64, y: f64| Vector([-a * x, -b * y, 1.0]).unit();
        assert!((wall.normal - normal(x, y)).max_abs() < 1e-15);
        assert!((wall.area - Vector([-a * x, -b * y, 1.0]) * 0.1).max_abs() < 1e-15);
        // the change of the normal along the surface
        let h = 1e-6;
        for (du, tangent) in [([h, 0.0], Vector([1.0, 0.0, a * x])), ([0.0, h], Vector([0.0, 1.0, b * y]))] {
            let change = (normal(x + du[0], y + du[1]) - normal(x - du[0], y - du[1])) * (0.5 / h);
            let found = Vector::from_fn(|i| wall.curvature[i].dot(&tangent));
            assert!((found - change).max_abs() < 1e-9, "{found:?} {change:?}");
        }
        assert!((0..3).all(|i| wall.curvature[i].dot(&wall.normal).abs() < 1e-15));
    }

    /// A circle stretched to an ellipse has its curvature a b/(…)^{3/2}; turning it is what `turn` does.
    #[test]
    fn circles_become_ellipses_and_rotations_stay_rotations() {
        let (a, b, angle) = (2.0, 0.5, 0.6f64);
        let n = Vector([angle.cos(), angle.sin()]);
        let t = Vector([-n[1], n[0]]);
        let circle = interface(n, std::array::from_fn(|i| t * t[i]));
        let mut wall = circle;
        let second = [[Vector::ZERO; 2]; 2];
        wall.deform(&Strain { map: [Vector([a, 0.0]), Vector([0.0, b])], second });
        let speed = (a * n[1]).hypot(b * n[0]);
        let along = Vector([-a * n[1], b * n[0]]) * (1.0 / speed);
        let curvature = along.dot(&Vector::from_fn(|i| wall.curvature[i].dot(&along)));
        assert!((curvature - a * b / speed.powi(3)).abs() < 1e-14);
        assert!((wall.area - Vector([b * n[0], a * n[1]]) * 0.1).max_abs() < 1e-16);
        let rotation = [Vector([0.8, -0.6]), Vector([0.6, 0.8])];
        let (mut one, mut other) = (circle, circle);
        one.deform(&Strain { map: rotation, second });
        other.turn(&rotation);
        assert!((one.normal - other.normal).max_abs() < 1e-15 && (one.area - other.area).max_abs() < 1e-15);
        assert!((0..2).all(|i| (one.curvature[i] - other.curvature[i]).max_abs() < 1e-15));
    }
}
