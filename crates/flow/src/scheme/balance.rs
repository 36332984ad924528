//! The force on bodies from the momentum of the gas around them, which knows nothing of the pressure on the wall.
//!
//! A weight φ is 1 around the bodies and falls to 0 farther out. With the momentum m = ρ(v − v∞) beyond that of the free stream,
//! so that uniform flow adds up to nothing on any cloud, T = m v + (p − p∞)I − τ, and particles that move with w,
//!
//! F = Σ_i V_i [(T − m w)·∇φ − φ (dm/dt + m ∇·w)] + Σ_shocks (φ_j − φ_i) D_ij − Σ_sides φ (T − m w)·A:
//!
//! what passes the zone in which φ falls, less what gathers inside it. It follows from the momentum equation by parts, where on
//! the wall (v − w)·n = 0; for moments, (v − w) × m φ is added because T is not symmetric. dm/dt is the change that a particle
//! sees, in steady flow zero; fluxes of mass and energy are summed in the same way. D is what the scheme carries along the
//! edges of a shock beyond the mean flux of their ends: inside a captured shock, a few particles wide, the states of particles
//! alone do not balance, and a zone that runs along a bow shock would miss a fifth of the drag. Elsewhere they are all that is
//! asked. Sides A of the domain count where the zone is cut by them: planes of symmetry by the pressure on them, others by what the
//! scheme lets through. In space clouds have few particles to a level, and a particle farther out stands for a cell as wide as a quarter of its
//! distance: sums over particles are then off by a quarter of the square of that, since cells of a lattice balance one another's errors and cells
//! that grow do not. There each cell is taken in eight parts, with states along their gradients. Volumes of particles beside a wall are not known to all
//! digits; what they lack together follows from the walls and goes to them by area and thickness.
use super::discretisation::CloudMotion;
use super::reconstruct::smooth_step;
use super::view::View;
use crate::cloud::tree::Tree;
use crate::math::parallel::{sweep_parts, sweep_slots};
use crate::math::reduce::{maximum, sum};
use crate::math::{Bounds, Vector};
use crate::physics::{Conserved, Primitive, n_variables};

/// Distance from the box around the bodies within which φ = 1, and beyond which it is 0, in lengths of that box.
const ZONE: [f64; 2] = [0.1, 0.6];
/// The same in spacings of the interface, at least: φ must fall over several particles.
const PARTICLES: [f64; 2] = [2.0, 16.0];

/// Differences of pressure along an edge, over its mean twice, that are no shock, and that surely are one.
const JUMP: [f64; 2] = [0.01, 0.03];

/// Part of the way to a side of the domain that a zone keeps within, so that it need not be cut, and particles that must lie on it.
const WITHIN: f64 = 0.95;
const ENOUGH: f64 = 6.0;
/// Places along each axis at which cells are looked at.
const LOOKS: usize = 9;
/// Relative change of density and pressure within a cell that gradients are trusted for.
const TRUSTED: f64 = 0.3;
/// Parts that a cell in space is taken in.
const PARTS: usize = 8;

/// The weight φ: a product of quintics of the distance from a box along each axis.
#[derive(Clone, Copy, Debug)]
pub struct Zone<const D: usize> {
    bodies: Bounds<D>,
    /// Distance within which φ = 1, and beyond which it is 0, below and above the box along each axis.
    reach: [[[f64; 2]; 2]; D],
}

impl<const D: usize> Zone<D> {
    /// The zone around a box with particles at the given distance on it. `gaps` are its distances from the sides of the domain, below and
    /// above along each axis, and the greatest distance of particles in between: where a side is near, the zone ends before it if there is
    /// room for some particles; else the side cuts it.
    pub fn around(bodies: Bounds<D>, spacing: f64, gaps: &[[[f64; 2]; 2]; D]) -> Self {
        let length = bodies.extent().max_abs();
        let wanted = [0, 1].map(|k| (ZONE[k] * length).max(PARTICLES[k] * spacing));
        let reach = |[room, apart]: [f64; 2]| {
            let shorter = if room < ENOUGH * apart { 1.0 } else { (WITHIN * room / wanted[1]).min(1.0) };
            wanted.map(|reach| shorter * reach)
        };
        Self { bodies, reach: gaps.map(|axis| axis.map(reach)) }
    }

