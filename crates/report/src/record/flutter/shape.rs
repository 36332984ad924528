//! Coordinates of a structure, and how much each takes part in a motion.
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Part of a chord by which pivots may differ.
const SAME: f64 = 1e-6;

/// The part of a coordinate in a motion e^{iωt}.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Share {
    /// Its name.
    pub coordinate: String,
    /// Amplitude over the largest: of angles in radians, of displacements of rigid bodies in b, of modes in what their files have.
    pub amplitude: f64,
    /// Phase in degrees by which it is ahead of the largest, from −180 to 180.
    pub phase_deg: f64,
}

/// A natural mode in still air.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct NaturalMode {
    /// Its number, from 1.
    pub mode: usize,
    /// Cycles per unit of time of the case.
    pub frequency: f64,
    /// Its shape.
    pub shape: Vec<Share>,
}

impl Share {
    /// The amplitude that it stands for, as a complex number.
    pub fn phasor(&self) -> Complex64 {
        Complex64::from_polar(self.amplitude, self.phase_deg.to_radians())
    }
}

/// What a coordinate moves, beside its name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// Point about which a rigid body turns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pivot: Option<Vec<f64>>,
    /// Checksum of the shape of a mode, or of its file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<String>,
}

impl Mark {
    /// True where both are known and differ.
    pub fn contradicts(&self, other: &Self, chord: f64) -> bool {
        let apart = |a: &Vec<f64>, b: &Vec<f64>| a.iter().zip(b).any(|(a, b)| (a - b).abs() > SAME * chord);
        let pivots = self.pivot.as_ref().zip(other.pivot.as_ref()).is_some_and(|(a, b)| apart(a, b));
        pivots || self.shape.as_ref().zip(other.shape.as_ref()).is_some_and(|(a, b)| a != b)
    }
}
