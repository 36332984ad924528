//! Mean lines of NACA sections: height, slope and second derivative.
//!
//! Five digits (Jacobs and Pinkerton, NACA report 537, 1935), for a design lift coefficient of 0.3:
//! y = k₁/6 (x³ − 3 r x² + r² (3 − r) x) before r, k₁ r³/6 (1 − x) behind; reflexed
//! y = k₁/6 ((x − r)³ − κ (1 − r)³ x − r³ x + r³) before r, with κ (x − r)³ in place of (x − r)³ behind. r, k₁ and κ = k₂/k₁ as published.
//!
//! 6-series: the load of thin sections is uniform to a and falls linearly from there to zero (Abbott, von Doenhoff and Stivers,
//! NACA report 824, 1945). Its slope is logarithmic at the nose, for a = 1 at both ends: next to an end, within half a percent of
//! the chord at the nose and a thousandth at the other, a parabola goes on to it. The A-series has the line a = 0.8 with a straight
//! end (Loftin, report 903, 1948); the published straight line misses the end of the chord by 6e-4 of the design lift, so the
//! whole is turned about the nose by that.
use std::f64::consts::PI;

use crate::case::MeanLine;

/// Design lift coefficient of the published numbers.
const LIFT: f64 = 0.3;
/// r and k₁ of the lines 210 to 250 (Abbott and von Doenhoff 1959, p. 115).
const CUBIC: [[f64; 2]; 5] = [[0.0580, 361.4], [0.1260, 51.64], [0.2025, 15.957], [0.2900, 6.643], [0.3910, 3.230]];
/// r, k₁ and k₂/k₁ of the lines 221 to 251 (Ladson and Brooks, NASA TM X-3284, 1975).
#[expect(clippy::approx_constant, reason = "a place on the chord")]
const REFLEXED: [[f64; 3]; 4] =
    [[0.1300, 51.990, 0.000_764], [0.2170, 15.793, 0.006_77], [0.3180, 6.520, 0.0303], [0.4410, 3.191, 0.1355]];

/// Parts of the chord at nose and end where the logarithm of the 6-series gives way to a parabola.
const BOUNDED: [f64; 2] = [0.005, 0.001];
/// a of the A-series, where its line becomes straight, and what its published ordinates divide the line of that a by.
const STRAIGHTENED: [f64; 3] = [0.8, 0.87437, 1.0209];

/// Height, slope and second derivative of a line at `x`.
pub(super) fn at(line: &MeanLine, x: f64) -> (f64, f64, f64) {
    match *line {
        MeanLine::Parabolas { camber: 0.0, .. } => (0.0, 0.0, 0.0),
        MeanLine::Parabolas { camber: m, place: p } => {
            let (q, base) = if x < p { (m / (p * p), 0.0) } else { (m / ((1.0 - p) * (1.0 - p)), 1.0 - 2.0 * p) };
            (q * (base + 2.0 * p * x - x * x), 2.0 * q * (p - x), -2.0 * q)
        }
        MeanLine::Cubic { lift, place } => {
            let [r, k] = CUBIC[place - 1];
            let k = k * lift / (6.0 * LIFT);
            if x < r {
                let height = x * (r * r * (3.0 - r) + x * (x - 3.0 * r));
                (k * height, k * (r * r * (3.0 - r) + x * (3.0 * x - 6.0 * r)), 6.0 * k * (x - r))
            } else {
                (k * r.powi(3) * (1.0 - x), -k * r.powi(3), 0.0)
            }
        }
        MeanLine::Reflexed { lift, place } => {
            let [r, k, ratio] = REFLEXED[place - 2];
            let k = k * lift / (6.0 * LIFT);
            let (part, from) = (if x < r { 1.0 } else { ratio }, x - r);
            let fall = ratio * (1.0 - r).powi(3) + r.powi(3);
            let height = part * from.powi(3) - fall * x + r.powi(3);
            (k * height, k * (3.0 * part * from * from - fall), 6.0 * k * part * from)
        }
        MeanLine::Uniform { lift, to } => scaled(bounded(x, |x| uniform(to, x)), lift),
        MeanLine::Straightened { lift } => {
            let [a, joint, divisor] = STRAIGHTENED;
            let last = uniform(a, joint);
            let whole = |x: f64| if x < joint { uniform(a, x) } else { (last.0 + last.1 * (x - joint), last.1, 0.0) };
            let (height, slope, bend) = bounded(x, whole);
            let missed = whole(1.0).0;
            scaled((height - missed * x, slope - missed, bend), lift / divisor)
        }
    }
}

