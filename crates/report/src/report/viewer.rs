//! The field viewer: particles of a plane run, the triangles between them and the state of the gas, for the script of the page.
//!
//! A steady run has one frame, one with files of a series a frame for each, a harmonic balance its mean and harmonics, from
//! which the script makes any phase. All quantities but vorticity are computed on the page from density, velocity, pressure and
//! the free stream.
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use serde_json::Value;

use super::colour::Colormap;
use super::files::RunFolder;
use super::page::Block;
use super::words::number;
use crate::observe::vtk::read_collection;
use crate::observe::vtk_read::FieldFile;

/// Bytes of numbers that a page holds; what is far from the bodies goes first.
const MOST_BYTES: usize = 8_000_000;
/// Frames of a series that a page holds.
const MOST_FRAMES: usize = 24;
/// From one field of a film to the next.
const DEGREES: u32 = 30;
/// Margins around the bodies that are tried, in their longer side.
const MARGINS: [f64; 8] = [4.0, 3.0, 2.0, 1.5, 1.0, 0.6, 0.3, 0.15];
/// Margin of what is seen first.
const FIRST_SIGHT: f64 = 0.6;
/// Harmonics that are drawn.
const MOST_HARMONICS: usize = 16;
/// Entries of a colour scale.
const COLOURS: usize = 256;

/// What the script of the page gets.
#[derive(Serialize)]
struct Data {
    /// Density, pressure, speed, ratio of specific heats.
    free: Value,
    /// What the numbers of a particle are, in their order.
    columns: Vec<&'static str>,
    /// Window of the first sight: least x and y, greatest x and y.
    window: [f64; 4],
    frames: Vec<Frame>,
    /// Colours of the scales, red, green, blue after one another.
    sequential: String,
    diverging: String,
}

/// A moment, or all phases of a period.
#[derive(Serialize)]
struct Frame {
    /// What the slider tells; empty for a period.
    label: String,
    particles: usize,
    /// Triangles of particles; empty when they are those of the frame before.
    triangles: String,
    /// Sides along bodies.
    walls: String,
    /// For each column the numbers of all particles: first the mean, then real and imaginary part of each harmonic.
    terms: Vec<String>,
}

/// The chapter's first block, or the word why there is none; nothing at all for runs in space.
pub(super) fn viewer(run: &RunFolder) -> Option<Block> {
    let summary = run.json("summary.json").ok()?;
    let free = summary.get("free_stream").filter(|free| free.is_object())?.clone();
    let sources = Source::of(run)?;
    match data(&sources, free) {
        Ok(data) => Some(Block::Viewer(serde_json::to_string(&data).ok()?.replace('<', "\\u003c"))),
        Err(reason) => Some(Block::LeftOut(reason)),
    }
}

fn data(sources: &[Source], free: Value) -> Result<Data, String> {
    let bodies = sources.iter().filter_map(Source::bodies).reduce(Window::with);
    let all = || sources.iter().map(|s| Window::of(&s.points)).reduce(Window::with);
    let seen = bodies.or_else(all).ok_or("the field has no particles")?;
    let bytes = |window: &Window| sources.iter().map(|s| s.bytes(window)).sum::<usize>();
    let mut windows = vec![Window::EVERYTHING];
    windows.extend(bodies.into_iter().flat_map(|b| MARGINS.map(|margin| b.padded(margin))));
    let window = windows.iter().find(|w| bytes(w) <= MOST_BYTES);
    let window = window
        .ok_or("the field viewer, for the field has more particles than a page holds: open `field.vtu` in ParaView")?;
    let first = if bodies.is_some() { seen.padded(FIRST_SIGHT) } else { seen };
    let mut frames: Vec<Frame> = sources.iter().map(|s| s.frame(window)).collect();
    for k in (1..frames.len()).rev() {
        if frames[k].triangles == frames[k - 1].triangles {
            frames[k].triangles.clear();
            frames[k].walls.clear();
        }
    }
    let scale = |map: Colormap| {
        let end = (COLOURS - 1) as f64;
        let colours = (0..COLOURS).map(|k| map.colour(k as f64, [0.0, end]));
        STANDARD.encode(colours.flat_map(|c| [c.r, c.g, c.b]).collect::<Vec<u8>>())
    };
    Ok(Data {
        free,
        columns: sources[0].columns.clone(),
        window: [first.low[0], first.low[1], first.high[0], first.high[1]],
        frames,
        sequential: scale(Colormap::Sequential),
        diverging: scale(Colormap::Diverging { centre: 0.5 * (COLOURS - 1) as f64 }),
    })
}

