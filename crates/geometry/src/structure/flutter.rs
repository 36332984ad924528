//! Flutter analysis (p-k method): speed, density or altitude of the stream is varied at constant Mach number.
//!
//! With x = U/U_ref, the speed relative to that for which matrices and time are given, motions q e^{λt} satisfy
//!
//! D(λ, x) q = [M λ² + C λ + K − x² Q(iκ)] q = 0, κ = Im λ/x,
//!
//! the p-k method (Hassig, J. Aircraft 8, 1971): the aerodynamic forces are those of the harmonic motion with the same
//! frequency, which is exact for neutral stability. κ = 0 is the limit of steady displacements. Where density is varied
//! instead, x is the dynamic pressure ratio, x² Q becomes x Q, and κ = Im λ/u with the speed u at x ([`Varied`]).
//!
//! The branches λ(x), one for each natural mode, are followed in modal coordinates, ΦᵀMΦ = 1: first at one low speed
//! while damping and aerodynamic forces are increased from zero, then along x. Newton's method for D q = 0, q₀ᴴ q = 1,
//! where q₀ is the previous shape, at fixed κ is embedded in a secant iteration for κ. The step is reduced where this
//! fails or where shapes change too much. In a conservative system, two roots that coalesce separate at right angles,
//! |λ − λ_F| ∝ |x − x_F|^½. Every branch turns right at this point, so that the two are distinguished: of two
//! coalescing frequencies, the lower one, which rises, becomes the unstable branch.
//!
//! A mode without stiffness starts with an artificial one that is removed as the forces are increased.
//!
//! Where density is varied, motions unstable from the start have their flutter point at 0 ([`Flutter::grows_from`]).
//!
//! Limits: a branch ends where its frequency reaches zero, and where no root is found. Non-oscillatory motions, among
//! them divergence, are treated separately ([`StillMotions`]).
pub use still::StillMotions;
pub use varied::Varied;

use num_complex::Complex64;

mod crossings;
mod g_method;
mod modal;
mod natural;
mod start;
pub mod state_space;
mod still;
mod varied;

use super::Matrices;
use modal::Modes;

/// First speed of a branch divided by the last.
const FIRST: f64 = 1e-3;
/// Minimum number of steps of a branch.
const STEPS: f64 = 200.0;
/// Minimum number of steps in which the forces are increased from zero.
const TURNED_ON: f64 = 4.0;
/// Relative step below which no further reduction is tried: branches turn or end there.
const SMALLEST: f64 = 1e-7;
/// Smallest squared cosine of the angle between the shapes before and after a step.
const SAME_SHAPE: f64 = 0.9;
/// Greatest relative change of a root in a step.
const SAME_ROOT: f64 = 0.2;
/// Relative distances of the initial guesses from a root where branches turn.
const BESIDE: [f64; 3] = [1e-3, 1e-2, 1e-4];
/// Greatest number of Newton steps; five reach round-off unless roots are close.
const NEWTON: usize = 40;
/// Greatest number of secant steps for κ.
const SECANT: usize = 60;
/// Relative change of the frequency at which the secant iteration ends, and at which it may stagnate.
const MATCHED: [f64; 2] = [1e-12, 1e-10];
/// Ratio of growth rate and root below which a motion is neutral; far above round-off.
const NEUTRAL: f64 = 1e-9;
/// Ratio of imaginary and real part below which an eigenvalue counts as real.
const REAL: f64 = 1e-8;
/// Squared frequency relative to the largest, below which a mode has no stiffness except round-off.
const RIGID: f64 = 1e-13;
const ZERO: Complex64 = Complex64::new(0.0, 0.0);

/// A structure and the aerodynamic forces on it.
pub struct Flutter<'a> {
    forces: &'a (dyn Fn(f64) -> Vec<Complex64> + 'a),
    modes: Option<Modes>,
    varied: Varied<'a>,
}

/// A point of a branch.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Varied quantity x; U/U_ref unless another quantity is varied.
    pub x: f64,
    /// Speed ratio U/U_ref.
    pub speed: f64,
    /// Root λ: growth rate (real part) and angular frequency (imaginary part), in the time of the reference.
    pub lambda: Complex64,
    /// Complex amplitudes of the coordinates, with generalised mass 1; phases are continuous along the branch.
    pub shape: Vec<Complex64>,
}

