//! Forced vibration of structures by harmonic balance: the equations of a periodic motion and their preconditioner.
//!
//! The unknowns are the displacements u_n at the 2N + 1 instances of a period. With ∂/∂t = ωD, which is exact for N
//! harmonics, they satisfy f(t_n, u_n, (ωDu)_n) − M (ω²D²u)_n = 0 (Hall, Thomas and Clark, AIAA J. 40, 2002, for M u″ =
//! f instead of u′ = R). *Oversampling* evaluates f at more instances than there are unknowns and keeps its harmonics
//! up to N: with twice as many instances, products of three displacements are not aliased. The prescribed motion of
//! supports is truncated to its harmonics up to N.
//!
//! The linear systems are preconditioned for each harmonic k by a factorisation of (1 + ikωβ) K + (ikωα − k²ω²) M, with
//! the stiffness K averaged over all instances and the damping α M + β K.
use num_complex::Complex64;

use crate::math::fourier::{Instances, Matrix};
use crate::math::parallel::sweep;
use crate::math::reduce::{maximum, sum};
use crate::math::sparse::ComplexFactors;
use crate::system::{Damping, Fault, Mechanical, Moment};

/// Frequency and instances of a periodic motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periodic {
    /// Angular frequency ω [rad/time].
    pub omega: f64,
    /// Instances at which the displacements are unknowns.
    pub held: Instances,
    /// Instances at which forces are evaluated; at least as many as those of the unknowns.
    pub seen: Instances,
}

/// Equations of a periodic motion. Vectors hold the displacements of all instances, one instance after another.
pub struct Vibration<'a, S: Mechanical> {
    system: &'a S,
    periodic: Periodic,
    /// Internal variables of the materials; for other materials, the initial values of an evaluation.
    history: Vec<f64>,
    derivative: Matrix,
    up: Matrix,
    down: Matrix,
    work: S::Work,
    after: Vec<f64>,
    factors: Vec<ComplexFactors>,
}

/// Motion at one time.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Displacements of all degrees of freedom.
    pub displacement: Vec<f64>,
    /// Velocities of all degrees of freedom.
    pub velocity: Vec<f64>,
    /// Accelerations of all degrees of freedom.
    pub acceleration: Vec<f64>,
}

/// Stiffness, and any damping other than that proportional to mass, at all instances where forces are evaluated.
pub struct Linearised<S: Mechanical> {
    stiffness: Vec<S::Stiffness>,
    damping: Vec<S::Stiffness>,
}

impl<'a, S: Mechanical> Vibration<'a, S> {
    /// Equations for the motion `periodic` of `system`, whose materials have the internal variables `history`; these do
    /// not change.
    pub fn new(system: &'a S, periodic: Periodic, history: Vec<f64>) -> Self {
        let Periodic { omega, held, seen } = periodic;
        Self {
            derivative: held.derivative(omega),
            up: held.resample(&seen),
            down: seen.resample(&held),
            work: system.work(),
            after: vec![0.0; history.len()],
            factors: Vec::new(),
            system,
            periodic,
            history,
        }
    }

