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
mod derivative;
pub mod led;
mod march;
mod preconditioner;
mod solid_preconditioner;
pub mod solids;

pub use bodies::{Attached, body_motion};
pub use march::March;
pub use preconditioner::CoupledPreconditioner;

use crate::math::Vector;
use crate::math::parallel::fill;
use crate::math::reduce::{largest_size, sum, sum_each};
use crate::scheme::{self, Exchange, Fluid, HasGas, View};
use crate::solid::Solid;
use crate::solid::forces::State;
use crate::system::{Fault, Field, Instant, Name, Ranges, Rate, System, placed};
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
    placing: Ranges,
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
        let structure = Field::new(Name::Structure, count, 2);
        let fields: Vec<Field> = fluid.fields().iter().copied().chain([structure]).collect();
        let (fastest, placing) = (bodies.iter().map(Attached::fastest).fold(SLOWEST, f64::max), placing(&fields));
        Self { fluid, bodies, solids: None, fields, placing, fastest, held: false }
    }

    /// The same with bodies made of particles.
    pub fn with_solids(mut self, solids: OnCloud<D>) -> Self {
        self.fields.retain(|field| field.cloud != Name::Solid);
        let solid = &solids.solids.structure.solid;
        self.fields.push(Field::new(Name::Solid, solid.len(), 2 * D));
        if solid.remembers() {
            self.fields.push(Field::new(Name::History, solid.len(), solid.history_width()).on(Name::Solid));
        }
        self.placing = placing(&self.fields);
        self.solids = Some(solids);
        self
    }

    /// Bodies made of particles.
    pub fn solids(&self) -> Option<&OnCloud<D>> {
        self.solids.as_ref()
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
        self.rows_of(Name::Structure).len()
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
        self.loads_of(&|w| self.fluid.wall_force((frame, gas), w), u, (load, chunks));
    }

    /// Sets `load` to the generalised forces of the forces `force` on the walls.
    fn loads_of(
        &self,
        force: &(impl Fn(usize) -> Vector<D> + Sync),
        u: &[f64],
        (load, chunks): (&mut [f64], &mut Vec<f64>),
    ) {
        let before = &self.fluid.discretisation.cloud;
        let placements: Vec<_> = self.bodies.iter().map(|body| body.placement(u)).collect();
        sum_each(before.interface.len(), load, chunks, |walls, load| {
            for (body, placement) in self.bodies.iter().zip(&placements) {
                body.add_loads((before, placement), force, walls.clone(), &mut load[body.range()]);
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

    /// The moment at which rates of bodies made of particles are sought in a frame.
    fn moving<'a>(&self, frame: &'a Frame<D>) -> Moving<'a> {
        Moving { time: frame.gas.time, step: frame.step, jets: &frame.gas.jets, pace: self.pace(frame) }
    }

    /// d/dt of the unknowns of the structures in the state `u` under the walls whose states are in `work`.
    fn structures(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, du: &mut [f64]) {
        let sprung = self.unknowns_of(Name::Structure);
        self.loads(&frame.gas, &u[sprung.clone()], work);
        for body in &self.bodies {
            let load = &work.load[body.range()];
            let own = sprung.start + 2 * body.first..sprung.start + 2 * body.range().end;
            let (u, du) = (&u[own.clone()], &mut du[own]);
            match self.pace(frame) {
                Pace::Held => body.towards_start(u, self.fastest, du),
                Pace::Steady => body.towards_rest(u, load, self.fastest, du),
                Pace::Marching => body.rates(frame.gas.time, u, load, du),
            }
        }
        if let (Some(on), Some(storage)) = (&self.solids, &mut work.solids) {
            on.load(&|w| self.fluid.wall_force((&frame.gas, &work.gas), w), &mut storage.load);
            let at = self.moving(frame);
            let (solid, remembered) = (self.unknowns_of(Name::Solid), self.unknowns_of(Name::History));
            if !remembered.is_empty() {
                storage.history.copy_from_slice(&u[remembered.clone()]);
            }
            du[remembered].fill(0.0);
            du[solid.clone()].fill(0.0);
            on.solids.rates(&at, &u[solid.clone()], storage, &mut du[solid]);
        }
    }
}

/// The unknowns that place frames: coordinates of bodies on springs, and displacements.
fn placing(fields: &[Field]) -> Ranges {
    Ranges::of_fields(fields, &[Name::Structure, Name::Solid])
}

impl<const D: usize> Coupled<D> {
    /// The largest change of a coordinate of structures and solids in its unit; infinite if NaN.
    fn largest_move(&self, du: &[f64]) -> f64 {
        let own = &du[self.unknowns_of(Name::Structure)];
        let units: Vec<f64> = self.bodies.iter().flat_map(|b| b.units.iter().copied()).collect();
        let sprung = largest_size(units.len().min(own.len() / 2), |k| own[2 * k] / units[k]);
        let unit = self.solids.as_ref().map_or(1.0, |s| s.solids.length);
        let solid = &du[self.unknowns_of(Name::Solid)];
        largest_size(solid.len() / 2, |k| solid[2 * k] / unit).max(sprung)
    }
}

impl<const D: usize> System for Coupled<D> {
    type Frame = Frame<D>;
    type Work = Work<D>;

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn placing(&self) -> &Ranges {
        &self.placing
    }

    fn work(&self) -> Work<D> {
        let solids = self.solids.as_ref().map(|s| s.solids.work());
        Work { gas: self.fluid.work(), load: vec![0.0; self.n_coordinates()], chunks: Vec::new(), solids }
    }

    fn frame(&self, at: &Instant<'_>, u: &[f64]) -> Frame<D> {
        let gas = self.fluid.frame(at, &u[self.unknowns_of(Name::Gas)]);
        Frame { gas, steady: matches!(at.rate, Rate::Still), taken: None, step: step_of(&at.rate) }
    }

    fn place(&self, at: &Instant<'_>, frame: &mut Frame<D>) {
        self.fluid.place(at, &mut frame.gas);
        frame.steady = matches!(at.rate, Rate::Still);
        frame.step = step_of(&at.rate);
    }

    fn settle(&self, frame: &Frame<D>, work: &mut Work<D>, u: &mut [f64]) {
        let (own, Some((on, work))) = (self.unknowns_of(Name::History), self.solids.as_ref().zip(work.solids.as_mut()))
        else {
            return;
        };
        if own.is_empty() || self.pace(frame) != Pace::Marching {
            return;
        }
        on.solids.split(&u[self.unknowns_of(Name::Solid)], work);
        work.history.copy_from_slice(&u[own.clone()]);
        on.solids.forces(frame.gas.time, frame.step, work);
        u[own].copy_from_slice(&work.after);
    }

    fn prescribe(&self, time: f64, u: &mut [f64]) {
        if let Some(on) = self.solids.as_ref().filter(|_| !self.held) {
            on.solids.prescribe(time, &mut u[self.unknowns_of(Name::Solid)]);
        }
    }

    fn lead(&self, from: f64, to: f64, u: &mut [f64]) {
        if let Some(on) = &self.solids {
            on.solids.lead(from, to, &mut u[self.unknowns_of(Name::Solid)]);
        }
    }

    fn rhs(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, du: &mut [f64]) {
        let gas = self.unknowns_of(Name::Gas);
        self.fluid.rhs(&frame.gas, &u[gas.clone()], &mut work.gas, &mut du[gas]);
        self.structures(frame, u, work, du);
    }

    fn jvp(&self, frame: &Frame<D>, at: [&[f64]; 2], work: &mut Work<D>, out: &mut [f64]) {
        let gas = self.unknowns_of(Name::Gas);
        self.fluid.jvp(&frame.gas, at.map(|u| &u[gas.clone()]), &mut work.gas, &mut out[gas]);
        self.structures_change(frame, at, work, out);
    }

    fn rates(&self, frame: &Frame<D>, u: &[f64], work: &mut Work<D>, rate: &mut [f64]) {
        let gas = &mut rate[self.rows_of(Name::Gas)];
        self.fluid.rates(&frame.gas, &u[self.unknowns_of(Name::Gas)], &mut work.gas, gas);
        rate[self.rows_of(Name::Structure)].fill(self.fastest);
        if let Some(on) = &self.solids {
            let own = if self.pace(frame) == Pace::Marching { on.solids.brisk } else { on.solids.omega };
            [Name::Solid, Name::History].into_iter().for_each(|name| fill(&mut rate[self.rows_of(name)], own));
        }
    }

    fn largest_change(&self, u: &[f64], du: &[f64]) -> f64 {
        let gas = self.unknowns_of(Name::Gas);
        self.fluid.largest_change(&u[gas.clone()], &du[gas]).max(self.largest_move(du))
    }

    fn contrast(&self, u: &[f64]) -> f64 {
        self.fluid.contrast(&u[self.unknowns_of(Name::Gas)])
    }

    fn shorten(&self, u: &[f64], du: &mut [f64], largest: f64) {
        let gas = self.unknowns_of(Name::Gas);
        self.fluid.shorten(&u[gas.clone()], &mut du[gas.clone()], largest);
        let change = self.largest_move(du);
        if change > largest && change.is_finite() {
            for at in placed(&self.fields).filter(|at| at.field.cloud != Name::Gas) {
                du[at.unknowns].iter_mut().for_each(|du| *du *= largest / change);
            }
        }
    }

    fn check(&self, frame: &Frame<D>, u: &[f64]) -> Result<(), Fault> {
        self.bodies
            .iter()
            .try_for_each(|b| b.check(&u[self.unknowns_of(Name::Structure)], self.rows_of(Name::Structure).start))?;
        if let Some(on) = &self.solids {
            on.solids.check(&u[self.unknowns_of(Name::Solid)], self.rows_of(Name::Solid).start)?;
        }
        self.fluid.check(&frame.gas, &u[self.unknowns_of(Name::Gas)])
    }

    fn check_frame(&self, frame: &Frame<D>) -> Result<(), Fault> {
        self.fluid.check_frame(&frame.gas)
    }

    fn locate(&self, frame: &Frame<D>, row: usize) -> Vec<f64> {
        let Some(at) = placed(&self.fields).find(|at| at.rows.contains(&row)) else { return Vec::new() };
        let particle = row - at.rows.start;
        match (at.field.cloud, &self.solids) {
            (Name::Gas, _) => self.fluid.locate(&frame.gas, particle),
            (Name::Solid, Some(on)) => on.solids.structure.solid.particles.x[particle].0.to_vec(),
            _ => Vec::new(),
        }
    }
}

impl<const D: usize> HasGas<D> for Coupled<D> {
    fn gas(&self) -> &Fluid<D> {
        &self.fluid
    }

    fn set_gas(&mut self, gas: Fluid<D>) {
        let own = self.fields.iter_mut().filter(|field| field.cloud == Name::Gas);
        own.zip(gas.fields()).for_each(|(field, new)| *field = *new);
        self.placing = placing(&self.fields);
        self.fluid = gas;
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
        let remembered = &u[self.unknowns_of(Name::History)];
        let (gas, u, solid) =
            (&u[self.unknowns_of(Name::Gas)], &u[self.unknowns_of(Name::Structure)], &u[self.unknowns_of(Name::Solid)]);
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
            on.load(&|w| view.wall_force(w), &mut work.load);
            on.solids.split(solid, work);
            if !self.unknowns_of(Name::History).is_empty() {
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
        self.fluid.fill_states(&frame.gas, &u[self.unknowns_of(Name::Gas)], &mut work.gas);
        if self.fluid.viscous_model.is_some() {
            self.fluid.fill_gradients(&frame.gas, &mut work.gas);
        }
        self.loads(&frame.gas, &u[self.unknowns_of(Name::Structure)], work);
        work.load.clone()
    }

    fn solid_snapshot(&self, frame: &Frame<D>, u: &[f64]) -> Option<SolidSnapshot<'_, D>> {
        let on = self.solids.as_ref()?;
        let mut work = on.solids.work();
        on.solids.split(&u[self.unknowns_of(Name::Solid)], &mut work);
        if !frame.steady && frame.taken.is_none() {
            on.solids.by_formula(&frame.gas.jets, &mut work);
        }
        let own = self.unknowns_of(Name::History);
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
