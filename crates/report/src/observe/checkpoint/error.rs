//! What can go wrong with a checkpoint: which file, which part of it, and what to do.
use std::path::PathBuf;

use super::FileError;
use super::format::VERSION;

const HINT: &str = "copy the file again, or start from an older checkpoint";

/// What can go wrong with a checkpoint.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The operating system refused.
    #[error(transparent)]
    File(#[from] FileError),
    /// Another kind of file.
    #[error("`{}` is not a checkpoint: it does not start with `ALULACKP`", path.display())]
    Magic {
        /// The file.
        path: PathBuf,
    },
    /// A file of another version.
    #[error("`{}` is a checkpoint of version {version}; this program reads version {VERSION}\nhint: continue the run with the program that wrote it", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Version in the file.
        version: u32,
    },
    /// The file ends early or goes on after its last field.
    #[error("checkpoint `{}` has {found} bytes, {expected} are needed for {part}\nhint: {HINT}", path.display())]
    Length {
        /// The file.
        path: PathBuf,
        /// Bytes in the file.
        found: u64,
        /// Bytes that should be there.
        expected: u64,
        /// What the bytes are for.
        part: String,
    },
    /// The header is damaged.
    #[error("the header of checkpoint `{}` is damaged: {reason}\nhint: {HINT}", path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A field is damaged.
    #[error("field `{field}` of checkpoint `{}` is damaged: {reason}\nhint: {HINT}", path.display())]
    Field {
        /// The file.
        path: PathBuf,
        /// Name of the field.
        field: String,
        /// What is wrong.
        reason: String,
    },
    /// A field that cannot be written.
    #[error("field `{field}` cannot be stored: {reason}")]
    Invalid {
        /// Name of the field.
        field: String,
        /// What is wrong.
        reason: String,
    },
    /// A field that was asked for is not there.
    #[error("the checkpoint has no field `{field}` of type {dtype}; it has {present}")]
    Missing {
        /// Name of the field.
        field: String,
        /// Type that was asked for.
        dtype: &'static str,
        /// Names that are there.
        present: String,
    },
}
