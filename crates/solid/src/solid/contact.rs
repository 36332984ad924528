//! Contact by the penalty method, of a solid with rigid planes and of its bodies with one another.
//!
//! A surface particle that penetrates a plane by the depth g is pushed back by the force k g with k = s (K + 4/3 μ)
//! A/h, so that the energy ½ k g² is recovered. Two surface particles of different bodies that are nearer to each other
//! than one spacing are pushed apart along their connecting line in the same way; bodies in contact are therefore one
//! spacing apart. Friction follows Coulomb's law, regularised at small sliding velocities.
use super::body::{Contact, Solid};
use super::forces::State;
use crate::cloud::grid::Grid;
use crate::math::Vector;
use crate::math::reduce::maximum;

/// Sliding velocity, as a fraction of the speed of pressure waves, below which friction is reduced in proportion.
const STICKS: f64 = 1e-4;

/// Contact force on one particle or one pair.
struct Push<const D: usize> {
    force: Vector<D>,
    energy: f64,
}

impl<const D: usize> Solid<D> {
    /// Contact stiffness k of a surface particle.
    pub(super) fn contact_stiffness(&self, i: usize, stiffness: f64) -> f64 {
        let h = self.particles.spacing[i];
        // at a corner, the areas of the adjacent sides cancel in part
        let area = self.particles.area[i].norm().max(0.5 * h.powi(D as i32 - 1) * self.particles.around(i));
        stiffness * self.material_of(i).moduli.pressure_wave() * area / h
    }

    pub(super) fn is_on_surface(&self, i: usize) -> bool {
        self.particles.area[i] != Vector::ZERO
    }

    /// Calls `f(i, push, sliding)` for every particle that penetrates a plane.
    fn on_planes(&self, contact: &Contact<D>, state: &State<'_, D>, mut f: impl FnMut(usize, Push<D>, Vector<D>)) {
        for plane in &contact.planes {
            for i in (0..self.len()).filter(|i| self.is_on_surface(*i)) {
                let x = self.particles.x[i] + Vector(state.displacement[i]);
                let depth = -(x - plane.point).dot(&plane.normal);
                if depth > 0.0 {
                    let k = self.contact_stiffness(i, contact.stiffness);
                    let v = Vector(state.velocity[i]);
                    let sliding = v - plane.normal * v.dot(&plane.normal);
                    f(i, Push { force: plane.normal * (k * depth), energy: 0.5 * k * depth * depth }, sliding);
                }
            }
        }
    }

    /// Friction force on a particle with the contact force `pressed` and the sliding velocity `sliding`.
    fn friction(&self, i: usize, contact: &Contact<D>, pressed: f64, sliding: &Vector<D>) -> Vector<D> {
        let speed = sliding.norm();
        let slow = STICKS * self.material_of(i).pressure_wave_speed();
        *sliding * (-contact.friction * pressed / (speed * speed + slow * slow).sqrt())
    }

    /// Calls `f(i, j, push)` for every pair of particles of different bodies in contact; the push acts on particle i.
    fn between_bodies(&self, contact: &Contact<D>, state: &State<'_, D>, mut f: impl FnMut(usize, usize, Push<D>)) {
        let several = self.body.iter().any(|b| *b != self.body[0]);
        if !contact.bodies || !several {
            return;
        }
        let largest = maximum(self.len(), |i| self.particles.spacing[i]);
        let mut grid = Grid::new(largest);
        let at = |i: usize| self.particles.x[i] + Vector(state.displacement[i]);
        let skin: Vec<usize> = (0..self.len()).filter(|i| self.is_on_surface(*i)).collect();
        skin.iter().for_each(|i| grid.insert(&at(*i), *i as u32));
        let mut near = Vec::new();
        for i in skin {
            near.clear();
            grid.near(&at(i), largest, |j| near.push(j as usize));
            near.retain(|j| *j > i && self.body[*j] != self.body[i]);
            near.sort_unstable();
            for j in near.iter().copied() {
                let (d, reach) = (at(i) - at(j), 0.5 * (self.particles.spacing[i] + self.particles.spacing[j]));
                let r = d.norm();
                if r < reach && r > 0.0 {
                    let [a, b] = [i, j].map(|i| self.contact_stiffness(i, contact.stiffness));
                    let (k, depth) = (2.0 * a * b / (a + b), reach - r);
                    f(i, j, Push { force: d * (k * depth / r), energy: 0.5 * k * depth * depth });
                }
            }
        }
    }

    /// Adds the contact forces.
    pub(super) fn add_contact(&self, state: &State<'_, D>, force: &mut [[f64; D]]) {
        let Some(contact) = &self.contact else { return };
        let mut add = |i: usize, push: &Vector<D>| (0..D).for_each(|a| force[i][a] += push[a]);
        self.on_planes(contact, state, |i, push, sliding| {
            let rubbed = self.friction(i, contact, push.force.norm(), &sliding);
            add(i, &(push.force + rubbed));
        });
        self.between_bodies(contact, state, |i, j, push| {
            add(i, &push.force);
            add(j, &-push.force);
        });
    }

    /// Elastic energy of contact.
    pub(super) fn contact_energy(&self, state: &State<'_, D>) -> f64 {
        let Some(contact) = &self.contact else { return 0.0 };
        let mut sum = 0.0;
        self.on_planes(contact, state, |_, push, _| sum += push.energy);
        self.between_bodies(contact, state, |_, _, push| sum += push.energy);
        sum
    }

    /// Power dissipated by friction.
    pub(super) fn rubbed(&self, state: &State<'_, D>) -> f64 {
        let Some(contact) = &self.contact else { return 0.0 };
        let mut sum = 0.0;
        self.on_planes(contact, state, |i, push, sliding| {
            sum -= self.friction(i, contact, push.force.norm(), &sliding).dot(&sliding);
        });
        sum
    }
}
