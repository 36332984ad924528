//! The page of a flutter boundary, and its pictures.
//!
//! Everything comes from the files of `alula flutter`: `flutter.json`, `v-g.csv`, and `modes.json`, which says how far each coordinate takes
//! the points of the surface.
use std::path::Path;

use serde_json::{Value, json};

mod charts;
mod found;
mod tables;

use self::found::{branches as branches_of, first, place_of, varied};
use super::chart::Chart;
use super::files::RunFolder;
use super::page::{Block, Card, Fact, Page, Section, Status};
use super::sections;
use super::words::{grouped, number};
use super::{ReportError, write_file};
use crate::case::Matching;
use crate::record::flutter::{Boundary, FlutterAt, FlutterRow, Share};

/// The surface and how coordinates move it.
const MODES: &str = "modes.json";
/// Modes with which charts stand beside one another: more have legends too long for that.
const FEW: usize = 6;
/// Cards at the top.
const CARDS: usize = 6;

/// True for a folder of `alula flutter`.
pub(super) fn is_flutter(run: &RunFolder) -> bool {
    run.path.join("flutter.json").is_file() && !run.path.join("summary.json").exists()
}

/// Draws the charts of a flutter boundary into its pictures.
pub fn write_flutter(run: &Path) -> Result<(), ReportError> {
    let Ok(found) = found::read(&RunFolder::new(run)) else { return Ok(()) };
    for (name, chart) in charts::all(&found) {
        write_file(&run.join(format!("pictures/{name}.svg")), chart.svg()?.as_bytes())?;
        write_file(&run.join(format!("pictures/{name}.png")), &chart.png()?)?;
    }
    Ok(())
}

/// The page.
pub(super) fn page(run: &RunFolder) -> Page {
    let found = found::read(run);
    let of = |chapter: fn(&Boundary) -> Vec<Block>| found.as_ref().map(chapter).map_err(String::clone);
    let sections = [
        Section::new("warnings", "Warnings", Ok(found.as_ref().map(warnings).unwrap_or_default())),
        Section::new("crossings", "Crossings", of(crossings)),
        Section::new("boundary", "Boundary", of(|f| charts::boundary(f).map(Block::chart).into_iter().collect())),
        Section::new("branches", "Damping, frequencies and eigenvalues", of(branches)),
        Section::new("modes", "Modes", found.as_ref().map(|f| modes(f, run)).map_err(String::clone)),
        Section::new("limit-cycles", "Limit cycles", of(cycles)),
        Section::new("conditions", "Conditions and conventions", of(conditions)),
        Section::new("cost", "Cost", of(cost)),
        Section::new("case", "Case", sections::case(run)),
        Section::new("cite", "How to cite", Ok(sections::citation())),
        Section::new("files", "Files", Ok(sections::files(run))),
    ];
    let known = found.as_ref().ok();
    Page {
        title: known.map(|f| f.title.clone()).filter(|t| !t.trim().is_empty()).unwrap_or("Flutter".to_owned()),
        status: Some(status(known)),
        cards: known.map(|f| f.flutter.iter().filter_map(card).take(CARDS).collect()).unwrap_or_default(),
        sections: sections.into_iter().filter(|s| !s.blocks.is_empty()).collect(),
        ..Page::default()
    }
}

fn status(found: Option<&Boundary>) -> Status {
    let Some(found) = found else {
        return Status { class: "unknown", verdict: "no boundary".to_owned(), facts: String::new() };
    };
    let all = &found.flutter;
    let doubtful = all.iter().any(|at| !at.warnings.is_empty());
    let (class, verdict) = if doubtful { ("bad", "doubtful in part") } else { ("good", "found") };
    let machs: Vec<String> = all.iter().map(|at| at.mach.to_string()).collect();
    let marches: f64 = found.lco.iter().filter_map(|c| c.march.as_ref()).map(|m| m.cpu_seconds).sum();
    let cpu = all.iter().map(|at| at.cpu_seconds).sum::<f64>() + marches;
    let read = all.iter().find_map(|at| at.read.as_ref());
    let cost = match read {
        Some(file) => format!("forces read from {file}"),
        None => {
            let particles = all.iter().map(|at| at.particles as f64).fold(0.0, f64::max);
            format!("{} particles · {cpu:.1} s of processor time", grouped(particles))
        }
    };
    let crossings: usize = all.iter().map(|at| at.crossings.len()).sum();
    let plural = if crossings == 1 { "" } else { "s" };
    let facts = format!("{crossings} crossing{plural} · Mach {} · {cost}", machs.join(", "));
    Status { class, verdict: verdict.to_owned(), facts }
}

