//! Exact solutions of gas dynamics: the truth that tests, verification cases and far fields compare with.
//!
//! Every page states its solution, its source and where it stops being valid. All functions are pure, take the ratio of
//! specific heats γ as an argument and use any consistent set of units unless the page says otherwise.
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
//! | [`piston`] | piston started at once, and oscillating: simple wave and acoustics |
//! | [`theodorsen`] | plate that pitches and plunges in incompressible flow |
//! | [`flutter`] | typical section on springs in incompressible flow: roots, flutter, divergence |
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

/// Density, velocity and pressure of the gas at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GasState<const D: usize, S = f64> {
    /// Density.
    pub density: S,
    /// Velocity.
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

/// Why an exact solution does not exist for the arguments given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// γ is not above one, or not finite.
    #[error("ratio of specific heats {gamma} is outside (1, inf)\nhint: use 1.4 for air")]
    Gamma {
        /// The value given.
        gamma: f64,
    },
    /// γ for which the solution has no closed form.
    #[error(
        "ratio of specific heats {gamma} has no closed form here\nhint: use 1 + 2/n with n odd, such as 1.4 or 5/3"
    )]
    GammaNotClosed {
        /// The value given.
        gamma: f64,
    },
    /// A state with density or pressure not positive, or a number that is not finite.
    #[error(
        "{side} state has density {density}, velocity {velocity}, pressure {pressure}\n\
         hint: density and pressure must be positive, all three finite"
    )]
    State {
        /// Which state.
        side: &'static str,
        /// Its density.
        density: f64,
        /// Its velocity.
        velocity: f64,
        /// Its pressure.
        pressure: f64,
    },
    /// The two states of a Riemann problem part so fast that a vacuum opens.
    #[error(
        "velocity difference {difference} opens a vacuum, the limit is {limit}\n\
         hint: bring the velocities closer or raise the pressures"
    )]
    Vacuum {
        /// Right velocity minus left velocity.
        difference: f64,
        /// Greatest difference without vacuum.
        limit: f64,
    },
    /// A Mach number outside the range of the solution.
    #[error("{what} needs a Mach number in {range}, not {mach}\nhint: change the Mach number")]
    Mach {
        /// The solution.
        what: &'static str,
        /// Its range.
        range: &'static str,
        /// The value given.
        mach: f64,
    },
    /// A deflection for which no attached shock exists.
    #[error(
        "deflection of {angle} rad at Mach {mach} detaches the shock, the limit is {limit} rad\nhint: reduce the deflection or raise the Mach number"
    )]
    Detached {
        /// The deflection, radians.
        angle: f64,
        /// Mach number ahead of the shock.
        mach: f64,
        /// Greatest deflection of an attached shock, radians.
        limit: f64,
    },
    /// An angle outside the range of the solution.
    #[error("{what} needs an angle in {range}, not {angle} rad\nhint: change the angle")]
    Angle {
        /// The solution.
        what: &'static str,
        /// Its range.
        range: &'static str,
        /// The value given, radians.
        angle: f64,
    },
    /// A point where the solution is not defined.
    #[error(
        "point ({x}, {y}) lies outside {what}\nhint: move the domain into the region that the page of the solution names"
    )]
    Outside {
        /// The solution.
        what: &'static str,
        /// Abscissa.
        x: f64,
        /// Ordinate.
        y: f64,
    },
    /// A parameter that makes the solution meaningless.
    #[error("{what} is {value}, needs {range}\nhint: change this parameter")]
    Parameter {
        /// The parameter.
        what: &'static str,
        /// The value given.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
}

/// Refuses a ratio of specific heats that is not above one.
pub(crate) fn check_gamma(gamma: f64) -> Result<(), Error> {
    if 1.0 < gamma && gamma.is_finite() { Ok(()) } else { Err(Error::Gamma { gamma }) }
}
