//! The chapter on error bars of marches and harmonic balances: every number with its bar, the parts of that, and the runs that tell them.
use super::files::RunFolder;
use super::page::{Block, Table};
use super::words::{grouped, number};
use crate::observe::error_bars::{Bar, ErrorBars, OtherRun, Part, Window};

/// A part of a bar and its name.
type Column = (&'static str, fn(&Bar) -> Option<f64>);

const COLUMNS: [Column; 4] = [
    ("cloud", |b| b.cloud),
    ("step in time", |b| b.step),
    ("number of harmonics", |b| b.harmonics),
    ("since the period before", |b| b.transient),
];

/// Nothing for a run that was not asked for error bars.
pub(super) fn error_bars(run: &RunFolder) -> Vec<Block> {
    let found = run.json("summary.json").map(|summary| summary["error_bars"].clone()).unwrap_or_default();
    let Ok(found) = serde_json::from_value::<ErrorBars>(found) else { return Vec::new() };
    if let Some(why) = &found.untold {
        return vec![Block::Text(format!("No error bars are told: {why}."))];
    }
    if found.bars.is_empty() {
        return Vec::new();
    }
    vec![Block::Text(told(&found)), Block::Table(bars(&found)), Block::Table(runs(&found.runs))]
}

fn told(found: &ErrorBars) -> String {
    let [from, until] = [found.measured.from, found.measured.until].map(number);
    let window = match found.measured.window {
        Window::LastPeriod => "the last period of the motion",
        Window::Cycles => "the last cycles of the lift",
        Window::March => "the whole march",
    };
    format!(
        "Numbers of {window}, from t = {from} to {until}. Each part of a bar is what the number differs by in the run of the same name below, \
         times its factor: two runs show no order of convergence. Of a harmonic the difference is that of complex numbers, so that amplitude \
         and phase share it. Parts add as squares. A phase that may be any has no row."
    )
}

fn bars(found: &ErrorBars) -> Table {
    let there: Vec<&Column> = COLUMNS.iter().filter(|(_, of)| found.bars.iter().any(|b| of(b).is_some())).collect();
    let columns: Vec<&str> = ["", "", "value", "±"].into_iter().chain(there.iter().map(|(name, _)| *name)).collect();
    let row = |b: &Bar| {
        let head = [b.of.clone(), b.name(), number(b.value), number(b.half_width)];
        let parts = there.iter().map(|(_, of)| of(b).map_or("–".to_owned(), number));
        head.into_iter().chain(parts).collect()
    };
    Table::new(&columns, found.bars.iter().map(row))
}

fn runs(all: &[OtherRun]) -> Table {
    let row = |run: &OtherRun| {
        let (name, what) = match run.part {
            Part::Cloud => ("cloud", "times the spacing"),
            Part::Step => ("step in time", "times the step"),
            Part::Harmonics => ("number of harmonics", "times the harmonics"),
        };
        vec![
            name.to_owned(),
            format!("{} {what}", number(run.ratio)),
            number(run.factor),
            grouped(run.particles as f64),
            number(run.cpu_seconds),
        ]
    };
    Table::new(&["further run", "with", "factor", "particles", "processor time [s]"], all.iter().map(row))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::error_bars::{Measure, Measured, Quantity};
    use crate::report::page::{Page, Section};

    #[test]
    fn bars_have_their_parts_and_say_why_there_are_none() {
        let folder = tempfile::tempdir().unwrap();
        let measure = |value: f64| Measure {
            of: "CL".into(),
            quantity: Quantity::Harmonic(1),
            value: [value, 0.0],
            before: None,
        };
        let measured = Measured { window: Window::LastPeriod, from: 1.0, until: 2.0, values: vec![measure(0.5)] };
        let run = OtherRun {
            part: Part::Cloud,
            ratio: 2.0,
            factor: 2.0,
            particles: 1234,
            cpu_seconds: 3.0,
            values: vec![measure(0.49)],
        };
        let page = |found: &ErrorBars| {
            let text = serde_json::json!({ "error_bars": found }).to_string();
            std::fs::write(folder.path().join("summary.json"), text).unwrap();
            let section = Section::new("bars", "Error bars", Ok(error_bars(&RunFolder::new(folder.path()))));
            Page { sections: vec![section], ..Page::default() }.html().unwrap()
        };
        let whole = page(&ErrorBars::of(measured.clone(), vec![run]));
        for part in ["harmonic 1, amplitude", "harmonic 1, phase", "0.020000", "times the spacing", "last period"] {
            assert!(whole.contains(part), "{part}: {whole}");
        }
        assert!(!whole.contains("step in time"));
        assert!(page(&ErrorBars::untold(measured, Some("it is not periodic".into()))).contains("it is not periodic"));
    }
}
