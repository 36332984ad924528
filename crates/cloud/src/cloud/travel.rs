//! Clouds of Lagrangian particles, which are rebuilt around the current particle positions.
//!
//! A [`BackgroundDomain`] holds what stays fixed: the background, which prescribes the local spacing H(x), the sides of
//! the domain with their outer particles, and the bodies with their interface particles. The cloud follows from the
//! positions of the fluid particles by the ball rule r ≤ ρ (h_i + h_j)/2 everywhere.
//!
//! Before a cloud is rebuilt, particles are removed and inserted. A particle is removed when it has entered a body (or
//! comes nearer than `blank` spacings to it), or comes too near to an interface particle (0.4 spacings), to an outer
//! particle of an open side, or to another fluid particle; of two such fluid particles, the second is removed. A
//! particle that leaves through a periodic side returns through the opposite side. A particle is inserted at every
//! empty position of the background: a centre or a corner of a leaf with no particle within 0.9 spacings (1.0 in 3-D).
use std::sync::Arc;

use super::fill::{Ball, Walls, curve_position, side_of};
use super::grid::Grid;
use super::interface::{Placed, place};
use super::layers::Layers;
use super::layout::Layout;
use super::neighbours::{NEAR, Search};
use super::particles::{ParticleSite, Particles};
use super::tree::{Leaf, Tree};
use super::{Cloud, CloudError, CloudSpec, Transform};
use crate::case::Side;
use crate::geometry::Surface;
use crate::math::parallel::{CHUNK, order_by_key, parts, sweep, sweep_each, sweep_parts};
use crate::math::{Bounds, Vector};
use crate::motion::RigidPose;

/// Minimum radius of the neighbour lists in spacings. With 1.6, which suffices on a lattice, sheared clouds have too
/// few neighbours: the error of the isentropic vortex after two units of time was six times larger.
const MIN_RADIUS: f64 = 1.8;
/// Distance, in mean spacings, below which two particles are too near.
const CROWDED: f64 = 0.6;
/// Minimum distance, in spacings, between fluid particles and interface particles.
const CLEARANCE: f64 = 0.4;
/// Minimum distance, in spacings, between fluid particles and an open side: half a spacing from the outer particles.
const OPEN_GAP: f64 = 1.0;
/// Minimum distance, in spacings, between fluid particles and a plane of symmetry; the image is twice as far away.
const CLOSED_GAP: f64 = 0.2;
/// Radius, in spacings, of a region that counts as empty, in two and three dimensions. It exceeds half the diagonal of
/// a leaf, where a regular cloud has its corners.
const EMPTY: [f64; 2] = [0.9, 1.0];
/// Number of samples of a leaf along each axis, from which volumes are computed.
const SAMPLES: usize = 4;
/// Greatest ratio of the spacings of two neighbours, because adjacent leaves differ by one level.
const LARGER: f64 = 1.5;
/// Distance to the wall, in spacings, up to which it is computed.
const KNOWN: f64 = NEAR + 1.0;
/// Distance, in leaf sizes, beyond which a sample is assigned to no particle.
const FARTHEST: f64 = 8.0;
/// Marks an inserted particle, which has no predecessor.
pub const NEW: u32 = u32::MAX;

/// Background, sides and bodies, which stay the same while the particles travel.
pub struct BackgroundDomain<const D: usize> {
    tree: Arc<Tree<D>>,
    layout: Layout<D>,
    transforms: Vec<Transform<D>>,
    placed: Placed<D>,
    outer: Vec<(Leaf<D>, (usize, usize))>,
    surface: Option<Surface<D>>,
    radius: f64,
    blank: f64,
    uniform: bool,
    /// For each cell of the background, true when all leaves that the particles in it can have neighbours in are of the
    /// same size.
    even: Vec<bool>,
}

/// A rebuilt cloud with the relation of its fluid particles to those of the previous cloud.
pub struct Recloud<const D: usize> {
    /// The rebuilt cloud.
    pub cloud: Cloud<D>,
    /// For each fluid particle its index in the previous cloud, or `NEW`.
    pub from: Vec<u32>,
    /// Indices of removed particles in the previous cloud, ascending.
    pub removed: Vec<u32>,
}

/// The bodies in their current positions.
struct Scene<'a, const D: usize> {
    poses: &'a [RigidPose<D>],
    surface: Option<std::borrow::Cow<'a, Surface<D>>>,
    placed: std::borrow::Cow<'a, Placed<D>>,
}

