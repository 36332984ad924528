//! PLY files (Turk 1994), text and binary: the elements `vertex` and `face`; other elements and properties are passed over.
use super::{Soup, finite, no_point};
use crate::geometry::GeometryError;
use crate::geometry::polygon;
use crate::math::Vector;

/// A kind of number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Number {
    Int { bytes: usize, signed: bool },
    Float { bytes: usize },
}

/// What an element has: a number, or a list that its length goes before.
struct Property {
    name: String,
    count: Option<Number>,
    value: Number,
}

/// Things of one kind, one after another.
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Text,
    Little,
    Big,
}

/// Numbers one after another, from text or bytes.
struct Numbers<'b> {
    format: Format,
    rest: &'b [u8],
    /// Line of the text that the next number stands in.
    line: usize,
}

/// What is wrong, and at which line where there are lines.
type Bad = (Option<usize>, String);

/// Reads a file; `notes` says what was left out. Faces may stand before the vertices that they name.
pub(super) fn read(file: &str, bytes: &[u8], notes: &mut Vec<String>) -> Result<Soup, GeometryError> {
    let refused = |(line, what): Bad| {
        let place = line.map_or_else(|| file.to_owned(), |line| format!("{file}, line {line}"));
        GeometryError::refused(place, what, "export the file again")
    };
    let (elements, mut numbers) = header(bytes).map_err(refused)?;
    let (mut vertices, mut before, mut soup) = (Vec::new(), Vec::new(), Soup::default());
    for element in elements.iter().filter(|e| !e.properties.is_empty()) {
        let named = |names: &[&str]| element.properties.iter().position(|p| names.contains(&p.name.as_str()));
        let axes = ["x", "y", "z"].map(|axis| named(&[axis]));
        let list = named(&["vertex_indices", "vertex_index"]);
        let missing = ["x", "y", "z"].iter().zip(axes).find(|(_, at)| at.is_none());
        if let (Some((axis, _)), "vertex") = (missing, element.name.as_str()) {
            return Err(refused((None, format!("the element `vertex` has no property `{axis}`"))));
        }
        for k in 0..element.count {
            let line = numbers.line_of_next();
            let values = numbers.element(element, k).map_err(refused)?;
            match (element.name.as_str(), list) {
                ("vertex", _) => {
                    let vertex =
                        Vector(axes.map(|at| at.and_then(|at| values[at].first().copied()).unwrap_or(f64::NAN)));
                    vertices.push(vertex);
                }
                ("face", Some(list)) if vertices.is_empty() => before.push((line, values[list].clone())),
                ("face", Some(list)) => face((line, &values[list]), &vertices, &mut soup).map_err(refused)?,
                _ => {}
            }
        }
    }
    for (line, own) in &before {
        face((*line, own), &vertices, &mut soup).map_err(refused)?;
    }
    notes.extend(numbers.surplus(file));
    for (k, corners) in soup.triangles.iter().enumerate() {
        corners.iter().try_for_each(|corner| finite(file, k + 1, corner))?;
    }
    Ok(soup)
}

/// Adds the triangles of a face.
fn face((line, numbers): (Option<usize>, &[f64]), vertices: &[Vector<3>], soup: &mut Soup) -> Result<(), Bad> {
    let vertex = |v: &f64| {
        let found = (v.fract() == 0.0 && *v >= 0.0).then(|| vertices.get(*v as usize).copied()).flatten();
        found.ok_or_else(|| (line, format!("vertex {v} of a face is not there: the file has {}", vertices.len())))
    };
    let corners = numbers.iter().map(vertex).collect::<Result<Vec<_>, _>>()?;
    let what = || (line, format!("a face of {} corners is neither convex nor flat", corners.len()));
    let triangles = if corners.len() < 3 { Vec::new() } else { polygon::divided(&corners).ok_or_else(what)? };
    triangles.iter().for_each(|t| soup.push(t.map(|k| corners[k]), 0));
    Ok(())
}

/// The elements that a header announces, and what follows it.
fn header(bytes: &[u8]) -> Result<(Vec<Element>, Numbers<'_>), Bad> {
    let (mut elements, mut format): (Vec<Element>, _) = (Vec::new(), None);
    let (mut rest, mut line) = (bytes, 0);
    if !bytes.starts_with(b"ply") {
        return Err((None, "is no PLY file, which begins with `ply`".to_owned()));
    }
    loop {
        let Some(end) = rest.iter().position(|b| *b == b'\n') else {
            return Err((None, "has no line `end_header`".to_owned()));
        };
        let text = String::from_utf8_lossy(&rest[..end]).to_lowercase();
        (rest, line) = (&rest[end + 1..], line + 1);
        let words: Vec<&str> = text.split_whitespace().collect();
        let bad = || (Some(line), format!("`{}` is not a line of a PLY header", text.trim()));
        match words[..] {
            ["format", kind, ..] => format = Some(Format::of(kind).ok_or_else(bad)?),
            ["element", name, count] => {
                let count = count.parse().map_err(|_| bad())?;
                elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
            }
            ["property", ref of @ ..] => {
                let (element, property) = (elements.last_mut().ok_or_else(bad)?, Property::of(of).ok_or_else(bad)?);
                element.properties.push(property);
            }
            ["end_header"] => break,
            ["ply" | "comment" | "obj_info", ..] | [] => {}
            _ => return Err(bad()),
        }
    }
    let format = format.ok_or((None, "has no line `format`".to_owned()))?;
    Ok((elements, Numbers { format, rest, line: line + 1 }))
}

