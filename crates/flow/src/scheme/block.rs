//! Small dense blocks of the linearisation.

/// A dense block, row-major, of order D + 2 ≤ 5.
pub(super) type Block = [[f64; 5]; 5];
