//! The quantity x of the stream that is varied in a flutter analysis, and speed and dynamic pressure as functions of
//! it.

/// Varied quantity x of the stream at constant Mach number.
#[derive(Clone, Copy)]
pub enum Varied<'a> {
    /// Speed ratio U/U_ref at constant density.
    Speed,
    /// Dynamic pressure divided by that of the reference. The speed ratio is the given function of it, which is one
    /// where the sound speed is constant.
    Pressure(&'a dyn Fn(f64) -> f64),
}

impl Varied<'_> {
    /// Speed ratio U/U_ref at x.
    pub fn speed(&self, x: f64) -> f64 {
        match self {
            Self::Speed => x,
            Self::Pressure(speed) => speed(x),
        }
    }

    /// Dynamic pressure at x divided by that of the reference.
    pub fn pressure(&self, x: f64) -> f64 {
        match self {
            Self::Speed => x * x,
            Self::Pressure(_) => x,
        }
    }

    /// x at which the dynamic pressure ratio is `pressure`.
    pub fn place(&self, pressure: f64) -> f64 {
        match self {
            Self::Speed => pressure.sqrt(),
            Self::Pressure(_) => pressure,
        }
    }
}
