//! Samples of the surface in 3-D, and the particles that are chosen among them.
//!
//! No two particles are nearer than 0.78 h; each moves to the sample nearest to the centroid of those that it represents
//! (eight iterations of Lloyd, 1982). Samples of surfaces of slivers are united first, cell by cell.
use std::cell::Cell;
use std::collections::BTreeMap;

use super::grid::Grid;
use super::tree::Tree;
use crate::geometry::Surface;
use crate::math::parallel::{order_by_key, sweep, sweep_slots};
use crate::math::{Bounds, Vector};

/// Minimum distance between selected samples, in background cells (3-D).
const PICK_SPACING: f64 = 0.78;
/// Size of the samples, in background cells (3-D). Particles are located at samples and hence up to half a sample away
/// from the centroid of what they represent, which is an error of first order in the pressure force. The lift
/// coefficient of the ONERA M6 is 0.286 with a size of 0.25, 0.2917 with 0.125, and 0.2916 with 0.0625.
const SAMPLE_SIZE: f64 = 0.125;
/// Radius, in background cells, within which a sample searches for its owner and within which the curvature is fitted.
/// The cells of Lloyd's partition have radii below 0.8.
const AROUND: f64 = 2.0;
/// Number of Lloyd iterations.
const LLOYD_ROUNDS: usize = 8;
/// Samples over those that the area asks for from which a surface consists of slivers: triangles that are halved leave 3 to 8.
const MANY: f64 = 16.0;
/// Side of the cells, in sizes of samples, in which samples of slivers are united, and cosine of the angle between their normals from which.
const UNITED: f64 = 0.75;
const SAME_FACE: f64 = 0.95;
/// Rounding of distances, over them.
const ROUNDING: f64 = 1e-9;
/// Samples whose normals differ more (cosine) belong to different particles.
const SAME_SIDE: f64 = -0.2;

/// Small pieces of surface, from which interface particles are selected. Each property is an array of its own: most loops need one or two.
pub(super) struct Samples<const D: usize> {
    pub(super) x: Vec<Vector<D>>,
    pub(super) normal: Vec<Vector<D>>,
    pub(super) area_vector: Vec<Vector<D>>,
    /// Size of the area vector.
    area: Vec<f64>,
    pub(super) spacing: Vec<f64>,
    pub(super) element: Vec<u32>,
}

/// One of them: a piece of an element.
#[derive(Clone)]
struct Sample<const D: usize> {
    x: Vector<D>,
    normal: Vector<D>,
    area: Vector<D>,
    spacing: f64,
    element: u32,
}

impl<const D: usize> Samples<D> {
    /// Dense samples of a surface along a space-filling curve, those that are `inside`; `tree` says how large its cells are around a point.
    pub(super) fn of_surface(
        surface: &Surface<D>,
        tree: &Tree<D>,
        inside: impl Fn(&Vector<D>, f64) -> bool + Sync,
    ) -> Self {
        let mut groups = surface.grouped_pieces(
            |x, last: &Cell<u32>| SAMPLE_SIZE * tree.size_at(x, last),
            |x, normal, share, element, last| {
                let spacing = tree.size_at(x, last);
                let area = surface.element_area_vector(element) * share;
                inside(x, spacing).then_some(Sample { x: *x, normal: *normal, area, spacing, element })
            },
        );
        if are_crowded(&groups) {
            sweep_slots(&mut groups, |_, group| *group = united(surface, group));
        }
        let mut samples = Self::of(groups);
        samples.sort_along_curve();
        samples
    }

    /// The samples at which particles stand, and for each sample the number of the particle that it belongs to.
    pub(super) fn partition(&self) -> (Vec<usize>, Vec<u32>) {
        let (mut chosen, mut owner) = pick(self);
        for _ in 0..LLOYD_ROUNDS {
            assign(self, &chosen, &mut owner);
            recentre(self, &owner, &mut chosen);
        }
        assign(self, &chosen, &mut owner);
        (chosen, owner)
    }

