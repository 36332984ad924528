//! Flutter of a typical section in incompressible flow.
//!
//! A flat plate of half chord b and mass m per span on plunge and pitch springs, with the loads of Theodorsen (NACA
//! report 496, 1935). They are continued to growing and decaying motions e^{st} by C(p) = K₁(p)/(K₀(p) + K₁(p)), p =
//! sb/U (Edwards, Ashley and Breakwell, AIAA J. 17, 1979), which is exact for linear potential flow. With z = h/b
//! positive up, α positive nose up, λ = s/ω_α = p V*, V* = U/(b ω_α), μ = m/(πρb²), ω̄ = ω_h/ω_α,
//!
//! (λ² + 2ζ_h ω̄ λ + ω̄²) z − x_α λ² α = V*² c_l/(πμ), −x_α λ² z + r_α² (λ² + 2ζ_α λ + 1) α = 2 V*² c_m/(πμ),
//!
//! with the coefficients of [`super::theodorsen`]. The determinant has two roots that start from those of the section
//! in still fluid at zero speed; flutter begins where one of them first crosses to a positive real part. A real root
//! crosses at zero: divergence, at V*² = μ r_α²/(1 + 2a).
use num_complex::Complex64;

use super::Error;
use super::theodorsen::{plate_loads, theodorsen_growing};

/// Reduced speed at which the roots are started: the aerodynamic stiffness and damping are negligible there.
const STILL: f64 = 1e-3;
/// Minimum number of steps in which roots are followed up to a speed.
const STEPS: usize = 400;
/// Maximum number of iterations of the secant method.
const MOST: usize = 60;
/// Relative change of a root at which the iteration ends: a few units in the last place.
const CONVERGED: f64 = 4e-16;
/// Number of bisections that reduce an interval of speeds to round-off.
const HALVINGS: usize = 60;

/// A typical section; lengths are divided by the half chord b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlutterSection {
    /// Mass ratio μ = m/(πρb²).
    pub mass_ratio: f64,
    /// Position a of the elastic axis, aft of mid-chord.
    pub axis: f64,
    /// Static unbalance x_α: distance of the centre of mass aft of the elastic axis.
    pub x_alpha: f64,
    /// Square of the radius of gyration, r_α²: moment of inertia about the elastic axis divided by m b².
    pub r_alpha2: f64,
    /// Ratio ω_h/ω_α of the uncoupled plunge and pitch frequencies.
    pub frequency_ratio: f64,
    /// Damping ratios ζ_h and ζ_α of the uncoupled degrees of freedom.
    pub damping: [f64; 2],
}

/// Flutter point: a harmonic motion that neither grows nor decays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlutterPoint {
    /// Reduced speed V* = U/(b ω_α).
    pub reduced_speed: f64,
    /// Frequency ratio ω/ω_α.
    pub frequency: f64,
}

impl FlutterPoint {
    /// Reduced frequency k = ωb/U.
    pub fn reduced_frequency(&self) -> f64 {
        self.frequency / self.reduced_speed
    }
}

type Matrix = [[Complex64; 2]; 2];

impl FlutterSection {
    /// Matrix of the equations for λ = s/ω_α at the reduced speed `v`.
    fn matrix(&self, lambda: Complex64, v: f64) -> Result<Matrix, Error> {
        let (zero, one) = (Complex64::new(0.0, 0.0), Complex64::new(1.0, 0.0));
        let (square, ratio, [zh, za]) = (lambda * lambda, self.frequency_ratio, self.damping);
        let p = lambda / v;
        let c = theodorsen_growing(p)?;
        let [plunge, pitch] = [[zero, one], [one, zero]].map(|motion| plate_loads(p, c, self.axis, motion));
        let loads = v * v / (std::f64::consts::PI * self.mass_ratio);
        let heave = square + 2.0 * zh * ratio * lambda + ratio * ratio;
        let twist = self.r_alpha2 * (square + 2.0 * za * lambda + 1.0);
        Ok([
            [heave - loads * plunge.lift, -self.x_alpha * square - loads * pitch.lift],
            [-self.x_alpha * square - 2.0 * loads * plunge.moment, twist - 2.0 * loads * pitch.moment],
        ])
    }

    /// Determinant of the equations for λ = s/ω_α at the reduced speed `v`; it vanishes for the free motions.
    pub fn determinant(&self, lambda: Complex64, v: f64) -> Result<Complex64, Error> {
        let m = self.matrix(lambda, v)?;
        Ok(m[0][0] * m[1][1] - m[0][1] * m[1][0])
    }

