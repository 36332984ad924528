//! Flutter boundaries: at each Mach number a steady flow, forces of small motions about it, and the speeds at which motions of the
//! structure begin to grow.
//!
//! Forces are computed at a few frequencies and at none, and interpolated by rational functions. Where that finds a crossing, forces are
//! computed at its frequency as well, until the speed of no crossing changes by more than is asked: that change is its error bar. Forces
//! that a former run left serve other structures without any flow; their error bar is the change when the nearest ones are left out.
mod clearance;
mod coarser;
mod damping;
mod held;
mod limit_cycles;
pub(crate) mod marched;
mod scales;
mod search;
mod shapes;
mod skin;
mod state_space;
mod stored;
mod trim;
mod wall_motion;

pub(crate) use self::held::Held;
#[cfg(test)]
pub(crate) use self::held::problem_of;
use self::limit_cycles::Seek;
pub(crate) use self::limit_cycles::coordinate;
pub(crate) use self::scales::Scales;
use self::search::Search;
pub(crate) use self::skin::{Moving, Skin};
pub(crate) use self::stored::{Stored, unreadable};
use super::cost;
use super::flow::{self, Flow};
use super::monitor::{Monitor, Quiet, Within};
use super::solution::Solution;
use super::time_left::Portion;
use crate::case::{Case, Flutter as Plan, GasResponse, LimitCycles, Matching};
use crate::geometry::dimension;
use crate::physics::atmosphere;
use crate::problem::coarser::{BETWEEN, COARSER, refinement, times_the_spacing};
use crate::problem::{Problem, RunError, StreamRatio, spacing, supported};
use crate::record::flutter::remedy;
use crate::record::flutter::{Boundary, FlutterAt};
use crate::structure::limit_cycle::Borne;

/// Parts by which the gas of a case may differ from the air of the standard atmosphere.
const AIR: f64 = 0.005;

/// The table `[flutter]` with all its Mach numbers.
pub(crate) fn planned(case: &Case) -> Result<Plan, RunError> {
    let Some(mut plan) = case.flutter.clone() else {
        return Err(RunError::Unsupported {
            what: "the case has no table `[flutter]`".into(),
            hint: "add one: `[flutter]` alone seeks the boundary at the Mach number of `[flow]`",
        });
    };
    if plan.mach.is_empty() {
        plan.mach = vec![case.flow.reference().mach];
    }
    let cycles = case.lco.as_ref().map(|lco| lco.mach.unwrap_or(case.flow.reference().mach));
    plan.mach.extend(cycles.filter(|mach| !plan.mach.contains(mach)));
    refused(case, &plan)?;
    supported(case)?;
    Ok(plan)
}

/// Keeps a boundary Mach number by Mach number.
pub(crate) trait BoundaryKeeper {
    /// What was finished before at a Mach number.
    fn known(&self, mach: f64) -> Option<FlutterAt>;
    /// Keeps what is finished at a Mach number.
    fn keep(&mut self, at: &FlutterAt) -> Result<(), RunError>;
    /// Keeps the boundary so far.
    fn so_far(&mut self, boundary: &Boundary) -> Result<(), RunError>;
    /// True where motions of the walls are drawn.
    fn draws(&self) -> bool;
}

/// Keeps a boundary in memory alone.
pub(crate) struct InMemory;

impl BoundaryKeeper for InMemory {
    fn known(&self, _: f64) -> Option<FlutterAt> {
        None
    }
    fn keep(&mut self, _: &FlutterAt) -> Result<(), RunError> {
        Ok(())
    }
    fn so_far(&mut self, _: &Boundary) -> Result<(), RunError> {
        Ok(())
    }
    fn draws(&self) -> bool {
        false
    }
}