impl<const D: usize> BackgroundDomain<D> {
    /// Prepares the background of `cloud`, which was built from `spec` and `surface`.
    pub fn new(spec: &CloudSpec<D>, surface: Option<&Surface<D>>, cloud: &Cloud<D>) -> Result<Self, CloudError> {
        let layout = Layout::new(spec, surface)?;
        let tree = Arc::clone(&cloud.tree);
        let placed = surface.map(|s| place(s, &tree, &layout.planes())).unwrap_or_default();
        let walls = Walls::new(surface, tree.bounds(), &cloud.transforms);
        let (mut outer, mut last) = (Vec::new(), None);
        let mut sizes = (f64::INFINITY, 0.0f64);
        for leaf in tree.leaves() {
            sizes = (sizes.0.min(leaf.size), sizes.1.max(leaf.size));
            let side = side_of(&leaf, &tree.bounds(), &layout.sides);
            let free = |last: &mut _| walls.distance((&leaf.centre, leaf.size), spec.blank, last).is_some();
            outer.extend(side.filter(|_| free(&mut last)).map(|side| (leaf, side)));
        }
        let order = order_by_key(outer.len(), |k| curve_position(tree.anchor(outer[k].0.node)));
        let outer: Vec<_> = order.into_iter().map(|k| outer[k as usize]).collect();
        let transforms = cloud.transforms.clone();
        let (radius, blank, uniform) = (spec.radius.max(MIN_RADIUS), spec.blank, sizes.0 == sizes.1);
        // from the centre of a leaf to a particle in it, to its neighbours, and to the leaves that determine their
        // spacing
        let even = tree.even(0.5 + LARGER * radius + 1.0);
        let surface = surface.cloned();
        Ok(Self { tree, layout, transforms, placed, outer, surface, radius, blank, uniform, even })
    }

    /// The cloud of fluid particles at `x` with the bodies at `poses` (empty: as the case places them), and for each
    /// fluid particle its index in `x`. Fails when a particle lies inside a body.
    pub fn cloud(&self, poses: &[RigidPose<D>], x: &[Vector<D>]) -> Result<(Cloud<D>, Vec<u32>), CloudError> {
        let scene = self.scene(poses);
        let sites = self.sites(&scene, x);
        let buried = sites.iter().position(Option::is_none);
        if let Some(i) = buried {
            let problem = format!("particle {i} at {} lies inside a body", x[i]);
            return Err(CloudError::Quality(vec![problem]));
        }
        let (particles, order) = self.gather(&scene, sites.into_iter().flatten().collect());
        Ok((self.joined(&scene, particles)?, order))
    }

    /// The cloud of the fluid particles of `old` after removal and insertion of particles. Fails when no fluid particle
    /// is left.
    pub fn recloud(&self, poses: &[RigidPose<D>], old: &Cloud<D>) -> Result<Recloud<D>, CloudError> {
        let scene = self.scene(poses);
        let mut x = old.x[..old.n_fluid].to_vec();
        x.iter_mut().for_each(|x| *x = self.wrapped(x));
        let sites = self.sites(&scene, &x);
        let mut gone: Vec<bool> = sites.iter().map(Option::is_none).collect();
        self.thin_out(old, &mut gone);
        let kept: Vec<u32> = (0..old.n_fluid as u32).filter(|i| !gone[*i as usize]).collect();
        let removed = (0..old.n_fluid as u32).filter(|i| gone[*i as usize]).collect();
        let sites: Vec<ParticleSite<D>> = kept.iter().filter_map(|i| sites[*i as usize]).collect();
        let (mut particles, mut order) = self.gather(&scene, sites.clone());
        let inserted = self.missing(&scene, &particles);
        if !inserted.is_empty() {
            (particles, order) = self.gather(&scene, sites.into_iter().chain(inserted).collect());
        }
        if particles.n_fluid == 0 {
            return Err(CloudError::Empty);
        }
        let from = order.iter().map(|k| kept.get(*k as usize).copied().unwrap_or(NEW)).collect();
        Ok(Recloud { cloud: self.joined(&scene, particles)?, from, removed })
    }

