//! Tables of a flutter boundary.
use super::super::page::{Block, Fact, Table};
use super::super::words::{grouped, load, number, plain};
use super::found::first;
use crate::case::Matching;
use crate::math::digits::fixed;
use crate::record::flutter::{Boundary, Doubt, FlutterAt, FlutterRow, LimitCycle, NaturalMode, Share};

/// Names of what crosses, for people.
pub(super) fn in_words(kind: &str) -> &str {
    match kind {
        "restabilised" => "decays again",
        other => other,
    }
}

pub(super) fn optional(x: Option<f64>) -> String {
    x.map_or_else(|| "–".to_owned(), number)
}

/// A part in per cent; a dash where it is not known.
pub(super) fn percent(part: Option<f64>) -> String {
    part.filter(|p| p.is_finite()).map_or_else(|| "–".to_owned(), |p| format!("{:.2} %", 100.0 * p))
}

/// Half of an error bar that is told.
const LEAST_BAR: f64 = 1e-6;

/// A number and half its error bar, to two digits of the bar; alone where it does not vary or nothing is known.
pub(super) fn with_bar(value: f64, bar: Option<f64>) -> String {
    let Some(bar) = bar.filter(|bar| bar.is_finite() && *bar >= LEAST_BAR) else { return number(value) };
    let decimals = (1.0 - bar.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{} ± {}", fixed(value, decimals), fixed(bar, decimals)).replace('-', "\u{2212}")
}

fn optional_with_bar(value: Option<f64>, bar: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| with_bar(value, bar))
}

/// Every crossing with its error bars and what the g-method has.
pub(super) fn crossings(found: &Boundary) -> Table {
    let dimensional = found.flutter.iter().any(|at| at.dimensional);
    let matched = found.flutter.iter().any(|at| at.matching != Matching::None);
    let mut columns = vec!["M", "what", "branch"];
    columns.extend(match dimensional {
        true => ["TAS, m/s", "EAS, m/s", "density, kg/m³", "q, Pa", "altitude, m", "frequency, Hz"],
        false => ["V/V of the case", "V_f", "V*", "density", "dynamic pressure", "frequency"],
    });
    columns.extend([
        "mass ratio",
        "over pitch",
        "k",
        "margin to V_D",
        "interpolation, ± of √q",
        "cloud, ± of √q",
        "g-method",
        "remark",
    ]);
    let row = |(at, c): (&FlutterAt, &FlutterRow)| {
        let g = c.g_method.map_or_else(|| "–".to_owned(), |g| format!("{g:+.0e}").replace('-', "\u{2212}"));
        let mut row = vec![at.mach.to_string(), in_words(&c.kind).to_owned(), c.name()];
        let only_matched = |x: f64, bar: Option<f64>| if matched { with_bar(x, bar) } else { "–".to_owned() };
        row.extend(match dimensional {
            true => [
                with_bar(c.speed, c.bars.speed_error),
                optional_with_bar(c.equivalent_airspeed, c.bars.equivalent_airspeed_error),
                with_bar(c.density, c.bars.density_error),
                with_bar(c.dynamic_pressure, c.bars.dynamic_pressure_error),
                optional_with_bar(c.altitude, c.bars.altitude_error),
                number(c.frequency),
            ],
            false => [
                with_bar(c.speed_ratio, c.bars.speed_ratio_error),
                optional_with_bar(c.speed_index, c.bars.speed_index_error),
                optional_with_bar(c.reduced_speed, c.bars.reduced_speed_error),
                only_matched(c.density, c.bars.density_error),
                only_matched(c.dynamic_pressure, c.bars.dynamic_pressure_error),
                number(c.frequency),
            ],
        });
        row.extend([
            optional(c.mass_ratio.filter(|_| matched)),
            optional(c.frequency_ratio),
            number(c.reduced_frequency),
            c.margin.map_or_else(|| "–".to_owned(), |m| signed(m, 1)),
            percent(Some(c.error)),
            percent(c.cloud_error),
            g,
            remarks(c),
        ]);
        row
    };
    let all = found.flutter.iter().flat_map(|at| at.crossings.iter().map(move |c| (at, c)));
    Table::new(&columns, all.map(row))
}

