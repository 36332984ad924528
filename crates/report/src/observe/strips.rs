//! Loads along the span: strips of a body across its span, and what the strips outboard of a station do to the section there.
//!
//! A piece of wall at s along the span stands for a stretch of it. Its force is shared among strips as a hat of half width r, 3/2 of
//! that stretch, ∫ (1 − |t − s|/r)/r dt, so that nothing is lost or made: strips add up to the body, whatever their width. A share acts in the
//! middle of its stretch, all of them together where the piece is, so that moments add up too. What of a hat is beyond the ends
//! of the body is folded back.
//!
//! Up is z for wings and y for fins. At the inner end of a strip, over all strips from there outwards,
//!
//! shear V = Σ F·up, bending M = Σ (s_k − s) F·up − (x_k − x)·up F·span, positive where tips are bent up, and torsion
//! T = Σ (x_k − x)·up F_x − (x_k − x)_x F·up about the quarter chord, nose up positive.
use serde::{Deserialize, Serialize};

use super::loads::{Coefficients, Load, LoadAxes};

/// Width of strips in mean extents of pieces along the span.
const WIDTH: f64 = 2.0;
/// Half width of hats in extents of pieces.
const REACH: f64 = 1.5;
/// Most strips from root to tip.
const MOST: f64 = 100.0;
/// Smallest extent of a piece, in widths of strips.
const THINNEST: f64 = 1e-9;

/// A piece of wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its place along the span.
    pub station: f64,
    /// Its extent along the span.
    pub extent: f64,
    /// Its place.
    pub x: [f64; 3],
    /// Force on it.
    pub force: [f64; 3],
}

/// Force and its moment about the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force.
    pub force: [f64; 3],
    /// Moment about the origin.
    pub moment: [f64; 3],
}

/// Which way a span runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Span {
    /// Along y: wings and all that lies; up is z.
    #[serde(rename = "y")]
    Lying,
    /// Along z: fins; up is y.
    #[serde(rename = "z")]
    Upright,
}

/// A section of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Section {
    /// Chord.
    pub chord: f64,
    /// Quarter of the chord.
    pub quarter: [f64; 3],
}

/// A strip of a body, and what acts on the section at its inner end.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// From where to where along the span; the first one is the inner end.
    pub ends: [f64; 2],
    /// Mean section.
    pub section: Section,
    /// Section at the inner end.
    pub inner: Section,
    /// Load.
    pub load: Wrench,
    /// Load of this strip and all outboard of it.
    pub outboard: Wrench,
}

/// Strips of one side of a body, from the root to the tip.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    /// Strips.
    pub strips: Vec<Strip>,
}

/// Strips of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Strips {
    /// Name of the body.
    pub body: String,
    /// Which way its span runs.
    pub span: Span,
    /// True for wings and fins, false for what is as high as it is wide.
    pub lifting: bool,
    /// One or two sides.
    pub sides: Vec<Side>,
}

/// What acts at the root of one side of a wing or a fin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RootLoads {
    /// Name of the body.
    pub body: String,
    /// Which way its span runs.
    pub axis: Span,
    /// Place of the root along the span.
    pub root: f64,
    /// Place of the tip.
    pub tip: f64,
    /// Force along z, of fins along y, in the units of the case.
    pub shear: f64,
    /// Bending moment, positive where the tip is bent up.
    pub bending: f64,
    /// Torsion about the quarter chord of the root, nose up positive.
    pub torsion: f64,
    /// Shear over dynamic pressure and reference area.
    pub shear_coefficient: f64,
    /// Bending moment over dynamic pressure, reference area and chord.
    pub bending_coefficient: f64,
    /// Torsion over the same.
    pub torsion_coefficient: f64,
    /// Distance of the centre of the load from the root over that of the tip; null without shear.
    pub centre: Option<f64>,
}

/// Shear, bending moment and torsion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Internal {
    /// Force upwards.
    pub shear: f64,
    /// Bending moment.
    pub bending: f64,
    /// Torsion.
    pub torsion: f64,
}

impl Wrench {
    /// Adds the force `f` acting at `x`.
    pub fn add(&mut self, x: &[f64; 3], f: &[f64; 3]) {
        let turn = cross(x, f);
        (0..3).for_each(|d| self.force[d] += f[d]);
        (0..3).for_each(|d| self.moment[d] += turn[d]);
    }

