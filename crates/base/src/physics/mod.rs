//! Pointwise physics: no index, no slice, no particle.
pub mod atmosphere;
pub mod gas;
pub mod outgoing;
pub mod riemann;
pub mod solid;
pub mod viscous;

pub use gas::{Conserved, Gas, Primitive};
pub use viscous::Newtonian;

/// Unknowns of a particle in `dimension` dimensions: density, momentum and energy.
#[inline(always)]
pub const fn n_variables(dimension: usize) -> usize {
    dimension + 2
}
