//! What a run has found when it is over: loads, ledgers, errors, the wall.
use super::look::friction::{chordwise, friction_load, separations, wall_friction};
use super::look::{WallSnapshot, hinge_moments, pressure_load, tip_vortex, totals};
use super::record::family;
use super::record::work::Clock;
use super::record::{Log, Record};
use crate::case::{Case, Initial};
use crate::claims::truth::FieldTruth;
use crate::geometry::Surface;
use crate::math::{Bounds, Vector};
use crate::observe::convergence::Convergence;
use crate::observe::induced::SpanLoad;
use crate::observe::loads::{Balance, Coefficients, Load, LoadAxes, together};
use crate::observe::strips::{RootLoads, Strips};
use crate::observe::usage::peak_bytes;
use crate::physics::n_variables;
use crate::problem::numerics;
use crate::record::summary::{
    Conditions, Cost, FILES, FreeStream, GridConvergence, Ledger, Loads, Periodic, Progress, Reclouding,
    ReferenceValues, Separation, Structures, Summary, WakePlane,
};
use crate::scheme::{Fluid, View};
use crate::system::System;

/// The flow at the end, seen in the axes of the case.
pub(crate) struct Found<'a, const D: usize> {
    /// The case.
    pub(crate) case: &'a Case,
    /// The gas with its gradients.
    pub(crate) view: View<'a, D>,
    /// Bodies.
    pub(crate) surface: Option<&'a Surface<D>>,
    /// Axes of the loads.
    pub(crate) axes: LoadAxes,
    /// Names of bodies and tags.
    pub(crate) names: Names,
    /// What passes a zone around the bodies.
    pub(crate) balance: Option<Balance>,
    /// Loads along the span of bodies in space.
    pub(crate) strips: Vec<Strips>,
    /// Induced drag of that.
    pub(crate) span_load: Option<SpanLoad>,
    /// Lift and drag from planes behind them.
    pub(crate) wake: Vec<WakePlane>,
}

/// Names of bodies and tags.
pub(crate) struct Names {
    /// Of bodies.
    pub(crate) bodies: Vec<String>,
    /// Of their parts.
    pub(crate) tags: Vec<String>,
}

impl Names {
    /// Those of a surface.
    pub(crate) fn of<const D: usize>(surface: Option<&Surface<D>>) -> Self {
        surface.map_or(Self { bodies: Vec::new(), tags: Vec::new() }, |s| Self {
            bodies: s.bodies.clone(),
            tags: s.tags.clone(),
        })
    }
}

/// Wall seconds of a run.
pub(crate) struct Spent<'a> {
    /// Since it began.
    pub(crate) clock: &'a Clock,
    /// Until it was solved.
    pub(crate) solved: f64,
}

impl Spent<'_> {
    fn phases(&self) -> Vec<(String, f64)> {
        let files = self.clock.wall_seconds() - self.solved;
        vec![("solve".into(), self.solved), (FILES.into(), files)]
    }
}

/// Bytes of a solver, its state and its integrator.
pub(crate) fn bytes_of<const D: usize>(fluid: &Fluid<D>, integrator: usize) -> usize {
    let cloud = &fluid.discretisation.cloud;
    let rows = cloud.neighbours.index.len() * 4 + cloud.neighbours.first.len() * 4;
    let points = cloud.len() * (8 * D + 8 + 8) + cloud.n_fluid * 8;
    let states = cloud.len() * (8 * n_variables(D) + 8 * D * n_variables(D)) + 2 * 8 * fluid.len();
    rows + points + states + fluid.discretisation.operators.bytes() + fluid.discretisation.walls.bytes() + integrator
}

fn last_change(cycles: &[[f64; 5]]) -> Option<Coefficients> {
    let [.., a, b] = cycles else { return None };
    Some(Coefficients { cl: b[2] - a[2], cd: b[3] - a[3], cm: b[4] - a[4] })
}

/// Relative change of the totals of a march; `None` where they were not known when it began.
fn drift<const D: usize>(view: &View<'_, D>, state: &[f64], start: &[f64]) -> Option<Ledger> {
    let end = totals(&view.volumes(), state, n_variables(D));
    if start.len() != end.len() {
        return None;
    }
    let relative = |c: usize| (end[c] - start[c]) / start[c].abs().max(f64::MIN_POSITIVE);
    let momentum = (1..=D).map(|c| (end[c] - start[c]).abs()).fold(0.0, f64::max) / start[0];
    Some(Ledger { mass: relative(0), momentum, energy: relative(D + 1) })
}

