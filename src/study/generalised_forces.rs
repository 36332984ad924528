//! Generalised forces of the gas on the coordinates of structures in small motions about a steady flow, and flutter with these.
use num_complex::Complex64;

use super::steady::SteadyFlow;
use super::studies::in_order;
use crate::math::rational::Rational;
use crate::problem::RunError;
use crate::structure::Matrices;
use crate::structure::flutter::{Crossing, Flutter};

/// Misfit of rational functions to the forces.
const MISFIT: f64 = 1e-7;

/// Forces per coordinate q = q̂ e^{iωt}, in units of the solver: density and sound speed of the stream are 1, and so is the unit of length of
/// the geometry.
#[derive(Clone, Debug)]
pub struct GeneralisedForces {
    /// Names of the coordinates.
    pub coordinates: Vec<String>,
    /// Reduced frequencies ωc/2V, rising.
    pub reduced_frequencies: Vec<f64>,
    /// A matrix at each of them, rows one after another: entry i, j is the force on coordinate i per unit of coordinate j.
    pub matrices: Vec<Vec<Complex64>>,
    /// Mass, damping and stiffness of the structures of the problem about the steady flow.
    pub structure: Matrices,
    /// Greatest residual that the linear systems were left with, over their right-hand sides.
    pub residual: f64,
    /// Speed of the stream over half the chord: angular over reduced frequency.
    rate: f64,
}

/// Forces about `flow` at these reduced frequencies ωc/2V. Those at 0 are what divergence and a good fit need.
pub fn forces(flow: &SteadyFlow<'_>, reduced_frequencies: &[f64]) -> Result<GeneralisedForces, RunError> {
    let mut source = flow.source()?;
    let coordinates = source.names();
    super::refuse(
        coordinates.is_empty(),
        "generalised forces without a `[structure]`",
        "add one: forces are those on its coordinates",
    )?;
    let rate = 2.0 * flow.summary().conditions.mach / flow.summary().conditions.chord;
    let (mut all, mut residual) = (Vec::new(), 0.0_f64);
    for k in in_order(reduced_frequencies) {
        let found = source.forces_unless(rate * k, &|| false).ok_or(RunError::NoStage)?;
        residual = found.ended.iter().map(|e| e.left).fold(residual, f64::max);
        all.push((k, found.generalised));
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (reduced_frequencies, matrices) = all.into_iter().unzip();
    Ok(GeneralisedForces { coordinates, reduced_frequencies, matrices, structure: source.matrices(), residual, rate })
}

impl GeneralisedForces {
    /// Speeds up to `most` times that of the stream at which motions of a structure with these matrices neither grow nor decay, at the density and the Mach
    /// number of the stream; empty where too few frequencies are known.
    pub fn crossings(&self, structure: &Matrices, most: f64) -> Vec<Crossing> {
        let omegas = self.reduced_frequencies.iter().map(|k| k * self.rate);
        let samples: Vec<(f64, Vec<Complex64>)> = omegas.zip(self.matrices.iter().cloned()).collect();
        let Some(fit) = Rational::of(&samples, MISFIT) else { return Vec::new() };
        let forces = |kappa: f64| fit.at(Complex64::new(0.0, kappa));
        let flutter = Flutter::new(structure, &forces);
        flutter.crossings(&flutter.branches(most), most)
    }

    /// Reduced frequency of a crossing.
    pub fn reduced_frequency(&self, crossing: &Crossing) -> f64 {
        crossing.kappa / self.rate
    }
}
