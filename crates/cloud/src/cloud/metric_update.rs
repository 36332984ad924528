//! Update of conservative coefficients on a deforming cloud.
//!
//! A displacement with the gradient F maps an area vector s to cof(F) s and a volume V to det(F) V (Nanson's formula;
//! Ogden, Non-Linear Elastic Deformations, 1984, section 2.2). F is fitted at every particle, and each edge uses the
//! mean of its two ends. Fluxes therefore stay conservative to round-off. The area vectors close exactly under affine
//! motion, and to second order under any other motion, because cof(F) is free of divergence (Piola's identity).
use super::Cloud;
use super::operators::{Operators, WallFace};
use crate::math::Vector;
use crate::math::parallel::{sweep, sweep_parts};
use crate::math::square::{cofactors, determinant, times};

/// Rows of a D × D matrix.
type Matrix<const D: usize> = [Vector<D>; D];

/// The product cof(F) v.
fn cofactor_times<const D: usize>(f: &Matrix<D>, v: &Vector<D>) -> Vector<D> {
    times(&cofactors(f), v)
}

impl<const D: usize> Operators<D> {
    /// Computes area vectors, wall faces and volumes of `cloud` from those of `origin`, which are conservative
    /// coefficients of the cloud
    /// `from` before the displacement.
    pub fn metric_update(&mut self, cloud: &mut Cloud<D>, origin: &Self, from: &Cloud<D>) {
        let gradients = origin.displacement_gradients(cloud, from);
        let at = |i: usize| seen(cloud, &gradients, i);
        let between = |i: usize, j: usize| match at(j) {
            Some(other) => std::array::from_fn(|r| (gradients[i][r] + other[r]) * 0.5),
            None => gradients[i],
        };
        self.carry_edges(origin, |i, j, s| if i < from.n_fluid { cofactor_times(&between(i, j), s) } else { *s });
        let faces = (0..origin.n_fluid_parts).flat_map(|k| origin.wall_faces(k));
        let turned = |f: &WallFace<D>| cofactor_times(&between(f.i as usize, f.wall as usize), &f.area);
        self.set_wall_faces(faces.map(|f| WallFace { area: turned(f), ..*f }).collect());
        let (volume, ghosts) = cloud.volume.split_at_mut(cloud.x.len() - cloud.ghosts.len());
        sweep(&mut volume[..from.n_fluid], |i| from.volume[i] * determinant(&gradients[i]));
        for (slot, image) in ghosts.iter_mut().zip(&cloud.ghosts) {
            *slot = volume[image.source as usize];
        }
    }

    /// Deformation gradient F = 1 + ∂(x − X)/∂X of every row, with the weights of this fit of the cloud `from` at X.
    pub fn displacement_gradients(&self, cloud: &Cloud<D>, from: &Cloud<D>) -> Vec<Matrix<D>> {
        let mut all = vec![[Vector::ZERO; D]; from.n_rows()];
        let moved = |i: usize| cloud.x[i] - from.x[i];
        sweep_parts(&self.parts, 1, &mut all, &|k, out| {
            let start = self.parts[k].start;
            out.fill(std::array::from_fn(Vector::axis));
            for (e, [a_i, a_j]) in self.weighed_edges(from, k) {
                let d = moved(e.j()) - moved(e.i());
                (0..D).for_each(|r| out[e.i() - start][r] += a_i * d[r]);
                if e.both() {
                    (0..D).for_each(|r| out[e.j() - start][r] += a_j * -d[r]);
                }
            }
        });
        // a row that does not determine a gradient uses that of its first neighbour that does
        let bounded = |i: usize| from.first_order.binary_search(&(i as u32)).is_ok();
        for i in from.first_order.iter().map(|i| *i as usize) {
            let whole = |j: &&u32| (**j as usize) < from.n_rows() && !bounded(**j as usize);
            if let Some(j) = from.neighbours.of(i).iter().find(whole) {
                all[i] = all[*j as usize];
            }
        }
        all
    }
}

/// F of a particle with a row, or of the image of one; `None` for other particles.
fn seen<const D: usize>(cloud: &Cloud<D>, gradients: &[Matrix<D>], i: usize) -> Option<Matrix<D>> {
    if i < gradients.len() {
        return Some(gradients[i]);
    }
    let image = cloud.ghosts.get(i.checked_sub(cloud.n_real())?)?;
    let sign = cloud.transforms[image.transform as usize].sign;
    let f = gradients.get(image.source as usize)?;
    Some(std::array::from_fn(|r| Vector::from_fn(|c| sign[r] * sign[c] * f[r][c])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::CloudSpec;
    use crate::cloud::conservative::conservative;

    /// Greatest sum of area vectors around a particle, over the sum of their sizes, after the motion `to`.
    fn open(to: impl Fn(&Vector<2>) -> Vector<2>) -> (f64, f64) {
        let text = "title = \"x\"\ndimension = 2\n[flow]\nmach = 0.5\n[[body]]\ncircle = { radius = 0.3 }\n[cloud]\nspacing = 0.0625\n\
                    jitter = 0.2\ndomain = { min = [-1.0, -1.0], max = [1.0, 1.0] }\n";
        let case = crate::case::read(text, "test").unwrap();
        let surface = crate::geometry::load_surface::<2>(&case.bodies, std::path::Path::new(".")).unwrap().0;
        let mut from = Cloud::build(&CloudSpec::of_case(&case), Some(&surface), &[]).unwrap();
        let mut origin = Operators::new(&from);
        conservative(&mut from, &mut origin);
        let (mut cloud, mut moved) = (from.clone(), origin.clone());
        cloud.x.iter_mut().for_each(|x| *x = to(x));
        moved.refit(&cloud);
        moved.metric_update(&mut cloud, &origin, &from);
        let mut sums = vec![(Vector::<2>::ZERO, 0.0); cloud.len()];
        let mut put = |i: usize, s: Vector<2>| sums[i] = (sums[i].0 + s, sums[i].1 + s.norm());
        for k in 0..moved.n_fluid_parts {
            for e in moved.edges(k) {
                put(e.i(), e.s);
                if e.both() {
                    put(e.j(), -e.s);
                }
            }
            moved.wall_faces(k).iter().for_each(|f| put(f.i as usize, f.area));
        }
        // edges between parts are visited from both sides; outer sides have no faces of their own
        let inside = |i: &usize| cloud.x[*i].max_abs() < 0.85;
        let worst = (0..cloud.n_fluid).filter(inside).map(|i| sums[i].0.norm() / sums[i].1).fold(0.0, f64::max);
        let total = (0..cloud.n_fluid).map(|i| cloud.volume[i]).sum::<f64>();
        (worst, total / from.volume[..from.n_fluid].iter().sum::<f64>())
    }

    #[test]
    fn areas_stay_closed_under_affine_motion_and_nearly_so_under_any_other() {
        let (worst, grown) = open(|x| Vector([1.2 * x[0] + 0.3 * x[1], -0.4 * x[0] + 0.9 * x[1] + 2.0]));
        assert!(worst < 1e-13 && (grown - 1.2).abs() < 1e-13, "{worst} {grown}");
        let (worst, _) = open(|x| *x + Vector([0.03 * (3.0 * x[1]).sin(), 0.05 * (2.0 * x[0]).cos()]));
        assert!(worst < 2e-3, "{worst}");
    }
}
