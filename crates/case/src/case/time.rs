//! Time integration of a case, as data.
use serde::{Deserialize, Serialize};

use super::Case;
use super::kinds::{COUNT, POSITIVE};
use super::quantity::{Frequency, Time};
use super::schema::{Absent, Kind, Range, Variant, defaulted, keys, optional, required, words};

pub(super) const TIME: &[Variant] = &[
    Variant::table("steady", &STEADY, "relax to a steady state"),
    Variant::table("explicit", &EXPLICIT, "march in time with an explicit Runge-Kutta method"),
    Variant::table("dual", &DUAL, "march in time with implicit steps, each relaxed in a pseudo time"),
    Variant::table(
        "harmonics",
        &HARMONICS,
        "find the periodic solution at once by harmonic balance, without marching; `[time] harmonics = 2` is enough, and \
         tables of a march that stand beside it are left aside",
    )
    .ruling(),
    Variant::table("newmark", &NEWMARK, "march structures alone in time with implicit steps, by the generalised-alpha method"),
    Variant::table("modes", &MODES, "find free vibrations of structures alone"),
];

const ORDERS: Kind = Kind::Number(Range { min: 0.0, max: 16.0, closed: false });

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

keys! {
    /// Implicit time marching of a purely structural case by the generalised-α method.
    pub struct Newmark, NEWMARK {
        /// Step in time.
        step: Time = required(Kind::Quantity(Time::DIMENSION, Range::POSITIVE)),
        /// Time at which the run ends.
        until: Time = required(Kind::Quantity(Time::DIMENSION, Range::POSITIVE)),
        /// What a step leaves of vibrations too fast for it: 1 is the trapezoidal rule, 0 takes them away at once.
        rho_infinity: f64 = defaulted(Kind::Number(Range::between(0.0, 1.0)), Absent::Number(0.9)),
        /// Residual over the size of the forces at which a step ends.
        tolerance: f64 = defaulted(Kind::Number(Range { min: 0.0, max: 0.1, closed: false }), Absent::Number(1e-8)),
        /// Greatest number of Newton iterations of a step.
        iterations: u32 = defaulted(COUNT, Absent::Integer(20)),
    }

    /// Natural modes of a purely structural case.
    pub struct Modes, MODES {
        /// Number of modes.
        number: u32 = defaulted(Kind::Integer(1, 1000), Absent::Integer(6)),
        /// The modes are the nearest above this frequency.
        shift: Option<Frequency> = optional(Kind::Quantity(Frequency::DIMENSION, Range::POSITIVE), "the lowest ones"),
        /// Vibrations are about the static equilibrium under the loads, else about the body without stress.
        preload: bool = defaulted(Kind::Flag, Absent::Flag(false)),
    }

    /// Settings of the harmonic balance.
    pub struct Harmonics, HARMONICS.short("number") {
        /// Number of harmonics N: the solution is held at 2N + 1 instances of the period. With `"auto"` there are as
        /// many as `tail` asks for.
        number: HarmonicCount = required(Kind::IntegerOr(1, 16, "auto")),
        /// The equations are evaluated with so many times the harmonics and filtered: 1.5 or 2 where shocks move.
        oversample: f64 = defaulted(Kind::Number(Range::between(1.0, 2.0)), Absent::Number(1.0)),
        /// Part that the last harmonic may have of all harmonics, in the loads and in the density: above it a run
        /// warns, and `number = "auto"` adds two more.
        tail: f64 = defaulted(Kind::Number(Range { min: 0.0, max: 1.0, closed: false }), Absent::Number(0.01)),
        /// Greatest number of harmonics of `number = "auto"`.
        most: u32 = defaulted(Kind::Integer(1, 16), Absent::Integer(9)),
        /// Orders of magnitude the residual must fall.
        orders: f64 = defaulted(ORDERS, Absent::Number(5.0)),
        /// Mean and harmonics of lift and moment must change by less than this part of the first harmonic: in the last
        /// iteration, or over five iterations when the residual has fallen by two orders only. Structures alone: part
        /// of the displacements that what is left may change.
        tolerance: f64 = defaulted(Kind::Number(Range { min: 0.0, max: 0.1, closed: false }), Absent::Number(1e-4)),
        /// Greatest number of iterations for each number of harmonics.
        iterations: u32 = defaulted(COUNT, Absent::Integer(500)),
        /// Periods that are marched before in coarse implicit steps, about 36 a period; the balance begins from the
        /// last of them. For flow that separates or moves far from the steady one.
        #[serde(default)]
        march: u32 = defaulted(Kind::Integer(0, 1000), Absent::Integer(0)),
        /// Periods that are marched afterwards, in implicit steps of 1/128 period from the balance; the run tells by
        /// how much the loads of the last of them differ.
        #[serde(default)]
        check: u32 = defaulted(Kind::Integer(0, 1000), Absent::Integer(0)),
        /// Method of the relaxation.
        method: SteadyMethod = defaulted(Kind::Words(RELAXATIONS), Absent::Word("newton_krylov")),
        /// Courant number at the start.
        cfl: f64 = defaulted(POSITIVE, Absent::Number(10.0)),
        /// Greatest Courant number.
        cfl_max: f64 = defaulted(POSITIVE, Absent::Number(1e6)),
        /// Frequency of structures alone, `omega` in the histories of their loads.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        frequency: Option<Frequency> = optional(
            Kind::Quantity(Frequency::DIMENSION, Range::POSITIVE),
            "that of the motion; structures alone need this or `period`",
        ),
        /// Period of structures alone instead.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        period: Option<Time> = optional(
            Kind::Quantity(Time::DIMENSION, Range::POSITIVE),
            "that of the motion; structures alone need this or `frequency`",
        ),
    }
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

