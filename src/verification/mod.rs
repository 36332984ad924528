//! The walk through `verification/`: every folder is a case with claims; each case runs, each claim is judged.
//!
//! Claims share runs, also with those of other cases that they compare with: the store has them, in memory or in a folder where a later
//! walk finds them. A case that does not run fails its claims, with the reason in the place of the source, and the walk goes on.
mod folder;
mod measure;
mod store;

use std::fs;
use std::path::{Path, PathBuf};

use crate::case::Case;
use crate::claims::calibration::{KnownLoad, holding, median_ratio};
use crate::claims::metric::{BarMetric, FlutterMetric, ForceMetric, StudyMetric};
use crate::claims::{Claim, ClaimRow, Metric, Sample, Table, metrics};
use crate::observe::loads::Coefficients;
use crate::problem::files::plain;
use crate::study::Monitor;
use folder::{FILES, respaced, unreadable};
use measure::{Measured, Value};
use store::{Found, Job, Kind, Store};

pub use folder::Folder;
pub use store::{Keep, Spent, TimeTaken, build_of_this_program, times};

/// Name of the folder of all cases.
const FOLDER: &str = "verification";

/// Processor seconds of the quick subset: ten minutes of one core, so that two cores take less.
pub const QUICK: f64 = 600.0;

/// By how much the angles of attack of an ensemble differ, radians: loads change by a hundred thousandth, chaos by all it can.
const NEXT_TO_NOTHING: f64 = 1e-6;

/// Why a walk cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum WalkError {
    /// No folder of cases.
    #[error("no folder `{FOLDER}` here or above\nhint: name one with `--folder`")]
    Nowhere,
    /// A folder or file that cannot be read.
    #[error("cannot read `{path}`: {problem}\nhint: each case needs the files `case.toml` and `claim.toml`")]
    Unreadable {
        /// The file.
        path: String,
        /// What the system says.
        problem: std::io::Error,
    },
    /// A file with mistakes.
    #[error("`{path}`: {problem}")]
    Mistakes {
        /// The file.
        path: String,
        /// The mistakes.
        problem: String,
    },
    /// A folder in which nothing can be kept.
    #[error(
        "cannot keep measurements in `{path}`: {problem}\nhint: choose a folder that you can write to with `--keep`"
    )]
    Keep {
        /// The folder.
        path: String,
        /// What the system says.
        problem: std::io::Error,
    },
    /// Nothing to do.
    #[error("no case {wanted}\nhint: `{folder}` holds {names}")]
    NoCase {
        /// What was asked for.
        wanted: String,
        /// The folder of all cases.
        folder: String,
        /// What there is.
        names: String,
    },
}

/// What to judge.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Only cases whose names contain one of these texts; all where there are none.
    pub filters: Vec<String>,
    /// Only cases that take so many processor seconds together, the shortest first, as their claim files say.
    pub within: Option<f64>,
}

/// The folder `verification` in `from` or above it.
pub fn find(from: &Path) -> Result<PathBuf, WalkError> {
    from.ancestors().map(|a| a.join(FOLDER)).find(|p| p.is_dir()).ok_or(WalkError::Nowhere)
}

/// A walk through the cases of a folder.
pub struct Walk {
    folders: Vec<Folder>,
    chosen: Vec<usize>,
    store: Store,
}

