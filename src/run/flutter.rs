//! Flutter boundaries: at each Mach number a steady flow, forces of small motions about it, and the speeds at which motions of the
//! structure begin to grow.
//!
//! Forces are computed at a few frequencies and at none, and interpolated by rational functions. Where that finds a crossing, forces are
//! computed at its frequency as well, until the speed of no crossing changes by more than is asked: that change is its error bar. Forces
//! that a former run left serve other structures without any flow; their error bar is the change when the nearest ones are left out.
use std::path::Path;

mod clearance;
mod coarser;
mod damping;
mod files;
mod held;
mod kept;
mod limit_cycles;
mod marched;
mod scales;
mod search;
mod shapes;
mod skin;
mod state_space;
mod stored;
mod tables;
mod trim;
mod wall_motion;

use self::held::Held;
use self::kept::Kept;
use self::limit_cycles::Seek;
use self::scales::Scales;
use self::search::Search;
use self::skin::Skin;
use self::stored::Stored;
use super::cost;
use super::flow::{self, Flow};
use super::folder::{self, Places};
use super::monitor::{Monitor, Quiet, Within};
use super::refusals;
use super::solution::Solution;
use super::time_left::Portion;
use crate::case::{Case, Flutter as Plan, GasResponse, LimitCycles, Matching};
use crate::geometry::dimension;
use crate::physics::atmosphere;
use crate::problem::coarser::{BETWEEN, COARSER, times_the_spacing};
use crate::problem::solids::told_of_own_modes;
use crate::problem::{Problem, RunError, StreamRatio, spacing, supported};
use crate::record::flutter::remedy;
pub use crate::record::flutter::{
    Bars, Boundary, CaseReference, Clearance, Doubt, FlutterAt, FlutterRow, LimitCycle, MarchedCycle, Mark, MotionRow,
    NaturalMode, Share, StateSpaceAt, Trim,
};
use crate::structure::limit_cycle::Borne;

/// Parts by which the gas of a case may differ from the air of the standard atmosphere.
const AIR: f64 = 0.005;

/// Seeks the boundary of the table `[flutter]`, into a fresh folder; `None` when the monitor says stop.
pub fn flutter(case: &Case, places: &Places, monitor: &mut dyn Monitor) -> Result<Option<Boundary>, RunError> {
    let found = sought(case, (&places.input, Some(&places.out)), None, monitor);
    found.map_err(|problem| refusals::with_other_files(case, &places.input, problem))
}

/// The same without a folder, with the forces of a file where one is given.
pub fn in_memory(
    case: &Case,
    input: &Path,
    forces: Option<&Path>,
    monitor: &mut dyn Monitor,
) -> Result<Option<Boundary>, RunError> {
    sought(case, (input, None), forces, monitor)
}

/// The same with the forces of a file, `flutter.json` of a former run or `gaf.json`: the boundary of the structure alone, without a flow.
/// `None` when the monitor says stop.
pub fn again(
    case: &Case,
    places: &Places,
    forces: &Path,
    monitor: &mut dyn Monitor,
) -> Result<Option<Boundary>, RunError> {
    sought(case, (&places.input, Some(&places.out)), Some(forces), monitor)
}

/// True where `out` holds a boundary that was interrupted.
pub fn is_interrupted(out: &Path) -> bool {
    out.join(folder::KEPT).exists()
}

/// Goes on with a boundary that was interrupted: with the Mach numbers that are not finished. `None` when the monitor says stop.
pub fn resume(out: &Path, monitor: &mut dyn Monitor) -> Result<Option<Boundary>, RunError> {
    let (case, input) = folder::read_case(out)?;
    folder::check_input(&case, &input, out)?;
    flutter(&case, &Places { input, out: out.to_path_buf() }, monitor)
}

