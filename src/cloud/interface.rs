//! Interface particles: where the surface meets the cloud.
//!
//! In 2-D they follow the outline at a spacing proportional to the local size of the background, half a spacing away from
//! sharp edges; area vectors are chords between the midpoints of neighbours, so that they sum to zero exactly. In 3-D they
//! are picked from dense samples of the surface (no two nearer than 0.78 h) and moved to the middle of what they stand for
//! (Lloyd 1982, eight rounds); their area vectors are sums of the samples' and close as well as the surface does.
use super::Interface;
use super::tree::Tree;
use crate::geometry::Surface;
use crate::math::{Bounds, Vector};

/// Spacing along the outline in cells of the background (2-D).
const OUTLINE_SPACING: f64 = 0.85;
/// Steepest growth of the spacing along the outline.
const OUTLINE_GROWTH: f64 = 0.25;
/// Smallest distance between picked samples in cells of the background (3-D).
const PICK_SPACING: f64 = 0.78;
/// Size of the samples in cells (3-D).
const SAMPLE_SIZE: f64 = 0.3;
/// Rounds of Lloyd's iteration.
const LLOYD_ROUNDS: usize = 8;
/// Samples whose normals differ more (cosine) belong to different particles.
const SAME_SIDE: f64 = -0.2;

/// Interface particles of all bodies.
#[derive(Default)]
pub struct Placed<const D: usize> {
    /// Positions, on the surface.
    pub x: Vec<Vector<D>>,
    /// Local spacings of the background.
    pub spacing: Vec<f64>,
    /// Normals, areas, curvature, tags.
    pub interface: Vec<Interface<D>>,
    /// Successor along the outline (2-D), `u32::MAX` at a sharp edge.
    pub next: Vec<u32>,
}

/// Places interface particles on every body.
pub fn place<const D: usize>(surface: &Surface<D>, tree: &Tree<D>) -> Placed<D> {
    if D == 2 { outline(surface, tree) } else { scatter(surface, tree) }
}

/// 2-D: one smooth piece of outline after the other.
fn outline<const D: usize>(surface: &Surface<D>, tree: &Tree<D>) -> Placed<D> {
    let mut placed = Placed::default();
    for (piece, chain) in surface.chains().iter().enumerate() {
        outline_piece(surface, tree, chain, piece as u32, &mut placed);
    }
    placed
}

/// One piece: `chain` lists its elements in order.
fn outline_piece<const D: usize>(
    surface: &Surface<D>,
    tree: &Tree<D>,
    chain: &crate::geometry::Chain,
    piece: u32,
    placed: &mut Placed<D>,
) {
    let lengths: Vec<f64> = chain.elements.iter().map(|e| surface.element_area_vector(*e).norm()).collect();
    let mut h: Vec<f64> =
        chain.elements.iter().map(|e| tree.leaf_at(&surface.element_point(*e, &half()).0).size).collect();
    limit_growth(&mut h, &lengths, chain.closed);
    let steps: Vec<f64> = lengths.iter().zip(&h).map(|(l, h)| l / (OUTLINE_SPACING * h)).collect();
    let total: f64 = steps.iter().sum();
    let n = (total.round() as usize).max(if chain.closed { 4 } else { 2 });
    let walk = Walk { surface, chain, steps: &steps, scale: total / n as f64 };
    let first = placed.x.len() as u32;
    let mut corner = walk.at(0.0);
    let mut arc = 0.0;
    for k in 0..n {
        let here = walk.at(k as f64 + 0.5);
        let end = walk.at(k as f64 + 1.0);
        let chord = end.x - corner.x;
        // the fluid lies to the left or right of the walk as the normals say
        let mut area = Vector::ZERO;
        (area[0], area[1]) = (chord[1], -chord[0]);
        let area = if area.dot(&here.normal) >= 0.0 { area } else { -area };
        let curvature = rank_one(&(end.normal - corner.normal), &chord);
        let element = surface.element(here.element);
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
        let last = k + 1 == n;
        placed.next.push(if !last {
            first + k as u32 + 1
        } else if chain.closed {
            first
        } else {
            u32::MAX
        });
        arc += chord.norm();
        corner = end;
    }
}

fn half<const D: usize>() -> [f64; D] {
    [1.0 / D as f64; D]
}

