//! `flutter.json` and `v-g.csv` of a folder, as the page and its charts read them.
use super::super::files::{Csv, RunFolder};
use crate::case::Matching;
use crate::record::flutter::tables::{HISTORY, HISTORY_COLUMNS, motion_of};
use crate::record::flutter::{Boundary, FlutterAt, FlutterRow, MotionRow};

/// The boundary of a run.
const SUMMARY: &str = "flutter.json";

/// The boundary in a folder with the motions of its table, or why it cannot be read.
pub(super) fn read(run: &RunFolder) -> Result<Boundary, String> {
    let mut found: Boundary =
        serde_json::from_value(run.json(SUMMARY)?).map_err(|e| format!("`{SUMMARY}` has no flutter: {e}"))?;
    let motions = run.table(HISTORY).map(|table| motions(&table)).unwrap_or_default();
    for (mach, motion) in motions {
        found.flutter.iter_mut().filter(|at| at.mach == mach).for_each(|at| at.motions.push(motion.clone()));
    }
    Ok(found)
}

/// Motions at a Mach number, branch by branch.
pub(super) fn branches(at: &FlutterAt) -> Vec<(&str, Vec<&MotionRow>)> {
    let mut all: Vec<(&str, Vec<&MotionRow>)> = Vec::new();
    for motion in &at.motions {
        match all.iter_mut().find(|(name, _)| *name == motion.branch) {
            Some((_, own)) => own.push(motion),
            None => all.push((&motion.branch, vec![motion])),
        }
    }
    all
}

/// What begins to grow first, or what else happens first.
pub(super) fn first(at: &FlutterAt) -> Option<&FlutterRow> {
    at.crossings.iter().find(|c| c.kind == "flutter").or(at.crossings.first())
}

/// Name of what is varied, for axes.
pub(super) fn varied(at: &FlutterAt) -> &'static str {
    match (at.matching, at.dimensional) {
        (Matching::Density, true) => "dynamic pressure, Pa",
        (Matching::Density, false) => "density",
        (Matching::Altitude, _) => "EAS, m/s",
        (Matching::None, true) => "TAS, m/s",
        _ if at.reference.speed_index.is_some() => "speed index",
        _ => "speed over that of the case",
    }
}

/// Place of a motion on that axis.
pub(super) fn place(at: &FlutterAt, motion: &MotionRow) -> f64 {
    match (at.matching, at.dimensional) {
        (Matching::Density, true) => motion.dynamic_pressure,
        (Matching::Density, false) => motion.density,
        (Matching::Altitude, _) => motion.equivalent_airspeed.unwrap_or(f64::NAN),
        (Matching::None, true) => motion.speed,
        _ => motion.speed_ratio * at.reference.speed_index.unwrap_or(1.0),
    }
}

/// Place of a crossing on that axis.
pub(super) fn place_of(at: &FlutterAt, crossing: &FlutterRow) -> f64 {
    match (at.matching, at.dimensional) {
        (Matching::Density, true) => crossing.dynamic_pressure,
        (Matching::Density, false) => crossing.density,
        (Matching::Altitude, _) => crossing.equivalent_airspeed.unwrap_or(f64::NAN),
        (Matching::None, true) => crossing.speed,
        _ => crossing.speed_ratio * at.reference.speed_index.unwrap_or(1.0),
    }
}

/// Rows of the table of motions, each with its Mach number.
fn motions(table: &Csv) -> Vec<(f64, MotionRow)> {
    let columns = HISTORY_COLUMNS.map(|name| table.numbers(name).unwrap_or_default());
    let branches = table.column("branch").unwrap_or_default();
    let row = |k: usize| columns.each_ref().map(|column| column.get(k).copied().unwrap_or(f64::NAN));
    (0..table.rows.len()).map(|k| motion_of(row(k), branches.get(k).copied())).collect()
}
