//! Linearisation of the first-order scheme.
//!
//! −∂R_i/∂U_i = Σ_j [−a_ij·A(q_i) + |s_ij|/(2V_i) |A|(q̄)], −∂R_i/∂U_j = a_ij·A(q_j) − |s_ij|/(2V_i) |A|(q̄), with A·n = ∂F·n/∂U
//! and |A| Roe's matrix with rounded eigenvalues. A wall state follows the particle in front of it: its column is folded into
//! the row with the mirror that removes the normal velocity.
use super::block::Block;
use super::edge_blocks::edge_blocks;
use super::edge_flux::half_face;
use super::fluid::{Fluid, Work};
use super::frame::Frame;
use super::viscous::WallCondition;
use crate::math::Vector;
use crate::math::block_matrix::{BlockMatrix, Rows};
use crate::physics::riemann::rounded;
use crate::physics::{Gas, Primitive, n_variables};

/// Fraction of the sound speed below which eigenvalues are rounded: keeps diagonal blocks invertible where the flow stops.
const ROUNDING: f64 = 0.1;

/// ∂(F·n)/∂U at the state `q`.
#[inline(always)]
pub fn flux_jacobian<const D: usize>(gas: &Gas, q: &Primitive<D>, n: &Vector<D>) -> Block {
    let g1 = gas.gamma - 1.0;
    let (v, vn) = (&q.velocity, q.velocity.dot(n));
    let (phi, h) = (0.5 * g1 * v.norm_squared(), gas.total_enthalpy(q));
    let e = D + 1;
    let mut a = [[0.0; 5]; 5];
    for d in 0..D {
        a[0][1 + d] = n[d];
        a[1 + d][0] = n[d] * phi - v[d] * vn;
        for c in 0..D {
            a[1 + d][1 + c] = v[d] * n[c] - g1 * v[c] * n[d];
        }
        a[1 + d][1 + d] += vn;
        a[1 + d][e] = g1 * n[d];
        a[e][1 + d] = h * n[d] - g1 * v[d] * vn;
    }
    a[e][0] = vn * (phi - h);
    a[e][e] = gas.gamma * vn;
    a
}

/// |λ| of the entropy wave, what the mean of both acoustic ones is above it, and half of their difference over the speed of sound,
/// in a flow of the velocity `vn` across something that moves by `drift`.
#[inline(always)]
pub(super) fn rounded_speeds(c: f64, vn: f64, drift: f64) -> [f64; 3] {
    let fix = |x: f64| rounded(x.abs(), ROUNDING * c);
    let (l1, l2, l3) = (fix(vn - drift), fix(vn - drift + c), fix(vn - drift - c));
    [l1, 0.5 * (l2 + l3) - l1, 0.5 * (l2 - l3) / c]
}

/// |A − drift| across the unit normal `n` at the state `q`, eigenvalues rounded off below a fraction of the sound speed.
///
/// With |λ| of the shear and entropy waves taken out, the rest is a matrix of rank two (Turkel 1999, eq. 3.14).
#[inline(always)]
pub fn dissipation_matrix<const D: usize>(gas: &Gas, q: &Primitive<D>, n: &Vector<D>, drift: f64) -> Block {
    let c = gas.sound_speed(q);
    let g1 = gas.gamma - 1.0;
    let (v, vn) = (&q.velocity, q.velocity.dot(n));
    let [l1, a, b] = rounded_speeds(c, vn, drift);
    let (phi, h, e) = (0.5 * v.norm_squared(), gas.total_enthalpy(q), D + 1);
    // rows: pressure change / c² and normal momentum change; columns: what they carry
    let mut pressure = [0.0; 5];
    let mut normal = [0.0; 5];
    pressure[0] = g1 * phi;
    normal[0] = -vn;
    let mut carry = [0.0; 5];
    let mut push = [0.0; 5];
    carry[0] = 1.0;
    for d in 0..D {
        pressure[1 + d] = -g1 * v[d];
        normal[1 + d] = n[d];
        carry[1 + d] = v[d];
        push[1 + d] = n[d];
    }
    pressure[e] = g1;
    carry[e] = h;
    push[e] = vn;
    let mut m = [[0.0; 5]; 5];
    for r in 0..n_variables(D) {
        for k in 0..n_variables(D) {
            m[r][k] = a * (carry[r] * pressure[k] / (c * c) + push[r] * normal[k])
                + b * (push[r] * pressure[k] + carry[r] * normal[k]);
        }
        m[r][r] += l1;
    }
    m
}

/// Fills `matrix` from the states in `work`.
pub fn assemble<const D: usize>(fluid: &Fluid<D>, frame: &Frame<D>, work: &Work<D>, matrix: &mut BlockMatrix) {
    let (op, cloud) = (&frame.discretisation.operators, &frame.discretisation.cloud);
    matrix.assemble(|k, rows| {
        edge_blocks(fluid, (frame, work), (op.edges(k), op.weights(k)), rows);
        if fluid.conservative {
            for face in op.wall_faces(k) {
                let i = face.i as usize;
                let half = half_face(cloud.volume[i], &face.area);
                let mut push = wall_jacobian(&fluid.gas, &work.state[i], &half);
                (0..n_variables(D)).for_each(|k| push[k][k] += frame.velocity_of(face.wall as usize).dot(&half));
                rows.add(i, i, |r, c| 2.0 * push[r][c]);
            }
            fluid.add_viscous_walls((frame, work), op.wall_faces(k), rows);
        }
        if fluid.isentropic {
            op.parts[k].clone().for_each(|i| fluid.hold_entropy_block((frame, work), i, rows));
        }
    });
}

