//! Modes of files beside the bodies that they move.
//!
//! Points in other units than those of the case, or beside the body, make a shape as any others do, and forces that mean nothing. Where they
//! lie, how far apart they are and what the shape becomes on the walls is held against the body.
use std::path::Path;

use super::super::error::RunError;
use super::super::monitor::Monitor;
use super::{bodies, motions};
use crate::case::{Case, GafMethod, rounded};
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
/// Greatest displacement of a wall over that of the points.
const MORE: f64 = 2.0;
/// Corners of walls that are looked at.
const LOOKED_AT: usize = 2000;
/// Lengths of units in metres.
const UNITS: [(f64, &str); 5] =
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

/// Judges the modes of all files that a case names, as a run, `alula gaf` and `alula flutter` do.
pub(crate) fn judged<const D: usize>(
    case: &Case,
    input: &Path,
    surface: Option<&Surface<D>>,
) -> Result<ToldOfModes, RunError> {
    let of = |case: &Case| {
        let mut laws = motions(case, input, surface)?;
        let attached = bodies(case, input, surface, &mut laws)?;
        Ok::<_, RunError>(told_of(surface, &laws, &attached))
    };
    let mut told = of(case)?;
    if let Some(plan) = case.gaf.as_ref().filter(|plan| plan.method == GafMethod::Linear && !plan.flexible.is_empty()) {
        let more = of(&case.gaf_steady_case(plan))?;
        told.add(more.notes, more.warnings);
    }
    Ok(told)
}

/// What is told of modes that move bodies.
pub(crate) fn told_of<const D: usize>(
    surface: Option<&Surface<D>>,
    motions: &Motions<D>,
    attached: &[Attached<D>],
) -> ToldOfModes {
    let mut told = ToldOfModes::default();
    let Some(surface) = surface else { return told };
    let led = (0..motions.len()).flat_map(|b| motions.of(b).shapes().map(move |shape| (Some(b), shape)));
    let carried = attached.iter().flat_map(|a| a.shapes.iter().map(|shape| (Some(a.body), shape.as_ref())));
    let forces = motions.shapes_of_forces().iter().map(|shape| (None, shape));
    // bodies that share a structure share its modes
    let one = |body: Option<usize>| body.filter(|_| attached.len() < 2);
    for (body, shape) in led.chain(carried).chain(forces).filter(|(_, shape)| shape.file().is_some()) {
        let warning = |r: &String| r.strip_prefix(WARNING).map(str::to_owned);
        let notes = shape.remarks().iter().filter(|r| warning(r).is_none()).cloned().collect();
        let warnings = shape.remarks().iter().filter_map(warning).chain(beside(surface, one(body), shape)).collect();
        told.add(notes, warnings);
    }
    told
}

impl ToldOfModes {
    /// Tells it to those who watch a run.
    pub(crate) fn tell(&self, monitor: &mut dyn Monitor) {
        self.notes.iter().for_each(|note| monitor.note(note));
        self.warnings.iter().for_each(|warning| monitor.warn(warning));
    }

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
fn beside<const D: usize>(surface: &Surface<D>, body: Option<usize>, shape: &ModeShape<D>) -> Option<String> {
    let file = shape.file()?;
    let (name, walls) = named(surface, body);
    let points = box_of(shape);
    if let Some((_, unit)) = unit(&points, &walls) {
        let (points, walls) = (told(&points), told(&walls));
        return Some(format!(
            "the points of mode `{file}` reach from {points}, but {name} from {walls}: are they in {unit}?"
        ));
    }
    let longest = (0..D).fold(0, |a, d| if walls.extent()[d] > walls.extent()[a] { d } else { a });
    let (low, high) = (points.min[longest].max(walls.min[longest]), points.max[longest].min(walls.max[longest]));
    let beyond = 1.0 - (high - low).max(0.0) / walls.extent()[longest];
    let own = |e: &&Element<D>| body.is_none_or(|b| usize::from(e.body) == b);
    let corners = || surface.elements.iter().filter(own).map(|e| &surface.vertices[e.vertices[0] as usize]);
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
    use super::*;

    /// What is said of a bend of eleven stations beside a section of unit chord.
    fn said(scale: f64, shift: f64, part: f64) -> Result<Option<String>, String> {
        let case = crate::case::read("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n", "t").unwrap();
        let surface = super::super::surface::<2>(&case, Path::new("")).unwrap().0.unwrap();
        let row = |x: f64, y: f64| {
            format!("{},{},0,{}\n", scale * (part * x + shift), scale * y, scale * part * part * x * x)
        };
        let rows = (0..11).map(|k| 0.1 * f64::from(k)).flat_map(|x| [row(x, -0.06), row(x, 0.06)]);
        let text = format!("x,y,dx,dy\n{}", rows.collect::<String>());
        let shape = crate::motion::mode_shape::<2>("m.csv", &|_| Ok(text.clone())).map_err(|e| e.to_string())?;
        assert!(shape.remarks().is_empty(), "{:?}", shape.remarks());
        lies_on(&surface, Some(0), &shape).map_err(|e| e.to_string())?;
        Ok(beside(&surface, Some(0), &shape))
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
