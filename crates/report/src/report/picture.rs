//! Flow pictures: a field on a raster of pixels, and the particles themselves.
use super::ReportError;
use super::axes::{Frame, Scale, TITLE_MARGIN, draw_title, tick_text, title_width};
use super::canvas::{Anchor, Area, Bitmap, Canvas, Pen, Text};
use super::colour::{CURVES, Colormap, Colour};
use super::contour;
use super::font::{self, LIFTED, OTHER_FONTS};
use super::stream_lines::Directions;
use crate::math::{Bounds, Vector};

/// Longest side of a plot area in pixels.
const LONG_SIDE: f64 = 820.0;
/// A plot area is never higher than this.
const TALL_SIDE: f64 = 640.0;
/// Room for the colour bar and its numbers; from a plot to the bar, and size of the quantity above it.
const BAR: f64 = 110.0;
const TO_BAR: f64 = 20.0;
const QUANTITY_SIZE: f64 = 13.0;
const CONTOUR: Pen = Pen::new(Colour::rgb(62, 68, 78), 0.7);
const STREAM: Pen = Pen::new(Colour::rgb(62, 68, 78), 0.8);
/// Pixels of PNG per unit of canvas, at most.
const SHARPNESS: f64 = 2.0;

/// A field sampled at the centres of equal pixels.
#[derive(Clone, Debug)]
pub struct Raster {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// What the raster covers, from border to border.
    pub window: Bounds<2>,
    /// Values row by row, the first row at the smallest y; NaN inside a body and outside the flow.
    pub values: Vec<f64>,
}

/// How a field is shown.
#[derive(Clone, Debug)]
pub struct PictureStyle<'a> {
    /// Title.
    pub title: &'a str,
    /// Quantity and unit, beside the colour bar.
    pub quantity: &'a str,
    /// Labels of the axes.
    pub axes: [&'a str; 2],
    /// Colours.
    pub map: Colormap,
    /// Values at the ends of the colour bar; absent: nearly all of the field (outliers of 0.2 % are cut).
    pub range: Option<[f64; 2]>,
    /// Values of contour lines.
    pub contours: &'a [f64],
    /// Bodies: closed polygons.
    pub outlines: &'a [Vec<Vector<2>>],
    /// Directions at the pixels, along which lines are drawn; none: an empty slice.
    pub directions: &'a [[f64; 2]],
    /// A place that is marked.
    pub mark: Option<Vector<2>>,
}

impl<'a> PictureStyle<'a> {
    /// A field on its own, with axes of these names.
    pub fn plain(title: &'a str, quantity: &'a str, axes: [&'a str; 2]) -> Self {
        Self {
            title,
            quantity,
            axes,
            map: Colormap::Sequential,
            range: None,
            contours: &[],
            outlines: &[],
            directions: &[],
            mark: None,
        }
    }
}

/// What the colour of a particle says.
#[derive(Clone, Copy, Debug)]
pub enum Dots<'a> {
    /// Level of refinement, one colour each.
    Level(&'a [u32]),
    /// A value on a colour scale.
    Value {
        /// One value per particle.
        values: &'a [f64],
        /// Quantity and unit.
        quantity: &'a str,
        /// Colours.
        map: Colormap,
    },
}

/// A cloud of particles.
#[derive(Clone, Debug)]
pub struct Scatter<'a> {
    /// Positions.
    pub points: &'a [Vector<2>],
    /// Meaning of the colours, one entry per position.
    pub dots: Dots<'a>,
    /// Interface particles with their normals.
    pub interface: &'a [(Vector<2>, Vector<2>)],
    /// Bodies: closed polygons.
    pub outlines: &'a [Vec<Vector<2>>],
}

