//! Harmonic balance: a periodic solution, computed directly without marching (Hall, Thomas and Clark, AIAA J. 40,
//! 2002).
//!
//! The unknowns are the states U_n at the 2N + 1 instances of a period. With ∂/∂t = ωD, which is exact for N harmonics,
//! they satisfy R(U_n) − Σ_j (ωD)_nj U_j = 0, eq. (32). These equations are a [`System`] like any other: the row of a
//! particle holds the states of all instances one after another, and [`super::relax`] drives the residual to zero in
//! pseudo time. Each instance has its own frame, with positions x_n on the same neighbour lists and velocities w = ωD x
//! from the same operator, so that uniform flow, and linear fields at rest, are preserved. The linear systems are
//! block-circulant for the average of all linearisations, and are solved by sweeps for each harmonic
//! ([`crate::math::circulant`]).
//!
//! *Oversampling* evaluates R at more instances than there are unknowns, on the interpolated state, and keeps its
//! harmonics up to N, so that products of high harmonics are not aliased into low ones.

use crate::math::fourier::{Instances, Matrix};
use crate::math::parallel::sweep_rows;
use crate::system::{
    Fault, Field, Hierarchy, Implicit, Instant, Period, Preconditioner, Ranges, RightHandSide, Shift, System, Term,
    placed,
};

/// The equations of a periodic solution of a system.
pub struct HarmonicBalance<'a, S: System> {
    system: &'a S,
    fields: Vec<Field>,
    placing: Ranges,
    held: Instances,
    seen: Instances,
    omega: f64,
    derivative: Matrix,
    /// Differentiation matrix between the instances where R is evaluated.
    seen_derivative: Matrix,
    up: Matrix,
    down: Matrix,
}

/// Working storage: state, residual and, after the first product, change of the state, all at one instance.
pub struct Work<S: System> {
    work: S::Work,
    u: Vec<f64>,
    v: Vec<f64>,
    du: Vec<f64>,
}

impl<'a, S: System> HarmonicBalance<'a, S> {
    /// Equations for the periodic motion of `system` with the angular frequency `omega` [rad/time] and the harmonics of
    /// `held`. R is evaluated with `oversample` times as many harmonics (at least one).
    pub fn new(system: &'a S, held: Instances, omega: f64, oversample: f64) -> Self {
        let harmonics = (oversample.max(1.0) * held.harmonics() as f64).ceil() as usize;
        let seen = Instances::of_harmonics(harmonics);
        let (derivative, count) = (held.derivative(omega), held.count());
        let fields: Vec<Field> = system.fields().iter().map(|f| f.at_instances(count)).collect();
        let placing = system.placing().at_instances(count);
        let (up, down) = (held.resample(&seen), seen.resample(&held));
        let seen_derivative = seen.derivative(omega);
        Self { system, fields, placing, held, seen, omega, derivative, seen_derivative, up, down }
    }

    /// Instances at which the solution is stored.
    pub fn instances(&self) -> Instances {
        self.held
    }

    /// Times of the instances at which R is evaluated.
    pub fn times(&self) -> Vec<f64> {
        self.seen.times(self.omega)
    }

