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

use super::discretisation::CloudMotion;
use super::edge_flux::{EdgeEnd, EdgeFace, FluxScheme, beyond_mean, mean_through};
use super::edges::{Particles, edge_fluxes};
use super::fluid::{Fluid, Frozen, Work};
use super::frame::Frame;
use super::lanes::{Number, told};
use super::reconstruct::{Factors, Limit, Unlimited, VanAlbada, Venkatakrishnan};
use crate::case::Limiter;
use crate::cloud::Edge;
use crate::cloud::operators::WallFace;
use crate::math::Vector;
use crate::math::parallel::sweep_parts;
use crate::physics::{Conserved, n_variables};

impl<const D: usize> Fluid<D> {
    /// Fills `du` with R from the states in `work`.
    pub(super) fn residual<S: Number>(&self, frame: &Frame<D>, work: &mut Work<D, S>, du: &mut [f64]) {
        if self.reconstruction.second_order || self.viscous_model.is_some() {
            self.fill_gradients(frame, work);
        }
        let work = &*work;
        self.fluxes((frame, work), du);
        if self.isentropic {
            self.hold_entropy(frame, work, du);
        }
    }

    /// Whether w·∇U is taken with the coefficients of the fluxes. Across thin layers these differ from the weights that are
    /// exact for linear fields, and with both of them a false flow through the layers, the difference times w, makes steps in
    /// time fail where w is large.
    pub(super) fn passes_by_faces(&self) -> bool {
        let deforms = matches!(self.cloud_motion, CloudMotion::Along { .. });
        self.conservative && (deforms || !self.discretisation.cloud.layers.is_empty())
    }

    /// Has the limiter leave of all slopes from now on what it leaves of them in the state `u`, and shocks be where they are there.
    pub fn freeze_limiter(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>) {
        work.frozen = None;
        self.fill_states(frame, u, work);
        if !self.reconstruction.second_order {
            return;
        }
        self.fill_gradients(frame, work);
        let factors = match self.limiter {
            Limiter::None => self.factors(Unlimited, frame, work),
            Limiter::VanAlbada => self.factors(VanAlbada, frame, work),
            Limiter::Venkatakrishnan => self.factors(Venkatakrishnan, frame, work),
        };
        work.frozen = Some(Arc::new(Frozen { factors, steepness: work.steepness.clone() }));
    }

    /// What the limiter leaves of the slopes at the ends of all edges, part by part.
    fn factors(&self, limit: impl Limit, frame: &Frame<D>, work: &Work<D>) -> Vec<Vec<Factors<D>>> {
        let (op, x) = (&frame.discretisation.operators, &frame.discretisation.cloud.x);
        let of = |e: &Edge<D>| {
            let (ends, d) = ([e.i(), e.j()], x[e.j()] - x[e.i()]);
            let q = ends.map(|i| work.state[i]);
            let slopes = ends.map(|i| work.gradient[i].along(&d).times(1.0 - work.steepness[i]));
            self.reconstruction.factors(&self.gas, limit, (&q[0], &q[1]), (&slopes[0], &slopes[1]))
        };
        (0..op.n_fluid_parts).map(|k| op.edges(k).iter().map(of).collect()).collect()
    }

