//! Structures of particles alone in folders: files, checkpoints, and what is known of them before they are computed.
pub(super) mod files;
mod inspect;
pub(super) mod pictures;
mod saved;
mod trial;

pub(super) use files::Files;
pub(super) use inspect::inspect_in_gas;
pub use inspect::{SolidReport, inspect_structure};
pub(super) use saved::Saved;
