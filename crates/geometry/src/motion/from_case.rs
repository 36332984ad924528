//! Motions from the tables of a case and the files that they name.
//!
//! Motions are in the time of the solver, tables in that of the case. The conversion happens only here.
use std::sync::Arc;

use super::mode_points::{self, Flaw};
use super::samples::Samples;
use super::{BodyMotion, ModeShape, Motions, Spline, TimeFunction};
use crate::case::formula::{Formula, FormulaError};
use crate::case::{
    BodyMotionSpec, Case, CaseErrors, MotionFormula, MotionTable, OwnFrequency, Temporal, Units, read_mode,
};
use crate::math::Vector;

/// A function that reads the text of a file that a case names.
pub type ReadFile<'a> = &'a dyn Fn(&str) -> std::io::Result<String>;

/// Reason why a motion cannot be constructed.
#[derive(Debug, thiserror::Error)]
pub enum MotionError {
    /// The file of a motion table cannot be read.
    #[error("cannot read the motion table `{file}`: {source}")]
    File {
        /// Name of the file.
        file: String,
        /// Cause.
        source: std::io::Error,
    },
    /// The file does not contain a valid motion table.
    #[error(
        "motion table `{file}`: {problem}\nhint: give columns `time` and any of `x`, `y`, `z`, `angle_deg`, `angle_rad`"
    )]
    Table {
        /// Name of the file.
        file: String,
        /// Description of the problem.
        problem: String,
    },
    /// The file of a mode shape cannot be read.
    #[error("cannot read the mode `{file}`: {source}\nhint: paths are relative to the case file")]
    ModeFile {
        /// Name of the file.
        file: String,
        /// Cause.
        source: std::io::Error,
    },
    /// The file does not contain a valid mode shape.
    #[error("{0}")]
    Mode(Box<CaseErrors>),
    /// The points of a mode do not determine a shape.
    #[error(
        "mode `{file}`: its points lie too near to one another, or on both sides of a plate that is thin against its extent\n\
         hint: keep the points of one side, and no two within a millionth of the extent"
    )]
    Crowded {
        /// Name of the file.
        file: String,
    },
    /// Two nearly coincident points of a mode have different displacements.
    #[error(
        "mode `{file}`, line {second}: the point is {distance:.1e} away from that of line {first}, but its displacement differs by \
         {difference:.2e}, where the greatest of all is {greatest:.2e}\n\
         hint: remove one of the two rows: the shape between points is smooth"
    )]
    Jump {
        /// Name of the file.
        file: String,
        /// Line of the first point.
        first: usize,
        /// Line of the second point.
        second: usize,
        /// Distance between the points.
        distance: f64,
        /// Difference of their displacements.
        difference: f64,
        /// Greatest displacement of all points.
        greatest: f64,
    },
    /// A formula is invalid.
    #[error("formula `{text}`: {source}")]
    Formula {
        /// Text of the formula.
        text: String,
        /// Cause.
        source: FormulaError,
    },
    /// The position at the start is not finite.
    #[error(
        "the motion of {body} is not finite at t = 0\nhint: look for divisions by zero, `ln` and `sqrt` in its formulas"
    )]
    NotFinite {
        /// Name of the body.
        body: String,
    },
    /// A body rotates but has no pivot.
    #[error("the motion of {body} turns, but has no pivot\nhint: add `pivot` to its motion")]
    Pivot {
        /// Name of the body.
        body: String,
    },
}

impl<const D: usize> Motions<D> {
    /// The motions of `case`. `chord` is its reference chord; `read` reads the files that it names.
    pub fn of_case(case: &Case, chord: f64, read: ReadFile<'_>) -> Result<Self, MotionError> {
        let build = |motion: Option<&BodyMotionSpec>, whose: String| match motion {
            Some(motion) => Builder { case, chord, units: case.flow.units(), read, motion, whose: &whose }.law(),
            None => Ok(BodyMotion::fixed()),
        };
        let named = |i: usize| case.bodies[i].name.clone().unwrap_or_else(|| format!("body {}", i + 1));
        let bodies = (0..case.bodies.len())
            .map(|i| build(case.motion_of(i), format!("`{}`", named(i))))
            .collect::<Result<_, _>>()?;
        let general = build(case.motion.as_ref().map(|m| &m.law), "`[motion]`".to_owned())?;
        let flexible =
            case.gaf.iter().filter(|_| matches!(case.time, Temporal::Harmonics(_))).flat_map(|g| &g.flexible);
        let forces = flexible.map(|mode| mode_shape(&mode.file, read)).collect::<Result<_, _>>()?;
        Ok(Self { general, forces, ..Self::new(bodies) })
    }
}

/// One error for each motion table of `case` that cannot be used; `read` reads the files that the case names.
pub fn faulty_tables<const D: usize>(case: &Case, read: ReadFile<'_>) -> Vec<MotionError> {
    let own = case.bodies.iter().filter_map(|body| body.motion.as_ref());
    let all = own.chain(case.motion.as_ref().map(|motion| &motion.law));
    let fault = |motion: &BodyMotionSpec| {
        let builder = Builder { case, chord: 1.0, units: case.flow.units(), read, motion, whose: "" };
        builder.table::<D>(motion.table.as_ref()?, BodyMotion::fixed()).err()
    };
    all.filter_map(fault).collect()
}

