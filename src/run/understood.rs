//! What the program understood of a case, in numbers: what `check` tells beside its mistakes.
use super::setup::{chord, reynolds};
use crate::case::Case;
use crate::geometry::Surface;
use crate::math::{Bounds, Vector};
use crate::motion::Motions;
use crate::observe::loads::LoadAxes;

/// A line: what, and its value with the unit.
pub type Fact = (&'static str, String);

/// Stream, reference values, bodies and times of a case.
/// `axes` are those of its loads.
pub(crate) fn facts<const D: usize>(
    case: &Case,
    surface: Option<&Surface<D>>,
    motions: &Motions<D>,
    axes: Option<&LoadAxes>,
) -> Vec<Fact> {
    let mut facts = stream(case, surface);
    facts.extend(axes.map(|a| reference::<D>(case, a)));
    for (body, name) in surface.iter().flat_map(|s| s.bodies.iter().enumerate()) {
        let bounds = surface.map_or(Bounds::EMPTY, |s| s.bounds_of(body));
        facts.push(("body", format!("`{name}` from {} to {}", place(&bounds.min), place(&bounds.max))));
    }
    facts.extend(times(case, surface, motions));
    facts
}

/// The number with the unit that it has in a dimensional stream.
fn with_unit(case: &Case, value: f64, unit: &str) -> String {
    if case.flow.is_dimensional() { format!("{} {unit}", short(value)) } else { short(value) }
}

fn stream<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> Vec<Fact> {
    let s = case.flow.reference();
    let mut facts = vec![
        ("Mach number", short(s.mach)),
        ("sound speed", with_unit(case, s.sound_speed, "m/s")),
        ("speed", with_unit(case, s.speed, "m/s")),
        ("dynamic pr.", with_unit(case, s.dynamic_pressure(), "Pa")),
    ];
    if case.flow.is_dimensional() {
        facts.push((
            "gas",
            format!("{} Pa, {} K, {} kg/m3", short(s.pressure), short(case.flow.kelvin()), short(s.density)),
        ));
    }
    let viscous = reynolds(case, chord(case, surface));
    facts.push(("Reynolds nr.", viscous.map_or_else(|| "none: no viscosity".to_owned(), short)));
    facts
}

/// What loads are divided by.
fn reference<const D: usize>(case: &Case, axes: &LoadAxes) -> Fact {
    // the scale of forces in the units of the solver, whose speed of the stream is the Mach number
    let area = axes.force_scale / (0.5 * case.flow.reference().mach.powi(2));
    let area = if D == 2 { String::new() } else { format!(", area {}", short(area)) };
    ("reference", format!("chord {}{area}, moments about {}", short(axes.chord), list(&axes.moment_point[..D])))
}

fn times<const D: usize>(case: &Case, surface: Option<&Surface<D>>, motions: &Motions<D>) -> Vec<Fact> {
    let (units, period) = (case.flow.units(), motions.period());
    let mut facts = Vec::new();
    if let Some(period) = period {
        let k = std::f64::consts::PI * chord(case, surface) / (period * case.flow.reference().mach);
        let time = with_unit(case, units.case_time(period), "s");
        let k = if k.is_finite() { format!(", reduced frequency k = ωc/2V = {}", short(k)) } else { String::new() };
        facts.push(("period", format!("{time}{k}")));
    }
    if let Some(step) = case.step_length(period) {
        facts.push(("time step", with_unit(case, units.case_time(step), "s")));
    }
    if let Some(end) = case.end(period).filter(|_| super::recipe::balance(case).is_none()) {
        facts.push(("until", with_unit(case, units.case_time(end), "s")));
    }
    facts
}

/// Six digits are enough to recognise a number.
fn short(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    if value == 0.0 || (-4.0..9.0).contains(&exponent) {
        let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
        return format!("{rounded}");
    }
    format!("{value:.5e}")
}

fn place<const D: usize>(x: &Vector<D>) -> String {
    list(&x.0)
}

fn list(numbers: &[f64]) -> String {
    format!("({})", numbers.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", "))
}
