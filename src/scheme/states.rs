//! States and gradients of all particles from the evolved ones.
//!
//! Walls follow from the fluid particles in front of them (`wall_state`), outer sides hold a state and let waves leave
//! (`sides`), images copy their source through a reflection or shift.
use super::fluid::{Fluid, Work};
use super::frame::{Discretisation, Frame};
use super::reconstruct::Gradient;
use super::viscous::WallCondition;
use super::wall_state::{no_slip_wall, slip_wall};
use crate::case::Side;
use crate::math::Vector;
use crate::math::sweep::{sweep, sweep_each, sweep_parts};
use crate::physics::{Conserved, Primitive};

impl<const D: usize> Fluid<D> {
    /// Fills `work.state` for every particle from the evolved ones, in the axes of `frame.discretisation`.
    pub fn fill_states(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>) {
        let (cloud, fits) = (&frame.discretisation.cloud, &frame.discretisation.walls);
        let (fluid, rest) = work.state.split_at_mut(cloud.n_fluid);
        let inward = |q: Primitive<D>| Primitive { velocity: frame.to_body_axes(&q.velocity), ..q };
        sweep(fluid, |i| inward(self.gas.primitive(&Conserved::of_row(u, i))));
        let fluid = &*fluid;
        let first_ghost = cloud.n_real();
        let seen = |k: usize| {
            if k < cloud.n_fluid {
                return fluid[k];
            }
            let image = &cloud.ghosts[k - first_ghost];
            self.image_state(&fluid[image.source as usize], image.transform)
        };
        let (walls, rest) = rest.split_at_mut(cloud.interface.len());
        let moved = |w: usize| (frame.velocity_of(cloud.n_fluid + w), frame.walls.get(w));
        let slips = |w: usize| slip_wall((cloud, fits), &self.gas, w, moved(w), seen);
        // sides and walls are few particles, each of them much work
        match self.viscous_model {
            None => sweep_each(walls, slips),
            Some(_) => sweep_each(walls, |w| {
                self.no_slip_state(&frame.discretisation, (w, frame), seen).unwrap_or_else(|| slips(w))
            }),
        }
        let walls = &*walls;
        let (outer, ghosts) = rest.split_at_mut(cloud.outer.len());
        sweep_each(outer, |k| self.outer_state(frame, k, fluid));
        let outer = &*outer;
        sweep(ghosts, |k| {
            let image = &cloud.ghosts[k];
            let s = image.source as usize;
            let source = match s {
                s if s < cloud.n_fluid => &fluid[s],
                s if s < cloud.n_rows() => &walls[s - cloud.n_fluid],
                s => &outer[s - cloud.n_rows()],
            };
            self.image_state(source, image.transform)
        });
    }

    /// State of interface particle `w` when the gas sticks to its wall; `None` when it slides.
    #[inline]
    pub(super) fn no_slip_state(
        &self,
        discretisation: &Discretisation<D>,
        (w, frame): (usize, &Frame<D>),
        q: impl Fn(usize) -> Primitive<D>,
    ) -> Option<Primitive<D>> {
        let temperature = match self.viscous_model.as_ref()?.wall_condition(discretisation.cloud.interface[w].body) {
            WallCondition::Slip => return None,
            WallCondition::Adiabatic => None,
            WallCondition::Temperature(t) => Some(t),
        };
        let velocity = frame.velocity_of(discretisation.cloud.n_fluid + w);
        let moved = (velocity, frame.walls.get(w));
        Some(no_slip_wall((&discretisation.cloud, &discretisation.walls), &self.gas, w, (moved, temperature), q))
    }

    fn image_state(&self, q: &Primitive<D>, transform: u8) -> Primitive<D> {
        Primitive { velocity: self.discretisation.cloud.transforms[transform as usize].direction(&q.velocity), ..*q }
    }

    /// Fills `work.gradient` from `work.state`.
    pub fn fill_gradients(&self, frame: &Frame<D>, work: &mut Work<D>) {
        let (cloud, op) = (&frame.discretisation.cloud, &frame.discretisation.operators);
        let state = &work.state;
        let (rows, rest) = work.gradient.split_at_mut(cloud.n_rows());
        sweep_parts(&op.parts, 1, rows, &|k, out| {
            let start = op.parts[k].start;
            out.fill(Gradient::ZERO);
            for e in op.edges(k) {
                let dq = state[e.j()].minus(&state[e.i()]);
                out[e.i() - start].add(&e.a_i, &dq);
                if e.both() {
                    out[e.j() - start].add(&-e.a_j, &dq);
                }
            }
        });
        cloud.first_order.iter().for_each(|i| rows[*i as usize] = Gradient::ZERO);
        let rows = &*rows;
        let (outer, ghosts) = rest.split_at_mut(cloud.outer.len());
        // a held state that varies along the side also varies across it: without a slope the edge flux is of first order
        sweep(outer, |k| match cloud.outer[k].side {
            Side::Held => rows.get(cloud.outer[k].source as usize).copied().unwrap_or(Gradient::ZERO),
            _ => Gradient::ZERO,
        });
        sweep(ghosts, |k| {
            let image = &cloud.ghosts[k];
            let t = &cloud.transforms[image.transform as usize];
            rows.get(image.source as usize).map_or(Gradient::ZERO, |g| Gradient {
                density: t.direction(&g.density),
                velocity: std::array::from_fn(|c| t.direction(&g.velocity[c]) * t.sign[c]),
                pressure: t.direction(&g.pressure),
            })
        });
    }

    /// Force of the pressure on all bodies in the axes of the case, from the wall states in `work`.
    pub fn pressure_force(&self, frame: &Frame<D>, work: &Work<D>) -> Vector<D> {
        let cloud = &frame.discretisation.cloud;
        let walls = &work.state[cloud.interface_range()];
        let far = self.far_field.pressure();
        let force = cloud.interface.iter().zip(walls).fold(Vector::ZERO, |f, (w, q)| f - w.area * (q.pressure - far));
        frame.to_inertial_axes(&force)
    }
}
