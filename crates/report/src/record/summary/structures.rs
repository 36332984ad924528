//! Bodies that move with the gas.
use serde::{Deserialize, Serialize};

use crate::observe::structure::StructureSummary;
use crate::observe::swing::Swing;

/// What became of bodies that move with the gas.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Structures {
    /// What became of bodies on springs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub structure: Vec<StructureSummary>,
    /// The last period of every coordinate of the structures, where the march was to find it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub swings: Vec<Option<Swing>>,
    /// What became of bodies made of particles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid: Option<SolidEnd>,
}

/// Motion and stress of the bodies made of particles in a gas, in the units of the case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidEnd {
    /// Displacements of the probes; without any the mean ones of the bodies.
    pub probes: Vec<ProbeEnd>,
    /// Greatest von Mises stress at the end.
    pub stress: f64,
    /// Place of the particle that has it, before it was moved.
    pub stress_at: Vec<f64>,
}

/// Displacement of a probe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbeEnd {
    /// Name of the probe, or of the body whose mean displacement it is.
    pub name: String,
    /// Displacement at the end.
    pub displacement: Vec<f64>,
    /// Greatest distance from where it was at rest in all of the run.
    pub farthest: f64,
}
