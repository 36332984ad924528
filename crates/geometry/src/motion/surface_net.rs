//! Surfaces of bodies that are made of particles: their displacement is that of nodes, and carries what is on them and around.
//!
//! *On the surface* a point goes where a fit through the nearest nodes takes it, which weighs those at hand most (w = 1/r⁴: points
//! that are nodes go as these do). In the plane the fit is α + βz + γz² with complex numbers, in space a small rigid motion, a
//! stretch and a parabola along the surface: rigid motions come back to round-off, those of finite angle in the plane as well.
//! *Around it* the fit is α + βz, in space a small rigid motion with a stretch, over nodes as far away as the point is from the surface
//! and half as much again, so that the cloud near a body turns as the body does and forgets its waves farther away; nodes are
//! gathered in groups that grow with the distance. All are linear in the displacements of the nodes, so that differences of positions stay exact.
use std::collections::BTreeMap;

use crate::math::jet::Jet;
use crate::math::moving_fit::{Basis, weights};
use crate::math::{Bounds, Vector};

/// Nodes that carry a point of the surface, in the plane and in space.
const NEAREST: [usize; 2] = [5, 12];
/// Cosine of the angle between normals beyond which a node is on another side of the body.
const OTHER_SIDE: f64 = -0.3;
/// Distance to a node over the spacing of nodes that counts as none: nodes themselves are not divided by it.
const AT_NODE: f64 = 3e-3;
/// Reach of the fit around the surface: in spacings of nodes, and in distances from the surface.
const REACH: [f64; 2] = [3.0, 1.5];
/// Size of a group over that reach, in the plane and in space.
const GROUP: [f64; 2] = [0.25, 0.4];

/// Nodes that are gathered.
#[derive(Clone, Debug)]
struct Group<const D: usize> {
    place: Vector<D>,
    /// Their area.
    area: f64,
    /// Nodes and their part of that area.
    members: Vec<(u32, f64)>,
}

/// Groups of one size.
#[derive(Clone, Debug)]
struct Level<const D: usize> {
    size: f64,
    groups: Vec<Group<D>>,
    /// Number of its first group among those of all levels.
    first: u32,
}

/// The surface of a body made of particles.
#[derive(Clone, Debug)]
pub struct SurfaceNet<const D: usize> {
    first: usize,
    place: Vec<Vector<D>>,
    normal: Vec<Vector<D>>,
    spacing: f64,
    levels: Vec<Level<D>>,
}

/// How a point goes with the nodes: u = Σ W_k u_k.
#[derive(Clone, Debug, Default)]
pub struct Carried<const D: usize> {
    /// Nodes, or groups of them, and what their displacements do.
    pub parts: Vec<(u32, [[f64; D]; D])>,
}

/// Displacements of all nodes and groups at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NetDisplacement<const D: usize> {
    nodes: Vec<Vector<D>>,
    groups: Vec<Vector<D>>,
}

impl<const D: usize> SurfaceNet<D> {
    /// Nodes at `place` with the areas `area`, about `spacing` apart; the displacement of the first of them begins with coordinate
    /// number `first` of all bodies. Nodes without area carry nothing.
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

    /// True when there are none.
    pub fn is_empty(&self) -> bool {
        self.place.is_empty()
    }

    /// Places of the nodes at rest.
    pub fn places(&self) -> &[Vector<D>] {
        &self.place
    }

    /// Displacements where the coordinates of all bodies are `jets`.
    pub fn displacement(&self, jets: &[Jet]) -> NetDisplacement<D> {
        let nodes = self.of(jets, |jet| jet.value);
        let group =
            |g: &Group<D>| g.members.iter().fold(Vector::ZERO, |sum, (k, part)| sum + nodes[*k as usize] * *part);
        let groups = self.levels.iter().flat_map(|l| l.groups.iter().map(group)).collect();
        NetDisplacement { nodes, groups }
    }

    /// What `part` takes of the coordinates of all nodes.
    pub fn of(&self, jets: &[Jet], part: impl Fn(&Jet) -> f64) -> Vec<Vector<D>> {
        let of = |k: usize, d: usize| jets.get(self.first + k * D + d).map_or(0.0, &part);
        (0..self.len()).map(|k| Vector::from_fn(|d| of(k, d))).collect()
    }

    /// How the point `x` of the surface goes, where the normal is `normal`, with the nodes.
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

    /// How the point `x` away from the surface goes with the groups.
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
                // smooth, with two derivatives at the end (Wendland 1995)
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

    /// Where nodes take a point of the surface: what the quantities `nodes` of theirs are there.
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

/// The weights of nodes at their offsets in the value at the offset zero.
fn fitted<const D: usize>(nodes: &[(u32, Vector<D>, f64)], basis: Vec<Basis>) -> Carried<D> {
    let of_values: Vec<f64> = nodes.iter().flat_map(|(_, _, w)| [*w; D]).collect();
    let (all, width) = (weights(basis, &of_values), of_values.len());
    let block = |k: usize| std::array::from_fn(|r| std::array::from_fn(|c| all[r * width + k * D + c]));
    Carried { parts: nodes.iter().enumerate().map(|(k, node)| (node.0, block(k))).collect() }
}

/// The same for α + βz in the plane, with α the mean of the values and β their covariance with z over its variance.
fn turned<const D: usize>(nodes: &[(u32, Vector<D>, f64)]) -> Carried<D> {
    let total: f64 = nodes.iter().map(|n| n.2).sum();
    let mean = nodes.iter().fold(Vector::ZERO, |sum, (_, z, w)| sum + *z * (w / total));
    let variance: f64 = nodes.iter().map(|(_, z, w)| w * (*z - mean).norm_squared()).sum();
    let part = |(k, z, w): &(u32, Vector<D>, f64)| {
        // w/Σw − w m conj(z − m)/S, a complex number that turns and stretches
        let (d, over) = (*z - mean, if variance > 0.0 { w / variance } else { 0.0 });
        let re = w / total - over * (mean[0] * d[0] + mean[1] * d[1]);
        let im = -over * (mean[1] * d[0] - mean[0] * d[1]);
        let block = [[re, -im], [im, re]];
        (*k, std::array::from_fn(|r| std::array::from_fn(|c| block[r][c])))
    };
    Carried { parts: nodes.iter().map(part).collect() }
}

/// Values of a field at the nodes, and at the offset zero.
fn field<const D: usize>(nodes: &[(u32, Vector<D>, f64)], f: impl Fn(&Vector<D>) -> Vector<D>) -> Basis {
    Basis { at_nodes: nodes.iter().flat_map(|(_, d, _)| f(d).0).collect(), asked: f(&Vector::ZERO).0.to_vec() }
}

/// Shifts, small rotations and the stretch alike on all sides: α + βz in the plane.
fn rigid<const D: usize>(nodes: &[(u32, Vector<D>, f64)]) -> Vec<Basis> {
    let mut all: Vec<Basis> = (0..D).map(|a| field(nodes, |_| Vector::axis(a))).collect();
    for (a, b) in (0..D).flat_map(|a| (0..a).map(move |b| (a, b))) {
        all.push(field(nodes, |d| Vector::axis(a) * d[b] - Vector::axis(b) * d[a]));
    }
    all.push(field(nodes, |d| *d));
    all
}

/// The same with parabolas along the surface.
fn along_surface<const D: usize>(nodes: &[(u32, Vector<D>, f64)], normal: &Vector<D>) -> Vec<Basis> {
    let mut all = rigid(nodes);
    if D == 2 {
        // γz²
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

/// Two unit vectors along a surface in space; in the plane the first of them alone has a meaning.
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
