//! Airfoil coordinate files.
//!
//! Rows of numbers, separated by blanks, commas or semicolons; `#` begins a comment. The order is detected:
//!
//! - Selig: once around the section from trailing edge to trailing edge, in either direction;
//! - Lednicer: a row of two counts, then both sides from the leading edge to the trailing edge; the counts may be absent;
//! - a header with a column `surface` whose values begin with `u` or `l`;
//! - one side only: half thickness of a symmetric section; of several thickness columns the first counts.
//!
//! Columns of a header are recognised by name: `x…` the first coordinate, the next one the second; `pct` in a name
//! means percent of the chord. What was assumed is reported.
use super::GeometryError;
use super::outline::{self, Mark};
use super::shell::Shell;
use crate::case::decimal_comma;
use crate::math::{Bounds, Vector};
use std::io::Read;

/// Longest file that is read, bytes: a section with a million points.
const LONGEST: u64 = 64 << 20;

/// One row of coordinates.
#[derive(Clone, Debug)]
struct Row {
    mark: Mark,
    surface: String,
}

/// Columns named by a header.
struct Columns {
    x: usize,
    y: usize,
    surface: Option<usize>,
    section: Option<usize>,
    scale: [f64; 2],
    half: bool,
    names: String,
}

/// A file as read: rows with the breaks between blocks lost, and what the header said.
struct Table {
    rows: Vec<Row>,
    counts: Option<[usize; 2]>,
    columns: Option<Columns>,
}

/// The smooth shell of the section in `input`; `file` names it in messages, `notes` says what was assumed.
pub(super) fn read(file: &str, input: impl Read, notes: &mut Vec<String>) -> Result<Shell<2>, GeometryError> {
    let mut bytes = Vec::new();
    let input = input.take(LONGEST).read_to_end(&mut bytes);
    input.map_err(|source| GeometryError::Open { file: file.to_string(), source })?;
    let table = parse(file, &super::plain(file, &bytes)?)?;
    let marks = around(file, &table, notes)?;
    outline::airfoil(file, marks, notes)
}

/// Refuses rows whose numbers have decimal commas: two values would be read as four.
fn no_decimal_commas(file: &str, number: usize, line: &str) -> Result<(), GeometryError> {
    match decimal_comma(line) {
        None => Ok(()),
        Some(word) => Err(GeometryError::refused(
            format!("{file}, line {number}"),
            format!("`{word}` has a decimal comma"),
            "write decimals with a point, `0.5`",
        )),
    }
}

fn parse(file: &str, text: &str) -> Result<Table, GeometryError> {
    let mut table = Table { rows: Vec::new(), counts: None, columns: None };
    let mut section: Option<String> = None;
    for (i, line) in text.lines().enumerate() {
        let line = line.split(['#', '!']).next().unwrap_or("").trim().trim_start_matches('\u{feff}');
        let words: Vec<&str> = line.split(|c: char| c == ',' || c == ';' || c.is_whitespace()).collect();
        let words: Vec<&str> = words.into_iter().filter(|w| !w.is_empty()).collect();
        if words.is_empty() {
            continue;
        }
        let before = table.rows.is_empty() && table.counts.is_none();
        if before && table.columns.is_none() && words.iter().any(|w| number(w).is_none()) {
            table.columns = Columns::of(&words);
            continue;
        }
        if before && words.len() == 1 {
            // A title that is a number, `2412`.
            continue;
        }
        no_decimal_commas(file, i + 1, line)?;
        let row = row(file, i + 1, &words, table.columns.as_ref())?;
        if before && table.columns.is_none() && counts(&row).is_some() {
            table.counts = counts(&row);
            continue;
        }
        if let Some(k) = table.columns.as_ref().and_then(|c| c.section)
            && section.get_or_insert_with(|| words[k].to_string()) != words[k]
        {
            let what = format!("a second section `{}` begins", words[k]);
            return Err(GeometryError::refused(format!("{file}, line {}", i + 1), what, "give one section per file"));
        }
        table.rows.push(row);
    }
    Ok(table)
}

impl Columns {
    /// Columns of a header, none when the line is a title.
    fn of(words: &[&str]) -> Option<Self> {
        let names: Vec<String> = words.iter().map(|w| w.to_lowercase()).collect();
        let x = names.iter().position(|n| n == "x" || n.starts_with("x_") || n.starts_with("x/"))?;
        let y = x + 1;
        // `x` may be a word of a title as well
        let name = names.get(y).filter(|n| n.starts_with(['y', 'z']) || n.contains("thick"))?;
        let find = |what: &str| names.iter().position(|n| n == what);
        let scale = |n: &str| if n.contains("pct") { 0.01 } else { 1.0 };
        Some(Self {
            x,
            y,
            surface: find("surface"),
            section: find("section"),
            scale: [scale(&names[x]), scale(name)],
            half: name.contains("thick") || names.len() > y + 1,
            names: format!("`{}` and `{}`", words[x], words[y]),
        })
    }
}

