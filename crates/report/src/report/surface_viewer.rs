//! The viewer of surfaces: walls of a run in space and the gas there, for the script of the page, which turns and colours them.
//!
//! Places are whole numbers of 16 bits over the box around the walls, normals of 8 bits, values of 16 bits between the least and
//! the greatest of their field, but for what is far out; corners of triangles are 24 bits each. Walls beyond [`MOST`] triangles are thinned out.
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use super::colour::Colormap;
use super::files::RunFolder;
use super::page::Block;
use super::walls::Walls;

/// Most triangles that a page holds: about 4 MB of text with five fields.
const MOST: usize = 200_000;
/// Entries of a colour scale.
const COLOURS: usize = 256;
/// Values farther than this beyond the ends of the colours, in what the colours span, are told as if they were there.
const WIDEST: f64 = 3.0;
/// Steps of places and values.
const STEPS: f64 = 65_535.0;

/// What the script of the page gets.
#[derive(Serialize)]
struct Data<'a> {
    /// Number of corners.
    points: usize,
    /// Lowest and highest corner of the box.
    low: [f64; 3],
    high: [f64; 3],
    /// x, y, z of each corner, 16 bits each.
    places: String,
    /// Normals, 8 bits with sign each.
    normals: String,
    /// Corners of triangles, 24 bits each.
    triangles: String,
    /// Body of each corner, 8 bits.
    body: String,
    bodies: &'a [String],
    /// Axis and place of each plane of symmetry.
    mirrors: Vec<(usize, f64)>,
    fields: Vec<Field>,
    /// Colours of the scales, red, green, blue after one another.
    sequential: String,
    diverging: String,
    /// Particles and triangles that were left out.
    thinned: bool,
}

/// Values on the walls.
#[derive(Serialize)]
struct Field {
    name: &'static str,
    /// What the colour bar says.
    symbol: &'static str,
    /// Middle of the colours, where there is one.
    middle: Option<f64>,
    /// Least and greatest value: those of 0 and of the greatest number.
    low: f64,
    high: f64,
    /// Ends of the colours.
    from: f64,
    to: f64,
    values: String,
}

/// Name of a field in files, on the page, at the colour bar; the middle of its colours.
pub(super) const TOLD: [(&str, &str, &str, Option<f64>); 7] = [
    ("cp", "Pressure coefficient", "Cp", Some(0.0)),
    ("mach", "Mach number", "M", None),
    ("total_pressure_loss", "Total pressure loss", "1 − p₀/p₀∞", None),
    ("entropy", "Entropy", "(p/ρ^γ)/∞ − 1", None),
    ("temperature", "Temperature", "T/T∞", None),
    ("cf", "Friction coefficient", "Cf", None),
    ("heat_flux", "Heat flux", "q", Some(0.0)),
];

/// The viewer, for runs in space that have walls.
pub(super) fn surface_viewer(run: &RunFolder) -> Option<Block> {
    let walls = Walls::of(run)?;
    let all = walls.triangles.len();
    let walls = walls.thinned(MOST);
    let data = data(&walls, walls.triangles.len() < all);
    Some(Block::Surface(serde_json::to_string(&data).ok()?.replace('<', "\\u003c")))
}

