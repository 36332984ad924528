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
//!
//! Bodies made of particles ([`solids`]) add the displacements and velocities of these, in pairs, as coordinates of their own.
mod bodies;
pub mod led;
mod march;
mod preconditioner;
mod solid_preconditioner;
pub mod solids;

pub use bodies::{Attached, body_motion};
pub use march::March;
pub use preconditioner::CoupledPreconditioner;

use std::ops::Range;

use crate::math::parallel::sweep_rows;
use crate::math::reduce::{largest_size, sum, sum_each};
use crate::scheme::{self, Exchange, Fluid, HasGas, View};
use crate::solid::Solid;
use crate::solid::forces::State;
use crate::system::{Fault, Field, Instant, Rate, System};
use crate::time::explicit::{Explicit, Plan};
use crate::time::{Integrator, Past};

use solids::{Moving, OnCloud, Pace};

/// Rate of a structure that nothing holds, in units of the case: what local times are measured with then.
const SLOWEST: f64 = 1e-6;

/// A gas with the structures that it flows around.
pub struct Coupled<const D: usize> {
    fluid: Fluid<D>,
    bodies: Vec<Attached<D>>,
    solids: Option<OnCloud<D>>,
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
    /// Power of the gas on bodies made of particles in the step that has led here, where that is explicit.
    pub taken: Option<f64>,
    /// Length of the implicit step that ends here; 0 where there is none.
    pub step: f64,
}

/// Length of the step that the formula of an instant ends.
fn step_of(rate: &Rate<'_>) -> f64 {
    match rate {
        Rate::Formula([now, before, ..]) => (now.time - before.time).max(0.0),
        Rate::Within { step, .. } => *step,
        _ => 0.0,
    }
}

/// Storage of an evaluation.
pub struct Work<const D: usize> {
    /// That of the gas.
    pub gas: scheme::Work<D>,
    /// Generalised forces of the gas on all coordinates.
    pub load: Vec<f64>,
    /// Sums of chunks of walls on the way to them.
    chunks: Vec<f64>,
    /// That of bodies made of particles.
    pub solids: Option<solids::Work<D>>,
}

impl<const D: usize> Coupled<D> {
    /// The gas `fluid`, whose bodies move as [`body_motion`] has it, with the structures `bodies` in the order of their coordinates. Bodies
    /// with the same first coordinate share one structure, and its forces are those on all of them.
    pub fn new(fluid: Fluid<D>, bodies: Vec<Attached<D>>) -> Self {
        let count = bodies.iter().map(|b| b.range().end).max().unwrap_or(0);
        let fields = vec![fluid.fields()[0], Field::new("structure", count, 2)];
        let fastest = bodies.iter().map(Attached::fastest).fold(SLOWEST, f64::max);
        Self { fluid, bodies, solids: None, fields, fastest, held: false }
    }

    /// The same with bodies made of particles.
    pub fn with_solids(mut self, solids: OnCloud<D>) -> Self {
        self.fields.truncate(2);
        let solid = &solids.solids.structure.solid;
        self.fields.push(Field::new("solid", solid.len(), 2 * D));
        if solid.remembers() {
            self.fields.push(Field::new("history", solid.len(), solid.history_width()));
        }
        self.solids = Some(solids);
        self
    }

    /// Bodies made of particles.
    pub fn solids(&self) -> Option<&OnCloud<D>> {
        self.solids.as_ref()
    }

    /// The unknowns of bodies on springs.
    fn sprung(&self) -> Range<usize> {
        let first = self.fields[0].len();
        first..first + self.fields[1].len()
    }

    /// The unknowns of bodies made of particles.
    pub fn solid_range(&self) -> Range<usize> {
        let first = self.sprung().end;
        first..first + self.fields.get(2).map_or(0, Field::len)
    }

    /// What their materials remember among the unknowns.
    pub fn history_range(&self) -> Range<usize> {
        let first = self.solid_range().end;
        first..first + self.fields.get(3).map_or(0, Field::len)
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
        let solids = self.solids.as_ref().map(|s| s.solids.initial()).unwrap_or_default();
        let solid = self.solids.as_ref().map(|s| &s.solids.structure.solid).filter(|s| s.remembers());
        let virgin = solid.map(Solid::virgin).unwrap_or_default();
        let sprung = self.bodies.iter().flat_map(Attached::initial);
        gas.iter().copied().chain(sprung).chain(solids).chain(virgin).collect()
    }

