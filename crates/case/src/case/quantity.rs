//! Quantities with units.
//!
//! A case file contains values such as `"1.25 deg"` or `"35 kPa"`; the program uses plain numbers in base units,
//! because one conversion at the input is easier to verify than factors inside formulas. A value x with the unit (a, b)
//! is a·x + b in the base unit; b differs from zero for temperature scales only. The factors are exact by definition:
//! international yard and pound agreement (1959) for foot and pound, CGPM (1901) for standard gravity 9.806 65 m/s².
//!
//! A plain number is in the base unit, except for angles and frequencies: degrees mistaken for radians, or hertz for
//! radians per second, yield a wrong but plausible flow. These quantities therefore need a unit unless they are zero.
use std::f64::consts::TAU;
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A unit: its symbol and the conversion `factor * value + offset` to the base unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Symbol of the unit.
    pub symbol: &'static str,
    /// Size of the unit in base units.
    pub factor: f64,
    /// Zero of the scale in base units.
    pub offset: f64,
}

/// A physical dimension with its permitted units; the base unit comes first.
#[derive(Debug, PartialEq)]
pub struct Dimension {
    /// Name of the quantity in messages.
    pub name: &'static str,
    /// Permitted units, the base unit first.
    pub units: &'static [Unit],
    /// True when a plain number other than zero is rejected.
    pub needs_unit: bool,
    /// Example of a value for messages.
    pub example: &'static str,
}

/// Reason why a text is not a quantity.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuantityError {
    /// The text does not start with a number.
    #[error("`{text}` does not begin with a number")]
    Number {
        /// The text.
        text: String,
    },
    /// The number is infinite, NaN or too large.
    #[error("`{text}` is not a finite number")]
    Infinite {
        /// The text.
        text: String,
    },
    /// The unit is unknown.
    #[error("`{unit}` is not a unit of {dimension}; allowed: {allowed}")]
    Unit {
        /// The text after the number.
        unit: String,
        /// Name of the expected quantity.
        dimension: &'static str,
        /// Permitted units.
        allowed: String,
    },
    /// The unit is missing where one is necessary.
    #[error("{dimension} `{text}` has no unit")]
    Missing {
        /// The text.
        text: String,
        /// Name of the expected quantity.
        dimension: &'static str,
    },
}

impl Dimension {
    /// Symbols of the permitted units, `deg, rad, …`.
    pub fn symbols(&self) -> String {
        self.units.iter().map(|u| u.symbol).collect::<Vec<_>>().join(", ")
    }

    /// Unit of the example.
    pub fn usual(&self) -> &'static str {
        self.example.split_once(' ').map_or("", |(_, unit)| unit)
    }

    /// Converts `text`, for example `1.25 deg`, to base units. Fails when it is not a number with a permitted unit.
    pub fn parse(&self, text: &str) -> Result<f64, QuantityError> {
        let trimmed = text.trim();
        let (number, symbol) = trimmed.split_at(number_length(trimmed));
        let value: f64 = number.parse().map_err(|_| QuantityError::Number { text: text.to_owned() })?;
        if symbol.trim().is_empty() {
            return self.plain(value);
        }
        let unit = self.unit(symbol.trim())?;
        finite(unit.factor * value + unit.offset, text)
    }

    /// Converts a plain number to base units. Fails when the quantity needs a unit or the number is not finite.
    pub fn plain(&self, value: f64) -> Result<f64, QuantityError> {
        if self.needs_unit && value != 0.0 {
            let text = value.to_string();
            return Err(QuantityError::Missing { text, dimension: self.name });
        }
        finite(value, &value.to_string())
    }

    fn unit(&self, symbol: &str) -> Result<&Unit, QuantityError> {
        let written = plain_symbol(symbol);
        self.units.iter().find(|u| plain_symbol(u.symbol) == written).ok_or_else(|| QuantityError::Unit {
            unit: symbol.to_owned(),
            dimension: self.name,
            allowed: self.symbols(),
        })
    }
}

/// A unit symbol with products written as spaces and powers as digits: `kg·m²`, `kg*m^2` and `kg m2` are the same unit.
pub(super) fn plain_symbol(symbol: &str) -> String {
    let one = |c: char| match c {
        '·' | '⋅' | '*' => Some(' '),
        '²' => Some('2'),
        '³' => Some('3'),
        '^' => None,
        other => Some(other),
    };
    symbol.chars().filter_map(one).collect()
}

fn finite(value: f64, text: &str) -> Result<f64, QuantityError> {
    if value.is_finite() { Ok(value) } else { Err(QuantityError::Infinite { text: text.to_owned() }) }
}