    /// The box outside of which φ = 0.
    pub fn bounds(&self) -> Bounds<D> {
        let far = |side: usize| Vector::from_fn(|d| self.reach[d][side][1]);
        Bounds { min: self.bodies.min - far(0), max: self.bodies.max + far(1) }
    }

    /// True where φ is the same all over a cube of this size around `x`.
    fn is_even(&self, x: &Vector<D>, size: f64) -> bool {
        let half = 0.5 * size;
        let distance = |d: usize| {
            let (below, above) = (self.bodies.min[d] - x[d], x[d] - self.bodies.max[d]);
            (above.max(below), self.reach[d][usize::from(above > below)])
        };
        (0..D).map(distance).all(|(r, [near, _])| r + half <= near)
            || (0..D).map(distance).any(|(r, [_, far])| r - half >= far)
    }

    /// φ and ∇φ at `x`.
    pub fn at(&self, x: &Vector<D>) -> (f64, Vector<D>) {
        let axes: [(f64, f64); D] = std::array::from_fn(|d| {
            let (below, above) = (self.bodies.min[d] - x[d], x[d] - self.bodies.max[d]);
            let (sign, [near, far]) = if above > below { (1.0, self.reach[d][1]) } else { (-1.0, self.reach[d][0]) };
            let s = ((above.max(below) - near) / (far - near)).clamp(0.0, 1.0);
            let slope = -30.0 * s * s * (1.0 - s) * (1.0 - s) / (far - near);
            (1.0 - s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), sign * slope)
        });
        let rest = |d: usize| (0..D).filter(|k| *k != d).map(|k| axes[k].0).product::<f64>();
        (axes.iter().map(|a| a.0).product(), Vector::from_fn(|d| axes[d].1 * rest(d)))
    }
}

/// What passes a cell, per volume.
struct Cell<const D: usize> {
    /// Flow along ∇φ beyond that of the free stream; flows of mass and energy as they are.
    flow: (Conserved<D>, [f64; 2]),
    /// φ m.
    momentum: Vector<D>,
    /// Moment of the force about the particle.
    couple: Vector<D>,
}

/// What one particle, what is missing beside a wall, or a piece of side adds to the balance; everything in the axes of the case.
#[derive(Clone, Copy, Debug)]
pub struct Part<const D: usize> {
    /// Where.
    pub x: Vector<D>,
    /// Force on the bodies.
    pub force: Vector<D>,
    /// Velocity v − w and weighted momentum whose product is added to the moment.
    pub carried: [Vector<D>; 2],
    /// Moment of the force about `x`, as it acts elsewhere in the cell.
    pub couple: Vector<D>,
    /// Mass that flows outward.
    pub mass: f64,
    /// Energy that flows outward.
    pub energy: f64,
    /// Mass and energy that pass the zone, whatever the direction.
    pub passed: [f64; 2],
}

/// A piece of what bounds the gas where the zone is cut.
#[derive(Clone, Copy, Debug)]
pub struct SidePiece<const D: usize> {
    /// Its middle.
    pub x: Vector<D>,
    /// Its outward area.
    pub area: Vector<D>,
}

impl<const D: usize> Part<D> {
    const BLANK: Self = Self {
        x: Vector::ZERO,
        force: Vector::ZERO,
        carried: [Vector::ZERO; 2],
        couple: Vector::ZERO,
        mass: 0.0,
        energy: 0.0,
        passed: [0.0; 2],
    };
}

/// Takes the balance of a gas at one moment.
pub struct Balance<'a, const D: usize> {
    view: View<'a, D>,
    free: Primitive<D>,
    /// The weight.
    pub zone: Zone<D>,
}

