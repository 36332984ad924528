//! Linearisation of the first-order scheme.
//!
//! −∂R_i/∂U_i = Σ_j [−a_ij·A(q_i) + |s_ij|/(2V_i) |A|(q̄)], −∂R_i/∂U_j = a_ij·A(q_j) − |s_ij|/(2V_i) |A|(q̄), with A·n = ∂F·n/∂U
//! and |A| Roe's matrix with rounded eigenvalues. What edges add is in `scheme::edge_blocks`.
use super::block::Block;
use super::edge_blocks::edge_blocks;
use super::edge_flux::half_face;
use super::fluid::{Fluid, Work};
use super::frame::Frame;
use crate::math::Vector;
use crate::math::block_matrix::BlockMatrix;
use crate::physics::{Gas, Primitive, n_variables};

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Conserved;

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
}
