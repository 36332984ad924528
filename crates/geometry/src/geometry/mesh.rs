//! Triangle files: STL (binary and text), OBJ and PLY.
//!
//! Each format yields a triangle soup with names of parts, from which [`super::repair`] makes a surface. Deviations
//! from the format that have only one interpretation are accepted and reported; damaged data are rejected with the
//! line, or the number of the triangle.
mod obj;
mod ply;
mod stl;

use super::GeometryError;
use super::parts::UNNAMED;
use crate::case::decimal_comma;
use crate::math::Vector;
use std::io::Read;

/// Greatest size of a file in bytes: 80 million triangles.
pub(super) const LONGEST: u64 = 4 << 30;

/// Triangles as given in a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Soup {
    pub(super) triangles: Vec<[Vector<3>; 3]>,
    /// Index into `names` for every triangle.
    pub(super) tags: Vec<u16>,
    /// Names of the solids or groups.
    pub(super) names: Vec<String>,
}

impl Soup {
    /// Sets `name` as the part of the following triangles.
    fn begin(&mut self, name: &str) -> u16 {
        let name = if name.is_empty() { UNNAMED } else { name };
        let found = self.names.iter().position(|n| n == name).unwrap_or_else(|| {
            self.names.push(name.to_string());
            self.names.len() - 1
        });
        found.min(usize::from(u16::MAX)) as u16
    }

    fn push(&mut self, triangle: [Vector<3>; 3], tag: u16) {
        self.triangles.push(triangle);
        self.tags.push(tag);
    }
}

/// Reads a surface file, whose extension defines the format; assumptions are appended to `notes`. Fails when the data
/// are damaged.
pub(super) fn read(file: &str, input: impl Read, notes: &mut Vec<String>) -> Result<Soup, GeometryError> {
    let mut bytes = Vec::new();
    let length = input.take(LONGEST).read_to_end(&mut bytes);
    length.map_err(|source| GeometryError::Open { file: file.to_string(), source })?;
    let name = file.to_lowercase();
    let soup = if name.ends_with(".stl") {
        stl::read(file, &bytes, notes)?
    } else if name.ends_with(".obj") {
        obj::read(file, &super::plain(file, &bytes)?, notes)?
    } else if name.ends_with(".ply") {
        ply::read(file, &bytes, notes)?
    } else {
        let hint = "export the surface as STL, OBJ or PLY";
        return Err(GeometryError::refused(file, "is neither `.stl` nor `.obj` nor `.ply`", hint));
    };
    if soup.triangles.is_empty() {
        return Err(GeometryError::refused(file, "holds no triangles", "check the export"));
    }
    Ok(soup)
}

/// Message about a line that is not `what` it should be.
fn no_point(line: &str, what: &str) -> String {
    match decimal_comma(line) {
        Some(word) => format!("`{word}` has a decimal comma"),
        None => format!("`{}` is not {what}", line.trim()),
    }
}

/// A point of three numbers; magnitudes above 1e100 would overflow when squared.
fn point(words: &[&str]) -> Option<Vector<3>> {
    let value = |w: &&str| w.parse::<f64>().ok().filter(|v| v.abs() < 1e100);
    let values: Vec<f64> = words.iter().map_while(value).collect();
    match (words.len(), &values[..]) {
        (3, &[x, y, z]) => Some(Vector([x, y, z])),
        _ => None,
    }
}