    /// Sums the edge fluxes of every fluid particle, weighted with volumes until the end so that no edge divides by one.
    pub(super) fn fluxes<S: Number>(&self, at: (&Frame<D>, &Work<D, S>), du: &mut [f64]) {
        let (frame, work) = at;
        let (op, cloud) = (&frame.discretisation.operators, &frame.discretisation.cloud);
        let scheme = self.flux_scheme();
        let particles = Particles {
            x: &cloud.x,
            volume: &cloud.volume,
            state: &work.state,
            gradient: &work.gradient,
            steepness: &work.steepness,
            velocity: &frame.velocity,
            outer: (cloud.outer_range().start, cloud.outer_range().end),
        };
        sweep_parts(op.fluid_parts(), n_variables(D), du, &|k, out| {
            let start = op.parts[k].start;
            out.fill(0.0);
            let mut to = |i: usize, change: &Conserved<D, S>| {
                told(change).add_to(&mut out[(i - start) * n_variables(D)..]);
            };
            let frozen = work.frozen.as_ref().map_or(&[][..], |f| &f.factors[k]);
            edge_fluxes(&scheme, particles, (op.edges(k), op.weights(k), frozen), &mut to);
            if self.conservative {
                self.wall_fluxes(op.wall_faces(k), at, &mut to);
                self.viscous_walls(op.wall_faces(k), at, &mut to);
            }
            for (row, volume) in out.chunks_exact_mut(n_variables(D)).zip(&cloud.volume[start..]) {
                let inverse = 1.0 / volume;
                row.iter_mut().for_each(|r| *r *= inverse);
            }
            if frame.turn.is_some() {
                out.chunks_exact_mut(n_variables(D)).for_each(|row| frame.momentum_to_inertial_axes(row));
            }
        });
    }

    /// What passes the area of an edge, which moves with the mean velocity of its ends, without stress and heat.
    pub(super) fn through(&self, (frame, work): (&Frame<D>, &Work<D>), e: &Edge<D>) -> Conserved<D> {
        let ends = [e.i(), e.j()];
        let (state, moved) = (ends.map(|i| work.state[i]), ends.map(|i| frame.velocity_of(i)));
        mean_through(&self.gas, &state, &e.s, &moved).plus(1.0, &self.beyond_mean((frame, work), e))
    }

    /// What is let through an edge beyond the mean flux of its ends.
    pub(super) fn beyond_mean(&self, (frame, work): (&Frame<D>, &Work<D>), e: &Edge<D>) -> Conserved<D> {
        let x = &frame.discretisation.cloud.x;
        let ends = [e.i(), e.j()].map(|i| EdgeEnd {
            state: work.state[i],
            gradient: work.gradient[i],
            steepness: work.steepness[i],
            weight: Vector::ZERO,
            velocity: frame.velocity_of(i),
        });
        let (ends, face) = ([&ends[0], &ends[1]], EdgeFace { along: x[e.j()] - x[e.i()], area: e.s, whole: 0.0 });
        beyond_mean(&self.flux_scheme(), ends, &face)
    }

    fn flux_scheme(&self) -> FluxScheme {
        let Self { gas, flux, limiter: limit, reconstruction, conservative, .. } = *self;
        let medium = self.viscous_model.as_ref().map(|f| f.medium);
        FluxScheme { gas, flux, limit, reconstruction, conservative, by_faces: self.passes_by_faces(), medium }
    }

    /// Pressure on the pieces of wall that bound fluid particles: no mass passes, and energy only where the wall moves.
    fn wall_fluxes<S: Number>(
        &self,
        faces: &[WallFace<D>],
        (frame, work): (&Frame<D>, &Work<D, S>),
        add: &mut impl FnMut(usize, &Conserved<D, S>),
    ) {
        let by_faces = self.passes_by_faces();
        for face in faces {
            let (i, wall) = (face.i as usize, &work.state[face.wall as usize]);
            let own = &work.state[i];
            let (moved, area) = (frame.velocity_of(face.wall as usize), Vector::constant(&face.area));
            let pressed = match frame.taken_by(face) {
                None => {
                    let push = area * wall.pressure;
                    Conserved { density: S::constant(0.0), momentum: push, energy: push.along(&moved) }
                }
                Some((force, power)) => {
                    let push = face.area * self.far_field.pressure();
                    Conserved::constant(&Conserved {
                        density: 0.0,
                        momentum: push + force,
                        energy: push.dot(&moved) + power,
                    })
                }
            };
            let through = match frame.moves() {
                true => {
                    let swept = S::constant(moved.dot(&face.area));
                    pressed.plus(swept, &self.gas.conserved(if by_faces { own } else { wall }))
                }
                false => pressed,
            };
            add(i, &self.gas.flux(own, &area).minus(&through));
        }
    }
}
