//! What the program understood of a case, in numbers: what `check` tells beside its mistakes.
mod aeroelastic;

use serde::Serialize;

pub use aeroelastic::{Aeroelastic, UnderstoodFlutter, UnderstoodGaf, UnderstoodStructure};

use crate::case::Case;
use crate::geometry::Surface;
use crate::math::digits::short;
use crate::math::{Bounds, Vector};
use crate::motion::Motions;
use crate::observe::loads::LoadAxes;
use crate::problem::numerics::balance;
use crate::problem::reference::chord;
use crate::record::summary::{ReferenceValues, list};

/// Stream, reference values, bodies and times of a case: in SI units where `dimensional` is true; otherwise lengths are in the
/// unit of the geometry, and density and sound speed of the stream are 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Understood {
    /// True where the stream has units.
    pub dimensional: bool,
    /// Mach number of the stream.
    pub mach: f64,
    /// Angle of attack in degrees, nose up positive.
    pub alpha_deg: f64,
    /// Sound speed of the stream.
    pub sound_speed: f64,
    /// Speed of the stream.
    pub speed: f64,
    /// Dynamic pressure ρ V²/2 of the stream.
    pub dynamic_pressure: f64,
    /// Static pressure of the stream.
    pub pressure: f64,
    /// Density of the stream.
    pub density: f64,
    /// Temperature of the stream in kelvin; absent where it has no units.
    pub temperature: Option<f64>,
    /// Reynolds number; absent without viscosity.
    pub reynolds: Option<f64>,
    /// What loads are divided by; absent without bodies.
    pub reference: Option<ReferenceValues>,
    /// Bodies and the boxes around them.
    pub bodies: Vec<BodyBox>,
    /// Period of the motion; absent where it does not repeat.
    pub period: Option<f64>,
    /// Frequencies of the motion as multiples of that of this period, where they are several or not the first.
    pub multiples: Vec<usize>,
    /// Reduced frequency k = ωc/2V of that motion; absent without a stream.
    pub reduced_frequency: Option<f64>,
    /// First step of an implicit march.
    pub time_step: Option<f64>,
    /// Time at which a march ends.
    pub until: Option<f64>,
    /// Points of a polar; absent for a single flow.
    pub points: Option<usize>,
    /// Structures, and what is asked of their motions.
    #[serde(flatten)]
    pub aeroelastic: Aeroelastic,
}

/// A body and the box around it, with corners of two or three coordinates.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BodyBox {
    /// Its name.
    pub name: String,
    /// Corner with the smallest coordinates.
    pub min: Vec<f64>,
    /// Corner with the largest coordinates.
    pub max: Vec<f64>,
}

impl Understood {
    /// What a case means with these bodies, motions and structures; `axes` are those of its loads.
    pub(crate) fn of<const D: usize>(
        case: &Case,
        surface: Option<&Surface<D>>,
        motions: &Motions<D>,
        axes: Option<&LoadAxes>,
        aeroelastic: Aeroelastic,
    ) -> Self {
        let (stream, units, period) = (case.flow.reference(), case.flow.units(), motions.period());
        let time = |t: Option<f64>| t.map(|t| units.case_time(t));
        let chord = chord(case, surface);
        let frequency = |t: f64| std::f64::consts::PI * chord / (t * stream.mach);
        let bounds = |body: usize| surface.map_or(Bounds::EMPTY, |s| s.bounds_of(body));
        let names = surface.iter().flat_map(|s| s.bodies.iter().enumerate());
        Self {
            dimensional: case.flow.is_dimensional(),
            mach: stream.mach,
            alpha_deg: case.flow.alpha.degrees(),
            sound_speed: stream.sound_speed,
            speed: stream.speed,
            dynamic_pressure: stream.dynamic_pressure(),
            pressure: stream.pressure,
            density: stream.density,
            temperature: case.flow.is_dimensional().then(|| case.flow.kelvin()),
            reynolds: case.flow.reynolds_number(chord),
            reference: axes.map(|axes| ReferenceValues::of::<D>(case, axes)),
            bodies: names.map(|(body, name)| BodyBox::of(name, &bounds(body))).collect(),
            period: time(period),
            multiples: Some(motions.multiples()).filter(|m| m.iter().any(|n| *n > 1)).unwrap_or_default(),
            reduced_frequency: period.map(frequency).filter(|k| k.is_finite()),
            time_step: time(case.step_length(period)),
            until: time(case.end(period).filter(|_| balance(case).is_none())),
            points: case.polar.as_ref().map(crate::case::Polar::len),
            aeroelastic,
        }
    }

    /// The same in lines for people: what, and its value with the unit.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let mut lines = vec![
            ("Mach number", short(self.mach)),
            ("sound speed", self.with_unit(self.sound_speed, "m/s")),
            ("speed", self.with_unit(self.speed, "m/s")),
            ("dynamic pr.", self.with_unit(self.dynamic_pressure, "Pa")),
        ];
        // a polar has lines of its own
        if self.points.is_none() {
            lines.insert(1, ("alpha", format!("{} deg", short(self.alpha_deg))));
        }
        if let Some(kelvin) = self.temperature {
            let gas = format!("{} Pa, {} K, {} kg/m3", short(self.pressure), short(kelvin), short(self.density));
            lines.push(("gas", gas));
        }
        lines.push(("Reynolds nr.", self.reynolds.map_or_else(|| "none: no viscosity".to_owned(), short)));
        if let Some(r) = &self.reference {
            lines.push(("reference", r.told()));
        }
        for body in &self.bodies {
            lines.push(("body", format!("`{}` from {} to {}", body.name, list(&body.min), list(&body.max))));
        }
        if let Some(period) = self.period {
            let k = self.reduced_frequency.map(|k| format!(", reduced frequency k = ωc/2V = {}", short(k)));
            lines.push(("period", self.with_unit(period, "s") + &k.unwrap_or_default()));
            if !self.multiples.is_empty() {
                let all = self.multiples.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
                lines.push(("frequencies", format!("{all} times the common one of this period, its harmonics")));
            }
        }
        lines.extend(self.time_step.map(|t| ("time step", self.with_unit(t, "s"))));
        lines.extend(self.until.map(|t| ("until", self.with_unit(t, "s"))));
        lines.extend(self.aeroelastic.lines());
        lines
    }

    /// The number with the unit that it has in a dimensional stream.
    fn with_unit(&self, value: f64, unit: &str) -> String {
        if self.dimensional { format!("{} {unit}", short(value)) } else { short(value) }
    }
}

impl BodyBox {
    fn of<const D: usize>(name: &str, bounds: &Bounds<D>) -> Self {
        let corner = |x: &Vector<D>| x.0.to_vec();
        Self { name: name.to_owned(), min: corner(&bounds.min), max: corner(&bounds.max) }
    }
}
