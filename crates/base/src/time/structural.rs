//! Implicit methods for structures: generalised-α steps in time, and static equilibrium.
//!
//! A step of the generalised-α method (Chung and Hulbert 1993, doi:10.1115/1.2900803) solves M a_m + f_int(u_f) =
//! f(t_f) at points within the step, with the spectral radius ρ∞ for frequencies that are not resolved; ρ∞ = 1 is the
//! constant average acceleration of Newmark (1959), which conserves the energy of linear structures. Newton's method
//! uses the consistent tangent of the materials. Its equations are solved by conjugate gradients, preconditioned by
//! Cholesky factors of an earlier matrix, or by the diagonal if there are too many unknowns for a factorisation.
//! Equilibrium uses the same solver without inertia, in load steps.
use super::{Cost, Integrator, Mark, Memory, Past, Standing, Step, TimeError};
use crate::math::conjugate::{Symmetric as ByProducts, conjugate_gradients};
use crate::math::reduce::{dot, maximum, sum};
use crate::math::sparse::Factors;
use crate::math::types::Vector;
use crate::system::{Fault, Instant, Mechanical, Moment};

/// Parameters of Newton's method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newton {
    /// Ratio of the residual force to the applied forces at convergence.
    pub tolerance: f64,
    /// Maximum number of iterations.
    pub iterations: u32,
}

/// Ratio of the residual force to the forces that is accepted as round-off if Newton's method makes no further
/// progress.
const ROUND_OFF: f64 = 1e-6;
/// Number of conjugate-gradient iterations with factors after which the factors are recomputed.
const STALE: usize = 12;
/// Maximum number of conjugate-gradient iterations with the diagonal.
const MOST: usize = 20_000;

/// Solver of (scale K + shift M) x = r for successive matrices.
struct Solver {
    factors: Option<Factors>,
    stale: bool,
}

/// One linear system of Newton's method.
struct Equations<'a, S: Mechanical> {
    system: &'a S,
    stiffness: &'a S::Stiffness,
    scale: f64,
    shift: f64,
}

impl Solver {
    const NEW: Self = Self { factors: None, stale: true };

    /// Adds the solution for the residual `r` to `x` and returns the number of iterations; `None` if the matrix is not
    /// positive definite.
    fn solve<S: Mechanical>(
        &mut self,
        equations: &Equations<'_, S>,
        (x, r): (&mut [f64], &mut [f64]),
        work: &mut S::Work,
        tolerance: f64,
    ) -> Option<usize> {
        let Equations { system, stiffness, scale, shift } = *equations;
        let n = x.len();
        let factored = n <= system.largest_factored();
        if factored && self.stale {
            self.factors = Some(system.matrix(stiffness, scale, shift).factor()?);
            self.stale = false;
        }
        let diagonal: Vec<f64> = match factored {
            true => Vec::new(),
            false => diagonal(equations),
        };
        let held: Vec<bool> = (0..n).map(|k| system.is_held(k)).collect();
        let (mut y, mut left): (Vec<Vector<1>>, Vec<Vector<1>>) =
            (vec![Vector::ZERO; n], r.iter().map(|r| Vector([*r])).collect());
        let goal = tolerance * dot(r, r).sqrt();
        let (mut plain, mut image) = (vec![0.0; n], vec![0.0; n]);
        let (mut solved, factors) = (vec![0.0; n], &self.factors);
        let iterations = conjugate_gradients(
            &mut y,
            &mut left,
            if factored { 10 * STALE } else { MOST },
            ByProducts {
                enough: |r: &[Vector<1>]| sum(r.len(), |k| r[k][0] * r[k][0]).sqrt() <= goal,
                product: |v: &[Vector<1>], out: &mut [Vector<1>]| {
                    plain.iter_mut().zip(v).for_each(|(p, v)| *p = v[0]);
                    system.stiffness(stiffness, &plain, work, &mut image);
                    for k in 0..n {
                        let all = scale * image[k] + shift * system.mass(k) * plain[k];
                        out[k] = Vector([if held[k] { plain[k] } else { all }]);
                    }
                },
                precondition: |r: &[Vector<1>], z: &mut [Vector<1>]| match factors {
                    Some(factors) if factored => {
                        solved.iter_mut().zip(r).for_each(|(s, r)| *s = r[0]);
                        factors.solve(&mut solved);
                        z.iter_mut().zip(&solved).for_each(|(z, s)| z[0] = *s);
                    }
                    _ => z.iter_mut().enumerate().for_each(|(k, z)| z[0] = r[k][0] / diagonal[k]),
                },
            },
        );
        self.stale |= iterations > STALE;
        x.iter_mut().zip(&y).for_each(|(x, y)| *x += y[0]);
        r.iter_mut().zip(&left).for_each(|(r, l)| *r = l[0]);
        Some(iterations)
    }
}

