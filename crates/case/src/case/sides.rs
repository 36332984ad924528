//! The sides of the domain, as data.
use serde::{Deserialize, Serialize};

use super::kinds::POSITIVE;
use super::schema::{Absent, Field, Kind, Table, Variant, defaulted, keys};

/// Sides of the domain, two for each axis.
pub(super) const SIDES: [(&str, &str); 3] = [("x_min", "x_max"), ("y_min", "y_max"), ("z_min", "z_max")];

const SIDE: &[Variant] = &[
    Variant::word("far_field", "free stream, with the vortex of the lift in 2-D; waves leave"),
    Variant::word(
        "held",
        "the state of `[initial]` held for all times (supersonic inflow, inlets of channels, exact solutions); waves leave",
    ),
    Variant::table("outflow", &OUTFLOW, "zero normal gradient; with a static pressure when the outflow is subsonic"),
    Variant::word("symmetry", "plane of symmetry"),
    Variant::word("periodic", "periodic with the opposite side"),
];

static OUTFLOW: Table =
    Table::of(&[Field::optional("pressure", POSITIVE, "extrapolated", "Static pressure over free-stream pressure.")]);

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
