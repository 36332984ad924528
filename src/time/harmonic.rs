//! Harmonic balance: a periodic solution at once, without marching (Hall, Thomas and Clark, AIAA J. 40, 2002).
//!
//! The unknowns are the states U_n at the 2N + 1 instances of a period; with ∂/∂t = ωD, exact for N harmonics, they obey
//! R(U_n) − Σ_j (ωD)_nj U_j = 0, eq. (32). This is a [`System`] like any other: a particle carries the states of all its
//! instances one after another, and [`super::relax`] drives the residual to zero in pseudo time. Each instance has a frame of
//! its own: positions x_n on the same lists, velocities w = ωD x with the same operator, so that uniform flow and linear
//! fields at rest stay what they are. The linear systems are block-circulant about the mean of all linearisations and are
//! swept harmonic by harmonic ([`crate::math::circulant`]).
//!
//! *Oversampling* evaluates R at more instances than there are unknowns, on the interpolated state, and keeps the harmonics
//! up to N of what it finds: products of high harmonics are then not mistaken for low ones.
use crate::math::block_matrix::BlockMatrix;
use crate::math::fourier::{Instances, Matrix};
use crate::math::sweep::sweep_rows;
use crate::system::{Fault, Moment, System};

/// The equations of a periodic solution.
pub struct HarmonicBalance<'a, S: System> {
    system: &'a S,
    held: Instances,
    seen: Instances,
    omega: f64,
    derivative: Matrix,
    up: Matrix,
    down: Matrix,
}

/// Storage of an evaluation: state and residual of one instance, and the residuals of all where they are filtered.
pub struct Work<S: System> {
    work: S::Work,
    u: Vec<f64>,
    du: Vec<f64>,
}

impl<'a, S: System> HarmonicBalance<'a, S> {
    /// `system` in periodic motion of angular frequency `omega`, with the harmonics of `held`. R is evaluated at
    /// `oversample` times as many harmonics (at least one).
    pub fn new(system: &'a S, held: Instances, omega: f64, oversample: f64) -> Self {
        let harmonics = (oversample.max(1.0) * held.harmonics() as f64).ceil() as usize;
        let seen = Instances::of_harmonics(harmonics);
        let derivative = held.derivative(omega);
        Self { system, held, seen, omega, derivative, up: held.resample(&seen), down: seen.resample(&held) }
    }

    /// Instances that hold the solution.
    pub fn instances(&self) -> Instances {
        self.held
    }

    /// Times at which R is evaluated.
    pub fn times(&self) -> Vec<f64> {
        self.seen.times(self.omega)
    }

    /// A state of all instances that are copies of `u`.
    pub fn copies(&self, u: &[f64]) -> Vec<f64> {
        let (b, count) = (self.system.block(), self.held.count());
        let mut all = vec![0.0; u.len() * count];
        sweep_rows(&mut all, b * count, |i, row| {
            row.chunks_exact_mut(b).for_each(|r| r.copy_from_slice(&u[i * b..(i + 1) * b]));
        });
        all
    }

    /// The state `u`, given at the instances of `from`, at those of this one: exact interpolation, or the part it can hold.
    pub fn resampled(&self, u: &[f64], from: Instances) -> Vec<f64> {
        let (b, old, count) = (self.system.block(), from.count(), self.held.count());
        let matrix = from.resample(&self.held);
        let mut all = vec![0.0; u.len() / old * count];
        sweep_rows(&mut all, b * count, |i, row| {
            for (n, r) in row.chunks_exact_mut(b).enumerate() {
                for (v, r) in r.iter_mut().enumerate() {
                    *r = (0..old).map(|j| matrix.row(n)[j] * u[i * b * old + j * b + v]).sum();
                }
            }
        });
        all
    }

    /// The state at the phase ωt.
    pub fn at_phase(&self, u: &[f64], phase: f64, out: &mut [f64]) {
        self.combine(u, &self.held.weights(phase), out);
    }

