//! How the linear systems of bodies made of particles are solved.
//!
//! In time, with s = shift + c, the pairs (u, v) obey s u − v = r_u, s v + M⁻¹K u = r_v: (K + s²M) u = M (r_v + s r_u), v = s u − r_u, by
//! Cholesky factors. In a periodic solution the same holds for every harmonic with s = shift + ikω. With damping C = αM + βK it is
//! ((1 + sβ)K + (s² + sα)M) u = M (r_v + (s + α) r_u) + βK r_u. On the way to rest
//! (shift K₀ + ωK) u = K₀ r_u. Particles that are held have rates of their own.
//!
//! The stiffness of a periodic solution is one for all instances. Bodies that are led turn with what leads them: their instances are
//! turned back first, so that what is stiff along a thin body stays along it.
use std::sync::Arc;

use num_complex::Complex64;

use super::solids::{Moving, Pace, Solids, Work};
use crate::math::Vector;
use crate::math::fourier::Matrix;
use crate::math::sparse::{ComplexFactors, Factors, Symmetric};
use crate::motion::RigidPose;
use crate::system::{Mechanical, Period, Placed, RightHandSide, Shift};

enum Inverse {
    /// Nothing is known yet, or no matrix could be factored.
    Diagonal,
    Real {
        factors: Factors,
        rubbed: Option<Symmetric>,
    },
    Rest {
        factors: Factors,
        reference: Symmetric,
    },
    Harmonics {
        factors: Vec<ComplexFactors>,
        rubbed: Option<Symmetric>,
    },
}

/// α and β of the damping of a structure, in units of the gas.
#[derive(Clone, Copy)]
struct Damped {
    mass: f64,
    stiffness: f64,
}

impl Damped {
    fn of<const D: usize>(solids: &Solids<D>) -> Self {
        let damping = solids.structure.damping();
        Self { mass: damping.mass / solids.scales.speed, stiffness: damping.stiffness * solids.scales.speed }
    }

    /// βK, where there is damping in proportion to stiffness.
    fn rubbed(self, stiffness: &Symmetric) -> Option<Symmetric> {
        let times = |k: &f64| self.stiffness * k;
        let all = || Symmetric { value: stiffness.value.iter().map(times).collect(), ..stiffness.clone() };
        (self.stiffness > 0.0).then(all)
    }

    /// (s² + sα)/(1 + sβ).
    fn inertia(self, s: Complex64) -> Complex64 {
        s * (s + self.mass) / self.elastic(s)
    }

    /// 1 + sβ.
    fn elastic(self, s: Complex64) -> Complex64 {
        1.0 + self.stiffness * s
    }
}

/// Complex amplitudes of a pair (u, v), real and imaginary parts.
type Waves = [[f64; 2]; 2];

/// Row `row` of a matrix over instances or coefficients times number `which` of the pairs `k` of all of them.
fn weighted(matrix: &Matrix, row: usize, [k, which]: [usize; 2], all: &[Vec<[f64; 2]>]) -> f64 {
    matrix.row(row).iter().zip(all).map(|(w, part)| w * part[k][which]).sum::<f64>()
}

/// The pairs of one harmonic with λ = s + ikω, `lambda`, from the right-hand sides `known`; `omega` is the pace of what is held.
fn solve_harmonic<const D: usize>(
    solids: &Solids<D>,
    (factors, rubbed): (&mut ComplexFactors, Option<&Symmetric>),
    lambda: Complex64,
    omega: f64,
    known: &[Waves],
) -> Vec<Waves> {
    let (s, w, damped, solid) = (lambda.re, lambda.im, Damped::of(solids), &solids.structure.solid);
    let held = |k: usize| solid.is_held(k / D, k % D);
    let mass = |k: usize| solid.mass()[k / D] * solids.scales.speed * solids.scales.speed;
    // r_v + (λ + α) r_u
    let a = s + damped.mass;
    let inertia = |k: usize| {
        let [u, v] = known[k];
        [mass(k) * (v[0] + a * u[0] - w * u[1]), mass(k) * (v[1] + a * u[1] + w * u[0])]
    };
    let mut x: Vec<[f64; 2]> = (0..known.len()).map(|k| if held(k) { [0.0; 2] } else { inertia(k) }).collect();
    if let Some(rubbed) = rubbed {
        let elastic = damped.elastic(lambda);
        let [re, im] = [0, 1].map(|part| pulled(rubbed, &held, known.iter().map(|pair| pair[0][part])));
        for (k, x) in x.iter_mut().enumerate() {
            let divided = Complex64::new(x[0] + re[k], x[1] + im[k]) / elastic;
            *x = [divided.re, divided.im];
        }
    }
    factors.solve(&mut x);
    let pair = |k: usize| {
        if held(k) {
            return known[k].map(|r| r.map(|r| r / (s + omega)));
        }
        let (u, r) = (x[k], known[k][0]);
        [u, [s * u[0] - w * u[1] - r[0], s * u[1] + w * u[0] - r[1]]]
    };
    (0..known.len()).map(pair).collect()
}

