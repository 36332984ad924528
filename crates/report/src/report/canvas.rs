//! A sheet of shapes and words: charts and pictures are drawn on it once, as a list that two thin writers take.
//!
//! The template `sheet.svg` writes the list as SVG, `paint` paints it as PNG. Coordinates are pixels, y down. A sheet has layers,
//! one above the other; a layer may show inside an area only. A point that is not finite lifts the pen.
use std::fmt::Write as _;

use askama::Template;
use serde::Serialize;

use super::colour::Colour;
use super::{ReportError, font};

/// An axis-aligned rectangle on a canvas.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
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

impl Area {
    /// Corners, one after another around it.
    pub fn corners(&self) -> [[f64; 2]; 4] {
        let (right, bottom) = (self.x + self.width, self.y + self.height);
        [[self.x, self.y], [right, self.y], [right, bottom], [self.x, bottom]]
    }
}

/// Smallest letters that a text is set in for want of room, in pixels.
const SMALLEST: f64 = 9.0;
/// Pixels by which a text may be longer than its room.
const ROUNDING: f64 = 1e-6;
/// What stands for the rest of a text that has no room even so.
const REST: &str = "...";

/// How a line is interrupted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    /// Not at all.
    None,
    /// Dashes: theory and fits.
    Dashes,
    /// Long dashes.
    Long,
    /// Dots.
    Dots,
    /// Dashes and dots in turn.
    DashDot,
}

impl Dash {
    /// Lengths of what is drawn and of what is left out, in turn; none of a full line.
    pub(crate) fn lengths(self) -> &'static [f32] {
        match self {
            Self::None => &[],
            Self::Dashes => &[5.0, 4.0],
            Self::Long => &[12.0, 4.0],
            Self::Dots => &[1.5, 4.0],
            Self::DashDot => &[9.0, 4.0, 1.5, 4.0],
        }
    }

    /// In the words of SVG; `None` for a full line.
    fn pattern(self) -> Option<String> {
        let lengths: Vec<String> = self.lengths().iter().map(f32::to_string).collect();
        (!lengths.is_empty()).then(|| lengths.join(" "))
    }
}

/// A line on a canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// Colour.
    pub colour: Colour,
    /// Width in pixels.
    pub width: f64,
    /// How it is interrupted.
    pub dash: Dash,
}

impl Pen {
    /// A full line.
    pub const fn new(colour: Colour, width: f64) -> Self {
        Self { colour, width, dash: Dash::None }
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

impl Anchor {
    /// In the words of SVG.
    fn word(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Middle => "middle",
            Self::End => "end",
        }
    }
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

    /// The same, no longer than so many pixels: in smaller letters, and cut where these are too small to read.
    pub(crate) fn within(mut self, room: f64) -> Self {
        let length = |text: &str, size: f64| font::OTHER_FONTS * font::width(text) * size;
        let whole = length(&self.text, self.size);
        if whole <= room + ROUNDING {
            return self;
        }
        self.size = (self.size * room / whole).clamp(SMALLEST.min(self.size), self.size);
        if length(&self.text, self.size) > room + ROUNDING {
            let mut letters: Vec<char> = self.text.chars().collect();
            let told = |letters: &[char]| letters.iter().collect::<String>().trim_end().to_owned() + REST;
            while !letters.is_empty() && length(&told(&letters), self.size) > room {
                letters.pop();
            }
            self.text = told(&letters);
        }
        self
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

impl Bitmap {
    /// The picture as an address that holds all of it.
    fn address(&self) -> askama::Result<String> {
        let png = self.png().map_err(askama::Error::custom)?;
        Ok(super::data_address("png", &png))
    }
}

/// Something drawn.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    Path {
        outline: Outline,
        fill: Option<Colour>,
        pen: Option<Pen>,
    },
    Discs {
        centres: Vec<[f64; 2]>,
        radius: f64,
        fill: Option<Colour>,
        pen: Option<Pen>,
    },
    /// A line with a disc at each of its points.
    Marked {
        outline: Outline,
        centres: Vec<[f64; 2]>,
        radius: f64,
        fill: Colour,
        pen: Pen,
    },
    Text(Text),
    Picture {
        bitmap: Bitmap,
        area: Area,
    },
}

/// Chains of segments.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    pub(crate) points: Vec<[f64; 2]>,
    /// The last point of each chain is joined to its first.
    pub(crate) closed: bool,
}

impl Outline {
    /// The chains, one after another.
    pub(crate) fn chains(&self) -> impl Iterator<Item = &[[f64; 2]]> {
        self.points.split(|p| !finite(p)).filter(|chain| !chain.is_empty())
    }

    /// In the words of SVG.
    fn commands(&self) -> String {
        let mut path = String::new();
        for chain in self.chains() {
            for (k, [x, y]) in chain.iter().enumerate() {
                let _ = write!(path, "{}{x:.2} {y:.2}", if k == 0 { 'M' } else { 'L' });
            }
            path.push_str(if self.closed { "Z" } else { "" });
        }
        path
    }
}

fn finite(p: &[f64; 2]) -> bool {
    p[0].is_finite() && p[1].is_finite()
}

