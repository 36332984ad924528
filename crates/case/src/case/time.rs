//! How a case goes on in time, as data.
use serde::{Deserialize, Serialize};

use super::{Case, Frequency, Time};

/// Steady relaxation or time marching.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Temporal {
    /// Relax to a steady state.
    Steady(Steady),
    /// March in time with an explicit Runge-Kutta method.
    Explicit(Explicit),
    /// March in time with implicit steps, each relaxed in a pseudo time.
    Dual(Dual),
    /// Find the periodic solution by harmonic balance.
    Harmonics(Harmonics),
    /// March structures alone in time with implicit steps.
    Newmark(Newmark),
    /// Find free vibrations of structures alone.
    Modes(Modes),
}

/// Implicit march of structures alone by the generalised-α method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Newmark {
    /// Step in time.
    pub step: Time,
    /// Time at which the run ends.
    pub until: Time,
    /// Spectral radius ρ∞ at infinite frequency, 0 to 1.
    pub rho_infinity: f64,
    /// Residual over the size of the forces at which a step ends.
    pub tolerance: f64,
    /// Greatest number of Newton iterations of a step.
    pub iterations: u32,
}

/// Free vibrations of structures alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Modes {
    /// How many.
    pub number: u32,
    /// The modes are the nearest above this frequency; absent: the lowest ones.
    pub shift: Option<Frequency>,
    /// They are about the static equilibrium under the loads, not about the stress-free shape.
    pub preload: bool,
}

/// Harmonic balance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Harmonics {
    /// Number of harmonics.
    pub number: HarmonicCount,
    /// Harmonics with which the equations are evaluated, over those that are kept.
    pub oversample: f64,
    /// Part that the last harmonic may have of all.
    pub tail: f64,
    /// Greatest number of harmonics when it is found on the way.
    pub most: u32,
    /// Orders of magnitude the residual must fall.
    pub orders: f64,
    /// Change of the loads below which the run ends as well.
    pub tolerance: f64,
    /// Greatest number of iterations for each number of harmonics.
    pub iterations: u32,
    /// Periods that are marched before, to begin from the last of them.
    #[serde(default)]
    pub march: u32,
    /// Periods that are marched afterwards, to tell how far a march ends from the balance.
    #[serde(default)]
    pub check: u32,
    /// Method.
    pub method: SteadyMethod,
    /// Courant number at the start.
    pub cfl: f64,
    /// Greatest Courant number.
    pub cfl_max: f64,
    /// Frequency of structures alone; with gas it is that of the motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frequency: Option<Frequency>,
    /// Their period instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period: Option<Time>,
}

/// A number of harmonics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum HarmonicCount {
    /// This one.
    Fixed(u32),
    /// As many as it takes.
    Auto(Automatic),
}

/// The word `auto`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Automatic {
    /// `auto`.
    Auto,
}

/// Steady relaxation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Steady {
    /// Method.
    pub method: SteadyMethod,
    /// Orders of magnitude the residual must fall.
    pub orders: f64,
    /// Greatest number of iterations.
    pub iterations: u32,
    /// Courant number at the start.
    pub cfl: f64,
    /// Greatest Courant number.
    pub cfl_max: f64,
    /// Equal steps in which the loads of structures alone grow; absent: one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_steps: Option<u32>,
}

/// Method of the steady relaxation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SteadyMethod {
    /// Newton's method with GMRES, preconditioned by sweeps.
    NewtonKrylov,
    /// Lower-upper symmetric Gauss-Seidel sweeps alone.
    LuSgs,
    /// Explicit Runge-Kutta with local steps: the plain reference.
    RungeKutta,
}

/// Explicit time marching; [`read()`](super::read()) sees to it that one of `until` and `periods` is there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Explicit {
    /// Time at which the run ends.
    pub until: Option<Time>,
    /// Number of periods of the motion instead.
    pub periods: Option<f64>,
    /// Courant number.
    pub cfl: f64,
    /// Runge-Kutta method.
    pub method: RungeKutta,
    /// Greatest number of steps.
    pub steps: u32,
    /// The run ends when mean and first harmonic of the loads change less from one period to the next.
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

/// Implicit time marching; one of `step` and `steps_per_period`, and one of `until` and `periods`, is there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Dual {
    /// Step in time.
    pub step: Option<Time>,
    /// Number of steps in a period of the motion instead.
    pub steps_per_period: Option<u32>,
    /// Time at which the run ends.
    pub until: Option<Time>,
    /// Number of periods of the motion instead.
    pub periods: Option<f64>,
    /// Order of the backward difference, 1 or 2.
    pub order: u8,
    /// Orders of magnitude the residual must fall within a step.
    pub orders: f64,
    /// Greatest number of iterations within a step.
    pub inner_iterations: u32,
    /// Orders of magnitude the residual of the steady flow must fall before the march; absent: as many as the march needs.
    #[serde(default)]
    pub start_orders: Option<f64>,
    /// Relative error of a step that the step size is fitted to; absent: fixed steps.
    pub adaptive: Option<f64>,
    /// The run ends when mean and first harmonic of the loads change less from one period to the next.
    pub periodic_tolerance: Option<f64>,
    /// Method of the relaxation within a step.
    pub method: SteadyMethod,
    /// Courant number of the pseudo time at the start of a step.
    pub cfl: f64,
    /// Greatest Courant number of the pseudo time.
    pub cfl_max: f64,
    /// About the period of a free motion of structures, with whose second like period the run ends; no key asks for that.
    #[serde(skip)]
    pub swing: Option<Time>,
}

impl Dual {
    /// A march with steps of one length, all else as it is without being told.
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
    /// True for cases that change in time.
    pub fn is_unsteady(&self) -> bool {
        !matches!(self.time, Temporal::Steady(_) | Temporal::Modes(_))
    }

    /// Angular frequency of a harmonic balance of structures alone.
    pub fn balance_frequency(&self) -> Option<f64> {
        let Temporal::Harmonics(plan) = &self.time else { return None };
        plan.frequency.map(|f| f.0).or_else(|| Some(std::f64::consts::TAU / plan.period?.0))
    }

    /// Time of the solver at which a march ends; `period` is that of the motion, in the same units. `None` when it counts periods
    /// of a motion that has none, and where nothing marches.
    pub fn end(&self, period: Option<f64>) -> Option<f64> {
        let (until, periods) = match &self.time {
            Temporal::Steady(_) | Temporal::Harmonics(_) | Temporal::Modes(_) => return None,
            Temporal::Newmark(plan) => (Some(plan.until), None),
            Temporal::Explicit(plan) => (plan.until, plan.periods),
            Temporal::Dual(plan) => (plan.until, plan.periods),
        };
        until.map(|t| self.flow.units().solver_time(t.0)).or_else(|| Some(periods? * period?))
    }

    /// Implicit step in the time of the solver, the first one when steps are adaptive; `period` as for [`Self::end`].
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
