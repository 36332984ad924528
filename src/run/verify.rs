//! The walk through `verification/`: every folder is a case with claims; each case runs, each claim is judged.
//!
//! Claims share runs: one for each case and spacing, kept until the walk ends, so that a claim may compare its case with
//! another one. They stay in memory. A case that does not run fails its claims, with
//! the reason in the place of the source, and the walk goes on.
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::flutter::{self, Boundary};
use super::gaf::{self, Matrices};
use super::measure::{self, Measured, Value};
use super::monitor::{Monitor, Quiet};
use super::outcome::Outcome;
use super::session::Session;
use super::solids::{self, SolidSummary};
use crate::case::{Case, Length, read};
use crate::observe::loads::Coefficients;
use crate::problem::RunError;
use crate::verify::calibration::{KnownLoad, holding, median_ratio};
use crate::verify::{Claim, ClaimFile, ClaimRow, Metric, Sample, Study, Table, metrics};

/// Name of the folder of all cases.
const FOLDER: &str = "verification";
/// Files of one case.
const FILES: [&str; 2] = ["case.toml", "claim.toml"];

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
    /// Nothing to do.
    #[error("no case is called so\nhint: `{folder}` holds {names}")]
    NoCase {
        /// The folder of all cases.
        folder: String,
        /// What there is.
        names: String,
    },
}

/// A folder with a case and what it claims.
#[derive(Clone, Debug)]
pub struct Folder {
    /// Name of the folder.
    pub name: String,
    /// The folder.
    pub path: PathBuf,
    /// The case.
    pub case: Case,
    /// The claims.
    pub claims: ClaimFile,
}

/// What to judge.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Only cases whose name contains this.
    pub filter: Option<String>,
    /// Only the quick subset, without extrapolations.
    pub fast: bool,
}

/// The folder `verification` in `from` or above it.
pub fn find(from: &Path) -> Result<PathBuf, WalkError> {
    from.ancestors().map(|a| a.join(FOLDER)).find(|p| p.is_dir()).ok_or(WalkError::Nowhere)
}

