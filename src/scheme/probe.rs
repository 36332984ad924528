//! The solution between particles.
//!
//! At a point x every particle nearby offers its own linear fit q_k + ∇q_k·(x − x_k); the offers are blended with compact
//! weights (a partition of unity), so that pictures, transfers and integrals see the solver's fit and nothing else.
use super::fluid::{Fluid, Work};
use crate::cloud::tree::{Leaf, Tree};
use crate::geometry::Surface;
use crate::math::{Bounds, Vector};
use crate::physics::Primitive;

/// Radius of the weights in cells of the background.
const RADIUS: f64 = 1.5;

/// The leaf of the background that was asked about last, and the particles that reach into one that was.
#[derive(Clone, Debug, Default)]
pub struct Near<const D: usize> {
    leaf: Option<Leaf<D>>,
    listed: Option<u32>,
    list: Vec<u32>,
}

impl<const D: usize> Near<D> {
    /// The leaf that holds `x`.
    #[inline]
    fn leaf(&mut self, tree: &Tree<D>, x: &Vector<D>) -> Leaf<D> {
        match &self.leaf {
            Some(leaf) if (*x - leaf.centre).max_abs() < 0.5 * leaf.size => *leaf,
            _ => *self.leaf.insert(tree.leaf_at(x)),
        }
    }
}

/// A solution that can be asked anywhere.
pub struct Probe<'a, const D: usize> {
    fluid: &'a Fluid<D>,
    work: &'a Work<D>,
    surface: Option<&'a Surface<D>>,
}

impl<'a, const D: usize> Probe<'a, D> {
    /// Looks at the states and gradients in `work`, which must be filled.
    pub fn new(fluid: &'a Fluid<D>, work: &'a Work<D>, surface: Option<&'a Surface<D>>) -> Self {
        Self { fluid, work, surface }
    }

    /// Size of the background at `x`: about the distance between particles there.
    pub fn spacing(&self, x: &Vector<D>, near: &mut Near<D>) -> f64 {
        near.leaf(&self.fluid.reference().cloud.tree, &self.fluid.origin(x)).size
    }

    /// State at `x`; `None` where no particle is near.
    pub fn at(&self, x: &Vector<D>) -> Option<Primitive<D>> {
        self.beside(x, &mut Near::default())
    }

    /// The same where points are asked one after another that are mostly in the leaf of the one before.
    pub fn beside(&self, x: &Vector<D>, near: &mut Near<D>) -> Option<Primitive<D>> {
        // the background knows particles where they were before any motion
        let cloud = &self.fluid.reference().cloud;
        let (place, x) = (x, &self.fluid.origin(x));
        let leaf = near.leaf(&cloud.tree, x);
        let reach = RADIUS * leaf.size;
        if near.listed != Some(leaf.node) {
            near.listed = Some(leaf.node);
            near.list.clear();
            let corner = Vector::splat(0.5 * leaf.size + reach);
            let cube = Bounds { min: leaf.centre - corner, max: leaf.centre + corner };
            cloud.tree.overlapping(&cube, |node| near.list.extend(cloud.leaves.of(node)));
        }
        let mut sum: Option<Primitive<D>> = None;
        let mut weight = 0.0;
        for k in &near.list {
            let k = *k as usize;
            let d = *x - cloud.x[k];
            let w = (1.0 - d.norm() / reach).max(0.0).powi(2);
            if w > 0.0 && self.in_sight(k, x) {
                let offer = self.offer(k, &(*place - self.fluid.shape.cloud.x[k]));
                sum = Some(sum.map_or_else(|| scaled(&offer, w), |s| s.plus(w, &offer)));
                weight += w;
            }
        }
        sum.map(|s| scaled(&s, 1.0 / weight))
    }

    fn offer(&self, k: usize, d: &Vector<D>) -> Primitive<D> {
        let q = &self.work.state[k];
        let linear = q.plus(1.0, &self.work.gradient[k].along(d));
        if linear.density > 0.0 && linear.pressure > 0.0 { linear } else { *q }
    }

    fn in_sight(&self, k: usize, x: &Vector<D>) -> bool {
        let cloud = &self.fluid.reference().cloud;
        let near = cloud.wall_distance[k] < RADIUS * 2.0 * cloud.spacing[k];
        !near || self.surface.is_none_or(|s| !s.crosses(&cloud.x[k], x))
    }
}

fn scaled<const D: usize>(q: &Primitive<D>, s: f64) -> Primitive<D> {
    Primitive { density: q.density * s, velocity: q.velocity * s, pressure: q.pressure * s }
}
