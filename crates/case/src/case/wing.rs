//! Wings given by planform and sections, as data.
use super::kinds::{POSITIVE, SIZE};
use super::naca::{NACA, Naca};
use super::quantity::{Angle, Length};
use super::schema::{Absent, Kind, Range, defaulted, keys, optional, required, words};

const SECTION: &str = "another key of the section";
/// Steepest sweep of a wing, radians (80°), and the dihedral of a fin.
const STEEPEST_SWEEP: f64 = 80.0 * std::f64::consts::PI / 180.0;
const UPRIGHT: f64 = 0.5 * std::f64::consts::PI;

keys! {
    /// A wing, a tail or a fin.
    pub struct Wing, WING {
        /// NACA section, at the root where there is another one at the tip.
        naca: Option<Naca> = optional(Kind::Table(&NACA), SECTION),
        /// Coordinate file of the section.
        airfoil: Option<String> = optional(Kind::File, SECTION),
        /// NACA section at the tip.
        tip_naca: Option<Naca> = optional(Kind::Table(&NACA), "that of the root"),
        /// Coordinate file of the section at the tip.
        tip_airfoil: Option<String> = optional(Kind::File, "that of the root"),
        /// Distance from tip to tip; from root to tip where there is one side.
        span: Length = required(SIZE),
        /// Chord at the root.
        chord: Option<Length> = optional(SIZE, "from `aspect_ratio`").alias("root_chord"),
        /// Square of the span over the area.
        aspect_ratio: Option<f64> = optional(POSITIVE, "from `chord`"),
        /// Chord at the tip over that at the root.
        taper: f64 = defaulted(Kind::Number(Range::POSITIVE), Absent::Number(1.0)),
        /// Angle by which the line at `sweep_at` of the chord is swept back.
        sweep: Angle = defaulted(
            Kind::Quantity(Angle::DIMENSION, Range::between(-STEEPEST_SWEEP, STEEPEST_SWEEP)), Absent::Number(0.0),
        ),
        /// Part of the chord at which that line runs: 0 is the leading edge.
        sweep_at: f64 = defaulted(Kind::Number(Range::between(0.0, 1.0)), Absent::Number(0.0)),
        /// Angle by which tips are raised; `"90 deg"` for a fin, which has one side.
        dihedral: Angle = defaulted(
            Kind::Quantity(Angle::DIMENSION, Range::between(-UPRIGHT, UPRIGHT)), Absent::Number(0.0),
        ),
        /// Angle by which the nose of the tip is turned up against the root, about the quarter chord; in between it
        /// grows in proportion to the distance from the root.
        twist: Angle = defaulted(
            Kind::Quantity(Angle::DIMENSION, Range::between(-UPRIGHT, UPRIGHT)), Absent::Number(0.0),
        ),
        /// How the chord changes along the span.
        planform: PlanformShape = defaulted(Kind::Words(PLANFORMS), Absent::Word("straight")),
        /// How tips end.
        tip: Tip = defaulted(Kind::Words(TIPS), Absent::Word("round")),
        /// Which sides there are.
        sides: WingSides = defaulted(Kind::Words(WING_SIDES), Absent::Word("both")),
    }
}

words! {
    /// Chord distribution along the span.
    pub enum PlanformShape, PLANFORMS {
        /// in proportion to the distance from the root
        Straight = "straight",
        /// as that of an ellipse, without `taper`
        Elliptic = "elliptic",
    }

    /// Shape of a wing tip.
    pub enum Tip, TIPS {
        /// half a circle seen from ahead, inside the planform; an elliptic planform ends in a point
        Round = "round",
        /// the face of the last section
        Flat = "flat",
        /// half a body of revolution of the last section, beyond the span, as of the ONERA M6
        Revolved = "revolved",
    }

    /// Whether both sides of a wing exist or one only.
    pub enum WingSides, WING_SIDES {
        /// both, mirrored at y = 0
        Both = "both",
        /// that of positive y, or the fin
        One = "one",
    }

    /// Curve through the points of a profile.
    pub enum ProfileSides, PROFILE_SIDES {
        /// a smooth curve with corners where it turns by more than 35 deg; its ends on the axis are round where it
        /// reaches them at more than 30 deg
        Smooth = "smooth",
        /// straight lines: cones and cylinders
        Straight = "straight",
    }
}
