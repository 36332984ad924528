//! Triangle files: STL (binary and text) and OBJ.
//!
//! Both give a soup of triangles with part names; [`super::repair`] makes a surface of it. Text STL is read here in
//! double precision, with all its solids and with line numbers in messages; binary STL goes through `stl_io`, OBJ through
//! `tobj`.
use super::GeometryError;
use super::parts::UNNAMED;
use crate::case::{decimal_comma, numbers_of};
use crate::math::Vector;
use std::io::{Cursor, Read};

/// Header and count of a binary STL file, bytes.
const STL_HEADER: usize = 84;
/// One triangle of a binary STL file, bytes.
const STL_TRIANGLE: usize = 50;
/// Bytes in which a text begins.
const BEGINNING: usize = 256;
/// Longest file that is read, bytes: 80 million triangles.
const LONGEST: u64 = 4 << 30;

/// Triangles as they stand in a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Soup {
    pub(super) triangles: Vec<[Vector<3>; 3]>,
    /// Index into `names` of every triangle.
    pub(super) tags: Vec<u16>,
    /// Names of the solids or groups.
    pub(super) names: Vec<String>,
}

impl Soup {
    /// Makes `name` the part of the triangles to come.
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

/// Reads a surface file; the end of the name tells the format.
pub(super) fn read(file: &str, input: impl Read) -> Result<Soup, GeometryError> {
    let mut bytes = Vec::new();
    let length = input.take(LONGEST).read_to_end(&mut bytes);
    length.map_err(|source| GeometryError::Open { file: file.to_string(), source })?;
    let name = file.to_lowercase();
    let soup = if name.ends_with(".stl") {
        read_stl(file, &mut bytes)?
    } else if name.ends_with(".obj") {
        read_obj(file, super::plain(file, &bytes)?.as_bytes())?
    } else {
        return Err(GeometryError::refused(file, "is neither `.stl` nor `.obj`", "export the surface as STL or OBJ"));
    };
    if soup.triangles.is_empty() {
        return Err(GeometryError::refused(file, "holds no triangles", "check the export"));
    }
    Ok(soup)
}

/// A file whose length is what a binary header says is binary, even when it begins with `solid`.
fn read_stl(file: &str, bytes: &mut [u8]) -> Result<Soup, GeometryError> {
    let count = bytes.get(80..STL_HEADER).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]]) as usize);
    let announced = count.map(|n| STL_HEADER + STL_TRIANGLE * n);
    let begins = numbers_of(&bytes[..bytes.len().min(BEGINNING)]).unwrap_or_default();
    let text = begins.trim_start().get(..5).is_some_and(|w| w.eq_ignore_ascii_case("solid"));
    match announced {
        Some(length) if length == bytes.len() || (!text && length < bytes.len()) => read_stl_binary(file, bytes),
        _ if text => read_stl_text(file, &super::plain(file, bytes)?),
        Some(length) => {
            let (n, held) = (count.unwrap_or(0), bytes.len());
            let what = format!("announces {n} triangles, {length} bytes, but holds {held} bytes: it is cut short");
            Err(GeometryError::refused(file, what, "copy or export the file again"))
        }
        None => {
            let what = format!("is no STL file: {} bytes, and a binary header alone has 84", bytes.len());
            Err(GeometryError::refused(file, what, "text STL begins with `solid`"))
        }
    }
}

fn read_stl_binary(file: &str, bytes: &mut [u8]) -> Result<Soup, GeometryError> {
    // The reader takes a header that begins with `solid` for text.
    bytes[..80].fill(0);
    let broken = |e: std::io::Error| GeometryError::refused(file, e.to_string(), "export the file again");
    let mut cursor = Cursor::new(bytes);
    let mut soup = Soup::default();
    for (i, triangle) in stl_io::create_stl_reader(&mut cursor).map_err(broken)?.enumerate() {
        let corners = triangle.map_err(broken)?.vertices.map(|v| Vector(v.0.map(f64::from)));
        if let Some(bad) = corners.iter().find(|c| !c.is_finite()) {
            let what = format!("triangle {} has the corner {:?}, not a finite point", i + 1, bad.0);
            return Err(GeometryError::refused(file, what, "export the file again"));
        }
        soup.push(corners, 0);
    }
    Ok(soup)
}

fn read_stl_text(file: &str, text: &str) -> Result<Soup, GeometryError> {
    let mut soup = Soup::default();
    let mut corners: Vec<Vector<3>> = Vec::new();
    let (mut tag, mut open) = (0, false);
    for (i, line) in text.lines().enumerate() {
        let refused =
            |what: String, hint: &str| Err(GeometryError::refused(format!("{file}, line {}", i + 1), what, hint));
        let words: Vec<&str> = line.split_whitespace().collect();
        let Some(first) = words.first() else { continue };
        match first.to_ascii_lowercase().as_str() {
            "solid" => tag = soup.begin(&words[1..].join(" ")),
            "facet" if open => return refused("a facet begins inside another".into(), "a line `endfacet` is missing"),
            "facet" => open = true,
            "vertex" if open => match vertex(&words[1..]) {
                Some(point) => corners.push(point),
                None => return refused(no_point(line, "a vertex"), "write `vertex x y z`, decimals with a point"),
            },
            "endfacet" => match corners[..] {
                [a, b, c] => {
                    soup.push([a, b, c], tag);
                    corners.clear();
                    open = false;
                }
                _ => return refused(format!("the facet has {} vertices", corners.len()), "triangles have 3"),
            },
            "outer" | "endloop" | "endsolid" => {}
            other => return refused(format!("`{other}` is not a word of an STL file"), "export the file again"),
        }
    }
    if open {
        return Err(GeometryError::refused(
            file,
            "ends inside a facet: it is cut short",
            "copy or export the file again",
        ));
    }
    Ok(soup)
}