    /// Sum of two.
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            force: std::array::from_fn(|d| self.force[d] + other.force[d]),
            moment: std::array::from_fn(|d| self.moment[d] + other.moment[d]),
        }
    }

    /// Moment about the point `x`.
    pub fn about(&self, x: &[f64; 3]) -> [f64; 3] {
        let shift = cross(x, &self.force);
        std::array::from_fn(|d| self.moment[d] - shift[d])
    }

    /// Coefficients of lift, drag and moment about the reference point.
    pub fn coefficients(&self, axes: &LoadAxes) -> Coefficients {
        axes.coefficients(&Load { force: self.force, moment: self.about(&axes.moment_point)[1] })
    }
}

impl Span {
    /// The axis along the span.
    pub fn axis(self) -> usize {
        match self {
            Self::Lying => 1,
            Self::Upright => 2,
        }
    }

    /// The axis upwards.
    pub fn up(self) -> usize {
        3 - self.axis()
    }

    /// Nose-up moment about `x` of a load.
    pub fn nose_up(self, load: &Wrench, x: &[f64; 3]) -> f64 {
        let moment = load.about(x);
        match self {
            Self::Lying => moment[1],
            Self::Upright => -moment[2],
        }
    }
}

impl Strip {
    /// Width.
    pub fn width(&self) -> f64 {
        (self.ends[1] - self.ends[0]).abs()
    }

    /// Middle.
    pub fn middle(&self) -> f64 {
        f64::midpoint(self.ends[0], self.ends[1])
    }

    /// What acts on the section at the inner end.
    pub fn internal(&self, span: Span) -> Internal {
        let mut at = self.inner.quarter;
        at[span.axis()] = self.ends[0];
        let outward = (self.ends[1] - self.ends[0]).signum();
        let about_x = self.outboard.about(&at)[0] * outward;
        Internal {
            shear: self.outboard.force[span.up()],
            bending: if span == Span::Lying { about_x } else { -about_x },
            torsion: span.nose_up(&self.outboard, &at),
        }
    }
}

impl Strips {
    /// All strips, ascending along the span.
    pub fn across(&self) -> Vec<&Strip> {
        let mut all: Vec<&Strip> = self.sides.iter().flat_map(|side| &side.strips).collect();
        all.sort_by(|a, b| a.middle().total_cmp(&b.middle()));
        all
    }

    /// Loads of the whole body.
    pub fn whole(&self) -> Wrench {
        self.sides.iter().flat_map(|side| &side.strips).fold(Wrench::default(), |sum, s| sum.plus(&s.load))
    }

    /// What acts at the roots; `pressure` is the unit of pressure of the case in that of the solver.
    pub fn roots(&self, axes: &LoadAxes, pressure: f64) -> Vec<RootLoads> {
        let scale = if axes.force_scale > 0.0 { 1.0 / axes.force_scale } else { 0.0 };
        let of = |side: &Side| {
            let (first, last) = (side.strips.first()?, side.strips.last()?);
            let Internal { shear, bending, torsion } = first.internal(self.span);
            let (root, tip) = (first.ends[0], last.ends[1]);
            Some(RootLoads {
                body: self.body.clone(),
                axis: self.span,
                root,
                tip,
                shear: shear * pressure,
                bending: bending * pressure,
                torsion: torsion * pressure,
                shear_coefficient: shear * scale,
                bending_coefficient: bending * scale / axes.chord,
                torsion_coefficient: torsion * scale / axes.chord,
                centre: (shear != 0.0).then(|| bending / shear / (tip - root).abs()),
            })
        };
        self.sides.iter().filter_map(of).collect()
    }
}

/// Ends of the strips of a side from its inner end to its outer one.
pub fn divide(pieces: &[Piece], [inner, outer]: [f64; 2]) -> Vec<[f64; 2]> {
    let (low, high) = (inner.min(outer), inner.max(outer));
    let inside = || pieces.iter().filter(|p| low <= p.station && p.station <= high);
    let weight: f64 = inside().map(|p| p.extent * p.extent).sum();
    if weight <= 0.0 {
        return Vec::new();
    }
    let extent = inside().map(|p| p.extent.powi(3)).sum::<f64>() / weight;
    let n = ((high - low) / (WIDTH * extent)).round().clamp(1.0, MOST);
    let at = |k: f64| inner + (outer - inner) * k / n;
    (0..n as usize).map(|k| [at(k as f64), at(k as f64 + 1.0)]).collect()
}

