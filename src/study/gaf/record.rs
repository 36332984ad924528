//! Matrices of generalised forces as data.
use serde::Serialize;

use crate::case::Gaf;
use crate::problem::{Problem, reference};

/// Signs and units of generalised forces.
pub const CONVENTION: &str = "f(t) = Re f exp(+i omega t); Cl = lift/(q c), up positive; Cm = moment/(q c^2) about the pivot, nose up \
                          positive; columns per plunge over the length L (up positive), per radian of pitch (nose up positive), \
                          per unit of the coordinate of a flexible mode; Q_ij = work of the gas per unit of coordinate i, due to \
                          coordinate j, over q S c (2-D: S = c), with the coordinates of the columns: the row of pitch is Cm, that \
                          of plunge the upward force over q S times L/c; k = omega L/U with L as given; phase positive when the \
                          load leads the motion; errors are radii of circles in the complex plane for the spacing of the cloud";

/// One column of the matrix at one frequency.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Column {
    /// Reduced frequency.
    pub k: f64,
    /// Mode that moves.
    pub mode: String,
    /// Lift over motion: real and imaginary part.
    pub cl: [f64; 2],
    /// Moment over motion.
    pub cm: [f64; 2],
    /// Generalised force on every mode over motion, see [`GeneralisedForce`](super::super::GeneralisedForce).
    pub q: Vec<[f64; 2]>,
    /// Greatest change of lift, moment or generalised force, over the largest of them, when the amplitude is halved; absent where
    /// motion is infinitely small.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nonlinearity: Option<f64>,
    /// How far the entries are known on this cloud; absent where no coarser one was asked, or had an answer.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub errors: Option<Errors>,
    /// How the linear system was solved; absent for a harmonic balance.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub solved: Option<Solved>,
    /// Processor seconds; of a linear system without those of the steady flow, which all columns share.
    pub cpu_seconds: f64,
    /// True when the equations were solved: both harmonic balances, or the linear system and the steady flow.
    pub converged: bool,
}

/// Error bars of the entries of a column for the spacing of the cloud: radii of circles in the complex plane about each entry, in its
/// units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// That of lift over motion.
    pub cl_error: f64,
    /// That of moment over motion.
    pub cm_error: f64,
    /// Those of the generalised forces over motion.
    pub q_error: Vec<f64>,
}

/// How a linear system was solved.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Solved {
    /// Linear iterations.
    pub iterations: usize,
    /// Residual over right-hand side.
    pub left: f64,
}

/// Matrices of all frequencies.
#[derive(Clone, Debug)]
pub struct Matrices {
    /// Names of the modes, in the order of rows and columns.
    pub modes: Vec<String>,
    /// Columns, frequency by frequency in the order of the case.
    pub columns: Vec<Column>,
    /// Change above which a column is told to be nonlinear.
    pub linearity: f64,
    /// Where forces hold.
    pub conditions: Conditions,
}

/// The flow and the lengths that forces hold for.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Conditions {
    /// Mach number.
    pub mach: f64,
    /// Angle of attack.
    pub alpha_deg: f64,
    /// Speed U of the stream, in the units of the case.
    pub speed: f64,
    /// Its dynamic pressure q, in the units of the case.
    pub dynamic_pressure: f64,
    /// Reference chord c and area S (2-D: c).
    pub chord: f64,
    /// S.
    pub area: f64,
    /// Length L of the reduced frequencies.
    pub reduced_length: f64,
    /// Point about which the body pitches.
    pub pivot: Option<Vec<f64>>,
}

impl Column {
    /// Error bars of lift, moment and generalised forces; not a number where they are not known.
    pub(crate) fn bars(&self) -> Vec<f64> {
        match &self.errors {
            Some(e) => [e.cl_error, e.cm_error].into_iter().chain(e.q_error.iter().copied()).collect(),
            None => vec![f64::NAN; 2 + self.q.len()],
        }
    }
}

impl Conditions {
    pub(super) fn of(problem: &Problem, plan: &Gaf) -> Self {
        let case = problem.given();
        let (chord, area) = match problem {
            Problem::Plane(problem) => {
                let chord = problem.surface().map_or(1.0, |s| reference::chord(case, Some(s)));
                (chord, chord)
            }
            Problem::Space(problem) => {
                let seen = problem.surface().map(|s| reference::planform(case, s));
                seen.map_or((1.0, 1.0), |seen| (seen.chord, seen.area))
            }
        };
        let stream = problem.reference();
        Self {
            mach: stream.mach,
            speed: stream.speed,
            dynamic_pressure: stream.dynamic_pressure(),
            alpha_deg: case.flow.alpha.0.to_degrees(),
            chord,
            area,
            reduced_length: plan.reduced_length.map_or(0.5 * chord, |l| l.0),
            pivot: plan.pivot.as_ref().map(|p| p.iter().map(|x| x.0).collect()),
        }
    }
}

impl Matrices {
    /// Reduced frequencies, in the order of the columns.
    pub fn reduced_frequencies(&self) -> Vec<f64> {
        self.columns.chunks(self.modes.len().max(1)).map(|all| all[0].k).collect()
    }

    /// The same in cycles per unit of time of the case: k U/(2π L).
    pub fn frequencies(&self) -> Vec<f64> {
        let c = &self.conditions;
        let scale = c.speed / (std::f64::consts::TAU * c.reduced_length);
        self.reduced_frequencies().into_iter().map(|k| k * scale).collect()
    }
}