/// What re-clouding did, where particles travel with the fluid.
fn reclouding<const D: usize>(record: &Record) -> Option<Reclouding> {
    let t = &record.ledger;
    if t.renewals == 0 {
        return None;
    }
    let start = &record.start_totals;
    let over = |c: usize, scale: usize| t.lost[c] / start[scale].abs().max(f64::MIN_POSITIVE);
    let momentum = (1..=D).map(|c| over(c, 0).powi(2)).sum::<f64>().sqrt();
    Some(Reclouding {
        renewals: t.renewals,
        inserted: t.inserted,
        removed: t.removed,
        first_order: t.first_order,
        transfer: Ledger { mass: over(0, 0), momentum, energy: over(D + 1, D + 1) },
    })
}

/// Loads of a motion that repeats.
fn periodic(log: &Log<'_>) -> Periodic {
    let record = &log.record;
    Periodic {
        harmonic_balance: record.balance.clone(),
        generalised_forces: record.forces.clone(),
        periodic_change: log.case_period().and_then(|p| record.trace.change(p)),
        first_harmonics: log.case_period().map_or_else(Vec::new, |p| record.trace.first_harmonics(p)),
        momentum_of_period: log.case_period().and_then(|p| record.moments.last(p)),
        last_period: log.case_period().and_then(|p| record.trace.last_period(p)),
        periodic_loads: log.case_period().and_then(|p| record.trace.periodic_loads(p)),
        lift_cycles: record.trace.cycles(),
    }
}