/// The preconditioner of bodies made of particles.
pub(super) struct SolidPreconditioner<const D: usize> {
    solids: Arc<Solids<D>>,
    period: Option<Period>,
    pace: Pace,
    time: f64,
    step: f64,
    work: Work<D>,
    points: f64,
    inverse: Inverse,
    shift: f64,
    coefficient: f64,
    omega: f64,
    /// What leads each body from time 0 to each instance of a period.
    turns: Vec<Vec<RigidPose<D>>>,
}

impl<const D: usize> SolidPreconditioner<D> {
    pub(super) fn new(solids: Arc<Solids<D>>, period: Option<Period>) -> Self {
        let work = solids.work();
        let times = period.map_or_else(Vec::new, |p| p.instances.times(p.omega));
        let turns = times.into_iter().map(|t| solids.bodies.iter().map(|b| b.led(t)).collect()).collect();
        let omega = solids.omega;
        let (pace, time, step, points) = (Pace::Held, 0.0, 0.0, 1.0);
        Self {
            solids,
            period,
            pace,
            time,
            step,
            work,
            points,
            inverse: Inverse::Diagonal,
            shift: omega,
            coefficient: 0.0,
            omega,
            turns,
        }
    }

    pub(super) fn begin(&mut self, points: usize) {
        self.points = points as f64;
        self.work.displacement.fill([0.0; D]);
        self.work.velocity.fill([0.0; D]);
    }

    /// Adds a state and what materials remember: the stiffness is that at the mean of all.
    pub(super) fn add(&mut self, at: &Moving<'_>, u: &[f64], remembered: &[f64]) {
        let t = at.time;
        (self.time, self.step, self.pace) = (t, at.step, at.pace);
        if !remembered.is_empty() {
            self.work.history.copy_from_slice(remembered);
        }
        let solids = Arc::clone(&self.solids);
        for body in &solids.bodies {
            let led = if self.period.is_some() { body.led(t) } else { RigidPose::identity() };
            for i in body.particles.clone() {
                let x = &solids.structure.solid.particles.x[i];
                let u = Vector::from_fn(|a| u[2 * (i * D + a)]);
                let back = if self.period.is_some() { led.inverse_point(&(*x + u)) - *x } else { u };
                (0..D).for_each(|a| self.work.displacement[i][a] += back[a] / self.points);
            }
        }
    }

