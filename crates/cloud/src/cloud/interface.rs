//! Placement of the interface particles on the surface.
//!
//! Surfaces end where the domain ends: only the half of a body on the fluid side of a plane of symmetry carries
//! particles.
//!
//! In 2-D the particles follow the outline with a spacing proportional to the local size of the background cells, and
//! start half a spacing away from sharp edges. Their area vectors are chords between the midpoints of neighbours, so
//! that they sum exactly to zero. In 3-D the particles are selected from dense samples of the surface (no two nearer
//! than 0.78 h) and moved to the centroid of the samples that they represent (eight iterations of Lloyd, 1982). Their
//! area vectors are sums over these samples and therefore close as accurately as the surface does.
use std::cell::Cell;
use std::collections::BTreeMap;

use super::Interface;
use super::grid::Grid;
use super::tree::Tree;
use crate::geometry::{Chain, Surface};
use crate::math::parallel::{order_by_key, sweep, sweep_slots};
use crate::math::{Bounds, Vector};

/// Spacing along the outline, in background cells (2-D).
const OUTLINE_SPACING: f64 = 0.85;
/// Greatest length of a piece of outline, in background cells, over which the spacing is taken as constant.
const LONGEST_STRIP: f64 = 0.5;
/// Greatest growth rate of the spacing along the outline.
const OUTLINE_GROWTH: f64 = 0.25;
/// Minimum distance between selected samples, in background cells (3-D).
const PICK_SPACING: f64 = 0.78;
/// Size of the samples, in background cells (3-D). Particles are located at samples and hence up to half a sample away
/// from the centroid of what they represent, which is an error of first order in the pressure force. The lift
/// coefficient of the ONERA M6 is 0.286 with a size of 0.25, 0.2917 with 0.125, and 0.2916 with 0.0625.
const SAMPLE_SIZE: f64 = 0.125;
/// Radius, in background cells, within which a sample searches for its owner and within which the curvature is fitted.
/// The cells of Lloyd's partition have radii below 0.8.
const AROUND: f64 = 2.0;
/// Samples nearer to a side of the domain than this, in background cells, are left out: the cap that closes half a body
/// is not a wall.
const ON_PLANE: f64 = 1e-6;
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

/// Interface particles of all bodies. Lengths are in the unit of the geometry.
#[derive(Clone, Default)]
pub struct Placed<const D: usize> {
    /// Positions on the surface.
    pub x: Vec<Vector<D>>,
    /// Local spacing of the background at each particle.
    pub spacing: Vec<f64>,
    /// Normal, area, curvature, body and tag of each particle.
    pub interface: Vec<Interface<D>>,
    /// Index of the next particle along the outline (2-D); `u32::MAX` at a sharp edge.
    pub next: Vec<u32>,
    /// End point of the piece of outline that belongs to each particle (2-D).
    pub end: Vec<Vector<D>>,
}

/// A plane that ends the domain: axis, sign of the outward normal, coordinate.
pub type Plane = (usize, f64, f64);

/// Places interface particles on every body, on the inner side of all `planes`.
pub fn place<const D: usize>(surface: &Surface<D>, tree: &Tree<D>, planes: &[Plane]) -> Placed<D> {
    if D == 2 { outline(surface, tree, planes) } else { scatter(surface, tree, planes) }
}

/// 2-D: places particles on one smooth piece of outline after the other.
fn outline<const D: usize>(surface: &Surface<D>, tree: &Tree<D>, planes: &[Plane]) -> Placed<D> {
    let mut placed = Placed::default();
    let mut piece = 0;
    for chain in surface.chains() {
        for (strips, closed) in runs(surface, tree, &chain, planes) {
            outline_piece(surface, tree, &strips, (piece, closed), &mut placed);
            piece += 1;
        }
    }
    placed
}

/// Part of an element of the outline, at most half a background cell long, given by the barycentric weights of its
/// ends.
#[derive(Clone, Copy, Debug)]
struct Strip {
    element: u32,
    from: f64,
    to: f64,
}

