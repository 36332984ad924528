//! What became of a claim: `verify` finds it, `report` shows it.
use serde::Serialize;

/// A judged claim: one row of the verification table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimRow {
    /// Name of the case folder.
    pub case: String,
    /// Metric, with its label and the number of runs in brackets.
    pub metric: String,
    /// Metric alone.
    pub name: &'static str,
    /// Words that tell apart two claims of the same metric.
    pub label: Option<String>,
    /// How value and reference are compared: `relative`, `absolute`, `range`, `at_most` or `at_least`.
    pub kind: &'static str,
    /// Measured value.
    pub value: f64,
    /// Reference: the middle of a range, the bound of one-sided claims.
    pub reference: f64,
    /// Value less reference, divided by |reference| for relative claims.
    pub error: f64,
    /// Greatest |error| that passes; half the width of a range, zero for one-sided claims.
    pub tolerance: f64,
    /// Number of runs that the value is the mean of.
    pub runs: usize,
    /// Twice the standard error of that mean; zero of one run.
    pub scatter: f64,
    /// The claim holds.
    pub pass: bool,
    /// Where the reference comes from.
    pub source: String,
}