/// Diagonal of scale K + shift M.
fn diagonal<S: Mechanical>(equations: &Equations<'_, S>) -> Vec<f64> {
    let Equations { system, stiffness, scale, shift } = *equations;
    let of = |(k, d): (usize, &f64)| if system.is_held(k) { 1.0 } else { scale * d + shift * system.mass(k) };
    system.diagonal(stiffness).iter().enumerate().map(of).collect()
}

/// Parameters of an implicit march.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Length of a time step.
    pub step: f64,
    /// Time at the end.
    pub until: f64,
    /// Spectral radius ρ∞ for unresolved frequencies, 0 to 1; smaller values damp them more.
    pub radius: f64,
    /// Parameters of Newton's method.
    pub newton: Newton,
}

/// An implicit march of a structure by the generalised-α method.
pub struct GeneralisedAlpha<'a, S: Mechanical> {
    system: &'a S,
    plan: Plan,
    past: Past,
    frame: S::Frame,
    work: S::Work,
    u: Vec<f64>,
    after: Vec<f64>,
    acceleration: Vec<f64>,
    solver: Solver,
    cost: Cost,
}

/// Parameters of the generalised-α method.
#[derive(Clone, Copy)]
struct Weights {
    mass: f64,
    force: f64,
    beta: f64,
    gamma: f64,
}

impl Weights {
    fn of(radius: f64) -> Self {
        let (mass, force) = ((2.0 * radius - 1.0) / (radius + 1.0), radius / (radius + 1.0));
        let gamma = 0.5 - mass + force;
        Self { mass, force, beta: 0.25 * (1.0 - mass + force).powi(2), gamma }
    }

    /// Derivative of the velocities at the end of a step with respect to the displacements there [1/time].
    fn rate(self, step: f64) -> f64 {
        self.gamma / (self.beta * step)
    }

    /// Factor of the mass matrix in Newton's equations, including mass-proportional damping.
    fn shift(self, step: f64, damping: f64) -> f64 {
        (1.0 - self.mass) / (self.beta * step * step) + (1.0 - self.force) * self.rate(step) * damping
    }
}

impl<'a, S: Mechanical> GeneralisedAlpha<'a, S> {
    /// Prepares a march from the state `u`; if the march is resumed, `past.before` holds the accelerations.
    pub fn new(system: &'a S, plan: Plan, past: Past, u: Vec<f64>) -> Self {
        let n = system.displacements();
        let mut march = Self {
            frame: system.frame(&Instant::still(past.time), &u),
            work: system.work(),
            after: vec![0.0; u.len() - 2 * n],
            acceleration: past.before.clone(),
            solver: Solver::NEW,
            cost: Cost::default(),
            system,
            plan,
            past,
            u,
        };
        if march.acceleration.is_empty() {
            let mut force = vec![0.0; n];
            let (u, rest) = march.u.split_at(n);
            let at =
                Moment { time: march.past.time, step: 0.0, displacement: u, velocity: &rest[..n], history: &rest[n..] };
            system.forces(&at, &mut march.work, &mut force, &mut march.after);
            march.acceleration =
                (0..n).map(|k| if system.is_held(k) { 0.0 } else { force[k] / system.mass(k) }).collect();
        }
        march
    }

