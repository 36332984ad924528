//! Scales, ticks and the frame of a plot.
//!
//! Linear ticks stand at multiples of 1, 2 or 5 times a power of ten; logarithmic ticks at powers of ten.
use serde::Serialize;

use super::canvas::{Anchor, Area, Canvas, Pen, Text};
use super::colour::Colour;
use super::font::{self, OTHER_FONTS};

/// Size of tick labels in pixels.
pub(crate) const TICK_SIZE: f64 = 12.0;
/// Size of axis labels in pixels.
pub(crate) const LABEL_SIZE: f64 = 13.5;
/// Size of titles in pixels.
pub(crate) const TITLE_SIZE: f64 = 16.0;
/// Room beside a title.
pub(super) const TITLE_MARGIN: f64 = 12.0;
/// From the plot to the label beside it: room for tick labels of eight characters.
const LABEL_ROOM: f64 = 62.0;
/// Pixels from one tick to the next, at least: beside one another, above one another.
const TICK_ROOM: [f64; 2] = [80.0, 50.0];

/// A map from values to a side of a plot: `from` stands at its beginning, `to` at its end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scale {
    /// Value at the left or the bottom.
    pub from: f64,
    /// Value at the right or the top; smaller than `from` on a reversed axis.
    pub to: f64,
    /// Logarithmic.
    pub log: bool,
}

/// A labelled position on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Value.
    pub value: f64,
    /// Text beside it.
    pub label: String,
}

impl Scale {
    /// A scale around all usable values, with a little room on both sides; 0 to 1 when there are none.
    pub fn around(values: impl Iterator<Item = f64>, log: bool, reversed: bool) -> Self {
        let usable = values.filter(|v| v.is_finite() && (!log || *v > 0.0)).map(|v| if log { v.log10() } else { v });
        let [min, max] = usable.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        let [min, max] = if min <= max { [min, max] } else { [0.0, 1.0] };
        // A flat curve gets a window of one part in ten, so that rounding noise does not fill the plot.
        let room = if max > min { 0.05 * (max - min) } else { 0.1 * min.abs().max(0.1) };
        let [min, max] = [min - room, max + room];
        let [min, max] = if log { [10.0_f64.powf(min), 10.0_f64.powf(max)] } else { [min, max] };
        if reversed { Self { from: max, to: min, log } } else { Self { from: min, to: max, log } }
    }

    /// Where `value` stands between the beginning (0) and the end (1).
    pub fn fraction(&self, value: f64) -> f64 {
        if self.log {
            (value.log10() - self.from.log10()) / (self.to.log10() - self.from.log10())
        } else {
            (value - self.from) / (self.to - self.from)
        }
    }

    /// The scale over `factor` times as much, about its middle.
    fn widened(self, factor: f64) -> Self {
        let (middle, half) = (0.5 * (self.from + self.to), 0.5 * factor * (self.to - self.from));
        Self { from: middle - half, to: middle + half, ..self }
    }

    /// About `count` round values on the scale.
    pub fn ticks(&self, count: usize) -> Vec<Tick> {
        let [min, max] = if self.from < self.to { [self.from, self.to] } else { [self.to, self.from] };
        if self.log && max / min >= 10.0 { log_ticks(min, max, count) } else { linear_ticks(min, max, count) }
    }
}

fn linear_ticks(min: f64, max: f64, count: usize) -> Vec<Tick> {
    let step = round_step((max - min) / count.max(1) as f64);
    if !(step > 0.0 && step.is_finite()) || (max / step).abs() > 1e12 {
        return Vec::new();
    }
    let (first, last) = ((min / step - 1e-9).ceil() as i64, (max / step + 1e-9).floor() as i64);
    (first..=last).map(|k| k as f64 * step).map(|value| Tick { value, label: label(value, step) }).collect()
}

