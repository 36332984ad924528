//! Exact solutions of gas dynamics, with which tests and verification cases are compared, and which provide far fields.
//!
//! Every page states its solution, its source and its range of validity. All functions are pure, take the ratio of
//! specific heats γ as an argument and use any consistent set of units unless the page states otherwise.
//!
//! | page | solution |
//! |---|---|
//! | [`riemann`] | Riemann problem of the ideal gas |
//! | [`shock`] | normal and oblique shocks, detachment |
//! | [`expansion`] | isentropic relations, Prandtl-Meyer fan |
//! | [`cone`] | supersonic flow past a cone |
//! | [`diamond`] | diamond airfoil by shock-expansion theory |
//! | [`vortex`] | advected isentropic vortex |
//! | [`ringleb`] | Ringleb's transonic hodograph flow |
//! | [`potential`] | subcritical flow past a circle and a sphere |
//! | [`vortex_far_field`] | point vortex in a compressible free stream |
//! | [`piston`] | impulsively started and oscillating piston: simple wave and acoustics |
//! | [`theodorsen`] | pitching and plunging plate in incompressible flow |
//! | [`flutter`] | typical section in incompressible flow: roots, flutter, divergence |
//! | [`lifting_surface`] | lift and induced drag of thin wings in subsonic flow |
//! | [`blasius`] | laminar boundary layer on a flat plate |
use crate::math::Vector;

mod bessel;
pub mod blasius;
pub mod cone;
pub mod diamond;
pub mod expansion;
pub mod flutter;
mod janzen_rayleigh;
pub mod lifting_surface;
pub mod piston;
pub mod potential;
pub mod riemann;
pub mod ringleb;
mod roots;
pub mod shock;
pub mod theodorsen;
pub mod vortex;
pub mod vortex_far_field;

/// State of the gas at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GasState<const D: usize, S = f64> {
    /// Density of the gas.
    pub density: S,
    /// Velocity of the gas.
    pub velocity: Vector<D, S>,
    /// Static pressure.
    pub pressure: S,
}

impl<const D: usize> GasState<D> {
    /// Speed of sound √(γp/ρ).
    pub fn sound_speed(&self, gamma: f64) -> f64 {
        (gamma * self.pressure / self.density).sqrt()
    }

    /// Mach number |v|/c.
    pub fn mach(&self, gamma: f64) -> f64 {
        self.velocity.norm() / self.sound_speed(gamma)
    }
}

/// Reason why an exact solution does not exist for the given arguments.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The ratio of specific heats γ is not above 1, or not finite.
    #[error("ratio of specific heats {gamma} is outside (1, inf)\nhint: use 1.4 for air")]
    Gamma {
        /// The value given.
        gamma: f64,
    },
    /// The solution has no closed form for this γ.
    #[error(
        "ratio of specific heats {gamma} has no closed form here\nhint: use 1 + 2/n with n odd, such as 1.4 or 5/3"
    )]
    GammaNotClosed {
        /// The value given.
        gamma: f64,
    },
    /// A density or pressure is not positive, or a value is not finite.
    #[error(
        "{side} state has density {density}, velocity {velocity}, pressure {pressure}\n\
         hint: density and pressure must be positive, all three finite"
    )]
    State {
        /// Name of the state, for the message.
        side: &'static str,
        /// Density of the state.
        density: f64,
        /// Velocity of the state.
        velocity: f64,
        /// Pressure of the state.
        pressure: f64,
    },
    /// The two states of a Riemann problem separate so fast that a vacuum forms.
    #[error(
        "velocity difference {difference} opens a vacuum, the limit is {limit}\n\
         hint: bring the velocities closer or raise the pressures"
    )]
    Vacuum {
        /// Right velocity minus left velocity.
        difference: f64,
        /// Maximum difference without vacuum.
        limit: f64,
    },
    /// A Mach number is outside the range of the solution.
    #[error("{what} needs a Mach number in {range}, not {mach}\nhint: change the Mach number")]
    Mach {
        /// Name of the solution.
        what: &'static str,
        /// Range of the Mach number.
        range: &'static str,
        /// The value given.
        mach: f64,
    },
    /// No attached shock exists for this deflection.
    #[error(
        "deflection of {angle} rad at Mach {mach} detaches the shock, the limit is {limit} rad\nhint: reduce the deflection or raise the Mach number"
    )]
    Detached {
        /// Deflection (rad).
        angle: f64,
        /// Mach number ahead of the shock.
        mach: f64,
        /// Maximum deflection of an attached shock (rad).
        limit: f64,
    },
    /// An angle is outside the range of the solution.
    #[error("{what} needs an angle in {range}, not {angle} rad\nhint: change the angle")]
    Angle {
        /// Name of the solution.
        what: &'static str,
        /// Range of the angle.
        range: &'static str,
        /// The value given (rad).
        angle: f64,
    },
    /// The solution is not defined at this point.
    #[error(
        "point ({x}, {y}) lies outside {what}\nhint: move the domain into the region that the page of the solution names"
    )]
    Outside {
        /// Name of the solution.
        what: &'static str,
        /// Coordinate x of the point.
        x: f64,
        /// Coordinate y of the point.
        y: f64,
    },
    /// A parameter is outside its range.
    #[error("{what} is {value}, needs {range}\nhint: change this parameter")]
    Parameter {
        /// Name of the parameter.
        what: &'static str,
        /// The value given.
        value: f64,
        /// Range of the parameter.
        range: &'static str,
    },
}

/// Returns an error if the ratio of specific heats is not finite and above 1.
pub(crate) fn check_gamma(gamma: f64) -> Result<(), Error> {
    if 1.0 < gamma && gamma.is_finite() { Ok(()) } else { Err(Error::Gamma { gamma }) }
}
