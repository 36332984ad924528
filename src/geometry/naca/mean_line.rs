//! Mean lines of NACA sections of four and five digits: height, slope and second derivative.
//!
//! Five digits (Jacobs and Pinkerton, NACA report 537, 1935), for a design lift coefficient of 0.3:
//! y = k₁/6 (x³ − 3 r x² + r² (3 − r) x) before r, k₁ r³/6 (1 − x) behind; reflexed
//! y = k₁/6 ((x − r)³ − κ (1 − r)³ x − r³ x + r³) before r, with κ (x − r)³ in place of (x − r)³ behind. r, k₁ and κ = k₂/k₁ as published.
use crate::case::MeanLine;

/// Design lift coefficient of the published numbers.
const LIFT: f64 = 0.3;
/// r and k₁ of the lines 210 to 250 (Abbott and von Doenhoff 1959, p. 115).
const CUBIC: [[f64; 2]; 5] = [[0.0580, 361.4], [0.1260, 51.64], [0.2025, 15.957], [0.2900, 6.643], [0.3910, 3.230]];
/// r, k₁ and k₂/k₁ of the lines 221 to 251 (Ladson and Brooks, NASA TM X-3284, 1975).
#[expect(clippy::approx_constant, reason = "a place on the chord")]
const REFLEXED: [[f64; 3]; 4] =
    [[0.1300, 51.990, 0.000_764], [0.2170, 15.793, 0.006_77], [0.3180, 6.520, 0.0303], [0.4410, 3.191, 0.1355]];

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
    }
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
        ];
        for line in lines {
            for x in [0.01, 0.15, 0.31, 0.5, 0.9] {
                let ([low, high], (_, slope, bend)) = ([x - 1e-6, x + 1e-6].map(|x| at(&line, x)), at(&line, x));
                assert!(((high.0 - low.0) / 2e-6 - slope).abs() < 1e-8, "{line:?} {x}");
                assert!(((high.1 - low.1) / 2e-6 - bend).abs() < 1e-6, "{line:?} {x}");
            }
        }
    }
}
