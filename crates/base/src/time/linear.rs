//! Small harmonic perturbations of a steady state: (iω − ∂R/∂U) û = b̂.
//!
//! This is the limit of harmonic balance for a vanishing amplitude (Hall and Clark 1993, doi:10.2514/3.11706), without
//! the mean and without Newton iterations: one linear system for each right-hand side, with real and imaginary parts
//! stored together. The initial guess is the best combination of the known solutions. Products with ∂R/∂U are exact
//! ([`jvp`](crate::system::System::jvp)); those that build the Krylov space are one-sided differences. The
//! preconditioner is that of harmonic balance with one harmonic. Solves are refined iteratively: the residual is
//! recomputed with exact products until it is small.
use super::recycled::Recycled;
use crate::math::fourier::Instances;
use crate::math::krylov::{Gmres, Goal, Numbers};
use crate::math::parallel::sweep_slots;
use crate::math::reduce::norm;
use crate::system::{Hierarchy, Implicit, Period, Placed, Preconditioner, Reach, RightHandSide, Shift, placed};

/// Relative change of the state in one-sided difference products.
const HASTY: f64 = 1e-8;
/// Relative reduction of the residual in each GMRES solve, and the number of refinements.
const ROUND: f64 = 1e-5;
const ROUNDS: usize = 6;
/// Maximum number of basis vectors of one GMRES solve.
const BASIS: usize = 100;
/// Fraction of the tolerance to which the last solve reduces the residual.
const MARGIN: f64 = 0.7;
/// Courant number of the preconditioner; it is large because there is no pseudo time.
const FAR: f64 = 1e8;

/// A system linearised about a steady state.
pub struct Linear<'a, S: Implicit> {
    system: &'a S,
    frame: S::Frame,
    work: S::Work,
    state: Vec<f64>,
    size: f64,
    rates: Vec<f64>,
    /// Local time of each unknown, with which residuals are multiplied.
    scale: Vec<f64>,
    gmres: Gmres,
    moved: Vec<f64>,
    found: Vec<f64>,
    /// R at the steady state.
    rest: Vec<f64>,
    recycled: Recycled,
    /// Storage of the preconditioner: components of one harmonic, and all instances before and after the solve.
    parts: Vec<f64>,
    instances: [Vec<f64>; 2],
}

/// Result of a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ended {
    /// Number of linear iterations.
    pub iterations: usize,
    /// Ratio of the residual to the right-hand side.
    pub left: f64,
}

impl<'a, S: Implicit> Linear<'a, S> {
    /// Linearises `system` at the state `state` in the frame `frame`, with the working storage `work`.
    pub fn new(system: &'a S, frame: S::Frame, state: &[f64], mut work: S::Work) -> Self {
        let rows = crate::system::rows(system.fields());
        let mut rates = vec![0.0; rows];
        system.rates(&frame, state, &mut work, &mut rates);
        let n = state.len();
        let mut rest = vec![0.0; n];
        system.rhs(&frame, state, &mut work, &mut rest);
        let mut scale = Vec::with_capacity(n);
        for Placed { field, rows, .. } in placed(system.fields()) {
            scale.extend(rates[rows].iter().flat_map(|r| std::iter::repeat_n(1.0 / r, field.block)));
        }
        Self {
            size: norm(state),
            state: state.to_vec(),
            gmres: Gmres::new(2 * n, BASIS),
            moved: vec![0.0; n],
            found: vec![0.0; n],
            rest,
            recycled: Recycled::default(),
            parts: vec![0.0; 2 * n],
            instances: [vec![0.0; 3 * n], vec![0.0; 3 * n]],
            system,
            frame,
            work,
            rates,
            scale,
        }
    }

    /// The steady state.
    pub fn state(&self) -> &[f64] {
        &self.state
    }

    /// Computes out = ∂R/∂U v, exactly or by a one-sided difference, which takes half the time.
    fn product(&mut self, v: &[f64], exact: bool, out: &mut [f64]) {
        if exact {
            return self.system.jvp(&self.frame, [&self.state, v], &mut self.work, out);
        }
        let size = norm(v);
        if size == 0.0 {
            return out.fill(0.0);
        }
        let (step, state) = (HASTY * self.size / size, &self.state);
        sweep_slots(&mut self.moved, |i, u| *u = state[i] + step * v[i]);
        self.system.rhs(&self.frame, &self.moved, &mut self.work, &mut self.found);
        let (there, rest) = (&self.found, &self.rest);
        sweep_slots(out, |i, o| *o = (there[i] - rest[i]) / step);
    }

