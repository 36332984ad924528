//! The tangent stiffness of a solid as a matrix, for direct solvers.
//!
//! K couples all particles that appear together in one neighbour list. Block (j, k) is Σ_m b_mj C_m b_mk / V_m with C =
//! ∂P/∂F and the weights b of the gradient at m. The stabilisation adds c_m (w_j δ_jk − w_j d_j·M⁻¹d_k w_k). In a body
//! of revolution, the hoop strain of m couples its radial displacement with all particles of its list; on the axis it
//! is part of the strain in the plane.
use super::body::Solid;
use super::forces::Tangents;
use crate::math::Vector;
use crate::math::sparse::Symmetric;

/// A particle with its neighbours, and the weights of its gradient.
struct Cloud<const D: usize> {
    members: Vec<usize>,
    weights: Vec<Vector<D>>,
    /// Rows of the stiffness of the residuals.
    residual: Vec<Vec<f64>>,
}

impl<const D: usize> Cloud<D> {
    fn around(solid: &Solid<D>, m: usize) -> Self {
        let particles = &solid.particles;
        let edges = particles.of(m);
        let members: Vec<usize> = std::iter::once(m).chain(edges.iter().map(|e| e.other as usize)).collect();
        let own = edges.iter().fold(Vector::ZERO, |sum: Vector<D>, e| sum - e.own);
        let weights = std::iter::once(own).chain(edges.iter().map(|e| e.own)).collect();
        let residual = particles.residual_block(m);
        Self { members, weights, residual }
    }
}

impl<const D: usize> Solid<D> {
    /// The matrix `scale` K + `shift` M on the free displacements, with ones on the diagonal for the constrained ones.
    pub fn matrix_of(&self, tangents: &Tangents<D>, scale: f64, shift: f64) -> Symmetric {
        let mut all = self.particles.pattern(D);
        for m in 0..self.len() {
            self.add_cloud(m, tangents, scale, &mut all);
        }
        self.add_hoops(tangents, scale, &mut all);
        for k in 0..self.len() * D {
            let at = all.first[k];
            let (i, a) = (k / D, k % D);
            if self.is_held(i, a) {
                all.value[at] = 1.0;
            } else {
                all.value[at] += shift * self.mass()[i];
            }
        }
        all
    }

    /// The diagonal of K.
    pub fn diagonal_of(&self, tangents: &Tangents<D>) -> Vec<f64> {
        let mut all = vec![0.0; self.len() * D];
        for m in 0..self.len() {
            let cloud = Cloud::around(self, m);
            for (k, particle) in cloud.members.iter().enumerate() {
                let b = &cloud.weights[k];
                for c in 0..D {
                    let bent: f64 =
                        (0..D).map(|d| (0..D).map(|s| tangents.all[m][c][d][c][s] * b[s] * b[d]).sum::<f64>()).sum();
                    all[particle * D + c] += bent / self.particles.volume[m] + tangents.stiff[m] * cloud.residual[k][k];
                }
            }
            if self.is_round() {
                all[m * D] += self.hoops(m, &cloud, tangents)[0][0];
            }
        }
        all
    }

    /// Coupling of the radial displacement of `m` with all particles of its list due to the hoop strain of `m`.
    fn hoops(&self, m: usize, cloud: &Cloud<D>, tangents: &Tangents<D>) -> Vec<[f64; D]> {
        let (t, per_radius) = (&tangents.hoop[m], self.per_radius[m]);
        let of =
            |b: &Vector<D>| std::array::from_fn(|a| per_radius * (0..D).map(|s| t.of_strain[a][s] * b[s]).sum::<f64>());
        let mut all: Vec<[f64; D]> = cloud.weights.iter().map(of).collect();
        // its own weight enters the row and the column
        all[0][0] = 2.0 * all[0][0] + t.own * per_radius * self.hoop_weight(m);
        all
    }

    /// Adds the terms of hoop strain and hoop stress.
    fn add_hoops(&self, tangents: &Tangents<D>, scale: f64, all: &mut Symmetric) {
        for m in (0..self.len()).filter(|m| self.is_round() && !self.is_held(*m, 0)) {
            let cloud = Cloud::around(self, m);
            let hoops = self.hoops(m, &cloud, tangents);
            for (particle, hoop) in cloud.members.iter().zip(&hoops) {
                for a in (0..D).filter(|a| !self.is_held(*particle, *a)) {
                    let (k, own) = (particle * D + a, m * D);
                    let (column, row) = (k.min(own), k.max(own));
                    let range = all.first[column]..all.first[column + 1];
                    let at = range.start + all.row[range.clone()].partition_point(|r| *r < row);
                    all.value[at] += scale * hoop[a];
                }
            }
        }
    }

    fn add_cloud(&self, m: usize, tangents: &Tangents<D>, scale: f64, all: &mut Symmetric) {
        let cloud = Cloud::around(self, m);
        let (per_volume, stiff) = (scale / self.particles.volume[m], scale * tangents.stiff[m]);
        for (k, particle) in cloud.members.iter().enumerate() {
            // C b_k: stress due to a unit displacement of particle k along each axis
            let stress: [[[f64; D]; D]; D] = std::array::from_fn(|c| {
                let mut sum = [[0.0; D]; D];
                for d in 0..D {
                    let (t, b) = (&tangents.all[m][c][d], cloud.weights[k][d] * per_volume);
                    (0..D).for_each(|r| (0..D).for_each(|s| sum[r][s] += t[r][s] * b));
                }
                sum
            });
            for (j, other) in cloud.members.iter().enumerate().filter(|(_, other)| *other >= particle) {
                let b = &cloud.weights[j];
                let smooth = stiff * cloud.residual[j][k];
                for c in 0..D {
                    let column = particle * D + c;
                    if self.is_held(*particle, c) {
                        continue;
                    }
                    let from = if other == particle { c } else { 0 };
                    let range = all.first[column]..all.first[column + 1];
                    let start = range.start + all.row[range.clone()].partition_point(|r| *r < other * D + from);
                    for a in from..D {
                        let pulled: f64 = (0..D).map(|s| stress[c][a][s] * b[s]).sum();
                        if !self.is_held(*other, a) {
                            all.value[start + a - from] += pulled + if a == c { smooth } else { 0.0 };
                        }
                    }
                }
            }
        }
    }
}