fn row(file: &str, line: usize, words: &[&str], columns: Option<&Columns>) -> Result<Row, GeometryError> {
    let refused = |what: String, hint: &str| GeometryError::refused(format!("{file}, line {line}"), what, hint);
    let (x, y, scale) = columns.map_or((0, 1, [1.0, 1.0]), |c| (c.x, c.y, c.scale));
    let last = columns.map_or(y, |c| y.max(c.surface.unwrap_or(0)).max(c.section.unwrap_or(0)));
    if words.len() <= last {
        return Err(refused(format!("has {} values", words.len()), "every row needs two coordinates, `x y`"));
    }
    let value = |k: usize| {
        number(words[k]).ok_or_else(|| refused(format!("`{}` is not a finite number", words[k]), "write rows as `x y`"))
    };
    let point = Vector([value(x)? * scale[0], value(y)? * scale[1]]);
    let surface = columns.and_then(|c| c.surface).map_or(String::new(), |k| words[k].to_lowercase());
    Ok(Row { mark: Mark { point, line }, surface })
}

/// A finite number below 1e100 in magnitude, so that squares stay finite.
fn number(word: &str) -> Option<f64> {
    word.parse::<f64>().ok().filter(|v| v.abs() < 1e100)
}

/// The two counts of a Lednicer file: whole numbers that cannot be coordinates of a unit chord.
fn counts(row: &Row) -> Option<[usize; 2]> {
    let whole = |v: f64| (2.0..=1e6).contains(&v) && v.fract() == 0.0;
    let [a, b] = row.mark.point.0;
    (whole(a) && whole(b)).then_some([a as usize, b as usize])
}

/// The points once around the section, from trailing edge to trailing edge, upper side first.
fn around(file: &str, table: &Table, notes: &mut Vec<String>) -> Result<Vec<Mark>, GeometryError> {
    let marks: Vec<Mark> = table.rows.iter().map(|r| r.mark).collect();
    if marks.len() < 3 {
        let what = format!("holds {} points", marks.len());
        return Err(GeometryError::refused(file, what, "an airfoil file lists `x y` row by row"));
    }
    if let Some(columns) = &table.columns {
        notes.push(format!("{file}: coordinates from columns {}", columns.names));
        if columns.surface.is_some() {
            return by_name(file, table);
        }
    }
    if let Some([upper, lower]) = table.counts {
        if upper + lower != marks.len() {
            let what = format!("announces {upper} and {lower} points but holds {}", marks.len());
            return Err(GeometryError::refused(file, what, "correct the counts in the second line or remove it"));
        }
        notes.push(format!("{file}: Lednicer order, {upper} and {lower} points"));
        return Ok(join(&marks[..upper], &marks[upper..]));
    }
    let x: Vec<f64> = marks.iter().map(|m| m.point[0]).collect();
    let bounds = Bounds::around(marks.iter().map(|m| &m.point));
    let (low, range) = (bounds.min[0], bounds.extent()[0]);
    let (front, rear) = (|v: f64| v - low < 0.25 * range, |v: f64| v - low > 0.75 * range);
    if let Some(cut) = (1..x.len()).find(|&i| rear(x[i - 1]) && front(x[i])) {
        notes.push(format!("{file}: Lednicer order without counts, {cut} and {} points", x.len() - cut));
        return Ok(join(&marks[..cut], &marks[cut..]));
    }
    let (first, last) = (x[0], x[x.len() - 1]);
    if (front(first) && rear(last)) || (rear(first) && front(last)) {
        return mirrored(file, marks, notes);
    }
    if front(first) && front(last) {
        notes.push(format!("{file}: once around from the leading edge"));
        return Ok(from_the_rear(&marks));
    }
    let half = table.columns.as_ref().is_some_and(|c| c.half);
    let more = if half { "; further columns are not used" } else { "" };
    notes.push(format!("{file}: Selig order{more}"));
    Ok(marks)
}

