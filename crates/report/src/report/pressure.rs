//! The chapter on pressure: Cp along the chord as sections are judged by.
//!
//! Both sides of each body are lines of their own, suction is up, and the outline stands below to the scale of x. Cp* is the pressure
//! coefficient at Mach 1 in isentropic flow from the free stream, 2/(γM²) [((2 + (γ−1)M²)/(γ+1))^(γ/(γ−1)) − 1] (Anderson,
//! *Modern Compressible Flow*, section 9.3). Shocks are where the Mach number on the wall falls through 1 steeply, stagnation
//! points where Cp is greatest.
use std::path::Path;

use super::canvas::{Area, Canvas, Pen, Text};
use super::chart::{Axis, Chart, Marks, Series, Size};
use super::colour::Colour;
use super::conditions::conditions as of_stream;
use super::files::{Csv, LOADS, RunFolder};
use super::page::{Block, Fact};
use super::surface_views::title;
use super::words::{grouped, number, with_bar};
use super::{ReportError, font, last_period, stations, write_file};

/// Cp* farther up than this, in the range of Cp, would leave no room for the curves.
const FAR: f64 = 0.6;
/// A shock takes at least this from the Mach number within a few particles.
const JUMP: f64 = 0.08;
/// Particles on each side of a sonic point that its jump is measured over.
const REACH: usize = 2;
/// Of the height of the chart the outline takes at most this part.
const OUTLINE: f64 = 0.5;
/// Between the curves and the outline below them, in pixels.
const GAP: f64 = 24.0;
/// Pixels of the sheet that the curves and the outline fill, across and up.
const ROOM: [f64; 2] = [770.0, 460.0];
/// Size of the letters in the box of conditions, height of a line, and the air around them, in pixels.
const BOX_TEXT: f64 = 12.5;
const BOX_ROW: f64 = 17.0;
const BOX_AIR: f64 = 9.0;

pub(super) fn pressure(run: &RunFolder) -> Result<Vec<Block>, String> {
    let (curves, missing) = run.references();
    let mut blocks: Vec<Block> = missing.into_iter().map(Block::LeftOut).collect();
    let sections = stations::charts(run, &curves);
    if !sections.is_empty() {
        blocks.extend([Block::Facts(conditions(run)), Block::charts(sections.into_iter())]);
        return Ok(blocks);
    }
    let references = curves.into_iter().map(|reference| reference.curve).collect();
    match chart(run, references) {
        Ok(chart) => blocks.extend([Block::Facts(conditions(run)), Block::sized_chart(chart, Size::TALL)]),
        Err(reason) => blocks.insert(0, Block::LeftOut(reason)),
    }
    Ok(blocks)
}

/// Cp of the surface along the chord beside the references.
pub(super) fn chart(run: &RunFolder, references: Vec<Series>) -> Result<Chart, String> {
    let table = run.table("surface.csv")?;
    let three_d = table.numbers("nz").is_some_and(|nz| nz.iter().any(|n| n.abs() > 1e-9));
    if three_d && references.is_empty() {
        return Err("a curve of Cp needs a two-dimensional body; pictures show the pressure of this one".to_owned());
    }
    let bodies = if three_d { Vec::new() } else { Body::all(&table) };
    let mut series: Vec<Series> = bodies.iter().flat_map(Body::curves).collect();
    series.extend(references);
    series.extend(sonic(run, &series));
    let marks: Vec<Series> = bodies.iter().flat_map(Body::marks).collect();
    let outlines = outlines(&bodies, &series);
    series.extend(marks);
    series.extend(outlines);
    Ok(Chart { title: "Pressure coefficient".into(), x: Axis::linear("x/c"), y: Axis::reversed("Cp"), series })
}

/// What the curve belongs to.
fn conditions(run: &RunFolder) -> Vec<Fact> {
    let summary = run.json("summary.json").unwrap_or_default();
    let mut facts = of_stream(&summary);
    let at = last_period::at(&summary).map_or_else(String::new, |at| format!(" {at}"));
    for load in LOADS {
        let told = |table: &str| summary[table][load.column].as_f64();
        let bar = told("loads_error");
        let text = |value| bar.map_or_else(|| number(value), |bar| with_bar(value, bar));
        let fact = |value| Fact::new(&format!("{}{at}", load.name), text(value));
        facts.extend(told("loads").map(fact));
    }
    facts.extend(summary["particles"].as_f64().map(|n| Fact::new("Particles", grouped(n))));
    facts
}

