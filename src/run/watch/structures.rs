//! How bodies on springs move: a row for every step.
use super::super::error::RunError;
use super::super::record::Log;
use super::drive::{Now, Observer};
use crate::observe::structure::StructureSample;
use crate::scheme::{Exchange, HasGas};
use crate::time::{Standing, Step};

/// Keeps coordinates, forces and energies of all structures.
pub(crate) struct Structures<'a, S, const D: usize> {
    /// The system.
    pub(crate) system: &'a S,
}

impl<S: HasGas<D>, const D: usize> Observer<S> for Structures<'_, S, D> {
    fn step(&mut self, step: &Step, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        let Standing { frame, work, state } = now.standing();
        match self.system.exchange(frame, state, work) {
            Some(exchange) => log.structure(&sample(step.time, exchange)),
            None => Ok(()),
        }
    }
}

/// A row of the table.
pub(crate) fn sample(time: f64, exchange: Exchange) -> StructureSample {
    let Exchange { coordinates, rates, loads, power, wall_power, kinetic, potential, dissipation } = exchange;
    StructureSample { time, coordinates, rates, loads, kinetic, potential, dissipation, gas_power: power, wall_power }
}
