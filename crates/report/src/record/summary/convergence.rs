//! How far a flow came.
use serde::{Deserialize, Serialize};

use crate::observe::loads::Coefficients;

/// How far a flow came: iterations, residual, conservation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Progress {
    /// Particles, images left out.
    pub particles: usize,
    /// Iterations over all stages.
    pub iterations: u64,
    /// Orders of magnitude that the residual of the last stage fell; null of a march, each of whose steps has its own, and where the
    /// start was a steady flow already.
    pub residual_drop: Option<f64>,
    /// True where the goal was reached: the residual fell as far as asked, or the loads of a march settled within `periodic_tolerance`.
    /// False too where a march did not come to its end; null where it did and was asked for nothing else.
    pub converged: Option<bool>,
    /// Physical time at the end of a march, in the units of the case.
    pub time: f64,
    /// Linear iterations of the last stage.
    pub linear_iterations: u32,
    /// Steps in time whose inner iterations did not reach their goal.
    pub unconverged_steps: u32,
    /// Times a step in time was halved because its equations could not be solved.
    pub halved_steps: u32,
    /// Conservation; null for a harmonic balance, which does not go from one time to another.
    pub ledger: Option<Ledger>,
    /// What re-clouding did, where particles travel with the fluid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub re_clouding: Option<Reclouding>,
    /// Change of the loads in the last cycle of adaptation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adapt_change: Option<Coefficients>,
    /// Volume-weighted root mean square error of density, where the case has an exact solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_l2_density: Option<f64>,
    /// What makes these results doubtful.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// How often the cloud of travelling particles was built anew, and what that did.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Reclouding {
    /// Times the cloud was built anew; the last one is for the files.
    pub renewals: u32,
    /// Particles inserted into holes and at sides where the gas enters.
    pub inserted: u64,
    /// Particles removed where they were too near to others, to a wall or to a side.
    pub removed: u64,
    /// Greatest number of rows that fell back to first order.
    pub first_order: u32,
    /// What replacing particles added to the totals, over those at the start; momentum over the mass.
    pub transfer: Ledger,
}

/// What was lost, relative. Marching: change of the totals, what crossed open sides not counted as lost. Steady: net flux
/// through a zone around the bodies over the flux that enters it.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Ledger {
    /// Mass.
    pub mass: f64,
    /// Momentum: difference of the two load evaluations, in coefficients.
    pub momentum: f64,
    /// Energy.
    pub energy: f64,
}
