//! Displacement of the surface of a solid of particles, and of the gas cloud around it.
//!
//! *On the surface*, the displacement of a point is a weighted fit to the nearest surface nodes with weights w = 1/r⁴,
//! so that points at
//! nodes move with them. In 2-D the fit is α + βz + γz² with complex numbers; in 3-D it is a small rigid motion, a
//! uniform stretch and a parabola along the surface. Rigid motions are reproduced to round-off, in 2-D for finite
//! angles too. *Around the surface*, the fit is α + βz, in 3-D a small rigid motion with a stretch, over nodes up to a
//! distance of 1.5 times that of the point from the surface. The cloud near a body therefore rotates with it, and short
//! waves of the surface decay with the distance. Nodes are combined into groups whose size increases with the distance.
//! All fits are linear in the displacements of the nodes, so that differences of positions remain exact.
use std::collections::BTreeMap;

use crate::math::jet::Jet;
use crate::math::moving_fit::{Basis, weights};
use crate::math::{Bounds, Vector};

/// Number of nodes in the fit for a point of the surface, in 2-D and 3-D.
const NEAREST: [usize; 2] = [5, 12];
/// Cosine of the angle between normals below which a node lies on the other side of the body.
const OTHER_SIDE: f64 = -0.3;
/// Distance to a node, in node spacings, below which a point coincides with the node, so that no division by zero
/// occurs.
const AT_NODE: f64 = 3e-3;
/// Radius of the fit around the surface: in node spacings, and in distances from the surface.
const REACH: [f64; 2] = [3.0, 1.5];
/// Size of a group relative to this radius, in 2-D and 3-D.
const GROUP: [f64; 2] = [0.25, 0.4];

/// A group of nodes.
#[derive(Clone, Debug)]
struct Group<const D: usize> {
    place: Vector<D>,
    /// Area of the group.
    area: f64,
    /// Nodes of the group, each with its fraction of the area.
    members: Vec<(u32, f64)>,
}

/// Groups of equal size.
#[derive(Clone, Debug)]
struct Level<const D: usize> {
    size: f64,
    groups: Vec<Group<D>>,
    /// Index of the first group among those of all levels.
    first: u32,
}

/// The surface nodes of a solid of particles, arranged in groups.
#[derive(Clone, Debug)]
pub struct SurfaceNet<const D: usize> {
    first: usize,
    place: Vec<Vector<D>>,
    normal: Vec<Vector<D>>,
    spacing: f64,
    levels: Vec<Level<D>>,
}

/// Relation between the displacement of a point and those of the nodes: u = Σ W_k u_k.
#[derive(Clone, Debug, Default)]
pub struct Carried<const D: usize> {
    /// Indices of nodes, or of groups, with the matrices W_k.
    pub parts: Vec<(u32, [[f64; D]; D])>,
}

/// Displacements of all nodes and groups at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NetDisplacement<const D: usize> {
    nodes: Vec<Vector<D>>,
    groups: Vec<Vector<D>>,
}

impl<const D: usize> SurfaceNet<D> {
    /// Nodes at the positions `place` with the area vectors `area`, about `spacing` apart. The displacement of the first
    /// node starts at the coordinate number `first` of all bodies. Nodes of zero area do not affect other points.
    pub fn new(first: usize, place: Vec<Vector<D>>, area: &[Vector<D>], spacing: f64) -> Self {
        let unit = |a: &Vector<D>| if *a == Vector::ZERO { *a } else { a.unit() };
        let normal: Vec<Vector<D>> = area.iter().map(unit).collect();
        let bounds = Bounds::around(&place);
        let extent = bounds.extent().max_abs();
        let (mut levels, mut size, mut begin) = (Vec::<Level<D>>::new(), spacing, 0u32);
        loop {
            let mut cells: BTreeMap<[i64; D], Vec<usize>> = BTreeMap::new();
            for (k, x) in place.iter().enumerate() {
                let cell = std::array::from_fn(|d| ((x[d] - bounds.min[d]) / size).floor() as i64);
                cells.entry(cell).or_default().push(k);
            }
            let alone = levels.is_empty();
            let lists: Vec<Vec<usize>> =
                if alone { (0..place.len()).map(|k| vec![k]).collect() } else { cells.into_values().collect() };
            let groups: Vec<Group<D>> = lists.iter().map(|list| gathered(list, &place, area)).collect();
            let count = groups.len() as u32;
            levels.push(Level { size: if alone { 0.0 } else { size }, groups, first: begin });
            begin += count;
            if size > extent {
                break;
            }
            size *= 2.0;
        }
        Self { first, place, normal, spacing, levels }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.place.len()
    }

