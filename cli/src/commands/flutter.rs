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
    let out = args.out.clone().unwrap_or_else(|| super::default_folder(&format!("{name}-flutter"), args.force));
    let input = args.case.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    let places = Places { input, out: out.clone() };
    let mut forces = args.forces.clone();
    if args.force {
        let inside = forces.as_ref().and_then(|file| place_within(file, &out));
        let kept = run::flutter::set_aside(&case, &places, forces.as_deref());
        match super::tell_kept(kept, &out, args.verbosity.quiet) {
            // the file may be one of the earlier results
            Ok(kept) => forces = kept.zip(inside).map(|(kept, inside)| kept.join(inside)).or(forces),
            Err(outcome) => return outcome,
        }
    }
    let mut watch = watched(&out, args.verbosity);
    let found = match &forces {
        Some(file) => run::flutter::again(&case, &places, file, &mut watch),
        None => run::flutter::flutter(&case, &places, &mut watch),
    };
    tell(found, &out, &mut watch, args.verbosity)
}

/// Where a file lies within a folder, if it does.
fn place_within(file: &Path, folder: &Path) -> Option<PathBuf> {
    let (file, folder) = (file.canonicalize().ok()?, folder.canonicalize().ok()?);
    file.strip_prefix(folder).ok().map(Path::to_path_buf)
}

/// Goes on with the boundary in the folder `out`.
pub(crate) fn resume(out: &Path, verbosity: Verbosity) -> Outcome {
    let mut watch = watched(out, verbosity);
    let found = run::flutter::resume(out, &mut watch);
    tell(found, out, &mut watch, verbosity)
}

/// A watch over the boundary in the folder `out`.
fn watched(out: &Path, verbosity: Verbosity) -> Watch {
    let folder = out.to_path_buf();
    Watch::new(verbosity).with_farewell(move || interrupted(&folder))
}

/// Says how to go on with a boundary that was told to stop.
fn interrupted(out: &Path) {
    let table = out.join("flutter.csv");
    let what = match table.is_file() {
        true => format!("interrupted: Mach numbers that were finished stand in `{}`", table.display()),
        false => "interrupted before the first Mach number was finished".to_owned(),
    };
    output::note(&format!("{what}; go on with `alula resume {}`", out.display()));
}

