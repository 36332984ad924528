//! The stiffness of a structure as a matrix, for those who factor it.
//!
//! K couples all particles that are members of one cloud: block (j, k) is Σ_m b_mj C_m b_mk / V_m with C = ∂P/∂F and the weights
//! b of the cloud around m, and what stabilisation adds, c_m (w_j δ_jk − w_j d_j·M⁻¹d_k w_k). About an axis of revolution the
//! hoop strain of m couples its displacement along the radius with all members; on the axis it is part of the strain in the plane.
use super::body::Solid;
use super::forces::Tangents;
use crate::math::Vector;
use crate::math::sparse::Symmetric;

/// The members of one cloud and what they weigh.
struct Cloud<const D: usize> {
    members: Vec<usize>,
    weights: Vec<Vector<D>>,
    /// Rows of the residual's stiffness.
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
    /// `scale` K + `shift` M among what is free, one for what is held.
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

    /// What the hoop strain of `m` adds to K: to its own displacement along the radius, by those of all members.
    fn hoops(&self, m: usize, cloud: &Cloud<D>, tangents: &Tangents<D>) -> Vec<[f64; D]> {
        let (t, per_radius) = (&tangents.hoop[m], self.per_radius[m]);
        let of =
            |b: &Vector<D>| std::array::from_fn(|a| per_radius * (0..D).map(|s| t.of_strain[a][s] * b[s]).sum::<f64>());
        let mut all: Vec<[f64; D]> = cloud.weights.iter().map(of).collect();
        // its own weight is in row and column
        all[0][0] = 2.0 * all[0][0] + t.own * per_radius * self.hoop_weight(m);
        all
    }

    /// Adds what hoop strains and stresses are.
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
            // C b_k: stress for a unit displacement of member k along each axis
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
