//! Limit cycles: of which coordinate, how large, with what accuracy, as data.
use super::super::kinds::{PART, POSITIVE, SIZE};
use super::super::quantity::{Angle, Length};
use super::super::schema::{Absent, Kind, List, Range, defaulted, keys, optional, words};

const TURN: Kind = Kind::Quantity(Angle::DIMENSION, Range::POSITIVE);

keys! {
    /// The table `[lco]`.
    pub struct LimitCycles, LIMIT_CYCLES {
        /// Mach number.
        mach: Option<f64> = optional(POSITIVE, "that of `[flow]`"),
        /// Coordinate whose amplitude is given: the first harmonic of it.
        coordinate: Option<String> = optional(Kind::Text, "`pitch`, else the first one"),
        /// Least and greatest amplitude of a coordinate that is an angle, `["0.25 deg", "4 deg"]`.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        amplitude: Vec<Angle> = optional(
            Kind::List(&List { item: TURN, min: 2, max: 2, single: false }), "`displacement` must be given",
        ),
        /// Least and greatest amplitude of a coordinate that is a length, or of a mode, of which one is what its file
        /// has.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        displacement: Vec<Length> = optional(
            Kind::List(&List { item: SIZE, min: 2, max: 2, single: false }), "`amplitude` must be given",
        ),
        /// Number of amplitudes.
        points: u32 = defaulted(Kind::Integer(2, 200), Absent::Integer(6)),
        /// Greatest number of harmonics; as many are taken as `accuracy` asks for.
        harmonics: u32 = defaulted(Kind::Integer(1, 15), Absent::Integer(5)),
        /// Part by which two more harmonics may change a speed.
        accuracy: f64 = defaulted(PART, Absent::Number(0.005)),
        /// What the gas does in motions that are not small.
        gas: GasResponse = defaulted(Kind::Words(GAS), Absent::Word("nonlinear")),
        /// March in time from the largest stable motion that was found, until its amplitude settles, and tell by how
        /// much it differs.
        march: bool = defaulted(Kind::Flag, Absent::Flag(false)),
    }
}

words! {
    /// How the gas answers to a motion.
    pub enum GasResponse, GAS {
        /// what it does: harmonic balance at each amplitude, some of them a point
        Nonlinear = "nonlinear",
        /// what it does in small motions: springs alone limit the motion
        Linear = "linear",
    }
}

impl LimitCycles {
    /// All amplitudes, rising, in base units.
    pub fn amplitudes(&self) -> Vec<f64> {
        let angles = self.amplitude.iter().map(|a| a.0);
        let ends: Vec<f64> = angles.chain(self.displacement.iter().map(|l| l.0)).collect();
        let [first, .., last] = ends[..] else { return ends };
        let n = self.points.max(2);
        (0..n).map(|k| first + (last - first) * f64::from(k) / f64::from(n - 1)).collect()
    }
}
