//! Stress and heat between particles and on walls.
//!
//! In the middle of the edge d = x_j − x_i, with the mean ḡ of the gradients at both ends and the direction m = s_ij/|s_ij| of
//! its face, the gradient of velocity and temperature is
//!
//! g = ḡ + m (Δf − ḡ·d)/(m·d),
//!
//! the mean, corrected so that the difference between the particles themselves counts across the face. Corrections along
//! the edge instead of m are wrong on thin layers with neighbours across the diagonals. The viscous flux F_v(g) then goes
//! through the face: +F_v·s_ij/V_i with conservative coefficients, else 2 a_ij·[F_v − F_v(g_i)], which both are zero in
//! uniform flow and for uniform stress.
//!
//! *Walls that the gas sticks to.* The velocity of an interface particle is that of the wall, its pressure follows from
//! ∂p/∂n = −ρ n·a_w and its temperature from ∂θ/∂n = 0 or is given (`boundary`). The wall takes the stress of the slope
//! ∂v/∂n = (Δv₁ η₂/η₁ − Δv₂ η₁/η₂)/(η₂ − η₁), a parabola through the wall and two layers at the heights η, or without layers
//! of the normal part of the gradient of the interface particle. Along the wall the gas turns with it: ∇v = n ∂v/∂n + G (I − nn)
//! with the rate of rotation G of the wall, so that what turns with the wall feels no stress.
//!
//! The linearisation keeps differences across the face alone (thin layer).
use std::sync::Arc;

use super::boundary::{WallMotion, no_slip_wall};
use super::discretisation::{Discretisation, Frame};
use super::fluid::{Fluid, Work, half_face};
use super::jacobian::Block;
use super::reconstruct::Gradient;
use crate::cloud::operators::WallFace;
use crate::cloud::{Cloud, Edge};
use crate::math::Vector;
use crate::math::block_matrix::Rows;
use crate::math::sweep::sweep_parts;
use crate::physics::viscous::Slopes;
use crate::physics::{Conserved, Gas, Newtonian, Primitive};

/// Smallest part of the length of an edge that counts as its extent across the face: keeps the correction bounded, and of
/// the sign that damps, where a face lies along its edge.
const SHORTEST: f64 = 0.3;

/// What the gas does on the surface of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WallCondition {
    /// It slides.
    Slip,
    /// It sticks, and no heat passes.
    Adiabatic,
    /// It sticks, at this temperature over that of the free stream.
    Temperature(f64),
}

/// Viscosity of the gas and the walls it acts on.
#[derive(Clone, Debug, PartialEq)]
pub struct ViscousModel {
    /// Viscosity and heat conduction.
    pub medium: Newtonian,
    /// One a body.
    pub wall_conditions: Vec<WallCondition>,
}

impl ViscousModel {
    /// Contact with the body of that number.
    #[inline]
    pub fn wall_condition(&self, body: u16) -> WallCondition {
        self.wall_conditions.get(usize::from(body)).copied().unwrap_or(WallCondition::Slip)
    }
}

/// Slopes of velocity and temperature along the normal of a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSlopes<const D: usize> {
    /// Stress of the gas on the wall without its pressure, force per area.
    pub stress: Vector<D>,
    /// Heat that flows from the gas into the wall, per area and time.
    pub heat: f64,
}

/// The two particles next to the wall in the column of interface particle `w`, with their heights.
#[inline]
pub(super) fn lowest_two<const D: usize>(cloud: &Cloud<D>, w: usize) -> Option<([usize; 2], [f64; 2])> {
    let column = cloud.layers.columns.get(w)?;
    let ([a, b, ..], [low, high, ..]) = (column.particles.as_slice(), column.heights.as_slice()) else { return None };
    Some(([*a as usize, *b as usize], [*low, *high]))
}

/// Weights of the slope at the wall of a parabola through zero there and values at two heights.
fn slope_weights([low, high]: [f64; 2]) -> [f64; 2] {
    [high / low / (high - low), -low / high / (high - low)]
}

