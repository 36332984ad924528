//! Files that a case names.
use std::io::ErrorKind;
use std::path::Path;

use crate::case::{read_written, text_of};

/// Text of a file that a case or a run refers to.
pub(crate) fn text(folder: &Path, name: &str) -> std::io::Result<String> {
    plain(&folder.join(name))
}

/// Text of a file, however it is encoded.
pub(crate) fn plain(path: &Path) -> std::io::Result<String> {
    text_of(&read_written(path)?).map_err(|e| std::io::Error::new(ErrorKind::InvalidData, e))
}
