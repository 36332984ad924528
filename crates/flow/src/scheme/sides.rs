//! States of the particles on the open sides of the domain.
//!
//! A side holds a state: that of the far field, or that of the start. What differs from it near the side leaves as waves do
//! ([`crate::physics::outgoing`]): the disturbance of the last particle is continued along the line through it and the one
//! behind it, and the part of it that moves outwards is added to what is held.
use super::fluid::{FarField, Fluid, Work};
use super::frame::Frame;
use super::lanes::Number;
use crate::case::Side;
use crate::math::Vector;
use crate::math::dual::Dual;
use crate::math::parallel::{sweep_each, sweep_each_slot};
use crate::physics::Primitive;
use crate::physics::outgoing::outgoing;

/// Greatest part of the way between two particles by which a disturbance is continued to a side.
const FURTHEST: f64 = 1.0;

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
            if !matches!(cloud.outer[k].side, Side::FarField) {
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
        sweep_each(&mut work.held, |k| match cloud.outer[k].side {
            Side::FarField => cloud.beside(k).map(|i| S::far(&*self.far_field, &frame.place(i), &force)),
            _ => held[k].each_ref().map(Primitive::constant),
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
        if let Side::Outflow { pressure } = outer.side {
            let given = |p: f64| S::constant(p / self.gas.gamma);
            return Primitive { pressure: pressure.map_or(inner.pressure, given), ..*inner };
        }
        let [x, near, far] = cloud.beside(k).map(|i| &cloud.x[i]);
        let (n, moved) = (outer.normal(), frame.velocity_of(cloud.outer_range().start + k));
        let ahead = ((*x - *near).dot(&n) / (*near - *far).dot(&n)).clamp(0.0, FURTHEST);
        let change = inner.minus(&beside).minus(&fluid[outer.behind as usize].minus(&further));
        let arriving = inner.plus(S::constant(if ahead.is_finite() { ahead } else { 0.0 }), &change);
        let arriving = if arriving.is_physical() { arriving } else { *inner };
        outgoing(&self.gas, &held, [&arriving, &beside], (&n, &moved))
    }
}
