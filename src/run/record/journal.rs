//! Tables that a run appends to while it goes.
use std::path::{Path, PathBuf};

use super::super::error::RunError;
use super::super::folder;
use super::crosscheck::{self, Twofold};
use super::saved::Saved;
use super::trace::Trace;
use crate::case::Case;
use crate::observe::History;
use crate::observe::structure::{self, StructureHistory, StructureNames, StructureSample, StructureTable};

/// Name of the history in the run folder.
const HISTORY: &str = "history.csv";
/// Columns of it.
const COLUMNS: [&str; 10] =
    ["cycle", "iteration", "time", "cfl", "residual", "cl", "cd", "cm", "seconds", "fluid_particles"];
/// More of them when something moves: iterations within the step, angle and displacement of the first body that moves.
const MOVING: [&str; 5] = ["inner", "angle_deg", "shift_x", "shift_y", "shift_z"];
/// One more when a body bends: the coordinate of the first mode of that body.
const BENDING: &str = "mode";
/// One more for a polar: the number of the point, from 1.
const POINT: &str = "point";

/// The run folder while a run goes on.
pub(crate) struct Journal {
    /// The folder.
    pub(crate) out: PathBuf,
    history: History,
    moments: Option<History>,
    structures: Option<StructureHistory>,
}

/// What the tables of an interrupted run hold.
#[derive(Default)]
pub(crate) struct Earlier {
    /// Loads in time.
    pub(crate) trace: Trace,
    /// Loads evaluated twice.
    pub(crate) moments: Twofold,
    /// How structures moved.
    pub(crate) structures: StructureTable,
}

/// Columns of the history of a case.
fn columns(case: &Case) -> Vec<&'static str> {
    let moving = MOVING.into_iter().filter(|_| case.moves());
    let point = case.polar.as_ref().map(|_| POINT);
    COLUMNS.into_iter().chain(moving).chain(case.bends().then_some(BENDING)).chain(point).collect()
}

impl Journal {
    /// Begins the tables, or goes on where `saved` stands; `twice`: loads are evaluated twice.
    pub(crate) fn open(
        case: &Case,
        out: &Path,
        saved: Option<&Saved>,
        twice: bool,
        structures: &[StructureNames],
    ) -> Result<(Self, Earlier), RunError> {
        let table = |name: &str, columns: &[&str]| match saved {
            Some(s) => History::resume(&out.join(name), columns, s.iteration),
            None => History::create(&out.join(name), columns),
        };
        let history = table(HISTORY, &columns(case))?;
        let moments = twice.then(|| table(crosscheck::FILE, &crosscheck::COLUMNS)).transpose()?;
        let structures = (!structures.is_empty()).then(|| match saved {
            Some(s) => StructureHistory::resume(out, structures, s.iteration),
            None => StructureHistory::create(out, structures),
        });
        let structures = structures.transpose()?;
        let until = |s: &Saved| case.flow.units().case_time(s.time);
        let text = |name: &str| folder::text(out, name).unwrap_or_default();
        let earlier = saved.map_or_else(Earlier::default, |s| Earlier {
            trace: if s.time > 0.0 { Trace::parse(&text(HISTORY), until(s)) } else { Trace::default() },
            moments: if twice { Twofold::parse(&text(crosscheck::FILE)) } else { Twofold::default() },
            structures: StructureTable::parse(&text(structure::FILE)).unwrap_or_default(),
        });
        Ok((Self { out: out.to_path_buf(), history, moments, structures }, earlier))
    }

    /// Appends an iteration.
    pub(crate) fn row(&mut self, row: &[f64]) -> Result<(), RunError> {
        Ok(self.history.append(row)?)
    }

    /// Appends how structures moved.
    pub(crate) fn structure(&mut self, iteration: u64, sample: &StructureSample) -> Result<(), RunError> {
        match &mut self.structures {
            Some(file) => Ok(file.push(iteration, sample)?),
            None => Ok(()),
        }
    }

    /// Appends loads that were evaluated twice.
    pub(crate) fn moment(&mut self, row: &[f64]) -> Result<(), RunError> {
        match &mut self.moments {
            Some(file) => Ok(file.append(row)?),
            None => Ok(()),
        }
    }
}
