//! Charts of a flutter boundary: damping, frequency and eigenvalues of every mode along the speed, all crossings against the Mach number, and
//! limit cycles.
use super::super::chart::{Axis, Chart, Marks, Series};
use super::found::{branches, place, place_of, varied};
use crate::case::Matching;
use crate::observe::structure::is_angle;
use crate::record::flutter::{Boundary, FlutterAt, FlutterRow, LimitCycle, MotionRow};

/// Kinds of crossings, and how they are drawn.
const KINDS: [(&str, Marks); 3] =
    [("flutter", Marks::Dots), ("restabilised", Marks::Rings), ("divergence", Marks::Rings)];
/// Width of the ends of an error bar over what the axis spans.
const CAP: f64 = 0.006;

/// All charts of a run with the names of their files.
pub(super) fn all(found: &Boundary) -> Vec<(String, Chart)> {
    let mut charts = Vec::new();
    for at in &found.flutter {
        let own = [("damping", damping(at)), ("frequency", frequency(at)), ("root-locus", locus(at))];
        charts.extend(own.map(|(name, chart)| (format!("{name}-mach-{:.3}", at.mach), chart)));
    }
    charts.extend(limit_cycles(found).map(|chart| ("limit-cycles".to_owned(), chart)));
    charts.extend(boundary(found).map(|chart| ("boundary".to_owned(), chart)));
    charts
}

/// Damping of every mode, and where it vanishes.
pub(super) fn damping(at: &FlutterAt) -> Chart {
    let chart = along(at, "Damping", "g = 2 zeta, growth positive", |m| m.damping);
    let still: Vec<f64> = chart.series.iter().flat_map(|s| &s.x).copied().collect();
    let ends = [f64::min, f64::max].map(|f| still.iter().copied().reduce(f).unwrap_or(f64::NAN));
    let neutral = Series::new("", Marks::Dashes, ends.to_vec(), vec![0.0; 2]);
    let chart = marked(chart, at, |_| 0.0);
    Chart { series: chart.series.into_iter().chain([neutral]).collect(), ..chart }
}

/// Frequency of every mode, and that of crossings.
pub(super) fn frequency(at: &FlutterAt) -> Chart {
    let unit = if at.dimensional { "Hz" } else { "cycles per unit of time" };
    let chart = along(at, "Frequency", unit, |m| m.frequency);
    marked(chart, at, |c| c.frequency)
}

fn along(at: &FlutterAt, title: &str, y: &str, of: fn(&MotionRow) -> f64) -> Chart {
    let line = |(name, all): (&str, Vec<&MotionRow>)| {
        let (x, y) = all.into_iter().filter(|m| !m.rests()).map(|m| (place(at, m), of(m))).unzip();
        Series::new(name, Marks::Line, x, y)
    };
    Chart {
        title: format!("{title}, Mach {}", at.mach),
        x: Axis::linear(varied(at)),
        y: Axis::linear(y),
        series: branches(at).into_iter().map(line).filter(|s| !s.x.is_empty()).collect(),
    }
}

/// The same with crossings at the heights `of`.
fn marked(mut chart: Chart, at: &FlutterAt, of: fn(&FlutterRow) -> f64) -> Chart {
    chart.series.extend(of_kinds(at.crossings.iter(), |c| [place_of(at, c), of(c)]));
    chart
}

/// A series for each kind of crossing that there is; rings are seen on the lines that they mark.
fn of_kinds<'a>(
    all: impl Iterator<Item = &'a FlutterRow> + Clone,
    place: impl Fn(&FlutterRow) -> [f64; 2],
) -> Vec<Series> {
    let one = |(kind, _): (&str, Marks)| {
        let (x, y) = all.clone().filter(|c| c.kind == kind).map(|c| place(c).into()).unzip();
        Series::new(kind, Marks::Rings, x, y)
    };
    KINDS.map(one).into_iter().filter(|s| !s.x.is_empty()).collect()
}