/// Draws a field with a colour bar, axes, contour lines and bodies, as PNG.
pub fn raster_png(raster: &Raster, style: &PictureStyle) -> Result<Vec<u8>, ReportError> {
    let expected = raster.width.saturating_mul(raster.height);
    if raster.values.len() != expected || expected == 0 {
        return Err(ReportError::Shape { what: "a raster", found: raster.values.len(), expected: expected.max(1) });
    }
    let raster = &if style.outlines.is_empty() { raster.clone() } else { bled(raster) };
    let (mut canvas, frame) = sheet(raster.window, style.title, style.quantity)?;
    let range = style.range.unwrap_or_else(|| robust_range(&raster.values));
    canvas.rectangle(frame.area, Some(Colour::BODY), None);
    canvas.picture(coloured(raster, style.map, range), frame.area);
    canvas.layer("bodies", Some(frame.area));
    for level in style.contours {
        draw_contour(&mut canvas, &frame, raster, *level);
    }
    draw_stream_lines(&mut canvas, &frame, raster, style.directions)?;
    draw_outlines(&mut canvas, &frame, style.outlines);
    if let Some(at) = style.mark {
        let centre = vec![place(&frame, &at)];
        canvas.discs(centre.clone(), 7.0, None, Some(Pen::new(Colour::PAPER, 4.0)));
        canvas.discs(centre, 7.0, None, Some(Pen::new(Colour::INK, 1.6)));
    }
    frame.border(&mut canvas, style.axes[0], style.axes[1]);
    colour_bar(&mut canvas, frame.area, style.map, range, style.quantity);
    // a coarse raster does not become sharper in more pixels
    let pixels = 2.0 * raster.width as f64 / frame.area.width;
    canvas.png(pixels.clamp(1.0, SHARPNESS))
}

/// Draws the particles inside `window`, interface particles with their normals, as PNG.
pub fn scatter_png(scatter: &Scatter, window: Bounds<2>, title: &str) -> Result<Vec<u8>, ReportError> {
    let (found, quantity) = match scatter.dots {
        Dots::Level(levels) => (levels.len(), ""),
        Dots::Value { values, quantity, .. } => (values.len(), quantity),
    };
    if found != scatter.points.len() {
        return Err(ReportError::Shape { what: "the colour of particles", found, expected: scatter.points.len() });
    }
    let (mut canvas, frame) = sheet(window, title, quantity)?;
    let seen = Seen::of(scatter.points, window, &frame);
    canvas.layer("particles", Some(frame.area));
    draw_outlines(&mut canvas, &frame, scatter.outlines);
    match scatter.dots {
        Dots::Level(levels) => draw_levels(&mut canvas, &frame, &seen, levels),
        Dots::Value { values, quantity, map } => {
            let shown: Vec<f64> = seen.particles.iter().map(|i| values[*i]).collect();
            let range = robust_range(&shown);
            for (place, value) in seen.places.iter().zip(shown) {
                canvas.discs(vec![*place], seen.radius, Some(map.colour(value, range)), None);
            }
            canvas.layer("legend", None);
            colour_bar(&mut canvas, frame.area, map, range, quantity);
        }
    }
    canvas.layer("interface", Some(frame.area));
    draw_interface(&mut canvas, &frame, scatter.interface, window, seen.radius);
    frame.border(&mut canvas, "x", "y");
    canvas.png(SHARPNESS)
}

/// The particles that a picture shows.
struct Seen {
    particles: Vec<usize>,
    places: Vec<[f64; 2]>,
    /// Radius of their dots.
    radius: f64,
}

impl Seen {
    fn of(points: &[Vector<2>], window: Bounds<2>, frame: &Frame) -> Self {
        let particles: Vec<usize> = (0..points.len()).filter(|i| window.contains(&points[*i])).collect();
        let places = particles.iter().map(|i| place(frame, &points[*i])).collect();
        // Dots cover a third of the area when evenly spread, and stay visible without merging.
        let spacing = (frame.area.width * frame.area.height / particles.len().max(1) as f64).sqrt();
        Self { particles, places, radius: (0.28 * spacing).clamp(0.7, 4.5) }
    }
}

