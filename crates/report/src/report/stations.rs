//! Cp along the chord at stations of the span: what sections of wings are judged by.
//!
//! The hull is cut at y = η times the half span from the middle. x/c counts from the foremost point of what a body shows there to
//! its rearmost one. References with a column `eta` stand in the chart of the station that they are nearest to.
use std::path::Path;

use super::ReportError;
use super::axes::draw_title;
use super::canvas::{Canvas, Text};
use super::chart::{Axis, Chart, Marks, Series, Size};
use super::colour::Colour;
use super::files::{Reference, RunFolder};
use super::surface_views::{conditions, title};
use super::walls::Walls;
use super::write_file;
use crate::math::slice::{OnSide, slice};

/// Stations where the case names none.
const USUAL: [f64; 6] = [0.2, 0.44, 0.65, 0.8, 0.9, 0.95];
/// References within this part of the half span of a station belong to it.
const SAME: f64 = 0.02;
/// Charts in a row of the sheet.
const ACROSS: usize = 3;
/// Above the charts of the sheet.
const TOP: f64 = 70.0;
/// Least points of a curve: others are of blunt edges.
const SHORTEST: usize = 8;

/// A chart for each station; none for runs in the plane.
pub(super) fn charts(run: &RunFolder, references: &[Reference]) -> Vec<Chart> {
    let Some(walls) = Walls::of(run) else { return Vec::new() };
    let [low, high] = walls.bounds();
    let plane = walls.mirrors.iter().find(|m| m.axis == 1).map(|m| m.at);
    let middle = plane.unwrap_or_else(|| f64::midpoint(low[1], high[1]));
    // half models may stand on either side of the plane
    let half = if high[1] - middle >= middle - low[1] { high[1] - middle } else { low[1] - middle };
    let chart = |eta: &f64| chart(&walls, *eta, middle + eta * half, references);
    stations(run, references).iter().filter_map(chart).collect()
}

/// Draws the charts of all stations as one sheet, `pictures/cp-stations`.
pub fn write_stations(run: &Path) -> Result<(), ReportError> {
    let folder = RunFolder::new(run);
    let charts = charts(&folder, &folder.references().0);
    if charts.is_empty() {
        return Ok(());
    }
    let (size, across) = (Size::SMALL, ACROSS.min(charts.len()));
    let rows = charts.len().div_ceil(across);
    let mut canvas = Canvas::new(across as f64 * size.width, TOP + rows as f64 * size.height);
    draw_title(&mut canvas, &format!("Sections: {}", title(&folder)), [24.0, 30.0]);
    let room = canvas.width - 24.0;
    canvas.text(Text { colour: Colour::GREY, ..Text::new(conditions(&folder), [24.0, 54.0], 13.0) }.within(room));
    for (k, chart) in charts.iter().enumerate() {
        let at = [(k % across) as f64 * size.width, TOP + (k / across) as f64 * size.height];
        canvas.sheet(&chart.draw(size), at);
    }
    write_file(&run.join("pictures/cp-stations.svg"), canvas.svg()?.as_bytes())?;
    write_file(&run.join("pictures/cp-stations.png"), &canvas.png(2.0)?)
}

/// Those of the case, else of the references, else the usual ones.
fn stations(run: &RunFolder, references: &[Reference]) -> Vec<f64> {
    let case: toml::Table = run.text("case.toml").ok().and_then(|text| text.parse().ok()).unwrap_or_default();
    let named = case.get("output").and_then(|o| o.get("stations")).and_then(toml::Value::as_array);
    let number = |v: &toml::Value| v.as_float().or_else(|| v.as_integer().map(|v| v as f64));
    if let Some(named) = named {
        return named.iter().filter_map(number).collect();
    }
    let mut known: Vec<f64> = references.iter().flat_map(|r| &r.stations).copied().filter(|e| e.is_finite()).collect();
    known.sort_by(f64::total_cmp);
    known.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    if known.is_empty() { USUAL.to_vec() } else { known }
}

fn chart(walls: &Walls, eta: f64, at: f64, references: &[Reference]) -> Option<Chart> {
    let cp = walls.field("cp")?;
    let chains = slice(&walls.points, &walls.triangles, 1, at);
    let body = |chain: &[OnSide]| usize::from(walls.body[chain[0].corners[0] as usize]);
    let mut series = Vec::new();
    for (number, name) in walls.bodies.iter().enumerate() {
        let own: Vec<&Vec<OnSide>> = chains.iter().filter(|chain| body(chain) == number).collect();
        let along = |p: &OnSide| p.value(|i| walls.points[i as usize][0]);
        let ends = own.iter().flat_map(|c| c.iter()).map(along);
        let [front, rear] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
        let chord = rear - front;
        for (k, chain) in own.into_iter().filter(|chain| chain.len() >= SHORTEST && chord > 0.0).enumerate() {
            let x = chain.iter().map(|p| (along(p) - front) / chord).collect();
            let y = chain.iter().map(|p| p.value(|i| cp[i as usize])).collect();
            series.push(Series::new(if k == 0 { name } else { "" }, Marks::Line, x, y));
        }
    }
    if series.is_empty() {
        return None;
    }
    for Reference { curve, stations } in references {
        let near = |k: &usize| stations.get(*k).is_some_and(|s| (s - eta).abs() < SAME);
        let own: Vec<usize> = (0..curve.x.len()).filter(near).collect();
        let of = |values: &[f64]| own.iter().map(|k| values[*k]).collect();
        if !own.is_empty() {
            series.push(Series::new(&curve.name, Marks::Rings, of(&curve.x), of(&curve.y)));
        }
    }
    let title = format!("eta = {eta:.3}").trim_end_matches('0').to_owned();
    Some(Chart { title, x: Axis::linear("x/c"), y: Axis::reversed("Cp"), series })
}
