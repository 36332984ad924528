//! `alula verify`.
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use alula::claims::{Claim, ClaimRow};
use alula::report::write_verification_page;
use alula::run::Monitor;
use alula::verification::{
    Folder, Keep, QUICK, Selection, Spent, TimeTaken, Walk, WalkError, build_of_this_program, find, times,
};
use serde_json::{Value, json};

use crate::arguments::{self, Verbosity};
use crate::outcome::Outcome;
use crate::output;
use crate::watch::Watch;

/// The page with all claims.
const PAGE: &str = "runs/verification.html";

/// Runs the cases of `verification/` and judges their claims.
pub(crate) fn verify(args: &arguments::Verify) -> Outcome {
    match begin(args) {
        Ok(walk) if args.list => list(&walk, args),
        Ok(walk) => judge(walk, args),
        Err(problem) => refuse(&problem.to_string()),
    }
}

fn begin(args: &arguments::Verify) -> Result<Walk, WalkError> {
    let root = match &args.folder {
        Some(folder) => folder.clone(),
        None => find(&std::env::current_dir().unwrap_or_else(|_| PathBuf::from(".")))?,
    };
    Walk::new(&root, &Selection { filters: args.filters.clone(), within: args.fast.then_some(QUICK) })
}

fn judge(mut walk: Walk, args: &arguments::Verify) -> Outcome {
    let build = build_of_this_program();
    match build.clone().map(|build| Keep { folder: args.keep.clone(), build, again: args.again }) {
        Some(keep) => {
            if let Err(problem) = walk.keep(keep) {
                return refuse(&problem.to_string());
            }
        }
        None => output::message("warning: nothing is kept: the system does not tell which file this program is"),
    }
    let keep = build.is_some().then(|| args.keep.clone());
    let leave = move || interrupted(keep.as_deref());
    let mut watch = Watch::new(Verbosity { json: false, quiet: false }).with_farewell(leave.clone());
    let mut rows = Vec::new();
    let mut cpu_seconds = 0.0;
    for k in 0..walk.len() {
        let Some(judged) = walk.judge(k, &mut watch) else {
            watch.progress().finish();
            leave();
            return Outcome::Interrupted;
        };
        let spent: Vec<Spent> = walk.spent().cloned().collect();
        cpu_seconds += spent.iter().map(|s| s.cpu_seconds).sum::<f64>();
        if let Some(folder) = walk.cases().nth(k).filter(|_| args.json) {
            judged.iter().map(claim).chain([case(folder, &judged, &spent)]).for_each(tell);
        }
        rows.extend(judged);
        let held = rows.iter().filter(|r| r.pass).count();
        watch.note(&format!("{} of {} cases judged, {held} of {} claims hold", k + 1, walk.len(), rows.len()));
    }
    watch.progress().finish();
    let held = rows.iter().filter(|r| r.pass).count();
    if args.json {
        let (version, cases) = (env!("CARGO_PKG_VERSION"), walk.len());
        tell(json!({
            "event": "verification", "version": version, "build": build, "cases": cases, "claims": rows.len(), "held": held,
            "cpu_seconds": cpu_seconds,
        }));
    } else {
        output::data(&table(&rows));
    }
    if let Err(problem) = write_page(&rows, Path::new(PAGE)) {
        return refuse(&problem);
    }
    if held == rows.len() { Outcome::Done } else { Outcome::Failed }
}

fn refuse(problem: &str) -> Outcome {
    let (what, hint) = problem.split_once("\nhint: ").unwrap_or((problem, "see `verification/README.md`"));
    output::error(what, hint);
    Outcome::BadInput
}

fn tell(event: Value) {
    output::data(&format!("{event}\n"));
}

/// One claim as one JSON object.
fn claim(row: &ClaimRow) -> Value {
    json!({
        "event": "claim", "case": row.case, "metric": row.metric, "name": row.name, "label": row.label, "kind": row.kind,
        "value": row.value, "runs": row.runs, "scatter": row.scatter, "reference": row.reference, "error": row.error,
        "tolerance": row.tolerance, "pass": row.pass, "source": row.source,
    })
}

/// A case that was judged as one JSON object, with what it needed.
fn case(folder: &Folder, rows: &[ClaimRow], spent: &[Spent]) -> Value {
    let sum = |seconds: fn(&Spent) -> f64| spent.iter().map(seconds).sum::<f64>();
    let run = |s: &Spent| {
        json!({
            "name": s.name, "spacing": s.spacing, "particles": s.particles, "iterations": s.iterations,
            "cpu_seconds": s.cpu_seconds, "wall_seconds": s.wall_seconds, "kept": s.kept,
        })
    };
    json!({
        "event": "case", "case": folder.name, "title": folder.case.title, "claims": rows.len(),
        "held": rows.iter().filter(|r| r.pass).count(), "cpu_seconds": sum(|s| s.cpu_seconds),
        "wall_seconds": sum(|s| s.wall_seconds), "runs": spent.iter().map(run).collect::<Vec<_>>(),
    })
}

/// Prints the cases, the time that each took last or takes about, and what each claims.
fn list(walk: &Walk, args: &arguments::Verify) -> Outcome {
    let last = times(&args.keep);
    if args.json {
        walk.cases().map(|folder| listed(folder, last.get(&folder.name))).for_each(tell);
        return Outcome::Done;
    }
    output::data(&names(walk.cases(), &last))
}