impl<'a, const D: usize> Balance<'a, D> {
    /// The balance of the gas in `view`, with its gradients; `free` is the free stream. `None` without bodies.
    pub fn new(free: Primitive<D>, view: View<'a, D>) -> Option<Self> {
        let (frame, range) = (view.frame, view.cloud().interface_range());
        if range.is_empty() {
            return None;
        }
        let places: Vec<Vector<D>> = range.clone().map(|i| frame.place(i)).collect();
        let before = Bounds::around(&view.reference().x[range.clone()]);
        let spacing = maximum(range.len(), |w| frame.discretisation.cloud.spacing[range.start + w]);
        let zone = Zone::around(Bounds::around(&places), spacing, &gaps(&view.reference().tree, &before));
        Some(Self { view, free, zone })
    }

    /// What the particles add, and what lies between them and the walls. `rate` is dU/dt of the fluid particles; empty in steady flow.
    /// `cut` are the pieces that bound the gas inside the zone, but for the walls; `None` where they are not known.
    pub fn parts(&self, rate: &[f64], cut: Option<&[SidePiece<D>]>) -> Vec<Part<D>> {
        let (frame, cloud) = (self.view.frame, self.view.cloud());
        let spread = self.spread();
        let volume = self.view.fluid.volumes();
        let first = self.view.fluid.discretisation.cloud.interface.len();
        let gathered = |i: usize| {
            let own = if rate.is_empty() { Conserved::ZERO } else { Conserved::of_row(rate, i) };
            own.momentum - self.free.velocity * own.density + self.momentum(i) * spread.get(i).map_or(0.0, |s| s.1)
        };
        let volume = |i: usize| volume[i] * spread.get(i).map_or(1.0, |s| s.0);
        let missing = cut.map(|cut| self.missing(&volume, cut));
        let in_shocks = self.carried_through_shocks();
        let mut parts = vec![Part::BLANK; first + cloud.n_fluid];
        sweep_slots(&mut parts, |k, part| {
            *part = match k.checked_sub(first) {
                None => {
                    let v = missing.map_or(0.0, |m| m * self.share(k));
                    Part { x: frame.place(cloud.n_fluid + k), force: gathered(self.beside(k)) * -v, ..Part::BLANK }
                }
                Some(i) => {
                    let x = frame.place(i);
                    let v = volume(i);
                    let weight = self.zone.at(&x).0;
                    let cell = self.cell(i, v);
                    let flow = &cell.flow;
                    let more = Conserved::of_row(&in_shocks, i);
                    let push = frame.to_inertial_axes(&more.momentum) - self.free.velocity * more.density;
                    Part {
                        x,
                        force: (flow.0.momentum - gathered(i) * weight) * v + push,
                        carried: [
                            frame.to_inertial_axes(&(self.view.work.state[i].velocity - frame.velocity_of(i))),
                            cell.momentum * v,
                        ],
                        couple: cell.couple * v,
                        mass: -v * flow.0.density - more.density,
                        energy: -v * flow.0.energy - more.energy,
                        passed: flow.1.map(|f| v * f.abs()),
                    }
                }
            };
        });
        parts
    }

    /// What the scheme carries along the edges of shocks beyond the mean flux of their ends, times the change of φ; half of it at
    /// either end.
    fn carried_through_shocks(&self) -> Vec<f64> {
        let (frame, cloud) = (self.view.frame, self.view.cloud());
        let (op, work) = (&frame.discretisation.operators, self.view.work);
        let n = n_variables(D);
        let mut carried = vec![0.0; n * cloud.n_fluid];
        sweep_parts(op.fluid_parts(), n, &mut carried, &|k, out| {
            let start = op.parts[k].start;
            for e in op.edges(k) {
                let [p, q] = [e.i(), e.j()].map(|i| work.state[i].pressure);
                let jump = (q - p).abs() / (q + p);
                let weight = smooth_step((jump - JUMP[0]) / (JUMP[1] - JUMP[0]));
                if weight == 0.0 {
                    continue;
                }
                let change = self.zone.at(&frame.place(e.j())).0 - self.zone.at(&frame.place(e.i())).0;
                if change != 0.0 {
                    let part = self.view.fluid.beyond_mean((frame, work), e).times(0.5 * weight * change);
                    part.add_to(&mut out[(e.i() - start) * n..]);
                    if e.both() {
                        part.add_to(&mut out[(e.j() - start) * n..]);
                    }
                }
            }
        });
        carried
    }

