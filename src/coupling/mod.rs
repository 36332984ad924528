//! Gas and structures as one system.
//!
//! U = [gas | q₀, q₀', q₁, q₁', …]: the states of all fluid particles, then the coordinates of all structures, each with its rate.
//! The coordinates place the bodies, and with them the cloud; its velocities follow from positions by the formula that
//! serves the state. The gas acts on the structures by the virtual work of pressure and friction on the walls,
//! Q_k = Σ_w F_w · ∂x_w/∂q_k. Steady runs, implicit marching and harmonic balance are those of any other [`System`]: each Newton
//! iteration solves for gas and coordinates together, and nothing is left to iterate between them.
//!
//! In a steady flow there is no time for inertia: the coordinates go to where springs and gas are at rest with one another,
//! dq/dτ = M⁻¹(Q + f − F(q))/ω, dq'/dτ = −ω q', with ω the highest natural frequency. Structures that are *held*, for the steady
//! flow that a march begins with, keep the values of their start.
mod bodies;
mod preconditioner;

pub use bodies::{Attached, body_motion};
pub use preconditioner::CoupledPreconditioner;

use std::ops::Range;

use crate::math::sweep::sweep_rows;
use crate::scheme::{self, Exchange, Fluid, HasGas, View};
use crate::system::{Fault, Field, Instant, Rate, System, unknowns};

/// Rate of a structure that nothing holds, in units of the case: what local times are measured with then.
const SLOWEST: f64 = 1e-6;

/// A gas with the structures that it flows around.
pub struct Coupled<const D: usize> {
    fluid: Fluid<D>,
    bodies: Vec<Attached<D>>,
    fields: Vec<Field>,
    /// Highest natural frequency of the structures.
    fastest: f64,
    /// The structures are held where they begin.
    held: bool,
}

/// The gas and its cloud, and whether time stands still.
#[derive(Clone, Debug)]
pub struct Frame<const D: usize> {
    /// The gas.
    pub gas: scheme::Frame<D>,
    /// Steady flow: the structures go to their equilibrium.
    pub steady: bool,
}

/// Storage of an evaluation.
pub struct Work<const D: usize> {
    /// That of the gas.
    pub gas: scheme::Work<D>,
    /// Generalised forces of the gas on all coordinates.
    pub load: Vec<f64>,
}

impl<const D: usize> Coupled<D> {
    /// The gas `fluid`, whose bodies move as [`body_motion`] has it, with the structures `bodies` in the order of their coordinates.
    pub fn new(fluid: Fluid<D>, bodies: Vec<Attached<D>>) -> Self {
        let count = bodies.iter().map(|b| b.structure.len()).sum();
        let fields = vec![fluid.fields()[0], Field::new("structure", count, 2)];
        let fastest = bodies.iter().map(Attached::fastest).fold(SLOWEST, f64::max);
        Self { fluid, bodies, fields, fastest, held: false }
    }

    /// The gas.
    pub fn fluid(&self) -> &Fluid<D> {
        &self.fluid
    }

    /// The structures.
    pub fn bodies(&self) -> &[Attached<D>] {
        &self.bodies
    }

    /// Number of coordinates of all structures.
    pub fn n_coordinates(&self) -> usize {
        self.fields[1].rows
    }

    /// Unknowns of the gas.
    pub fn gas_range(&self) -> Range<usize> {
        0..self.fields[0].len()
    }

    /// The state in which the gas is `gas` and the structures are where they begin.
    pub fn start_with(&self, gas: &[f64]) -> Vec<f64> {
        gas.iter().copied().chain(self.bodies.iter().flat_map(Attached::initial)).collect()
    }

    /// Generalised forces of the walls whose states are in `work`, for coordinates with the unknowns `u` of the structures.
    fn loads(&self, frame: &scheme::Frame<D>, work: &scheme::Work<D>, u: &[f64], load: &mut [f64]) {
        load.fill(0.0);
        for body in &self.bodies {
            body.add_loads(&self.fluid, (frame, work), u, &mut load[body.range()]);
        }
    }

    /// d/dt of the unknowns `u` of the structures under the walls whose states are in `work`.
    fn structures(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, change: &mut [f64]) {
        self.loads(&frame.gas, &work.gas, u, &mut work.load);
        for body in &self.bodies {
            let (own, load) = (2 * body.first..2 * body.range().end, &work.load[body.range()]);
            match (self.held, frame.steady) {
                (true, _) => body.towards_start(&u[own.clone()], self.fastest, &mut change[own]),
                (_, true) => body.towards_rest(&u[own.clone()], load, self.fastest, &mut change[own]),
                _ => body.rates(frame.gas.time, &u[own.clone()], load, &mut change[own]),
            }
        }
    }
}

impl<const D: usize> System for Coupled<D> {
    type Frame = Frame<D>;
    type Work = Work<D>;

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn placing(&self) -> Range<usize> {
        self.fields[0].len()..unknowns(&self.fields)
    }

    fn work(&self) -> Work<D> {
        Work { gas: self.fluid.work(), load: vec![0.0; self.n_coordinates()] }
    }

    fn frame(&self, at: &Instant<'_>, u: &[f64]) -> Frame<D> {
        let gas = self.fluid.frame(at, &u[self.gas_range()]);
        Frame { gas, steady: matches!(at.rate, Rate::Still) }
    }

