//! Plane outlines as two sides from the nose to the rear, sampled at common positions, for the construction of wings
//! and bodies of revolution.
use super::shell::Shell;
use crate::math::Vector;

/// Distance from the rear, as a fraction of the chord, within which a corner belongs to the trailing edge.
const REAR: f64 = 0.1;

/// Upper and lower side of a section, from the nose to the rear.
pub(super) struct Sides {
    /// Upper side.
    pub(super) upper: Vec<Vector<2>>,
    /// Lower side; its first point is that of the upper side, and its last one too where the section ends sharply.
    pub(super) lower: Vec<Vector<2>>,
}

/// Smooth pieces of a profile, one after another from the nose to the rear; the points may have one or two measures of
/// the section.
pub(super) struct Chain<const D: usize>(pub(super) Vec<Vec<Vector<D>>>);

impl Sides {
    /// The sides of a counter-clockwise outline at the fractions `places` of their lengths, from 0 to 1.
    pub(super) fn of(outline: &Shell<2>, places: &[f64]) -> Self {
        let points = &outline.vertices;
        let n = points.len();
        let along = |k: &usize| points[*k][0];
        let high = (0..n).map(|k| along(&k)).fold(f64::NEG_INFINITY, f64::max);
        let low = (0..n).map(|k| along(&k)).fold(f64::INFINITY, f64::min);
        let vertex = |x: &Vector<2>| points.iter().position(|p| p == x);
        let edges = outline.features().edges;
        let at_rear = edges.iter().filter(|e| e.ends[0][0] > high - REAR * (high - low));
        let mut rear: Vec<usize> = at_rear.filter_map(|e| vertex(&e.ends[0])).collect();
        rear.sort_by(|a, b| points[*a][1].total_cmp(&points[*b][1]));
        let last = (0..n).max_by(|a, b| along(a).total_cmp(&along(b))).unwrap_or(0);
        let (below, above) = (rear.first().copied().unwrap_or(last), rear.last().copied().unwrap_or(last));
        let middle = (points[below] + points[above]) * 0.5;
        let far = |k: &usize| (points[*k] - middle).norm_squared();
        let nose = (0..n).max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0);
        let run =
            |from: usize, to: usize| (0..=(to + n - from) % n).map(|k| points[(from + k) % n]).collect::<Vec<_>>();
        let mut upper = run(above, nose);
        upper.reverse();
        Self { upper: at(&upper, places), lower: at(&run(nose, below), places) }
    }

    /// True when both sides end at the same point.
    pub(super) fn is_sharp(&self) -> bool {
        self.upper.last() == self.lower.last()
    }
}

impl<const D: usize> Chain<D> {
    /// About `n` points, distributed over the pieces in proportion to their lengths and clustered at their ends.
    pub(super) fn resampled(&self, n: usize) -> Vec<Vector<D>> {
        /// Minimum number of panels of a piece.
        const FEWEST: f64 = 8.0;
        let length = |piece: &Vec<Vector<D>>| piece.windows(2).map(|p| (p[1] - p[0]).norm()).sum::<f64>();
        let whole: f64 = self.0.iter().map(length).sum();
        let mut points: Vec<Vector<D>> = Vec::new();
        for piece in &self.0 {
            let panels = (n as f64 * length(piece) / whole).ceil().max(FEWEST) as usize;
            let own = at(piece, &clustered(panels));
            points.extend(&own[usize::from(!points.is_empty())..]);
        }
        points
    }
}

/// Fractions of a length that are clustered at its ends, for `n` panels.
pub(super) fn clustered(n: usize) -> Vec<f64> {
    (0..=n).map(|k| 0.5 - 0.5 * (std::f64::consts::PI * k as f64 / n as f64).cos()).collect()
}

/// The points of a chain at the fractions `places` of its length, from 0 to 1.
fn at<const D: usize>(chain: &[Vector<D>], places: &[f64]) -> Vec<Vector<D>> {
    let mut lengths = vec![0.0];
    for pair in chain.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).norm());
    }
    let whole = lengths[lengths.len() - 1];
    let point = |part: &f64| {
        let length = part * whole;
        let k = lengths.partition_point(|l| *l < length).clamp(1, chain.len() - 1);
        let within = (length - lengths[k - 1]) / (lengths[k] - lengths[k - 1]).max(f64::MIN_POSITIVE);
        chain[k - 1] + (chain[k] - chain[k - 1]) * within.clamp(0.0, 1.0)
    };
    let mut points: Vec<_> = places.iter().map(point).collect();
    let last = points.len() - 1;
    (points[0], points[last]) = (chain[0], chain[chain.len() - 1]);
    points
}
