//! What edges add to the matrix of the linearised scheme, many at a time.
//!
//! As in [`super::edges`]: what the ends of some edges hold is gathered, a loop without branches computes the blocks of all of them,
//! and each is added to its row.
use multiversion::multiversion;

use super::edge_flux::half_face;
use super::fluid::{Fluid, Work};
use super::folded_columns::couple;
use super::frame::Frame;
use super::lanes::{LANES, Lanes, StateLanes, put, take};
use crate::cloud::{Edge, Weights};
use crate::math::Vector;
use crate::math::block_matrix::Rows;
use crate::math::blocks::array;
use crate::physics::riemann::rounded;
use crate::physics::{Gas, Primitive, n_variables};

/// Fraction of the sound speed below which eigenvalues are rounded: keeps diagonal blocks invertible where the flow stops.
const ROUNDING: f64 = 0.1;
/// Variables of gas in space, and as many numbers as a vector register takes.
const MOST: usize = 5;
const WIDE: usize = 8;
/// Room for a block whose columns are written [`WIDE`] numbers at a time.
const ROOM: usize = MOST * MOST + WIDE;

/// Some edges, and what their blocks are made of.
///
/// With the vectors (1, v, H), (0, n, v·n), (−v·n, n, 0) and (∂p/∂U) of a state, ∂(F·n)/∂U is
/// v·n + (1, v, H) ⊗ (−v·n, n, 0) + (0, n, v·n) ⊗ ∂p/∂U, and |A| is made of the same.
struct Batch<const D: usize> {
    own: [StateLanes<D>; 2],
    /// Coefficient of the flux at either end.
    face: [[Lanes; D]; 2],
    /// What the particle at either end passes of its own state as it moves.
    swept: [Lanes; 2],
    /// One over the volume of either end.
    by_volume: [Lanes; 2],
    area: [Lanes; D],
    /// Mean velocity of both ends through the area.
    drift: Lanes,
    waves: Waves<D>,
}

/// A number of every edge, single.
type Single = [f32; LANES];

/// What the blocks of some edges are made of.
struct Waves<const D: usize> {
    /// Velocity, enthalpy, and the derivative of the pressure by the density: of both ends and the mean of them.
    velocity: [[Single; D]; 3],
    enthalpy: [Single; 3],
    push: [Single; 3],
    /// The direction of the area and the velocity of the mean along it.
    normal: [Single; D],
    across: Single,
    /// Half of the area times the parts of |A| that belong to: identity, (1, v, H) ⊗ ∂p/∂U, both mixed products,
    /// (0, n, v·n) ⊗ (−v·n, n, 0).
    spread: [Single; 4],
    /// Of either end: coefficient of the flux, the velocities of itself and of the other along it, what it passes of its own
    /// state, one over its volume.
    face: [[Single; D]; 2],
    through: [[Single; 2]; 2],
    swept: [Single; 2],
    by_volume: [Single; 2],
}

impl<const D: usize> Batch<D> {
    const BLANK: Self = Self {
        own: [StateLanes::ZERO; 2],
        face: [[[0.0; LANES]; D]; 2],
        swept: [[0.0; LANES]; 2],
        by_volume: [[0.0; LANES]; 2],
        area: [[0.0; LANES]; D],
        drift: [0.0; LANES],
        waves: Waves {
            velocity: [[[0.0; LANES]; D]; 3],
            enthalpy: [[0.0; LANES]; 3],
            push: [[0.0; LANES]; 3],
            normal: [[0.0; LANES]; D],
            across: [0.0; LANES],
            spread: [[0.0; LANES]; 4],
            face: [[[0.0; LANES]; D]; 2],
            through: [[[0.0; LANES]; 2]; 2],
            swept: [[0.0; LANES]; 2],
            by_volume: [[0.0; LANES]; 2],
        },
    };
}

impl<const D: usize> Waves<D> {
    /// (1, v, H) and ∂p/∂U of an end of edge `k`, or of the mean.
    #[inline(always)]
    fn state(&self, m: usize, k: usize, g1: f32) -> (Column, Column) {
        let v = &self.velocity[m];
        (column(1.0, (v, k, 1.0), self.enthalpy[m][k]), column(self.push[m][k], (v, k, -g1), g1))
    }

