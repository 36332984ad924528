//! Half thickness of NACA sections of four and five digits, as functions of s = √x.
//!
//! Standard form (Jacobs, Ward, Pinkerton, NACA report 460, 1933):
//! y = 5 τ (0.2969 √x − 0.1260 x − 0.3516 x² + 0.2843 x³ − a₄ x⁴); a₄ = 0.1015 as published leaves a base, 0.1036 closes it at x = 1.
//!
//! Modified form (Stack and von Doenhoff, NACA report 492, 1934), 5 τ times
//! a₀ √x + a₁ x + a₂ x² + a₃ x³ before the place m of greatest thickness and d₀ + d₁ (1 − x) + d₂ (1 − x)² + d₃ (1 − x)³ behind it. d₀ is
//! the base, d₁ the slope at the end, tabulated for each m; d₂ and d₃ make the half thickness 0.1 at m, where its slope vanishes. a₀ is
//! that of the standard form times a sixth of the index of the nose radius; the other a make height, slope and curvature go on
//! through m.
use super::six_series::Six;
use crate::case::ThicknessForm;

/// Standard coefficients but the last.
const STANDARD: [f64; 4] = [0.2969, -0.1260, -0.3516, 0.2843];
/// Last coefficient as published, and with a closed end.
const LAST: [f64; 2] = [0.1015, 0.1036];
/// Base of a modified form as published.
const BASE: f64 = 0.002;
/// d₁ for m = 0.2 to 0.6 (report 492, table I; Abbott and von Doenhoff 1959, p. 117).
const END_SLOPE: [f64; 5] = [0.2, 0.234, 0.315, 0.465, 0.7];
/// Half thickness at m of a section of 20 %, which the coefficients are those of.
const HALF: f64 = 0.1;
/// Index of the nose radius of the standard form.
const STANDARD_INDEX: f64 = 6.0;
/// Index from which on the radius is three times that of the standard form, and √3.
const LARGE_INDEX: (f64, f64) = (9.0, 1.732_050_807_568_877_2);

/// A form of half thickness.
#[derive(Clone, Debug)]
pub(super) enum Thickness {
    /// Of four digits: thickness, last coefficient.
    Standard(f64, f64),
    /// Modified.
    Modified(Modified),
    /// Of the 6-series.
    Six(Six),
}

/// Coefficients of a modified form.
#[derive(Clone, Debug)]
pub(super) struct Modified {
    thickness: f64,
    place: f64,
    a: [f64; 4],
    d: [f64; 4],
}

impl Thickness {
    /// The form with a greatest thickness, closed at x = 1 or as published.
    pub(super) fn new(thickness: f64, form: ThicknessForm, closed: bool) -> Self {
        match form {
            ThicknessForm::Standard => Self::Standard(thickness, LAST[usize::from(closed)]),
            ThicknessForm::Modified { nose, place } => {
                Self::Modified(Modified::new(thickness, (nose, place), if closed { 0.0 } else { BASE }))
            }
            ThicknessForm::Six(series) => Self::Six(Six::new(thickness, series, closed)),
        }
    }

    /// Half thickness and its derivative with respect to s = √x.
    pub(super) fn at(&self, s: f64) -> (f64, f64) {
        match self {
            Self::Standard(thickness, last) => {
                let c = [STANDARD[0], STANDARD[1], STANDARD[2], STANDARD[3], -last];
                let x = s * s;
                let value = c[0] * s + x * (c[1] + x * (c[2] + x * (c[3] + x * c[4])));
                let slope = c[0] + s * (2.0 * c[1] + x * (4.0 * c[2] + x * (6.0 * c[3] + x * 8.0 * c[4])));
                (5.0 * thickness * value, 5.0 * thickness * slope)
            }
            Self::Modified(form) => form.at(s),
            Self::Six(form) => form.at(s),
        }
    }

    /// Where the half thickness vanishes, at x = 1 or behind it, by Newton's method: 1.008930411 for the standard form as published.
    pub(super) fn end(&self) -> f64 {
        let mut s = 1.0_f64;
        for _ in 0..20 {
            let (value, slope) = self.at(s);
            if value == 0.0 {
                break;
            }
            s -= value / slope;
        }
        s * s
    }
}