/// What begins to grow first at a Mach number.
fn card(at: &FlutterAt) -> Option<Card> {
    let c = first(at)?;
    let what = tables::in_words(&c.kind);
    let speed = ("TAS, m/s", c.speed, c.bars.speed_error);
    let (name, value, bar) = match (at.matching, at.dimensional, c.speed_index) {
        (Matching::Altitude, ..) => ("altitude, m", c.altitude.map_or(f64::NAN, f64::round), c.bars.altitude_error),
        (Matching::Density, true, _) => ("dynamic pressure, Pa", c.dynamic_pressure, c.bars.dynamic_pressure_error),
        (Matching::Density, ..) => ("dynamic pressure", c.dynamic_pressure, c.bars.dynamic_pressure_error),
        (_, true, _) => speed,
        (.., Some(index)) => ("speed index", index, c.bars.speed_index_error),
        _ => ("speed", c.speed, c.bars.speed_error),
    };
    let told = |value: f64, bar: Option<f64>| Some(tables::with_bar(value, bar));
    let unknown = bar.is_none().then(|| "± –".to_owned());
    let frequency = if at.dimensional { "frequency, Hz" } else { "frequency" };
    let facts = [
        (name, unknown),
        ("TAS, m/s", told(c.speed, c.bars.speed_error).filter(|_| at.dimensional && name != "TAS, m/s")),
        ("EAS, m/s", c.equivalent_airspeed.and_then(|v| told(v, c.bars.equivalent_airspeed_error))),
        ("k", Some(number(c.reduced_frequency))),
        (frequency, Some(number(c.frequency))),
        ("branch", Some(c.name())),
        ("V*", c.reduced_speed.and_then(|v| told(v, c.bars.reduced_speed_error))),
        ("clearance of 15 %", at.clearance.as_ref().map(|c| (if c.passes { "pass" } else { "fail" }).to_owned())),
    ];
    let facts = facts.into_iter().filter_map(|(name, value)| Some(Fact::new(name, value?))).collect();
    let value = format!("{} {name}", tables::with_bar(value, bar));
    Some(Card { name: format!("{what}, Mach {}", at.mach), value, facts })
}

fn warnings(found: &Boundary) -> Vec<Block> {
    let told = found.flutter.iter().flat_map(|at| at.warnings.iter().map(move |w| format!("Mach {}: {w}", at.mach)));
    told.map(Block::Text).collect()
}

fn crossings(found: &Boundary) -> Vec<Block> {
    let mut blocks = Vec::new();
    for at in found.flutter.iter().filter(|at| at.crossings.is_empty()) {
        blocks.push(Block::Text(format!("At Mach {} nothing begins to grow as far as was looked at.", at.mach)));
    }
    let table = tables::crossings(found);
    blocks.extend((!table.rows.is_empty()).then_some(Block::Table(table)));
    let clearances = tables::clearances(found);
    if !clearances.rows.is_empty() {
        blocks.extend([Block::Heading("Clearance to the design speed".to_owned()), Block::Table(clearances)]);
    }
    for at in &found.flutter {
        blocks.extend(at.notes.iter().map(|note| Block::Text(format!("Mach {}: {note}", at.mach))));
    }
    let doubts = tables::doubts(found);
    if !doubts.rows.is_empty() {
        let words = "In these ranges of speed the difference to a coarser cloud decides whether a motion grows: a finer \
                     spacing, or other Mach numbers near by, tell more.";
        blocks.extend([
            Block::Heading("Where the cloud decides".to_owned()),
            Block::Text(words.to_owned()),
            Block::Table(doubts),
        ]);
    }
    if found.flutter.iter().any(|at| at.read.is_some()) {
        blocks.push(Block::Text(
            "Forces were read, and cannot be refined at crossings: ± is the change when the nearest frequency is left out.".to_owned(),
        ));
    }
    blocks
}