impl Walk {
    /// Reads all cases and claims under `root`; mistakes in any of them end the walk before it begins.
    pub fn new(root: &Path, selection: &Selection) -> Result<Self, WalkError> {
        let entries = fs::read_dir(root).map_err(|e| unreadable(root, e))?;
        // a page of results lies in a folder too, where the walk was begun in this one
        let is_case = |p: &PathBuf| FILES.iter().any(|name| p.join(name).exists());
        let mut paths: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).filter(is_case).collect();
        paths.sort();
        let folders: Vec<Folder> = paths.iter().map(|p| Folder::read(p)).collect::<Result<_, _>>()?;
        let chosen = selection.choose(&folders).map_err(|wanted| {
            let names = folders.iter().map(|f| format!("`{}`", f.name)).collect::<Vec<_>>().join(", ");
            WalkError::NoCase { wanted, folder: root.display().to_string(), names }
        })?;
        Ok(Self { folders, chosen, store: Store::default() })
    }

    /// Keeps all that is computed from now on, and takes from there what an earlier walk of the same build kept.
    pub fn keep(&mut self, keep: Keep) -> Result<(), WalkError> {
        let path = keep.folder.display().to_string();
        self.store.keep(keep).map_err(|problem| WalkError::Keep { path, problem })
    }

    /// The cases to judge.
    pub fn cases(&self) -> impl Iterator<Item = &Folder> {
        self.chosen.iter().map(|&k| &self.folders[k])
    }

    /// Number of cases to judge.
    pub fn len(&self) -> usize {
        self.chosen.len()
    }

    /// True when there is nothing to judge.
    pub fn is_empty(&self) -> bool {
        self.chosen.is_empty()
    }

    /// Judges the claims of case `k` of those chosen; `None` when the monitor says stop.
    pub fn judge(&mut self, k: usize, monitor: &mut dyn Monitor) -> Option<Vec<ClaimRow>> {
        let folder = self.folders[*self.chosen.get(k)?].clone();
        self.store.begin();
        let mut rows = Vec::new();
        for claim in &folder.claims.claims {
            let value = match &claim.case {
                Some(file) => {
                    folder.beside(file).map_err(|e| e.to_string()).and_then(|other| self.sample(claim, &other, monitor))
                }
                None => self.sample(claim, &folder, monitor),
            };
            if monitor.stop() {
                return None;
            }
            rows.push(row(claim, &folder.name, value));
        }
        self.store.note_time(&folder.name, monitor);
        Some(rows)
    }

    /// What the case that was judged last needed, and what that took.
    pub fn spent(&self) -> impl Iterator<Item = &Spent> {
        self.store.spent()
    }

    /// The value of a claim, or the mean of its ensemble: runs whose angles of attack differ by next to nothing.
    fn sample(&mut self, claim: &Claim, folder: &Folder, monitor: &mut dyn Monitor) -> Result<Sample, String> {
        let member = |k: usize| {
            let mut member = folder.clone();
            if k > 0 {
                member.name = format!("{}, run {}", folder.name, k + 1);
                member.case.flow.alpha.0 += NEXT_TO_NOTHING * k as f64;
            }
            member
        };
        let values = (0..claim.ensemble.unwrap_or(1)).map(|k| self.measure(claim, &member(k), monitor));
        Ok(Sample::of(&values.collect::<Result<Vec<f64>, _>>()?))
    }

    fn measure(&mut self, claim: &Claim, folder: &Folder, monitor: &mut dyn Monitor) -> Value {
        if !folder.case.has_gas() {
            let key = self.ensure(Kind::Structure, folder, &folder.case, monitor);
            return match self.store.at(&key)? {
                Found::Structure(numbers) => measure::solid::value(numbers, claim),
                _ => Err("the case has no structure".into()),
            };
        }
        match claim.metric {
            Metric::Flutter(metric) => self.boundary((metric, claim), folder, monitor),
            Metric::Force(metric) => self.forces((metric, claim), folder, monitor),
            Metric::Bar(metric) => self.calibrate((metric, claim), folder, monitor),
            Metric::Study(metric) => self.study((metric, claim), folder, monitor),
            _ => self.flow(claim, folder, monitor),
        }
    }

    /// The metric of a flow, compared with the others that the claim names.
    fn flow(&mut self, claim: &Claim, folder: &Folder, monitor: &mut dyn Monitor) -> Value {
        let mut others = Vec::new();
        for other in self.others(claim, folder)? {
            let key = self.ensure(Kind::Flow, &other, &other.case, monitor);
            self.store.flow(&key)?;
            others.push(key);
        }
        let own = self.ensure(Kind::Flow, folder, &folder.case, monitor);
        let others = others.iter().map(|key| self.store.flow(key)).collect::<Result<Vec<&Measured>, _>>()?;
        self.store.flow(&own)?.value(claim, &folder.path, &others)
    }

    /// Order or limit of a metric over the spacings of the study.
    fn study(&mut self, (metric, claim): (StudyMetric, &Claim), folder: &Folder, monitor: &mut dyn Monitor) -> Value {
        let Some(study) = &folder.claims.study else { return Err("there is no `[study]`".into()) };
        let mut values = Vec::new();
        for &spacing in &study.spacings {
            let key = self.ensure(Kind::Flow, folder, &respaced(&folder.case, spacing, study), monitor);
            values.push(self.store.flow(&key)?.value(claim, &folder.path, &[])?);
        }
        let found = match metric {
            StudyMetric::Order | StudyMetric::CpRmsOrder => metrics::observed_order(&study.spacings, &values),
            StudyMetric::ExtrapolatedCl | StudyMetric::ExtrapolatedCd => {
                metrics::limit(&study.spacings, &values).map(|(limit, _)| limit)
            }
        };
        found.ok_or_else(|| format!("the values {values:?} have no order or limit"))
    }

    /// The metric of a flutter boundary, compared with the one that the claim names.
    fn boundary(
        &mut self,
        (metric, claim): (FlutterMetric, &Claim),
        folder: &Folder,
        monitor: &mut dyn Monitor,
    ) -> Value {
        let other = claim.other.as_ref().map(|name| self.named(name, folder)).transpose()?;
        let other = other.map(|other| self.ensure(Kind::Flutter, &other, &other.case, monitor));
        let own = self.ensure(Kind::Flutter, folder, &folder.case, monitor);
        let numbers = |key: &str| match self.store.at(key)? {
            Found::Flutter(boundary) => Ok(&**boundary),
            _ => Err(String::from("the case has no flutter boundary")),
        };
        let other = other.as_deref().map(numbers).transpose()?;
        measure::boundary::value(numbers(&own)?, other, (metric, claim))
    }

    /// Forces of small motions in the case of `folder` and in those that the claim names, against a table.
    fn forces(&mut self, (metric, claim): (ForceMetric, &Claim), folder: &Folder, monitor: &mut dyn Monitor) -> Value {
        let all: Vec<Folder> = std::iter::once(folder.clone()).chain(self.others(claim, folder)?).collect();
        let keys: Vec<String> = all.iter().map(|one| self.ensure(Kind::Forces, one, &one.case, monitor)).collect();
        let numbers = |key: &String| match self.store.at(key)? {
            Found::Forces(forces) => Ok(&forces[..]),
            _ => Err(String::from("the case has no forces")),
        };
        let forces = keys.iter().map(numbers).collect::<Result<Vec<_>, String>>()?;
        let sections: Vec<_> = all.iter().map(|one| &one.case).zip(forces).collect();
        measure::forces::value(&sections, (metric, claim), &folder.path)
    }

    /// Runs every case of the table of `claim`, and holds their error bars against the exact loads.
    fn calibrate(&mut self, (metric, claim): (BarMetric, &Claim), folder: &Folder, monitor: &mut dyn Monitor) -> Value {
        let name = claim.file.as_deref().ok_or("the claim names no `file` of loads")?;
        let wrong = |e: &dyn std::fmt::Display| format!("`{name}`: {e}");
        let text = plain(&folder.path.join(name)).map_err(|e| wrong(&e))?;
        let known = Table::parse(&text).and_then(|t| KnownLoad::all(&t)).map_err(|e| wrong(&e))?;
        let mut loads = Vec::new();
        for row in &known {
            let here = folder.beside(&row.case).map_err(|e| e.to_string())?;
            let key = self.ensure(Kind::Flow, &here, &here.case, monitor);
            let numbers = &self.store.flow(&key)?.numbers;
            // those that need no theory, which is what they are held against
            let bars = numbers.half_widths.ok_or_else(|| format!("`{}` has no error bars", row.case))?;
            let found =
                row.found(three(&numbers.loads), bars).ok_or_else(|| wrong(&format!("no load `{}`", row.load)))?;
            if metric == BarMetric::BarsHolding {
                monitor.note(&format!(
                    "{}: {} error {:.1e}, bar {:.1e}",
                    row.case, row.load, found.error, found.half_width
                ));
            }
            loads.push(found);
        }
        let found = match metric {
            BarMetric::BarsHolding => holding(&loads),
            BarMetric::BarOverError => median_ratio(&loads),
        };
        found.ok_or_else(|| wrong(&"no loads"))
    }

    /// The cases that a claim compares with.
    fn others(&self, claim: &Claim, here: &Folder) -> Result<Vec<Folder>, String> {
        claim.other.iter().chain(&claim.third).map(|name| self.named(name, here)).collect()
    }

    /// The case that a claim compares with: that of another folder, or another file of this one.
    fn named(&self, name: &str, here: &Folder) -> Result<Folder, String> {
        if name == FILES[0] {
            Folder::read(&here.path).map_err(|e| e.to_string())
        } else if name.ends_with(".toml") {
            here.beside(name).map_err(|e| e.to_string())
        } else {
            let found = self.folders.iter().find(|f| f.name == name).cloned();
            found.ok_or_else(|| format!("there is no case `{name}`"))
        }
    }

    /// Computes `case` of `folder` unless that has been done; the key of what was found.
    fn ensure(&mut self, kind: Kind, folder: &Folder, case: &Case, monitor: &mut dyn Monitor) -> String {
        self.store.ensure(&Job { kind, name: &folder.name, case, folder: &folder.path }, monitor)
    }
}