/// Sides by the column `surface`.
fn by_name(file: &str, table: &Table) -> Result<Vec<Mark>, GeometryError> {
    let side = |letter: char| -> Vec<Mark> {
        table.rows.iter().filter(|r| r.surface.starts_with(letter)).map(|r| r.mark).collect()
    };
    let (upper, lower) = (side('u'), side('l'));
    if let Some(row) = table.rows.iter().find(|r| !r.surface.starts_with(['u', 'l'])) {
        let what = format!("`{}` is not a side", row.surface);
        return Err(GeometryError::refused(format!("{file}, line {}", row.mark.line), what, "use `upper` or `lower`"));
    }
    if upper.len() < 2 || lower.len() < 2 {
        let what = format!("has {} upper and {} lower points", upper.len(), lower.len());
        return Err(GeometryError::refused(file, what, "give both sides, or drop the column `surface`"));
    }
    Ok(join(&upper, &lower))
}

/// One side given: the other is its mirror image.
fn mirrored(file: &str, marks: Vec<Mark>, notes: &mut Vec<String>) -> Result<Vec<Mark>, GeometryError> {
    let size = Bounds::around(marks.iter().map(|m| &m.point)).extent().max_abs();
    if let Some(bad) = marks.iter().find(|m| m.point[1] < -1e-9 * size) {
        let what = format!("one side only, and the half thickness {} is negative", bad.point[1]);
        let hint = "list both sides from trailing edge to trailing edge (Selig order)";
        return Err(GeometryError::refused(format!("{file}, line {}", bad.line), what, hint));
    }
    notes.push(format!("{file}: one side with {} points, taken as half thickness of a symmetric section", marks.len()));
    let mirror: Vec<Mark> =
        marks.iter().map(|m| Mark { point: Vector([m.point[0], -m.point[1]]), line: m.line }).collect();
    Ok(join(&marks, &mirror))
}

/// Upper side backwards from the trailing edge, then the lower side; each may be given in either direction.
fn join(upper: &[Mark], lower: &[Mark]) -> Vec<Mark> {
    let from_front = |side: &[Mark]| {
        let mut side = side.to_vec();
        if side[0].point[0] > side[side.len() - 1].point[0] {
            side.reverse();
        }
        side
    };
    let (mut marks, lower) = (from_front(upper), from_front(lower));
    let shared = usize::from(marks[0].point == lower[0].point);
    marks.reverse();
    marks.extend(&lower[shared..]);
    marks
}

/// A closed outline that begins at the leading edge, turned to begin and end at its rearmost point.
fn from_the_rear(marks: &[Mark]) -> Vec<Mark> {
    let rear = (0..marks.len()).fold(0, |a, i| if marks[i].point[0] > marks[a].point[0] { i } else { a });
    let mut turned = marks[rear..].to_vec();
    turned.extend(&marks[..=rear]);
    turned
}

#[cfg(test)]
mod tests {
    use super::super::surface::Surface;
    use super::*;
    use proptest::prelude::*;

    const RAE_2822: &str = include_str!("testdata/rae2822_agard_ar138.csv");
    const NACA_64A010: &str = include_str!("testdata/naca64a010_bmp_design.csv");
    const NACA_64A010_LOOP: &str = include_str!("testdata/naca64a010_isogai_su2.csv");
    const NACA_0012: &str = include_str!("testdata/naca0012_formula_variants.csv");

    fn load(text: &str) -> Result<(Surface<2>, Vec<String>), GeometryError> {
        let mut notes = Vec::new();
        let shell = read("wing.dat", text.as_bytes(), &mut notes)?;
        Ok((Surface::new(&[("wing".into(), shell)]), notes))
    }

    fn error(text: &str) -> String {
        load(text).unwrap_err().to_string()
    }

    #[test]
    fn commas_and_encodings_of_other_programs_are_read_or_told() {
        let rows = "1 0\n0.5 0.05\n0 0\n0.5 -0.05\n1 0\n";
        let told = error(&rows.replace('.', ","));
        assert!(told.contains("line 2") && told.contains("`0,5` has a decimal comma"), "{told}");
        assert_eq!(load(&rows.replace('\n', "\r")).is_ok(), load(rows).is_ok());
        assert!(load(&rows.replace(' ', ",")).is_ok() == load(rows).is_ok());
        let wide: Vec<u8> = [0xff, 0xfe].into_iter().chain(rows.bytes().flat_map(|b| [b, 0])).collect();
        assert_eq!(read("wing.dat", &wide[..], &mut Vec::new()).is_ok(), load(rows).is_ok());
        let broken = [&wide[..], &[0x00, 0xd8]].concat();
        let told = read("wing.dat", &broken[..], &mut Vec::new()).map(|_| ()).unwrap_err().to_string();
        assert!(told.contains("broken UTF-16"), "{told}");
    }