    /// True when there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.place.is_empty()
    }

    /// Undeformed positions of the nodes.
    pub fn places(&self) -> &[Vector<D>] {
        &self.place
    }

    /// Displacements of nodes and groups for the coordinates `jets` of all bodies.
    pub fn displacement(&self, jets: &[Jet]) -> NetDisplacement<D> {
        let nodes = self.of(jets, |jet| jet.value);
        let group =
            |g: &Group<D>| g.members.iter().fold(Vector::ZERO, |sum, (k, part)| sum + nodes[*k as usize] * *part);
        let groups = self.levels.iter().flat_map(|l| l.groups.iter().map(group)).collect();
        NetDisplacement { nodes, groups }
    }

    /// The quantity `part` of the coordinates of all nodes, as vectors.
    pub fn of(&self, jets: &[Jet], part: impl Fn(&Jet) -> f64) -> Vec<Vector<D>> {
        let of = |k: usize, d: usize| jets.get(self.first + k * D + d).map_or(0.0, &part);
        (0..self.len()).map(|k| Vector::from_fn(|d| of(k, d))).collect()
    }

    /// Relation for the point `x` on the surface, where the normal is `normal`.
    pub fn on_surface(&self, x: &Vector<D>, normal: &Vector<D>) -> Carried<D> {
        let mut near: Vec<(f64, u32)> = (0..self.len())
            .filter(|k| self.normal[*k] != Vector::ZERO && self.normal[*k].dot(normal) > OTHER_SIDE)
            .map(|k| ((self.place[k] - *x).norm_squared(), k as u32))
            .collect();
        let count = NEAREST[D - 2].min(near.len());
        if count < near.len() {
            near.select_nth_unstable_by(count, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            near.truncate(count);
        }
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let least = (AT_NODE * self.spacing).powi(2);
        let nodes: Vec<(u32, Vector<D>, f64)> = near
            .iter()
            .map(|(r2, k)| (*k, (self.place[*k as usize] - *x) * (1.0 / self.spacing), (least / (r2 + least)).powi(2)))
            .collect();
        fitted(&nodes, along_surface(&nodes, normal))
    }

    /// Relation for the point `x` away from the surface.
    pub fn around(&self, x: &Vector<D>) -> Carried<D> {
        let carries = self.place.iter().zip(&self.normal).filter(|(_, n)| **n != Vector::ZERO);
        let nearest = carries.map(|(p, _)| (*p - *x).norm_squared()).fold(f64::INFINITY, f64::min).sqrt();
        let reach = REACH[0] * self.spacing + REACH[1] * nearest;
        let fits = |l: &&Level<D>| l.size <= GROUP[D - 2] * reach;
        let Some(level) = self.levels.iter().rev().find(fits).or(self.levels.first()) else {
            return Carried::default();
        };
        let mut nodes = Vec::new();
        for (g, group) in (level.first..).zip(&level.groups) {
            let r = (group.place - *x).norm() / reach;
            if r < 1.0 && group.area > 0.0 {
                // weight function with two continuous derivatives at the end of its support (Wendland 1995)
                let weight = group.area * (1.0 - r).powi(4) * (4.0 * r + 1.0);
                nodes.push((g, (group.place - *x) * (1.0 / reach), weight));
            }
        }
        if D == 2 { turned(&nodes) } else { fitted(&nodes, rigid(&nodes)) }
    }
}

impl<const D: usize> Carried<D> {
    fn sum(&self, all: &[Vector<D>]) -> Vector<D> {
        let mut sum = Vector::ZERO;
        for (k, w) in &self.parts {
            let u = &all[*k as usize];
            for r in 0..D {
                for c in 0..D {
                    sum[r] += w[r][c] * u[c];
                }
            }
        }
        sum
    }

    /// Value at a point of the surface of a quantity given at the nodes.
    pub fn of_nodes(&self, nodes: &[Vector<D>]) -> Vector<D> {
        self.sum(nodes)
    }

    /// Displacement of a point around the surface.
    pub fn of_groups(&self, at: &NetDisplacement<D>) -> Vector<D> {
        self.sum(&at.groups)
    }

    /// Displacement of a point of the surface.
    pub fn on(&self, at: &NetDisplacement<D>) -> Vector<D> {
        self.sum(&at.nodes)
    }
}

