//! The discrete equations on a cloud.
pub mod boundary;
pub mod fluid;
pub mod jacobian;
pub mod reconstruct;

pub use fluid::{Fluid, Frame, Work};
