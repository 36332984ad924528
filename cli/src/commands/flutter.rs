//! `alula flutter`.
use std::path::{Path, PathBuf};

use alula::run::flutter::{Boundary, FlutterAt};
use alula::run::{self, Places};
use serde_json::json;

use super::run::{Shortfall, results};
use crate::arguments;
use crate::outcome::Outcome;
use crate::output;
use crate::watch::Watch;

/// Seeks the flutter boundary.
pub(crate) fn flutter(args: &arguments::Flutter) -> Outcome {
    let case = match super::load(&args.case) {
        Ok(case) => case,
        Err(outcome) => return outcome,
    };
    let name = args.case.file_stem().map_or_else(|| "flutter".to_owned(), |n| n.to_string_lossy().into_owned());
    let out = args.out.clone().unwrap_or_else(|| run::fresh_folder(Path::new("runs"), &format!("{name}-flutter")));
    let input = args.case.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    let mut watch = Watch::new(args.verbosity);
    let found = run::flutter::flutter(&case, &Places { input, out: out.clone() }, &mut watch);
    watch.progress().finish();
    let boundary = match found {
        Ok(Some(boundary)) => boundary,
        Ok(None) => {
            output::note(
                "interrupted: Mach numbers that were finished stand in `flutter.csv`; `alula flutter` begins again",
            );
            return Outcome::Interrupted;
        }
        Err(problem) => return super::refuse(&problem),
    };
    let found = match args.verbosity.json {
        true => {
            let event = json!({ "run": out, "title": boundary.title, "flutter": boundary.flutter, "lco": [] });
            output::event_line("summary", event) + "\n"
        }
        false => table(&boundary) + &format!("tables: {} and v-g.csv\n", out.join("flutter.csv").display()),
    };
    results(&found, shortfall(&boundary), args.verbosity)
}

/// The first Mach number whose result is doubtful.
fn shortfall(boundary: &Boundary) -> Option<Shortfall> {
    let (at, what) = boundary.flutter.iter().find_map(|at| at.warnings.first().map(|w| (at, w)))?;
    Some(Shortfall {
        what: format!("Mach {}: {what}", at.mach),
        hint: "see `flutter.json`, `frequencies` of `[flutter]` and `orders` of `[time.steady]`".into(),
    })
}

/// All crossings, for people.
fn table(boundary: &Boundary) -> String {
    let mut text =
        String::from("    Mach  what          mode   V/V_ref  speed index        k  frequency  over pitch     error\n");
    for at in &boundary.flutter {
        if at.crossings.is_empty() {
            text.push_str(&format!("{:>8}  nothing begins to grow up to the greatest speed looked at\n", at.mach));
        }
        text.push_str(&rows(at));
    }
    let cpu: f64 = boundary.flutter.iter().map(|at| at.cpu_seconds).sum();
    text + &format!("{cpu:.1} s of processor time\n")
}

fn rows(at: &FlutterAt) -> String {
    let optional = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.4}"));
    let row = |c: &alula::run::flutter::FlutterRow| {
        format!(
            "{:>8}  {:<12} {:>5}  {:>8.4}  {:>11}  {:>7.4}  {:>9.4}  {:>10}  {:>6.2} %{}\n",
            at.mach,
            c.kind,
            c.mode,
            c.speed_ratio,
            optional(c.speed_index),
            c.reduced_frequency,
            c.frequency,
            optional(c.frequency_ratio),
            100.0 * c.error,
            if c.extrapolated { "  beyond the frequencies computed" } else { "" }
        )
    };
    at.crossings.iter().map(row).collect()
}
