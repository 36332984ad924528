//! The discrete equations on a cloud.
pub mod adapt;
pub mod boundary;
pub mod fluid;
pub mod jacobian;
pub mod probe;
pub mod reconstruct;
pub mod start;

pub use fluid::{Fluid, Frame, Work};
