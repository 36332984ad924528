//! Problems of structures that move in a stream: the steady flow that small motions are about, the march of a periodic one, and the motions
//! of `[gaf]`.
use super::given::Given;
use super::stream::{StreamRatio, enter};
use crate::case::{
    AnyMode, BodyMotionSpec, Case, Dual, Gaf, HarmonicCount, Harmonics, Motion, ParticleMotion, Steady, SteadyMethod,
    Structure, Temporal, Time,
};

/// Orders by which the residual of a flow falls that small motions are about; the remaining residual acts as a spurious force.
const ORDERS: f64 = 9.0;

/// The march of a periodic motion of structures in a stream at one Mach number. Dimensions stay those of the case: the structure is softer in
/// place of a faster stream. Structures that are not trimmed are held as drawn against the forces of the steady flow.
pub(crate) struct March<'a> {
    /// Mach number.
    pub(crate) mach: f64,
    /// Stream over that of the case.
    pub(crate) stream: StreamRatio,
    /// Value and rate of every coordinate where it begins.
    pub(crate) start: &'a [[f64; 2]],
    /// Generalised forces of the steady flow on all coordinates, in units of the solver.
    pub(crate) borne: &'a [f64],
    /// Period of the motion, in the time of the case.
    pub(crate) period: f64,
    /// Greatest number of periods.
    pub(crate) most: f64,
}

impl March<'_> {
    /// Forces that hold structures against those of the steady flow, in the units of the case.
    pub(super) fn held(&self, case: &Case) -> Vec<f64> {
        let pressure = case.flow.units().pressure();
        self.borne.iter().map(|f| -f * pressure).collect()
    }
}

/// Turns a case into the steady one on the same cloud, converged tightly enough for small motions about it; `particles` follow the bodies.
fn settle(case: &mut Case, particles: ParticleMotion) {
    let steady = if let Temporal::Steady(steady) = &case.time { steady.clone() } else { Steady::default() };
    case.time = Temporal::Steady(Steady { orders: ORDERS, ..steady });
    case.motion = Some(Motion { particles, law: case.motion.take().map_or_else(Default::default, |m| m.law) });
    case.output.report = false;
}

/// The steady flow at one Mach number about which forces are sought; bodies stay where they begin unless they are trimmed.
pub(super) fn settle_at(Given { case, modes }: &mut Given, mach: f64) {
    // a rigid cloud around one rigid body turns with it; one that deforms serves any number of modes
    settle(case, ParticleMotion::Deforming);
    case.title = format!("{} at Mach {mach}", case.title);
    case.flow.mach = Some(mach);
    for structure in &mut case.structures {
        structure.initial.clear();
        structure.modes.iter_mut().for_each(|m| (m.initial, m.initial_rate) = (0.0, 0.0));
    }
    *modes = modes.at_rest();
}

/// The steady flow about which the forces in all modes of `gaf` are linearised. All bodies belong to one structure at rest, whose masses and
/// springs do not affect the forces. If all modes are rigid-body modes, the cloud moves rigidly.
pub(super) fn settle_for(case: &mut Case, gaf: &Gaf) {
    settle(case, gaf.particles_of(gaf.all_modes()));
    if let Some(motion) = &mut case.motion {
        motion.law = BodyMotionSpec::default();
    }
    case.reference.moment_point = gaf.pivot.clone().or(case.reference.moment_point.take());
    case.structures = vec![gaf.structure()];
}

/// The harmonic balance of one mode at the reduced frequency `k`, with `factor` times the amplitude of `gaf`. The case keeps the table,
/// because generalised forces are evaluated for its modes.
pub(super) fn swing(case: &mut Case, gaf: &Gaf, mode: AnyMode<'_>, k: f64, factor: f64) {
    let harmonics = gaf.harmonics.unwrap_or(1);
    case.title = format!("{}: {} at k = {k}", case.title, mode.name());
    let particles = gaf.particles_of(std::iter::once(mode));
    case.motion = Some(Motion { particles, law: gaf.motion_of(mode, k, factor) });
    case.reference.moment_point = gaf.pivot.clone().or(case.reference.moment_point.take());
    case.time = Temporal::Harmonics(Harmonics {
        number: HarmonicCount::Fixed(harmonics),
        oversample: 1.0,
        tail: 0.01,
        most: harmonics,
        orders: 5.0,
        tolerance: 1e-4,
        iterations: 500,
        march: 0,
        check: 0,
        method: SteadyMethod::NewtonKrylov,
        cfl: 10.0,
        cfl_max: 1e6,
        frequency: None,
        period: None,
    });
    case.output.report = false;
}

/// The march of a periodic motion; forces that hold the structures are added to its problem.
pub(super) fn march(given: &mut Given, march: &March<'_>) {
    /// Steps of a period.
    const STEPS: f64 = 64.0;
    let (period, motion) = (march.period, given.case.motion.clone());
    settle_at(given, march.mach);
    let Given { case, modes } = given;
    case.title = format!("{}, limit cycle", case.title);
    let dual = Dual { swing: Some(Time(period)), ..Dual::fixed(Time(period / STEPS), Time(march.most * period)) };
    (case.time, case.accuracy) = (Temporal::Dual(dual), None);
    // a rigid cloud turns with a rigid body, as in any march
    case.motion = motion;
    *modes = modes.in_stream(march.stream).weightless();
    let (trimmed, dimension) = (case.is_trimmed(), usize::from(case.dimension.unwrap_or(2)));
    let mut rest = march.start;
    for body in 0..case.bodies.len() {
        let Some(k) = case.structure_of(body).and_then(|s| case.structures.iter().position(|o| o == s)) else {
            continue;
        };
        let structure = &mut case.structures[k];
        soften(structure, march.stream, trimmed);
        let begun = begin(structure, dimension, rest).max(modes.begin(body, rest));
        rest = &rest[begun.min(rest.len())..];
    }
}

/// Turns a structure into that in another stream, told in the units of the case; nothing else pulls but, where it is `trimmed`, gravity.
fn soften(structure: &mut Structure, ratio: StreamRatio, trimmed: bool) {
    enter(structure, ratio, false);
    structure.modes.iter_mut().for_each(|m| m.force = None);
    structure.force = None;
    structure.gravity = structure.gravity.take().filter(|_| trimmed);
}

/// Lets a structure begin with these values and rates; returns the number of its coordinates.
fn begin(structure: &mut Structure, dimension: usize, start: &[[f64; 2]]) -> usize {
    let free = structure.freedoms(dimension);
    for (freedom, [value, rate]) in free.iter().zip(start) {
        structure.initial.insert(freedom.name().to_owned(), *value);
        structure.initial.insert(format!("{}_rate", freedom.name()), *rate);
    }
    structure.modes.iter_mut().zip(start).for_each(|(m, [value, rate])| (m.initial, m.initial_rate) = (*value, *rate));
    free.len().max(structure.modes.len())
}
