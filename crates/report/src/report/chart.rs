//! Charts: curves, dots and bars against a pair of axes, drawn once for SVG, PNG and the page.
//!
//! Curves are parametric: points are joined in their order, so that histories, loops and phase planes are drawn alike. A value
//! that is not a number interrupts its curve.
use serde::Serialize;

use super::ReportError;
use super::axes::{Frame, Scale, draw_title, title_width};
use super::canvas::{Area, Canvas, Dash, Pen, Text};
use super::colour::{CURVES, Colour};
use super::font::{self, LIFTED, OTHER_FONTS};

/// From the borders of a sheet to the plot.
const LEFT: f64 = 82.0;
const RIGHT: f64 = 22.0;
const TOP: f64 = 46.0;
const BOTTOM: f64 = 60.0;
/// Baseline of the title.
const TITLE_LINE: f64 = 28.0;
/// Size of legend texts in pixels.
const LEGEND_SIZE: f64 = 12.5;
/// Height of a row of the legend.
const LEGEND_ROW: f64 = 18.0;
/// Room for the mark of an entry of the legend, and between one entry and the next.
const LEGEND_MARK: f64 = 26.0;
const LEGEND_GAP: f64 = 16.0;

/// How the lines of one colour differ: the first of each colour, the second, and so on.
const DASHES: [Dash; 4] = [Dash::None, Dash::Long, Dash::Dots, Dash::DashDot];
/// Radius of the marks on a line.
const MARK: f64 = 2.6;

/// Where along a loop its arrows are.
const ARROWS: [f64; 2] = [0.125, 0.625];
/// Length of their heads, and half their width over it.
const ARROW: f64 = 11.0;
const SLENDER: f64 = 0.45;

/// Size of a sheet in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

impl Size {
    /// A file of its own.
    pub const FILE: Self = Self { width: 760.0, height: 470.0 };
    /// As wide as a page.
    pub const PAGE: Self = Self { width: 960.0, height: 430.0 };
    /// As wide as a page, for what needs height.
    pub const TALL: Self = Self { width: 960.0, height: 640.0 };
    /// One of several beside one another.
    pub const SMALL: Self = Self { width: 480.0, height: 310.0 };
}

/// One side of a chart.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Logarithmic; values that are not positive are left out.
    pub log: bool,
    /// Largest value at the bottom or the left: pressure coefficients.
    pub reversed: bool,
    /// A unit is as long as on the other axis: shapes and paths in the plane. Both must be linear.
    pub equal: bool,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Marks {
    /// Joined by straight lines.
    Line,
    /// Joined, with a mark at each point up to the first that is not a number; what follows that are error bars.
    Points,
    /// Joined, with arrows that tell in which order: loops against a motion.
    Loop,
    /// Joined by dashes: theory and fits.
    Dashes,
    /// Separate dots: computed values in no order along a curve.
    Dots,
    /// Separate rings: measurements and other references.
    Rings,
    /// Bars from zero; `x` holds the edges, one more than `y`.
    Bars,
}

/// Numbers of one kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// Name in the legend; no legend entry when empty.
    pub name: String,
    /// How it is drawn.
    pub marks: Marks,
    /// Horizontal positions.
    pub x: Vec<f64>,
    /// Vertical positions.
    pub y: Vec<f64>,
}

/// What tells the series of a chart apart: colours first, then dashes, and marks that are full or hollow.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Style {
    colour: Colour,
    dash: Dash,
    fill: Colour,
}

impl Style {
    /// That of the series with this number.
    fn of(number: usize) -> Self {
        let (colour, turn) = (CURVES[number % CURVES.len()], number / CURVES.len());
        let fill = if turn.is_multiple_of(2) { colour } else { Colour::PAPER };
        Self { colour, dash: DASHES[turn % DASHES.len()], fill }
    }
}

