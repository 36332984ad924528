//! Structures of particles alone in folders: files and checkpoints.
pub(super) mod files;
pub(super) mod pictures;
mod saved;

pub(super) use files::Files;
pub(super) use saved::Saved;