    /// Greatest distance of the file's points from the surface.
    fn miss(surface: &Surface<2>, text: &str) -> f64 {
        let table = parse("", text).unwrap();
        let distance = |r: &Row| surface.nearest(&r.mark.point, 1.0).unwrap().distance;
        table.rows.iter().map(distance).fold(0.0, f64::max)
    }

    #[test]
    fn published_sections_load() {
        let (rae, notes) = load(RAE_2822).unwrap();
        assert!(rae.sharp.len() == 1 && miss(&rae, RAE_2822) < 1e-12, "{notes:?}");
        // The convex parts bulge beyond the polygon of the published points by less than a thousandth of its area.
        let ring = around("", &parse("", RAE_2822).unwrap(), &mut Vec::new()).unwrap();
        let twice = |w: &[Mark]| w[0].point[0] * w[1].point[1] - w[1].point[0] * w[0].point[1];
        let polygon = 0.5 * ring.windows(2).map(twice).sum::<f64>();
        assert!((0.0..1e-3).contains(&(rae.volume() / polygon - 1.0)), "{} {polygon}", rae.volume());
        assert!((rae.bounds().extent()[1] - 0.122).abs() < 1e-4, "height of the box around the section");
        let (design, notes) = load(NACA_64A010).unwrap();
        assert!(notes.iter().any(|n| n.contains("wavy")), "four decimals: {notes:?}");
        assert!(design.sharp.len() == 2 && miss(&design, NACA_64A010) < 1e-12, "{notes:?}");
        assert!(notes.iter().any(|n| n.contains("half thickness")), "{notes:?}");
        assert!((design.bounds().extent()[1] - 0.1).abs() < 1e-4);
        let (ring, notes) = load(NACA_64A010_LOOP).unwrap();
        assert!(ring.sharp.len() == 1 && notes.iter().any(|n| n.contains("Selig")), "{notes:?}");
        // Nose radius of 64A010: 0.687 % chord (Abbott and von Doenhoff 1959, appendix III).
        let nose = ring.nearest(&Vector([-0.1, 0.0]), 1.0).unwrap();
        assert!(
            (ring.radius[nose.element as usize] / 0.00687 - 1.0).abs() < 0.2,
            "{}",
            ring.radius[nose.element as usize]
        );
    }

    #[test]
    fn the_spline_recovers_the_formula() {
        let (surface, notes) = load(NACA_0012).unwrap();
        assert!(notes.iter().any(|n| n.contains("`x_c` and `z_closed`")), "{notes:?}");
        let thickness =
            |x: f64| 0.6 * (0.2969 * x.sqrt() - 0.1260 * x - 0.3516 * x * x + 0.2843 * x.powi(3) - 0.1036 * x.powi(4));
        let mut worst = 0.0_f64;
        for i in 0..4000 {
            let x = (0.5 * std::f64::consts::PI * f64::from(i) / 4000.0).sin().powi(2);
            worst = worst.max(surface.nearest(&Vector([x, thickness(x)]), 1.0).unwrap().distance);
        }
        // 81 points over half the section, eight digits.
        assert!(worst < 2e-6, "{worst}");
        let nose = surface.nearest(&Vector([-0.1, 0.0]), 1.0).unwrap();
        assert!((surface.radius[nose.element as usize] / 0.015867 - 1.0).abs() < 0.02);
    }

    /// Points of a symmetric section of half thickness 0.1 sin(πx) without its nose rounded: upper side front to rear.
    fn lens(i: usize, n: usize) -> (f64, f64) {
        let x = i as f64 / n as f64;
        (x, 0.2 * x * (1.0 - x))
    }

    fn rows(points: impl Iterator<Item = (f64, f64)>) -> String {
        points.map(|(x, y)| format!("{x} {y}\n")).collect()
    }

