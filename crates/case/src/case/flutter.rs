//! Flutter boundaries: at which Mach numbers, with what accuracy, as data.
pub(super) mod check;
pub(super) mod keys;
mod limit_cycles;

use serde::{Deserialize, Serialize};

pub use limit_cycles::{GasResponse, LimitCycles};

use super::quantity::Velocity;
use super::{Case, Motion, ParticleMotion, Steady, Temporal, Time};

/// The table `[flutter]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flutter {
    /// Mach numbers; empty: that of `[flow]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mach: Vec<f64>,
    /// Reduced frequencies that forces are computed at first; empty: those of [`Self::first`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reduced_frequencies: Vec<f64>,
    /// What is varied.
    #[serde(rename = "match")]
    pub matching: Matching,
    /// Greatest speed looked at, over that of the structure; in a tunnel density over that of the case.
    pub most: f64,
    /// Part by which two successive interpolations may differ in a speed.
    pub accuracy: f64,
    /// Greatest number of frequencies.
    pub frequencies: u32,
    /// Forces are those about the static equilibrium of structure and gas at the first crossing.
    pub trim: bool,
    /// The structure in the stream is also written as a linear system of first order.
    pub state_space: bool,
    /// The limiter stays what it is in the steady flow.
    pub frozen_limiter: bool,
    /// Crossings and damping are sought on a coarser cloud as well.
    pub cloud_error: bool,
    /// V_D, an equivalent airspeed that margins are told against.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub design_speed: Option<Velocity>,
}

/// How the stream is varied at one Mach number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Matching {
    /// Speed and sound speed, at the density of the case.
    #[default]
    None,
    /// Density, at the sound speed of the case.
    Density,
    /// Altitude in the standard atmosphere, and density and sound speed with it.
    Altitude,
}

impl Flutter {
    /// Reduced frequencies that forces are computed at first, rising: from almost steady to twice what sections flutter at.
    pub fn first(&self) -> Vec<f64> {
        const USUAL: [f64; 4] = [0.02, 0.08, 0.2, 0.5];
        let mut all =
            if self.reduced_frequencies.is_empty() { USUAL.to_vec() } else { self.reduced_frequencies.clone() };
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// Frequencies that forces are computed at, about: those at first, at rest, and two near a crossing.
    pub fn expected(&self) -> usize {
        (self.first().len() + 3).min(self.frequencies.max(1) as usize)
    }
}

impl Case {
    /// True where the limiter stays in small motions what it is in the steady flow.
    pub fn freezes_limiter(&self) -> bool {
        self.flutter.as_ref().is_some_and(|f| f.frozen_limiter) || self.gaf.as_ref().is_some_and(|g| g.frozen_limiter)
    }

    /// True where forces are sought about the static equilibrium of structure and gas.
    pub fn is_trimmed(&self) -> bool {
        self.flutter.as_ref().is_some_and(|f| f.trim)
    }

    /// The steady flow on the cloud of the case, so far converged that small motions about it can be told; `particles` follow bodies.
    pub fn settled_case(&self, particles: ParticleMotion) -> Self {
        /// Orders that the residual falls by: what is left of it is a force that does not belong to the motion.
        const ORDERS: f64 = 9.0;
        let mut case = self.clone();
        let steady = if let Temporal::Steady(steady) = &self.time { steady.clone() } else { Steady::default() };
        case.time = Temporal::Steady(Steady { orders: ORDERS, ..steady });
        case.motion = Some(Motion { particles, law: self.motion.clone().map_or_else(Default::default, |m| m.law) });
        case.output.report = false;
        case
    }

    /// About the period of a free motion of structures that a march is to find.
    pub fn swing(&self) -> Option<Time> {
        match &self.time {
            Temporal::Dual(dual) => dual.swing,
            _ => None,
        }
    }
}