    /// Root λ = s/ω_α near `guess` at the reduced speed `v`: growth rate and angular frequency divided by ω_α. Returns
    /// an error if the iteration does not converge.
    pub fn root(&self, v: f64, guess: Complex64) -> Result<Complex64, Error> {
        let mut before = guess * Complex64::new(1.0, 1e-5);
        let mut now = guess;
        let mut value = [self.determinant(before, v)?, self.determinant(now, v)?];
        for _ in 0..MOST {
            let slope = (value[1] - value[0]) / (now - before);
            let change = value[1] / slope;
            if !change.is_finite() || change.norm() <= CONVERGED * now.norm() {
                return Ok(now);
            }
            (before, now) = (now, now - change);
            value = [value[1], self.determinant(now, v)?];
        }
        let rest = value[1].norm();
        // rounding may keep the last digits from settling
        if rest < 1e-12 {
            Ok(now)
        } else {
            Err(Error::Parameter { what: "residual of a root", value: rest, range: "none" })
        }
    }

    /// Frequencies divided by ω_α in still fluid with its added mass; the first is that of the mode with more plunge if
    /// it is the lower one.
    fn still(&self) -> [f64; 2] {
        let (mu, a) = (self.mass_ratio, self.axis);
        let (m, s, i) = (1.0 + 1.0 / mu, self.x_alpha - a / mu, self.r_alpha2 + (0.125 + a * a) / mu);
        let (w2, r2) = (self.frequency_ratio.powi(2), self.r_alpha2);
        let (quadratic, linear, constant) = (m * i - s * s, -(m * r2 + i * w2), w2 * r2);
        let root = (linear * linear - 4.0 * quadratic * constant).max(0.0).sqrt();
        let large = (root - linear) / (2.0 * quadratic);
        [(constant / (quadratic * large)).sqrt(), large.sqrt()]
    }

    /// Follows both roots from still fluid to the reduced speed `upto`; `see` is called with the speed and the roots,
    /// and ends the search by returning false.
    fn follow(&self, upto: f64, mut see: impl FnMut(f64, [Complex64; 2]) -> bool) -> Result<(), Error> {
        let start = self.still().map(|w| Complex64::new(0.0, w));
        let first = STILL.min(0.5 * upto);
        let mut path: Vec<(f64, [Complex64; 2])> = vec![(first, self.roots(first, start)?)];
        for k in 1..=STEPS {
            let v = first + (upto - first) * k as f64 / STEPS as f64;
            let (now, roots) = path[path.len() - 1];
            // linear extrapolation from the last two steps
            let guess = match path.len() {
                1 => roots,
                n => {
                    let (then, old) = path[n - 2];
                    std::array::from_fn(|m| roots[m] + (roots[m] - old[m]) * ((v - now) / (now - then)))
                }
            };
            let found = self.roots(v, guess)?;
            if !see(v, found) {
                return Ok(());
            }
            path.push((v, found));
        }
        Ok(())
    }

    fn roots(&self, v: f64, guess: [Complex64; 2]) -> Result<[Complex64; 2], Error> {
        Ok([self.root(v, guess[0])?, self.root(v, guess[1])?])
    }

    /// Both roots λ = s/ω_α at the reduced speed `v`, followed from still fluid.
    pub fn modes(&self, v: f64) -> Result<[Complex64; 2], Error> {
        let mut last = [Complex64::new(f64::NAN, f64::NAN); 2];
        self.follow(v, |_, roots| {
            last = roots;
            true
        })?;
        Ok(last)
    }

    /// Lowest reduced speed below `upto` at which a motion begins to grow; `None` if there is none.
    pub fn flutter(&self, upto: f64) -> Result<Option<FlutterPoint>, Error> {
        let (mut before, mut found) = ((STILL, [Complex64::new(-1.0, 0.0); 2]), None);
        self.follow(upto, |v, roots| {
            found = (0..2).find(|m| before.1[*m].re < 0.0 && roots[*m].re >= 0.0).map(|m| (before.0, v, roots[m]));
            before = (v, roots);
            found.is_none()
        })?;
        let Some((mut low, mut high, mut root)) = found else { return Ok(None) };
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            root = self.root(middle, root)?;
            if root.re < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(Some(FlutterPoint { reduced_speed: 0.5 * (low + high), frequency: root.im }))
    }

