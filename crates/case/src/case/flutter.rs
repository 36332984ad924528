//! Flutter analysis, as data: Mach numbers, matching, accuracy and options.
pub(super) mod check;
mod limit_cycles;

use super::Case;
use super::kinds::{PART, POSITIVE};
use super::quantity::{Time, Velocity};
use super::schema::{Absent, Kind, List, Range, defaulted, keys, optional, words};
use super::time::Temporal;

pub(super) use limit_cycles::LIMIT_CYCLES;
pub use limit_cycles::{GasResponse, LimitCycles};

keys! {
    /// The table `[flutter]`: settings of the flutter analysis.
    pub struct Flutter, FLUTTER {
        /// Mach numbers at which the boundary is sought.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        mach: Vec<f64> = optional(
            Kind::List(&List { item: POSITIVE, min: 1, max: 64, single: true }), "that of `[flow]`",
        ),
        /// Reduced frequencies k = ωb/U∞, b half of the reference chord, at which forces are computed first; zero is
        /// always among them. More are added near each crossing.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        reduced_frequencies: Vec<f64> = optional(
            Kind::List(&List { item: POSITIVE, min: 2, max: 64, single: false }), "0.02, 0.08, 0.2 and 0.5",
        ),
        /// What is varied at a Mach number until a motion neither grows nor decays.
        matching as "match": Matching = defaulted(Kind::Words(MATCHING), Absent::Word("none")),
        /// Greatest speed that is looked at, over that of the structure (`reduced_speed`, `speed_index`, or the free
        /// stream); with `match = "density"` greatest density over that of the case. Altitudes are looked at from 5 km
        /// below the sea.
        most: f64 = defaulted(Kind::Number(Range { min: 0.0, max: 1000.0, closed: false }), Absent::Number(4.0)),
        /// Part by which a speed may change when a frequency is left out.
        accuracy: f64 = defaulted(PART, Absent::Number(0.005)),
        /// Greatest number of frequencies at a Mach number.
        frequencies: u32 = defaulted(Kind::Integer(3, 64), Absent::Integer(12)),
        /// Forces are those about the static equilibrium of structure and gas at the first crossing, which is sought
        /// with it; else about the bodies as drawn.
        trim: bool = defaulted(Kind::Flag, Absent::Flag(false)),
        /// Write the structure in the stream as a linear system of first order as well, at the first crossing of each
        /// Mach number.
        state_space: bool = defaulted(Kind::Flag, Absent::Flag(false)),
        /// In small motions the limiter, and where it takes shocks to be, stay what they are in the steady flow. Else
        /// forces are those that the equations of a march have in a motion that is small enough.
        frozen_limiter: bool = defaulted(Kind::Flag, Absent::Flag(false)),
        /// Tell the error that the spacing leaves in each speed, from a cloud with twice of it, and with 3/2 of it
        /// where there are shocks, and where it decides whether motions grow.
        cloud_error: bool = defaulted(Kind::Flag, Absent::Flag(true)),
        /// Design speed V_D, an equivalent airspeed (EAS): margins are told against it, and whether 1.15 V_D are free
        /// of flutter and divergence.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        design_speed: Option<Velocity> = optional(Kind::Quantity(Velocity::DIMENSION, Range::POSITIVE), "no margins"),
    }
}

words! {
    /// Quantity of the stream that is varied at constant Mach number (matching).
    pub enum Matching, MATCHING = None {
        /// the speed, and the sound speed with it, at the density of the case
        None = "none",
        /// the density, at the sound speed of the case: a wind tunnel
        Density = "density",
        /// the altitude in the standard atmosphere of 1976: speed, density and Mach number belong together
        Altitude = "altitude",
    }
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
