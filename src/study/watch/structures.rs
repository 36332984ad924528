//! How bodies on springs move: a row for every step.
use super::super::record::Log;
use super::drive::{Now, Observer};
use crate::case::Units;
use crate::observe::structure::StructureSample;
use crate::problem::RunError;
use crate::scheme::{Exchange, HasGas};
use crate::time::{Standing, Step};

/// Keeps coordinates, forces and energies of all structures.
pub(crate) struct Structures<'a, S, const D: usize> {
    /// The system.
    pub(crate) system: &'a S,
}

impl<S: HasGas<D>, const D: usize> Observer<S, Log<'_>> for Structures<'_, S, D> {
    fn step(&mut self, step: &Step, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        let Standing { frame, work, state, .. } = now.standing();
        match self.system.exchange(frame, state, work) {
            Some(exchange) => log.structure(log.record.iteration, &sample(step.time, exchange, &log.units)),
            None => Ok(()),
        }
    }
}

/// A row of the table, in the units of the case; `time` and `exchange` are in those of the solver.
pub(crate) fn sample(time: f64, exchange: Exchange, units: &Units) -> StructureSample {
    let Exchange { coordinates, mut rates, mut loads, power, wall_power, kinetic, potential, dissipation } = exchange;
    // a force on a length is an energy: lengths are the same in both, and so forces, moments and energies have one factor
    let (force, power_unit) = (units.pressure(), units.pressure() * units.speed);
    rates.iter_mut().for_each(|v| *v *= units.speed);
    loads.iter_mut().for_each(|q| *q *= force);
    StructureSample {
        time: units.case_time(time),
        coordinates,
        rates,
        loads,
        kinetic: kinetic * force,
        potential: potential * force,
        dissipation: dissipation * power_unit,
        gas_power: power * power_unit,
        wall_power: wall_power * power_unit,
    }
}
