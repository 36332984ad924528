//! The folder of a run as the keeper of a study: tables, checkpoints, fields and pictures.
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::files::{self, Target};
use super::journal::Journal;
use super::{checkpoint, folder, room};
use crate::case::Case;
use crate::coupling::SolidSnapshot;
use crate::geometry::Surface;
use crate::observe::structure::StructureSample;
use crate::problem::RunError;
use crate::record::summary::{Summary, write_polar};
use crate::scheme::Work;
use crate::study::PeriodFields;
use crate::study::keeper::{Camera, Earlier, End, Keeper, Tables};
use crate::study::look::GasView;
use crate::study::record::Log;
use crate::study::record::polar::PolarRecord;
use crate::study::record::saved::{FILE, Saved};

/// Keeps the study of a gas in a folder.
pub(super) struct FolderKeeper {
    out: PathBuf,
    journal: Option<Journal>,
}

impl FolderKeeper {
    /// In the folder `out`.
    pub(super) fn new(out: &Path) -> Self {
        Self { out: out.to_path_buf(), journal: None }
    }

    fn with(&mut self, write: impl FnOnce(&mut Journal) -> Result<(), RunError>) -> Result<(), RunError> {
        self.journal.as_mut().map_or(Ok(()), write)
    }
}

impl Keeper for FolderKeeper {
    fn check_room(&self, case: &Case, particles: usize, dimension: usize, period: Option<f64>) -> Result<(), RunError> {
        room::check(case, &self.out, particles, dimension, period)
    }

    fn open(&mut self, tables: &Tables<'_>, saved: Option<&Saved<'_>>) -> Result<Earlier, RunError> {
        let (journal, earlier) = Journal::open(&self.out, tables, saved)?;
        self.journal = Some(journal);
        Ok(earlier)
    }

    fn row(&mut self, row: &[f64]) -> Result<(), RunError> {
        self.with(|journal| journal.row(row))
    }

    fn structure(&mut self, iteration: u64, sample: &StructureSample) -> Result<(), RunError> {
        self.with(|journal| journal.structure(iteration, sample))
    }

    fn moment(&mut self, row: &[f64]) -> Result<(), RunError> {
        self.with(|journal| journal.moment(row))
    }

    fn points(&self, polar: &PolarRecord) -> Result<(), RunError> {
        Ok(write_polar(&polar.points, &self.out)?)
    }

    fn checkpoint(&self, saved: Saved<'_>) -> Result<(), RunError> {
        let tables = self.journal.as_ref().map_or_else(|| Ok(Vec::new()), Journal::marks)?;
        checkpoint::write(Saved { tables, ..saved }, &self.out)
    }

    fn describe(&self) -> Result<(), RunError> {
        self.journal.as_ref().map_or(Ok(()), Journal::describe)
    }

    fn name(&self) -> String {
        self.out.display().to_string()
    }

    fn checkpoint_name(&self) -> String {
        self.out.join(FILE).display().to_string()
    }

    fn plane(&self) -> Arc<dyn Camera<2>> {
        Arc::new(Fields { out: self.out.clone() })
    }

    fn space(&self) -> Arc<dyn Camera<3>> {
        Arc::new(Fields { out: self.out.clone() })
    }
}

/// Fields and pictures in a folder.
struct Fields {
    out: PathBuf,
}

impl Fields {
    fn target<'a>(&'a self, case: &'a Case) -> Target<'a> {
        Target { case, out: &self.out }
    }
}

impl<const D: usize> Camera<D> for Fields {
    fn field(&self, case: &Case, gas: &GasView<'_, D>, work: &mut Work<D>, interval: f64) -> Result<(), RunError> {
        files::write_series(&self.target(case), gas, work, interval)
    }

    fn solid(&self, case: &Case, at: &SolidSnapshot<'_, D>, time: f64, interval: f64) -> Result<(), RunError> {
        files::write_solid_series(&self.target(case), at, (time, interval))
    }

    fn picture(
        &self,
        case: &Case,
        surface: &Surface<D>,
        gas: &GasView<'_, D>,
        work: &mut Work<D>,
        part: u64,
    ) -> Result<(), RunError> {
        files::write_film(&self.target(case), surface, gas, work, part)
    }

    fn frame(
        &self,
        case: &Case,
        gas: &GasView<'_, D>,
        work: &mut Work<D>,
        period: f64,
        part: u64,
    ) -> Result<(), RunError> {
        files::write_film_field(&self.target(case), gas, work, period, part)
    }

    fn period(&self, case: &Case, instances: &[[f64; 6]], fields: &PeriodFields<'_, D>) -> Result<(), RunError> {
        files::write_period(case, instances, fields, &self.out)
    }

    fn end(&self, end: End<'_, D>, summary: &mut Summary, log: &Log<'_>) -> Result<(), RunError> {
        let End { found, field, walls, solid, chosen, refined } = end;
        if chosen {
            folder::put_cloud(&summary.conditions.cloud, refined, &self.out)?;
        }
        files::write_all(found, summary, (field, walls), solid, log, &self.out)?;
        log.keeper.as_ref().map_or(Ok(()), |keeper| keeper.describe())?;
        folder::finish(&self.out)
    }
}
