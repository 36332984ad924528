//! What a verification has computed: in memory, and in a folder where it is kept.
//!
//! A computation that has ended is not repeated. It is found by the build of the program, the name of the case, the kind of the
//! computation, and a hash of all that it depends on: the case as it was read and the files that it names. Claims and reference tables
//! are not part of it, so that a claim that was changed is judged again without a run.
//!
//! `times.json` beside the builds has what every case took last.
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::measure::{Measured, Numbers, solid};
use crate::case::{Case, read_regular};
use crate::observe::table::write_json;
use crate::observe::usage::cpu_seconds;
use crate::observe::{Checkpoint, checkpoint};
use crate::problem::RunError;
use crate::problem::files::plain;
use crate::record::flutter::Boundary;
use crate::record::gaf::Column;
use crate::run::{Outcome, Session, flutter, gaf};
use crate::study::Monitor;
use crate::study::monitor::Quiet;
use crate::study::solids;

/// Name of the table of times.
const TIMES: &str = "times.json";
/// How the folders of builds begin, of whatever else lies beside them nothing is removed.
const BUILD: &str = "build-";
/// Ending of a file that holds a computation.
const ENDING: &str = "kept";
/// Builds whose computations are kept.
const BUILDS: usize = 3;

/// Where computations are kept.
#[derive(Clone, Debug)]
pub struct Keep {
    /// The folder; made where it is missing.
    pub folder: PathBuf,
    /// The build of the program, see [`build_of_this_program`].
    pub build: String,
    /// True to compute everything again and to replace what is there.
    pub again: bool,
}

/// What a computation took.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spent {
    /// Name of the case; with the file where it is not `case.toml`.
    pub name: String,
    /// Spacing of the cloud, 0 where the program chose it.
    pub spacing: f64,
    /// Particles, images left out; 0 where it failed.
    pub particles: usize,
    /// Iterations of a flow over all stages; absent of all else.
    pub iterations: Option<u64>,
    /// Processor seconds.
    pub cpu_seconds: f64,
    /// Wall seconds.
    pub wall_seconds: f64,
    /// True where an earlier verification computed it.
    #[serde(skip)]
    pub kept: bool,
}

/// What a whole case took when it was judged last.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TimeTaken {
    /// Processor seconds of all its computations.
    pub cpu_seconds: f64,
    /// Their wall seconds.
    pub wall_seconds: f64,
    /// The build of the program.
    pub build: String,
}

/// Version and a hash of the file of the running program: two programs of one source may differ in their compiler. `None` where the
/// system does not tell which file that is.
pub fn build_of_this_program() -> Option<String> {
    let mut hash = DefaultHasher::new();
    fs::read(std::env::current_exe().ok()?).ok()?.hash(&mut hash);
    Some(format!("{}-{:016x}", env!("CARGO_PKG_VERSION"), hash.finish()))
}

/// What cases took last, by name; empty where nothing is kept in `folder`.
pub fn times(folder: &Path) -> BTreeMap<String, TimeTaken> {
    let text = plain(&folder.join(TIMES)).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// What is computed of a case.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// Its flow.
    Flow,
    /// Its structure alone.
    Structure,
    /// Its flutter boundary.
    Flutter,
    /// Its forces of small motions.
    Forces,
}

/// A computation that a claim needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job<'a> {
    pub(super) kind: Kind,
    pub(super) name: &'a str,
    pub(super) case: &'a Case,
    /// Folder that file names in the case refer to.
    pub(super) folder: &'a Path,
}

/// What a computation found.
pub(super) enum Found {
    Flow(Box<Measured>),
    Structure(solid::Numbers),
    Flutter(Box<Boundary>),
    Forces(Vec<Column>),
}

/// The part of it that is no array.
#[derive(Serialize, Deserialize)]
enum Head {
    Flow(Box<Numbers>),
    Structure(solid::Numbers),
    Flutter(Box<Boundary>),
    Forces(Vec<Column>),
    /// Why it failed.
    Failed(String),
}

/// Why a computation has no result.
enum Failure {
    /// The monitor said stop.
    Stopped,
    /// It cannot be computed here and now.
    Refused(String),
    /// It failed on its way, and would again.
    Failed(String),
}

