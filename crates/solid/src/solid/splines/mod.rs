//! Natural modes of a 3-D solid with B-splines.
//!
//! K φ = ω² M φ by the Ritz method. The displacements are tensor products of cubic B-splines on a lattice of cells over
//! the bounding box of the body; the energies are integrals over the body itself, evaluated along rays through its
//! surface (`points`). Because the body is not filled with particles, sharp edges, thin tails and plates much thinner
//! than a cell need no special treatment: cubic splines represent the bending of a plate with a single cell through the
//! thickness. The frequencies are upper bounds of those on an infinitely fine lattice. A second, coarser lattice gives
//! an estimate of the remaining error (Höllig 2003, *Finite Element Methods with B-Splines*; Parvizian, Düster and Rank
//! 2007, *Computational Mechanics* 41, for cells that are filled in part). See the book page
//! `solid-particles`.
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

/// Default number of cells of the lattice: in the plane of the two longest sides of the bounding box, or in all of it.
const CELLS: f64 = 500.0;
/// Ratio of the cell sizes of the second, coarser lattice and the first, for the error estimate.
const COARSER: f64 = 1.5;
/// Shift added to K in units of M (speed of shear waves / length)², so that free bodies can be factored.
const SHIFT: f64 = 1e-3;
/// Fraction of the same unit below which ω² belongs to a rigid-body mode.
const RIGID: f64 = 1e-7;

/// A box in which the body is constrained.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldBox {
    /// Smallest and largest coordinate of the box along each axis. All parts of the body in it are constrained, inside
    /// and surface.
    pub place: [[f64; 2]; 3],
    /// True for the axes along which the displacement is zero.
    pub fixed: [bool; 3],
}

/// A plane of symmetry normal to an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// Index of the axis.
    pub axis: usize,
    /// Coordinate of the plane on this axis.
    pub place: f64,
    /// True when the body lies on the side of smaller coordinates.
    pub below: bool,
}

/// A body whose natural modes are computed.
pub struct Body<'a> {
    /// Its closed surface.
    pub surface: &'a Surface<3>,
    /// Materials; the modes use their elastic moduli at small strains.
    pub materials: &'a [Material],
    /// Index of the material at a point.
    pub material: &'a (dyn Fn(&Vector<3>) -> usize + Sync),
    /// Boxes in which the body is constrained.
    pub held: &'a [HeldBox],
    /// Planes of symmetry.
    pub mirrors: &'a [Mirror],
    /// Cell size; `None`: chosen from the size of the body.
    pub size: Option<f64>,
}

impl Body<'_> {
    /// True for points more than `slack` beyond a plane of symmetry.
    fn beyond(&self, x: &Vector<3>, slack: f64) -> bool {
        let far = |m: &Mirror| if m.below { x[m.axis] - m.place } else { m.place - x[m.axis] };
        self.mirrors.iter().any(|m| far(m) > slack)
    }
}

/// A natural mode.
#[derive(Clone, Debug)]
pub struct Mode {
    /// Angular frequency [rad/s]; 0 for a rigid-body mode.
    pub omega: f64,
    /// Relative difference from the frequency on the coarser lattice.
    pub error: f64,
    /// Generalised mass ∫ ρ φ² dV (kg).
    pub generalised_mass: f64,
    coefficients: Vec<f64>,
}

/// Natural modes of a body.
pub struct SplineModes {
    /// The modes in ascending order of frequency, with unit generalised mass.
    pub modes: Vec<Mode>,
    /// Mass (kg) of the body on this side of the planes of symmetry.
    pub mass: f64,
    /// Volume by integration along rays.
    pub volume: f64,
    /// Number of spline coefficients.
    pub unknowns: usize,
    /// Cell size.
    pub size: f64,
    space: Space,
}

/// Reason why modes could not be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplineModesError {
    /// No ray passes through the inside of the body.
    #[error("no ray passes through the inside of the body: is its surface closed?")]
    Hollow,
    /// No part of the body lies in the box of a support.
    #[error("support {} contains no part of the body", .number + 1)]
    Unsupported {
        /// Index of the support.
        number: usize,
    },
    /// There are too many unknowns.
    #[error("the body needs {unknowns} spline coefficients, but modes are computed for at most {most}")]
    TooLarge {
        /// Number of unknowns.
        unknowns: usize,
        /// Greatest number of unknowns.
        most: usize,
    },
    /// The stiffness matrix is not positive definite.
    #[error(
        "the stiffness of the body is not positive definite: its elastic constants permit deformation without energy"
    )]
    Soft,
}

