//! The solution between particles.
//!
//! At a point x every particle nearby offers its own linear fit q_k + ∇q_k·(x − x_k); the offers are blended with compact
//! weights (a partition of unity), so that pictures, transfers and integrals see the solver's fit and nothing else. Particles in
//! wall layers look as far across the wall as their layers are thick: the slope of a boundary layer holds no farther. There
//! they count more than those outside the layers, in proportion to the square of length over thickness.
use super::view::View;
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
    view: View<'a, D>,
    surface: Option<&'a Surface<D>>,
    /// Points are named by where they are before any motion.
    unmoved: bool,
}

impl<'a, const D: usize> Probe<'a, D> {
    /// Asks the gas in `view`, with its gradients.
    pub fn new(view: View<'a, D>, surface: Option<&'a Surface<D>>) -> Self {
        Self { view, surface, unmoved: false }
    }

    /// The same where points are named by where they are before any motion.
    pub fn before_motion(view: View<'a, D>, surface: Option<&'a Surface<D>>) -> Self {
        Self { view, surface, unmoved: true }
    }

    /// The place of the point `x` before any motion, and that among `places`.
    fn origin(&self, x: &Vector<D>) -> (Vector<D>, Vector<D>) {
        if self.unmoved { (*x, *x) } else { (self.view.origin(x), self.view.in_frame(x)) }
    }

    /// Where particles are, in the axes that gradients are in.
    fn places(&self) -> &'a [Vector<D>] {
        if self.unmoved { &self.view.reference().x } else { &self.view.cloud().x }
    }

    /// Size of the background at `x`: about the distance between particles there.
    pub fn spacing(&self, x: &Vector<D>, near: &mut Near<D>) -> f64 {
        near.leaf(&self.view.reference().tree, &self.origin(x).0).size
    }

    /// State at `x`; `None` where no particle is near.
    pub fn at(&self, x: &Vector<D>) -> Option<Primitive<D>> {
        self.beside(x, &mut Near::default())
    }

    /// The same where points are asked one after another that are mostly in the leaf of the one before.
    pub fn beside(&self, x: &Vector<D>, near: &mut Near<D>) -> Option<Primitive<D>> {
        let mut sum: Option<Primitive<D>> = None;
        let mut weight = 0.0;
        self.offers(x, near, |k, w, d| {
            let offer = self.offer(k, d);
            sum = Some(sum.map_or_else(|| scaled(&offer, w), |s| s.plus(w, &offer)));
            weight += w;
        });
        sum.map(|s| self.view.turned(&scaled(&s, 1.0 / weight)))
    }

    /// Curl of the velocity at `x`, blended from that at the particles; `None` where none is near.
    pub fn vorticity(&self, x: &Vector<D>, near: &mut Near<D>) -> Option<[f64; 3]> {
        let (mut sum, mut weight) = ([0.0; 3], 0.0);
        self.offers(x, near, |k, w, _| {
            let own = self.view.vorticity(k);
            (0..3).for_each(|d| sum[d] += w * own[d]);
            weight += w;
        });
        (weight > 0.0).then(|| sum.map(|s| s / weight))
    }

    /// Calls `f(particle, weight, offset)` for all that have a word at `x`.
    #[inline]
    fn offers(&self, x: &Vector<D>, near: &mut Near<D>, mut f: impl FnMut(usize, f64, &Vector<D>)) {
        // the background knows particles where they were before any motion
        let cloud = self.view.reference();
        let (x, place) = &self.origin(x);
        let places = self.places();
        let leaf = near.leaf(&cloud.tree, x);
        let reach = RADIUS * leaf.size;
        if near.listed != Some(leaf.node) {
            near.listed = Some(leaf.node);
            near.list.clear();
            let corner = Vector::splat(0.5 * leaf.size + reach);
            let cube = Bounds { min: leaf.centre - corner, max: leaf.centre + corner };
            cloud.tree.overlapping(&cube, |node| near.list.extend(cloud.leaves.of(node)));
        }
        for k in &near.list {
            let k = *k as usize;
            let w = self.weight(k, &(*x - cloud.x[k]), reach);
            if w > 0.0 && self.in_sight(k, x) {
                f(k, w, &(*place - places[k]));
            }
        }
    }

    /// Weight of particle `k` at the offset `d` from it.
    #[inline(always)]
    fn weight(&self, k: usize, d: &Vector<D>, reach: f64) -> f64 {
        let cloud = self.view.reference();
        // most are too far away, and in layers no nearer than that
        if d.norm_squared() >= reach * reach {
            return 0.0;
        }
        let Some((column, layer)) = cloud.layers.slot(k) else {
            return (1.0 - d.norm() / reach).powi(2);
        };
        let stretch = (cloud.spacing[k] / cloud.layers.thickness(column, layer)).max(1.0);
        let across = d.dot(cloud.layers.normal(column));
        let distance = (d.norm_squared() + across * across * (stretch * stretch - 1.0)).sqrt();
        (stretch * (1.0 - distance / reach).max(0.0)).powi(2)
    }

    fn offer(&self, k: usize, d: &Vector<D>) -> Primitive<D> {
        let q = &self.view.work.state[k];
        let linear = q.plus(1.0, &self.view.work.gradient[k].along(d));
        if linear.density > 0.0 && linear.pressure > 0.0 { linear } else { *q }
    }

    fn in_sight(&self, k: usize, x: &Vector<D>) -> bool {
        let cloud = self.view.reference();
        let near = cloud.wall_distance[k] < RADIUS * 2.0 * cloud.spacing[k];
        !near || self.surface.is_none_or(|s| !s.crosses(&cloud.x[k], x))
    }
}

fn scaled<const D: usize>(q: &Primitive<D>, s: f64) -> Primitive<D> {
    Primitive { density: q.density * s, velocity: q.velocity * s, pressure: q.pressure * s }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Instant, System};

    #[test]
    fn a_boundary_layer_has_no_jet_beside_it() {
        const THICKNESS: f64 = 0.02;
        let text = "[flow]\nmach = 0.3\nreynolds = 1e4\n[[body]]\ncircle = { radius = 0.5 }\n[cloud]\nspacing = 0.02\nfar_field = 4\n\
                    wall_layers = { first = 0.001 }\n";
        let fluid = crate::scheme::built::fluid(text);
        let exact = |x: &Vector<2>| 1.0 - (-(x.norm() - 0.5) / THICKNESS).exp();
        let frame = fluid.frame(&Instant::still(0.0), &vec![1.0; fluid.len()]);
        let mut work = fluid.work();
        for (q, x) in work.state.iter_mut().zip(&fluid.discretisation.cloud.x) {
            *q = Primitive { density: 1.0, velocity: Vector([exact(x), 0.0]), pressure: 0.7 };
        }
        fluid.fill_gradients(&frame, &mut work);
        let probe = Probe::new(View::new(&fluid, &frame, &work), None);
        for angle in [0.3f64, 1.1, 2.5] {
            for k in 1..200 {
                let x = Vector([angle.cos(), angle.sin()]) * (0.5 + 0.001 * f64::from(k));
                let found = probe.at(&x).unwrap().velocity[0];
                assert!(found < 1.01 && (found - exact(&x)).abs() < 0.03, "{found} for {} at {x:?}", exact(&x));
            }
        }
    }
}
