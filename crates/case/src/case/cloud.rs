//! How particles fill the domain, as data: spacings, layers along walls, refinement that follows the solution.
//!
//! Ranges that are not plain logic come from the numerics: particles nearer to the wall than 0.3 spacings spoil the
//! conditioning of their clouds, more than 0.6 leave a gap; fewer than 3 particles a level do not fill a cloud.
use super::kinds::{COUNT, POINT, SIZE};
use super::quantity::Length;
use super::schema::{Absent, Kind, List, Range, defaulted, keys, optional, required, words};

const LEVELS: Kind = Kind::Integer(0, 16);

keys! {
    /// Distribution of the particles in the domain. Lengths are in the unit of the geometry.
    pub struct Cloud, CLOUD {
        /// Particle spacing at the surface; of the whole domain when there is no body, where it must be given. In space
        /// and with viscosity too.
        spacing: Option<Length> = optional(
            SIZE, "1/64 of the shortest body; a steady case goes on to finer clouds as `[accuracy]` says",
        ),
        /// Half-width of the far field around the bodies; not beside `domain`.
        far_field: Option<Length> = optional(SIZE, "40 chords (2-D), 10 (3-D)"),
        /// Explicit domain: whole numbers of `spacing` long. Where the program chooses the spacing, far sides move
        /// outward until they are.
        domain: Option<Domain> = optional(
            Kind::Table(&DOMAIN), "a square or cube of half-width `far_field`; must be given when there is no body",
        ),
        /// Particles per level of refinement, counted away from the surface.
        layers: Option<f64> = optional(Kind::Number(Range::between(3.0, 1000.0)), "6; 12 where no `spacing` is given"),
        /// Extra levels of refinement at sharp edges.
        edge_levels: u32 = defaulted(LEVELS, Absent::Integer(2)),
        /// Spacing is at most this fraction of the local radius of curvature.
        curvature: f64 = defaulted(Kind::Number(Range { min: 0.0, max: 1.0, closed: false }), Absent::Number(0.125)),
        /// Greatest number of extra levels that curvature may ask for.
        curvature_levels: u32 = defaulted(LEVELS, Absent::Integer(3)),
        /// A box with its own spacing.
        #[serde(default)]
        boxes as "box": Vec<RefineBox> = defaulted(Kind::Tables(&REFINE), Absent::Filled),
        /// Refinement behind the bodies along the free stream.
        wake: Option<Wake> = optional(Kind::Table(&WAKE), "no refinement"),
        /// Layers of particles along the walls, thin across them.
        wall_layers: Option<WallLayers> = optional(Kind::Table(&WALL_LAYERS), "no layers"),
        /// Fluid particles nearer to the wall than this fraction of the local spacing are left out.
        blank: f64 = defaulted(Kind::Number(Range::between(0.3, 0.6)), Absent::Number(0.4)),
        /// Radius of the clouds near the wall in local spacings.
        radius: f64 = defaulted(Kind::Number(Range::between(1.0, 4.0)), Absent::Number(1.6)),
        /// Random displacement of interior particles as a fraction of the local spacing (for tests of robustness).
        jitter: f64 = defaulted(Kind::Number(Range::between(0.0, 0.45)), Absent::Number(0.0)),
    }

    /// An explicit rectangular domain.
    pub struct Domain, DOMAIN {
        /// Corner with the smallest coordinates.
        min: Vec<Length> = required(POINT),
        /// Corner with the largest coordinates.
        max: Vec<Length> = required(POINT),
    }

    /// A box with a spacing of its own.
    pub struct RefineBox, REFINE {
        /// Corner with the smallest coordinates.
        min: Vec<Length> = required(POINT),
        /// Corner with the largest coordinates.
        max: Vec<Length> = required(POINT),
        /// Largest spacing inside.
        spacing: Length = required(SIZE),
    }

    /// Refinement of the wake.
    pub struct Wake, WAKE {
        /// Length behind the trailing edge.
        length: Length = required(SIZE),
        /// Largest spacing inside.
        spacing: Length = required(SIZE),
    }

    /// Layers of particles along the walls.
    #[derive(Copy)]
    pub struct WallLayers, WALL_LAYERS {
        /// Distance of the first layer from the wall.
        first: Length = required(SIZE),
        /// Ratio of the distances between successive layers.
        growth: f64 = defaulted(Kind::Number(Range::between(1.0, 1.5)), Absent::Number(1.2)),
        /// Greatest number of layers; fewer where the surface turns sharply or another wall is near.
        count: Option<u32> = optional(
            Kind::Integer(1, 1000), "until layers are as far apart as the particles of a layer",
        ),
    }

    /// Solution-adaptive refinement.
    pub struct Adapt, ADAPT {
        /// Number of refinements (0: none).
        cycles: u32 = defaulted(Kind::Integer(0, 64), Absent::Integer(0)),
        /// Finest spacing that adaptation may ask for.
        spacing: Option<Length> = optional(SIZE, "`cloud.spacing`"),
        /// Greatest number of particles.
        particles: usize = defaulted(COUNT, Absent::Integer(2_000_000)),
        /// Sensors in use.
        sensors: Vec<Sensor> = defaulted(
            Kind::List(&List { item: Kind::Words(SENSORS), min: 1, max: 3, single: true }),
            Absent::Words(&["shock", "curvature"]),
        ),
    }
}

words! {
    /// Sensor of the adaptive refinement.
    pub enum Sensor, SENSORS {
        /// jumps of pressure across an edge
        Shock = "shock",
        /// jumps of tangential velocity across an edge
        Shear = "shear",
        /// second differences of density and velocity
        Curvature = "curvature",
    }
}

impl Cloud {
    /// Number of particles across each level of refinement.
    pub fn particles_per_level(&self) -> f64 {
        self.layers.unwrap_or(6.0)
    }
}

impl Default for Adapt {
    fn default() -> Self {
        ADAPT.value()
    }
}