/// Eigenvalues of every mode along the speed: where they begin, and where they cross the axis.
pub(super) fn locus(at: &FlutterAt) -> Chart {
    let modes = branches(at);
    let line = |(name, all): &(&str, Vec<&MotionRow>)| {
        let (x, y) = all.iter().map(|m| m.eigenvalue.into()).unzip();
        Series::new(name, Marks::Line, x, y)
    };
    let first = modes.iter().filter_map(|(_, all)| all.first()).map(|m| m.eigenvalue.into()).unzip();
    let mut series: Vec<Series> = modes.iter().map(line).collect();
    series.push(Series::new("lowest speed", Marks::Rings, first.0, first.1));
    // both are told of every motion: their ratio turns one into the other
    let known = modes.iter().flat_map(|(_, all)| all).find(|m| m.frequency > 0.0 && m.eigenvalue[1] != 0.0);
    if let Some(motion) = known {
        let factor = motion.eigenvalue[1].abs() / motion.frequency;
        series.extend(of_kinds(at.crossings.iter(), |c| [0.0, factor * c.frequency]));
    }
    let top = modes.iter().flat_map(|(_, all)| all).map(|m| m.eigenvalue[1]).fold(0.0, f64::max);
    series.push(Series::new("", Marks::Dashes, vec![0.0; 2], vec![0.0, top]));
    Chart {
        title: format!("Root locus, Mach {}", at.mach),
        x: Axis::linear("Re lambda over the fastest rate, growth positive"),
        y: Axis::linear("Im lambda over the fastest rate"),
        series,
    }
}

/// What the stream is varied in, where charts draw it.
#[derive(Clone, Copy)]
struct StreamAxis {
    matching: Matching,
    /// Numbers are in SI units.
    dimensional: bool,
    /// All that is drawn has a speed index.
    indexed: bool,
}

impl StreamAxis {
    fn label(self) -> &'static str {
        match (self.matching, self.dimensional) {
            (Matching::Density, true) => "dynamic pressure, Pa",
            (Matching::Density, false) => "dynamic pressure",
            (Matching::Altitude, _) => "altitude, m",
            (Matching::None, true) => "TAS, m/s",
            _ if self.indexed => "speed index",
            _ => "speed",
        }
    }

    /// Where something is that has this speed index, speed, dynamic pressure and altitude; so it is with their error bars.
    fn place(self, index: Option<f64>, [speed, pressure]: [f64; 2], altitude: Option<f64>) -> f64 {
        match (self.matching, self.dimensional) {
            (Matching::Density, _) => pressure,
            (Matching::Altitude, _) => altitude.unwrap_or(f64::NAN),
            (Matching::None, true) => speed,
            _ => index.filter(|_| self.indexed).unwrap_or(speed),
        }
    }
}

