//! Loads along the span of bodies in space, from the forces on the particles of their walls.
//!
//! A body is cut across its span: along y, and along z where it is seen from the side with more than twice the area that it is seen
//! from above with, as a fin. The root is at the plane of symmetry: that of the domain, else y = 0 where bodies reach it, else their
//! middle; or at the inner end of a side that does not reach the plane. A fin has its root where its chord is longer.
use super::symmetry::side_of_symmetry;
use crate::case::{self, Case};
use crate::geometry::{Station, Surface};
use crate::observe::induced::{SpanLoad, induced};
use crate::observe::loads::LoadAxes;
use crate::observe::strips::{Piece, Section, Side, Span, Strips, divide, shares, side};
use crate::scheme::View;
use crate::scheme::start::free_stream;

/// Area seen from one direction over that seen from another, from which on a body is a wing or a fin, and is a fin.
const FLAT: f64 = 1.3;
const UPRIGHT: f64 = 2.0;
/// Sections that the mean of a strip is taken of.
const SECTIONS: usize = 8;
/// Part of the span that a side must have to be one.
const SLIVER: f64 = 0.02;
/// Part of the height of a fin, from either end, at which its chords are compared: nearer, a fuselage may cut them.
const WITHIN: f64 = 0.3;

/// Loads along the span of all bodies; none in the plane, without a stream, or where no body is flat.
pub(crate) fn span_loads<const D: usize>(
    case: &Case,
    view: &View<'_, D>,
    surface: Option<&Surface<D>>,
    axes: &LoadAxes,
) -> Vec<Strips> {
    let Some(surface) = surface.filter(|_| D == 3 && axes.force_scale > 0.0) else { return Vec::new() };
    let middle = plane_of_symmetry(case, view, surface);
    let bodies = surface.bodies.iter().enumerate();
    let all: Vec<Strips> = bodies.filter_map(|(b, name)| of_body(view, surface, (b as u16, name), middle)).collect();
    if all.iter().any(|s| s.lifting) { all } else { Vec::new() }
}

/// Induced drag of the load along the span in a subsonic stream; `None` between walls, whose images the flat wake in free air does not have.
pub(crate) fn span_load<const D: usize>(
    case: &Case,
    view: &View<'_, D>,
    surface: Option<&Surface<D>>,
    bodies: &[Strips],
    axes: &LoadAxes,
) -> Option<SpanLoad> {
    let free = free_stream::<D>(case);
    let plane = side_of_symmetry(case, &view.reference().tree.bounds()).map(|side| side.0);
    let subsonic = D == 3 && free.velocity.norm() < 1.0;
    if !subsonic || !in_free_air(case) {
        return None;
    }
    let load = induced(bodies, plane, axes, 0.5 * free.density * free.velocity.norm_squared())?;
    Some(SpanLoad { left_out: left_out(surface?, bodies), ..load })
}

/// True where at most one side along the span is a wall or an image, and none above or below.
fn in_free_air(case: &Case) -> bool {
    let [_, y, z] = case.boundary.pairs();
    !y.iter().all(|side| side.has_images()) && y[0] != case::Side::Periodic && !z.iter().any(|side| side.has_images())
}

/// Fins and winglets, which leave the plane of the wake.
fn left_out<const D: usize>(surface: &Surface<D>, bodies: &[Strips]) -> Vec<String> {
    /// Height over half the span from which on a wing leaves that plane.
    const HIGH: f64 = 0.15;
    let told = |strips: &Strips| {
        let name = &strips.body;
        if strips.span == Span::Upright {
            return strips.lifting.then(|| {
                format!("`{name}` stands upright: its load is along z (`strips.csv`), and no part of this lift and induced drag")
            });
        }
        let bounds = surface.bounds_of(surface.bodies.iter().position(|b| b == name)?);
        let ends = strips.sides.iter().flat_map(|side| side.strips.iter().flat_map(|s| s.ends.map(f64::abs)));
        let height = bounds.extent()[2.min(D - 1)] / ends.fold(0.0, f64::max);
        (strips.lifting && height > HIGH).then(|| {
            format!(
                "`{name}` is {:.0} % of its half span high: the wake is not flat, as this induced drag has it",
                100.0 * height
            )
        })
    };
    bodies.iter().filter_map(told).collect()
}