/// The boundary of a problem that asks for one, with the forces of a file in place of a flow where one is given; `None` when the monitor says
/// stop.
pub(crate) fn boundary(
    problem: &Problem,
    (plan, stored): (&Plan, Option<&Stored>),
    keeper: &mut dyn BoundaryKeeper,
    monitor: &mut dyn Monitor,
) -> Result<Option<Boundary>, RunError> {
    let mut all = Boundary::new(&problem.given().title);
    let all_machs = vec![1.0; plan.mach.len()];
    for (k, &mach) in plan.mach.iter().enumerate() {
        let monitor = &mut Within { outer: Portion::of(k, &all_machs), monitor: &mut *monitor };
        let known = keeper.known(mach).filter(|_| stored.is_none());
        let new = known.is_none() && stored.is_none();
        let found = match (stored, known) {
            (Some(stored), _) => Some((of_stored(problem, plan, mach, stored)?, true)),
            (None, Some(before)) => {
                monitor.note(&format!("Mach {mach} was finished before"));
                Some((before, true))
            }
            (None, None) => at_mach(problem, plan, (mach, keeper.draws()), monitor)?,
        };
        let Some((mut found, whole)) = found else { return Ok(None) };
        found.read = stored.map(|stored| stored.file().to_owned());
        found.warnings.iter().for_each(|w| monitor.warn(&format!("Mach {mach}: {w}")));
        found.notes.iter().for_each(|note| monitor.note(&format!("Mach {mach}: {note}")));
        if whole && new {
            keeper.keep(&found)?;
        }
        all.lco.append(&mut found.cycles);
        all.flutter.push(found);
        keeper.so_far(&all)?;
        if !whole {
            return Ok(None);
        }
    }
    Ok(Some(all))
}

/// What forces that are read do not serve.
pub(crate) fn refused_with_forces(case: &Case, plan: &Plan) -> Result<(), RunError> {
    if plan.trim {
        return Err(RunError::Unsupported {
            what: "this version cannot compute the static equilibrium with forces that are read".into(),
            hint: "leave `trim` out: forces are those of the run that wrote them, about its steady flow",
        });
    }
    if case.lco.as_ref().is_some_and(|lco| lco.march) {
        let what = "`lco.march` asks for a march of gas and structure, but forces that are read come without a gas";
        return Err(RunError::Unsupported { what: what.into(), hint: "leave out `march`, or `--forces`" });
    }
    Ok(())
}

/// What nothing flutters of, or not in one go.
fn refused(case: &Case, plan: &Plan) -> Result<(), RunError> {
    let (matching, machs, flow) = (plan.matching, plan.mach.len(), &case.flow);
    let off = |a: f64, b: f64| (a / b - 1.0).abs() > AIR;
    let air = !off(flow.gamma, atmosphere::GAMMA) && !off(flow.gas_constant, atmosphere::GAS_CONSTANT);
    let asks = [
        (case.structures.is_empty(), "flutter without a `[structure]`", "add one: its coordinates are the modes"),
        (
            case.polar.is_some(),
            "the flutter boundary of a polar",
            "give one angle and one Mach number in `[flow]`, others in `[flutter]`",
        ),
        (
            case.solids().next().is_some(),
            "the flutter of bodies made of particles beside a gas",
            "add `[structure]` with `model = \"own_modes\"` and `number = 4`: its natural modes then move it",
        ),
        (
            case.lco.is_some() && case.structures.iter().any(|s| s.large_angles),
            "limit cycles of a section whose inertia is that of a rigid body at any angle",
            "leave out `large_angles`",
        ),
        (
            case.flow.velocity.is_some(),
            "the flutter boundary of a stream that is given by `velocity`",
            "give `mach` instead: the speed is what is sought",
        ),
        (
            matching == Matching::Altitude && !flow.is_dimensional(),
            "flutter in the standard atmosphere for a stream without units",
            "give two of `pressure`, `temperature` and `density` in `[flow]`, and masses and frequencies with units",
        ),
        (
            matching == Matching::Altitude && !air,
            "flutter in the standard atmosphere in another gas than air",
            "leave out `gamma` and `gas_constant`, or use `match = \"none\"` or `\"density\"`",
        ),
        (
            plan.design_speed.is_some() && !flow.is_dimensional(),
            "margins against a design speed in a stream without units",
            "give two of `pressure`, `temperature` and `density` in `[flow]`, or leave `design_speed` out",
        ),
        (
            goes_with_speed(case) && (matching == Matching::Altitude || (matching == Matching::Density && machs > 1)),
            "matched speeds of a structure whose frequencies go with the speed of the stream",
            "give `frequency` or `stiffness` instead of `speed_index`, `reduced_speed`, `reduced_velocity` or `reduced_frequency`",
        ),
    ];
    match asks.into_iter().find(|a| a.0) {
        Some((_, what, hint)) => {
            Err(RunError::Unsupported { what: format!("this version cannot compute {what}"), hint })
        }
        None => Ok(()),
    }
}