/// Draws the chart with what it belongs to in a box, `pictures/cp-chord`.
pub fn write_pressure(run: &Path) -> Result<(), ReportError> {
    let folder = RunFolder::new(run);
    let references = folder.references().0.into_iter().map(|reference| reference.curve).collect();
    let Ok(chart) = chart(&folder, references) else { return Ok(()) };
    let chart = Chart { title: format!("Pressure coefficient: {}", title(&folder)), ..chart };
    let mut canvas = chart.draw(Size::TALL);
    let lines: Vec<String> = conditions(&folder)
        .into_iter()
        .map(|fact| format!("{}  {}", fact.name, fact.value.replace('\u{202f}', " ")))
        .collect();
    boxed(&mut canvas, &chart.area(Size::TALL), &lines);
    write_file(&run.join("pictures/cp-chord.svg"), canvas.svg()?.as_bytes())?;
    write_file(&run.join("pictures/cp-chord.png"), &canvas.png(2.0)?)
}

/// Lines in a box in the upper right corner of `area`, where curves of Cp seldom come.
fn boxed(canvas: &mut Canvas, area: &Area, lines: &[String]) {
    let widest = lines.iter().map(|line| font::width(line)).fold(0.0, f64::max) * BOX_TEXT * font::OTHER_FONTS;
    let (width, height) = (widest + 2.0 * BOX_AIR, lines.len() as f64 * BOX_ROW + BOX_AIR);
    let corner = [area.x + area.width - width - BOX_AIR, area.y + BOX_AIR];
    let frame = Area { x: corner[0], y: corner[1], width, height };
    canvas.layer("conditions", None);
    canvas.rectangle(frame, Some(Colour::PAPER.faded(230)), Some(Pen::new(Colour::GREY, 1.0)));
    for (k, line) in lines.iter().enumerate() {
        let at = [corner[0] + BOX_AIR, corner[1] + (k + 1) as f64 * BOX_ROW];
        canvas.text(Text::new(line, at, BOX_TEXT));
    }
}

fn case(run: &RunFolder) -> toml::Table {
    run.text("case.toml").ok().and_then(|text| text.parse().ok()).unwrap_or_default()
}

/// Cp* across the chart, where it is near the curves.
fn sonic(run: &RunFolder, series: &[Series]) -> Option<Series> {
    let case = case(run);
    let flow = |key: &str| {
        let value = case.get("flow")?.get(key)?;
        value.as_float().or_else(|| value.as_integer().map(|v| v as f64))
    };
    let critical = critical_cp(flow("mach")?, flow("gamma").unwrap_or(1.4))?;
    let [[left, right], [low, high]] = [range(series, |s| &s.x)?, range(series, |s| &s.y)?];
    let near = low - critical < FAR * (high - low) && critical < high;
    near.then(|| Series::new(&format!("Cp* {critical:.3}"), Marks::Dashes, vec![left, right], vec![critical; 2]))
}

/// Cp where the flow is as fast as sound; `None` in supersonic streams.
fn critical_cp(mach: f64, gamma: f64) -> Option<f64> {
    let ratio = (2.0 + (gamma - 1.0) * mach * mach) / (gamma + 1.0);
    let cp = 2.0 / (gamma * mach * mach) * (ratio.powf(gamma / (gamma - 1.0)) - 1.0);
    (0.0 < mach && mach < 1.0 && cp.is_finite()).then_some(cp)
}

/// Smallest and largest of all values; `None` where there is no range.
fn range(series: &[Series], values: fn(&Series) -> &Vec<f64>) -> Option<[f64; 2]> {
    let all = series.iter().flat_map(values).copied().filter(|v| v.is_finite());
    let [low, high] = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
    (low < high).then_some([low, high])
}

/// A particle on the wall.
#[derive(Clone, Copy)]
struct WallPoint {
    x: f64,
    height: f64,
    cp: f64,
    mach: f64,
}