impl<const D: usize> Found<'_, D> {
    /// The last line of the run; `state` is that of the solver.
    pub(crate) fn summary(&self, log: &Log<'_>, state: &[f64], spent: &Spent<'_>) -> Summary {
        let (case, record) = (self.case, &log.record);
        let marches = case.is_unsteady() && record.balance.is_none();
        let family = family::found(case, record);
        Summary {
            conditions: self.conditions(log),
            convergence: self.progress(log, state, marches),
            loads: self.loads(),
            grid: GridConvergence {
                loads_error: family.as_ref().map(Convergence::half_widths),
                grid_convergence: family,
                supersonic: self.is_supersonic(),
            },
            // further runs tell them
            error_bars: None,
            polar: record.polar.points.clone(),
            periodic: periodic(log),
            structures: Structures {
                structure: log.structure_summaries(),
                swings: case.swing().map_or_else(Vec::new, |period| log.swings(period.0)),
                solid: None,
            },
            cost: self.cost(log, spent),
        }
    }

    fn conditions(&self, log: &Log<'_>) -> Conditions {
        let (case, record) = (self.case, &log.record);
        Conditions {
            case: case.title.clone(),
            run: log.keeper.as_ref().map_or_else(String::new, |keeper| keeper.name()),
            mach: case.flow.reference().mach,
            alpha_deg: case.flow.alpha.degrees(),
            reynolds: case.flow.reynolds_number(self.axes.chord),
            free_stream: FreeStream::of(&case.flow.reference(), case.flow.gamma),
            chord: self.axes.chord,
            reference: self.surface.map(|_| ReferenceValues::of::<D>(case, &self.axes)),
            cloud: case.cloud.clone(),
            loads_at: case.is_unsteady().then_some(record.time),
        }
    }

    fn progress(&self, log: &Log<'_>, state: &[f64], marches: bool) -> Progress {
        let record = &log.record;
        Progress {
            particles: self.particles(),
            iterations: record.iteration,
            residual_drop: (!marches && !record.began_steady).then(|| -record.drop.log10()),
            converged: record.goal_reached(marches),
            time: record.time,
            linear_iterations: record.linear,
            unconverged_steps: record.unconverged,
            halved_steps: record.halved,
            ledger: self.ledger(log, state, marches),
            re_clouding: reclouding::<D>(record),
            adapt_change: last_change(&record.cycles),
            error_l2_density: self.exact_error(log.units.solver_time(record.time)),
            warnings: Vec::new(),
        }
    }

    /// Particles, images left out.
    fn particles(&self) -> usize {
        self.view.fluid.discretisation.cloud.n_real()
    }

    /// What was lost; `None` for a harmonic balance.
    fn ledger(&self, log: &Log<'_>, state: &[f64], marches: bool) -> Option<Ledger> {
        match numerics::balance(self.case) {
            Some(_) => None,
            None if marches => drift(&self.view, state, &log.record.start_totals),
            None => {
                let (balance, (pressure, friction)) = (self.balance.unwrap_or_default(), self.wall_loads(|_| true));
                let wall = self.axes.coefficients(&together(&pressure, &friction));
                Some(self.steady_ledger(&balance, &wall, &self.axes.coefficients(&balance.load)))
            }
        }
    }

    fn loads(&self) -> Loads {
        let (case, fluid) = (self.case, self.view.fluid);
        let (pressure, friction) = self.wall_loads(|_| true);
        let total = self.axes.coefficients(&together(&pressure, &friction));
        let part = |load: &Load| fluid.viscous_model.as_ref().map(|_| self.axes.coefficients(load));
        Loads {
            total,
            pressure: part(&pressure),
            friction: part(&friction),
            momentum_balance: self.balance.map(|balance| self.axes.coefficients(&balance.load)),
            separation: self.separations(),
            tip_vortex: tip_vortex(case, &self.view, self.surface, [self.axes.chord, total.cl]),
            root_loads: self.root_loads(),
            hinge_moments: hinge_moments(case, &self.view, &self.names.bodies),
            span_load: self.span_load.clone(),
            wake_planes: self.wake.clone(),
        }
    }

    fn cost(&self, log: &Log<'_>, spent: &Spent<'_>) -> Cost {
        let (fluid, record, n) = (self.view.fluid, &log.record, self.particles());
        let [cpu, wall] = log.seconds();
        Cost {
            cpu_seconds: cpu,
            wall_seconds: wall,
            peak_bytes: peak_bytes(),
            work_units: record.work.total as f64 / self.view.cloud().n_fluid as f64,
            bytes_per_particle: bytes_of(fluid, record.bytes) as f64 / n as f64,
            cpu_ms_per_particle: 1e3 * cpu / n as f64,
            phases: spent.phases(),
        }
    }

    /// True where the gas is faster than sound somewhere.
    fn is_supersonic(&self) -> bool {
        let faster = |i: usize| {
            let q = self.view.state(i);
            q.velocity.norm() > self.view.fluid.gas.sound_speed(&q)
        };
        (0..self.view.cloud().n_fluid).any(faster)
    }

    /// What acts at the roots of wings and fins.
    fn root_loads(&self) -> Vec<RootLoads> {
        let pressure = self.case.flow.units().pressure();
        self.strips.iter().filter(|s| s.lifting).flat_map(|s| s.roots(&self.axes, pressure)).collect()
    }

    /// The flow on the walls.
    pub(crate) fn walls(&self) -> WallSnapshot {
        let names = [self.names.bodies.clone(), self.names.tags.clone()];
        WallSnapshot::of(self.case, &self.view, self.chordwise(), names)
    }

    /// Loads of pressure and friction on the interface particles chosen.
    pub(crate) fn wall_loads(&self, chosen: impl Fn(usize) -> bool + Sync) -> (Load, Load) {
        (pressure_load(&self.view, &self.axes, &chosen), friction_load(&self.view, &self.axes, &chosen))
    }

    /// Distances of the interface particles from the nose, over the extent of the bodies.
    pub(crate) fn chordwise(&self) -> Vec<f64> {
        let bounds = self.surface.map_or(Bounds { min: Vector::ZERO, max: Vector::splat(1.0) }, Surface::bounds);
        chordwise(&self.view, &bounds)
    }

    fn separations(&self) -> Vec<Separation> {
        let friction = wall_friction(self.case, &self.view);
        friction.map_or_else(Vec::new, |f| separations(self.case, &self.view, &f, &self.chordwise()))
    }

    fn steady_ledger(&self, balance: &Balance, wall: &Coefficients, through: &Coefficients) -> Ledger {
        // half of what passes comes in
        let over = |net: f64, passed: f64| if passed > 0.0 { 2.0 * net / passed } else { 0.0 };
        Ledger {
            mass: over(balance.mass, balance.passed[0]),
            momentum: (wall.cl - through.cl).hypot(wall.cd - through.cd),
            energy: over(balance.energy, balance.passed[1]),
        }
    }

    /// Error of the density against the exact solution that the case starts from, when it has one, at a `time` of the solver.
    fn exact_error(&self, time: f64) -> Option<f64> {
        if matches!(self.case.initial, Initial::FreeStream) || !self.case.bodies.is_empty() {
            return None;
        }
        let cloud = self.view.cloud();
        let extent = cloud.tree.bounds().extent();
        let period = Some(Vector([extent[0], extent[1]]));
        let truth =
            FieldTruth::new(&self.case.initial.in_solver_units(&self.case.flow.units()), self.case.flow.gamma, period)
                .ok()??;
        let (mut sum, mut volume) = (0.0, 0.0);
        let volumes = self.view.volumes();
        for i in 0..cloud.n_fluid {
            let x = self.view.place(i);
            let exact = truth.state(&Vector([x[0], x[1]]), time).ok()?;
            let error = self.view.state(i).density - exact.density;
            sum += volumes[i] * error * error;
            volume += volumes[i];
        }
        Some((sum / volume).sqrt())
    }
}