/// The tensor ∂n/∂x that turns the chord into the change of the normal, along the chord only.
fn rank_one<const D: usize>(change: &Vector<D>, chord: &Vector<D>) -> [Vector<D>; D] {
    let slope = change.dot(chord) / chord.norm_squared();
    let t = chord.unit();
    std::array::from_fn(|r| t * (slope * t[r]))
}

/// Makes `h` grow no faster than `OUTLINE_GROWTH` along the outline.
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

struct Walk<'a, const D: usize> {
    surface: &'a Surface<D>,
    chain: &'a crate::geometry::Chain,
    steps: &'a [f64],
    scale: f64,
}

struct Stop<const D: usize> {
    x: Vector<D>,
    normal: Vector<D>,
    element: u32,
    position: usize,
}

impl<const D: usize> Walk<'_, D> {
    /// The point after `k` particle spacings.
    fn at(&self, k: f64) -> Stop<D> {
        let mut rest = k * self.scale;
        let mut position = 0;
        while position + 1 < self.steps.len() && rest > self.steps[position] {
            rest -= self.steps[position];
            position += 1;
        }
        let fraction = (rest / self.steps[position]).clamp(0.0, 1.0);
        let element = self.chain.elements[position];
        let mut weights = [0.0; D];
        (weights[0], weights[1]) = (1.0 - fraction, fraction);
        let (x, normal) = self.surface.element_point(element, &weights);
        Stop { x, normal, element, position }
    }
}

/// A small piece of surface.
struct Sample<const D: usize> {
    x: Vector<D>,
    normal: Vector<D>,
    area: Vector<D>,
    spacing: f64,
    element: u32,
}

/// 3-D: dense samples, greedy pick, Lloyd.
fn scatter<const D: usize>(surface: &Surface<D>, tree: &Tree<D>) -> Placed<D> {
    let mut samples = Vec::new();
    surface.for_each_piece(
        |x| SAMPLE_SIZE * tree.leaf_at(x).size,
        |x, normal, area, element| {
            samples.push(Sample { x: *x, normal: *normal, area: *area, spacing: tree.leaf_at(x).size, element });
        },
    );
    sort_along_curve(&mut samples);
    let mut chosen = pick(&samples);
    let mut owner = Vec::new();
    for _ in 0..LLOYD_ROUNDS {
        owner = assign(&samples, &chosen);
        recentre(&samples, &owner, &mut chosen);
    }
    owner = if chosen.is_empty() { owner } else { assign(&samples, &chosen) };
    gather(surface, &samples, &chosen, &owner)
}

fn sort_along_curve<const D: usize>(samples: &mut [Sample<D>]) {
    let bounds = Bounds::around(samples.iter().map(|s| &s.x));
    let scale = f64::from(1u32 << 20) / (bounds.extent().max_abs() * 1.0001);
    let cell = |s: &Sample<D>| std::array::from_fn::<u32, D, _>(|d| ((s.x[d] - bounds.min[d]) * scale) as u32);
    samples.sort_by_cached_key(|s| (crate::math::hilbert::hilbert_index(cell(s), 20), s.element));
}

/// Samples that keep `PICK_SPACING` between them, first come first served.
fn pick<const D: usize>(samples: &[Sample<D>]) -> Vec<usize> {
    let mut grid = Grid::new(samples.iter().fold(0.0f64, |m, s| m.max(s.spacing)));
    let mut chosen: Vec<usize> = Vec::new();
    for (k, s) in samples.iter().enumerate() {
        let r = PICK_SPACING * s.spacing;
        let mut free = true;
        grid.near(&s.x, |j| {
            let o = &samples[chosen[j as usize]];
            free &= (o.x - s.x).norm_squared() > r * r || o.normal.dot(&s.normal) < SAME_SIDE;
        });
        if free {
            grid.insert(&s.x, chosen.len() as u32);
            chosen.push(k);
        }
    }
    chosen
}