    /// Volume that the particles beside the walls lack, over the sum of the shares of the walls: ∫ ∇·(φ x) dV is known from the
    /// walls and from the pieces that cut the zone.
    fn missing(&self, volume: &(impl Fn(usize) -> f64 + Sync), cut: &[SidePiece<D>]) -> f64 {
        let (frame, cloud) = (self.view.frame, self.view.cloud());
        let middle = self.zone.bounds().centre();
        let cut = sum(cut.len(), |k| self.zone.at(&cut[k].x).0 * (cut[k].x - middle).dot(&cut[k].area));
        let n_walls = cloud.interface.len();
        let exact = sum(n_walls, |w| {
            -(frame.place(cloud.n_fluid + w) - middle).dot(&frame.to_inertial_axes(&cloud.interface[w].area))
        }) + cut;
        let particle = |i: usize| {
            let v = volume(i);
            let part = |x: Vector<D>| {
                let (weight, slope) = self.zone.at(&x);
                weight * D as f64 + slope.dot(&(x - middle))
            };
            let all = self.parts_of_cell(i, v).into_iter().flatten().map(|offset| part(frame.place(i) + offset));
            let (count, sum) = all.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
            v * sum / count
        };
        let found = sum(cloud.n_fluid, particle);
        let shares = sum(n_walls, |w| self.share(w));
        (exact - found) / D as f64 / shares
    }

    /// The part of interface particle `w` in volume that is missing: rows of particles are a spacing thick.
    fn share(&self, w: usize) -> f64 {
        let cloud = self.view.cloud();
        cloud.interface[w].area.norm() * cloud.spacing[cloud.n_fluid + w]
    }

    /// The fluid particle nearest to interface particle `w` of those it is fitted to.
    fn beside(&self, w: usize) -> usize {
        let cloud = self.view.cloud();
        let x = cloud.x[cloud.n_fluid + w];
        let near = cloud.wall_stencils.of(w).iter().map(|j| *j as usize);
        let nearest = near.min_by(|a, b| (cloud.x[*a] - x).norm_squared().total_cmp(&(cloud.x[*b] - x).norm_squared()));
        nearest.map_or(0, |j| cloud.source(j).index)
    }

    /// ρ(v − v∞) in the axes of the case.
    fn momentum(&self, i: usize) -> Vector<D> {
        self.momentum_of(&self.view.work.state[i])
    }

    fn momentum_of(&self, q: &Primitive<D>) -> Vector<D> {
        (self.view.frame.to_inertial_axes(&q.velocity) - self.free.velocity) * q.density
    }

    /// Middles of the parts that the cell of particle `i`, of volume `v`, is taken in, from its own: one in the plane and where φ does not fall.
    fn parts_of_cell(&self, i: usize, v: f64) -> [Option<Vector<D>>; PARTS] {
        let (frame, x, size) = (self.view.frame, self.view.frame.place(i), v.abs().powf(1.0 / D as f64));
        let mut all = [None; PARTS];
        if D < 3 || self.zone.is_even(&x, size) {
            all[0] = Some(Vector::ZERO);
            return all;
        }
        let offset = |k: usize| Vector::from_fn(|d| if k >> d & 1 == 0 { -0.25 * size } else { 0.25 * size });
        std::array::from_fn(|k| Some(frame.to_inertial_axes(&offset(k))))
    }

    /// What passes the cell of particle `i`, of volume `v`, as a mean over its parts.
    fn cell(&self, i: usize, v: f64) -> Cell<D> {
        let (frame, work) = (self.view.frame, self.view.work);
        let parts = self.parts_of_cell(i, v);
        let share = 1.0 / parts.iter().flatten().count() as f64;
        let mut all = Cell { flow: (Conserved::ZERO, [0.0; 2]), momentum: Vector::ZERO, couple: Vector::ZERO };
        for offset in parts.into_iter().flatten() {
            let (weight, slope) = self.zone.at(&(frame.place(i) + offset));
            let q = extended(&work.state[i], &work.gradient[i].along(&frame.to_body_axes(&offset)));
            let (flow, whole) = self.fluxes((i, &q), &frame.to_body_axes(&slope));
            all.flow.0 = all.flow.0.plus(share, &flow);
            (0..2).for_each(|k| all.flow.1[k] += share * whole[k]);
            all.momentum += self.momentum_of(&q) * (share * weight);
            let [r, f] = [offset, flow.momentum];
            all.couple += Vector::from_fn(|d| {
                let (a, b) = ((d + 1) % D, (d + 2) % D);
                if D == 3 { r[a] * f[b] - r[b] * f[a] } else { 0.0 }
            }) * share;
        }
        all
    }

