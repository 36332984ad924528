//! Numbers that turn those of the solver into those of users, and how the stream is varied.
use std::f64::consts::{PI, TAU};

use crate::case::{Case, FreeStreamScales, Matching, StructureModel};
use crate::geometry::dimension;
use crate::physics::atmosphere;
use crate::problem::StreamRatio;
use crate::record::flutter::{Bars, CaseReference};
use crate::structure::flutter::Varied;

/// Density of the standard atmosphere at sea level, kg/m³: that of equivalent airspeeds.
const SEA_LEVEL_DENSITY: f64 = 1.225;

/// Scales at one Mach number.
pub(crate) struct Scales {
    /// Half of the reference chord.
    pub(crate) semichord: f64,
    /// Speed of the stream, in sound speeds.
    pub(super) stream: f64,
    /// The stream in the units of the case.
    pub(super) reference: FreeStreamScales,
    /// Solver rate to cycles per unit of time of the case.
    pub(super) cycles: f64,
    /// Solver rate to that of the case, and solver force to that of the case.
    pub(super) rate: f64,
    pub(super) force: f64,
    /// V*, V_f and μ of the structure in the case.
    pub(super) reduced_speed: Option<f64>,
    pub(super) speed_index: Option<f64>,
    pub(super) mass_ratio: Option<f64>,
    /// What is varied.
    pub(super) matching: Matching,
    /// True where the stream of the case has units.
    pub(super) dimensional: bool,
    /// Number of space dimensions.
    pub(super) dimension: usize,
}

/// The stream at one value of what is varied.
pub(super) struct Stream {
    /// Speed over that of the case.
    pub(super) speed: f64,
    /// Dynamic pressure over that of the case.
    pub(super) pressure: f64,
    /// Geometric altitude in metres, where that is varied.
    pub(super) altitude: Option<f64>,
}

/// The stream at one value of what is varied, in the units of the case.
#[derive(Clone, Copy, Debug)]
pub(super) struct StreamNumbers {
    /// Speed over that of the case.
    pub(super) speed_ratio: f64,
    /// Speed.
    pub(super) speed: f64,
    /// Equivalent airspeed in m/s, where the stream has units.
    pub(super) equivalent_airspeed: Option<f64>,
    /// Density.
    pub(super) density: f64,
    /// Dynamic pressure.
    pub(super) dynamic_pressure: f64,
    /// Geometric altitude in metres, where that is varied.
    pub(super) altitude: Option<f64>,
}

impl Scales {
    /// Those of a case whose reference chord is `chord`.
    pub(crate) fn of(case: &Case, chord: f64, matching: Matching) -> Self {
        let (reference, units) = (case.flow.reference(), case.flow.units());
        let structure = &case.structures[0];
        let semichord = structure.semichord.map_or(0.5 * chord, |b| b.0);
        let section = dimension(case) == 2 && structure.model != StructureModel::Modal;
        let by_mass = structure.mass.filter(|_| section).map(|m| m.0 / (PI * reference.density * semichord.powi(2)));
        let mass_ratio = structure.mass_ratio.or(by_mass);
        let index = structure.speed_index;
        let root = structure.mass_ratio.map(f64::sqrt);
        let reduced = structure
            .reduced_speed
            .or(structure.reduced_velocity.map(|u| u / PI))
            .or(index.zip(root).map(|(v, root)| v * root));
        Self {
            semichord,
            stream: reference.mach,
            reference,
            cycles: units.case_rate(1.0) / TAU,
            rate: units.case_rate(1.0),
            force: units.pressure(),
            reduced_speed: reduced,
            speed_index: index.or(reduced.zip(root).map(|(v, root)| v / root)),
            mass_ratio,
            matching,
            dimensional: case.flow.is_dimensional(),
            dimension: usize::from(dimension(case)),
        }
    }

    /// What ratios of the case refer to.
    pub(super) fn case_reference(&self) -> CaseReference {
        CaseReference {
            speed: self.reference.speed,
            density: self.reference.density,
            dynamic_pressure: self.reference.dynamic_pressure(),
            speed_index: self.speed_index,
            reduced_speed: self.reduced_speed,
            mass_ratio: self.mass_ratio,
        }
    }

