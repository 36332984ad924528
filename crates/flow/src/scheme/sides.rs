//! States of the particles on the open sides of the domain.
//!
//! A side holds a state: that of the far field, or that of the start. What differs from it near the side leaves as waves do
//! ([`crate::physics::outgoing`]): the disturbance of the last particle is continued along the line through it and the one
//! behind it, and the part of it that moves outwards is added to what is held. [`OpenSide`] is the boundary condition of a side:
//! all that depends on which of them it is stands here. Planes of symmetry and periodic sides have none; there are images beyond them.
use super::fluid::{FarField, Fluid, Work};
use super::frame::Frame;
use super::lanes::Number;
use crate::case::Side;
use crate::math::Vector;
use crate::math::dual::Dual;
use crate::math::parallel::{sweep_each, sweep_each_slot};
use crate::physics::outgoing::outgoing;
use crate::physics::{Gas, Primitive};

/// Greatest part of the way between two particles by which a disturbance is continued to a side.
const FURTHEST: f64 = 1.0;

/// Boundary condition of an open side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum OpenSide {
    /// The far field, which goes with the force on the bodies; waves leave.
    FarField,
    /// The field at the start, for all times; waves leave.
    Start,
    /// No slope across the side, and a static pressure over that of the free stream where one is given.
    Outflow {
        /// The pressure.
        pressure: Option<f64>,
    },
}

/// What an outer particle has before it, in the axes of the frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Before<'a, const D: usize, S> {
    /// State that the side holds at the particle, and at the fluid particle before it.
    pub held: [Primitive<D, S>; 2],
    /// State of that fluid particle, and the same with its disturbance continued to the side.
    pub gas: [&'a Primitive<D, S>; 2],
    /// Direction out of the domain, and velocity of the outer particle.
    pub side: [Vector<D>; 2],
}

impl OpenSide {
    /// The condition of an open side of a case. Other sides have no outer particles.
    pub(super) fn of(side: Side) -> Self {
        match side {
            Side::FarField => Self::FarField,
            Side::Held | Side::Symmetry | Side::Periodic => Self::Start,
            Side::Outflow { pressure } => Self::Outflow { pressure },
        }
    }

    /// True where what the side holds goes with the force on the bodies.
    fn follows_force(self) -> bool {
        self == Self::FarField
    }

    /// True where what the side holds varies along it, and so across it too: without a slope the edge flux is of first order.
    pub(super) fn varies(self) -> bool {
        self == Self::Start
    }

    /// State of an outer particle.
    fn state<const D: usize, S: Number>(self, gas: &Gas, before: &Before<'_, D, S>) -> Primitive<D, S> {
        let ([held, beside], [inner, arriving], [n, moved]) = (&before.held, before.gas, &before.side);
        match self {
            Self::FarField | Self::Start => outgoing(gas, held, [arriving, beside], (n, moved)),
            Self::Outflow { pressure } => {
                let given = |p: f64| S::constant(p / gas.gamma);
                Primitive { pressure: pressure.map_or(inner.pressure, given), ..*inner }
            }
        }
    }
}

/// Numbers that the far field is known in: plain ones, or those that carry their change with the state.
pub(super) trait OnSides: Number {
    /// State of the far field `field` at `x` when the bodies feel the force `force`.
    fn far<const D: usize>(field: &dyn FarField<D>, x: &Vector<D>, force: &Vector<D, Self>) -> Primitive<D, Self>;
}

impl OnSides for f64 {
    fn far<const D: usize>(field: &dyn FarField<D>, x: &Vector<D>, force: &Vector<D>) -> Primitive<D> {
        field.state(x, force)
    }
}

impl OnSides for Dual {
    fn far<const D: usize>(field: &dyn FarField<D>, x: &Vector<D>, force: &Vector<D, Self>) -> Primitive<D, Self> {
        field.changing(x, force)
    }
}

