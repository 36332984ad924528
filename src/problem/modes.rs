//! Modes of files beside the bodies that they move.
//!
//! Points in other units than those of the case, or beside the body, make a shape as any others do, and forces that mean nothing. Where they
//! lie, how far apart they are and what the shape becomes on the walls is held against the body.
use super::error::RunError;
use crate::case::rounded;
use crate::coupling::Attached;
use crate::geometry::{Element, Surface};
use crate::math::{Bounds, Vector};
use crate::motion::{ModeShape, Motions, WARNING};

/// Extents of a body by which the points of a mode may lie beside it.
const OFF: f64 = 0.5;
/// Least extent of the points of a mode over that of the body.
const SMALL: f64 = 0.2;
/// Greatest one: a mode of a whole aircraft may carry a flap.
const LARGE: f64 = 100.0;
/// Part of the length of a body that may lie beyond the points of a mode.
const BEYOND: f64 = 0.3;
/// Part of the extent of a body by which points lie beyond one of its ends, and it beyond them at the other, where they are shifted.
const SHIFTED: f64 = 0.05;
/// Extent of points over that of a body from which they are larger, and its inverse from which they are smaller.
const SCALED: f64 = 1.3;
/// Part by which this may differ from axis to axis, and places of ends from those of a body of that size.
const EVENLY: [f64; 2] = [0.2, 0.1];
/// Extent along an axis, over the greatest, of what is flat across it.
const FLAT: f64 = 1e-3;
/// Greatest displacement of a wall over that of the points.
const MORE: f64 = 2.0;
/// Corners of walls that are looked at.
const LOOKED_AT: usize = 2000;
/// Lengths of units in metres.
pub(super) const UNITS: [(f64, &str); 5] =
    [(1e-3, "millimetres"), (1e-2, "centimetres"), (0.0254, "inches"), (0.3048, "feet"), (1e3, "kilometres")];
/// Extents of a body by which the ends of points in another unit may differ from its own.
const ALIKE: f64 = 0.25;

/// What is told of modes: what was left out or chosen, and what is doubtful.
#[derive(Default)]
pub(crate) struct ToldOfModes {
    /// Notes.
    pub(crate) notes: Vec<String>,
    /// Warnings.
    pub(crate) warnings: Vec<String>,
}

/// What is told of modes that move bodies, as far as they lie within the box around the `gas`.
pub(crate) fn told_of<'a, const D: usize>(
    (surface, gas): (Option<&Surface<D>>, &Bounds<D>),
    motions: &'a Motions<D>,
    attached: &'a [Attached<D>],
) -> ToldOfModes {
    let mut told = ToldOfModes::default();
    let Some(surface) = surface else { return told };
    let of_motion = |b: usize| motions.of(b).shapes().map(move |shape| (Some(b), shape));
    let led = (0..motions.len()).flat_map(of_motion);
    let of_structure = |a: &'a Attached<D>| a.shapes.iter().map(move |shape| (Some(a.body), shape.as_ref()));
    let carried = attached.iter().flat_map(of_structure);
    let forces = motions.shapes_of_forces().iter().map(|shape| (None, shape));
    // bodies that share a structure share its modes
    let one = |body: Option<usize>| body.filter(|_| attached.len() < 2);
    for (body, shape) in led.chain(carried).chain(forces) {
        let Some(file) = shape.file() else { continue };
        let warning = |r: &String| r.strip_prefix(WARNING).map(str::to_owned);
        let notes = shape.remarks().iter().filter(|r| warning(r).is_none()).cloned().collect();
        let doubt = beside((surface, gas), one(body), shape)
            .map(|doubt| format!("{doubt}; see `file = \"{file}\"` in the case"));
        let warnings = shape.remarks().iter().filter_map(warning).chain(doubt).collect();
        told.add(notes, warnings);
    }
    told
}

