//! Values of one cloud of particles at the places of another.
//!
//! Each place takes the value of the nearest particle, continued along the slope that its neighbours give by least squares: exact
//! for linear fields. Where neighbours lie on a line, as those of thin layers do, the slope across it is left out.
use std::ops::{Add, Mul};

use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::math::Vector;
use crate::math::least_squares::{bounded_inverse, gradient_weight, normal_inverse, normal_matrix};

/// Neighbours of the nearest particle that give its slope, in the plane and in space.
const NEIGHBOURS: [usize; 2] = [8, 16];
/// Condition number of their fit above which it is bounded.
const FLAT: f64 = 100.0;

/// Particles and weights of each place.
pub(super) struct Transfer {
    rows: Vec<Vec<(usize, f64)>>,
}

impl Transfer {
    /// From particles at `from` to the places `to`; `None` where there are no particles.
    pub(super) fn new(from: &[[f64; 3]], to: &[[f64; 3]]) -> Option<Self> {
        let tree = RTree::bulk_load(from.iter().zip(0..).map(|(x, i)| GeomWithData::new(*x, i)).collect());
        let plane = from.iter().all(|x| x[2] == 0.0);
        let row = |x: &[f64; 3]| if plane { row::<2>(&tree, x) } else { row::<3>(&tree, x) };
        Some(Self { rows: to.iter().map(row).collect::<Option<_>>()? })
    }

    /// The values there.
    pub(super) fn of<T: Copy + Add<Output = T> + Mul<f64, Output = T>>(&self, values: &[T]) -> Vec<T> {
        let sum = |row: &Vec<(usize, f64)>| {
            let (first, rest) = (row[0], &row[1..]);
            rest.iter().fold(values[first.0] * first.1, |sum, (i, w)| sum + values[*i] * *w)
        };
        self.rows.iter().map(sum).collect()
    }
}

/// Particles and weights of the place `x`, the nearest one first.
fn row<const D: usize>(tree: &RTree<GeomWithData<[f64; 3], usize>>, x: &[f64; 3]) -> Option<Vec<(usize, f64)>> {
    let place = |x: &[f64; 3]| Vector::<D>::from_fn(|d| x[d]);
    let nearest = tree.nearest_neighbor(x)?;
    let centre = place(nearest.geom());
    let off = place(x) - centre;
    if off.norm_squared() == 0.0 {
        return Some(vec![(nearest.data, 1.0)]);
    }
    let around = tree.nearest_neighbor_iter(nearest.geom()).map(|p| (p.data, place(p.geom()) - centre));
    let around: Vec<_> = around.filter(|(_, d)| d.norm_squared() > 0.0).take(NEIGHBOURS[usize::from(D == 3)]).collect();
    let (matrix, count) = normal_matrix(around.iter().map(|(_, d)| *d));
    let inverse = normal_inverse(&matrix).filter(|(_, condition)| *condition < FLAT);
    let inverse = inverse.map_or_else(|| bounded_inverse(&matrix, count), |(inverse, _)| inverse);
    let mut row = vec![(nearest.data, 1.0)];
    for (i, d) in around {
        let weight = gradient_weight(&inverse, &d).dot(&off);
        row[0].1 -= weight;
        row.push((i, weight));
    }
    Some(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_fields_are_transferred_exactly() {
        let from: Vec<[f64; 3]> =
            (0..100).map(|k| [f64::from(k % 10) + 0.3 * f64::from(k).sin(), f64::from(k / 10), 0.0]).collect();
        let to: Vec<[f64; 3]> = (0..20).map(|k| [0.4 * f64::from(k), 4.2 + 0.1 * f64::from(k), 0.0]).collect();
        let field = |x: &[f64; 3]| 2.0 + 3.0 * x[0] - x[1];
        let values: Vec<f64> = from.iter().map(field).collect();
        let found = Transfer::new(&from, &to).unwrap().of(&values);
        assert!(found.iter().zip(&to).all(|(f, x)| (f - field(x)).abs() < 1e-12), "{found:?}");
        assert!(Transfer::new(&[], &to).is_none());
    }

    #[test]
    fn neighbours_on_a_line_give_bounded_values() {
        let from: Vec<[f64; 3]> = (0..20).map(|k| [0.0, 0.01 * f64::from(k), 0.0]).collect();
        let values: Vec<f64> = (0..20).map(f64::from).collect();
        let found = Transfer::new(&from, &[[0.5, 0.105, 0.0]]).unwrap().of(&values)[0];
        assert!((9.0..12.0).contains(&found), "{found}");
    }
}