/// Kind of a stability boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Flutter: an oscillation becomes unstable.
    Flutter,
    /// Restabilisation: an unstable oscillation becomes stable again.
    Restabilised,
    /// Divergence: a steady displacement of any magnitude is in equilibrium.
    Divergence,
}

/// Branch to which a motion belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Branch of a natural mode; modes are numbered from 0 by ascending frequency.
    Mode(usize),
    /// A non-oscillatory growing motion; these are numbered from 0 by ascending speed of onset.
    Divergence(usize),
}

/// A point of neutral stability.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// Kind of the stability boundary.
    pub kind: Kind,
    /// Branch to which it belongs.
    pub branch: Branch,
    /// Natural mode (by ascending frequency) of the branch; for divergence, the mode with the largest displacement.
    pub mode: usize,
    /// Varied quantity x; U/U_ref unless another quantity is varied.
    pub x: f64,
    /// Speed ratio U/U_ref.
    pub speed: f64,
    /// Dynamic pressure divided by that of the reference.
    pub pressure: f64,
    /// Angular frequency Im λ in the time of the reference.
    pub frequency: f64,
    /// Frequency κ = Im λ/(U/U_ref) of the aerodynamic forces.
    pub kappa: f64,
    /// Complex amplitudes of the coordinates, with generalised mass 1.
    pub shape: Vec<Complex64>,
}

/// Varied quantity, and fraction of damping and forces that acts.
#[derive(Clone, Copy)]
struct Place {
    x: f64,
    on: f64,
}

#[derive(Clone)]
struct Root {
    place: Place,
    lambda: Complex64,
    /// Shape in modal coordinates, of length 1.
    shape: Vec<Complex64>,
    /// Derivative dλ/dx along the branch.
    rate: Complex64,
}

