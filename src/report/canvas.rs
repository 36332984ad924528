//! A sheet of shapes and text that prints itself as SVG or, through `paint`, as PNG.
//!
//! Coordinates are pixels, y down. Charts and pictures draw on a canvas once and get both formats.
use std::fmt::Write as _;

use base64::Engine as _;

use super::ReportError;
use super::colour::Colour;

/// An axis-aligned rectangle on a canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left side.
    pub x: f64,
    /// Top.
    pub y: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// A line on a canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// Colour.
    pub colour: Colour,
    /// Width in pixels.
    pub width: f64,
    /// Drawn as dashes.
    pub dashed: bool,
}

impl Pen {
    /// A full line.
    pub const fn new(colour: Colour, width: f64) -> Self {
        Self { colour, width, dashed: false }
    }
}

/// Which point of a text stands at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The beginning.
    Start,
    /// The middle.
    Middle,
    /// The end.
    End,
}

/// A text on a canvas.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Words.
    pub text: String,
    /// Where the anchor stands on the baseline.
    pub at: [f64; 2],
    /// Size in pixels.
    pub size: f64,
    /// Colour.
    pub colour: Colour,
    /// Which point of the text stands at `at`.
    pub anchor: Anchor,
    /// Reads upwards instead of to the right.
    pub upright: bool,
    /// Heavier strokes.
    pub bold: bool,
}

impl Text {
    /// A text that begins at `at`.
    pub fn new(text: impl Into<String>, at: [f64; 2], size: f64) -> Self {
        let (colour, anchor) = (Colour::INK, Anchor::Start);
        Self { text: text.into(), at, size, colour, anchor, upright: false, bold: false }
    }
}

/// A picture of `width × height` pixels, first row at the top, red-green-blue-opacity.
#[derive(Clone, Debug, PartialEq)]
pub struct Bitmap {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Four bytes per pixel.
    pub rgba: Vec<u8>,
}

/// Something drawn.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    Path { points: Vec<[f64; 2]>, closed: bool, fill: Option<Colour>, pen: Option<Pen>, clip: Option<Area> },
    Discs { centres: Vec<[f64; 2]>, radius: f64, fill: Option<Colour>, pen: Option<Pen>, clip: Option<Area> },
    Text(Text),
    Picture { bitmap: Bitmap, area: Area },
}

/// A sheet to draw on.
#[derive(Clone, Debug)]
pub struct Canvas {
    /// Width in pixels.
    pub width: f64,
    /// Height in pixels.
    pub height: f64,
    pub(crate) items: Vec<Item>,
    clip: Option<Area>,
}

impl Canvas {
    /// A white sheet.
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, items: Vec::new(), clip: None }
    }

    /// What is drawn from now on shows inside `area` only; `None` lifts the restriction. Text is never cut.
    pub fn clip(&mut self, area: Option<Area>) {
        self.clip = area;
    }

    /// An open chain of segments.
    pub fn line(&mut self, points: Vec<[f64; 2]>, pen: Pen) {
        self.items.push(Item::Path { points, closed: false, fill: None, pen: Some(pen), clip: self.clip });
    }

    /// A closed shape.
    pub fn polygon(&mut self, points: Vec<[f64; 2]>, fill: Option<Colour>, pen: Option<Pen>) {
        self.items.push(Item::Path { points, closed: true, fill, pen, clip: self.clip });
    }

    /// A rectangle.
    pub fn rectangle(&mut self, area: Area, fill: Option<Colour>, pen: Option<Pen>) {
        let (right, bottom) = (area.x + area.width, area.y + area.height);
        self.polygon(vec![[area.x, area.y], [right, area.y], [right, bottom], [area.x, bottom]], fill, pen);
    }

    /// Equal discs.
    pub fn discs(&mut self, centres: Vec<[f64; 2]>, radius: f64, fill: Option<Colour>, pen: Option<Pen>) {
        self.items.push(Item::Discs { centres, radius, fill, pen, clip: self.clip });
    }

    /// Words.
    pub fn text(&mut self, text: Text) {
        self.items.push(Item::Text(text));
    }

    /// A picture stretched over `area`.
    pub fn picture(&mut self, bitmap: Bitmap, area: Area) {
        self.items.push(Item::Picture { bitmap, area });
    }

    /// The sheet as PNG with `scale` pixels per unit.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, ReportError> {
        super::paint::png(self, scale)
    }

    /// The sheet as a stand-alone SVG document.
    pub fn svg(&self) -> Result<String, ReportError> {
        let (w, h) = (self.width, self.height);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\" \
             font-family=\"Inter, Helvetica, Arial, sans-serif\">\n<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n"
        );
        for (k, item) in self.items.iter().enumerate() {
            svg_item(&mut svg, k, item)?;
        }
        svg.push_str("</svg>\n");
        Ok(svg)
    }
}