/// V-g and V-f diagrams and the root locus of each Mach number.
fn branches(found: &Boundary) -> Vec<Block> {
    let known: Vec<&FlutterAt> = found.flutter.iter().filter(|at| !branches_of(at).is_empty()).collect();
    let few = known.iter().all(|at| branches_of(at).len() <= FEW);
    let set = |charts: Vec<Chart>| -> Vec<Block> {
        // one alone has room
        match few && charts.len() > 1 {
            true => vec![Block::charts(charts.into_iter())],
            false => charts.into_iter().map(Block::chart).collect(),
        }
    };
    let against_speed = known.iter().flat_map(|at| [charts::damping(at), charts::frequency(at)]);
    let loci = known.iter().map(|at| charts::locus(at));
    let mut blocks = set(against_speed.collect());
    blocks.push(Block::Text(
        "Rings are where motions are neutral, and in root loci where they begin at the lowest speed.".to_owned(),
    ));
    blocks.extend(set(loci.collect()));
    if known.is_empty() { Vec::new() } else { blocks }
}

/// Motions of the surface over a period.
fn modes(found: &Boundary, run: &RunFolder) -> Vec<Block> {
    let table = tables::shapes(found);
    if table.rows.is_empty() {
        return Vec::new();
    }
    let moving = match run.json(MODES) {
        Ok(surface) => {
            animated(found, surface).unwrap_or_else(|| Block::LeftOut(format!("the motions: `{MODES}` has no surface")))
        }
        Err(reason) => Block::LeftOut(reason),
    };
    vec![
        moving,
        Block::Text(
            "Amplitude and phase of each coordinate, the largest 1 ∠ 0°: angles in radians, displacements of rigid bodies in b, modes in \
             what their files have. Files `flutter-mode-mach-….pvd` show the same in ParaView."
                .to_owned(),
        ),
        Block::Table(table),
    ]
}

/// What the script of the page gets: the surface, and all motions to choose from.
fn animated(found: &Boundary, mut surface: Value) -> Option<Block> {
    let coordinates: Vec<String> = serde_json::from_value(surface.get("coordinates")?.clone()).ok()?;
    let motion = |name: String, frequency: f64, shape: &[Share]| {
        let part = |f: fn(f64) -> f64| -> Vec<f64> {
            let one = |s: &Share| s.amplitude * f(s.phase_deg.to_radians());
            (0..coordinates.len()).map(|k| shape.get(k).map_or(0.0, one)).collect()
        };
        json!({ "name": name, "frequency": number(frequency), "re": part(f64::cos), "im": part(f64::sin) })
    };
    let crossing = |(at, c): (&FlutterAt, &FlutterRow)| {
        let name =
            format!("{}, Mach {}, {} {}", tables::in_words(&c.kind), at.mach, varied(at), number(place_of(at, c)));
        motion(name, c.frequency, &c.shape)
    };
    let crossings = found.flutter.iter().flat_map(|at| at.crossings.iter().map(move |c| (at, c))).map(crossing);
    let natural = found.flutter.iter().take(1).flat_map(|at| &at.natural);
    let natural = natural.map(|n| motion(format!("natural mode {}", n.mode), n.frequency, &n.shape));
    surface["motions"] = crossings.chain(natural).collect();
    Some(Block::Modes(serde_json::to_string(&surface).ok()?.replace('<', "\\u003c")))
}

fn cycles(found: &Boundary) -> Vec<Block> {
    let Some(chart) = charts::limit_cycles(found) else { return Vec::new() };
    let words = "Full lines join motions that smaller and larger ones go to, dashed lines those that others leave. Rings at zero are where \
                 small motions are neutral.";
    let mut blocks = vec![Block::chart(chart), Block::Text(words.to_owned()), Block::Table(tables::cycles(found))];
    let marches = tables::marches(found);
    if !marches.rows.is_empty() {
        blocks.extend([
            Block::Heading("Marched in time".to_owned()),
            Block::Text(
                "A march begins with coordinates and rates of the limit cycle and the steady flow; what it ends with is the first harmonic of \
                 its last period."
                    .to_owned(),
            ),
            Block::Table(marches),
        ]);
    }
    blocks
}

fn conditions(found: &Boundary) -> Vec<Block> {
    let Some(first) = found.flutter.first() else { return Vec::new() };
    let mut blocks = tables::facts(first);
    blocks.push(Block::Heading("Stream and structure of the case".to_owned()));
    blocks.push(Block::Table(tables::reference(found)));
    let equilibria = tables::equilibria(found);
    if !equilibria.rows.is_empty() {
        let words =
            "Forces are those about the static equilibrium of structure and gas, with these coordinates in base units:";
        blocks.extend([Block::Text(words.to_owned()), Block::Table(equilibria)]);
    }
    blocks
}