/// A sheet with a title and a frame of the proportions of `window`.
fn sheet(window: Bounds<2>, title: &str, quantity: &str) -> Result<(Canvas, Frame), ReportError> {
    let extent = window.extent();
    if !(extent[0] > 0.0 && extent[1] > 0.0 && extent.is_finite()) {
        return Err(ReportError::Window { min: window.min.0, max: window.max.0 });
    }
    let scale = (LONG_SIDE / extent[0]).min(TALL_SIDE / extent[1]);
    // A very slender window is stretched rather than drawn as a line.
    let [width, height] = [0, 1].map(|d| (extent[d] * scale).max(120.0));
    // a title that reaches above the colour bar stands higher than what the bar is of
    let long = title_width(title) > width;
    let area = Area { x: 82.0, y: if long { 66.0 } else { 46.0 }, width, height };
    let least = title_width(title).min(LONG_SIDE) + 2.0 * TITLE_MARGIN;
    let mut canvas = Canvas::new((area.x + width + bar_room(quantity)).max(least), area.y + height + 62.0);
    draw_title(&mut canvas, title, [area.x, 28.0]);
    let scale = |d: usize| Scale { from: window.min[d], to: window.max[d], log: false };
    Ok((canvas, Frame { area, x: scale(0), y: scale(1) }))
}

fn place(frame: &Frame, x: &Vector<2>) -> [f64; 2] {
    frame.place(x[0], x[1])
}

/// The range of the values. What lies beyond all but the 0.2 % smallest and largest by more than their range is cut: one bad
/// particle must not bleach a picture, but stagnation points and suction peaks belong on the scale.
pub(super) fn robust_range(values: &[f64]) -> [f64; 2] {
    range_without(values, 0.002)
}

/// The same where this part of the values may be far out on either side.
pub(super) fn range_without(values: &[f64], part: f64) -> [f64; 2] {
    let mut finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let (count, cut) = (finite.len(), (part * finite.len() as f64) as usize);
    let Some(last) = count.checked_sub(1 + cut) else { return [0.0, 1.0] };
    let mut ranked = |k: usize| *finite.select_nth_unstable_by(k, f64::total_cmp).1;
    let [low, high, least, most] = [ranked(cut), ranked(last), ranked(0), ranked(count - 1)];
    let width = high - low;
    let end = |extreme: f64, inner: f64| if (extreme - inner).abs() <= width { extreme } else { inner };
    match [end(least, low), end(most, high)] {
        [low, high] if low < high => [low, high],
        [low, _] => [low - 0.5, low + 0.5],
    }
}

/// The raster with its field continued a few pixels into bodies, whose exact outlines are drawn over it: no steps of
/// pixels show along a wall.
fn bled(raster: &Raster) -> Raster {
    const PIXELS: usize = 3;
    let (width, height) = (raster.width, raster.height);
    let mut values = raster.values.clone();
    for _ in 0..PIXELS {
        let before = values.clone();
        for (at, value) in values.iter_mut().enumerate().filter(|(_, value)| !value.is_finite()) {
            let (k, l) = (at % width, at / width);
            let beside = [(k.wrapping_sub(1), l), (k + 1, l), (k, l.wrapping_sub(1)), (k, l + 1)];
            let known = beside.iter().filter(|(k, l)| *k < width && *l < height).map(|(k, l)| before[l * width + k]);
            let (n, sum) = known.filter(|v| v.is_finite()).fold((0, 0.0), |(n, sum), v| (n + 1, sum + v));
            *value = if n > 0 { sum / f64::from(n) } else { f64::NAN };
        }
    }
    Raster { values, ..raster.clone() }
}

fn coloured(raster: &Raster, map: Colormap, range: [f64; 2]) -> Bitmap {
    let mut rgba = Vec::with_capacity(4 * raster.values.len());
    for row in raster.values.chunks(raster.width).rev() {
        for value in row {
            let c = if value.is_finite() { map.colour(*value, range) } else { Colour::BODY };
            rgba.extend([c.r, c.g, c.b, c.a]);
        }
    }
    Bitmap { width: raster.width, height: raster.height, rgba }
}