    /// Reduced frequency of an angular frequency of the solver at the speed of the case.
    pub(super) fn reduced_frequency(&self, kappa: f64) -> f64 {
        kappa * self.semichord / self.stream
    }

    /// The other way.
    pub(super) fn angular_frequency(&self, k: f64) -> f64 {
        k * self.stream / self.semichord
    }

    /// The stream where x is varied: see [`crate::structure::flutter::Varied`].
    pub(super) fn at(&self, x: f64) -> Stream {
        match self.matching {
            Matching::None => Stream { speed: x, pressure: x * x, altitude: None },
            Matching::Density => Stream { speed: 1.0, pressure: x, altitude: None },
            Matching::Altitude => {
                let altitude = atmosphere::altitude(x * self.reference.pressure).unwrap_or(atmosphere::RANGE[1]);
                let sound = atmosphere::at(altitude).map_or(self.reference.sound_speed, |air| air.sound_speed);
                Stream { speed: sound / self.reference.sound_speed, pressure: x, altitude: Some(altitude) }
            }
        }
    }

    /// x where the dynamic pressure over that of the case is `pressure`.
    pub(super) fn place(&self, pressure: f64) -> f64 {
        match self.matching {
            Matching::None => pressure.sqrt(),
            _ => pressure,
        }
    }

    /// The stream where x is varied, in the units of the case.
    pub(super) fn numbers(&self, x: f64) -> StreamNumbers {
        let (stream, reference) = (self.at(x), &self.reference);
        let density = match self.matching {
            Matching::None => 1.0,
            _ => stream.pressure / (stream.speed * stream.speed),
        };
        let dynamic_pressure = reference.dynamic_pressure() * stream.pressure;
        StreamNumbers {
            speed_ratio: stream.speed,
            speed: reference.speed * stream.speed,
            equivalent_airspeed: self.dimensional.then(|| (2.0 * dynamic_pressure / SEA_LEVEL_DENSITY).sqrt()),
            density: reference.density * density,
            dynamic_pressure,
            altitude: stream.altitude,
        }
    }

    /// Half widths of error bars where the root of the dynamic pressure, over that of the case squared `pressure`, is known to the part `bar`.
    pub(super) fn bars(&self, pressure: f64, bar: f64) -> Bars {
        if !bar.is_finite() {
            return Bars::default();
        }
        let [low, high] =
            [(1.0 - bar).max(0.0), 1.0 + bar].map(|part| self.numbers(self.place(pressure * part * part)));
        let half = |of: fn(&StreamNumbers) -> f64| 0.5 * (of(&high) - of(&low)).abs();
        let some = |of: fn(&StreamNumbers) -> Option<f64>| Some(0.5 * (of(&high)? - of(&low)?).abs());
        // V_f and V* go with the root of the dynamic pressure and with the speed
        let index = self.speed_index.map(|v| v * bar * pressure.sqrt());
        Bars {
            speed_ratio_error: Some(half(|n| n.speed_ratio)),
            speed_index_error: index,
            reduced_speed_error: self.reduced_speed.map(|v| v * half(|n| n.speed_ratio)),
            speed_error: Some(half(|n| n.speed)),
            equivalent_airspeed_error: some(|n| n.equivalent_airspeed),
            density_error: Some(half(|n| n.density)),
            dynamic_pressure_error: Some(half(|n| n.dynamic_pressure)),
            altitude_error: some(|n| n.altitude),
        }
    }

