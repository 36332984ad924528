//! Noise of measured surfaces, and the curvature of the shape that they follow.
//!
//! The vertices of a scan are displaced by some fraction of the edge length σ/L, so that adjacent triangles turn by about 2 σ/L and
//! the curvature from corner normals is in error by σ/L², often more than the shape has. Positions and normals are therefore
//! averaged together, with area weights over the triangles around each vertex, m times. Where the normal is a linear
//! function of the position the averages satisfy it for any triangulation, so that the curvature dN̄/dx̄ keeps its value
//! over √m triangles, while that of the noise decreases as m^(-3/2). A curvature that decreases over a large part of the
//! surface is noise. The one that is used is the least over all scales: it holds over one triangle and over several.
use super::shell::{Joint, Shell};
use super::simplex;
use crate::math::Vector;

/// Number of triangles below which a surface is not a scan.
const FEWEST: usize = 500;
/// Turn of an edge (rad) below which its triangles are coplanar, and the greatest fraction of such edges in a scan: 0.11 in
/// isosurfaces through tetrahedra, 0.6 in a surface of cubes.
const COPLANAR: (f64, f64) = (1e-4, 0.2);
/// Averages after which the curvature is compared with that of the triangles.
const TRIALS: [usize; 2] = [4, 8];
/// A curvature that exceeds the averaged one by this factor on more than this fraction of the area is noise. Smooth
/// surfaces of long triangles have 0.11, spheres with displacements of 1.4 % of an edge 0.39.
const EXCESS: (f64, f64) = (1.2, 0.25);
/// Averages are doubled until the curvature decreases by more than this fraction on less than a quarter of the area.
const SETTLED: f64 = 0.02;
/// Greatest number of averages.
const MOST: usize = 32;
/// Number of median changes by which the curvature is reduced: most of a normal distribution is within three of them.
const CERTAIN: f64 = 3.0;
/// Greatest fraction by which it is reduced: where much of a surface is flat, the changes are no measure for the rest.
const UNCERTAIN: f64 = 0.1;
/// Edges are sharp where they turn by more than this many standard deviations of the noise.
const SHARP: f64 = 5.0;
/// Median of the magnitude of a normal distribution, over its standard deviation.
const MEDIAN: f64 = 0.6745;
/// Standard deviation of the turn of edges over that of the vertices divided by the edge length: an edge turns by
/// (z_c + z_d - z_a - z_b) / h, where h = √3/2 of the edge length is the height of the triangles.
const TURN: f64 = 2.31;

/// Noise of the vertices of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Noise {
    /// Median ratio of the curvature over single triangles to that over several of them.
    excess: f64,
    /// Median turn of the edges (rad).
    turn: f64,
    /// Standard deviation of the vertices along the normal.
    deviation: f64,
    /// Number of averages.
    rounds: usize,
    /// Median change of the curvature by the last doubling of the averages, over the curvature: what is left of the noise.
    scatter: f64,
}

impl Noise {
    /// Turn above which an edge is sharp, not less than `crease` (rad).
    pub(super) fn crease(&self, crease: f64) -> f64 {
        crease.max(SHARP * self.turn / MEDIAN)
    }

    /// The note about the noise of a surface.
    pub(super) fn told(&self, file: &str, crease: f64) -> String {
        let off = match self.deviation {
            d if d > 0.0 => format!("; vertices are about {d:.1e} off"),
            _ => String::new(),
        };
        format!(
            "{file}: the surface is noisy: its curvature over single triangles is {:.1} times (median) that over about {:.0} of them{off}. The cloud is \
             refined by the latter, and edges are sharp from {:.0} degrees",
            self.excess,
            2.0 * (self.rounds as f64).sqrt(),
            self.crease(crease).to_degrees().min(180.0)
        )
    }
}