    /// Sets `work.load` to the generalised forces of the walls whose states are in `work`, for coordinates with the unknowns `u` of the structures.
    fn loads(&self, frame: &scheme::Frame<D>, u: &[f64], work: &mut Work<D>) {
        let Work { gas, load, chunks, .. } = work;
        let view = View::new(&self.fluid, frame, gas);
        let placements: Vec<_> = self.bodies.iter().map(|body| body.placement(u)).collect();
        sum_each(view.reference().interface.len(), load, chunks, |walls, load| {
            for (body, placement) in self.bodies.iter().zip(&placements) {
                body.add_loads(&view, placement, walls.clone(), &mut load[body.range()]);
            }
        });
    }

    /// What rates are sought for.
    fn pace(&self, frame: &Frame<D>) -> Pace {
        match (self.held, frame.steady) {
            (true, _) => Pace::Held,
            (_, true) => Pace::Steady,
            _ => Pace::Marching,
        }
    }

    /// d/dt of the unknowns `u` of the structures under the walls whose states are in `work`.
    fn structures(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, change: &mut [f64]) {
        self.loads(&frame.gas, u, work);
        for body in &self.bodies {
            let (own, load) = (2 * body.first..2 * body.range().end, &work.load[body.range()]);
            match (self.held, frame.steady) {
                (true, _) => body.towards_start(&u[own.clone()], self.fastest, &mut change[own]),
                (_, true) => body.towards_rest(&u[own.clone()], load, self.fastest, &mut change[own]),
                _ => body.rates(frame.gas.time, &u[own.clone()], load, &mut change[own]),
            }
        }
        let own = self.fields[1].len()..u.len();
        if let (Some(on), Some(storage)) = (&self.solids, &mut work.solids) {
            on.load(&View::new(&self.fluid, &frame.gas, &work.gas), storage);
            let at = Moving { time: frame.gas.time, step: frame.step, jets: &frame.gas.jets, pace: self.pace(frame) };
            let (solid, remembered) =
                (own.start..own.start + on.solids.len() * 2 * D, own.start + on.solids.len() * 2 * D..u.len());
            change[own].fill(0.0);
            if !remembered.is_empty() {
                storage.history.copy_from_slice(&u[remembered]);
            }
            on.solids.rates(&at, &u[solid.clone()], storage, &mut change[solid]);
        }
    }
}

impl<const D: usize> Coupled<D> {
    /// The largest change of a coordinate of structures and solids in its unit; infinite if NaN.
    fn largest_move(&self, du: &[f64]) -> f64 {
        let own = &du[self.sprung()];
        let units: Vec<f64> = self.bodies.iter().flat_map(|b| b.units.iter().copied()).collect();
        let sprung = largest_size(units.len().min(own.len() / 2), |k| own[2 * k] / units[k]);
        let unit = self.solids.as_ref().map_or(1.0, |s| s.solids.length);
        let solid = &du[self.solid_range()];
        largest_size(solid.len() / 2, |k| solid[2 * k] / unit).max(sprung)
    }
}

impl<const D: usize> System for Coupled<D> {
    type Frame = Frame<D>;
    type Work = Work<D>;

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn placing(&self) -> Range<usize> {
        self.fields[0].len()..self.solid_range().end
    }

    fn work(&self) -> Work<D> {
        let solids = self.solids.as_ref().map(|s| s.solids.work());
        Work { gas: self.fluid.work(), load: vec![0.0; self.n_coordinates()], chunks: Vec::new(), solids }
    }

    fn frame(&self, at: &Instant<'_>, u: &[f64]) -> Frame<D> {
        let gas = self.fluid.frame(at, &u[self.gas_range()]);
        Frame { gas, steady: matches!(at.rate, Rate::Still), taken: None, step: step_of(&at.rate) }
    }

    fn place(&self, at: &Instant<'_>, frame: &mut Frame<D>) {
        self.fluid.place(at, &mut frame.gas);
        frame.steady = matches!(at.rate, Rate::Still);
        frame.step = step_of(&at.rate);
    }

    fn remembered(&self) -> Range<usize> {
        self.history_range()
    }

    fn settle(&self, frame: &Frame<D>, work: &mut Work<D>, u: &mut [f64]) {
        let (own, Some((on, work))) = (self.history_range(), self.solids.as_ref().zip(work.solids.as_mut())) else {
            return;
        };
        if own.is_empty() || self.pace(frame) != Pace::Marching {
            return;
        }
        on.solids.split(&u[self.solid_range()], work);
        work.history.copy_from_slice(&u[own.clone()]);
        on.solids.forces(frame.gas.time, frame.step, work);
        u[own].copy_from_slice(&work.after);
    }

    fn prescribe(&self, time: f64, u: &mut [f64]) {
        if let Some(on) = self.solids.as_ref().filter(|_| !self.held) {
            on.solids.prescribe(time, &mut u[self.solid_range()]);
        }
    }

