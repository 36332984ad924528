//! Result of a verification claim: computed by `verify`, shown by `report`.
use serde::Serialize;

/// An evaluated claim: one row of the verification table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimRow {
    /// Name of the case folder.
    pub case: String,
    /// Name of the metric with its label and, in brackets, the number of runs.
    pub metric: String,
    /// Name of the metric alone.
    pub name: &'static str,
    /// Label that distinguishes two claims of the same metric.
    pub label: Option<String>,
    /// Kind of the comparison: `relative`, `absolute`, `range`, `at_most` or `at_least`.
    pub kind: &'static str,
    /// Measured value.
    pub value: f64,
    /// Reference value: the centre of a range, or the bound of a one-sided claim.
    pub reference: f64,
    /// Difference of value and reference, divided by |reference| for relative claims.
    pub error: f64,
    /// Greatest permitted |error|: half the width of a range; zero for one-sided claims.
    pub tolerance: f64,
    /// Number of runs over which the value is averaged.
    pub runs: usize,
    /// Twice the standard error of this mean; zero for one run.
    pub scatter: f64,
    /// True when the claim is fulfilled.
    pub pass: bool,
    /// Source of the reference value.
    pub source: String,
}