impl ToldOfModes {
    /// Adds what is not told yet.
    fn add(&mut self, notes: Vec<String>, warnings: Vec<String>) {
        for (all, more) in [(&mut self.notes, notes), (&mut self.warnings, warnings)] {
            more.into_iter().for_each(|told| all.extend((!all.contains(&told)).then_some(told)));
        }
    }
}

/// Refuses a mode of a file whose points lie off the body, or are in other units; `body` is its number, none stands for all.
pub(super) fn lies_on<const D: usize>(
    surface: &Surface<D>,
    body: Option<usize>,
    shape: &ModeShape<D>,
) -> Result<(), RunError> {
    let Some(file) = shape.file() else { return Ok(()) };
    let (name, walls) = named(surface, body);
    let points = box_of(shape);
    let (extent, reach) = (points.extent().max_abs(), OFF * walls.extent().max_abs());
    let far = (0..D).any(|d| points.min[d] > walls.max[d] + reach || points.max[d] < walls.min[d] - reach);
    let unit = unit(&points, &walls).filter(|(length, _)| !(0.1..10.0).contains(length));
    let large = extent > LARGE * walls.extent().max_abs();
    let small = extent < SMALL * walls.extent().max_abs() && extent > 0.0;
    if !far && !small && !large && unit.is_none() {
        return Ok(());
    }
    let guess = unit.map_or(String::new(), |(_, name)| format!(": they seem to be in {name}"));
    Err(RunError::Motion {
        what: format!(
            "the points of mode `{file}` reach from {}, but {name} from {}{guess}",
            told(&points),
            told(&walls)
        ),
        hint: "points of a mode are those of the body where it is placed, in the units of the case, and so are displacements",
    })
}

/// What is doubtful of a shape beside its body.
fn beside<const D: usize>(
    (surface, gas): (&Surface<D>, &Bounds<D>),
    body: Option<usize>,
    shape: &ModeShape<D>,
) -> Option<String> {
    let file = shape.file()?;
    let (name, walls) = named(surface, body);
    let points = box_of(shape);
    if let Some((_, unit)) = unit(&points, &walls) {
        let (points, walls) = (told(&points), told(&walls));
        return Some(format!(
            "the points of mode `{file}` reach from {points}, but {name} from {walls}: are they in {unit}?"
        ));
    }
    let alone = body.is_none() || surface.bodies.len() < 2;
    let doubt = scaled(&points, &walls, alone).or_else(|| shifted(&points, &walls));
    if let Some(doubt) = doubt {
        let (points, walls) = (told(&points), told(&walls));
        return Some(format!("the points of mode `{file}` reach from {points}, but {name} from {walls}: {doubt}"));
    }
    // what a plane of symmetry cuts off is not computed
    let computed = Bounds { min: walls.min.max(&gas.min), max: walls.max.min(&gas.max) };
    let longest = longest(&computed);
    let (low, high) = (points.min[longest].max(computed.min[longest]), points.max[longest].min(computed.max[longest]));
    let beyond = 1.0 - (high - low).max(0.0) / computed.extent()[longest];
    let own = |e: &&Element<D>| body.is_none_or(|b| usize::from(e.body) == b);
    let corners = || {
        let all = surface.elements.iter().filter(own).map(|e| &surface.vertices[e.vertices[0] as usize]);
        all.filter(|x| gas.contains(x))
    };
    let every = corners().count().div_ceil(LOOKED_AT).max(1);
    let greatest = corners().step_by(every).map(|x| shape.at(x).norm()).fold(0.0, f64::max);
    let spreads = points.extent()[longest] > 0.0;
    if greatest > MORE * shape.size() && (beyond > BEYOND || spreads) {
        return Some(format!(
            "mode `{file}` moves walls of {name} by up to {greatest:.3e}, but its own points by {:.3e} at most: the shape between or beyond \
             them is not what its rows say",
            shape.size()
        ));
    }
    (spreads && beyond > BEYOND).then(|| {
        let part = 100.0 * beyond;
        format!("{part:.0} % of the length of {name} lie beyond the points of mode `{file}`: the shape goes on there as it ends at them")
    })
}

