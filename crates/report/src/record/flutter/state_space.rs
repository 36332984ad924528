//! The structure in the stream as a linear system of first order.
use serde::{Deserialize, Serialize};

/// A system at one speed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StateSpaceAt {
    /// Signs and units.
    pub conventions: String,
    /// Speed over that of the case.
    pub speed_ratio: f64,
    /// Speed in the units of the case.
    pub speed: f64,
    /// Density in the units of the case.
    pub density: f64,
    /// Worst misfit of the forces, over the largest modulus of an entry.
    pub misfit: f64,
    /// Names of the states.
    pub states: Vec<String>,
    /// Names of the forces.
    pub inputs: Vec<String>,
    /// Names of what is seen.
    pub outputs: Vec<String>,
    /// A, B, C and D, row by row.
    pub a: Vec<Vec<f64>>,
    /// B.
    pub b: Vec<Vec<f64>>,
    /// C.
    pub c: Vec<Vec<f64>>,
    /// D.
    pub d: Vec<Vec<f64>>,
    /// What it is made from, for other speeds.
    pub parts: serde_json::Value,
}