fn gathered<const D: usize>(list: &[usize], place: &[Vector<D>], area: &[Vector<D>]) -> Group<D> {
    let whole: f64 = list.iter().map(|k| area[*k].norm()).sum();
    let part = |k: usize| if whole > 0.0 { area[k].norm() / whole } else { 1.0 / list.len() as f64 };
    let place = list.iter().fold(Vector::ZERO, |sum, k| sum + place[*k] * part(*k));
    Group { place, area: whole, members: list.iter().map(|k| (*k as u32, part(*k))).collect() }
}

/// Weights of nodes, given by their offsets, for the value at the offset zero.
fn fitted<const D: usize>(nodes: &[(u32, Vector<D>, f64)], basis: Vec<Basis>) -> Carried<D> {
    let of_values: Vec<f64> = nodes.iter().flat_map(|(_, _, w)| [*w; D]).collect();
    let (all, width) = (weights(basis, &of_values), of_values.len());
    let block = |k: usize| std::array::from_fn(|r| std::array::from_fn(|c| all[r * width + k * D + c]));
    Carried { parts: nodes.iter().enumerate().map(|(k, node)| (node.0, block(k))).collect() }
}

/// Weights for the fit α + βz in 2-D, where α is the weighted mean and β the covariance with z divided by its variance.
fn turned<const D: usize>(nodes: &[(u32, Vector<D>, f64)]) -> Carried<D> {
    let total: f64 = nodes.iter().map(|n| n.2).sum();
    let mean = nodes.iter().fold(Vector::ZERO, |sum, (_, z, w)| sum + *z * (w / total));
    let variance: f64 = nodes.iter().map(|(_, z, w)| w * (*z - mean).norm_squared()).sum();
    let part = |(k, z, w): &(u32, Vector<D>, f64)| {
        // w/Σw − w m conj(z − m)/S, a complex number that represents rotation and stretch
        let (d, over) = (*z - mean, if variance > 0.0 { w / variance } else { 0.0 });
        let re = w / total - over * (mean[0] * d[0] + mean[1] * d[1]);
        let im = -over * (mean[1] * d[0] - mean[0] * d[1]);
        let block = [[re, -im], [im, re]];
        (*k, std::array::from_fn(|r| std::array::from_fn(|c| block[r][c])))
    };
    Carried { parts: nodes.iter().map(part).collect() }
}

/// Values of a field at the nodes and at the offset zero.
fn field<const D: usize>(nodes: &[(u32, Vector<D>, f64)], f: impl Fn(&Vector<D>) -> Vector<D>) -> Basis {
    Basis { at_nodes: nodes.iter().flat_map(|(_, d, _)| f(d).0).collect(), asked: f(&Vector::ZERO).0.to_vec() }
}

/// Basis of translations, small rotations and uniform stretch; α + βz in 2-D.
fn rigid<const D: usize>(nodes: &[(u32, Vector<D>, f64)]) -> Vec<Basis> {
    let mut all: Vec<Basis> = (0..D).map(|a| field(nodes, |_| Vector::axis(a))).collect();
    for (a, b) in (0..D).flat_map(|a| (0..a).map(move |b| (a, b))) {
        all.push(field(nodes, |d| Vector::axis(a) * d[b] - Vector::axis(b) * d[a]));
    }
    all.push(field(nodes, |d| *d));
    all
}

/// This basis together with parabolas along the surface.
fn along_surface<const D: usize>(nodes: &[(u32, Vector<D>, f64)], normal: &Vector<D>) -> Vec<Basis> {
    let mut all = rigid(nodes);
    if D == 2 {
        // the term γz²
        all.push(field(nodes, |d| {
            Vector::from_fn(|k| if k == 0 { d[0] * d[0] - d[1] * d[1] } else { 2.0 * d[0] * d[1] })
        }));
        all.push(field(nodes, |d| {
            Vector::from_fn(|k| if k == 1 { d[0] * d[0] - d[1] * d[1] } else { -2.0 * d[0] * d[1] })
        }));
        return all;
    }
    let [t, s] = tangents(normal);
    let powers: [fn(f64, f64) -> f64; 5] = [|x, _| x, |_, y| y, |x, _| x * x, |x, y| x * y, |_, y| y * y];
    for power in powers {
        for a in 0..D {
            all.push(field(nodes, |d| Vector::axis(a) * power(d.dot(&t), d.dot(&s))));
        }
    }
    all
}