/// A rectangle of the plane.
#[derive(Clone, Copy)]
struct Window {
    low: [f64; 2],
    high: [f64; 2],
}

impl Window {
    const EVERYTHING: Self = Self { low: [f64::NEG_INFINITY; 2], high: [f64::INFINITY; 2] };
    const NOTHING: Self = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    fn of(points: &[[f64; 2]]) -> Self {
        points.iter().fold(Self::NOTHING, |window, p| window.with(Self { low: *p, high: *p }))
    }

    fn with(self, other: Self) -> Self {
        Self {
            low: [0, 1].map(|d| self.low[d].min(other.low[d])),
            high: [0, 1].map(|d| self.high[d].max(other.high[d])),
        }
    }

    fn padded(&self, margin: f64) -> Self {
        let width = margin * (self.high[0] - self.low[0]).max(self.high[1] - self.low[1]);
        Self { low: self.low.map(|x| x - width), high: self.high.map(|x| x + width) }
    }

    fn contains(&self, p: &[f64; 2]) -> bool {
        (0..2).all(|d| self.low[d] <= p[d] && p[d] <= self.high[d])
    }
}

/// The particles of a file.
struct Source {
    label: String,
    columns: Vec<&'static str>,
    /// Places at which windows look.
    points: Vec<[f64; 2]>,
    triangles: Vec<[u32; 3]>,
    /// Sides of triangles along bodies.
    walls: Vec<[u32; 2]>,
    /// For each term the numbers of all particles, column after column.
    terms: Vec<Vec<Vec<f64>>>,
}

impl Source {
    /// All frames of a run, `None` without triangles.
    fn of(run: &RunFolder) -> Option<Vec<Self>> {
        let open = |name: &str| FieldFile::open(&run.path.join(name)).ok();
        if let Some(found) = open("field_harmonics.vtu").as_ref().and_then(Self::harmonics) {
            return Some(vec![found]);
        }
        let listed = |name: &str| read_collection(&run.text(name).unwrap_or_default());
        let mut series = listed("film.pvd");
        if series.len() < 2 {
            series = listed("series.pvd");
        }
        let stride = series.len().div_ceil(MOST_FRAMES).max(1);
        // the last one is always there
        series = series.into_iter().rev().step_by(stride).collect();
        series.reverse();
        let frame = |(time, name): &(f64, String)| {
            let time = format!("t = {}", number(*time));
            let part = name.strip_prefix("film-").and_then(|rest| rest.strip_suffix(".vtu")?.parse::<u32>().ok());
            let label = part.map_or_else(|| time.clone(), |k| format!("phase {}°, {time}", k * DEGREES % 360));
            Self::moment(&open(name)?, label)
        };
        let frames: Option<Vec<Self>> = series.iter().map(frame).collect();
        match frames {
            Some(frames) if frames.len() > 1 => Some(frames),
            _ => Some(vec![Self::moment(&open("field.vtu")?, String::new())?]),
        }
    }

    fn moment(file: &FieldFile, label: String) -> Option<Self> {
        let points = file.points()?;
        let vector =
            |name: &str, d: usize| Some(file.values(name)?.chunks_exact(3).map(|v| v[d]).collect::<Vec<f64>>());
        let term = vec![
            points.iter().map(|x| x[0]).collect(),
            points.iter().map(|x| x[1]).collect(),
            file.values("density")?,
            vector("velocity", 0)?,
            vector("velocity", 1)?,
            file.values("pressure")?,
            vector("vorticity", 2)?,
        ];
        let columns = vec!["x", "y", "density", "u", "v", "pressure", "vorticity"];
        Self::new(label, columns, &points, file.triangles()?, vec![term])
    }

    /// Mean and harmonics; places are those before any motion and what the motion adds.
    fn harmonics(file: &FieldFile) -> Option<Self> {
        let (points, triangles) = (file.points()?, file.triangles()?);
        let own = ["displacement_x", "displacement_y", "density", "velocity_x", "velocity_y", "pressure"];
        let column =
            |ending: &str| own.iter().map(|name| file.values(&format!("{name}_{ending}"))).collect::<Option<Vec<_>>>();
        let mut mean = column("mean")?;
        for d in 0..2 {
            mean[d].iter_mut().zip(&points).for_each(|(shift, x)| *shift += x[d]);
        }
        let mut terms = vec![mean];
        for n in 1..=MOST_HARMONICS {
            let (Some(re), Some(im)) = (column(&format!("{n}_re")), column(&format!("{n}_im"))) else { break };
            terms.extend([re, im]);
        }
        let columns = vec!["x", "y", "density", "u", "v", "pressure"];
        Self::new(String::new(), columns, &points, triangles, terms)
    }