    /// Computes one step of length `step`: the new state and accelerations, or the reason of the failure.
    fn step(&mut self, step: f64, end: f64) -> Result<(), Fault> {
        let (system, n) = (self.system, self.acceleration.len());
        let w = Weights::of(self.plan.radius);
        let (u0, rest) = self.u.split_at(n);
        let (v0, history) = (rest[..n].to_vec(), &rest[n..]);
        let a0 = self.acceleration.clone();
        let held: Vec<bool> = (0..n).map(|k| system.is_held(k)).collect();
        // factors of an earlier step would not be available to a resumed run
        self.solver.stale = true;
        // initial guess: constant accelerations
        let mut u: Vec<f64> = (0..n).map(|k| u0[k] + step * v0[k] + 0.5 * step * step * a0[k]).collect();
        system.hold(end, &mut u);
        let middle = self.past.time + (1.0 - w.force) * step;
        let (mut force, mut scale, mut before) = (vec![0.0; n], 0.0f64, f64::INFINITY);
        let acceleration =
            |u: &[f64], k: usize| ((u[k] - u0[k] - step * v0[k]) / (step * step) - (0.5 - w.beta) * a0[k]) / w.beta;
        for iteration in 0..self.plan.newton.iterations {
            let within: Vec<f64> = (0..n).map(|k| (1.0 - w.force) * u[k] + w.force * u0[k]).collect();
            let velocity: Vec<f64> = (0..n)
                .map(|k| {
                    let v = v0[k] + step * ((1.0 - w.gamma) * a0[k] + w.gamma * acceleration(&u, k));
                    (1.0 - w.force) * v + w.force * v0[k]
                })
                .collect();
            let at = Moment { time: middle, step, displacement: &within, velocity: &velocity, history };
            system.forces(&at, &mut self.work, &mut force, &mut self.after);
            self.cost.evaluations += 1;
            let mut left: Vec<f64> = (0..n)
                .map(|k| {
                    let a = (1.0 - w.mass) * acceleration(&u, k) + w.mass * a0[k];
                    if held[k] { 0.0 } else { force[k] - system.mass(k) * a }
                })
                .collect();
            let inertia = |k: usize| system.mass(k) * acceleration(&u, k).abs().max(a0[k].abs());
            scale = scale.max(maximum(n, |k| if held[k] { 0.0 } else { force[k].abs().max(inertia(k)) }));
            let size = maximum(n, |k| left[k].abs());
            if size.is_nan() || !left.iter().all(|l| l.is_finite()) {
                break;
            }
            let spent = size > 0.5 * before && size <= ROUND_OFF * scale;
            before = size;
            if iteration > 0 && (size <= self.plan.newton.tolerance * scale || spent) {
                return self.accept(&u, (&v0, &a0), (step, end), w);
            }
            let stiffness = system.linearise(&at, [1.0, w.rate(step)]);
            let (scale, shift) = (1.0 - w.force, w.shift(step, system.damping().mass));
            let equations = Equations { system, stiffness: &stiffness, scale, shift };
            let mut change = vec![0.0; n];
            let solved = self.solver.solve(&equations, (&mut change, &mut left), &mut self.work, 1e-6);
            let Some(linear) = solved else { break };
            self.cost.linear += linear as u32;
            u.iter_mut().zip(&change).for_each(|(u, c)| *u += c);
        }
        let reason = format!("Newton's method did not converge in a step of {step:.3e} to time {end:.6e}");
        Err(Fault { particle: 0, place: Vec::new(), reason })
    }

    fn accept(
        &mut self,
        u: &[f64],
        (v0, a0): (&[f64], &[f64]),
        (step, end): (f64, f64),
        w: Weights,
    ) -> Result<(), Fault> {
        let n = u.len();
        let mut new = self.u.clone();
        let mut accelerations = vec![0.0; n];
        for k in 0..n {
            let a = ((u[k] - self.u[k] - step * v0[k]) / (step * step) - (0.5 - w.beta) * a0[k]) / w.beta;
            accelerations[k] = a;
            new[k] = u[k];
            new[n + k] = v0[k] + step * ((1.0 - w.gamma) * a0[k] + w.gamma * a);
        }
        // materials store the state at the end of the step, not that at the point within it
        let (displacement, rest) = new.split_at(n);
        let at = Moment { time: end, step, displacement, velocity: &rest[..n], history: &self.u[2 * n..] };
        let mut force = vec![0.0; n];
        self.system.forces(&at, &mut self.work, &mut force, &mut self.after);
        new[2 * n..].copy_from_slice(&self.after);
        self.system.check(&self.frame, &new)?;
        (self.u, self.acceleration) = (new, accelerations);
        Ok(())
    }
}

