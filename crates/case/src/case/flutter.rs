//! Flutter analysis, as data: Mach numbers, matching, accuracy and options.
pub(super) mod check;
pub(super) mod keys;
mod limit_cycles;

use serde::{Deserialize, Serialize};

pub use limit_cycles::{GasResponse, LimitCycles};

use super::quantity::Velocity;
use super::{Case, Temporal, Time};

/// The table `[flutter]`: settings of the flutter analysis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flutter {
    /// Mach numbers; empty: the one of `[flow]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mach: Vec<f64>,
    /// Reduced frequencies at which forces are computed first; empty: those of [`Self::first`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reduced_frequencies: Vec<f64>,
    /// The quantity of the stream that is varied.
    #[serde(rename = "match")]
    pub matching: Matching,
    /// Upper bound of the search: speed relative to that of the structure, or density relative to that of the case
    /// where density is varied.
    pub most: f64,
    /// Relative difference of the flutter speed between two successive interpolations at which the refinement ends.
    pub accuracy: f64,
    /// Greatest number of reduced frequencies.
    pub frequencies: u32,
    /// True when forces are computed about the static aeroelastic equilibrium at the first flutter point.
    pub trim: bool,
    /// True when the aeroelastic system is also written in state-space form.
    pub state_space: bool,
    /// True when the limiter keeps the values of the steady flow.
    pub frozen_limiter: bool,
    /// True when flutter points and damping are also computed on a coarser cloud, for an error estimate.
    pub cloud_error: bool,
    /// Design dive speed V_D as equivalent airspeed, relative to which margins are reported.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub design_speed: Option<Velocity>,
}

/// Quantity of the stream that is varied at constant Mach number (matching).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Matching {
    /// Speed and sound speed at the density of the case; the atmosphere is not matched.
    #[default]
    None,
    /// Density at the sound speed of the case, as in a wind tunnel.
    Density,
    /// Altitude in the standard atmosphere, which determines density and sound speed.
    Altitude,
}

impl Flutter {
    /// Reduced frequencies at which forces are computed first, ascending, from nearly steady to twice the usual flutter
    /// value of sections.
    pub fn first(&self) -> Vec<f64> {
        const USUAL: [f64; 4] = [0.02, 0.08, 0.2, 0.5];
        let mut all =
            if self.reduced_frequencies.is_empty() { USUAL.to_vec() } else { self.reduced_frequencies.clone() };
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// Expected number of reduced frequencies: the first ones, zero, and two near a flutter point.
    pub fn expected(&self) -> usize {
        (self.first().len() + 3).min(self.frequencies.max(1) as usize)
    }
}

impl Case {
    /// True when the limiter keeps the values of the steady flow in small motions.
    pub fn freezes_limiter(&self) -> bool {
        self.flutter.as_ref().is_some_and(|f| f.frozen_limiter) || self.gaf.as_ref().is_some_and(|g| g.frozen_limiter)
    }

    /// True when forces are computed about the static aeroelastic equilibrium.
    pub fn is_trimmed(&self) -> bool {
        self.flutter.as_ref().is_some_and(|f| f.trim)
    }

    /// Estimated period of the free vibration of structures that a march is to find.
    pub fn swing(&self) -> Option<Time> {
        match &self.time {
            Temporal::Dual(dual) => dual.swing,
            _ => None,
        }
    }
}