impl Modified {
    fn new(thickness: f64, (index, place): (f64, f64), base: f64) -> Self {
        let behind = 1.0 - place;
        let tenths = (10.0 * place).round() as usize;
        let end = END_SLOPE[tenths - 2];
        let (rise, fall) = (HALF - base, end * behind);
        // d₂ k² + d₃ k³ = rise − fall and 2 d₂ k² + 3 d₃ k³ = −fall, k the length behind m
        let d = [base, end, (3.0 * rise - 2.0 * fall) / behind.powi(2), (fall - 2.0 * rise) / behind.powi(3)];
        let curvature = 2.0 * d[2] + 6.0 * d[3] * behind;
        let radius = if index >= LARGE_INDEX.0 { LARGE_INDEX.1 } else { index / STANDARD_INDEX };
        let a0 = STANDARD[0] * radius;
        let root = place.sqrt();
        // a₁ m + a₂ m² + a₃ m³ = h, a₁ + 2 a₂ m + 3 a₃ m² = g, 2 a₂ + 6 a₃ m = c
        let (h, g, c) = (HALF - a0 * root, -0.5 * a0 / root, curvature + 0.25 * a0 / (root * place));
        let (p, q, r) = (h / place, g, c * place);
        let a3 = (p - q + 0.5 * r) / place.powi(2);
        let a2 = (0.5 * r - 3.0 * a3 * place.powi(2)) / place;
        let a1 = q - 2.0 * a2 * place - 3.0 * a3 * place.powi(2);
        Self { thickness, place, a: [a0, a1, a2, a3], d }
    }

    fn at(&self, s: f64) -> (f64, f64) {
        let (x, [a, d]) = (s * s, [&self.a, &self.d]);
        let (value, slope) = if x < self.place {
            let value = a[0] * s + x * (a[1] + x * (a[2] + x * a[3]));
            (value, a[0] + s * (2.0 * a[1] + x * (4.0 * a[2] + x * 6.0 * a[3])))
        } else {
            let left = 1.0 - x;
            let value = d[0] + left * (d[1] + left * (d[2] + left * d[3]));
            (value, -2.0 * s * (d[1] + left * (2.0 * d[2] + left * 3.0 * d[3])))
        };
        (5.0 * self.thickness * value, 5.0 * self.thickness * slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test] // coefficients and ordinates of NACA 0010-64 by the program of NASA TM X-3284 (Ladson and Brooks 1975), radius rounded there
    fn modified_forms_are_the_published_ones() {
        let Thickness::Modified(form) = Thickness::new(0.1, ThicknessForm::Modified { nose: 6.0, place: 0.4 }, false)
        else {
            unreachable!()
        };
        for (found, published) in form.a.iter().zip([0.296648, -0.246120, 0.174088, -0.265983]) {
            assert!((found - published).abs() < 2e-3, "{found} {published}");
        }
        for (found, published) in form.d.iter().zip([0.002, 0.315, -0.233333, -0.032407]) {
            assert!((found - published).abs() < 1e-6, "{found} {published}");
        }
        let table = [
            (0.0125, 0.01506),
            (0.05, 0.02721),
            (0.2, 0.04414),
            (0.4, 0.05),
            (0.6, 0.0443),
            (0.9, 0.01557),
            (1.0, 0.001),
        ];
        for (x, published) in table {
            assert!((form.at(f64::sqrt(x)).0 - published).abs() < 2e-5, "{x} {:?}", form.at(f64::sqrt(x)));
        }
    }

    #[test]
    fn modified_forms_go_on_smoothly_and_close() {
        for tenths in 2..=6 {
            for index in [0.0, 3.0, 6.0, 9.0] {
                let place = 0.1 * f64::from(tenths);
                let form = Thickness::new(0.12, ThicknessForm::Modified { nose: index, place }, true);
                let (value, slope) = form.at(place.sqrt());
                assert!((value - 0.06).abs() < 1e-12 && slope.abs() < 1e-12, "{tenths} {index}");
                let before = form.at(place.sqrt() - 1e-9);
                assert!((before.0 - 0.06).abs() < 1e-12 && before.1.abs() < 1e-7, "{before:?}");
                assert!(form.at(1.0).0.abs() < 1e-15);
            }
        }
    }
}
