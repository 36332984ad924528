//! The gas on a cloud: dU_i/dt = R_i.
//!
//! With edge coefficients c_ij = 2a_ij and the antisymmetric vectors s_ij = V_i a_ij − V_j a_ji, m = s/|s|,
//!
//! R_i = − Σ_j { c_ij·[F(q_L) + F(q_R)]/2 + |s_ij|/V_i [F̂(q_L, q_R, m) − m·(F(q_L) + F(q_R))/2] } + F(q_i)·Σ_j c_ij:
//!
//! a consistent least-squares central flux, plus the dissipation of an upwind flux weighted by a vector that is
//! antisymmetric across every edge, so that large implicit steps converge and shocks stand across level transitions. The
//! last term carries the flux of the particle itself and keeps uniform flow exactly on any cloud. With *conservative*
//! coefficients c_ij = s_ij/V_i, and what one particle loses another gains to round-off; only pressure then acts on the
//! pieces of wall that bound a particle.
//!
//! On particles that move with w_i the term w_i·∇U is added, always with the velocity of the particle whose equation it is and
//! with the least-squares coefficients, so that uniform flow and linear fields at rest stay what they are; conservative coefficients
//! then serve the fluxes alone, and follow the cloud as it deforms ([`Operators::metric_update`]). On clouds with wall layers
//! they serve both: the gas beside a wall moves with it, and what is left of v − w must not be the difference of two sums with different
//! weights. The dissipation of an edge is that of an area that moves with the mean velocity of its ends.
//!
//! [`Operators::metric_update`]: crate::cloud::Operators::metric_update
#[cfg(test)]
mod tests;

use std::sync::Arc;

use crate::case::{Flux, Limiter, Side};
use crate::cloud::Cloud;
use crate::cloud::operators::WallFace;
use crate::math::Vector;
use crate::math::sweep::{first, maximum, sweep, sweep_each, sweep_each_slot, sweep_parts, sweep_rows};
use crate::physics::riemann::{AusmPlusUp, Hllc, Roe, Rusanov, UpwindFlux};
use crate::physics::{Conserved, Gas, Primitive};
use crate::system::{Fault, Field as Unknowns, Instant, Rate, System};

use super::boundary::slip_wall;
use super::discretisation::{CloudMotion, Discretisation, Frame, LagrangianStep};
use super::edges::{FluxScheme, Particles, edge_fluxes};
use super::preconditioner::to_inertial_axes;
use super::reconstruct::{Gradient, Limit, Reconstruction, Unlimited, VanAlbada, Venkatakrishnan};
use super::start::Field;
use super::viscous::ViscousModel;

/// The compressible Euler equations on a cloud, with friction the Navier-Stokes equations.
pub struct Fluid<const D: usize> {
    /// Particles, weights and fits before any motion.
    pub discretisation: Arc<Discretisation<D>>,
    /// How particles move.
    pub cloud_motion: CloudMotion<D>,
    /// The gas.
    pub gas: Gas,
    /// Upwind flux.
    pub flux: Flux,
    /// Slope limiter.
    pub limiter: Limiter,
    /// Order, κ, threshold.
    pub reconstruction: Reconstruction,
    /// Exactly conservative coefficients.
    pub conservative: bool,
    /// The gas keeps the entropy of the free stream.
    pub isentropic: bool,
    /// Viscosity; `None` for an inviscid gas.
    pub viscous_model: Option<Arc<ViscousModel>>,
    /// State of the far field.
    pub far_field: Arc<dyn FarField<D>>,
    /// The field at the start, which some sides hold for ever.
    pub held: Field<D>,
    /// The unknowns: density, momentum and energy of every fluid particle.
    pub fields: [Unknowns; 1],
}

/// What the far field is, given the force on the bodies.
pub trait FarField<const D: usize>: Send + Sync {
    /// State at `x` when the bodies feel the force `force` (per unit span in 2-D).
    fn state(&self, x: &Vector<D>, force: &Vector<D>) -> Primitive<D>;
    /// Static pressure far away.
    fn pressure(&self) -> f64;
}

/// Storage of an evaluation.
pub struct Work<const D: usize> {
    /// States of all particles, images included.
    pub state: Vec<Primitive<D>>,
    /// Gradients of all particles.
    pub gradient: Vec<Gradient<D>>,
}

impl<const D: usize> Fluid<D> {
    /// The unknowns on a cloud: density, momentum and energy of every fluid particle; density measures a residual.
    pub fn unknowns(cloud: &Cloud<D>) -> [Unknowns; 1] {
        [Unknowns::new("gas", cloud.n_fluid, D + 2).measured_by(1)]
    }

    /// The state at the start.
    pub fn start(&self) -> Vec<f64> {
        let cloud = &self.discretisation.cloud;
        let mut u = vec![0.0; self.len()];
        sweep_rows(&mut u, D + 2, |i, row| self.gas.conserved(&(self.held)(&cloud.x[i])).store(row));
        u
    }

