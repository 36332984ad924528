//! Loads, and where they act.
use serde::{Deserialize, Serialize};

use crate::observe::hinge::HingeMoment;
use crate::observe::induced::SpanLoad;
use crate::observe::loads::Coefficients;
use crate::observe::strips::RootLoads;

/// Loads on all bodies.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Loads {
    /// Loads from wall pressure and friction: of the steady flow, or of the instant `loads_at`.
    #[serde(rename = "loads")]
    pub total: Coefficients,
    /// The part of the pressure, where the gas has viscosity.
    #[serde(rename = "loads_pressure", default, skip_serializing_if = "Option::is_none")]
    pub pressure: Option<Coefficients>,
    /// The part of the friction.
    #[serde(rename = "loads_friction", default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<Coefficients>,
    /// Loads from the momentum of the gas around the bodies; null without bodies.
    #[serde(rename = "loads_momentum_balance")]
    pub momentum_balance: Option<Coefficients>,
    /// Where friction turns against the stream.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub separation: Vec<Separation>,
    /// The vortex behind the tip of what lifts, in space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip_vortex: Option<TipVortex>,
    /// What acts at the roots of wings and fins.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub root_loads: Vec<RootLoads>,
    /// Moments about the hinges of the case.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hinge_moments: Vec<HingeMoment>,
    /// Lift and induced drag of the load along the span.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span_load: Option<SpanLoad>,
    /// Lift and drag from planes behind the bodies, the nearest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wake_planes: Vec<WakePlane>,
}

/// A place where friction on a wall turns against the stream.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Separation {
    /// Number of the body, from 0.
    pub body: u16,
    /// True on the side whose normal has a part along the lift.
    pub upper: bool,
    /// Distance from the nose over the extent of the bodies.
    pub x_c: f64,
}

/// The vortex that leaves a tip, in the units of the case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TipVortex {
    /// Place of the plane.
    pub x: f64,
    /// Place of the core along the span.
    pub y: f64,
    /// Height of the core.
    pub z: f64,
    /// Circulation of the half plane; positive for lift.
    pub circulation: f64,
}

/// Lift and drag from one plane behind the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WakePlane {
    /// Distance behind the bodies in reference chords.
    pub distance: f64,
    /// Place along x.
    pub x: f64,
    /// Lift coefficient of the vorticity of the wake.
    pub cl: f64,
    /// Induced drag coefficient.
    pub cd_induced: f64,
    /// Drag coefficient of entropy: shocks, and what the scheme loses.
    pub cd_entropy: f64,
    /// Sum of both.
    pub cd: f64,
}