    /// Reduced speed of divergence; `None` for an elastic axis at or ahead of the quarter chord.
    pub fn divergence(&self) -> Option<f64> {
        let lever = 1.0 + 2.0 * self.axis;
        (lever > 0.0).then(|| (self.mass_ratio * self.r_alpha2 / lever).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn section([mass_ratio, axis, x_alpha, r_alpha2, frequency_ratio]: [f64; 5]) -> FlutterSection {
        FlutterSection { mass_ratio, axis, x_alpha, r_alpha2, frequency_ratio, damping: [0.0; 2] }
    }

    fn digits(a: f64, b: f64, unit: f64) {
        assert!((a - b).abs() <= 0.51 * unit, "{a} is not {b}");
    }

    #[test] // reference/harmonics/typical_section_flutter_linear.csv, rows of Mach 0
    fn sections_flutter_where_the_table_says() {
        let rows = [
            ([100.0, -0.5, 0.25, 0.25, 0.2], 0.083632258, 6.2566244, 0.52325563),
            ([40.0, -0.3, 0.2, 0.25, 0.4], 0.21264121, 2.9937178, 0.63658778),
            ([60.0, -2.0, 1.8, 3.48, 1.0], 0.13792225, 18.378811, 2.5348469),
            ([60.0, -0.6, 0.2, 0.29, 0.5], 0.14747213, 4.836198, 0.7132044),
            ([75.0, -0.6, 0.25, 0.75, 0.5], 0.11812175, 6.8956661, 0.81452818),
        ];
        let unit = |x: f64| 10f64.powf(x.log10().floor() - 7.0);
        for (numbers, k, v, omega) in rows {
            let found = section(numbers).flutter(25.0).unwrap().unwrap();
            digits(found.reduced_speed, v, unit(v));
            digits(found.frequency, omega, unit(omega));
            digits(found.reduced_frequency(), k, unit(k));
        }
        // isogai_typical_section/linear_theory_flutter_points.csv
        let found = section([100.0, -0.5, 0.25, 0.25, 0.3185]).flutter(10.0).unwrap().unwrap();
        digits(found.reduced_speed, 5.64046, 1e-5);
        digits(found.frequency, 0.56990, 1e-5);
        digits(found.reduced_frequency(), 0.10104, 1e-5);
    }

    #[test]
    fn motions_decay_below_and_grow_above() {
        let s = section([60.0, -2.0, 1.8, 3.48, 1.0]);
        let v = s.flutter(25.0).unwrap().unwrap().reduced_speed;
        let before = s.modes(0.9 * v).unwrap();
        // continues in steps short enough to stay on the same roots
        let mut roots = before;
        let mut most = |to: f64| {
            roots = s.roots(to * v, roots).unwrap();
            roots[0].re.max(roots[1].re)
        };
        let rates = [0.92, 0.94, 0.96, 0.97, 0.99, 1.0, 1.01, 1.02, 1.03].map(&mut most);
        assert!(rates[3] < -1e-4 && rates[5].abs() < 1e-10 && rates[8] > 1e-4, "{rates:?}");
        for root in before {
            assert!(s.determinant(root, 0.9 * v).unwrap().norm() < 1e-12);
            // the second equation holds for the mode shape from the first
            let m = s.matrix(root, 0.9 * v).unwrap();
            assert!((m[1][1] - m[1][0] * m[0][1] / m[0][0]).norm() < 1e-11);
        }
        assert_eq!(s.flutter(10.0).unwrap(), None);
        // damping increases the speed here; for Isogai's section with its large static unbalance it decreases it
        // (Ziegler's paradox)
        let bending = section([40.0, -0.3, 0.2, 0.25, 0.4]);
        let (damped, at) =
            (FlutterSection { damping: [0.01, 0.01], ..bending }, bending.flutter(10.0).unwrap().unwrap());
        assert!(damped.flutter(10.0).unwrap().unwrap().reduced_speed > at.reduced_speed);
    }

    #[test]
    fn still_fluid_adds_its_mass_and_nothing_else() {
        let light = section([1e9, -0.2, 0.3, 0.4, 0.6]);
        let [a, b] = light.still();
        // (1 − x²/r²) λ⁴ − (1 + ω̄²) λ² + ω̄² = 0 in vacuum
        for square in [a * a, b * b] {
            assert!(((1.0 - 0.09 / 0.4) * square * square - 1.36 * square + 0.36).abs() < 1e-8);
        }
        let s = section([5.0, -0.2, 0.3, 0.4, 0.6]);
        let found = s.modes(1e-6).unwrap();
        s.still().iter().zip(found).for_each(|(w, r)| assert!((r - Complex64::new(0.0, *w)).norm() < 1e-5));
    }

    #[test]
    fn divergence_is_a_root_at_zero() {
        let s = section([40.0, -0.3, 0.2, 0.25, 0.4]);
        let v = s.divergence().unwrap();
        assert!(s.determinant(Complex64::new(1e-9, 0.0), v).unwrap().norm() < 1e-7);
        assert!((v - 5.0).abs() < 1e-12 && section([60.0, -2.0, 1.8, 3.48, 1.0]).divergence().is_none());
    }
}