/// A computation that has ended.
struct Ended {
    found: Result<Found, String>,
    spent: Spent,
}

/// Computations of a verification.
#[derive(Default)]
pub(super) struct Store {
    keep: Option<Keep>,
    ended: BTreeMap<String, Ended>,
    /// Computed by this verification, where nothing older counts.
    renewed: BTreeSet<String>,
    /// Those that the case that is judged needed.
    used: Vec<String>,
}

impl Store {
    /// Keeps what is computed from now on; folders of builds beyond the last [`BUILDS`] are removed.
    pub(super) fn keep(&mut self, keep: Keep) -> std::io::Result<()> {
        let own = keep.folder.join(format!("{BUILD}{}", keep.build));
        fs::create_dir_all(&own)?;
        let mut others: Vec<(std::time::SystemTime, PathBuf)> = fs::read_dir(&keep.folder)?
            .filter_map(|entry| {
                let entry = entry.ok()?;
                let is_build = entry.file_name().to_string_lossy().starts_with(BUILD) && entry.path() != own;
                let when = entry.metadata().ok().filter(|m| m.is_dir() && is_build)?.modified().ok()?;
                Some((when, entry.path()))
            })
            .collect();
        others.sort();
        let surplus = others.len().saturating_sub(BUILDS - 1);
        others.iter().take(surplus).try_for_each(|(_, folder)| fs::remove_dir_all(folder))?;
        self.keep = Some(keep);
        Ok(())
    }

    /// A case begins: what is kept on disk leaves the memory.
    pub(super) fn begin(&mut self) {
        self.used.clear();
        if self.keep.is_some() {
            self.ended.clear();
        }
    }

    /// What the computations of this case took, in the order in which they were needed first.
    pub(super) fn spent(&self) -> impl Iterator<Item = &Spent> {
        self.used.iter().filter_map(|key| Some(&self.ended.get(key)?.spent))
    }

    /// Notes what the case `name`, which is judged, took.
    pub(super) fn note_time(&self, name: &str, monitor: &mut dyn Monitor) {
        let Some(keep) = &self.keep else { return };
        let sum = |seconds: fn(&Spent) -> f64| self.spent().map(seconds).sum();
        let taken = TimeTaken {
            cpu_seconds: sum(|s| s.cpu_seconds),
            wall_seconds: sum(|s| s.wall_seconds),
            build: keep.build.clone(),
        };
        let mut all = times(&keep.folder);
        all.insert(name.to_owned(), taken);
        if let Err(problem) = write_json(&keep.folder.join(TIMES), &all) {
            monitor.warn(&format!("the time of `{name}` is not kept: {problem}"));
        }
    }

    /// Computes `job` unless that has been done; the key of what it found.
    pub(super) fn ensure(&mut self, job: &Job<'_>, monitor: &mut dyn Monitor) -> String {
        let key = job.key();
        if !self.ended.contains_key(&key) && !monitor.stop() {
            let ended = self.kept(&key, job).or_else(|| self.compute(&key, job, monitor));
            if let Some(ended) = ended {
                monitor.note(&told(&ended));
                self.ended.insert(key.clone(), ended);
            }
        }
        if !self.used.contains(&key) {
            self.used.push(key.clone());
        }
        key
    }

    /// What was found under a key.
    pub(super) fn at(&self, key: &str) -> Result<&Found, String> {
        let ended = self.ended.get(key).ok_or("the case did not run")?;
        ended.found.as_ref().map_err(Clone::clone)
    }

    /// The flow under a key.
    pub(super) fn flow(&self, key: &str) -> Result<&Measured, String> {
        match self.at(key)? {
            Found::Flow(found) => Ok(found),
            _ => Err("the case has no flow".into()),
        }
    }

    fn path(&self, key: &str) -> Option<PathBuf> {
        let keep = self.keep.as_ref()?;
        Some(keep.folder.join(format!("{BUILD}{}", keep.build)).join(format!("{key}.{ENDING}")))
    }

