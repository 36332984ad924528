//! The page of structures of particles alone: what was found, deformation and stress, natural modes, energies and probes.
//!
//! Everything comes from `summary.json`, `history.csv` and the pictures; quantities are in SI units, in the plane of the thickness of the case.
use serde_json::Value;

use super::chart::{Axis, Chart, Series};
use super::files::{Csv, RunFolder};
use super::page::{Block, Card, Fact, Page, Section, Status, Table};
use super::sections;
use super::words::{grouped, number, number_of};

/// Columns of `history.csv` that are energies, with their names on the page.
const ENERGIES: [(&str, &str); 7] = [
    ("kinetic", "kinetic"),
    ("strain", "strain"),
    ("stabilisation", "stabilisation"),
    ("contact", "contact"),
    ("dissipated", "dissipated by materials"),
    ("damped", "taken by damping"),
    ("work", "work of loads and supports"),
];
/// Displacements that cards tell, and modes.
const CARDS: usize = 6;

/// True for the folder of structures alone.
pub(super) fn is_solid(summary: &Value) -> bool {
    summary["study"].is_string()
}

/// The page.
pub(super) fn page(run: &RunFolder, summary: &Value) -> Page {
    let history = run.table("history.csv");
    let sections = [
        Section::new("warnings", "Warnings", Ok(sections::warnings(summary))),
        Section::new("found", "What was found", Ok(found(summary))),
        Section::new("deformation", "Deformation and stress", Ok(pictures(run, "solid").into_iter().collect())),
        Section::new("modes", "Natural modes", Ok(modes(run, summary))),
        Section::new("energies", "Energies", Ok(energies(summary, history.as_ref().ok()))),
        Section::new("probes", "Probes", Ok(probes(summary, history.as_ref().ok()))),
        Section::new("cost", "Cost", Ok(cost(summary))),
        Section::new("case", "Case", sections::case(run)),
        Section::new("cite", "How to cite", Ok(sections::citation())),
        Section::new("files", "Files", Ok(sections::files(run))),
    ];
    Page {
        title: sections::case_title(run, summary),
        status: Some(status(summary)),
        cards: cards(summary),
        sections: sections.into_iter().filter(|s| !s.blocks.is_empty()).collect(),
        ..Page::default()
    }
}

/// The study in words, and the horizontal axis of its history.
fn study(summary: &Value) -> [&'static str; 2] {
    match summary["study"].as_str() {
        Some("modes") => ["natural modes", "part of the load"],
        Some("equilibrium") => ["equilibrium", "part of the load"],
        Some("periodic") => ["periodic motion", "time, s"],
        _ => ["march", "time, s"],
    }
}

fn status(summary: &Value) -> Status {
    let [what, _] = study(summary);
    let (class, verdict) = match summary["converged"].as_bool() {
        Some(true) => ("good", format!("{what} found")),
        _ => ("bad", format!("{what}: not to be relied on")),
    };
    let count = |key: &str, unit: &str| summary[key].as_f64().map(|n| format!("{} {unit}", grouped(n)));
    let time = summary["time"].as_f64().filter(|t| *t > 0.0).map(|t| format!("up to t = {} s", number(t)));
    let facts = [count("particles", "solid particles"), count("steps", "steps").filter(|s| s != "0 steps"), time];
    Status { class, verdict, facts: facts.into_iter().flatten().collect::<Vec<_>>().join(" · ") }
}

/// The entries of a list, none of what is not one.
fn items(list: &Value) -> &[Value] {
    list.as_array().map_or(&[], Vec::as_slice)
}