/// A part in per cent with its sign.
fn signed(part: f64, decimals: usize) -> String {
    let text = fixed(100.0 * part, decimals);
    let sign = if text.starts_with('-') { "" } else { "+" };
    format!("{sign}{text} %").replace('-', "\u{2212}")
}

fn remarks(c: &FlutterRow) -> String {
    let mut all = c.remarks.clone();
    all.extend(Some(remark(c.extrapolated)).filter(|text| !text.is_empty()));
    all.join("; ")
}

/// Ranges of speed in which the cloud decides; without rows where there are none.
pub(super) fn doubts(found: &Boundary) -> Table {
    let dimensional = found.flutter.iter().any(|at| at.dimensional);
    let mut columns = vec!["M", "branch", "what"];
    columns.extend(match dimensional {
        true => ["TAS, m/s", "EAS, m/s", "q, Pa", "altitude, m"],
        false => ["V/V of the case", "V_f", "dynamic pressure", "–"],
    });
    columns.extend(["g", "g on a coarser cloud"]);
    let range = |[a, b]: [f64; 2]| format!("{} to {}", number(a), number(b));
    let optional_range = |ends: Option<[f64; 2]>| ends.map_or_else(|| "–".to_owned(), range);
    let row = |(at, d): (&FlutterAt, &Doubt)| {
        let what = match &d.kind[..] {
            "coarser_cloud_only" => "grows on a coarser cloud, not here",
            "nearly" => "decays by less than both clouds differ",
            "this_cloud_only" => "grows by less than both clouds differ",
            _ => "decays again by less than both clouds differ",
        };
        let [a, b] = d.dynamic_pressure;
        let index = at.reference.speed_index.map(|v| [a, b].map(|q| v * (q / at.reference.dynamic_pressure).sqrt()));
        let ranges = match dimensional {
            true => [range(d.speed), optional_range(d.equivalent_airspeed), range([a, b]), optional_range(d.altitude)],
            false => [range(d.speed_ratio), optional_range(index), range([a, b]), "–".to_owned()],
        };
        let head = [at.mach.to_string(), d.branch.clone(), what.to_owned()];
        head.into_iter().chain(ranges).chain([number(d.damping), number(d.damping_coarser)]).collect()
    };
    let all = found.flutter.iter().flat_map(|at| at.doubts.iter().map(move |d| (at, d)));
    Table::new(&columns, all.map(row))
}

/// Margins to the design speed; without rows where none is given.
pub(super) fn clearances(found: &Boundary) -> Table {
    let columns = [
        "M",
        "V_D, m/s EAS",
        "1.15 V_D",
        "lowest flutter or divergence, m/s EAS",
        "margin to V_D",
        "clearance of 15 %",
        "why",
    ];
    let row = |at: &FlutterAt| {
        let c = at.clearance.as_ref()?;
        Some(vec![
            at.mach.to_string(),
            number(c.design_speed),
            number(c.required),
            optional_with_bar(c.lowest, c.lowest_error),
            c.margin.map_or_else(|| "–".to_owned(), |m| signed(m, 1)),
            (if c.passes { "pass" } else { "fail" }).to_owned(),
            c.reason.clone(),
        ])
    };
    Table::new(&columns, found.flutter.iter().filter_map(row))
}

