//! What cases may ask and no solver computes yet.
use super::error::RunError;
use super::solids::with_gas;
use crate::case::{Case, ParticleMotion, RungeKutta, Temporal};

/// Exactly conservative coefficients unless the case says otherwise: they cost a few per cent of a run.
const CONSERVATIVE: bool = true;

/// Refuses what a case file can say but the solver cannot compute yet; each line goes when its solver comes.
pub(crate) fn supported(case: &Case) -> Result<(), RunError> {
    with_gas(case)?;
    let travels = case.moves() && case.particles() == ParticleMotion::Lagrangian;
    let layered = travels && case.cloud.wall_layers.is_some();
    let bare = case.moves() && case.bodies.is_empty() && case.particles() == ParticleMotion::Deforming;
    let balanced = travels && case.scheme.conservative == Some(true);
    let slow = case.scheme.low_mach && !conserves(case);
    let sprung = !case.structures.is_empty();
    let explicit = sprung && matches!(case.time, Temporal::Explicit(_));
    let soft = case.has_gas() && case.solids().next().is_some();
    let carried = (sprung || soft) && case.particles() == ParticleMotion::Lagrangian;
    let march = if let Temporal::Explicit(plan) = &case.time { Some(plan) } else { None };
    let fourth = soft && march.is_some_and(|plan| plan.method == RungeKutta::Rk4);
    let unfaced = soft && march.is_some() && !conserves(case);
    let asks = [
        (
            explicit,
            "bodies on springs with explicit steps (`[structure]` needs `[time.steady]`, `[time.dual]` or `harmonics`)",
        ),
        (fourth, "bodies made of particles with `method = \"rk4\"` (leave it out)"),
        (
            unfaced,
            "bodies made of particles with explicit steps and without conservative coefficients (take `[time.dual]`, or leave out \
             `conservative` and `wall_layers`)",
        ),
        (
            carried,
            "bodies on springs, or made of particles, among particles that travel with the fluid (`particles = \"lagrangian\"`)",
        ),
        (layered, "wall layers of particles that travel with the fluid (`wall_layers`, `particles = \"lagrangian\"`)"),
        (bare, "a deforming cloud without bodies (`particles = \"deforming\"`)"),
        (slow, "slow flow without conservative coefficients (`low_mach = true` needs `conservative = true`)"),
        (balanced, "conservative coefficients of particles that travel with the fluid (`conservative = true`)"),
    ];
    let missing: Vec<&str> = asks.iter().filter(|a| a.0).map(|a| a.1).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let what = format!("this version cannot compute {}", missing.join(", "));
    Err(RunError::Unsupported {
        what,
        hint: "`alula cloud` builds the cloud of such a case, but no flow is computed on it",
    })
}

/// Exactly conservative coefficients? Not where particles travel with the fluid and their lists are made anew again and again; and
/// not where wall layers move: weights that are exact for linear fields serve as well or better there.
pub(super) fn conserves(case: &Case) -> bool {
    let travels = case.moves() && case.particles() == ParticleMotion::Lagrangian;
    let layered = case.moves() && case.cloud.wall_layers.is_some();
    case.scheme.conservative.unwrap_or(CONSERVATIVE && !travels && !layered)
}