/// What was found in the folder `out`.
fn tell(found: Result<Option<Boundary>, RunError>, out: &Path, watch: &mut Watch, verbosity: Verbosity) -> Outcome {
    watch.progress().finish();
    let boundary = match found {
        Ok(Some(boundary)) => boundary,
        Ok(None) => {
            interrupted(out);
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
    let first = |at: &FlutterAt| Some((at.mach, at.warnings.first()?.clone(), at.remedies.first()?.clone()));
    let (mach, what, hint) = boundary.flutter.iter().find_map(first)?;
    Some(Shortfall { what: format!("Mach {mach}: {what}"), hint })
}

/// All crossings, for people.
fn table(boundary: &Boundary) -> String {
    let mut text = String::new();
    let empty = boundary.flutter.iter().filter(|at| at.crossings.is_empty());
    for at in empty {
        let end = match at.matching {
            Matching::None => "up to the greatest speed looked at",
            Matching::Density => "up to the greatest density looked at",
            Matching::Altitude => "at any altitude",
        };
        text.push_str(&format!("{:>8}  nothing begins to grow {end}\n", at.mach));
    }
    let rows: Vec<Vec<String>> = boundary.flutter.iter().flat_map(rows).collect();
    if let Some(at) = boundary.flutter.iter().find(|at| !at.crossings.is_empty()) {
        text.push_str(&aligned(&columns(at), &rows));
    }
    boundary.flutter.iter().filter_map(clearance).for_each(|line| text.push_str(&line));
    if let Some(file) = boundary.flutter.iter().find_map(|at| at.read.as_ref()) {
        let note = "errors are changes when the nearest of them are left out, crossings cannot refine them";
        return text + &format!("forces read from {file}: {note}\n");
    }
    let cpu: f64 = boundary.flutter.iter().map(|at| at.cpu_seconds).sum();
    text + &format!("{cpu:.1} s of processor time\n")
}

/// What columns are called: with units where the stream has them, else the reduced numbers of flutter.
fn columns(at: &FlutterAt) -> Vec<&'static str> {
    let mut all = vec!["Mach", "what", "branch"];
    match at.dimensional {
        true => all.extend(["TAS, m/s", "EAS, m/s", "density, kg/m3", "q, Pa", "altitude, m", "frequency, Hz"]),
        false => all.extend(["V/V_ref", "speed index", "V*", "density", "q", "mass ratio", "frequency", "over pitch"]),
    }
    all.extend(["k", "error", "cloud", "g-method", ""]);
    all
}

/// Every crossing; error bars are those of the numbers that vary, in their units.
fn rows(at: &FlutterAt) -> Vec<Vec<String>> {
    let is_matched = at.matching != Matching::None;
    let row = |c: &FlutterRow| {
        let bars = &c.bars;
        let mut row = vec![at.mach.to_string(), c.kind.clone(), c.branch.clone()];
        let known = |x: Option<f64>, bar: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| with_bar(x, bar));
        if at.dimensional {
            row.extend([
                with_bar(c.speed, bars.speed_error),
                known(c.equivalent_airspeed, bars.equivalent_airspeed_error),
                with_bar(c.density, bars.density_error),
                with_bar(c.dynamic_pressure, bars.dynamic_pressure_error),
                known(c.altitude, bars.altitude_error),
                format!("{:.4}", c.frequency),
            ]);
        } else {
            let matched = |x: Option<f64>, bar: Option<f64>| known(x.filter(|_| is_matched), bar);
            row.extend([
                with_bar(c.speed_ratio, bars.speed_ratio_error),
                known(c.speed_index, bars.speed_index_error),
                known(c.reduced_speed, bars.reduced_speed_error),
                matched(Some(c.density), bars.density_error),
                matched(Some(c.dynamic_pressure), bars.dynamic_pressure_error),
                matched(c.mass_ratio, None),
                format!("{:.4}", c.frequency),
                known(c.frequency_ratio, None),
            ]);
        }
        row.extend([
            format!("{:.4}", c.reduced_frequency),
            format!("{:.2} %", 100.0 * c.error),
            c.cloud_error.map_or_else(|| "-".to_owned(), |e| format!("{:.2} %", 100.0 * e)),
            c.g_method.map_or_else(|| "-".to_owned(), |g| format!("{g:+.0e}")),
            remark(c),
        ]);
        row
    };
    at.crossings.iter().map(row).collect()
}

/// What else there is to say of a crossing.
fn remark(c: &FlutterRow) -> String {
    let mut all = c.remarks.clone();
    if c.extrapolated {
        all.push("beyond the frequencies computed".to_owned());
    }
    all.join("; ")
}

/// What is left to the design speed.
fn clearance(at: &FlutterAt) -> Option<String> {
    let c = at.clearance.as_ref()?;
    let verdict = if c.passes { "pass" } else { "fail" };
    let margin = c.margin.map_or_else(|| "none found".to_owned(), |m| format!("{:+.1} %", 100.0 * m));
    Some(format!(
        "Mach {}: V_D {:.1} m/s EAS, margin {margin}; clearance of 15 % ({:.1} m/s): {verdict}, {}\n",
        at.mach, c.design_speed, c.required, c.reason
    ))
}

/// Half of an error bar that is told.
const LEAST_BAR: f64 = 1e-6;

