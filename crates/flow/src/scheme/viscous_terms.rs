//! Viscous terms of the whole cloud: walls, spectral radii and linearisation; the module `edges` computes the fluxes
//! between particles.
//!
//! The pointwise functions and their derivation are in `viscous`.
use std::sync::Arc;

use super::block::Block;
use super::edge_flux::half_face;
use super::fluid::{Fluid, Work};
use super::frame::Frame;
use super::lanes::Number;
use super::viscous::{
    ViscousModel, WallSlopes, at_contact, direction, reach, slope_weights, slopes, temperature_gradient, thin_layer,
};
use super::wall_fits::lowest_two;
use super::wall_motion::WallMotion;
use crate::cloud::operators::WallFace;
use crate::cloud::{Cloud, Edge};
use crate::math::Vector;
use crate::math::block_matrix::Rows;
use crate::math::parallel::sweep_parts;
use crate::physics::viscous::Slopes;
use crate::physics::{Conserved, Primitive};

impl<const D: usize> Fluid<D> {
    /// Viscous flux at particle `i` across `n`; zero for an inviscid gas.
    pub(super) fn viscous_flux(&self, work: &Work<D>, i: usize, n: &Vector<D>) -> Conserved<D> {
        let flux =
            |f: &Arc<ViscousModel>| f.medium.flux(&self.gas, &slopes(&self.gas, &work.state[i], &work.gradient[i]), n);
        self.viscous_model.as_ref().map_or(Conserved::ZERO, flux)
    }

    /// Calls `add(i, change)` with the viscous contribution of every wall face to V dU/dt of the particle there.
    pub(super) fn viscous_walls<S: Number>(
        &self,
        faces: &[WallFace<D>],
        at: (&Frame<D>, &Work<D, S>),
        add: &mut impl FnMut(usize, &Conserved<D, S>),
    ) {
        let Some(viscous_model) = &self.viscous_model else { return };
        for face in faces {
            let mut through = self.viscous_wall(viscous_model, at, face);
            if at.0.taken_by(face).is_some() {
                // the given wall traction includes friction: only the heat flux remains
                through.energy = through.energy - through.momentum.along(&at.0.velocity_of(face.wall as usize));
                through.momentum = Vector::zero();
            }
            add(face.i as usize, &through);
        }
    }

    /// Viscous flux through a wall face.
    fn viscous_wall<S: Number>(
        &self,
        viscous_model: &ViscousModel,
        (frame, work): (&Frame<D>, &Work<D, S>),
        face: &WallFace<D>,
    ) -> Conserved<D, S> {
        let cloud = &frame.discretisation.cloud;
        let source = cloud.source(face.wall as usize);
        let w = source.index - cloud.n_fluid;
        let Some(at) = self.at_wall(viscous_model, (cloud, work), w, frame.walls.get(w)) else {
            return Conserved::zero();
        };
        let area = Vector::constant(&face.area);
        if !source.image {
            return viscous_model.medium.flux(&self.gas, &at, &area);
        }
        let transform = &cloud.transforms[cloud.ghosts[face.wall as usize - cloud.n_real()].transform as usize];
        let through = viscous_model.medium.flux(&self.gas, &at, &transform.direction(&area));
        Conserved { momentum: transform.direction(&through.momentum), ..through }
    }

    /// Velocity, temperature and their gradients on the wall of interface particle `w`, which moves with `motion`;
    /// `None` at slip walls.
    fn at_wall<S: Number>(
        &self,
        viscous_model: &ViscousModel,
        (cloud, work): (&Cloud<D>, &Work<D, S>),
        w: usize,
        motion: Option<&WallMotion<D>>,
    ) -> Option<Slopes<D, S>> {
        let wall_condition = viscous_model.wall_condition(cloud.interface[w].body);
        if wall_condition.slips() {
            return None;
        }
        let (i, normal) = (cloud.n_fluid + w, &cloud.interface[w].normal);
        let wall = &work.state[i];
        let temperature = self.gas.temperature(wall);
        let (rate, heating) = match lowest_two(cloud, w) {
            Some((particles, heights)) => {
                let [a, b] = slope_weights(heights);
                let [p, q] = particles.map(|k| &work.state[k]);
                let heat = |q: &Primitive<D, S>| self.gas.temperature(q) - temperature;
                let rate = (p.velocity - wall.velocity).times(a) + (q.velocity - wall.velocity).times(b);
                (rate, heat(p) * a + heat(q) * b)
            }
            None => {
                let g = &work.gradient[i];
                let rate = Vector::from_fn(|c| g.velocity[c].along(normal));
                (rate, temperature_gradient(&self.gas, wall, g).along(normal))
            }
        };
        let heating = wall_condition.heat(heating);
        let normal_of = |s: S| Vector::constant(normal) * s;
        Some(Slopes {
            velocity: wall.velocity,
            temperature,
            velocity_gradient: std::array::from_fn(|c| {
                let along = motion.map_or(Vector::ZERO, |m| {
                    m.wall_velocity_gradient[c] - *normal * m.wall_velocity_gradient[c].dot(normal)
                });
                normal_of(rate[c]) + Vector::constant(&along)
            }),
            temperature_gradient: normal_of(heating),
        })
    }

