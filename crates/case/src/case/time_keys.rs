//! The keys of `[time]`.
use super::kinds::{COUNT, POSITIVE};
use super::quantity::{Frequency, Time};
use super::schema::{Absent, Field, Kind, Range, Table, Variant};

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

static NEWMARK: Table = Table::of(&[
    Field::required("step", Kind::Quantity(Time::DIMENSION, Range::POSITIVE), "Step in time."),
    Field::required("until", Kind::Quantity(Time::DIMENSION, Range::POSITIVE), "Time at which the run ends."),
    Field::defaulted(
        "rho_infinity",
        Kind::Number(Range::between(0.0, 1.0)),
        Absent::Number(0.9),
        "What a step leaves of vibrations too fast for it: 1 is the trapezoidal rule, 0 takes them away at once.",
    ),
    Field::defaulted(
        "tolerance",
        Kind::Number(Range { min: 0.0, max: 0.1, closed: false }),
        Absent::Number(1e-8),
        "Residual over the size of the forces at which a step ends.",
    ),
    Field::defaulted("iterations", COUNT, Absent::Integer(20), "Greatest number of Newton iterations of a step."),
]);

static MODES: Table = Table::of(&[
    Field::defaulted("number", Kind::Integer(1, 1000), Absent::Integer(6), "Number of modes."),
    Field::optional(
        "shift",
        Kind::Quantity(Frequency::DIMENSION, Range::POSITIVE),
        "the lowest ones",
        "The modes are the nearest above this frequency.",
    ),
    Field::defaulted(
        "preload",
        Kind::Flag,
        Absent::Flag(false),
        "Vibrations are about the static equilibrium under the loads, else about the body without stress.",
    ),
]);

static HARMONICS: Table = Table::of(&[
        Field::required(
            "number",
            Kind::IntegerOr(1, 16, "auto"),
            "Number of harmonics N: the solution is held at 2N + 1 instances of the period. With `\"auto\"` there are as many \
             as `tail` asks for.",
        ),
        Field::defaulted(
            "oversample",
            Kind::Number(Range::between(1.0, 2.0)),
            Absent::Number(1.0),
            "The equations are evaluated with so many times the harmonics and filtered: 1.5 or 2 where shocks move.",
        ),
        Field::defaulted(
            "tail",
            Kind::Number(Range { min: 0.0, max: 1.0, closed: false }),
            Absent::Number(0.01),
            "Part that the last harmonic may have of all harmonics, in the loads and in the density: above it a run warns, \
             and `number = \"auto\"` adds two more.",
        ),
        Field::defaulted(
            "most",
            Kind::Integer(1, 16),
            Absent::Integer(9),
            "Greatest number of harmonics of `number = \"auto\"`.",
        ),
        Field::defaulted("orders", ORDERS, Absent::Number(5.0), "Orders of magnitude the residual must fall."),
        Field::defaulted(
            "tolerance",
            Kind::Number(Range { min: 0.0, max: 0.1, closed: false }),
            Absent::Number(1e-4),
            "Mean and harmonics of lift and moment must change by less than this part of the first harmonic: in the last \
             iteration, or over five iterations when the residual has fallen by two orders only. Structures alone: \
             part of the displacements that what is left may change.",
        ),
        Field::defaulted(
            "iterations",
            COUNT,
            Absent::Integer(500),
            "Greatest number of iterations for each number of harmonics.",
        ),
        Field::defaulted(
            "march",
            Kind::Integer(0, 1000),
            Absent::Integer(0),
            "Periods that are marched before in coarse implicit steps, about 36 a period; the balance begins from the last of them. \
             For flow that separates or moves far from the steady one.",
        ),
        Field::defaulted(
            "check",
            Kind::Integer(0, 1000),
            Absent::Integer(0),
            "Periods that are marched afterwards, in implicit steps of 1/128 period from the balance; the run tells by how much the \
             loads of the last of them differ.",
        ),
        METHOD,
        CFL,
        CFL_MAX,
        Field::optional(
            "frequency",
            Kind::Quantity(Frequency::DIMENSION, Range::POSITIVE),
            "that of the motion; structures alone need this or `period`",
            "Frequency of structures alone, `omega` in the histories of their loads.",
        ),
        Field::optional(
            "period",
            Kind::Quantity(Time::DIMENSION, Range::POSITIVE),
            "that of the motion; structures alone need this or `frequency`",
            "Period of structures alone instead.",
        ),
    ]).short("number");