    /// Computes out = (iω − ∂R/∂U) x times the local time, real parts before imaginary parts.
    fn shifted(&mut self, omega: f64, (x, exact): (&[f64], bool), out: &mut [f64]) {
        let n = self.state.len();
        let (re, im) = x.split_at(n);
        let (out_re, out_im) = out.split_at_mut(n);
        self.product(re, exact, out_re);
        self.product(im, exact, out_im);
        let scale = &self.scale;
        sweep_slots(out_re, |i, o| *o = scale[i] * (-*o - omega * im[i]));
        sweep_slots(out_im, |i, o| *o = scale[i] * (-*o + omega * re[i]));
    }

    /// Solves (iω − ∂R/∂U) x = b for each right-hand side in `right`, real parts before imaginary parts, to the
    /// relative residual `tolerance`; `plan` describes the levels of the preconditioner. Returns `None` if `stop`,
    /// which is called in every iteration, returns true before all solutions are found.
    pub fn solve(
        &mut self,
        omega: f64,
        right: &[Vec<f64>],
        tolerance: f64,
        (plan, stop): (&Hierarchy, &dyn Fn() -> bool),
    ) -> Option<Vec<(Vec<f64>, Ended)>> {
        self.recycled.expect(right.len());
        let waves = Waves::new(omega);
        let mut preconditioner = self.system.preconditioner(plan, Some(waves.period));
        preconditioner.begin(1);
        preconditioner.add(self.system, &self.frame, &self.state, &mut self.work);
        let shift = Shift { rates: &self.rates, cfl: FAR, coefficient: 0.0, reach: Reach::Far };
        preconditioner.finish(&shift);
        let mut problem = Problem { waves: &waves, preconditioner, stop };
        right.iter().map(|b| self.one(b, tolerance, &mut problem)).collect()
    }

    fn one(&mut self, b: &[f64], tolerance: f64, problem: &mut Problem<'_, S>) -> Option<(Vec<f64>, Ended)> {
        let (n, unknowns, omega) = (b.len(), self.state.len(), problem.waves.period.omega);
        let scale = self.scale.clone();
        let scaled = |i: usize| scale[i % unknowns] * b[i];
        let (mut x, mut r, mut z) = (vec![0.0; n], (0..n).map(scaled).collect::<Vec<f64>>(), vec![0.0; n]);
        let whole = norm(&r);
        if whole == 0.0 {
            return Some((x, Ended::default()));
        }
        self.recycled.begin(omega, &scale, (&mut x, &mut r));
        if omega == 0.0 {
            // the real and imaginary parts are independent: a part without right-hand side must not keep errors of
            // other frequencies
            for part in [0..unknowns, unknowns..n].into_iter().filter(|part| b[part.clone()].iter().all(|b| *b == 0.0))
            {
                x[part.clone()].fill(0.0);
                r[part].fill(0.0);
            }
        }
        let mut ended = Ended { iterations: 0, left: norm(&r) / whole };
        for round in 0..ROUNDS {
            // the reported residual is that of an exact product, not that of a combination
            if round > 0 && ended.left <= tolerance {
                break;
            }
            let asked = if ended.left > 0.0 { (MARGIN * tolerance / ended.left).min(MARGIN) } else { MARGIN };
            ended.iterations += self.correct(ROUND.max(asked), (&mut r, &mut z), problem);
            if (problem.stop)() {
                return None;
            }
            sweep_slots(&mut x, |i, x| *x += z[i]);
            self.shifted(omega, (&x, true), &mut r);
            sweep_slots(&mut r, |i, r| *r = scaled(i) - *r);
            let left = norm(&r) / whole;
            let stalled = !(left < 0.5 * ended.left);
            ended.left = left;
            if stalled && round > 0 {
                break;
            }
        }
        // A x = iω x − (b − r)
        let rotated = |i: usize| if i < unknowns { -x[unknowns + i] } else { x[i - unknowns] };
        self.recycled.keep(&x, |i| omega * scale[i % unknowns] * rotated(i) - (scaled(i) - r[i]));
        Some((x, ended))
    }

    /// Sets `z` to the solution for the right-hand side `r` until the fraction `tolerance` of it remains, and returns
    /// the number of iterations; `r` is used as storage.
    fn correct(
        &mut self,
        tolerance: f64,
        (r, z): (&mut [f64], &mut [f64]),
        Problem { waves, preconditioner, stop }: &mut Problem<'_, S>,
    ) -> usize {
        let mut gmres = std::mem::replace(&mut self.gmres, Gmres::new(0, 0));
        let [mut all, mut found] = std::mem::take(&mut self.instances);
        let mut parts = std::mem::take(&mut self.parts);
        let (system, omega, scale, frame) = (self.system, waves.period.omega, self.scale.clone(), self.frame.clone());
        let goal = Goal { tolerance, most: BASIS };
        let linear = crate::math::krylov::System {
            product: |v: &[f64], out: &mut [f64]| self.shifted(omega, (v, false), out),
            precondition: |v: Numbers<'_>, out: &mut [f64]| {
                waves.spread(system, (&v, &scale), &mut parts, &mut all);
                preconditioner.apply(system, &[&frame; 3], &RightHandSide::Plain(&all), &mut found);
                waves.gather(system, &found, out);
            },
        };
        let solved = gmres.solve_unless((r, z), goal, *stop, linear);
        (self.gmres, self.parts, self.instances) = (gmres, parts, [all, found]);
        solved.iterations
    }
}

