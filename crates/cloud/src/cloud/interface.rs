//! Placement of the interface particles on the surface.
//!
//! Surfaces end where the domain ends: only the half of a body on the fluid side of a plane of symmetry carries
//! particles.
//!
//! In 2-D the particles follow the outline with a spacing proportional to the local size of the background cells, and
//! start half a spacing away from sharp edges. Their area vectors are chords between the midpoints of neighbours, so
//! that they sum exactly to zero. In 3-D the particles are chosen among dense samples of the surface (`samples`). Their
//! area vectors are sums over the samples that they represent and therefore close as accurately as the surface does.
use super::Interface;
use super::samples::{Samples, around};
use super::tree::Tree;
use crate::geometry::{Chain, Surface};
use crate::math::Vector;
use crate::math::parallel::sweep;

/// Spacing along the outline, in background cells (2-D).
const OUTLINE_SPACING: f64 = 0.85;
/// Greatest length of a piece of outline, in background cells, over which the spacing is taken as constant.
const LONGEST_STRIP: f64 = 0.5;
/// Greatest growth rate of the spacing along the outline.
const OUTLINE_GROWTH: f64 = 0.25;
/// Samples nearer to a side of the domain than this, in background cells, are left out: the cap that closes half a body
/// is not a wall.
const ON_PLANE: f64 = 1e-6;

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

/// True for a point on the inner side of all `planes`; `spacing` is that of the background there.
fn is_inside<const D: usize>(planes: &[Plane], x: &Vector<D>, spacing: f64) -> bool {
    planes.iter().all(|p| p.1 * (x[p.0] - p.2) < -ON_PLANE * spacing)
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
            let inside = is_inside(planes, &x, tree.leaf_at(&x).size);
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

/// 3-D: particles at chosen samples of the surface.
fn scatter<const D: usize>(surface: &Surface<D>, tree: &Tree<D>, planes: &[Plane]) -> Placed<D> {
    let samples = Samples::of_surface(surface, tree, |x, spacing| is_inside(planes, x, spacing));
    let (chosen, owner) = samples.partition();
    gather(surface, &samples, &chosen, &owner)
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
