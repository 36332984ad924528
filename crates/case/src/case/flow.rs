//! Free stream: reference values and units.
//!
//! Perfect gas: p = ρ R T, c = √(γ p/ρ), V = M c. Without dimensional values ρ = 1 and c = 1, hence p = 1/γ.
use serde::{Deserialize, Serialize};

use super::Body;
use super::kinds::{ANGLE, POSITIVE, SIZE};
use super::quantity::{Angle, Density, Length, Pressure, Temperature, Velocity, Viscosity};
use super::schema::{Absent, Field, Kind, Range, Table, Variant, defaulted, keys, optional, words};

keys! {
    /// Free stream, given by `mach` alone (nondimensional: density 1 and sound speed 1) or by dimensional values.
    pub struct Flow, FLOW {
        /// Mach number of the free stream; several make a polar.
        mach: Option<f64> = optional(
            Kind::Values(&POSITIVE), "`velocity` must be given",
        ).known_as(&["m", "ma", "mach_number"]),
        /// Speed of the free stream; needs a dimensional free stream.
        velocity: Option<Velocity> = optional(
            Kind::Quantity(Velocity::DIMENSION, Range::POSITIVE), "`mach` must be given",
        ).known_as(&["speed", "u", "v", "airspeed"]),
        /// Static pressure of the free stream.
        pressure: Option<Pressure> = optional(
            Kind::Quantity(Pressure::DIMENSION, Range::POSITIVE), "nondimensional, or from the other two",
        ),
        /// Static temperature of the free stream.
        temperature: Option<Temperature> = optional(
            Kind::Quantity(Temperature::DIMENSION, Range::POSITIVE), "nondimensional, or from the other two",
        ),
        /// Density of the free stream.
        density: Option<Density> = optional(
            Kind::Quantity(Density::DIMENSION, Range::POSITIVE), "nondimensional, or from the other two",
        ),
        /// Specific gas constant, J/(kg K); the default is air.
        gas_constant: f64 = defaulted(POSITIVE, Absent::Number(287.05)),
        /// Ratio of specific heats.
        gamma: f64 = defaulted(Kind::Number(Range::above(1.0)), Absent::Number(1.4)),
        /// The gas keeps the entropy of the free stream, as sound does: for periodic flow that no stream passes
        /// through, where any distribution of entropy would be a solution. Without viscosity only; shocks lose no total
        /// pressure.
        #[serde(default)]
        isentropic: bool = defaulted(Kind::Flag, Absent::Flag(false)),
        /// Angle of attack, nose up positive: the flow turns from +x towards +y in 2-D, towards +z in 3-D. Several,
        /// `"-4:8:1 deg"` or `[-2, 0, 2, 4]`, make a polar: one run through all of them, at every Mach number of
        /// `mach`. Several without a unit are degrees.
        #[serde(default)]
        alpha: Angle = defaulted(
            Kind::Values(&ANGLE), Absent::Number(0.0),
        ).known_as(&["aoa", "angle", "angle_of_attack", "incidence"]),
        /// Sideslip angle, 3-D only: the flow turns towards +y.
        #[serde(default)]
        beta: Angle = defaulted(ANGLE, Absent::Number(0.0)),
        /// Reynolds number ρ∞ U∞ L/μ∞ with L = `reynolds_length`.
        reynolds: Option<f64> = optional(
            POSITIVE, "no viscosity, or from `viscosity`",
        ).known_as(&["re", "reynolds_number"]),
        /// Length of the Reynolds number.
        reynolds_length: Option<Length> = optional(SIZE, "the reference chord"),
        /// Dynamic viscosity of the free stream; needs a dimensional free stream.
        viscosity: Option<Viscosity> = optional(
            Kind::Quantity(Viscosity::DIMENSION, Range::POSITIVE), "no viscosity, or from `reynolds`",
        ),
        /// How the viscosity depends on temperature.
        viscosity_law: Option<ViscosityLaw> = optional(Kind::Words(VISCOSITY_LAWS), "`\"sutherland\"`"),
        /// Constant S of Sutherland's law. The law needs the temperature of the free stream: `temperature`, which may
        /// stand alone for this purpose, else 288.15 K.
        sutherland: Option<Temperature> = optional(
            Kind::Quantity(Temperature::DIMENSION, Range::POSITIVE), "110.4 K, air",
        ),
        /// Prandtl number.
        prandtl: Option<f64> = optional(POSITIVE, "0.72, air"),
    }
}