/// True where the structure becomes stiffer with the speed of the stream, so that each Mach number has another one.
fn goes_with_speed(case: &Case) -> bool {
    case.structures.iter().any(|s| {
        let numbers = [s.speed_index, s.reduced_speed, s.reduced_velocity];
        numbers.iter().any(Option::is_some) || s.modes.iter().any(|m| m.reduced_frequency.is_some())
    })
}

/// The boundary at one Mach number, with the motions of the walls where they are `drawn`, and false where the monitor said stop in the
/// march after it; `None` where it did before.
fn at_mach(
    root: &Problem,
    plan: &Plan,
    (mach, drawn): (f64, bool),
    monitor: &mut dyn Monitor,
) -> Result<Option<(FlutterAt, bool)>, RunError> {
    let own = root.about_steady_flow(mach)?;
    let held = Held::of(&own);
    let scales = Scales::of(own.case(), held.chord, plan.matching);
    let lco = cycles_at(root.given(), mach);
    let place = Place { problem: &own, held: &held, scales: &scales, plan, lco, drawn };
    let marches = lco.is_some_and(|lco| lco.march);
    let part = |k: usize, shocks: bool| Portion::of(k, &place.parts(shocks, marches));
    let first = &mut Within { outer: part(0, false), monitor: &mut *monitor };
    let at = match plan.trim {
        true => {
            let boundary =
                |stream: StreamRatio, last: bool, monitor: &mut dyn Monitor| place.boundary((stream, last), monitor);
            trim::trimmed(&scales, (plan, lco.is_some()), &boundary, first)?
        }
        false => place.boundary((StreamRatio::SAME, true), first)?,
    };
    let Some(mut at) = at else { return Ok(None) };
    if plan.cloud_error && !place.against_coarser(&mut at, &part, monitor)? {
        return Ok(None);
    }
    let outer = part(3, at.supersonic);
    let mut at = placed(at, (own.case(), mach), held, (&scales, plan));
    let whole = !marches || at.cycles.is_empty() || marched::march(root, &mut at, &mut Within { outer, monitor })?;
    if !whole {
        at.warn(("told to stop while the limit cycle was marched: all else is whole".into(), remedy::CYCLES));
    }
    Ok(Some((at, whole)))
}

/// What a coarser cloud says.
enum Asked {
    /// The monitor said stop.
    Stopped,
    /// The boundary on it.
    Told(Box<FlutterAt>),
    /// Nothing: it does not fit into the domain, or cannot be computed on.
    Silent,
}

/// What is sought at a Mach number, and of what.
struct Place<'a> {
    /// The steady flow at that Mach number.
    problem: &'a Problem,
    held: &'a Held,
    scales: &'a Scales,
    plan: &'a Plan,
    lco: Option<&'a LimitCycles>,
    /// True where motions of the walls are drawn, which are cut out of the cloud for that.
    drawn: bool,
}