impl Format {
    fn of(word: &str) -> Option<Self> {
        match word {
            "ascii" => Some(Self::Text),
            "binary_little_endian" => Some(Self::Little),
            "binary_big_endian" => Some(Self::Big),
            _ => None,
        }
    }
}

impl Property {
    fn of(words: &[&str]) -> Option<Self> {
        match *words {
            ["list", count, value, name] => {
                Some(Self { name: name.to_owned(), count: Some(Number::of(count)?), value: Number::of(value)? })
            }
            [value, name] => Some(Self { name: name.to_owned(), count: None, value: Number::of(value)? }),
            _ => None,
        }
    }
}

impl Number {
    fn of(word: &str) -> Option<Self> {
        let int = |bytes, signed| Some(Self::Int { bytes, signed });
        match word {
            "char" | "int8" => int(1, true),
            "uchar" | "uint8" => int(1, false),
            "short" | "int16" => int(2, true),
            "ushort" | "uint16" => int(2, false),
            "int" | "int32" => int(4, true),
            "uint" | "uint32" => int(4, false),
            "float" | "float32" => Some(Self::Float { bytes: 4 }),
            "double" | "float64" => Some(Self::Float { bytes: 8 }),
            _ => None,
        }
    }
}

impl Numbers<'_> {
    /// What is told of what follows the last element.
    fn surplus(&mut self, file: &str) -> Option<String> {
        let line = self.line_of_next();
        let more = self.rest.len();
        match (more, line) {
            (0, _) => None,
            (_, Some(line)) => {
                Some(format!("{file}: line {line} and what follows is left out: the header announces no more"))
            }
            (1, None) => Some(format!("{file}: 1 byte after the last element is left out")),
            (_, None) => Some(format!("{file}: {more} bytes after the last element are left out")),
        }
    }

    /// Line of the next number of a text.
    fn line_of_next(&mut self) -> Option<usize> {
        if self.format != Format::Text {
            return None;
        }
        while let [first, rest @ ..] = self.rest {
            if !first.is_ascii_whitespace() {
                break;
            }
            self.line += usize::from(*first == b'\n');
            self.rest = rest;
        }
        Some(self.line)
    }

    /// All numbers of element number `k`, a list for each property.
    fn element(&mut self, element: &Element, k: usize) -> Result<Vec<Vec<f64>>, Bad> {
        let name = &element.name;
        let mut all = Vec::with_capacity(element.properties.len());
        for property in &element.properties {
            let line = self.line_of_next();
            let short = || {
                (
                    line,
                    format!("ends in {name} {} of {}: it is cut short, or a number is damaged", k + 1, element.count),
                )
            };
            let count = match property.count {
                None => 1.0,
                Some(kind) => self.next(kind)?.ok_or_else(short)?,
            };
            // memory is taken for what is there alone
            let values = (0..count as usize).map(|_| self.next(property.value)?.ok_or_else(short));
            all.push(values.collect::<Result<Vec<_>, _>>()?);
        }
        Ok(all)
    }

    /// The next number; `None` at the end.
    fn next(&mut self, kind: Number) -> Result<Option<f64>, Bad> {
        if let Some(line) = self.line_of_next() {
            let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
            let (word, rest) = self.rest.split_at(end);
            let whole = self.rest.split(|b| *b == b'\n').next().unwrap_or_default();
            let (word, whole) = (String::from_utf8_lossy(word), String::from_utf8_lossy(whole));
            if word.is_empty() {
                return Ok(None);
            }
            let Ok(value) = word.parse::<f64>() else {
                return Err((Some(line), no_point(&whole, "a row of numbers")));
            };
            self.rest = rest;
            return Ok(Some(value));
        }
        let (Number::Int { bytes, .. } | Number::Float { bytes }) = kind;
        let Some((taken, rest)) = self.rest.split_at_checked(bytes) else { return Ok(None) };
        self.rest = rest;
        let mut raw = [0; 8];
        raw[..bytes].copy_from_slice(taken);
        if self.format == Format::Big {
            raw[..bytes].reverse();
        }
        let whole = u64::from_le_bytes(raw);
        let shift = 64 - 8 * bytes as u32;
        Ok(Some(match kind {
            Number::Int { signed: true, .. } => ((whole << shift) as i64 >> shift) as f64,
            Number::Int { .. } => whole as f64,
            Number::Float { bytes: 4 } => f64::from(f32::from_bits(whole as u32)),
            Number::Float { .. } => f64::from_bits(whole),
        }))
    }
}