fn svg_item(svg: &mut String, k: usize, item: &Item) -> Result<(), ReportError> {
    match item {
        Item::Path { points, closed, fill, pen, clip } => {
            let mut path = String::new();
            for (i, p) in points.iter().filter(|p| p[0].is_finite() && p[1].is_finite()).enumerate() {
                let _ = write!(path, "{}{:.2} {:.2}", if i == 0 { 'M' } else { 'L' }, p[0], p[1]);
            }
            let end = if *closed { "Z" } else { "" };
            let clip = svg_clip(svg, k, *clip);
            let _ = writeln!(svg, r#"<path d="{path}{end}"{}{clip}/>"#, svg_style(*fill, *pen));
        }
        Item::Discs { centres, radius, fill, pen, clip } => {
            let clip = svg_clip(svg, k, *clip);
            let _ = writeln!(svg, "<g{}{clip}>", svg_style(*fill, *pen));
            for c in centres.iter().filter(|c| c[0].is_finite() && c[1].is_finite()) {
                let _ = writeln!(svg, r#"<circle cx="{:.2}" cy="{:.2}" r="{radius:.2}"/>"#, c[0], c[1]);
            }
            svg.push_str("</g>\n");
        }
        Item::Text(text) => svg_text(svg, text),
        Item::Picture { bitmap, area } => {
            let data = base64::engine::general_purpose::STANDARD.encode(super::paint::bitmap_png(bitmap)?);
            let Area { x, y, width, height } = area;
            let _ = writeln!(
                svg,
                r#"<image x="{x}" y="{y}" width="{width}" height="{height}" preserveAspectRatio="none" href="data:image/png;base64,{data}"/>"#
            );
        }
    }
    Ok(())
}

fn svg_clip(svg: &mut String, k: usize, clip: Option<Area>) -> String {
    let Some(Area { x, y, width, height }) = clip else { return String::new() };
    let _ =
        writeln!(svg, r#"<clipPath id="clip{k}"><rect x="{x}" y="{y}" width="{width}" height="{height}"/></clipPath>"#);
    format!(r#" clip-path="url(#clip{k})""#)
}

fn svg_style(fill: Option<Colour>, pen: Option<Pen>) -> String {
    let mut style = match fill {
        Some(c) => format!(r#" fill="{}" fill-opacity="{:.3}""#, c.hex(), f64::from(c.a) / 255.0),
        None => r#" fill="none""#.to_owned(),
    };
    if let Some(pen) = pen {
        let opacity = f64::from(pen.colour.a) / 255.0;
        let _ = write!(
            style,
            r#" stroke="{}" stroke-opacity="{opacity:.3}" stroke-width="{}" stroke-linejoin="round""#,
            pen.colour.hex(),
            pen.width
        );
        if pen.dashed {
            style.push_str(r#" stroke-dasharray="5 4""#);
        }
    }
    style
}

fn svg_text(svg: &mut String, text: &Text) {
    let anchor = match text.anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let [x, y] = text.at;
    let turn = if text.upright { format!(r#" transform="rotate(-90 {x:.2} {y:.2})""#) } else { String::new() };
    let weight = if text.bold { r#" font-weight="600""# } else { "" };
    let _ = writeln!(
        svg,
        r#"<text x="{x:.2}" y="{y:.2}" font-size="{}" fill="{}" text-anchor="{anchor}"{weight}{turn}>{}</text>"#,
        text.size,
        text.colour.hex(),
        escape(&text.text)
    );
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
