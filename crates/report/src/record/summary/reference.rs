//! Reference values of loads.
use serde::{Deserialize, Serialize};

use crate::case::Case;
use crate::math::digits::short;
use crate::observe::loads::LoadAxes;

/// What loads are divided by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceValues {
    /// Chord.
    pub chord: f64,
    /// Area; absent in the plane, where it is chord times 1.
    pub area: Option<f64>,
    /// Body whose planform gives what the case does not give; absent where all do.
    pub body: Option<String>,
    /// Point of the moment, of two or three coordinates.
    pub moment_point: Vec<f64>,
}

impl ReferenceValues {
    /// Those of loads in these axes.
    pub fn of<const D: usize>(case: &Case, axes: &LoadAxes) -> Self {
        // the scale of forces in the units of the solver, whose speed of the stream is the Mach number
        let area = (D == 3).then(|| axes.force_scale / (0.5 * case.flow.reference().mach.powi(2)));
        let body = case.reference.body.clone();
        let moment_point = axes.moment_point[..D].iter().map(|x| without_round_off(*x, axes.chord)).collect();
        Self { chord: axes.chord, area, body, moment_point }
    }

    /// The same in words.
    pub fn told(&self) -> String {
        let area = self.area.map_or_else(String::new, |area| format!(", area {}", short(area)));
        let of = self.body.as_ref().map_or_else(String::new, |body| format!(", planform of `{body}`"));
        format!("chord {}{area}, moments about {}{of}", short(self.chord), list(&self.moment_point))
    }
}

/// A coordinate, or zero where it is the round-off of coordinates of the size of `length`.
fn without_round_off(x: f64, length: f64) -> f64 {
    /// Greatest round-off of a point that moved with a body and came back.
    const ROUND_OFF: f64 = 1e-12;
    if x.abs() <= ROUND_OFF * length { 0.0 } else { x }
}

/// Numbers in brackets.
pub fn list(numbers: &[f64]) -> String {
    format!("({})", numbers.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_that_moved_and_came_back_has_no_round_off() {
        let point = [0.25, -6.41e-19, -3.7e-17, 1e-9].map(|x| without_round_off(x, 1.0));
        assert_eq!(list(&point), "(0.25, 0, 0, 1e-9)");
    }
}
