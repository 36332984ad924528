//! Natural modes of a solid in space among splines.
//!
//! K φ = ω² M φ by Ritz's method: displacements are tensor products of cubic B-splines on a lattice of cells over the body's box,
//! and energies are integrals over the body itself, taken along rays through its surface (`points`). No cloud fills the body, so that
//! sharp edges, thin tails and plates much thinner than a cell are as good as thick parts: cubic splines hold the bending of a plate
//! with one cell through the thickness. Frequencies are upper bounds of those of the lattice's limit, and a second, coarser lattice
//! says how far they still are from it (Höllig 2003, *Finite Element Methods with B-Splines*; Parvizian, Düster and Rank 2007,
//! *Computational Mechanics* 41, for cells that a body fills in part). Book page `solid-particles`.
mod assembly;
mod basis;
mod points;
#[cfg(test)]
mod tests;

use crate::geometry::Surface;
use crate::math::Vector;
use crate::math::lanczos::start;
use crate::math::reduce::dot;
use crate::math::symmetric;
use crate::physics::solid::Material;
use assembly::{Matrices, Space};

/// Cells of the lattice across the body, where nothing else is said: those of its box in the plane of its two longest sides, or in all
/// of it.
const CELLS: f64 = 500.0;
/// How much coarser the second lattice is, by which errors are estimated.
const COARSER: f64 = 1.5;
/// Part of (speed of shear waves over length)² that is added to K over M, so that free bodies can be factored.
const SHIFT: f64 = 1e-3;
/// Part of the same below which ω² is that of a motion as a whole.
const RIGID: f64 = 1e-7;

/// Where a body is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Smallest and largest coordinates of a box: what is in it is held, the surface as the inside.
    pub place: [[f64; 2]; 3],
    /// True for axes along which it is held.
    pub fixed: [bool; 3],
}

/// A plane across an axis beyond which the body is its mirror image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// The axis.
    pub axis: usize,
    /// The plane's coordinate on it.
    pub place: f64,
    /// The body at hand is on the side of smaller coordinates.
    pub below: bool,
}

/// A body of which modes are sought.
pub struct Body<'a> {
    /// Its surface, closed.
    pub surface: &'a Surface<3>,
    /// Materials; modes are those of their small strains about rest.
    pub materials: &'a [Material],
    /// Number of the material at a point.
    pub material: &'a (dyn Fn(&Vector<3>) -> usize + Sync),
    /// Where it is held.
    pub held: &'a [Held],
    /// Planes of symmetry.
    pub mirrors: &'a [Mirror],
    /// Length of a cell; `None`: by the size of the body.
    pub size: Option<f64>,
}

impl Body<'_> {
    /// True for points farther than `slack` beyond a plane of symmetry.
    fn beyond(&self, x: &Vector<3>, slack: f64) -> bool {
        let far = |m: &Mirror| if m.below { x[m.axis] - m.place } else { m.place - x[m.axis] };
        self.mirrors.iter().any(|m| far(m) > slack)
    }
}

/// A natural mode.
#[derive(Clone, Debug)]
pub struct Mode {
    /// Angular frequency; 0 where the body moves as a whole.
    pub omega: f64,
    /// Relative difference from the frequency on a coarser lattice.
    pub error: f64,
    /// ∫ ρ φ² dV.
    pub generalised_mass: f64,
    coefficients: Vec<f64>,
}

/// Modes of a body.
pub struct Found {
    /// The lowest, from the slowest on, of unit generalised mass.
    pub modes: Vec<Mode>,
    /// Mass of the body on this side of the planes of symmetry.
    pub mass: f64,
    /// Its volume by rays.
    pub volume: f64,
    /// Number of coefficients.
    pub unknowns: usize,
    /// Length of a cell.
    pub size: f64,
    space: Space,
}

