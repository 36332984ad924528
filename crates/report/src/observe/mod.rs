//! What a run leaves behind: tables, field files and checkpoints. Takes slices, knows no solver type.
pub mod checkpoint;
pub mod columns;
pub mod convergence;
pub mod cycles;
pub mod damping;
pub mod error_bars;
pub mod harmonics;
pub mod hinge;
pub mod induced;
pub mod loads;
pub mod strips;
pub mod structure;
pub mod sums;
pub mod swing;
pub mod table;
pub mod usage;
pub mod vtk;
pub mod vtk_read;

pub use checkpoint::{Array, Checkpoint, CheckpointError, Field};
pub use table::{FileError, History, write_atomic};
pub use vtk::{About, Cells, Column, Facets, VtkError};