/// Computes the lowest `count` modes. Fails when the surface is open, a support holds nothing, or the matrices are too
/// large or not positive definite.
pub fn modes(body: &Body<'_>, count: usize) -> Result<SplineModes, SplineModesError> {
    let size = body.size.unwrap_or_else(|| usual_size(body));
    let mut found = on_lattice(body, size, count)?;
    let coarse = on_lattice(body, COARSER * size, count)?;
    for (mode, other) in found.modes.iter_mut().zip(&coarse.modes) {
        mode.error = if mode.omega > 0.0 { (other.omega / mode.omega - 1.0).abs() } else { 0.0 };
    }
    Ok(found)
}

/// Default cell size: cubic cells, except across thin bodies.
fn usual_size(body: &Body<'_>) -> f64 {
    let mut sides = body.surface.bounds().extent().0;
    sides.sort_by(|a, b| b.total_cmp(a));
    let flat = (sides[0] * sides[1] / CELLS).sqrt();
    if sides[2] < 1.5 * flat { flat } else { (sides[0] * sides[1] * sides[2] / CELLS).cbrt() }
}

fn on_lattice(body: &Body<'_>, size: f64, count: usize) -> Result<SplineModes, SplineModesError> {
    let matrices = Matrices::new(body, size)?;
    let Matrices { space, volume, mass_of_body, .. } = &matrices;
    let n = 3 * space.live;
    let speed = body.materials.iter().map(Material::shear_wave_speed).fold(0.0, f64::max);
    let scale = (speed / body.surface.bounds().extent().norm()).powi(2);
    let factors = matrices.factor(SHIFT * scale).ok_or(SplineModesError::Soft)?;
    let count = count.min(n);
    let (values, vectors) =
        lowest(n, count, |x| matrices.inertia(x), |block| factors.solve(block)).ok_or(SplineModesError::Soft)?;
    let modes = values.iter().zip(vectors).map(|(value, coefficients)| {
        let square = 1.0 / value - SHIFT * scale;
        let omega = if square > RIGID * scale { square.sqrt() } else { 0.0 };
        Mode { omega, error: 0.0, generalised_mass: 1.0, coefficients }
    });
    Ok(SplineModes {
        modes: modes.collect(),
        mass: *mass_of_body,
        volume: *volume,
        unknowns: n,
        size,
        space: matrices.space.clone(),
    })
}

/// The largest eigenvalues θ of x ↦ solve(M x) with M-orthonormal eigenvectors, by block iteration with Rayleigh-Ritz
/// projection (Bathe and Wilson 1972). M is not diagonal here, so that its root is not available to make the operator
/// symmetric for [`crate::math::lanczos`]. `None` when the iteration does not converge.
fn lowest(
    n: usize,
    count: usize,
    inertia: impl Fn(&[f64]) -> Vec<f64>,
    solve: impl Fn(&mut [f64]),
) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    /// Tolerance for changes of the eigenvalues, relative to themselves and to the largest.
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

/// Makes the vectors M-orthonormal and returns M times them; `None` when they are linearly dependent.
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

impl SplineModes {
    /// Displacement of mode `k` at the point `x` in the body or near it.
    pub fn displacement(&self, k: usize, x: &Vector<3>) -> Vector<3> {
        self.space.value(&self.modes[k].coefficients, x)
    }

    /// The integral ∫ ρ f·φ dV with mode `k`.
    pub fn along(&self, k: usize, f: impl Fn(&Vector<3>) -> Vector<3>) -> f64 {
        self.space.masses().map(|(x, mass)| mass * f(x).dot(&self.displacement(k, x))).sum()
    }

    /// Divides mode `k` by `by` and its generalised mass accordingly.
    pub fn scale(&mut self, k: usize, by: f64) {
        let mode = &mut self.modes[k];
        mode.coefficients.iter_mut().for_each(|c| *c /= by);
        mode.generalised_mass /= by * by;
    }
}

/// At most `count` points on the surface of a body, on this side of its planes of symmetry, as far apart as possible.
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