    pub(super) fn finish(&mut self, shift: &Shift<'_>, row: usize) {
        let solids = Arc::clone(&self.solids);
        (self.shift, self.coefficient) = (shift.of(row), shift.coefficient);
        let mass = solids.scales.speed * solids.scales.speed;
        let (t, s, damped) = ((self.time, self.step), self.shift, Damped::of(&solids));
        self.inverse = match (self.pace, &self.period) {
            (Pace::Held, _) => Inverse::Diagonal,
            (Pace::Steady, _) => {
                let rest = solids.work();
                let reference = solids.stiffness(&rest, t, (1.0, 0.0));
                let mut all = solids.stiffness(&self.work, t, (1.0, 0.0));
                all.value.iter_mut().zip(&reference.value).for_each(|(k, k0)| *k = s * k0 + self.omega * *k);
                match all.factor() {
                    Some(factors) => Inverse::Rest { factors, reference },
                    None => Inverse::Diagonal,
                }
            }
            (Pace::Marching, None) => {
                let inertia = damped.inertia(s.into()).re;
                let stiffness = solids.stiffness(&self.work, t, (1.0, inertia * mass));
                // without that of inertia, where it is wanted
                let elastic = || solids.stiffness(&self.work, t, (1.0, 0.0));
                let rubbed = (damped.stiffness > 0.0).then(elastic).and_then(|k| damped.rubbed(&k));
                match stiffness.factor() {
                    Some(factors) => Inverse::Real { factors, rubbed },
                    None => Inverse::Diagonal,
                }
            }
            (Pace::Marching, Some(period)) => {
                let stiffness = solids.stiffness(&self.work, t, (1.0, 0.0));
                let of = |k: usize| {
                    let square = mass * damped.inertia(Complex64::new(s, k as f64 * period.omega));
                    let square = [square.re, square.im];
                    let solid = &solids.structure.solid;
                    let entry = |(i, a): (usize, usize)| {
                        let free = f64::from(u8::from(!solid.is_held(i, a)));
                        square.map(|z| z * free * solid.mass()[i])
                    };
                    let diagonal: Vec<[f64; 2]> =
                        (0..solids.len()).flat_map(|i| (0..D).map(move |a| (i, a))).map(entry).collect();
                    stiffness.factor_with(&diagonal)
                };
                let all: Option<Vec<ComplexFactors>> = (0..=period.instances.harmonics()).map(of).collect();
                let rubbed = damped.rubbed(&stiffness);
                all.map_or(Inverse::Diagonal, |factors| Inverse::Harmonics { factors, rubbed })
            }
        };
    }

    /// z = what solves the systems for the right-hand sides `r`, whose rows are those of `at`.
    pub(super) fn apply(&mut self, r: &RightHandSide<'_>, at: &Placed, z: &mut [f64]) {
        let solids = Arc::clone(&self.solids);
        let (n, count) = (solids.len(), self.period.map_or(1, |p| p.instances.count()));
        let b = 2 * D * count;
        debug_assert!(z.len() == n * b && at.field.rows == n);
        // u and v apart, all particles and components of an instance one after another
        let mut parts = vec![vec![[0.0; 2]; n * D]; count];
        let mut row = vec![0.0; b];
        for i in 0..n {
            r.row_in_full(i, i * b, &mut row);
            for (m, part) in parts.iter_mut().enumerate() {
                for a in 0..D {
                    part[i * D + a] = [row[m * 2 * D + 2 * a], row[m * 2 * D + 2 * a + 1]];
                }
            }
        }
        match self.period {
            None => self.solve(&mut parts[0]),
            Some(period) => {
                self.turn(&mut parts, RigidPose::inverse_direction);
                self.solve_harmonics(&period, &mut parts);
                self.turn(&mut parts, RigidPose::direction);
            }
        }
        for i in 0..n {
            for (m, part) in parts.iter().enumerate() {
                for a in 0..D {
                    let to = i * b + m * 2 * D + 2 * a;
                    [z[to], z[to + 1]] = part[i * D + a];
                }
            }
        }
    }

    /// Turns the pairs of all instances by what leads their bodies.
    fn turn(&self, parts: &mut [Vec<[f64; 2]>], by: impl Fn(&RigidPose<D>, &Vector<D>) -> Vector<D>) {
        for (part, turns) in parts.iter_mut().zip(&self.turns) {
            for (body, pose) in self.solids.bodies.iter().zip(turns).filter(|(body, _)| body.lead.is_some()) {
                for pairs in part[body.particles.start * D..body.particles.end * D].chunks_exact_mut(D) {
                    let turned = [0, 1].map(|k| by(pose, &Vector::from_fn(|a| pairs[a][k])));
                    pairs.iter_mut().enumerate().for_each(|(a, pair)| *pair = turned.map(|v| v[a]));
                }
            }
        }
    }