/// What is said of points that lie as the walls do, but are larger or smaller; `alone` where there is no other body that they may be those of.
fn scaled<const D: usize>(points: &Bounds<D>, walls: &Bounds<D>, alone: bool) -> Option<String> {
    let (size, own) = (walls.extent().max_abs(), points.extent().max_abs());
    let both = (0..D).filter(|d| walls.extent()[*d] > FLAT * size && points.extent()[*d] > FLAT * own);
    let ratios: Vec<f64> = both.map(|d| points.extent()[d] / walls.extent()[d]).collect();
    let ratio = own / size;
    let evenly = !ratios.is_empty() && ratios.iter().all(|r| (r / ratio - 1.0).abs() <= EVENLY[0]);
    let ends = [(points.min, walls.min), (points.max, walls.max)];
    // across what is flat ends say nothing
    let thick = |d: &usize| points.extent()[*d] > FLAT * own;
    let near = |(p, w): &(Vector<D>, Vector<D>)| {
        (0..D).filter(thick).all(|d| (p[d] - ratio * w[d]).abs() <= EVENLY[1] * ratio * size)
    };
    // points within a body may be few of those on it
    let differ = (alone && ratio > SCALED) || (ratio < SCALED.recip() && ratios.len() > 1);
    (differ && evenly && ends.iter().all(near)).then(|| {
        let (ratio, compared) = match ratio > 1.0 {
            true => (ratio, "large"),
            false => (ratio.recip(), "small"),
        };
        format!(
            "they are {} times as {compared} as it is: is their unit of length that of the case?",
            rounded(ratio, 3)
        )
    })
}

/// What is said of points that lie beyond one end of a body that lies beyond them at the other.
fn shifted<const D: usize>(points: &Bounds<D>, walls: &Bounds<D>) -> Option<String> {
    let extent = walls.extent();
    let thinnest = (0..D).fold(0, |a, d| if extent[d] < extent[a] { d } else { a });
    let chord = (0..D).filter(|d| *d != thinnest).map(|d| extent[d]).fold(f64::INFINITY, f64::min);
    (0..D).find_map(|d| {
        // along its thickness a body is measured by its chord
        let least = SHIFTED * if d == thinnest { chord } else { extent[d] };
        let [low, high] = [points.min[d] - walls.min[d], points.max[d] - walls.max[d]];
        let both = low.abs() > least && high.abs() > least && low * high > 0.0;
        both.then(|| {
            let (way, axis) = (rounded(0.5 * (low + high), 3), ["x", "y", "z"][d]);
            format!("they lie beyond one end of it, and it lies beyond them at the other: are they shifted by {way} along {axis}?")
        })
    })
}

/// The axis along which a box is longest.
fn longest<const D: usize>(walls: &Bounds<D>) -> usize {
    (0..D).fold(0, |a, d| if walls.extent()[d] > walls.extent()[a] { d } else { a })
}

/// The unit of length in which points lie as the walls do in that of the case: its length in that, and its name.
fn unit<const D: usize>(points: &Bounds<D>, walls: &Bounds<D>) -> Option<(f64, &'static str)> {
    let size = walls.extent().max_abs();
    let alike = |length: f64| {
        let ends = [(points.min, walls.min), (points.max, walls.max)];
        ends.iter().all(|(p, w)| (0..D).all(|d| (p[d] * length - w[d]).abs() <= ALIKE * size))
    };
    // where they are in the unit of the case they fit as they are, unless both are within the reach of the other
    let fits = |length: f64| alike(length) && points.extent().max_abs() * length > (1.0 - ALIKE) * size;
    if alike(1.0) {
        return None;
    }
    UNITS.iter().copied().find(|(length, _)| fits(*length))
}

