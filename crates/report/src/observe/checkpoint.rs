//! Checkpoints: everything a run needs to continue, bit for bit.
//!
//! A container of named arrays, readable from any language in a few lines:
//!
//! | bytes      | content                                                                                     |
//! |------------|---------------------------------------------------------------------------------------------|
//! | 0..8       | `ALULACKP`                                                                                  |
//! | 8..12      | version, u32                                                                                |
//! | 12..20     | length of the header in bytes, u64                                                          |
//! | 20..24     | CRC-32 of bytes 8..20 and of the header, u32                                                |
//! | 24..24+n   | header, JSON: `{"meta": …, "fields": [{name, dtype, shape, offset, stored, encoding, crc32}]}` |
//! | then       | the stored arrays one after another, `offset` counted from the end of the header            |
//!
//! All numbers are little-endian. An array is stored as one LZ4 frame where its first MiB shrinks, else raw and written from where it
//! lies: states hardly shrink, and copies of them would be the peak of memory of a large run. Its CRC-32 is that of the stored bytes. Every byte of the file is under the magic, a CRC or the check of the total length, so that
//! damage is reported with the name of the field it hit and never read as a number.
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use lz4_flex::frame::{FrameDecoder, FrameEncoder};
use serde::{Deserialize, Serialize};

use super::sums;
use super::table::{FileError, folder_of, write_beside};
use crate::case::read_regular;

const MAGIC: &[u8; 8] = b"ALULACKP";
const VERSION: u32 = 2;
const PREAMBLE: usize = 24;
/// Bytes of an array that tell whether it shrinks, and those that are written at a time.
const TOLD_BY: usize = 1 << 20;
const PIECE: usize = 1 << 16;

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

const HINT: &str = "copy the file again, or start from an older checkpoint";

