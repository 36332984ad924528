//! STL files: binary in single precision, text in double precision with all its solids.
use super::{Soup, finite, no_point, point};
use crate::case::numbers_of;
use crate::geometry::GeometryError;
use crate::math::Vector;

/// Header and count of a binary file, bytes.
const HEADER: usize = 84;
/// Bytes of the count.
const COUNT: usize = 4;
/// Least and greatest length in bytes of headers that are tried where the 80 of the format do not fit.
const OTHERS: [usize; 2] = [76, 88];
/// One triangle of a binary file, bytes: a normal, three corners, and two of no meaning.
const TRIANGLE: usize = 50;
/// Bytes of the normal.
const NORMAL: usize = 12;
/// Bytes in which a text begins.
const BEGINNING: usize = 256;

/// Reads a file, binary or text. Binary headers may begin with `solid` as texts do, so that the length, and zeros, tell one from the other.
pub(super) fn read(file: &str, bytes: &[u8], notes: &mut Vec<String>) -> Result<Soup, GeometryError> {
    let announced = count(bytes, HEADER - COUNT);
    let fits = |header: &usize| {
        let n = count(bytes, *header).filter(|n| *n > 0 || *header + COUNT == HEADER);
        n.is_some_and(|n| header + COUNT + TRIANGLE * n == bytes.len())
    };
    let exact = fits(&(HEADER - COUNT));
    let other = if exact { None } else { (OTHERS[0]..=OTHERS[1]).find(fits) };
    let begins = numbers_of(&bytes[..bytes.len().min(BEGINNING)]).unwrap_or_default();
    let small = begins.to_lowercase();
    let is_text = !begins.contains('\0') && (small.trim_start().starts_with("solid") || small.contains("facet"));
    if let Some(header) = other {
        notes.push(format!("{file}: the header has {header} bytes where the format has {}", HEADER - COUNT));
        return triangles(file, &bytes[header + COUNT..]);
    }
    match announced {
        _ if is_text && !exact => text(file, &crate::geometry::plain(file, bytes)?),
        Some(announced) => binary(file, announced, bytes, notes),
        None => {
            let what = format!("is no STL file: {} bytes, and a binary header alone has 84", bytes.len());
            Err(GeometryError::refused(file, what, "text STL begins with `solid`"))
        }
    }
}

/// The count of triangles after a header of so many bytes.
fn count(bytes: &[u8], header: usize) -> Option<usize> {
    let counted = bytes.get(header..header + COUNT)?;
    Some(u32::from_le_bytes([counted[0], counted[1], counted[2], counted[3]]) as usize)
}

fn binary(file: &str, announced: usize, bytes: &[u8], notes: &mut Vec<String>) -> Result<Soup, GeometryError> {
    let (held, rest) = bytes[HEADER..].as_chunks::<TRIANGLE>();
    if held.len() < announced {
        let (length, n) = (HEADER + TRIANGLE * announced, bytes.len());
        let what = format!(
            "announces {announced} triangles, {length} bytes, but holds {n} bytes: it is cut short in triangle {}",
            held.len() + 1
        );
        return Err(GeometryError::refused(file, what, "copy or export the file again"));
    }
    let mut count = held.len();
    if count > announced && rest.is_empty() {
        notes.push(format!("{file}: the header announces {announced} triangles, but {count} follow: all are read"));
    } else if count > announced || !rest.is_empty() {
        count = announced;
        let more = bytes.len() - HEADER - TRIANGLE * count;
        let what = if more == 1 { "1 byte after the last triangle is" } else { "bytes after the last triangle are" };
        let number = if more == 1 { String::new() } else { format!("{more} ") };
        notes.push(format!("{file}: {number}{what} left out"));
    }
    triangles(file, &bytes[HEADER..HEADER + TRIANGLE * count])
}

/// The triangles of a binary file, one after another.
fn triangles(file: &str, bytes: &[u8]) -> Result<Soup, GeometryError> {
    let single = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let mut soup = Soup::default();
    for (k, triangle) in bytes.as_chunks::<TRIANGLE>().0.iter().enumerate() {
        let corner = |c: usize| Vector::from_fn(|d| single(&triangle[NORMAL + 12 * c + 4 * d..]));
        let corners = [corner(0), corner(1), corner(2)];
        corners.iter().try_for_each(|c| finite(file, k + 1, c))?;
        soup.push(corners, 0);
    }
    Ok(soup)
}

/// A facet that is being read.
#[derive(Default)]
struct Facet {
    open: bool,
    corners: Vec<Vector<3>>,
}

/// Reads the words of a text; several statements may stand in a line.
fn text(file: &str, text: &str) -> Result<Soup, GeometryError> {
    let mut soup = Soup::default();
    let mut facet = Facet::default();
    let (mut tag, mut last) = (0, 0);
    for (i, line) in text.lines().enumerate() {
        let refused = |what: String, hint: &str| GeometryError::refused(format!("{file}, line {}", i + 1), what, hint);
        let small = line.to_ascii_lowercase();
        let words: Vec<&str> = small.split('#').next().unwrap_or_default().split_whitespace().collect();
        let mut rest = &words[..];
        last = if rest.is_empty() { last } else { i + 1 };
        while let [first, more @ ..] = rest {
            rest = more;
            match (*first, more.first()) {
                ("solid", _) => {
                    let named: Vec<&str> = line.split_whitespace().skip(words.len() - more.len()).collect();
                    tag = soup.begin(&named.join(" "));
                    rest = &[];
                }
                // a name or three numbers follow
                ("endsolid" | "color" | "colour", _) | ("end", Some(&"solid")) => rest = &[],
                ("facet", _) if facet.open => {
                    return Err(refused("a facet begins inside another".into(), "a line `endfacet` is missing"));
                }
                ("facet", next) => {
                    facet.open = true;
                    // the normal follows from the corners
                    rest = if next == Some(&"normal") { more.get(4..).unwrap_or_default() } else { more };
                }
                ("vertex", _) if facet.open => {
                    let corner = more.get(..3).and_then(point);
                    let hint = "write `vertex x y z`, decimals with a point";
                    facet.corners.push(corner.ok_or_else(|| refused(no_point(line, "a vertex"), hint))?);
                    rest = &more[3..];
                }
                ("endfacet", _) | ("end", Some(&"facet")) => {
                    let [a, b, c] = facet.corners[..] else {
                        let what = format!("the facet has {} vertices", facet.corners.len());
                        return Err(refused(what, "triangles have 3"));
                    };
                    soup.push([a, b, c], tag);
                    facet = Facet::default();
                    rest = if *first == "end" { &more[1..] } else { more };
                }
                ("outer" | "loop" | "endloop" | "end", _) => {}
                (other, _) => {
                    return Err(refused(format!("`{other}` is not a word of an STL file"), "export the file again"));
                }
            }
        }
    }
    if facet.open {
        let place = format!("{file}, line {last}");
        return Err(GeometryError::refused(
            place,
            "ends inside a facet: it is cut short",
            "copy or export the file again",
        ));
    }
    Ok(soup)
}
