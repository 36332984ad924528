//! The chapter on structures: what they are, how they moved and how that ended.
use std::f64::consts::TAU;

use super::chart::{Axis, Chart, Marks, Series};
use super::files::RunFolder;
use super::page::{Block, Fact, Table};
use super::words::number;
use crate::observe::structure::{
    CoordinateHistory, CoordinateSummary, FILE, StructureSummary, StructureTable, is_angle,
};

/// Misfit of a fit, over the deviation of the history, above which the page warns of it.
const DOUBTFUL: f64 = 0.05;

/// Nothing for a run without structures.
pub(super) fn structure(run: &RunFolder) -> Vec<Block> {
    let summaries = run.json("summary.json").map(|summary| summary["structure"].clone()).unwrap_or_default();
    let summaries: Vec<StructureSummary> = serde_json::from_value(summaries).unwrap_or_default();
    let table = run.text(FILE).map(|text| StructureTable::parse(&text));
    if summaries.is_empty() && table.is_err() {
        return Vec::new();
    }
    let mut blocks: Vec<Block> = summaries.iter().flat_map(|summary| ending(summary, summaries.len() > 1)).collect();
    match table {
        Ok(Some(table)) => blocks.extend(charts(&table, &summaries)),
        Ok(None) => blocks.push(Block::LeftOut(format!("`{FILE}` is not a table of structures"))),
        Err(reason) => blocks.push(Block::LeftOut(reason)),
    }
    blocks
}

/// What a structure is and how its coordinates ended.
fn ending(summary: &StructureSummary, several: bool) -> Vec<Block> {
    let mut blocks = Vec::new();
    if several {
        blocks.push(Block::Heading(summary.body.clone()));
    }
    if !summary.description.is_empty() {
        blocks.push(Block::List(summary.description.clone()));
    }
    if !summary.coordinates.is_empty() {
        blocks.push(Block::Table(tail_table(&summary.coordinates)));
    }
    let mut notes: Vec<String> = summary.coordinates.iter().filter_map(note).collect();
    if summary.coordinates.iter().any(is_balanced) {
        notes.push(
            "the frequency is that of the harmonic balance, of which two periods are shown: nothing is fitted".into(),
        );
    }
    if !notes.is_empty() {
        blocks.push(Block::List(notes));
    }
    let energy =
        summary.energy_per_cycle.map(|energy| Fact::new("Work of the gas over the last cycle", number(energy)));
    blocks.extend(energy.map(|fact| Block::Facts(vec![fact])));
    blocks
}

/// True for a coordinate whose frequency was known before.
fn is_balanced(c: &CoordinateSummary) -> bool {
    c.frequency.is_some() && c.fit_residual.is_none()
}

/// Columns of the table of coordinates.
const TAIL: [&str; 9] = [
    "coordinate",
    "mean",
    "amplitude",
    "spread of amplitude",
    "ω",
    "period",
    "growth rate σ",
    "damping ratio",
    "misfit of the fit",
];

/// Mean and amplitude of the last cycles, frequency and damping of the tail; a row for each oscillation found.
fn tail_table(coordinates: &[CoordinateSummary]) -> Table {
    let further = |c: &CoordinateSummary| (1..c.modes.len()).map(|k| further_row(c, k)).collect::<Vec<_>>();
    Table::new(&TAIL, coordinates.iter().flat_map(|c| std::iter::once(first_row(c)).chain(further(c))))
}

fn told(value: Option<f64>) -> String {
    value.map_or("–".to_owned(), number)
}

/// A value of a coordinate, angles in degrees.
fn length(c: &CoordinateSummary, value: Option<f64>) -> String {
    told(value.map(|v| if c.angle { v.to_degrees() } else { v }))
}

fn first_row(c: &CoordinateSummary) -> Vec<String> {
    let name = format!("{}{}", c.name, if c.angle { " (degrees)" } else { "" });
    let period = c.frequency.map(|frequency| TAU / frequency);
    let fit = [c.frequency, period, c.growth_rate, c.damping_ratio, c.fit_residual].map(told);
    [name, length(c, c.mean), length(c, c.amplitude), told(c.amplitude_spread)].into_iter().chain(fit).collect()
}

