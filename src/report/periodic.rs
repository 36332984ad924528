//! The chapter on motion: loads in time, loops against the motion, harmonics, and the film strip of the last period.
use serde_json::Value;

use super::chart::{Axis, Chart, Marks, Series};
use super::files::{RunFolder, Table};
use super::sections::{chart_html, figure, number, table_html};

/// What the pictures of the film strip begin with.
pub(super) const FILM: &str = "film";
/// Smallest part of a motion, in degrees or lengths, that a loop is drawn against.
const STILL: f64 = 1e-12;
/// Harmonics in the table.
const SHOWN: usize = 3;
/// Loads: column, name.
const LOADS: [(&str, &str); 3] = [("cl", "CL"), ("cd", "CD"), ("cm", "CM")];

/// Nothing for a run in which nothing marched.
pub(super) fn motion(run: &RunFolder) -> String {
    let mut html = run.table("history.csv").map(|t| in_time(&t)).unwrap_or_default();
    html.push_str(&strip(run));
    if let Ok(table) = run.table("loops.csv") {
        html.push_str(&loops(&table, run.table("instances.csv").ok().as_ref()));
    }
    if let Ok(harmonics) = run.json("harmonics.json") {
        html.push_str(&harmonics_table(&harmonics));
    }
    html
}

fn in_time(history: &Table) -> String {
    let Some(time) = history.numbers("time") else { return String::new() };
    let kept: Vec<usize> = (0..time.len()).filter(|k| time[*k] > 0.0).collect();
    if kept.len() < 2 {
        return String::new();
    }
    let pick =
        |values: Vec<f64>| -> Vec<f64> { kept.iter().map(|k| values.get(*k).copied().unwrap_or(f64::NAN)).collect() };
    let x = pick(time);
    let curve = |(column, name): (&str, &str)| {
        let y = pick(history.numbers(column)?);
        Some(Series { name: name.to_owned(), marks: Marks::Line, x: x.clone(), y })
    };
    let series: Vec<Series> = LOADS.into_iter().filter_map(curve).collect();
    let y = Axis::linear("coefficient");
    chart_html(&Chart { title: "Loads in time".into(), x: Axis::linear("time"), y, series })
}

/// Pictures of one period, one beside the other.
fn strip(run: &RunFolder) -> String {
    let frames: String = run
        .pictures()
        .iter()
        .filter(|(name, _)| name.starts_with(FILM))
        .map(|(name, bytes)| figure(name, bytes))
        .collect();
    match frames.is_empty() {
        true => String::new(),
        false => format!("<h3>Last period</h3>\n<div class=\"pictures\">\n{frames}</div>\n"),
    }
}

fn loops(table: &Table, instances: Option<&Table>) -> String {
    let moved = |values: &Vec<f64>| values.iter().any(|v| v.abs() > STILL);
    let angle = table.numbers("angle_deg").filter(moved).map(|x| (x, "angle_deg", "angle, degrees"));
    let motion = angle.or_else(|| table.numbers("shift").filter(moved).map(|x| (x, "shift", "displacement")));
    let Some((mut x, moves, label)) = motion else { return String::new() };
    // the last point is followed by the first
    x.extend(x.first().copied());
    let one = |(column, name): (&str, &str)| {
        let mut y = table.numbers(column)?;
        y.extend(y.first().copied());
        let mut series = vec![Series { name: name.to_owned(), marks: Marks::Line, x: x.clone(), y }];
        if let Some((x, y)) = instances.and_then(|t| t.numbers(moves).zip(t.numbers(column))) {
            series.push(Series { name: "instances".to_owned(), marks: Marks::Dots, x, y });
        }
        let chart =
            Chart { title: format!("{name} over one period"), x: Axis::linear(label), y: Axis::linear(name), series };
        Some(chart_html(&chart))
    };
    LOADS.into_iter().filter_map(one).collect()
}

fn harmonics_table(all: &Value) -> String {
    let mut columns = vec!["load".to_owned(), "mean".to_owned()];
    columns.extend((1..=SHOWN).map(|k| format!("|harmonic {k}|")));
    columns.extend(["over the motion".to_owned(), "ahead of it, degrees".to_owned()]);
    let names: Vec<&str> = columns.iter().map(String::as_str).collect();
    let value = |v: &Value| v.as_f64().map_or_else(|| "–".to_owned(), number);
    let row = |(key, name): (&str, &str)| {
        let load = &all["loads"][key];
        let first = &all["about_motion"][0]["loads_per_motion"][key];
        let mut row = vec![name.to_owned(), value(&load["mean"])];
        row.extend((0..SHOWN).map(|k| value(&load["harmonics"][k]["abs"])));
        row.extend([value(&first["amplitude"]), value(&first["phase_deg"])]);
        row
    };
    format!("<h3>Harmonics</h3>\n{}", table_html(&names, LOADS.into_iter().map(row)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_period_becomes_loops_harmonics_and_a_strip() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("pictures")).unwrap();
        std::fs::write(at("pictures/film-1.png"), b"png").unwrap();
        std::fs::write(at("history.csv"), "time,cl,cd,cm\n0,9,9,9\n1,1,2,3\n2,2,3,4\n").unwrap();
        std::fs::write(at("loops.csv"), "phase,angle_deg,shift,cl,cd,cm\n0,0,0,1,2,3\n0.5,1,0,2,3,4\n").unwrap();
        std::fs::write(at("harmonics.json"), r#"{"loads":{"cl":{"mean":0.5,"harmonics":[{"abs":0.25}]}}}"#).unwrap();
        let page = motion(&RunFolder::new(folder.path()));
        for part in ["Loads in time", "CL over one period", "angle, degrees", "Last period", "Harmonics", "0.25"] {
            assert!(page.contains(part), "{part}: {page}");
        }
        assert!(!page.contains("displacement"));
    }

    #[test]
    fn a_steady_run_has_no_such_chapter() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("history.csv"), "time,cl\n0,1\n0,2\n").unwrap();
        assert!(motion(&RunFolder::new(folder.path())).is_empty());
    }
}