/// Things drawn one after another.
#[derive(Clone, Debug)]
pub(crate) struct Layer {
    /// How scripts find it.
    pub(crate) name: &'static str,
    /// Where it shows; absent: everywhere.
    pub(crate) clip: Option<Area>,
    pub(crate) items: Vec<Item>,
}

/// A sheet to draw on.
#[derive(Clone, Debug, Template)]
#[template(path = "sheet.svg")]
pub struct Canvas {
    /// Width in pixels.
    pub width: f64,
    /// Height in pixels.
    pub height: f64,
    pub(crate) layers: Vec<Layer>,
}

impl Canvas {
    /// A white sheet with one layer.
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, layers: vec![Layer { name: "sheet", clip: None, items: Vec::new() }] }
    }

    /// Begins a layer above all others; with `clip` it shows inside that area only.
    pub fn layer(&mut self, name: &'static str, clip: Option<Area>) {
        self.layers.push(Layer { name, clip, items: Vec::new() });
    }

    fn draw(&mut self, item: Item) {
        if let Some(layer) = self.layers.last_mut() {
            layer.items.push(item);
        }
    }

    /// An open chain of segments.
    pub fn line(&mut self, points: Vec<[f64; 2]>, pen: Pen) {
        self.draw(Item::Path { outline: Outline { points, closed: false }, fill: None, pen: Some(pen) });
    }

    /// A closed shape.
    pub fn polygon(&mut self, points: Vec<[f64; 2]>, fill: Option<Colour>, pen: Option<Pen>) {
        self.draw(Item::Path { outline: Outline { points, closed: true }, fill, pen });
    }

    /// A rectangle.
    pub fn rectangle(&mut self, area: Area, fill: Option<Colour>, pen: Option<Pen>) {
        self.polygon(area.corners().to_vec(), fill, pen);
    }

    /// Equal discs.
    pub fn discs(&mut self, mut centres: Vec<[f64; 2]>, radius: f64, fill: Option<Colour>, pen: Option<Pen>) {
        centres.retain(finite);
        self.draw(Item::Discs { centres, radius, fill, pen });
    }

    /// An open chain of segments with equal discs at `centres`, as one item.
    pub(crate) fn marked_line(
        &mut self,
        (points, centres): (Vec<[f64; 2]>, Vec<[f64; 2]>),
        radius: f64,
        fill: Colour,
        pen: Pen,
    ) {
        let centres = centres.into_iter().filter(finite).collect();
        self.draw(Item::Marked { outline: Outline { points, closed: false }, centres, radius, fill, pen });
    }

    /// Words.
    pub fn text(&mut self, text: Text) {
        self.draw(Item::Text(text));
    }

    /// A picture stretched over `area`.
    pub fn picture(&mut self, bitmap: Bitmap, area: Area) {
        self.draw(Item::Picture { bitmap, area });
    }

    /// Puts another sheet on this one, with its upper left corner at `at`.
    pub(crate) fn sheet(&mut self, other: &Self, at: [f64; 2]) {
        let moved = |p: &[f64; 2]| [p[0] + at[0], p[1] + at[1]];
        let area = |a: &Area| Area { x: a.x + at[0], y: a.y + at[1], ..*a };
        let item = |item: &Item| match item {
            Item::Path { outline, fill, pen } => {
                let points = outline.points.iter().map(moved).collect();
                Item::Path { outline: Outline { points, closed: outline.closed }, fill: *fill, pen: *pen }
            }
            Item::Discs { centres, radius, fill, pen } => {
                Item::Discs { centres: centres.iter().map(moved).collect(), radius: *radius, fill: *fill, pen: *pen }
            }
            Item::Marked { outline, centres, radius, fill, pen } => Item::Marked {
                outline: Outline { points: outline.points.iter().map(moved).collect(), closed: outline.closed },
                centres: centres.iter().map(moved).collect(),
                radius: *radius,
                fill: *fill,
                pen: *pen,
            },
            Item::Text(text) => Item::Text(Text { at: moved(&text.at), ..text.clone() }),
            Item::Picture { bitmap, area: own } => Item::Picture { bitmap: bitmap.clone(), area: area(own) },
        };
        self.layers.extend(other.layers.iter().map(|layer| Layer {
            name: layer.name,
            clip: layer.clip.as_ref().map(area),
            items: layer.items.iter().map(item).collect(),
        }));
    }

    /// The sheet as a stand-alone SVG document.
    pub fn svg(&self) -> Result<String, ReportError> {
        Ok(self.render()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_fit_into_their_room() {
        let length = |t: &Text| font::OTHER_FONTS * font::width(&t.text) * t.size;
        let title = |words: usize| Text::new("wing with flap ".repeat(words), [0.0; 2], 16.0).within(300.0);
        let (short, long, longest) = (title(1), title(3), title(40));
        assert_eq!((short.size, long.text.len()), (16.0, 45));
        assert!(SMALLEST < long.size && long.size < 16.0 && length(&long) < 300.1, "{long:?}");
        assert!(longest.text.ends_with(REST) && longest.size == SMALLEST && length(&longest) < 300.0, "{longest:?}");
        assert_eq!(Text::new("", [0.0; 2], 16.0).within(10.0).text, "");
    }
}
