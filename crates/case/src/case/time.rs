//! Time integration of a case, as data.
use serde::{Deserialize, Serialize};

use super::{Case, Frequency, Time};

/// Kind of the computation: steady relaxation, time marching, harmonic balance or vibration modes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Temporal {
    /// Relaxation to a steady state.
    Steady(Steady),
    /// Time marching with an explicit Runge-Kutta method.
    Explicit(Explicit),
    /// Implicit time marching with dual time stepping.
    Dual(Dual),
    /// Periodic solution by harmonic balance.
    Harmonics(Harmonics),
    /// Implicit time marching of a purely structural case.
    Newmark(Newmark),
    /// Natural modes of a purely structural case.
    Modes(Modes),
}

/// Implicit time marching of a purely structural case by the generalised-α method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Newmark {
    /// Time step [s].
    pub step: Time,
    /// End time [s].
    pub until: Time,
    /// Spectral radius ρ∞ at infinite frequency, from 0 to 1.
    pub rho_infinity: f64,
    /// Residual relative to the magnitude of the forces at which a step is converged.
    pub tolerance: f64,
    /// Greatest number of Newton iterations per step.
    pub iterations: u32,
}

/// Natural modes of a purely structural case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Modes {
    /// Number of modes.
    pub number: u32,
    /// Lower bound of the frequencies: the modes above it and nearest to it are computed; absent: the lowest modes.
    pub shift: Option<Frequency>,
    /// True for modes about the static equilibrium under the loads, false for modes about the stress-free shape.
    pub preload: bool,
}

/// Settings of the harmonic balance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Harmonics {
    /// Number of harmonics.
    pub number: HarmonicCount,
    /// Number of harmonics with which the equations are evaluated divided by the number of harmonics of the solution.
    pub oversample: f64,
    /// Greatest fraction of all harmonics that the last one may have, for the automatic choice of their number.
    pub tail: f64,
    /// Greatest number of harmonics of the automatic choice.
    pub most: u32,
    /// Orders of magnitude by which the residual must fall.
    pub orders: f64,
    /// Alternative criterion: change of the loads below which the iteration ends.
    pub tolerance: f64,
    /// Greatest number of iterations for each number of harmonics.
    pub iterations: u32,
    /// Number of periods that are marched in time before, to provide the initial guess.
    #[serde(default)]
    pub march: u32,
    /// Number of periods that are marched in time afterwards, to compare a time march with the harmonic balance.
    #[serde(default)]
    pub check: u32,
    /// Iterative method.
    pub method: SteadyMethod,
    /// Initial Courant number.
    pub cfl: f64,
    /// Greatest Courant number.
    pub cfl_max: f64,
    /// Frequency of a purely structural case; with gas it is that of the motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frequency: Option<Frequency>,
    /// Period, an alternative to `frequency`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period: Option<Time>,
}

/// Number of harmonics: given or automatic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum HarmonicCount {
    /// A given number.
    Fixed(u32),
    /// The number is increased until the last harmonic is small enough.
    Auto(Automatic),
}

/// The word `auto`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Automatic {
    /// `auto`.
    Auto,
}

/// Settings of the steady relaxation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Steady {
    /// Iterative method.
    pub method: SteadyMethod,
    /// Orders of magnitude by which the residual must fall.
    pub orders: f64,
    /// Greatest number of iterations.
    pub iterations: u32,
    /// Initial Courant number.
    pub cfl: f64,
    /// Greatest Courant number.
    pub cfl_max: f64,
    /// Number of equal load steps of a purely structural case; absent: one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_steps: Option<u32>,
}

/// Iterative method of the steady relaxation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SteadyMethod {
    /// Newton's method with GMRES, preconditioned by symmetric Gauss-Seidel sweeps.
    NewtonKrylov,
    /// Lower-upper symmetric Gauss-Seidel sweeps (LU-SGS).
    LuSgs,
    /// Explicit Runge-Kutta method with local time steps, as a plain reference.
    RungeKutta,
}

/// Settings of explicit time marching; [`read()`](super::read()) ensures that one of `until` and `periods` is given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Explicit {
    /// End time.
    pub until: Option<Time>,
    /// Number of periods of the motion, an alternative to `until`.
    pub periods: Option<f64>,
    /// Courant number.
    pub cfl: f64,
    /// Runge-Kutta method.
    pub method: RungeKutta,
    /// Greatest number of time steps.
    pub steps: u32,
    /// Change of the mean and the first harmonic of the loads from one period to the next below which the run ends.
    pub periodic_tolerance: Option<f64>,
}