impl<const D: usize> Fluid<D> {
    /// Brings what sides hold of the state at the start to where the particles of `frame` are.
    pub(super) fn hold_start(&self, frame: &mut Frame<D>) {
        let cloud = &self.discretisation.cloud;
        let mut held = std::mem::take(&mut frame.held);
        sweep_each_slot(&mut held, |k, q| {
            if !OpenSide::of(cloud.outer[k].side).follows_force() {
                *q = cloud.beside(k).map(|i| (self.held)(&frame.place(i)));
            }
        });
        frame.held = held;
    }

    /// Sets what sides hold in `work`: what `frame` says of them, and in the far field what goes with the force of the wall states in
    /// `work`.
    pub(super) fn hold_sides<S: OnSides>(&self, frame: &Frame<D>, work: &mut Work<D, S>) {
        let force = self.pressure_force(frame, work);
        let (cloud, held) = (&self.discretisation.cloud, &frame.held);
        work.held.resize_with(held.len(), || held[0].each_ref().map(Primitive::constant));
        sweep_each(&mut work.held, |k| match OpenSide::of(cloud.outer[k].side).follows_force() {
            true => cloud.beside(k).map(|i| S::far(&*self.far_field, &frame.place(i), &force)),
            false => held[k].each_ref().map(Primitive::constant),
        });
    }

    /// State of outer particle `k`, whose side holds `held`: that, with the part of what its source differs that leaves.
    pub(super) fn outer_state<S: Number>(
        &self,
        frame: &Frame<D>,
        (k, held): (usize, &[Primitive<D, S>; 3]),
        fluid: &[Primitive<D, S>],
    ) -> Primitive<D, S> {
        let cloud = &frame.discretisation.cloud;
        let outer = &cloud.outer[k];
        let [held, beside, further] = held.map(|q| Primitive { velocity: frame.to_body_axes(&q.velocity), ..q });
        let Some(inner) = fluid.get(outer.source as usize) else { return held };
        let [x, near, far] = cloud.beside(k).map(|i| &cloud.x[i]);
        let (n, moved) = (outer.normal(), frame.velocity_of(cloud.outer_range().start + k));
        let ahead = ((*x - *near).dot(&n) / (*near - *far).dot(&n)).clamp(0.0, FURTHEST);
        let change = inner.minus(&beside).minus(&fluid[outer.behind as usize].minus(&further));
        let arriving = inner.plus(S::constant(if ahead.is_finite() { ahead } else { 0.0 }), &change);
        let arriving = if arriving.is_physical() { &arriving } else { inner };
        let before = Before { held: [held, beside], gas: [inner, arriving], side: [n, moved] };
        OpenSide::of(outer.side).state(&self.gas, &before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_side_takes_what_its_condition_says() {
        let gas = Gas { gamma: 1.4 };
        let still = Primitive { density: 1.0, velocity: Vector([0.4, 0.0]), pressure: 1.0 / 1.4 };
        let inner = Primitive { density: 1.1, velocity: Vector([0.5, 0.1]), pressure: 0.8 };
        let side = [Vector([1.0, 0.0]), Vector::ZERO];
        let state = |condition: Side, inner: &Primitive<2>| {
            let before = Before { held: [still; 2], gas: [inner; 2], side };
            OpenSide::of(condition).state(&gas, &before)
        };
        // an outflow takes what comes, at the pressure that is given
        assert_eq!(state(Side::Outflow { pressure: None }, &inner), inner);
        let given = state(Side::Outflow { pressure: Some(0.9) }, &inner);
        assert_eq!(given, Primitive { pressure: 0.9 / 1.4, ..inner });
        // what nothing disturbs is held; of a wave that leaves, nearly all is added
        for condition in [Side::FarField, Side::Held] {
            assert_eq!(state(condition, &still), still);
            let push = 1e-4;
            let wave = Primitive {
                density: still.density + push,
                velocity: still.velocity + Vector([push, 0.0]),
                pressure: still.pressure + push,
            };
            let found = state(condition, &wave);
            assert!((found.pressure - wave.pressure).abs() < 0.05 * push, "{found:?}");
            assert!((found.velocity - wave.velocity).norm() < 0.05 * push, "{found:?}");
        }
    }
}