    /// What an earlier verification kept; a file that cannot be read counts as none.
    fn kept(&self, key: &str, job: &Job<'_>) -> Option<Ended> {
        let stale = self.keep.as_ref()?.again && !self.renewed.contains(key);
        let file = checkpoint::read(&self.path(key)?).ok().filter(|_| !stale)?;
        let part = |name: &str| file.meta.get(name).cloned().unwrap_or(Value::Null);
        let spent: Spent = serde_json::from_value(part("spent")).ok()?;
        let found = match toml::from_str(part("found").as_str()?).ok()? {
            Head::Flow(numbers) => Ok(Found::Flow(Box::new(Measured::from_file(job.case, *numbers, &file)?))),
            Head::Structure(numbers) => Ok(Found::Structure(numbers)),
            Head::Flutter(boundary) => Ok(Found::Flutter(boundary)),
            Head::Forces(all) => Ok(Found::Forces(all)),
            Head::Failed(why) => Err(why),
        };
        Some(Ended { found, spent: Spent { kept: !self.renewed.contains(key), ..spent } })
    }

    /// Computes and keeps; `None` where the monitor said stop.
    fn compute(&mut self, key: &str, job: &Job<'_>, monitor: &mut dyn Monitor) -> Option<Ended> {
        monitor.note(&job.told());
        let (clock, cpu) = (std::time::Instant::now(), cpu_seconds());
        let (found, lasting) = match job.solve(monitor) {
            Ok(found) => (Ok(found), true),
            Err(Failure::Stopped) => return None,
            Err(Failure::Refused(why)) => (Err(why), false),
            Err(Failure::Failed(why)) => (Err(why), true),
        };
        let (particles, iterations) = found.as_ref().map_or((0, None), Found::size);
        let spent = Spent {
            name: job.name.to_owned(),
            spacing: spacing_of(job.case),
            particles,
            iterations,
            cpu_seconds: cpu_seconds() - cpu,
            wall_seconds: clock.elapsed().as_secs_f64(),
            kept: false,
        };
        let ended = Ended { found, spent };
        if let Some(path) = self.path(key).filter(|_| lasting) {
            self.renewed.insert(key.to_owned());
            if let Err(problem) = ended.write(&path) {
                monitor.warn(&format!("`{}` is not kept: {problem}", job.name));
            }
        }
        Some(ended)
    }
}

impl Ended {
    fn write(&self, path: &Path) -> Result<(), String> {
        let head = match &self.found {
            Ok(Found::Flow(run)) => Head::Flow(Box::new(run.numbers.clone())),
            Ok(Found::Structure(numbers)) => Head::Structure(numbers.clone()),
            Ok(Found::Flutter(boundary)) => Head::Flutter(boundary.clone()),
            Ok(Found::Forces(all)) => Head::Forces(all.clone()),
            Err(why) => Head::Failed(why.clone()),
        };
        let fields = if let Ok(Found::Flow(run)) = &self.found { run.arrays() } else { Vec::new() };
        // in TOML, which unlike JSON has words for numbers that are infinite or not known
        let found = toml::to_string(&head).map_err(|e| e.to_string())?;
        let file = Checkpoint { meta: json!({ "spent": self.spent, "found": found }), fields };
        checkpoint::write(path, &file).map_err(|e| e.to_string())
    }
}

impl Found {
    /// Particles, and iterations of a flow.
    fn size(&self) -> (usize, Option<u64>) {
        match self {
            Self::Flow(run) => (run.numbers.particles, Some(run.numbers.iterations)),
            Self::Structure(numbers) => (numbers.particles, None),
            Self::Flutter(boundary) => (boundary.flutter.first().map_or(0, |at| at.particles), None),
            Self::Forces(_) => (0, None),
        }
    }
}

