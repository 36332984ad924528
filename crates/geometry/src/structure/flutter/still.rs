//! Non-oscillatory motions: divergence, and modes whose frequency has vanished.
//!
//! Real roots λ have the aerodynamic forces of steady displacements. In modal coordinates they satisfy λ² + C λ + A(p)
//! = 0 with A(p) = K − p Q(0) at the dynamic pressure p. Without damping, λ² = −a for each real eigenvalue a of A.
//! Divergence, K q = p Q(0) q, occurs where one of them becomes negative.
//!
//! A coordinate without stiffness has a ∝ p: either it diverges at any speed (p = 0), or the stream provides stiffness.
//! Displacements that cause neither elastic nor aerodynamic forces, such as the position of a free body, are neutral at
//! every speed. They are eliminated from A such that the free body accelerates under its load (inertia relief; Rodden
//! and Love 1985, doi:10.2514/3.45236). A spring, however soft, would carry the load instead: the divergence of a free
//! body is not the limit of that of a softly supported one.
use std::ops::Range;

use num_complex::Complex64;

use super::{Branch, Crossing, Flutter, Kind, Modes, Point, REAL, RIGID, STEPS, ZERO, largest_share, least};
use crate::math::dense::Factors;
use crate::math::eigenvalues::eigenvalues;
use crate::math::singular::Singular;

/// Aerodynamic force of a steady displacement, relative to the largest one, that counts as zero: the error of computed
/// forces.
const UNFELT: f64 = 1e-3;
/// Relative distance in dynamic pressure from a boundary at which growing motions are counted.
const BESIDE: f64 = 1e-6;
/// Rate of a motion relative to the fastest one below which it is neutral: the root of round-off.
const SLOW: f64 = 1e-7;

/// Non-oscillatory motions as functions of x.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StillMotions {
    /// For each divergence, in ascending order of speed, the motion that is neutral there and unstable above it, or
    /// below it.
    pub growing: Vec<Vec<Point>>,
    /// For each mode, its motion after it has ceased to oscillate: decay or growth; empty where it causes no force.
    pub resting: Vec<Vec<Point>>,
}

/// The equations of the steady displacements that cause elastic or aerodynamic forces.
pub(super) struct Felt {
    /// Number of displacements; those without stiffness come first.
    n: usize,
    free: usize,
    /// The displacements in modal coordinates, one after another.
    basis: Vec<Vec<f64>>,
    /// Displacements that cause no forces, in modal coordinates.
    unfelt: Vec<Vec<f64>>,
    stiffness: Vec<f64>,
    forces: Vec<f64>,
    damping: Vec<f64>,
}