fn box_of<const D: usize>(shape: &ModeShape<D>) -> Bounds<D> {
    let [min, max] = shape.corners();
    Bounds { min, max }
}

/// A body in words, and the box around it.
fn named<const D: usize>(surface: &Surface<D>, body: Option<usize>) -> (String, Bounds<D>) {
    match body {
        Some(b) => (format!("body `{}`", surface.bodies[b]), surface.bounds_of(b)),
        None => ("the bodies".to_owned(), surface.bounds()),
    }
}

fn told<const D: usize>(b: &Bounds<D>) -> String {
    let one = |c: f64| if c.abs() < f64::EPSILON { "0".to_owned() } else { rounded(c, 4) };
    let place = |x: &Vector<D>| x.0.map(one).join(", ");
    format!("({}) to ({})", place(&b.min), place(&b.max))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::in_dimension::ProblemIn;
    use super::super::open::surface;
    use super::*;

    /// What is said of a bend of eleven stations beside a section of unit chord.
    fn said(scale: f64, shift: f64, part: f64) -> Result<Option<String>, String> {
        let row = |x: f64, y: f64| {
            format!("{},{},0,{}\n", scale * (part * x + shift), scale * y, scale * part * part * x * x)
        };
        let rows = (0..11).map(|k| 0.1 * f64::from(k)).flat_map(|x| [row(x, -0.06), row(x, 0.06)]);
        said_of(&rows.collect::<String>())
    }

    fn everywhere<const D: usize>() -> Bounds<D> {
        Bounds { min: Vector::splat(f64::NEG_INFINITY), max: Vector::splat(f64::INFINITY) }
    }

    #[test]
    fn the_half_that_is_not_computed_needs_no_points() {
        let case =
            crate::case::read("[flow]\nmach = 0.5\n[[body]]\nwing = { naca = \"0012\", span = 6, chord = 1 }\n", "t");
        let surface = surface::<3>(&case.unwrap(), Path::new("")).unwrap().0.unwrap();
        let rows: String =
            (0..4).flat_map(|k| [0.0, 1.0].map(|x| format!("{x},{k},0,0,0,{}\n", 0.01 * f64::from(k * k)))).collect();
        let text = format!("x,y,z,dx,dy,dz\n{rows}");
        let shape = crate::motion::mode_shape::<3>("m.csv", &|_| Ok(text.clone())).unwrap();
        let half = Bounds { min: Vector([f64::NEG_INFINITY, 0.0, f64::NEG_INFINITY]), ..everywhere() };
        let told = |gas: &Bounds<3>| beside((&surface, gas), Some(0), &shape);
        assert_eq!(told(&half), None);
        assert!(told(&everywhere()).unwrap().contains("50 % of the length of body"));
    }

    /// What is said of the rows of a file beside a section of unit chord.
    fn said_of(rows: &str) -> Result<Option<String>, String> {
        let case = crate::case::read("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n", "t").unwrap();
        let surface = surface::<2>(&case, Path::new("")).unwrap().0.unwrap();
        let text = format!("x,y,dx,dy\n{rows}");
        let shape = crate::motion::mode_shape::<2>("m.csv", &|_| Ok(text.clone())).map_err(|e| e.to_string())?;
        assert!(shape.remarks().is_empty(), "{:?}", shape.remarks());
        lies_on(&surface, Some(0), &shape).map_err(|e| e.to_string())?;
        Ok(beside((&surface, &everywhere()), Some(0), &shape))
    }

    /// What is said of a bend whose points lie at the places `at` of x and of a half thickness.
    fn placed(at: impl Fn(f64, f64) -> [f64; 2]) -> Option<String> {
        let row = |x: f64, side: f64| {
            let [a, b] = at(x, 0.06 * side);
            format!("{a},{b},0,{}\n", 0.1 * a * a)
        };
        let rows = (0..11).map(|k| 0.1 * f64::from(k)).flat_map(|x| [row(x, -1.0), row(x, 1.0)]);
        said_of(&rows.collect::<String>()).unwrap()
    }

    #[test]
    fn points_beyond_the_body_that_are_larger_or_shifted_are_doubtful() {
        let double = placed(|x, y| [2.0 * x, 2.0 * y]).unwrap();
        assert!(double.contains("they are 2 times as large as it is") && double.contains("`m.csv`"), "{double}");
        assert!(double.contains("reach from (0, -0.12) to (2, 0.12)"), "{double}");
        assert!(placed(|x, y| [1.4 * x, 1.4 * y]).unwrap().contains("1.4 times as large"));
        assert!(placed(|x, y| [0.72 * x, 0.72 * y]).unwrap().contains("times as small"));
        for (shift, told) in [(-0.25, "shifted by -0.25 along x"), (0.1, "shifted by 0.1 along x")] {
            let said = placed(|x, y| [x + shift, y]).unwrap();
            assert!(said.contains(told), "{said}");
        }
        for thick in [0.0, 1.0] {
            let above = placed(|x, y| [x + 0.02 * (1.0 - thick) * y.signum(), thick * y + 0.5]).unwrap();
            assert!(above.contains("along y"), "{above}");
        }
        // a little beyond, on the chord line, within a box of spars, or of a whole aircraft
        assert_eq!(placed(|x, y| [1.04 * x - 0.02, y]), None);
        assert_eq!(placed(|x, y| [x + 0.03, 0.5 * y]), None);
        assert_eq!(placed(|x, y| [x + 0.02 * y.signum(), 0.0]), None);
        assert_eq!(placed(|x, y| [0.1 + 0.75 * x, y]), None);
        assert_eq!(placed(|x, y| [4.0 * x - 1.5, 9.0 * y]), None);
    }

    #[test]
    fn the_key_of_a_doubtful_mode_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let row = |k: i32| format!("{},0,0,{}\n", 0.2 * f64::from(k), 0.01 * f64::from(k * k));
        let text = format!("x,y,dx,dy\n{}", (0..11).map(row).collect::<String>());
        std::fs::write(folder.path().join("double.csv"), text).unwrap();
        let case = "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[gaf]\nreduced_frequencies = 0.1\nmodes = []\n[[gaf.mode]]\n\
                    name = \"b\"\nfile = \"double.csv\"\n";
        let case = crate::case::read(case, "case.toml").unwrap_or_else(|e| panic!("{e}"));
        let problem = ProblemIn::<2>::of_case(&case, folder.path()).unwrap();
        let told = format!("{:?}", problem.remarks_on_gaf_modes().unwrap()).replace('\\', "");
        assert!(
            told.contains("2 times as large") && told.contains("see `file = \"double.csv\"` in the case"),
            "{told}"
        );
    }

    #[test]
    fn other_units_and_other_places_are_seen() {
        assert_eq!(said(1.0, 0.0, 1.0), Ok(None));
        for (scale, unit) in [(1e3, "millimetres"), (100.0, "centimetres"), (39.37, "inches"), (1e-3, "kilometres")] {
            let told = said(scale, 0.0, 1.0).unwrap_err();
            assert!(told.contains(&format!("they seem to be in {unit}")) && told.contains("`m.csv`"), "{told}");
        }
        assert!(said(3.281, 0.0, 1.0).unwrap().unwrap().contains("are they in feet?"));
        let far = said(1.0, 50.0, 1.0).unwrap_err();
        assert!(far.contains("reach from (50, -0.06) to (51, 0.06), but body `body-1` from (0, -0.06"), "{far}");
        assert!(said(1.0, 0.0, 0.4).unwrap().unwrap().contains("moves walls of body `body-1` by up to"));
        assert!(said(1.0, 0.35, 0.65).unwrap().unwrap().contains("% of the length of body `body-1` lie beyond"));
    }
}
