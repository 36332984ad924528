//! Limit cycles: periodic motions of given amplitude, with speed and frequency as unknowns.
//!
//! With q(t) = q₀ + Re Σ q̂_n e^{inωt}, a structure with springs s_j(q_j) in a stream of u times the reference speed
//! and p times the reference dynamic pressure satisfies, harmonic by harmonic,
//!
//! (−n²ω²M + inωC + K) q̂_n + f̂_n − p (Q(inκ) q̂_n + δ̂_n) = 0, κ = ω/u,
//!
//! where f = s(q) − s(0) − s'(0) q is the nonlinear part of the spring forces and δ the nonlinear part of the
//! aerodynamic forces. u and p depend on the varied quantity x ([`Varied`]): u = x and p = x² at constant density. For
//! a structure in equilibrium with the steady forces F₀ at p₀, the equations for the means contain (p − p₀) F₀ on the
//! right-hand side as well. The harmonics of f are computed from its values at many instants of a period (alternating
//! frequency-time method: Cameron and Griffin 1989, doi:10.1115/1.3176036), so that aliasing is avoided. Amplitude and
//! phase of one coordinate are given, and ω and x are unknowns; a branch can therefore be followed around a fold, where
//! x decreases while the amplitude increases. The equations are solved by Newton's method with central differences.
//!
//! The initial guess for a given amplitude is the flutter point of the structure with the equivalent stiffness f̂₁/q̂₁
//! of the spring for a sinusoidal motion (describing function).
use num_complex::Complex64;

use super::flutter::{Crossing, Flutter, Kind, Varied};
use super::{Matrices, Spring};
use crate::math::dense::Factors;

/// Number of instants at which springs are evaluated: per harmonic, and the minimum.
const INSTANTS: [usize; 2] = [32, 256];
/// Greatest number of Newton steps.
const NEWTON: usize = 60;
/// Residual relative to the largest term at which the iteration ends, and the residual that is acceptable when it
/// stagnates.
const CONVERGED: [f64; 2] = [1e-12, 1e-8];
/// Relative step of the finite differences.
const CHANGE: f64 = 1e-6;
/// Fractions of a Newton step that are tried.
const SHORTER: [f64; 6] = [1.0, 0.5, 0.25, 0.1, 0.03, 0.01];
/// Fraction of a mode shape below which the coordinate does not participate in the mode.
const MOVES: f64 = 1e-9;
const ZERO: Complex64 = Complex64::new(0.0, 0.0);

/// A periodic motion q(t) = mean + Re Σ harmonics e^{inωt} of all coordinates, or the periodic forces on them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Periodic {
    /// Mean of each coordinate.
    pub mean: Vec<f64>,
    /// Complex amplitudes: `harmonics[n][j]` is harmonic n + 1 of coordinate j.
    pub harmonics: Vec<Vec<Complex64>>,
}

/// A limit cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Varied quantity x; U/U_ref unless another quantity is varied.
    pub x: f64,
    /// Speed ratio U/U_ref.
    pub speed: f64,
    /// Angular frequency in the time of the reference.
    pub omega: f64,
    /// Periodic motion of all coordinates.
    pub motion: Periodic,
}

/// A structure with nonlinear springs in a stream.
pub struct Oscillator<'a> {
    /// Matrices of small motions about rest.
    pub matrices: &'a Matrices,
    /// Spring of each coordinate.
    pub springs: &'a [Spring],
    /// Linear aerodynamic forces Q at the reduced frequency κ, row by row.
    pub forces: &'a (dyn Fn(f64) -> Vec<Complex64> + 'a),
    /// The varied quantity.
    pub varied: Varied<'a>,
    /// Index of the coordinate whose amplitude is given.
    pub coordinate: usize,
    /// Steady aerodynamic forces in equilibrium with the structure; `None`: the initial placement is an equilibrium at
    /// any speed.
    pub borne: Option<&'a Borne>,
}

/// Steady aerodynamic forces in the static equilibrium about which the structure moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Borne {
    /// Generalised force on each coordinate.
    pub forces: Vec<f64>,
    /// Dynamic pressure of this equilibrium relative to that of the reference.
    pub pressure: f64,
}