/// A walk through the cases of a folder.
pub struct Walk {
    folders: Vec<Folder>,
    chosen: Vec<usize>,
    fast: bool,
    runs: BTreeMap<(String, u64), Result<Measured, String>>,
    structures: BTreeMap<String, Result<SolidSummary, String>>,
    boundaries: BTreeMap<String, Result<Boundary, String>>,
    forces: BTreeMap<String, Result<Matrices, String>>,
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
        let wanted = |f: &Folder| selection.filter.as_ref().is_none_or(|text| f.name.contains(text.as_str()));
        let chosen: Vec<usize> = (0..folders.len())
            .filter(|&k| wanted(&folders[k]) && (!selection.fast || folders[k].claims.fast))
            .collect();
        if chosen.is_empty() {
            let names = folders.iter().map(|f| format!("`{}`", f.name)).collect::<Vec<_>>().join(", ");
            return Err(WalkError::NoCase { folder: root.display().to_string(), names });
        }
        let (runs, structures) = (BTreeMap::new(), BTreeMap::new());
        let (boundaries, forces) = (BTreeMap::new(), BTreeMap::new());
        Ok(Self { folders, chosen, fast: selection.fast, runs, structures, boundaries, forces })
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
        let fast = self.fast;
        let claims = folder.claims.claims.iter().filter(|c| !(fast && is_extrapolation(c.metric)));
        let mut rows = Vec::new();
        for claim in claims {
            let value = match &claim.case {
                Some(file) => {
                    folder.beside(file).map_err(|e| e.to_string()).and_then(|other| self.sample(claim, &other, monitor))
                }
                None => self.sample(claim, &folder, monitor),
            };
            rows.push(row(claim, &folder.name, value));
            if monitor.stop() {
                return None;
            }
        }
        Some(rows)
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
            return measure::solid::value(self.structure(folder, monitor)?, claim);
        }
        if claim.metric.is_of_flutter() {
            let other = claim.other.as_ref().map(|name| self.named(name, folder)).transpose()?;
            other.as_ref().map(|other| self.boundary(other, monitor).map(|_| ())).transpose()?;
            self.boundary(folder, monitor)?;
            let known = |f: &Folder| self.boundaries.get(&f.name).and_then(|b| b.as_ref().ok());
            let own = known(folder).ok_or("the case did not run")?;
            return measure::boundary::value(own, other.as_ref().and_then(known), claim);
        }
        if claim.metric.is_of_forces() {
            return self.forces_of(claim, folder, monitor);
        }
        if claim.metric.needs_cases() {
            return self.calibrate(claim, folder, monitor);
        }
        if !claim.metric.needs_study() {
            let names = claim.other.iter().chain(&claim.third);
            let others = names.map(|name| self.other(name, folder, monitor)).collect::<Result<Vec<_>, _>>()?;
            let key = self.ensure(folder, &folder.case, monitor);
            let others: Vec<_> = others.iter().filter_map(|key| self.runs.get(key)?.as_ref().ok()).collect();
            return self.at(&key)?.value(claim, &folder.path, &others);
        }
        let Some(study) = &folder.claims.study else { return Err("there is no `[study]`".into()) };
        let mut values = Vec::new();
        for &spacing in &study.spacings {
            let key = self.ensure(folder, &respaced(&folder.case, spacing, study), monitor);
            values.push(self.at(&key)?.value(claim, &folder.path, &[])?);
        }
        let found = match claim.metric {
            Metric::Order | Metric::CpRmsOrder => metrics::observed_order(&study.spacings, &values),
            _ => metrics::limit(&study.spacings, &values).map(|(limit, _)| limit),
        };
        found.ok_or_else(|| format!("the values {values:?} have no order or limit"))
    }

    /// Computes a structure alone unless that has been done.
    fn structure(&mut self, folder: &Folder, monitor: &mut dyn Monitor) -> Result<&SolidSummary, String> {
        let name = folder.name.clone();
        if !self.structures.contains_key(&name) && !monitor.stop() {
            monitor.note(&name);
            let job = solids::Job { case: &folder.case, input: &folder.path, out: None, from: None };
            let found = solids::solve(&job, &mut Quiet { monitor });
            let found = match found {
                Ok(solids::Ended::Finished(found)) => Ok(found.summary),
                Ok(solids::Ended::Interrupted(_)) => Err("the run was interrupted".into()),
                Err(problem) => Err(reason(&problem)),
            };
            if let Ok(s) = &found {
                monitor.note(&format!("{name}: {} particles, {:.1} s", s.particles, s.wall_seconds));
            }
            self.structures.insert(name.clone(), found);
        }
        let found = self.structures.get(&name).ok_or("the case did not run")?;
        found.as_ref().map_err(Clone::clone)
    }

    /// Seeks a flutter boundary unless that has been done.
    fn boundary(&mut self, folder: &Folder, monitor: &mut dyn Monitor) -> Result<&Boundary, String> {
        let name = folder.name.clone();
        if !self.boundaries.contains_key(&name) && !monitor.stop() {
            monitor.note(&name);
            let found = flutter::in_memory(&folder.case, &folder.path, None, &mut Quiet { monitor });
            let found = match found {
                Ok(Some(boundary)) => Ok(boundary),
                Ok(None) => Err("the run was interrupted".into()),
                Err(problem) => Err(reason(&problem)),
            };
            if let Ok(b) = &found {
                let cpu: f64 = b.flutter.iter().map(|at| at.cpu_seconds).sum();
                let particles = b.flutter.first().map_or(0, |at| at.particles);
                monitor.note(&format!("{name}: {particles} particles, {cpu:.1} s of processor time"));
            }
            self.boundaries.insert(name.clone(), found);
        }
        let found = self.boundaries.get(&name).ok_or("the case did not run")?;
        found.as_ref().map_err(Clone::clone)
    }

    /// Measures forces of small motions in the case of `folder` and in those that the claim names.
    fn forces_of(&mut self, claim: &Claim, folder: &Folder, monitor: &mut dyn Monitor) -> Value {
        let names = claim.other.iter().chain(&claim.third);
        let others = names.map(|name| self.named(name, folder)).collect::<Result<Vec<_>, _>>()?;
        let all: Vec<&Folder> = std::iter::once(folder).chain(&others).collect();
        for one in &all {
            if !self.forces.contains_key(&one.name) && !monitor.stop() {
                monitor.note(&one.name);
                let found = gaf::in_memory(&one.case, &one.path, &mut Quiet { monitor });
                let found = found.map_err(|e| reason(&e)).and_then(|m| m.ok_or("the run was interrupted".into()));
                self.forces.insert(one.name.clone(), found);
            }
        }
        let known = |one: &&Folder| {
            let found = self.forces.get(&one.name).ok_or("the case did not run")?;
            found.as_ref().map_err(Clone::clone)
        };
        let matrices = all.iter().map(known).collect::<Result<Vec<_>, String>>()?;
        let sections: Vec<_> = all.iter().map(|one| &one.case).zip(matrices).collect();
        measure::forces::value(&sections, claim, &folder.path)
    }

    /// Runs every case of the table of `claim`, and holds their error bars against the exact loads.
    fn calibrate(&mut self, claim: &Claim, folder: &Folder, monitor: &mut dyn Monitor) -> Value {
        let name = claim.file.as_deref().ok_or("the claim names no `file` of loads")?;
        let wrong = |e: &dyn std::fmt::Display| format!("`{name}`: {e}");
        let text = fs::read_to_string(folder.path.join(name)).map_err(|e| wrong(&e))?;
        let known = Table::parse(&text).and_then(|t| KnownLoad::all(&t)).map_err(|e| wrong(&e))?;
        let mut loads = Vec::new();
        for row in &known {
            let here = folder.beside(&row.case).map_err(|e| e.to_string())?;
            let key = self.ensure(&here, &here.case, monitor);
            let s = &self.at(&key)?.summary;
            let family = s.grid_convergence.as_ref().ok_or_else(|| format!("`{}` has no error bars", row.case))?;
            // those that need no theory, which is what they are held against
            let bars = [family.cl, family.cd, family.cm].map(|load| load.told_by_clouds());
            let found = row.found(three(&s.loads), bars).ok_or_else(|| wrong(&format!("no load `{}`", row.load)))?;
            if claim.metric == Metric::BarsHolding {
                monitor.note(&format!(
                    "{}: {} error {:.1e}, bar {:.1e}",
                    row.case, row.load, found.error, found.half_width
                ));
            }
            loads.push(found);
        }
        let found = if claim.metric == Metric::BarsHolding { holding(&loads) } else { median_ratio(&loads) };
        found.ok_or_else(|| wrong(&"no loads"))
    }

    /// Runs the case that a claim compares with: that of another folder, or another file of this one.
    fn other(&mut self, name: &str, here: &Folder, monitor: &mut dyn Monitor) -> Result<(String, u64), String> {
        let folder = self.named(name, here)?;
        let key = self.ensure(&folder, &folder.case, monitor);
        self.at(&key)?;
        Ok(key)
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

    fn at(&self, key: &(String, u64)) -> Result<&Measured, String> {
        match self.runs.get(key) {
            Some(Ok(run)) => Ok(run),
            Some(Err(problem)) => Err(problem.clone()),
            None => Err("the case did not run".into()),
        }
    }

    /// Runs a case at its spacing unless that has been done.
    fn ensure(&mut self, folder: &Folder, case: &Case, monitor: &mut dyn Monitor) -> (String, u64) {
        let key = (folder.name.clone(), spacing_of(case).to_bits());
        if !self.runs.contains_key(&key) && !monitor.stop() {
            let spacing = spacing_of(case);
            monitor.note(&format!("{} at spacing {spacing}", folder.name));
            let run = run(folder, case, monitor);
            if let Ok(m) = &run {
                let s = &m.summary;
                let (n, it) = (s.particles, s.iterations);
                monitor.note(&format!("{}: {n} particles, {it} iterations, {:.1} s", folder.name, s.wall_seconds));
            }
            self.runs.insert(key.clone(), run);
        }
        key
    }
}