impl<const D: usize> Shell<D> {
    /// The noise of the vertices; `None` for a smooth surface, and where normals or curvature are known.
    pub(super) fn noise(&self, joints: &[Joint]) -> Option<Noise> {
        if D != 3 || self.elements.len() < FEWEST || self.normals.is_some() || self.curvature.is_some() {
            return None;
        }
        let coplanar = joints.iter().filter(|j| j.turn.abs() < COPLANAR.0).count();
        if coplanar as f64 > COPLANAR.1 * joints.len() as f64 {
            return None;
        }
        // creases are found with the noise, not before
        let mut means = Means::new(self, &self.corner_groups(joints.iter()));
        let (own, mut rounds) = (means.curvature(), 0);
        let mut smooth = |more: usize| {
            means.average(more - std::mem::replace(&mut rounds, more));
            means.curvature()
        };
        let mut curvature = Vec::new();
        for trial in TRIALS {
            curvature = smooth(trial);
            if self.fraction(|e| own[e].abs() > EXCESS.0 * curvature[e].abs()) < EXCESS.1 {
                return None;
            }
        }
        let (mut last, mut scatter) = (TRIALS[1], 0.0);
        while last < MOST {
            let next = smooth(2 * last);
            let falls = self.fraction(|e| (1.0 - SETTLED) * curvature[e].abs() > next[e].abs());
            scatter = median(curvature.iter().zip(&next).map(|(a, b)| (a - b).abs() / divisor(*b)));
            (last, curvature) = (2 * last, next);
            if falls < EXCESS.1 {
                break;
            }
        }
        let excess = median(own.iter().zip(&curvature).map(|(a, b)| a.abs() / divisor(*b)));
        let [turn, deviation] = self.turn_and_deviation(joints, &curvature);
        Some(Noise { excess, turn, deviation, rounds: last, scatter })
    }

    /// Median turn of the edges (rad), and the standard deviation of the vertices that it tells beside that of a shape with this curvature.
    fn turn_and_deviation(&self, joints: &[Joint], curvature: &[f64]) -> [f64; 2] {
        let length = |j: &Joint| (self.vertices[j.facet[0] as usize] - self.vertices[j.facet[1] as usize]).norm();
        let edge = joints.iter().map(length).sum::<f64>() / joints.len() as f64;
        // centres of adjacent equilateral triangles are 1/√3 of an edge apart
        let across = edge / 3f64.sqrt();
        let turn = median(joints.iter().map(|j| j.turn.abs()));
        let shape = median(curvature.iter().map(|k| k.abs() * across)).min(turn);
        [turn, (turn * turn - shape * shape).sqrt() / MEDIAN / TURN * edge]
    }

    /// Curvature of the elements of a noisy surface with these corner groups: the least over all scales, reduced by what may
    /// be left of the noise.
    pub(super) fn curvature_over_noise(&self, noise: &Noise, group: &[u32]) -> Vec<f64> {
        let mut means = Means::new(self, group);
        // magnitudes of noise do not cancel, so that those of the triangles are no less than those of the shape
        let each: Vec<f64> = means.each().iter().map(|k| k.abs()).collect();
        let mut least = self.averaged(&each);
        let (mut rounds, mut next) = (0, TRIALS[1]);
        while next <= noise.rounds {
            means.average(next - rounds);
            for (least, k) in least.iter_mut().zip(means.curvature()) {
                *least = least.abs().min(k.abs()).copysign(k);
            }
            (rounds, next) = (next, 2 * next);
        }
        let sure = 1.0 - (CERTAIN * noise.scatter).min(UNCERTAIN);
        least.iter_mut().for_each(|k| *k *= sure);
        least
    }

    /// Fraction of the area of the elements for which `holds` is true.
    fn fraction(&self, holds: impl Fn(usize) -> bool) -> f64 {
        let area = |e: usize| simplex::area_vector(&self.corners(e)).norm();
        let sum = |e: std::ops::Range<usize>| e.map(|e| (area(e), if holds(e) { area(e) } else { 0.0 }));
        let (all, own) = sum(0..self.elements.len()).fold((0.0, 0.0), |(a, b), (c, d)| (a + c, b + d));
        own / f64::max(all, f64::MIN_POSITIVE)
    }
}

/// Positions and normals averaged over the elements around the vertices, for each group of corners.
struct Means<'a, const D: usize> {
    shell: &'a Shell<D>,
    /// Groups of the corners of the elements.
    nodes: Vec<[u32; D]>,
    area: Vec<f64>,
    at: Vec<[Vector<D>; 2]>,
}

impl<'a, const D: usize> Means<'a, D> {
    fn new(shell: &'a Shell<D>, group: &[u32]) -> Self {
        let normals = shell.normals_of(group);
        let mut number = vec![u32::MAX; group.len()];
        let mut at: Vec<[Vector<D>; 2]> = Vec::new();
        let node = |e: usize, k: usize| {
            let number = &mut number[group[e * D + k] as usize];
            if *number == u32::MAX {
                *number = at.len() as u32;
                at.push([shell.vertices[shell.elements[e][k] as usize], normals[e][k]]);
            }
            *number
        };
        let nodes = nodes_of(shell.elements.len(), node);
        let area = (0..shell.elements.len()).map(|e| simplex::area_vector(&shell.corners(e)).norm()).collect();
        Self { shell, nodes, area, at }
    }