fn cost(found: &Boundary) -> Vec<Block> {
    if found.flutter.iter().all(|at| at.read.is_some()) {
        return Vec::new();
    }
    vec![Block::Table(tables::cost(found))]
}

#[cfg(test)]
mod tests {
    use super::super::overview::tests::{assert_balanced, assert_self_contained};
    use super::super::write_report;
    use super::*;

    /// What a run of two Mach numbers with limit cycles leaves.
    fn fill(run: &Path) {
        let shape = json!([{"coordinate": "plunge", "amplitude": 1.0, "phase_deg": 0.0}, {"coordinate": "pitch", "amplitude": 0.4, "phase_deg": -31.5}]);
        let crossing = |kind: &str, ratio: f64, error: Value| {
            json!({"kind": kind, "mode": (kind == "flutter").then_some(1), "speed_ratio": ratio, "speed_index": 0.5 * ratio, "reduced_speed": 4.0, "speed": 0.75 * ratio,
                "density": 1.0, "dynamic_pressure": 0.3, "mass_ratio": 60.0, "altitude": null, "reduced_frequency": 0.13, "frequency": 0.07,
                "frequency_ratio": 1.16, "error": error, "speed_index_error": error.as_f64().map(|e| 0.5 * ratio * e), "branch": if kind == "flutter" { "mode 1" } else { "divergence 1" }, "g_method": -3e-13, "extrapolated": kind == "divergence", "shape": shape})
        };
        let at = |mach: f64, warnings: &[&str]| {
            json!({"mach": mach, "match": "none", "crossings": [crossing("flutter", 2.0, json!(0.03)), crossing("divergence", 3.0, json!(null))],
                "natural": [{"mode": 1, "frequency": 0.05, "shape": shape}], "reduced_frequencies": [0.0, 0.1], "coordinates": ["plunge", "pitch"],
                "reference": {"speed": 0.75, "density": 1.0, "dynamic_pressure": 0.28, "speed_index": 0.5, "reduced_speed": null, "mass_ratio": 60.0},
                "chord": 1.0, "semichord": 0.5, "alpha_deg": 0.0, "read": null, "steady": [0.0, 0.001, 0.0], "orders": 9.7, "particles": 3784,
                "trim": {"speed_ratio": 1.9, "dynamic_pressure": 1.0, "coordinates": [0.25, 0.0], "rounds": 3}, "linear_iterations": 120, "residual": 4e-7, "cpu_seconds": 3.2, "warnings": warnings})
        };
        let cycle = |amplitude: f64, index: f64, stable: bool, march: Value| {
            json!({"mach": 0.8, "branch": 1, "coordinate": "pitch", "amplitude": amplitude, "speed_index": index, "speed": index, "speed_ratio": 1.2,
                "reduced_frequency": 0.1, "frequency": 0.03, "stable": stable, "mean": 0.0, "harmonics": 3, "error": null, "balances": 5,
                "extrapolated": false, "march": march})
        };
        let march = json!({"amplitude": 2.52, "frequency": 0.031, "periods": 9.0, "difference": 0.008, "change": 0.001, "cpu_seconds": 20.0});
        let lco =
            [cycle(1.0, 0.9, false, json!(null)), cycle(2.0, 0.85, true, json!(null)), cycle(2.5, 0.95, true, march)];
        let all = json!({"title": "A section <b>", "flutter": [at(0.75, &[]), at(0.8, &["known to 3.0 % only"])], "lco": lco});
        std::fs::write(run.join("flutter.json"), all.to_string()).unwrap();
        let motions: String = (0..2)
            .flat_map(|m| (1..=2).map(move |mode| (m, mode)))
            .flat_map(|(m, mode)| (1..20).map(move |k| (0.75 + 0.05 * f64::from(m), mode, 0.2 * f64::from(k))))
            .map(|(mach, mode, x)| {
                format!(
                    "{mach},{mode},{x},0.1,10,{},{},{},{},1,0.3,NaN\n",
                    x - 2.0,
                    0.05 + 0.01 * x,
                    0.1 * (x - 2.0),
                    0.6
                )
            })
            .collect();
        let columns = "mach,mode,speed_ratio,k,1/k,damping_g,frequency,eigenvalue_re,eigenvalue_im,density,dynamic_pressure,altitude";
        std::fs::write(run.join("v-g.csv"), format!("{columns}\n{motions}")).unwrap();
        let surface = json!({"chord": 1.0, "coordinates": ["plunge", "pitch"], "points": [0, 0, 0, 1, 0, 0, 0.5, 0.1, 0], "lines": [0, 1, 1, 2, 2, 0],
            "triangles": [], "moves": [[0, 0.5, 0, 0, 0.5, 0, 0, 0.5, 0], [0, 0.3, 0, 0, -0.7, 0, 0.1, -0.2, 0]]});
        std::fs::write(run.join(MODES), surface.to_string()).unwrap();
        std::fs::create_dir_all(run.join("pictures")).unwrap();
    }