fn data(walls: &Walls, thinned: bool) -> Data<'_> {
    let [low, high] = walls.bounds();
    let step =
        |v: f64, low: f64, high: f64| if high > low { STEPS * ((v - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
    let places = walls.points.iter().flat_map(|x| [0, 1, 2].map(|d| step(x[d], low[d], high[d])));
    let normals = walls.normals.iter().flat_map(|n| n.0.map(|v| (127.0 * v).round() as i8 as u8));
    let corners = walls.triangles.iter().flatten().flat_map(|i| i.to_le_bytes().into_iter().take(3));
    let scale = |map: Colormap| {
        let end = (COLOURS - 1) as f64;
        let colours = (0..COLOURS).map(|k| map.colour(k as f64, [0.0, end]));
        STANDARD.encode(colours.flat_map(|c| [c.r, c.g, c.b]).collect::<Vec<u8>>())
    };
    let field = |(name, values): &(&'static str, Vec<f64>)| {
        let (_, title, symbol, middle) = TOLD.into_iter().find(|(own, ..)| own == name)?;
        let symbol = if *name == "temperature" && walls.kelvin { "T, K" } else { symbol };
        let [from, to] = Walls::range(values);
        let wide = WIDEST * (to - from);
        let low = values.iter().copied().fold(f64::INFINITY, f64::min).max(from - wide);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max).min(to + wide);
        let values = words(values.iter().map(|v| step(*v, low, high)));
        Some(Field { name: title, symbol, middle, low, high, from, to, values })
    };
    Data {
        points: walls.points.len(),
        low,
        high,
        places: words(places),
        normals: STANDARD.encode(normals.collect::<Vec<u8>>()),
        triangles: STANDARD.encode(corners.collect::<Vec<u8>>()),
        body: STANDARD.encode(&walls.body),
        bodies: &walls.bodies,
        mirrors: walls.mirrors.iter().map(|m| (m.axis, m.at)).collect(),
        fields: walls.fields.iter().filter_map(field).collect(),
        sequential: scale(Colormap::Sequential),
        diverging: scale(Colormap::Diverging { centre: 0.5 * (COLOURS - 1) as f64 }),
        thinned,
    }
}

/// Steps as numbers of 16 bits.
fn words(steps: impl Iterator<Item = f64>) -> String {
    STANDARD.encode(steps.flat_map(|v| (v.round() as u16).to_le_bytes()).collect::<Vec<u8>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::overview::tests::{assert_balanced, assert_self_contained};
    use crate::report::walls::tests::fill_wing;
    use crate::report::{write_report, write_stations, write_surface_views};

    /// Most bytes of a page of any number of triangles.
    const PAGE: usize = 7_000_000;

    #[test]
    fn a_page_with_a_surface_asks_for_nothing_and_has_bounds() {
        let folder = tempfile::tempdir().unwrap();
        fill_wing(folder.path(), 400);
        let page = std::fs::read_to_string(write_report(folder.path()).unwrap()).unwrap();
        assert_balanced(&page);
        assert_self_contained(&page);
        let other = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!other.contains("http://") && !other.contains("https://www") && !other.contains("import("));
        assert!(page.contains("class=\"viewer surface\"") && page.contains("webgl2"));
        assert!(page.len() < PAGE, "{}", page.len());
    }

    #[test]
    fn numbers_come_back_from_their_steps() {
        let folder = tempfile::tempdir().unwrap();
        fill_wing(folder.path(), 20);
        let Some(Block::Surface(text)) = surface_viewer(&RunFolder::new(folder.path())) else { panic!("no viewer") };
        let data: serde_json::Value = serde_json::from_str(&text).unwrap();
        let decoded = |text: &serde_json::Value| STANDARD.decode(text.as_str().unwrap()).unwrap();
        assert_eq!(decoded(&data["triangles"]).len(), 9 * 800);
        assert_eq!(decoded(&data["places"]).len(), 6 * 441);
        let cp = &data["fields"][0];
        assert_eq!((cp["symbol"].as_str(), cp["middle"].as_f64()), (Some("Cp"), Some(0.0)));
        let words: Vec<f64> =
            decoded(&cp["values"]).chunks(2).map(|b| f64::from(u16::from_le_bytes([b[0], b[1]]))).collect();
        let (low, high) = (cp["low"].as_f64().unwrap(), cp["high"].as_f64().unwrap());
        assert!((low + words[0] / STEPS * (high - low) - 1.0).abs() < 1e-4, "the first corner has Cp 1");
        assert_eq!(data["mirrors"], serde_json::json!([[1, 0.0]]));
    }

    #[test]
    fn sheets_show_views_and_stations() {
        let folder = tempfile::tempdir().unwrap();
        fill_wing(folder.path(), 60);
        write_surface_views(folder.path()).unwrap();
        write_stations(folder.path()).unwrap();
        let svg = std::fs::read_to_string(folder.path().join("pictures/cp-stations.svg")).unwrap();
        assert!(
            svg.contains("eta = 0.5") && svg.contains("eta = 0.9") && !svg.contains("eta = 0.44"),
            "those of the reference"
        );
        assert!(svg.contains("measured") && svg.contains("Mach 0.8"));
        for name in ["surface-views", "cp", "cp-stations"] {
            assert!(folder.path().join(format!("pictures/{name}.png")).is_file(), "{name}");
        }
    }
}