impl Job<'_> {
    /// Name, kind, and a hash of the case as it was read and of the files that it names.
    fn key(&self) -> String {
        let mut hash = DefaultHasher::new();
        // every digit of every number, which a case file may round
        format!("{:?}", self.case).hash(&mut hash);
        let case = serde_json::to_value(self.case).unwrap_or_default();
        for file in texts(&case).into_iter().map(|text| self.folder.join(text)).filter(|path| path.is_file()) {
            read_regular(&file).unwrap_or_default().hash(&mut hash);
        }
        let plain = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '-' };
        let name: String = self.name.chars().map(plain).collect();
        format!("{name}.{:?}-{:016x}", self.kind, hash.finish()).to_lowercase()
    }

    fn told(&self) -> String {
        match spacing_of(self.case) {
            0.0 => self.name.to_owned(),
            spacing => format!("{} at spacing {spacing}", self.name),
        }
    }

    fn solve(&self, monitor: &mut dyn Monitor) -> Result<Found, Failure> {
        let quiet = &mut Quiet { monitor };
        match self.kind {
            Kind::Flow => self.flow(quiet),
            Kind::Structure => match solids::solve((self.case, self.folder), None, quiet)? {
                solids::Ended::Finished(found) => Ok(Found::Structure((&found.summary).into())),
                solids::Ended::Interrupted(_) => Err(Failure::Stopped),
            },
            Kind::Flutter => {
                let found = flutter::in_memory(self.case, self.folder, None, quiet)?;
                found.map(|boundary| Found::Flutter(Box::new(boundary))).ok_or(Failure::Stopped)
            }
            Kind::Forces => {
                let found = gaf::in_memory(self.case, self.folder, quiet)?;
                found.map(|matrices| Found::Forces(matrices.columns)).ok_or(Failure::Stopped)
            }
        }
    }

    fn flow(&self, monitor: &mut dyn Monitor) -> Result<Found, Failure> {
        let mut session = Session::open(self.case, self.folder)?;
        let Outcome::Finished(summary) = session.solve(monitor)? else { return Err(Failure::Stopped) };
        let measured = Measured::of(self.case, (&*summary).into(), &session);
        measured.map(|run| Found::Flow(Box::new(run))).ok_or_else(|| Failure::Failed("the run left no solution".into()))
    }
}

impl From<RunError> for Failure {
    fn from(problem: RunError) -> Self {
        match problem {
            RunError::Time { source, .. } => Self::Failed(source.to_string()),
            other => Self::Refused(other.to_string()),
        }
    }
}

/// All texts in a value.
fn texts(value: &Value) -> Vec<&str> {
    match value {
        Value::String(text) => vec![text],
        Value::Array(list) => list.iter().flat_map(texts).collect(),
        Value::Object(table) => table.values().flat_map(texts).collect(),
        _ => Vec::new(),
    }
}

/// Spacing of a case, zero where the program chooses it.
pub(super) fn spacing_of(case: &Case) -> f64 {
    case.cloud.spacing.map_or(0.0, |l| l.0)
}

/// One line about a computation that has ended.
fn told(ended: &Ended) -> String {
    let Spent { name, particles, iterations, cpu_seconds, kept, .. } = &ended.spent;
    let iterations = iterations.map_or_else(String::new, |n| format!(", {n} iterations"));
    let size = if ended.found.is_ok() { format!("{particles} particles{iterations}") } else { "failed".into() };
    let from = if *kept { ", known from before" } else { "" };
    format!("{name}: {size}, {cpu_seconds:.1} s of processor time{from}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::flutter::{FlutterAt, FlutterRow};
    use crate::record::gaf::Errors;

    #[test]
    fn boundaries_and_forces_are_kept_as_they_are_found() {
        let row =
            FlutterRow { kind: "flutter".into(), speed: 0.1 + 0.2, error: f64::INFINITY, ..FlutterRow::default() };
        let mut boundary = Boundary::new("t");
        boundary.flutter.push(FlutterAt { mach: 0.5, crossings: vec![row], ..FlutterAt::default() });
        let errors = Some(Errors { cl_error: 1.0, cm_error: f64::INFINITY, q_error: vec![1.0 / 3.0] });
        let forces = vec![Column { k: 0.1, q: vec![[1.0, -2.0]], errors, ..Column::default() }];
        for head in [Head::Flutter(Box::new(boundary)), Head::Forces(forces)] {
            let text = toml::to_string(&head).unwrap();
            let again: Head = toml::from_str(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
            assert_eq!(toml::to_string(&again).unwrap(), text);
        }
    }
}
