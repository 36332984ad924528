//! Specification of a cloud as plain values, set by hand or read from the tables `[cloud]` and `[boundary]` of a case.
use super::sources::SourceBox;
use crate::case::{self, Case, Side, Wake, WallLayers};
use crate::math::{Bounds, Vector};

/// Greatest number of particles whose tree, parent cells included, can still be numbered with 32 bits.
const MAX_PARTICLES: usize = 1 << 30;

/// Spacing, domain and refinement of a cloud. All lengths are in the unit of the geometry.
///
/// ```
/// # use alula_cloud::cloud::{Cloud, CloudSpec};
/// # use alula_base::math::{Bounds, Vector};
/// let unit = Bounds { min: Vector([0.0, 0.0]), max: Vector([1.0, 1.0]) };
/// let spec = CloudSpec { domain: Some(unit), jitter: 0.3, ..CloudSpec::new(0.125) };
/// let cloud = Cloud::build(&spec, None, &[]).unwrap();
/// assert_eq!(cloud.n_fluid + cloud.outer.len(), 64);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CloudSpec<const D: usize> {
    /// Spacing at the surface, or in the whole domain when there is no surface.
    pub spacing: f64,
    /// Extent of the domain, each side a whole multiple of `spacing`; `None`: a domain around the surface of half-width
    /// `far_field`.
    pub domain: Option<Bounds<D>>,
    /// Half-width of a domain around the surface; `None`: 40 (2-D) or 10 (3-D) body lengths.
    pub far_field: Option<f64>,
    /// Boundary conditions on the sides of the domain, `[axis][0: smallest, 1: largest coordinate]`.
    pub sides: [[Side; 2]; D],
    /// Boxes with a spacing of their own.
    pub boxes: Vec<SourceBox<D>>,
    /// Refinement behind the surface along the first axis.
    pub wake: Option<Wake>,
    /// Number of particles across each level of refinement, counted away from the surface.
    pub layers: f64,
    /// Number of additional levels of refinement at sharp edges.
    pub edge_levels: u32,
    /// Upper bound of the spacing as a fraction of the local radius of curvature.
    pub curvature: f64,
    /// Greatest number of additional levels of refinement due to curvature.
    pub curvature_levels: u32,
    /// Layers of particles along the walls; `None`: no layers.
    pub wall_layers: Option<WallLayers>,
    /// Clearance of fluid particles from the wall as a fraction of the local spacing; particles nearer to the wall are
    /// left out.
    pub blank: f64,
    /// Radius of the neighbour lists near walls, in local spacings.
    pub radius: f64,
    /// Amplitude of the random displacement of interior particles as a fraction of the local spacing.
    pub jitter: f64,
    /// Greatest number of particles that the memory can hold. A larger cloud is rejected before it is built.
    pub most: usize,
}

impl<const D: usize> CloudSpec<D> {
    /// A cloud of this spacing with a far field; every other value is the default of the case file.
    pub fn new(spacing: f64) -> Self {
        Self {
            spacing,
            domain: None,
            far_field: None,
            sides: [[Side::FarField; 2]; D],
            boxes: Vec::new(),
            wake: None,
            layers: 6.0,
            edge_levels: 2,
            curvature: 0.125,
            curvature_levels: 3,
            wall_layers: None,
            blank: 0.4,
            radius: 1.6,
            jitter: 0.0,
            most: MAX_PARTICLES,
        }
    }

    /// The values of the tables `[cloud]` and `[boundary]` of a case. The spacing of the case must be resolved.
    pub fn of_case(case: &Case) -> Self {
        Self::of(&case.cloud, &case.boundary)
    }

    /// The cloud that the tables `[cloud]` and `[boundary]` describe.
    pub fn of(cloud: &case::Cloud, s: &case::Sides) -> Self {
        let sides = [[s.x_min, s.x_max], [s.y_min, s.y_max], [s.z_min, s.z_max]];
        let boxes =
            cloud.boxes.iter().map(|b| SourceBox { bounds: bounds(&b.min, &b.max), spacing: b.spacing.0 }).collect();
        Self {
            spacing: cloud.spacing.map_or(0.0, |l| l.0),
            domain: cloud.domain.as_ref().map(|d| bounds(&d.min, &d.max)),
            far_field: cloud.far_field.map(|l| l.0),
            sides: std::array::from_fn(|d| sides[d]),
            boxes,
            wake: cloud.wake.clone(),
            layers: cloud.particles_per_level(),
            edge_levels: cloud.edge_levels,
            curvature: cloud.curvature,
            curvature_levels: cloud.curvature_levels,
            wall_layers: cloud.wall_layers,
            blank: cloud.blank,
            radius: cloud.radius,
            jitter: cloud.jitter,
            most: MAX_PARTICLES,
        }
    }
}

impl<const D: usize> CloudSpec<D> {
    /// True when side `end` of axis `d` is a plane of symmetry and the opposite side is not.
    pub fn halves(&self, d: usize, end: usize) -> bool {
        self.sides[d][end] == Side::Symmetry && self.sides[d][1 - end] != Side::Symmetry
    }

    /// Bounds that the domain cannot exceed: those of an explicit domain, or the half space on the fluid side of each
    /// plane of symmetry. A plane of symmetry of a domain around bodies passes through the origin of its axis.
    pub fn limits(&self) -> Bounds<D> {
        let end = |d: usize, end: usize, none: f64| if self.halves(d, end) { 0.0 } else { none };
        self.domain.unwrap_or_else(|| Bounds {
            min: Vector::from_fn(|d| end(d, 0, f64::NEG_INFINITY)),
            max: Vector::from_fn(|d| end(d, 1, f64::INFINITY)),
        })
    }
}

fn bounds<const D: usize>(min: &[case::Length], max: &[case::Length]) -> Bounds<D> {
    let corner = |v: &[case::Length]| Vector::from_fn(|d| v.get(d).map_or(0.0, |l| l.0));
    Bounds { min: corner(min), max: corner(max) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_is_the_same_by_hand_and_in_a_case() {
        let text = "[flow]\nmach = 0.5\n[[body]]\ncircle = { radius = 0.5 }\n[cloud]\nspacing = 0.1\n";
        assert_eq!(CloudSpec::<2>::of_case(&case::read(text, "t").unwrap()), CloudSpec::new(0.1));
    }
}
