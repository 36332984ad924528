//! The standard atmosphere: temperature, pressure and density of air as functions of altitude.
//!
//! In layers of geopotential altitude H, the molecular-scale temperature is linear, T = T_b + L (H − H_b), and
//! hydrostatic balance gives
//!
//! p = p_b (T_b/T)^{g₀/(R L)}, or p_b exp(−g₀ (H − H_b)/(R T_b)) where L = 0, ρ = p/(R T), a = √(γ R T),
//!
//! with H = r₀ z/(r₀ + z) for the geometric altitude z (U.S. Standard Atmosphere, 1976, NOAA-S/T 76-1562; up to 32 km
//! it equals those of ISO 2533 and ICAO). Range: from 5 km below to 86 km above sea level.

/// Geopotential altitude of the base of each layer (m), and temperature gradient in the layer [K/m].
const LAYERS: [(f64, f64); 7] = [
    (0.0, -6.5e-3),
    (11_000.0, 0.0),
    (20_000.0, 1e-3),
    (32_000.0, 2.8e-3),
    (47_000.0, 0.0),
    (51_000.0, -2.8e-3),
    (71_000.0, -2e-3),
];
/// Temperature (K) and pressure (Pa) at sea level.
const SEA: (f64, f64) = (288.15, 101_325.0);
/// Standard gravity [m/s²].
const GRAVITY: f64 = 9.806_65;
/// Specific gas constant of air [J/(kg K)]: 8314.32/28.9644.
pub const GAS_CONSTANT: f64 = 8314.32 / 28.9644;
/// Ratio of specific heats of air.
pub const GAMMA: f64 = 1.4;
/// Radius of the earth in the definition of the geopotential altitude (m).
const RADIUS: f64 = 6_356_766.0;
/// Range of geometric altitudes of this model (m).
pub const RANGE: [f64; 2] = [-5_000.0, 86_000.0];

/// State of the air at an altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// Temperature (K); above 80 km the molecular-scale temperature, for the mean molecular mass at sea level.
    pub temperature: f64,
    /// Pressure (Pa).
    pub pressure: f64,
    /// Density [kg/m³].
    pub density: f64,
    /// Speed of sound [m/s].
    pub sound_speed: f64,
}

/// A layer with the state of the air at its base.
#[derive(Clone, Copy)]
struct Layer {
    base: f64,
    slope: f64,
    temperature: f64,
    pressure: f64,
}

impl Layer {
    fn temperature(&self, height: f64) -> f64 {
        self.temperature + self.slope * (height - self.base)
    }

    fn pressure(&self, height: f64) -> f64 {
        let fall = GRAVITY / GAS_CONSTANT;
        self.pressure
            * match self.slope {
                0.0 => (-fall * (height - self.base) / self.temperature).exp(),
                slope => (self.temperature / self.temperature(height)).powf(fall / slope),
            }
    }

    /// Geopotential altitude (m) at which the pressure is `pressure` (Pa).
    fn height(&self, pressure: f64) -> f64 {
        let (part, fall) = (self.pressure / pressure, GRAVITY / GAS_CONSTANT);
        self.base
            + match self.slope {
                0.0 => part.ln() * self.temperature / fall,
                slope => self.temperature / slope * (part.powf(slope / fall) - 1.0),
            }
    }
}

/// All layers in ascending order.
fn layers() -> [Layer; LAYERS.len()] {
    let mut layer = Layer { base: 0.0, slope: LAYERS[0].1, temperature: SEA.0, pressure: SEA.1 };
    LAYERS.map(|(base, slope)| {
        layer = Layer { base, slope, temperature: layer.temperature(base), pressure: layer.pressure(base) };
        layer
    })
}

/// State of the air at the geometric altitude `z` (m); `None` outside [`RANGE`].
pub fn at(z: f64) -> Option<Air> {
    if !(RANGE[0]..=RANGE[1]).contains(&z) {
        return None;
    }
    let (height, all) = (RADIUS * z / (RADIUS + z), layers());
    let layer = all.iter().rev().find(|layer| layer.base <= height).unwrap_or(&all[0]);
    let (temperature, pressure) = (layer.temperature(height), layer.pressure(height));
    let heat = GAS_CONSTANT * temperature;
    Some(Air { temperature, pressure, density: pressure / heat, sound_speed: (GAMMA * heat).sqrt() })
}

/// Geometric altitude (m) at which the pressure is `pressure` (Pa); `None` outside [`RANGE`].
pub fn altitude(pressure: f64) -> Option<f64> {
    let all = layers();
    let layer = all.iter().rev().find(|layer| pressure <= layer.pressure).unwrap_or(&all[0]);
    let height = layer.height(pressure);
    let z = RADIUS * height / (RADIUS - height);
    // tolerance for round-off at both ends of the range
    let inside = (RANGE[0] - 1e-3..=RANGE[1] + 1e-3).contains(&z);
    inside.then(|| z.clamp(RANGE[0], RANGE[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    // U.S. Standard Atmosphere (1976), table I: km, K, Pa, kg/m³, m/s
    const TABLE: [[f64; 5]; 8] = [
        [0.0, 288.150, 101_325.0, 1.2250, 340.294],
        [5.0, 255.676, 54_048.0, 0.736_43, 320.545],
        [11.0, 216.774, 22_700.0, 0.364_80, 295.154],
        [20.0, 216.650, 5529.3, 0.088_910, 295.069],
        [30.0, 226.509, 1197.0, 0.018_410, 301.709],
        [50.0, 270.650, 79.779, 1.0269e-3, 329.799],
        [70.0, 219.585, 5.2209, 8.2829e-5, 297.06],
        [80.0, 198.639, 1.0524, 1.8458e-5, 282.54],
    ];

    #[test]
    fn air_is_that_of_the_table() {
        for [km, temperature, pressure, density, sound] in TABLE {
            let air = at(1000.0 * km).unwrap();
            let pairs = [
                (air.temperature, temperature),
                (air.pressure, pressure),
                (air.density, density),
                (air.sound_speed, sound),
            ];
            assert!(pairs.iter().all(|(a, b)| (a / b - 1.0).abs() < 1e-4), "{km}: {air:?}");
        }
    }

    #[test]
    fn a_pressure_has_its_altitude() {
        for km in [-5.0, -1.0, 0.0, 3.0, 11.0, 15.0, 25.0, 40.0, 49.0, 60.0, 75.0, 86.0] {
            let z = 1000.0 * km;
            assert!((altitude(at(z).unwrap().pressure).unwrap() - z).abs() < 1e-5, "{km}");
        }
        assert!(at(86_001.0).is_none() && at(-5001.0).is_none() && altitude(1e6).is_none() && altitude(0.1).is_none());
    }
}