/// Adds the block of `column`, a wall, an outer particle or an image, to `row`: to the particle that rules it.
#[inline(always)]
pub(super) fn couple<const D: usize>(
    fluid: &Fluid<D>,
    rows: &mut Rows<'_>,
    (frame, work): (&Frame<D>, &Work<D>),
    (row, column): (usize, usize),
    coupling: impl Fn(usize, usize) -> f64,
) {
    let cloud = &frame.discretisation.cloud;
    if cloud.interface_range().contains(&column) {
        let wall = &cloud.interface[column - cloud.n_fluid];
        let slips = fluid.viscous_model.as_ref().is_none_or(|f| f.wall_condition(wall.body) == WallCondition::Slip);
        match slips {
            true => rows.add(row, row, |r, c| folded(&coupling, &wall.normal, r, c)),
            false => {
                let ends = (&work.state[row].velocity, &work.state[column].velocity);
                rows.add(row, row, |r, c| no_slip_entry(&coupling, ends, r, c));
            }
        }
    } else if column >= cloud.n_real() {
        let image = cloud.ghosts[column - cloud.n_real()];
        let sign = cloud.transforms[image.transform as usize].sign;
        let flip = |c: usize| if (1..=D).contains(&c) { sign[c - 1] } else { 1.0 };
        if (image.source as usize) < cloud.n_fluid {
            rows.add(row, image.source as usize, |r, c| coupling(r, c) * flip(c));
        }
    }
}

/// −∂/∂U of (0, pressure · n, 0) − F·n, the wall pressure taken to be that of the particle.
fn wall_jacobian<const D: usize>(gas: &Gas, q: &Primitive<D>, n: &Vector<D>) -> Block {
    let mut m = flux_jacobian(gas, q, n).map(|row| row.map(|x| -x));
    let g1 = gas.gamma - 1.0;
    for d in 0..D {
        m[1 + d][0] += n[d] * 0.5 * g1 * q.velocity.norm_squared();
        for c in 0..D {
            m[1 + d][1 + c] -= n[d] * g1 * q.velocity[c];
        }
        m[1 + d][D + 1] += n[d] * g1;
    }
    m
}

/// Entry (r, c) of coupling · P, where P removes the normal velocity of the particle in front of the wall.
fn folded<const D: usize>(coupling: &impl Fn(usize, usize) -> f64, normal: &Vector<D>, r: usize, c: usize) -> f64 {
    if !(1..=D).contains(&c) {
        return coupling(r, c);
    }
    let along: f64 = (0..D).map(|d| coupling(r, 1 + d) * normal[d]).sum();
    coupling(r, c) - along * normal[c - 1]
}

/// Entry (r, c) of coupling · P, where P gives density and pressure of the particle in front of a wall, moving with v, to a
/// state with the velocity w of the wall.
fn no_slip_entry<const D: usize>(
    coupling: &impl Fn(usize, usize) -> f64,
    (v, w): (&Vector<D>, &Vector<D>),
    r: usize,
    c: usize,
) -> f64 {
    let energy = coupling(r, D + 1);
    match c {
        0 => {
            let carried: f64 = (0..D).map(|d| coupling(r, 1 + d) * w[d]).sum();
            coupling(r, 0) + carried + 0.5 * (v.norm_squared() + w.norm_squared()) * energy
        }
        c if c <= D => -energy * v[c - 1],
        _ => energy,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Conserved;
    use crate::physics::riemann::{Roe, UpwindFlux};

    const AIR: Gas = Gas { gamma: 1.4 };

    fn bump(u: &Conserved<3>, k: usize, h: f64) -> Primitive<3> {
        let mut row = [0.0; 5];
        u.store(&mut row);
        row[k] += h;
        AIR.primitive(&Conserved::load(&row))
    }

    fn difference(f: impl Fn(f64) -> Conserved<3>) -> [f64; 5] {
        let h = 1e-6;
        let d = f(h).plus(-1.0, &f(-h)).times(0.5 / h);
        let mut row = [0.0; 5];
        d.store(&mut row);
        row
    }

    #[test]
    fn jacobian_is_the_derivative_of_the_flux() {
        let q = Primitive { density: 1.2, velocity: Vector([0.3, -0.5, 0.2]), pressure: 0.8 };
        let (n, u) = (Vector([0.2, 0.7, -0.4]), AIR.conserved(&q));
        let a = flux_jacobian(&AIR, &q, &n);
        for k in 0..5 {
            let d = difference(|h| AIR.flux(&bump(&u, k, h), &n));
            (0..5).for_each(|r| assert!((a[r][k] - d[r]).abs() < 1e-8, "{r} {k}"));
        }
    }

    #[test]
    fn dissipation_matrix_is_that_of_the_roe_flux() {
        let q = Primitive { density: 1.2, velocity: Vector([0.6, -0.5, 0.2]), pressure: 0.8 };
        let (n, u) = (Vector([0.6, 0.0, 0.8]), AIR.conserved(&q));
        let m = dissipation_matrix(&AIR, &q, &n, 0.0);
        for k in 0..5 {
            let d = difference(|h| {
                let r = bump(&u, k, h);
                Roe.across(&AIR, &q, &r, &n).plus(-0.5, &AIR.flux(&r, &n)).times(-2.0)
            });
            (0..5).for_each(|r| assert!((m[r][k] - d[r]).abs() < 1e-5, "{r} {k} {} {}", m[r][k], d[r]));
        }
    }
}