    #[test]
    fn a_boundary_becomes_one_sound_page() {
        let folder = tempfile::tempdir().unwrap();
        fill(folder.path());
        let page = std::fs::read_to_string(write_report(folder.path()).unwrap()).unwrap();
        assert_balanced(&page);
        assert_self_contained(&page);
        let told = [
            "A section &#60;b&#62;",
            "Flutter boundary",
            "Damping, Mach 0.75",
            "Frequency, Mach 0.8",
            "Root locus, Mach 0.75",
            "error bar",
            "Limit cycles, Mach 0.8",
            "small motions",
            "Marched in time",
            "V_f = V*/√μ",
            "e^{+iωt}",
            "Mach 0.8: known to 3.0 % only",
            "iterations per column",
            "viewer modes",
            "natural mode 1",
            "0.4000 ∠ −31.5°",
            "1.000 ± 0.030 speed index",
            "divergence 1",
            "./flutter.json",
            "beyond the frequencies",
        ];
        for text in told {
            assert!(page.contains(text), "{text}");
        }
        // three charts at each Mach number, boundary and branches, the surface, and the script of the page
        assert_eq!(page.matches("</script>").count(), 2 * 3 + 2 + 1 + 1);
        write_flutter(folder.path()).unwrap();
        for name in ["root-locus-mach-0.750.svg", "damping-mach-0.800.png", "boundary.png", "limit-cycles.svg"] {
            assert!(folder.path().join("pictures").join(name).is_file(), "{name}");
        }
    }

    #[test]
    fn the_page_points_at_what_stays() {
        let folder = tempfile::tempdir().unwrap();
        fill(folder.path());
        std::fs::write(folder.path().join(crate::observe::table::KEPT), "{}").unwrap();
        let page = std::fs::read_to_string(write_report(folder.path()).unwrap()).unwrap();
        std::fs::remove_file(folder.path().join(crate::observe::table::KEPT)).unwrap();
        let links: Vec<&str> = page.split("href=\"./").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        assert!(links.contains(&"flutter.json"));
        links.iter().for_each(|link| assert!(folder.path().join(link).is_file(), "{link}"));
    }

    #[test]
    fn the_surface_gets_amplitudes_and_phases() {
        let folder = tempfile::tempdir().unwrap();
        fill(folder.path());
        let run = RunFolder::new(folder.path());
        let Some(Block::Modes(text)) = animated(&found::read(&run).unwrap(), run.json(MODES).unwrap()) else {
            panic!("none")
        };
        let told: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(told["motions"].as_array().unwrap().len(), 2 * 2 + 1);
        let [re, im] = ["re", "im"].map(|part| told["motions"][0][part][1].as_f64().unwrap());
        assert!((re.hypot(im) - 0.4).abs() < 1e-12 && (im.atan2(re).to_degrees() + 31.5).abs() < 1e-9);
    }

    #[test]
    fn what_is_missing_or_broken_becomes_words() {
        let folder = tempfile::tempdir().unwrap();
        for junk in ["{}", "[1", "{\"flutter\": [{\"mach\": 0.5}]}", "{\"flutter\": 7}", "{\"lco\": [{}]}"] {
            std::fs::write(folder.path().join("flutter.json"), junk).unwrap();
            let page = std::fs::read_to_string(write_report(folder.path()).unwrap()).unwrap();
            assert_balanced(&page);
            write_flutter(folder.path()).unwrap_or_else(|e| assert!(matches!(e, ReportError::Io { .. }), "{e}"));
        }
    }
}