/// Explicit Runge-Kutta method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RungeKutta {
    /// Strong-stability-preserving, three stages, third order (Shu and Osher 1988).
    Ssprk3,
    /// Classical, four stages, fourth order.
    Rk4,
}

/// Settings of implicit time marching. One of `step` and `steps_per_period` is given, and one of `until` and `periods`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Dual {
    /// Time step.
    pub step: Option<Time>,
    /// Number of time steps per period of the motion, an alternative to `step`.
    pub steps_per_period: Option<u32>,
    /// End time.
    pub until: Option<Time>,
    /// Number of periods of the motion, an alternative to `until`.
    pub periods: Option<f64>,
    /// Order of the backward difference, 1 or 2.
    pub order: u8,
    /// Orders of magnitude by which the residual must fall within a time step.
    pub orders: f64,
    /// Greatest number of iterations within a time step.
    pub inner_iterations: u32,
    /// Orders of magnitude by which the residual of the steady flow must fall before the march; absent: as many as the
    /// march needs.
    #[serde(default)]
    pub start_orders: Option<f64>,
    /// Relative error of a time step that the step size control aims at; absent: fixed steps.
    pub adaptive: Option<f64>,
    /// Change of the mean and the first harmonic of the loads from one period to the next below which the run ends.
    pub periodic_tolerance: Option<f64>,
    /// Iterative method within a time step.
    pub method: SteadyMethod,
    /// Initial Courant number of the pseudo time in each step.
    pub cfl: f64,
    /// Greatest Courant number of the pseudo time.
    pub cfl_max: f64,
    /// Estimated period of a free vibration of structures; the run ends with the second of two equal periods. There is
    /// no key for it.
    #[serde(skip)]
    pub swing: Option<Time>,
}

impl Dual {
    /// A march with constant time steps; all other settings have their defaults.
    pub fn fixed(step: Time, until: Time) -> Self {
        Self {
            step: Some(step),
            steps_per_period: None,
            until: Some(until),
            periods: None,
            order: 2,
            orders: 2.0,
            inner_iterations: 50,
            start_orders: None,
            adaptive: None,
            periodic_tolerance: None,
            method: SteadyMethod::NewtonKrylov,
            cfl: 10.0,
            cfl_max: 1e6,
            swing: None,
        }
    }
}

impl Case {
    /// True for time-dependent cases.
    pub fn is_unsteady(&self) -> bool {
        !matches!(self.time, Temporal::Steady(_) | Temporal::Modes(_))
    }

    /// Angular frequency of the harmonic balance of a purely structural case.
    pub fn balance_frequency(&self) -> Option<f64> {
        let Temporal::Harmonics(plan) = &self.time else { return None };
        plan.frequency.map(|f| f.0).or_else(|| Some(std::f64::consts::TAU / plan.period?.0))
    }

    /// End time of a march in units of the solver; `period` is that of the motion in the same units. `None` when the
    /// end is given in periods but the motion has none, and for cases without a time march.
    pub fn end(&self, period: Option<f64>) -> Option<f64> {
        let (until, periods) = match &self.time {
            Temporal::Steady(_) | Temporal::Harmonics(_) | Temporal::Modes(_) => return None,
            Temporal::Newmark(plan) => (Some(plan.until), None),
            Temporal::Explicit(plan) => (plan.until, plan.periods),
            Temporal::Dual(plan) => (plan.until, plan.periods),
        };
        until.map(|t| self.flow.units().solver_time(t.0)).or_else(|| Some(periods? * period?))
    }

    /// Implicit time step in units of the solver, the first one when steps are adaptive; `period` as for [`Self::end`].
    pub fn step_length(&self, period: Option<f64>) -> Option<f64> {
        let (step, steps_per_period) = match &self.time {
            Temporal::Dual(plan) => (plan.step, plan.steps_per_period),
            Temporal::Newmark(plan) => (Some(plan.step), None),
            _ => return None,
        };
        let step = step.map(|t| self.flow.units().solver_time(t.0));
        step.or_else(|| Some(period? / f64::from(steps_per_period?)))
    }
}

impl Default for Temporal {
    fn default() -> Self {
        Self::Steady(Steady::default())
    }
}

impl Default for Steady {
    fn default() -> Self {
        Self {
            method: SteadyMethod::NewtonKrylov,
            orders: 6.0,
            iterations: 2000,
            cfl: 10.0,
            cfl_max: 1e6,
            load_steps: None,
        }
    }
}