    /// (T − m w)·g where the state is `q`, in the cell of particle `i`, momentum in the axes of the case, with the flows of mass and energy
    /// along g beyond those of the free stream; the whole flows.
    fn fluxes(&self, (i, q): (usize, &Primitive<D>), g: &Vector<D>) -> (Conserved<D>, [f64; 2]) {
        let (frame, gas) = (self.view.frame, &self.view.fluid.gas);
        let free = Primitive { velocity: frame.to_body_axes(&self.free.velocity), ..self.free };
        let (own, far) = (gas.flux(q, g), gas.flux(&free, g));
        let stress = self.view.fluid.viscous_flux(self.view.work, i, g);
        let push = frame.to_inertial_axes(&(*g * (q.pressure - free.pressure) - stress.momentum));
        let momentum = self.momentum_of(q) * (q.velocity - frame.velocity_of(i)).dot(g) + push;
        let energy = own.energy - far.energy - stress.energy;
        (Conserved { density: own.density - far.density, momentum, energy }, [own.density, own.energy])
    }

    /// What a piece of a plane of symmetry adds, which nothing passes: the pressure on it, beyond that of the free stream.
    pub fn pressed(&self, piece: &SidePiece<D>, pressure: f64) -> Part<D> {
        let push = piece.area * (pressure - self.free.pressure);
        Part { x: piece.x, force: push * -self.zone.at(&piece.x).0, ..Part::BLANK }
    }

    /// What passes the open sides of the domain inside the zone, with the areas that it passes: the fluxes of the scheme along the edges
    /// that end at outer particles. What outer particles hold jumps where a side is near, and the gas ends between them and the rest.
    pub fn through_sides(&self) -> Vec<(SidePiece<D>, Part<D>)> {
        let (frame, cloud) = (self.view.frame, self.view.cloud());
        let (op, state, outer) = (&frame.discretisation.operators, &self.view.work.state, cloud.outer_range());
        let mut found = Vec::new();
        for k in 0..op.fluid_parts().len() {
            for e in op.edges(k).iter().filter(|e| outer.contains(&cloud.source(e.j()).index)) {
                let x = (frame.place(e.i()) + frame.place(e.j())) * 0.5;
                let weight = self.zone.at(&x).0;
                if weight == 0.0 {
                    continue;
                }
                let area = frame.to_inertial_axes(&e.s);
                let passing = self.view.fluid.through((frame, self.view.work), e);
                let push = frame.to_inertial_axes(&passing.momentum) - self.free.velocity * passing.density;
                let swept = (frame.velocity_of(e.i()) + frame.velocity_of(e.j())).dot(&area) * 0.5;
                let ends = [e.i(), e.j()].map(|i| self.view.fluid.gas.conserved(&state[i]));
                let whole = passing.plus(0.5 * swept, &ends[0].plus(1.0, &ends[1]));
                let beyond = whole.minus(&self.view.fluid.gas.flux(&self.free, &area));
                let part = Part {
                    x,
                    force: (push - area * self.free.pressure) * -weight,
                    mass: weight * beyond.density,
                    energy: weight * beyond.energy,
                    passed: [whole.density, whole.energy].map(|f| weight * f.abs()),
                    ..Part::BLANK
                };
                found.push((SidePiece { x, area }, part));
            }
        }
        found
    }