impl Periodic {
    /// Coordinate `j` at the phase ωt.
    pub fn at(&self, j: usize, phase: f64) -> f64 {
        let term = |(n, q): (usize, &Vec<Complex64>)| (q[j] * Complex64::cis((n + 1) as f64 * phase)).re;
        self.mean[j] + self.harmonics.iter().enumerate().map(term).sum::<f64>()
    }

    /// Mean and first `harmonics` harmonics of values at equidistant instants of a period.
    pub fn of_values(values: &[Vec<f64>], harmonics: usize) -> Self {
        let count = values.len() as f64;
        let coordinates = values.first().map_or(0, Vec::len);
        let term = |n: usize, j: usize| {
            let at =
                |(k, v): (usize, &Vec<f64>)| Complex64::cis(-std::f64::consts::TAU * (n * k) as f64 / count) * v[j];
            values.iter().enumerate().map(at).sum::<Complex64>() / count
        };
        let of = |n: usize| (0..coordinates).map(|j| 2.0 * term(n, j)).collect();
        Self { mean: (0..coordinates).map(|j| term(0, j).re).collect(), harmonics: (1..=harmonics).map(of).collect() }
    }

    /// The motion with `count` harmonics: truncated, or extended by zeros.
    pub fn with_harmonics(&self, count: usize) -> Self {
        let mut all = self.clone();
        all.harmonics.resize(count, vec![ZERO; self.mean.len()]);
        all
    }

    /// Linear interpolation `self` + `part` (`other` − `self`).
    pub fn towards(&self, other: &Self, part: f64) -> Self {
        let other = other.with_harmonics(self.harmonics.len());
        let mix = |a: &Vec<Complex64>, b: &Vec<Complex64>| a.iter().zip(b).map(|(a, b)| a + (b - a) * part).collect();
        Self {
            mean: self.mean.iter().zip(&other.mean).map(|(a, b)| a + part * (b - a)).collect(),
            harmonics: self.harmonics.iter().zip(&other.harmonics).map(|(a, b)| mix(a, b)).collect(),
        }
    }
}

impl Cycle {
    /// Frequency κ = ω/u at which the aerodynamic forces are evaluated.
    pub fn kappa(&self) -> f64 {
        self.omega / self.speed
    }
}