/// Condition of the gas on the surface of a body.
pub(super) const WALL: &[Variant] = &[
    Variant::word("slip", "the gas slides along the surface"),
    Variant::word("adiabatic", "the gas sticks to the surface, no heat passes; needs viscosity"),
    Variant::table(
        "temperature",
        &WALL_TEMPERATURE,
        "the gas sticks to a surface of this temperature; needs viscosity",
    ),
];

static WALL_TEMPERATURE: Table = Table::of(&[Field::required(
    "value",
    Kind::Quantity(super::quantity::Temperature::DIMENSION, Range::POSITIVE),
    "Temperature; over that of the free stream, without unit, when the free stream has none.",
)])
.short("value");

/// Sutherland's constant of air (K) (U.S. Standard Atmosphere, 1976).
const SUTHERLAND: f64 = 110.4;
/// Default temperature of the free stream (K) (U.S. Standard Atmosphere, 1976, sea level).
const SEA_LEVEL: f64 = 288.15;
/// Prandtl number of air.
const PRANDTL: f64 = 0.72;
/// Reynolds number above which a boundary layer cannot be laminar (Schlichting and Gersten, Boundary-Layer Theory,
/// section 15.1).
pub const NEVER_LAMINAR: f64 = 1e7;
/// Knudsen number above which the flow is free-molecular (Bird, Molecular Gas Dynamics, section 1.2).
pub const NO_CONTINUUM: f64 = 10.0;

words! {
    /// Temperature dependence of the viscosity.
    pub enum ViscosityLaw, VISCOSITY_LAWS {
        /// μ/μ∞ = (T/T∞)^1.5 (T∞ + S)/(T + S)
        Sutherland = "sutherland",
        /// the same everywhere
        Constant = "constant",
    }
}

/// Wall condition: velocity and temperature of the gas at the surface of a body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Wall {
    /// Slip wall: the gas slides along the surface.
    Slip,
    /// Adiabatic no-slip wall.
    Adiabatic,
    /// Isothermal no-slip wall.
    Temperature {
        /// Wall temperature: in kelvin when the free stream is dimensional, otherwise divided by that of the free
        /// stream.
        value: Temperature,
    },
}

/// Viscosity and heat conduction of the gas in units of the solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscous {
    /// Dynamic viscosity μ∞ of the free stream.
    pub viscosity: f64,
    /// Constant S/T∞ of Sutherland's law μ/μ∞ = θ^1.5 (1 + S/T∞)/(θ + S/T∞) with θ = T/T∞; `None`: constant viscosity.
    pub sutherland: Option<f64>,
    /// Prandtl number μ c_p/λ.
    pub prandtl: f64,
}

/// Values of the free stream: in SI units when it is dimensional, otherwise in units of its density and sound speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FreeStreamScales {
    /// Density.
    pub density: f64,
    /// Speed of sound.
    pub sound_speed: f64,
    /// Static pressure.
    pub pressure: f64,
    /// Flow speed.
    pub speed: f64,
    /// Mach number.
    pub mach: f64,
}

impl FreeStreamScales {
    /// Dynamic pressure ρ V²/2.
    pub fn dynamic_pressure(&self) -> f64 {
        0.5 * self.density * self.speed * self.speed
    }
}

/// Units of the solver, measured in units of the case. In the solver, the free stream has density 1 and sound speed 1,
/// and lengths are those of the case. Its unit of time is therefore the unit of length divided by the sound speed.
///
/// Every time, frequency, speed and force of a case is converted here on input and on output. Without a dimensional
/// free stream, both factors are exactly 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Density ρ∞ of the free stream.
    pub density: f64,
    /// Sound speed a∞ of the free stream.
    pub speed: f64,
}

impl Units {
    /// Unit of pressure ρ∞ a∞², which is also the factor on forces, moments and energies.
    pub fn pressure(&self) -> f64 {
        self.density * self.speed * self.speed
    }

