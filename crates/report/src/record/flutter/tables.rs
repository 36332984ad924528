//! A flutter boundary as tables: `flutter.csv`, `v-g.csv`, `flutter-doubts.csv` and `lco.csv`.
use std::path::Path;

use super::{Boundary, Doubt, FlutterRow, MotionRow};
use crate::observe::columns::{self, Scale};
use crate::observe::table::{Entry, FileError, write_csv};

/// Names of the tables.
const CROSSINGS: &str = "flutter.csv";
/// Table of the motions.
pub const HISTORY: &str = "v-g.csv";
const DOUBTS: &str = "flutter-doubts.csv";
const CYCLES: &str = "lco.csv";

const CROSSING_COLUMNS: [&str; 30] = [
    "mach",
    "kind",
    "mode",
    "speed_ratio",
    "speed_index",
    "reduced_speed",
    "speed",
    "reduced_frequency",
    "frequency",
    "frequency_ratio",
    "error",
    "cloud_error",
    "g_method",
    "density",
    "dynamic_pressure",
    "mass_ratio",
    "altitude",
    "branch",
    "equivalent_airspeed",
    "speed_ratio_error",
    "speed_index_error",
    "reduced_speed_error",
    "speed_error",
    "equivalent_airspeed_error",
    "density_error",
    "dynamic_pressure_error",
    "altitude_error",
    "growth",
    "holding_damping",
    "margin",
];
const DOUBT_COLUMNS: [&str; 16] = [
    "mach",
    "branch",
    "kind",
    "damping_g",
    "damping_g_coarser",
    "speed_ratio",
    "speed_ratio_end",
    "speed",
    "speed_end",
    "equivalent_airspeed",
    "equivalent_airspeed_end",
    "dynamic_pressure",
    "dynamic_pressure_end",
    "altitude",
    "altitude_end",
    "spacing_ratio",
];
const CYCLE_COLUMNS: [&str; 18] = [
    "mach",
    "branch",
    "coordinate",
    "amplitude",
    "speed_ratio",
    "speed_index",
    "reduced_speed",
    "speed",
    "reduced_frequency",
    "frequency",
    "stability",
    "mean",
    "harmonics",
    "error",
    "balances",
    "density",
    "dynamic_pressure",
    "altitude",
];
/// Columns of the table of motions.
pub const HISTORY_COLUMNS: [&str; 15] = [
    "mach",
    "mode",
    "speed_ratio",
    "k",
    "1/k",
    "damping_g",
    "frequency",
    "eigenvalue_re",
    "eigenvalue_im",
    "density",
    "dynamic_pressure",
    "altitude",
    "branch",
    "speed",
    "equivalent_airspeed",
];

/// Writes all tables into a folder.
pub fn write_tables(boundary: &Boundary, out: &Path) -> Result<(), FileError> {
    let crossings = boundary.flutter.iter().flat_map(|at| at.crossings.iter().map(|c| crossing(at.mach, c)));
    write_csv(&out.join(CROSSINGS), &CROSSING_COLUMNS, crossings)?;
    let motions = boundary.flutter.iter().flat_map(|at| at.motions.iter().map(|m| motion(at.mach, m)));
    write_csv(&out.join(HISTORY), &HISTORY_COLUMNS, motions)?;
    if boundary.flutter.iter().any(|at| !at.doubts.is_empty()) {
        let doubts = boundary.flutter.iter().flat_map(|at| at.doubts.iter().map(|d| doubt(at.mach, d)));
        write_csv(&out.join(DOUBTS), &DOUBT_COLUMNS, doubts)?;
    }
    if !boundary.lco.is_empty() {
        write_cycles(boundary, &out.join(CYCLES))?;
    }
    Ok(())
}

/// Writes what the columns of the tables hold.
pub fn describe_tables(boundary: &Boundary, out: &Path) -> Result<(), FileError> {
    let Some(at) = boundary.flutter.first() else { return Ok(()) };
    let scale = Scale { dimensional: at.dimensional, dimension: at.dimension };
    columns::describe_tables(out, scale, &[])
}

