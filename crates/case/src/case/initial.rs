//! The field at the start: data, and the check of what a case says of it.
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::Units;
use super::draft::Draft;
use super::facts::{formula_in, is, is_dimensional};
use super::formula::Formula;

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
            Ok(Formula::Number(value)) if value <= 0.0 && !path.contains("velocity") => {
                draft.fail(&path, format!("`{path}` is {value}")).allowed("greater than 0");
            }
            _ => {}
        }
    }
}