impl Strip {
    fn at<const D: usize>(&self, surface: &Surface<D>, fraction: f64) -> (Vector<D>, Vector<D>) {
        let f = self.from + fraction * (self.to - self.from);
        let mut weights = [0.0; D];
        (weights[0], weights[1]) = (1.0 - f, f);
        surface.element_point(self.element, &weights)
    }
}

/// Connected runs of strips of a chain between the planes; there are several where a plane cuts the chain.
fn runs<const D: usize>(
    surface: &Surface<D>,
    tree: &Tree<D>,
    chain: &Chain,
    planes: &[Plane],
) -> Vec<(Vec<Strip>, bool)> {
    let mut runs: Vec<Vec<Strip>> = Vec::new();
    let mut open = false;
    let mut cut = false;
    for element in &chain.elements {
        for strip in strips(surface, tree, *element, planes) {
            let x = strip.at(surface, 0.5).0;
            let slack = ON_PLANE * tree.leaf_at(&x).size;
            let inside = planes.iter().all(|p| p.1 * (x[p.0] - p.2) < -slack);
            cut |= !inside;
            match runs.last_mut() {
                Some(run) if inside && open => run.push(strip),
                _ if inside => runs.push(vec![strip]),
                _ => {}
            }
            open = inside;
        }
    }
    // true when a closed outline was entered inside a run, so that the last run continues in the first
    let starts_inside = runs.first().is_some_and(|r| r[0].element == chain.elements[0] && r[0].from == 0.0);
    if cut && chain.closed && open && starts_inside && runs.len() > 1 {
        let first = runs.remove(0);
        runs.last_mut().into_iter().for_each(|r| r.extend(&first));
    }
    runs.into_iter().map(|run| (run, chain.closed && !cut)).collect()
}

/// Cuts an element at the planes and then halves its parts until they are short.
fn strips<const D: usize>(surface: &Surface<D>, tree: &Tree<D>, element: u32, planes: &[Plane]) -> Vec<Strip> {
    let whole = Strip { element, from: 0.0, to: 1.0 };
    let (a, b) = (whole.at(surface, 0.0).0, whole.at(surface, 1.0).0);
    let crossing = planes.iter().map(|p| (p.2 - a[p.0]) / (b[p.0] - a[p.0]));
    let mut cuts: Vec<f64> = crossing.filter(|f| (1e-9..1.0 - 1e-9).contains(f)).chain([0.0, 1.0]).collect();
    cuts.sort_by(f64::total_cmp);
    let length = (b - a).norm();
    let mut done = Vec::new();
    let mut stack: Vec<Strip> = cuts.windows(2).rev().map(|w| Strip { element, from: w[0], to: w[1] }).collect();
    while let Some(strip) = stack.pop() {
        if (strip.to - strip.from) * length <= LONGEST_STRIP * tree.leaf_at(&strip.at(surface, 0.5).0).size {
            done.push(strip);
            continue;
        }
        let middle = 0.5 * (strip.from + strip.to);
        stack.push(Strip { from: middle, ..strip });
        stack.push(Strip { to: middle, ..strip });
    }
    done
}

