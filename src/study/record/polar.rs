//! The points of a polar: what is known of each.
use serde::{Deserialize, Serialize};

use crate::record::summary::PolarPoint;

/// What a run knows of its polar so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct PolarRecord {
    /// Points that are over.
    pub(crate) points: Vec<PolarPoint>,
    /// The present point starts from rest: there is no other, or from its neighbour it did not go.
    pub(crate) from_rest: bool,
    /// Iterations and processor seconds of the run when the present point began.
    began: (u64, f64),
}

impl PolarRecord {
    /// A point begins.
    pub(crate) fn begin(&mut self, iteration: u64, cpu_seconds: f64, from_rest: bool) {
        (self.began, self.from_rest) = ((iteration, cpu_seconds), from_rest);
    }

    /// Iterations and processor seconds of the present point.
    pub(crate) fn spent(&self, iteration: u64, cpu_seconds: f64) -> (u64, f64) {
        (iteration - self.began.0, cpu_seconds - self.began.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::loads::Coefficients;

    #[test]
    fn a_point_is_told_without_zeros_that_have_a_sign() {
        let case =
            crate::case::read("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n", "t").unwrap();
        let loads = Coefficients { cl: -1e-9, cd: 0.02, cm: -0.3 };
        let point = PolarPoint { alpha_deg: -0.0, loads: Some(loads), converged: true, ..PolarPoint::of(&case.flow) };
        assert_eq!(point.told(), "M 0.5, alpha 0 deg: CL 0.00000, CD 0.02000, CM -0.30000");
    }
}
