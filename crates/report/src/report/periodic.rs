//! The chapter on motion: loads in time, loops against the motion, harmonics, and the film strip of the last period.
use serde_json::Value;

use super::chart::{Axis, Chart, Marks, Series};
use super::files::{Csv, FILM, LOADS, Load, RunFolder};
use super::page::{Block, Table};
use super::sections::pictures_of;
use super::words::number_of;

/// Smallest part of a motion, in degrees or lengths, that a loop is drawn against.
const STILL: f64 = 1e-12;
/// Harmonics in the table.
const SHOWN: usize = 3;

/// One period of a run.
pub(super) struct Period {
    /// Name in legends.
    pub(super) name: String,
    /// Motion and loads at phases of the period.
    pub(super) loops: Csv,
    /// The same at the instances of a harmonic balance.
    pub(super) instances: Option<Csv>,
}

/// Nothing for a run in which nothing marched.
pub(super) fn motion(run: &RunFolder) -> Vec<Block> {
    let mut blocks: Vec<Block> = run.table("history.csv").ok().and_then(in_time).into_iter().collect();
    let film = pictures_of(run, |name| name.starts_with(FILM));
    blocks.extend(film.into_iter().flat_map(|strip| [Block::Heading("Last period".to_owned()), strip]));
    if let Ok(loops) = run.table("loops.csv") {
        let period = Period { name: String::new(), loops, instances: run.table("instances.csv").ok() };
        blocks.extend(loop_charts(&[period]).into_iter().map(|(_, chart)| Block::chart(chart)));
    }
    if let Ok(harmonics) = run.json("harmonics.json") {
        blocks.extend([Block::Heading("Harmonics".to_owned()), Block::Table(harmonics_table(&harmonics))]);
    }
    blocks
}

/// Loads of the rows that are later than the beginning.
fn in_time(mut history: Csv) -> Option<Block> {
    let time = history.numbers("time")?;
    let mut late = time.iter().map(|t| *t > 0.0);
    history.rows.retain(|_| late.next().unwrap_or(false));
    let (x, y) = (Axis::linear("time"), Axis::linear("coefficient"));
    let chart = Chart { title: "Loads in time".into(), x, y, series: history.loads("time") };
    (history.rows.len() > 1).then(|| Block::chart(chart))
}

/// Each load against the motion, for one run or more; nothing when the first one stands still.
pub(super) fn loop_charts(runs: &[Period]) -> Vec<(Load, Chart)> {
    let moved = |motion: &str| {
        let values = runs.first().and_then(|run| run.loops.numbers(motion));
        values.is_some_and(|values| values.iter().any(|v| v.abs() > STILL))
    };
    let motions = [("angle_deg", "angle, degrees"), ("shift", "displacement")];
    let Some((motion, label)) = motions.into_iter().find(|(motion, _)| moved(motion)) else { return Vec::new() };
    let one = |load: Load| {
        let name = |run: &Period| if runs.len() > 1 { run.name.clone() } else { load.name.to_owned() };
        let closed = |run: &Period| Some(run.loops.curve(motion, load.column, &name(run))?.closed());
        let lines = runs.iter().filter_map(closed).map(|s| Series { marks: Marks::Loop, ..s });
        let dots = runs.iter().filter_map(|run| run.instances.as_ref()?.curve(motion, load.column, "instances"));
        let series: Vec<Series> = lines.chain(dots.map(|s| Series { marks: Marks::Dots, ..s })).collect();
        let title = format!("{} over one period", load.name);
        (load, Chart { title, x: Axis::linear(label), y: Axis::linear(load.name), series })
    };
    LOADS.into_iter().map(one).filter(|(_, chart)| !chart.series.is_empty()).collect()
}

fn harmonics_table(all: &Value) -> Table {
    let harmonics: Vec<String> = (1..=SHOWN).map(|k| format!("|harmonic {k}|")).collect();
    let mut columns = vec!["load", "mean"];
    columns.extend(harmonics.iter().map(String::as_str));
    columns.extend(["over the motion", "ahead of it, degrees"]);
    let row = |load: &Load| {
        let own = &all["loads"][load.column];
        let first = &all["about_motion"][0]["loads_per_motion"][load.column];
        let mut values = vec![&own["mean"]];
        values.extend((0..SHOWN).map(|k| &own["harmonics"][k]["abs"]));
        values.extend([&first["amplitude"], &first["phase_deg"]]);
        std::iter::once(load.name.to_owned()).chain(values.into_iter().map(number_of)).collect()
    };
    Table::new(&columns, LOADS.iter().map(row))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::page::{Page, Section};

    #[test]
    fn a_period_becomes_loops_harmonics_and_a_strip() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("pictures")).unwrap();
        std::fs::write(at("pictures/film-1.png"), b"png").unwrap();
        std::fs::write(at("history.csv"), "time,cl,cd,cm\n0,9,9,9\n1,1,2,3\n2,2,3,4\n").unwrap();
        std::fs::write(at("loops.csv"), "phase,angle_deg,shift,cl,cd,cm\n0,0,0,1,2,3\n0.5,1,0,2,3,4\n").unwrap();
        std::fs::write(at("harmonics.json"), r#"{"loads":{"cl":{"mean":0.5,"harmonics":[{"abs":0.25}]}}}"#).unwrap();
        let section = Section::new("motion", "Motion", Ok(motion(&RunFolder::new(folder.path()))));
        let page = Page { sections: vec![section], ..Page::default() }.html().unwrap();
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
