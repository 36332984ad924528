//! Files of a flutter boundary: tables, `flutter.json`, pictures and page.
use std::path::Path;

use super::super::files::write_state_script;
use super::super::folder::BOUNDARY;
use super::state_space;
use crate::observe::About;
use crate::observe::columns::Scale;
use crate::observe::table::write_json;
use crate::problem::RunError;
use crate::record::flutter::tables::{describe_tables, write_tables};
use crate::record::flutter::{Boundary, FlutterAt, FlutterRow};
use crate::report;
use crate::study::flutter::Skin;

/// The surface that moves, for the page.
const MODES: &str = "modes.json";

/// Writes tables and pictures of a boundary into the folder `out`; `skin` draws its motions.
pub(super) fn write(boundary: &Boundary, skin: Option<&Skin>, out: &Path) -> Result<(), RunError> {
    write_tables(boundary, out)?;
    for at in &boundary.flutter {
        at.state_space.iter().try_for_each(|system| state_space::write(system, at.mach, out))?;
    }
    describe_tables(boundary, out)?;
    write_json(&out.join(BOUNDARY), boundary)?;
    skin.map_or(Ok(()), |skin| picture(boundary, skin, out))
}

/// Writes pictures and page, and the motions at which the last Mach number begins to flutter.
fn picture(boundary: &Boundary, skin: &Skin, out: &Path) -> Result<(), RunError> {
    if boundary.flutter.len() == 1 {
        skin.write(&out.join(MODES))?;
    }
    if let Some(at) = boundary.flutter.last() {
        let flutter = at.crossings.iter().filter(|c| c.kind == "flutter");
        let shown: Vec<&FlutterRow> = match flutter.clone().next() {
            Some(_) => flutter.collect(),
            None => at.crossings.iter().take(1).collect(),
        };
        for (k, crossing) in shown.into_iter().enumerate() {
            let more = if k > 0 { format!("-{}", k + 1) } else { String::new() };
            let name = format!("flutter-mode-mach-{:.3}{more}", at.mach);
            // one that was written with pressures before it was interrupted stays
            if crossing.walls.is_some() || !out.join(format!("{name}.pvd")).is_file() {
                skin.write_series(out, (&name, &about(at, &boundary.title, crossing)), crossing)?;
            }
        }
    }
    write_state_script(out)?;
    report::write_flutter(out)?;
    report::write_report(out)?;
    Ok(())
}

/// What files of the motion at a crossing tell.
fn about(at: &FlutterAt, title: &str, crossing: &FlutterRow) -> About {
    let unit = |what: &str, si: &str, own: &str| format!("{what} [{}]", if at.dimensional { si } else { own });
    About {
        scale: Some(Scale { dimensional: at.dimensional, dimension: at.dimension }),
        numbers: vec![
            ("Mach number".to_owned(), at.mach),
            ("alpha [deg]".to_owned(), at.alpha_deg),
            (unit("speed", "m/s", "a"), crossing.speed),
            (unit("density", "kg/m3", "rho"), crossing.density),
            (unit("dynamic pressure", "Pa", "rho.a2"), crossing.dynamic_pressure),
            (unit("frequency", "Hz", "a/L"), crossing.frequency),
            ("reduced frequency".to_owned(), crossing.reduced_frequency),
        ],
        words: vec![("title", title.to_owned()), ("motion", format!("{}, {}", crossing.kind, crossing.branch))],
        scalars: if crossing.walls.is_some() { "cp_unsteady" } else { "displacement" },
        vectors: "displacement",
    }
}
