//! Problems of structures that move in a stream: the steady flow that small motions are about, and the march of a periodic one.
use super::stream::{StreamRatio, enter};
use crate::case::{Case, Dual, ParticleMotion, Structure, Temporal, Time};

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

/// The steady flow at one Mach number about which forces are sought; bodies stay where they begin unless they are trimmed.
pub(super) fn about_steady_flow(case: &Case, mach: f64) -> Case {
    // a rigid cloud around one rigid body turns with it; one that deforms serves any number of modes
    let mut own = case.settled_case(ParticleMotion::Deforming);
    own.title = format!("{} at Mach {mach}", case.title);
    own.flow.mach = Some(mach);
    for structure in &mut own.structures {
        structure.initial.clear();
        structure.modes.iter_mut().for_each(|m| (m.initial, m.initial_rate) = (0.0, 0.0));
    }
    own
}

/// The march of a periodic motion; forces that hold the structures are added to its problem.
pub(super) fn march(case: &Case, march: &March<'_>) -> Case {
    /// Steps of a period.
    const STEPS: f64 = 64.0;
    let period = march.period;
    let mut own = about_steady_flow(case, march.mach);
    own.title = format!("{}, limit cycle", own.title);
    let dual = Dual { swing: Some(Time(period)), ..Dual::fixed(Time(period / STEPS), Time(march.most * period)) };
    (own.time, own.accuracy) = (Temporal::Dual(dual), None);
    // a rigid cloud turns with a rigid body, as in any march
    own.motion.clone_from(&case.motion);
    let (trimmed, dimension) = (case.is_trimmed(), usize::from(own.dimension.unwrap_or(2)));
    let mut rest = march.start;
    for body in 0..own.bodies.len() {
        let Some(k) = own.structure_of(body).and_then(|s| own.structures.iter().position(|o| o == s)) else {
            continue;
        };
        let structure = &mut own.structures[k];
        soften(structure, march.stream, trimmed);
        let begun = begin(structure, dimension, rest);
        rest = &rest[begun.min(rest.len())..];
    }
    own
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
