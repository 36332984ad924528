//! Matrices of generalised forces: `gaf.json`, written and read by the same types, and `gaf.csv`.
use std::path::Path;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::observe::columns::{Scale, describe_tables};
use crate::observe::table::{Entry, FileError, write_csv, write_json};

/// Names of the files.
pub const TABLE: &str = "gaf.csv";
const FILE: &str = "gaf.json";

/// Signs and units of generalised forces.
pub const CONVENTION: &str = "f(t) = Re f exp(+i omega t); Cl = lift/(q c), up positive; Cm = moment/(q c^2) about the pivot, nose up \
                          positive; columns per plunge over the length L (up positive), per radian of pitch (nose up positive), \
                          per unit of the coordinate of a flexible mode; Q_ij = work of the gas per unit of coordinate i, due to \
                          coordinate j, over q S c (2-D: S = c), with the coordinates of the columns: the row of pitch is Cm, that \
                          of plunge the upward force over q S times L/c; k = omega L/U with L as given; phase positive when the \
                          load leads the motion; errors are radii of circles in the complex plane for the spacing of the cloud";

/// One column of the matrix at one frequency.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Column {
    /// Reduced frequency.
    pub k: f64,
    /// Mode that moves.
    pub mode: String,
    /// Lift over motion: real and imaginary part.
    pub cl: [f64; 2],
    /// Moment over motion.
    pub cm: [f64; 2],
    /// Generalised force on every mode over motion, see [`GeneralisedForce`](super::summary::GeneralisedForce).
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// That of lift over motion.
    pub cl_error: f64,
    /// That of moment over motion.
    pub cm_error: f64,
    /// Those of the generalised forces over motion.
    pub q_error: Vec<f64>,
}

/// How a linear system was solved.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
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
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
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

/// `gaf.json`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GafFile {
    /// Signs and units.
    #[serde(default)]
    pub convention: String,
    /// Mach number.
    pub mach: f64,
    /// Angle of attack.
    pub alpha_deg: f64,
    /// Reference chord.
    pub chord: f64,
    /// Reference area.
    pub area: f64,
    /// Length of the reduced frequencies.
    pub reduced_length: f64,
    /// Point about which the body pitches.
    pub pivot: Option<Vec<f64>>,
    /// Names of the rows of coefficients.
    #[serde(default)]
    pub rows: Vec<String>,
    /// Names of the modes, in the order of rows and columns.
    pub modes: Vec<String>,
    /// A matrix at each reduced frequency, in the order of the case.
    pub matrices: Vec<SquareMatrix>,
    /// Columns, frequency by frequency.
    #[serde(default)]
    pub columns: Vec<Column>,
}

/// Forces at one reduced frequency, real and imaginary parts.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SquareMatrix {
    /// Reduced frequency.
    pub k: f64,
    /// Lift over each motion.
    #[serde(default)]
    pub cl: Vec<[f64; 2]>,
    /// Moment over each motion.
    #[serde(default)]
    pub cm: Vec<[f64; 2]>,
    /// `q[i][j]` is the force on mode i that mode j makes.
    pub q: Vec<Vec<[f64; 2]>>,
}

impl Column {
    /// A row of the table.
    fn row(&self, bounded: bool) -> Vec<Entry> {
        let mut row = vec![Entry::from(self.k), Entry::from(self.mode.as_str())];
        for [re, im] in [self.cl, self.cm] {
            let value = Complex64::new(re, im);
            row.extend([re, im, value.norm(), value.arg().to_degrees()].map(Entry::from));
        }
        row.extend(self.q.iter().flatten().map(|v| Entry::from(*v)));
        row.extend(self.nonlinearity.map(Entry::from));
        row.extend(self.solved.iter().flat_map(|s| [Entry::from(s.iterations as f64), Entry::from(s.left)]));
        if bounded {
            row.extend(self.bars().into_iter().map(Entry::from));
        }
        row
    }

    /// Error bars of lift, moment and generalised forces; not a number where they are not known.
    fn bars(&self) -> Vec<f64> {
        match &self.errors {
            Some(e) => [e.cl_error, e.cm_error].into_iter().chain(e.q_error.iter().copied()).collect(),
            None => vec![f64::NAN; 2 + self.q.len()],
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

    /// What `gaf.json` holds of the matrices at these reduced frequencies.
    fn file(&self, frequencies: &[f64]) -> GafFile {
        let c = &self.conditions;
        GafFile {
            convention: CONVENTION.to_owned(),
            mach: c.mach,
            alpha_deg: c.alpha_deg,
            chord: c.chord,
            area: c.area,
            reduced_length: c.reduced_length,
            pivot: c.pivot.clone(),
            rows: ["cl", "cm"].map(str::to_owned).to_vec(),
            modes: self.modes.clone(),
            matrices: frequencies.iter().map(|k| self.square(*k)).collect(),
            columns: self.columns.clone(),
        }
    }

    fn square(&self, k: f64) -> SquareMatrix {
        let columns: Vec<&Column> = self.columns.iter().filter(|c| c.k == k).collect();
        let row = |i: usize| columns.iter().map(|c| c.q[i]).collect();
        SquareMatrix {
            k,
            cl: columns.iter().map(|c| c.cl).collect(),
            cm: columns.iter().map(|c| c.cm).collect(),
            q: (0..self.modes.len()).map(row).collect(),
        }
    }

    /// Writes `gaf.csv`, a row for each column of the matrices, and `gaf.json` into the folder `out`.
    pub fn write(&self, frequencies: &[f64], scale: Scale, out: &Path) -> Result<(), FileError> {
        let bounded = self.columns.iter().any(|c| c.errors.is_some());
        let names = self.names(bounded);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        write_csv(&out.join(TABLE), &names, self.columns.iter().map(|c| c.row(bounded)))?;
        describe_tables(out, scale, &[])?;
        write_json(&out.join(FILE), &self.file(frequencies))
    }

    /// Columns of the table; with those of error bars where it is `bounded`.
    fn names(&self, bounded: bool) -> Vec<String> {
        let parts = |load: &str| ["re", "im", "abs", "phase_deg"].map(|part| format!("{load}_{part}"));
        let mut names: Vec<String> = ["k".into(), "mode".into()].into();
        names.extend(["cl", "cm"].iter().flat_map(|load| parts(load)));
        names.extend(self.modes.iter().flat_map(|m| [format!("q_{m}_re"), format!("q_{m}_im")]));
        let linear = self.columns.iter().any(|c| c.solved.is_some());
        let last: &[&str] = if linear { &["iterations", "left"] } else { &["nonlinearity"] };
        names.extend(last.iter().map(|name| (*name).to_owned()));
        if bounded {
            names.extend(["cl_error".to_owned(), "cm_error".to_owned()]);
            names.extend(self.modes.iter().map(|m| format!("q_{m}_error")));
        }
        names
    }
}