impl Place<'_> {
    /// Work on the cloud of the case, on coarser ones, two of them where there are `shocks`, and in the march of a limit cycle, beside one
    /// another.
    fn parts(&self, shocks: bool, marches: bool) -> [f64; 4] {
        let asked = |ratio: f64, asked: bool| match asked && self.plan.cloud_error {
            true => spacing::alike(ratio, dimension(self.problem.case()).into()),
            false => 0.0,
        };
        [1.0, asked(COARSER, true), asked(BETWEEN, shocks), f64::from(u8::from(marches))]
    }

    /// The boundary with the forces about the steady flow in a stream of the same Mach number, and with the limit cycles.
    fn boundary(
        &self,
        (stream, cycles): (StreamRatio, bool),
        monitor: &mut dyn Monitor,
    ) -> Result<Option<FlutterAt>, RunError> {
        let problem = self.problem.in_stream(stream)?;
        let columns = self.held.names.len() * self.plan.expected();
        let share = cost::share_of_steady(dimension(problem.case()).into(), columns);
        let Some(mut flow) = flow::steady(&problem, share, monitor)? else { return Ok(None) };
        let Some(mut at) = self.about(&mut *flow, (stream, cycles))? else { return Ok(None) };
        let Ok(Solution { summary, .. }) = flow.conclude(None)? else { return Ok(None) };
        at.steady = [summary.loads.total.cl, summary.loads.total.cd, summary.loads.total.cm];
        at.orders = summary.convergence.residual_drop.unwrap_or(0.0);
        (at.particles, at.cpu_seconds) = (summary.convergence.particles, summary.cost.cpu_seconds);
        if !summary.succeeded() {
            at.warn(("the steady flow did not converge: forces about it are doubtful".into(), remedy::STEADY));
        }
        Ok(Some(at))
    }

    /// The same about a steady flow that is known.
    fn about(
        &self,
        flow: &mut dyn Flow<'_>,
        (stream, cycles): (StreamRatio, bool),
    ) -> Result<Option<FlutterAt>, RunError> {
        let (mut forces, log) = flow.forces()?;
        let forces = &mut *forces;
        let mut search = Search::new(self.held, self.scales, self.plan, Vec::new(), 0.0);
        let Some(mut at) = search.run((&mut *forces, stream), log) else { return Ok(None) };
        if self.drawn {
            search.show(&mut at, forces);
        }
        (at.borne, at.supersonic) = (forces.borne(), forces.is_supersonic());
        if let Some(lco) = self.lco.filter(|_| cycles) {
            let springs = search::springs_of_the_case(forces.springs(), stream);
            let borne = self.plan.trim.then(|| Borne { forces: at.borne.clone(), pressure: stream.pressure });
            at.add_cycles(Seek::new(lco, &mut search, (springs, borne))?.run(Some((&mut *forces, &mut *log))));
            if log.stopped() {
                return Ok(None);
            }
        }
        Ok(Some(at))
    }

    /// Holds crossings and damping against those of coarser clouds in the same stream, where there are such; false when the monitor says
    /// stop.
    fn against_coarser(
        &self,
        at: &mut FlutterAt,
        part: &dyn Fn(usize, bool) -> Portion,
        monitor: &mut dyn Monitor,
    ) -> Result<bool, RunError> {
        let mut others = Vec::new();
        for ratio in [COARSER, BETWEEN] {
            let shocks = at.supersonic || others.iter().any(|(_, coarse): &(f64, FlutterAt)| coarse.supersonic);
            if ratio != COARSER && !shocks {
                break;
            }
            let outer = part(if ratio == COARSER { 1 } else { 2 }, shocks);
            match self.on_coarser(at, ratio, &mut Within { outer, monitor: &mut *monitor })? {
                Asked::Stopped => return Ok(false),
                Asked::Told(coarse) => others.push((refinement(&self.problem.given().cloud, ratio), *coarse)),
                Asked::Silent => {}
            }
        }
        at.cpu_seconds += others.iter().map(|(_, coarse)| coarse.cpu_seconds).sum::<f64>();
        coarser::compare(at, &others, self.scales);
        Ok(true)
    }

    /// The boundary in the stream of `at` on a cloud with `ratio` times the spacing.
    fn on_coarser(&self, at: &FlutterAt, ratio: f64, monitor: &mut dyn Monitor) -> Result<Asked, RunError> {
        let silent = |why: RunError, monitor: &mut dyn Monitor| {
            monitor.note(&format!("the coarser cloud tells nothing: {why}"));
            Ok(Asked::Silent)
        };
        let own = match self.problem.on_spacing(ratio) {
            Ok(Some(own)) => own,
            Ok(None) => return Ok(Asked::Silent),
            Err(why) => return silent(why, monitor),
        };
        let stream = at.trim.as_ref().map_or(StreamRatio::SAME, |trim| StreamRatio {
            pressure: trim.dynamic_pressure / self.scales.reference.dynamic_pressure(),
            temperature: trim.speed_ratio * trim.speed_ratio,
        });
        monitor.note(&format!("the same on a cloud with {}", times_the_spacing(ratio)));
        let plan = Plan { state_space: false, ..self.plan.clone() };
        let place = Place { problem: &own, plan: &plan, drawn: false, ..*self };
        // what that cloud is too coarse for is told by the difference
        match place.boundary((stream, false), &mut Quiet { monitor }) {
            Ok(Some(coarse)) => Ok(Asked::Told(Box::new(coarse))),
            Ok(None) => Ok(Asked::Stopped),
            // a cloud that is too coarse for the body tells nothing of the one that is not
            Err(why) => silent(why, monitor),
        }
    }
}

