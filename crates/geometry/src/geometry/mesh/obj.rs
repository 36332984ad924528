//! OBJ files: vertices, faces and groups; what belongs to materials, textures and normals is passed over.
use super::{Soup, no_point, point};
use crate::geometry::GeometryError;
use crate::geometry::polygon;
use crate::math::Vector;

/// Words of the format that say nothing about faces.
const PASSED_OVER: [&str; 41] = [
    "vt",
    "vn",
    "vp",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "l",
    "p",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "bevel",
    "c_interp",
    "d_interp",
    "cstype",
    "deg",
    "bmat",
    "step",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "call",
    "csh",
    "bsp",
    "bzp",
    "cdc",
    "cdp",
    "res",
    "fo",
];

/// A face: its line, its part, and the numbers of its vertices, counted from one.
struct Face {
    line: usize,
    tag: u16,
    corners: Vec<usize>,
}

/// A file while it is read.
#[derive(Default)]
struct Reader {
    soup: Soup,
    vertices: Vec<Vector<3>>,
    faces: Vec<Face>,
    tag: u16,
    /// Lines of faces with less than three corners.
    too_few: Vec<usize>,
    /// Lines that begin with words of no meaning.
    unknown: Vec<usize>,
}

/// Reads the text of a file.
pub(super) fn read(file: &str, text: &str, notes: &mut Vec<String>) -> Result<Soup, GeometryError> {
    let mut reader = Reader::default();
    for (number, line) in lines(text) {
        let bad = |(what, hint): (String, &str)| GeometryError::refused(format!("{file}, line {number}"), what, hint);
        reader.line(number, &line).map_err(bad)?;
    }
    for (lines, what) in [
        (&reader.too_few, "faces have less than three corners and are left out"),
        (&reader.unknown, "lines begin with no word of an OBJ file and are left out"),
    ] {
        if let Some(first) = lines.first() {
            notes.push(format!("{file}: {} {what}, the first in line {first}", lines.len()));
        }
    }
    reader.triangles(file)
}

/// Lines without comments, those that end in `\` with the ones that continue them, with the number of the first.
fn lines(text: &str) -> impl Iterator<Item = (usize, String)> {
    let mut all = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (i, first) = all.next()?;
        let said = |line: &str| line.split('#').next().unwrap_or_default().trim_end().to_string();
        let mut line = said(first);
        while line.ends_with('\\') {
            line.pop();
            line.push(' ');
            line.push_str(&all.next().map(|(_, more)| said(more)).unwrap_or_default());
        }
        Some((i + 1, line))
    })
}

impl Reader {
    fn line(&mut self, number: usize, line: &str) -> Result<(), (String, &'static str)> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [first, rest @ ..] = &words[..] else { return Ok(()) };
        match first.to_ascii_lowercase().as_str() {
            // weights and colours may follow
            "v" => match rest.get(..3).and_then(point) {
                Some(vertex) => self.vertices.push(vertex),
                None => return Err((no_point(line, "a vertex"), "write `v x y z`, decimals with a point")),
            },
            "f" => {
                let corners = rest.iter().map(|word| self.corner(word)).collect::<Result<Vec<_>, _>>()?;
                if corners.len() < 3 {
                    self.too_few.push(number);
                } else {
                    self.faces.push(Face { line: number, tag: self.tag, corners });
                }
            }
            "g" | "o" => self.tag = self.begin(&rest.join(" ")),
            word if PASSED_OVER.contains(&word) => {}
            _ => self.unknown.push(number),
        }
        Ok(())
    }

    /// Begins a part; faces before the first one have no name.
    fn begin(&mut self, name: &str) -> u16 {
        if self.soup.names.is_empty() && !self.faces.is_empty() {
            self.soup.begin("");
        }
        self.soup.begin(name)
    }

    /// The number of the vertex of `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative ones count back from the last.
    fn corner(&self, word: &str) -> Result<usize, (String, &'static str)> {
        let number = word.split('/').next().unwrap_or_default();
        let count = self.vertices.len();
        match number.parse::<i64>() {
            Ok(k) if k > 0 => Ok(k as usize),
            Ok(k) if k < 0 => count.checked_add_signed(k as isize).map(|k| k + 1).ok_or_else(|| absent(k, count)),
            _ => Err((
                format!("`{word}` is not the number of a vertex"),
                "write faces as `f 1 2 3`, vertices counted from 1",
            )),
        }
    }

    /// The triangles of all faces, once all vertices are known.
    fn triangles(mut self, file: &str) -> Result<Soup, GeometryError> {
        let mut soup = std::mem::take(&mut self.soup);
        for face in &self.faces {
            let place = || format!("{file}, line {}", face.line);
            let vertex = |k: &usize| {
                let found = self.vertices.get(k - 1).copied();
                found.ok_or_else(|| absent(*k as i64, self.vertices.len()))
            };
            let corners: Result<Vec<Vector<3>>, _> = face.corners.iter().map(vertex).collect();
            let corners = corners.map_err(|(what, hint)| GeometryError::refused(place(), what, hint))?;
            let Some(triangles) = polygon::divided(&corners) else {
                let what = format!("a face of {} corners is neither convex nor flat", corners.len());
                return Err(GeometryError::refused(place(), what, "export triangles"));
            };
            triangles.iter().for_each(|t| soup.push(t.map(|k| corners[k]), face.tag));
        }
        Ok(soup)
    }
}

fn absent(number: i64, count: usize) -> (String, &'static str) {
    (format!("vertex {number} of a face is not there: the file has {count}"), "export the file again")
}