    /// Stress and heat flux on the wall of interface particle `w`, which moves with `motion`, from the states and
    /// gradients in `work`; `None` at slip walls.
    pub(super) fn wall_slopes<S: Number>(
        &self,
        (cloud, work): (&Cloud<D>, &Work<D, S>),
        w: usize,
        motion: Option<&WallMotion<D>>,
    ) -> Option<WallSlopes<D, S>> {
        let viscous_model = self.viscous_model.as_ref()?;
        let at = self.at_wall(viscous_model, (cloud, work), w, motion)?;
        let still = Slopes { velocity: Vector::zero(), ..at };
        let through = viscous_model.medium.flux(&self.gas, &still, &Vector::constant(&cloud.interface[w].normal));
        Some(WallSlopes { stress: through.momentum, heat: through.energy })
    }

    /// Adds the decay rates of differences between particles by viscosity and heat conduction.
    pub(super) fn add_viscous_rate(
        &self,
        viscous_model: &ViscousModel,
        (frame, work): (&Frame<D>, &Work<D>),
        rate: &mut [f64],
    ) {
        let (op, cloud) = (&frame.discretisation.operators, &frame.discretisation.cloud);
        sweep_parts(op.fluid_parts(), 1, rate, &|k, out| {
            let start = op.parts[k].start;
            let diffusivity = |i: usize| viscous_model.medium.diffusivity(&self.gas, &work.state[i]);
            for (e, weights) in op.weighed_edges(cloud, k) {
                let (to_i, to_j) = self.exchange((e, &weights), cloud);
                out[e.i() - start] += to_i * diffusivity(e.i());
                if e.both() {
                    out[e.j() - start] += to_j * diffusivity(e.j());
                }
            }
            for face in op.wall_faces(k).iter().filter(|_| self.conservative) {
                let i = face.i as usize;
                out[i - start] += self.wall_exchange(cloud, face)[0].1 * diffusivity(i);
            }
        });
    }

    /// Area divided by volume and distance of the face of an edge, for each end.
    #[inline(always)]
    fn exchange(&self, (e, weights): (&Edge<D>, &[Vector<D>; 2]), cloud: &Cloud<D>) -> (f64, f64) {
        let d = cloud.x[e.j()] - cloud.x[e.i()];
        let m = direction(&e.s, &d);
        let across = 2.0 / reach(&d, &m);
        let [a_i, a_j] = match self.conservative {
            true => [half_face(cloud.volume[e.i()], &e.s), -half_face(cloud.volume[e.j()], &e.s)],
            false => *weights,
        };
        (a_i.dot(&m).max(0.0) * across, (-a_j.dot(&m)).max(0.0) * across)
    }

    /// Particles on which the slope at a wall face depends, with the derivative times area divided by volume.
    fn wall_exchange(&self, cloud: &Cloud<D>, face: &WallFace<D>) -> [(usize, f64); 2] {
        let (i, wall) = (face.i as usize, face.wall as usize);
        let size = face.area.norm();
        let area = size / cloud.volume[i];
        let column = wall.checked_sub(cloud.n_fluid).filter(|_| wall < cloud.n_rows());
        if let Some((particles, heights)) = column.and_then(|w| lowest_two(cloud, w)).filter(|c| c.0[0] == i) {
            let [a, b] = slope_weights(heights);
            return [(particles[0], area * a), (particles[1], area * b)];
        }
        let normal = face.area * (1.0 / size.max(f64::MIN_POSITIVE));
        [(i, area / reach(&(cloud.x[wall] - cloud.x[i]), &normal)), (i, 0.0)]
    }

    /// Viscosity times area divided by volume and distance of an edge, for each end, and the [`thin_layer`] blocks of
    /// both ends.
    #[inline(always)]
    pub(super) fn viscous_edge(
        &self,
        work: &Work<D>,
        (e, weights): (&Edge<D>, &[Vector<D>; 2]),
        cloud: &Cloud<D>,
    ) -> ((f64, f64), [Block; 2]) {
        let mut layers = [[[0.0; 5]; 5]; 2];
        let Some(viscous_model) = &self.viscous_model else { return ((0.0, 0.0), layers) };
        let (medium, ends) = (&viscous_model.medium, [&work.state[e.i()], &work.state[e.j()]]);
        let mu = 0.5 * (medium.at(self.gas.temperature(ends[0])) + medium.at(self.gas.temperature(ends[1])));
        let m = direction(&e.s, &(cloud.x[e.j()] - cloud.x[e.i()]));
        let (to_i, to_j) = self.exchange((e, weights), cloud);
        for side in 0..2 {
            thin_layer(&self.gas, medium, ends[side], &m, &mut layers[side]);
        }
        ((mu * to_i, mu * to_j), layers)
    }

    /// Adds −∂/∂U of the viscous fluxes through wall faces.
    pub(super) fn add_viscous_walls(
        &self,
        (frame, work): (&Frame<D>, &Work<D>),
        faces: &[WallFace<D>],
        rows: &mut Rows<'_>,
    ) {
        let Some(viscous_model) = &self.viscous_model else { return };
        let (cloud, medium) = (&frame.discretisation.cloud, &viscous_model.medium);
        for face in faces {
            let source = cloud.source(face.wall as usize).index;
            let wall_condition = viscous_model.wall_condition(cloud.interface[source - cloud.n_fluid].body);
            if wall_condition.slips() {
                continue;
            }
            let n = face.area.unit();
            let viscosity = medium.at(self.gas.temperature(&work.state[source]));
            for (q, weight) in self.wall_exchange(cloud, face) {
                let block =
                    at_contact(&self.gas, medium, (&work.state[q], &work.state[source].velocity), (wall_condition, &n));
                rows.add(face.i as usize, q, |r, c| viscosity * weight * block[r][c]);
            }
        }
    }
}

#[cfg(test)]
mod tests;
