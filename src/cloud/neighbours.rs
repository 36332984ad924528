//! Which particles each particle sees.
//!
//! Away from walls the cloud of a particle is the 3×3 (3×3×3) stencil of the background: the leaves that touch its own.
//! Pairs that touch across an edge of the cube only are left out in 3-D, which halves the cost at the same accuracy. Near a
//! wall the cloud is the ball r ≤ ρ (h_i + h_j)/2, with interface particles in it. No pair reaches through a body: a
//! segment that crosses a surface joins nothing, an interface particle sees only what lies in front of it, and in 2-D it
//! sees of its own kind just the two neighbours along the outline, none across a sharp edge.
use super::fill::Particles;
use super::{Image, Transform};
use crate::geometry::Surface;
use crate::math::sweep::sweep;
use crate::math::{Bounds, Vector};

/// Pairs with a member nearer than this many spacings to a wall follow the ball rule.
pub const NEAR: f64 = 3.0;
/// Sine of the smallest angle between the tangent plane and what an interface particle sees.
const GRAZING: f64 = 0.05;
/// Interface particles whose normals differ more (cosine) do not see one another.
const FACING: f64 = 0.2;
/// Interface particles step off the surface by this fraction of the spacing before a line of sight is tested.
const LIFT: f64 = 1e-3;
/// Radius of the fit that gives the state of an interface particle, in spacings: two rings of fluid particles.
const FIT_REACH: f64 = 3.2;
/// Slack with which leaves count as touching, in spacings.
const TOUCH: f64 = 1e-6;

/// Rows of neighbours, compressed.
#[derive(Clone, Debug, Default)]
pub struct Neighbours {
    /// Start of each row, and the end of the last one.
    pub first: Vec<u32>,
    /// Particle indices, ascending in each row.
    pub index: Vec<u32>,
}

impl Neighbours {
    /// Neighbours of particle `i`.
    #[inline]
    pub fn of(&self, i: usize) -> &[u32] {
        &self.index[self.range(i)]
    }

    /// Where the neighbours of particle `i` stand.
    #[inline]
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.first[i] as usize..self.first[i + 1] as usize
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.first.len() - 1
    }

    /// True when there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Packs rows.
    pub fn from_rows(rows: &[Vec<u32>]) -> Self {
        let mut first = Vec::with_capacity(rows.len() + 1);
        let mut index = Vec::with_capacity(rows.iter().map(Vec::len).sum());
        first.push(0);
        for row in rows {
            index.extend_from_slice(row);
            first.push(index.len() as u32);
        }
        Self { first, index }
    }
}

/// A neighbour before images have numbers: particle and transform (`IDENTITY` for itself).
type Seen = (u32, u8);
const IDENTITY: u8 = u8::MAX;

/// Search over the particles of a tree.
pub struct Search<'a, const D: usize> {
    particles: &'a Particles<D>,
    surface: Option<&'a Surface<D>>,
    transforms: &'a [Transform<D>],
    radius: f64,
}

impl<'a, const D: usize> Search<'a, D> {
    /// Prepares a search; `radius` is the ball of the near-wall rule in spacings.
    pub fn new(
        particles: &'a Particles<D>,
        surface: Option<&'a Surface<D>>,
        transforms: &'a [Transform<D>],
        radius: f64,
    ) -> Self {
        Self { particles, surface, transforms, radius }
    }

    /// Clouds of all fluid and interface particles, the wider ones from which the state of the interface particles is
    /// fitted, and the images that either of them sees.
    pub fn clouds(&self) -> (Neighbours, Neighbours, Vec<Image>) {
        let n_rows = self.particles.n_rows();
        let mut rows: Vec<Vec<Seen>> = vec![Vec::new(); n_rows + self.particles.interface.len()];
        sweep(&mut rows, |i| {
            if i < n_rows { self.cloud_of(i) } else { self.fluid_in_front(i - n_rows + self.particles.n_fluid) }
        });
        let mut images: Vec<Seen> = rows.iter().flatten().filter(|s| s.1 != IDENTITY).copied().collect();
        images.sort_unstable();
        images.dedup();
        let first_image = self.particles.x.len() as u32;
        let mut numbered: Vec<Vec<u32>> = vec![Vec::new(); rows.len()];
        sweep(&mut numbered, |i| {
            let number = |s: &Seen| match s.1 {
                IDENTITY => s.0,
                _ => first_image + images.binary_search(s).unwrap_or(0) as u32,
            };
            let mut row: Vec<u32> = rows[i].iter().map(number).collect();
            row.sort_unstable();
            row
        });
        let images = images.iter().map(|s| Image { source: s.0, transform: s.1 }).collect();
        (Neighbours::from_rows(&numbered[..n_rows]), Neighbours::from_rows(&numbered[n_rows..]), images)
    }

    fn cloud_of(&self, i: usize) -> Vec<Seen> {
        let mut row = Vec::with_capacity(if D == 2 { 12 } else { 32 });
        self.candidates(i, self.reach(i), |k, t| {
            if self.sees(i, k as usize, t) {
                row.push((k, t));
            }
        });
        row
    }