/// Why a line is not `what` it should be.
fn no_point(line: &str, what: &str) -> String {
    match decimal_comma(line) {
        Some(word) => format!("`{word}` has a decimal comma"),
        None => format!("`{}` is not {what}", line.trim()),
    }
}

/// Three numbers; magnitudes above 1e100 would overflow when squared.
fn vertex(words: &[&str]) -> Option<Vector<3>> {
    let values: Vec<f64> = words.iter().filter_map(|w| w.parse().ok()).filter(|v: &f64| v.abs() < 1e100).collect();
    match (words.len(), &values[..]) {
        (3, &[x, y, z]) => Some(Vector([x, y, z])),
        _ => None,
    }
}

fn read_obj(file: &str, bytes: &[u8]) -> Result<Soup, GeometryError> {
    let models = match parse_obj(bytes) {
        Ok(models) => models,
        Err(error) => {
            let number = first_bad_line(bytes);
            let line = bytes.split(|b| *b == b'\n').nth(number - 1).map(String::from_utf8_lossy).unwrap_or_default();
            let place = format!("{file}, line {number}");
            if decimal_comma(&line).is_some() {
                return Err(GeometryError::refused(
                    place,
                    no_point(&line, "read"),
                    "write `v x y z`, decimals with a point",
                ));
            }
            return Err(GeometryError::refused(place, error.to_string(), "export the file again, as triangles"));
        }
    };
    let mut soup = Soup::default();
    for model in models {
        let tag = soup.begin(&model.name);
        let point = |i: &u32| {
            let first = 3 * *i as usize;
            model.mesh.positions.get(first..first + 3).map(|p| Vector([p[0], p[1], p[2]]))
        };
        for (i, corners) in model.mesh.indices.chunks_exact(3).enumerate() {
            let corners = [point(&corners[0]), point(&corners[1]), point(&corners[2])];
            let [Some(a), Some(b), Some(c)] = corners else { continue };
            if [a, b, c].iter().any(|p| p.max_abs() >= 1e100 || !p.is_finite()) {
                let what = format!("triangle {} of `{}` has a corner that is not a finite point", i + 1, model.name);
                return Err(GeometryError::refused(file, what, "export the file again"));
            }
            soup.push([a, b, c], tag);
        }
    }
    Ok(soup)
}

fn parse_obj(mut bytes: &[u8]) -> Result<Vec<tobj::Model>, tobj::LoadError> {
    let options =
        tobj::LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..Default::default() };
    // Materials are of no use here.
    tobj::load_obj_buf(&mut bytes, &options, |_| Ok(Default::default())).map(|(models, _)| models)
}

/// The first line with which reading fails, found by bisection: the reader's errors carry no place.
fn first_bad_line(bytes: &[u8]) -> usize {
    let ends: Vec<usize> = bytes
        .split_inclusive(|&b| b == b'\n')
        .scan(0, |end, line| {
            *end += line.len();
            Some(*end)
        })
        .collect();
    ends.partition_point(|&end| parse_obj(&bytes[..end]).is_ok()) + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0.0 0.0 0.0\nvertex 1.5 0.0 0.0\nvertex 0.0 1.0 0.0\n\
                       endloop\nendfacet\nendsolid a\n";
    const OBJ: &str = "v 0.0 0.0 0.0\nv 1.5 0.0 0.0\nv 0.0 1.0 0.0\nf 1 2 3\n";

    #[test]
    fn surface_files_are_read_however_they_are_saved() {
        let wide = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
        for (file, text) in [("a.stl", STL), ("a.obj", OBJ)] {
            let marked = [vec![0xff, 0xfe], wide(text)].concat();
            for bytes in
                [text.replace('\n', "\r").into_bytes(), text.replace('\n', "\r\n").into_bytes(), wide(text), marked]
            {
                let soup = read(file, &bytes[..]).unwrap();
                assert_eq!(soup.triangles, [[[0.0; 3], [1.5, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector)], "{file}");
            }
        }
    }

    #[test]
    fn decimal_commas_are_named() {
        for (file, text, line) in [("a.stl", STL, 5), ("a.obj", OBJ, 2)] {
            let told = read(file, text.replace("1.5", "1,5").as_bytes()).unwrap_err().to_string();
            assert!(told.contains(&format!("{file}, line {line}: `1,5` has a decimal comma")), "{told}");
        }
    }
}