/// Data common to all right-hand sides of one frequency.
struct Problem<'p, S: Implicit> {
    waves: &'p Waves,
    preconditioner: S::Preconditioner,
    stop: &'p dyn Fn() -> bool,
}

/// Transformation between one harmonic and the instances of a period.
struct Waves {
    period: Period,
    /// Cosine and sine of the phase at each instance.
    phase: Vec<[f64; 2]>,
}

impl Waves {
    fn new(omega: f64) -> Self {
        let instances = Instances::of_harmonics(1);
        let phase = instances.times(1.0).into_iter().map(|t| [t.cos(), t.sin()]).collect();
        Self { period: Period { instances, omega, mean: false }, phase }
    }

    /// Computes the values at the instances, Re(v̂ e^{iωt}), from harmonic components that are multiplied by local
    /// times.
    fn spread<S: Implicit>(&self, system: &S, (v, scale): (&Numbers<'_>, &[f64]), parts: &mut [f64], all: &mut [f64]) {
        let n = system.len();
        v.each(0, parts, |x, r| *x = f64::from(r));
        let (re, im) = parts.split_at_mut(n);
        for part in [&mut *re, &mut *im] {
            part.iter_mut().zip(scale).for_each(|(p, s)| *p /= s);
        }
        rows(system, |at, b| {
            let out = &mut all[at * 3..(at + b) * 3];
            for (m, [c, s]) in self.phase.iter().enumerate() {
                (0..b).for_each(|k| out[m * b + k] = re[at + k] * c - im[at + k] * s);
            }
        });
    }

    /// Computes the harmonic components of the values at the instances.
    fn gather<S: Implicit>(&self, system: &S, all: &[f64], out: &mut [f64]) {
        let (re, im) = out.split_at_mut(system.len());
        rows(system, |at, b| {
            for k in 0..b {
                let sum = |part: usize| -> f64 {
                    self.phase.iter().enumerate().map(|(m, p)| all[at * 3 + m * b + k] * p[part]).sum()
                };
                (re[at + k], im[at + k]) = (sum(0) * 2.0 / 3.0, -sum(1) * 2.0 / 3.0);
            }
        });
    }
}

/// Calls `f(index of the first unknown, number of unknowns)` for every row of all fields.
fn rows<S: Implicit>(system: &S, mut f: impl FnMut(usize, usize)) {
    for Placed { field, unknowns, .. } in placed(system.fields()) {
        (0..field.rows).for_each(|i| f(unknowns.start + i * field.block, field.block));
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::system::{Instant, System};
    use crate::time::control::Control;
    use crate::time::ordinary::Ordinary;

    #[test]
    fn small_motion_of_a_nonlinear_oscillator_is_that_of_its_tangent() {
        // u' = v, v' = −sin u − 0.3 v + 0.5 about its rest at u = π/6, forced on v
        let system = Ordinary::new(2, 2.0, |_, u: &[f64], du: &mut [f64]| {
            (du[0], du[1]) = (u[1], -u[0].sin() - 0.3 * u[1] + 0.5);
        });
        let rest = [std::f64::consts::FRAC_PI_6, 0.0];
        let control = Control::newton(2);
        let plan = Hierarchy { group: control.group, cycle: control.cycle };
        let mut linear = Linear::new(&system, system.frame(&Instant::still(0.0), &rest), &rest, ());
        for omega in [0.0, 0.7, 3.0] {
            let (x, ended) =
                linear.solve(omega, &[vec![0.0, 1.0, 0.0, -2.0]], 1e-9, (&plan, &|| false)).unwrap().remove(0);
            let i = Complex64::new(0.0, omega);
            let exact = Complex64::new(1.0, -2.0) / (i * i + 0.3 * i + rest[0].cos());
            assert!(ended.left < 1e-8 && ended.iterations < 20, "{ended:?}");
            let found = Complex64::new(x[0], x[2]);
            assert!((found - exact).norm() < 1e-6 * exact.norm(), "{found} {exact}");
        }
    }
}