    /// State of all instances, each equal to `u`.
    pub fn copies(&self, u: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; u.len() * self.held.count()];
        self.rows_of(self.held, &mut all, |b, one, row| {
            row.chunks_exact_mut(b).for_each(|r| r.copy_from_slice(&u[one..one + b]));
        });
        all
    }

    /// State of all instances, each equal to `u` with the prescribed motion of its time imposed.
    pub fn led_copies(&self, u: &[f64]) -> Vec<f64> {
        let mut all = self.copies(u);
        self.at_instances(self.held, &mut all, |time, one| self.system.lead(0.0, time, one));
        all
    }

    /// Interpolates the state `u` from the instances of `from` to those of this system. Only the difference from the
    /// prescribed motion is interpolated.
    pub fn led_resampled(&self, u: &[f64], from: Instances) -> Vec<f64> {
        let mut still = u.to_vec();
        self.at_instances(from, &mut still, |time, one| self.system.lead(time, 0.0, one));
        let mut all = self.resampled(&still, from);
        self.at_instances(self.held, &mut all, |time, one| self.system.lead(0.0, time, one));
        all
    }

    /// Applies `f` to the state of each instance in `u`, together with its time.
    fn at_instances(&self, instances: Instances, u: &mut [f64], f: impl Fn(f64, &mut [f64])) {
        let mut one = vec![0.0; self.system.len()];
        for (n, time) in instances.times(self.omega).into_iter().enumerate() {
            self.instance_of(instances, u, n, &mut one);
            f(time, &mut one);
            self.rows_of(instances, u, |b, at, row| row[n * b..(n + 1) * b].copy_from_slice(&one[at..at + b]));
        }
    }

    /// Interpolates the state `u` from the instances of `from` to those of this system: exact, or truncated to the
    /// harmonics that these can represent.
    pub fn resampled(&self, u: &[f64], from: Instances) -> Vec<f64> {
        let (old, count) = (from.count(), self.held.count());
        let matrix = from.resample(&self.held);
        let mut all = vec![0.0; u.len() / old * count];
        self.rows_of(self.held, &mut all, |b, one, row| {
            for (n, r) in row.chunks_exact_mut(b).enumerate() {
                for (v, r) in r.iter_mut().enumerate() {
                    *r = (0..old).map(|j| matrix.row(n)[j] * u[one * old + j * b + v]).sum();
                }
            }
        });
        all
    }

    /// Writes the state at the phase ωt (rad) to `out`.
    pub fn at_phase(&self, u: &[f64], phase: f64, out: &mut [f64]) {
        self.combine(u, &self.held.weights(phase), out);
    }

    /// Writes the sum Σ_j weights_j U_j over the instances to `out`.
    pub fn combine(&self, u: &[f64], weights: &[f64], out: &mut [f64]) {
        let count = self.held.count();
        for at in placed(self.system.fields()) {
            let all = &u[at.unknowns.start * count..at.unknowns.end * count];
            combine_rows(all, at.field.block, weights, &mut out[at.unknowns]);
        }
    }

    /// Copies the state of the stored instance `n` to `out`, without interpolation.
    pub fn instance(&self, u: &[f64], n: usize, out: &mut [f64]) {
        self.instance_of(self.held, u, n, out);
    }

    fn instance_of(&self, instances: Instances, u: &[f64], n: usize, out: &mut [f64]) {
        let count = instances.count();
        for at in placed(self.system.fields()) {
            let (b, all) = (at.field.block, &u[at.unknowns.start * count..at.unknowns.end * count]);
            sweep_rows(&mut out[at.unknowns], b, |i, row| {
                row.copy_from_slice(&all[(i * count + n) * b..(i * count + n + 1) * b]);
            });
        }
    }

    /// Sets the state of the stored instance `n` to `one`.
    pub fn set_instance(&self, one: &[f64], n: usize, u: &mut [f64]) {
        self.rows_of(self.held, u, |b, at, row| row[n * b..(n + 1) * b].copy_from_slice(&one[at..at + b]));
    }

    /// Writes the state at instance `n` of those where R is evaluated to `out`.
    pub fn look(&self, u: &[f64], n: usize, out: &mut [f64]) {
        if self.held == self.seen { self.instance(u, n, out) } else { self.combine(u, self.up.row(n), out) }
    }

    /// Calls `f(b, one, row)` for each row of all fields, where `b` is the number of unknowns of one instance, `one`
    /// the index of the first of them in a state of one instance, and `row` the values of the row.
    fn rows_of(&self, instances: Instances, all: &mut [f64], f: impl Fn(usize, usize, &mut [f64]) + Sync) {
        let count = instances.count();
        for at in placed(self.system.fields()) {
            let (b, first) = (at.field.block, at.unknowns.start);
            let rows = &mut all[at.unknowns.start * count..at.unknowns.end * count];
            sweep_rows(rows, b * count, |i, row| f(b, first + i * b, row));
        }
    }

    /// Index of the instance where R is evaluated that is nearest to the stored instance `n`.
    fn beside(&self, n: usize) -> usize {
        let (held, seen) = (self.held.count(), self.seen.count());
        (2 * n * seen + held) / (2 * held) % seen
    }

    /// Calls `f` with the instant at the phase ωt of the solution `u`; its velocities follow from the positions at all
    /// instances by the same operator as the time derivative of the state.
    pub fn with_instant<T>(&self, u: &[f64], phase: f64, f: impl FnOnce(&Instant<'_>) -> T) -> T {
        let now = self.coordinates(u, &self.held.weights(phase));
        let weights: Vec<f64> = self.seen.derivative_weights(phase).iter().map(|w| w * self.omega).collect();
        self.instant(&self.coordinates_seen(&self.placing.values(u)), (phase, &now), &weights, f)
    }

    /// Weighted sum Σ_j weights_j q_j of the coordinates that determine frames.
    fn coordinates(&self, u: &[f64], weights: &[f64]) -> Vec<f64> {
        self.coordinates_of(&self.placing.values(u), weights)
    }

    fn coordinates_of(&self, q: &[f64], weights: &[f64]) -> Vec<f64> {
        let (placing, count) = (self.system.placing(), self.held.count());
        let (mut out, mut first) = (vec![0.0; placing.len()], 0);
        for at in placed(self.system.fields()).filter(|at| placing.contain(&at.unknowns)) {
            let own = first..first + at.unknowns.len();
            first = own.end;
            combine_rows(&q[own.start * count..own.end * count], at.field.block, weights, &mut out[own]);
        }
        out
    }

    /// Coordinates at all instances where R is evaluated.
    fn coordinates_seen(&self, q: &[f64]) -> Vec<Vec<f64>> {
        (0..self.seen.count()).map(|n| self.coordinates_of(q, self.up.row(n))).collect()
    }

    /// Calls `f` with the instant at the phase ωt and the coordinates `now`, given the coordinates at all instances
    /// where R is evaluated and their weights in the derivative at that phase.
    fn instant<T>(
        &self,
        seen: &[Vec<f64>],
        (phase, now): (f64, &[f64]),
        weights: &[f64],
        f: impl FnOnce(&Instant<'_>) -> T,
    ) -> T {
        let times = self.seen.times(self.omega);
        let terms: Vec<Term<'_>> =
            (0..times.len()).map(|n| Term { coefficient: weights[n], time: times[n], coordinates: &seen[n] }).collect();
        f(&Instant::formula(phase / self.omega, &terms).with(now))
    }

    /// Phases (rad) of the instances where R is evaluated.
    fn phases(&self) -> Vec<f64> {
        self.times().into_iter().map(|t| t * self.omega).collect()
    }

    /// Computes out = −ωD u.
    fn turned(&self, u: &[f64], out: &mut [f64]) {
        let (derivative, count) = (&self.derivative, self.held.count());
        self.rows_of(self.held, out, |b, one, row| {
            let all = &u[one * count..(one + b) * count];
            for (n, row) in row.chunks_exact_mut(b).enumerate() {
                row.fill(0.0);
                for (d, u) in derivative.row(n).iter().zip(all.chunks_exact(b)) {
                    row.iter_mut().zip(u).for_each(|(r, u)| *r -= d * u);
                }
            }
        });
    }

    /// Adds `found`, a result at instance `n` of those where R is evaluated, to the stored instances by truncation of
    /// its harmonics.
    fn gather(&self, n: usize, found: &[f64], du: &mut [f64]) {
        let same = self.held == self.seen;
        self.rows_of(self.held, du, |b, one, row| {
            let found = &found[one..one + b];
            if same {
                row[n * b..(n + 1) * b].iter_mut().zip(found).for_each(|(r, d)| *r += d);
                return;
            }
            for (k, row) in row.chunks_exact_mut(b).enumerate() {
                let weight = self.down.row(k)[n];
                row.iter_mut().zip(found).for_each(|(r, d)| *r += weight * d);
            }
        });
    }

    /// Calls `f` with the index and the state of every instance where R is evaluated.
    fn each(&self, u: &[f64], mut f: impl FnMut(usize, &[f64])) {
        let mut one = vec![0.0; self.system.len()];
        for n in 0..self.seen.count() {
            self.look(u, n, &mut one);
            f(n, &one);
        }
    }
}

/// Weighted sum Σ_j weights_j of the instances, for rows of `b` unknowns each.
fn combine_rows(all: &[f64], b: usize, weights: &[f64], out: &mut [f64]) {
    let count = weights.len();
    sweep_rows(out, b, |i, row| {
        let all = &all[i * b * count..(i + 1) * b * count];
        row.fill(0.0);
        for (w, u) in weights.iter().zip(all.chunks_exact(b)) {
            row.iter_mut().zip(u).for_each(|(r, u)| *r += w * u);
        }
    });
}

impl<S: System> System for HarmonicBalance<'_, S> {
    type Frame = Vec<S::Frame>;
    type Work = Work<S>;

    fn prescribe(&self, _: f64, u: &mut [f64]) {
        self.at_instances(self.held, u, |time, one| self.system.prescribe(time, one));
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn placing(&self) -> &Ranges {
        &self.placing
    }

    fn work(&self) -> Self::Work {
        let zero = vec![0.0; self.system.len()];
        Work { work: self.system.work(), u: zero.clone(), v: Vec::new(), du: zero }
    }

    fn frame(&self, _: &Instant<'_>, u: &[f64]) -> Self::Frame {
        let mut one = vec![0.0; self.system.len()];
        let seen = self.coordinates_seen(&self.placing.values(u));
        let frame = |(n, phase): (usize, f64)| {
            self.look(u, n, &mut one);
            self.instant(&seen, (phase, &seen[n]), self.seen_derivative.row(n), |at| self.system.frame(at, &one))
        };
        self.phases().into_iter().enumerate().map(frame).collect()
    }

    fn place(&self, at: &Instant<'_>, frame: &mut Self::Frame) {
        let seen = self.coordinates_seen(at.coordinates);
        for (n, (phase, frame)) in self.phases().into_iter().zip(frame).enumerate() {
            self.instant(&seen, (phase, &seen[n]), self.seen_derivative.row(n), |at| self.system.place(at, frame));
        }
    }

    #[doc(alias = "eq32")]
    fn rhs(&self, frame: &Self::Frame, u: &[f64], work: &mut Self::Work, du: &mut [f64]) {
        self.turned(u, du);
        for (n, frame) in frame.iter().enumerate() {
            self.look(u, n, &mut work.u);
            self.system.rhs(frame, &work.u, &mut work.work, &mut work.du);
            self.gather(n, &work.du, du);
        }
    }

    fn jvp(&self, frame: &Self::Frame, [u, v]: [&[f64]; 2], work: &mut Self::Work, out: &mut [f64]) {
        self.turned(v, out);
        work.v.resize(self.system.len(), 0.0);
        for (n, frame) in frame.iter().enumerate() {
            self.look(u, n, &mut work.u);
            self.look(v, n, &mut work.v);
            self.system.jvp(frame, [&work.u, &work.v], &mut work.work, &mut work.du);
            self.gather(n, &work.du, out);
        }
    }

    fn rates(&self, frame: &Self::Frame, u: &[f64], work: &mut Self::Work, rate: &mut [f64]) {
        // the time derivative changes the state at a rate of at most ωN
        rate.fill(0.0);
        let mut one = vec![0.0; rate.len()];
        for (n, frame) in frame.iter().enumerate() {
            self.look(u, n, &mut work.u);
            self.system.rates(frame, &work.u, &mut work.work, &mut one);
            let one = &one;
            sweep_rows(rate, 1, |i, r| r[0] = r[0].max(one[i]));
        }
        let turn = self.omega * self.held.harmonics() as f64;
        sweep_rows(rate, 1, |_, r| r[0] += turn);
    }

    fn largest_change(&self, u: &[f64], du: &[f64]) -> f64 {
        let (mut one, mut step) = (vec![0.0; self.system.len()], vec![0.0; self.system.len()]);
        (0..self.held.count()).fold(0.0, |largest, n| {
            self.instance(u, n, &mut one);
            self.instance(du, n, &mut step);
            self.system.largest_change(&one, &step).max(largest)
        })
    }

    fn shorten(&self, u: &[f64], du: &mut [f64], largest: f64) {
        let (mut one, mut step) = (vec![0.0; self.system.len()], vec![0.0; self.system.len()]);
        for n in 0..self.held.count() {
            self.instance(u, n, &mut one);
            self.instance(du, n, &mut step);
            self.system.shorten(&one, &mut step, largest);
            self.set_instance(&step, n, du);
        }
    }

    fn check(&self, frame: &Self::Frame, u: &[f64]) -> Result<(), Fault> {
        let mut found = Ok(());
        self.each(u, |n, one| {
            if found.is_ok() {
                let period = 100.0 * n as f64 / self.seen.count() as f64;
                found = self.system.check(&frame[n], one).map_err(|fault| Fault {
                    reason: format!("{} at {period:.0} % of the period", fault.reason),
                    ..fault
                });
            }
        });
        found
    }

    fn check_frame(&self, frame: &Self::Frame) -> Result<(), Fault> {
        frame.iter().try_for_each(|f| self.system.check_frame(f))
    }

    fn locate(&self, frame: &Self::Frame, row: usize) -> Vec<f64> {
        frame.first().map_or_else(Vec::new, |f| self.system.locate(f, row))
    }
}

/// Preconditioner for all instances of a period, built from the average of the linearisations at all instances.
pub struct InTime<P> {
    inner: P,
    instances: usize,
}

impl<'a, S: Implicit> Implicit for HarmonicBalance<'a, S> {
    type Preconditioner = InTime<S::Preconditioner>;

    fn preconditioner(&self, plan: &Hierarchy, _: Option<Period>) -> Self::Preconditioner {
        let period = Period { instances: self.held, omega: self.omega, mean: true };
        InTime { inner: self.system.preconditioner(plan, Some(period)), instances: self.seen.count() }
    }
}

impl<'a, S: Implicit> Preconditioner<HarmonicBalance<'a, S>> for InTime<S::Preconditioner> {
    fn begin(&mut self, points: usize) {
        self.inner.begin(points * self.instances);
    }

    fn add(&mut self, balance: &HarmonicBalance<'a, S>, frame: &Vec<S::Frame>, u: &[f64], work: &mut Work<S>) {
        for (n, frame) in frame.iter().enumerate() {
            balance.look(u, n, &mut work.u);
            self.inner.add(balance.system, frame, &work.u, &mut work.work);
        }
    }

    fn finish(&mut self, shift: &Shift<'_>) {
        self.inner.finish(shift);
    }

    fn apply(
        &mut self,
        balance: &HarmonicBalance<'a, S>,
        frames: &[&Vec<S::Frame>],
        r: &RightHandSide<'_>,
        z: &mut [f64],
    ) {
        let near = |n: usize| frames.iter().map(move |f| &f[balance.beside(n)]);
        let all: Vec<&S::Frame> = (0..balance.held.count()).flat_map(near).collect();
        self.inner.apply(balance.system, &all, r, z);
    }

    fn bytes(&self) -> usize {
        self.inner.bytes()
    }
}