/// Reads the shape of a mode from its file.
pub fn mode_shape<const D: usize>(file: &str, read: ReadFile<'_>) -> Result<ModeShape<D>, MotionError> {
    let text = read(file).map_err(|source| MotionError::ModeFile { file: file.to_owned(), source })?;
    let table = read_mode(&text, file, D).map_err(|e| MotionError::Mode(Box::new(e)))?;
    mode_points::shape(file, &table).map_err(|flaw| match flaw {
        Flaw::Crowded => MotionError::Crowded { file: file.to_owned() },
        Flaw::Jump { lines: [first, second], distance, difference, greatest } => {
            MotionError::Jump { file: file.to_owned(), first, second, distance, difference, greatest }
        }
    })
}

/// Data from which the motion of one body is constructed.
struct Builder<'a> {
    case: &'a Case,
    chord: f64,
    units: Units,
    read: ReadFile<'a>,
    motion: &'a BodyMotionSpec,
    whose: &'a str,
}

impl Builder<'_> {
    fn law<const D: usize>(&self) -> Result<BodyMotion<D>, MotionError> {
        let motion = self.motion;
        let pivot = motion.pivot.as_ref().map(|p| Vector::from_fn(|d| p[d].0));
        let axis = motion.axis.as_ref().map(|a| [a[0], a[1], a[2]]);
        let mut law = BodyMotion::about(pivot.unwrap_or(Vector::ZERO), axis);
        let frequency = self.case.angular_frequency(motion, self.chord).unwrap_or(0.0);
        let omega = self.units.solver_rate(frequency);
        let sine = |amplitude: f64, phase: f64, omega: f64| TimeFunction::Sine { amplitude, omega, phase };
        let own = |part: &OwnFrequency| {
            self.units.solver_rate(self.case.part_frequency(part, motion, self.chord).unwrap_or(0.0))
        };
        for pitch in &motion.pitch {
            law = law.with_angle(sine(pitch.amplitude.0, pitch.phase.0, own(&pitch.own)));
        }
        for plunge in &motion.plunge {
            let up = Vector::axis(D - 1);
            let direction = plunge.direction.as_ref().map_or(up, |v| Vector::from_fn(|d| v[d]).unit());
            let omega = own(&plunge.own);
            law = law.with_shift_along(&direction, |c| sine(plunge.amplitude.0 * c, plunge.phase.0, omega));
        }
        if let Some(rotation) = &motion.rotation {
            law = law.with_angle(TimeFunction::Steady(self.units.solver_rate(rotation.rate.0)));
        }
        if let Some(translation) = &motion.translation {
            let speed = |d: usize| self.units.solver_rate(translation.velocity[d].0);
            law = law.with_shift(std::array::from_fn(|d| TimeFunction::Steady(speed(d))));
        }
        if let Some(table) = &motion.table {
            law = self.table(table, law)?;
        }
        if let Some(formula) = &motion.formula {
            law = self.formulas(formula, frequency, law)?;
        }
        for mode in &motion.modes {
            let shape = mode_shape(&mode.file, self.read)?;
            law = law.with_mode(Arc::new(shape), sine(mode.amplitude, mode.phase.0, omega));
        }
        // only the file of a table can contain a rotation that the reader of the case has not seen
        if pivot.is_none() && law.turns() {
            return Err(MotionError::Pivot { body: self.whose.to_owned() });
        }
        if !law.is_finite(0.0) {
            return Err(MotionError::NotFinite { body: self.whose.to_owned() });
        }
        Ok(law)
    }

    /// Adds the splines of a motion table.
    fn table<const D: usize>(&self, table: &MotionTable, law: BodyMotion<D>) -> Result<BodyMotion<D>, MotionError> {
        let samples = match &table.file {
            None => Samples::of(table),
            Some(file) => {
                let text = (self.read)(file).map_err(|source| MotionError::File { file: file.clone(), source })?;
                let problem = |problem| MotionError::Table { file: file.clone(), problem };
                Samples::parse(&text, table.periodic, D).map_err(problem)?
            }
        };
        let time: Vec<f64> = samples.time.iter().map(|t| self.units.solver_time(*t)).collect();
        let spline = |values: &Vec<f64>| TimeFunction::Spline(Spline::new(&time, values, table.periodic));
        let law = match &samples.angle {
            Some(angle) => law.with_angle(spline(angle)),
            None => law,
        };
        if samples.shift.iter().all(Option::is_none) {
            return Ok(law);
        }
        Ok(law.with_shift(std::array::from_fn(|d| samples.shift[d].as_ref().map_or(TimeFunction::Steady(0.0), spline))))
    }

    /// Adds formulas of the time of the case; `frequency` is in the same units.
    fn formulas<const D: usize>(
        &self,
        formula: &MotionFormula,
        frequency: f64,
        law: BodyMotion<D>,
    ) -> Result<BodyMotion<D>, MotionError> {
        let time = self.units.case_time(1.0);
        let course = |text: &Option<String>| match text {
            None => Ok(None),
            Some(text) => match Formula::parse(text) {
                Ok(formula) => Ok(Some(TimeFunction::Formula { formula, omega: frequency, time })),
                Err(source) => Err(MotionError::Formula { text: text.clone(), source }),
            },
        };
        let law = match course(&formula.angle)? {
            Some(angle) => law.with_angle(angle),
            None => law,
        };
        let shift = [course(&formula.x)?, course(&formula.y)?, course(&formula.z)?];
        if shift.iter().all(Option::is_none) {
            return Ok(law);
        }
        Ok(law.with_shift(std::array::from_fn(|d| shift[d].clone().unwrap_or(TimeFunction::Steady(0.0)))))
    }
}
