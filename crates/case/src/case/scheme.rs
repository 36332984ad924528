//! The spatial scheme, as data.
use super::schema::{Absent, Kind, Range, defaulted, keys, optional, words};

keys! {
    /// Spatial discretisation.
    pub struct Scheme, SCHEME {
        /// Upwind flux at the middle of an edge.
        flux: Flux = defaulted(Kind::Words(FLUXES), Absent::Word("hllc")),
        /// Order of the reconstruction.
        order: u8 = defaulted(Kind::Integer(1, 2), Absent::Integer(2)),
        /// Slope limiter.
        limiter: Limiter = defaulted(Kind::Words(LIMITERS), Absent::Word("van_albada")),
        /// Relative size of second differences below which the limiter leaves a field alone: more in 3-D, where clouds
        /// are coarser, and in viscous layers.
        limiter_threshold: Option<f64> = optional(
            Kind::Number(Range::between(0.0, 1.0)), "0.1 in 2-D without viscosity, 0.4 otherwise",
        ),
        /// κ of the reconstruction: 0 for steady flow, 1/3 for waves and vortices.
        kappa: f64 = defaulted(Kind::Number(Range::between(-1.0, 1.0)), Absent::Number(0.0)),
        /// The jump of the velocity across an edge counts in the upwind flux in proportion to the Mach number: for slow
        /// flow, with conservative coefficients.
        low_mach: bool = defaulted(Kind::Flag, Absent::Flag(false)),
        /// Exactly conservative coefficients.
        conservative: Option<bool> = optional(Kind::Flag, "the solver's own choice"),
    }
}

words! {
    /// Upwind flux function, evaluated at the midpoint of an edge.
    pub enum Flux, FLUXES {
        /// Harten-Lax-van Leer with contact (Toro 1994)
        Hllc = "hllc",
        /// Roe (1981) with a smooth entropy fix
        Roe = "roe",
        /// AUSM+-up (Liou 2006)
        AusmPlusUp = "ausm_plus_up",
        /// local Lax-Friedrichs
        Rusanov = "rusanov",
    }

    /// Slope limiter.
    pub enum Limiter, LIMITERS {
        /// unlimited: smooth flow only
        None = "none",
        /// van Albada (1982) with a threshold, differentiable
        VanAlbada = "van_albada",
        /// Venkatakrishnan's (1995) rational function on edges
        Venkatakrishnan = "venkatakrishnan",
    }
}

impl Default for Scheme {
    fn default() -> Self {
        SCHEME.value()
    }
}