    /// Fluid particles in front of the interface particle `i`, in sight.
    fn fluid_in_front(&self, i: usize) -> Vec<Seen> {
        let p = self.particles;
        let radius = FIT_REACH * p.spacing[i];
        let mut row = Vec::new();
        self.candidates(i, radius, |k, t| {
            let d = self.position(k as usize, t) - p.x[i];
            let fluid = (k as usize) < p.n_fluid;
            if fluid && d.norm() < radius && self.in_front(i, &d, IDENTITY) && self.in_sight(i, k as usize, &d) {
                row.push((k, t));
            }
        });
        row
    }

    fn reach(&self, i: usize) -> f64 {
        let h = self.particles.spacing[i];
        if self.near(i) { 0.5 * self.radius * 3.0 * h } else { h * (0.5 + TOUCH) }
    }

    fn near(&self, i: usize) -> bool {
        self.particles.wall_distance[i] < NEAR * self.particles.spacing[i]
    }

    fn position(&self, k: usize, t: u8) -> Vector<D> {
        let x = self.particles.x[k];
        if t == IDENTITY { x } else { self.transforms[t as usize].point(&x) }
    }

    /// Every particle, or image, whose leaf meets the cube of half-width `reach` around particle `i`.
    fn candidates(&self, i: usize, reach: f64, mut f: impl FnMut(u32, u8)) {
        let p = self.particles;
        let x = p.cell_centre(i);
        let domain = p.tree.bounds();
        let mut visit = |centre: &Vector<D>, t: u8| {
            let cube = Bounds { min: *centre - Vector::splat(reach), max: *centre + Vector::splat(reach) };
            p.tree.overlapping(&cube, |node| {
                for k in p.in_leaf(node) {
                    if k as usize != i || t != IDENTITY {
                        f(k, t);
                    }
                }
            });
        };
        visit(&x, IDENTITY);
        for (t, transform) in self.transforms.iter().enumerate() {
            let back = transform.inverse().point(&x);
            // the corner of the cube may reach into the domain where its faces do not
            if domain.distance_squared(&back) <= D as f64 * reach * reach {
                visit(&back, t as u8);
            }
        }
    }

    /// Whether particle `i` has particle `k`, moved by transform `t`, in its cloud.
    fn sees(&self, i: usize, k: usize, t: u8) -> bool {
        let p = self.particles;
        let (wall_i, wall_k) = (p.is_interface(i), p.is_interface(k));
        let near = wall_i || wall_k || self.near(i) || self.near(k);
        let d = self.position(k, t) - p.x[i];
        if near && d.norm() > 0.5 * self.radius * (p.spacing[i] + p.spacing[k]) {
            return false;
        }
        match (wall_i, wall_k) {
            (false, false) => self.leaves_touch(i, k, t, near) && (!near || self.in_sight(i, k, &d)),
            (true, false) => self.in_front(i, &d, IDENTITY) && self.in_sight(i, k, &d),
            (false, true) => self.in_front(k, &-d, t) && self.in_sight(k, i, &-d),
            (true, true) => self.walls_see(i, k, t),
        }
    }

    /// Leaves touch; contacts along an edge of the cube count only near a wall.
    fn leaves_touch(&self, i: usize, k: usize, t: u8, near: bool) -> bool {
        let p = self.particles;
        let mut other = p.cell_centre(k);
        if t != IDENTITY {
            other = self.transforms[t as usize].point(&other);
        }
        let d = other - p.cell_centre(i);
        let reach = 0.5 * (p.spacing[i] + p.spacing[k]);
        let tolerance = TOUCH * p.spacing[i].min(p.spacing[k]);
        if d.max_abs() > reach + tolerance {
            return false;
        }
        let contacts = (0..D).filter(|a| d[*a].abs() > reach - tolerance).count();
        D == 2 || near || contacts != 2
    }

    fn in_front(&self, wall: usize, d: &Vector<D>, t: u8) -> bool {
        let mut normal = self.particles.interface[wall - self.particles.n_fluid].normal;
        if t != IDENTITY {
            normal = self.transforms[t as usize].direction(&normal);
        }
        d.dot(&normal) > GRAZING * d.norm()
    }

    fn walls_see(&self, i: usize, k: usize, t: u8) -> bool {
        let p = self.particles;
        let (a, b) = (&p.interface[i - p.n_fluid], &p.interface[k - p.n_fluid]);
        if D == 2 {
            return t == IDENTITY && p.adjacent(i, k);
        }
        let normal = if t == IDENTITY { b.normal } else { self.transforms[t as usize].direction(&b.normal) };
        a.normal.dot(&normal) > FACING
    }

    /// No surface between particle `i` and the point at `d` from it; the pair is tested in one direction only.
    fn in_sight(&self, i: usize, k: usize, d: &Vector<D>) -> bool {
        let Some(surface) = self.surface else { return true };
        let p = self.particles;
        let r = d.norm();
        if p.wall_distance[i] + p.wall_distance[k] > r {
            return true;
        }
        let lifted = |w: usize| match p.is_interface(w) {
            true => p.interface[w - p.n_fluid].normal * (LIFT * p.spacing[w]),
            false => Vector::ZERO,
        };
        let (a, b) = (p.x[i] + lifted(i), p.x[i] + *d);
        if i < k { !surface.crosses(&a, &b) } else { !surface.crosses(&b, &a) }
    }
}