/// Length of the number at the start of `text` in bytes; an `e` belongs to it only when digits follow.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digit = |i: usize| bytes.get(i).is_some_and(u8::is_ascii_digit);
    let sign = |i: usize| matches!(bytes.get(i), Some(b'+' | b'-'));
    let mut end = usize::from(sign(0));
    while digit(end) || bytes.get(end) == Some(&b'.') {
        end += 1;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) && (digit(end + 1) || (sign(end + 1) && digit(end + 2))) {
        end += 2;
        while digit(end) {
            end += 1;
        }
    }
    end
}

const fn unit(symbol: &'static str, factor: f64) -> Unit {
    Unit { symbol, factor, offset: 0.0 }
}

/// The shortest decimal number of degrees that converts back to exactly the same `radians`.
pub(super) fn exact_degrees(radians: f64) -> Option<String> {
    let degrees = radians / DEGREE;
    let texts = (0..=15).map(|digits| format!("{degrees:.digits$}"));
    texts.into_iter().find(|text| text.parse::<f64>().is_ok_and(|value| value * DEGREE == radians))
}

impl Angle {
    /// The angle in degrees, without digits due to round-off.
    pub fn degrees(&self) -> f64 {
        exact_degrees(self.0).and_then(|text| text.parse().ok()).unwrap_or(self.0 / DEGREE)
    }
}

/// A dimensionless number that is given as text.
pub(super) const PURE: &Dimension =
    &Dimension { name: "a number", units: &[unit("-", 1.0)], needs_unit: false, example: "0.3" };

/// One degree in radians.
pub const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// One international foot in metres.
const FOOT: f64 = 0.3048;
/// One avoirdupois pound in kilograms.
const POUND: f64 = 0.453_592_37;
/// Standard gravity in m/s².
const GRAVITY: f64 = 9.806_65;
/// 0 degC in kelvin.
const ICE_POINT: f64 = 273.15;
/// One degree Rankine in kelvin.
const RANKINE: f64 = 5.0 / 9.0;

macro_rules! quantities {
    ($($name:ident, $text:literal, $needs_unit:literal, $example:literal, [$($unit:expr),+ $(,)?];)*) => { $(
        #[doc = concat!("A quantity: ", $text, " in base units.")]
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub f64);

        impl $name {
            /// Units this quantity may be written in.
            pub const DIMENSION: &'static Dimension = &Dimension {
                name: $text,
                units: &[$($unit),+],
                needs_unit: $needs_unit,
                example: $example,
            };
        }

        impl FromStr for $name {
            type Err = QuantityError;

            fn from_str(text: &str) -> Result<Self, QuantityError> {
                Self::DIMENSION.parse(text).map(Self)
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{} {}", self.0, Self::DIMENSION.units[0].symbol)
            }
        }
    )* };
}