impl<S: Mechanical> Integrator<S> for GeneralisedAlpha<'_, S> {
    fn finished(&self) -> bool {
        self.past.time >= self.plan.until
    }

    fn mark(&self) -> Mark {
        self.past.mark()
    }

    fn standing(&mut self) -> Standing<'_, S> {
        Standing { system: self.system, frame: &self.frame, work: &mut self.work, state: &self.u }
    }

    fn memory(&self) -> Memory {
        Memory::March(Past { before: self.acceleration.clone(), ..self.past.clone() })
    }

    fn cost(&self) -> Cost {
        Cost { bytes: 8 * (self.u.len() + 2 * self.acceleration.len()), ..self.cost }
    }

    fn advance(&mut self) -> Result<Step, TimeError> {
        /// Maximum number of times that a step is halved.
        const HALVED: u32 = 10;
        let left = self.plan.until - self.past.time;
        // a remaining time at round-off level is added to the last step
        let mut step = if left < self.plan.step * (1.0 + 1e-6) { left } else { self.plan.step };
        for halved in 0..=HALVED {
            let end = if step == left { self.plan.until } else { self.past.time + step };
            match self.step(step, end) {
                Ok(()) => {
                    (self.past.time, self.past.last) = (end, step);
                    self.past.iteration += 1;
                    self.system.place(&Instant::still(end), &mut self.frame);
                    let cfl = step / self.plan.step;
                    return Ok(Step {
                        iteration: self.past.iteration,
                        time: end,
                        cfl,
                        residual: 1.0,
                        linear: self.cost.linear,
                    });
                }
                Err(fault) if halved == HALVED => {
                    let hint = "lower `time.newmark.step`, or check the loads and their units";
                    return Err(TimeError::Fault { fault, iteration: self.past.iteration + 1, hint });
                }
                Err(_) => {
                    (step, self.solver.stale) = (0.5 * step, true);
                    self.past.halved += 1;
                    self.cost.halved += 1;
                }
            }
        }
        unreachable!("the last of the halved steps returns")
    }
}

/// Parameters of a search for equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadPlan {
    /// Number of load steps up to the full load.
    pub steps: u32,
    /// Parameters of Newton's method.
    pub newton: Newton,
}

/// Search for static equilibrium: the time of the structure increases from 0 to 1 with the load, and a system applies
/// the corresponding fraction of its loads.
pub struct Equilibrium<'a, S: Mechanical> {
    system: &'a S,
    plan: LoadPlan,
    past: Past,
    frame: S::Frame,
    work: S::Work,
    u: Vec<f64>,
    solver: Solver,
    cost: Cost,
    residual: f64,
}

impl<'a, S: Mechanical> Equilibrium<'a, S> {
    /// Prepares a search for equilibrium from the state `u`.
    pub fn new(system: &'a S, plan: LoadPlan, past: Past, u: Vec<f64>) -> Self {
        Self {
            frame: system.frame(&Instant::still(past.time), &u),
            work: system.work(),
            solver: Solver::NEW,
            cost: Cost::default(),
            residual: 1.0,
            system,
            plan,
            past,
            u,
        }
    }