/// Two orthonormal vectors tangential to a surface in 3-D; in 2-D only the first one is meaningful.
pub fn tangents<const D: usize>(normal: &Vector<D>) -> [Vector<D>; 2] {
    if D == 2 {
        return [Vector::from_fn(|d| if d == 0 { -normal[1] } else { normal[0] }), Vector::ZERO];
    }
    let least = (0..D).min_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs())).unwrap_or(0);
    let first = (Vector::axis(least) - *normal * normal[least]).unit();
    let (n, t) = (normal.to_3d(), first.to_3d());
    let second = [n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]];
    [first, Vector::from_fn(|d| second[d])]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(n: usize) -> (Vec<Vector<2>>, Vec<Vector<2>>) {
        let at = |k: usize| std::f64::consts::TAU * k as f64 / n as f64;
        let place: Vec<Vector<2>> = (0..n).map(|k| Vector([at(k).cos(), 0.4 * at(k).sin()])).collect();
        let area = (0..n).map(|k| Vector([0.4 * at(k).cos(), at(k).sin()]) * (6.0 / n as f64)).collect();
        (place, area)
    }

    /// The displacement of all nodes as coordinates.
    fn jets<const D: usize>(place: &[Vector<D>], f: impl Fn(&Vector<D>) -> Vector<D>) -> Vec<Jet> {
        place.iter().flat_map(|x| f(x).0.map(|value| Jet { value, first: 0.0, second: 0.0 })).collect()
    }

    #[test]
    fn turns_of_any_angle_carry_the_surface_and_all_around_in_the_plane() {
        let (place, area) = circle(60);
        let net = SurfaceNet::new(0, place.clone(), &area, 0.1);
        let turned = |x: &Vector<2>| {
            let (s, c) = 1.1f64.sin_cos();
            Vector([c * x[0] - s * x[1] + 0.3, s * x[0] + c * x[1]]) - *x
        };
        let at = net.displacement(&jets(&place, turned));
        for x in [Vector([0.9, 0.17]), Vector([-0.2, 0.39]), Vector([0.0, -0.4])] {
            let normal = Vector([0.16 * x[0], x[1]]).unit();
            assert!((net.on_surface(&x, &normal).on(&at) - turned(&x)).max_abs() < 1e-11);
        }
        for x in [Vector([0.9, 0.37]), Vector([-0.2, 1.39]), Vector([4.0, -3.4])] {
            assert!((net.around(&x).of_groups(&at) - turned(&x)).max_abs() < 1e-12);
        }
    }

    #[test]
    fn nodes_go_as_they_do_and_bends_come_back_to_third_order() {
        let worst = |n: usize| {
            let (place, area) = circle(n);
            let net = SurfaceNet::new(0, place.clone(), &area, 6.0 / n as f64);
            let bent = |x: &Vector<2>| Vector([0.1 * (2.0 * x[1]).sin(), 0.2 * (3.0 * x[0]).cos()]);
            let at = net.displacement(&jets(&place, bent));
            let normal = area[3].unit();
            assert!((net.on_surface(&place[3], &normal).on(&at) - bent(&place[3])).max_abs() < 1e-7);
            let error = |k: usize| {
                let t = std::f64::consts::TAU * (f64::from(k as u32) + 0.37) / 40.0;
                let x = Vector([t.cos(), 0.4 * t.sin()]);
                let normal = Vector([0.4 * t.cos(), t.sin()]).unit();
                (net.on_surface(&x, &normal).on(&at) - bent(&x)).max_abs()
            };
            (0..40).map(error).fold(0.0, f64::max)
        };
        let [coarse, fine] = [60, 120].map(worst);
        assert!(fine < 1e-3 && coarse / fine > 4.0, "{coarse} {fine}");
    }

    #[test]
    fn small_rigid_motions_carry_a_plate_in_space() {
        let place: Vec<Vector<3>> =
            (0..100).map(|k| Vector([f64::from(k % 10), f64::from(k / 10), 0.0]) * 0.1).collect();
        let area = vec![Vector([0.0, 0.0, 0.01]); 100];
        let net = SurfaceNet::new(0, place.clone(), &area, 0.1);
        let turned = |x: &Vector<3>| Vector([0.2 * x[2] - 0.1 * x[1], 0.1 * x[0] + 0.4, 0.05 - 0.2 * x[0]]);
        let at = net.displacement(&jets(&place, turned));
        let x = Vector([0.33, 0.52, 0.0]);
        assert!((net.on_surface(&x, &Vector([0.0, 0.0, 1.0])).on(&at) - turned(&x)).max_abs() < 1e-11);
        let x = Vector([0.33, 0.52, 0.7]);
        assert!((net.around(&x).of_groups(&at) - turned(&x)).max_abs() < 1e-11);
    }
}
