//! What is varied of a stream at one Mach number, where motions are sought that neither grow nor decay: x, and speed and dynamic pressure
//! there.

/// What x is: how the stream is varied at one Mach number.
#[derive(Clone, Copy)]
pub enum Varied<'a> {
    /// The speed over that of the reference, at constant density.
    Speed,
    /// The dynamic pressure over that of the reference; the speed over that of the reference is a function of it, one where the sound
    /// speed is constant.
    Pressure(&'a dyn Fn(f64) -> f64),
}

impl Varied<'_> {
    /// U/U_ref at x.
    pub fn speed(&self, x: f64) -> f64 {
        match self {
            Self::Speed => x,
            Self::Pressure(speed) => speed(x),
        }
    }

    /// Dynamic pressure over that of the reference at x.
    pub fn pressure(&self, x: f64) -> f64 {
        match self {
            Self::Speed => x * x,
            Self::Pressure(_) => x,
        }
    }

    /// x where the dynamic pressure over that of the reference is `pressure`.
    pub fn place(&self, pressure: f64) -> f64 {
        match self {
            Self::Speed => pressure.sqrt(),
            Self::Pressure(_) => pressure,
        }
    }
}