/// The outline of a body.
struct Body {
    name: String,
    /// Sides from the front to the rear, the upper one first.
    sides: [Vec<WallPoint>; 2],
}

impl Body {
    /// All bodies of `surface.csv`, whose rows follow the outline of each.
    fn all(table: &Csv) -> Vec<Self> {
        let column = |name: &str| table.numbers(name);
        let (Some(x), Some(cp)) = (column("x_c"), column("cp")) else { return Vec::new() };
        let (place, height) = (column("x").unwrap_or_default(), column("y").unwrap_or_default());
        let mach = column("mach").unwrap_or_default();
        let names = table.column("body").unwrap_or_else(|| vec!["surface"; x.len()]);
        let extent = |values: &[f64]| {
            values.iter().fold(f64::NEG_INFINITY, |m, v| m.max(*v))
                - values.iter().fold(f64::INFINITY, |m, v| m.min(*v))
        };
        let chord = extent(&place) / extent(&x);
        let scale = if chord.is_finite() && chord > 0.0 { 1.0 / chord } else { 1.0 };
        let at = |of: &[f64], k: usize| of.get(k).copied().unwrap_or(f64::NAN);
        let point =
            |k: usize| WallPoint { x: x[k], height: scale * at(&height, k), cp: at(&cp, k), mach: at(&mach, k) };
        let mut own: Vec<&str> = names.clone();
        own.sort_unstable();
        own.dedup();
        let body = |name: &str| {
            let points: Vec<WallPoint> = (0..x.len()).filter(|k| names[*k] == name).map(point).collect();
            let label = if name.parse::<u32>().is_ok() { format!("body {name}") } else { name.to_owned() };
            Self { name: label, sides: sides(points) }
        };
        own.into_iter().map(body).collect()
    }

    /// Cp on both sides.
    fn curves(&self) -> Vec<Series> {
        let curve = |(side, points): (&str, &Vec<WallPoint>)| {
            let (x, y) = points.iter().map(|p| (p.x, p.cp)).unzip();
            Series::new(&format!("{}, {side}", self.name), Marks::Line, x, y)
        };
        ["upper", "lower"].into_iter().zip(&self.sides).map(curve).collect()
    }

    /// The stagnation point, and the shocks of both sides.
    fn marks(&self) -> Vec<Series> {
        let ring = |name: String, [x, y]: [f64; 2]| Series::new(&name, Marks::Rings, vec![x], vec![y]);
        let all = self.sides.iter().flatten().filter(|p| p.cp.is_finite());
        let stagnation = all.max_by(|a, b| a.cp.total_cmp(&b.cp)).map(|p| [p.x, p.cp]);
        let stagnation = stagnation.map(|at| ring(format!("stagnation, x/c {:.4}", at[0]), at));
        let shocks = self.sides.iter().flat_map(|side| shocks(side));
        stagnation.into_iter().chain(shocks.map(|at| ring(format!("shock, x/c {:.3}", at[0]), at))).collect()
    }

    /// Largest and smallest height.
    fn heights(&self) -> [f64; 2] {
        self.sides
            .iter()
            .flatten()
            .fold([f64::NEG_INFINITY, f64::INFINITY], |[a, b], p| [a.max(p.height), b.min(p.height)])
    }
}

/// An outline cut where it is foremost and where it is rearmost; the part that lies higher comes first.
fn sides(mut outline: Vec<WallPoint>) -> [Vec<WallPoint>; 2] {
    let by_x = |a: &(usize, &WallPoint), b: &(usize, &WallPoint)| a.1.x.total_cmp(&b.1.x);
    let Some((rear, _)) = outline.iter().enumerate().max_by(by_x) else { return [Vec::new(), Vec::new()] };
    outline.rotate_left(rear);
    let front = outline.iter().enumerate().min_by(by_x).map_or(0, |(k, _)| k);
    let mut first = outline[..=front].to_vec();
    let second = outline[front..].to_vec();
    first.reverse();
    let mean = |side: &[WallPoint]| side.iter().map(|p| p.height).sum::<f64>() / side.len().max(1) as f64;
    if mean(&first) >= mean(&second) { [first, second] } else { [second, first] }
}