    #[test]
    fn every_order_gives_the_same_outline() {
        let (front, rear) = ((0..=40).map(|i| lens(i, 40)), (0..=40).rev().map(|i| lens(i, 40)));
        let flip = |(x, y): (f64, f64)| (x, -y);
        let upper_lower = rows(front.clone()) + "\n" + &rows(front.clone().map(flip));
        let orders = [
            "lens\n".to_string() + &rows(rear.clone().chain(front.clone().skip(1).map(flip))),
            "lens\n".to_string() + &rows(rear.clone().map(flip).chain(front.clone().skip(1))),
            "lens\n 41. 41.\n\n".to_string() + &upper_lower,
            upper_lower.clone(),
            rows(front.clone().chain(rear.map(flip).skip(1))),
            rows(front.clone()),
            "x,y\r\n".to_string() + &rows(front).replace(' ', ",").replace('\n', "\r\n"),
        ];
        let areas: Vec<f64> = orders.iter().map(|text| load(text).unwrap().0.volume()).collect();
        assert!(areas.iter().all(|a| (a - 0.4 / 6.0).abs() < 1e-5), "{areas:?}");
        let (sharp, _) = load(&orders[0]).unwrap();
        assert_eq!(sharp.sharp.len(), 2, "the nose of a lens is sharp");
        let noted = |k: usize, word: &str| load(&orders[k]).unwrap().1.iter().any(|n| n.contains(word));
        assert!(noted(1, "clockwise") && noted(2, "41 and 41") && noted(3, "without counts") && noted(5, "symmetric"));
    }

    #[test]
    fn an_ellipse_without_corners_stays_smooth() {
        let angle = |i: usize| 2.0 * std::f64::consts::PI * i as f64 / 80.0;
        let text = rows((0..=80).map(|i| (0.5 + 0.5 * angle(i).cos(), 0.2 * angle(i).sin())));
        let (surface, _) = load(&text).unwrap();
        assert!(surface.sharp.is_empty() && (surface.volume() / (0.1 * std::f64::consts::PI) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn points_missing_on_a_side_are_told() {
        let angle = |i: usize| 2.0 * std::f64::consts::PI * i as f64 / 100.0;
        let ellipse = |left_out: std::ops::Range<usize>| {
            let kept = (0..=100).filter(move |i| !left_out.contains(i));
            load(&rows(kept.map(|i| (0.5 + 0.5 * angle(i).cos(), 0.1 * angle(i).sin())))).unwrap().1
        };
        let told = |notes: &[String]| notes.iter().filter(|n| n.contains("points missing")).count();
        let notes = ellipse(23..28);
        assert!(notes.iter().any(|n| n.contains("6.1 times as far") && n.contains("line 23")), "{notes:?}");
        assert_eq!((told(&ellipse(0..0)), told(&notes), told(&ellipse(47..51))), (0, 1, 1));
        assert_eq!(told(&load(RAE_2822).unwrap().1) + told(&load(NACA_0012).unwrap().1), 0);
    }

    #[test]
    fn mistakes_are_refused_with_their_place() {
        assert!(error("").contains("holds 0 points"));
        assert!(error("a\n1 0\n0.5 x\n0 0").contains("wing.dat, line 3: `x` is not a finite number"));
        assert!(error("a\n1 0\n0.5\n0 0").contains("line 3: has 1 values"));
        assert!(error("a\n3 4\n0 0\n0.5 0.1\n1 0\n").contains("announces 3 and 4 points but holds 3"));
        assert!(error("0 0\n0.5 0.1\n0.7 -0.1\n1 0").contains("line 3: one side only"));
        assert!(error("1 0\n0.5 0.1\n0 0\n0.5 -0.1\n0.8 0.3\n1 0").contains("crosses itself at"));
        assert!(error("1 0\n0.8 0\n0.5 0\n0 0\n0.5 0\n1 0").contains("no area"));
        assert!(error("surface,x_c,z_c\nupper,0,0\nmiddle,1,0\nlower,1,0").contains("`middle` is not a side"));
        assert!(error("section,x_c,z_c\n0,1,0\n0,0,0.1\n1,1,0").contains("one section per file"));
    }

    proptest! {
        #[test]
        fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            let _ = read("x.dat", bytes.as_slice(), &mut Vec::new());
        }

        #[test]
        fn no_mutation_panics(place in 0..3000_usize, byte in any::<u8>(), cut in 0..3000_usize, drop in 0..60_usize) {
            let mut bytes = RAE_2822.as_bytes().to_vec();
            let place = place % bytes.len();
            bytes[place] = byte;
            bytes.drain(place..(place + drop).min(bytes.len()));
            bytes.truncate(cut.max(300));
            let _ = read("x.dat", bytes.as_slice(), &mut Vec::new());
        }

        #[test]
        fn no_numbers_panic(v in proptest::collection::vec((-3..4_i32, -3..4_i32), 3..12), scale in -200..200_i32) {
            let unit = 10_f64.powi(scale);
            let text = rows(v.iter().map(|(x, y)| (f64::from(*x) * unit, f64::from(*y) * unit)));
            let _ = read("x.dat", text.as_bytes(), &mut Vec::new());
        }
    }
}
