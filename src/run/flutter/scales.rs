//! Numbers that turn those of the solver into those of users, and how the stream is varied.
use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use crate::case::{Case, FreeStreamScales, Matching, StreamRatio, StructureModel};
use crate::geometry::dimension;
use crate::physics::atmosphere;
use crate::structure::flutter::Varied;

/// Scales at one Mach number.
pub(super) struct Scales {
    /// Half of the reference chord.
    pub(super) semichord: f64,
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
}

/// Stream and structure of the case at a Mach number, which ratios refer to.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct CaseReference {
    /// Speed in the units of the case.
    pub speed: f64,
    /// Density in the units of the case.
    pub density: f64,
    /// Dynamic pressure in the units of the case.
    pub dynamic_pressure: f64,
    /// V_f, where the structure has one.
    pub speed_index: Option<f64>,
    /// V*, where the structure has one.
    pub reduced_speed: Option<f64>,
    /// Mass ratio, where the structure is a section.
    pub mass_ratio: Option<f64>,
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

impl Stream {
    /// Density over that of the case.
    pub(super) fn density(&self) -> f64 {
        self.pressure / (self.speed * self.speed)
    }
}

impl Scales {
    /// Those of a case whose reference chord is `chord`.
    pub(super) fn of(case: &Case, chord: f64, matching: Matching) -> Self {
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