    fn lead(&self, from: f64, to: f64, u: &mut [f64]) {
        if let Some(on) = &self.solids {
            on.solids.lead(from, to, &mut u[self.solid_range()]);
        }
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
        let (sprung, solid) = own.split_at_mut(self.fields[1].rows);
        sweep_rows(sprung, 1, |_, r| r[0] = self.fastest);
        if let Some(on) = &self.solids {
            let own = if self.pace(frame) == Pace::Marching { on.solids.brisk } else { on.solids.omega };
            sweep_rows(solid, 1, |_, r| r[0] = own);
        }
    }

    fn largest_change(&self, u: &[f64], du: &[f64]) -> f64 {
        let gas = self.gas_range();
        self.fluid.largest_change(&u[gas.clone()], &du[gas]).max(self.largest_move(du))
    }

    fn shorten(&self, u: &[f64], du: &mut [f64], largest: f64) {
        let gas = self.gas_range();
        self.fluid.shorten(&u[gas.clone()], &mut du[gas.clone()], largest);
        let change = self.largest_move(du);
        if change > largest && change.is_finite() {
            du[gas.end..].iter_mut().for_each(|du| *du *= largest / change);
        }
    }

    fn check(&self, frame: &Frame<D>, u: &[f64]) -> Result<(), Fault> {
        self.bodies.iter().try_for_each(|b| b.check(&u[self.sprung()], self.fields[0].rows))?;
        if let Some(on) = &self.solids {
            on.solids.check(&u[self.solid_range()], self.fields[0].rows + self.fields[1].rows)?;
        }
        self.fluid.check(&frame.gas, &u[self.gas_range()])
    }

    fn check_frame(&self, frame: &Frame<D>) -> Result<(), Fault> {
        self.fluid.check_frame(&frame.gas)
    }

    fn locate(&self, frame: &Frame<D>, row: usize) -> Vec<f64> {
        match row < self.fields[0].rows {
            true => self.fluid.locate(&frame.gas, row),
            false => {
                let solid = row.checked_sub(self.fields[0].rows + self.fields[1].rows);
                let place = |(on, i): (&OnCloud<D>, usize)| on.solids.structure.solid.particles.x[i].0.to_vec();
                self.solids.as_ref().zip(solid).map(place).unwrap_or_default()
            }
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
        let remembered = &u[self.history_range()];
        let (gas, u, solid) = (&u[self.gas_range()], &u[self.sprung()], &u[self.solid_range()]);
        self.fluid.fill_states(&frame.gas, gas, &mut work.gas);
        if self.fluid.viscous_model.is_some() {
            self.fluid.fill_gradients(&frame.gas, &mut work.gas);
        }
        self.loads(&frame.gas, u, work);
        // by the rates of the difference formula, which move the walls: what these take is what the structures get
        let moved = |k: usize| frame.gas.jets.get(k).map_or(u[2 * k + 1], |jet| jet.first);
        let power = sum(work.load.len(), |k| work.load[k] * moved(k));
        let cloud = &frame.gas.discretisation.cloud;
        let velocity = |w: usize| frame.gas.to_inertial_axes(&frame.gas.velocity_of(cloud.n_fluid + w));
        let solids = self.solids.iter().flat_map(|s| &s.solids.bodies).map(|b| b.body);
        let carried: Vec<usize> = self.bodies.iter().map(|b| b.body).chain(solids).collect();
        let attached = |w: usize| carried.contains(&usize::from(cloud.interface[w].body));
        let view = View::new(&self.fluid, &frame.gas, &work.gas);
        let by_state = |w: usize| view.wall_force(w).dot(&velocity(w));
        let on_wall =
            |w: usize| frame.gas.taken.get(w).filter(|t| t.area > 0.0).map_or_else(|| by_state(w), |t| t.power);
        let wall_power = sum(cloud.interface.len(), |w| if attached(w) { on_wall(w) } else { 0.0 });
        let mut all = Exchange { power, wall_power, ..Exchange::default() };
        for body in &self.bodies {
            body.range().for_each(|k| all.push([u[2 * k], u[2 * k + 1], work.load[k]]));
            body.told(u).into_iter().for_each(|[place, rate]| all.push([place, rate, 0.0]));
        }
        for energy in self.bodies.iter().map(|b| b.energy(u)) {
            all.kinetic += energy.kinetic;
            all.potential += energy.potential;
            all.dissipation += energy.dissipation;
        }
        if let (Some(on), Some(work)) = (&self.solids, &mut work.solids) {
            on.load(&view, work);
            on.solids.split(solid, work);
            if !self.history_range().is_empty() {
                work.history.copy_from_slice(remembered);
            }
            if !frame.steady && frame.taken.is_none() {
                on.solids.by_formula(&frame.gas.jets, work);
            }
            let (energy, damped) = on.solids.energy(frame.gas.time, work);
            all.kinetic += energy.kinetic;
            all.potential += energy.strain + energy.stabilisation + energy.contact;
            all.dissipation += damped;
            all.power += frame.taken.unwrap_or_else(|| on.power(&frame.gas.jets, work));
            on.solids.told(work).into_iter().for_each(|told| all.push(told));
        }
        Some(all)
    }
}

/// A system with a gas that can march with explicit steps, in the way that suits what is beside the gas.
pub trait Marches<const D: usize>: HasGas<D> + Sized {
    /// Bodies made of particles in a frame at the state `u`; `None` where there are none.
    fn solid_snapshot(&self, frame: &Self::Frame, u: &[f64]) -> Option<SolidSnapshot<'_, D>>;
    /// This with its structures; `None` for a gas alone.
    fn coupled(&self) -> Option<&Coupled<D>> {
        None
    }
    /// Bodies on springs; none for a gas alone.
    fn attached(&self) -> &[Attached<D>] {
        &[]
    }
    /// Generalised forces of the gas on the coordinates of all structures, in units of the solver, at the state `u` for which the frame stands.
    fn generalised_forces(&self, _frame: &Self::Frame, _u: &[f64], _work: &mut Self::Work) -> Vec<f64> {
        Vec::new()
    }
    /// A march from the state `u`.
    fn explicit<'a>(&'a self, plan: Plan, past: Past, u: Vec<f64>) -> Box<dyn Integrator<Self> + 'a>;
}