fn log_ticks(min: f64, max: f64, count: usize) -> Vec<Tick> {
    let (first, last) = ((min.log10() - 1e-9).ceil() as i32, (max.log10() + 1e-9).floor() as i32);
    let stride = ((last - first) as f64 / count.max(1) as f64).ceil().max(1.0) as i32;
    let decades = (first..=last).filter(|k| k.rem_euclid(stride) == 0);
    decades.map(|k| Tick { value: 10.0_f64.powi(k), label: power_of_ten(k) }).collect()
}

fn power_of_ten(k: i32) -> String {
    if k == 0 { "1".to_owned() } else { format!("1e{k}").replace('-', "\u{2212}") }
}

/// The smallest of 1, 2, 5, 10, … ≥ `rough`.
fn round_step(rough: f64) -> f64 {
    let power = 10.0_f64.powf(rough.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|f| rough <= f * power * (1.0 + 1e-9)).unwrap_or(10.0);
    factor * power
}

/// A tick label with as many decimals as the step asks for.
fn label(value: f64, step: f64) -> String {
    let large = value.abs().max(step);
    let text = if value == 0.0 {
        "0".to_owned()
    } else if !(1e-4..1e6).contains(&large) {
        let digits = (large.log10().floor() - step.log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{value:.digits$e}")
    } else {
        let decimals = (-(step.log10() + 1e-9).floor()).clamp(0.0, 9.0) as usize;
        format!("{value:.decimals$}")
    };
    text.replace('-', "\u{2212}")
}

/// A plot area with a scale on each side.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Frame {
    /// Where curves are drawn.
    pub area: Area,
    /// Horizontal scale.
    pub x: Scale,
    /// Vertical scale.
    pub y: Scale,
}

impl Frame {
    /// The place of a point on the canvas.
    pub fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let Area { x: left, y: top, width, height } = self.area;
        [left + self.x.fraction(x) * width, top + (1.0 - self.y.fraction(y)) * height]
    }

    /// The frame with one of its linear scales widened until a unit is as long on both.
    pub fn with_equal_units(self) -> Self {
        let pixels = |length: f64, scale: Scale| length / (scale.to - scale.from).abs();
        let ratio = pixels(self.area.width, self.x) / pixels(self.area.height, self.y);
        match ratio > 1.0 {
            true => Self { x: self.x.widened(ratio), ..self },
            false => Self { y: self.y.widened(1.0 / ratio), ..self },
        }
    }

    /// Ticks below, each with its place from the left.
    fn ticks_below(&self) -> impl Iterator<Item = (f64, Tick)> {
        let ticks = self.x.ticks((self.area.width / TICK_ROOM[0]).clamp(5.0, 10.0) as usize);
        ticks.into_iter().map(|tick| (self.area.x + self.x.fraction(tick.value) * self.area.width, tick))
    }

    /// Ticks beside, each with its place from the top.
    fn ticks_beside(&self) -> impl Iterator<Item = (f64, Tick)> {
        let ticks = self.y.ticks((self.area.height / TICK_ROOM[1]).clamp(4.0, 6.0) as usize);
        ticks.into_iter().map(|tick| (self.area.y + (1.0 - self.y.fraction(tick.value)) * self.area.height, tick))
    }

    /// Draws grid lines at the ticks; under everything else.
    pub fn grid(&self, canvas: &mut Canvas) {
        let Area { x, y, width, height } = self.area;
        let pen = Pen::new(Colour::GRID, 1.0);
        canvas.layer("grid", None);
        self.ticks_below().for_each(|(at, _)| canvas.line(vec![[at, y], [at, y + height]], pen));
        self.ticks_beside().for_each(|(at, _)| canvas.line(vec![[x, at], [x + width, at]], pen));
    }

    /// Draws the border, ticks and labels; over everything else.
    pub fn border(&self, canvas: &mut Canvas, x_label: &str, y_label: &str) {
        let Area { x, y, width, height } = self.area;
        let (bottom, ink) = (y + height, Pen::new(Colour::INK, 1.0));
        canvas.layer("ticks", None);
        for (at, tick) in self.ticks_below() {
            canvas.line(vec![[at, bottom], [at, bottom + 4.0]], ink);
            canvas.text(tick_text(tick.label, [at, bottom + 8.0 + TICK_SIZE * 0.8], Anchor::Middle));
        }
        for (at, tick) in self.ticks_beside() {
            canvas.line(vec![[x - 4.0, at], [x, at]], ink);
            canvas.text(tick_text(tick.label, [x - 8.0, at + TICK_SIZE * 0.35], Anchor::End));
        }
        canvas.layer("border", None);
        canvas.rectangle(self.area, None, Some(ink));
        let middle = [x + 0.5 * width, y + 0.5 * height];
        let below = Text::new(x_label, [middle[0], bottom + 20.0 + TICK_SIZE + LABEL_SIZE * 0.6], LABEL_SIZE);
        canvas.text(Text { anchor: Anchor::Middle, ..below.within(width) });
        let beside = Text::new(y_label, [x - LABEL_ROOM, middle[1]], LABEL_SIZE);
        canvas.text(Text { anchor: Anchor::Middle, upright: true, ..beside.within(height) });
    }
}

