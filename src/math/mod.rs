//! Arithmetic that knows no physics: small vectors, least squares, sparse blocks and full matrices, Krylov methods, the parallel loop.
pub mod block_matrix;
pub mod blocks;
pub mod circulant;
pub mod conjugate;
pub mod dense;
pub mod eigenvalues;
pub mod exponentials;
pub mod fourier;
pub mod groups;
pub mod hilbert;
pub mod incomplete;
pub mod jet;
pub mod krylov;
pub mod least_squares;
pub mod multilevel;
pub mod pencil;
pub mod rotation;
pub(crate) mod rounded;
pub mod singular;
pub mod slice;
pub mod square;
pub mod sweep;
pub mod symmetric;
pub mod tetrahedra;
pub mod triangulation;
pub mod types;

pub use types::{Bounds, Vector};
