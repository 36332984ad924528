//! The gas in a system that may hold more than the gas.
//!
//! Those who look at a flow (loads, pictures, files) need the gas, its frame, its storage and its part of the state. A system
//! of gas and structure has them among others; the gas alone is all of them itself.
use std::borrow::Cow;
use std::ops::Range;

use super::{Fluid, Frame, Work};
use crate::system::{Implicit, Name};

/// What passes between a gas and the structures in it, and what these hold; in the units of the solver.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exchange {
    /// Coordinates of all structures, each followed by what is told of its points.
    pub coordinates: Vec<f64>,
    /// Their rates.
    pub rates: Vec<f64>,
    /// Generalised forces of the gas on them.
    pub loads: Vec<f64>,
    /// Power of the gas on the structures, Σ Q q'.
    pub power: f64,
    /// Power of pressure and friction on the walls as the gas has it, Σ F·w with the velocities of the cloud.
    pub wall_power: f64,
    /// Kinetic energy of the structures.
    pub kinetic: f64,
    /// Energy of their springs, and that of gravity.
    pub potential: f64,
    /// Power that their dampers take.
    pub dissipation: f64,
}

impl Exchange {
    /// Adds a coordinate with its rate and its load.
    pub fn push(&mut self, [coordinate, rate, load]: [f64; 3]) {
        self.coordinates.push(coordinate);
        self.rates.push(rate);
        self.loads.push(load);
    }
}

/// A system of which the gas on a cloud is a part.
pub trait HasGas<const D: usize>: Implicit {
    /// The equations of the gas.
    fn gas(&self) -> &Fluid<D>;
    /// Puts the gas on another cloud.
    fn set_gas(&mut self, gas: Fluid<D>);
    /// The frame of the gas.
    fn gas_frame<'a>(&self, frame: &'a Self::Frame) -> &'a Frame<D>;
    /// The storage of the gas.
    fn gas_work<'a>(&self, work: &'a mut Self::Work) -> &'a mut Work<D>;
    /// The state at the start.
    fn start(&self) -> Vec<f64>;

    /// Holds the bodies that coordinates of their own move where they are at the start, or lets them go.
    fn hold_bodies(&mut self, _held: bool) {}

    /// What passes between gas and structures in a frame at the state `u`; `None` where there are no structures.
    fn exchange(&self, _frame: &Self::Frame, _u: &[f64], _work: &mut Self::Work) -> Option<Exchange> {
        None
    }

    /// The unknowns of the gas in the state.
    fn gas_unknowns(&self) -> Range<usize> {
        self.unknowns_of(Name::Gas)
    }

    /// The part of the state that is the gas.
    fn gas_state<'a>(&self, u: &'a [f64]) -> &'a [f64] {
        &u[self.gas_unknowns()]
    }

    /// The coordinates of bodies that are unknowns; empty where all motion is prescribed.
    fn coordinates<'a>(&self, u: &'a [f64]) -> Cow<'a, [f64]> {
        self.placing().values(u)
    }

    /// The state `u` with another one of the gas, on a cloud of any size.
    fn with_gas(&self, u: &[f64], gas: &[f64]) -> Vec<f64> {
        let own = self.gas_unknowns();
        [&u[..own.start], gas, &u[own.end..]].concat()
    }
}

impl<const D: usize> HasGas<D> for Fluid<D> {
    fn gas(&self) -> &Fluid<D> {
        self
    }

    fn set_gas(&mut self, gas: Fluid<D>) {
        *self = gas;
    }

    fn gas_frame<'a>(&self, frame: &'a Frame<D>) -> &'a Frame<D> {
        frame
    }

    fn gas_work<'a>(&self, work: &'a mut Work<D>) -> &'a mut Work<D> {
        work
    }

    fn start(&self) -> Vec<f64> {
        self.start()
    }
}
