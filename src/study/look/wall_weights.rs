//! Values between wall particles: weights at a point of a wall that are exact for fields linear along it.
//!
//! A field is fitted as f + g·(x − x₀) in the two directions along the wall, by least squares over the wall particles within
//! [`REACH`] spacings whose normals look the same way; weights (1 − r/R)² / (r² + ε²) grow towards the point (moving least
//! squares; Lancaster and Salkauskas 1981). Where particles are too few or in line, their weighted mean stands in.
use crate::cloud::Cloud;
use crate::math::{Bounds, Vector};

/// Radius in cells of the background.
const REACH: f64 = 1.7;
/// Times that it is doubled until particles are found.
const DOUBLINGS: i32 = 4;
/// Cosine between normals from which on particles stand on the same side.
const SAME_SIDE: f64 = 0.35;
/// ε over the size of a cell: how closely a particle is met.
const CLOSENESS: f64 = 0.25;
/// Fewer particles make a mean.
const FEW: usize = 5;
/// Determinant of the normal matrix, over that of a full spread, below which the particles are in line.
const IN_LINE: f64 = 1e-4;

/// The wall particles of a cloud.
pub(crate) struct WallWeights<'a, const D: usize> {
    cloud: &'a Cloud<D>,
}

/// A wall particle near a point: number, offset along both directions over the radius, weight.
type Near = (u32, [f64; 2], f64);

impl<'a, const D: usize> WallWeights<'a, D> {
    /// Those of the cloud before any motion.
    pub(crate) fn of(cloud: &'a Cloud<D>) -> Self {
        Self { cloud }
    }

    /// Particles, counted from the first on walls, and their weights at the point `x` of a wall with this normal.
    pub(crate) fn at(&self, x: &Vector<D>, normal: &Vector<D>) -> Vec<(u32, f64)> {
        let size = self.cloud.tree.leaf_at(x).size;
        for side in [SAME_SIDE, -2.0] {
            for doubling in 0..DOUBLINGS {
                let reach = REACH * size * 2.0_f64.powi(doubling);
                let near = self.near((x, normal), reach, side);
                if !near.is_empty() {
                    return fitted(&near);
                }
            }
        }
        Vec::new()
    }

    fn near(&self, (x, normal): (&Vector<D>, &Vector<D>), reach: f64, side: f64) -> Vec<Near> {
        let cloud = self.cloud;
        let [t, s] = along(normal);
        let closeness = (CLOSENESS / REACH).powi(2);
        let cube = Bounds { min: *x - Vector::splat(reach), max: *x + Vector::splat(reach) };
        let mut near = Vec::new();
        cloud.tree.overlapping(&cube, |node| {
            for i in cloud.leaves.of(node) {
                let Some(w) = (*i as usize).checked_sub(cloud.n_fluid).filter(|w| *w < cloud.interface.len()) else {
                    continue;
                };
                let (offset, facing) =
                    ((cloud.x[*i as usize] - *x) * (1.0 / reach), cloud.interface[w].normal.dot(normal));
                let distance = offset.norm();
                if distance < 1.0 && facing > side {
                    let weight = (1.0 - distance).powi(2) / (distance * distance + closeness);
                    near.push((w as u32, [t.dot(&offset), s.dot(&offset)], weight * facing.max(SAME_SIDE)));
                }
            }
        });
        near
    }
}

/// Two directions along a wall.
fn along<const D: usize>(normal: &Vector<D>) -> [Vector<D>; 2] {
    let thin = (0..D).min_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs())).unwrap_or(0);
    let first = (Vector::axis(thin) - *normal * normal[thin]).unit();
    if D < 3 {
        return [first, Vector::ZERO];
    }
    let turn = |a: usize, b: usize| normal[a] * first[b] - normal[b] * first[a];
    [first, Vector::from_fn(|d| turn((d + 1) % D, (d + 2) % D))]
}

/// Row of the fit that gives the value at the point.
fn fitted(near: &[Near]) -> Vec<(u32, f64)> {
    let total: f64 = near.iter().map(|(.., weight)| weight).sum();
    let mean = |near: &[Near]| near.iter().map(|(w, _, weight)| (*w, weight / total)).collect();
    if near.len() < FEW {
        return mean(near);
    }
    // moments of the weights; the row is w_k (c₀ + c₁ a_k + c₂ b_k) with M c = (1, 0, 0)
    let moment = |f: &dyn Fn([f64; 2]) -> f64| near.iter().map(|(_, at, weight)| weight * f(*at)).sum::<f64>() / total;
    let [a, b] = [moment(&|x| x[0]), moment(&|x| x[1])];
    let [aa, ab, bb] = [moment(&|x| x[0] * x[0]), moment(&|x| x[0] * x[1]), moment(&|x| x[1] * x[1])];
    let det = aa * bb - ab * ab - a * (a * bb - ab * b) + b * (a * ab - aa * b);
    if det <= IN_LINE * aa * bb || det.is_nan() {
        return mean(near);
    }
    let c = [(aa * bb - ab * ab) / det, (ab * b - a * bb) / det, (a * ab - aa * b) / det];
    near.iter().map(|(w, at, weight)| (*w, weight / total * (c[0] + c[1] * at[0] + c[2] * at[1]))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fits_are_exact_for_linear_fields_and_means_for_few_particles() {
        let near: Vec<Near> = (0..9_u32)
            .map(|k| {
                let at = [0.2 * f64::from(k % 3) - 0.05, 0.3 * f64::from(k / 3) - 0.2 + 0.01 * f64::from(k)];
                (k, at, 1.0 / (1.0 + f64::from(k)))
            })
            .collect();
        let sum = |near: &[Near], row: &[(u32, f64)], f: &dyn Fn([f64; 2]) -> f64| {
            near.iter().zip(row).map(|((_, at, _), (_, w))| w * f(*at)).sum::<f64>()
        };
        let row = fitted(&near);
        for (f, exact) in [(&(|_: [f64; 2]| 1.0) as &dyn Fn([f64; 2]) -> f64, 1.0), (&|x| x[0], 0.0), (&|x| x[1], 0.0)]
        {
            assert!((sum(&near, &row, f) - exact).abs() < 1e-12);
        }
        for few in [&near[..3], &near[..1]] {
            let row = fitted(few);
            assert!((sum(few, &row, &|_| 1.0) - 1.0).abs() < 1e-12 && row.iter().all(|(_, w)| *w > 0.0));
        }
        let line: Vec<Near> = (0..6).map(|k| (k, [0.1 * f64::from(k), 0.0], 1.0)).collect();
        assert!(fitted(&line).iter().all(|(_, w)| (w - 1.0 / 6.0).abs() < 1e-12));
    }

    #[test]
    fn directions_along_a_wall_are_square() {
        for normal in [[0.0, 0.0, 1.0], [0.6, 0.0, -0.8], [0.48, 0.6, 0.64]] {
            let n = Vector(normal);
            let [t, s] = along(&n);
            assert!(t.dot(&n).abs() < 1e-12 && s.dot(&n).abs() < 1e-12 && t.dot(&s).abs() < 1e-12);
            assert!((t.norm() - 1.0).abs() < 1e-12 && (s.norm() - 1.0).abs() < 1e-12);
        }
    }
}