impl<'a> Flutter<'a> {
    /// Flutter analysis with the aerodynamic forces Q(iκ) per unit displacement at the speed U_ref, which `forces`
    /// returns for κ ≥ 0, row by row.
    pub fn new(matrices: &Matrices, forces: &'a (dyn Fn(f64) -> Vec<Complex64> + 'a)) -> Self {
        Self { forces, modes: Modes::new(matrices), varied: Varied::Speed }
    }

    /// The analysis with another varied quantity than the speed.
    pub fn varying(self, varied: Varied<'a>) -> Self {
        Self { varied, ..self }
    }

    /// Speed ratio U/U_ref at x.
    fn speed(&self, x: f64) -> f64 {
        self.varied.speed(x)
    }

    /// Dynamic pressure at x divided by that of the reference.
    fn pressure(&self, x: f64) -> f64 {
        self.varied.pressure(x)
    }

    /// x at which the dynamic pressure ratio is `pressure`.
    fn place(&self, pressure: f64) -> f64 {
        self.varied.place(pressure)
    }

    /// Branches of all natural modes in ascending order of frequency, from a low speed to `upto`. A branch that cannot
    /// be followed is empty; there are no branches when the mass matrix is not positive definite.
    pub fn branches(&self, upto: f64) -> Vec<Vec<Point>> {
        let (Some(modes), true) = (&self.modes, 0.0 < upto && upto.is_finite()) else { return Vec::new() };
        let Some(modes) = self.held(modes, upto) else { return vec![Vec::new(); modes.n] };
        (0..modes.n).map(|m| self.branch(&modes, m, upto)).collect()
    }

    /// The modes, with those without stiffness separated by the effect of the forces at the lowest speed.
    fn held(&self, modes: &Modes, upto: f64) -> Option<Modes> {
        let (mut held, rigid) = (modes.clone(), modes.rigid());
        if rigid.is_empty() {
            return Some(held);
        }
        let forces = self.modal(modes, 0.0)?.iter().map(|f| f.norm()).fold(0.0, f64::max);
        let least = self.pressure(FIRST * upto) * forces;
        for (place, m) in rigid.enumerate() {
            (held.squares[m], held.apart[m]) = (0.0, least * (place + 1).pow(2) as f64);
        }
        Some(held)
    }

    fn branch(&self, modes: &Modes, m: usize, upto: f64) -> Vec<Point> {
        let first = FIRST * upto;
        let Some(start) = self.begin(modes, m, first) else { return Vec::new() };
        let mut roots = self.followed_from_below(modes, m, &start).unwrap_or_default();
        let (path, _) = self.follow(modes, start.clone(), Place { x: upto, on: 1.0 }, (upto - first) / STEPS);
        roots.pop();
        let point = |root: Root| {
            let x = root.place.x;
            Point { x, speed: self.speed(x), lambda: root.lambda, shape: modes.coordinates(&root.shape) }
        };
        roots.into_iter().chain(std::iter::once(start)).chain(path).map(point).collect()
    }

    /// The root of natural mode `m` at the low value `x` of the varied quantity, where damping and forces are increased
    /// from zero.
    fn begin(&self, modes: &Modes, m: usize, x: f64) -> Option<Root> {
        let square = modes.squares[m] + modes.apart[m];
        if !(square > 0.0) {
            return None;
        }
        let shape = (0..modes.n).map(|k| if k == m { Complex64::from(1.0) } else { ZERO }).collect();
        let place = Place { x, on: 0.0 };
        let natural = Root { place, lambda: Complex64::new(0.0, square.sqrt()), shape, rate: ZERO };
        let (mut path, arrived) = self.follow(modes, natural, Place { on: 1.0, ..place }, TURNED_ON.recip());
        path.pop().filter(|_| arrived).map(|root| Root { rate: ZERO, ..root })
    }

    /// Forces Q(iκ) in modal coordinates; `None` when they are not finite.
    fn modal(&self, modes: &Modes, kappa: f64) -> Option<Vec<Complex64>> {
        let forces = (self.forces)(kappa);
        (forces.len() == modes.n * modes.n && forces.iter().all(|f| f.is_finite())).then(|| modes.project(&forces))
    }

    /// Roots on the line from `from` to `to` in steps of at most `longest`, and whether the end is reached.
    fn follow(&self, modes: &Modes, from: Root, to: Place, longest: f64) -> (Vec<Root>, bool) {
        let moves = [to.x - from.place.x, to.on - from.place.on];
        let length = moves[0] + moves[1];
        let smallest = SMALLEST * if moves[0] > 0.0 { to.x } else { 1.0 };
        let (mut now, mut path, mut left, mut step) = (from, Vec::new(), length, longest);
        while left > 0.0 {
            let place = |size: f64| {
                let part = (size / length).min(1.0);
                let Place { x, on } = now.place;
                if size >= left { to } else { Place { x: x + part * moves[0], on: on + part * moves[1] } }
            };
            let size = step.min(left);
            let mut taken = size;
            let found = match self.step(modes, &now, place(size), size, now.lambda + now.rate * size) {
                None if size > smallest => {
                    step = 0.5 * size;
                    continue;
                }
                None => {
                    taken = left.min(4.0 * smallest);
                    self.turn(modes, &now, place(taken), taken)
                }
                found => found,
            };
            let Some(root) = found else { return (path, false) };
            left = if taken >= left { 0.0 } else { left - taken };
            step = longest.min(2.0 * taken);
            path.push(root.clone());
            now = root;
        }
        (path, true)
    }

    /// The root at `place`, `size` away, near `guess`; `None` when there is none or it belongs to another branch.
    fn step(&self, modes: &Modes, from: &Root, place: Place, size: f64, guess: Complex64) -> Option<Root> {
        let (lambda, shape) = self.root(modes, place, guess, &from.shape)?;
        let turned = inner(&from.shape, &shape).norm_sqr();
        let change = lambda - from.lambda;
        let same = turned >= SAME_SHAPE && change.norm() <= SAME_ROOT * from.lambda.norm();
        same.then(|| Root { place, lambda, shape, rate: change / size })
    }

    /// The root beyond a point at which two roots coalesce: to the right of the direction of approach.
    fn turn(&self, modes: &Modes, from: &Root, place: Place, size: f64) -> Option<Root> {
        let speed = from.rate.norm();
        if !(speed > 0.0) {
            return None;
        }
        let right = from.rate / speed * -Complex64::i();
        let beside = |part: f64| {
            let guess = from.lambda + right * part * from.lambda.norm();
            let to_the_right = |root: &Root| (root.rate * right.conj()).re > 0.0;
            self.step(modes, from, place, size, guess).filter(to_the_right)
        };
        BESIDE.into_iter().find_map(beside)
    }

    /// Root and shape at `place` near a guess, with aerodynamic forces at the frequency of the root.
    fn root(
        &self,
        modes: &Modes,
        place: Place,
        guess: Complex64,
        near: &[Complex64],
    ) -> Option<(Complex64, Vec<Complex64>)> {
        let (mut lambda, mut shape) = (guess, near.to_vec());
        let (speed, pressure) = (self.speed(place.x), place.on * self.pressure(place.x));
        let mut kappa = lambda.im / speed;
        let (mut before, mut last) = (None::<[f64; 2]>, f64::INFINITY);
        for _ in 0..SECANT {
            // without oscillation there is no root of this kind
            if !(kappa > 0.0) {
                return None;
            }
            let mut dynamic = self.modal(modes, kappa)?;
            dynamic.iter_mut().zip(&modes.stiffness).for_each(|(q, k)| *q = k - *q * pressure);
            (lambda, shape) = modes.newton(&dynamic, place.on, (lambda, shape), near)?;
            let own = lambda.im / speed;
            let excess = own - kappa;
            let error = excess.abs() * speed / lambda.norm();
            if own > 0.0 && (error <= MATCHED[0] || (error <= MATCHED[1] && error >= last)) {
                let size = inner(&shape, &shape).re.sqrt();
                return Some((lambda, shape.into_iter().map(|q| q / size).collect()));
            }
            let secant = before.map(|[k, e]| kappa - excess * (kappa - k) / (excess - e));
            (before, last) = (Some([kappa, excess]), error);
            kappa = secant.filter(|k| 0.2 * own < *k && *k < 5.0 * own).unwrap_or(own);
        }
        None
    }
}

