//! Paints a canvas as PNG.
use tiny_skia::{FillRule, LineCap, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

use super::ReportError;
use super::canvas::{Anchor, Area, Bitmap, Canvas, Dash, Item, Outline, Pen, Text};
use super::colour::Colour;
use super::font;

/// Stroke width of text over its size.
const TEXT_WEIGHT: f64 = 0.075;
/// The same for bold text.
const BOLD_WEIGHT: f64 = 0.1;
/// More pixels than any screen shows; a guard against absurd sizes.
const MAX_SIDE: f64 = 16384.0;

impl Canvas {
    /// The sheet as PNG with `scale` pixels per unit.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, ReportError> {
        let size = [self.width * scale, self.height * scale];
        let too_large = || ReportError::Size { width: size[0], height: size[1] };
        if !size.iter().all(|s| (1.0..=MAX_SIDE).contains(s)) {
            return Err(too_large());
        }
        let mut sheet = Pixmap::new(size[0].round() as u32, size[1].round() as u32).ok_or_else(too_large)?;
        sheet.fill(tiny_skia::Color::WHITE);
        let mut painter = Painter { scale, mask: None, sheet };
        for layer in &self.layers {
            painter.mask = layer.clip.and_then(|area| painter.mask_of(area));
            layer.items.iter().for_each(|item| painter.item(item));
        }
        encoded(&painter.sheet)
    }
}

impl Bitmap {
    /// The pixels as PNG.
    pub(super) fn png(&self) -> Result<Vec<u8>, ReportError> {
        let size = ReportError::Size { width: self.width as f64, height: self.height as f64 };
        let pixmap = pixmap_of(self).ok_or(size)?;
        encoded(&pixmap)
    }
}

/// The picture as a file: quickly written rather than as small as can be.
fn encoded(pixmap: &Pixmap) -> Result<Vec<u8>, ReportError> {
    let wrong = |e: png::EncodingError| ReportError::Png(e.to_string());
    let opaque = pixmap.pixels().iter().all(|p| p.is_opaque());
    let colours = pixmap.pixels().iter().map(|p| p.demultiply());
    let bytes: Vec<u8> = match opaque {
        true => colours.flat_map(|c| [c.red(), c.green(), c.blue()]).collect(),
        false => colours.flat_map(|c| [c.red(), c.green(), c.blue(), c.alpha()]).collect(),
    };
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, pixmap.width(), pixmap.height());
    encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().map_err(wrong)?;
    writer.write_image_data(&bytes).map_err(wrong)?;
    writer.finish().map_err(wrong)?;
    Ok(file)
}

fn pixmap_of(bitmap: &Bitmap) -> Option<Pixmap> {
    let mut pixmap = Pixmap::new(u32::try_from(bitmap.width).ok()?, u32::try_from(bitmap.height).ok()?)?;
    for (to, from) in pixmap.pixels_mut().iter_mut().zip(bitmap.rgba.as_chunks::<4>().0) {
        *to = tiny_skia::ColorU8::from_rgba(from[0], from[1], from[2], from[3]).premultiply();
    }
    Some(pixmap)
}

struct Painter {
    scale: f64,
    /// What of the present layer shows.
    mask: Option<Mask>,
    sheet: Pixmap,
}

impl Painter {
    fn item(&mut self, item: &Item) {
        match item {
            Item::Path { outline, fill, pen } => self.path(outline, *fill, *pen),
            Item::Discs { centres, radius, fill, pen } => {
                // One path for all would merge overlapping discs into one outline; draw them one by one.
                let discs = centres.iter().map(|c| PathBuilder::from_circle(c[0] as f32, c[1] as f32, *radius as f32));
                discs.flatten().for_each(|disc| self.shape(&disc, *fill, *pen));
            }
            Item::Marked { outline, centres, radius, fill, pen } => {
                self.path(outline, None, Some(*pen));
                let full = Some(Pen { dash: Dash::None, ..*pen });
                let discs = centres.iter().map(|c| PathBuilder::from_circle(c[0] as f32, c[1] as f32, *radius as f32));
                discs.flatten().for_each(|disc| self.shape(&disc, Some(*fill), full));
            }
            Item::Text(text) => self.text(text),
            Item::Picture { bitmap, area } => self.picture(bitmap, *area),
        }
    }

    fn mask_of(&self, a: Area) -> Option<Mask> {
        let mut mask = Mask::new(self.sheet.width(), self.sheet.height())?;
        let area = tiny_skia::Rect::from_xywh(a.x as f32, a.y as f32, a.width as f32, a.height as f32)?;
        mask.fill_path(&PathBuilder::from_rect(area), FillRule::Winding, true, self.transform());
        Some(mask)
    }

    fn transform(&self) -> Transform {
        Transform::from_scale(self.scale as f32, self.scale as f32)
    }