    /// Σ_j weights_j U_j.
    pub fn combine(&self, u: &[f64], weights: &[f64], out: &mut [f64]) {
        let (b, count) = (self.system.block(), self.held.count());
        sweep_rows(out, b, |i, row| {
            let all = &u[i * b * count..(i + 1) * b * count];
            row.fill(0.0);
            for (w, u) in weights.iter().zip(all.chunks_exact(b)) {
                row.iter_mut().zip(u).for_each(|(r, u)| *r += w * u);
            }
        });
    }

    /// Instance `n` of those that hold the solution, to the bit.
    pub fn instance(&self, u: &[f64], n: usize, out: &mut [f64]) {
        let (b, count) = (self.system.block(), self.held.count());
        sweep_rows(out, b, |i, row| row.copy_from_slice(&u[(i * count + n) * b..(i * count + n + 1) * b]));
    }

    /// State at instance `n` of those where R is evaluated.
    pub fn look(&self, u: &[f64], n: usize, out: &mut [f64]) {
        if self.held == self.seen { self.instance(u, n, out) } else { self.combine(u, self.up.row(n), out) }
    }

    /// The instance of those where R is evaluated that is nearest to instance `n` of those that hold the solution.
    fn beside(&self, n: usize) -> usize {
        let (held, seen) = (self.held.count(), self.seen.count());
        (2 * n * seen + held) / (2 * held) % seen
    }

    /// The moment of phase ωt, velocities from positions at the instances by the operator of the state.
    pub fn with_moment<T>(&self, phase: f64, f: impl FnOnce(&Moment<'_>) -> T) -> T {
        let times = self.seen.times(self.omega);
        let weights = self.seen.derivative_weights(phase);
        let rate: Vec<(f64, f64)> = weights.iter().zip(&times).map(|(w, t)| (w * self.omega, *t)).collect();
        f(&Moment::By { time: phase / self.omega, rate: &rate })
    }

    /// A moment for each instance where R is evaluated.
    fn phases(&self) -> impl Iterator<Item = f64> + '_ {
        self.times().into_iter().map(|t| t * self.omega)
    }

    /// Calls `f` with the state of every instance where R is evaluated.
    fn each(&self, u: &[f64], mut f: impl FnMut(usize, &[f64])) {
        let mut one = vec![0.0; self.system.len()];
        for n in 0..self.seen.count() {
            self.look(u, n, &mut one);
            f(n, &one);
        }
    }
}

