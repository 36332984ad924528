//! Field files read back: those that [`super::vtk`] writes, with 64-bit numbers in compressed appended blocks.
use std::io::Read;
use std::path::Path;

use flate2::read::ZlibDecoder;

use crate::case::read_regular;

/// What stands before the arrays.
const MARKER: &[u8] = b"<AppendedData encoding=\"raw\">\n_";
/// Longest array that is read, bytes: a thousand million numbers.
const LONGEST: u64 = 8 << 30;

/// A field file in memory; its arrays are unpacked when they are asked for.
pub struct FieldFile {
    bytes: Vec<u8>,
    /// Name, offset and unit, empty where none is told, of each array of 64-bit numbers.
    arrays: Vec<(String, usize, String)>,
    /// Where offsets count from.
    start: usize,
}

impl FieldFile {
    /// Opens a file; why it cannot be read otherwise.
    pub fn open(path: &Path) -> Result<Self, String> {
        let bytes = read_regular(path).map_err(|e| e.to_string())?;
        Self::of(bytes).ok_or_else(|| "it is no field file of this program".to_owned())
    }

    fn of(bytes: Vec<u8>) -> Option<Self> {
        let start = bytes.windows(MARKER.len()).position(|w| w == MARKER)?;
        let xml = std::str::from_utf8(&bytes[..start]).ok()?;
        let part = |line: &str, key: &str| Some(line.split_once(&format!("{key}=\""))?.1.split_once('"')?.0.to_owned());
        let unit = |line: &str| Some(line.split_once("\"vtkDataArray\">")?.1.split_once("</")?.0.to_owned());
        let array = |line: &str| {
            Some((part(line, "Name")?, part(line, "offset")?.parse().ok()?, unit(line).unwrap_or_default()))
        };
        // field data stand in the head itself
        let appended = |line: &&str| line.contains("format=\"appended\"");
        let wide =
            |line: &&str| ["Float64", "Int64"].iter().any(|kind| line.contains(&format!("<DataArray type=\"{kind}\"")));
        let arrays = xml.lines().filter(appended).filter(wide).map(array).collect::<Option<_>>()?;
        Some(Self { arrays, start: start + MARKER.len(), bytes })
    }

    /// Numbers of the array called `name`.
    pub fn values(&self, name: &str) -> Option<Vec<f64>> {
        Some(self.words(name)?.into_iter().map(f64::from_bits).collect())
    }

    /// Unit of the array called `name`; `None` where the file tells none.
    pub fn unit(&self, name: &str) -> Option<&str> {
        let (.., unit) = self.arrays.iter().find(|(n, ..)| n == name)?;
        (!unit.is_empty()).then_some(unit)
    }

    /// Corners of its cells, `None` where they are not triangles.
    pub fn triangles(&self) -> Option<Vec<[u32; 3]>> {
        let ends = self.words("offsets")?;
        let corners: Vec<u32> =
            self.words("connectivity")?.into_iter().map(|i| u32::try_from(i).ok()).collect::<Option<_>>()?;
        let three = ends.iter().enumerate().all(|(k, end)| *end == 3 * (k as u64 + 1));
        (three && 3 * ends.len() == corners.len()).then(|| corners.as_chunks().0.to_vec())
    }

    fn words(&self, name: &str) -> Option<Vec<u64>> {
        let (_, offset, _) = self.arrays.iter().find(|(n, ..)| n == name)?;
        let block = self.bytes.get(self.start.checked_add(*offset)?..)?;
        let word = |k: usize| Some(u64::from_le_bytes(block.get(8 * k..8 * k + 8)?.try_into().ok()?) as usize);
        let pieces = word(0)?;
        let mut at = 8 * (3 + pieces);
        let mut unpacked = Vec::new();
        for k in 0..pieces {
            let size = word(3 + k)?;
            let packed = block.get(at..at.checked_add(size)?)?;
            ZlibDecoder::new(packed).take(LONGEST).read_to_end(&mut unpacked).ok()?;
            at += size;
        }
        Some(unpacked.as_chunks().0.iter().map(|b| u64::from_le_bytes(*b)).collect())
    }

    /// Places of the points.
    pub fn points(&self) -> Option<Vec<[f64; 3]>> {
        Some(self.values("Points")?.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::super::columns::Scale;
    use super::super::vtk::{About, Cells, Column, write_cells};
    use super::*;

    #[test]
    fn what_was_written_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("field.vtu");
        // more than a piece
        let points: Vec<[f64; 3]> = (0..40_000).map(|k| [f64::from(k), 0.5, -f64::from(k).sqrt()]).collect();
        let density: Vec<f64> = points.iter().map(|x| x[2].sin()).collect();
        let about = About {
            scale: Some(Scale { dimensional: false, dimension: 3 }),
            numbers: vec![("density [rho]".into(), 1.0)],
            words: vec![("title", "density".into())],
            ..About::default()
        };
        let column = Column { name: "density", components: 1, values: &density };
        write_cells(&path, &about, &points, Cells::Vertices, &[column]).unwrap();
        let file = FieldFile::open(&path).unwrap();
        assert_eq!(file.points().unwrap(), points);
        assert_eq!(file.values("density").unwrap(), density);
        assert!(file.values("pressure").is_none());
        assert_eq!((file.unit("density"), file.unit("Points")), (Some("rho"), None));
        assert!(file.triangles().is_none(), "vertices");
        let triangles = folder.path().join("triangles.vtu");
        write_cells(&triangles, &about, &points[..4], Cells::Triangles(&[[0, 1, 2], [3, 2, 1]]), &[]).unwrap();
        assert_eq!(FieldFile::open(&triangles).unwrap().triangles().unwrap(), [[0, 1, 2], [3, 2, 1]]);
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
        let cut = FieldFile::open(&path).unwrap();
        assert!(cut.values("density").is_none());
        std::fs::write(&path, "no field").unwrap();
        assert!(FieldFile::open(&path).is_err() && FieldFile::open(&folder.path().join("nothing")).is_err());
    }
}
