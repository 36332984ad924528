//! Layout of the background tree: domain, levels, and sources of refinement.
use super::estimate::Estimate;
use super::sources::{SIZE_SLACK, Source, SourceBox, Sources};
use super::tree::{Forest, Tree};
use super::{CloudError, CloudSpec, Transform};
use crate::case::Side;
use crate::geometry::Surface;
use crate::math::{Bounds, Vector};

/// Default half-width of the far field in body lengths, for two and three dimensions.
const FAR_FIELD: [f64; 2] = [40.0, 10.0];
/// Turning angle [rad] above which an edge of the surface is refined by additional levels.
const SHARP: f64 = 0.35;
/// Greatest relative deviation of the sides of an explicit domain from a whole number of cells.
const MISFIT: f64 = 1e-6;

/// The box that the domain fills and the boundary conditions on its sides.
#[derive(Clone, Debug)]
pub struct Layout<const D: usize> {
    /// Root cells of the background tree.
    pub forest: Forest<D>,
    /// Boundary conditions on the sides, `[axis][0: smallest, 1: largest coordinate]`.
    pub sides: [[Side; 2]; D],
}

impl<const D: usize> Layout<D> {
    /// Determines the root cells of the domain. Fails when an explicit domain is not a whole number of cells long, or
    /// when a body crosses a side of the domain.
    pub fn new(spec: &CloudSpec<D>, surface: Option<&Surface<D>>) -> Result<Self, CloudError> {
        let sides = spec.sides;
        let forest = match (&spec.domain, surface) {
            (Some(domain), _) => explicit(spec, domain)?,
            (None, Some(surface)) => around(spec, surface),
            (None, None) => return Err(CloudError::Layout("a case without bodies needs `cloud.domain`".into())),
        };
        let layout = Self { forest, sides };
        surface.map_or(Ok(()), |s| layout.contains(s))?;
        Ok(layout)
    }

    /// Bounds of the domain.
    pub fn bounds(&self) -> Bounds<D> {
        let Forest { origin, root_size, roots, .. } = self.forest;
        Bounds { min: origin, max: origin + Vector::from_fn(|d| f64::from(roots[d]) * root_size) }
    }

    /// Rejects bodies that lie outside the domain or cross a side with inflow or outflow.
    fn contains(&self, surface: &Surface<D>) -> Result<(), CloudError> {
        for (body, name) in surface.bodies.iter().enumerate() {
            let bounds = surface.bounds_of(body);
            let cut = self.planes().into_iter().find(|(d, outward, plane)| {
                let side = self.sides[*d][usize::from(*outward > 0.0)];
                let [near, far] =
                    if *outward > 0.0 { [bounds.min[*d], bounds.max[*d]] } else { [-bounds.max[*d], -bounds.min[*d]] };
                let plane = outward * plane;
                near >= plane || (far > plane && side != Side::Symmetry)
            });
            if let Some((d, _, plane)) = cut {
                let axis = ["x", "y", "z"][d];
                return Err(CloudError::Layout(format!(
                    "body `{name}` from {} to {} lies across or beyond the side {axis} = {plane} of the domain\nhint: enlarge \
                     `cloud.domain`, or move the body; only a plane of symmetry may cut a body",
                    bounds.min, bounds.max
                )));
            }
        }
        Ok(())
    }

    /// Sides that end the domain, as planes: axis, sign of the outward normal, coordinate.
    pub fn planes(&self) -> Vec<(usize, f64, f64)> {
        let low = |d: usize| self.forest.origin[d];
        let high = |d: usize| low(d) + f64::from(self.forest.roots[d]) * self.forest.root_size;
        let closed = (0..D).filter(|d| self.sides[*d][0] != Side::Periodic);
        closed.flat_map(|d| [(d, -1.0, low(d)), (d, 1.0, high(d))]).collect()
    }

    /// All compositions of the reflections at planes of symmetry and the translations across periodic sides.
    pub fn transforms(&self) -> Vec<Transform<D>> {
        let identity = Transform { sign: Vector::splat(1.0), offset: Vector::ZERO };
        let mut all = vec![identity];
        for d in 0..D {
            let low = self.forest.origin[d];
            let length = f64::from(self.forest.roots[d]) * self.forest.root_size;
            let mut along = Vec::new();
            for (end, plane) in [(0, low), (1, low + length)] {
                match self.sides[d][end] {
                    Side::Symmetry => along.push((-1.0, 2.0 * plane)),
                    Side::Periodic => along.push((1.0, if end == 0 { -length } else { length })),
                    _ => {}
                }
            }
            for base in all.clone() {
                for (sign, offset) in &along {
                    let mut t = base;
                    t.sign[d] = *sign;
                    t.offset[d] = *offset;
                    all.push(t);
                }
            }
        }
        all.remove(0);
        all
    }
}

