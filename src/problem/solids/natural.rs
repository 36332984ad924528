//! Natural modes of bodies made of particles, found before a run: the coordinates of a structure.
use std::sync::Arc;

use super::super::error::RunError;
use super::super::stream::StreamRatio;
use crate::case::{Case, ModeTable, StructureModel, Units};
use crate::motion::{ModeShape, MotionError};
use crate::structure::{Coordinate, ForceHistory, Model, Spring, Structure};

/// Natural modes of the bodies of a case, body by body, from the slowest on; none of bodies that do not move in such.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct NaturalModes {
    bodies: Vec<Vec<NaturalMode>>,
}

/// A natural mode, in units of the case.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NaturalMode {
    /// Generalised mass.
    mass: f64,
    /// Generalised stiffness.
    stiffness: f64,
    /// Damping ratio.
    damping_ratio: f64,
    /// Generalised force of gravity.
    weight: f64,
    /// Value and rate of the coordinate at the start.
    start: [f64; 2],
    /// Shape.
    table: Arc<ModeTable>,
    /// Frequency with its error, and generalised mass, in words.
    words: String,
}

/// What is found of a natural mode.
pub(super) struct Found {
    /// Angular frequency.
    pub(super) omega: f64,
    /// Generalised mass.
    pub(super) mass: f64,
    /// Gravity's part along it.
    pub(super) weight: f64,
    /// Momentum at the start along it.
    pub(super) momentum: f64,
    /// Damping in proportion to mass and to stiffness.
    pub(super) damping: [f64; 2],
    /// Estimate of the relative error of the frequency.
    pub(super) error: Option<f64>,
    /// Shape.
    pub(super) table: ModeTable,
}

impl From<Found> for NaturalMode {
    /// Damping in proportion to mass and stiffness is ζ = α/(2ω) + βω/2; the velocity at the start and gravity are their parts along the
    /// mode.
    fn from(found: Found) -> Self {
        let (mass, omega, [alpha, beta]) = (found.mass, found.omega, found.damping);
        let error = found.error.map(|e| format!(" ± {:.1e} %", 100.0 * e)).unwrap_or_default();
        Self {
            mass,
            stiffness: mass * omega * omega,
            damping_ratio: if omega > 0.0 { 0.5 * (alpha / omega + beta * omega) } else { 0.0 },
            weight: found.weight,
            start: [0.0, found.momentum / mass],
            table: Arc::new(found.table),
            words: format!("{:.5e}{error} (generalised mass {mass:.4e})", omega / std::f64::consts::TAU),
        }
    }
}

impl NaturalMode {
    /// Shape as a table.
    pub(crate) fn table(&self) -> &ModeTable {
        &self.table
    }
}

impl NaturalModes {
    /// Modes of each body.
    pub(super) fn new(bodies: Vec<Vec<NaturalMode>>) -> Self {
        Self { bodies }
    }

    /// Modes that the body number `body` of a case moves in; `None` where its structure is of another kind.
    pub(crate) fn of_body(&self, case: &Case, body: usize) -> Option<&[NaturalMode]> {
        let own = case.structure_of(body)?.model == StructureModel::OwnModes;
        self.bodies.get(body).filter(|_| own).map(Vec::as_slice)
    }

    /// Modes of all bodies in words, a line for each body.
    pub(crate) fn words(&self) -> Vec<String> {
        let line = |modes: &Vec<NaturalMode>| {
            let all: Vec<&str> = modes.iter().map(|m| m.words.as_str()).collect();
            format!("own modes, cycles per unit of time: {}", all.join(", "))
        };
        self.bodies.iter().filter(|modes| !modes.is_empty()).map(line).collect()
    }

    /// The same where every mode is changed.
    fn each(&self, change: impl Fn(NaturalMode) -> NaturalMode) -> Self {
        Self { bodies: self.bodies.iter().map(|modes| modes.iter().cloned().map(&change).collect()).collect() }
    }

    /// The same in units of another stream.
    pub(in super::super) fn in_stream(&self, ratio: StreamRatio) -> Self {
        let [stiffness, _, mass] = ratio.structural();
        self.each(|mode| NaturalMode { mass: mode.mass * mass, stiffness: mode.stiffness * stiffness, ..mode })
    }

    /// The same at rest at the start.
    pub(in super::super) fn at_rest(&self) -> Self {
        self.each(|mode| NaturalMode { start: [0.0; 2], ..mode })
    }

    /// The same without gravity.
    pub(in super::super) fn weightless(&self) -> Self {
        self.each(|mode| NaturalMode { weight: 0.0, ..mode })
    }

    /// Lets the modes of a body begin with these values and rates; returns their number.
    pub(in super::super) fn begin(&mut self, body: usize, start: &[[f64; 2]]) -> usize {
        let Some(modes) = self.bodies.get_mut(body) else { return 0 };
        modes.iter_mut().zip(start).for_each(|(mode, start)| mode.start = *start);
        modes.len()
    }
}

/// The modal structure of natural modes, in units of the solver, with the shapes of its coordinates.
pub(in super::super) fn structure<const D: usize>(
    modes: &[NaturalMode],
    units: &Units,
) -> Result<(Structure<D>, Vec<ModeShape<D>>), RunError> {
    let name = |k: usize| format!("mode-{}", k + 1);
    let coordinate = |(k, mode): (usize, &NaturalMode)| {
        let (mass, stiffness) = (mode.mass / units.density, mode.stiffness / units.pressure());
        Coordinate {
            name: name(k),
            spring: Spring::linear(stiffness),
            damping: 2.0 * mode.damping_ratio * (stiffness * mass).sqrt(),
            force: match mode.weight {
                0.0 => ForceHistory::Zero,
                weight => ForceHistory::steady(weight * (1.0 / units.pressure())),
            },
            initial: mode.start[0],
            initial_rate: units.solver_rate(mode.start[1]),
        }
    };
    let masses = modes.iter().enumerate().map(|(k, mode)| (name(k), mode.mass / units.density)).collect();
    let coordinates = modes.iter().enumerate().map(coordinate).collect();
    let shape = |(k, mode): (usize, &NaturalMode)| {
        ModeShape::new(&mode.table).ok_or_else(|| MotionError::Crowded { file: name(k) })
    };
    let shapes = modes.iter().enumerate().map(shape).collect::<Result<_, _>>()?;
    Ok((Structure::new(Model::Modal(masses), coordinates)?, shapes))
}