/// Frequencies of the first modes; else how far the first probes moved.
fn cards(summary: &Value) -> Vec<Card> {
    let mode = |(k, mode): (usize, &Value)| Card {
        name: format!("Mode {}", k + 1),
        value: format!("{} Hz", number_of(&mode["frequency"])),
        facts: vec![Fact::new("generalised mass, kg", number_of(&mode["generalised_mass"]))],
    };
    let modes: Vec<Card> = items(&summary["modes"]).iter().take(CARDS).enumerate().map(mode).collect();
    if !modes.is_empty() {
        return modes;
    }
    let probe = |probe: &Value| {
        let moved: Vec<f64> = items(&probe["displacement"]).iter().filter_map(Value::as_f64).collect();
        let size = moved.iter().map(|u| u * u).sum::<f64>().sqrt();
        let facts = AXES.iter().zip(&moved).map(|(axis, u)| Fact::new(&format!("along {axis}, m"), number(*u)));
        let name = format!("Displacement of {}", probe["name"].as_str().unwrap_or_default());
        (!moved.is_empty()).then(|| Card { name, value: format!("{} m", number(size)), facts: facts.collect() })
    };
    items(&summary["probes"]).iter().filter_map(probe).take(CARDS).collect()
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// Bodies, particles, mass, and how the study ended.
fn found(summary: &Value) -> Vec<Block> {
    let bodies: Vec<&str> = items(&summary["bodies"]).iter().filter_map(Value::as_str).collect();
    let periodic = &summary["periodic"];
    let rows = [
        ("study", Some(study(summary)[0].to_owned())),
        ("bodies", (!bodies.is_empty()).then(|| bodies.join(", "))),
        ("solid particles", summary["particles"].as_f64().map(grouped)),
        ("mean number of neighbours", summary["neighbours"].as_f64().map(|n| format!("{n:.1}"))),
        ("mass, kg", summary["mass"].as_f64().map(number)),
        ("steps", summary["steps"].as_f64().filter(|n| *n > 0.0).map(grouped)),
        ("time reached, s", summary["time"].as_f64().filter(|t| *t > 0.0).map(number)),
        ("largest force left, over the largest there is", summary["residual"].as_f64().map(number)),
        ("frequency, Hz", periodic["frequency"].as_f64().map(number)),
        ("harmonics", periodic["harmonics"].as_f64().map(grouped)),
        ("part of the last harmonic", periodic["tail"].as_f64().map(number)),
        ("iterations of Newton's method", periodic["iterations"].as_f64().map(grouped)),
    ];
    let rows = rows.into_iter().filter_map(|(name, value)| Some(vec![name.to_owned(), value?]));
    vec![Block::Table(Table::new(&["quantity", "value"], rows))]
}

/// Pictures whose names begin with `start`.
fn pictures(run: &RunFolder, start: &str) -> Option<Block> {
    sections::pictures_of(run, |name| name.starts_with(start))
}

fn modes(run: &RunFolder, summary: &Value) -> Vec<Block> {
    let row = |(k, mode): (usize, &Value)| {
        let told = ["frequency", "omega", "generalised_mass", "residual"].map(|key| number_of(&mode[key]));
        std::iter::once((k + 1).to_string()).chain(told).collect()
    };
    let rows: Vec<Vec<String>> = items(&summary["modes"]).iter().enumerate().map(row).collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let columns = ["mode", "frequency, Hz", "ω, rad/s", "generalised mass, kg", "residual"];
    let text =
        "The greatest component of each shape is 1; in pictures the greatest displacement is a tenth of the body.";
    let table = [Block::Table(Table::new(&columns, rows)), Block::Text(text.to_owned())];
    table.into_iter().chain(pictures(run, "mode-")).collect()
}

/// Curves of `history.csv`: those that are not zero all along.
fn curves(history: &Csv, columns: &[(String, String)]) -> Vec<Series> {
    let curve = |(column, name): &(String, String)| history.curve("time", column, name);
    let told = |s: &Series| s.x.len() > 1 && s.y.iter().any(|y| *y != 0.0);
    columns.iter().filter_map(curve).filter(told).collect()
}

fn chart(title: &str, axis: &str, label: &str, series: Vec<Series>) -> Option<Chart> {
    let (x, y) = (Axis::linear(axis), Axis::linear(label));
    (!series.is_empty()).then(|| Chart { title: title.to_owned(), x, y, series })
}

fn energies(summary: &Value, history: Option<&Csv>) -> Vec<Block> {
    if summary["study"] == "modes" {
        return Vec::new();
    }
    let [_, axis] = study(summary);
    let names = ENERGIES.map(|(column, name)| (column.to_owned(), name.to_owned()));
    let drawn = history.and_then(|h| chart("Energies", axis, "energy, J", curves(h, &names)));
    let row = |(key, name): &(&str, &str)| Some(vec![(*name).to_owned(), number(summary["ledger"][*key].as_f64()?)]);
    let first = ("kinetic_at_start", "kinetic at the start");
    let mut rows: Vec<Vec<String>> = std::iter::once(&first).chain(&ENERGIES).filter_map(row).collect();
    if let Some(open) = summary["ledger"]["open"].as_f64() {
        rows.push(vec!["what is missing, over the largest term".to_owned(), number(open)]);
    }
    let mut blocks: Vec<Block> = drawn.map(Block::chart).into_iter().collect();
    if !rows.is_empty() {
        let heading = if summary["study"] == "periodic" { "Over one period" } else { "At the end" };
        blocks.push(Block::Heading(heading.to_owned()));
        blocks.push(Block::Table(Table::new(&["energy", "J"], rows)));
    }
    blocks
}

fn probes(summary: &Value, history: Option<&Csv>) -> Vec<Block> {
    let [_, axis] = study(summary);
    let probes = items(&summary["probes"]);
    let name = |probe: &Value| probe["name"].as_str().unwrap_or_default().to_owned();
    let drawn = probes.iter().filter_map(|probe| {
        let columns = AXES.map(|a| (format!("{}_u{a}", name(probe)), format!("along {a}")));
        chart(&format!("Displacement of {}", name(probe)), axis, "displacement, m", curves(history?, &columns))
    });
    let charts: Vec<Chart> = drawn.collect();
    let row = |probe: &Value| {
        let moved = items(&probe["displacement"]).iter().map(number_of);
        std::iter::once(name(probe)).chain(moved).collect::<Vec<String>>()
    };
    let rows: Vec<Vec<String>> = probes.iter().map(row).filter(|row| row.len() > 1).collect();
    let mut blocks = Vec::new();
    match charts.len() {
        0 => {}
        1 => blocks.extend(charts.into_iter().map(Block::chart)),
        _ => blocks.push(Block::charts(charts.into_iter())),
    }
    if let Some(first) = rows.first() {
        let columns = ["probe", "u_x, m", "u_y, m", "u_z, m"];
        let heading = if summary["study"] == "periodic" { "At the start of the period" } else { "At the end" };
        blocks.push(Block::Heading(heading.to_owned()));
        blocks.push(Block::Table(Table::new(&columns[..first.len().min(4)], rows)));
    }
    blocks.extend(harmonics(probes));
    blocks
}

/// Mean and harmonics of each probe along each axis.
fn harmonics(probes: &[Value]) -> Vec<Block> {
    let mut rows = Vec::new();
    for probe in probes {
        let name = probe["name"].as_str().unwrap_or_default();
        for (axis, mean) in AXES.iter().zip(items(&probe["mean"])) {
            rows.push(vec![name.to_owned(), (*axis).to_owned(), "0".to_owned(), number_of(mean), "–".to_owned()]);
        }
        for wave in items(&probe["harmonics"]) {
            let both = items(&wave["amplitude"]).iter().zip(items(&wave["phase_deg"]));
            let harmonic = wave["harmonic"].as_f64().map_or_else(String::new, grouped);
            for (axis, (amplitude, phase)) in AXES.iter().zip(both) {
                let told = [harmonic.clone(), number_of(amplitude), number_of(phase)];
                rows.push([name.to_owned(), (*axis).to_owned()].into_iter().chain(told).collect());
            }
        }
    }
    let columns = ["probe", "axis", "harmonic", "amplitude, m", "phase, degrees"];
    match rows.is_empty() {
        true => Vec::new(),
        false => vec![Block::Heading("Harmonics".to_owned()), Block::Table(Table::new(&columns, rows))],
    }
}

fn cost(summary: &Value) -> Vec<Block> {
    let fact = |name: &str, key: &str| Some(Fact::new(name, format!("{} s", number(summary[key].as_f64()?))));
    let facts = [fact("Wall time", "wall_seconds"), fact("Processor time", "cpu_seconds")];
    let facts: Vec<Fact> = facts.into_iter().flatten().collect();
    if facts.is_empty() { Vec::new() } else { vec![Block::Facts(facts)] }
}

#[cfg(test)]
mod tests {
    use super::super::overview::tests::{assert_balanced, assert_self_contained};
    use super::super::write_report;
    use serde_json::json;
    use std::fs;
    use std::path::Path;

    fn page(folder: &Path, summary: &serde_json::Value) -> String {
        fs::write(folder.join("summary.json"), summary.to_string()).unwrap();
        let page = fs::read_to_string(write_report(folder).unwrap()).unwrap();
        assert_balanced(&page);
        assert_self_contained(&page);
        page
    }

    fn fill(folder: &Path) {
        fs::create_dir_all(folder.join("pictures")).unwrap();
        let picture = crate::report::Chart::default().png().unwrap();
        for name in ["solid", "solid-deformation", "mode-1"] {
            fs::write(folder.join(format!("pictures/{name}.png")), &picture).unwrap();
        }
        let rows: String = (0..20)
            .map(|k| format!("{k},{},1,{k},0,0,0,0,{k},0,0,{}\n", 0.1 * f64::from(k), -0.01 * f64::from(k)))
            .collect();
        let columns = "step,time,kinetic,strain,stabilisation,contact,dissipated,damped,work,open,tip_ux,tip_uy";
        fs::write(folder.join("history.csv"), format!("{columns}\n{rows}")).unwrap();
        fs::write(folder.join("case.toml"), "title = \"Bar <b>\"\n").unwrap();
    }

    #[test]
    fn a_march_of_a_structure_becomes_a_page() {
        let folder = tempfile::tempdir().unwrap();
        fill(folder.path());
        let summary = json!({"event": "summary", "title": "Bar <b>", "study": "march", "converged": true, "bodies": ["bar"], "particles": 1234,
            "neighbours": 8.1, "mass": 3.0, "steps": 20, "time": 1.9, "ledger": {"kinetic_at_start": 0.0, "kinetic": 1.0, "strain": 19.0,
            "work": 19.0, "open": 0.002}, "probes": [{"name": "tip", "displacement": [0.0, -0.19]}], "modes": [], "cpu_seconds": 1.5,
            "wall_seconds": 0.7, "warnings": ["steps were halved"]});
        let page = page(folder.path(), &summary);
        for text in [
            "Bar &#60;b&#62;",
            "march found",
            "steps were halved",
            "Deformation and stress",
            "alt=\"solid deformation\"",
            "energy, J",
            "work of loads and supports",
            "Displacement of tip",
            "along y, m",
            "\u{2212}0.19000",
            "time reached, s",
        ] {
            assert!(page.contains(text), "{text}");
        }
        assert!(!page.contains("Pressure on the surface") && !page.contains("momentum balance"));
        assert!(!page.contains("along x</text>"), "what stays zero is not drawn");
    }

    #[test]
    fn modes_equilibria_and_periodic_motions_tell_what_they_have() {
        let folder = tempfile::tempdir().unwrap();
        fill(folder.path());
        let modes = json!({"study": "modes", "converged": true, "modes": [{"frequency": 81.5, "omega": 512.0, "generalised_mass": 2.0, "residual": 1e-9}],
            "probes": [{"name": "tip", "displacement": []}]});
        let told = page(folder.path(), &modes);
        assert!(["natural modes found", "81.500 Hz", "alt=\"mode 1\"", "ω, rad/s"].iter().all(|t| told.contains(t)));
        assert!(!told.contains("id=\"energies\""));
        let periodic = json!({"study": "periodic", "converged": false, "periodic": {"frequency": 5.0, "harmonics": 3, "tail": 0.01, "iterations": 7},
            "probes": [{"name": "tip", "displacement": [0.1], "mean": [0.02], "harmonics": [{"harmonic": 1, "amplitude": [0.08], "phase_deg": [-90.0]}]}]});
        let told = page(folder.path(), &periodic);
        assert!(["not to be relied on", "Harmonics", "\u{2212}90.000"].iter().all(|t| told.contains(t)));
        for junk in [
            json!({"study": "march"}),
            json!({"study": "march", "modes": [7], "probes": [null], "ledger": 3, "bodies": {}}),
        ] {
            page(folder.path(), &junk);
        }
        fs::remove_file(folder.path().join("history.csv")).unwrap();
        page(folder.path(), &modes);
    }
}