    /// Fills `work.state` for every particle from the evolved ones, in the axes of `frame.discretisation`.
    pub fn fill_states(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>) {
        let (cloud, fits) = (&frame.discretisation.cloud, &frame.discretisation.walls);
        let (fluid, rest) = work.state.split_at_mut(cloud.n_fluid);
        let inward = |q: Primitive<D>| Primitive { velocity: frame.to_body_axes(&q.velocity), ..q };
        sweep(fluid, |i| inward(self.gas.primitive(&Conserved::load(&u[i * (D + 2)..]))));
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

    pub(super) fn rhs_with_limiter(&self, flux: impl UpwindFlux<D>, frame: &Frame<D>, work: &Work<D>, du: &mut [f64]) {
        match self.limiter {
            Limiter::None => self.fluxes(flux, Unlimited, (frame, work), du),
            Limiter::VanAlbada => self.fluxes(flux, VanAlbada, (frame, work), du),
            Limiter::Venkatakrishnan => self.fluxes(flux, Venkatakrishnan, (frame, work), du),
        }
    }

    /// Whether w·∇U is taken with the coefficients of the fluxes. Across thin layers these differ from the weights that are
    /// exact for linear fields, and with both of them a false flow through the layers, the difference times w, makes steps in
    /// time fail where w is large.
    pub(super) fn passes_by_faces(&self) -> bool {
        self.conservative && !self.discretisation.cloud.layers.is_empty()
    }

    /// Sums the edge fluxes of every fluid particle, weighted with volumes until the end so that no edge divides by one.
    fn fluxes(&self, flux: impl UpwindFlux<D>, limit: impl Limit, at: (&Frame<D>, &Work<D>), du: &mut [f64]) {
        let (frame, work) = at;
        let (op, cloud) = (&frame.discretisation.operators, &frame.discretisation.cloud);
        let (gas, reconstruction, conservative) = (self.gas, self.reconstruction, self.conservative);
        let medium = self.viscous_model.as_ref().map(|f| f.medium);
        let scheme =
            FluxScheme { gas, flux, limit, reconstruction, conservative, by_faces: self.passes_by_faces(), medium };
        let particles = Particles {
            x: &cloud.x,
            volume: &cloud.volume,
            state: &work.state,
            gradient: &work.gradient,
            velocity: &frame.velocity,
            outer: (cloud.outer_range().start, cloud.outer_range().end),
        };
        sweep_parts(op.fluid_parts(), D + 2, du, &|k, out| {
            let start = op.parts[k].start;
            out.fill(0.0);
            let mut to = |i: usize, change: &Conserved<D>| add(&mut out[(i - start) * (D + 2)..], change);
            edge_fluxes(&scheme, particles, op.edges(k), &mut to);
            if self.conservative {
                self.wall_fluxes(op.wall_faces(k), at, &mut to);
                self.viscous_walls(op.wall_faces(k), at, &mut to);
            }
            for (row, volume) in out.chunks_exact_mut(D + 2).zip(&cloud.volume[start..]) {
                let inverse = 1.0 / volume;
                row.iter_mut().for_each(|r| *r *= inverse);
            }
            if frame.turn.is_some() {
                out.chunks_exact_mut(D + 2).for_each(|row| to_inertial_axes(frame, row));
            }
        });
    }

    /// Pressure on the pieces of wall that bound fluid particles: no mass passes, and energy only where the wall moves.
    fn wall_fluxes(
        &self,
        faces: &[WallFace<D>],
        (frame, work): (&Frame<D>, &Work<D>),
        mut add: impl FnMut(usize, &Conserved<D>),
    ) {
        let by_faces = self.passes_by_faces();
        for face in faces {
            let (i, wall) = (face.i as usize, &work.state[face.wall as usize]);
            let own = &work.state[i];
            let moved = frame.velocity_of(face.wall as usize);
            let push = face.area * wall.pressure;
            let pressed = Conserved { density: 0.0, momentum: push, energy: push.dot(&moved) };
            let through = match frame.moves() {
                true => pressed.plus(moved.dot(&face.area), &self.gas.conserved(if by_faces { own } else { wall })),
                false => pressed,
            };
            add(i, &self.gas.flux(own, &face.area).plus(-1.0, &through));
        }
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

/// s/2V: what takes the place of a_ij when the coefficients are conservative.
#[inline(always)]
pub(super) fn half_face<const D: usize>(volume: f64, s: &Vector<D>) -> Vector<D> {
    *s * (0.5 / volume)
}

#[inline(always)]
pub(super) fn add<const D: usize>(row: &mut [f64], c: &Conserved<D>) {
    row[0] += c.density;
    for d in 0..D {
        row[1 + d] += c.momentum[d];
    }
    row[D + 1] += c.energy;
}

impl<const D: usize> System for Fluid<D> {
    type Frame = Frame<D>;
    type Work = Work<D>;

    fn fields(&self) -> &[Unknowns] {
        &self.fields
    }

    fn frame(&self, at: &Instant<'_>, u: &[f64]) -> Frame<D> {
        let cloud = &self.discretisation.cloud;
        let mut frame = Frame {
            time: at.time,
            discretisation: Arc::clone(&self.discretisation),
            turn: None,
            jets: Vec::new(),
            velocity: Arc::default(),
            walls: Arc::default(),
            lagrangian_step: LagrangianStep::default(),
            outer: (0..cloud.outer.len()).map(|k| cloud.beside(k).map(|i| (self.held)(&cloud.x[i]))).collect(),
        };
        self.place(at, &mut frame);
        self.update_boundary_state(u, &mut self.work(), &mut frame);
        frame
    }

    fn place(&self, at: &Instant<'_>, frame: &mut Frame<D>) {
        self.cloud_motion.place(&self.discretisation, at, frame);
        if matches!(at.rate, Rate::Still) {
            frame.velocity = Arc::default();
            frame.walls = Arc::default();
        }
    }

    fn plan_lagrangian_step(&self, step: f64, u: &[f64], work: &mut Work<D>, frame: &mut Frame<D>) -> f64 {
        if matches!(self.cloud_motion, CloudMotion::Travel(_)) {
            self.choose_ways(step, u, work, frame)
        } else {
            f64::INFINITY
        }
    }

    fn update_boundary_state(&self, u: &[f64], work: &mut Work<D>, frame: &mut Frame<D>) {
        self.fill_states(frame, u, work);
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

    fn work(&self) -> Work<D> {
        let blank = Primitive { density: 1.0, velocity: Vector::ZERO, pressure: 1.0 };
        let n = self.discretisation.cloud.len();
        Work { state: vec![blank; n], gradient: vec![Gradient::ZERO; n] }
    }

    fn rhs(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, du: &mut [f64]) {
        self.fill_states(frame, u, work);
        if self.reconstruction.second_order || self.viscous_model.is_some() {
            self.fill_gradients(frame, work);
        }
        match self.flux {
            Flux::Hllc => self.rhs_with_limiter(Hllc, frame, work, du),
            Flux::Roe => self.rhs_with_limiter(Roe, frame, work, du),
            Flux::AusmPlusUp => self.rhs_with_limiter(AusmPlusUp, frame, work, du),
            Flux::Rusanov => self.rhs_with_limiter(Rusanov, frame, work, du),
        }
        if self.isentropic {
            self.hold_entropy(frame, work, du);
        }
    }

    fn rates(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, rate: &mut [f64]) {
        self.fill_states(frame, u, work);
        let (op, volume) = (&frame.discretisation.operators, &frame.discretisation.cloud.volume);
        let mut sound = vec![0.0; frame.discretisation.cloud.n_fluid];
        sweep(&mut sound, |i| self.gas.sound_speed(&work.state[i]));
        let past = |i: usize| work.state[i].velocity - frame.velocity_of(i);
        let speed = |i: usize, a: &Vector<D>| past(i).dot(a).abs() + sound[i] * a.norm();
        sweep_parts(op.fluid_parts(), 1, rate, &|k, out| {
            let start = op.parts[k].start;
            out.fill(0.0);
            for e in op.edges(k) {
                let (i, j) = (e.i(), e.j());
                let (a_i, a_j) = match self.conservative {
                    true => (half_face(volume[i], &e.s), half_face(volume[j], &e.s)),
                    false => (e.a_i, e.a_j),
                };
                out[i - start] += speed(i, &a_i);
                if e.both() {
                    out[j - start] += speed(j, &a_j);
                }
            }
            for face in op.wall_faces(k).iter().filter(|_| self.conservative) {
                let i = face.i as usize;
                out[i - start] += speed(i, &half_face(volume[i], &face.area));
            }
        });
        if let Some(viscous_model) = &self.viscous_model {
            self.add_viscous_rate(viscous_model, (frame, work), rate);
        }
    }

    fn largest_change(&self, u: &[f64], du: &[f64]) -> f64 {
        let change = |i: usize| {
            let (a, b) = (Conserved::<D>::load(&u[i * (D + 2)..]), Conserved::load(&du[i * (D + 2)..]));
            let (old, new) = (self.gas.primitive(&a), self.gas.primitive(&a.plus(1.0, &b)));
            let change = (new.density / old.density - 1.0).abs().max((new.pressure / old.pressure - 1.0).abs());
            if change.is_finite() { change } else { f64::INFINITY }
        };
        maximum(self.discretisation.cloud.n_fluid, change)
    }

    fn check(&self, frame: &Frame<D>, u: &[f64]) -> Result<(), Fault> {
        let bad = |i: usize| !self.gas.primitive(&Conserved::<D>::load(&u[i * (D + 2)..])).is_physical();
        let Some(i) = first(self.discretisation.cloud.n_fluid, bad) else { return Ok(()) };
        let q = self.gas.primitive(&Conserved::<D>::load(&u[i * (D + 2)..]));
        let reason = format!("density {:.4e}, pressure {:.4e} (both must be positive)", q.density, q.pressure);
        Err(Fault { particle: i, place: frame.place(i).0.to_vec(), reason })
    }

    fn check_frame(&self, frame: &Frame<D>) -> Result<(), Fault> {
        self.volume_ratio_check(frame).map_or(Ok(()), Err)
    }

    fn locate(&self, frame: &Frame<D>, particle: usize) -> Vec<f64> {
        frame.place(particle).0.to_vec()
    }
}