/// Why there are no modes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// Rays found no inside.
    #[error("no ray meets the inside of the body: is its surface closed?")]
    Hollow,
    /// A support without a part of the body.
    #[error("support {} is where nothing of the body is", .number + 1)]
    Unsupported {
        /// Which.
        number: usize,
    },
    /// Too many cells.
    #[error("{unknowns} coefficients of splines are more than the {most} of which modes are found")]
    TooLarge {
        /// How many there are.
        unknowns: usize,
        /// How many there may be.
        most: usize,
    },
    /// K is not positive.
    #[error("the stiffness of the body is not positive: its elastic constants allow deformation that stores no energy")]
    Soft,
}

/// The lowest `count` modes.
pub fn modes(body: &Body<'_>, count: usize) -> Result<Found, Unfit> {
    let size = body.size.unwrap_or_else(|| usual_size(body));
    let mut found = on_lattice(body, size, count)?;
    let coarse = on_lattice(body, COARSER * size, count)?;
    for (mode, other) in found.modes.iter_mut().zip(&coarse.modes) {
        mode.error = if mode.omega > 0.0 { (other.omega / mode.omega - 1.0).abs() } else { 0.0 };
    }
    Ok(found)
}

/// Cells as long in all directions, but for thin ones.
fn usual_size(body: &Body<'_>) -> f64 {
    let mut sides = body.surface.bounds().extent().0;
    sides.sort_by(|a, b| b.total_cmp(a));
    let flat = (sides[0] * sides[1] / CELLS).sqrt();
    if sides[2] < 1.5 * flat { flat } else { (sides[0] * sides[1] * sides[2] / CELLS).cbrt() }
}

fn on_lattice(body: &Body<'_>, size: f64, count: usize) -> Result<Found, Unfit> {
    let matrices = Matrices::new(body, size)?;
    let Matrices { space, volume, mass_of_body, .. } = &matrices;
    let n = 3 * space.live;
    let speed = body.materials.iter().map(Material::shear_wave_speed).fold(0.0, f64::max);
    let scale = (speed / body.surface.bounds().extent().norm()).powi(2);
    let factors = matrices.factor(SHIFT * scale).ok_or(Unfit::Soft)?;
    let count = count.min(n);
    let (values, vectors) =
        lowest(n, count, |x| matrices.inertia(x), |block| factors.solve(block)).ok_or(Unfit::Soft)?;
    let modes = values.iter().zip(vectors).map(|(value, coefficients)| {
        let square = 1.0 / value - SHIFT * scale;
        let omega = if square > RIGID * scale { square.sqrt() } else { 0.0 };
        Mode { omega, error: 0.0, generalised_mass: 1.0, coefficients }
    });
    Ok(Found {
        modes: modes.collect(),
        mass: *mass_of_body,
        volume: *volume,
        unknowns: n,
        size,
        space: matrices.space.clone(),
    })
}

/// The largest eigenvalues θ of x ↦ solve(M x), M-orthonormal vectors with them: block iteration with Rayleigh and Ritz (Bathe and
/// Wilson 1972). M is no diagonal here, whose root would make the operator symmetric for [`crate::math::lanczos`]. `None` where it does
/// not settle.
fn lowest(
    n: usize,
    count: usize,
    inertia: impl Fn(&[f64]) -> Vec<f64>,
    solve: impl Fn(&mut [f64]),
) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    /// What eigenvalues may still change by, over themselves and over the largest.
    const TOLERANCE: [f64; 2] = [1e-11, 1e-14];
    const MOST_ITERATIONS: usize = 200;
    let m = (2 * count + 4).max(count + 8).min(n);
    let mut x: Vec<Vec<f64>> = (0..m).map(|k| start(n, k)).collect();
    let mut before = vec![0.0; m];
    for _ in 0..MOST_ITERATIONS {
        let mut images = orthonormal(&mut x, &inertia)?.concat();
        solve(&mut images);
        let y: Vec<&[f64]> = images.chunks_exact(n).collect();
        let my: Vec<Vec<f64>> = y.iter().map(|y| inertia(y)).collect();
        let even = |i: usize, j: usize| 0.5 * (dot(&x[i], &my[j]) + dot(&x[j], &my[i]));
        let projected: Vec<f64> = (0..m * m).map(|k| even(k / m, k % m)).collect();
        let eigen = symmetric::eigen(&projected, m)?;
        let combined = |k: usize, of: &dyn Fn(usize) -> Vec<f64>| {
            let mut sum = vec![0.0; n];
            for i in 0..m {
                let part = eigen.vectors[k][i];
                sum.iter_mut().zip(of(i)).for_each(|(s, y)| *s += part * y);
            }
            sum
        };
        let values: Vec<f64> = eigen.values.iter().rev().copied().collect();
        let settled = values
            .iter()
            .zip(&before)
            .take(count)
            .all(|(v, b)| (v - b).abs() <= TOLERANCE[0] * v + TOLERANCE[1] * values[0]);
        if settled {
            let vectors = (0..m).rev().take(count).map(|k| combined(k, &|i| x[i].clone())).collect();
            return Some((values[..count].to_vec(), vectors));
        }
        x = (0..m).rev().map(|k| combined(k, &|i| y[i].to_vec())).collect();
        before = values;
    }
    None
}