keys! {
    /// Settings of the steady relaxation.
    pub struct Steady, STEADY {
        /// Method of the relaxation.
        method: SteadyMethod = defaulted(Kind::Words(RELAXATIONS), Absent::Word("newton_krylov")),
        /// Orders of magnitude the residual must fall.
        orders: f64 = defaulted(ORDERS, Absent::Number(6.0)),
        /// Greatest number of iterations.
        iterations: u32 = defaulted(COUNT, Absent::Integer(2000)),
        /// Courant number at the start.
        cfl: f64 = defaulted(POSITIVE, Absent::Number(10.0)),
        /// Greatest Courant number.
        cfl_max: f64 = defaulted(POSITIVE, Absent::Number(1e6)),
        /// Structures alone: the loads grow in so many equal steps.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        load_steps: Option<u32> = optional(COUNT, "1"),
    }
}

words! {
    /// Iterative method of the steady relaxation.
    pub enum SteadyMethod, RELAXATIONS {
        /// Newton's method with GMRES, preconditioned by sweeps
        NewtonKrylov = "newton_krylov",
        /// lower-upper symmetric Gauss-Seidel sweeps alone
        LuSgs = "lu_sgs",
        /// explicit Runge-Kutta with local steps: the plain reference
        RungeKutta = "runge_kutta",
    }
}

keys! {
    /// Settings of explicit time marching; [`read()`](super::read()) ensures that one of `until` and `periods` is given.
    pub struct Explicit, EXPLICIT {
        /// Time at which the run ends: seconds, or lengths over sound speed without a dimensional free stream.
        until: Option<Time> = optional(Kind::Quantity(Time::DIMENSION, Range::POSITIVE), "`periods` must be given"),
        /// Number of periods of the motion after which the run ends.
        periods: Option<f64> = optional(POSITIVE, "`until` must be given"),
        /// Courant number.
        cfl: f64 = defaulted(POSITIVE, Absent::Number(0.8)),
        /// Runge-Kutta method.
        method: RungeKutta = defaulted(Kind::Words(MARCHES), Absent::Word("ssprk3")),
        /// Greatest number of steps.
        steps: u32 = defaulted(COUNT, Absent::Integer(1_000_000)),
        /// The run ends earlier when mean and first harmonic of the loads change by less than this part of the first
        /// harmonic from one period to the next.
        periodic_tolerance: Option<f64> = optional(
            Kind::Number(Range { min: 0.0, max: 1.0, closed: false }), "the run goes to its end",
        ),
    }
}

