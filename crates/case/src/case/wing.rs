//! Wings by their planform and sections, and bodies of revolution, as a case names them.
use serde::{Deserialize, Serialize};

use super::naca::Naca;
use super::quantity::{Angle, Length};

/// A wing, a tail or a fin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wing {
    /// NACA section, at the root where there is another one at the tip.
    pub naca: Option<Naca>,
    /// Section from a coordinate file, in place of `naca`.
    pub airfoil: Option<String>,
    /// NACA section at the tip; absent: that of the root.
    pub tip_naca: Option<Naca>,
    /// Section at the tip from a coordinate file.
    pub tip_airfoil: Option<String>,
    /// Distance from tip to tip, of a wing with one side from root to tip.
    pub span: Length,
    /// Chord at the root.
    pub chord: Option<Length>,
    /// Square of the span over the area, which gives the chord where that is absent.
    pub aspect_ratio: Option<f64>,
    /// Chord at the tip over that at the root.
    pub taper: f64,
    /// Angle by which a line at `sweep_at` of the chord is swept back.
    pub sweep: Angle,
    /// Part of the chord at which that line runs.
    pub sweep_at: f64,
    /// Angle by which the tips are raised; ±90° for a fin.
    pub dihedral: Angle,
    /// Angle by which the nose of the tip is turned up against that of the root, about the quarter chord; in between it grows in
    /// proportion to the distance from the root.
    pub twist: Angle,
    /// How the chord changes along the span.
    pub planform: PlanformShape,
    /// How tips end.
    pub tip: Tip,
    /// Which sides there are.
    pub sides: WingSides,
}

/// How the chord changes along the span.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlanformShape {
    /// In proportion to the distance from the root.
    Straight,
    /// As that of an ellipse.
    Elliptic,
}

/// How a tip ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tip {
    /// Half a circle seen from ahead, inside the planform.
    Round,
    /// Half a body of revolution of the last section, beyond the planform.
    Revolved,
    /// The face of the last section.
    Flat,
}

/// Which sides a wing has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WingSides {
    /// Both, mirrored at y = 0.
    Both,
    /// That of positive y, or the fin.
    One,
}

/// What joins the points of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProfileSides {
    /// A smooth curve, with corners where it turns by more than 35°.
    Smooth,
    /// Straight lines.
    Straight,
}
