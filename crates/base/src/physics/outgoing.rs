//! Outgoing waves at a boundary of the domain: a far-field condition by characteristics.
//!
//! Along a normal n, the Euler equations transport acoustic waves at u·n ± c, and the entropy p/ρ^γ and the tangential
//! velocity at u·n (Hirsch, Numerical Computation of Internal and External Flows 2, 1990, section 16.4). Acoustic waves
//! are represented by J± = u·n ± 2a/(γ − 1), where a is the speed of sound that the prescribed gas would have at the
//! local pressure; J± is constant across waves of the other family and across layers of different entropy. A boundary
//! with a prescribed state absorbs a wave from inside only if the wave continues beyond it. Otherwise a part is
//! reflected, because on a cloud no edge is normal to all waves.
use super::{Gas, Primitive};
use crate::math::Vector;
use crate::math::jet::Scalar;

/// Fraction of the speed of sound over which a wave that changes from outgoing to incoming is faded out.
const FADE: f64 = 0.1;
/// Minimum speed of sound of the state, relative to that of the prescribed state.
const LEAST: f64 = 0.1;

/// Transported quantities: J₊, J₋, p/ρ^γ and the tangential velocity.
struct Carried<const D: usize, S> {
    sound: [S; 2],
    entropy: S,
    along: Vector<D, S>,
}

impl<const D: usize, S: Scalar> Carried<D, S> {
    /// Exponent of the pressure in a.
    fn exponent(gas: &Gas) -> f64 {
        0.5 * (gas.gamma - 1.0) / gas.gamma
    }

    fn of(gas: &Gas, held: &Primitive<D, S>, q: &Primitive<D, S>, n: &Vector<D, S>) -> Self {
        let across = q.velocity.dot(n);
        let a = gas.sound_speed(held) * (q.pressure / held.pressure).powf(Self::exponent(gas));
        let up = a * (2.0 / (gas.gamma - 1.0));
        Self { sound: [across + up, across - up], entropy: gas.entropy(q), along: q.velocity - *n * across }
    }

    fn state(&self, gas: &Gas, held: &Primitive<D, S>, n: &Vector<D, S>) -> Primitive<D, S> {
        let [up, down] = self.sound;
        let a = ((up - down) * (0.25 * (gas.gamma - 1.0)) / gas.sound_speed(held)).max(S::constant(LEAST));
        let pressure = held.pressure * a.powf(1.0 / Self::exponent(gas));
        let density = (pressure / self.entropy).powf(1.0 / gas.gamma);
        Primitive { density, velocity: *n * ((up + down) * 0.5) + self.along, pressure }
    }
}

/// State on a boundary with the normal `n` that moves with the velocity `w`: the prescribed state plus the outgoing
/// part of the disturbance. `inner` is the state of the particle next to the boundary, `beside` the prescribed state at
/// that particle.
pub fn outgoing<const D: usize, S: Scalar>(
    gas: &Gas,
    held: &Primitive<D, S>,
    [inner, beside]: [&Primitive<D, S>; 2],
    (n, w): (&Vector<D>, &Vector<D>),
) -> Primitive<D, S> {
    let (n, w) = (&Vector::constant(n), &Vector::constant(w));
    let c = gas.sound_speed(held);
    let through = (held.velocity - *w).dot(n);
    let fade = c * FADE;
    let leaves = |speed: S| (speed / (speed * speed + fade * fade).sqrt() + 1.0) * 0.5;
    let [part_up, part_down, part] = [through + c, through - c, through].map(leaves);
    let [before, inside, usual] = [held, inner, beside].map(|q| Carried::of(gas, held, q, n));
    let after = Carried {
        sound: [
            before.sound[0] + part_up * (inside.sound[0] - usual.sound[0]),
            before.sound[1] + part_down * (inside.sound[1] - usual.sound[1]),
        ],
        entropy: before.entropy * ((inside.entropy / usual.entropy).log() * part).exp(),
        along: before.along + (inside.along - usual.along) * part,
    };
    // the difference is exactly zero if nothing leaves
    let change = after.state(gas, held, n).minus(&before.state(gas, held, n));
    held.plus(S::constant(1.0), &change)
}

#[cfg(test)]
mod tests {
    use super::*;

    const AIR: Gas = Gas { gamma: 1.4 };
    const N: Vector<2> = Vector([0.6, 0.8]);
    const T: Vector<2> = Vector([-0.8, 0.6]);

    fn stream(mach: f64) -> Primitive<2> {
        Primitive { density: 1.4, velocity: N * mach, pressure: 1.0 }
    }

    /// Maximum difference between the boundary state of a stream that ends in `inner` and `expected`.
    fn error(mach: f64, inner: &Primitive<2>, expected: &Primitive<2>) -> f64 {
        let held = stream(mach);
        let d = outgoing(&AIR, &held, [inner, &held], (&N, &Vector::ZERO)).minus(expected);
        d.density.abs().max(d.pressure.abs()).max(d.velocity.norm())
    }

    /// A simple wave in a stream, with its velocity changed by `by` along ±n.
    fn wave(mach: f64, by: f64, sign: f64) -> Primitive<2> {
        let c: f64 = 1.0 + 0.2 * by;
        Primitive { density: 1.4 * c.powf(5.0), velocity: N * (mach + sign * by), pressure: c.powf(7.0) }
    }

    #[test]
    fn sound_leaves_one_way_and_all_leaves_with_a_supersonic_stream() {
        for mach in [-0.5, 0.0, 0.5] {
            let (out, back) = (wave(mach, 0.1, 1.0), wave(mach, 0.1, -1.0));
            assert!(error(mach, &out, &out) < 3e-3, "Mach {mach}");
            assert!(error(mach, &back, &stream(mach)) < 3e-3);
        }
        let swirl = |mach: f64| Primitive { density: 1.5, velocity: N * mach + T * 0.1, pressure: 1.0 };
        assert!(error(0.5, &swirl(0.5), &swirl(0.5)) < 3e-3 && error(-0.5, &swirl(-0.5), &stream(-0.5)) < 3e-3);
        for state in [|m| wave(m, 0.1, 1.0), |m| wave(m, 0.1, -1.0), swirl] {
            assert!(error(2.0, &state(2.0), &state(2.0)) < 1e-3 && error(-2.0, &state(-2.0), &stream(-2.0)) < 1e-3);
        }
    }

    #[test]
    fn nothing_changes_to_the_bit_where_nothing_leaves() {
        assert!([-2.0, -0.3, 0.0, 0.7].iter().all(|m| error(*m, &stream(*m), &stream(*m)) == 0.0));
    }
}