impl Flutter<'_> {
    /// Divergence points below `upto`.
    pub(super) fn divergence(&self, modes: &Modes, upto: f64) -> Vec<Crossing> {
        let Some(felt) = self.felt(modes) else { return Vec::new() };
        let free = felt.free_growth();
        let mut found: Vec<(f64, Vec<f64>)> = free.into_iter().map(|shape| (0.0, shape)).collect();
        let pressures = felt.neutral_pressures().into_iter();
        found.extend(pressures.filter(|p| self.place(*p) <= upto).map(|p| (p, felt.softest(p))));
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let crossing = |(k, (p, shape)): (usize, (f64, Vec<f64>))| {
            self.still_crossing(modes, k, self.place(p), felt.in_modes(modes, &shape))
        };
        found.into_iter().enumerate().map(crossing).collect()
    }

    fn still_crossing(&self, modes: &Modes, branch: usize, x: f64, shape: Vec<Complex64>) -> Crossing {
        let (speed, pressure, mode) = (self.speed(x), self.pressure(x), largest_share(&shape));
        let (kind, shape, branch) = (Kind::Divergence, modes.coordinates(&shape), Branch::Divergence(branch));
        Crossing { kind, branch, mode, x, speed, pressure, frequency: 0.0, kappa: 0.0, shape }
    }

    /// Non-oscillatory motions up to `upto`, in addition to the oscillatory `branches`.
    ///
    /// The slowest growing motion is neutral at a divergence point: above it, or below it where the growth ends. Faster
    /// growing motions and all decaying ones belong to modes whose frequency has vanished.
    pub fn still_motions(&self, branches: &[Vec<Point>], upto: f64) -> StillMotions {
        let mut all = StillMotions { growing: Vec::new(), resting: vec![Vec::new(); branches.len()] };
        let Some((modes, felt)) = self.modes.as_ref().and_then(|m| Some((m, self.felt(m)?))) else { return all };
        let point = |x: f64, rate: f64| Point { x, speed: self.speed(x), lambda: rate.into(), shape: Vec::new() };
        let neutral: Vec<(f64, bool)> =
            self.divergence(modes, upto).iter().map(|c| (c.x, felt.begins_at(c.pressure))).collect();
        let begun = |k: &usize, x: f64| neutral[*k].1 && neutral[*k].0 <= x;
        let ending = |k: &usize, x: f64| !neutral[*k].1 && neutral[*k].0 > x;
        all.growing = neutral.iter().map(|(x, begins)| begins.then(|| point(*x, 0.0)).into_iter().collect()).collect();
        for step in 1..=STEPS as usize {
            let x = upto * step as f64 / STEPS;
            let (growing, decaying) = felt.rates(self.pressure(x));
            // the slowest first: the one that ends next, then the one that started last
            let ends = (0..neutral.len()).filter(|k| ending(k, x));
            let own = (0..neutral.len()).rev().filter(|k| begun(k, x)).collect::<Vec<_>>();
            let room = growing.len().saturating_sub(own.len());
            let own: Vec<usize> = ends.take(room).chain(own).collect();
            let (fast, slow) = growing.split_at(growing.len().saturating_sub(own.len()));
            own.iter().zip(slow.iter().rev()).for_each(|(k, rate)| all.growing[*k].push(point(x, *rate)));
            // the mode that ceased to oscillate first is the fastest
            let last = |m: usize| branches[m].last().map_or((0.0, false), |p| (p.x, p.lambda.re > 0.0));
            let mut still: Vec<usize> = (0..branches.len()).filter(|m| last(*m).0 < x).collect();
            still.sort_by(|a, b| last(*a).0.total_cmp(&last(*b).0));
            let (grown, decayed): (Vec<usize>, Vec<usize>) = still.into_iter().partition(|m| last(*m).1);
            let unfelt = std::iter::repeat_n(0.0, modes.n - felt.n);
            let rates = decaying.into_iter().chain(unfelt);
            grown.into_iter().zip(fast).for_each(|(m, rate)| all.resting[m].push(point(x, *rate)));
            decayed.into_iter().zip(rates).for_each(|(m, rate)| all.resting[m].push(point(x, rate)));
        }
        all.growing.iter_mut().zip(&neutral).filter(|(_, n)| !n.1).for_each(|(b, n)| b.push(point(n.0, 0.0)));
        all
    }

    /// Displacements that cause neither elastic nor aerodynamic forces, in coordinates: displacements of a free body.
    pub fn free_displacements(&self) -> Vec<Vec<Complex64>> {
        let Some((modes, felt)) = self.modes.as_ref().and_then(|m| Some((m, self.felt(m)?))) else { return Vec::new() };
        felt.unfelt.iter().map(|v| modes.coordinates(&v.iter().map(|q| (*q).into()).collect::<Vec<_>>())).collect()
    }

    /// Roots λ of the natural modes in a vacuum, in ascending order of the undamped frequency.
    pub fn in_still_air(&self) -> Vec<Complex64> {
        let Some(modes) = &self.modes else { return Vec::new() };
        let n = modes.n;
        let real = |a: &[Complex64]| a.iter().map(|z| z.re).collect::<Vec<f64>>();
        let found = quadratic(&real(&modes.stiffness), &real(&modes.damping), n);
        let natural = |square: &f64| Complex64::new(0.0, square.max(0.0).sqrt());
        let nearest = |to: Complex64| {
            let above = found.iter().filter(|z| z.im > 0.0);
            above.copied().min_by(|a, b| (a - to).norm().total_cmp(&(b - to).norm())).unwrap_or(to)
        };
        let rigid = modes.rigid();
        modes
            .squares
            .iter()
            .map(natural)
            .enumerate()
            .map(|(m, z)| if rigid.contains(&m) { ZERO } else { nearest(z) })
            .collect()
    }

    /// The equations of steady displacements; `None` where the forces at zero frequency are not finite.
    fn felt(&self, modes: &Modes) -> Option<Felt> {
        let forces: Vec<f64> = self.modal(modes, 0.0)?.iter().map(|f| f.re).collect();
        Some(Felt::new(modes, &forces))
    }
}

