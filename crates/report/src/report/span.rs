//! The chapter on the load along the span: lift, shear, bending and torsion of each body, the loads at roots, and drag as the wake has it.
use serde_json::Value;

use super::chart::{Axis, Chart, Marks, Series};
use super::files::{Csv, RunFolder};
use super::page::{Block, Table};
use super::words::{number, number_of};
use crate::observe::induced::SpanLoad;

/// Columns of the table and what they are called, all against the place along the span.
const CHARTS: [(&str, &str); 5] = [
    ("section_cl", "section lift coefficient"),
    ("section_cm", "section moment coefficient about the quarter chord"),
    ("shear_force", "shear_force"),
    ("bending_moment", "bending moment"),
    ("torsion_moment", "torsion about the quarter chord"),
];

/// Nothing for a run without wings.
pub(super) fn span(run: &RunFolder) -> Vec<Block> {
    let summary = run.json("summary.json").unwrap_or_default();
    let mut blocks = Vec::new();
    if let Ok(table) = run.table("strips.csv") {
        let all = bodies(&table);
        let lifting: Vec<&Body> = all.iter().filter(|b| root_loads(&summary).any(|r| r["body"] == b.name)).collect();
        blocks.extend(loading(&all, &lifting, &summary).map(Block::chart));
        blocks.push(Block::charts(CHARTS.iter().filter_map(|(column, title)| chart(&lifting, column, title))));
    }
    blocks.extend(roots(&summary));
    blocks.extend(drags(&summary));
    blocks
}

/// The strips of a body.
struct Body {
    name: String,
    table: Csv,
}

impl Body {
    fn curve(&self, column: &str) -> Option<Series> {
        let along = if self.table.numbers(column)?.len() > 1 { Marks::Line } else { Marks::Dots };
        let x = if ["shear_force", "bending_moment", "torsion_moment"].contains(&column) {
            "station_in"
        } else {
            "station"
        };
        Some(Series::new(&self.name, along, self.table.numbers(x)?, self.table.numbers(column)?))
    }

    fn lying(&self) -> bool {
        self.table.column("axis").is_some_and(|axis| axis.first() == Some(&"y"))
    }
}

fn bodies(table: &Csv) -> Vec<Body> {
    let mut all: Vec<Body> = Vec::new();
    for row in &table.rows {
        let Some(name) = row.first() else { continue };
        match all.iter_mut().find(|b| b.name == *name) {
            Some(body) => body.table.rows.push(row.clone()),
            None => all.push(Body {
                name: name.clone(),
                table: Csv { columns: table.columns.clone(), rows: vec![row.clone()] },
            }),
        }
    }
    all
}

/// c cl/c_ref of all that lies and of fins, and the elliptic load of the same lift and span as what lies.
fn loading(all: &[Body], lifting: &[&Body], summary: &Value) -> Option<Chart> {
    let fins = || lifting.iter().copied().filter(|b| !b.lying());
    let mut series: Vec<Series> = all.iter().filter(|b| b.lying()).filter_map(|b| b.curve("loading")).collect();
    if series.is_empty() {
        return None;
    }
    series.extend(fins().filter_map(|b| b.curve("loading")));
    let load = serde_json::from_value::<SpanLoad>(summary["span_load"].clone()).ok();
    series.extend(load.zip(ends(all)).map(|(load, ends)| {
        let (y, value) = load.ellipse(ends).into_iter().map(|[y, value]| (y, value)).unzip();
        Series::new("ellipse of the same lift", Marks::Dashes, y, value)
    }));
    let along = if fins().next().is_some() { "y, of fins z" } else { "y" };
    let (x, y) = (Axis::linear(along), Axis::linear("c cl / c_ref"));
    Some(Chart { title: "Load along the span".into(), x, y, series })
}

/// From where to where strips of what lies go.
fn ends(all: &[Body]) -> Option<[f64; 2]> {
    let edges = |b: &Body| {
        let (middle, width) = (b.table.numbers("station")?, b.table.numbers("width")?);
        Some(middle.iter().zip(&width).flat_map(|(m, w)| [m - 0.5 * w, m + 0.5 * w]).collect::<Vec<f64>>())
    };
    let edges: Vec<f64> = all.iter().filter(|b| b.lying()).filter_map(edges).flatten().collect();
    let ends = edges.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], e| [a.min(*e), b.max(*e)]);
    (ends[0] < ends[1]).then_some(ends)
}

/// A column of the table along the span of wings and fins.
fn chart(bodies: &[&Body], column: &str, title: &str) -> Option<Chart> {
    let series: Vec<Series> = bodies.iter().filter_map(|b| b.curve(column)).collect();
    let axis = if bodies.iter().all(|b| b.lying()) { "y" } else { "y, of fins z" };
    (!series.is_empty()).then(|| Chart {
        title: title.to_owned(),
        x: Axis::linear(axis),
        y: Axis::linear(title),
        series,
    })
}

fn root_loads(summary: &Value) -> impl Iterator<Item = &Value> {
    summary["root_loads"].as_array().into_iter().flatten()
}

/// What acts at the roots.
fn roots(summary: &Value) -> Vec<Block> {
    let row = |r: &Value| {
        let text = |key: &str| r[key].as_str().unwrap_or("–").to_owned();
        let mut row = vec![text("body"), format!("{} = {}", text("axis"), number_of(&r["root"]))];
        let told = [
            "shear",
            "bending",
            "torsion",
            "shear_coefficient",
            "bending_coefficient",
            "torsion_coefficient",
            "centre",
        ];
        row.extend(told.map(|key| number_of(&r[key])));
        row
    };
    let rows: Vec<Vec<String>> = root_loads(summary).map(row).collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let columns =
        ["body", "root", "shear", "bending", "torsion", "shear / q S", "bending / q S c", "torsion / q S c", "centre"];
    let text = "Shear is the force along z (of fins along y), bending is positive where the tip is bent up, torsion about the quarter chord \
                of the root is positive nose up; all in the units of the case. The centre of the load is its distance from the root over that \
                of the tip.";
    vec![
        Block::Heading("Loads at the roots".to_owned()),
        Block::Text(text.to_owned()),
        Block::Table(Table::new(&columns, rows)),
    ]
}

/// Drag of the load along the span, and from planes in the wake.
fn drags(summary: &Value) -> Vec<Block> {
    let load = &summary["span_load"];
    let mut rows = Vec::new();
    if load.is_object() {
        let value = |key: &str| number_of(&load[key]);
        let name = format!("Load along the span, efficiency {}", value("efficiency"));
        rows.push(vec![name, value("cl"), value("cd_induced"), "–".into(), "–".into()]);
    }
    for plane in summary["wake_planes"].as_array().into_iter().flatten() {
        let name = format!("Wake {} chords behind", plane["distance"].as_f64().map_or("–".to_owned(), number));
        let told = ["cl", "cd_induced", "cd_entropy", "cd"].map(|key| number_of(&plane[key]));
        rows.push(std::iter::once(name).chain(told).collect());
    }
    if rows.is_empty() {
        return Vec::new();
    }
    let columns = ["", "CL", "CD induced", "CD entropy", "CD"];
    let left_out = load["left_out"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let mut blocks = vec![Block::Heading("Drag from the wake".to_owned()), Block::Table(Table::new(&columns, rows))];
    blocks.extend(left_out.map(|told| Block::Text(told.to_owned())));
    blocks
}