impl Oscillator<'_> {
    fn n(&self) -> usize {
        self.springs.len()
    }

    /// Nonlinear part of the force of spring `j`.
    fn beyond(&self, j: usize, q: f64) -> f64 {
        let spring = &self.springs[j];
        spring.force(q) - spring.force(0.0) - tangent(spring) * q
    }

    /// Flutter points of the structure with the equivalent stiffness for a sinusoidal motion of this amplitude, below
    /// `upto`.
    pub fn begin(&self, amplitude: f64, upto: f64) -> Vec<(Kind, Cycle)> {
        let (c, n) = (self.coordinate, self.n());
        let count = INSTANTS[1];
        let sine = |k: usize| {
            let cosine = (std::f64::consts::TAU * k as f64 / count as f64).cos();
            2.0 / count as f64 * self.beyond(c, amplitude * cosine) * cosine
        };
        let more = (0..count).map(sine).sum::<f64>() / amplitude;
        let mut seen = self.matrices.clone();
        seen.stiffness[c * (n + 1)] += more;
        let flutter = Flutter::new(&seen, self.forces).varying(self.varied);
        let crossings = flutter.crossings(&flutter.branches(upto), upto);
        let cycle = |crossing: Crossing| {
            let largest = crossing.shape.iter().map(|z| z.norm()).fold(0.0, f64::max);
            let own = crossing.shape[c];
            let moves = crossing.kind != Kind::Divergence && own.norm() > MOVES * largest;
            moves.then(|| {
                let harmonic = crossing.shape.iter().map(|z| z / own * amplitude).collect();
                let motion = Periodic { mean: vec![0.0; n], harmonics: vec![harmonic] };
                (crossing.kind, Cycle { x: crossing.x, speed: crossing.speed, omega: crossing.frequency, motion })
            })
        };
        crossings.into_iter().filter_map(cycle).collect()
    }

    /// Nonlinear part of the forces `forces` in a cycle.
    pub fn beyond_small(&self, cycle: &Cycle, forces: &Periodic) -> Periodic {
        let (n, motion) = (self.n(), &cycle.motion);
        let of = |h: usize, q: &[Complex64]| -> Vec<Complex64> {
            let small = (self.forces)(h as f64 * cycle.kappa());
            (0..n).map(|i| (0..n).map(|j| small[i * n + j] * q[j]).sum()).collect()
        };
        let mean: Vec<Complex64> = motion.mean.iter().map(|q| Complex64::from(*q)).collect();
        let harmonics = motion.harmonics.iter().zip(&forces.harmonics).enumerate();
        let less = |(h, (q, f)): (usize, (&Vec<Complex64>, &Vec<Complex64>))| {
            f.iter().zip(of(h + 1, q)).map(|(f, small)| f - small).collect()
        };
        Periodic {
            mean: forces.mean.iter().zip(of(0, &mean)).map(|(f, small)| f - small.re).collect(),
            harmonics: harmonics.map(less).collect(),
        }
    }

    /// The cycle near `guess` in which the first harmonic of the coordinate has the given amplitude, with this number
    /// of harmonics. `beyond` is the nonlinear part of the aerodynamic forces. `None` when Newton's method does not
    /// converge.
    pub fn solve(&self, guess: &Cycle, amplitude: f64, harmonics: usize, beyond: Option<&Periodic>) -> Option<Cycle> {
        let n = self.n();
        let none = Periodic { mean: vec![0.0; n], harmonics: Vec::new() };
        let problem = Problem {
            own: self,
            amplitude,
            harmonics,
            beyond: beyond.unwrap_or(&none).with_harmonics(harmonics),
            scale: Scale::of(self, guess, amplitude),
        };
        let mut y = problem.pack(guess);
        let (mut r, mut size) = problem.residual(&y)?;
        for _ in 0..NEWTON {
            if size <= CONVERGED[0] {
                break;
            }
            let step = Factors::new(y.len(), problem.jacobian(&y)?)?;
            let mut change = vec![0.0; y.len()];
            step.solve(&r, &mut change);
            let tried = SHORTER.iter().find_map(|part| {
                let next: Vec<f64> = y.iter().zip(&change).map(|(y, c)| y - part * c).collect();
                problem.residual(&next).filter(|(_, s)| *s < size).map(|(r, s)| (next, r, s))
            });
            let Some((next, new, smaller)) = tried else { break };
            (y, r, size) = (next, new, smaller);
        }
        (size <= CONVERGED[1]).then(|| problem.unpack(&y))
    }
}

/// Stiffness s'(0) at rest.
fn tangent(spring: &Spring) -> f64 {
    spring.force(crate::math::jet::Jet::variable(0.0)).first
}

/// Scales of the unknowns and of the equations.
struct Scale {
    coordinate: Vec<f64>,
    force: Vec<f64>,
    x: f64,
    omega: f64,
}

impl Scale {
    fn of(own: &Oscillator<'_>, guess: &Cycle, amplitude: f64) -> Self {
        let n = own.n();
        let first = &guess.motion.harmonics[0];
        let coordinate: Vec<f64> = (0..n).map(|j| first[j].norm().max(1e-3 * amplitude)).collect();
        let square = guess.omega * guess.omega;
        let force = |j: usize| {
            let term = |i: usize| {
                let k = j * n + i;
                (own.matrices.stiffness[k].abs() + square * own.matrices.mass[k].abs()) * coordinate[i]
            };
            (0..n).map(term).fold(f64::MIN_POSITIVE, f64::max)
        };
        let force = (0..n).map(force).collect();
        Self { coordinate, force, x: guess.x, omega: guess.omega }
    }
}

/// The equations of one cycle.
struct Problem<'a> {
    own: &'a Oscillator<'a>,
    amplitude: f64,
    harmonics: usize,
    beyond: Periodic,
    scale: Scale,
}

