//! `alula verify`.
use std::path::{Path, PathBuf};

use alula::report::write_verification_page;
use alula::run::Monitor;
use alula::run::verify::{Selection, Walk, WalkError, find};
use alula::verify::ClaimRow;
use serde_json::json;

use crate::arguments::{self, Verbosity};
use crate::outcome::Outcome;
use crate::output;
use crate::watch::Watch;

/// The page with all claims.
const PAGE: &str = "runs/verification.html";

/// Runs the cases of `verification/` and judges their claims.
pub(crate) fn verify(args: &arguments::Verify) -> Outcome {
    let mut walk = match begin(args) {
        Ok(walk) => walk,
        Err(problem) => return refuse(&problem.to_string()),
    };
    let mut watch = Watch::new(Verbosity { json: false, quiet: false });
    let mut rows = Vec::new();
    for k in 0..walk.len() {
        let Some(judged) = walk.judge(k, &mut watch) else {
            watch.progress().finish();
            return Outcome::Interrupted;
        };
        if args.json {
            let lines: String = judged.iter().map(|r| line(r) + "\n").collect();
            output::data(&lines);
        }
        rows.extend(judged);
        let held = rows.iter().filter(|r| r.pass).count();
        watch.note(&format!("{} of {} cases judged, {held} of {} claims hold", k + 1, walk.len(), rows.len()));
    }
    watch.progress().finish();
    if !args.json {
        output::data(&table(&rows));
    }
    if let Err(problem) = write_page(&rows, Path::new(PAGE)) {
        return refuse(&problem);
    }
    if rows.iter().all(|r| r.pass) { Outcome::Done } else { Outcome::Failed }
}

fn begin(args: &arguments::Verify) -> Result<Walk, WalkError> {
    let root = match &args.folder {
        Some(folder) => folder.clone(),
        None => find(&std::env::current_dir().unwrap_or_else(|_| PathBuf::from(".")))?,
    };
    Walk::new(&root, &Selection { filter: args.filter.clone(), fast: args.fast })
}

fn refuse(problem: &str) -> Outcome {
    let (what, hint) = problem.split_once("\nhint: ").unwrap_or((problem, "see `verification/README.md`"));
    output::error(what, hint);
    Outcome::BadInput
}

/// One claim as one JSON object.
fn line(row: &ClaimRow) -> String {
    json!({
        "event": "claim", "case": row.case, "metric": row.metric, "value": row.value, "reference": row.reference,
        "error": row.error, "tolerance": row.tolerance, "pass": row.pass, "source": row.source,
    })
    .to_string()
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

#[cfg(test)]
mod tests {
    use super::*;

    fn row(value: f64, pass: bool) -> ClaimRow {
        ClaimRow {
            case: "sod".into(),
            metric: "mass_drift".into(),
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
        let parsed: serde_json::Value = serde_json::from_str(&line(&row(2e-12, true))).unwrap();
        let names: Vec<&str> = parsed.as_object().unwrap().keys().map(String::as_str).collect();
        let mut expected =
            vec!["event", "case", "metric", "value", "reference", "error", "tolerance", "pass", "source"];
        let mut names = names;
        expected.sort_unstable();
        names.sort_unstable();
        assert_eq!(names, expected);
        assert!(serde_json::from_str::<serde_json::Value>(&line(&row(f64::NAN, false))).unwrap()["value"].is_null());
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