    /// Volumes of the fluid particles of a newly built `cloud`: the parts of the leaves without outer particles that
    /// are nearest to each particle, by sampling. Their sum equals that of the cloud of the case.
    pub fn volumes(&self, poses: &[RigidPose<D>], cloud: &Cloud<D>) -> Vec<f64> {
        let scene = self.scene(poses);
        let mut rim: Vec<u32> = self.outer.iter().map(|(leaf, _)| leaf.node).collect();
        rim.sort_unstable();
        let inner = |leaf: &Leaf<D>| rim.binary_search(&leaf.node).is_err();
        let leaves: Vec<Leaf<D>> = self.tree.leaves().filter(inner).collect();
        let walls = Walls::new(scene.surface.as_deref(), self.tree.bounds(), &self.transforms);
        let mut owners: Vec<Vec<u32>> = vec![Vec::new(); leaves.len()];
        sweep(&mut owners, |k| {
            let (leaf, mut last) = (&leaves[k], None);
            let step = leaf.size / SAMPLES as f64;
            let sample = |s: usize| {
                let part = |d: usize| (s / SAMPLES.pow(d as u32) % SAMPLES) as f64 + 0.5;
                let x = leaf.centre + Vector::from_fn(|d| part(d) * step - 0.5 * leaf.size);
                walls.distance((&x, leaf.size), 0.0, &mut last).map(|_| x)
            };
            (0..SAMPLES.pow(D as u32)).filter_map(sample).filter_map(|x| self.owner(cloud, &x, leaf.size)).collect()
        });
        let mut volumes = vec![0.0; cloud.n_fluid];
        for (leaf, owners) in leaves.iter().zip(&owners) {
            let share = (leaf.size / SAMPLES as f64).powi(D as i32);
            owners.iter().for_each(|i| volumes[*i as usize] += share);
        }
        volumes
    }

    /// The fluid particle nearest to `x`.
    fn owner(&self, cloud: &Cloud<D>, x: &Vector<D>, size: f64) -> Option<u32> {
        let mut best = (f64::INFINITY, u32::MAX);
        let mut reach = 0.75 * size;
        while best.0 > reach * reach && reach < FARTHEST * size {
            for (t, place) in
                std::iter::once((None, *x)).chain(self.transforms.iter().map(|t| (Some(t), t.inverse().point(x))))
            {
                if t.is_some() && self.tree.bounds().distance_squared(&place) > reach * reach {
                    continue;
                }
                let cube = Bounds { min: place - Vector::splat(reach), max: place + Vector::splat(reach) };
                self.tree.overlapping(&cube, |node| {
                    for k in cloud.leaves.of(node).iter().filter(|k| (**k as usize) < cloud.n_fluid) {
                        let found = ((cloud.x[*k as usize] - place).norm_squared(), *k);
                        if found < best {
                            best = found;
                        }
                    }
                });
            }
            reach *= 2.0;
        }
        (best.1 != u32::MAX).then_some(best.1)
    }

    /// Radius of the neighbour lists in spacings.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Positions and data of the interface particles in the undisplaced bodies.
    pub fn walls(&self) -> (&[Vector<D>], &[super::Interface<D>]) {
        (&self.placed.x, &self.placed.interface)
    }

    fn joined(&self, scene: &Scene<'_, D>, particles: Particles<D>) -> Result<Cloud<D>, CloudError> {
        let mut reach = vec![0.0; particles.n_rows()];
        sweep(&mut reach, |i| self.reach(scene, &particles, i));
        let search = Search::new(&particles, scene.surface.as_deref(), &self.transforms, self.radius).free(reach);
        let found = search.clouds()?;
        Ok(Cloud::join(particles, found, self.transforms.clone()))
    }

    /// Search radius of particle `i`: its own radius where the background is uniform, the radius of a larger neighbour
    /// elsewhere.
    fn reach(&self, scene: &Scene<'_, D>, particles: &Particles<D>, i: usize) -> f64 {
        let own = self.radius * particles.spacing[i];
        let farthest = LARGER * own;
        let known = particles.wall_distance[i].min(KNOWN * particles.spacing[i]);
        let even = || scene.poses.is_empty() && self.even[particles.leaf_of(i) as usize];
        if self.uniform || known > farthest && even() { own } else { farthest }
    }

    fn scene<'a>(&'a self, poses: &'a [RigidPose<D>]) -> Scene<'a, D> {
        use std::borrow::Cow;
        if poses.iter().all(|p| *p == RigidPose::identity()) {
            let surface = self.surface.as_ref().map(Cow::Borrowed);
            return Scene { poses: &[], surface, placed: Cow::Borrowed(&self.placed) };
        }
        let point = |body: u16, x: &Vector<D>| poses.get(usize::from(body)).map_or(*x, |p| p.point(x));
        let direction = |body: u16, v: &Vector<D>| poses.get(usize::from(body)).map_or(*v, |p| p.direction(v));
        let surface = self.surface.as_ref().map(|s| Cow::Owned(s.moved(point, direction)));
        let mut placed = self.placed.clone();
        for (w, x) in placed.interface.iter_mut().zip(&mut placed.x) {
            *x = point(w.body, x);
            if let Some(pose) = poses.get(usize::from(w.body)) {
                w.turn(&pose.rotation);
            }
        }
        Scene { poses, surface, placed: Cow::Owned(placed) }
    }