/// The chosen sample nearest to each sample, on the same side of thin bodies.
fn assign<const D: usize>(samples: &[Sample<D>], chosen: &[usize]) -> Vec<u32> {
    let mut grid = Grid::new(samples.iter().fold(0.0f64, |m, s| m.max(s.spacing)));
    chosen.iter().enumerate().for_each(|(j, k)| grid.insert(&samples[*k].x, j as u32));
    let mut owner = vec![0u32; samples.len()];
    crate::math::sweep::sweep(&mut owner, |k| {
        let s = &samples[k];
        let mut best = (f64::INFINITY, 0);
        grid.near(&s.x, |j| {
            let o = &samples[chosen[j as usize]];
            let r = (o.x - s.x).norm_squared();
            if o.normal.dot(&s.normal) >= SAME_SIDE && (r, j) < best {
                best = (r, j);
            }
        });
        best.1
    });
    owner
}

/// Moves each chosen sample to the one nearest to the centre of its set.
fn recentre<const D: usize>(samples: &[Sample<D>], owner: &[u32], chosen: &mut [usize]) {
    let mut centre = vec![(Vector::<D>::ZERO, 0.0); chosen.len()];
    for (s, o) in samples.iter().zip(owner) {
        let w = s.area.norm();
        centre[*o as usize].0 += s.x * w;
        centre[*o as usize].1 += w;
    }
    let mut best = vec![(f64::INFINITY, 0usize); chosen.len()];
    for (k, (s, o)) in samples.iter().zip(owner).enumerate() {
        let (sum, weight) = centre[*o as usize];
        let r = (s.x - sum * (1.0 / weight)).norm_squared();
        if r < best[*o as usize].0 {
            best[*o as usize] = (r, k);
        }
    }
    chosen.iter_mut().zip(&best).for_each(|(c, b)| *c = b.1);
}

fn gather<const D: usize>(surface: &Surface<D>, samples: &[Sample<D>], chosen: &[usize], owner: &[u32]) -> Placed<D> {
    let mut placed = Placed::default();
    let mut area = vec![Vector::<D>::ZERO; chosen.len()];
    samples.iter().zip(owner).for_each(|(s, o)| area[*o as usize] += s.area);
    let mut grid = Grid::new(samples.iter().fold(0.0f64, |m, s| m.max(s.spacing)) * 1.5);
    chosen.iter().enumerate().for_each(|(j, k)| grid.insert(&samples[*k].x, j as u32));
    for (j, k) in chosen.iter().enumerate() {
        let s = &samples[*k];
        let element = surface.element(s.element);
        let mut around = Vec::new();
        grid.near(&s.x, |m| {
            let o = &samples[chosen[m as usize]];
            let d = o.x - s.x;
            if m as usize != j && d.norm() < 2.0 * s.spacing && o.normal.dot(&s.normal) > 0.5 {
                around.push((d, o.normal - s.normal));
            }
        });
        let curvature = shape_operator(&s.normal, &around);
        placed.x.push(s.x);
        placed.spacing.push(s.spacing);
        let (body, tag) = (element.body, element.tag);
        placed.interface.push(Interface { normal: s.normal, area: area[j], curvature, body, tag, piece: 0, arc: 0.0 });
        placed.next.push(u32::MAX);
    }
    placed
}

/// ∂n/∂x along the surface by least squares over (offset, change of normal), weights 1/r².
fn shape_operator<const D: usize>(normal: &Vector<D>, around: &[(Vector<D>, Vector<D>)]) -> [Vector<D>; D] {
    let tangential = |d: &Vector<D>| *d - *normal * d.dot(normal);
    // one artificial offset along the normal, without change, fixes the slope that the surface does not determine
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

/// Points in square bins.
struct Grid {
    size: f64,
    bins: std::collections::HashMap<[i32; 3], Vec<u32>>,
}

impl Grid {
    fn new(size: f64) -> Self {
        Self { size, bins: std::collections::HashMap::new() }
    }

    fn bin<const D: usize>(&self, x: &Vector<D>) -> [i32; 3] {
        x.to_3d().map(|c| (c / self.size).floor() as i32)
    }

    fn insert<const D: usize>(&mut self, x: &Vector<D>, k: u32) {
        let bin = self.bin(x);
        self.bins.entry(bin).or_default().push(k);
    }

    /// Every point in the bins around `x`.
    fn near<const D: usize>(&self, x: &Vector<D>, mut f: impl FnMut(u32)) {
        let bin = self.bin(x);
        for code in 0..27 {
            let b = [bin[0] + code % 3 - 1, bin[1] + code / 3 % 3 - 1, bin[2] + code / 9 - 1];
            self.bins.get(&b).into_iter().flatten().for_each(|k| f(*k));
        }
    }
}