    /// Volume of each fluid particle over that before any motion, and ∇·w; empty where both are as for a body.
    fn spread(&self) -> Vec<(f64, f64)> {
        let (frame, now) = (self.view.frame, &self.view.frame.discretisation);
        let stretched = match self.view.fluid.cloud_motion {
            CloudMotion::Still | CloudMotion::Rigid(_) => return Vec::new(),
            CloudMotion::Along { .. } => self.view.fluid.stretch(frame),
            CloudMotion::Travel(_) => vec![1.0; now.cloud.n_fluid],
        };
        let mut divergence = vec![0.0; now.cloud.n_fluid];
        let op = &now.operators;
        if frame.moves() {
            sweep_parts(op.fluid_parts(), 1, &mut divergence, &|k, out| {
                let start = op.parts[k].start;
                for (e, [a_i, a_j]) in op.weighed_edges(&now.cloud, k) {
                    let change = frame.velocity_of(e.j()) - frame.velocity_of(e.i());
                    out[e.i() - start] += a_i.dot(&change);
                    if e.both() {
                        out[e.j() - start] -= a_j.dot(&change);
                    }
                }
            });
        }
        stretched.into_iter().zip(divergence).collect()
    }
}

/// The state `q` changed by `change`; `q` alone where that is more than gradients are to be trusted for.
fn extended<const D: usize>(q: &Primitive<D>, change: &Primitive<D>) -> Primitive<D> {
    if change.density.abs() > TRUSTED * q.density || change.pressure.abs() > TRUSTED * q.pressure {
        return *q;
    }
    Primitive {
        density: q.density + change.density,
        velocity: q.velocity + change.velocity,
        pressure: q.pressure + change.pressure,
    }
}

