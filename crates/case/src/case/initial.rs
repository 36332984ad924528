//! The field at the start: its keys, the data, and the check of what a case says of it.
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::draft::Draft;
use super::facts::{formula_in, is, is_dimensional};
use super::flow::Units;
use super::formula::Formula;
use super::kinds::PLANE_POINT;
use super::schema::{Absent, Field, Kind, List, Range, Table, Variant};

const ANY: Kind = Kind::Number(Range::ANY);
const STATE: Kind = Kind::List(&List { item: ANY, min: 3, max: 3, single: false });

pub(super) const INITIAL: &[Variant] = &[
    Variant::word("free_stream", "free stream everywhere"),
    Variant::table("riemann", &RIEMANN, "two states on either side of a plane"),
    Variant::table(
        "vortex",
        &VORTEX,
        "isentropic vortex (Shu 1998), density and pressure 1 far away; in 3-D a column along z",
    ),
    Variant::word("ringleb", "Ringleb's flow, stagnation density and sound speed 1, 2-D"),
    Variant::table(
        "formula",
        &FORMULA_FIELD,
        "formulas of the position: a velocity profile of a channel, a pulse of pressure",
    ),
];

static FORMULA_FIELD: Table = Table::of(&[
    Field::required(
        "velocity",
        Kind::List(&List { item: Kind::Formula, min: 2, max: 3, single: false }),
        "Velocity, a number or a formula in `x`, `y`, `z` for each axis, `[\"6 * y * (1 - y)\", 0]`: m/s with a dimensional free stream, else over its sound speed.",
    ),
    Field::optional(
        "density",
        Kind::Formula,
        "that of the free stream",
        "Density, a number or a formula: kg/m3 with a dimensional free stream, else over that of the free stream.",
    ),
    Field::optional(
        "pressure",
        Kind::Formula,
        "that of the free stream",
        "Pressure, a number or a formula: Pa with a dimensional free stream, else over ρ∞ a∞², so that the free stream has 1/γ.",
    ),
]);

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
    /// Formulas of the position.
    Formula {
        /// Velocity along each axis.
        velocity: Vec<String>,
        /// Density; absent: that of the free stream.
        density: Option<String>,
        /// Pressure; absent: that of the free stream.
        pressure: Option<String>,
    },
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

/// Ringleb's flow lives in the plane, gases have density and pressure.
pub(super) fn check(draft: &mut Draft<'_>, d: usize) {
    let kind =
        draft.get("initial").and_then(|v| v.as_str().or_else(|| v.as_object()?.keys().next().map(String::as_str)));
    if d == 3 && kind == Some("ringleb") {
        let hint = "use a 2-D domain: two numbers in `min` and `max`";
        draft.fail("initial", "`ringleb` is a 2-D flow, but the case is 3-D").hint(hint);
    }
    let own =
        ["initial.vortex", "initial.ringleb"].iter().any(|k| draft.get(k).is_some()) || is(draft, "initial", "ringleb");
    if own && is_dimensional(draft) {
        let message = "this initial field is nondimensional (density and pressure, or sound speed, are 1), but the free stream is dimensional";
        draft.fail("initial", message).hint("give `[flow]` by `mach` alone");
    }
    formulas(draft, d);
    if let Some(axis) = draft.number("initial.riemann.axis").filter(|&a| a >= d as f64) {
        let message = format!("`initial.riemann.axis` is {axis} in a {d}-D case");
        draft.fail("initial.riemann.axis", message).allowed(format!("from 0 to {}", d - 1));
    }
    for side in ["initial.riemann.left", "initial.riemann.right"] {
        let Some(state) = draft.numbers(side) else { continue };
        for (i, name) in [(0, "density"), (2, "pressure")] {
            if state.get(i).is_some_and(|x| *x <= 0.0) {
                draft.fail(side, format!("the {name} in `{side}` is {}", state[i])).allowed("greater than 0");
            }
        }
    }
}

/// The formulas of a field at the start depend on the position alone.
fn formulas(draft: &mut Draft<'_>, d: usize) {
    let n = draft.count("initial.formula.velocity");
    if n != 0 && n != d {
        let message = format!("`initial.formula.velocity` has {n} components in a {d}-D case");
        draft.fail("initial.formula.velocity", message).allowed(format!("{d} formulas"));
    }
    let velocity = (0..n).map(|k| format!("initial.formula.velocity[{k}]"));
    for path in velocity.chain(["density", "pressure"].map(|k| format!("initial.formula.{k}"))) {
        let Some(text) = draft.get(&path).and_then(Value::as_str).map(str::to_owned) else { continue };
        formula_in(d, draft, &path, &text, false);
        match Formula::parse_in(&text, d) {
            Ok(formula) if formula.contains(&Formula::Time) => {
                draft
                    .fail(&path, format!("`{path}` uses `t`, but it is a field at the start"))
                    .hint("use `x`, `y` and `z` alone");
            }
            Ok(formula) if !(0..d).any(|k| formula.contains(&Formula::Coordinate(k))) && !path.contains("velocity") => {
                let value = formula.value(0.0, 0.0);
                if value <= 0.0 {
                    draft.fail(&path, format!("`{path}` is {value}")).allowed("greater than 0");
                }
            }
            _ => {}
        }
    }
}
