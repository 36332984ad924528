//! States and gradients of all particles from the evolved ones.
//!
//! Walls follow from the fluid particles in front of them (`wall_state`), outer sides hold a state and let waves leave
//! (`sides`), images copy their source through a reflection or shift.
use multiversion::multiversion;

use super::fluid::{Fluid, Work};
use super::frame::Frame;
use super::lanes::Number;
use super::reconstruct::Gradient;
use super::sides::OpenSide;
use super::wall_fits::{lowest_two, parabola};
use super::wall_motion::WallMotion;
use super::wall_state::{Wall, no_slip_wall, slip_wall};
use crate::cloud::Edge;
use crate::math::Vector;
use crate::math::parallel::{sweep, sweep_each, sweep_parts};
use crate::math::square::Symmetric;
use crate::physics::{Conserved, Primitive};

impl<const D: usize> Fluid<D> {
    /// Fills `work.state` for every particle from the evolved ones, in the axes of `frame.discretisation`.
    pub fn fill_states(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>) {
        self.fill_fluid(frame, u, work);
        self.fill_walls(frame, work);
        self.hold_sides(frame, work);
        self.fill_outside(frame, work);
    }

    /// Fills the states of the evolved particles.
    pub(super) fn fill_fluid(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>) {
        self.fill_rows(frame, |i| Conserved::of_row(u, i), work);
    }

    /// The same, row `i` of the unknowns being `u(i)`.
    pub(super) fn fill_rows<S: Number>(
        &self,
        frame: &Frame<D>,
        u: impl Fn(usize) -> Conserved<D, S> + Sync,
        work: &mut Work<D, S>,
    ) {
        let inward = |q: Primitive<D, S>| Primitive { velocity: frame.to_body_axes(&q.velocity), ..q };
        let fluid = &mut work.state[..frame.discretisation.cloud.n_fluid];
        sweep(fluid, |i| inward(self.gas.primitive(&u(i))));
    }

    /// Fills the states of interface particles from those of the fluid.
    pub(super) fn fill_walls<S: Number>(&self, frame: &Frame<D>, work: &mut Work<D, S>) {
        let cloud = &frame.discretisation.cloud;
        let (fluid, rest) = work.state.split_at_mut(cloud.n_fluid);
        let fluid = &*fluid;
        let first_ghost = cloud.n_real();
        let seen = |k: usize| {
            if k < cloud.n_fluid {
                return fluid[k];
            }
            let image = &cloud.ghosts[k - first_ghost];
            self.image_state(&fluid[image.source as usize], image.transform)
        };
        // sides and walls are few particles, each of them much work
        sweep_each(&mut rest[..cloud.interface.len()], |w| self.wall_state(frame, w, seen));
    }

