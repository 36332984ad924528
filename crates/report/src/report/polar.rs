//! The chapter on a polar: loads at its points, as charts with error bars and as a table.
use std::path::Path;

use serde_json::Value;

use super::chart::{Axis, Chart, Marks, Series};
use super::files::{Csv, LOADS, Load, RunFolder};
use super::page::{Block, Table};
use super::words::{grouped, load, plain, with_bar};
use super::{ReportError, write_file};

/// Name of the table.
const FILE: &str = "polar.csv";

/// Curves with which charts stand beside one another.
const FEW: usize = 6;

/// A quantity of the points, and its column.
#[derive(Clone, Copy)]
struct Quantity {
    column: &'static str,
    label: &'static str,
}

const ALPHA: Quantity = Quantity { column: "alpha_deg", label: "α, degrees" };
const MACH: Quantity = Quantity { column: "mach", label: "Mach number" };

impl From<Load> for Quantity {
    fn from(load: Load) -> Self {
        Self { column: load.column, label: load.name }
    }
}

/// The last point of a polar whose flow is known, which fields and loads of its run are of; `None` for a run at one point.
pub(super) fn last_point(summary: &Value) -> Option<String> {
    let points = summary["polar"].as_array().filter(|points| !points.is_empty())?;
    let last = points.last()?;
    let at = |key: &str| summary[key].as_f64().or_else(|| last[key].as_f64()).map(plain);
    Some(format!("Mach {}, α {}°", at("mach")?, at("alpha_deg")?))
}

/// Nothing for a run at one point.
pub(super) fn polar(run: &RunFolder) -> Vec<Block> {
    let Ok(points) = run.table(FILE) else { return Vec::new() };
    let charts: Vec<Chart> = charts(&points).into_iter().map(|(_, chart)| chart).collect();
    // long legends need the whole page
    let mut blocks = match charts.iter().all(|chart| chart.series.len() <= FEW) {
        true => vec![Block::charts(charts.into_iter())],
        false => charts.into_iter().map(Block::chart).collect(),
    };
    let last = last_point(&run.json("summary.json").unwrap_or_default());
    blocks.extend([Block::Text(words(&points, last)), Block::Table(table(&points))]);
    blocks
}

/// What the charts show, and what is wanting at which points.
fn words(points: &Csv, last: Option<String>) -> String {
    let failed = points.column("converged").map_or(0, |all| all.iter().filter(|c| **c != "true").count());
    let short = points.column("within_accuracy").map_or(0, |all| all.iter().filter(|c| **c == "false").count());
    let last = last.map_or_else(String::new, |point| format!(", {point}"));
    let mut text = format!(
        "Vertical and horizontal bars are error bars, where the loads were found on a family of clouds. The loads at the top and the \
         chapters below are those of the last point whose flow is known{last}."
    );
    if failed > 0 {
        text +=
            &format!(" Points that did not converge ({failed}) are left out of the curves; the table has the reasons.");
    }
    if short > 0 {
        let long = points.column("long_bars").unwrap_or_default();
        let of = |name: &str| long.iter().filter(|all| all.split(", ").any(|one| one == name)).count();
        let each = ["CL", "CD", "CM"].map(|name| (name, of(name))).into_iter().filter(|(_, n)| *n > 0);
        let each = each.map(|(name, n)| format!("{name} at {n}")).collect::<Vec<_>>().join(", ");
        let each = if each.is_empty() { each } else { format!(" ({each})") };
        text += &format!(" At {short} of {} points error bars are longer than asked for{each}.", points.rows.len());
    }
    text
}

/// Draws the charts of the polar of a run into its pictures.
pub fn write_polar(run: &Path) -> Result<(), ReportError> {
    let Ok(points) = RunFolder::new(run).table(FILE) else { return Ok(()) };
    for (name, chart) in charts(&points) {
        write_file(&run.join(format!("pictures/{name}.svg")), chart.svg()?.as_bytes())?;
        write_file(&run.join(format!("pictures/{name}.png")), &chart.png()?)?;
    }
    Ok(())
}