    fn new(
        label: String,
        columns: Vec<&'static str>,
        points: &[[f64; 3]],
        triangles: Vec<[u32; 3]>,
        terms: Vec<Vec<Vec<f64>>>,
    ) -> Option<Self> {
        let whole = terms.iter().flatten().all(|values| values.len() == points.len());
        let known = triangles.iter().flatten().all(|i| (*i as usize) < points.len());
        if triangles.is_empty() || !whole || !known {
            return None;
        }
        let points: Vec<[f64; 2]> = points.iter().map(|x| [x[0], x[1]]).collect();
        let walls = walls(&points, &triangles);
        Some(Self { label, columns, points, triangles, walls, terms })
    }

    /// What the bodies take, `None` without any.
    fn bodies(&self) -> Option<Window> {
        let ends: Vec<[f64; 2]> = self.walls.iter().flatten().map(|i| self.points[*i as usize]).collect();
        (!ends.is_empty()).then(|| Window::of(&ends))
    }

    /// The number that each particle has among those of triangles inside `window`, and how many there are.
    fn kept(&self, window: &Window) -> (Vec<Option<u32>>, Vec<[u32; 3]>) {
        let inside: Vec<bool> = self.points.iter().map(|p| window.contains(p)).collect();
        let mut number = vec![None; self.points.len()];
        let within = |t: &&[u32; 3]| t.iter().all(|i| inside[*i as usize]);
        let triangles: Vec<[u32; 3]> = self.triangles.iter().filter(within).copied().collect();
        triangles.iter().flatten().for_each(|i| number[*i as usize] = Some(0));
        number.iter_mut().flatten().enumerate().for_each(|(k, own)| *own = k as u32);
        (number, triangles)
    }

    fn bytes(&self, window: &Window) -> usize {
        let (number, triangles) = self.kept(window);
        let own = self.terms.iter().map(Vec::len).sum::<usize>() * size_of::<f32>();
        number.iter().flatten().count() * own + triangles.len() * size_of::<[u32; 3]>()
    }

    fn frame(&self, window: &Window) -> Frame {
        let (number, triangles) = self.kept(window);
        let indices = |all: &[u32]| {
            let of = |i: &u32| number[*i as usize].unwrap_or_default().to_le_bytes();
            STANDARD.encode(all.iter().flat_map(of).collect::<Vec<u8>>())
        };
        let seen = |side: &&[u32; 2]| side.iter().all(|i| number[*i as usize].is_some());
        let walls: Vec<[u32; 2]> = self.walls.iter().filter(seen).copied().collect();
        let numbers = |term: &Vec<Vec<f64>>| {
            let of = |values: &Vec<f64>| {
                let known = number.iter().zip(values).filter(|(n, _)| n.is_some());
                known.flat_map(|(_, v)| (*v as f32).to_le_bytes()).collect::<Vec<u8>>()
            };
            STANDARD.encode(term.iter().flat_map(of).collect::<Vec<u8>>())
        };
        Frame {
            label: self.label.clone(),
            particles: number.iter().flatten().count(),
            triangles: indices(triangles.as_flattened()),
            walls: indices(walls.as_flattened()),
            terms: self.terms.iter().map(numbers).collect(),
        }
    }
}

