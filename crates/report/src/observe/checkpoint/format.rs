//! Bytes of a checkpoint: a container of named arrays, readable from any language in a few lines.
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
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use lz4_flex::frame::{FrameDecoder, FrameEncoder};
use serde::{Deserialize, Serialize};

use super::{Array, Checkpoint, CheckpointError, Field};

const MAGIC: &[u8; 8] = b"ALULACKP";
pub(super) const VERSION: u32 = 2;
const PREAMBLE: usize = 24;
/// Bytes of an array that tell whether it shrinks, and those that are written at a time.
const TOLD_BY: usize = 1 << 20;
const PIECE: usize = 1 << 16;

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

impl Array<'_> {
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

/// The header, and of each field its packed bytes where it shrinks.
pub(super) type Encoded = (Vec<u8>, Vec<Option<Vec<u8>>>);

pub(super) fn put(checkpoint: &Checkpoint<'_>, (header, packed): &Encoded, w: &mut impl Write) -> io::Result<()> {
    w.write_all(header)?;
    checkpoint.fields.iter().zip(packed).try_for_each(|(field, packed)| match packed {
        Some(packed) => w.write_all(packed),
        None => field.data.write(usize::MAX, w),
    })
}

pub(super) fn encode(checkpoint: &Checkpoint) -> Result<Encoded, CheckpointError> {
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
pub(in super::super) fn header_sum(file: File) -> io::Result<Option<u32>> {
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

pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<Checkpoint<'static>, CheckpointError> {
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
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    pub(in super::super) fn sample() -> Checkpoint<'static> {
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

    pub(in super::super) fn sample_bytes() -> Vec<u8> {
        let mut bytes = Vec::new();
        put(&sample(), &encode(&sample()).unwrap(), &mut bytes).unwrap();
        bytes
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