/// All three values times a factor.
fn scaled((height, slope, bend): (f64, f64, f64), factor: f64) -> (f64, f64, f64) {
    (factor * height, factor * slope, factor * bend)
}

/// A line with a parabola to each end, which joins it in height and slope and ends at the height that the line ends at.
fn bounded(x: f64, line: impl Fn(f64) -> (f64, f64, f64)) -> (f64, f64, f64) {
    let (end, side, from, part) = if x < BOUNDED[0] {
        (0.0, 1.0, x, BOUNDED[0])
    } else if x > 1.0 - BOUNDED[1] {
        (1.0, -1.0, 1.0 - x, BOUNDED[1])
    } else {
        return line(x);
    };
    let (height, slope, _) = line(end + side * part);
    // height of the end + α t + β t², t the distance from the end
    let (rise, slope) = (height - line(end).0, side * slope);
    let beta = (slope * part - rise) / part.powi(2);
    let alpha = slope - 2.0 * beta * part;
    (line(end).0 + from * (alpha + beta * from), side * (alpha + 2.0 * beta * from), 2.0 * beta)
}

/// The line of unit design lift whose load is uniform to `a` (report 824, equations of p. 11).
fn uniform(a: f64, x: f64) -> (f64, f64, f64) {
    // the second derivative is infinite at a, in a single point
    let log = |t: f64| t.abs().max(1e-12).ln();
    let left = 1.0 - x;
    if a == 1.0 {
        let k = -0.25 / PI;
        return (k * (left * log(left) + x * log(x)), k * (log(x) - log(left)), k * (1.0 / x + 1.0 / left));
    }
    let rest = 1.0 - a;
    let g = -(a * a * (0.5 * log(a) - 0.25) + 0.25) / rest;
    let h = rest * (0.5 * log(rest) - 0.25) + g;
    let k = 0.5 / (PI * (a + 1.0));
    let to = a - x;
    let height = (to * to * (0.5 * log(to) - 0.25) - left * left * (0.5 * log(left) - 0.25)) / rest;
    (
        k * (height - x * log(x) + g - h * x),
        k * ((left * log(left) - to * log(to)) / rest - log(x) - 1.0 - h),
        k * ((log(to) - log(left)) / rest - 1.0 / x),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Design lift by the theory of thin sections, and the moment about the quarter chord at any angle: with x = (1 − cos θ)/2 and
    /// A_n = 2/π ∫ dy/dx cos nθ dθ, the lift at the ideal angle is π A₁ and the moment −π/4 (A₁ − A₂).
    fn thin(line: &MeanLine) -> (f64, f64) {
        let n = 200_000;
        let mean = |order: f64| {
            let slope = |k: i32| {
                let theta = std::f64::consts::PI * (f64::from(k) + 0.5) / f64::from(n);
                at(line, 0.5 * (1.0 - theta.cos())).1 * (order * theta).cos()
            };
            2.0 / f64::from(n) * (0..n).map(slope).sum::<f64>()
        };
        let pi = std::f64::consts::PI;
        (-pi * mean(1.0), 0.25 * pi * (mean(1.0) - mean(2.0)))
    }

    /// Lift coefficient of the line at an angle of attack of zero, 2 ∫ dy/dx (cos θ − 1) dθ.
    fn lift_at_rest(line: &MeanLine) -> f64 {
        let n = 200_000;
        let part = |k: i32| {
            let theta = PI * (f64::from(k) + 0.5) / f64::from(n);
            at(line, 0.5 * (1.0 - theta.cos())).1 * (theta.cos() - 1.0)
        };
        2.0 * PI / f64::from(n) * (0..n).map(part).sum::<f64>()
    }

    /// Part of the design lift that the published numbers miss it by: r of the lines with camber far forward has two or three digits.
    const ROUNDED: [f64; 5] = [0.03, 0.007, 4e-4, 4e-4, 4e-4];

    #[test]
    fn lines_have_their_design_lift_and_reflexed_ones_no_moment() {
        for place in 1..=5 {
            for lift in [0.3, 0.6] {
                let (found, _) = thin(&MeanLine::Cubic { lift, place });
                assert!((found.abs() / lift - 1.0).abs() < ROUNDED[place - 1], "{place} {found}");
            }
        }
        for place in 2..=5 {
            let (lift, moment) = thin(&MeanLine::Reflexed { lift: 0.3, place });
            assert!((lift.abs() / 0.3 - 1.0).abs() < 0.02 && moment.abs() < 1.5e-3, "{place} {lift} {moment}");
        }
    }

    #[test]
    fn lines_of_the_six_series_have_their_design_lift_and_published_heights() {
        // a, ideal angle in degrees and moment of a design lift of 1 (Abbott and von Doenhoff 1959, pp. 394 to 405)
        for (to, angle, moment) in [(0.0, 4.56, -0.083), (0.5, 3.04, -0.139), (0.8, 1.54, -0.202), (1.0, 0.0, -0.250)] {
            let line = MeanLine::Uniform { lift: 1.0, to };
            let lift = 2.0 * PI * f64::to_radians(angle) + lift_at_rest(&line);
            // the bounded slope at the end takes 1.4 % of the lift and the moment of a = 1
            assert!((lift - 1.0).abs() < 0.015, "{to} {lift}");
            assert!((-thin(&line).1.abs() - moment).abs() < 4e-3, "{to} {:?}", thin(&line));
        }
        let lift = 2.0 * PI * f64::to_radians(1.40) + lift_at_rest(&MeanLine::Straightened { lift: 1.0 });
        assert!((lift - 1.0).abs() < 0.02, "{lift}");
        // % of the chord for a design lift of 1 (Abbott and von Doenhoff 1959, pp. 402, 405)
        for (x, height) in [(0.05, 1.840), (0.5, 6.790), (0.85, 3.683), (0.95, 1.163)] {
            assert!((100.0 * at(&MeanLine::Uniform { lift: 1.0, to: 0.8 }, x).0 - height).abs() < 1e-3, "{x}");
        }
        assert!((100.0 * at(&MeanLine::Uniform { lift: 1.0, to: 1.0 }, 0.5).0 - 5.516).abs() < 6e-4);
        for (x, height) in [(0.05, 1.803), (0.5, 6.651), (0.8, 4.673), (0.9, 2.452), (0.95, 1.226)] {
            let found = 100.0 * at(&MeanLine::Straightened { lift: 1.0 }, x).0;
            assert!((found - height).abs() < 0.05, "{x} {found}");
        }
    }

    #[test]
    fn greatest_camber_lies_in_its_place_and_lines_end_on_the_chord() {
        for place in 1..=5 {
            let line = MeanLine::Cubic { lift: 0.3, place };
            let at_place = at(&line, 0.05 * place as f64);
            assert!(at_place.1.abs() < 2e-3 && at(&line, 1.0).0.abs() < 1e-12, "{place} {at_place:?}");
        }
        for place in 2..=5 {
            let line = MeanLine::Reflexed { lift: 0.3, place };
            let at_place = at(&line, 0.05 * place as f64);
            assert!(
                at_place.1.abs() < 2e-3 && at(&line, 0.0).0 == 0.0 && at(&line, 1.0).0.abs() < 1e-5,
                "{place} {at_place:?}"
            );
        }
    }

    #[test]
    fn slopes_are_derivatives() {
        let lines = [
            MeanLine::Parabolas { camber: 0.02, place: 0.4 },
            MeanLine::Cubic { lift: 0.45, place: 3 },
            MeanLine::Reflexed { lift: 0.3, place: 4 },
            MeanLine::Uniform { lift: 0.4, to: 1.0 },
            MeanLine::Uniform { lift: 0.4, to: 0.6 },
            MeanLine::Straightened { lift: 0.4 },
        ];
        for line in lines {
            for x in [0.002, 0.01, 0.15, 0.31, 0.5, 0.9, 0.9992] {
                let ([low, high], (_, slope, bend)) = ([x - 1e-6, x + 1e-6].map(|x| at(&line, x)), at(&line, x));
                assert!(((high.0 - low.0) / 2e-6 - slope).abs() < 1e-8, "{line:?} {x}");
                assert!(((high.1 - low.1) / 2e-6 - bend).abs() < 1e-6 * (1.0 + bend.abs()), "{line:?} {x}");
            }
        }
    }
}
