//! `alula flutter`.
use std::path::{Path, PathBuf};

use alula::case::Matching;
use alula::run::flutter::{Boundary, FlutterAt, FlutterRow, LimitCycle};
use alula::run::{self, Places, RunError};
use serde_json::json;

use super::run::{Shortfall, results};
use crate::arguments::{self, Verbosity};
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
    let places = Places { input, out: out.clone() };
    let found = match &args.forces {
        Some(file) => run::flutter::again(&case, &places, file, &mut watch).map(Some),
        None => run::flutter::flutter(&case, &places, &mut watch),
    };
    tell(found, &out, &mut watch, args.verbosity)
}

/// Goes on with the boundary in the folder `out`.
pub(crate) fn resume(out: &Path, verbosity: Verbosity) -> Outcome {
    let mut watch = Watch::new(verbosity);
    let found = run::flutter::resume(out, &mut watch);
    tell(found, out, &mut watch, verbosity)
}

/// What was found in the folder `out`.
fn tell(found: Result<Option<Boundary>, RunError>, out: &Path, watch: &mut Watch, verbosity: Verbosity) -> Outcome {
    watch.progress().finish();
    let boundary = match found {
        Ok(Some(boundary)) => boundary,
        Ok(None) => {
            let out = out.display();
            output::note(&format!(
                "interrupted: Mach numbers that were finished stand in `flutter.csv`; go on with `alula resume {out}`"
            ));
            return Outcome::Interrupted;
        }
        Err(problem) => return super::refuse(&problem),
    };
    let found = match verbosity.json {
        true => {
            let event =
                json!({ "run": out, "title": boundary.title, "flutter": boundary.flutter, "lco": boundary.lco });
            output::event_line("summary", event) + "\n"
        }
        false => {
            table(&boundary)
                + &cycles(&boundary)
                + &format!("tables: {} and v-g.csv\n", out.join("flutter.csv").display())
                + &page(out)
        }
    };
    results(&found, shortfall(&boundary), verbosity)
}

/// Where the page is, where there is one.
fn page(out: &Path) -> String {
    let page = out.join("report.html");
    if page.is_file() { format!("report: {}\n", page.display()) } else { String::new() }
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
    let matched = boundary.flutter.iter().any(|at| at.matching != Matching::None);
    let more = if matched { "     density  dynamic pressure  mass ratio  altitude" } else { "" };
    let mut text = format!(
        "    Mach  what          mode   V/V_ref  speed index        k  frequency  over pitch     error     cloud  g-method{more}\n"
    );
    for at in &boundary.flutter {
        if at.crossings.is_empty() {
            let end = match at.matching {
                Matching::None => "up to the greatest speed looked at",
                Matching::Density => "up to the greatest density looked at",
                Matching::Altitude => "at any altitude",
            };
            text.push_str(&format!("{:>8}  nothing begins to grow {end}\n", at.mach));
        }
        text.push_str(&rows(at));
    }
    if let Some(file) = boundary.flutter.iter().find_map(|at| at.read.as_ref()) {
        let note = "errors are changes when the nearest of them are left out, crossings cannot refine them";
        return text + &format!("forces read from {file}: {note}\n");
    }
    let cpu: f64 = boundary.flutter.iter().map(|at| at.cpu_seconds).sum();
    text + &format!("{cpu:.1} s of processor time\n")
}

fn rows(at: &FlutterAt) -> String {
    let optional = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.4}"));
    let matched = |c: &FlutterRow| match at.matching {
        Matching::None => String::new(),
        _ => format!(
            "  {:>10.4}  {:>16.5e}  {:>10}  {:>8}",
            c.density,
            c.dynamic_pressure,
            optional(c.mass_ratio),
            c.altitude.map_or_else(|| "-".to_owned(), |z| format!("{z:.0} m"))
        ),
    };
    let row = |c: &FlutterRow| {
        format!(
            "{:>8}  {:<12} {:>5}  {:>8.4}  {:>11}  {:>7.4}  {:>9.4}  {:>10}  {:>6.2} %  {:>8}  {:>8}{}{}\n",
            at.mach,
            c.kind,
            c.mode,
            c.speed_ratio,
            optional(c.speed_index),
            c.reduced_frequency,
            c.frequency,
            optional(c.frequency_ratio),
            100.0 * c.error,
            c.cloud_error.map_or_else(|| "-".to_owned(), |e| format!("{:.2} %", 100.0 * e)),
            c.g_method.map_or_else(|| "-".to_owned(), |g| format!("{g:+.0e}")),
            matched(c),
            if c.extrapolated { "  beyond the frequencies computed" } else { "" }
        )
    };
    at.crossings.iter().map(row).collect()
}

/// All limit cycles, for people.
fn cycles(boundary: &Boundary) -> String {
    let Some(first) = boundary.lco.first() else { return String::new() };
    let optional = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.4}"));
    let head = format!(
        "limit cycles, amplitude of {}\n    Mach  branch  amplitude   V/V_ref  speed index        k  frequency            harmonics     error\n",
        first.coordinate
    );
    let is_matched = boundary.flutter.iter().any(|at| at.matching != Matching::None);
    let matched = |c: &LimitCycle| {
        let altitude = c.altitude.map_or_else(String::new, |z| format!(", {z:.0} m"));
        format!("  density {:.4}, dynamic pressure {:.5e}{altitude}", c.density, c.dynamic_pressure)
    };
    let row = |c: &LimitCycle| {
        format!(
            "{:>8}  {:>6}  {:>9.4}  {:>8.4}  {:>11}  {:>7.4}  {:>9.4}  {:<8}  {:>9}  {:>6.2} %{}{}\n",
            c.mach,
            c.branch,
            c.amplitude,
            c.speed_ratio,
            optional(c.speed_index),
            c.reduced_frequency,
            c.frequency,
            if c.stable { "stable" } else { "unstable" },
            c.harmonics,
            100.0 * c.error,
            if is_matched { matched(c) } else { String::new() },
            if c.extrapolated { "  beyond the frequencies computed" } else { "" }
        )
    };
    let marched = |c: &LimitCycle| {
        let m = c.march.as_ref()?;
        Some(format!(
            "marched from {:.4}: amplitude {:.4} ({:+.2} %), frequency {:.4} ({:+.2} %) after {:.1} periods, the last of which changed it by \
             {:.2} %; {:.1} s of processor time\n",
            c.amplitude,
            m.amplitude,
            100.0 * m.difference,
            m.frequency,
            100.0 * (m.frequency / c.frequency - 1.0),
            m.periods,
            100.0 * m.change,
            m.cpu_seconds
        ))
    };
    let rows = boundary.lco.iter().map(row).chain(boundary.lco.iter().filter_map(marched));
    rows.fold(head, |text, row| text + &row)
}