/// A chart.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Chart {
    /// Title.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Data, first series at the back.
    pub series: Vec<Series>,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), ..Self::default() }
    }

    /// A logarithmic axis.
    pub fn log(label: &str) -> Self {
        Self { label: label.to_owned(), log: true, ..Self::default() }
    }

    /// A linear axis on which a unit is as long as on the other one.
    pub fn equal(label: &str) -> Self {
        Self { label: label.to_owned(), equal: true, ..Self::default() }
    }

    /// An axis with the largest value at the bottom.
    pub fn reversed(label: &str) -> Self {
        Self { label: label.to_owned(), reversed: true, ..Self::default() }
    }
}

impl Series {
    /// Numbers under a name; an empty one has no entry in the legend.
    pub fn new(name: &str, marks: Marks, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { name: name.to_owned(), marks, x, y }
    }

    /// The same with the first point once more at the end.
    pub fn closed(mut self) -> Self {
        self.x.extend(self.x.first().copied());
        self.y.extend(self.y.first().copied());
        self
    }

    fn pen(&self, style: Style, width: f64) -> Pen {
        let dash = if self.marks == Marks::Dashes { Dash::Dashes } else { style.dash };
        Pen { dash, ..Pen::new(style.colour, width) }
    }
}

impl Chart {
    /// Leaves out points evenly where a series has more than `most`.
    pub(super) fn thin(&mut self, most: usize) {
        for series in self.series.iter_mut().filter(|s| s.marks != Marks::Bars) {
            let stride = series.x.len().div_ceil(most).max(1);
            let thinned = |values: &[f64]| values.iter().copied().step_by(stride).collect();
            (series.x, series.y) = (thinned(&series.x), thinned(&series.y));
        }
    }

    /// The chart as a stand-alone SVG document.
    pub fn svg(&self) -> Result<String, ReportError> {
        self.draw(Size::FILE).svg()
    }

    /// The chart as PNG, two pixels per unit.
    pub fn png(&self) -> Result<Vec<u8>, ReportError> {
        self.draw(Size::FILE).png(2.0)
    }

    /// The chart on a canvas; in the layer `curves`, series and items correspond.
    pub fn draw(&self, size: Size) -> Canvas {
        let (mut canvas, frame) = (Canvas::new(size.width, size.height), self.frame(size));
        draw_title(&mut canvas, &self.title, [LEFT, TITLE_LINE]);
        for entry in self.legend(size) {
            entry.draw(&mut canvas);
        }
        frame.grid(&mut canvas);
        canvas.layer("curves", Some(frame.area));
        for (k, series) in self.series.iter().enumerate() {
            draw_series(&mut canvas, &frame, series, Style::of(k));
        }
        frame.border(&mut canvas, &self.x.label, &self.y.label);
        canvas
    }

