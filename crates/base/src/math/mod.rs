//! Mathematics without physics: small vectors, least squares, sparse block matrices and dense matrices, Krylov methods,
//! parallel loops and sums over rows.
pub mod block_matrix;
pub mod blocks;
pub mod circulant;
pub mod conjugate;
pub mod dense;
pub mod digits;
pub mod dual;
pub mod eigenvalues;
pub mod exponentials;
pub mod fourier;
pub mod groups;
pub mod hilbert;
pub mod incomplete;
pub mod jet;
pub mod krylov;
pub mod lanczos;
pub mod least_squares;
pub mod moving_fit;
pub mod multilevel;
pub mod parallel;
pub mod pencil;
pub mod rational;
pub mod reduce;
pub mod rotation;
pub mod rounded;
pub mod singular;
pub mod slice;
pub mod sparse;
pub mod square;

pub mod symmetric;
pub mod tetrahedra;
pub mod triangulation;
pub mod types;

pub use types::{Bounds, Vector};