    /// |A| times half of the area of edge `k`, by columns. With |λ| of the shear and entropy waves taken out, the rest is a matrix
    /// of rank two (Turkel 1999, eq. 3.14).
    #[inline(always)]
    fn dissipation(&self, k: usize, g1: f32) -> [Column; MOST] {
        let (carried, pressure) = self.state(2, k, g1);
        let (along, stopped) = of_face((&self.normal, k, 1.0), self.across[k]);
        let part: [f32; 4] = array(|p| self.spread[p][k]);
        let mut out = [[0.0; WIDE]; MOST];
        for c in 0..n_variables(D) {
            let (x, y) = (part[1] * pressure[c] + part[2] * stopped[c], part[2] * pressure[c] + part[3] * stopped[c]);
            for r in 0..WIDE {
                out[c][r] = x * carried[r] + y * along[r];
            }
            out[c][c] += part[0];
        }
        out
    }

    /// Block of the row of one end of edge `k`: `SIGN` 1 for what it takes of the state of the other, -1 for its own state.
    #[inline(always)]
    fn block<const SIGN: i8>(
        &self,
        (carried, pressure): &(Column, Column),
        side: usize,
        k: usize,
        spread: &[Column; MOST],
    ) -> [f32; ROOM] {
        let (n, sign, which) = (n_variables(D), f32::from(SIGN), usize::from(SIGN > 0));
        let (through, share) = (sign * self.through[side][which][k], sign * self.by_volume[side][k]);
        let (along, stopped) = of_face((&self.face[side], k, sign), through);
        let mut block = [0.0; ROOM];
        for c in 0..n {
            for r in 0..WIDE {
                block[c * n + r] = stopped[c] * carried[r] + pressure[c] * along[r] - share * spread[c][r];
            }
            block[c * n + c] += through - sign * self.swept[side][k];
        }
        block
    }
}