impl Folder {
    /// Reads one case with its claims.
    pub fn read(path: &Path) -> Result<Self, WalkError> {
        let [case, claims] = FILES.map(|name| path.join(name));
        let text = |p: &Path| fs::read_to_string(p).map_err(|e| unreadable(p, e));
        let wrong = |p: &Path, problem: String| WalkError::Mistakes { path: p.display().to_string(), problem };
        let claims_read = ClaimFile::parse(&text(&claims)?).map_err(|e| wrong(&claims, e.to_string()))?;
        let case_read = read(&text(&case)?, &case.display().to_string()).map_err(|e| wrong(&case, e.to_string()))?;
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        Ok(Self { name, path: path.to_path_buf(), case: case_read, claims: claims_read })
    }
}

impl Folder {
    /// Another case file of the same folder.
    fn beside(&self, file: &str) -> Result<Self, WalkError> {
        let path = self.path.join(file);
        let text = fs::read_to_string(&path).map_err(|e| unreadable(&path, e))?;
        let wrong = |e: crate::case::CaseErrors| WalkError::Mistakes {
            path: path.display().to_string(),
            problem: e.to_string(),
        };
        let case = read(&text, &path.display().to_string()).map_err(wrong)?;
        Ok(Self { name: format!("{}/{file}", self.name), case, ..self.clone() })
    }
}

