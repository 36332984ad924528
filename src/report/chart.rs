//! Charts: curves, dots and bars against a pair of axes, as SVG, PNG or data for the interactive page.
use serde::Serialize;

use super::ReportError;
use super::axes::{Frame, Scale, TITLE_SIZE};
use super::canvas::{Anchor, Area, Canvas, Pen, Text};
use super::colour::{CURVES, Colour};

/// Size of the sheet in pixels.
const SHEET: [f64; 2] = [760.0, 470.0];
/// Size of legend texts in pixels.
const LEGEND_SIZE: f64 = 12.5;

/// One side of a chart.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Logarithmic; values that are not positive are left out.
    pub log: bool,
    /// Largest value at the bottom or the left: pressure coefficients.
    pub reversed: bool,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Marks {
    /// Joined by straight lines.
    Line,
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
        Self { label: label.to_owned(), log: true, reversed: false }
    }

    /// An axis with the largest value at the bottom.
    pub fn reversed(label: &str) -> Self {
        Self { label: label.to_owned(), log: false, reversed: true }
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
        self.draw().svg()
    }

    /// The chart as PNG, two pixels per unit.
    pub fn png(&self) -> Result<Vec<u8>, ReportError> {
        self.draw().png(2.0)
    }

    /// The chart on a canvas.
    pub fn draw(&self) -> Canvas {
        let mut canvas = Canvas::new(SHEET[0], SHEET[1]);
        let area = Area { x: 82.0, y: 46.0, width: SHEET[0] - 104.0, height: SHEET[1] - 106.0 };
        let frame = Frame { area, x: self.scale(0), y: self.scale(1) };
        let title = Text::new(&self.title, [area.x, 28.0], TITLE_SIZE);
        canvas.text(Text { bold: true, ..title });
        frame.grid(&mut canvas);
        canvas.clip(Some(area));
        for (series, colour) in self.series.iter().zip(CURVES.iter().cycle()) {
            draw_series(&mut canvas, &frame, series, *colour);
        }
        canvas.clip(None);
        frame.border(&mut canvas, &self.x.label, &self.y.label);
        self.legend(&mut canvas, area);
        canvas
    }

    fn scale(&self, side: usize) -> Scale {
        let axis = if side == 0 { &self.x } else { &self.y };
        let bars = self.series.iter().any(|s| s.marks == Marks::Bars);
        let values = self.series.iter().flat_map(|s| if side == 0 { &s.x } else { &s.y }).copied();
        let zero = (bars && side == 1).then_some(0.0);
        let mut scale = Scale::around(values.chain(zero), axis.log, axis.reversed);
        if bars && side == 1 && scale.from < 0.0 && self.series.iter().all(|s| s.y.iter().all(|y| *y >= 0.0)) {
            scale.from = 0.0;
        }
        scale
    }

    fn legend(&self, canvas: &mut Canvas, area: Area) {
        let named: Vec<_> = self.series.iter().zip(CURVES.iter().cycle()).filter(|(s, _)| !s.name.is_empty()).collect();
        if named.len() < 2 && named.iter().all(|(s, _)| s.name == self.y.label) {
            return;
        }
        // To the right of the title, on one line: never over the data.
        let mut right = area.x + area.width;
        for (series, colour) in named.into_iter().rev() {
            let width = super::font::width(&series.name) * LEGEND_SIZE;
            let text = Text::new(&series.name, [right, 28.0], LEGEND_SIZE);
            canvas.text(Text { anchor: Anchor::End, ..text });
            let (left, y) = (right - width - 26.0, 24.0);
            match series.marks {
                Marks::Line => canvas.line(vec![[left, y], [left + 20.0, y]], Pen::new(*colour, 2.2)),
                Marks::Dots => canvas.discs(vec![[left + 12.0, y]], 3.0, Some(*colour), None),
                Marks::Rings => canvas.discs(vec![[left + 12.0, y]], 3.6, None, Some(Pen::new(*colour, 1.4))),
                Marks::Bars => {
                    let swatch = Area { x: left + 8.0, y: y - 5.0, width: 12.0, height: 10.0 };
                    canvas.rectangle(swatch, Some(*colour), None);
                }
            }
            right = left - 14.0;
        }
    }
}

fn draw_series(canvas: &mut Canvas, frame: &Frame, series: &Series, colour: Colour) {
    let places: Vec<[f64; 2]> = series.x.iter().zip(&series.y).map(|(x, y)| frame.place(*x, *y)).collect();
    match series.marks {
        Marks::Line => places
            .split(|p| !(p[0].is_finite() && p[1].is_finite()))
            .for_each(|piece| canvas.line(piece.to_vec(), Pen::new(colour, 1.8))),
        Marks::Dots => canvas.discs(places, 2.2, Some(colour), None),
        Marks::Rings => canvas.discs(places, 3.2, None, Some(Pen::new(colour, 1.3))),
        Marks::Bars => {
            for (edges, y) in series.x.windows(2).zip(&series.y) {
                let [low, high] = [frame.place(edges[0], 0.0), frame.place(edges[1], *y)];
                // One pixel of paper between bars.
                let area = Area { x: low[0], y: high[1], width: high[0] - low[0] - 1.0, height: low[1] - high[1] };
                canvas.rectangle(area, Some(colour.faded(215)), None);
            }
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
    fn an_empty_chart_is_no_failure() {
        let ragged = Series { name: "a".into(), marks: Marks::Bars, x: vec![], y: vec![1.0] };
        let chart = Chart { series: vec![ragged], ..Chart::default() };
        assert!(chart.png().is_ok() && chart.svg().is_ok());
    }
}
