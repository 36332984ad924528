//! What a cloud is made from, as plain values: by hand, or from the tables `[cloud]` and `[boundary]` of a case.
use super::sources::SourceBox;
use crate::case::{self, Case, Side, Wake, WallLayers};
use crate::math::{Bounds, Vector};

/// Greatest number of particles whose cells have numbers of 32 bits, parents included.
const MOST: usize = 1 << 30;

/// Spacing, domain and refinement of a cloud; lengths are in the unit of the geometry.
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
    /// Spacing at the surface; of the whole domain when there is none.
    pub spacing: f64,
    /// The domain, whole numbers of `spacing` long; `None`: around the surface as `far_field` says.
    pub domain: Option<Bounds<D>>,
    /// Half-width of a domain around the surface; `None`: 40 lengths of it (2-D), 10 (3-D).
    pub far_field: Option<f64>,
    /// Conditions on the sides of the domain, [axis][0: smallest, 1: largest coordinate].
    pub sides: [[Side; 2]; D],
    /// Boxes with their own spacing.
    pub boxes: Vec<SourceBox<D>>,
    /// Refinement behind the surface along the first axis.
    pub wake: Option<Wake>,
    /// Particles per level of refinement, counted away from the surface.
    pub layers: f64,
    /// Extra levels of refinement at sharp edges.
    pub edge_levels: u32,
    /// Spacing is at most this fraction of the local radius of curvature.
    pub curvature: f64,
    /// Greatest number of extra levels that curvature may ask for.
    pub curvature_levels: u32,
    /// Layers of particles along the walls, 2-D only.
    pub wall_layers: Option<WallLayers>,
    /// Fluid particles nearer to the wall than this fraction of the local spacing are left out.
    pub blank: f64,
    /// Radius of the clouds near the wall in local spacings.
    pub radius: f64,
    /// Random displacement of interior particles as a fraction of the local spacing.
    pub jitter: f64,
    /// Greatest number of particles: what memory holds. A cloud that would be larger is refused before it is built.
    pub most: usize,
}

impl<const D: usize> CloudSpec<D> {
    /// A cloud of this spacing in a far field, with the values that a case file leaves out.
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
            most: MOST,
        }
    }

    /// What `[cloud]` and `[boundary]` of a case say, whose spacing is known.
    pub fn of_case(case: &Case) -> Self {
        let (cloud, s) = (&case.cloud, &case.boundary);
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
            most: MOST,
        }
    }
}

impl<const D: usize> CloudSpec<D> {
    /// True where the side `end` of axis `d` is a plane of symmetry, and the other one is not.
    pub fn halves(&self, d: usize, end: usize) -> bool {
        self.sides[d][end] == Side::Symmetry && self.sides[d][1 - end] != Side::Symmetry
    }

    /// What the domain surely reaches no farther than: an explicit one, or the side of planes of symmetry that the gas is on; around
    /// bodies these pass through the origin of their axis.
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