impl Selection {
    /// Numbers of the cases chosen; where there are none, what was asked for, to follow "no case".
    fn choose(&self, folders: &[Folder]) -> Result<Vec<usize>, String> {
        let holds = |name: &str, filter: &String| name.contains(filter.as_str());
        if let Some(filter) = self.filters.iter().find(|filter| !folders.iter().any(|f| holds(&f.name, filter))) {
            return Err(format!("is called like `{filter}`"));
        }
        let quick = self.within.map(|seconds| within(folders, seconds));
        let wanted = |k: &usize| {
            let named = self.filters.is_empty() || self.filters.iter().any(|filter| holds(&folders[*k].name, filter));
            named && quick.as_ref().is_none_or(|quick| quick.contains(k))
        };
        let chosen: Vec<usize> = (0..folders.len()).filter(wanted).collect();
        match self.within {
            _ if !chosen.is_empty() => Ok(chosen),
            Some(seconds) => {
                Err(format!("of these is among the shortest that take {seconds} s of processor time together"))
            }
            None => Err("is there".into()),
        }
    }
}

/// Numbers of the cases that take `most` processor seconds together, the shortest first, as far as their claim files say.
fn within(folders: &[Folder], most: f64) -> Vec<usize> {
    let known = folders.iter().enumerate().filter_map(|(k, f)| Some((f.claims.cpu_seconds?, k)));
    let mut known: Vec<(f64, usize)> = known.collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0.0;
    let fits = |(seconds, _): &(f64, usize)| {
        sum += seconds;
        sum <= most
    };
    known.into_iter().take_while(fits).map(|(_, k)| k).collect()
}

fn three(c: &Coefficients) -> [f64; 3] {
    [c.cl, c.cd, c.cm]
}

fn row(claim: &Claim, case: &str, value: Result<Sample, String>) -> ClaimRow {
    match value {
        Ok(sample) => claim.judge_sample(case, sample),
        Err(problem) => {
            let first = problem.replace('\n', "; ");
            ClaimRow { source: format!("no value: {first}"), ..claim.judge(case, f64::NAN) }
        }
    }
}