    /// The samples of groups in their order.
    fn of(groups: Vec<Vec<Sample<D>>>) -> Self {
        let n = groups.iter().map(Vec::len).sum();
        let (numbers, vectors) = (|| Vec::with_capacity(n), || Vec::with_capacity(n));
        let (x, normal, area_vector, element) = (vectors(), vectors(), vectors(), Vec::with_capacity(n));
        let mut all = Self { x, normal, area_vector, area: numbers(), spacing: numbers(), element };
        for sample in groups.into_iter().flatten() {
            all.x.push(sample.x);
            all.normal.push(sample.normal);
            all.area.push(sample.area.norm());
            all.area_vector.push(sample.area);
            all.spacing.push(sample.spacing);
            all.element.push(sample.element);
        }
        all
    }

    fn len(&self) -> usize {
        self.x.len()
    }

    /// True when samples `a` and `b` are on the same side of thin bodies.
    fn beside(&self, a: usize, b: usize) -> bool {
        self.normal[a].dot(&self.normal[b]) >= SAME_SIDE
    }

    /// Puts the samples into the order of a space-filling curve.
    fn sort_along_curve(&mut self) {
        let bounds = Bounds::around(&self.x);
        let scale = f64::from(1u32 << 20) / (bounds.extent().max_abs() * 1.0001);
        let cell = |x: &Vector<D>| std::array::from_fn::<u32, D, _>(|d| ((x[d] - bounds.min[d]) * scale) as u32);
        let order = order_by_key(self.len(), |k| crate::math::hilbert::hilbert_index(cell(&self.x[k]), 20));
        let mut spare = Vec::new();
        [&mut self.x, &mut self.normal, &mut self.area_vector]
            .into_iter()
            .for_each(|all| permute(all, &order, &mut spare));
        let mut spare = Vec::new();
        [&mut self.area, &mut self.spacing].into_iter().for_each(|all| permute(all, &order, &mut spare));
        permute(&mut self.element, &order, &mut Vec::new());
    }
}

/// Puts `all` into the order of the numbers `order`; `spare` lends memory.
fn permute<T: Copy + Send + Sync>(all: &mut Vec<T>, order: &[u32], spare: &mut Vec<T>) {
    spare.clone_from(all);
    sweep(spare, |k| all[order[k] as usize]);
    std::mem::swap(all, spare);
}

/// Samples that keep `PICK_SPACING` between them, first come first served, and for every sample the one that is in its way: the nearest.
fn pick<const D: usize>(samples: &Samples<D>) -> (Vec<usize>, Vec<u32>) {
    // one grid for each spacing, so that the bins suit all queries
    let mut grids: BTreeMap<u64, Grid<D>> = BTreeMap::new();
    for h in &samples.spacing {
        grids.entry(h.to_bits()).or_insert_with(|| Grid::new(2.0 * PICK_SPACING * h));
    }
    let mut chosen: Vec<usize> = Vec::new();
    let mut owner = vec![0; samples.len()];
    for (k, x) in samples.x.iter().enumerate() {
        let r = PICK_SPACING * samples.spacing[k];
        let mut best = (r * r, u32::MAX);
        grids[&samples.spacing[k].to_bits()].near(x, r, |j| {
            let o = chosen[j as usize];
            let d = (samples.x[o] - *x).norm_squared();
            if d <= best.0 && samples.beside(o, k) {
                best = (d, j);
            }
        });
        owner[k] = best.1;
        if best.1 == u32::MAX {
            owner[k] = chosen.len() as u32;
            grids.values_mut().for_each(|g| g.insert(x, chosen.len() as u32));
            chosen.push(k);
        }
    }
    (chosen, owner)
}

/// True on a surface of slivers, whose pieces are as long as usual but much narrower.
fn are_crowded<const D: usize>(groups: &[Vec<Sample<D>>]) -> bool {
    let asked = |s: &Sample<D>| s.area.norm() / (SAMPLE_SIZE * s.spacing).powi(D as i32 - 1);
    let count = |group: &Vec<Sample<D>>| (group.len() as f64, group.iter().map(asked).sum::<f64>());
    let (all, enough) = groups.iter().map(count).fold((0.0, 0.0), |(n, m), (more, area)| (n + more, m + area));
    all > MANY * enough
}