/// Places the particles of one smooth piece of outline.
fn outline_piece<const D: usize>(
    surface: &Surface<D>,
    tree: &Tree<D>,
    strips: &[Strip],
    (piece, closed): (u32, bool),
    placed: &mut Placed<D>,
) {
    let area = |s: &Strip| surface.element_area_vector(s.element).norm() * (s.to - s.from);
    let lengths: Vec<f64> = strips.iter().map(area).collect();
    let mut h: Vec<f64> = strips.iter().map(|s| tree.leaf_at(&s.at(surface, 0.5).0).size).collect();
    limit_growth(&mut h, &lengths, closed);
    let steps: Vec<f64> = lengths.iter().zip(&h).map(|(l, h)| l / (OUTLINE_SPACING * h)).collect();
    let total: f64 = steps.iter().sum();
    let n = (total.round() as usize).max(if closed { 4 } else { 2 });
    let mut walk = Walk { surface, strips, steps: &steps, scale: total / n as f64, passed: 0.0, position: 0 };
    let first = placed.x.len() as u32;
    let mut corner = walk.to(0.0);
    let mut arc = 0.0;
    for k in 0..n {
        let here = walk.to(k as f64 + 0.5);
        let end = walk.to(k as f64 + 1.0);
        let chord = end.x - corner.x;
        // the normals decide whether the fluid lies to the left or to the right of the direction of travel
        let mut area = Vector::ZERO;
        (area[0], area[1]) = (chord[1], -chord[0]);
        let area = if area.dot(&here.normal) >= 0.0 { area } else { -area };
        let curvature = rank_one(&(end.normal - corner.normal), &chord);
        let element = surface.element(strips[here.position].element);
        let (body, tag) = (element.body, element.tag);
        placed.x.push(here.x);
        placed.spacing.push(h[here.position]);
        placed.interface.push(Interface {
            normal: here.normal,
            area,
            curvature,
            body,
            tag,
            piece,
            arc: arc + 0.5 * chord.norm(),
        });
        placed.end.push(end.x);
        let last = k + 1 == n;
        placed.next.push(if !last {
            first + k as u32 + 1
        } else if closed {
            first
        } else {
            u32::MAX
        });
        arc += chord.norm();
        corner = end;
    }
}

/// The tensor ∂n/∂x of rank one that maps the chord to the change of the normal.
fn rank_one<const D: usize>(change: &Vector<D>, chord: &Vector<D>) -> [Vector<D>; D] {
    let slope = change.dot(chord) / chord.norm_squared();
    let t = chord.unit();
    std::array::from_fn(|r| t * (slope * t[r]))
}

/// Limits the growth rate of `h` along the outline to `OUTLINE_GROWTH`.
fn limit_growth(h: &mut [f64], lengths: &[f64], closed: bool) {
    let n = h.len();
    for _ in 0..if closed { 2 } else { 1 } {
        for k in 0..n {
            if k > 0 || closed {
                let previous = h[(k + n - 1) % n];
                h[k] = h[k].min(previous + OUTLINE_GROWTH * lengths[k]);
            }
        }
        for k in (0..n).rev() {
            if k + 1 < n || closed {
                let following = h[(k + 1) % n];
                h[k] = h[k].min(following + OUTLINE_GROWTH * lengths[k]);
            }
        }
    }
}

/// Integration of the number of spacings along the strips, in the forward direction only.
struct Walk<'a, const D: usize> {
    surface: &'a Surface<D>,
    strips: &'a [Strip],
    steps: &'a [f64],
    scale: f64,
    passed: f64,
    position: usize,
}

struct Stop<const D: usize> {
    x: Vector<D>,
    normal: Vector<D>,
    position: usize,
}

impl<const D: usize> Walk<'_, D> {
    /// The point at `k` particle spacings from the start.
    fn to(&mut self, k: f64) -> Stop<D> {
        let target = k * self.scale;
        while self.position + 1 < self.steps.len() && target - self.passed > self.steps[self.position] {
            self.passed += self.steps[self.position];
            self.position += 1;
        }
        let fraction = ((target - self.passed) / self.steps[self.position]).clamp(0.0, 1.0);
        let (x, normal) = self.strips[self.position].at(self.surface, fraction);
        Stop { x, normal, position: self.position }
    }
}

