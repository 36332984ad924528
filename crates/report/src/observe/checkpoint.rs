//! Checkpoints: everything a run needs to continue, bit for bit, as named arrays in one file.
//!
//! A file takes the place of the one before in such an order that a machine that stops leaves one of them whole.
mod error;
mod format;

use std::borrow::Cow;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use super::sums;
use super::table::{FileError, folder_of, write_beside};
use crate::case::read_regular;
use format::{decode, encode, put};

pub use error::CheckpointError;
pub(super) use format::header_sum;

/// The state of a run at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint<'a> {
    /// Small facts: iteration, time, cycle, Courant number, version.
    pub meta: serde_json::Value,
    /// Large arrays.
    pub fields: Vec<Field<'a>>,
}

/// A named array.
#[derive(Clone, Debug, PartialEq)]
pub struct Field<'a> {
    /// Name, unique in a checkpoint.
    pub name: String,
    /// Extent along each axis, last axis fastest; its product is the length of `data`.
    pub shape: Vec<usize>,
    /// Values.
    pub data: Array<'a>,
}

/// The values of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Array<'a> {
    /// Double precision, where they lie or on their own.
    F64(Cow<'a, [f64]>),
    /// Indices.
    U32(Vec<u32>),
    /// Flags and raw bytes.
    U8(Vec<u8>),
}

impl Checkpoint<'_> {
    /// The values of a field of double precision.
    pub fn f64(&self, name: &str) -> Result<&[f64], CheckpointError> {
        match self.find(name) {
            Some(Array::F64(values)) => Ok(values),
            _ => Err(self.missing(name, "f64")),
        }
    }

    /// The values of a field of indices.
    pub fn u32(&self, name: &str) -> Result<&[u32], CheckpointError> {
        match self.find(name) {
            Some(Array::U32(values)) => Ok(values),
            _ => Err(self.missing(name, "u32")),
        }
    }

    /// The values of a field of bytes.
    pub fn u8(&self, name: &str) -> Result<&[u8], CheckpointError> {
        match self.find(name) {
            Some(Array::U8(values)) => Ok(values),
            _ => Err(self.missing(name, "u8")),
        }
    }

    fn find(&self, name: &str) -> Option<&Array<'_>> {
        self.fields.iter().find(|field| field.name == name).map(|field| &field.data)
    }

    fn missing(&self, name: &str, dtype: &'static str) -> CheckpointError {
        let present = self.fields.iter().map(|f| format!("`{}` ({})", f.name, f.data.dtype())).collect::<Vec<_>>();
        let present = if present.is_empty() { "none".to_owned() } else { present.join(", ") };
        CheckpointError::Missing { field: name.to_owned(), dtype, present }
    }
}

impl Array<'_> {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::F64(values) => values.len(),
            Self::U32(values) => values.len(),
            Self::U8(values) => values.len(),
        }
    }

    /// True when there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn dtype(&self) -> &'static str {
        match self {
            Self::F64(_) => "f64",
            Self::U32(_) => "u32",
            Self::U8(_) => "u8",
        }
    }
}

/// Writes a checkpoint and waits until it is on the disk. The one before is called `….previous` while the new one takes
/// its place, and is removed after; [`read`] finds it there when the machine stops in between. One that is there already, since a
/// machine stopped, stays until the new one is whole.
pub fn write(path: &Path, checkpoint: &Checkpoint<'_>) -> Result<(), CheckpointError> {
    let encoded = encode(checkpoint)?;
    let temporary = write_beside(path, |mut w| put(checkpoint, &encoded, &mut w))?;
    temporary.as_file().sync_all().map_err(FileError::io("write", path))?;
    sums::announce(path, Some(temporary.path()))?;
    let previous = previous_of(path);
    let replaced = path.exists() && !previous.exists();
    if replaced {
        std::fs::rename(path, &previous).map_err(FileError::io("rename", path))?;
    }
    if let Err(error) = temporary.persist(path) {
        if replaced {
            std::fs::rename(&previous, path).map_err(FileError::io("restore", path))?;
        }
        return Err(FileError::io("write", path)(error.error).into());
    }
    sync_folder(path).map_err(FileError::io("write", path))?;
    if previous.exists() {
        std::fs::remove_file(&previous).map_err(FileError::io("remove", &previous))?;
    }
    Ok(())
}

