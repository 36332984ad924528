//! Induced drag of a load along the span, as the wake far behind has it.
//!
//! With y = (b/2) cos θ the load for a unit of span is c c_l = 4 b Σ A_n sin nθ; in a flat wake (Glauert 1926)
//!
//! L/q = π b² A_1, D/q = π b² Σ n A_n², efficiency e = A_1²/Σ n A_n²,
//!
//! at all Mach numbers below 1, in free air on either side of one plane of symmetry at most: images in more of them change the wake, and a wing
//! from wall to wall has no induced drag at all. The A_n are fitted to the lift of strips, ∫ sin nθ dy = (b/4) [sin (n−1)θ/(n−1) − sin (n+1)θ/(n+1)] over
//! each of them, so that neither the width of strips nor the slope at the tips matters. Half a model has odd n alone.
use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::loads::LoadAxes;
use super::strips::{Span, Strips};
use crate::math::dense::solve;

/// Most terms, and strips for each of them at least.
const MOST: usize = 12;
const STRIPS: usize = 2;
/// Points of an ellipse that is drawn.
const POINTS: usize = 121;

/// Lift and induced drag of a load along the span.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpanLoad {
    /// Distance from tip to tip.
    pub span: f64,
    /// Place of the middle between them.
    pub centre: f64,
    /// c c_l over the reference chord in the middle of an elliptic load of that lift and span.
    pub elliptic: f64,
    /// Lift coefficient of the fit.
    pub cl: f64,
    /// Induced drag coefficient.
    pub cd_induced: f64,
    /// Induced drag of an elliptic load of that lift and span over it.
    pub efficiency: f64,
    /// What of the bodies a flat wake does not know.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<String>,
}

impl SpanLoad {
    /// The elliptic load of the same lift at places along the span, where there is one: place and c c_l over the reference chord.
    pub fn ellipse(&self, [low, high]: [f64; 2]) -> Vec<[f64; 2]> {
        let half = 0.5 * self.span;
        let [from, to] = [low, high].map(|y| ((y - self.centre) / half).clamp(-1.0, 1.0).asin());
        let point = |k: usize| {
            let angle = from + (to - from) * k as f64 / (POINTS - 1) as f64;
            [self.centre + half * angle.sin(), self.elliptic * angle.cos()]
        };
        (0..POINTS).map(point).collect()
    }
}

/// The load of all that lies, together; of half a model on one side of `plane`. `dynamic` is the dynamic pressure. `None` where nothing
/// lifts.
pub fn induced(bodies: &[Strips], plane: Option<f64>, axes: &LoadAxes, dynamic: f64) -> Option<SpanLoad> {
    let lying = || bodies.iter().filter(|b| b.span == Span::Lying).flat_map(|b| b.sides.iter().flat_map(|s| &s.strips));
    let all = || lying().flat_map(|s| s.ends);
    let [low, high] = all().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], s| [a.min(s), b.max(s)]);
    if low >= high {
        return None;
    }
    let centre = plane.unwrap_or(f64::midpoint(low, high));
    let half = (high - centre).max(centre - low);
    let width = lying().map(|s| s.width()).fold(0.0, f64::max);
    let n = ((high - low) / width).round().max(1.0) as usize;
    // the strips of all bodies on a common grid
    let at = |k: usize| low + (high - low) * k as f64 / n as f64;
    let mut lift = vec![0.0; n];
    for strip in lying() {
        let [a, b] = [strip.ends[0].min(strip.ends[1]), strip.ends[0].max(strip.ends[1])];
        let own: f64 = (0..3).map(|d| strip.load.force[d] * axes.lift[d]).sum();
        for (k, lift) in lift.iter_mut().enumerate() {
            *lift += own * (b.min(at(k + 1)) - a.max(at(k))).max(0.0) / (b - a);
        }
    }
    let angle = |k: usize| ((at(k) - centre) / half).clamp(-1.0, 1.0).acos();
    let terms = (n / STRIPS).clamp(1, if plane.is_some() { MOST } else { 2 * MOST });
    let order = |m: usize| if plane.is_some() { (2 * m + 1) as f64 } else { (m + 1) as f64 };
    let b = 2.0 * half;
    let basis = |m: usize, k: usize| 4.0 * b * 0.25 * b * (below(order(m), angle(k)) - below(order(m), angle(k + 1)));
    let row = |k: usize| (0..terms).map(|m| basis(m, k)).collect::<Vec<f64>>();
    let (mut matrix, mut right) = (vec![0.0; terms * terms], vec![[0.0]; terms]);
    for (k, lift) in lift.iter().enumerate() {
        let row = row(k);
        for i in 0..terms {
            (0..terms).for_each(|j| matrix[i * terms + j] += row[i] * row[j]);
            right[i][0] += row[i] * lift;
        }
    }
    if !solve(&mut matrix, &mut right) {
        return None;
    }
    let weighted: f64 = right.iter().enumerate().map(|(m, a)| order(m) * a[0] * a[0]).sum();
    let scale = PI * b * b / if plane.is_some() { 2.0 } else { 1.0 };
    let first = right[0][0];
    (weighted > 0.0).then(|| SpanLoad {
        span: b,
        centre,
        elliptic: 4.0 * b * first / (dynamic * axes.chord),
        cl: scale * first / axes.force_scale,
        // the terms are A_n times the dynamic pressure
        cd_induced: scale * weighted / (dynamic * axes.force_scale),
        efficiency: first * first / weighted,
        left_out: Vec::new(),
    })
}