/// Sides that one triangle has alone, but for those around the domain.
fn walls(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut sides: Vec<[u32; 2]> = triangles.iter().flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]).collect();
    sides.sort_unstable_by_key(|[a, b]| [*a.min(b), *a.max(b)]);
    let same = |p: &[u32; 2], q: &[u32; 2]| [p[0].min(p[1]), p[0].max(p[1])] == [q[0].min(q[1]), q[0].max(q[1])];
    let alone = |chunk: &[[u32; 2]]| (chunk.len() == 1).then(|| chunk[0]);
    let alone: Vec<[u32; 2]> = sides.chunk_by(same).filter_map(alone).collect();
    // triangles turn to the left, so that the sides around the domain lead from one corner of it to the next
    let mut next = std::collections::HashMap::new();
    alone.iter().for_each(|[a, b]| {
        next.insert(*a, *b);
    });
    let start = (0..points.len() as u32)
        .filter(|i| next.contains_key(i))
        .min_by(|i, j| points[*i as usize][0].total_cmp(&points[*j as usize][0]));
    let mut border = vec![false; points.len()];
    let mut at = start;
    while let Some(i) = at.filter(|i| !border[*i as usize]) {
        border[i as usize] = true;
        at = next.get(&i).copied();
    }
    alone.into_iter().filter(|[a, b]| !border[*a as usize] && !border[*b as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::vtk::{About, Cells, Column, write_cells, write_collection};
    use std::path::Path;

    /// A square of 7 x 7 particles without the triangles of its middle.
    fn square() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let points = (0..49).map(|k| [f64::from(k % 7), f64::from(k / 7), 0.0]).collect();
        let cells = (0..36).filter(|k| *k != 14 && *k != 15 && *k != 20 && *k != 21);
        let corner = |k: u32| k / 6 * 7 + k % 6;
        let triangles = cells.map(corner).flat_map(|a| [[a, a + 1, a + 8], [a, a + 8, a + 7]]).collect();
        (points, triangles)
    }

    fn write(path: &Path, names: &[&str], triangles: &[[u32; 3]]) {
        let (points, _) = square();
        let values: Vec<f64> = (0..3 * points.len()).map(|k| k as f64).collect();
        let column = |name: &&'static str| {
            let components = if ["velocity", "vorticity"].contains(name) { 3 } else { 1 };
            Column { name, components, values: &values[..components * points.len()] }
        };
        let names: Vec<&'static str> = names.iter().map(|name| &*name.to_string().leak()).collect();
        let columns: Vec<Column> = names.iter().map(column).collect();
        write_cells(path, &About::default(), &points, Cells::Triangles(triangles), &columns).unwrap();
    }

    const STATE: [&str; 4] = ["density", "velocity", "pressure", "vorticity"];

    fn shown(folder: &Path) -> Value {
        std::fs::write(folder.join("summary.json"), r#"{"free_stream":{"density":1}}"#).unwrap();
        match viewer(&RunFolder::new(folder)) {
            Some(Block::Viewer(data)) => serde_json::from_str(&data).unwrap(),
            _ => panic!("no viewer"),
        }
    }

    fn decoded(text: &Value) -> Vec<u8> {
        STANDARD.decode(text.as_str().unwrap()).unwrap()
    }

    #[test]
    fn a_steady_field_has_one_frame_with_its_body() {
        let folder = tempfile::tempdir().unwrap();
        let (_, triangles) = square();
        write(&folder.path().join("field.vtu"), &STATE, &triangles);
        let data = shown(folder.path());
        let frame = &data["frames"][0];
        assert_eq!(data["frames"].as_array().unwrap().len(), 1);
        assert_eq!(decoded(&frame["triangles"]).len(), 64 * 3 * 4);
        assert_eq!(decoded(&frame["walls"]).len(), 8 * 2 * 4, "the hole of four cells has eight sides");
        assert_eq!(decoded(&frame["terms"][0]).len(), 48 * 7 * 4, "the middle one is in no triangle");
        assert_eq!(decoded(&data["sequential"]).len(), 3 * COLOURS);
        assert!(data["window"][0].as_f64().unwrap() < 2.0 && data["window"][2].as_f64().unwrap() > 4.0);
    }

    #[test]
    fn films_come_before_the_end_and_harmonics_before_films() {
        let folder = tempfile::tempdir().unwrap();
        let (at, (_, triangles)) = (|name: &str| folder.path().join(name), square());
        for name in ["field.vtu", "film-01.vtu", "film-02.vtu"] {
            write(&at(name), &STATE, &triangles);
        }
        write_collection(&at("film.pvd"), &[(0.5, "film-01.vtu"), (1.0, "film-02.vtu")]).unwrap();
        let data = shown(folder.path());
        assert_eq!(data["frames"].as_array().unwrap().len(), 2);
        assert!(data["frames"][1]["label"].as_str().unwrap().starts_with("phase 60°"));
        assert_eq!(data["frames"][1]["triangles"], "", "those of the frame before");
        let columns = ["displacement_x", "displacement_y", "density", "velocity_x", "velocity_y", "pressure"];
        let names: Vec<String> =
            ["mean", "1_re", "1_im"].iter().flat_map(|end| columns.map(|name| format!("{name}_{end}"))).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        write(&at("field_harmonics.vtu"), &names, &triangles);
        assert_eq!(shown(folder.path())["frames"][0]["terms"].as_array().unwrap().len(), 3);
    }

    #[test]
    fn what_is_far_away_goes_first() {
        let (points, triangles) = square();
        let column: Vec<f64> = vec![0.0; points.len()];
        let source = Source::new(String::new(), vec!["x"], &points, triangles, vec![vec![column]]).unwrap();
        let near = source.bodies().unwrap().padded(0.5);
        let (number, kept) = source.kept(&near);
        assert_eq!((number.iter().flatten().count(), kept.len()), (24, 24));
        assert!(source.bytes(&near) < source.bytes(&Window::EVERYTHING));
        assert!(Source::new(String::new(), vec!["x"], &points, vec![[0, 1, 99]], vec![]).is_none());
    }
}