/// The row of an oscillation beside the first, with its amplitude at the end.
fn further_row(c: &CoordinateSummary, k: usize) -> Vec<String> {
    let mode = &c.modes[k];
    let name = format!("{}, oscillation {}", c.name, k + 1);
    let found = [mode.frequency, TAU / mode.frequency, mode.growth_rate, mode.damping_ratio].map(number);
    let (amplitude, none) = (length(c, Some(mode.amplitude)), || told(None));
    [name, none(), amplitude, none()].into_iter().chain(found).chain([none()]).collect()
}

/// A word on a coordinate without a frequency, or with one that is not to be believed.
fn note(c: &CoordinateSummary) -> Option<String> {
    let doubtful = c.fit_residual.filter(|residual| *residual > DOUBTFUL);
    let doubt =
        |r| format!("the tail of `{}` is no sum of oscillations that grow or decay: misfit {}", c.name, number(r));
    let none = c.no_frequency.as_ref().map(|reason| format!("`{}` has no frequency: {reason}", c.name));
    doubtful.map(doubt).or(none)
}

/// The horizontal axis of a history: time, or iterations where none passes.
struct Across<'a> {
    label: &'static str,
    values: &'a [f64],
}

impl Across<'_> {
    fn chart(&self, title: &str, label: &str, curves: &[(&str, &[f64])]) -> Chart {
        let line =
            |(name, values): &(&str, &[f64])| Series::new(name, Marks::Line, self.values.to_vec(), values.to_vec());
        let series = curves.iter().map(line).collect();
        Chart { title: title.to_owned(), x: Axis::linear(self.label), y: Axis::linear(label), series }
    }
}

fn charts(table: &StructureTable, summaries: &[StructureSummary]) -> Vec<Block> {
    if table.len() < 2 {
        return vec![Block::LeftOut(format!("`{FILE}` has no two rows"))];
    }
    let march = table.marches();
    let across = match march {
        true => Across { label: "time", values: &table.time },
        false => Across { label: "iteration", values: &table.iteration },
    };
    let angles = angles(table, summaries);
    let drawn: Vec<Drawn> = table.coordinates.iter().zip(angles).map(|(c, angle)| Drawn::of(c, angle)).collect();
    let mut blocks = vec![Block::charts(drawn.iter().map(|d| across.chart(&d.name, &d.label(""), &[("", &d.values)])))];
    blocks.push(Block::charts(
        table
            .coordinates
            .iter()
            .map(|c| across.chart(&format!("Force of the gas on {}", c.name), "generalised force", &[("", &c.loads)])),
    ));
    if march {
        blocks.push(Block::charts(drawn.iter().map(Drawn::phase_plane)));
        blocks.push(Block::charts(energies(table, &across).into_iter()));
    }
    blocks
}

/// Which coordinates are angles: as the summary says, or by their names without one.
fn angles(table: &StructureTable, summaries: &[StructureSummary]) -> Vec<bool> {
    let said: Vec<bool> = summaries.iter().flat_map(|s| &s.coordinates).map(|c| c.angle).collect();
    let by_name = || table.coordinates.iter().map(|c| is_angle(&c.name)).collect();
    if said.len() == table.coordinates.len() { said } else { by_name() }
}

/// A coordinate as it is drawn: angles in degrees.
struct Drawn {
    name: String,
    angle: bool,
    values: Vec<f64>,
    rates: Vec<f64>,
}

impl Drawn {
    fn of(c: &CoordinateHistory, angle: bool) -> Self {
        let unit = |values: &[f64]| values.iter().map(|v| if angle { v.to_degrees() } else { *v }).collect();
        Self { name: c.name.clone(), angle, values: unit(&c.values), rates: unit(&c.rates) }
    }

    fn label(&self, what: &str) -> String {
        format!("{}{what}{}", self.name, if self.angle { ", degrees" } else { "" })
    }

    fn phase_plane(&self) -> Chart {
        Chart {
            title: format!("Phase plane of {}", self.name),
            x: Axis::linear(&self.label("")),
            y: Axis::linear(&self.label(" rate")),
            series: vec![Series::new("", Marks::Loop, self.values.clone(), self.rates.clone())],
        }
    }
}