/// Limit cycles.
pub(super) fn cycles(found: &Boundary) -> Table {
    let columns = [
        "M",
        "branch",
        "amplitude",
        "V/V of the case",
        "V_f",
        "dynamic pressure",
        "k",
        "frequency",
        "",
        "mean",
        "harmonics",
        "± (speed)",
        "balances",
        "remark",
    ];
    let row = |c: &LimitCycle| {
        vec![
            c.mach.to_string(),
            c.branch.to_string(),
            number(c.amplitude),
            number(c.speed_ratio),
            optional(c.speed_index),
            number(c.dynamic_pressure),
            number(c.reduced_frequency),
            number(c.frequency),
            (if c.stable { "stable" } else { "unstable" }).to_owned(),
            number(c.mean),
            c.harmonics.to_string(),
            percent(Some(c.error)),
            c.balances.to_string(),
            remark(c.extrapolated),
        ]
    };
    Table::new(&columns, found.lco.iter().map(row))
}

/// What marches from limit cycles end with; without rows where there were none.
pub(super) fn marches(found: &Boundary) -> Table {
    let columns = [
        "M",
        "branch",
        "amplitude of the limit cycle",
        "of the march",
        "difference",
        "frequency of the march",
        "difference",
        "periods",
        "change in the last",
        "processor time, s",
    ];
    let row = |c: &LimitCycle| {
        let m = c.march.as_ref()?;
        Some(vec![
            c.mach.to_string(),
            c.branch.to_string(),
            number(c.amplitude),
            number(m.amplitude),
            signed(m.difference, 2),
            number(m.frequency),
            signed(m.frequency / c.frequency - 1.0, 2),
            format!("{:.1}", m.periods),
            percent(Some(m.change)),
            format!("{:.1}", m.cpu_seconds),
        ])
    };
    Table::new(&columns, found.lco.iter().filter_map(row))
}

fn remark(extrapolated: bool) -> String {
    (if extrapolated { "beyond the frequencies computed" } else { "" }).to_owned()
}

/// How much each coordinate takes part in the first crossing of each Mach number and in natural modes.
pub(super) fn shapes(found: &Boundary) -> Table {
    let Some(leading) = found.flutter.first() else { return Table::default() };
    let mut columns = vec!["motion", "frequency"];
    columns.extend(leading.coordinates.iter().map(String::as_str));
    let row = |(name, frequency, shape): (String, f64, &[Share])| {
        let share = |s: &Share| format!("{:.4} ∠ {}°", s.amplitude, fixed(s.phase_deg, 1)).replace('-', "\u{2212}");
        [name, number(frequency)].into_iter().chain(shape.iter().map(share)).collect::<Vec<String>>()
    };
    let crossings = found.flutter.iter().filter_map(|at| first(at).map(|c| (at, c)));
    let crossings =
        crossings.map(|(at, c)| (format!("{}, Mach {}", in_words(&c.kind), at.mach), c.frequency, &c.shape[..]));
    let natural =
        leading.natural.iter().map(|n: &NaturalMode| (format!("natural mode {}", n.mode), n.frequency, &n.shape[..]));
    Table::new(&columns, natural.chain(crossings).map(row))
}

/// What ratios refer to.
pub(super) fn reference(found: &Boundary) -> Table {
    let columns = match found.flutter.iter().any(|at| at.dimensional) {
        true => ["M", "speed, m/s", "density, kg/m³", "dynamic pressure, Pa", "V_f", "V*", "mass ratio"],
        false => ["M", "speed", "density", "dynamic pressure", "V_f", "V*", "mass ratio"],
    };
    let given = |x: Option<f64>| x.map_or_else(|| "–".to_owned(), plain);
    let row = |at: &FlutterAt| {
        let r = &at.reference;
        vec![
            at.mach.to_string(),
            plain(r.speed),
            plain(r.density),
            plain(r.dynamic_pressure),
            given(r.speed_index),
            given(r.reduced_speed),
            given(r.mass_ratio),
        ]
    };
    Table::new(&columns, found.flutter.iter().map(row))
}

