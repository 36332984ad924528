//! Arithmetic that knows no physics: small vectors, least squares, sparse blocks, Krylov methods, the parallel loop.
pub mod types;

pub use types::{Bounds, Vector};