    /// Converts a time of the case, in seconds when it is dimensional, to a time of the solver.
    pub fn solver_time(&self, time: f64) -> f64 {
        time * self.speed
    }

    /// Converts a time of the solver to a time of the case.
    pub fn case_time(&self, time: f64) -> f64 {
        time / self.speed
    }

    /// Converts a speed, frequency or rate of the solver to one of the case.
    pub fn case_rate(&self, rate: f64) -> f64 {
        rate * self.speed
    }

    /// Converts a speed, frequency or rate of the case to one of the solver.
    pub fn solver_rate(&self, rate: f64) -> f64 {
        rate / self.speed
    }
}

impl Flow {
    /// Conversion factors between units of the solver and units of the case.
    pub fn units(&self) -> Units {
        if !self.is_dimensional() {
            return Units { density: 1.0, speed: 1.0 };
        }
        let r = self.reference();
        Units { density: r.density, speed: r.sound_speed }
    }

    /// Density, sound speed, pressure, speed and Mach number of the free stream.
    ///
    /// The speed is zero when neither `mach` nor `velocity` is given, as in cases with an initial field of their own.
    pub fn reference(&self) -> FreeStreamScales {
        let (density, pressure) = self.state();
        let sound_speed = (self.gamma * pressure / density).sqrt();
        let (speed, mach) = match (self.velocity, self.mach) {
            (Some(velocity), _) => (velocity.0, velocity.0 / sound_speed),
            (None, mach) => (mach.unwrap_or(0.0) * sound_speed, mach.unwrap_or(0.0)),
        };
        FreeStreamScales { density, sound_speed, pressure, speed, mach }
    }

    /// True when the free stream is dimensional.
    pub fn is_dimensional(&self) -> bool {
        [self.pressure.is_some(), self.temperature.is_some(), self.density.is_some()].iter().filter(|g| **g).count() > 1
    }

    /// True when the gas is viscous.
    pub fn is_viscous(&self) -> bool {
        self.reynolds.is_some() || self.viscosity.is_some()
    }

    /// Viscosity and heat conduction; `None` for an inviscid gas. `chord` is the reference chord.
    pub fn viscous(&self, chord: f64) -> Option<Viscous> {
        let scales = self.reference();
        let from_reynolds = self.reynolds.map(|re| scales.density * scales.speed * self.viscous_length(chord) / re);
        let sutherland = self.sutherland.map_or(SUTHERLAND, |s| s.0) / self.kelvin();
        Some(Viscous {
            viscosity: self.viscosity.map(|mu| mu.0).or(from_reynolds)?,
            sutherland: (self.viscosity_law != Some(ViscosityLaw::Constant)).then_some(sutherland),
            prandtl: self.prandtl.unwrap_or(PRANDTL),
        })
    }

    /// Reference length of the Reynolds number: `reynolds_length`, or the reference chord.
    pub fn viscous_length(&self, chord: f64) -> f64 {
        self.reynolds_length.map_or(chord, |l| l.0)
    }

    /// Reynolds number of the free stream; `None` for an inviscid gas.
    pub fn reynolds_number(&self, chord: f64) -> Option<f64> {
        let (viscous, stream) = (self.viscous(chord)?, self.reference());
        Some(stream.density * stream.speed * self.viscous_length(chord) / viscous.viscosity)
    }

    /// Knudsen number Kn = M/Re √(πγ/2): mean free path divided by the reference length of the Reynolds number.
    pub fn free_path(&self, reynolds: f64, mach: f64) -> f64 {
        mach / reynolds * (0.5 * std::f64::consts::PI * self.gamma).sqrt()
    }

    /// Wall condition of `body`.
    pub fn wall(&self, body: &Body) -> Wall {
        body.wall.unwrap_or(if self.is_viscous() { Wall::Adiabatic } else { Wall::Slip })
    }

    /// Temperature of the free stream (K); 288.15 K when the case gives none.
    pub fn kelvin(&self) -> f64 {
        let from_gas_law = || {
            let (density, pressure) = self.state();
            pressure / (density * self.gas_constant)
        };
        match self.temperature {
            Some(t) => t.0,
            None if self.is_dimensional() => from_gas_law(),
            None => SEA_LEVEL,
        }
    }