    /// What x is to a structure; `speed` is that of [`Self::at`].
    pub(super) fn varied<'b>(&self, speed: &'b dyn Fn(f64) -> f64) -> Varied<'b> {
        match self.matching {
            Matching::None => Varied::Speed,
            _ => Varied::Pressure(speed),
        }
    }

    /// What x is called.
    pub(super) fn named(&self) -> &'static str {
        match self.matching {
            Matching::None => "speed",
            Matching::Density => "density",
            Matching::Altitude => "pressure",
        }
    }

    /// Pressure and temperature at x over those of the case.
    pub(super) fn ratio(&self, x: f64) -> StreamRatio {
        let stream = self.at(x);
        // the dynamic pressure goes with the pressure at constant Mach number
        StreamRatio { pressure: stream.pressure, temperature: stream.speed * stream.speed }
    }

    /// Greatest x: `most`, or the pressure at the bottom of the atmosphere over that of the case.
    pub(super) fn upto(&self, most: f64) -> f64 {
        match self.matching {
            Matching::Altitude => {
                atmosphere::at(atmosphere::RANGE[0]).map_or(most, |air| air.pressure / self.reference.pressure)
            }
            _ => most,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::held::problem_of;
    use super::*;

    fn scales(flow: &str, matching: Matching) -> Scales {
        let text = format!(
            "[flow]\nmach = 0.5\n{flow}[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n[structure]\nelastic_axis = -0.4\n\
             mass_ratio = 30\nx_alpha = 0.2\nr_alpha2 = 0.25\nfrequency_ratio = 0.4\nspeed_index = 2.0\n[flutter]\n"
        );
        Scales::of(problem_of(&text).about_steady_flow(0.5).unwrap().case(), 1.0, matching)
    }

    const AIR: &str = "pressure = \"101325 Pa\"\ntemperature = \"288.15 K\"\n";

    #[test] // dp/p = −dz/(8.4 km) near the ground, and q goes with p: ± 0.51 % of its root are ± 86 m
    fn error_bars_are_in_the_unit_of_each_number() {
        let scales = scales(AIR, Matching::Altitude);
        let pressure = atmosphere::at(109.0).unwrap().pressure / 101_325.0;
        let bars = scales.bars(pressure, 0.0051);
        let altitude = bars.altitude_error.unwrap();
        assert!((altitude - 86.0).abs() < 1.0, "{altitude}");
        let own = scales.numbers(scales.place(pressure));
        assert!((own.altitude.unwrap() - 109.0).abs() < 0.1 && (own.speed - 169.93).abs() < 0.05, "{own:?}");
        let part = |error: Option<f64>, of: f64| error.unwrap() / of;
        assert!((part(bars.dynamic_pressure_error, own.dynamic_pressure) - 0.0102).abs() < 1e-6);
        assert!((part(bars.equivalent_airspeed_error, own.equivalent_airspeed.unwrap()) - 0.0051).abs() < 1e-6);
        // the sound speed falls with the altitude
        assert!((bars.speed_error.unwrap() - 0.5 * 0.00384 * altitude).abs() < 0.01, "{bars:?}");
    }

    #[test]
    fn what_is_not_varied_has_no_error() {
        let tunnel = scales(AIR, Matching::Density);
        let bars = tunnel.bars(4.0, 0.01);
        assert_eq!((bars.speed_error, bars.altitude_error), (Some(0.0), None));
        assert!((bars.density_error.unwrap() - 0.02 * 4.0 * tunnel.reference.density).abs() < 1e-9);
        let plain = scales("", Matching::None);
        let bars = plain.bars(4.0, 0.01);
        assert!((bars.speed_index_error.unwrap() - 0.04).abs() < 1e-12 && bars.equivalent_airspeed_error.is_none());
        assert_eq!(plain.bars(4.0, f64::INFINITY), Bars::default());
        let still = plain.numbers(0.0);
        assert_eq!((still.speed, still.density, still.dynamic_pressure), (0.0, 1.0, 0.0));
    }

    #[test] // EAS = TAS √(ρ/ρ₀)
    fn equivalent_airspeeds_are_those_of_sea_level() {
        let own = scales(AIR, Matching::None).numbers(0.6);
        assert!((own.equivalent_airspeed.unwrap() / own.speed - 1.0).abs() < 1e-4, "{own:?}");
        let high = scales("pressure = \"26436 Pa\"\ntemperature = \"223.15 K\"\n", Matching::None).numbers(1.0);
        assert!((high.equivalent_airspeed.unwrap() / high.speed - (0.4127f64 / 1.225).sqrt()).abs() < 1e-3);
    }
}
