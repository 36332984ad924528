//! Field and surface files for ParaView and everything else that reads VTK XML.
//!
//! `.vtu` holds particles (one vertex cell each) or any one kind of linear cell, `.vtp` holds a surface, `.pvd` lists the
//! files of a series with their times. Arrays stand behind the XML in an appended block: little-endian, cut into pieces
//! of `BLOCK` bytes, each compressed with zlib. Per array the block starts with four-word bookkeeping of 64 bits
//! (number of pieces, size of a piece, size of a shorter last piece, compressed sizes). Format: VTK User's Guide, "VTK
//! File Formats", XML formats, compressed appended data.
//!
//! Vectors of two components are padded with a zero, for VTK draws arrows of three components only.
//!
//! What is true of the whole file stands before its points as field data: conditions of the case by name and unit, and the unit of
//! every array, which each array carries as well (`UNITS_LABEL` of VTK).
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::columns::{Scale, unit_of_array};
use super::table::{FileError, write_atomic};

/// Bytes of an array that are compressed together; readers unpack piece by piece.
const BLOCK: usize = 1 << 18;

/// Values at every point (or every cell), `components` after one another.
#[derive(Clone, Copy, Debug)]
pub struct Column<'a> {
    /// Name shown to the user.
    pub name: &'a str,
    /// Numbers per point: 1 for a scalar, 2 or 3 for a vector.
    pub components: usize,
    /// The numbers, point after point.
    pub values: &'a [f64],
}

/// What a file tells of its case besides its arrays.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// Units of the case, by which the unit of each array is told; none are told without.
    pub scale: Option<Scale>,
    /// Conditions of the case: name with unit, and value.
    pub numbers: Vec<(String, f64)>,
    /// Texts, by name.
    pub words: Vec<(&'static str, String)>,
    /// Array that a viewer colours by first, where the file has it.
    pub scalars: &'static str,
    /// Array that a viewer takes for arrows and streamlines first, where the file has it.
    pub vectors: &'static str,
}

