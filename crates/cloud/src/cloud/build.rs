//! Construction of a cloud from a geometry and a specification.
use std::sync::Arc;

use super::Transform;
use super::clouds::Clouds;
use super::layout::{Layout, background, capped};
use super::neighbours::Search;
use super::particles::Particles;
use super::sources::Source;
use super::{Cloud, CloudError, CloudSpec, Outer, WallDistance};
use crate::geometry::Surface;
use crate::math::Vector;

/// Distance, in spacings, by which probing points are kept away from the borders of leaves, where the result would be
/// ambiguous.
const ASIDE: f64 = 1e-6;

/// Height, in spacings, of the volume that an interface particle represents.
const WALL_HEIGHT: f64 = 0.45;

impl<const D: usize> Cloud<D> {
    /// Builds a cloud around a surface, or in the whole domain when there is no surface. `extra` are sources of
    /// refinement that follow the solution. Fails when the domain does not match the spacing, when the cloud is too
    /// large, or when particles have neighbour lists that cannot be repaired.
    pub fn build(spec: &CloudSpec<D>, surface: Option<&Surface<D>>, extra: &[Source<D>]) -> Result<Self, CloudError> {
        let layout = Layout::new(spec, surface)?;
        let tree = Arc::new(background(spec, &layout, surface, extra)?);
        let transforms = layout.transforms();
        let mut particles = Particles::fill(tree, &layout, &transforms, spec, surface);
        if particles.n_fluid == 0 {
            return Err(CloudError::Empty);
        }
        let found = Search::new(&particles, surface, &transforms, spec.radius).clouds()?;
        found.repair.moved.iter().for_each(|(i, place)| particles.x[*i as usize] = *place);
        let mut cloud = Self::join(particles, found, transforms);
        cloud.notes.extend(surface.and_then(|s| capped(spec, s)));
        Ok(cloud)
    }

    /// Combines the particles with the result of the neighbour search among them.
    pub(super) fn join(particles: Particles<D>, found: Clouds<D>, transforms: Vec<Transform<D>>) -> Self {
        let Clouds { neighbours, wall_stencils, ghosts, repair, n_crevice } = found;
        let mut notes = repair.notes();
        if n_crevice > 0 {
            notes.push(format!(
                "{n_crevice} interface particles lie in crevices and take the state of the nearest fluid particles"
            ));
        }
        let outer = outer_particles(&particles);
        let mut cloud = Self {
            volume: volumes(&particles),
            x: particles.x,
            spacing: particles.spacing,
            n_fluid: particles.n_fluid,
            interface: particles.interface,
            outer,
            ghosts,
            transforms,
            wall_distance: WallDistance::new(&particles.wall_distance),
            neighbours,
            wall_stencils,
            layers: particles.layers,
            leaves: particles.leaves,
            tree: particles.tree,
            first_order: repair.first_order,
            notes,
        };
        cloud.append_ghosts();
        cloud.note_mixed_rows();
        cloud
    }

    fn note_mixed_rows(&mut self) {
        let mut layers = std::mem::take(&mut self.layers);
        layers.note_mixed(|layers, i| {
            let step = |j: usize| layers.steps(i, self.source(j), &(self.x[j] - self.x[i]));
            self.neighbours.of(i).iter().any(|j| step(*j as usize).is_none())
        });
        self.layers = layers;
    }

    fn append_ghosts(&mut self) {
        for image in &self.ghosts {
            let k = image.source as usize;
            self.x.push(self.transforms[image.transform as usize].point(&self.x[k]));
            self.spacing.push(self.spacing[k]);
            self.volume.push(self.volume[k]);
        }
    }
}

/// Volumes of the particles: h^D for fluid particles, area times height for interface particles, and the product of the
/// spacings along and across the wall for particles in wall layers.
fn volumes<const D: usize>(particles: &Particles<D>) -> Vec<f64> {
    let mut volume: Vec<f64> = particles.spacing.iter().map(|h| h.powi(D as i32)).collect();
    for (w, i) in particles.interface.iter().zip(particles.n_fluid..) {
        volume[i] = WALL_HEIGHT * particles.spacing[i] * w.area.norm();
    }
    for (i, v) in volume.iter_mut().enumerate() {
        *v = particles.layers.volume(i, &particles.interface, &particles.x).unwrap_or(*v);
    }
    volume
}

/// The outer particles, each with the nearest fluid particles inward of it.
fn outer_particles<const D: usize>(particles: &Particles<D>) -> Vec<Outer> {
    let first = particles.n_rows();
    let outer = particles.outer.iter().zip(first..).map(|((axis, end), i)| {
        let side = particles.sides[*axis][*end];
        let (x, h) = (&particles.x[i], particles.spacing[i]);
        let centre = particles.tree.bounds().centre();
        // The probing point lies slightly nearer than one spacing and slightly inward along the side. Where leaves of
        // two sizes meet, it would otherwise lie on the border of two leaves, and clouds about an axis would lose their
        // symmetry.
        let inward = |d: usize| h * (centre[d] - x[d]).signum();
        let toward = |d: usize| (1.0 - ASIDE) * inward(d);
        let fluid_at = |x: &Vector<D>| {
            let leaf = particles.tree.leaf_at(x).node;
            particles.in_leaf(leaf).find(|k| (*k as usize) < particles.n_fluid)
        };
        // At an edge or a corner of the domain, the direction straight inward runs along another side, so diagonal
        // directions are tried too.
        let ways = (0..1usize << D).filter(|w| w & (1 << axis) != 0);
        let place = |w: usize| *x + Vector::from_fn(|d| if w & (1 << d) != 0 { toward(d) } else { ASIDE * inward(d) });
        let fewest = |n: u32| ways.clone().filter(move |w| w.count_ones() == n);
        let source = (1..=D as u32).flat_map(fewest).find_map(|w| fluid_at(&place(w))).unwrap_or(i as u32);
        let onwards = particles.x[source as usize] - *x;
        let behind = fluid_at(&(particles.x[source as usize] + onwards * (1.0 - ASIDE)))
            .filter(|k| *k != source)
            .unwrap_or(source);
        Outer { side, source, behind, outward: (*axis as u8, *end == 1) }
    });
    outer.collect()
}
