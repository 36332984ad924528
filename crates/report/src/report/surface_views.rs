//! Pictures of the pressure on the walls of a run in space: one sheet with six views, and the view from ahead alone.
//!
//! Half models stand with their mirror image. All views share the colours; each is as large as it fits. Below the title are the
//! conditions of the run.
use std::path::Path;

use super::ReportError;
use super::axes::draw_title;
use super::canvas::{Area, Canvas, Text};
use super::colour::{Colormap, Colour};
use super::files::{LOADS, RunFolder};
use super::last_period;
use super::picture::colour_bar;
use super::surface::{Shell, SurfaceStyle, draw_surface, seen};
use super::surface_viewer::TOLD;
use super::walls::Walls;
use super::words::{grouped, number};
use super::write_file;
use crate::math::Vector;

/// Name of a view, direction from the eye to the walls, what points upwards; x runs downstream, z up.
const VIEWS: [(&str, [f64; 3], [f64; 3]); 6] = [
    ("from ahead", [1.0, 0.8, -0.68], [0.0, 0.0, 1.0]),
    ("top", [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]),
    ("bottom", [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]),
    ("side", [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
    ("front", [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
    ("rear", [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
];
/// Views in a row of the sheet.
const ACROSS: usize = 3;
/// Area of each.
const CELL: [f64; 2] = [400.0, 340.0];
/// Room above and below what a row shows.
const ROOM: f64 = 160.0;
/// Left of the views, and above them.
const MARGIN: [f64; 2] = [24.0, 72.0];
/// Right of the views: the colour bar.
const BAR: f64 = 110.0;
/// Samples per unit of the sheet.
const SHARPNESS: f64 = 2.0;

/// Draws `pictures/surface-views.png` and `pictures/cp.png` of a run in space that has walls, from its files.
pub fn write_surface_views(run: &Path) -> Result<(), ReportError> {
    let folder = RunFolder::new(run);
    let Some(walls) = Walls::of(&folder) else { return Ok(()) };
    let walls = walls.mirrored();
    let words = [title(&folder), conditions(&folder)];
    let all: Vec<usize> = (0..VIEWS.len()).collect();
    let sheets = [("surface-views", all, CELL), ("cp", vec![0], [820.0, 560.0])];
    for (name, views, cell) in sheets {
        if let Some(canvas) = sheet(&walls, &words, &views, cell)? {
            write_file(&run.join(format!("pictures/{name}.png")), &canvas.png(SHARPNESS)?)?;
        }
    }
    Ok(())
}

/// The views with these numbers side by side.
fn sheet(walls: &Walls, words: &[String; 2], views: &[usize], cell: [f64; 2]) -> Result<Option<Canvas>, ReportError> {
    let Some((_, quantity, symbol, _)) = TOLD.into_iter().find(|(name, ..)| *name == "cp") else { return Ok(None) };
    let Some(values) = walls.field("cp") else { return Ok(None) };
    let Walls { points, normals, triangles, .. } = walls;
    let shell = Shell::Triangles { points, triangles, values, normals };
    let across = ACROSS.min(views.len());
    let row_of = |row: &[usize]| row.iter().map(|k| tallness(points, *k)).fold(0.0, f64::max) * cell[0] + ROOM;
    let heights: Vec<f64> = views.chunks(across).map(|row| row_of(row).min(cell[1])).collect();
    let height = heights.iter().sum();
    let all = Area { x: MARGIN[0], y: MARGIN[1], width: across as f64 * cell[0], height };
    let mut canvas = Canvas::new(all.x + all.width + BAR, all.y + all.height + MARGIN[0]);
    draw_title(&mut canvas, &format!("{quantity}: {}", words[0]), [all.x, 30.0]);
    let room = canvas.width - all.x;
    canvas.text(Text { colour: Colour::GREY, ..Text::new(words[1].as_str(), [all.x, 54.0], 13.0) }.within(room));
    let (map, range) = (Colormap::Diverging { centre: 0.0 }, Walls::range(values));
    for (k, view) in views.iter().enumerate() {
        let (name, direction, up) = VIEWS[*view];
        let at = [all.x + (k % across) as f64 * cell[0], all.y + heights[..k / across].iter().sum::<f64>()];
        let area = Area { x: at[0], y: at[1], width: cell[0], height: heights[k / across] };
        let (direction, up) = (Vector(direction), Vector(up));
        let style = SurfaceStyle { title: "", quantity: symbol, map, range: Some(range), direction, up };
        draw_surface(&mut canvas, area, &shell, &style)?;
        if views.len() > 1 {
            canvas.text(Text { colour: Colour::GREY, ..Text::new(name, [at[0] + 6.0, at[1] + 18.0], 13.0) });
        }
    }
    colour_bar(&mut canvas, all, map, range, symbol);
    Ok(Some(canvas))
}

/// Height over width of what a view shows.
fn tallness(points: &[Vector<3>], view: usize) -> f64 {
    let (_, direction, up) = VIEWS[view];
    let extent = seen(points, &Vector(direction), &Vector(up)).extent();
    extent[1] / extent[0].max(1e-300)
}

/// What a run is called.
pub(super) fn title(run: &RunFolder) -> String {
    let summary = run.json("summary.json").unwrap_or_default();
    summary["case"].as_str().filter(|t| !t.trim().is_empty()).unwrap_or("run without a title").to_owned()
}

/// Free stream, loads and number of particles in a line.
pub(super) fn conditions(run: &RunFolder) -> String {
    let case: toml::Table = run.text("case.toml").ok().and_then(|text| text.parse().ok()).unwrap_or_default();
    let flow = |key: &str| {
        case.get("flow").and_then(|flow| flow.get(key)).map(|value| match value {
            toml::Value::String(text) => text.clone(),
            other => other.to_string(),
        })
    };
    let of_flow = [("Mach", "mach"), ("alpha", "alpha"), ("beta", "beta"), ("Reynolds number", "reynolds")];
    let told = of_flow.into_iter().filter_map(|(name, key)| Some(format!("{name} {}", flow(key)?)));
    let summary = run.json("summary.json").unwrap_or_default();
    let load = |load: &super::files::Load| {
        let value = summary["loads"][load.column].as_f64()?;
        Some(format!("{} {}", load.name, number(value)))
    };
    let particles = summary["particles"].as_f64().map(|n| format!("{} particles", grouped(n).replace('\u{202f}', " ")));
    // loads of a march are those of an instant
    told.filter(|words| words != "beta 0 deg")
        .chain(last_period::at(&summary))
        .chain(LOADS.iter().filter_map(load))
        .chain(particles)
        .collect::<Vec<_>>()
        .join("  ·  ")
}