/// What ties points together in a `.vtu` file.
#[derive(Clone, Copy, Debug)]
pub enum Cells<'a> {
    /// One vertex per point.
    Vertices,
    /// Segments.
    Lines(&'a [[u32; 2]]),
    /// Triangles.
    Triangles(&'a [[u32; 3]]),
    /// Tetrahedra, the last corner on the left of the first three.
    Tetrahedra(&'a [[u32; 4]]),
    /// Quadrangles, corners in order around the border.
    Quads(&'a [[u32; 4]]),
    /// Axis-aligned boxes, corners with x fastest, then y, then z.
    Voxels(&'a [[u32; 8]]),
}

/// What ties points together in a `.vtp` file.
#[derive(Clone, Copy, Debug)]
pub enum Facets<'a> {
    /// One vertex per point: a surface of particles.
    Vertices,
    /// Chains of points: sections of a 2-D body; repeat the first point to close one.
    Polylines(&'a [Vec<u32>]),
    /// Triangles.
    Triangles(&'a [[u32; 3]]),
}

/// What can go wrong with a field file.
#[derive(Debug, thiserror::Error)]
pub enum VtkError {
    /// The operating system refused.
    #[error(transparent)]
    File(#[from] FileError),
    /// A column that does not match the points.
    #[error("column `{name}` has {found} values; {items} items of {components} components need {}", items * components)]
    Column {
        /// Name of the column.
        name: String,
        /// Values in the column.
        found: usize,
        /// Points or cells.
        items: usize,
        /// Components per item.
        components: usize,
    },
    /// A cell that refers to a point that is not there.
    #[error("cell {cell} refers to point {point}, but there are only {points}")]
    Cell {
        /// Index of the cell.
        cell: usize,
        /// Point it refers to.
        point: u32,
        /// Number of points.
        points: usize,
    },
}

/// Writes points joined by cells as a `.vtu` file, with columns at the points.
pub fn write_cells(
    path: &Path,
    about: &About,
    points: &[[f64; 3]],
    cells: Cells,
    columns: &[Column],
) -> Result<(), VtkError> {
    let (kind, joined) = match cells {
        Cells::Vertices => (1_u8, Joined::vertices(points.len())),
        Cells::Lines(cells) => (3, Joined::of(cells.iter().map(|c| &c[..]))),
        Cells::Triangles(cells) => (5, Joined::of(cells.iter().map(|c| &c[..]))),
        Cells::Tetrahedra(cells) => (10, Joined::of(cells.iter().map(|c| &c[..]))),
        Cells::Quads(cells) => (9, Joined::of(cells.iter().map(|c| &c[..]))),
        Cells::Voxels(cells) => (11, Joined::of(cells.iter().map(|c| &c[..]))),
    };
    joined.check(points.len())?;
    let mut file = Document::new("UnstructuredGrid");
    file.field_data(about, columns);
    let n_cells = joined.ends.len();
    let _ = writeln!(file.xml, r#"<Piece NumberOfPoints="{}" NumberOfCells="{n_cells}">"#, points.len());
    file.points(points);
    file.columns(about, points.len(), columns)?;
    file.xml.push_str("<Cells>\n");
    file.joined(&joined);
    file.array("types", "UInt8", 1, vec![kind; n_cells]);
    file.xml.push_str("</Cells>\n</Piece>\n</UnstructuredGrid>\n");
    file.write(path)
}

/// Writes a surface as a `.vtp` file, with columns at the points.
pub fn write_surface(
    path: &Path,
    about: &About,
    points: &[[f64; 3]],
    facets: Facets,
    columns: &[Column],
) -> Result<(), VtkError> {
    let (section, joined) = match facets {
        Facets::Vertices => ("Verts", Joined::vertices(points.len())),
        Facets::Polylines(chains) => ("Lines", Joined::of(chains.iter().map(|c| &c[..]))),
        Facets::Triangles(triangles) => ("Polys", Joined::of(triangles.iter().map(|c| &c[..]))),
    };
    joined.check(points.len())?;
    let mut file = Document::new("PolyData");
    file.field_data(about, columns);
    let count = |name: &str| if name == section { joined.ends.len() } else { 0 };
    let _ = writeln!(
        file.xml,
        r#"<Piece NumberOfPoints="{}" NumberOfVerts="{}" NumberOfLines="{}" NumberOfStrips="0" NumberOfPolys="{}">"#,
        points.len(),
        count("Verts"),
        count("Lines"),
        count("Polys")
    );
    file.points(points);
    file.columns(about, points.len(), columns)?;
    let _ = writeln!(file.xml, "<{section}>");
    file.joined(&joined);
    let _ = writeln!(file.xml, "</{section}>\n</Piece>\n</PolyData>");
    file.write(path)
}

/// Writes a `.pvd` file: the times of a series and the file of each, relative to the `.pvd` file.
pub fn write_collection(path: &Path, files: &[(f64, &str)]) -> Result<(), VtkError> {
    let mut xml =
        String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n");
    for (time, file) in files {
        let _ = writeln!(xml, r#"<DataSet timestep="{time}" part="0" file="{}"/>"#, escape(file));
    }
    xml.push_str("</Collection>\n</VTKFile>\n");
    Ok(write_atomic(path, |w| w.write_all(xml.as_bytes()))?)
}

/// Times and files of a `.pvd` file that [`write_collection`] wrote.
pub fn read_collection(text: &str) -> Vec<(f64, String)> {
    let entry = |line: &str| {
        let (time, rest) = line.strip_prefix("<DataSet timestep=\"")?.split_once('"')?;
        let file = rest.split_once("file=\"")?.1.split_once('"')?.0;
        Some((time.parse().ok()?, file.to_owned()))
    };
    text.lines().filter_map(entry).collect()
}

/// Cells of any kind: points of all cells one after another, and where each cell ends.
struct Joined {
    connectivity: Vec<u32>,
    ends: Vec<u64>,
}

impl Joined {
    fn vertices(n_points: usize) -> Self {
        Self { connectivity: (0..n_points).map(|i| i as u32).collect(), ends: (1..=n_points as u64).collect() }
    }

    fn of<'a>(cells: impl Iterator<Item = &'a [u32]>) -> Self {
        let mut joined = Self { connectivity: Vec::new(), ends: Vec::new() };
        for cell in cells {
            joined.connectivity.extend_from_slice(cell);
            joined.ends.push(joined.connectivity.len() as u64);
        }
        joined
    }

    fn check(&self, points: usize) -> Result<(), VtkError> {
        match self.connectivity.iter().position(|point| *point as usize >= points) {
            None => Ok(()),
            Some(at) => {
                let cell = self.ends.partition_point(|end| *end <= at as u64);
                Err(VtkError::Cell { cell, point: self.connectivity[at], points })
            }
        }
    }
}

/// A VTK file in the making: the XML, and the arrays that will stand behind it.
struct Document {
    xml: String,
    arrays: Vec<Vec<u8>>,
    offset: u64,
}

impl Document {
    fn new(kind: &str) -> Self {
        let xml = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<{kind}>\n"
        );
        Self { xml, arrays: Vec::new(), offset: 0 }
    }

    /// Conditions, texts and units, as ASCII: they are few, and people look for them in the file too.
    fn field_data(&mut self, about: &About, columns: &[Column]) {
        let unit = |c: &Column| Some(format!("{} [{}]", c.name, unit_of_array(c.name, about.scale?)?));
        let units: Vec<String> = columns.iter().filter_map(unit).collect();
        self.xml.push_str("<FieldData>\n");
        for (name, value) in about.numbers.iter().filter(|(_, value)| value.is_finite()) {
            let name = escape(name);
            let _ = writeln!(
                self.xml,
                r#"<DataArray type="Float64" Name="{name}" NumberOfTuples="1" format="ascii">{value:?}</DataArray>"#
            );
        }
        for (name, text) in &about.words {
            self.texts(name, std::slice::from_ref(text));
        }
        if !units.is_empty() {
            self.texts("units", &units);
        }
        self.xml.push_str("</FieldData>\n");
    }

    /// Texts as VTK writes them: their bytes as numbers, each text with a zero behind it.
    fn texts(&mut self, name: &str, all: &[String]) {
        let bytes = all.iter().flat_map(|text| text.bytes().filter(|b| *b != 0).chain([0]));
        let bytes = bytes.map(|b| b.to_string()).collect::<Vec<_>>().join(" ");
        let (name, n) = (escape(name), all.len());
        let _ = writeln!(
            self.xml,
            r#"<Array type="String" Name="{name}" NumberOfTuples="{n}" format="ascii">{bytes}</Array>"#
        );
    }

    fn points(&mut self, points: &[[f64; 3]]) {
        self.xml.push_str("<Points>\n");
        self.array("Points", "Float64", 3, points.iter().flatten().flat_map(|x| x.to_le_bytes()).collect());
        self.xml.push_str("</Points>\n");
    }

    fn joined(&mut self, cells: &Joined) {
        let connectivity = cells.connectivity.iter().flat_map(|i| i64::from(*i).to_le_bytes()).collect();
        self.array("connectivity", "Int64", 1, connectivity);
        self.array("offsets", "Int64", 1, cells.ends.iter().flat_map(|i| i.to_le_bytes()).collect());
    }

    /// The arrays at the points, and which of them are seen first.
    fn columns(&mut self, about: &About, items: usize, columns: &[Column]) -> Result<(), VtkError> {
        let first = |kind: &str, name: &str| match columns.iter().any(|c| c.name == name) {
            true => format!(" {kind}=\"{}\"", escape(name)),
            false => String::new(),
        };
        let seen = first("Scalars", about.scalars) + &first("Vectors", about.vectors);
        let _ = writeln!(self.xml, "<PointData{seen}>");
        for column in columns {
            let Column { name, components, values } = *column;
            if components == 0 || items.checked_mul(components) != Some(values.len()) {
                return Err(VtkError::Column { name: name.to_owned(), found: values.len(), items, components });
            }
            let padding: &[f64] = if components == 2 { &[0.0] } else { &[] };
            let bytes = values.chunks(components).flat_map(|v| v.iter().chain(padding)).flat_map(|v| v.to_le_bytes());
            let unit = about.scale.and_then(|scale| unit_of_array(name, scale));
            self.array_with_unit((name, unit), "Float64", components + padding.len(), bytes.collect());
        }
        self.xml.push_str("</PointData>\n");
        Ok(())
    }

    fn array(&mut self, name: &str, kind: &str, components: usize, bytes: Vec<u8>) {
        self.array_with_unit((name, None), kind, components, bytes);
    }

    fn array_with_unit(&mut self, (name, unit): (&str, Option<&str>), kind: &str, components: usize, bytes: Vec<u8>) {
        // on one line with the array, as readers of lines want it
        let key =
            |unit| format!(r#"<InformationKey name="UNITS_LABEL" location="vtkDataArray">{unit}</InformationKey>"#);
        let _ = writeln!(
            self.xml,
            r#"<DataArray type="{kind}" Name="{}" NumberOfComponents="{components}" format="appended" offset="{}">{}</DataArray>"#,
            escape(name),
            self.offset,
            unit.map(key).unwrap_or_default()
        );
        let packed = pack(&bytes);
        self.offset += packed.len() as u64;
        self.arrays.push(packed);
    }

    fn write(self, path: &Path) -> Result<(), VtkError> {
        let write = |w: &mut dyn Write| -> io::Result<()> {
            w.write_all(self.xml.as_bytes())?;
            w.write_all(b"<AppendedData encoding=\"raw\">\n_")?;
            self.arrays.iter().try_for_each(|array| w.write_all(array))?;
            w.write_all(b"\n</AppendedData>\n</VTKFile>\n")
        };
        Ok(write_atomic(path, write)?)
    }
}

/// An array as the compressed appended block of VTK: bookkeeping, then the pieces.
fn pack(bytes: &[u8]) -> Vec<u8> {
    let pieces: Vec<Vec<u8>> = bytes.chunks(BLOCK).map(deflate).collect();
    let mut words = vec![pieces.len() as u64, BLOCK as u64, (bytes.len() % BLOCK) as u64];
    words.extend(pieces.iter().map(|piece| piece.len() as u64));
    let mut packed: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    pieces.iter().for_each(|piece| packed.extend(piece));
    packed
}

fn deflate(piece: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    // Writing to memory has no way to fail; an empty piece would be refused by the reader, not misread.
    if encoder.write_all(piece).is_err() {
        return Vec::new();
    }
    encoder.finish().unwrap_or_default()
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    fn bare() -> About {
        About::default()
    }

    const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

    /// The values of an array of 64-bit words, by its name.
    fn words(bytes: &[u8], name: &str) -> Vec<u64> {
        let marker = b"<AppendedData encoding=\"raw\">\n_";
        let start = bytes.windows(marker.len()).position(|w| w == marker).unwrap();
        let xml = std::str::from_utf8(&bytes[..start]).unwrap();
        let line = xml.lines().find(|line| line.contains(&format!("Name=\"{name}\""))).unwrap();
        let offset = line.split("offset=\"").nth(1).unwrap().split('"').next().unwrap();
        let data = &bytes[start + marker.len() + offset.parse::<usize>().unwrap()..];
        let word = |k: usize| u64::from_le_bytes(data[8 * k..8 * k + 8].try_into().unwrap());
        let pieces = word(0) as usize;
        let mut at = 8 * (3 + pieces);
        let mut raw = Vec::new();
        for k in 0..pieces {
            let end = at + word(3 + k) as usize;
            flate2::read::ZlibDecoder::new(&data[at..end]).read_to_end(&mut raw).unwrap();
            at = end;
        }
        raw.as_chunks().0.iter().map(|b| u64::from_le_bytes(*b)).collect()
    }

    #[test]
    fn fields_come_back_through_the_compressed_block() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("field.vtu");
        let points: Vec<[f64; 3]> = (0..40_000).map(|i| [f64::from(i), 0.5, 0.0]).collect();
        let velocity: Vec<f64> = (0..80_000).map(f64::from).collect();
        let columns = [Column { name: "u & v", components: 2, values: &velocity }];
        write_cells(&path, &bare(), &points, Cells::Vertices, &columns).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let back = words(&bytes, "u &amp; v");
        assert_eq!(back.len(), 120_000, "several pieces, padded to three components");
        assert_eq!(f64::from_bits(back[3 * 777 + 1]), velocity[2 * 777 + 1]);
        assert_eq!(f64::from_bits(words(&bytes, "Points")[3 * 777]), 777.0);
        assert_eq!(words(&bytes, "offsets")[39_999], 40_000);
    }

    #[test]
    fn surfaces_and_series_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("surface.vtp");
        let cp = Column { name: "cp", components: 1, values: &[0.0, 1.0, 2.0, 3.0] };
        let chain = vec![vec![0, 1, 2, 3, 0]];
        write_surface(&path, &bare(), &SQUARE, Facets::Polylines(&chain), &[cp]).unwrap();
        assert_eq!(words(&std::fs::read(&path).unwrap(), "connectivity"), [0, 1, 2, 3, 0]);
        let series = folder.path().join("field.pvd");
        write_collection(&series, &[(0.0, "field_0.vtu"), (0.5, "field_1.vtu")]).unwrap();
        assert!(std::fs::read_to_string(&series).unwrap().contains(r#"timestep="0.5" part="0" file="field_1.vtu""#));
        let read = read_collection(&std::fs::read_to_string(&series).unwrap());
        assert_eq!(read, [(0.0, "field_0.vtu".to_owned()), (0.5, "field_1.vtu".to_owned())]);
    }

    fn told() -> About {
        About {
            scale: Some(Scale { dimensional: true, dimension: 2 }),
            numbers: vec![("alpha [deg]".into(), 1.25), ("Reynolds number".into(), f64::NAN)],
            words: vec![("title", "α & <b>".into())],
            scalars: "pressure",
            vectors: "velocity",
        }
    }

    #[test]
    fn conditions_units_and_what_is_seen_first_stand_in_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("field.vtu");
        let pressure = Column { name: "pressure", components: 1, values: &[1.0; 4] };
        let other = Column { name: "what nobody knows", components: 1, values: &[2.0; 4] };
        write_cells(&path, &told(), &SQUARE, Cells::Vertices, &[pressure, other]).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("<PointData Scalars=\"pressure\">"), "no array called velocity");
        assert!(text.contains("Name=\"alpha [deg]\" NumberOfTuples=\"1\" format=\"ascii\">1.25<"));
        assert!(!text.contains("Reynolds"), "what is not a number is not told");
        let codes = |text: &str| text.bytes().map(|b| b.to_string()).collect::<Vec<_>>().join(" ");
        assert!(text.contains(&format!(">{} 0</Array>", codes("α & <b>"))));
        assert!(text.contains(&format!("NumberOfTuples=\"1\" format=\"ascii\">{} 0</Array>", codes("pressure [Pa]"))));
        assert_eq!(text.matches(">Pa</InformationKey>").count(), 1);
        assert_eq!(words(&bytes, "pressure")[3], 1.0f64.to_bits());
    }

    #[test]
    fn mismatched_columns_and_cells_are_refused() {
        let path = Path::new("never-written.vtu");
        let short = Column { name: "cp", components: 1, values: &[0.0] };
        let message = write_cells(path, &bare(), &SQUARE, Cells::Vertices, &[short]).unwrap_err().to_string();
        assert_eq!(message, "column `cp` has 1 values; 4 items of 1 components need 4");
        let cells = [[0, 1, 2], [0, 2, 4]];
        let message = write_cells(path, &bare(), &SQUARE, Cells::Triangles(&cells), &[]).unwrap_err().to_string();
        assert_eq!(message, "cell 1 refers to point 4, but there are only 4");
        assert!(!path.exists());
    }

    /// Files for `tests/read_vtk.py`, in the folder named by `ALULA_VTK_OUT`; nothing happens without it.
    #[test]
    fn files_for_the_real_vtk() {
        let Some(folder) = std::env::var_os("ALULA_VTK_OUT") else { return };
        let (folder, about) = (Path::new(&folder), told());
        let values: Vec<f64> = (0..50_000).map(|i| (f64::from(i) * 0.01).sin()).collect();
        let points: Vec<[f64; 3]> = (0..50_000).map(|i| [f64::from(i), f64::from(i % 7), 0.0]).collect();
        let columns = [
            Column { name: "pressure", components: 1, values: &values },
            Column { name: "velocity", components: 2, values: &[values.clone(), values.clone()].concat() },
        ];
        write_cells(&folder.join("points.vtu"), &bare(), &points, Cells::Vertices, &columns).unwrap();
        write_cells(&folder.join("empty.vtu"), &bare(), &[], Cells::Vertices, &[]).unwrap();
        let cp = Column { name: "cp", components: 1, values: &[0.0, 1.0, f64::NAN, 3.0] };
        write_cells(&folder.join("quads.vtu"), &about, &SQUARE, Cells::Quads(&[[0, 1, 2, 3]]), &[cp]).unwrap();
        write_cells(&folder.join("lines.vtu"), &about, &SQUARE, Cells::Lines(&[[0, 1], [1, 2]]), &[cp]).unwrap();
        let cube: Vec<[f64; 3]> = (0..8).map(|k| [f64::from(k % 2), f64::from(k / 2 % 2), f64::from(k / 4)]).collect();
        write_cells(&folder.join("tetrahedra.vtu"), &about, &cube, Cells::Tetrahedra(&[[0, 1, 2, 4]]), &[]).unwrap();
        write_cells(&folder.join("voxels.vtu"), &about, &cube, Cells::Voxels(&[[0, 1, 2, 3, 4, 5, 6, 7]]), &[])
            .unwrap();
        let chain = [vec![0, 1, 2, 3, 0]];
        write_surface(&folder.join("chain.vtp"), &about, &SQUARE, Facets::Polylines(&chain), &[cp]).unwrap();
        let triangles = Facets::Triangles(&[[0, 1, 2], [0, 2, 3]]);
        write_surface(&folder.join("triangles.vtp"), &about, &SQUARE, triangles, &[cp]).unwrap();
        write_surface(&folder.join("vertices.vtp"), &about, &SQUARE, Facets::Vertices, &[cp]).unwrap();
        write_collection(&folder.join("series.pvd"), &[(0.0, "points.vtu")]).unwrap();
    }
}
