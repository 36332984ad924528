//! Flutter boundaries: at which Mach numbers, with what accuracy, as data.
pub(super) mod check;
pub(super) mod keys;
mod limit_cycles;
mod stream;

use serde::{Deserialize, Serialize};

pub use limit_cycles::{GasResponse, LimitCycles};
pub use stream::StreamRatio;

use super::quantity::Velocity;
use super::structure::StructureForce;
use super::{Case, Dual, Motion, ParticleMotion, Steady, Structure, Temporal, Time};

/// The table `[flutter]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flutter {
    /// Mach numbers; empty: that of `[flow]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mach: Vec<f64>,
    /// Reduced frequencies that forces are computed at first; empty: those of [`Self::first`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reduced_frequencies: Vec<f64>,
    /// What is varied.
    #[serde(rename = "match")]
    pub matching: Matching,
    /// Greatest speed looked at, over that of the structure; in a tunnel density over that of the case.
    pub most: f64,
    /// Part by which two successive interpolations may differ in a speed.
    pub accuracy: f64,
    /// Greatest number of frequencies.
    pub frequencies: u32,
    /// Forces are those about the static equilibrium of structure and gas at the first crossing.
    pub trim: bool,
    /// The structure in the stream is also written as a linear system of first order.
    pub state_space: bool,
    /// The limiter stays what it is in the steady flow.
    pub frozen_limiter: bool,
    /// Crossings and damping are sought on a coarser cloud as well.
    pub cloud_error: bool,
    /// V_D, an equivalent airspeed that margins are told against.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub design_speed: Option<Velocity>,
}

/// How the stream is varied at one Mach number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Matching {
    /// Speed and sound speed, at the density of the case.
    #[default]
    None,
    /// Density, at the sound speed of the case.
    Density,
    /// Altitude in the standard atmosphere, and density and sound speed with it.
    Altitude,
}

impl Flutter {
    /// Reduced frequencies that forces are computed at first, rising: from almost steady to twice what sections flutter at.
    pub fn first(&self) -> Vec<f64> {
        const USUAL: [f64; 4] = [0.02, 0.08, 0.2, 0.5];
        let mut all =
            if self.reduced_frequencies.is_empty() { USUAL.to_vec() } else { self.reduced_frequencies.clone() };
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// Frequencies that forces are computed at, about: those at first, at rest, and two near a crossing.
    pub fn expected(&self) -> usize {
        (self.first().len() + 3).min(self.frequencies.max(1) as usize)
    }
}

impl Case {
    /// True where the limiter stays in small motions what it is in the steady flow.
    pub fn freezes_limiter(&self) -> bool {
        self.flutter.as_ref().is_some_and(|f| f.frozen_limiter) || self.gaf.as_ref().is_some_and(|g| g.frozen_limiter)
    }

    /// True where forces are sought about the static equilibrium of structure and gas.
    pub fn is_trimmed(&self) -> bool {
        self.flutter.as_ref().is_some_and(|f| f.trim)
    }

    /// The steady flow at one Mach number about which forces are sought; bodies stay where they begin unless they are trimmed.
    pub fn flutter_case(&self, mach: f64) -> Self {
        // a rigid cloud around one rigid body turns with it; one that deforms serves any number of modes
        let mut case = self.settled_case(ParticleMotion::Deforming);
        case.title = format!("{} at Mach {mach}", self.title);
        case.flow.mach = Some(mach);
        for structure in &mut case.structures {
            structure.initial.clear();
            structure.modes.iter_mut().for_each(|m| (m.initial, m.initial_rate) = (0.0, 0.0));
        }
        case
    }

    /// The steady flow on the cloud of the case, so far converged that small motions about it can be told; `particles` follow bodies.
    pub(super) fn settled_case(&self, particles: ParticleMotion) -> Self {
        /// Orders that the residual falls by: what is left of it is a force that does not belong to the motion.
        const ORDERS: f64 = 9.0;
        let mut case = self.clone();
        let steady = if let Temporal::Steady(steady) = &self.time { steady.clone() } else { Steady::default() };
        case.time = Temporal::Steady(Steady { orders: ORDERS, ..steady });
        case.motion = Some(Motion { particles, law: self.motion.clone().map_or_else(Default::default, |m| m.law) });
        case.output.report = false;
        case
    }