/// Where the Mach number of a side, from front to rear, falls through 1 steeply: x/c and Cp there.
fn shocks(side: &[WallPoint]) -> Vec<[f64; 2]> {
    let at = |k: usize| {
        let (a, b) = (side[k], side[k + 1]);
        let part = (a.mach - 1.0) / (a.mach - b.mach);
        [a.x + part * (b.x - a.x), a.cp + part * (b.cp - a.cp)]
    };
    let falls = |k: &usize| {
        let (before, after) = (side[k.saturating_sub(REACH)], side[(k + 1 + REACH).min(side.len() - 1)]);
        side[*k].mach >= 1.0 && side[k + 1].mach < 1.0 && before.mach - after.mach > JUMP
    };
    (0..side.len().saturating_sub(1)).filter(falls).map(at).collect()
}

/// The bodies below the curves, where a unit of x is as long up as it is across; nothing where they would take too much room.
fn outlines(bodies: &[Body], curves: &[Series]) -> Vec<Series> {
    let (Some([left, right]), Some([low, high])) = (range(curves, |s| &s.x), range(curves, |s| &s.y)) else {
        return Vec::new();
    };
    let [top, bottom] = bodies
        .iter()
        .map(Body::heights)
        .fold([f64::NEG_INFINITY, f64::INFINITY], |[a, b], h| [a.max(h[0]), b.min(h[1])]);
    let unit = ROOM[0] / (right - left);
    let tall = (top - bottom) * unit;
    if !(0.0 < tall && tall <= OUTLINE * ROOM[1]) {
        return Vec::new();
    }
    let pixel = (high - low) / (ROOM[1] - GAP - tall);
    let place = |height: f64| high + (GAP + (top - height) * unit) * pixel;
    let outline = |body: &Body| {
        let around = body.sides[0].iter().rev().chain(&body.sides[1]);
        let (x, y) = around.map(|p| (p.x, place(p.height))).unzip();
        Series::new("", Marks::Line, x, y).closed()
    };
    bodies.iter().map(outline).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test] // Anderson, section 9.3: Cp* is -0.435 at Mach 0.8
    fn critical_pressure_is_that_of_the_books() {
        assert!((critical_cp(0.8, 1.4).unwrap() + 0.4346).abs() < 1e-4);
        assert!(critical_cp(0.0, 1.4).is_none() && critical_cp(1.2, 1.4).is_none());
    }

    /// A section from the rear over the upper side to the front and back, with a shock at 0.6.
    fn section() -> Vec<WallPoint> {
        let point = |k: u32| {
            let angle = std::f64::consts::TAU * (f64::from(k) + 0.5) / 200.0;
            let x = 0.5 + 0.5 * angle.cos();
            let mach = if angle.sin() > 0.0 && x > 0.1 && x < 0.6 { 1.3 } else { 0.7 };
            WallPoint { x, height: 0.06 * angle.sin(), cp: 1.0 - x, mach }
        };
        (0..200).map(point).collect()
    }

    #[test]
    fn an_outline_has_two_sides_from_front_to_rear() {
        for turned in [0, 30, 117, 199] {
            let mut outline = section();
            outline.rotate_left(turned);
            let [upper, lower] = sides(outline);
            assert!((upper.len() as i32 - 100).abs() <= 1 && (lower.len() as i32 - 100).abs() <= 1);
            assert!(upper.windows(2).chain(lower.windows(2)).all(|w| w[0].x <= w[1].x + 1e-12), "{turned}");
            assert!(upper[50].height > 0.0 && lower[50].height < 0.0);
        }
        assert!(sides(Vec::new()).iter().all(Vec::is_empty));
    }

    #[test]
    fn shocks_and_stagnation_points_are_found() {
        let body = Body { name: "a".into(), sides: sides(section()) };
        assert!(shocks(&body.sides[1]).is_empty());
        let found = shocks(&body.sides[0]);
        assert!(found.len() == 1 && (found[0][0] - 0.6).abs() < 0.02, "{found:?}");
        let marks = body.marks();
        assert!(marks.len() == 2 && marks[0].name.starts_with("stagnation, x/c 0.000"), "{}", marks[0].name);
    }
}