/// ∇θ of θ = γp/ρ.
#[inline(always)]
fn temperature_gradient<const D: usize>(gas: &Gas, q: &Primitive<D>, g: &Gradient<D>) -> Vector<D> {
    (g.pressure - g.density * (q.pressure / q.density)) * (gas.gamma / q.density)
}

/// Extent of the edge `d` across the face with the normal `m`.
#[inline(always)]
fn reach<const D: usize>(d: &Vector<D>, m: &Vector<D>) -> f64 {
    m.dot(d).max(SHORTEST * d.norm())
}

/// Direction of the face `s` of the edge `d`.
#[inline(always)]
pub(super) fn direction<const D: usize>(s: &Vector<D>, d: &Vector<D>) -> Vector<D> {
    let face = if s.norm_squared() > 0.0 { s } else { d };
    *face * (1.0 / face.norm())
}

/// What viscous fluxes follow from at a particle with the state `q` and the gradient `g`.
#[inline(always)]
pub(super) fn slopes<const D: usize>(gas: &Gas, q: &Primitive<D>, g: &Gradient<D>) -> Slopes<D> {
    Slopes {
        velocity: q.velocity,
        temperature: gas.temperature(q),
        velocity_gradient: g.velocity,
        temperature_gradient: temperature_gradient(gas, q, g),
    }
}

/// Slopes in the middle of the edge `d` whose face has the normal `m`.
#[inline(always)]
pub(super) fn middle<const D: usize>((a, b): (&Slopes<D>, &Slopes<D>), d: &Vector<D>, m: &Vector<D>) -> Slopes<D> {
    let across = 1.0 / reach(d, m);
    let corrected = |ga: &Vector<D>, gb: &Vector<D>, change: f64| {
        let mean = (*ga + *gb) * 0.5;
        mean + *m * ((change - mean.dot(d)) * across)
    };
    let (va, vb) = (&a.velocity_gradient, &b.velocity_gradient);
    let dv = b.velocity - a.velocity;
    let dt = b.temperature - a.temperature;
    Slopes {
        velocity: (a.velocity + b.velocity) * 0.5,
        temperature: 0.5 * (a.temperature + b.temperature),
        velocity_gradient: std::array::from_fn(|c| corrected(&va[c], &vb[c], dv[c])),
        temperature_gradient: corrected(&a.temperature_gradient, &b.temperature_gradient, dt),
    }
}

impl<const D: usize> Fluid<D> {
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

    /// Flux of stress and heat at particle `i` across `n`; zero without viscosity.
    pub(super) fn viscous_flux(&self, work: &Work<D>, i: usize, n: &Vector<D>) -> Conserved<D> {
        let flux =
            |f: &Arc<ViscousModel>| f.medium.flux(&self.gas, &slopes(&self.gas, &work.state[i], &work.gradient[i]), n);
        self.viscous_model.as_ref().map_or(Conserved::ZERO, flux)
    }

    /// Calls `add(i, change)` with what stress and heat through every piece of wall add to V dU/dt of the particle there.
    pub(super) fn viscous_walls(
        &self,
        faces: &[WallFace<D>],
        at: (&Frame<D>, &Work<D>),
        mut add: impl FnMut(usize, &Conserved<D>),
    ) {
        let Some(viscous_model) = &self.viscous_model else { return };
        faces.iter().for_each(|face| add(face.i as usize, &self.viscous_wall(viscous_model, at, face)));
    }