fn draw_contour(canvas: &mut Canvas, frame: &Frame, raster: &Raster, level: f64) {
    let extent = raster.window.extent();
    let pixel = [extent[0] / raster.width as f64, extent[1] / raster.height as f64];
    let at = |p: [f64; 2]| {
        let x = raster.window.min[0] + (p[0] + 0.5) * pixel[0];
        frame.place(x, raster.window.min[1] + (p[1] + 0.5) * pixel[1])
    };
    let segments = contour::segments(&raster.values, raster.width, level);
    canvas.line(segments.into_iter().flat_map(|[a, b]| [at(a), at(b), LIFTED]).collect(), CONTOUR);
}

/// Lines along directions, with an arrow in the middle of each.
fn draw_stream_lines(
    canvas: &mut Canvas,
    frame: &Frame,
    raster: &Raster,
    values: &[[f64; 2]],
) -> Result<(), ReportError> {
    if values.is_empty() {
        return Ok(());
    }
    let (width, height) = (raster.width, raster.height);
    if values.len() != width * height {
        return Err(ReportError::Shape { what: "directions", found: values.len(), expected: width * height });
    }
    let area = frame.area;
    let at = |p: &[f64; 2]| {
        [area.x + p[0] / width as f64 * area.width, area.y + area.height - p[1] / height as f64 * area.height]
    };
    for line in (Directions { width, height, values }).lines() {
        let points: Vec<[f64; 2]> = line.iter().map(at).collect();
        let middle = points.len() / 2;
        let ([ax, ay], [bx, by]) = (points[middle - 1], points[middle]);
        let long = (bx - ax).hypot(by - ay).max(1e-9);
        let (dx, dy) = (5.0 * (bx - ax) / long, 5.0 * (by - ay) / long);
        let wing = |side: f64| [bx - dx + side * 0.6 * dy, by - dy - side * 0.6 * dx];
        canvas.line(points, STREAM);
        canvas.line(vec![wing(1.0), [bx, by], wing(-1.0)], STREAM);
    }
    Ok(())
}

fn draw_outlines(canvas: &mut Canvas, frame: &Frame, outlines: &[Vec<Vector<2>>]) {
    for outline in outlines {
        let places = outline.iter().map(|x| place(frame, x)).collect();
        canvas.polygon(places, Some(Colour::BODY), Some(Pen::new(Colour::INK, 1.2)));
    }
}

/// One colour per level, finest first, with a legend beside the plot.
fn draw_levels(canvas: &mut Canvas, frame: &Frame, seen: &Seen, levels: &[u32]) {
    let mut present: Vec<u32> = seen.particles.iter().map(|i| levels[*i]).collect();
    present.sort_unstable();
    present.dedup();
    let range = [present.first().map_or(0.0, |l| f64::from(*l)), present.last().map_or(1.0, |l| f64::from(*l))];
    // The pale end of the scale is lost on paper: use seven eighths of it.
    let range = [range[0], range[1] + 0.15 * (range[1] - range[0]).max(1.0)];
    let colour = |level: u32| Some(Colormap::Sequential.colour(f64::from(level), range));
    for level in &present {
        let own = seen.particles.iter().zip(&seen.places).filter(|(i, _)| levels[**i] == *level);
        canvas.discs(own.map(|(_, place)| *place).collect(), seen.radius, colour(*level), None);
    }
    let (left, mut y) = (frame.area.x + frame.area.width + 18.0, frame.area.y + 12.0);
    canvas.layer("legend", None);
    canvas.text(Text::new("level", [left, y], 12.5));
    for level in present {
        y += 19.0;
        canvas.discs(vec![[left + 5.0, y - 4.0]], 4.5, colour(level), None);
        canvas.text(tick_text(level.to_string(), [left + 17.0, y], Anchor::Start));
    }
}