words! {
    /// Explicit Runge-Kutta method.
    pub enum RungeKutta, MARCHES {
        /// strong-stability-preserving, three stages, third order (Shu and Osher 1988)
        Ssprk3 = "ssprk3",
        /// classical, four stages, fourth order
        Rk4 = "rk4",
    }
}

keys! {
    /// Settings of implicit time marching. One of `step` and `steps_per_period` is given, and one of `until` and `periods`.
    pub struct Dual, DUAL {
        /// Number of steps in a period of the motion.
        steps_per_period: Option<u32> = optional(Kind::Integer(4, 1_000_000), "`step` must be given"),
        /// Step in time, in the units of `until`.
        step: Option<Time> = optional(
            Kind::Quantity(Time::DIMENSION, Range::POSITIVE), "`steps_per_period` must be given",
        ),
        /// Number of periods of the motion after which the run ends.
        periods: Option<f64> = optional(POSITIVE, "`until` must be given"),
        /// Time at which the run ends: seconds, or lengths over sound speed without a dimensional free stream.
        until: Option<Time> = optional(Kind::Quantity(Time::DIMENSION, Range::POSITIVE), "`periods` must be given"),
        /// Order of the backward difference in time; the first step is of first order.
        order: u8 = defaulted(Kind::Integer(1, 2), Absent::Integer(2)),
        /// Orders of magnitude the residual must fall within a step: below the size of the change in time, or one order
        /// less below that of a state guessed through the last three. What is left disturbs the damping of bodies on
        /// springs.
        orders: f64 = defaulted(ORDERS, Absent::Number(2.0)),
        /// Greatest number of iterations within a step.
        inner_iterations: u32 = defaulted(COUNT, Absent::Integer(50)),
        /// Orders of magnitude the residual of the steady flow that the march begins with must fall: what is left moves
        /// bodies on springs.
        #[serde(default)]
        start_orders: Option<f64> = optional(ORDERS, "3, and 13 with bodies on springs"),
        /// Relative error of a step to which the size of the steps is fitted.
        adaptive: Option<f64> = optional(Kind::Number(Range { min: 0.0, max: 0.1, closed: false }), "fixed steps"),
        /// The run ends earlier when mean and first harmonic of the loads change by less than this part of the first
        /// harmonic from one period to the next.
        periodic_tolerance: Option<f64> = optional(
            Kind::Number(Range { min: 0.0, max: 1.0, closed: false }), "the run goes to its end",
        ),
        /// Method of the relaxation.
        method: SteadyMethod = defaulted(Kind::Words(RELAXATIONS), Absent::Word("newton_krylov")),
        /// Courant number at the start of the relaxation before the march; each step in time begins at ten times as
        /// much.
        cfl: f64 = defaulted(POSITIVE, Absent::Number(10.0)),
        /// Greatest Courant number.
        cfl_max: f64 = defaulted(POSITIVE, Absent::Number(1e6)),
    } and {
        /// Estimated period of a free vibration of structures; the run ends with the second of two equal periods. There
        /// is no key for it.
        #[serde(skip)]
        swing: Option<Time>,
    }
}

impl Dual {
    /// A march with constant time steps; all other settings have their defaults.
    pub fn fixed(step: Time, until: Time) -> Self {
        Self { step: Some(step), until: Some(until), ..DUAL.value() }
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
        STEADY.value()
    }
}