/// Distances of a box from the sides of the domain, below and above along each axis, and the size of the largest of the cells half way to
/// each side.
fn gaps<const D: usize>(tree: &Tree<D>, around: &Bounds<D>) -> [[[f64; 2]; 2]; D] {
    let (domain, extent) = (tree.bounds(), around.extent());
    let gap = |d: usize, [inner, outer]: [f64; 2]| {
        let place = |k: usize| {
            let step = |axis: usize| (k / LOOKS.pow(axis as u32) % LOOKS) as f64 / (LOOKS - 1) as f64;
            let along = |axis: usize| around.min[axis] + step(axis) * extent[axis];
            Vector::from_fn(|axis| if axis == d { f64::midpoint(inner, outer) } else { along(axis) })
        };
        (0..LOOKS.pow(D as u32)).map(|k| tree.leaf_at(&place(k)).size).fold(0.0, f64::max)
    };
    std::array::from_fn(|d| {
        let (low, high) = ([around.min[d], domain.min[d]], [around.max[d], domain.max[d]]);
        [[low[0] - low[1], gap(d, low)], [high[1] - high[0], gap(d, high)]]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{BodyMotion, TimeFunction};
    use crate::scheme::{Fluid, built};
    use crate::system::{Instant, System, Term};

    /// Rate at which body and gas turn about the pivot.
    const OMEGA: f64 = 0.4;
    const PIVOT: Vector<2> = Vector([0.9, 0.3]);
    /// Step of the difference that gives particles their velocity.
    const STEP: f64 = 1e-4;

    /// A circle of radius 1/2 around the origin that turns about the pivot, in a viscous gas.
    fn turning(spacing: f64, mach: f64) -> (Primitive<2>, Fluid<2>) {
        let fluid = built::fluid(&format!(
            "[flow]\nmach = {mach}\nalpha = \"5 deg\"\nreynolds = 100\nviscosity_law = \"constant\"\n[[body]]\ncircle = {{ radius = 0.5 }}\n\
             [cloud]\nspacing = {spacing}\njitter = 0.1\ndomain = {{ min = [-3.2, -3.2], max = [3.2, 3.2] }}\n\
             [[cloud.box]]\nmin = [-1.6, -1.6]\nmax = [1.6, 1.6]\nspacing = {spacing}\n[time.explicit]\nuntil = 1\n"
        ));
        let law = BodyMotion::about(PIVOT, None).with_angle(TimeFunction::Steady(OMEGA));
        let cloud_motion = CloudMotion::deforming(&fluid.discretisation.cloud, vec![law], 1.0);
        ((fluid.held)(&Vector::ZERO), Fluid { cloud_motion, ..fluid })
    }

    /// Force on the circle at time `t` in the field `q` whose momentum changes at rest in space by `change`, and the middle
    /// of the circle.
    fn force(
        (free, fluid): &(Primitive<2>, Fluid<2>),
        t: f64,
        q: impl Fn(&Vector<2>) -> Primitive<2>,
        change: impl Fn(&Vector<2>, &Vector<2>) -> Vector<2>,
    ) -> (Vector<2>, Vector<2>) {
        let rate = [Term::of_time(0.5 / STEP, t + STEP), Term::of_time(-0.5 / STEP, t - STEP)];
        let frame = fluid.frame(&Instant::formula(t, &rate), &vec![1.0; fluid.len()]);
        let mut work = fluid.work();
        work.state.iter_mut().enumerate().for_each(|(i, s)| *s = q(&frame.place(i)));
        fluid.fill_gradients(&frame, &mut work);
        let mut du = vec![0.0; fluid.len()];
        for (i, row) in du.chunks_mut(4).enumerate() {
            row[1..3].copy_from_slice(&change(&frame.place(i), &frame.velocity_of(i)).0);
        }
        let balance = Balance::new(*free, View::new(fluid, &frame, &work)).unwrap();
        let sum = balance.parts(&du, Some(&[])).iter().fold(Vector::ZERO, |s, p| s + p.force);
        let walls = frame.discretisation.cloud.interface_range();
        let n = walls.len() as f64;
        (sum, walls.map(|i| frame.place(i)).fold(Vector::ZERO, |s, x| s + x * (1.0 / n)))
    }

    #[test]
    fn uniform_flow_makes_no_force_however_particles_move() {
        let at = turning(0.1, 0.5);
        let free = at.0;
        let (found, _) = force(&at, 0.7, |_| free, |_, _| Vector::ZERO);
        // velocities are differences over 2e-4 of positions with their round-off
        assert!(found.max_abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn gas_that_turns_with_the_body_holds_it_on_its_way() {
        let field = |x: &Vector<2>| {
            let d = *x - PIVOT;
            // a positive rate is nose up: clockwise
            let velocity = Vector([d[1], -d[0]]) * OMEGA;
            Primitive { density: 1.0, velocity, pressure: 1.0 / 1.4 + 0.5 * OMEGA * OMEGA * d.norm_squared() }
        };
        // particles move through a momentum that stands still in space: dm/dt = w·∇m
        let seen = |_: &Vector<2>, w: &Vector<2>| Vector([w[1], -w[0]]) * OMEGA;
        let mut errors = Vec::new();
        for spacing in [0.08, 0.04] {
            let at = turning(spacing, 1e-3);
            let (found, middle) = force(&at, 0.7, field, seen);
            let exact = (middle - PIVOT) * (-OMEGA * OMEGA * 0.25 * std::f64::consts::PI);
            errors.push((found - exact).norm() / exact.norm());
        }
        assert!(errors[1] < 0.005 && errors[1] < 0.5 * errors[0], "{errors:?}");
    }

    #[test]
    fn the_slope_of_the_weight_is_its_derivative() {
        let body = Bounds { min: Vector([0.0, -0.1]), max: Vector([1.0, 0.1]) };
        // a side at y = -0.4, another one too near to keep away from
        let gaps = [[[9.0, 0.01], [0.05, 0.01]], [[0.3, 0.01], [9.0, 0.01]]];
        let near = Zone::around(body, 0.01, &gaps).bounds();
        assert!((near.min[1] + 0.1 + 0.95 * 0.3).abs() < 1e-12 && near.max[0] > 1.5 && near.max[1] > 0.6, "{near:?}");
        let zone = Zone::around(body, 0.01, &[[[9.0, 0.01]; 2]; 2]);
        assert_eq!(zone.at(&Vector([0.5, 0.0])), (1.0, Vector::ZERO));
        assert_eq!(zone.at(&Vector([0.5, 0.8])).0, 0.0);
        for x in [Vector([1.3, 0.2]), Vector([-0.3, -0.45]), Vector([0.4, 0.5])] {
            let slope = zone.at(&x).1;
            for d in 0..2 {
                let step = Vector::axis(d) * 1e-6;
                let difference = (zone.at(&(x + step)).0 - zone.at(&(x - step)).0) / 2e-6;
                assert!((slope[d] - difference).abs() < 1e-8, "{x:?}");
            }
        }
    }
}
