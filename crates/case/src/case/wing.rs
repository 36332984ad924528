//! Wings given by planform and sections, as data.
use serde::{Deserialize, Serialize};

use super::naca::Naca;
use super::quantity::{Angle, Length};

/// A wing, a tail or a fin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wing {
    /// NACA section of the root, or of the whole wing.
    pub naca: Option<Naca>,
    /// Coordinate file of the section, an alternative to `naca`.
    pub airfoil: Option<String>,
    /// NACA section at the tip; absent: that of the root.
    pub tip_naca: Option<Naca>,
    /// Coordinate file of the section at the tip.
    pub tip_airfoil: Option<String>,
    /// Span from tip to tip; for a one-sided wing, from root to tip.
    pub span: Length,
    /// Root chord.
    pub chord: Option<Length>,
    /// Aspect ratio: square of the span divided by the area, an alternative to `chord`.
    pub aspect_ratio: Option<f64>,
    /// Taper ratio: tip chord divided by root chord.
    pub taper: f64,
    /// Sweep angle of the line at the fraction `sweep_at` of the chord, positive backward.
    pub sweep: Angle,
    /// Chord fraction of the line to which `sweep` refers.
    pub sweep_at: f64,
    /// Dihedral angle, tips up positive; ±90° for a fin.
    pub dihedral: Angle,
    /// Twist: angle of the tip relative to the root about the quarter chord, nose up positive; linear along the span.
    pub twist: Angle,
    /// Chord distribution along the span.
    pub planform: PlanformShape,
    /// Shape of the tips.
    pub tip: Tip,
    /// Whether both sides exist or one only.
    pub sides: WingSides,
}

/// Chord distribution along the span.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlanformShape {
    /// Linear from root to tip.
    Straight,
    /// Elliptic.
    Elliptic,
}

/// Shape of a wing tip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tip {
    /// Semicircular in front view, inside the planform.
    Round,
    /// Half a body of revolution of the last section, beyond the planform.
    Revolved,
    /// Flat, closed by the last section.
    Flat,
}

/// Whether both sides of a wing exist or one only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WingSides {
    /// Both sides, symmetric about y = 0.
    Both,
    /// The side of positive y, or a fin.
    One,
}

/// Curve through the points of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProfileSides {
    /// A smooth curve, with corners where its direction changes by more than 35°.
    Smooth,
    /// Straight lines.
    Straight,
}