/// Root cells of an explicit domain: their size is the largest power-of-two multiple of the spacing that divides every
/// side.
fn explicit<const D: usize>(spec: &CloudSpec<D>, domain: &Bounds<D>) -> Result<Forest<D>, CloudError> {
    let Bounds { min, max } = *domain;
    let spacing = spec.spacing;
    let cells: [f64; D] = std::array::from_fn(|d| (max[d] - min[d]) / spacing);
    for d in 0..D {
        if (cells[d] - cells[d].round()).abs() > MISFIT * cells[d] || cells[d] < 0.5 {
            return Err(CloudError::Layout(format!(
                "side {d} of `cloud.domain` is {} long, not a whole number of `cloud.spacing` = {spacing}\nhint: {} cells would fit with a spacing of {}",
                max[d] - min[d],
                cells[d].round().max(1.0),
                (max[d] - min[d]) / cells[d].round().max(1.0)
            )));
        }
    }
    let whole: [u64; D] = std::array::from_fn(|d| cells[d].round() as u64);
    let shift = whole.iter().map(|c| c.trailing_zeros()).min().unwrap_or(0).min(10);
    let root_size = spacing * f64::from(1u32 << shift);
    let roots = std::array::from_fn(|d| (whole[d] >> shift) as u32);
    if roots.iter().any(|r| *r >= 1 << 11) {
        return Err(CloudError::Layout(format!(
            "`cloud.domain` needs {roots:?} root cells, at most 2047 along an axis\nhint: make its sides multiples of a larger power of two of the spacing"
        )));
    }
    let periodic = std::array::from_fn(|d| spec.sides[d][0] == Side::Periodic);
    Ok(Forest { origin: min, root_size, roots, periodic })
}

/// One root cell around the bodies. Planes of symmetry pass through the origin of their axis.
fn around<const D: usize>(spec: &CloudSpec<D>, surface: &Surface<D>) -> Forest<D> {
    let bounds = surface.bounds();
    let length = bounds.extent().max_abs();
    let wanted = spec.far_field.unwrap_or(FAR_FIELD[D - 2] * length);
    let spacing = spec.spacing;
    let half = spacing * 2f64.powf((wanted / spacing).log2().ceil());
    let centre = bounds.centre();
    // The grid is aligned with the origin, so that the cloud of a section that is symmetric about an axis is symmetric
    // too.
    let snap = |c: f64| (c / spacing).round() * spacing;
    let origin = Vector::from_fn(|d| match (spec.halves(d, 0), spec.halves(d, 1)) {
        (true, _) => 0.0,
        (_, true) => -half,
        _ => snap(centre[d]) - half,
    });
    // Where a plane of symmetry cuts off half of the space, root cells of half the width fill the other half.
    let cut = |d: usize| spec.halves(d, 0) || spec.halves(d, 1);
    let halved = (0..D).any(cut);
    let count = |d: usize| if !halved || cut(d) { 1 } else { 2 };
    let root_size = if halved { half } else { 2.0 * half };
    Forest { origin, root_size, roots: std::array::from_fn(count), periodic: [false; D] }
}

/// Builds the background tree. `extra` are sources of refinement that follow the solution. Fails when the cloud would
/// be too large or when the wanted spacing is finer than the deepest level of the tree.
pub fn background<const D: usize>(
    spec: &CloudSpec<D>,
    layout: &Layout<D>,
    surface: Option<&Surface<D>>,
    extra: &[Source<D>],
) -> Result<Tree<D>, CloudError> {
    let mut points = extra.to_vec();
    let mut boxes = user_boxes(spec, surface);
    if surface.is_none() {
        boxes.push(SourceBox { bounds: layout.bounds(), spacing: spec.spacing });
    }
    let size = Estimate::new(spec, &layout.bounds(), surface, &boxes);
    size.check(spec.most)?;
    if let Some(surface) = surface {
        surface_sources(spec, surface, &mut points);
    }
    reaches(layout, &points, &boxes)?;
    let sources = Sources::new(points, boxes);
    let tree = Tree::build(&layout.forest, size.most_cells(spec.most), |x, size| sources.split(x, size));
    tree.ok_or_else(|| size.refused(format!("more than {}", spec.most), spec.most))
}