fn three(c: &Coefficients) -> [f64; 3] {
    [c.cl, c.cd, c.cm]
}

fn unreadable(path: &Path, problem: std::io::Error) -> WalkError {
    WalkError::Unreadable { path: path.display().to_string(), problem }
}

fn is_extrapolation(metric: Metric) -> bool {
    matches!(metric, Metric::ExtrapolatedCl | Metric::ExtrapolatedCd)
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

/// Spacing of a case, zero where the program chooses it.
fn spacing_of(case: &Case) -> f64 {
    case.cloud.spacing.map_or(0.0, |l| l.0)
}

/// The case at another spacing.
fn respaced(case: &Case, spacing: f64, study: &Study) -> Case {
    let mut case = case.clone();
    let factor = spacing / spacing_of(&case);
    case.cloud.spacing = Some(Length(spacing));
    if study.scale_boxes {
        case.cloud.boxes.iter_mut().for_each(|b| b.spacing.0 *= factor);
    }
    if study.scale_layers {
        case.cloud.layers = Some(case.cloud.particles_per_level() / factor);
    }
    if let Some(layers) = case.cloud.wall_layers.as_mut().filter(|_| study.scale_wall_layers) {
        layers.first.0 *= factor;
    }
    if let Some(wake) = case.cloud.wake.as_mut().filter(|_| study.scale_wake) {
        wake.spacing.0 *= factor;
    }
    case
}

/// Solves a case and keeps what can be measured.
fn run(folder: &Folder, case: &Case, monitor: &mut dyn Monitor) -> Result<Measured, String> {
    let mut session = Session::open(case, &folder.path).map_err(|e| reason(&e))?;
    let ended = session.solve(&mut Quiet { monitor }).map_err(|e| reason(&e))?;
    let Outcome::Finished(summary) = ended else { return Err("the run was interrupted".into()) };
    let none = "the run left no solution";
    Ok(Measured {
        case: case.clone(),
        summary: *summary,
        field: session.field().ok_or(none)?.clone(),
        wall: session.wall().ok_or(none)?,
        loops: session.loops().ok_or(none)?.clone(),
    })
}

/// What went wrong.
fn reason(problem: &RunError) -> String {
    match problem {
        RunError::Time { source, .. } => source.to_string(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Silent;

    const CASE: &str = "title = \"still\"\ndimension = 2\n[flow]\nmach = 0.5\n[cloud]\nspacing = 0.25\n\
        domain = { min = [0.0, 0.0], max = [1.0, 1.0] }\n[time.explicit]\nuntil = 0.1\ncfl = 0.5\nmethod = \"ssprk3\"\n";

    fn write(root: &Path, name: &str, claims: &str) {
        let folder = root.join(name);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("case.toml"), CASE).unwrap();
        fs::write(folder.join("claim.toml"), claims).unwrap();
    }

    #[test]
    fn claims_are_judged_and_reasons_given() {
        let root = tempfile::tempdir().unwrap();
        let claim = |metric: &str, bound: f64| {
            format!("[[claim]]\nmetric = \"{metric}\"\nkind = \"at_most\"\nreference = {bound}\nsource = \"s\"\n")
        };
        let three = claim("free_stream_deviation", 1e-12) + &claim("particles", 1.0) + &claim("shock_upper", 1.0);
        write(root.path(), "a", &three);
        write(root.path(), "b", &format!("fast = true\n{}", claim("cp_max_difference", 1.0)));
        let mut walk = Walk::new(root.path(), &Selection { filter: Some("a".into()), fast: false }).unwrap();
        assert_eq!(walk.len(), 1);
        let rows = walk.judge(0, &mut Silent).unwrap();
        assert_eq!(rows.iter().map(|r| r.pass).collect::<Vec<_>>(), [true, false, false], "{rows:?}");
        assert!(rows[2].value.is_nan() && rows[2].source.starts_with("no value: "), "{rows:?}");
        let mut fast = Walk::new(root.path(), &Selection { filter: None, fast: true }).unwrap();
        assert_eq!(fast.cases().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["b"]);
        assert!(!fast.judge(0, &mut Silent).unwrap()[0].pass);
    }

    /// Slow flow about a sphere: Cp = 1 − 9/4 sin²θ, with sin²θ = 4 (x/c) (1 − x/c) in the plane through its middle.
    #[test]
    fn sections_are_compared_where_their_reference_has_points() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("sphere");
        fs::create_dir_all(&folder).unwrap();
        let case = "[flow]\nmach = 0.1\n[[body]]\nsphere = { radius = 0.5 }\n[cloud]\nspacing = 0.125\n\
                    curvature_levels = 0\nfar_field = 4\n[time.steady]\norders = 3\n";
        fs::write(folder.join("case.toml"), case).unwrap();
        let parts = [0.05, 0.2, 0.35, 0.5];
        let rows = ["upper", "lower"]
            .iter()
            .flat_map(|side| parts.map(|x| format!("0,{side},{x},{}\n", 1.0 - 9.0 * x * (1.0 - x))));
        fs::write(folder.join("cp.csv"), format!("y,surface,x_c,Cp\n{}", rows.collect::<String>())).unwrap();
        let claim = |more: &str| {
            format!(
                "[[claim]]\nmetric = \"section_cp_rms\"\nfile = \"cp.csv\"\nkind = \"at_most\"\nreference = 0.1\nsource = \"s\"\n{more}"
            )
        };
        let outside = "region = { min = [-1, 2], max = [1, 3] }\n";
        fs::write(folder.join("claim.toml"), claim("") + &claim(outside)).unwrap();
        let rows = Walk::new(root.path(), &Selection::default()).unwrap().judge(0, &mut Silent).unwrap();
        assert!(rows[0].pass && rows[0].value > 0.0, "{rows:?}");
        assert!(rows[1].value.is_nan(), "{rows:?}");
    }

    #[test]
    fn bad_folders_end_the_walk_before_it_begins() {
        let root = tempfile::tempdir().unwrap();
        assert!(matches!(
            Walk::new(&root.path().join("none"), &Selection::default()),
            Err(WalkError::Unreadable { .. })
        ));
        assert!(matches!(Walk::new(root.path(), &Selection::default()), Err(WalkError::NoCase { .. })));
        write(root.path(), "a", "");
        assert!(matches!(Walk::new(root.path(), &Selection::default()), Err(WalkError::Mistakes { .. })));
    }
}