    /// Finds the equilibrium under the fraction `load` of the load.
    fn settle(&mut self, load: f64) -> Result<(), Fault> {
        let (system, n) = (self.system, self.system.displacements());
        let mut u = self.u[..n].to_vec();
        system.hold(load, &mut u);
        let still = vec![0.0; n];
        let (mut force, mut after) = (vec![0.0; n], vec![0.0; self.u.len() - 2 * n]);
        let (mut scale, mut before) = (0.0f64, f64::INFINITY);
        let moved = maximum(n, |k| (u[k] - self.u[k]).abs()) > 0.0;
        for iteration in 0..=self.plan.newton.iterations {
            let history = &self.u[2 * n..];
            let at = Moment { time: load, step: 0.0, displacement: &u, velocity: &still, history };
            system.forces(&at, &mut self.work, &mut force, &mut after);
            self.cost.evaluations += 1;
            let mut left: Vec<f64> = (0..n).map(|k| if system.is_held(k) { 0.0 } else { force[k] }).collect();
            let size = maximum(n, |k| left[k].abs());
            if !left.iter().all(|l| l.is_finite()) {
                break;
            }
            scale = scale.max(maximum(n, |k| force[k].abs()));
            self.residual = if scale > 0.0 { size / scale } else { 0.0 };
            let spent = size > 0.5 * before && size <= ROUND_OFF * scale;
            before = size;
            let first = iteration == 0 && moved;
            if (self.residual <= self.plan.newton.tolerance || spent) && !first {
                self.u[..n].copy_from_slice(&u);
                self.u[2 * n..].copy_from_slice(&after);
                return system.check(&self.frame, &self.u);
            }
            let stiffness = system.linearise(&at, [1.0, 0.0]);
            let equations = Equations { system, stiffness: &stiffness, scale: 1.0, shift: 0.0 };
            let mut change = vec![0.0; n];
            self.solver.stale |= iteration > 0;
            let Some(linear) = self.solver.solve(&equations, (&mut change, &mut left), &mut self.work, 1e-8) else {
                break;
            };
            self.cost.linear += linear as u32;
            u.iter_mut().zip(&change).for_each(|(u, c)| *u += c);
        }
        let reason = format!(
            "Newton's method found no equilibrium under {:.1} % of the load: the residual is {:.1e} of the largest force",
            100.0 * load,
            self.residual
        );
        Err(Fault { particle: 0, place: Vec::new(), reason })
    }
}

impl<S: Mechanical> Integrator<S> for Equilibrium<'_, S> {
    fn finished(&self) -> bool {
        self.past.time >= 1.0
    }

    fn mark(&self) -> Mark {
        Mark { residual: self.residual, ..self.past.mark() }
    }

    fn standing(&mut self) -> Standing<'_, S> {
        Standing { system: self.system, frame: &self.frame, work: &mut self.work, state: &self.u }
    }

    fn memory(&self) -> Memory {
        Memory::March(self.past.clone())
    }

    fn cost(&self) -> Cost {
        Cost { bytes: 8 * self.u.len(), ..self.cost }
    }

    fn advance(&mut self) -> Result<Step, TimeError> {
        /// Maximum number of times that a load step is halved.
        const HALVED: u32 = 8;
        let mut step = (1.0 / f64::from(self.plan.steps)).min(1.0 - self.past.time);
        for halved in 0..=HALVED {
            let load = if self.past.time + step > 1.0 - 1e-9 { 1.0 } else { self.past.time + step };
            let before = self.u.clone();
            match self.settle(load) {
                Ok(()) => {
                    (self.past.time, self.past.last) = (load, step);
                    self.past.iteration += 1;
                    self.system.place(&Instant::still(load), &mut self.frame);
                    let Self { residual, .. } = *self;
                    return Ok(Step {
                        iteration: self.past.iteration,
                        time: load,
                        cfl: 1.0,
                        residual,
                        linear: self.cost.linear,
                    });
                }
                Err(fault) if halved == HALVED => {
                    self.u = before;
                    let hint = "raise `load_steps`, add supports, or check whether the body buckles";
                    return Err(TimeError::Fault { fault, iteration: self.past.iteration + 1, hint });
                }
                Err(_) => {
                    self.u = before;
                    (step, self.solver.stale) = (0.5 * step, true);
                    self.cost.halved += 1;
                }
            }
        }
        unreachable!("the last of the halved steps returns")
    }
}