    /// Everything that a script needs beside the drawing.
    pub(super) fn data(&self, size: Size) -> ChartData<'_> {
        ChartData { chart: self, frame: self.frame(size) }
    }

    /// What the curves fill of a sheet.
    pub(super) fn area(&self, size: Size) -> Area {
        self.frame(size).area
    }

    fn frame(&self, size: Size) -> Frame {
        let top = self.legend(size).last().map_or(TOP, |entry| entry.at[1] + TOP - TITLE_LINE);
        let area = Area { x: LEFT, y: top, width: size.width - LEFT - RIGHT, height: size.height - top - BOTTOM };
        let frame = Frame { area, x: self.scale(&self.x, |s| &s.x), y: self.scale(&self.y, |s| &s.y) };
        let equal = (self.x.equal || self.y.equal) && !self.x.log && !self.y.log;
        if equal { frame.with_equal_units() } else { frame }
    }

    fn scale(&self, axis: &Axis, values: fn(&Series) -> &Vec<f64>) -> Scale {
        let bars = std::ptr::eq(axis, &self.y) && self.series.iter().any(|s| s.marks == Marks::Bars);
        let all = self.series.iter().flat_map(values).copied();
        let mut scale = Scale::around(all.chain(bars.then_some(0.0)), axis.log, axis.reversed);
        if bars && scale.from < 0.0 && self.series.iter().all(|s| s.y.iter().all(|y| *y >= 0.0)) {
            scale.from = 0.0;
        }
        scale
    }

    /// Entries of the legend: beside the title where there is room for all of them, else in rows below it.
    fn legend(&self, size: Size) -> Vec<Entry<'_>> {
        let width = |series: &Series| LEGEND_MARK + OTHER_FONTS * font::width(&series.name) * LEGEND_SIZE;
        let right = size.width - RIGHT;
        let mut named: Vec<_> = self.series.iter().enumerate().filter(|(_, s)| !s.name.is_empty()).collect();
        named.retain(|(_, series)| self.series.len() > 1 || series.name != self.y.label);
        let all = named.iter().map(|(_, series)| width(series) + LEGEND_GAP).sum::<f64>() - LEGEND_GAP;
        let beside = LEFT + title_width(&self.title) + LEGEND_GAP <= right - all;
        let mut next = if beside { [right - all, TITLE_LINE] } else { [LEFT, TITLE_LINE + LEGEND_ROW] };
        let entry = |(k, series): (usize, _)| {
            if next[0] > LEFT && next[0] + width(series) > right + 1e-6 {
                next = [LEFT, next[1] + LEGEND_ROW];
            }
            let at = next;
            next[0] += width(series) + LEGEND_GAP;
            Entry { series, style: Style::of(k), at, room: right - at[0] - LEGEND_MARK }
        };
        named.into_iter().map(entry).collect()
    }
}

/// A chart and where it is drawn.
#[derive(Serialize)]
pub(super) struct ChartData<'a> {
    #[serde(flatten)]
    chart: &'a Chart,
    frame: Frame,
}

/// A series in the legend, from `at` to the right.
struct Entry<'a> {
    series: &'a Series,
    style: Style,
    at: [f64; 2],
    /// Room for its name, in pixels.
    room: f64,
}

impl Entry<'_> {
    fn draw(&self, canvas: &mut Canvas) {
        let Self { style, at: [x, line], .. } = *self;
        let (y, colour) = (line - 4.0, style.colour);
        match self.series.marks {
            Marks::Line | Marks::Loop | Marks::Dashes => {
                canvas.line(vec![[x, y], [x + 20.0, y]], self.series.pen(style, 2.2));
            }
            Marks::Points => {
                let line = vec![[x, y], [x + 20.0, y]];
                canvas.marked_line((line, vec![[x + 10.0, y]]), MARK, style.fill, self.series.pen(style, 1.8));
            }
            Marks::Dots => canvas.discs(vec![[x + 12.0, y]], 3.0, Some(colour), None),
            Marks::Rings => canvas.discs(vec![[x + 12.0, y]], 3.6, None, Some(Pen::new(colour, 1.4))),
            Marks::Bars => {
                let swatch = Area { x: x + 8.0, y: y - 5.0, width: 12.0, height: 10.0 };
                canvas.rectangle(swatch, Some(colour), None);
            }
        }
        canvas.text(Text::new(&self.series.name, [x + LEGEND_MARK, line], LEGEND_SIZE).within(self.room));
    }
}

/// The head of an arrow at point `at` of a line, after a lifted pen; `None` where the line does not move on.
fn arrow(line: &[[f64; 2]], at: usize) -> Option<[[f64; 2]; 4]> {
    let (tip, before) = (line.get(at)?, line.get(at.checked_sub(1)?)?);
    let [dx, dy] = [tip[0] - before[0], tip[1] - before[1]];
    let size = dx.hypot(dy);
    if !size.is_finite() || size == 0.0 {
        return None;
    }
    let [dx, dy] = [dx / size * ARROW, dy / size * ARROW];
    let side = |s: f64| [tip[0] - dx + s * dy * SLENDER, tip[1] - dy - s * dx * SLENDER];
    Some([LIFTED, side(-1.0), *tip, side(1.0)])
}