#[derive(Serialize, Deserialize)]
struct Header {
    meta: serde_json::Value,
    fields: Vec<Entry>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Entry {
    name: String,
    dtype: Dtype,
    shape: Vec<usize>,
    offset: u64,
    stored: u64,
    encoding: Encoding,
    crc32: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Dtype {
    F64,
    U32,
    U8,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Encoding {
    Raw,
    Lz4,
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

    /// Bytes of the first `most` of these at least, or of all, one piece after the other.
    fn write(&self, most: usize, w: &mut impl Write) -> io::Result<()> {
        fn pieces<T, const N: usize>(
            v: &[T],
            most: usize,
            of: impl Fn(&T) -> [u8; N],
            w: &mut impl Write,
        ) -> io::Result<()> {
            let count = v.len().min(most.div_ceil(N));
            v[..count].chunks(PIECE / N).try_for_each(|v| w.write_all(&v.iter().flat_map(&of).collect::<Vec<u8>>()))
        }
        match self {
            Self::F64(values) => pieces(values, most, |v| v.to_le_bytes(), w),
            Self::U32(values) => pieces(values, most, |v| v.to_le_bytes(), w),
            Self::U8(values) => w.write_all(&values[..values.len().min(most)]),
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Self::F64(values) => 8 * values.len(),
            Self::U32(values) => 4 * values.len(),
            Self::U8(values) => values.len(),
        }
    }

    fn from_bytes(dtype: Dtype, bytes: Vec<u8>) -> Self {
        match dtype {
            Dtype::F64 => Self::F64(bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect()),
            Dtype::U32 => Self::U32(bytes.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect()),
            Dtype::U8 => Self::U8(bytes),
        }
    }
}

impl Dtype {
    fn size(self) -> usize {
        match self {
            Self::F64 => 8,
            Self::U32 => 4,
            Self::U8 => 1,
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

/// The header, and of each field its packed bytes where it shrinks.
type Encoded = (Vec<u8>, Vec<Option<Vec<u8>>>);

fn put(checkpoint: &Checkpoint<'_>, (header, packed): &Encoded, w: &mut impl Write) -> io::Result<()> {
    w.write_all(header)?;
    checkpoint.fields.iter().zip(packed).try_for_each(|(field, packed)| match packed {
        Some(packed) => w.write_all(packed),
        None => field.data.write(usize::MAX, w),
    })
}

fn encode(checkpoint: &Checkpoint) -> Result<Encoded, CheckpointError> {
    let mut entries: Vec<Entry> = Vec::with_capacity(checkpoint.fields.len());
    let mut blocks = Vec::with_capacity(checkpoint.fields.len());
    let mut offset = 0;
    for field in &checkpoint.fields {
        check_field(field, &entries)?;
        let (packed, crc32) = encode_array(&field.data)
            .map_err(|e| CheckpointError::Invalid { field: field.name.clone(), reason: e.to_string() })?;
        let dtype = match field.data {
            Array::F64(_) => Dtype::F64,
            Array::U32(_) => Dtype::U32,
            Array::U8(_) => Dtype::U8,
        };
        let (name, shape) = (field.name.clone(), field.shape.clone());
        let (encoding, stored) = match &packed {
            Some(packed) => (Encoding::Lz4, packed.len() as u64),
            None => (Encoding::Raw, field.data.bytes() as u64),
        };
        entries.push(Entry { name, dtype, shape, offset, stored, encoding, crc32 });
        offset += stored;
        blocks.push(packed);
    }
    let header = Header { meta: checkpoint.meta.clone(), fields: entries };
    let json = serde_json::to_vec(&header)
        .map_err(|e| CheckpointError::Invalid { field: "meta".to_owned(), reason: e.to_string() })?;
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((json.len() as u64).to_le_bytes());
    bytes.extend(header_crc(&bytes[8..20], &json).to_le_bytes());
    bytes.extend(json);
    Ok((bytes, blocks))
}

fn check_field(field: &Field, before: &[Entry]) -> Result<(), CheckpointError> {
    let invalid = |reason: String| Err(CheckpointError::Invalid { field: field.name.clone(), reason });
    if before.iter().any(|entry| entry.name == field.name) {
        return invalid("the name is taken by another field".to_owned());
    }
    if product(&field.shape) != Some(field.data.len()) {
        return invalid(format!("its shape is {:?} but it has {} values", field.shape, field.data.len()));
    }
    Ok(())
}

/// The packed bytes of an array whose beginning shrinks, and the CRC-32 of what is stored.
///
/// Fast rather than small: flags and indices shrink in any way, and a checkpoint must not stall the run.
fn encode_array(data: &Array) -> io::Result<(Option<Vec<u8>>, u32)> {
    let beginning = pack(data, TOLD_BY)?;
    if beginning.len() < data.bytes().min(TOLD_BY) {
        let packed = if data.bytes() <= TOLD_BY { beginning } else { pack(data, usize::MAX)? };
        let crc = crc32fast::hash(&packed);
        return Ok((Some(packed), crc));
    }
    let mut sum = Checksum(crc32fast::Hasher::new());
    data.write(usize::MAX, &mut sum)?;
    Ok((None, sum.0.finalize()))
}

fn pack(data: &Array<'_>, most: usize) -> io::Result<Vec<u8>> {
    let mut encoder = FrameEncoder::new(Vec::new());
    data.write(most, &mut encoder)?;
    Ok(encoder.finish()?)
}

/// Keeps the checksum of what is written to it.
struct Checksum(crc32fast::Hasher);

impl Write for Checksum {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn product(shape: &[usize]) -> Option<usize> {
    shape.iter().try_fold(1_usize, |n, extent| n.checked_mul(*extent))
}

/// Checksum of the header that a file has, whatever it says of it itself; `None` where it ends early.
pub(super) fn header_sum(file: File) -> io::Result<Option<u32>> {
    let mut file = io::BufReader::new(file);
    let mut head = Vec::new();
    (&mut file).take(PREAMBLE as u64).read_to_end(&mut head)?;
    if head.len() < PREAMBLE {
        return Ok(None);
    }
    let (length, mut json) = (u64::from_le_bytes(integer(&head, 12)), Vec::new());
    file.take(length).read_to_end(&mut json)?;
    Ok((json.len() as u64 == length).then(|| header_crc(&head[8..20], &json)))
}

fn header_crc(preamble: &[u8], json: &[u8]) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    crc.update(preamble);
    crc.update(json);
    crc.finalize()
}

/// The four (or eight) bytes at `at` as an integer; the caller has checked that they are there.
fn integer<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    std::array::from_fn(|k| bytes.get(at + k).copied().unwrap_or(0))
}

fn decode(path: &Path, bytes: &[u8]) -> Result<Checkpoint<'static>, CheckpointError> {
    let too_short = |expected: u64, part: &str| CheckpointError::Length {
        path: path.to_path_buf(),
        found: bytes.len() as u64,
        expected,
        part: part.to_owned(),
    };
    if bytes.len() >= MAGIC.len() && !bytes.starts_with(MAGIC) {
        return Err(CheckpointError::Magic { path: path.to_path_buf() });
    }
    if bytes.len() < PREAMBLE {
        return Err(too_short(PREAMBLE as u64, "the preamble"));
    }
    let version = u32::from_le_bytes(integer(bytes, 8));
    if version != VERSION {
        return Err(CheckpointError::Version { path: path.to_path_buf(), version });
    }
    let length = u64::from_le_bytes(integer(bytes, 12));
    let end = length.saturating_add(PREAMBLE as u64);
    let json = usize::try_from(end)
        .ok()
        .and_then(|end| bytes.get(PREAMBLE..end))
        .ok_or_else(|| too_short(end, "the header"))?;
    let header = decode_header(path, bytes, json)?;
    let data = &bytes[PREAMBLE + json.len()..];
    let mut fields = Vec::with_capacity(header.fields.len());
    let mut next = 0;
    for entry in &header.fields {
        if entry.offset != next {
            return Err(damaged(path, entry, format!("it starts at byte {} instead of {next}", entry.offset)));
        }
        next = next.saturating_add(entry.stored);
        fields.push(decode_field(path, entry, data, end)?);
    }
    if data.len() as u64 != next {
        return Err(too_short(end.saturating_add(next), "the whole file"));
    }
    Ok(Checkpoint { meta: header.meta, fields })
}

fn decode_header(path: &Path, bytes: &[u8], json: &[u8]) -> Result<Header, CheckpointError> {
    let broken = |reason: String| CheckpointError::Header { path: path.to_path_buf(), reason };
    let expected = u32::from_le_bytes(integer(bytes, 20));
    let found = header_crc(&bytes[8..20], json);
    if found != expected {
        return Err(broken(format!("its CRC-32 is {found:08x} instead of {expected:08x}")));
    }
    serde_json::from_slice(json).map_err(|e| broken(e.to_string()))
}

fn damaged(path: &Path, entry: &Entry, reason: String) -> CheckpointError {
    CheckpointError::Field { path: path.to_path_buf(), field: entry.name.clone(), reason }
}

fn decode_field(path: &Path, entry: &Entry, data: &[u8], base: u64) -> Result<Field<'static>, CheckpointError> {
    let end = entry.offset.saturating_add(entry.stored);
    let stored = usize::try_from(entry.offset).ok().zip(usize::try_from(end).ok());
    let stored = stored.and_then(|(start, end)| data.get(start..end)).ok_or_else(|| CheckpointError::Length {
        path: path.to_path_buf(),
        found: base + data.len() as u64,
        expected: base.saturating_add(end),
        part: format!("field `{}`", entry.name),
    })?;
    let crc = crc32fast::hash(stored);
    if crc != entry.crc32 {
        return Err(damaged(path, entry, format!("its CRC-32 is {crc:08x} instead of {:08x}", entry.crc32)));
    }
    let size = product(&entry.shape).and_then(|n| n.checked_mul(entry.dtype.size()));
    let size = size.ok_or_else(|| damaged(path, entry, format!("no memory holds the shape {:?}", entry.shape)))?;
    let raw = unpack(entry, stored, size).map_err(|e| damaged(path, entry, e.to_string()))?;
    if raw.len() != size {
        let reason = format!("it has {} bytes, its shape {:?} needs {size}", raw.len(), entry.shape);
        return Err(damaged(path, entry, reason));
    }
    Ok(Field { name: entry.name.clone(), shape: entry.shape.clone(), data: Array::from_bytes(entry.dtype, raw) })
}

/// Memory grows with what is really decoded, at most one byte past `size`: a forged shape cannot exhaust it.
fn unpack(entry: &Entry, stored: &[u8], size: usize) -> io::Result<Vec<u8>> {
    match entry.encoding {
        Encoding::Raw => Ok(stored.to_vec()),
        Encoding::Lz4 => {
            let mut raw = Vec::new();
            FrameDecoder::new(stored).take((size as u64).saturating_add(1)).read_to_end(&mut raw)?;
            Ok(raw)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sample() -> Checkpoint<'static> {
        let state: Vec<f64> = (0..60).map(|k| (f64::from(k) * 0.1).sin()).collect();
        Checkpoint {
            meta: serde_json::json!({"iteration": 120, "time": 0.1, "label": "π"}),
            fields: vec![
                Field { name: "state".into(), shape: vec![15, 4], data: Array::F64(state.into()) },
                Field { name: "level".into(), shape: vec![300], data: Array::U32(vec![3; 300]) },
                Field { name: "flags".into(), shape: vec![3], data: Array::U8(vec![0, 255, 7]) },
                Field { name: "nothing".into(), shape: vec![0, 4], data: Array::F64(vec![].into()) },
            ],
        }
    }

    fn sample_bytes() -> Vec<u8> {
        let mut bytes = Vec::new();
        put(&sample(), &encode(&sample()).unwrap(), &mut bytes).unwrap();
        bytes
    }

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

    #[test]
    fn damage_names_the_field() {
        let mut bytes = sample_bytes();
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        let message = decode(Path::new("c.alula"), &bytes).unwrap_err().to_string();
        assert!(message.starts_with("field `flags` of checkpoint `c.alula` is damaged: its CRC-32 is"), "{message}");
        let message = decode(Path::new("c.alula"), &bytes[..last - 2]).unwrap_err().to_string();
        assert!(message.contains("are needed for field `flags`"), "{message}");
        assert!(matches!(decode(Path::new("c"), b"PNG image, surely"), Err(CheckpointError::Magic { .. })));
        bytes[8] = 9;
        assert!(matches!(decode(Path::new("c"), &bytes), Err(CheckpointError::Version { version: 9, .. })));
    }

    #[test]
    fn ragged_and_doubled_fields_are_refused() {
        let mut checkpoint = sample();
        checkpoint.fields[0].shape = vec![15, 5];
        assert!(encode(&checkpoint).unwrap_err().to_string().contains("its shape is [15, 5] but it has 60 values"));
        let mut checkpoint = sample();
        checkpoint.fields[1].name = "state".into();
        assert!(matches!(encode(&checkpoint), Err(CheckpointError::Invalid { .. })));
    }

    /// A header that passes its CRC but lies about a shape.
    #[test]
    fn a_forged_shape_is_an_error_without_the_memory() {
        let forged = |shape: &str, block: &[u8], encoding: &str| {
            let json = format!(
                r#"{{"meta":null,"fields":[{{"name":"a","dtype":"f64","shape":{shape},"offset":0,"stored":{},"encoding":"{encoding}","crc32":{}}}]}}"#,
                block.len(),
                crc32fast::hash(block)
            );
            let mut bytes = MAGIC.to_vec();
            bytes.extend(VERSION.to_le_bytes());
            bytes.extend((json.len() as u64).to_le_bytes());
            bytes.extend(header_crc(&bytes[8..20], json.as_bytes()).to_le_bytes());
            bytes.extend(json.as_bytes());
            bytes.extend(block);
            decode(Path::new("c"), &bytes)
        };
        assert!(forged("[1]", &[0; 8], "raw").is_ok());
        let packed = pack(&Array::U8(vec![0; 80]), usize::MAX).unwrap();
        assert!(forged("[10]", &packed, "lz4").is_ok());
        for (shape, block, encoding) in [
            ("[2]", &[0; 8][..], "raw"),
            ("[4294967296, 4294967296, 9]", &[0; 8], "raw"),
            ("[1000000000000]", &packed, "lz4"),
            ("[3]", &packed, "lz4"),
            ("[1]", &[1; 8], "lz4"),
            ("[-1]", &[0; 8], "raw"),
        ] {
            assert!(forged(shape, block, encoding).is_err(), "{shape} {encoding}");
        }
    }

    proptest! {
        #[test]
        fn a_truncated_file_is_an_error(cut in any::<prop::sample::Index>()) {
            let bytes = sample_bytes();
            prop_assert!(decode(Path::new("c"), &bytes[..cut.index(bytes.len())]).is_err());
        }

        #[test]
        fn a_longer_file_is_an_error(tail in prop::collection::vec(any::<u8>(), 1..20)) {
            let bytes = [sample_bytes(), tail].concat();
            prop_assert!(decode(Path::new("c"), &bytes).is_err());
        }

        #[test]
        fn a_flipped_bit_is_an_error(at in any::<prop::sample::Index>(), bit in 0..8_u32) {
            let mut bytes = sample_bytes();
            let at = at.index(bytes.len());
            bytes[at] ^= 1 << bit;
            prop_assert!(decode(Path::new("c"), &bytes).is_err(), "byte {at} bit {bit}");
        }

        #[test]
        fn noise_is_an_error(noise in prop::collection::vec(any::<u8>(), 0..200), magic in any::<bool>()) {
            let bytes = if magic { [MAGIC.to_vec(), vec![1, 0, 0, 0], noise].concat() } else { noise };
            prop_assert!(decode(Path::new("c"), &bytes).is_err());
        }
    }
}