impl Felt {
    fn new(modes: &Modes, forces: &[f64]) -> Self {
        let (n, rigid) = (modes.n, modes.rigid());
        let column = |j: usize| (0..n).map(|i| forces[i * n + j]).collect::<Vec<f64>>();
        let size = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let largest = (0..n).map(|j| size(&column(j))).fold(0.0, f64::max);
        let felt = Singular::of(rigid.clone().map(column).collect());
        let pairs = felt.left.iter().zip(&felt.right);
        let (of_rigid, unfelt): (Vec<_>, Vec<_>) = pairs.partition(|(force, _)| size(force) > UNFELT * largest);
        let in_modes = |v: &[f64]| (0..n).map(|k| if rigid.contains(&k) { v[k - rigid.start] } else { 0.0 }).collect();
        let [mut basis, unfelt] =
            [of_rigid, unfelt].map(|all| all.into_iter().map(|(_, v)| in_modes(v)).collect::<Vec<Vec<f64>>>());
        let free = basis.len();
        let stiff = (0..n).filter(|m| !rigid.contains(m));
        basis.extend(stiff.map(|m| (0..n).map(|k| if k == m { 1.0 } else { 0.0 }).collect()));
        let project = |entry: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
            let product =
                |a: &Vec<f64>, b: &Vec<f64>| (0..n * n).map(|e| a[e / n] * entry(e / n, e % n) * b[e % n]).sum::<f64>();
            basis.iter().flat_map(|a| basis.iter().map(move |b| product(a, b))).collect()
        };
        // stiffness due to round-off is set to zero
        let is_rigid = |k: usize| rigid.contains(&k);
        let stiffness = project(&|i, j| if is_rigid(i) || is_rigid(j) { 0.0 } else { modes.stiffness[i * n + j].re });
        let damping = project(&|i, j| modes.damping[i * n + j].re);
        let forces = project(&|i, j| forces[i * n + j]);
        Self { n: basis.len(), free, basis, unfelt, stiffness, forces, damping }
    }

    /// The block `rows` × `columns` of the forces.
    fn block(&self, rows: Range<usize>, columns: Range<usize>) -> Vec<f64> {
        rows.flat_map(|i| columns.clone().map(move |j| (i, j))).map(|(i, j)| self.forces[i * self.n + j]).collect()
    }

    /// Displacements without stiffness that grow at any speed.
    fn free_growth(&self) -> Vec<Vec<f64>> {
        let m = self.free;
        let forces = self.block(0..m, 0..m);
        let largest = self.forces.iter().fold(0.0f64, |most, f| most.max(f.abs()));
        let values = eigenvalues(&forces, m).unwrap_or_default();
        let growing = values.into_iter().filter(|v| v.re > UNFELT * largest && v.im.abs() <= REAL * v.re);
        let shape = |value: Complex64| {
            let less = |i: usize, j: usize| forces[i * m + j] - if i == j { value.re } else { 0.0 };
            let own = null((0..m).map(|j| (0..m).map(|i| less(i, j)).collect()).collect());
            own.into_iter().chain(std::iter::repeat_n(0.0, self.n - m)).collect()
        };
        growing.map(shape).collect()
    }

    /// Positive dynamic pressures at which a displacement is in equilibrium. 1/p are the positive eigenvalues of K⁻¹ Q,
    /// where displacements without stiffness are eliminated by the condition that no force acts on them.
    fn neutral_pressures(&self) -> Vec<f64> {
        let (m, stiff) = (self.free, self.n - self.free);
        let stiffness: Vec<f64> =
            (0..stiff * stiff).map(|e| self.stiffness[(m + e / stiff) * self.n + m + e % stiff]).collect();
        let mut forces = self.block(m..self.n, m..self.n);
        if m > 0 {
            let Some(free) = Factors::new(m, self.block(0..m, 0..m)) else { return Vec::new() };
            let (rows, columns) = (self.block(m..self.n, 0..m), self.block(0..m, m..self.n));
            for j in 0..stiff {
                let column: Vec<f64> = (0..m).map(|i| columns[i * stiff + j]).collect();
                let mut follows = vec![0.0; m];
                free.solve(&column, &mut follows);
                for i in 0..stiff {
                    let less: f64 = (0..m).map(|k| rows[i * m + k] * follows[k]).sum();
                    forces[i * stiff + j] -= less;
                }
            }
        }
        let Some(factors) = Factors::new(stiff, stiffness).filter(|_| stiff > 0) else { return Vec::new() };
        let mut compliance = vec![0.0; stiff * stiff];
        for j in 0..stiff {
            let column: Vec<f64> = (0..stiff).map(|i| forces[i * stiff + j]).collect();
            let mut solved = vec![0.0; stiff];
            factors.solve(&column, &mut solved);
            (0..stiff).for_each(|i| compliance[i * stiff + j] = solved[i]);
        }
        let values = eigenvalues(&compliance, stiff).unwrap_or_default();
        let largest = values.iter().fold(0.0f64, |most, v| most.max(v.norm()));
        let real = values.into_iter().filter(|v| v.im.abs() <= REAL * v.re && v.re > f64::EPSILON * largest);
        real.map(|v| v.re.recip()).collect()
    }

    /// The matrix K − p Q.
    fn at(&self, pressure: f64) -> Vec<f64> {
        self.stiffness.iter().zip(&self.forces).map(|(k, q)| k - pressure * q).collect()
    }

    /// Number of negative eigenvalues of K − p Q.
    fn negative(&self, pressure: f64) -> usize {
        let values = eigenvalues(&self.at(pressure), self.n).unwrap_or_default();
        values.iter().filter(|v| v.re < 0.0 && v.im.abs() <= REAL * -v.re).count()
    }

    /// True where a motion becomes unstable with increasing dynamic pressure at `p`, false where it becomes stable.
    fn begins_at(&self, p: f64) -> bool {
        let [before, after] = [1.0 - BESIDE, 1.0 + BESIDE].map(|part| self.negative(part * p));
        p == 0.0 || before <= after
    }

    /// The displacement for which K − p Q is softest.
    fn softest(&self, pressure: f64) -> Vec<f64> {
        let a = self.at(pressure);
        null((0..self.n).map(|j| (0..self.n).map(|i| a[i * self.n + j]).collect()).collect())
    }

    /// Rates of the growing motions and of the decaying motions, the fastest first in both lists.
    fn rates(&self, pressure: f64) -> (Vec<f64>, Vec<f64>) {
        let all = quadratic(&self.at(pressure), &self.damping, self.n);
        let slow = SLOW * all.iter().map(|z| z.norm()).fold(0.0, f64::max);
        let real = all.into_iter().filter(|z| z.im.abs() <= slow && z.re.abs() > slow).map(|z| z.re);
        let (mut growing, mut decaying): (Vec<f64>, Vec<f64>) = real.partition(|rate| *rate > 0.0);
        growing.sort_by(|a, b| b.total_cmp(a));
        decaying.sort_by(f64::total_cmp);
        (growing, decaying)
    }

    /// A displacement in modal coordinates.
    fn in_modes(&self, modes: &Modes, shape: &[f64]) -> Vec<Complex64> {
        let one = |k: usize| self.basis.iter().zip(shape).map(|(b, q)| b[k] * q).sum::<f64>();
        (0..modes.n).map(|k| one(k).into()).collect()
    }
}