/// Rejects a corner of a triangle (numbered from one) that is not a finite point.
fn finite(file: &str, triangle: usize, corner: &Vector<3>) -> Result<(), GeometryError> {
    if corner.is_finite() && corner.max_abs() < 1e100 {
        return Ok(());
    }
    let what = format!("triangle {triangle} has the corner {:?}, not a finite point", corner.0);
    Err(GeometryError::refused(file, what, "export the file again"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0.0 0.0 0.0\nvertex 1.5 0.0 0.0\nvertex 0.0 1.0 0.0\n\
                       endloop\nendfacet\nendsolid a\n";
    const OBJ: &str = "v 0.0 0.0 0.0\nv 1.5 0.0 0.0\nv 0.0 1.0 0.0\nf 1 2 3\n";
    const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n\
                       element face 1\nproperty list uchar int vertex_indices\nend_header\n0.0 0.0 0.0\n1.5 0.0 0.0\n0.0 1.0 0.0\n3 0 1 2\n";

    fn soup(file: &str, bytes: &[u8]) -> Result<(Soup, Vec<String>), String> {
        let mut notes = Vec::new();
        read(file, bytes, &mut notes).map(|soup| (soup, notes)).map_err(|e| e.to_string())
    }

    fn triangle() -> Vec<[Vector<3>; 3]> {
        vec![[[0.0; 3], [1.5, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector)]
    }

    #[test]
    fn surface_files_are_read_however_they_are_saved() {
        let wide = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
        for (file, text) in [("a.stl", STL), ("a.obj", OBJ), ("a.ply", PLY)] {
            let marked = [vec![0xff, 0xfe], wide(text)].concat();
            let mut saved = vec![text.as_bytes().to_vec(), text.replace('\n', "\r\n").into_bytes()];
            if file != "a.ply" {
                saved.extend([text.replace('\n', "\r").into_bytes(), wide(text), marked]);
            }
            for bytes in saved {
                assert_eq!(soup(file, &bytes).unwrap().0.triangles, triangle(), "{file}");
            }
        }
    }

    #[test]
    fn decimal_commas_are_named() {
        for (file, text, line) in [("a.stl", STL, 5), ("a.obj", OBJ, 2), ("a.ply", PLY, 11)] {
            let told = soup(file, text.replace("1.5", "1,5").as_bytes()).unwrap_err();
            assert!(told.contains(&format!("{file}, line {line}: `1,5` has a decimal comma")), "{told}");
        }
    }

    /// The triangle as a binary file with these words in its header, which says that there are `count`.
    fn binary(header: &[u8], count: u32) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, 0);
        bytes.extend(count.to_le_bytes());
        bytes.extend([0; 12]);
        bytes.extend(triangle()[0].iter().flat_map(|x| x.0).flat_map(|v| (v as f32).to_le_bytes()));
        bytes.extend([0, 0]);
        bytes
    }

    #[test]
    fn stl_files_that_differ_from_the_format_are_read_and_told() {
        let more = |tail: &[u8]| [&binary(b"solid cube", 1)[..], tail].concat();
        for (bytes, told) in [
            (binary(b"solid cube", 1), None),
            (more(b"\n"), Some("1 byte after the last triangle is left out")),
            (more(b"some more"), Some("9 bytes after")),
            (binary(b"exported", 0), Some("announces 0 triangles, but 1 follow")),
            (binary(b"exported", 1)[1..].to_vec(), Some("the header has 79 bytes where the format has 80")),
            ([b"e", &binary(b"exported", 1)[..]].concat(), Some("the header has 81 bytes where the format has 80")),
            (STL.replace("endsolid", "end solid").into_bytes(), None),
            (STL.replace("endloop\nendfacet", "end loop\nend facet").to_uppercase().into_bytes(), None),
            (STL.replace("endloop\n", "").replace("outer loop\n", "").into_bytes(), None),
            (STL.replace('\n', " ").replacen("solid a ", "solid a\n", 1).into_bytes(), None),
            (format!("# exported\n\n{STL}").into_bytes(), None),
            (STL.replacen("solid a\n", "", 1).into_bytes(), None),
            (STL.replace("normal 0 0 1", "normal nan nan nan").into_bytes(), None),
            (STL.replace("endfacet\n", "endfacet\ncolor 1 0 0\n").into_bytes(), None),
        ] {
            let (soup, notes) = soup("a.stl", &bytes).unwrap_or_else(|e| panic!("{e} {told:?}"));
            assert_eq!(soup.triangles, triangle());
            assert!(
                notes.len() == usize::from(told.is_some()) && notes.iter().all(|n| n.contains(told.unwrap_or(""))),
                "{notes:?}"
            );
        }
    }

    #[test]
    fn damaged_stl_files_are_refused_with_their_place() {
        let mut bad = binary(b"", 1);
        bad[84 + 12 + 4..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
        let cut = &binary(b"solid", 2)[..130];
        for (bytes, told) in [
            (&bad[..], "triangle 1 has the corner"),
            (cut, "announces 2 triangles, 184 bytes, but holds 130 bytes: it is cut short in triangle 1"),
            (STL.replace("1.5 0.0 0.0", "1.5 0.0").as_bytes(), "line 5: `vertex 1.5 0.0` is not a vertex"),
            (STL.replace("1.5 0.0 0.0", "1.5 0.0 0.0 7").as_bytes(), "line 5: `7` is not a word of an STL file"),
            (STL.replace("vertex 1.5 0.0 0.0\n", "").as_bytes(), "line 7: the facet has 2 vertices"),
            (
                STL.replace("endfacet\n", "").replace("solid a", &format!("solid a\n{}", &STL[8..])).as_bytes(),
                "a facet begins inside another",
            ),
            (STL.replace("facet normal", "faced normal").as_bytes(), "line 2: `faced` is not a word of an STL file"),
            (STL.replace("endfacet\nendsolid a\n", "").as_bytes(), "line 7: ends inside a facet"),
        ] {
            let found = soup("a.stl", bytes).unwrap_err();
            assert!(found.contains(told), "{told}: {found}");
        }
    }

    #[test]
    fn obj_files_of_all_programs_are_read() {
        for (text, notes) in [
            (OBJ.replace("f 1 2 3", "usemtl \nf 1 2 3"), 0),
            (OBJ.replace("f 1 2 3", "vt 0 0\nvn 0 0 1\ns off\no part\nf 1/1 2/1 3/1"), 0),
            (OBJ.replace("f 1 2 3", "vn 0 0 1\nf 1//1 2//1 3//1"), 0),
            (OBJ.replace("f 1 2 3", "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1"), 0),
            (OBJ.replace("f 1 2 3", "f -3 -2 \\\n -1"), 0),
            (OBJ.replace("1.5 0.0 0.0", "1.5 0.0 0.0 1.0"), 0),
            (OBJ.replace("1.5 0.0 0.0", "1.5 0.0 0.0 0.5 0.5 0.5 # grey"), 0),
            (OBJ.replace("v ", "v\t  ").to_uppercase(), 0),
            (format!("f 1 2 3\n{}", OBJ.replace("f 1 2 3\n", "p 1\nl 1 2\n")), 0),
            (format!("{OBJ}f 1 2\nwhatever 3\n"), 2),
        ] {
            let (soup, told) = soup("a.obj", text.as_bytes()).unwrap_or_else(|e| panic!("{e}\n{text}"));
            assert_eq!((soup.triangles, told.len()), (triangle(), notes), "{text} {told:?}");
        }
        let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
        assert_eq!(soup("a.obj", format!("{square}f 1 2 3 4").as_bytes()).unwrap().0.triangles.len(), 2);
        let names = soup("a.obj", format!("{square}g a b\nf 1 2 3\ng\nf 1 3 4").as_bytes()).unwrap().0.names;
        assert_eq!(names, ["a b", UNNAMED]);
    }

    #[test]
    fn damaged_obj_files_are_refused_with_their_line() {
        for (text, told) in [
            (OBJ.replace("f 1 2 3", "f 1 2 4"), "line 4: vertex 4 of a face is not there: the file has 3"),
            (OBJ.replace("f 1 2 3", "f -4 2 3"), "line 4: vertex -4 of a face is not there"),
            (OBJ.replace("f 1 2 3", "f 0 1 2"), "line 4: `0` is not the number of a vertex"),
            (OBJ.replace("f 1 2 3", "f 1 2 x"), "line 4: `x` is not the number of a vertex"),
            (OBJ.replace("v 1.5 0.0 0.0", "v 1.5 0.0"), "line 2: `v 1.5 0.0` is not a vertex"),
            (OBJ.replace("v 1.5 0.0 0.0", "v 1.5 nan 0.0"), "line 2: `v 1.5 nan 0.0` is not a vertex"),
        ] {
            let found = soup("a.obj", text.as_bytes()).unwrap_err();
            assert!(found.contains(told), "{told}: {found}");
        }
    }

    #[test]
    fn ply_files_are_read_in_all_their_forms() {
        let header = |kind: &str| {
            let end = PLY.find("end_header\n").unwrap() + 11;
            PLY[..end].replace("ascii", kind).replacen(
                "property double z\n",
                "property float z\nproperty uchar red\n",
                1,
            )
        };
        let body = |f64s: fn(f64) -> [u8; 8], f32s: fn(f32) -> [u8; 4], i32s: fn(i32) -> [u8; 4]| {
            let point = |x: &Vector<3>| [&f64s(x[0])[..], &f64s(x[1]), &f32s(x[2] as f32), &[200]].concat();
            let points: Vec<u8> = triangle()[0].iter().flat_map(point).collect();
            [points, vec![3], [0, 1, 2].map(i32s).concat()].concat()
        };
        let little =
            [header("binary_little_endian").as_bytes(), &body(f64::to_le_bytes, f32::to_le_bytes, i32::to_le_bytes)]
                .concat();
        let big = [header("binary_big_endian").as_bytes(), &body(f64::to_be_bytes, f32::to_be_bytes, i32::to_be_bytes)]
            .concat();
        for bytes in [little.clone(), big] {
            assert_eq!(soup("a.ply", &bytes).unwrap().0.triangles, triangle());
        }
        // faces before vertices, and more than is announced
        let (vertices, face) = (PLY.find("element v").unwrap(), PLY.find("element f").unwrap());
        let (end, rows) = (PLY.find("end_header").unwrap(), PLY.find("3 0 1 2").unwrap());
        let numbers = end + "end_header\n".len();
        let parts = [0..vertices, face..end, vertices..face, end..numbers, rows..PLY.len(), numbers..rows];
        let swapped: String = parts.map(|part| &PLY[part]).concat();
        let (found, notes) = soup("a.ply", swapped.as_bytes()).unwrap();
        assert!(found.triangles == triangle() && notes.is_empty(), "{swapped} {notes:?}");
        for (bytes, told) in [
            (format!("{PLY}\n3 0 1 2\n").into_bytes(), "a.ply: line 15 and what follows is left out"),
            ([&little[..], b"more"].concat(), "a.ply: 4 bytes after the last element are left out"),
        ] {
            let (soup, notes) = soup("a.ply", &bytes).unwrap();
            assert!(soup.triangles == triangle() && notes.len() == 1 && notes[0].contains(told), "{notes:?}");
        }
        let told = |bytes: &[u8]| soup("a.ply", bytes).unwrap_err();
        assert!(told(&little[..little.len() - 1]).contains("face 1"), "{}", told(&little[..little.len() - 1]));
        assert!(
            told(PLY.replace("3 0 1 2", "3 0 1 3").as_bytes())
                .contains("line 13: vertex 3 of a face is not there: the file has 3")
        );
        assert!(told(PLY.replace("property double z\n", "").as_bytes()).contains("no property `z`"));
        assert!(told(b"solid a").contains("begins with `ply`"));
    }
}