/// Number of cells of the background tree around a surface and the sources in `extra`. This is slightly more than the
/// number of particles of the cloud and costs a small part of building it.
pub fn count<const D: usize>(
    spec: &CloudSpec<D>,
    surface: Option<&Surface<D>>,
    extra: &[Source<D>],
) -> Result<usize, CloudError> {
    let layout = Layout::new(spec, surface)?;
    Ok(background(spec, &layout, surface, extra)?.leaves().count())
}

/// Rejects spacings that are finer than the deepest level of the tree.
fn reaches<const D: usize>(layout: &Layout<D>, points: &[Source<D>], boxes: &[SourceBox<D>]) -> Result<(), CloudError> {
    let finest = points.iter().map(|p| p.spacing).chain(boxes.iter().map(|b| b.spacing)).fold(f64::INFINITY, f64::min);
    let possible = layout.forest.finest();
    if possible <= finest * SIZE_SLACK {
        return Ok(());
    }
    Err(CloudError::Layout(format!(
        "the spacing {finest:.3e} is too fine for this domain: the finest possible spacing is {possible:.3e}\nhint: lower \
         `cloud.far_field`, or raise `cloud.spacing`"
    )))
}

/// A warning with the place where the curvature of the surface asks for a finer spacing than `curvature_levels`
/// permits; `None` where there is no such place.
pub fn capped<const D: usize>(spec: &CloudSpec<D>, surface: &Surface<D>) -> Option<String> {
    let finest = finest(spec);
    let radius = |e: &u32| surface.radius[*e as usize];
    let mut sharp: Vec<u32> = (0..surface.elements.len() as u32).filter(|e| radius(e) < finest).collect();
    // An outline that ends in a cusp may have any curvature within one particle spacing of its edge.
    if D == 2 {
        let mut edges = Vec::new();
        surface.for_each_sharp_point(0.0, finest, |x| edges.push(*x));
        let beside = |e: &u32| edges.iter().any(|x| (surface.corners(*e)[0] - *x).norm() < finest);
        sharp.retain(|e| !beside(e));
    }
    sharp.sort_by(|a, b| radius(a).total_cmp(&radius(b)));
    // In 3-D the tips taper off to a point; a piece of surface smaller than a particle is therefore ignored.
    let (mut seen, patch) = (0.0, if D == 2 { 0.0 } else { finest.powi(D as i32 - 1) });
    let found = sharp.into_iter().find(|e| {
        seen += surface.element_area_vector(*e).norm();
        seen >= patch
    })?;
    let (x, radius) = (surface.corners(found)[0], radius(&found));
    let levels = (spec.spacing / (spec.curvature * radius).max(f64::MIN_POSITIVE)).log2().ceil();
    Some(format!(
        "near {x} the surface has a radius of curvature of {radius:.2e}, but the finest spacing is {finest:.2e}: \
         `cloud.curvature_levels = {levels}` resolves it (now {})",
        spec.curvature_levels
    ))
}

/// The finest spacing that curvature may ask for.
fn finest<const D: usize>(spec: &CloudSpec<D>) -> f64 {
    spec.spacing / f64::from(1u32 << spec.curvature_levels)
}

fn user_boxes<const D: usize>(spec: &CloudSpec<D>, surface: Option<&Surface<D>>) -> Vec<SourceBox<D>> {
    let mut boxes = spec.boxes.clone();
    if let (Some(wake), Some(surface)) = (&spec.wake, surface) {
        let b = surface.bounds();
        let mut max = b.max;
        max[0] += wake.length.0;
        boxes.push(SourceBox { bounds: Bounds { min: b.min, max }, spacing: wake.spacing.0 });
    }
    boxes
}

/// Adds the points of the surface with the spacing that the specification, the curvature and the sharp edges ask for.
fn surface_sources<const D: usize>(cloud: &CloudSpec<D>, surface: &Surface<D>, points: &mut Vec<Source<D>>) {
    let base = cloud.spacing;
    let finest = finest(cloud);
    points.extend(surface.samples(0.5 * base, |x, radius| {
        let spacing = (cloud.curvature * radius).clamp(finest, base);
        Source { x: *x, spacing, layers: cloud.layers }
    }));
    let edge = base / f64::from(1u32 << cloud.edge_levels);
    surface.for_each_sharp_point(SHARP, edge, |x| points.push(Source { x: *x, spacing: edge, layers: cloud.layers }));
}