/// Loads over the angle, drag and moment over the lift, and loads over the Mach number: whatever has two values or more.
fn charts(points: &Csv) -> Vec<(String, Chart)> {
    let [cl, cd, cm] = LOADS.map(Quantity::from);
    let many = |q: Quantity| values(points, q).len() > 1;
    let mut all = Vec::new();
    if many(ALPHA) {
        let pairs = [(ALPHA, cl, "polar-cl-alpha"), (cd, cl, "polar-cl-cd"), (cl, cm, "polar-cm-cl")];
        all.extend(pairs.map(|(x, y, name)| (name.to_owned(), chart(points, [x, y], MACH))));
    }
    if many(MACH) {
        let names = ["polar-cl-mach", "polar-cd-mach", "polar-cm-mach"];
        let each = [cl, cd, cm].into_iter().zip(names);
        all.extend(each.map(|(y, name)| (name.to_owned(), chart(points, [MACH, y], ALPHA))));
    }
    all
}

/// The different values of a quantity, in the order in which they come.
fn values(points: &Csv, quantity: Quantity) -> Vec<f64> {
    let mut all = Vec::new();
    for value in points.numbers(quantity.column).unwrap_or_default() {
        if !all.contains(&value) {
            all.push(value);
        }
    }
    all
}

/// A curve with error bars for each value of `parameter`.
fn chart(points: &Csv, [x, y]: [Quantity; 2], parameter: Quantity) -> Chart {
    let parameters = values(points, parameter);
    let name = |value: f64| match parameter.column {
        _ if parameters.len() == 1 => String::new(),
        "mach" => format!("M {}", plain(value)),
        _ => format!("α {}°", plain(value)),
    };
    let series = parameters.iter().map(|value| {
        let chosen = chosen(points, parameter, *value);
        let of = |q: Quantity, end: &str| {
            let all = points.numbers(&format!("{}{end}", q.column)).unwrap_or_default();
            chosen.iter().map(|k| all.get(*k).copied().unwrap_or(f64::NAN)).collect::<Vec<f64>>()
        };
        let [at, bars] = ["", "_error"].map(|end| [of(x, end), of(y, end)]);
        with_bars(&name(*value), at, &bars)
    });
    let title = format!("{} over {}", y.label, x.label.split(',').next().unwrap_or_default());
    Chart { title, x: Axis::linear(x.label), y: Axis::linear(y.label), series: series.collect() }
}

/// Converged points where `parameter` has a value.
fn chosen(points: &Csv, parameter: Quantity, value: f64) -> Vec<usize> {
    let all = points.numbers(parameter.column).unwrap_or_default();
    let converged = points.column("converged").unwrap_or_default();
    let fits = |k: &usize| all[*k] == value && converged.get(*k).is_some_and(|c| *c == "true");
    (0..all.len()).filter(fits).collect()
}

/// A line through points with their marks, and a bar from end to end of each error, as one series.
fn with_bars(name: &str, [mut x, mut y]: [Vec<f64>; 2], bars: &[Vec<f64>; 2]) -> Series {
    for k in 0..x.len() {
        let (at, half) = ([x[k], y[k]], [bars[0][k], bars[1][k]]);
        for d in 0..2 {
            let half = if half[d].is_finite() { half[d] } else { continue };
            let ends = [-half, half].map(|h| if d == 0 { [at[0] + h, at[1]] } else { [at[0], at[1] + h] });
            for p in [[f64::NAN; 2], ends[0], ends[1]] {
                x.push(p[0]);
                y.push(p[1]);
            }
        }
    }
    Series::new(name, Marks::Points, x, y)
}