    /// Flux of stress and heat through a piece of wall.
    fn viscous_wall(
        &self,
        viscous_model: &ViscousModel,
        (frame, work): (&Frame<D>, &Work<D>),
        face: &WallFace<D>,
    ) -> Conserved<D> {
        let cloud = &frame.discretisation.cloud;
        let source = cloud.source(face.wall as usize);
        let w = source.index - cloud.n_fluid;
        let Some(at) = self.at_wall(viscous_model, (cloud, work), w, frame.walls.get(w)) else {
            return Conserved::ZERO;
        };
        if !source.image {
            return viscous_model.medium.flux(&self.gas, &at, &face.area);
        }
        let transform = &cloud.transforms[cloud.ghosts[face.wall as usize - cloud.n_real()].transform as usize];
        let through = viscous_model.medium.flux(&self.gas, &at, &transform.direction(&face.area));
        Conserved { momentum: transform.direction(&through.momentum), ..through }
    }

    /// Slopes on the wall of interface particle `w` that moves with `motion`; `None` where the gas slides.
    fn at_wall(
        &self,
        viscous_model: &ViscousModel,
        (cloud, work): (&Cloud<D>, &Work<D>),
        w: usize,
        motion: Option<&WallMotion<D>>,
    ) -> Option<Slopes<D>> {
        let wall_condition = viscous_model.wall_condition(cloud.interface[w].body);
        if wall_condition == WallCondition::Slip {
            return None;
        }
        let (i, normal) = (cloud.n_fluid + w, &cloud.interface[w].normal);
        let wall = &work.state[i];
        let temperature = self.gas.temperature(wall);
        let (rate, heating) = match lowest_two(cloud, w) {
            Some((particles, heights)) => {
                let [a, b] = slope_weights(heights);
                let [p, q] = particles.map(|k| &work.state[k]);
                let heat = |q: &Primitive<D>| self.gas.temperature(q) - temperature;
                let rate = (p.velocity - wall.velocity) * a + (q.velocity - wall.velocity) * b;
                (rate, heat(p) * a + heat(q) * b)
            }
            None => {
                let g = &work.gradient[i];
                let rate = Vector::from_fn(|c| g.velocity[c].dot(normal));
                (rate, temperature_gradient(&self.gas, wall, g).dot(normal))
            }
        };
        let heating = if wall_condition == WallCondition::Adiabatic { 0.0 } else { heating };
        Some(Slopes {
            velocity: wall.velocity,
            temperature,
            velocity_gradient: std::array::from_fn(|c| {
                let along = motion.map_or(Vector::ZERO, |m| {
                    m.wall_velocity_gradient[c] - *normal * m.wall_velocity_gradient[c].dot(normal)
                });
                *normal * rate[c] + along
            }),
            temperature_gradient: *normal * heating,
        })
    }

    /// Stress and heat on the wall of interface particle `w`, which moves with `motion`, from the states and gradients in
    /// `work`; `None` where the gas slides.
    pub(super) fn wall_slopes(
        &self,
        (cloud, work): (&Cloud<D>, &Work<D>),
        w: usize,
        motion: Option<&WallMotion<D>>,
    ) -> Option<WallSlopes<D>> {
        let viscous_model = self.viscous_model.as_ref()?;
        let at = self.at_wall(viscous_model, (cloud, work), w, motion)?;
        let still = Slopes { velocity: Vector::ZERO, ..at };
        let through = viscous_model.medium.flux(&self.gas, &still, &cloud.interface[w].normal);
        Some(WallSlopes { stress: through.momentum, heat: through.energy })
    }