    /// Prescribed spacing at `x`: the leaf size of the background, which moves with the bodies, averaged over one leaf.
    fn spacing(&self, poses: &[RigidPose<D>], x: &Vector<D>) -> f64 {
        let at = |x: &Vector<D>| self.average(&self.tree.leaf_at(x), x);
        poses.iter().map(|p| at(&p.inverse_point(x))).reduce(f64::min).unwrap_or_else(|| at(x))
    }

    /// Mean size of the leaves around the position `x` in a leaf.
    fn average(&self, leaf: &Leaf<D>, x: &Vector<D>) -> f64 {
        let size = leaf.size;
        if self.uniform || self.even[leaf.node as usize] {
            return size;
        }
        let corner = |c: u32| Vector::from_fn(|d| x[d] + if c >> d & 1 == 0 { -0.5 * size } else { 0.5 * size });
        let sum: f64 = (0..1u32 << D).map(|c| self.tree.leaf_at(&corner(c)).size).sum();
        sum / f64::from(1u32 << D)
    }

    /// Position after translation through periodic sides into the domain.
    fn wrapped(&self, x: &Vector<D>) -> Vector<D> {
        let (bounds, periodic) = (self.tree.bounds(), self.tree.periodic());
        let extent = bounds.extent();
        Vector::from_fn(|d| match periodic[d] {
            true if x[d] < bounds.min[d] => x[d] + extent[d],
            true if x[d] >= bounds.max[d] => x[d] - extent[d],
            _ => x[d],
        })
    }

    /// Sites for particles at the positions `x`; `None` outside the domain and in bodies.
    fn sites(&self, scene: &Scene<'_, D>, x: &[Vector<D>]) -> Vec<Option<ParticleSite<D>>> {
        let walls = Walls::new(scene.surface.as_deref(), self.tree.bounds(), &self.transforms);
        let mut sites = vec![None; x.len()];
        let chunks = parts(x.len(), CHUNK);
        sweep_parts(&chunks, 1, &mut sites, &|k, slots| {
            let mut last = None;
            for (x, slot) in x[chunks[k].clone()].iter().zip(slots) {
                *slot = self.site(scene, &walls, x, &mut last);
            }
        });
        sites
    }

    fn site(
        &self,
        scene: &Scene<'_, D>,
        walls: &Walls<'_, D>,
        x: &Vector<D>,
        last: &mut Option<Ball<D>>,
    ) -> Option<ParticleSite<D>> {
        let leaf = self.tree.leaf_at(x);
        let spacing = if scene.poses.is_empty() { self.average(&leaf, x) } else { self.spacing(scene.poses, x) };
        if !self.is_inside(x, spacing) {
            return None;
        }
        let distance = walls.distance((x, spacing), self.blank, last)?;
        Some(ParticleSite { cell: self.tree.cell_at(x), centre: *x, spacing, node: leaf.node, distance, layer: None })
    }

    /// True inside the domain, with room for the outer particles of open sides.
    fn is_inside(&self, x: &Vector<D>, h: f64) -> bool {
        let bounds = self.tree.bounds();
        (0..D).all(|d| {
            [x[d] - bounds.min[d], bounds.max[d] - x[d]].iter().zip(&self.layout.sides[d]).all(|(gap, side)| match side
            {
                Side::Periodic => *gap >= 0.0,
                Side::Symmetry => *gap >= CLOSED_GAP * h,
                _ => *gap >= OPEN_GAP * h,
            })
        })
    }

    /// Marks particles that are too near to others in `gone`.
    fn thin_out(&self, old: &Cloud<D>, gone: &mut [bool]) {
        let walls = old.interface_range();
        let near = |i: usize, j: u32, part: f64| {
            let mean = 0.5 * (old.spacing[i] + old.spacing[j as usize]);
            (old.x[j as usize] - old.x[i]).norm_squared() < (part * mean).powi(2)
        };
        let mut crowds = vec![Vec::new(); old.n_fluid];
        let known = &*gone;
        sweep(&mut crowds, |i| {
            if known[i] {
                return Vec::new();
            }
            let part = |j: u32| if walls.contains(&old.source(j as usize).index) { CLEARANCE } else { CROWDED };
            // of two fluid particles only the second is tested
            let looks = |j: usize| j < i || j >= old.n_fluid;
            old.neighbours.of(i).iter().copied().filter(|j| looks(*j as usize) && near(i, *j, part(*j))).collect()
        });
        for (i, crowd) in crowds.iter().enumerate().filter(|(_, c)| !c.is_empty()) {
            let stays = |j: &u32| {
                let s = old.source(*j as usize).index;
                s >= old.n_fluid || s < i && !gone[s]
            };
            gone[i] |= crowd.iter().any(stays);
        }
    }