/// Loads of the strips of sides with these ends: what each piece shares among them.
pub fn shares(pieces: &[Piece], sides: &[Vec<[f64; 2]>], span: Span) -> Vec<Vec<Wrench>> {
    let strips: Vec<StripEnds> = sides.iter().flat_map(|side| strip_ends(side, sides)).collect();
    let mut loads = vec![Wrench::default(); strips.len()];
    let narrowest = strips.iter().map(|s| s.high - s.low).fold(f64::INFINITY, f64::min);
    let mut parts: Vec<[f64; 2]> = Vec::with_capacity(strips.len());
    for piece in pieces {
        let reach = (REACH * piece.extent).max(THINNEST * narrowest);
        parts.clear();
        parts.extend(strips.iter().map(|strip| strip.share(piece.station, reach)));
        let total: f64 = parts.iter().map(|p| p[0]).sum();
        if total <= 0.0 {
            let away = |s: &StripEnds| (f64::midpoint(s.low, s.high) - piece.station).abs();
            let nearest = (0..strips.len()).min_by(|a, b| away(&strips[*a]).total_cmp(&away(&strips[*b])));
            nearest.into_iter().for_each(|k| loads[k].add(&piece.x, &piece.force));
            continue;
        }
        let centre = parts.iter().map(|p| p[1]).sum::<f64>() / total;
        for (load, [weight, first]) in loads.iter_mut().zip(&parts).filter(|(_, p)| p[0] > 0.0) {
            let mut x = piece.x;
            x[span.axis()] += first / weight - centre;
            load.add(&x, &piece.force.map(|f| f * (weight / total)));
        }
    }
    let mut loads = loads.into_iter();
    sides.iter().map(|side| loads.by_ref().take(side.len()).collect()).collect()
}

/// A strip that hats are cut to.
struct StripEnds {
    low: f64,
    high: f64,
    /// From where to where its side goes.
    side: [f64; 2],
    /// Ends of the body on its side, beyond which hats are folded back.
    folds: [Option<f64>; 2],
}

/// The strips of one side of all `sides`: where one goes on in the other no body ends.
fn strip_ends(side: &[[f64; 2]], sides: &[Vec<[f64; 2]>]) -> Vec<StripEnds> {
    let (Some([inner, _]), Some([_, outer])) = (side.first(), side.last()) else { return Vec::new() };
    let joined = sides.iter().filter(|s| s.first().is_some_and(|e| e[0] == *inner)).count() > 1;
    let folds = [Some(*inner).filter(|_| !joined), Some(*outer)];
    let strip = |e: &[f64; 2]| StripEnds {
        low: e[0].min(e[1]),
        high: e[0].max(e[1]),
        side: [inner.min(*outer), inner.max(*outer)],
        folds,
    };
    side.iter().map(strip).collect()
}

impl StripEnds {
    /// Part of the hat around `s` that lies in the strip or is folded back into it, and its first moment about `s`.
    fn share(&self, s: f64, reach: f64) -> [f64; 2] {
        let own = share(s, reach, [self.low, self.high]);
        let beside = self.side[0] <= s && s <= self.side[1];
        self.folds.iter().flatten().filter(|_| beside).fold(own, |[weight, first], end| {
            let [back, moment] = share(s, reach, [2.0 * end - self.high, 2.0 * end - self.low]);
            [weight + back, first + 2.0 * (end - s) * back - moment]
        })
    }
}

/// Strips of one side from their ends, sections and loads.
pub fn side(ends: &[[f64; 2]], sections: &[[Section; 2]], loads: &[Wrench]) -> Side {
    let mut strips: Vec<Strip> = ends
        .iter()
        .zip(sections)
        .zip(loads)
        .map(|((ends, [inner, section]), load)| Strip {
            ends: *ends,
            section: *section,
            inner: *inner,
            load: *load,
            outboard: Wrench::default(),
        })
        .collect();
    let mut sum = Wrench::default();
    for strip in strips.iter_mut().rev() {
        sum = sum.plus(&strip.load);
        strip.outboard = sum;
    }
    Side { strips }
}

/// Part of the hat of half width `reach` around `s` that lies in a stretch, and its first moment about `s`.
fn share(s: f64, reach: f64, [low, high]: [f64; 2]) -> [f64; 2] {
    // of (1 − |t|) up to t
    let whole = |t: f64| 0.5 + t - 0.5 * t * t.abs();
    let first = |t: f64| 0.5 * t * t - t.abs().powi(3) / 3.0;
    let [a, b] = [low, high].map(|x| ((x - s) / reach).clamp(-1.0, 1.0));
    [whole(b) - whole(a), (first(b) - first(a)) * reach]
}

fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Pieces of an elliptic load of size 1 on a wing of half span 1, unevenly placed.
    fn elliptic(n: usize) -> Vec<Piece> {
        let at = |k: usize| {
            let [a, b] = [k, k + 1].map(|k| (k as f64 / n as f64).powf(0.8));
            let s = f64::midpoint(a, b);
            let load = (b - a) * (1.0 - s * s).sqrt() * 4.0 / PI;
            Piece { station: s, extent: b - a, x: [0.3 * s, s, 0.1], force: [0.02 * load, 0.0, load] }
        };
        (0..n).map(at).collect()
    }

    fn strips_of(pieces: &[Piece], ends: &[[f64; 2]]) -> Side {
        let section = Section { chord: 1.0, quarter: [0.25, 0.0, 0.0] };
        side(ends, &vec![[section; 2]; ends.len()], &shares(pieces, &[ends.to_vec()], Span::Lying)[0])
    }

    #[test]
    fn strips_add_up_to_the_pieces() {
        let pieces = elliptic(57);
        let mut whole = Wrench::default();
        pieces.iter().for_each(|p| whole.add(&p.x, &p.force));
        let ends = divide(&pieces, [0.0, 1.0]);
        assert!(ends.len() > 20 && ends[0][0] == 0.0 && (ends[ends.len() - 1][1] - 1.0).abs() < 1e-15);
        let side = strips_of(&pieces, &ends);
        let sum = Strips { body: String::new(), span: Span::Lying, lifting: true, sides: vec![side.clone()] }.whole();
        for d in 0..3 {
            assert!((sum.force[d] - whole.force[d]).abs() < 1e-14, "{sum:?} {whole:?}");
            assert!((sum.moment[d] - whole.moment[d]).abs() < 1e-14, "{sum:?} {whole:?}");
            assert!((side.strips[0].outboard.force[d] - whole.force[d]).abs() < 1e-14);
        }
    }

    #[test] // the centre of a quarter of an ellipse is at 4/(3π)
    fn an_elliptic_load_bends_the_root() {
        let pieces = elliptic(80);
        let side = strips_of(&pieces, &divide(&pieces, [0.0, 1.0]));
        let root = side.strips[0].internal(Span::Lying);
        assert!((root.shear - 1.0).abs() < 1e-3, "{root:?}");
        assert!((root.bending - 4.0 / (3.0 * PI)).abs() < 1e-3, "{root:?}");
        // the line of pieces runs back by 0.3 of the span
        let torsion = 0.25 - 0.3 * 4.0 / (3.0 * PI) + 0.1 * 0.02;
        assert!((root.torsion - torsion).abs() < 1e-3, "{root:?}");
        let half = side.strips.iter().find(|s| s.ends[0] >= 0.5).unwrap();
        let s = half.ends[0];
        let exact = 2.0 / PI * (s.acos() - s * (1.0 - s * s).sqrt());
        assert!((half.internal(Span::Lying).shear - exact).abs() < 2e-3);
    }

    #[test]
    fn both_sides_are_bent_up_by_lift() {
        let pieces: Vec<Piece> = elliptic(40).into_iter().chain(elliptic(40).into_iter().map(mirrored)).collect();
        let ends = [divide(&pieces, [0.0, -1.0]), divide(&pieces, [0.0, 1.0])];
        let loads = shares(&pieces, &ends, Span::Lying);
        let n = ends[0].len();
        let section = [[Section::default(); 2]; 100];
        let left = side(&ends[0], &section[..n], &loads[0]).strips[0].internal(Span::Lying);
        let right = side(&ends[1], &section[..n], &loads[1]).strips[0].internal(Span::Lying);
        assert!((left.bending - right.bending).abs() < 1e-12 && left.bending > 0.4, "{left:?} {right:?}");
        assert!((left.torsion - right.torsion).abs() < 1e-12);
    }

    fn mirrored(p: Piece) -> Piece {
        Piece { station: -p.station, x: [p.x[0], -p.x[1], p.x[2]], ..p }
    }

    #[test]
    fn a_fin_pushed_towards_y_is_bent_up() {
        let piece = Piece { station: 0.5, extent: 0.1, x: [1.0, 0.0, 0.5], force: [0.0, 2.0, 0.0] };
        let ends = [[0.0, 1.0]];
        let section = Section { chord: 1.0, quarter: [0.0; 3] };
        let fin = side(&ends, &[[section; 2]], &shares(&[piece], &[ends.to_vec()], Span::Upright)[0]);
        assert_eq!(fin.strips[0].internal(Span::Upright), Internal { shear: 2.0, bending: 1.0, torsion: -2.0 });
    }
}
