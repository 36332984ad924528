//! How large a cloud may be on this machine.
use super::numerics::harmonics;
use crate::case::{Case, Cloud, ParticleMotion, Temporal};
use crate::cloud::CloudSpec;
use crate::observe::usage::available_bytes;

/// Part of the memory that a run surely takes of what is expected.
const SURELY: f64 = 0.8;

/// Bytes of each particle in the plane: steady, what steps in time add, a balance without and with each harmonic, explicit steps
/// of particles at rest and in motion.
const STEADY_BYTES: f64 = 1830.0;
const STEP_BYTES: f64 = 850.0;
const BALANCE_BYTES: [f64; 2] = [3100.0, 1750.0];
const EXPLICIT_BYTES: [f64; 2] = [1000.0, 1300.0];
/// Bytes of a particle in space over those in the plane.
const SPACE_BYTES: f64 = 1.3;

/// The cloud that a case describes, no larger than what memory holds.
pub(crate) fn spec<const D: usize>(case: &Case) -> CloudSpec<D> {
    spec_of(case, &case.cloud)
}

/// Another cloud for the same case, no larger than what memory holds.
pub(crate) fn spec_of<const D: usize>(case: &Case, cloud: &Cloud) -> CloudSpec<D> {
    let spec = CloudSpec::of(cloud, &case.boundary);
    let each = SURELY * bytes_each(case, D);
    let held = available_bytes().map_or(spec.most, |bytes| (bytes as f64 / each) as usize);
    CloudSpec { most: spec.most.min(held), ..spec }
}

/// Bytes that each particle of a run takes.
pub(crate) fn bytes_each(case: &Case, dimension: usize) -> f64 {
    let plane = match &case.time {
        Temporal::Steady(_) | Temporal::Newmark(_) | Temporal::Modes(_) => STEADY_BYTES,
        Temporal::Dual(_) => STEADY_BYTES + STEP_BYTES,
        Temporal::Harmonics(_) => BALANCE_BYTES[0] + BALANCE_BYTES[1] * f64::from(harmonics(case)),
        Temporal::Explicit(_) => EXPLICIT_BYTES[usize::from(case.moves() && case.particles() != ParticleMotion::Rigid)],
    };
    if dimension == 2 { plane } else { SPACE_BYTES * plane }
}