/// The samples of a group with those of a cell of `UNITED` sizes, one spacing, one part of a body and about one normal as one: the first of
/// them, which gets their area.
fn united<const D: usize>(surface: &Surface<D>, group: &[Sample<D>]) -> Vec<Sample<D>> {
    let low: [f64; D] = std::array::from_fn(|d| group.iter().map(|s| s.x[d]).fold(f64::INFINITY, f64::min));
    let cell = |s: &Sample<D>| -> [u32; D] {
        std::array::from_fn(|d| ((s.x[d] - low[d]) / (UNITED * SAMPLE_SIZE * s.spacing)) as u32)
    };
    let part = |s: &Sample<D>| (surface.element(s.element).body, surface.element(s.element).tag);
    let mut order: Vec<([u32; D], u32)> = group.iter().map(cell).zip(0..).collect();
    order.sort_unstable();
    let mut kept: Vec<Sample<D>> = Vec::new();
    let (mut first, mut last) = (0, None);
    for (cell, k) in order {
        if last.replace(cell) != Some(cell) {
            first = kept.len();
        }
        let s = &group[k as usize];
        let alike =
            |o: &&mut Sample<D>| o.spacing == s.spacing && part(o) == part(s) && o.normal.dot(&s.normal) >= SAME_FACE;
        match kept[first..].iter_mut().find(alike) {
            Some(o) => o.area += s.area,
            None => kept.push(s.clone()),
        }
    }
    kept
}

/// Makes `owner` the chosen sample nearest to each sample, on the same side of thin bodies: its owner so far or one of the
/// others around that.
fn assign<const D: usize>(samples: &Samples<D>, chosen: &[usize], owner: &mut [u32]) {
    let near = by_distance(samples, chosen);
    let places: Vec<(Vector<D>, Vector<D>)> = chosen.iter().map(|k| (samples.x[*k], samples.normal[*k])).collect();
    sweep_slots(owner, |k, owner| {
        let (x, normal, old) = (&samples.x[k], &samples.normal[k], *owner);
        let mut best = (f64::INFINITY, old);
        let mut try_one = |j: u32| {
            let (place, facing) = &places[j as usize];
            let r = (*place - *x).norm_squared();
            if facing.dot(normal) >= SAME_SIDE && (r, j) < best {
                best = (r, j);
            }
            best.0
        };
        let mut reach = try_one(old).sqrt();
        let own = (places[old as usize].0 - *x).norm();
        for (apart, j) in &near[old as usize] {
            // none of those to come is nearer: the triangle's inequality
            if (apart - own) * (1.0 - ROUNDING) > reach {
                break;
            }
            reach = try_one(*j).sqrt();
        }
        *owner = best.1;
    });
}

/// For each chosen sample the others around it with their distances, the nearest first.
fn by_distance<const D: usize>(samples: &Samples<D>, chosen: &[usize]) -> Vec<Vec<(f64, u32)>> {
    let around = around(samples, chosen);
    let mut near = vec![Vec::new(); chosen.len()];
    sweep(&mut near, |j| {
        let x = &samples.x[chosen[j]];
        let apart = |m: &u32| ((samples.x[chosen[*m as usize]] - *x).norm(), *m);
        let mut list: Vec<(f64, u32)> = around[j].iter().map(apart).collect();
        list.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        list
    });
    near
}

/// For each chosen sample the others within `AROUND` spacings of it.
pub(super) fn around<const D: usize>(samples: &Samples<D>, chosen: &[usize]) -> Vec<Vec<u32>> {
    let mut grids: BTreeMap<u64, Grid<D>> = BTreeMap::new();
    for k in chosen {
        let h = samples.spacing[*k];
        grids.entry(h.to_bits()).or_insert_with(|| Grid::new(AROUND * h));
    }
    for (k, j) in chosen.iter().zip(0..) {
        grids.values_mut().for_each(|g| g.insert(&samples.x[*k], j));
    }
    let mut around = vec![Vec::new(); chosen.len()];
    sweep(&mut around, |j| {
        let (x, h) = (&samples.x[chosen[j]], samples.spacing[chosen[j]]);
        let r = AROUND * h;
        let mut list = Vec::new();
        grids[&h.to_bits()].near(x, r, |m| {
            if m as usize != j && (samples.x[chosen[m as usize]] - *x).norm_squared() < r * r {
                list.push(m);
            }
        });
        list.sort_unstable();
        list
    });
    around
}