impl Modes {
    /// Range of the modes without stiffness.
    pub(super) fn rigid(&self) -> Range<usize> {
        let least = RIGID * self.squares.iter().fold(0.0f64, |most, square| most.max(square.abs()));
        let below = |limit: f64| self.squares.iter().filter(|square| **square < limit).count();
        below(-least)..self.squares.iter().filter(|square| !(**square > least)).count()
    }
}

/// The vector of unit length whose product with the matrix of these columns is smallest.
fn null(columns: Vec<Vec<f64>>) -> Vec<f64> {
    let mut singular = Singular::of(columns);
    let place = least(singular.squares().into_iter());
    singular.right.swap_remove(place)
}

/// Roots λ of λ² + C λ + A = 0.
fn quadratic(a: &[f64], damping: &[f64], n: usize) -> Vec<Complex64> {
    let size = 2 * n;
    let mut matrix = vec![0.0; size * size];
    for i in 0..n {
        matrix[i * size + n + i] = 1.0;
        for j in 0..n {
            matrix[(n + i) * size + j] = -a[i * n + j];
            matrix[(n + i) * size + n + j] = -damping[i * n + j];
        }
    }
    eigenvalues(&matrix, size).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::super::super::Matrices;
    use super::*;

    fn section(plunge: f64, pitch: f64) -> Matrices {
        Matrices { mass: vec![1.0, -0.1, -0.1, 0.25], damping: vec![0.0; 4], stiffness: vec![plunge, 0.0, 0.0, pitch] }
    }

    /// Lift and moment of the angle, ahead of the axis by `arm`, with quasi-steady damping.
    fn forces(arm: f64) -> impl Fn(f64) -> Vec<Complex64> {
        move |kappa: f64| {
            let rate = Complex64::new(0.0, kappa);
            [-rate, Complex64::from(1.0), -arm * rate, arm - 0.3 * rate].map(|f| 0.05 * f).to_vec()
        }
    }

    fn first(m: &Matrices, arm: f64) -> Vec<Crossing> {
        let forces = forces(arm);
        let flutter = Flutter::new(m, &forces);
        flutter.crossings(&flutter.branches(4.0), 4.0)
    }

    #[test] // p = K_α/(0.05 a)
    fn without_stiffness_the_speed_of_divergence_is_zero() {
        for (pitch, exact) in [(0.1, 10f64.sqrt()), (1e-9, 1e-4 * 10f64.sqrt()), (0.0, 0.0)] {
            let found = first(&section(0.2, pitch), 0.2);
            let own: Vec<&Crossing> = found.iter().filter(|c| c.kind == Kind::Divergence).collect();
            assert!(own.len() == 1 && (own[0].x - exact).abs() < 1e-9, "{pitch}: {found:?}");
            assert_eq!((own[0].branch, own[0].frequency), (Branch::Divergence(0), 0.0));
            assert!(own[0].shape[1].norm() > 0.3, "{:?}", own[0].shape);
        }
        // behind the axis the stream holds it
        assert!(first(&section(0.2, 0.0), -0.2).iter().all(|c| c.kind != Kind::Divergence));
    }

    #[test]
    fn a_mode_without_stiffness_that_the_stream_holds_is_followed() {
        let (m, forces) = (section(0.2, 0.0), forces(-0.2));
        let branches = Flutter::new(&m, &forces).branches(4.0);
        assert!(branches.iter().all(|b| b.len() > 200 && b[b.len() - 1].x == 4.0), "{:?}", branches[0].last());
        // its frequency goes with the speed
        let [a, b] = [1, 2].map(|k| &branches[0][k]);
        assert!((a.lambda.im / a.x - b.lambda.im / b.x).abs() < 0.02 * a.lambda.im / a.x);
    }

    #[test] // pitch on a spring, free in plunge: the moment is that about the centre of mass, where the body turns
    fn a_free_body_diverges_about_its_centre_of_mass() {
        let m = section(0.0, 0.1);
        for arm in [0.2, 0.4] {
            // m (K_α − p a L) + S p L = 0 with the coupling S = −m x_α, x_α = 0.1
            let pressure: f64 = 0.1 / (0.05 * (arm + 0.1));
            let found = first(&m, arm);
            let own: Vec<&Crossing> = found.iter().filter(|c| c.kind == Kind::Divergence).collect();
            assert!(own.len() == 1 && (own[0].x - pressure.sqrt()).abs() < 1e-9, "{own:?} {}", pressure.sqrt());
        }
        let forces = forces(0.4);
        let flutter = Flutter::new(&m, &forces);
        // place stays neutral at every speed
        let still = flutter.still_motions(&[Vec::new(), Vec::new()], 4.0);
        assert!(still.resting.iter().any(|b| !b.is_empty() && b.iter().all(|p| p.lambda == ZERO)), "{still:?}");
    }

    #[test] // K_α = p a L on a spring of plunge of any stiffness; without it the body turns about its centre of mass
    fn a_soft_spring_of_plunge_bears_the_load_that_a_free_body_accelerates_under() {
        let divergence = |plunge: f64| {
            let found = first(&section(plunge, 0.1), 0.2);
            let own: Vec<&Crossing> = found.iter().filter(|c| c.kind == Kind::Divergence).collect();
            assert_eq!(own.len(), 1, "{plunge}: {found:?}");
            own[0].x
        };
        let held = (0.1f64 / (0.05 * 0.2)).sqrt();
        for plunge in [0.2, 0.05, 1e-3, 1e-5, 1e-8] {
            assert!((divergence(plunge) / held - 1.0).abs() < 1e-6, "{plunge}: {} {held}", divergence(plunge));
        }
        assert!((divergence(0.0) / (0.1f64 / (0.05 * 0.3)).sqrt() - 1.0).abs() < 1e-9);
        let forces = forces(0.2);
        let of = |plunge: f64| Flutter::new(&section(plunge, 0.1), &forces).free_displacements();
        let free = of(0.0);
        assert!(free.len() == 1 && free[0][1].norm() < 1e-9 * free[0][0].norm(), "{free:?}");
        assert!(of(1e-8).is_empty());
    }

    #[test] // without damping frequencies that have met may part on the real axis: one motion grows, the other ceases to at det A = 0
    fn a_motion_that_ceases_to_grow_is_told_before_its_divergence() {
        let m =
            Matrices { mass: vec![1.0, 0.4, 0.4, 0.25], damping: vec![0.0; 4], stiffness: vec![0.2, 0.0, 0.0, 0.2] };
        let forces = |_: f64| [0.0, 0.05, 0.0, 0.01].map(Complex64::from).to_vec();
        let flutter = Flutter::new(&m, &forces);
        let branches = flutter.branches(8.0);
        let found = flutter.crossings(&branches, 8.0);
        let divergence: Vec<&Crossing> = found.iter().filter(|c| c.kind == Kind::Divergence).collect();
        assert!(divergence.len() == 1 && (divergence[0].x - 20f64.sqrt()).abs() < 1e-9, "{found:?}");
        let still = flutter.still_motions(&branches, 8.0);
        let own = &still.growing[0];
        let ends = [own.first().unwrap(), own.last().unwrap()];
        assert!(ends.iter().any(|p| p.lambda == ZERO && (p.x - 20f64.sqrt()).abs() < 1e-9), "{own:?}");
    }

    #[test] // λ² = −a
    fn branches_of_divergence_begin_there_and_every_mode_is_told() {
        let m = Matrices { mass: vec![1.0], damping: vec![0.0], stiffness: vec![1.0] };
        let forces = |_: f64| vec![Complex64::from(0.25)];
        let flutter = Flutter::new(&m, &forces);
        let branches = flutter.branches(4.0);
        let still = flutter.still_motions(&branches, 4.0);
        let growing = &still.growing[0];
        assert!((growing[0].x - 2.0).abs() < 1e-12 && growing[0].lambda == ZERO);
        let last = growing.last().unwrap();
        assert!(last.x == 4.0 && (last.lambda.re - 3f64.sqrt()).abs() < 1e-9);
        let resting = still.resting[0].last().unwrap();
        assert!(resting.x == 4.0 && (resting.lambda.re + 3f64.sqrt()).abs() < 1e-9);
        assert_eq!(flutter.in_still_air(), [Complex64::new(0.0, 1.0)]);
    }
}
