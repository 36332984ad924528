//! Pointwise physics: no index, no slice, no particle.
pub mod gas;
pub mod outgoing;
pub mod riemann;
pub mod viscous;

pub use gas::{Conserved, Gas, Primitive};
pub use viscous::Newtonian;