/// A row for each point.
fn table(points: &Csv) -> Table {
    let column = |name: &str| points.column(name).unwrap_or_default();
    let numbers = |name: &str| points.numbers(name).unwrap_or_default();
    let given = ["mach", "alpha_deg"].map(numbers);
    let loads = LOADS.map(|load| [numbers(load.column), numbers(&format!("{}_error", load.column))]);
    let momentum = ["cl_momentum", "cd_momentum", "cm_momentum"].map(numbers);
    let iterations = numbers("iterations");
    let (reasons, within, long) = (column("reason"), column("within_accuracy"), column("long_bars"));
    let at = |values: &Vec<f64>, k: usize| values.get(k).copied().unwrap_or(f64::NAN);
    let row = |k: usize| {
        let told = |[value, bar]: &[Vec<f64>; 2]| match at(bar, k) {
            bar if bar.is_finite() => with_bar(at(value, k), bar),
            _ => load(at(value, k)),
        };
        let short = within.get(k) == Some(&"false") && reasons[k].is_empty();
        let remark = match long.get(k).filter(|names| short && !names.is_empty()) {
            Some(names) => format!("error bar of {names} longer than asked for"),
            None if short => "longer error bars than asked for".to_owned(),
            None => reasons[k].to_owned(),
        };
        let given = given.iter().map(|c| plain(at(c, k)));
        let loads = loads.iter().map(told).chain(momentum.iter().map(|c| load(at(c, k))));
        let count = Some(at(&iterations, k)).filter(|n| n.is_finite()).map_or("–".to_owned(), grouped);
        given.chain(loads).chain([count, remark]).collect::<Vec<_>>()
    };
    let columns =
        ["M", "α, °", "CL", "CD", "CM", "CL by momentum", "CD by momentum", "CM by momentum", "iterations", "remark"];
    Table::new(&columns, (0..reasons.len()).map(row))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::overview::tests::assert_balanced;
    use crate::report::write_report;

    /// What a polar of two Mach numbers and so many angles leaves; the bar of CD is too long at the last point.
    fn fill(run: &Path, angles: u32) {
        let mut rows = String::from(
            "mach,alpha_deg,cl,cl_error,cd,cd_error,cm,cm_error,cl_momentum,cd_momentum,iterations,converged,within_accuracy,reason,long_bars\n",
        );
        for (mach, k) in [0.3, 0.5].into_iter().flat_map(|mach| (0..angles).map(move |k| (mach, k))) {
            let last = mach == 0.5 && k + 1 == angles;
            let (within, long) = if last { ("false", "CD") } else { ("true", "") };
            let cl = 0.1 * f64::from(k) + 0.012_345_678;
            rows += &format!(
                "{mach},{k},{cl},0.00123,-8.337e-5,0.00068,-1e-9,0.00017,{cl},-1e-9,34,true,{within},,{long}\n"
            );
        }
        std::fs::write(run.join(FILE), rows).unwrap();
        let loads = serde_json::json!({ "cl": 1.297, "cd": 0.0108, "cm": -0.0034 });
        let summary = serde_json::json!({ "mach": 0.5, "alpha_deg": f64::from(angles - 1), "converged": true, "loads": loads,
            "reference": { "chord": 1.0 }, "polar": [{ "mach": 0.3, "alpha_deg": 0.0 }] });
        std::fs::write(run.join("summary.json"), summary.to_string()).unwrap();
    }

    fn page(angles: u32) -> String {
        let folder = tempfile::tempdir().unwrap();
        fill(folder.path(), angles);
        std::fs::read_to_string(write_report(folder.path()).unwrap()).unwrap()
    }

    #[test]
    fn a_page_says_which_point_its_headline_is_of_and_rounds_what_it_tells() {
        let page = page(13);
        assert_balanced(&page);
        for part in [
            "<h2>CL at Mach 0.5, α 12°</h2>",
            "Loads at Mach 0.5, α 12°",
            "last point whose flow is known, Mach 0.5, α 12°",
            "At 1 of 26 points error bars are longer than asked for (CD at 1)",
            ">0.0123 ± 0.0012</td>",
            ">0.00000</td>",
            ">\u{2212}0.00008 ± 0.00068</td>",
            ">34</td>",
            ">0.3</td>",
            "class=\"t\">error bar of CD longer than asked for</td>",
        ] {
            assert!(page.contains(part), "{part}");
        }
        assert!(!page.contains("CM by momentum"), "a column in which nothing is told");
        assert!(!page.contains("against reference") && !page.contains("34.000"));
        // the seventh curve has the colour of the first, and another dash
        assert!(page.contains("α 6°") && page.contains("stroke-dasharray=\"12 4\""));
    }

    #[test]
    fn few_curves_stand_beside_one_another() {
        assert!(page(3).contains("<div class=\"charts\">"));
        assert!(!page(3).contains("stroke-dasharray=\"12 4\""));
    }
}