    /// The march of a motion of period `period` at one Mach number, in a stream of `ratio` times the pressure and temperature of the case; `start` has value and
    /// rate of every coordinate where it begins. Dimensions stay those of the case: the structure is softer in place of a faster stream.
    /// Structures that are not trimmed are held as drawn against `borne`, the forces of the steady flow on all coordinates in units of the
    /// solver.
    pub fn cycle_case(
        &self,
        (mach, ratio): (f64, StreamRatio),
        (start, borne): (&[[f64; 2]], &[f64]),
        [period, most]: [f64; 2],
    ) -> Self {
        /// Steps of a period.
        const STEPS: f64 = 64.0;
        let mut case = self.flutter_case(mach);
        case.title = format!("{}, limit cycle", case.title);
        let march = Dual { swing: Some(Time(period)), ..Dual::fixed(Time(period / STEPS), Time(most * period)) };
        (case.time, case.accuracy) = (Temporal::Dual(march), None);
        // a rigid cloud turns with a rigid body, as in any march
        case.motion.clone_from(&self.motion);
        let (trimmed, pressure) = (self.is_trimmed(), case.flow.units().pressure());
        let held: Vec<f64> = borne.iter().map(|f| -f * pressure).collect();
        let (dimension, mut rest, mut held) = (usize::from(case.dimension.unwrap_or(2)), start, &held[..]);
        for body in 0..case.bodies.len() {
            let Some(k) = case.structure_of(body).and_then(|s| case.structures.iter().position(|o| o == s)) else {
                continue;
            };
            let structure = &mut case.structures[k];
            structure.soften(ratio, trimmed);
            if !trimmed {
                structure.hold(dimension, held);
            }
            let own = structure.begin(dimension, rest);
            (rest, held) = (&rest[own.min(rest.len())..], &held[own.min(held.len())..]);
        }
        case
    }

    /// About the period of a free motion of structures that a march is to find.
    pub fn swing(&self) -> Option<Time> {
        match &self.time {
            Temporal::Dual(dual) => dual.swing,
            _ => None,
        }
    }
}

impl Structure {
    /// That in another stream, told in the units of the case; nothing else pulls but, where it is `trimmed`, gravity.
    fn soften(&mut self, ratio: StreamRatio, trimmed: bool) {
        self.enter(ratio, false);
        self.modes.iter_mut().for_each(|m| m.force = None);
        self.force = None;
        self.gravity = self.gravity.take().filter(|_| trimmed);
    }

    /// Constant forces on its coordinates, in base units.
    fn hold(&mut self, dimension: usize, forces: &[f64]) {
        let text = |force: &f64| format!("{force:?}");
        if self.modes.is_empty() {
            let free = self.freedoms(dimension);
            let formulas = free.iter().zip(forces).map(|(f, force)| (f.name().to_owned(), text(force))).collect();
            self.force = Some(StructureForce { formulas, ..StructureForce::default() });
        }
        self.modes.iter_mut().zip(forces).for_each(|(m, force)| m.force = Some(text(force)));
    }

    /// Begins with these values and rates; tells how many coordinates there are.
    fn begin(&mut self, dimension: usize, start: &[[f64; 2]]) -> usize {
        let free = self.freedoms(dimension);
        for (freedom, [value, rate]) in free.iter().zip(start) {
            self.initial.insert(freedom.name().to_owned(), *value);
            self.initial.insert(format!("{}_rate", freedom.name()), *rate);
        }
        self.modes.iter_mut().zip(start).for_each(|(m, [value, rate])| (m.initial, m.initial_rate) = (*value, *rate));
        free.len().max(self.modes.len())
    }
}