/// A number and half its error bar, to two digits of the bar.
fn with_bar(value: f64, bar: Option<f64>) -> String {
    match bar.filter(|bar| bar.is_finite() && *bar >= LEAST_BAR) {
        Some(bar) => {
            let decimals = (1.0 - bar.log10().floor()).clamp(0.0, 6.0) as usize;
            format!("{value:.decimals$} ± {bar:.decimals$}")
        }
        None if value == 0.0 => "0".to_owned(),
        None => {
            let decimals = (4.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
            format!("{value:.decimals$}")
        }
    }
}

/// A table without columns in which nothing is told.
fn aligned(columns: &[&str], rows: &[Vec<String>]) -> String {
    let told = |k: &usize| rows.iter().any(|row| row[*k] != "-" && !row[*k].is_empty());
    let kept: Vec<usize> = (0..columns.len()).filter(told).collect();
    let length = |text: &str| text.chars().count();
    let width = |k: usize| rows.iter().map(|row| length(&row[k])).chain([length(columns[k])]).max().unwrap_or(0);
    let line = |cell: &dyn Fn(usize) -> String| {
        let cells = kept.iter().map(|k| {
            let (text, width) = (cell(*k), width(*k));
            // words are read from the left
            if *k == 1 || *k == 2 || *k + 1 == columns.len() {
                format!("{text:<width$}")
            } else {
                format!("{text:>width$}")
            }
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    let head = line(&|k| columns[k].to_owned());
    rows.iter().fold(head, |text, row| text + &line(&|k| row[k].clone()))
}

/// All limit cycles, for people.
fn cycles(boundary: &Boundary) -> String {
    let Some(first) = boundary.lco.first() else { return String::new() };
    let optional = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.4}"));
    let dimensional = boundary.flutter.iter().any(|at| at.dimensional);
    let head = format!(
        "limit cycles, amplitude of {}\n    Mach  branch  amplitude   V/V_ref  speed index        k  {}            harmonics     error\n",
        first.coordinate,
        if dimensional { "frequency, Hz" } else { "    frequency" }
    );
    let is_matched = boundary.flutter.iter().any(|at| at.matching != Matching::None);
    let matched = |c: &LimitCycle| {
        let altitude = c.altitude.map_or_else(String::new, |z| format!(", {z:.0} m"));
        match dimensional {
            true => format!(
                "  TAS {:.2} m/s, density {:.4} kg/m3, q {:.1} Pa{altitude}",
                c.speed, c.density, c.dynamic_pressure
            ),
            false => format!("  density {:.4}, dynamic pressure {:.5e}", c.density, c.dynamic_pressure),
        }
    };
    let row = |c: &LimitCycle| {
        format!(
            "{:>8}  {:>6}  {:>9.4}  {:>8.4}  {:>11}  {:>7.4}  {:>13.4}  {:<8}  {:>9}  {:>6.2} %{}{}\n",
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
            if is_matched || dimensional { matched(c) } else { String::new() },
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_bars_have_two_digits_in_the_unit_of_their_number() {
        assert_eq!(with_bar(109.0, Some(85.9)), "109 ± 86");
        assert_eq!(with_bar(170.2543, Some(0.8712)), "170.25 ± 0.87");
        assert_eq!((with_bar(0.0, Some(0.0)), with_bar(1.225, Some(0.0))), ("0".to_owned(), "1.2250".to_owned()));
        assert_eq!(with_bar(1234.5, None), "1234.5");
    }

    #[test]
    fn columns_stand_below_their_names_and_empty_ones_are_left_out() {
        let rows = vec![
            vec!["0.5".to_owned(), "flutter".into(), "mode 1".into(), "1.0 ± 0.1".into(), "-".into()],
            vec!["0.75".to_owned(), "divergence".into(), "divergence 1".into(), "2".into(), "-".into()],
        ];
        let text = aligned(&["Mach", "what", "branch", "TAS, m/s", "altitude, m"], &rows);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "Mach  what        branch         TAS, m/s");
        assert_eq!(lines[1], " 0.5  flutter     mode 1        1.0 ± 0.1");
        assert_eq!(lines[2], "0.75  divergence  divergence 1          2");
    }
}