    /// Averages over the elements around each node, this many times.
    fn average(&mut self, rounds: usize) {
        let mut sum = vec![([Vector::ZERO; 2], 0.0); self.at.len()];
        for _ in 0..rounds {
            sum.fill(([Vector::ZERO; 2], 0.0));
            for (nodes, area) in self.nodes.iter().zip(&self.area) {
                let mean =
                    |q: usize| nodes.iter().fold(Vector::ZERO, |s, n| s + self.at[*n as usize][q]) * (area / D as f64);
                let mean = [mean(0), mean(1)];
                for node in nodes {
                    let entry = &mut sum[*node as usize];
                    (0..2).for_each(|q| entry.0[q] += mean[q]);
                    entry.1 += area;
                }
            }
            for (at, (sum, area)) in self.at.iter_mut().zip(&sum).filter(|(_, (_, area))| *area > 0.0) {
                *at = sum.map(|s| s * (1.0 / area));
            }
        }
    }

    /// Signed curvature of largest magnitude of every element.
    fn each(&self) -> Vec<f64> {
        let of = |nodes: &[u32; D]| {
            let corners = nodes.map(|n| self.at[n as usize][0]);
            simplex::curvature(&corners, &nodes.map(|n| self.at[n as usize][1].unit()))
        };
        self.nodes.iter().map(of).collect()
    }

    /// The same, averaged over the elements around its vertices.
    fn curvature(&self) -> Vec<f64> {
        self.shell.averaged(&self.each())
    }
}

/// Nodes of the corners of `n` elements.
fn nodes_of<const D: usize>(n: usize, mut node: impl FnMut(usize, usize) -> u32) -> Vec<[u32; D]> {
    (0..n).map(|e| std::array::from_fn(|k| node(e, k))).collect()
}

/// A magnitude that can be divided by.
fn divisor(k: f64) -> f64 {
    k.abs().max(f64::MIN_POSITIVE)
}

/// Median of numbers; zero without any.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = values.collect();
    let middle = all.len() / 2;
    if all.is_empty() { 0.0 } else { *all.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::super::primitive::{cuboid, icosphere};
    use super::*;

    /// A sphere of radius 1/2 without known normals, whose vertices are displaced along the radius by a standard deviation.
    fn ball(deviation: f64) -> Shell<3> {
        let mut shell = Shell { normals: None, curvature: None, exact: super::super::Exact::None, ..icosphere(0.5, 4) };
        let mut seed = 1_u64;
        // a sum of twelve uniform numbers is nearly normal
        let mut normal = || (0..12).map(|_| uniform(&mut seed)).sum::<f64>() - 6.0;
        shell.vertices.iter_mut().for_each(|x| *x = *x * (1.0 + 2.0 * deviation * normal()));
        shell
    }

    fn uniform(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1_u64 << 53) as f64
    }

    #[test]
    fn noise_is_measured_and_not_taken_for_curvature() {
        for deviation in [2e-3, 4e-3] {
            let shell = ball(deviation);
            let noise = shell.noise(&shell.joints()).expect("noise");
            assert!((noise.deviation / deviation - 1.0).abs() < 0.3, "{deviation} {noise:?}");
            assert!(noise.excess > 1.2 && noise.crease(0.7) >= 0.7, "{noise:?}");
            let features = shell.features();
            assert!(features.edges.is_empty(), "{} sharp edges", features.edges.len());
            // of 2 in truth
            let over = shell.fraction(|e| features.curvature[e].abs() > 2.1);
            let under = shell.fraction(|e| features.curvature[e].abs() < 1.6);
            assert!(over < 0.05 && under < 0.1, "{over} of the area above 2.1, {under} below 1.6 at {deviation}");
        }
    }

    #[test]
    fn smooth_surfaces_have_no_noise() {
        for shell in [ball(0.0), ball(1e-5), cuboid([1.0, 0.5, 0.25])] {
            assert_eq!(shell.noise(&shell.joints()), None);
        }
    }
}
