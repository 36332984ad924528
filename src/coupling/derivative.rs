//! How the rates of structures change with the state, in a frame that stays.
//!
//! The forces of the gas on walls are evaluated with numbers that carry their change, as the residual of the gas is
//! (`scheme::derivative`); the accelerations of bodies on springs have derivatives of their own. How the work of a force changes as a
//! coordinate turns the body, and the forces of bodies made of particles, are formulas without edges that are differenced over four points:
//! f′ = [8 (f(h) − f(−h)) − (f(2h) − f(−2h))]/12h, right to some 1e-12 of their size.
use super::solids::Pace;
use super::{Coupled, Frame, Work};
use crate::math::Vector;
use crate::math::dual::Dual;
use crate::math::reduce::largest_size;
use crate::system::{Name, System};

/// Points of the differences in steps, with their weights.
const POINTS: [(f64, f64); 4] = [(1.0, 8.0 / 12.0), (-1.0, -8.0 / 12.0), (2.0, -1.0 / 12.0), (-2.0, 1.0 / 12.0)];
/// Step in the coordinates of bodies on springs, in their units, and in those of particles of bodies, in lengths of these.
const STEP: f64 = 1e-3;
const PARTICLE_STEP: f64 = 1e-5;

impl<const D: usize> Coupled<D> {
    /// Sets the rows of the structures of `out` to how their rates change with `v` at the state `u`; the gas has just done so, and the
    /// changes of its walls are in `work`.
    pub(super) fn structures_change(&self, frame: &Frame<D>, at: [&[f64]; 2], work: &mut Work<D>, out: &mut [f64]) {
        let Some(changing) = work.gas.changing.take() else { return };
        let force = |w: usize| self.fluid.wall_force((&frame.gas, &*changing), w);
        self.sprung_change(frame, at, &force, work, out);
        self.solids_change(frame, at, &force, work, out);
        work.gas.changing = Some(changing);
    }

    /// The rows of bodies on springs.
    fn sprung_change(
        &self,
        frame: &Frame<D>,
        at: [&[f64]; 2],
        force: &(impl Fn(usize) -> Vector<D, Dual> + Sync),
        work: &mut Work<D>,
        out: &mut [f64],
    ) {
        let own = self.unknowns_of(Name::Structure);
        let [u, v] = at.map(|u| &u[own.clone()]);
        let out = &mut out[own];
        if self.pace(frame) == Pace::Held {
            return out.iter_mut().zip(v).for_each(|(o, v)| *o = -self.fastest * v);
        }
        let change = self.loads_change([u, v], force, work);
        for body in &self.bodies {
            let (own, range) = (2 * body.first..2 * body.range().end, body.range());
            let loads = [&work.load[range.clone()], &change[range]];
            let steady = frame.steady.then_some(self.fastest);
            let at = [&u[own.clone()], &v[own.clone()]];
            body.rates_change((frame.gas.time, steady), at, loads, &mut out[own]);
        }
    }

    /// Changes of the generalised forces with forces on walls and with where coordinates have put these; sets `work.load` to the forces.
    fn loads_change(
        &self,
        [u, v]: [&[f64]; 2],
        force: &(impl Fn(usize) -> Vector<D, Dual> + Sync),
        work: &mut Work<D>,
    ) -> Vec<f64> {
        let value = |w: usize| Vector::from_fn(|d| force(w)[d].value);
        let slope = |w: usize| Vector::from_fn(|d| force(w)[d].derivative);
        let (mut all, mut there) = (vec![0.0; work.load.len()], vec![0.0; work.load.len()]);
        self.loads_of(&slope, u, (&mut all, &mut work.chunks));
        self.loads_of(&value, u, (&mut work.load, &mut work.chunks));
        let units: Vec<f64> = self.bodies.iter().flat_map(|b| b.units.iter().copied()).collect();
        let fastest = largest_size(units.len().min(v.len() / 2), |k| v[2 * k] / units[k]);
        if fastest > 0.0 {
            let step = STEP / fastest;
            for (part, weight) in POINTS {
                let moved: Vec<f64> = u.iter().zip(v).map(|(u, v)| u + part * step * v).collect();
                self.loads_of(&value, &moved, (&mut there, &mut work.chunks));
                all.iter_mut().zip(&there).for_each(|(all, there)| *all += weight / step * there);
            }
        }
        all
    }

    /// The rows of bodies made of particles.
    fn solids_change(
        &self,
        frame: &Frame<D>,
        [u, v]: [&[f64]; 2],
        force: &dyn Fn(usize) -> Vector<D, Dual>,
        work: &mut Work<D>,
        out: &mut [f64],
    ) {
        let (Some(on), Some(work)) = (&self.solids, &mut work.solids) else { return };
        let (own, remembered) = (self.unknowns_of(Name::Solid), self.unknowns_of(Name::History));
        if !remembered.is_empty() {
            work.history.copy_from_slice(&u[remembered.clone()]);
        }
        out[remembered].fill(0.0);
        let ([u, v], out) = ([u, v].map(|u| &u[own.clone()]), &mut out[own.clone()]);
        let [mut value, mut slope] = [(); 2].map(|()| vec![Vector::ZERO; on.solids.len()]);
        on.load(&|w| Vector::from_fn(|d| force(w)[d].value), &mut value);
        on.load(&|w| Vector::from_fn(|d| force(w)[d].derivative), &mut slope);
        out.fill(0.0);
        // rates are linear in the forces of the gas, which therefore set no limit to the step
        let fastest = largest_size(v.len(), |k| v[k]);
        let step = if fastest > 0.0 { PARTICLE_STEP * on.solids.length / fastest } else { 1.0 };
        let mut there = vec![0.0; out.len()];
        for (part, weight) in POINTS {
            let by = part * step;
            let moved: Vec<f64> = u.iter().zip(v).map(|(u, v)| u + by * v).collect();
            work.load.iter_mut().zip(value.iter().zip(&slope)).for_each(|(load, (f, df))| *load = *f + *df * by);
            on.solids.rates(&self.moving(frame), &moved, work, &mut there);
            out.iter_mut().zip(&there).for_each(|(out, there)| *out += weight / step * there);
        }
    }
}