pub(crate) fn tick_text(label: String, at: [f64; 2], anchor: Anchor) -> Text {
    Text { anchor, colour: Colour::GREY, ..Text::new(label, at, TICK_SIZE) }
}

/// Draws a title from `at` on, inside the sheet: one too long begins farther left, is drawn smaller, and is cut at the very last.
pub(super) fn draw_title(canvas: &mut Canvas, title: &str, at: [f64; 2]) {
    let text = Text { bold: true, ..Text::new(title, at, TITLE_SIZE) }.within(canvas.width - 2.0 * TITLE_MARGIN);
    let wide = title_width(&text.text) * text.size / TITLE_SIZE;
    let left = at[0].min(canvas.width - TITLE_MARGIN - wide).max(TITLE_MARGIN);
    canvas.text(Text { at: [left, at[1]], ..text });
}

/// Width of a title, whatever the font.
pub(super) fn title_width(title: &str) -> f64 {
    OTHER_FONTS * TITLE_SIZE * font::width(title)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale) -> Vec<String> {
        scale.ticks(5).into_iter().map(|t| t.label).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels(Scale { from: 0.0, to: 1.0, log: false }), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(Scale { from: 1.2, to: -1.3, log: false }), ["−1.0", "−0.5", "0", "0.5", "1.0"]);
        assert_eq!(labels(Scale { from: 1e-4, to: 1.0, log: true }), ["1e−4", "1e−3", "1e−2", "1e−1", "1"]);
        assert_eq!(labels(Scale { from: 0.0, to: 4e6, log: false })[1], "1e6");
    }

    #[test]
    fn a_unit_can_be_as_long_on_both_sides() {
        let area = Area { x: 0.0, y: 0.0, width: 400.0, height: 100.0 };
        let [x, y] = [[0.0, 2.0], [3.0, 1.0]].map(|[from, to]| Scale { from, to, log: false });
        let frame = Frame { area, x, y }.with_equal_units();
        assert_eq!([frame.x.from, frame.x.to, frame.y.from, frame.y.to], [-3.0, 5.0, 3.0, 1.0]);
    }

    #[test]
    fn strange_data_make_a_harmless_scale() {
        let nothing = Scale::around([f64::NAN, f64::INFINITY].into_iter(), false, false);
        assert!(nothing.from < 0.0 && 1.0 < nothing.to);
        let flat = Scale::around([2.0, 2.0].into_iter(), false, true);
        assert!(flat.from > 2.0 && flat.to < 2.0);
        let huge = Scale { from: 1e300, to: 1.0000000001e300, log: false };
        assert!(huge.ticks(5).len() < 20);
        assert!(Scale::around([0.0, -1.0].into_iter(), true, false).from > 0.0);
    }
}