impl Problem<'_> {
    /// Means, real and imaginary parts of all harmonics, ω and x, in scaled form.
    fn pack(&self, cycle: &Cycle) -> Vec<f64> {
        let motion = cycle.motion.with_harmonics(self.harmonics);
        let unit = &self.scale.coordinate;
        let mut y: Vec<f64> = motion.mean.iter().zip(unit).map(|(q, u)| q / u).collect();
        for harmonic in &motion.harmonics {
            y.extend(harmonic.iter().zip(unit).flat_map(|(q, u)| [q.re / u, q.im / u]));
        }
        y.extend([cycle.omega / self.scale.omega, cycle.x / self.scale.x]);
        y
    }

    fn unpack(&self, y: &[f64]) -> Cycle {
        let (n, unit) = (self.own.n(), &self.scale.coordinate);
        let harmonic = |row: &[f64]| (0..n).map(|j| Complex64::new(row[2 * j], row[2 * j + 1]) * unit[j]).collect();
        let (means, rest) = y.split_at(n);
        let (all, ends) = rest.split_at(2 * n * self.harmonics);
        let motion = Periodic {
            mean: means.iter().zip(unit).map(|(q, u)| q * u).collect(),
            harmonics: all.chunks_exact(2 * n).map(harmonic).collect(),
        };
        let x = ends[1] * self.scale.x;
        Cycle { omega: ends[0] * self.scale.omega, x, speed: self.own.varied.speed(x), motion }
    }

    /// All equations, each divided by its largest term, and the largest of them; `None` for unphysical values.
    fn residual(&self, y: &[f64]) -> Option<(Vec<f64>, f64)> {
        let cycle = self.unpack(y);
        if !(cycle.x > 0.0 && cycle.omega > 0.0) {
            return None;
        }
        let (n, m) = (self.own.n(), self.own.matrices);
        let springs = self.springs(&cycle.motion);
        let pressure = self.own.varied.pressure(cycle.x);
        let mut r = Vec::with_capacity(y.len());
        for h in 0..=self.harmonics {
            let (w, forces) = (h as f64 * cycle.omega, (self.own.forces)(h as f64 * cycle.kappa()));
            let of = |p: &Periodic, j: usize| match h {
                0 => Complex64::from(p.mean[j]),
                _ => p.harmonics[h - 1][j],
            };
            for i in 0..n {
                let structure = |j: usize| {
                    let k = i * n + j;
                    Complex64::new(m.stiffness[k] - w * w * m.mass[k], w * m.damping[k]) - pressure * forces[k]
                };
                let sum: Complex64 = (0..n).map(|j| structure(j) * of(&cycle.motion, j)).sum();
                let more = |b: &Borne| (pressure - b.pressure) * b.forces[i];
                let rest = if h == 0 { self.own.borne.map_or(0.0, more) } else { 0.0 };
                let all = (sum + of(&springs, i) - pressure * of(&self.beyond, i) - rest) / self.scale.force[i];
                r.push(all.re);
                if h > 0 {
                    r.push(all.im);
                }
            }
        }
        let own = cycle.motion.harmonics[0][self.own.coordinate] / self.amplitude;
        r.extend([own.re - 1.0, own.im]);
        let size = r.iter().fold(0.0, |m: f64, r| if r.is_finite() { m.max(r.abs()) } else { f64::INFINITY });
        size.is_finite().then_some((r, size))
    }

    /// Nonlinear part of the spring forces.
    fn springs(&self, motion: &Periodic) -> Periodic {
        let count = (INSTANTS[0] * self.harmonics).max(INSTANTS[1]);
        let at = |k: usize| {
            let phase = std::f64::consts::TAU * k as f64 / count as f64;
            (0..self.own.n()).map(|j| self.own.beyond(j, motion.at(j, phase))).collect()
        };
        Periodic::of_values(&(0..count).map(at).collect::<Vec<Vec<f64>>>(), self.harmonics)
    }

    /// Jacobian of the equations, row by row.
    fn jacobian(&self, y: &[f64]) -> Option<Vec<f64>> {
        let n = y.len();
        let mut all = vec![0.0; n * n];
        for j in 0..n {
            let step = CHANGE * y[j].abs().max(1.0);
            let moved = |by: f64| {
                let mut y = y.to_vec();
                y[j] += by;
                self.residual(&y)
            };
            let ((forth, _), (back, _)) = (moved(step)?, moved(-step)?);
            (0..n).for_each(|i| all[i * n + j] = (forth[i] - back[i]) / (2.0 * step));
        }
        Some(all)
    }
}