/// Relative growth rate Re λ/|λ|.
fn growth(lambda: Complex64) -> f64 {
    lambda.re / lambda.norm()
}

fn inner(a: &[Complex64], b: &[Complex64]) -> Complex64 {
    a.iter().zip(b).map(|(a, b)| a.conj() * b).sum()
}

/// Index of the smallest value; zero when there are no values.
fn least(values: impl Iterator<Item = f64>) -> usize {
    values.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |found| found.0)
}

/// Index of the mode with the largest share.
fn largest_share(shape: &[Complex64]) -> usize {
    least(shape.iter().map(|q| -q.norm()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrices(mass: &[f64], damping: &[f64], stiffness: &[f64]) -> Matrices {
        Matrices { mass: mass.to_vec(), damping: damping.to_vec(), stiffness: stiffness.to_vec() }
    }

    fn real(a: &[f64]) -> Vec<Complex64> {
        a.iter().map(|x| Complex64::from(*x)).collect()
    }

    fn kinds(found: &[Crossing]) -> Vec<Kind> {
        found.iter().map(|c| c.kind).collect()
    }

    /// |D q| divided by the magnitude of its terms.
    fn residual(
        m: &Matrices,
        forces: &dyn Fn(f64) -> Vec<Complex64>,
        x: f64,
        lambda: Complex64,
        q: &[Complex64],
    ) -> f64 {
        let n = q.len();
        let loads = forces(lambda.im / x);
        let entry = |k: usize| lambda * lambda * m.mass[k] + lambda * m.damping[k] + m.stiffness[k] - x * x * loads[k];
        let row = |i: usize| (0..n).map(|j| entry(i * n + j) * q[j]).sum::<Complex64>().norm();
        (0..n).map(row).fold(0.0, f64::max) / lambda.norm_sqr()
    }

    #[test] // p² − (a + d) p + a d − b c = 0 with a, d = ω² − x² Q_ii has a double root where (a − d)² + 4 x⁴ Q₁₂ Q₂₁ = 0
    fn frequencies_that_meet_flutter_where_they_do() {
        let m = matrices(&[1.0, 0.0, 0.0, 1.0], &[0.0; 4], &[1.0, 0.0, 0.0, 4.0]);
        let forces = |_: f64| real(&[0.0, 0.6, -0.5, 0.0]);
        let flutter = Flutter::new(&m, &forces);
        let branches = flutter.branches(4.0);
        let x = (9.0f64 / (4.0 * 0.3)).powf(0.25);
        let omega = 2.5f64.sqrt();
        let found = flutter.crossings(&branches, 4.0);
        assert_eq!(kinds(&found), [Kind::Flutter], "{found:?}");
        assert!((found[0].x / x - 1.0).abs() < 1e-12, "{:e}", found[0].x / x - 1.0);
        assert!((found[0].frequency / omega - 1.0).abs() < 1e-12 && found[0].mode == 0, "{found:?}");
        assert!((found[0].kappa - found[0].frequency / found[0].x).abs() < 1e-15);
        // beyond: −λ² = 5/2 ± i √(0.3 x⁴ − 9/4), one root grows, the other decays
        let exact = (-Complex64::new(2.5, (0.3 * 256.0f64 - 2.25).sqrt())).sqrt();
        let ends = [&branches[0], &branches[1]].map(|b| b[b.len() - 1].clone());
        for (end, sign) in ends.iter().zip([1.0, -1.0]) {
            let expected = Complex64::new(sign * exact.re.abs(), exact.im.abs());
            assert!(end.x == 4.0 && (end.lambda - expected).norm() < 1e-12, "{end:?} {expected}");
        }
        assert!(branches.iter().all(|b| b.len() > 200));
    }

    #[test] // with |Q₁₂ Q₂₁| > 0 and Q₁₁ − Q₂₂ of the right sign frequencies meet, go apart and are free again
    fn frequencies_that_part_are_stable_again() {
        let m = matrices(&[1.0, 0.0, 0.0, 1.0], &[0.0; 4], &[1.0, 0.0, 0.0, 4.0]);
        let forces = |_: f64| real(&[-1.0, 0.3, -0.3, 0.0]);
        let flutter = Flutter::new(&m, &forces);
        let branches = flutter.branches(3.5);
        let found = flutter.crossings(&branches, 3.5);
        // x² − 3 = ∓ 0.6 x²
        let exact = [(3.0f64 / 1.6).sqrt(), (3.0f64 / 0.4).sqrt()];
        assert_eq!(kinds(&found), [Kind::Flutter, Kind::Restabilised], "{found:?}");
        for (crossing, x) in found.iter().zip(exact) {
            let omega = ((5.0 + x * x) / 2.0).sqrt();
            assert!((crossing.x / x - 1.0).abs() < 1e-11 && (crossing.frequency / omega - 1.0).abs() < 1e-11);
        }
        assert!(branches.iter().all(|b| b[b.len() - 1].x == 3.5));
    }

    #[test]
    fn one_coordinate_follows_its_formula() {
        let m = matrices(&[2.0], &[0.1], &[8.0]);
        let forces = |kappa: f64| vec![Complex64::new(-0.5, -0.3 * kappa)];
        let flutter = Flutter::new(&m, &forces);
        let branches = flutter.branches(3.0);
        for point in &branches[0] {
            assert!(residual(&m, &forces, point.x, point.lambda, &point.shape) < 1e-11);
            // imaginary part: 4 σ ω + 0.1 ω + 0.3 x ω = 0
            assert!((point.lambda.re + 0.025 + 0.075 * point.x).abs() < 1e-12);
            assert!((point.shape[0].norm() - 0.5f64.sqrt()).abs() < 1e-14);
        }
        assert!(flutter.crossings(&branches, 3.0).is_empty());
    }

    #[test] // growth only while κ = 1/x is between 1/2 and 1
    fn forces_that_depend_on_frequency_stabilise_again() {
        let m = matrices(&[1.0], &[0.0], &[1.0]);
        let forces = |kappa: f64| {
            vec![Complex64::new(0.0, 0.01 * kappa * (kappa - 0.5) * (1.0 - kappa) / (1.0 + kappa * kappa))]
        };
        let flutter = Flutter::new(&m, &forces);
        let branches = flutter.branches(4.0);
        let found = flutter.crossings(&branches, 4.0);
        assert_eq!(kinds(&found), [Kind::Flutter, Kind::Restabilised], "{found:?}");
        for (crossing, x) in found.iter().zip([1.0, 2.0]) {
            assert!((crossing.x - x).abs() < 2e-12 && (crossing.frequency - 1.0).abs() < 1e-12, "{crossing:?}");
            assert!((crossing.kappa * x - 1.0).abs() < 1e-11 && crossing.mode == 0);
        }
    }

    #[test]
    fn a_real_root_diverges_and_its_branch_ends() {
        let m = matrices(&[2.0, 0.3, 0.3, 1.0], &[0.0; 4], &[3.0, 0.0, 0.0, 5.0]);
        let forces = |_: f64| real(&[0.0, 1.0, 0.0, 0.8]);
        let flutter = Flutter::new(&m, &forces);
        let found = flutter.crossings(&flutter.branches(4.0), 4.0);
        let divergence: Vec<&Crossing> = found.iter().filter(|c| c.kind == Kind::Divergence).collect();
        assert_eq!(divergence.len(), 1);
        // 5 = 0.8 x², 3 q₁ = x² q₂
        let x = 2.5;
        assert!((divergence[0].x - x).abs() < 1e-12 && divergence[0].frequency == 0.0 && divergence[0].kappa == 0.0);
        assert!((divergence[0].shape[0] / divergence[0].shape[1] - x * x / 3.0).norm() < 1e-12);
        assert!(flutter.crossings(&[], 2.4).is_empty());
        let alone = matrices(&[1.0], &[0.0], &[1.0]);
        let forces = |_: f64| real(&[0.25]);
        let flutter = Flutter::new(&alone, &forces);
        let branch = flutter.branches(3.0).remove(0);
        let last = &branch[branch.len() - 1];
        assert!((last.x - 2.0).abs() < 1e-5 && last.lambda.im < 1e-2 && last.lambda.re == 0.0, "{last:?}");
        assert_eq!(kinds(&flutter.crossings(&[branch], 3.0)), [Kind::Divergence]);
    }

    #[test]
    fn many_modes_satisfy_their_equations() {
        let n = 5;
        let wave = |k: usize, s: f64| (s * (k * k + 1) as f64).sin();
        let even = |k: usize, s: f64| wave(k, s) + wave(k % n * n + k / n, s);
        let unit = |k: usize| f64::from(u8::from(k % n == k / n));
        let mass: Vec<f64> = (0..n * n).map(|k| 2.0 * unit(k) + 0.1 * even(k, 1.3)).collect();
        let stiffness: Vec<f64> =
            (0..n * n).map(|k| unit(k) * ((k / n + 1) as f64).powi(2) + 0.1 * even(k, 0.7)).collect();
        let damping: Vec<f64> = (0..n * n).map(|k| 0.02 * unit(k)).collect();
        let m = matrices(&mass, &damping, &stiffness);
        let forces = |kappa: f64| {
            let lag = Complex64::new(0.0, kappa) / Complex64::new(0.3, kappa);
            let entry =
                |k: usize| 0.1 * wave(k, 2.1) - 0.1 * lag * wave(k, 0.4) - Complex64::new(0.0, 0.1 * kappa * unit(k));
            (0..n * n).map(entry).collect::<Vec<_>>()
        };
        let branches = Flutter::new(&m, &forces).branches(3.0);
        assert_eq!(branches.len(), n);
        for branch in &branches {
            assert!(branch.len() > 200 && branch[branch.len() - 1].x == 3.0, "{} {:?}", branch.len(), branch.last());
            for pair in branch.windows(2) {
                let point = &pair[1];
                assert!(residual(&m, &forces, point.x, point.lambda, &point.shape) < 1e-11);
                assert!((point.lambda - pair[0].lambda).norm() < 0.1 * point.lambda.norm());
            }
        }
        // different branches have different roots
        let ends: Vec<Complex64> = branches.iter().map(|b| b[b.len() - 1].lambda).collect();
        assert!((0..n).all(|a| (0..a).all(|b| (ends[a] - ends[b]).norm() > 1e-3)), "{ends:?}");
    }

    #[test]
    fn equal_frequencies_are_told_apart_by_forces() {
        let m = matrices(&[1.0, 0.0, 0.0, 1.0], &[0.0; 4], &[1.0, 0.0, 0.0, 1.0]);
        let forces = |kappa: f64| vec![Complex64::new(-0.3, -0.1 * kappa), (0.1).into(), (0.2).into(), (0.2).into()];
        let branches = Flutter::new(&m, &forces).branches(1.0);
        assert!(branches.iter().all(|b| b.last().is_some_and(|p| p.x == 1.0)));
        let ends = [0, 1].map(|k| branches[k][branches[k].len() - 1].lambda);
        assert!((ends[0] - ends[1]).norm() > 0.1, "{ends:?}");
    }

    #[test]
    fn what_has_no_modes_has_no_branches() {
        let forces = |_: f64| real(&[0.1]);
        assert!(Flutter::new(&matrices(&[-1.0], &[0.0], &[1.0]), &forces).branches(1.0).is_empty());
        assert!(Flutter::new(&matrices(&[1.0], &[0.0], &[1.0]), &forces).branches(f64::NAN).is_empty());
        assert_eq!(Flutter::new(&matrices(&[1.0], &[0.0], &[0.0]), &forces).branches(1.0), [Vec::new()]);
        let broken = |_: f64| Vec::new();
        assert_eq!(Flutter::new(&matrices(&[1.0], &[0.0], &[1.0]), &broken).branches(1.0), [Vec::new()]);
    }
}
