//! The chapter on a polar: loads at its points, as charts with error bars and as a table.
use std::path::Path;

use super::chart::{Axis, Chart, Marks, Series};
use super::files::{Csv, LOADS, Load, RunFolder};
use super::page::{Block, Table};
use super::words::{grouped, number};
use super::{ReportError, write_file};

/// Name of the table.
const FILE: &str = "polar.csv";

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

/// Nothing for a run at one point.
pub(super) fn polar(run: &RunFolder) -> Vec<Block> {
    let Ok(points) = run.table(FILE) else { return Vec::new() };
    let failed = points.column("converged").map_or(0, |all| all.iter().filter(|c| **c != "true").count());
    let short = points.column("within_accuracy").map_or(0, |all| all.iter().filter(|c| **c == "false").count());
    let mut text = "Vertical and horizontal bars are error bars, where the loads were found on a family of clouds. \
         The chapters below show the last point whose flow is known."
        .to_owned();
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
    vec![
        Block::charts(charts(&points).into_iter().map(|(_, chart)| chart)),
        Block::Text(text),
        Block::Table(table(&points)),
    ]
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
        "mach" => format!("M {value}"),
        _ => format!("α {value}°"),
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

/// A line through points, and a bar from end to end of each error, as one series.
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
    Series::new(name, Marks::Line, x, y)
}

/// A row for each point.
fn table(points: &Csv) -> Table {
    let column = |name: &str| points.column(name).unwrap_or_default();
    let numbers = |name: &str| points.numbers(name).unwrap_or_default();
    let shown =
        ["mach", "alpha_deg", "cl", "cl_error", "cd", "cd_error", "cm", "cm_error", "cl_momentum", "cd_momentum"]
            .map(numbers);
    let iterations = numbers("iterations");
    let (reasons, within, long) = (column("reason"), column("within_accuracy"), column("long_bars"));
    let row = |k: usize| {
        let values = shown.iter().map(|c| c.get(k).copied().map_or("–".to_owned(), number));
        let reason = reasons.get(k).copied().unwrap_or_default();
        let short = within.get(k) == Some(&"false") && reason.is_empty();
        let remark = match long.get(k).filter(|names| short && !names.is_empty()) {
            Some(names) => format!("error bar of {names} longer than asked for"),
            None if short => "longer error bars than asked for".to_owned(),
            None => reason.to_owned(),
        };
        let count = iterations.get(k).copied().map_or("–".to_owned(), grouped);
        values.chain([count, remark]).collect::<Vec<_>>()
    };
    let rows = (0..reasons.len()).map(row).collect::<Vec<_>>();
    Table::new(
        &[
            "M",
            "α, °",
            "CL",
            "±",
            "CD",
            "±",
            "CM",
            "±",
            "CL by momentum",
            "CD by momentum",
            "iterations",
            "not converged, or short of the accuracy",
        ],
        rows,
    )
}