fn draw_interface(
    canvas: &mut Canvas,
    frame: &Frame,
    interface: &[(Vector<2>, Vector<2>)],
    window: Bounds<2>,
    radius: f64,
) {
    let colour = CURVES[1];
    let seen = interface.iter().filter(|(x, _)| window.contains(x));
    let mut centres = Vec::new();
    for (x, normal) in seen {
        let [a, n] = [place(frame, x), normal.unit().0];
        let length = 4.5 * radius.max(1.5);
        canvas.line(vec![a, [a[0] + length * n[0], a[1] - length * n[1]]], Pen::new(colour, 0.45 * radius.max(1.5)));
        centres.push(a);
    }
    canvas.discs(centres, radius.max(1.2), Some(colour), None);
}

/// Room right of a plot for a colour bar and the name of its quantity.
pub(super) fn bar_room(quantity: &str) -> f64 {
    BAR.max(TO_BAR + OTHER_FONTS * QUANTITY_SIZE * font::width(quantity) + TITLE_MARGIN)
}

/// A labelled colour bar to the right of `area`.
pub(super) fn colour_bar(canvas: &mut Canvas, area: Area, map: Colormap, range: [f64; 2], quantity: &str) {
    let height = area.height.min(420.0);
    let bar = Area { x: area.x + area.width + TO_BAR, y: area.y + 0.5 * (area.height - height), width: 15.0, height };
    let steps = 256;
    let value = |k: usize| range[1] + (range[0] - range[1]) * (k as f64 + 0.5) / steps as f64;
    let rgba = (0..steps).map(|k| map.colour(value(k), range)).flat_map(|c| [c.r, c.g, c.b, 255]).collect();
    canvas.picture(Bitmap { width: 1, height: steps, rgba }, bar);
    canvas.rectangle(bar, None, Some(Pen::new(Colour::INK, 1.0)));
    let scale = Scale { from: range[0], to: range[1], log: false };
    let right = bar.x + bar.width;
    for tick in scale.ticks((height / 45.0).clamp(2.0, 7.0) as usize) {
        let y = bar.y + (1.0 - scale.fraction(tick.value)) * height;
        canvas.line(vec![[right, y], [right + 4.0, y]], Pen::new(Colour::INK, 1.0));
        canvas.text(tick_text(tick.label, [right + 8.0, y + 4.2], Anchor::Start));
    }
    canvas.text(Text::new(quantity, [bar.x, bar.y - 8.0], QUANTITY_SIZE));
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Keeps a picture in the folder named by `ALULA_PICTURES`, to look at; does nothing without it.
    pub(crate) fn keep(name: &str, bytes: &[u8]) {
        if let Some(folder) = std::env::var_os("ALULA_PICTURES") {
            std::fs::write(std::path::Path::new(&folder).join(name), bytes).unwrap();
        }
    }

    fn ellipse() -> Vec<Vector<2>> {
        let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / 200.0;
        (0..200).map(|k| Vector([0.5 + 0.5 * angle(k).cos(), 0.06 * angle(k).sin()])).collect()
    }

    fn sample(width: usize, height: usize) -> Raster {
        let window = Bounds { min: Vector([-0.5, -0.6]), max: Vector([1.5, 0.7]) };
        let value = |i: usize| {
            let x = -0.5 + 2.0 * ((i % width) as f64 + 0.5) / width as f64;
            let y = -0.6 + 1.3 * ((i / width) as f64 + 0.5) / height as f64;
            let inside = ((x - 0.5) / 0.5).powi(2) + (y / 0.06).powi(2) < 1.0;
            let bump = (-((x - 0.45) / 0.3).powi(2) - ((y - 0.15) / 0.3).powi(2)).exp();
            let shock = if x < 0.62 || y < 0.0 { 1.0 } else { 0.35 };
            if inside {
                f64::NAN
            } else {
                0.8 + 0.5 * bump * shock - 0.5 * (-((x / 0.1).powi(2) + (y / 0.1).powi(2))).exp()
            }
        };
        Raster { width, height, window, values: (0..width * height).map(value).collect() }
    }

    #[test]
    fn a_field_becomes_a_picture() {
        let contours = [0.9, 1.0, 1.1, 1.2];
        let mut style = PictureStyle {
            title: "Mach number, NACA 0012, M = 0.8, α = 1.25°",
            quantity: "Mach",
            axes: ["x/c", "y/c"],
            map: Colormap::Sequential,
            range: None,
            contours: &contours,
            outlines: &[ellipse()],
            directions: &[],
            mark: None,
        };
        keep("raster.png", &raster_png(&sample(400, 260), &style).unwrap());
        style.map = Colormap::Diverging { centre: 1.0 };
        style.contours = &contours[1..2];
        keep("raster-diverging.png", &raster_png(&sample(400, 260), &style).unwrap());
    }

    #[test]
    fn a_cloud_becomes_a_picture() {
        let mut points = Vec::new();
        let mut levels = Vec::new();
        for level in 0..4_u32 {
            let h = 0.08 / f64::from(1 << level);
            for k in 0..(2.0 / h) as usize {
                for l in 0..(1.2 / h) as usize {
                    let x = Vector([-0.5 + (k as f64 + 0.5) * h, -0.6 + (l as f64 + 0.5) * h]);
                    let distance = (((x[0] - 0.5) / 0.5).powi(2) + (x[1] / 0.06).powi(2)).sqrt() - 1.0;
                    let wanted = if distance < 1.2 {
                        3
                    } else if distance < 3.0 {
                        2
                    } else if distance < 5.0 {
                        1
                    } else {
                        0
                    };
                    if distance > 0.05 && wanted == level {
                        points.push(x);
                        levels.push(level);
                    }
                }
            }
        }
        let interface: Vec<_> = ellipse().iter().map(|x| (*x, Vector([(x[0] - 0.5) / 0.25, x[1] / 0.0036]))).collect();
        let outlines = [ellipse()];
        let dots = Dots::Level(&levels);
        let scatter = Scatter { points: &points, dots, interface: &interface, outlines: &outlines };
        let window = Bounds { min: Vector([-0.1, -0.25]), max: Vector([0.5, 0.25]) };
        keep("scatter.png", &scatter_png(&scatter, window, "Particles near the leading edge").unwrap());
        let values: Vec<f64> = points.iter().map(|x| x[0]).collect();
        let dots = Dots::Value { values: &values, quantity: "x", map: Colormap::Sequential };
        let scatter = Scatter { dots, ..scatter };
        keep("scatter-value.png", &scatter_png(&scatter, window, "Particles by value").unwrap());
        let scatter = Scatter { dots: Dots::Level(&[]), ..scatter };
        assert!(scatter_png(&scatter, window, "").is_err());
    }

    #[test]
    fn impossible_pictures_are_errors() {
        let style = PictureStyle {
            title: "",
            quantity: "",
            axes: ["", ""],
            map: Colormap::Sequential,
            range: None,
            contours: &[0.0, f64::NAN],
            outlines: &[],
            directions: &[],
            mark: None,
        };
        let mut raster = sample(4, 3);
        raster.values = vec![f64::NAN; 12];
        assert!(raster_png(&raster, &style).is_ok(), "a field of nothing is a grey picture");
        raster.values.pop();
        assert!(matches!(raster_png(&raster, &style), Err(ReportError::Shape { found: 11, expected: 12, .. })));
        let mut raster = sample(4, 3);
        raster.window = Bounds::EMPTY;
        assert!(matches!(raster_png(&raster, &style), Err(ReportError::Window { .. })));
        assert_eq!(robust_range(&[2.0; 5]), [1.5, 2.5]);
    }

    #[test]
    fn a_peak_is_on_the_scale_and_an_outlier_is_not() {
        let mut values: Vec<f64> = (0..2000).map(|k| f64::from(k % 100) * 0.01).collect();
        values[7] = 1.5;
        assert_eq!(robust_range(&values), [0.0, 1.5]);
        values[8] = 40.0;
        let range = robust_range(&values);
        assert!(range[1] < 1.0, "{range:?}");
    }
}