quantities! {
    Ratio, "a ratio", false, "1 %", [unit("-", 1.0), unit("%", 1e-2)];
    Angle, "an angle", true, "1.25 deg", [
        unit("rad", 1.0), unit("deg", DEGREE), unit("°", DEGREE), unit("mrad", 1e-3),
    ];
    Length, "a length", false, "0.3 m", [
        unit("m", 1.0), unit("mm", 1e-3), unit("cm", 1e-2), unit("km", 1e3), unit("um", 1e-6),
        unit("in", FOOT / 12.0), unit("ft", FOOT),
    ];
    Pressure, "a pressure", false, "35 kPa", [
        unit("Pa", 1.0), unit("hPa", 1e2), unit("kPa", 1e3), unit("MPa", 1e6), unit("GPa", 1e9), unit("mbar", 1e2),
        unit("bar", 1e5), unit("atm", 101_325.0), unit("psi", POUND * GRAVITY * 144.0 / (FOOT * FOOT)),
        unit("psf", POUND * GRAVITY / (FOOT * FOOT)),
    ];
    Temperature, "a temperature", false, "288.15 K", [
        unit("K", 1.0), Unit { symbol: "degC", factor: 1.0, offset: ICE_POINT },
        Unit { symbol: "°C", factor: 1.0, offset: ICE_POINT },
        Unit { symbol: "degF", factor: RANKINE, offset: ICE_POINT - 32.0 * RANKINE }, unit("degR", RANKINE),
    ];
    Density, "a density", false, "1.225 kg/m3", [
        unit("kg/m3", 1.0), unit("kg/m^3", 1.0), unit("g/cm3", 1e3), unit("lb/ft3", POUND / (FOOT * FOOT * FOOT)),
        unit("slug/ft3", POUND * GRAVITY / (FOOT * FOOT * FOOT * FOOT)),
    ];
    Velocity, "a speed", false, "240 m/s", [
        unit("m/s", 1.0), unit("km/h", 1.0 / 3.6), unit("km/s", 1e3), unit("ft/s", FOOT),
        unit("mph", 5280.0 * FOOT / 3600.0), unit("kn", 1852.0 / 3600.0), unit("kt", 1852.0 / 3600.0),
    ];
    Time, "a time", false, "20 ms", [
        unit("s", 1.0), unit("ms", 1e-3), unit("us", 1e-6), unit("min", 60.0), unit("h", 3600.0),
    ];
    WallTime, "a wall-clock time", false, "2 min", [unit("s", 1.0), unit("min", 60.0), unit("h", 3600.0)];
    Frequency, "a frequency", true, "5 Hz", [
        unit("rad/s", 1.0), unit("Hz", TAU), unit("kHz", 1e3 * TAU), unit("rpm", TAU / 60.0),
    ];
    Rate, "an angular rate", false, "10 deg/s", [
        unit("rad/s", 1.0), unit("deg/s", DEGREE), unit("rpm", TAU / 60.0), unit("Hz", TAU),
    ];
    Viscosity, "a viscosity", false, "1.8e-5 Pa s", [
        unit("Pa s", 1.0), unit("Pa.s", 1.0), unit("kg/m/s", 1.0), unit("mPa s", 1e-3), unit("uPa s", 1e-6),
        unit("P", 0.1), unit("cP", 1e-3),
    ];
    Acceleration, "an acceleration", false, "-9.81 m/s2", [
        unit("m/s2", 1.0), unit("m/s^2", 1.0), unit("ft/s2", FOOT), unit("g", GRAVITY),
    ];
    Mass, "a mass", false, "3 kg/m", [
        unit("kg", 1.0), unit("g", 1e-3), unit("lb", POUND), unit("slug", POUND * GRAVITY / FOOT),
        unit("t", 1e3), unit("kg/m", 1.0), unit("g/m", 1e-3), unit("lb/ft", POUND / FOOT),
        unit("slug/ft", POUND * GRAVITY / (FOOT * FOOT)),
    ];
    Inertia, "a moment of inertia", false, "0.2 kg m", [
        unit("kg m2", 1.0), unit("kg cm2", 1e-4), unit("lb ft2", POUND * FOOT * FOOT), unit("slug ft2", POUND * GRAVITY * FOOT),
        unit("kg m", 1.0), unit("kg m2/m", 1.0), unit("slug ft", POUND * GRAVITY), unit("slug ft2/ft", POUND * GRAVITY),
    ];
    Stiffness, "a stiffness", false, "2.8 kN/m2", [
        unit("N/m", 1.0), unit("kN/m", 1e3), unit("N/mm", 1e3), unit("lbf/ft", POUND * GRAVITY / FOOT), unit("lbf/in", 12.0 * POUND * GRAVITY / FOOT),
        unit("N/m2", 1.0), unit("kN/m2", 1e3), unit("N/m/m", 1.0), unit("lbf/ft2", POUND * GRAVITY / (FOOT * FOOT)),
    ];
    AngularStiffness, "a stiffness against rotation", false, "300 N m/rad", [
        unit("N m/rad", 1.0), unit("N m", 1.0), unit("Nm/rad", 1.0), unit("Nm", 1.0), unit("kN m/rad", 1e3), unit("N m/deg", 1.0 / DEGREE),
        unit("lbf ft/rad", POUND * GRAVITY * FOOT),
        unit("N/rad", 1.0), unit("N m/rad/m", 1.0), unit("N", 1.0), unit("lbf/rad", POUND * GRAVITY),
    ];
    Damper, "a damper", false, "40 N s/m", [
        unit("N s/m", 1.0), unit("kN s/m", 1e3), unit("kg/s", 1.0), unit("lbf s/ft", POUND * GRAVITY / FOOT),
        unit("N s/m2", 1.0), unit("kN s/m2", 1e3), unit("N s/m/m", 1.0), unit("lbf s/ft2", POUND * GRAVITY / (FOOT * FOOT)),
    ];
    AngularDamper, "a damper of rotation", false, "2 N m s/rad", [
        unit("N m s/rad", 1.0), unit("N m s", 1.0), unit("Nm s/rad", 1.0), unit("lbf ft s/rad", POUND * GRAVITY * FOOT),
        unit("N s/rad", 1.0), unit("N m s/rad/m", 1.0), unit("N s", 1.0), unit("lbf s/rad", POUND * GRAVITY),
    ];
    PerArea, "an inverse square of a length", false, "40 1/m2", [
        unit("1/m2", 1.0), unit("1/mm2", 1e6), unit("1/ft2", 1.0 / (FOOT * FOOT)),
    ];
    PerSquareAngle, "an inverse square of an angle", false, "40 1/rad2", [
        unit("1/rad2", 1.0), unit("1/deg2", 1.0 / (DEGREE * DEGREE)),
    ];
    Force, "a force", false, "250 N", [
        unit("N", 1.0), unit("kN", 1e3), unit("MN", 1e6), unit("mN", 1e-3), unit("lbf", POUND * GRAVITY),
    ];
    PerTime, "a rate", false, "10 1/s", [unit("1/s", 1.0), unit("s-1", 1.0), unit("1/ms", 1e3), unit("1/us", 1e6)];
    SpecificHeat, "a heat capacity", false, "900 J/kg/K", [
        unit("J/kg/K", 1.0), unit("J/(kg K)", 1.0), unit("kJ/kg/K", 1e3), unit("kJ/(kg K)", 1e3),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn close(value: f64, expected: f64) {
        assert!((value - expected).abs() <= 1e-12 * expected.abs(), "{value} is not {expected}");
    }

    #[test]
    fn units_become_base_units() {
        close("1.25 deg".parse::<Angle>().unwrap().0, 1.25_f64.to_radians());
        close("-3°".parse::<Angle>().unwrap().0, -3.0_f64.to_radians());
        close("12 ft".parse::<Length>().unwrap().0, 3.6576);
        close("35kPa".parse::<Pressure>().unwrap().0, 35e3);
        close("15 degC".parse::<Temperature>().unwrap().0, 288.15);
        close("59 degF".parse::<Temperature>().unwrap().0, 288.15);
        close("100 km/h".parse::<Velocity>().unwrap().0, 100.0 / 3.6);
        close("20 ms".parse::<Time>().unwrap().0, 0.02);
        close("60 rpm".parse::<Rate>().unwrap().0, std::f64::consts::TAU);
        close("5 Hz".parse::<Frequency>().unwrap().0, 10.0 * std::f64::consts::PI);
        close("1.8e-5 Pa s".parse::<Viscosity>().unwrap().0, 1.8e-5);
        assert_eq!(Viscosity::DIMENSION.usual(), "Pa s");
        close("1e3 m".parse::<Length>().unwrap().0, 1000.0);
        close("14.695948775513 psi".parse::<Pressure>().unwrap().0, 101_325.0);
        close("1 slug/ft".parse::<Mass>().unwrap().0, 14.593_902_937_206_364 / 0.3048);
        close("2 slug ft2".parse::<Inertia>().unwrap().0, 2.0 * 1.355_817_948_331_400_4);
        close("1 lbf/in".parse::<Stiffness>().unwrap().0, 175.126_835_246_476_4);
        close("1 N m/deg".parse::<AngularStiffness>().unwrap().0, 180.0 / std::f64::consts::PI);
        close("1 kg·m²".parse::<Inertia>().unwrap().0, 1.0);
        close("3 kg*m^2".parse::<Inertia>().unwrap().0, 3.0);
        close("1.2 kg/m³".parse::<Density>().unwrap().0, 1.2);
        close("40 1/deg2".parse::<PerSquareAngle>().unwrap().0, 40.0 * (180.0 / std::f64::consts::PI).powi(2));
        close("2 lbf s/ft".parse::<Damper>().unwrap().0, 2.0 * 14.593_902_937_206_364);
        close("2 N m s/rad".parse::<AngularDamper>().unwrap().0, 2.0);
        close("-1 g".parse::<Acceleration>().unwrap().0, -9.80665);
        // sea level of the standard atmosphere (1976) in slug/ft3
        assert!(("0.0023769 slug/ft3".parse::<Density>().unwrap().0 - 1.225).abs() < 1e-4);
    }

    #[test]
    fn plain_numbers_are_base_units_but_angles_need_theirs() {
        assert_eq!("0.3".parse::<Length>().unwrap().0, 0.3);
        assert_eq!("0".parse::<Angle>().unwrap().0, 0.0);
        let error = "1.25".parse::<Angle>().unwrap_err();
        assert_eq!(error.to_string(), "an angle `1.25` has no unit");
    }

    #[test]
    fn wrong_units_list_the_allowed_ones() {
        let error = "20 minutes".parse::<Time>().unwrap_err();
        assert_eq!(error.to_string(), "`minutes` is not a unit of a time; allowed: s, ms, us, min, h");
        assert!("fast".parse::<Velocity>().is_err());
        assert!("1e999 m".parse::<Length>().is_err());
        assert!("".parse::<Length>().is_err());
    }

    proptest! {
        #[test]
        fn any_text_is_refused_without_panic(text in "\\PC{0,12}") {
            let _ = text.parse::<Length>();
            let _ = text.parse::<Angle>();
        }

        #[test]
        fn numbers_survive(value in proptest::num::f64::NORMAL) {
            prop_assert_eq!(format!("{value:?} m").parse::<Length>().unwrap().0, value);
        }
    }
}
