//! The loads of a motion that repeats, as a run is judged by: means and first harmonics of the last period, and how far that differs
//! from the one before. The instant at which a run ended is told as one.
use serde_json::Value;

use super::files::{LOADS, Load};
use super::page::{Block, Card, Fact, Table};
use super::words::{number, number_of, with_bar};

/// The loads of the last period in large type; `None` of a run without one.
pub(super) fn cards(summary: &Value) -> Option<Vec<Card>> {
    let period = period(summary)?;
    let card = |load: &Load| {
        let of = |key: &str| number_of(&period[key][load.column]);
        let mut facts = vec![
            Fact::new(&format!("{}, amplitude", harmonic(period)), of("amplitude")),
            Fact::new(&per_motion(period), of("per_motion")),
            Fact::new(&format!("degrees before {}", motion(period)), of("phase_deg")),
        ];
        facts.extend(at(summary).map(|at| Fact::new(&at, number_of(&summary["loads"][load.column]))));
        let mean = period["mean"][load.column].as_f64();
        let value = match mean.zip(bar(summary, load, "mean")) {
            Some((mean, bar)) => with_bar(mean, bar),
            None => of("mean"),
        };
        Card { name: format!("{}, mean of the last period", load.name), value, facts }
    };
    Some(LOADS.iter().map(card).collect())
}

/// A table of the last period and how far it repeats the one before; nothing of a run without one.
pub(super) fn blocks(summary: &Value) -> Vec<Block> {
    let Some(period) = period(summary) else { return Vec::new() };
    let row = |name: String, key: &str| {
        std::iter::once(name).chain(LOADS.iter().map(|load| number_of(&period[key][load.column]))).collect()
    };
    let rows: Vec<Vec<String>> = vec![
        row("mean".into(), "mean"),
        row(format!("{}, amplitude", harmonic(period)), "amplitude"),
        row(per_motion(period), "per_motion"),
        row(format!("degrees before {}", motion(period)), "phase_deg"),
    ];
    vec![
        Block::Heading("The last period".to_owned()),
        Block::Table(Table::new(&["", "CL", "CD", "CM"], rows)),
        Block::Text(repeats(summary)),
    ]
}

/// Mean and amplitude of a load over the cycles that the lift of a march without a period goes through of itself.
pub(super) fn cycles(summary: &Value, load: &Load) -> Vec<Fact> {
    let cycles = &summary["lift_cycles"];
    let of = |key: &str| cycles[format!("{key}_{}", load.column)].as_f64().map(number);
    let (Some(mean), Some(amplitude), true) = (of("mean"), of("amplitude"), at(summary).is_some()) else {
        return Vec::new();
    };
    let name = format!("over the last {} cycles of the lift", number_of(&cycles["cycles"]).trim_end_matches(".0000"));
    vec![Fact::new(&name, format!("{mean} ± {amplitude}"))]
}

/// How a march without a period ended, where what follows is an instant of a run.
pub(super) fn at(summary: &Value) -> Option<String> {
    summary["loads_at"].as_f64().map(|t| format!("at t = {}", number(t)))
}

/// Half width of the error bar of a number of a load, where there is one.
fn bar(summary: &Value, load: &Load, quantity: &str) -> Option<f64> {
    let bars = summary["error_bars"]["bars"].as_array()?;
    let own = bars.iter().find(|bar| bar["of"] == load.name && bar["quantity"] == quantity)?;
    own["half_width"].as_f64()
}

/// How far the last period repeats the one before, in a sentence.
fn repeats(summary: &Value) -> String {
    if summary["harmonic_balance"].is_object() {
        return "A harmonic balance: the flow repeats itself from period to period.".to_owned();
    }
    let change = &summary["periodic_change"];
    match (change["mean"].as_f64(), change["first_harmonic"].as_f64()) {
        (Some(mean), Some(first)) => format!(
            "From the period before it differs by {} (means) and {} (first harmonics) of the first harmonics.",
            number(mean),
            number(first)
        ),
        _ => "No period before confirms it: march two or more.".to_owned(),
    }
}

fn period(summary: &Value) -> Option<&Value> {
    summary.get("periodic_loads").filter(|period| period.is_object())
}

fn harmonic(period: &Value) -> String {
    match period["harmonic"].as_u64() {
        None | Some(1) => "first harmonic".to_owned(),
        Some(n) => format!("harmonic {n}"),
    }
}

/// The motion that phases are told against.
fn motion(period: &Value) -> String {
    period["motion"].as_str().unwrap_or("the motion").replace('_', " ")
}

/// What an amplitude is divided by.
fn per_motion(period: &Value) -> String {
    let unit = match period["motion"].as_str() {
        Some("angle") => "radian",
        Some("mode") => "unit of the mode",
        _ => "length of the motion",
    };
    format!("the same per {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_march_leads_with_its_last_period() {
        let three = |cl: f64| json!({ "cl": cl, "cd": 0.0, "cm": 0.0 });
        let mut summary = json!({ "loads": three(0.9), "loads_at": 62.8, "periodic_loads": {
            "mean": three(0.28), "amplitude": three(0.09), "per_motion": three(5.3), "phase_deg": three(-4.2), "motion": "angle", "harmonic": 1 } });
        let cards = cards(&summary).unwrap();
        let facts: Vec<(&str, &str)> = cards[0].facts.iter().map(|f| (f.name.as_str(), f.value.as_str())).collect();
        assert_eq!((cards[0].name.as_str(), cards[0].value.as_str()), ("CL, mean of the last period", "0.28000"));
        assert_eq!(facts[1], ("the same per radian", "5.3000"));
        assert_eq!(facts[3], ("at t = 62.800", "0.90000"));
        assert!(repeats(&summary).contains("No period before"));
        summary["periodic_change"] = json!({ "mean": 0.02, "first_harmonic": 0.001 });
        assert!(repeats(&summary).contains("0.020000 (means)"));
        assert!(super::cards(&json!({ "loads": three(0.9) })).is_none() && blocks(&json!({})).is_empty());
    }
}