fn write_cycles(boundary: &Boundary, file: &Path) -> Result<(), FileError> {
    let rows = boundary.lco.iter().map(|c| {
        vec![
            Entry::from(c.mach),
            Entry::from(c.branch as f64),
            Entry::from(c.coordinate.as_str()),
            Entry::from(c.amplitude),
            Entry::from(c.speed_ratio),
            number(c.speed_index),
            number(c.reduced_speed),
            Entry::from(c.speed),
            Entry::from(c.reduced_frequency),
            Entry::from(c.frequency),
            Entry::from(if c.stable { "stable" } else { "unstable" }),
            Entry::from(c.mean),
            Entry::from(c.harmonics as f64),
            Entry::from(c.error),
            Entry::from(c.balances as f64),
            Entry::from(c.density),
            Entry::from(c.dynamic_pressure),
            number(c.altitude),
        ]
    });
    write_csv(file, &CYCLE_COLUMNS, rows)
}

fn number(x: Option<f64>) -> Entry {
    Entry::from(x.unwrap_or(f64::NAN))
}

fn crossing(mach: f64, c: &FlutterRow) -> Vec<Entry> {
    let bars = &c.bars;
    let head = [Entry::from(mach), Entry::from(c.kind.as_str()), number(c.mode.map(|m| m as f64))];
    let numbers = [
        Some(c.speed_ratio),
        c.speed_index,
        c.reduced_speed,
        Some(c.speed),
        Some(c.reduced_frequency),
        Some(c.frequency),
        c.frequency_ratio,
        Some(c.error),
        c.cloud_error,
        c.g_method,
        Some(c.density),
        Some(c.dynamic_pressure),
        c.mass_ratio,
        c.altitude,
    ];
    let more = [
        c.equivalent_airspeed,
        bars.speed_ratio_error,
        bars.speed_index_error,
        bars.reduced_speed_error,
        bars.speed_error,
        bars.equivalent_airspeed_error,
        bars.density_error,
        bars.dynamic_pressure_error,
        bars.altitude_error,
        c.growth,
        c.holding_damping,
        c.margin,
    ];
    let branch = std::iter::once(Entry::from(c.branch.as_str()));
    head.into_iter().chain(numbers.map(number)).chain(branch).chain(more.map(number)).collect()
}

fn motion(mach: f64, m: &MotionRow) -> Vec<Entry> {
    let over = if m.reduced_frequency > 0.0 { 1.0 / m.reduced_frequency } else { f64::INFINITY };
    let [re, im] = m.eigenvalue;
    let numbers = [m.speed_ratio, m.reduced_frequency, over, m.damping, m.frequency, re, im];
    let stream = [m.density, m.dynamic_pressure, m.altitude.unwrap_or(f64::NAN)];
    let mode = m.mode.map_or(f64::NAN, |mode| mode as f64);
    let head = [mach, mode].into_iter().chain(numbers).chain(stream).map(Entry::from);
    let branch = std::iter::once(Entry::from(m.branch.as_str()));
    head.chain(branch).chain([Entry::from(m.speed), number(m.equivalent_airspeed)]).collect()
}

/// The Mach number and the motion of a row of the table of motions; columns that a table lacks are NaN, and a motion without a branch is named
/// after its mode.
pub fn motion_of(row: [f64; HISTORY_COLUMNS.len()], branch: Option<&str>) -> (f64, MotionRow) {
    let known = |value: f64| Some(value).filter(|v| v.is_finite());
    let [mach, mode, speed_ratio, k, _, damping, frequency, re, im, density, dynamic_pressure, altitude, _, speed, eas] =
        row;
    let motion = MotionRow {
        branch: branch.map_or_else(|| format!("mode {mode}"), str::to_owned),
        mode: known(mode).map(|mode| mode as usize),
        speed_ratio,
        speed,
        equivalent_airspeed: known(eas),
        damping,
        frequency,
        eigenvalue: [re, im],
        density,
        dynamic_pressure,
        reduced_frequency: k,
        altitude: known(altitude),
    };
    (mach, motion)
}

fn doubt(mach: f64, d: &Doubt) -> Vec<Entry> {
    let head = [Entry::from(mach), Entry::from(d.branch.as_str()), Entry::from(d.kind.as_str())];
    let none = [f64::NAN; 2];
    let (eas, altitude) = (d.equivalent_airspeed.unwrap_or(none), d.altitude.unwrap_or(none));
    let ends = [d.speed_ratio, d.speed, eas, d.dynamic_pressure, altitude];
    let numbers = [d.damping, d.damping_coarser].into_iter().chain(ends.into_iter().flatten()).chain([d.spacing_ratio]);
    head.into_iter().chain(numbers.map(Entry::from)).collect()
}