    /// Adds the rates at which viscosity and conduction even out differences between particles.
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
            for e in op.edges(k) {
                let (to_i, to_j) = self.exchange(e, cloud);
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

    /// Area over volume and distance of the face of an edge, as each end sees it.
    #[inline(always)]
    fn exchange(&self, e: &Edge<D>, cloud: &Cloud<D>) -> (f64, f64) {
        let d = cloud.x[e.j()] - cloud.x[e.i()];
        let m = direction(&e.s, &d);
        let across = 2.0 / reach(&d, &m);
        let (a_i, a_j) = match self.conservative {
            true => (half_face(cloud.volume[e.i()], &e.s), -half_face(cloud.volume[e.j()], &e.s)),
            false => (e.a_i, e.a_j),
        };
        (a_i.dot(&m).max(0.0) * across, (-a_j.dot(&m)).max(0.0) * across)
    }

    /// Particles that the slope at a piece of wall depends on, with its derivative times area over volume.
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

    /// Viscosity times area over volume and distance of an edge, as each end sees it, and what [`thin_layer`] gives for both ends.
    #[inline(always)]
    pub(super) fn viscous_edge(&self, work: &Work<D>, e: &Edge<D>, cloud: &Cloud<D>) -> ((f64, f64), [Block; 2]) {
        let mut layers = [[[0.0; 5]; 5]; 2];
        let Some(viscous_model) = &self.viscous_model else { return ((0.0, 0.0), layers) };
        let (medium, ends) = (&viscous_model.medium, [&work.state[e.i()], &work.state[e.j()]]);
        let mu = 0.5 * (medium.at(self.gas.temperature(ends[0])) + medium.at(self.gas.temperature(ends[1])));
        let m = direction(&e.s, &(cloud.x[e.j()] - cloud.x[e.i()]));
        let (to_i, to_j) = self.exchange(e, cloud);
        for side in 0..2 {
            thin_layer(&self.gas, medium, ends[side], &m, &mut layers[side]);
        }
        ((mu * to_i, mu * to_j), layers)
    }

    /// Adds −∂/∂U of stress and heat on pieces of wall.
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
            if wall_condition == WallCondition::Slip {
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

/// ∂/∂U of (0, v + m (m·v)/3, v̄·(the same) + γ/Pr e) at the state `q`, v̄ held: what differences across a face of normal `m`
/// exchange, over the viscosity.
#[inline(always)]
fn thin_layer<const D: usize>(gas: &Gas, medium: &Newtonian, q: &Primitive<D>, m: &Vector<D>, block: &mut Block) {
    motion(q, m, block);
    let heat = energy(q, gas);
    let e = D + 1;
    for c in 0..D + 2 {
        let work: f64 = (0..D).map(|d| q.velocity[d] * block[1 + d][c]).sum();
        block[e][c] = work + gas.gamma / medium.prandtl * heat[c];
    }
}

/// The same at a wall with the given velocity.
fn at_contact<const D: usize>(
    gas: &Gas,
    medium: &Newtonian,
    (q, wall): (&Primitive<D>, &Vector<D>),
    (wall_condition, n): (WallCondition, &Vector<D>),
) -> Block {
    let mut block = [[0.0; 5]; 5];
    motion(q, n, &mut block);
    let heat = energy(q, gas);
    let conducts = if wall_condition == WallCondition::Adiabatic { 0.0 } else { gas.gamma / medium.prandtl };
    for c in 0..D + 2 {
        let work: f64 = (0..D).map(|d| wall[d] * block[1 + d][c]).sum();
        block[D + 1][c] = work + conducts * heat[c];
    }
    block
}

/// ∂/∂U of v + m (m·v)/3, in the rows of momentum of a block that is zero.
#[inline(always)]
fn motion<const D: usize>(q: &Primitive<D>, m: &Vector<D>, block: &mut Block) {
    let across = q.velocity.dot(m);
    for d in 0..D {
        block[1 + d][0] = -(q.velocity[d] + m[d] * across / 3.0) / q.density;
        for c in 0..D {
            block[1 + d][1 + c] = m[d] * m[c] / (3.0 * q.density);
        }
        block[1 + d][1 + d] += 1.0 / q.density;
    }
}

/// ∂e/∂U of the internal energy per mass.
#[inline(always)]
fn energy<const D: usize>(q: &Primitive<D>, gas: &Gas) -> [f64; 5] {
    let mut row = [0.0; 5];
    row[0] = (q.velocity.norm_squared() - gas.energy(q) / q.density) / q.density;
    (0..D).for_each(|d| row[1 + d] = -q.velocity[d] / q.density);
    row[D + 1] = 1.0 / q.density;
    row
}

#[cfg(test)]
mod tests;
