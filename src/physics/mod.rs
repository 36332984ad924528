//! Pointwise physics: no index, no slice, no particle.
pub mod gas;
pub mod riemann;

pub use gas::{Conserved, Gas, Primitive};