/// All crossings against the Mach number; `None` with fewer than two of these, and where nothing crosses.
pub(super) fn boundary(found: &Boundary) -> Option<Chart> {
    let matching = found.flutter.first()?.matching;
    let crossings = || found.flutter.iter().flat_map(|at| at.crossings.iter().map(move |c| (at.mach, c)));
    let indexed = crossings().all(|(_, c)| c.speed_index.is_some());
    let axis = StreamAxis { matching, dimensional: found.flutter.first()?.dimensional, indexed };
    let place = |c: &FlutterRow| axis.place(c.speed_index, [c.speed, c.dynamic_pressure], c.altitude);
    let bar = |c: &FlutterRow| {
        let known = |error: Option<f64>| error.unwrap_or(f64::NAN);
        axis.place(
            c.bars.speed_index_error,
            [known(c.bars.speed_error), known(c.bars.dynamic_pressure_error)],
            c.bars.altitude_error,
        )
    };
    if found.flutter.len() < 2 || crossings().next().is_none() {
        return None;
    }
    let machs = found.flutter.iter().map(|at| at.mach);
    let [low, high] = [machs.clone().fold(f64::INFINITY, f64::min), machs.fold(f64::NEG_INFINITY, f64::max)];
    let cap = CAP * (high - low);
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for (mach, c) in crossings() {
        let (at, half) = (place(c), bar(c));
        if half.is_finite() {
            let (below, above) = (at - half, at + half);
            let nan = f64::NAN;
            x.extend([mach, mach, nan, mach - cap, mach + cap, nan, mach - cap, mach + cap, nan]);
            y.extend([below, above, nan, below, below, nan, above, above, nan]);
        }
    }
    let bars = (!x.is_empty()).then(|| Series::new("error bar", Marks::Line, x, y));
    let one = |(kind, marks): (&str, Marks)| {
        let (x, y) = crossings().filter(|(_, c)| c.kind == kind).map(|(mach, c)| (mach, place(c))).unzip();
        Series::new(kind, marks, x, y)
    };
    let kinds = KINDS.map(one).into_iter().filter(|s| !s.x.is_empty());
    let (x, y) = (Axis::linear("Mach number"), Axis::linear(axis.label()));
    Some(Chart { title: "Flutter boundary".into(), x, y, series: kinds.chain(bars).collect() })
}

/// Amplitude against speed, or what is varied instead: branches, full where motions go to them and dashed where they leave; where they begin, and what marches end
/// with. `None` without limit cycles.
pub(super) fn limit_cycles(found: &Boundary) -> Option<Chart> {
    let first = found.lco.first()?;
    let matching = found.flutter.first().map_or(Matching::None, |at| at.matching);
    let dimensional = found.flutter.first().is_some_and(|at| at.dimensional);
    let axis = StreamAxis { matching, dimensional, indexed: found.lco.iter().all(|c| c.speed_index.is_some()) };
    let speed = |c: &LimitCycle| axis.place(c.speed_index, [c.speed, c.dynamic_pressure], c.altitude);
    let lines = [("", Marks::Line, true), ("", Marks::Dashes, false)].map(|(name, marks, stable)| {
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for pair in found.lco.windows(2).filter(|p| p[0].branch == p[1].branch) {
            // a part that ends at a stable point and begins at one
            if (pair[0].stable && pair[1].stable) == stable {
                x.extend([speed(&pair[0]), speed(&pair[1]), f64::NAN]);
                y.extend([pair[0].amplitude, pair[1].amplitude, f64::NAN]);
            }
        }
        Series::new(name, marks, x, y)
    });
    let of = |name: &str, marks: Marks, stable: bool| {
        let own = found.lco.iter().filter(|c| c.stable == stable);
        let (x, y) = own.map(|c| (speed(c), c.amplitude)).unzip();
        Series::new(name, marks, x, y)
    };
    let marched = found.lco.iter().filter_map(|c| Some((speed(c), c.march.as_ref()?.amplitude))).unzip();
    let own = found.flutter.iter().filter(|at| at.mach == first.mach).flat_map(|at| &at.crossings);
    let at = |c: &FlutterRow| axis.place(c.speed_index, [c.speed, c.dynamic_pressure], c.altitude);
    let begins = own.filter(|c| c.kind != "divergence").map(|c| (at(c), 0.0));
    let (x, y) = begins.unzip();
    let [full, dashed] = lines;
    let series = [
        full,
        dashed,
        of("stable", Marks::Dots, true),
        of("unstable", Marks::Rings, false),
        Series::new("small motions", Marks::Rings, x, y),
        Series::new("march", Marks::Rings, marched.0, marched.1),
    ];
    let unit = if is_angle(&first.coordinate) { "degrees" } else { "length" };
    Some(Chart {
        title: format!("Limit cycles, Mach {}", first.mach),
        x: Axis::linear(axis.label()),
        y: Axis::linear(&format!("amplitude of {}, {unit}", first.coordinate)),
        series: series.into_iter().filter(|s| !s.x.is_empty()).collect(),
    })
}