/// The static equilibria that forces are about; without rows where bodies stay as drawn.
pub(super) fn equilibria(found: &Boundary) -> Table {
    let names = found.flutter.first().map_or(&[][..], |at| &at.coordinates);
    let mut columns = vec!["M", "V/V of the case", "dynamic pressure"];
    columns.extend(names.iter().map(String::as_str));
    let row = |at: &FlutterAt| {
        let trim = at.trim.as_ref()?;
        let stream = [at.mach.to_string(), number(trim.speed_ratio), number(trim.dynamic_pressure)];
        Some(stream.into_iter().chain(trim.coordinates.iter().map(|q| number(*q))).collect())
    };
    Table::new(&columns, found.flutter.iter().filter_map(row))
}

/// Angle, lengths, what is varied.
pub(super) fn facts(at: &FlutterAt) -> Vec<Block> {
    let varied = match at.matching {
        Matching::Density => "density, at the sound speed of the case",
        Matching::Altitude => "altitude in the standard atmosphere of 1976",
        Matching::None => "speed, at the density of the case and constant Mach number",
    };
    vec![
        Block::Facts(vec![
            Fact::new("Angle of attack, degrees", plain(at.alpha_deg)),
            Fact::new("Reference chord", plain(at.chord)),
            Fact::new("b", plain(at.semichord)),
            Fact::new("Coordinates", at.coordinates.join(", ")),
        ]),
        Block::Text(format!("Varied until a motion neither grows nor decays: {varied}.")),
        Block::List(
            [
                "Displacements are positive along the axes, plunge is up (h of the literature is down: h = −plunge); pitch is nose up \
                 positive, a flap trailing edge down.",
                "Motion goes as e^{+iωt}: a phase that is greater is ahead. λ is its rate, g = 2ζ = 2 Re λ/|λ|; growth is positive. \
                 Motions that do not oscillate have g = 2bλ/(U ln 2), growth over a chord of the way in doublings.",
                "k = ωb/U; V* = U/(b ω_α); V_f = V*/√μ = U/(b ω_α √μ) with ω_α that of pitch alone and the mass ratio μ = m/(πρb²).",
                "± beside a number is half its error bar in its own unit, the greater of two errors of √q, the root of the dynamic pressure: its \
                 change between the last two interpolations of the forces, and what the spacing of the cloud leaves.",
                "EAS is √(2q/ρ₀) with ρ₀ = 1.225 kg/m³.",
                "g-method: what that method (Chen 2000) finds of the same crossing, less one; anything above 1e−6 says that following or \
                 interpolation went wrong there.",
            ]
            .map(str::to_owned)
            .to_vec(),
        ),
    ]
}

/// What it took.
pub(super) fn cost(found: &Boundary) -> Table {
    let columns = [
        "M",
        "particles",
        "steady flow, orders",
        "CL",
        "CD",
        "CM",
        "frequencies",
        "iterations per column",
        "residual of columns",
        "processor time, s",
        "of it marches",
    ];
    let row = |at: &FlutterAt| {
        let columns = (at.reduced_frequencies.len() * at.coordinates.len()) as f64;
        let [cl, cd, cm] = at.steady.map(|c| if c.is_nan() { "–".to_owned() } else { load(c) });
        let marches: f64 = found
            .lco
            .iter()
            .filter(|c| c.mach == at.mach)
            .filter_map(|c| c.march.as_ref())
            .map(|m| m.cpu_seconds)
            .sum();
        vec![
            at.mach.to_string(),
            grouped(at.particles as f64),
            format!("{:.1}", at.orders),
            cl,
            cd,
            cm,
            at.reduced_frequencies.len().to_string(),
            format!("{:.1}", at.linear_iterations as f64 / columns.max(1.0)),
            Some(at.residual)
                .filter(|r| r.is_finite())
                .map_or_else(|| "–".to_owned(), |r| format!("{r:.0e}").replace('-', "\u{2212}")),
            format!("{:.1}", at.cpu_seconds + marches),
            if marches > 0.0 { format!("{marches:.1}") } else { "–".to_owned() },
        ]
    };
    Table::new(&columns, found.flutter.iter().map(row))
}