/// A case that is listed as one JSON object.
fn listed(folder: &Folder, last: Option<&TimeTaken>) -> Value {
    let claim = |c: &Claim| {
        json!({
            "name": c.metric.name(), "label": c.label, "kind": c.kind.name(), "holds": c.kind.to_string(), "source": c.source,
        })
    };
    json!({
        "event": "listed", "case": folder.name, "title": folder.case.title,
        "expected_cpu_seconds": folder.claims.cpu_seconds, "cpu_seconds": last.map(|t| t.cpu_seconds),
        "wall_seconds": last.map(|t| t.wall_seconds), "build": last.map(|t| &t.build),
        "claims": folder.claims.claims.iter().map(claim).collect::<Vec<_>>(),
    })
}

/// A line for each case and each claim, and the sum of the times.
fn names<'a>(cases: impl Iterator<Item = &'a Folder>, last: &BTreeMap<String, TimeTaken>) -> String {
    let (mut text, mut count, mut sum, mut unknown) = (String::new(), 0, 0.0, 0);
    for folder in cases {
        let measured = last.get(&folder.name).map(|t| t.cpu_seconds);
        let time = match (measured, folder.claims.cpu_seconds) {
            (Some(seconds), _) => format!("{} of processor time, last", duration(seconds)),
            (None, Some(seconds)) => format!("about {} of processor time", duration(seconds)),
            (None, None) => "time not known".to_owned(),
        };
        text += &format!("{}  {time}\n", folder.name);
        for claim in &folder.claims.claims {
            text += &format!("    {}: {}\n", claim.title(None), claim.kind);
        }
        count += 1;
        match measured.or(folder.claims.cpu_seconds) {
            Some(seconds) => sum += seconds,
            None => unknown += 1,
        }
    }
    let beside = if unknown > 0 { format!(", and {unknown} of unknown time") } else { String::new() };
    text + &format!("{} of {count} cases take {} of processor time{beside}\n", count - unknown, duration(sum))
}

/// Seconds as people say them.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// An aligned table and its sum.
fn table(rows: &[ClaimRow]) -> String {
    let widest = |f: fn(&ClaimRow) -> &str| rows.iter().map(|r| f(r).chars().count()).max().unwrap_or(0);
    let (case, metric) = (widest(|r| &r.case).max(4), widest(|r| &r.metric).max(6));
    let mut text = format!(
        "{:4}  {:case$}  {:metric$}  {:>12}  {:>12}  {:>10}  {:>9}  source\n",
        "", "case", "metric", "value", "reference", "error", "tolerance"
    );
    for r in rows {
        let verdict = if r.pass { "pass" } else { "FAIL" };
        text += &format!(
            "{verdict}  {:case$}  {:metric$}  {:>12}  {:>12}  {:>10}  {:>9}  {}\n",
            r.case,
            r.metric,
            number(r.value),
            number(r.reference),
            number(r.error),
            number(r.tolerance),
            r.source
        );
    }
    let held = rows.iter().filter(|r| r.pass).count();
    text + &format!("{held} of {} claims hold\npage: {PAGE}\n", rows.len())
}

/// Five significant digits, with an exponent only where the number needs it.
fn number(v: f64) -> String {
    if !v.is_finite() {
        return "-".into();
    }
    if v == 0.0 || v.fract() == 0.0 && v.abs() < 1e7 {
        return format!("{v:.0}");
    }
    if v.abs() >= 1e-3 && v.abs() < 1e6 {
        let digits = (4 - v.abs().log10().floor() as i32).clamp(0, 6) as usize;
        return format!("{v:.digits$}");
    }
    format!("{v:.3e}")
}

fn write_page(rows: &[ClaimRow], path: &Path) -> Result<(), String> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .map_err(|e| format!("cannot make `{}`: {e}\nhint: work in a folder you can write to", folder.display()))?;
    }
    write_verification_page(rows, path).map_err(|e| e.to_string())
}

/// Says how to go on with a walk that was told to stop, where something is kept.
fn interrupted(keep: Option<&Path>) {
    if let Some(keep) = keep {
        output::message(&format!("interrupted; the same command goes on with what `{}` keeps", keep.display()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(value: f64, pass: bool) -> ClaimRow {
        ClaimRow {
            case: "sod".into(),
            metric: "mass_drift (all)".into(),
            name: "mass_drift",
            label: Some("all".into()),
            kind: "at_most",
            runs: 1,
            scatter: 0.0,
            value,
            reference: 1e-11,
            error: value - 1e-11,
            tolerance: 0.0,
            pass,
            source: "Toro (2009)".into(),
        }
    }

    #[test]
    fn rows_are_lines_of_json() {
        let parsed: Value = serde_json::from_str(&claim(&row(2e-12, true)).to_string()).unwrap();
        let (first, _) = parsed.as_object().unwrap().iter().next().unwrap();
        assert_eq!(first, "event");
        assert_eq!(
            (&parsed["name"], &parsed["label"], &parsed["kind"]),
            (&json!("mass_drift"), &json!("all"), &json!("at_most"))
        );
        assert!(claim(&row(f64::NAN, false))["value"].is_null());
    }

    #[test]
    fn durations_have_the_unit_that_reads_well() {
        assert_eq!([0.25, 59.6, 600.0, 9000.0].map(duration), ["0.2 s", "60 s", "10 min", "2.5 h"]);
    }

    #[test]
    fn columns_are_aligned() {
        let text = table(&[row(2e-12, true), row(f64::NAN, false)]);
        let at = |line: &str| line.find("source").or_else(|| line.find("Toro"));
        let columns: Vec<_> = text.lines().take(3).map(at).collect();
        assert!(columns.iter().all(|c| *c == columns[0] && c.is_some()), "{text}");
        assert!(text.contains("1 of 2 claims hold"));
        assert_eq!(
            [0.28451, 0.0, 25000.0, 39.31393, 1e-11].map(number),
            ["0.28451", "0", "25000", "39.314", "1.000e-11"]
        );
    }
}