    /// Density and pressure of the free stream.
    fn state(&self) -> (f64, f64) {
        let r = self.gas_constant;
        match (self.pressure, self.temperature, self.density) {
            (Some(p), _, Some(rho)) => (rho.0, p.0),
            (Some(p), Some(t), None) => (p.0 / (r * t.0), p.0),
            (None, Some(t), Some(rho)) => (rho.0, rho.0 * r * t.0),
            _ => (1.0, 1.0 / self.gamma),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::case::read;

    fn scales(flow: &str) -> super::FreeStreamScales {
        stream(flow).reference()
    }

    fn stream(flow: &str) -> super::Flow {
        let text = format!("[flow]\n{flow}\n[cloud]\nspacing = 0.1\n[[body]]\nnaca = \"0012\"\n");
        read(&text, "case.toml").unwrap_or_else(|e| panic!("{e}")).flow
    }

    #[test]
    fn viscosity_follows_from_the_reynolds_number() {
        assert_eq!(stream("mach = 0.5").viscous(1.0), None);
        let v = stream("mach = 0.5\nreynolds = 5000").viscous(2.0).unwrap();
        assert!((v.viscosity - 2e-4).abs() < 1e-18 && v.prandtl == 0.72);
        assert!((v.sutherland.unwrap() - 110.4 / 288.15).abs() < 1e-15);
        let v =
            stream("mach = 0.5\nreynolds = 5000\nreynolds_length = 1\ntemperature = \"200 K\"").viscous(2.0).unwrap();
        assert!((v.viscosity - 1e-4).abs() < 1e-18 && (v.sutherland.unwrap() - 0.552).abs() < 1e-15);
        let air = "mach = 0.5\npressure = 101325\ntemperature = \"15 degC\"\nviscosity = \"1.8e-5 Pa s\"\n\
                   viscosity_law = \"constant\"\nprandtl = 0.7";
        let v = stream(air).viscous(1.0).unwrap();
        assert_eq!((v.viscosity, v.sutherland, v.prandtl), (1.8e-5, None, 0.7));
        let air = stream("mach = 0.5\npressure = 101325\ndensity = 1.225\nreynolds = 1e6");
        assert!((air.kelvin() - 288.15).abs() < 0.01 && air.viscous(1.0).unwrap().viscosity > 1e-4);
    }

    #[test]
    fn nondimensional_stream_has_unit_density_and_sound_speed() {
        let s = scales("mach = 0.8");
        assert_eq!((s.density, s.sound_speed, s.speed, s.mach), (1.0, 1.0, 0.8, 0.8));
        assert!((s.pressure - 1.0 / 1.4).abs() < 1e-15);
    }

    #[test] // U.S. Standard Atmosphere (1976), sea level: 1.225 kg/m³, 340.294 m/s
    fn dimensional_stream_agrees_with_the_standard_atmosphere() {
        let s = scales("velocity = \"170.147 m/s\"\npressure = \"1013.25 hPa\"\ntemperature = \"15 degC\"");
        assert!((s.density - 1.225).abs() < 1e-3);
        assert!((s.sound_speed - 340.294).abs() < 0.05);
        assert!((s.mach - 0.5).abs() < 1e-4);
        assert!((s.dynamic_pressure() - 0.5 * 1.225 * 170.147_f64.powi(2)).abs() < 20.0);
        let units = stream("mach = 0.5\npressure = 101325\ndensity = 1.225").units();
        assert_eq!(units.solver_time(2.0), 2.0 * units.speed);
        assert!((units.case_time(units.solver_time(0.3)) - 0.3).abs() < 1e-16);
        assert!((units.case_rate(units.solver_rate(7.0)) - 7.0).abs() < 1e-14);
        assert!((units.pressure() - 1.4 * 101_325.0).abs() < 1e-9);
        assert_eq!(stream("mach = 0.5\ngamma = 1.27").units(), super::Units { density: 1.0, speed: 1.0 });
        let other = scales("mach = 0.5\npressure = 101325\ndensity = 1.225");
        assert!((other.speed - 170.147).abs() < 0.05);
    }
}