/// The plane of symmetry across the span, y.
fn plane_of_symmetry<const D: usize>(case: &Case, view: &View<'_, D>, surface: &Surface<D>) -> f64 {
    let [low, high] = [surface.bounds().min[1], surface.bounds().max[1]];
    let slack = SLIVER * (high - low);
    let reached = low <= slack && high >= -slack;
    let own = if reached { 0.0 } else { f64::midpoint(low, high) };
    side_of_symmetry(case, &view.reference().tree.bounds()).map_or(own, |side| side.0)
}

fn of_body<const D: usize>(
    view: &View<'_, D>,
    surface: &Surface<D>,
    (body, name): (u16, &str),
    middle: f64,
) -> Option<Strips> {
    let reference = view.reference();
    let own: Vec<usize> = (0..reference.interface.len()).filter(|w| reference.interface[*w].body == body).collect();
    let seen = |d: usize| own.iter().map(|w| reference.interface[*w].area[d].abs()).sum::<f64>();
    let [side_on, above] = [seen(1), seen(2)];
    let span = if side_on > UPRIGHT * above { Span::Upright } else { Span::Lying };
    let axis = span.axis();
    let piece = |w: &usize| {
        let wall = &reference.interface[*w];
        let i = reference.n_fluid + w;
        let extent = (wall.area.norm() * (1.0 - wall.normal[axis].powi(2)).max(0.0)).sqrt();
        Piece { station: reference.x[i][axis], extent, x: view.place(i).to_3d(), force: view.wall_force(*w).to_3d() }
    };
    let pieces: Vec<Piece> = own.iter().map(piece).collect();
    let stretches = stretches(surface, body, span, middle);
    let ends: Vec<Vec<[f64; 2]>> =
        stretches.into_iter().map(|s| divide(&pieces, s)).filter(|e| !e.is_empty()).collect();
    let loads = shares(&pieces, &ends, span);
    let sides: Vec<Side> =
        ends.iter().zip(&loads).map(|(ends, own)| side(ends, &sections(surface, body, axis, ends), own)).collect();
    let lifting = above.max(side_on) > FLAT * above.min(side_on);
    (!sides.is_empty()).then(|| Strips { body: name.to_owned(), span, lifting, sides })
}

/// Inner and outer end of each side of a body.
fn stretches<const D: usize>(surface: &Surface<D>, body: u16, span: Span, middle: f64) -> Vec<[f64; 2]> {
    let axis = span.axis();
    if span == Span::Upright {
        let [_, whole] = surface.sides(body, axis, f64::NEG_INFINITY);
        let Some([low, high]) = whole else { return Vec::new() };
        let inside = WITHIN * (high - low);
        let chords = surface.stations(body, axis, &[low + inside, high - inside]);
        let hangs = chords[1].chord > chords[0].chord;
        return vec![if hangs { [high, low] } else { [low, high] }];
    }
    let [left, right] = surface.sides(body, axis, middle);
    let length = |side: &Option<[f64; 2]>| side.map_or(0.0, |[low, high]| high - low);
    let least = SLIVER * (length(&left) + length(&right));
    let keep = |side: &Option<[f64; 2]>| length(side) > least;
    let left = left.filter(|s| keep(&Some(*s))).map(|[low, high]| [high, low]);
    left.into_iter().chain(right.filter(|s| keep(&Some(*s)))).collect()
}

/// Sections at the inner ends of strips, and mean ones.
fn sections<const D: usize>(surface: &Surface<D>, body: u16, axis: usize, ends: &[[f64; 2]]) -> Vec<[Section; 2]> {
    // half a step inside: the ends of bodies have no section
    let within = |[from, to]: &[f64; 2], k: usize| from + (to - from) * (k as f64 + 0.5) / SECTIONS as f64;
    let mut at: Vec<f64> = ends.iter().flat_map(|e| (0..SECTIONS).map(|k| within(e, k))).collect();
    let falls = ends.first().is_some_and(|e| e[1] < e[0]);
    if falls {
        at.reverse();
    }
    let mut found = surface.stations(body, axis, &at);
    if falls {
        found.reverse();
    }
    found.chunks(SECTIONS).map(|own| [section(&own[..1]), section(own)]).collect()
}

/// The mean of stations: each counts as its chord does.
fn section(stations: &[Station]) -> Section {
    let sum: f64 = stations.iter().map(|s| s.chord).sum();
    let quarter = |d: usize| stations.iter().map(|s| s.chord * s.quarter[d]).sum::<f64>() / sum;
    if sum > 0.0 {
        Section { chord: sum / stations.len() as f64, quarter: std::array::from_fn(quarter) }
    } else {
        Section::default()
    }
}