    fn path(&mut self, outline: &Outline, fill: Option<Colour>, pen: Option<Pen>) {
        let mut path = PathBuilder::new();
        for chain in outline.chains() {
            path.move_to(chain[0][0] as f32, chain[0][1] as f32);
            chain[1..].iter().for_each(|p| path.line_to(p[0] as f32, p[1] as f32));
            if outline.closed {
                path.close();
            }
        }
        path.finish().into_iter().for_each(|path| self.shape(&path, fill, pen));
    }

    fn shape(&mut self, path: &Path, fill: Option<Colour>, pen: Option<Pen>) {
        let transform = self.transform();
        if let Some(colour) = fill {
            self.sheet.fill_path(path, &paint(colour), FillRule::EvenOdd, transform, self.mask.as_ref());
        }
        if let Some(pen) = pen {
            let stroke = Stroke {
                width: pen.width as f32,
                line_cap: LineCap::Round,
                line_join: LineJoin::Round,
                dash: StrokeDash::new(pen.dash.lengths().to_vec(), 0.0),
                ..Stroke::default()
            };
            self.sheet.stroke_path(path, &paint(pen.colour), &stroke, transform, self.mask.as_ref());
        }
    }

    fn text(&mut self, text: &Text) {
        let shift = match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5,
            Anchor::End => -1.0,
        } * font::width(&text.text);
        let [x, y] = text.at;
        let place = |p: &[f64; 2]| {
            let (along, up) = ((p[0] + shift) * text.size, p[1] * text.size);
            if text.upright { [x - up, y - along] } else { [x + along, y - up] }
        };
        let weight = if text.bold { BOLD_WEIGHT } else { TEXT_WEIGHT };
        let points = font::strokes(&text.text).iter().map(place).collect();
        self.path(&Outline { points, closed: false }, None, Some(Pen::new(text.colour, weight * text.size)));
    }

    fn picture(&mut self, bitmap: &Bitmap, area: Area) {
        let from = |v: f64| (v * self.scale).round().max(0.0) as usize;
        let (x, y) = (from(area.x), from(area.y));
        let (width, height) = (from(area.x + area.width) - x, from(area.y + area.height) - y);
        let across = self.sheet.width() as usize;
        let width = width.min(across.saturating_sub(x));
        let rows = self.sheet.pixels_mut().chunks_exact_mut(across).skip(y);
        if width == 0 || bitmap.rgba.is_empty() {
            return;
        }
        for (to, from) in rows.zip(stretched(bitmap, width, height).rgba.chunks_exact(4 * width)) {
            for (to, from) in to[x..x + width].iter_mut().zip(from.as_chunks::<4>().0) {
                // what lies beneath shows through
                let under = [to.red(), to.green(), to.blue()].map(|c| u32::from(c) * (255 - u32::from(from[3])) / 255);
                let over = tiny_skia::ColorU8::from_rgba(from[0], from[1], from[2], from[3]).premultiply();
                let [r, g, b] = [over.red(), over.green(), over.blue()];
                let sum = |a: u8, k: usize| a.saturating_add(under[k] as u8);
                *to = tiny_skia::ColorU8::from_rgba(sum(r, 0), sum(g, 1), sum(b, 2), 255).premultiply();
            }
        }
    }
}

/// The bitmap in other numbers of pixels, linear between the centres of its own.
fn stretched(bitmap: &Bitmap, width: usize, height: usize) -> Bitmap {
    const ONE: u32 = 256;
    // the two pixels on either side of the centre of each new one, and the share of the second
    let between = |old: usize, new: usize| -> Vec<(usize, usize, u32)> {
        let place = |k: usize| ((k as f64 + 0.5) * old as f64 / new as f64 - 0.5).clamp(0.0, old as f64 - 1.0);
        let split = |p: f64| (p as usize, (p as usize + 1).min(old - 1), (p.fract() * f64::from(ONE)) as u32);
        (0..new).map(|k| split(place(k))).collect()
    };
    let pixels = bitmap.rgba.as_chunks::<4>().0;
    let mix = |a: [u8; 4], b: [u8; 4], t: u32| -> [u32; 4] {
        std::array::from_fn(|c| u32::from(a[c]) * (ONE - t) + u32::from(b[c]) * t)
    };
    let columns = between(bitmap.width, width);
    let mut rgba = Vec::with_capacity(4 * width * height);
    for (low, high, up) in between(bitmap.height, height) {
        let row = |r: usize| &pixels[r * bitmap.width..(r + 1) * bitmap.width];
        let (below, above) = (row(low), row(high));
        for &(left, right, along) in &columns {
            let (a, b) = (mix(below[left], below[right], along), mix(above[left], above[right], along));
            rgba.extend((0..4).map(|c| ((a[c] * (ONE - up) + b[c] * up) / (ONE * ONE)) as u8));
        }
    }
    Bitmap { width, height, rgba }
}

fn paint(colour: Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(colour.r, colour.g, colour.b, colour.a);
    paint.anti_alias = true;
    paint
}