/// Refuses a boundary of which it is known before any flow that it cannot be sought.
pub(super) fn rehearse(case: &Case, input: &Path) -> Result<(), RunError> {
    let plan = planned(case)?;
    // the structure is the same at all Mach numbers
    let Some(mach) = plan.mach.first() else { return Ok(()) };
    let own = Problem::of_case(case, input)?.about_steady_flow(*mach)?;
    let held = Held::of(&own);
    case.lco.as_ref().map_or(Ok(0), |lco| limit_cycles::coordinate(lco, &held.names))?;
    refusals::rehearse(&own, !plan.trim)
}

/// The table `[flutter]` with all its Mach numbers.
fn planned(case: &Case) -> Result<Plan, RunError> {
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

/// Seeks the boundary of a case whose files lie in `input`, into the folder `out` where one is given.
fn sought(
    case: &Case,
    (input, out): (&Path, Option<&Path>),
    forces: Option<&Path>,
    monitor: &mut dyn Monitor,
) -> Result<Option<Boundary>, RunError> {
    let plan = planned(case)?;
    let problem = &Problem::of_case(case, input)?;
    let case = problem.given();
    told_of_own_modes(case).iter().for_each(|told| monitor.note(told));
    forces.map_or(Ok(()), |_| refused_with_forces(case, &plan))?;
    let stored = forces.map(Stored::read).transpose()?;
    let _held = out.map(|out| folder::create_once(case, input, out)).transpose()?;
    let mut kept = Kept::of(case, input, out)?;
    kept.write(out)?;
    let (mut all, mut drawn) = (Boundary::new(&case.title), None);
    let all_machs = vec![1.0; plan.mach.len()];
    for (k, mach) in plan.mach.clone().into_iter().enumerate() {
        let monitor = &mut Within { outer: Portion::of(k, &all_machs), monitor: &mut *monitor };
        let found = match (&stored, kept.at(mach)) {
            (Some(stored), _) => Some((of_stored(problem, &plan, mach, stored)?, true)),
            (None, Some(before)) => {
                monitor.note(&format!("Mach {mach} was finished before"));
                Some((before, true))
            }
            (None, None) => at_mach(problem, &plan, (mach, case.output.report && out.is_some()), monitor)?,
        };
        let Some((mut found, whole)) = found else { return Ok(None) };
        found.read = forces.map(|f| f.display().to_string());
        found.warnings.iter().for_each(|w| monitor.warn(&format!("Mach {mach}: {w}")));
        found.notes.iter().for_each(|note| monitor.note(&format!("Mach {mach}: {note}")));
        if whole && forces.is_none() && kept.at(mach).is_none() {
            kept.add(&found);
            kept.write(out)?;
        }
        if case.output.report && out.is_some() && drawn.is_none() {
            drawn = Some(skin(problem, mach)?);
        }
        all.lco.append(&mut found.cycles);
        all.flutter.push(found);
        out.map_or(Ok(()), |out| files::write(&all, drawn.as_ref(), out))?;
        if !whole {
            return Ok(None);
        }
    }
    if let Some(out) = out {
        folder::finish(out)?;
        folder::forget_kept(out);
    }
    Ok(Some(all))
}

/// What draws motions of the structures.
fn skin(problem: &Problem, mach: f64) -> Result<Skin, RunError> {
    let own = problem.about_steady_flow(mach)?;
    let held = Held::of(&own);
    let b = Scales::of(own.case(), held.chord, Matching::None).semichord;
    Ok(Skin::of(&own, &held.units(b)))
}

/// What forces that are read do not serve.
fn refused_with_forces(case: &Case, plan: &Plan) -> Result<(), RunError> {
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
        at.steady = [summary.loads.cl, summary.loads.cd, summary.loads.cm];
        at.orders = summary.residual_drop.unwrap_or(0.0);
        (at.particles, at.cpu_seconds) = (summary.particles, summary.cpu_seconds);
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
                Asked::Told(coarse) => others.push((ratio, *coarse)),
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