    /// Fills the states of outer particles and images from those of the fluid and the walls, and what sides hold.
    pub(super) fn fill_outside<S: Number>(&self, frame: &Frame<D>, work: &mut Work<D, S>) {
        let (cloud, held) = (&frame.discretisation.cloud, &work.held);
        let (inside, rest) = work.state.split_at_mut(cloud.n_rows());
        let (fluid, walls) = inside.split_at(cloud.n_fluid);
        let (outer, ghosts) = rest.split_at_mut(cloud.outer.len());
        sweep_each(outer, |k| self.outer_state(frame, (k, &held[k]), fluid));
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

    /// State of interface particle `w`, from those of the fluid particles, images included, in `q`.
    fn wall_state<S: Number>(
        &self,
        frame: &Frame<D>,
        w: usize,
        q: impl Fn(usize) -> Primitive<D, S>,
    ) -> Primitive<D, S> {
        let (cloud, fits) = (&frame.discretisation.cloud, &frame.discretisation.walls);
        let interface = &cloud.interface[w];
        let mut wall = Wall {
            normal: Vector::constant(&interface.normal),
            curvature: interface.curvature.each_ref().map(Vector::constant),
            offset: S::constant(fits.normal_offset(w)),
            velocity: Vector::constant(&frame.velocity_of(cloud.n_fluid + w)),
            motion: frame.walls.get(w).map(WallMotion::constant),
        };
        let front = || fits.row(cloud, w).map(|(k, weight)| (S::constant(weight), q(k)));
        let condition = self.wall_condition(interface.body);
        if condition.slips() {
            return slip_wall(&self.gas, &wall, front());
        }
        let temperature = condition.temperature();
        let Some((particles, heights)) = lowest_two(cloud, w) else {
            return no_slip_wall(&self.gas, &wall, temperature, front());
        };
        let (weights, offset) = parabola(heights);
        wall.offset = S::constant(offset);
        let front = weights.into_iter().zip(particles).map(|(weight, k)| (S::constant(weight), q(k)));
        no_slip_wall(&self.gas, &wall, temperature, front)
    }

    fn image_state<S: Number>(&self, q: &Primitive<D, S>, transform: u8) -> Primitive<D, S> {
        Primitive { velocity: self.discretisation.cloud.transforms[transform as usize].direction(&q.velocity), ..*q }
    }

    /// Fills `work.gradient` from `work.state`.
    pub fn fill_gradients<S: Number>(&self, frame: &Frame<D>, work: &mut Work<D, S>) {
        let (cloud, op) = (&frame.discretisation.cloud, &frame.discretisation.operators);
        let state = &work.state;
        let (rows, rest) = work.gradient.split_at_mut(cloud.n_rows());
        sweep_parts(&op.parts, 1, rows, &|k, out| {
            let start = op.parts[k].start;
            out.fill(Gradient::zero());
            let inverse = op.inverse();
            if inverse.is_empty() {
                for (e, [a_i, a_j]) in op.weighed_edges(cloud, k) {
                    let dq = state[e.j()].minus(&state[e.i()]);
                    out[e.i() - start].add(&a_i, &dq);
                    if e.both() {
                        out[e.j() - start].add(&-a_j, &dq);
                    }
                }
                return;
            }
            shared_sums(op.edges(k), (&cloud.x, state), &inverse[start..], (start, out));
        });
        cloud.first_order.iter().for_each(|i| rows[*i as usize] = Gradient::zero());
        let rows = &*rows;
        let (outer, ghosts) = rest.split_at_mut(cloud.outer.len());
        sweep(outer, |k| {
            let source =
                rows.get(cloud.outer[k].source as usize).filter(|_| OpenSide::of(cloud.outer[k].side).varies());
            source.copied().unwrap_or_else(Gradient::zero)
        });
        sweep(ghosts, |k| {
            let image = &cloud.ghosts[k];
            let t = &cloud.transforms[image.transform as usize];
            rows.get(image.source as usize).map_or_else(Gradient::zero, |g| Gradient {
                density: t.direction(&g.density),
                velocity: std::array::from_fn(|c| t.direction(&g.velocity[c]).times(t.sign[c])),
                pressure: t.direction(&g.pressure),
            })
        });
        match &work.frozen {
            None => self.fill_steepness(frame, work),
            Some(frozen) => sweep(&mut work.steepness, |i| S::constant(frozen.steepness[i])),
        }
    }

    fn fill_steepness<S: Number>(&self, frame: &Frame<D>, work: &mut Work<D, S>) {
        let cloud = &frame.discretisation.cloud;
        let (state, gradient) = (&work.state, &work.gradient);
        let (rows, rest) = work.steepness.split_at_mut(cloud.n_rows());
        sweep(rows, |i| gradient[i].steepness(cloud.spacing[i], state[i].pressure));
        let rows = &*rows;
        let ghosts = &mut rest[cloud.outer.len()..];
        sweep(ghosts, |k| rows.get(cloud.ghosts[k].source as usize).copied().unwrap_or(S::constant(0.0)));
    }

    /// Force of the pressure on all bodies in the axes of the case, from the wall states in `work`.
    pub fn pressure_force<S: Number>(&self, frame: &Frame<D>, work: &Work<D, S>) -> Vector<D, S> {
        let cloud = &frame.discretisation.cloud;
        let walls = &work.state[cloud.interface_range()];
        let far = self.far_field.pressure();
        let push = |w: usize, d: usize| S::constant(-cloud.interface[w].area[d]) * (walls[w].pressure - far);
        let force = Vector::from_fn(|d| S::sum(walls.len(), |w| push(w, d)));
        frame.to_inertial_axes(&force)
    }
}

/// Gradients of the rows from `start` on, where both ends of an edge sum the same and only then make gradients of it.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn shared_sums<const D: usize, S: Number>(
    edges: &[Edge<D>],
    (x, state): (&[Vector<D>], &[Primitive<D, S>]),
    inverse: &[Symmetric<D>],
    (start, out): (usize, &mut [Gradient<D, S>]),
) {
    for e in edges {
        let (d, dq) = (x[e.j()] - x[e.i()], state[e.j()].minus(&state[e.i()]));
        let scaled = d * (1.0 / d.norm_squared());
        out[e.i() - start].add(&scaled, &dq);
        if e.both() && e.seen_back() {
            out[e.j() - start].add(&scaled, &dq);
        }
    }
    for (g, m) in out.iter_mut().zip(inverse) {
        let m = m.full();
        *g = g.map(|v| Vector::from_fn(|r| v.along(&Vector(m[r]))));
    }
}