impl<S: System> System for HarmonicBalance<'_, S> {
    type Frame = Vec<S::Frame>;
    type Work = Work<S>;

    fn block(&self) -> usize {
        self.system.block() * self.held.count()
    }

    fn len(&self) -> usize {
        self.system.len() * self.held.count()
    }

    fn measured(&self) -> usize {
        self.system.measured()
    }

    fn in_time(&self) -> Option<(Instances, f64)> {
        Some((self.held, self.omega))
    }

    fn frame(&self, _: &Moment<'_>, u: &[f64]) -> Self::Frame {
        let mut one = vec![0.0; self.system.len()];
        let phases = self.phases().enumerate();
        let frame = |(n, phase): (usize, f64)| {
            self.look(u, n, &mut one);
            self.with_moment(phase, |moment| self.system.frame(moment, &one))
        };
        phases.map(frame).collect()
    }

    fn place(&self, _: &Moment<'_>, frame: &mut Self::Frame) {
        for (phase, frame) in self.phases().zip(frame) {
            self.with_moment(phase, |moment| self.system.place(moment, frame));
        }
    }

    fn follow(&self, u: &[f64], work: &mut Self::Work, frame: &mut Self::Frame) {
        for (n, frame) in frame.iter_mut().enumerate() {
            self.look(u, n, &mut work.u);
            self.system.follow(&work.u, &mut work.work, frame);
        }
    }

    fn work(&self) -> Self::Work {
        let zero = vec![0.0; self.system.len()];
        Work { work: self.system.work(), u: zero.clone(), du: zero }
    }

    #[doc(alias = "eq32")]
    fn rhs(&self, frame: &Self::Frame, u: &[f64], work: &mut Self::Work, du: &mut [f64]) {
        let (b, count) = (self.system.block(), self.held.count());
        let derivative = &self.derivative;
        sweep_rows(du, b * count, |i, row| {
            let all = &u[i * b * count..(i + 1) * b * count];
            for (n, row) in row.chunks_exact_mut(b).enumerate() {
                row.fill(0.0);
                for (d, u) in derivative.row(n).iter().zip(all.chunks_exact(b)) {
                    row.iter_mut().zip(u).for_each(|(r, u)| *r -= d * u);
                }
            }
        });
        let same = self.held == self.seen;
        for (n, frame) in frame.iter().enumerate() {
            self.look(u, n, &mut work.u);
            self.system.rhs(frame, &work.u, &mut work.work, &mut work.du);
            let one = &work.du;
            sweep_rows(du, b * count, |i, row| {
                let one = &one[i * b..(i + 1) * b];
                if same {
                    row[n * b..(n + 1) * b].iter_mut().zip(one).for_each(|(r, d)| *r += d);
                    return;
                }
                for (k, row) in row.chunks_exact_mut(b).enumerate() {
                    let weight = self.down.row(k)[n];
                    row.iter_mut().zip(one).for_each(|(r, d)| *r += weight * d);
                }
            });
        }
    }

    fn spectral_radius(&self, frame: &Self::Frame, u: &[f64], work: &mut Self::Work, rate: &mut [f64]) {
        // the derivative in time turns states by at most ωN
        rate.fill(0.0);
        let mut one = vec![0.0; rate.len()];
        for (n, frame) in frame.iter().enumerate() {
            self.look(u, n, &mut work.u);
            self.system.spectral_radius(frame, &work.u, &mut work.work, &mut one);
            let one = &one;
            sweep_rows(rate, 1, |i, r| r[0] = r[0].max(one[i]));
        }
        let turn = self.omega * self.held.harmonics() as f64;
        sweep_rows(rate, 1, |_, r| r[0] += turn);
    }

    fn graph(&self) -> (&[u32], &[u32]) {
        self.system.graph()
    }

    fn parts(&self) -> &[std::ops::Range<usize>] {
        self.system.parts()
    }

    /// The mean of the linearisations of all instances; ∂/∂t is added by the hierarchy that solves with it.
    fn linearise(&self, frame: &Self::Frame, u: &[f64], work: &mut Self::Work, matrix: &mut BlockMatrix) {
        matrix.begin_mean(frame.len());
        for (n, frame) in frame.iter().enumerate() {
            self.look(u, n, &mut work.u);
            self.system.linearise(frame, &work.u, &mut work.work, matrix);
        }
        matrix.end_mean();
    }

    fn inward(&self, frame: &Self::Frame, row: &mut [f32]) {
        let instances = row.chunks_exact_mut(self.system.block()).enumerate();
        instances.for_each(|(n, row)| self.system.inward(&frame[self.beside(n)], row));
    }

    fn outward(&self, frame: &Self::Frame, row: &mut [f64]) {
        let instances = row.chunks_exact_mut(self.system.block()).enumerate();
        instances.for_each(|(n, row)| self.system.outward(&frame[self.beside(n)], row));
    }

    fn largest_change(&self, u: &[f64], du: &[f64]) -> f64 {
        let (mut one, mut step) = (vec![0.0; self.system.len()], vec![0.0; self.system.len()]);
        (0..self.held.count()).fold(0.0, |largest, n| {
            self.instance(u, n, &mut one);
            self.instance(du, n, &mut step);
            self.system.largest_change(&one, &step).max(largest)
        })
    }

    fn fault(&self, frame: &Self::Frame, u: &[f64]) -> Option<Fault> {
        let mut found = None;
        self.each(u, |n, one| {
            if found.is_none() {
                let period = 100.0 * n as f64 / self.seen.count() as f64;
                found = self
                    .system
                    .fault(&frame[n], one)
                    .map(|fault| Fault { reason: format!("{} at {period:.0} % of the period", fault.reason), ..fault });
            }
        });
        found
    }

    fn misplaced(&self, frame: &Self::Frame) -> Option<Fault> {
        frame.iter().find_map(|f| self.system.misplaced(f))
    }

    fn locate(&self, frame: &Self::Frame, particle: usize) -> Vec<f64> {
        frame.first().map_or_else(Vec::new, |f| self.system.locate(f, particle))
    }
}
