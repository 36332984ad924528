//! Oriented bounding boxes for slivers.
//!
//! Triangles of CAD files are often long and narrow; those of a cone extend from its tip to its base. Axis-aligned
//! boxes around them overlap by hundreds, so that a search in a tree of such boxes visits most of the surface. An
//! oriented box along the slivers fits them closely (Gottschalk, Lin and Manocha, "OBBTree", SIGGRAPH 1996). It is used
//! only to skip candidates, so that results do not change.
use super::simplex::{self, Corners};
use crate::math::{Bounds, Vector};

/// Aspect ratio above which a triangle is a sliver, and above which an oriented box is used; an axis-aligned box
/// suffices for rounder shapes.
const SLENDER: f64 = 4.0;
/// Enlargement of a box relative to the coordinates, which covers their round-off.
const SLACK: f64 = 1e-12;
/// Round-off of unit vectors and of angles between axes.
const ROUNDING: f64 = 1e-12;

/// An oriented box around adjacent slivers.
#[derive(Clone, Debug)]
pub(super) struct Bar<const D: usize> {
    centre: Vector<D>,
    axes: [Vector<D>; D],
    half: Vector<D>,
}

impl<const D: usize> Bar<D> {
    /// The oriented box around triangles; `None` where they are not adjacent slivers.
    pub(super) fn around(elements: impl Iterator<Item = Corners<D>> + Clone) -> Option<Self> {
        let axes = axes(elements.clone())?;
        let origin = elements.clone().next()?[0];
        let (mut low, mut high) = (Vector::splat(f64::INFINITY), Vector::splat(f64::NEG_INFINITY));
        let mut size = 0.0_f64;
        for x in elements.flatten() {
            let at = Vector::from_fn(|k| (x - origin).dot(&axes[k]));
            (low, high, size) = (low.min(&at), high.max(&at), size.max(x.max_abs()));
        }
        let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let slender = (1..D).all(|k| SLENDER * half[k] < half[0]);
        let centre = (0..D).fold(origin, |x, k| x + axes[k] * middle[k]);
        slender.then(|| Self { centre, axes, half: half + Vector::splat(SLACK * size) })
    }

    /// Lower bound of the squared distance from `x`.
    #[inline]
    pub(super) fn distance_squared(&self, x: &Vector<D>) -> f64 {
        // the axes are orthogonal up to round-off
        const BELOW: f64 = 1.0 - 1e-9;
        let at = self.local(&(*x - self.centre));
        BELOW * (0..D).map(|k| (at[k].abs() - self.half[k]).max(0.0)).map(|beyond| beyond * beyond).sum::<f64>()
    }

    /// True when an element lies beyond one of the sides.
    pub(super) fn misses(&self, corners: &Corners<D>) -> bool {
        let local = corners.map(|x| self.local(&(x - self.centre)));
        (0..D).any(|k| local.iter().all(|x| x[k] > self.half[k]) || local.iter().all(|x| x[k] < -self.half[k]))
    }

    /// A segment (`middle` ± `half`) in the axes of the bar, and the bar in them.
    pub(super) fn segment(&self, middle: &Vector<D>, half: &Vector<D>) -> (Vector<D>, Vector<D>, Bounds<D>) {
        let bounds = Bounds { min: -self.half, max: self.half };
        (self.local(&(*middle - self.centre)), self.local(half), bounds)
    }

    fn local(&self, x: &Vector<D>) -> Vector<D> {
        Vector::from_fn(|k| x.dot(&self.axes[k]))
    }
}