/// Bodies made of particles at a moment, in the units of the case.
#[derive(Debug)]
pub struct SolidSnapshot<'a, const D: usize> {
    /// The bodies.
    pub solid: &'a Solid<D>,
    /// Displacements.
    pub displacement: Vec<[f64; D]>,
    /// Velocities, by the formula that serves the state where there is one.
    pub velocity: Vec<[f64; D]>,
    /// What materials remember.
    pub history: Vec<f64>,
}

impl<const D: usize> SolidSnapshot<'_, D> {
    /// What the stresses follow from.
    pub fn state(&self) -> State<'_, D> {
        State {
            time: 0.0,
            step: 0.0,
            displacement: &self.displacement,
            velocity: &self.velocity,
            history: &self.history,
        }
    }
}

impl<const D: usize> Marches<D> for Fluid<D> {
    fn solid_snapshot(&self, _: &Self::Frame, _: &[f64]) -> Option<SolidSnapshot<'_, D>> {
        None
    }

    fn explicit<'a>(&'a self, plan: Plan, past: Past, u: Vec<f64>) -> Box<dyn Integrator<Self> + 'a> {
        Box::new(Explicit::new(self, plan, past, u))
    }
}

impl<const D: usize> Marches<D> for Coupled<D> {
    fn coupled(&self) -> Option<&Coupled<D>> {
        Some(self)
    }

    fn attached(&self) -> &[Attached<D>] {
        &self.bodies
    }

    fn generalised_forces(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>) -> Vec<f64> {
        self.fluid.fill_states(&frame.gas, &u[self.gas_range()], &mut work.gas);
        if self.fluid.viscous_model.is_some() {
            self.fluid.fill_gradients(&frame.gas, &mut work.gas);
        }
        self.loads(&frame.gas, &u[self.sprung()], work);
        work.load.clone()
    }

    fn solid_snapshot(&self, frame: &Frame<D>, u: &[f64]) -> Option<SolidSnapshot<'_, D>> {
        let on = self.solids.as_ref()?;
        let mut work = on.solids.work();
        on.solids.split(&u[self.solid_range()], &mut work);
        if !frame.steady && frame.taken.is_none() {
            on.solids.by_formula(&frame.gas.jets, &mut work);
        }
        let own = self.history_range();
        let history = if own.is_empty() { work.history } else { u[own].to_vec() };
        let solid = &on.solids.structure.solid;
        Some(SolidSnapshot { solid, displacement: work.displacement, velocity: work.velocity, history })
    }

    fn explicit<'a>(&'a self, plan: Plan, past: Past, u: Vec<f64>) -> Box<dyn Integrator<Self> + 'a> {
        match &self.solids {
            Some(on) => Box::new(March::new(self, on, plan, past, u)),
            None => Box::new(Explicit::new(self, plan, past, u)),
        }
    }
}