fn energies(table: &StructureTable, across: &Across<'_>) -> [Chart; 4] {
    let total: Vec<f64> = table.kinetic.iter().zip(&table.potential).map(|(k, p)| k + p).collect();
    let energies = [("kinetic", &table.kinetic[..]), ("potential", &table.potential), ("sum", &total)];
    let power = [("gas", &table.gas_power[..]), ("dampers", &table.dissipation)];
    [
        across.chart("Energy of the structures", "energy", &energies),
        across.chart("Power of the gas, and power that dampers take", "power", &power),
        across.chart("Work of the gas on the structures", "work", &[("", &table.gas_work)]),
        across.chart("Work on the walls less work on the structures", "work", &[("", &table.ledger)]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::structure::tests::{fill, section};
    use crate::report::overview::tests::assert_balanced;
    use crate::report::write_report;

    fn page(folder: &std::path::Path) -> String {
        std::fs::read_to_string(write_report(folder).unwrap()).unwrap()
    }

    fn summary(folder: &std::path::Path) -> Vec<StructureSummary> {
        let mut all = StructureTable::read(&folder.join(FILE)).unwrap().unwrap().summaries(&[section()], None);
        all[0].description = vec!["mass ratio μ = 60".into(), "V* = 5 <b>".into()];
        all
    }

    #[test]
    fn a_march_becomes_histories_phase_planes_and_a_table() {
        let folder = tempfile::tempdir().unwrap();
        fill(folder.path());
        let json = serde_json::json!({ "structure": summary(folder.path()) });
        std::fs::write(folder.path().join("summary.json"), json.to_string()).unwrap();
        if let Some(to) = std::env::var_os("ALULA_PICTURES") {
            std::fs::write(std::path::Path::new(&to).join("structure.html"), page(folder.path())).unwrap();
        }
        let page = page(folder.path());
        assert_balanced(&page);
        let parts = [
            "<h2",
            "Structure",
            "mass ratio μ = 60",
            "V* = 5 &#60;b&#62;",
            "Phase plane of plunge",
            "pitch, degrees",
            "pitch (degrees)",
            "0.90000",
            "\u{2212}0.020000",
            "Work of the gas over the last cycle",
            "Work on the walls less work on the structures",
        ];
        for part in parts {
            assert!(page.contains(part), "{part}");
        }
        assert!(!page.contains("has no frequency"));
    }

    #[test]
    fn an_equilibrium_is_drawn_over_iterations() {
        let folder = tempfile::tempdir().unwrap();
        fill(folder.path());
        let text = std::fs::read_to_string(folder.path().join(FILE)).unwrap();
        let still = |line: &str| {
            let mut entries: Vec<&str> = line.split(',').collect();
            entries[1] = if entries[1] == "time" { "time" } else { "0" };
            entries.join(",") + "\n"
        };
        std::fs::write(folder.path().join(FILE), text.lines().map(still).collect::<String>()).unwrap();
        let bare = page(folder.path());
        assert_balanced(&bare);
        assert!(bare.contains("Force of the gas on pitch") && !bare.contains("Phase plane"));
        let json = serde_json::json!({ "structure": summary(folder.path()) });
        std::fs::write(folder.path().join("summary.json"), json.to_string()).unwrap();
        assert!(page(folder.path()).contains("<code>pitch</code> has no frequency"));
    }

    #[test]
    fn what_is_missing_is_a_word_and_no_structure_no_chapter() {
        let folder = tempfile::tempdir().unwrap();
        assert!(structure(&RunFolder::new(folder.path())).is_empty());
        for junk in ["", "x,y\n1,2\n", "iteration,time,kinetic\n"] {
            std::fs::write(folder.path().join(FILE), junk).unwrap();
            assert!(page(folder.path()).contains("is not a table of structures"));
        }
        std::fs::remove_file(folder.path().join(FILE)).unwrap();
        std::fs::write(folder.path().join("summary.json"), r#"{"structure":[{"body":"wing"}]}"#).unwrap();
        assert!(page(folder.path()).contains("<code>structure.csv</code> is not in the folder"));
    }
}