/// Draws a series as one item.
fn draw_series(canvas: &mut Canvas, frame: &Frame, series: &Series, style: Style) {
    let colour = style.colour;
    let places = || series.x.iter().zip(&series.y).map(|(x, y)| frame.place(*x, *y)).collect();
    match series.marks {
        Marks::Line | Marks::Dashes => canvas.line(places(), series.pen(style, 1.8)),
        Marks::Points => {
            let places: Vec<[f64; 2]> = places();
            let marks = places.iter().copied().take_while(|p| p.iter().all(|c| c.is_finite())).collect();
            canvas.marked_line((places, marks), MARK, style.fill, series.pen(style, 1.4));
        }
        Marks::Loop => {
            let places: Vec<[f64; 2]> = places();
            let arrows = ARROWS.iter().filter_map(|part| arrow(&places, (part * places.len() as f64) as usize));
            let all = places.iter().copied().chain(arrows.flatten()).collect();
            canvas.line(all, series.pen(style, 1.8));
        }
        Marks::Dots => canvas.discs(places(), 2.2, Some(colour), None),
        Marks::Rings => canvas.discs(places(), 3.2, None, Some(Pen::new(colour, 1.3))),
        Marks::Bars => {
            let bar = |(edges, y): (&[f64], &f64)| {
                let [low, high] = [frame.place(edges[0], 0.0), frame.place(edges[1], *y)];
                // One pixel of paper between bars.
                let area = Area { x: low[0], y: high[1], width: high[0] - low[0] - 1.0, height: low[1] - high[1] };
                area.corners().into_iter().chain([LIFTED])
            };
            let bars = series.x.windows(2).zip(&series.y).flat_map(bar).collect();
            canvas.polygon(bars, Some(colour.faded(215)), None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::overview::tests::assert_balanced;
    use crate::report::picture::tests::keep;

    fn pressure() -> Chart {
        let x: Vec<f64> = (0..120).map(|k| (f64::from(k) / 119.0).powi(2)).collect();
        let upper = x.iter().map(|x| if *x < 0.61 { -1.15 + 0.2 * (9.0 * x).sin() } else { -0.1 + 0.4 * (x - 0.6) });
        Chart {
            title: "Pressure coefficient".into(),
            x: Axis::linear("x/c"),
            y: Axis::reversed("Cp"),
            series: vec![
                Series { name: "Alula, aerofoil".into(), marks: Marks::Dots, y: upper.collect(), x },
                Series {
                    name: "CFL3D, 80 chords".into(),
                    marks: Marks::Rings,
                    x: vec![0.1, 0.3, 0.5, 0.9],
                    y: vec![-1.0, -1.1, -1.2, f64::NAN],
                },
            ],
        }
    }

    #[test]
    fn a_pressure_chart_has_both_formats() {
        let svg = pressure().svg().unwrap();
        assert_balanced(&svg);
        assert!(svg.contains("CFL3D, 80 chords") && !svg.contains("NaN"));
        let png = pressure().png().unwrap();
        assert!(png.starts_with(b"\x89PNG"));
        keep("chart-cp.png", &png);
    }

    #[test]
    fn residuals_and_histograms_are_drawn() {
        let x: Vec<f64> = (0..200).map(f64::from).collect();
        let y: Vec<f64> = x.iter().map(|x| 10.0_f64.powf(-0.05 * x) * (1.2 + (0.7 * x).sin())).collect();
        let residual = Chart {
            title: "Residual".into(),
            x: Axis::linear("iteration"),
            y: Axis::log("residual"),
            series: vec![Series { name: "residual".into(), marks: Marks::Line, x, y }],
        };
        keep("chart-residual.png", &residual.png().unwrap());
        let bars = Chart {
            title: "Neighbours per particle".into(),
            x: Axis::linear("neighbours"),
            y: Axis::linear("particles"),
            series: vec![Series {
                name: String::new(),
                marks: Marks::Bars,
                x: vec![8.0, 10.0, 12.0, 14.0, 16.0],
                y: vec![120.0, 5_400.0, 3_200.0, 80.0],
            }],
        };
        keep("chart-bars.png", &bars.png().unwrap());
        assert_balanced(&bars.svg().unwrap());
    }

    #[test]
    fn thirteen_curves_are_told_apart() {
        let all: Vec<Style> = (0..24).map(Style::of).collect();
        for (k, style) in all.iter().enumerate() {
            assert!(!all[..k].contains(style), "{k}");
        }
        let curve = |k: u32| Series::new(&format!("{k}"), Marks::Points, vec![0.0, 1.0], vec![0.0, f64::from(k)]);
        let chart = Chart { title: "CL".repeat(150), series: (0..13).map(curve).collect(), ..Chart::default() };
        let svg = chart.svg().unwrap();
        assert_balanced(&svg);
        // the same colour comes three times, each with a dash of its own; each line has its marks, and one in the legend
        let first = CURVES[0].hex();
        let with = |fill: &str| {
            svg.matches(&format!(
                "<g stroke=\"{first}\" stroke-width=\"1.4\" stroke-linejoin=\"round\" fill=\"{fill}\""
            ))
            .count()
        };
        assert_eq!([with(&first), with(&Colour::PAPER.hex())], [2, 1]);
        assert_eq!(svg.matches("<circle").count(), 13 * 3);
        assert!(svg.contains("...</text>"), "a title that is too long is cut where the sheet ends");
        assert!(chart.png().is_ok());
    }

    #[test]
    fn phase_planes_of_several_runs_share_a_chart() {
        let run = |speed: u32, marks| {
            let t = (0..400).map(|k| 0.05 * f64::from(k));
            let point = |t: f64| {
                let size = (-0.02 * f64::from(speed) * t).exp();
                [size * t.cos(), -size * t.sin()]
            };
            let (x, y) = t.map(|t| point(t).into()).unzip();
            Series::new(&format!("pitch at {speed} of the flutter speed"), marks, x, y)
        };
        let mut series: Vec<Series> = (1..6).map(|k| run(k, Marks::Line)).collect();
        series[2].x[100] = f64::NAN;
        series.push(run(6, Marks::Dashes));
        let chart =
            Chart { title: "Phase plane".into(), x: Axis::linear("α"), y: Axis::equal("dα/dτ / ω"), series };
        let frame = chart.frame(Size::FILE);
        let [a, b] = [frame.place(0.0, 0.0), frame.place(1.0, 1.0)];
        assert!(((b[0] - a[0]) + (b[1] - a[1])).abs() < 1e-9, "a unit is as long on both axes");
        let legend = chart.legend(Size::FILE);
        assert!(legend.len() == 6 && legend[5].at[1] < frame.area.y && legend[0].at[1] > TITLE_LINE, "rows of its own");
        let canvas = chart.draw(Size::FILE);
        let curves = canvas.layers.iter().find(|layer| layer.name == "curves").unwrap();
        assert_eq!(curves.items.len(), 6, "one item for each series, interrupted or not");
        let svg = canvas.svg().unwrap();
        assert_balanced(&svg);
        keep("chart-phase.svg", svg.as_bytes());
        keep("chart-phase.png", &chart.png().unwrap());
    }

    #[test]
    fn loops_tell_their_direction() {
        let line = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]];
        let head = arrow(&line, 1).unwrap();
        assert!(head[0][0].is_nan() && head[2] == [10.0, 0.0] && head[1][0] < 10.0 && head[1][1] == -head[3][1]);
        assert!(arrow(&line, 0).is_none() && arrow(&[[1.0, 1.0]; 2], 1).is_none() && arrow(&line, 3).is_none());
    }

    #[test]
    fn an_empty_chart_is_no_failure() {
        let ragged = Series { name: "a".into(), marks: Marks::Bars, x: vec![], y: vec![1.0] };
        let chart = Chart { series: vec![ragged], ..Chart::default() };
        assert!(chart.png().is_ok() && chart.svg().is_ok());
    }
}