    fn place(&self, at: &Instant<'_>, frame: &mut Frame<D>) {
        self.fluid.place(at, &mut frame.gas);
        frame.steady = matches!(at.rate, Rate::Still);
    }

    fn update_boundary_state(&self, u: &[f64], work: &mut Work<D>, frame: &mut Frame<D>) {
        self.fluid.update_boundary_state(&u[self.gas_range()], &mut work.gas, &mut frame.gas);
    }

    fn rhs(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, du: &mut [f64]) {
        let ((gas, u), (gas_change, change)) =
            (u.split_at(self.fields[0].len()), du.split_at_mut(self.fields[0].len()));
        self.fluid.rhs(&frame.gas, gas, &mut work.gas, gas_change);
        self.structures(frame, u, work, change);
    }

    fn rhs_with_boundary(&self, u: &[f64], work: &mut Work<D>, frame: &mut Frame<D>, du: &mut [f64]) {
        let ((gas, u), (gas_change, change)) =
            (u.split_at(self.fields[0].len()), du.split_at_mut(self.fields[0].len()));
        self.fluid.rhs_with_boundary(gas, &mut work.gas, &mut frame.gas, gas_change);
        self.structures(frame, u, work, change);
    }

    fn rates(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, rate: &mut [f64]) {
        let (gas, own) = rate.split_at_mut(self.fields[0].rows);
        self.fluid.rates(&frame.gas, &u[self.gas_range()], &mut work.gas, gas);
        sweep_rows(own, 1, |_, r| r[0] = self.fastest);
    }

    fn largest_change(&self, u: &[f64], du: &[f64]) -> f64 {
        let gas = self.gas_range();
        let own = du[self.placing()].chunks_exact(2).zip(self.bodies.iter().flat_map(|b| &b.units));
        let largest = own.map(|(pair, unit)| pair[0].abs() / unit);
        largest.fold(self.fluid.largest_change(&u[gas.clone()], &du[gas]), |m, c| {
            if c.is_finite() { m.max(c) } else { f64::INFINITY }
        })
    }

    fn check(&self, frame: &Frame<D>, u: &[f64]) -> Result<(), Fault> {
        self.bodies.iter().try_for_each(|b| b.check(&u[self.placing()], self.fields[0].rows))?;
        self.fluid.check(&frame.gas, &u[self.gas_range()])
    }

    fn check_frame(&self, frame: &Frame<D>) -> Result<(), Fault> {
        self.fluid.check_frame(&frame.gas)
    }

    fn locate(&self, frame: &Frame<D>, row: usize) -> Vec<f64> {
        match row < self.fields[0].rows {
            true => self.fluid.locate(&frame.gas, row),
            false => Vec::new(),
        }
    }
}

impl<const D: usize> HasGas<D> for Coupled<D> {
    fn gas(&self) -> &Fluid<D> {
        &self.fluid
    }

    fn set_gas(&mut self, gas: Fluid<D>) {
        self.fields[0] = gas.fields()[0];
        self.fluid = gas;
    }

    fn gas_unknowns(&self) -> Range<usize> {
        self.gas_range()
    }

    fn gas_frame<'a>(&self, frame: &'a Frame<D>) -> &'a scheme::Frame<D> {
        &frame.gas
    }

    fn gas_work<'a>(&self, work: &'a mut Work<D>) -> &'a mut scheme::Work<D> {
        &mut work.gas
    }

    fn start(&self) -> Vec<f64> {
        self.start_with(&self.fluid.start())
    }

    fn hold_bodies(&mut self, held: bool) {
        self.held = held;
    }

    fn exchange(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>) -> Option<Exchange> {
        let (gas, u) = (&u[self.gas_range()], &u[self.placing()]);
        self.fluid.fill_states(&frame.gas, gas, &mut work.gas);
        if self.fluid.viscous_model.is_some() {
            self.fluid.fill_gradients(&frame.gas, &mut work.gas);
        }
        self.loads(&frame.gas, &work.gas, u, &mut work.load);
        let [coordinates, rates] = [0, 1].map(|part| u.chunks_exact(2).map(|pair| pair[part]).collect::<Vec<f64>>());
        let loads = work.load.clone();
        // by the rates of the difference formula, which move the walls: what these take is what the structures get
        let moved = |k: usize| frame.gas.jets.get(k).map_or(rates[k], |jet| jet.first);
        let power = loads.iter().enumerate().map(|(k, load)| load * moved(k)).sum();
        let cloud = &frame.gas.discretisation.cloud;
        let velocity = |w: usize| frame.gas.to_inertial_axes(&frame.gas.velocity_of(cloud.n_fluid + w));
        let attached = |w: &usize| self.bodies.iter().any(|b| b.body == usize::from(cloud.interface[*w].body));
        let walls = (0..cloud.interface.len()).filter(attached);
        let view = View::new(&self.fluid, &frame.gas, &work.gas);
        let wall_power = walls.map(|w| view.wall_force(w).dot(&velocity(w))).sum();
        let mut all = Exchange { coordinates, rates, loads, power, wall_power, ..Exchange::default() };
        for energy in self.bodies.iter().map(|b| b.energy(u)) {
            all.kinetic += energy.kinetic;
            all.potential += energy.potential;
            all.dissipation += energy.dissipation;
        }
        Some(all)
    }
}
