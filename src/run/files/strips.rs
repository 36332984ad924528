//! The table and the chart of loads along the span.
use std::path::Path;

use crate::observe::strips::{Span, Strip, Strips};
use crate::observe::table::{Entry, write_csv};
use crate::problem::RunError;
use crate::report::{Axis, Chart, Marks, Series, write_file};
use crate::scheme::start::free_stream;
use crate::study::found::Found;

/// Name of the table.
pub(crate) const FILE: &str = "strips.csv";
const COLUMNS: [&str; 20] = [
    "body",
    "axis",
    "station",
    "width",
    "chord",
    "x_quarter",
    "section_cl",
    "section_cd",
    "section_cm",
    "loading",
    "cl",
    "cd",
    "cm",
    "fx",
    "fy",
    "fz",
    "station_in",
    "shear_force",
    "bending_moment",
    "torsion_moment",
];

/// Writes the strips of all bodies; nothing where there are none.
pub(super) fn write_table<const D: usize>(found: &Found<'_, D>, out: &Path) -> Result<(), RunError> {
    if found.strips.is_empty() {
        return Ok(());
    }
    let pressure = found.case.flow.units().pressure();
    let rows = found.strips.iter().flat_map(|body| body.across().into_iter().map(move |strip| (body, strip)));
    let rows = rows.map(|(body, strip)| {
        let chord = strip.section.chord;
        let over = if chord > 0.0 { 1.0 / (dynamic(found) * chord * strip.width()) } else { f64::NAN };
        let along = |d: &[f64; 3]| (0..3).map(|k| strip.load.force[k] * d[k]).sum::<f64>();
        let c = strip.load.coefficients(&found.axes);
        let inner = strip.internal(body.span);
        let numbers = [
            strip.middle(),
            strip.width(),
            chord,
            strip.section.quarter[0],
            lift(found, body.span, strip) * over,
            along(&found.axes.drag) * over,
            body.span.nose_up(&strip.load, &strip.section.quarter) * over / chord,
            loading(found, body.span, strip),
            c.cl,
            c.cd,
            c.cm,
        ];
        let mut row =
            vec![Entry::from(body.body.as_str()), Entry::from(if body.span == Span::Lying { "y" } else { "z" })];
        row.extend(numbers.map(Entry::from));
        row.extend(strip.load.force.map(|f| Entry::from(f * pressure)));
        row.push(Entry::from(strip.ends[0]));
        row.extend([inner.shear, inner.bending, inner.torsion].map(|v| Entry::from(v * pressure)));
        row
    });
    Ok(write_csv(&out.join(FILE), &COLUMNS, rows)?)
}

/// Dynamic pressure of the free stream.
fn dynamic<const D: usize>(found: &Found<'_, D>) -> f64 {
    let free = free_stream::<D>(found.case);
    0.5 * free.density * free.velocity.norm_squared()
}

/// Lift of a strip, of a fin the force along y.
fn lift<const D: usize>(found: &Found<'_, D>, span: Span, strip: &Strip) -> f64 {
    match span {
        Span::Lying => (0..3).map(|k| strip.load.force[k] * found.axes.lift[k]).sum(),
        Span::Upright => strip.load.force[1],
    }
}

/// c cl/c_ref: lift for a unit of span over dynamic pressure and reference chord.
fn loading<const D: usize>(found: &Found<'_, D>, span: Span, strip: &Strip) -> f64 {
    lift(found, span, strip) / (dynamic(found) * found.axes.chord * strip.width())
}

/// Draws the load along the span of all that lies or stands, and the ellipse of the same lift as what lies.
pub(super) fn write_chart<const D: usize>(found: &Found<'_, D>, out: &Path) -> Result<(), RunError> {
    // what is neither wing nor fin has strips too, and a load where it lies
    let drawn = |s: &&Strips| s.span == Span::Lying || s.lifting;
    let all: Vec<(&Strips, Vec<&Strip>)> = found.strips.iter().filter(drawn).map(|s| (s, s.across())).collect();
    let lying = || all.iter().filter(|(body, _)| body.span == Span::Lying);
    if lying().next().is_none() {
        return Ok(());
    }
    let curve = |(body, strips): &(&Strips, Vec<&Strip>)| {
        let y = strips.iter().map(|strip| loading(found, body.span, strip)).collect();
        Series::new(&body.body, Marks::Line, strips.iter().map(|strip| strip.middle()).collect(), y)
    };
    let mut series: Vec<Series> = all.iter().map(curve).collect();
    let edges = lying().flat_map(|(_, strips)| strips.iter().flat_map(|s| s.ends));
    let ends = edges.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], s| [a.min(s), b.max(s)]);
    let upright = lying().count() < all.len();
    series.extend(found.span_load.as_ref().map(|load| {
        let (y, value) = load.ellipse(ends).into_iter().map(|[y, value]| (y, value)).unzip();
        Series::new("ellipse of the same lift", Marks::Dashes, y, value)
    }));
    let along = if upright { "y, of fins z" } else { "y" };
    let (x, y) = (Axis::linear(along), Axis::linear("c cl / c_ref"));
    let chart = Chart { title: "Load along the span".into(), x, y, series };
    write_file(&out.join("pictures/span-loading.svg"), chart.svg()?.as_bytes())?;
    Ok(write_file(&out.join("pictures/span-loading.png"), &chart.png()?)?)
}
