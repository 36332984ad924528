//! Structures of particles of a case: filled, supported, loaded; and their own modes.
mod build;
mod cut;
mod filling;
mod material;
mod natural;
mod own_modes;
mod probes;
mod size;
mod spline_modes;

pub(crate) use build::{Built, Expected, Filling};
pub(in crate::problem) use natural::structure;
pub(crate) use natural::{NaturalMode, NaturalModes};
pub(crate) use own_modes::own_modes;

use super::error::RunError;
use crate::case::{Case, PlaneState, Temporal};

/// Refuses what can be said of structures but is not computed yet.
pub(crate) fn supported(case: &Case) -> Result<(), RunError> {
    let any = |f: fn(&crate::case::Solid) -> bool| case.solids().any(|(_, _, s)| f(s));
    let asks = [
        (
            any(|s| s.plane == PlaneState::Axisymmetric) && any(|s| s.plane != PlaneState::Axisymmetric),
            "bodies of which some only are axisymmetric (`plane = \"axisymmetric\"`)",
        ),
        (differ(case), "bodies with different `damping` or `stiffness_damping`"),
        (
            case.contact.is_some() && !matches!(case.time, Temporal::Explicit(_)),
            "contact in other than explicit marches (`[contact]` needs `[time.explicit]`)",
        ),
    ];
    match asks.iter().filter(|a| a.0).map(|a| a.1).collect::<Vec<_>>()[..] {
        [] => Ok(()),
        ref missing => Err(RunError::Unsupported {
            what: format!("{} cannot be computed yet", missing.join(" and ")),
            hint: "leave it out",
        }),
    }
}

/// True where one body is damped in another way than the others.
fn differ(case: &Case) -> bool {
    let mut all = case.solids().map(|(_, _, s)| (s.damping.0, s.stiffness_damping.0));
    let first = all.next();
    all.any(|d| Some(d) != first)
}

/// Refuses what is computed of a gas where there is none.
pub(crate) fn with_gas(case: &Case) -> Result<(), RunError> {
    supported(case)?;
    if case.has_gas() {
        return Ok(());
    }
    Err(RunError::Unsupported {
        what: "the case has no gas: a structure alone has no cloud, and no fields or loads of one".into(),
        hint: "`alula run` computes it",
    })
}