const METHOD: Field =
    Field::defaulted("method", Kind::Words(RELAXATIONS), Absent::Word("newton_krylov"), "Method of the relaxation.");
const CFL: Field = Field::defaulted("cfl", POSITIVE, Absent::Number(10.0), "Courant number at the start.");
const CFL_MAX: Field = Field::defaulted("cfl_max", POSITIVE, Absent::Number(1e6), "Greatest Courant number.");
const ORDERS: Kind = Kind::Number(Range { min: 0.0, max: 16.0, closed: false });

static STEADY: Table = Table::of(&[
    METHOD,
    Field::defaulted("orders", ORDERS, Absent::Number(6.0), "Orders of magnitude the residual must fall."),
    Field::defaulted("iterations", COUNT, Absent::Integer(2000), "Greatest number of iterations."),
    CFL,
    CFL_MAX,
    Field::optional("load_steps", COUNT, "1", "Structures alone: the loads grow in so many equal steps."),
]);

const RELAXATIONS: &[(&str, &str)] = &[
    ("newton_krylov", "Newton's method with GMRES, preconditioned by sweeps"),
    ("lu_sgs", "lower-upper symmetric Gauss-Seidel sweeps alone"),
    ("runge_kutta", "explicit Runge-Kutta with local steps: the plain reference"),
];

const UNTIL: Field = Field::optional(
    "until",
    Kind::Quantity(Time::DIMENSION, Range::POSITIVE),
    "`periods` must be given",
    "Time at which the run ends: seconds, or lengths over sound speed without a dimensional free stream.",
);
const PERIODS: Field = Field::optional(
    "periods",
    POSITIVE,
    "`until` must be given",
    "Number of periods of the motion after which the run ends.",
);
const PERIODIC_TOLERANCE: Field = Field::optional(
    "periodic_tolerance",
    Kind::Number(Range { min: 0.0, max: 1.0, closed: false }),
    "the run goes to its end",
    "The run ends earlier when mean and first harmonic of the loads change by less than this part of the first harmonic \
     from one period to the next.",
);

static EXPLICIT: Table = Table::of(&[
    UNTIL,
    PERIODS,
    Field::defaulted("cfl", POSITIVE, Absent::Number(0.8), "Courant number."),
    Field::defaulted("method", Kind::Words(MARCHES), Absent::Word("ssprk3"), "Runge-Kutta method."),
    Field::defaulted("steps", COUNT, Absent::Integer(1_000_000), "Greatest number of steps."),
    PERIODIC_TOLERANCE,
]);

const MARCHES: &[(&str, &str)] = &[
    ("ssprk3", "strong-stability-preserving, three stages, third order (Shu and Osher 1988)"),
    ("rk4", "classical, four stages, fourth order"),
];

static DUAL: Table = Table::of(&[
    Field::optional(
        "steps_per_period",
        // fewer steps do not resolve a sine
        Kind::Integer(4, 1_000_000),
        "`step` must be given",
        "Number of steps in a period of the motion.",
    ),
    Field::optional(
        "step",
        Kind::Quantity(Time::DIMENSION, Range::POSITIVE),
        "`steps_per_period` must be given",
        "Step in time, in the units of `until`.",
    ),
    PERIODS,
    UNTIL,
    Field::defaulted(
        "order",
        Kind::Integer(1, 2),
        Absent::Integer(2),
        "Order of the backward difference in time; the first step is of first order.",
    ),
    Field::defaulted(
        "orders",
        ORDERS,
        Absent::Number(2.0),
        "Orders of magnitude the residual must fall within a step: below the size of the change in time, or one order less \
         below that of a state guessed through the last three. What is left disturbs the damping of bodies on springs.",
    ),
    Field::defaulted("inner_iterations", COUNT, Absent::Integer(50), "Greatest number of iterations within a step."),
    Field::optional(
        "start_orders",
        ORDERS,
        "3, and 13 with bodies on springs",
        "Orders of magnitude the residual of the steady flow that the march begins with must fall: what is left moves bodies on springs.",
    ),
    Field::optional(
        "adaptive",
        Kind::Number(Range { min: 0.0, max: 0.1, closed: false }),
        "fixed steps",
        "Relative error of a step to which the size of the steps is fitted.",
    ),
    PERIODIC_TOLERANCE,
    METHOD,
    Field::defaulted(
        "cfl",
        POSITIVE,
        Absent::Number(10.0),
        "Courant number at the start of the relaxation before the march; each step in time begins at ten times as much.",
    ),
    CFL_MAX,
]);
