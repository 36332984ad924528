//! Physics at a point: gas, solids and atmosphere, without particles, indices or arrays of unknowns.
pub mod atmosphere;
pub mod gas;
pub mod outgoing;
pub mod riemann;
pub mod solid;
pub mod viscous;

pub use gas::{Conserved, Gas, Primitive};
pub use viscous::Newtonian;

/// Number of unknowns of a gas particle in `dimension` dimensions: density, momentum and energy.
#[inline(always)]
pub const fn n_variables(dimension: usize) -> usize {
    dimension + 2
}
