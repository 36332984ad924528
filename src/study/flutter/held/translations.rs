//! Displacements that no steady force follows, because they move all bodies by the same way, or none.
//!
//! A uniform stream is the same everywhere, so that bodies which it flows around have the same forces wherever they are: with coordinates q = v of
//! such a displacement, Q(0) v = 0. Computed forces are not zero to the last digit, and the ratio of what is left of them to the stiffness of a soft
//! spring is a divergence that does not exist. The part along v is taken out of them,
//!
//! Q(0) − (Q(0) v) wᵀ, wᵀ v = 1.
//!
//! It is the places of the walls that tell v, not the size of forces: a small force on a soft spring is one.
use num_complex::Complex64;

use super::super::shapes::moves;
use crate::case::{Case, Side};
use crate::coupling::Attached;
use crate::geometry::Surface;
use crate::math::singular::Singular;

/// Points of the walls that are looked at.
const LOOKED_AT: usize = 500;
/// Displacement of walls against one another, over their greatest, that is what digits of files leave of none.
const TOGETHER: f64 = 1e-6;

/// A displacement of all bodies by the same way, or of none.
#[derive(Clone, Debug)]
pub(in super::super) struct Translation {
    /// v: coordinates.
    coordinates: Vec<f64>,
    /// w: by how much coordinates share in it.
    share: Vec<f64>,
}

/// Those among the coordinates of `bodies`, `n` in all.
pub(super) fn translations<const D: usize>(
    case: &Case,
    surface: &Surface<D>,
    (bodies, n): (&[Attached<D>], usize),
) -> Vec<Translation> {
    let pairs = case.boundary.pairs();
    let others = |side: &Side| matches!(side, Side::Held | Side::Outflow { .. });
    if pairs.iter().flatten().any(others) {
        return Vec::new();
    }
    // what moves towards a plane of symmetry moves towards its image
    let images: Vec<usize> = (0..3).filter(|d| pairs[*d].contains(&Side::Symmetry)).collect();
    let mut columns: Vec<Vec<[f64; 3]>> = vec![vec![[0.0; 3]; surface.vertices.len()]; n];
    for body in bodies {
        for (column, own) in columns.iter_mut().skip(body.first).zip(moves(surface, body, &vec![1.0; n])) {
            column.iter_mut().zip(own).for_each(|(sum, d)| (0..3).for_each(|k| sum[k] += d[k]));
        }
    }
    among(&columns, &images)
}

/// Those among coordinates that displace points by `columns`, but for those along the axes `images`.
fn among(columns: &[Vec<[f64; 3]>], images: &[usize]) -> Vec<Translation> {
    let points = columns.first().map_or(0, Vec::len);
    let every = points.div_ceil(LOOKED_AT).max(1);
    let looked: Vec<Vec<&[f64; 3]>> = columns.iter().map(|c| c.iter().step_by(every).collect()).collect();
    let greatest = |c: &Vec<&[f64; 3]>| c.iter().flat_map(|d| d.iter()).fold(0.0f64, |most, d| most.max(d.abs()));
    // in units of the greatest displacement of each
    let units: Vec<f64> = looked.iter().map(|c| Some(greatest(c)).filter(|u| *u > 0.0).unwrap_or(1.0)).collect();
    let against = |(c, unit): (&Vec<&[f64; 3]>, &f64)| -> Vec<f64> {
        let count = c.len().max(1) as f64;
        let mean = |k: usize| c.iter().map(|d| d[k]).sum::<f64>() / count;
        let mean: [f64; 3] = [0, 1, 2].map(|k| if images.contains(&k) { 0.0 } else { mean(k) });
        c.iter().flat_map(|d| (0..3).map(move |k| (d[k] - mean[k]) / (unit * count.sqrt()))).collect()
    };
    let found = Singular::of(looked.iter().zip(&units).map(against).collect());
    let together = found.squares().into_iter().zip(&found.right).filter(|(square, _)| square.sqrt() <= TOGETHER);
    let translation = |(_, y): (f64, &Vec<f64>)| Translation {
        coordinates: y.iter().zip(&units).map(|(y, unit)| y / unit).collect(),
        share: y.iter().zip(&units).map(|(y, unit)| y * unit).collect(),
    };
    together.map(translation).collect()
}

impl Translation {
    /// Takes what is left of forces on it out of steady forces, rows one after another.
    pub(in super::super) fn clear(&self, forces: &mut [Complex64]) {
        for row in forces.chunks_exact_mut(self.coordinates.len().max(1)) {
            let own: Complex64 = row.iter().zip(&self.coordinates).map(|(f, v)| f * *v).sum();
            row.iter_mut().zip(&self.share).for_each(|(f, w)| *f -= own * *w);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Held, problem_of};
    use super::*;

    const CASE: &str = "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n[flutter]\n[structure]\nelastic_axis = -0.4\n\
                        mass_ratio = 60\nx_alpha = 0.2\nr_alpha2 = 0.25\nfrequency_ratio = 0.5\nreduced_speed = 2\n";

    fn held(text: &str) -> Held {
        Held::of(&problem_of(text))
    }

    #[test]
    fn the_plunge_of_a_section_is_one_and_its_pitch_is_none() {
        let found = held(CASE).translations;
        assert!(found.len() == 1 && found[0].coordinates[1].abs() < 1e-9 * found[0].coordinates[0].abs(), "{found:?}");
        let mut forces = [1e-7, 0.3, -2e-7, 0.05].map(Complex64::from);
        found[0].clear(&mut forces);
        assert!(forces[0].norm() < 1e-15 && forces[2].norm() < 1e-15);
        assert!((forces[1].re - 0.3).abs() < 1e-12 && (forces[3].re - 0.05).abs() < 1e-12);
        // another body that stays makes it none
        let second =
            CASE.replace("[cloud]", "[[body]]\nname = \"second\"\nnaca = \"0012\"\ntranslate = [3, 0]\n[cloud]");
        let second = second.replace("[structure]\n", "[structure]\nbody = \"body-1\"\n");
        assert!(held(&second).translations.is_empty());
    }

    #[test]
    fn sums_of_coordinates_are_seen_and_ways_to_an_image_are_none() {
        let points: Vec<f64> = (0..40).map(|k| 0.025 * f64::from(k)).collect();
        let of = |f: &dyn Fn(f64) -> [f64; 3]| points.iter().map(|x| f(*x)).collect::<Vec<_>>();
        // x + 1/2 and x/1000 differ by a translation, in units of their own
        let columns = [of(&|x| [0.0, x + 0.5, 0.0]), of(&|x| [0.0, 1e-3 * x, 0.0]), of(&|x| [0.0, x * x, 0.0])];
        let found = among(&columns, &[]);
        assert!(found.len() == 1, "{found:?}");
        let v = &found[0].coordinates;
        assert!((v[1] / v[0] + 1e3).abs() < 1e-6 && v[2].abs() < 1e-9, "{v:?}");
        assert!((v.iter().zip(&found[0].share).map(|(v, w)| v * w).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(among(&columns, &[1]).is_empty() && among(&columns, &[2]).len() == 1);
        // what moves no wall has no force
        assert_eq!(among(&[of(&|_| [0.0; 3]), of(&|x| [0.0, x, 0.0])], &[1]).len(), 1);
    }
}