/// ∫ sin nθ sin θ dθ up to θ, twice.
fn below(n: f64, theta: f64) -> f64 {
    let first = if n > 1.0 { ((n - 1.0) * theta).sin() / (n - 1.0) } else { theta };
    first - ((n + 1.0) * theta).sin() / (n + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::strips::{Section, Side, Wrench, side};

    /// Strips of the load A_1 sin θ + A_3 sin 3θ on a half wing of span 1 from its plane of symmetry.
    fn half_wing(n: usize, first: f64, third: f64) -> Strips {
        let to = |s: f64| s.acos();
        let of = |a: f64, b: f64| {
            4.0 * 2.0
                * 0.5
                * (first * (below(1.0, to(a)) - below(1.0, to(b))) + third * (below(3.0, to(a)) - below(3.0, to(b))))
        };
        let ends: Vec<[f64; 2]> = (0..n).map(|k| [k, k + 1].map(|k| k as f64 / n as f64)).collect();
        let load = |[a, b]: &[f64; 2]| Wrench { force: [0.0, 0.0, of(*a, *b)], moment: [0.0; 3] };
        let loads: Vec<Wrench> = ends.iter().map(load).collect();
        let sides: Vec<Side> = vec![side(&ends, &vec![[Section::default(); 2]; n], &loads)];
        Strips { body: "wing".into(), span: Span::Lying, lifting: true, sides }
    }

    fn axes(area: f64, dynamic: f64) -> LoadAxes {
        LoadAxes {
            dimension: 3,
            drag: [1.0, 0.0, 0.0],
            lift: [0.0, 0.0, 1.0],
            moment_point: [0.0; 3],
            force_scale: area * dynamic,
            chord: 1.0,
        }
    }

    #[test] // Glauert (1926)
    fn terms_of_the_load_give_lift_and_induced_drag() {
        let (q, area, a, c) = (2.0, 0.4, 0.03, 0.004);
        let found = induced(&[half_wing(30, q * a, q * c)], Some(0.0), &axes(area, q), q).unwrap();
        let whole = 2.0 * area;
        assert!((found.cl - PI * 4.0 * a / whole).abs() < 1e-12, "{found:?}");
        assert!((found.cd_induced - PI * 4.0 * (a * a + 3.0 * c * c) / whole).abs() < 1e-12, "{found:?}");
        assert!((found.efficiency - 1.0 / (1.0 + 3.0 * (c / a).powi(2))).abs() < 1e-10);
    }

    #[test]
    fn a_whole_wing_is_two_halves() {
        let half = half_wing(30, 0.03, 0.004);
        let mut whole = half.clone();
        let mirror =
            |s: &crate::observe::strips::Strip| crate::observe::strips::Strip { ends: s.ends.map(|e| -e), ..s.clone() };
        whole.sides.push(Side { strips: half.sides[0].strips.iter().map(mirror).collect() });
        let [one, two] = [
            induced(&[half], Some(0.0), &axes(0.4, 1.0), 1.0).unwrap(),
            induced(&[whole], None, &axes(0.8, 1.0), 1.0).unwrap(),
        ];
        assert!((one.cd_induced - two.cd_induced).abs() < 1e-10 && (one.cl - two.cl).abs() < 1e-10, "{one:?} {two:?}");
    }
}