/// Small pieces of surface, from which interface particles are selected. Each property is an array of its own: most loops need one or two.
struct Samples<const D: usize> {
    x: Vec<Vector<D>>,
    normal: Vec<Vector<D>>,
    area_vector: Vec<Vector<D>>,
    /// Its size.
    area: Vec<f64>,
    spacing: Vec<f64>,
    element: Vec<u32>,
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

/// 3-D: dense samples, greedy pick, Lloyd.
fn scatter<const D: usize>(surface: &Surface<D>, tree: &Tree<D>, planes: &[Plane]) -> Placed<D> {
    let mut groups = surface.grouped_pieces(
        |x, last: &Cell<u32>| SAMPLE_SIZE * tree.size_at(x, last),
        |x, normal, share, element, last| {
            let spacing = tree.size_at(x, last);
            let inside = planes.iter().all(|p| p.1 * (x[p.0] - p.2) < -ON_PLANE * spacing);
            let area = surface.element_area_vector(element) * share;
            inside.then_some(Sample { x: *x, normal: *normal, area, spacing, element })
        },
    );
    if are_crowded(&groups) {
        sweep_slots(&mut groups, |_, group| *group = united(surface, group));
    }
    let mut samples = Samples::of(groups);
    samples.sort_along_curve();
    let (mut chosen, mut owner) = pick(&samples);
    for _ in 0..LLOYD_ROUNDS {
        assign(&samples, &chosen, &mut owner);
        recentre(&samples, &owner, &mut chosen);
    }
    assign(&samples, &chosen, &mut owner);
    gather(surface, &samples, &chosen, &owner)
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
fn around<const D: usize>(samples: &Samples<D>, chosen: &[usize]) -> Vec<Vec<u32>> {
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

fn gather<const D: usize>(surface: &Surface<D>, samples: &Samples<D>, chosen: &[usize], owner: &[u32]) -> Placed<D> {
    let mut placed = Placed::default();
    let mut area = vec![Vector::<D>::ZERO; chosen.len()];
    for (own, o) in samples.area_vector.iter().zip(owner) {
        area[*o as usize] += *own;
    }
    let around = around(samples, chosen);
    let mut curvature = vec![[Vector::ZERO; D]; chosen.len()];
    sweep(&mut curvature, |j| {
        let (x, normal) = (samples.x[chosen[j]], samples.normal[chosen[j]]);
        let others = around[j].iter().map(|m| chosen[*m as usize]).filter(|o| samples.normal[*o].dot(&normal) > 0.5);
        let changes = others.map(|o| (samples.x[o] - x, samples.normal[o] - normal));
        shape_operator(&normal, &changes.collect::<Vec<_>>())
    });
    for (j, k) in chosen.iter().enumerate() {
        let element = surface.element(samples.element[*k]);
        placed.x.push(samples.x[*k]);
        placed.spacing.push(samples.spacing[*k]);
        let (body, tag) = (element.body, element.tag);
        let (normal, curvature) = (samples.normal[*k], curvature[j]);
        placed.interface.push(Interface { normal, area: area[j], curvature, body, tag, piece: 0, arc: 0.0 });
        placed.next.push(u32::MAX);
    }
    placed
}

/// Curvature tensor ∂n/∂x along the surface by least squares over pairs (offset, change of normal) with the weights
/// 1/r².
fn shape_operator<const D: usize>(normal: &Vector<D>, around: &[(Vector<D>, Vector<D>)]) -> [Vector<D>; D] {
    let tangential = |d: &Vector<D>| *d - *normal * d.dot(normal);
    // an artificial offset along the normal, without change, determines the slope across the surface, which the data
    // leave open
    let reach = around.iter().map(|a| a.0.norm()).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let mut offsets: Vec<Vector<D>> = around.iter().map(|(d, _)| tangential(d)).collect();
    offsets.push(*normal * reach);
    let mut weights = Vec::new();
    if crate::math::least_squares::gradient_weights(&offsets, &mut weights).is_none() {
        return [Vector::ZERO; D];
    }
    let mut k = [Vector::ZERO; D];
    for (w, (_, change)) in weights.iter().zip(around) {
        let c = tangential(change);
        (0..D).for_each(|r| k[r] += *w * c[r]);
    }
    k
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