/// Makes vectors M-orthonormal; gives M times them.
fn orthonormal(x: &mut [Vec<f64>], inertia: &impl Fn(&[f64]) -> Vec<f64>) -> Option<Vec<Vec<f64>>> {
    let mut images: Vec<Vec<f64>> = Vec::new();
    for k in 0..x.len() {
        for _ in 0..2 {
            for (j, image) in images.iter().enumerate() {
                let part = dot(&x[k], image);
                let (done, rest) = x.split_at_mut(k);
                rest[0].iter_mut().zip(&done[j]).for_each(|(v, o)| *v -= part * o);
            }
        }
        let mut image = inertia(&x[k]);
        let norm = dot(&x[k], &image).sqrt();
        if !(norm > 0.0) {
            return None;
        }
        x[k].iter_mut().chain(&mut image).for_each(|v| *v /= norm);
        images.push(image);
    }
    Some(images)
}

impl Found {
    /// Displacement of mode number `k` at a point of the body or near it.
    pub fn displacement(&self, k: usize, x: &Vector<3>) -> Vector<3> {
        self.space.value(&self.modes[k].coefficients, x)
    }

    /// ∫ ρ f·φ dV with mode number `k`.
    pub fn along(&self, k: usize, f: impl Fn(&Vector<3>) -> Vector<3>) -> f64 {
        self.space.masses().map(|(x, mass)| mass * f(x).dot(&self.displacement(k, x))).sum()
    }

    /// Divides mode number `k` by `by`.
    pub fn scale(&mut self, k: usize, by: f64) {
        let mode = &mut self.modes[k];
        mode.coefficients.iter_mut().for_each(|c| *c /= by);
        mode.generalised_mass /= by * by;
    }
}

/// At most `count` points of the surface of a body, on this side of its planes of symmetry, as far from one another as they can be.
pub fn spread(body: &Body<'_>, count: usize) -> Vec<Vector<3>> {
    let surface = body.surface;
    let size = (surface.area() / (20.0 * count as f64)).sqrt();
    let mut all = Vec::new();
    points::of_surface(surface, 2.0 * size, |p| all.push(p.x));
    all.extend(surface.vertices.iter().copied());
    let beyond = |x: &Vector<3>, m: &Mirror| if m.below { x[m.axis] > m.place } else { x[m.axis] < m.place };
    all.retain(|x| !body.mirrors.iter().any(|m| beyond(x, m)));
    let mut far = vec![f64::INFINITY; all.len()];
    let mut chosen = Vec::new();
    let mut next = 0;
    while chosen.len() < count.min(all.len()) && far[next] > 0.0 {
        let x = all[next];
        chosen.push(x);
        far.iter_mut().zip(&all).for_each(|(f, y)| *f = f.min((*y - x).norm_squared()));
        next = (0..all.len()).fold(0, |best, i| if far[i] > far[best] { i } else { best });
    }
    chosen
}