/// Adds the blocks of the edges of a part.
pub(super) fn edge_blocks<const D: usize>(
    fluid: &Fluid<D>,
    at: (&Frame<D>, &Work<D>),
    (edges, weights): (&[Edge<D>], Weights<'_, D>),
    rows: &mut Rows<'_>,
) {
    let mut batch = Batch::BLANK;
    for (c, some) in edges.chunks(LANES).enumerate() {
        gather(fluid, at, (some, c * LANES, &weights), &mut batch);
        waves(fluid.gas, &mut batch);
        add(fluid, at, (some, c * LANES, &weights), (&batch.waves, rows));
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn gather<const D: usize>(
    fluid: &Fluid<D>,
    (frame, work): (&Frame<D>, &Work<D>),
    (edges, first, weights): (&[Edge<D>], usize, &Weights<'_, D>),
    batch: &mut Batch<D>,
) {
    let (cloud, by_faces) = (&frame.discretisation.cloud, fluid.passes_by_faces());
    let weighed = !fluid.conservative || frame.moves() && !by_faces;
    for (k, e) in edges.iter().enumerate() {
        let ends = [e.i(), e.j()];
        let of_fit =
            if weighed { weights.of(first + k, e, &(cloud.x[ends[1]] - cloud.x[ends[0]])) } else { [Vector::ZERO; 2] };
        for side in 0..2 {
            let i = ends[side];
            batch.own[side].put_primitive(k, &work.state[i]);
            let outward = if side == 0 { e.s } else { -e.s };
            let face = if fluid.conservative { half_face(cloud.volume[i], &outward) } else { of_fit[side] };
            put(&mut batch.face[side], k, &face);
            batch.by_volume[side][k] = 1.0 / cloud.volume[i];
            if frame.moves() {
                let passed = if by_faces { face } else { of_fit[side] };
                batch.swept[side][k] = frame.velocity[i].dot(&passed);
            }
        }
        put(&mut batch.area, k, &e.s);
        if frame.moves() {
            batch.drift[k] = 0.5 * (frame.velocity[ends[0]] + frame.velocity[ends[1]]).dot(&e.s);
        }
    }
}

/// What the blocks of every edge are made of.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn waves<const D: usize>(gas: Gas, batch: &mut Batch<D>) {
    let Batch { own, area, drift, face, swept, by_volume, waves } = batch;
    for k in 0..LANES {
        let (i, j, s) = (own[0].primitive(k), own[1].primitive(k), take::<D, f64>(area, k));
        let mean = Primitive::zip(&i, &j, |a, b| 0.5 * (a + b));
        let size = s.norm();
        let n = s * (1.0 / size.max(f64::MIN_POSITIVE));
        let c = gas.sound_speed(&mean);
        let [l1, a, b] = rounded_speeds(c, mean.velocity.dot(&n), drift[k] / size.max(f64::MIN_POSITIVE));
        let half = 0.5 * size;
        put_single(&mut waves.normal, k, &n);
        waves.across[k] = mean.velocity.dot(&n) as f32;
        waves.spread[0][k] = (half * l1) as f32;
        waves.spread[1][k] = (half * a / (c * c)) as f32;
        waves.spread[2][k] = (half * b) as f32;
        waves.spread[3][k] = (half * a) as f32;
        let states = [i, j, mean];
        for m in 0..3 {
            let q = &states[m];
            put_single(&mut waves.velocity[m], k, &q.velocity);
            waves.enthalpy[m][k] = gas.total_enthalpy(q) as f32;
            waves.push[m][k] = (0.5 * (gas.gamma - 1.0) * q.velocity.norm_squared()) as f32;
        }
        for side in 0..2 {
            let face = take(&face[side], k);
            put_single(&mut waves.face[side], k, &face);
            waves.through[side][0][k] = states[side].velocity.dot(&face) as f32;
            waves.through[side][1][k] = states[1 - side].velocity.dot(&face) as f32;
            waves.swept[side][k] = swept[side][k] as f32;
            waves.by_volume[side][k] = by_volume[side][k] as f32;
        }
    }
}

#[inline(always)]
fn put_single<const D: usize>(lanes: &mut [Single; D], k: usize, v: &Vector<D>) {
    for d in 0..D {
        lanes[d][k] = v[d] as f32;
    }
}

/// |λ| of the entropy wave, what the mean of both acoustic ones is above it, and half of their difference over the speed of sound,
/// in a flow of the velocity `vn` across something that moves by `drift`.
#[inline(always)]
fn rounded_speeds(c: f64, vn: f64, drift: f64) -> [f64; 3] {
    let fix = |x: f64| rounded(x.abs(), ROUNDING * c);
    let (l1, l2, l3) = (fix(vn - drift), fix(vn - drift + c), fix(vn - drift - c));
    [l1, 0.5 * (l2 + l3) - l1, 0.5 * (l2 - l3) / c]
}

/// A vector of the variables.
type Column = [f32; WIDE];

/// (first, v, last) of edge `k`, v multiplied by `scale`.
#[inline(always)]
fn column<const D: usize>(first: f32, (v, k, scale): (&[Single; D], usize, f32), last: f32) -> Column {
    let mut out = [0.0; WIDE];
    out[0] = first;
    for d in 0..D {
        out[1 + d] = v[d][k] * scale;
    }
    out[1 + D] = last;
    out
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn add<const D: usize>(
    fluid: &Fluid<D>,
    at: (&Frame<D>, &Work<D>),
    (edges, first, weights): (&[Edge<D>], usize, &Weights<'_, D>),
    (waves, rows): (&Waves<D>, &mut Rows<'_>),
) {
    let (n, cloud, g1) = (n_variables(D), &at.0.discretisation.cloud, (fluid.gas.gamma - 1.0) as f32);
    for (k, e) in edges.iter().enumerate() {
        let spread = waves.dissipation(k, g1);
        let (of_ends, ends) = ([waves.state(0, k, g1), waves.state(1, k, g1)], [e.i(), e.j()]);
        let viscous = fluid.viscous_model.is_some().then(|| {
            let of_fit = match fluid.conservative {
                true => [Vector::ZERO; 2],
                false => weights.of(first + k, e, &(cloud.x[ends[1]] - cloud.x[ends[0]])),
            };
            fluid.viscous_edge(at.1, (e, &of_fit), cloud)
        });
        let served = if e.both() { 2 } else { 1 };
        for side in 0..served {
            let (row, beside) = (ends[side], ends[1 - side]);
            let mut own = waves.block::<-1>(&of_ends[side], side, k, &spread);
            let mut other = waves.block::<1>(&of_ends[1 - side], side, k, &spread);
            if let Some((exchange, layers)) = &viscous {
                let exchange = [exchange.0, exchange.1][side];
                for c in 0..n {
                    for r in 0..n {
                        own[c * n + r] += (exchange * layers[side][r][c]) as f32;
                        other[c * n + r] -= (exchange * layers[1 - side][r][c]) as f32;
                    }
                }
            }
            rows.add_own(n, row, &own);
            match beside < cloud.n_fluid {
                true => rows.add_other(n, (row, beside), &other),
                false => couple(fluid, rows, at, (row, beside), |r, c| f64::from(other[c * n + r])),
            }
        }
    }
}

/// (0, n, v·n) and (−v·n, n, 0).
#[inline(always)]
fn of_face<const D: usize>(n: (&[Single; D], usize, f32), vn: f32) -> (Column, Column) {
    (column(0.0, n, vn), column(-vn, n, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Conserved;
    use crate::physics::riemann::{Roe, UpwindFlux};

    const AIR: Gas = Gas { gamma: 1.4 };
    const Q: Primitive<3> = Primitive { density: 1.2, velocity: Vector([0.6, -0.5, 0.2]), pressure: 0.8 };
    const AREA: Vector<3> = Vector([1.2, 0.0, 1.6]);

    /// Edges between particles of the same state, the one at the first end of volume 2, the other of volume 4.
    fn between_equals() -> Waves<3> {
        let mut batch = Batch::BLANK;
        for k in 0..LANES {
            for (side, (volume, sign)) in [(2.0, 1.0), (4.0, -1.0)].into_iter().enumerate() {
                batch.own[side].put_primitive(k, &Q);
                put(&mut batch.face[side], k, &(AREA * (0.5 * sign / volume)));
                batch.by_volume[side][k] = 1.0 / volume;
            }
            put(&mut batch.area, k, &AREA);
        }
        waves(AIR, &mut batch);
        batch.waves
    }

    /// Derivative of `f` by variable `k` of the state `Q`.
    fn derivative(k: usize, f: impl Fn(&Primitive<3>) -> Conserved<3>) -> [f64; 5] {
        let h = 1e-6;
        let at = |h: f64| {
            let mut row = [0.0; 5];
            AIR.conserved(&Q).store(&mut row);
            row[k] += h;
            f(&AIR.primitive(&Conserved::load(&row)))
        };
        let mut row = [0.0; 5];
        at(h).plus(-1.0, &at(-h)).times(0.5 / h).store(&mut row);
        row
    }

    #[test]
    fn dissipation_is_that_of_the_roe_flux() {
        let (found, n) = (between_equals().dissipation(3, 0.4), AREA * 0.5);
        for c in 0..5 {
            // the area is 2, half of it 1
            let wanted = derivative(c, |q| Roe.across(&AIR, &Q, q, &n).plus(-0.5, &AIR.flux(q, &n)).times(-2.0));
            (0..5).for_each(|r| assert!((f64::from(found[c][r]) - wanted[r]).abs() < 1e-5, "{r} {c}"));
        }
    }

    #[test]
    fn blocks_are_the_derivatives_of_what_an_edge_passes() {
        let waves = between_equals();
        let (state, spread) = (waves.state(0, 3, 0.4), waves.dissipation(3, 0.4));
        for (side, face) in [AREA * 0.25, AREA * -0.125].into_iter().enumerate() {
            let own = waves.block::<-1>(&state, side, 3, &spread);
            let other = waves.block::<1>(&state, side, 3, &spread);
            for c in 0..5 {
                let flux = derivative(c, |q| AIR.flux(q, &face));
                for r in 0..5 {
                    let spread = f64::from(spread[c][r] * waves.by_volume[side][3]);
                    assert!((f64::from(own[c * 5 + r]) - (spread - flux[r])).abs() < 1e-5, "{side} {r} {c}");
                    assert!((f64::from(other[c * 5 + r]) - (flux[r] - spread)).abs() < 1e-5, "{side} {r} {c}");
                }
            }
        }
    }
}