    /// The structure whose motion is periodic.
    pub fn system(&self) -> &'a S {
        self.system
    }

    /// Number of displacements of one instance.
    fn n(&self) -> usize {
        self.system.displacements()
    }

    /// Number of instances of the unknowns.
    fn count(&self) -> usize {
        self.periodic.held.count()
    }

    /// Number of unknowns of all instances.
    pub fn len(&self) -> usize {
        self.n() * self.count()
    }

    /// True if the structure has no degrees of freedom.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Imposes the displacements of the supports at all instances.
    pub fn hold(&self, u: &mut [f64]) {
        let (n, seen) = (self.n(), self.periodic.seen);
        let led: Vec<Vec<f64>> = seen
            .times(self.periodic.omega)
            .into_iter()
            .map(|t| {
                let mut at = vec![0.0; n];
                self.system.hold(t, &mut at);
                at
            })
            .collect();
        for (m, u) in u.chunks_exact_mut(n).enumerate() {
            for k in (0..n).filter(|k| self.system.is_held(*k)) {
                u[k] = self.down.row(m).iter().zip(&led).map(|(w, led)| w * led[k]).sum();
            }
        }
    }

    /// Sum Σ_j weights_j u_j over the instances.
    fn combined(&self, u: &[f64], weights: &[f64]) -> Vec<f64> {
        let n = self.n();
        let mut out = vec![0.0; n];
        sweep(&mut out, |k| weights.iter().enumerate().map(|(j, w)| w * u[j * n + k]).sum());
        out
    }

    /// Time derivative of `u` at all instances.
    fn rate(&self, u: &[f64]) -> Vec<f64> {
        (0..self.count()).flat_map(|m| self.combined(u, self.derivative.row(m))).collect()
    }

    /// Interpolates the displacements `u` from the instances of `from` to those of this motion: exact, or truncated to
    /// the harmonics that these can represent.
    pub fn resampled(&self, u: &[f64], from: Instances) -> Vec<f64> {
        let matrix = from.resample(&self.periodic.held);
        let mut all: Vec<f64> = (0..self.count()).flat_map(|m| self.combined(u, matrix.row(m))).collect();
        self.hold(&mut all);
        all
    }

    /// Displacement, velocity and acceleration at the phase ωt (rad).
    pub fn at_phase(&self, u: &[f64], phase: f64) -> Motion {
        let weights = self.periodic.held.weights(phase);
        let velocity = self.rate(u);
        let acceleration = self.rate(&velocity);
        let of = |q: &[f64]| self.combined(q, &weights);
        Motion { displacement: of(u), velocity: of(&velocity), acceleration: of(&acceleration) }
    }

    /// Writes the residual of the equations to `out` and returns the maximum force in it.
    pub fn residual(&mut self, u: &[f64], out: &mut [f64]) -> Result<f64, Fault> {
        let (n, system) = (self.n(), self.system);
        let velocity = self.rate(u);
        let acceleration = self.rate(&velocity);
        let free = |k: usize| f64::from(u8::from(!system.is_held(k)));
        sweep(out, |k| -free(k % n) * system.mass(k % n) * acceleration[k]);
        let mut largest = maximum(out.len(), |k| out[k].abs());
        let mut force = vec![0.0; n];
        for (m, time) in self.periodic.seen.times(self.periodic.omega).into_iter().enumerate() {
            let row = self.up.row(m);
            let (now, speed) = (self.combined(u, row), self.combined(&velocity, row));
            let at = Moment { time, step: 0.0, displacement: &now, velocity: &speed, history: &self.history };
            system.forces(&at, &mut self.work, &mut force, &mut self.after);
            system.check_forces(&self.work, &now)?;
            largest = largest.max(maximum(n, |k| free(k) * force[k].abs()));
            let (down, force) = (&self.down, &force);
            for (j, out) in out.chunks_exact_mut(n).enumerate() {
                let weight = down.row(j)[m];
                out.iter_mut().enumerate().for_each(|(k, out)| *out += weight * free(k) * force[k]);
            }
        }
        Ok(largest)
    }

    /// Stiffness and damping linearised about the motion `u`.
    pub fn linearise(&self, u: &[f64]) -> Linearised<S> {
        let velocity = self.rate(u);
        let of = |parts: [f64; 2]| {
            let one = |(m, time): (usize, f64)| {
                let row = self.up.row(m);
                let (now, speed) = (self.combined(u, row), self.combined(&velocity, row));
                let at = Moment { time, step: 0.0, displacement: &now, velocity: &speed, history: &self.history };
                self.system.linearise(&at, parts)
            };
            self.periodic.seen.times(self.periodic.omega).into_iter().enumerate().map(one).collect()
        };
        let damping = if self.system.damping().is_viscous { of([0.0, 1.0]) } else { Vec::new() };
        Linearised { stiffness: of([1.0, 0.0]), damping }
    }

    /// Computes out = −(∂r/∂u) w, the decrease of the residual due to `w`; the change of follower loads is neglected.
    pub fn product(&mut self, linear: &Linearised<S>, w: &[f64], out: &mut [f64]) {
        let (n, system) = (self.n(), self.system);
        let rate = self.rate(w);
        let acceleration = self.rate(&rate);
        let damping = system.damping().mass;
        let free = |k: usize| f64::from(u8::from(!system.is_held(k)));
        sweep(out, |k| free(k % n) * system.mass(k % n) * (acceleration[k] + damping * rate[k]));
        let mut force = vec![0.0; n];
        for m in 0..linear.stiffness.len() {
            let row = self.up.row(m);
            for (all, q) in [(&linear.stiffness, w), (&linear.damping, &rate[..])] {
                let Some(one) = all.get(m) else { continue };
                system.stiffness(one, &self.combined(q, row), &mut self.work, &mut force);
                let (down, force) = (&self.down, &force);
                for (j, out) in out.chunks_exact_mut(n).enumerate() {
                    let weight = down.row(j)[m];
                    out.iter_mut().enumerate().for_each(|(k, out)| *out += weight * free(k) * force[k]);
                }
            }
        }
    }

    /// Factors the preconditioner for `linear`; false if a matrix is singular.
    pub fn factor(&mut self, linear: &Linearised<S>) -> bool {
        let system = self.system;
        let part = 1.0 / linear.stiffness.len() as f64;
        let mut matrices = linear.stiffness.iter().map(|k| system.matrix(k, part, 0.0));
        let Some(mut mean) = matrices.next() else { return false };
        matrices.for_each(|one| mean.value.iter_mut().zip(&one.value).for_each(|(k, one)| *k += one));
        let damping = system.damping();
        let of = |m: usize| {
            let turn = m as f64 * self.periodic.omega;
            let inertia = quotient([-turn * turn, turn * damping.mass], elastic(damping, turn));
            let entry = |k: usize| match system.is_held(k) {
                true => [0.0; 2],
                false => inertia.map(|z| z * system.mass(k)),
            };
            mean.factor_with(&(0..self.n()).map(entry).collect::<Vec<_>>())
        };
        let all: Option<Vec<ComplexFactors>> = (0..=self.periodic.held.harmonics()).map(of).collect();
        self.factors = all.unwrap_or_default();
        !self.factors.is_empty()
    }

    /// Approximate solution z of the linear systems for the right-hand side `r`.
    pub fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        let (n, held, system) = (self.n(), self.periodic.held, self.system);
        let (forward, back, h) = (held.to_coefficients(), held.to_values(), held.harmonics());
        let damping = system.damping();
        let series: Vec<Vec<f64>> = (0..self.count()).map(|k| self.combined(r, forward.row(k))).collect();
        let mut found = vec![0.0; r.len()];
        for (m, factors) in self.factors.iter_mut().enumerate() {
            let elastic = elastic(damping, m as f64 * self.periodic.omega);
            // q = Re(q̂ exp(iωt)): q̂ = cosine − i sine
            let sine = |k: usize| if m == 0 { 0.0 } else { series[m + h][k] };
            let right = |k: usize| match system.is_held(k) {
                true => [0.0; 2],
                false => quotient([series[m][k], -sine(k)], elastic),
            };
            let mut x: Vec<[f64; 2]> = (0..n).map(right).collect();
            factors.solve(&mut x);
            for (k, x) in x.iter().enumerate() {
                found[m * n + k] = x[0];
                if m > 0 {
                    found[(m + h) * n + k] = -x[1];
                }
            }
        }
        for (m, z) in z.chunks_exact_mut(n).enumerate() {
            z.copy_from_slice(&self.combined(&found, back.row(m)));
        }
    }

    /// Fraction of the last harmonic in the whole motion, for displacements weighted by mass; a measure of truncation.
    /// If every second harmonic vanishes, the last one that does not is used. `None` with a single harmonic.
    pub fn tail(&self, u: &[f64]) -> Option<f64> {
        let (n, held) = (self.n(), self.periodic.held);
        let (forward, h) = (held.to_coefficients(), held.harmonics());
        let size = |m: usize| {
            let [cosine, sine] = [m, m + h].map(|k| self.combined(u, forward.row(k)));
            sum(n, |k| self.system.mass(k) * (cosine[k] * cosine[k] + sine[k] * sine[k])).sqrt()
        };
        let sizes: Vec<f64> = (1..=h).map(size).collect();
        let last = &sizes[h.saturating_sub(if h > 2 { 2 } else { 1 })..];
        let whole: f64 = sizes.iter().sum();
        (h > 1 && whole > 0.0).then(|| last.iter().fold(0.0f64, |m, x| m.max(*x)) / whole)
    }
}

/// Complex stiffness factor 1 + iβω of the elastic forces.
fn elastic(damping: Damping, omega: f64) -> Complex64 {
    Complex64::new(1.0, damping.stiffness * omega)
}

/// Complex quotient a/b, with a and the result as (real part, imaginary part).
fn quotient(a: [f64; 2], b: Complex64) -> [f64; 2] {
    let c = Complex64::new(a[0], a[1]) / b;
    [c.re, c.im]
}