/// Reads a checkpoint; falls back to `….previous` when the file `path` is missing or damaged and that one is whole.
pub fn read(path: &Path) -> Result<Checkpoint<'static>, CheckpointError> {
    let from = |file: &Path| {
        let bytes = read_regular(file).map_err(FileError::io("read", file))?;
        let found = decode(file, &bytes)?;
        sums::check_as(path, file)?;
        Ok(found)
    };
    from(path).or_else(|problem| from(&previous_of(path)).map_err(|_| problem))
}

/// True where [`read`] finds a file to read.
pub fn is_there(path: &Path) -> bool {
    path.exists() || previous_of(path).exists()
}

fn previous_of(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".previous");
    PathBuf::from(name)
}

/// Makes the renames themselves durable; folders cannot be opened on Windows, where the rename is journalled.
fn sync_folder(path: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder_of(path))?.sync_all() } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::format::tests::{sample, sample_bytes};
    use super::*;

    #[test]
    fn every_bit_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoint.alula");
        let odd = [0.0, -0.0, f64::MIN_POSITIVE / 4.0, f64::INFINITY, f64::from_bits(0x7ff0_0000_dead_beef)];
        let mut checkpoint = sample();
        checkpoint.fields.push(Field { name: "odd".into(), shape: vec![5], data: Array::F64(odd.to_vec().into()) });
        write(&path, &checkpoint).unwrap();
        let back = read(&path).unwrap();
        let bits = |c: &Checkpoint| c.f64("odd").unwrap().iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&checkpoint), bits(&back));
        assert_eq!(checkpoint.meta, back.meta);
        assert_eq!(checkpoint.fields[..4], back.fields[..4]);
        assert_eq!(back.u32("level").unwrap().len(), 300);
        let message = back.u8("state").unwrap_err().to_string();
        assert!(message.starts_with("the checkpoint has no field `state` of type u8; it has `state` (f64)"));
    }

    #[test]
    fn large_arrays_come_back_whether_they_shrink_or_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoint.alula");
        let noise: Vec<f64> = (0..200_000_u64).map(|k| f64::from_bits(k.wrapping_mul(0x9e37_79b9_7f4a_7c15))).collect();
        let field = |name: &str, data: Array<'static>| Field { name: name.into(), shape: vec![data.len()], data };
        let fields = vec![field("noise", Array::F64(noise.into())), field("same", Array::U32(vec![7; 400_000]))];
        let checkpoint = Checkpoint { meta: serde_json::Value::Null, fields };
        write(&path, &checkpoint).unwrap();
        let size = std::fs::metadata(&path).unwrap().len();
        assert!((1_600_000..1_620_000).contains(&size), "{size}");
        let (back, bits) = (read(&path).unwrap(), |c: &Checkpoint| {
            c.f64("noise").unwrap().iter().map(|v| v.to_bits()).collect::<Vec<_>>()
        });
        assert_eq!(bits(&back), bits(&checkpoint));
        assert_eq!(back.fields[1], checkpoint.fields[1]);
    }

    #[test]
    fn the_previous_file_stands_in_when_the_machine_stops_between_renames() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoint.alula");
        write(&path, &sample()).unwrap();
        write(&path, &sample()).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "the previous one is removed");
        std::fs::rename(&path, previous_of(&path)).unwrap();
        assert_eq!(read(&path).unwrap(), sample());
        write(&path, &sample()).unwrap();
        assert!(!previous_of(&path).exists());
    }

    #[test]
    fn the_previous_file_stands_in_for_a_damaged_one_and_outlives_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoint.alula");
        std::fs::write(&path, &sample_bytes()[..100]).unwrap();
        let alone = read(&path).unwrap_err().to_string();
        std::fs::write(previous_of(&path), sample_bytes()).unwrap();
        assert!(is_there(&path) && read(&path).unwrap() == sample());
        // both are damaged: the problem told is that of the file itself
        std::fs::write(previous_of(&path), b"nothing").unwrap();
        assert_eq!(read(&path).unwrap_err().to_string(), alone);
        std::fs::remove_file(&path).unwrap();
        assert!(is_there(&path));
        write(&path, &sample()).unwrap();
        assert!(!previous_of(&path).exists() && read(&path).unwrap() == sample());
    }
}