/// Moves each chosen sample to the one nearest to the centre of its set.
fn recentre<const D: usize>(samples: &Samples<D>, owner: &[u32], chosen: &mut [usize]) {
    let mut centre = vec![(Vector::<D>::ZERO, 0.0); chosen.len()];
    for ((x, w), o) in samples.x.iter().zip(&samples.area).zip(owner) {
        centre[*o as usize].0 += *x * *w;
        centre[*o as usize].1 += w;
    }
    centre.iter_mut().for_each(|(sum, weight)| *sum = *sum * (1.0 / *weight));
    let mut best = vec![(f64::INFINITY, 0usize); chosen.len()];
    for (k, (x, o)) in samples.x.iter().zip(owner).enumerate() {
        let r = (*x - centre[*o as usize].0).norm_squared();
        if r < best[*o as usize].0 {
            best[*o as usize] = (r, k);
        }
    }
    chosen.iter_mut().zip(&best).for_each(|(c, b)| *c = b.1);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pieces of a plate, `across` to a sample's size along one of its sides, and one along the other.
    fn pieces(across: usize) -> Vec<Sample<3>> {
        let (size, n) = (SAMPLE_SIZE * 0.1, 80 * 80 * across);
        let at = |k: usize| Vector([(k / 80) as f64 * size / across as f64, (k % 80) as f64 * size, 0.5]);
        let normal = Vector([0.0, 0.0, 1.0]);
        let area = normal * (size * size / across as f64);
        (0..n).map(|k| Sample { x: at(k), normal, area, spacing: 0.1, element: 0 }).collect()
    }

    fn plate(across: usize) -> Samples<3> {
        let mut samples = Samples::of(vec![pieces(across)]);
        samples.sort_along_curve();
        samples
    }

    #[test]
    fn pieces_of_slivers_are_united_and_keep_their_area() {
        let surface = Surface::new(&[("ball".to_owned(), crate::geometry::icosphere(0.5, 1))]);
        assert!(!are_crowded(&[pieces(1)]) && are_crowded(&[pieces(20)]));
        let (before, after) = (pieces(20), united(&surface, &pieces(20)));
        assert!(after.len() * 8 < before.len() && after.len() > 80 * 80, "{}", after.len());
        let area = |all: &[Sample<3>]| all.iter().map(|s| s.area[2]).sum::<f64>();
        assert!((area(&before) - area(&after)).abs() < 1e-10);
        // two sides of a thin plate stay apart
        let below = |s: Sample<3>| Sample { normal: s.normal * -1.0, area: s.area * -1.0, ..s };
        let both: Vec<_> = pieces(20).into_iter().flat_map(|s| [s.clone(), below(s)]).collect();
        assert_eq!(united(&surface, &both).len(), 2 * after.len());
    }

    #[test]
    fn every_sample_belongs_to_the_nearest_particle() {
        for across in [1, 20] {
            let samples = plate(across);
            let (mut chosen, mut owner) = pick(&samples);
            for _ in 0..2 {
                assign(&samples, &chosen, &mut owner);
                let apart = |x: &Vector<3>, j: u32| (samples.x[chosen[j as usize]] - *x).norm_squared();
                for (x, own) in samples.x.iter().zip(&owner).step_by(37) {
                    let nearest =
                        (0..chosen.len() as u32).map(|j| (apart(x, j), j)).reduce(|a, b| if b < a { b } else { a });
                    assert_eq!(Some((apart(x, *own), *own)), nearest);
                }
                recentre(&samples, &owner, &mut chosen);
            }
        }
    }

    #[test]
    fn picked_samples_keep_their_distance_and_leave_no_gap() {
        for across in [1, 20] {
            let samples = plate(across);
            let chosen = pick(&samples).0;
            let r = PICK_SPACING * 0.1;
            let apart = |a: usize, b: usize| (samples.x[a] - samples.x[b]).norm();
            assert!(chosen.iter().enumerate().all(|(k, a)| chosen[..k].iter().all(|b| apart(*a, *b) > r)));
            assert!((0..samples.len()).step_by(11).all(|k| chosen.iter().any(|a| apart(*a, k) <= r)));
        }
    }
}
