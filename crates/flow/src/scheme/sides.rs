//! States of the particles on the open sides of the domain.
//!
//! A side holds a state: that of the far field, or that of the start. What differs from it near the side leaves as waves do
//! ([`crate::physics::outgoing`]): the disturbance of the last particle is continued along the line through it and the one
//! behind it, and the part of it that moves outwards is added to what is held.
use super::fluid::{Fluid, Work};
use super::frame::Frame;
use super::lanes::Number;
use crate::case::Side;
use crate::math::dual::Dual;
use crate::math::parallel::sweep_each_slot;
use crate::physics::Primitive;
use crate::physics::outgoing::outgoing;

/// Greatest part of the way between two particles by which a disturbance is continued to a side.
const FURTHEST: f64 = 1.0;

impl<const D: usize> Fluid<D> {
    /// Brings what sides hold to the time of `frame` and, in the far field, to the force of the wall states in `work`.
    pub(super) fn hold_sides(&self, frame: &mut Frame<D>, work: &Work<D>) {
        let force = self.pressure_force(frame, work);
        let cloud = &self.discretisation.cloud;
        let mut outer = std::mem::take(&mut frame.outer);
        let still = self.cloud_motion.is_still();
        sweep_each_slot(&mut outer, |k, q| match cloud.outer[k].side {
            Side::FarField => *q = cloud.beside(k).map(|i| self.far_field.state(&frame.place(i), &force)),
            _ if still => {}
            _ => *q = cloud.beside(k).map(|i| (self.held)(&frame.place(i))),
        });
        frame.outer = outer;
    }

    /// What sides hold, with the change that goes with the wall states in `work`; far from the bodies alone does it change.
    pub(super) fn hold_changing(&self, frame: &Frame<D>, work: &Work<D, Dual>, outer: &mut [[Primitive<D, Dual>; 3]]) {
        let force = self.pressure_force(frame, work);
        let cloud = &self.discretisation.cloud;
        sweep_each_slot(outer, |k, q| match cloud.outer[k].side {
            Side::FarField => *q = cloud.beside(k).map(|i| self.far_field.changing(&frame.place(i), &force)),
            _ => *q = frame.outer[k].each_ref().map(Primitive::constant),
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
