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
        Self { chord: axes.chord, area, body, moment_point: axes.moment_point[..D].to_vec() }
    }

    /// The same in words.
    pub fn told(&self) -> String {
        let area = self.area.map_or_else(String::new, |area| format!(", area {}", short(area)));
        let of = self.body.as_ref().map_or_else(String::new, |body| format!(", planform of `{body}`"));
        format!("chord {}{area}, moments about {}{of}", short(self.chord), list(&self.moment_point))
    }
}

/// Numbers in brackets.
pub fn list(numbers: &[f64]) -> String {
    format!("({})", numbers.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", "))
}