    /// The particles of these sites in the order of the space-filling curve, and the index of the site of each
    /// particle.
    fn gather(&self, scene: &Scene<'_, D>, sites: Vec<ParticleSite<D>>) -> (Particles<D>, Vec<u32>) {
        let order = order_by_key(sites.len(), |k| curve_position(sites[k].cell));
        let sites = order.iter().map(|k| sites[*k as usize]).collect();
        let tree = Arc::clone(&self.tree);
        let all = (sites, scene.placed.clone().into_owned(), self.outer.clone());
        (Particles::assemble(tree, &self.layout, all, Layers::default()), order)
    }

    /// Sites at the empty positions of the background.
    fn missing(&self, scene: &Scene<'_, D>, particles: &Particles<D>) -> Vec<ParticleSite<D>> {
        let search = Search::new(particles, scene.surface.as_deref(), &self.transforms, self.radius);
        let walls = Walls::new(scene.surface.as_deref(), self.tree.bounds(), &self.transforms);
        let cells = parts(self.tree.n_nodes(), CHUNK);
        let mut found: Vec<Vec<ParticleSite<D>>> = vec![Vec::new(); cells.len()];
        let leaves = |c: usize| cells[c].clone().filter_map(|k| self.tree.as_leaf(k as u32));
        // the background moves with the bodies: its positions are tested in the frame of each of them
        let carried = |x: &Vector<D>| scene.poses.iter().map(|p| p.point(x)).collect::<Vec<_>>();
        sweep_each(&mut found, |c| {
            let mut last = None;
            let mut site = |x: Vector<D>| {
                let within = EMPTY[D - 2] * self.spacing(scene.poses, &x);
                let empty = self.is_inside(&x, within) && search.is_empty(&x, within);
                empty.then(|| self.site(scene, &walls, &x, &mut last)).flatten()
            };
            let mut sites = Vec::new();
            for leaf in leaves(c) {
                let places = [leaf.centre, leaf.centre - Vector::splat(0.5 * leaf.size)];
                for place in places.into_iter().filter(|x| !self.is_taken(scene, particles, &leaf, x)) {
                    match scene.poses.is_empty() {
                        true => sites.extend(site(place)),
                        false => sites.extend(carried(&place).into_iter().filter_map(&mut site)),
                    }
                }
            }
            sites
        });
        self.apart(found.into_iter().flatten())
    }

    /// True for most positions of a leaf that are not empty, because a particle of the same leaf is near; an
    /// inexpensive first test.
    fn is_taken(&self, scene: &Scene<'_, D>, particles: &Particles<D>, leaf: &Leaf<D>, x: &Vector<D>) -> bool {
        let within = EMPTY[D - 2] * leaf.size;
        let near = |k: u32| (particles.x[k as usize] - *x).norm() < within;
        scene.poses.is_empty() && self.even[leaf.node as usize] && particles.in_leaf(leaf.node).any(near)
    }

    /// The sites that keep their distance from all preceding ones.
    fn apart(&self, sites: impl Iterator<Item = ParticleSite<D>>) -> Vec<ParticleSite<D>> {
        let sites: Vec<ParticleSite<D>> = sites.collect();
        let largest = sites.iter().map(|s| s.spacing).fold(f64::MIN_POSITIVE, f64::max);
        let (mut kept, mut grid) = (Vec::new(), Grid::new(2.0 * largest));
        let mut all: Vec<Vector<D>> = Vec::new();
        for site in sites {
            let (x, reach) = (&site.centre, EMPTY[D - 2] * site.spacing);
            let mut free = self.transforms.iter().all(|t| (t.point(x) - *x).norm() >= CROWDED * site.spacing);
            grid.near(x, reach, |k| free &= (all[k as usize] - *x).norm() >= reach);
            if free {
                let images = self.transforms.iter().map(|t| t.point(x));
                for place in std::iter::once(*x).chain(images) {
                    grid.insert(&place, all.len() as u32);
                    all.push(place);
                }
                kept.push(site);
            }
        }
        kept
    }
}
