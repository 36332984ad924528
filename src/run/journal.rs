//! Tables that a run appends to while it goes.
use std::path::{Path, PathBuf};

use crate::geometry::dimension;
use crate::observe::History;
use crate::observe::columns::{Scale, describe_tables};
use crate::observe::structure::{self, StructureHistory, StructureNames, StructureSample, StructureTable};
use crate::observe::table::TableMark;
use crate::problem::RunError;
use crate::problem::files;
use crate::study::keeper::{Earlier, Tables};
use crate::study::record::IterationHistory;
use crate::study::record::crosscheck::{self, Twofold};
use crate::study::record::saved::Saved;
use crate::study::record::trace::Trace;

/// Name of the history in the run folder.
const HISTORY: &str = "history.csv";

/// The run folder while a run goes on.
pub(crate) struct Journal {
    /// The folder.
    out: PathBuf,
    history: History,
    moments: Option<History>,
    structures: Option<StructureHistory>,
    scale: Scale,
    names: Vec<StructureNames>,
}

impl Journal {
    /// Begins the tables of a study in the folder `out`, or goes on where `saved` stands.
    pub(crate) fn open(
        out: &Path,
        &Tables { case, twice, structures: names }: &Tables<'_>,
        saved: Option<&Saved<'_>>,
    ) -> Result<(Self, Earlier), RunError> {
        let mark = |name: &str| saved.and_then(|s| s.tables.iter().find(|mark| mark.file == name));
        let table = |name: &str, columns: &[&str]| match saved {
            Some(s) => History::resume(&out.join(name), columns, s.iteration, mark(name)),
            None => History::create(&out.join(name), columns),
        };
        let rows = IterationHistory::of(case);
        let history = table(HISTORY, &rows.names)?;
        let moments = twice.then(|| table(crosscheck::FILE, &crosscheck::COLUMNS)).transpose()?;
        let structures = (!names.is_empty()).then(|| match saved {
            Some(s) => StructureHistory::resume(out, names, s.iteration, mark(structure::FILE)),
            None => StructureHistory::create(out, names),
        });
        let structures = structures.transpose()?;
        let until = |s: &Saved<'_>| case.flow.units().case_time(s.time);
        let text = |name: &str| files::text(out, name).unwrap_or_default();
        let earlier = saved.map_or_else(Earlier::default, |s| Earlier {
            history: rows.with_rows(&text(HISTORY)),
            trace: if s.time > 0.0 { Trace::parse(&text(HISTORY), until(s)) } else { Trace::default() },
            moments: if twice { Twofold::parse(&text(crosscheck::FILE)) } else { Twofold::default() },
            structures: StructureTable::parse(&text(structure::FILE)).unwrap_or_default(),
        });
        let scale = Scale { dimensional: case.flow.is_dimensional(), dimension: dimension(case).into() };
        let journal = Self { out: out.to_path_buf(), history, moments, structures, scale, names: names.to_vec() };
        journal.describe()?;
        Ok((journal, earlier))
    }

    /// What the tables hold now, for a checkpoint.
    pub(crate) fn marks(&self) -> Result<Vec<TableMark>, RunError> {
        let tables = std::iter::once(&self.history).chain(&self.moments).map(History::mark);
        let structures = self.structures.iter().map(StructureHistory::mark);
        Ok(tables.chain(structures).collect::<Result<_, _>>()?)
    }

    /// Tells the units of all tables of the folder.
    pub(crate) fn describe(&self) -> Result<(), RunError> {
        Ok(describe_tables(&self.out, self.scale, &self.names)?)
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