    /// Pairs (u, v) at one instance.
    fn solve(&self, all: &mut [[f64; 2]]) {
        let (s, solids) = (self.shift, &self.solids);
        let solid = &solids.structure.solid;
        let held = |k: usize| solid.is_held(k / D, k % D);
        let mass = |k: usize| solid.mass()[k / D] * solids.scales.speed * solids.scales.speed;
        // ∂/∂t of what is held is on both sides
        let own = s + self.omega - self.coefficient;
        match &self.inverse {
            Inverse::Real { factors, rubbed } => {
                let damped = Damped::of(solids);
                let inertia = |k: usize| mass(k) * (all[k][1] + (s + damped.mass) * all[k][0]);
                let mut x: Vec<f64> = (0..all.len()).map(|k| if held(k) { 0.0 } else { inertia(k) }).collect();
                if let Some(rubbed) = rubbed {
                    let pulled = pulled(rubbed, &held, all.iter().map(|pair| pair[0]));
                    x.iter_mut().zip(&pulled).for_each(|(x, p)| *x += p);
                }
                let elastic = damped.elastic(s.into()).re;
                x.iter_mut().for_each(|x| *x /= elastic);
                factors.solve(&mut x);
                for (k, pair) in all.iter_mut().enumerate() {
                    *pair = if held(k) { pair.map(|r| r / own) } else { [x[k], s * x[k] - pair[0]] };
                }
            }
            Inverse::Rest { factors, reference } => {
                let right: Vec<f64> = (0..all.len()).map(|k| if held(k) { 0.0 } else { all[k][0] }).collect();
                let mut x = vec![0.0; all.len()];
                reference.product(&right, &mut x);
                factors.solve(&mut x);
                for (k, pair) in all.iter_mut().enumerate() {
                    let u = if held(k) { pair[0] / (s + self.omega) } else { x[k] };
                    *pair = [u, pair[1] / (s + self.omega)];
                }
            }
            _ => all.iter_mut().for_each(|pair| *pair = pair.map(|r| r / (s + self.omega))),
        }
    }

    /// The pairs of all instances, harmonic by harmonic.
    fn solve_harmonics(&mut self, period: &Period, parts: &mut [Vec<[f64; 2]>]) {
        let (s, solids) = (self.shift, Arc::clone(&self.solids));
        let Inverse::Harmonics { factors, rubbed } = &mut self.inverse else {
            let part = s + self.omega;
            parts.iter_mut().flatten().for_each(|pair| *pair = pair.map(|r| r / part));
            return;
        };
        let (forward, back) = (period.instances.to_coefficients(), period.instances.to_values());
        let h = period.instances.harmonics();
        let mut found = vec![vec![[0.0; 2]; parts[0].len()]; 2 * h + 1];
        for (m, factors) in factors.iter_mut().enumerate() {
            // q = Re(q̂ exp(iωt)): q̂ = cosine − i sine
            let complex = |k: usize, which: usize| match m {
                0 => [weighted(&forward, 0, [k, which], parts), 0.0],
                _ => [weighted(&forward, m, [k, which], parts), -weighted(&forward, m + h, [k, which], parts)],
            };
            let known: Vec<Waves> = (0..parts[0].len()).map(|k| [complex(k, 0), complex(k, 1)]).collect();
            let w = m as f64 * period.omega;
            let solved = solve_harmonic(&solids, (factors, rubbed.as_ref()), Complex64::new(s, w), self.omega, &known);
            for (k, [u, v]) in solved.into_iter().enumerate() {
                found[m][k] = [u[0], v[0]];
                if m > 0 {
                    found[m + h][k] = [-u[1], -v[1]];
                }
            }
        }
        for (m, part) in parts.iter_mut().enumerate() {
            for (k, pair) in part.iter_mut().enumerate() {
                *pair = [weighted(&back, m, [k, 0], &found), weighted(&back, m, [k, 1], &found)];
            }
        }
    }

    pub(super) fn bytes(&self) -> usize {
        let n = self.work.displacement.len();
        let matrix = |m: Option<&Symmetric>| m.map_or(0, |m| 16 * m.value.len());
        let factors = match &self.inverse {
            Inverse::Diagonal => 0,
            Inverse::Real { factors, rubbed } => factors.bytes() + matrix(rubbed.as_ref()),
            Inverse::Rest { factors, reference } => factors.bytes() + matrix(Some(reference)),
            Inverse::Harmonics { factors, rubbed } => {
                factors.iter().map(ComplexFactors::bytes).sum::<usize>() + matrix(rubbed.as_ref())
            }
        };
        factors + 8 * n * D * 6
    }
}

/// βK r of what is free.
fn pulled(rubbed: &Symmetric, held: &impl Fn(usize) -> bool, r: impl Iterator<Item = f64>) -> Vec<f64> {
    let free: Vec<f64> = r.enumerate().map(|(k, r)| if held(k) { 0.0 } else { r }).collect();
    let mut out = vec![0.0; free.len()];
    rubbed.product(&free, &mut out);
    out
}
