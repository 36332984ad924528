//! How loads converge as clouds become finer.
use serde::{Deserialize, Serialize};

use crate::observe::convergence::Convergence;
use crate::observe::loads::Coefficients;

/// Loads on a family of clouds.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GridConvergence {
    /// Half widths of the error bars of the loads, where they were found on a family of clouds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loads_error: Option<Coefficients>,
    /// That family, and how the loads converge on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid_convergence: Option<Convergence>,
    /// True where the gas is faster than sound somewhere at the end; not written.
    #[serde(skip)]
    pub supersonic: bool,
}
