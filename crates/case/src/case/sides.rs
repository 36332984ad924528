//! The sides of the domain and the field at the start, as data.
use serde::{Deserialize, Serialize};

use super::flow::Units;
use super::kinds::{PLANE_POINT, POSITIVE};
use super::schema::{Absent, Field, Kind, List, Range, Table, Variant, defaulted, keys};

const ANY: Kind = Kind::Number(Range::ANY);
const STATE: Kind = Kind::List(&List { item: ANY, min: 3, max: 3, single: false });

/// Sides of the domain, two for each axis.
pub(super) const SIDES: [(&str, &str); 3] = [("x_min", "x_max"), ("y_min", "y_max"), ("z_min", "z_max")];

const SIDE: &[Variant] = &[
    Variant::word("far_field", "free stream, with the vortex of the lift in 2-D; waves leave"),
    Variant::word("held", "the state of `[initial]` held for ever (supersonic inflow, exact solutions)"),
    Variant::table("outflow", &OUTFLOW, "zero normal gradient; with a static pressure when the outflow is subsonic"),
    Variant::word("symmetry", "plane of symmetry"),
    Variant::word("periodic", "periodic with the opposite side"),
];

static OUTFLOW: Table =
    Table::of(&[Field::optional("pressure", POSITIVE, "extrapolated", "Static pressure over free-stream pressure.")]);

pub(super) const INITIAL: &[Variant] = &[
    Variant::word("free_stream", "free stream everywhere"),
    Variant::table("riemann", &RIEMANN, "two states on either side of a plane"),
    Variant::table(
        "vortex",
        &VORTEX,
        "isentropic vortex (Shu 1998), density and pressure 1 far away; in 3-D a column along z",
    ),
    Variant::word("ringleb", "Ringleb's flow, stagnation density and sound speed 1, 2-D"),
];

static RIEMANN: Table = Table::of(&[
    Field::required(
        "left",
        STATE,
        "Left state: density, velocity along `axis`, pressure; SI units with a dimensional free stream.",
    ),
    Field::required("right", STATE, "Right state: density, velocity along `axis`, pressure, in the same units."),
    Field::defaulted("position", ANY, Absent::Number(0.0), "Position of the plane."),
    Field::defaulted("axis", Kind::Integer(0, 2), Absent::Integer(0), "Axis across the plane, 0 for x."),
]);

static VORTEX: Table = Table::of(&[
    Field::required("strength", ANY, "Strength β."),
    Field::required("centre", PLANE_POINT, "Centre at the start, in the plane of x and y."),
    Field::required("velocity", PLANE_POINT, "Mean velocity."),
]);

keys! {
    /// Boundary conditions on the sides of the domain.
    #[derive(Default)]
    pub struct Sides, BOUNDARY {
        /// Side of smallest x.
        x_min: Side = defaulted(Kind::Choice(SIDE), Absent::Word("far_field")),
        /// Side of largest x.
        x_max: Side = defaulted(Kind::Choice(SIDE), Absent::Word("far_field")),
        /// Side of smallest y.
        y_min: Side = defaulted(Kind::Choice(SIDE), Absent::Word("far_field")),
        /// Side of largest y.
        y_max: Side = defaulted(Kind::Choice(SIDE), Absent::Word("far_field")),
        /// Side of smallest z.
        z_min: Side = defaulted(Kind::Choice(SIDE), Absent::Word("far_field")),
        /// Side of largest z.
        z_max: Side = defaulted(Kind::Choice(SIDE), Absent::Word("far_field")),
    }
}

impl Sides {
    /// Conditions on the sides of smallest and largest coordinate along each axis.
    pub const fn pairs(&self) -> [[Side; 2]; 3] {
        [[self.x_min, self.x_max], [self.y_min, self.y_max], [self.z_min, self.z_max]]
    }
}

/// Boundary condition on a side of the domain. What the gas does at an open side stands in `scheme::sides`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Free stream, in 2-D with the far-field vortex of the lift; waves leave through the upwind flux.
    #[default]
    FarField,
    /// State of `[initial]`, prescribed for all times (supersonic inflow, exact solutions).
    Held,
    /// Zero normal gradient, with a prescribed static pressure when the outflow is subsonic.
    Outflow {
        /// Static pressure divided by that of the free stream; absent: extrapolated.
        pressure: Option<f64>,
    },
    /// Plane of symmetry.
    Symmetry,
    /// Periodicity with the opposite side.
    Periodic,
}

impl Side {
    /// True where images of the gas are beyond the side: at planes of symmetry and periodic sides.
    pub const fn has_images(self) -> bool {
        matches!(self, Self::Symmetry | Self::Periodic)
    }
}

/// Initial field.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Initial {
    /// Free stream everywhere.
    #[default]
    FreeStream,
    /// Two states (density, velocity along `axis`, pressure) on either side of a plane.
    Riemann {
        /// Left state (density, velocity, pressure).
        left: [f64; 3],
        /// Right state (density, velocity, pressure).
        right: [f64; 3],
        /// Position of the plane.
        position: f64,
        /// Axis normal to the plane, 0 for x.
        axis: u8,
    },
    /// Isentropic vortex (Shu 1998) of given strength, centre and mean velocity; density and pressure are 1 far away.
    Vortex {
        /// Strength β.
        strength: f64,
        /// Initial centre.
        centre: [f64; 2],
        /// Mean velocity.
        velocity: [f64; 2],
    },
    /// Ringleb's flow with stagnation density and stagnation sound speed 1.
    Ringleb,
}

impl Initial {
    /// The field in units of the solver. The vortex and Ringleb's flow are defined in the units of the solver already.
    pub fn in_solver_units(&self, units: &Units) -> Self {
        let state = |s: &[f64; 3]| [s[0] / units.density, units.solver_rate(s[1]), s[2] / units.pressure()];
        match self {
            Self::Riemann { left, right, position, axis } => {
                Self::Riemann { left: state(left), right: state(right), position: *position, axis: *axis }
            }
            other => other.clone(),
        }
    }
}