/// Axes of a box: along the longest sides of the triangles, across them, and normal to them; `None` in 2-D, or where a
/// triangle is not a sliver.
fn axes<const D: usize>(elements: impl Iterator<Item = Corners<D>>) -> Option<[Vector<D>; D]> {
    if D != 3 {
        return None;
    }
    let (mut along, mut area) = (Vector::ZERO, Vector::ZERO);
    for corners in elements {
        let (side, own) = (longest_side(&corners), simplex::area_vector(&corners));
        if side.norm_squared() < 2.0 * SLENDER * own.norm() {
            return None;
        }
        along += if along.dot(&side) < 0.0 { -side } else { side };
        area += own;
    }
    let first = along.unit();
    let normal_to_first = |v: &Vector<D>| (*v - first * v.dot(&first)).unit();
    // twice, to remove the round-off of the first orthogonalisation
    let normal = normal_to_first(&normal_to_first(&area));
    let across = simplex::cross(&normal, &first);
    let unit = |v: &Vector<D>| (v.norm() - 1.0).abs() < ROUNDING;
    (unit(&first) && unit(&normal) && unit(&across) && normal.dot(&first).abs() < ROUNDING)
        .then(|| std::array::from_fn(|k| [first, across, normal][k.min(2)]))
}

fn longest_side<const D: usize>(corners: &Corners<D>) -> Vector<D> {
    (0..D)
        .map(|k| corners[(k + 1) % D] - corners[k])
        .fold(Vector::ZERO, |longest, side| if side.norm_squared() > longest.norm_squared() { side } else { longest })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blade(turn: f64) -> Corners<3> {
        let at = |r: f64, t: f64| Vector([1.0 - r, 0.3 * r * t.cos(), 0.3 * r * t.sin()]);
        [at(0.0, 0.0), at(1.0, turn), at(1.0, turn + 0.01)]
    }

    #[test]
    fn a_bar_holds_slivers_and_is_nearer_than_they() {
        let blades: Vec<Corners<3>> = (0..4).map(|k| blade(0.7 + 0.01 * f64::from(k))).collect();
        let bar = Bar::around(blades.iter().copied()).expect("slivers side by side");
        for k in 0..200 {
            let x = Vector([0.013, 0.007, 0.011].map(|a: f64| (a * f64::from(k * k)).sin()));
            let distance = |c: &Corners<3>| (simplex::blend(c, &simplex::closest(&x, c)) - x).norm_squared();
            let nearest = blades.iter().map(distance).fold(f64::INFINITY, f64::min);
            assert!(bar.distance_squared(&x) <= nearest);
        }
        assert!(Bar::around([blade(0.0), blade(3.0)].into_iter()).is_none());
        let round = [Vector([0.0; 3]), Vector([1.0, 0.0, 0.0]), Vector([0.0, 1.0, 0.0])];
        assert!(Bar::around([round].into_iter()).is_none());
    }

    #[test]
    fn what_bars_pass_over_intersects_nothing() {
        let blades: Vec<Corners<3>> = (0..64).map(|k| blade(0.01 * f64::from(k))).collect();
        let tree = super::super::tree::Tree::new(&blades);
        let edges = |a: &Corners<3>, b: &Corners<3>| (0..3).any(|k| simplex::crosses(&a[k], &a[(k + 1) % 3], b));
        let mut met = 0;
        for k in 0..400 {
            let at = |s: f64| {
                Vector(
                    [[0.5, 0.5, 13.0], [0.2, 0.15, 7.1], [0.1, 0.12, 11.3]]
                        .map(|[m, a, w]: [f64; 3]| m + a * (w * s).sin()),
                )
            };
            let needle = [0.0, 0.5, 0.51].map(|s| at(f64::from(k) + s));
            let every: Vec<u32> = (0..64)
                .filter(|e| edges(&needle, &blades[*e as usize]) || edges(&blades[*e as usize], &needle))
                .collect();
            let mut found = Vec::new();
            tree.meeting(0, &needle, |e, corners| {
                found.extend(simplex::intersection(&needle, corners).map(|_| e));
                false
            });
            found.sort_unstable();
            assert_eq!(found, every);
            met += found.len();
        }
        assert!(met > 100, "{met}");
    }
}