/// The same from forces that are known.
fn of_stored(root: &Problem, plan: &Plan, mach: f64, stored: &Stored) -> Result<FlutterAt, RunError> {
    let own = root.about_steady_flow(mach)?;
    let (held, case) = (Held::of(&own), root.given());
    let own = own.case();
    let scales = Scales::of(own, held.chord, plan.matching);
    let samples = stored.samples(mach, own.flow.alpha.0.to_degrees(), &held)?;
    let mut search = Search::new(&held, &scales, plan, samples.all, samples.residual);
    let mut at = search.again();
    if let Some(lco) = cycles_at(case, mach) {
        at.add_cycles(Seek::new(lco, &mut search, (held.springs.clone(), None))?.run(None));
        if lco.gas == GasResponse::Nonlinear && !at.cycles.is_empty() {
            let what = "forces that are read are those of small motions: so are the limit cycles (`gas = \"linear\"`)";
            at.warn((what.into(), remedy::CYCLES));
        }
    }
    Ok(placed(at, (own, mach), held, (&scales, plan)))
}

/// The limit cycles that are sought at a Mach number of a case.
fn cycles_at(case: &Case, mach: f64) -> Option<&LimitCycles> {
    case.lco.as_ref().filter(|lco| lco.mach.unwrap_or(case.flow.reference().mach) == mach)
}

/// With error bars, margins, and what tells whether its forces serve another case.
fn placed(mut at: FlutterAt, (own, mach): (&Case, f64), held: Held, (scales, plan): (&Scales, &Plan)) -> FlutterAt {
    let reference = at.reference.dynamic_pressure;
    let curves = damping::curves(&at.motions, reference);
    for c in &mut at.crossings {
        let pressure = c.dynamic_pressure / reference;
        c.bars = scales.bars(pressure, c.bar());
        let curve = curves.iter().find(|curve| curve.branch == c.branch).filter(|_| c.kind == "flutter");
        if let Some(growth) = curve.and_then(|curve| curve.growth(pressure.sqrt())) {
            (c.growth, c.holding_damping) = (Some(growth.most), growth.holding);
        }
        c.remarks = c.told();
    }
    if let Some(design) = plan.design_speed {
        clearance::tell(&mut at, design.0, (scales, scales.upto(plan.most)));
    }
    FlutterAt { mach, chord: held.chord, moved: held.marks, alpha_deg: own.flow.alpha.0.to_degrees(), ..at }
}
