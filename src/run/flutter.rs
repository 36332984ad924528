//! Flutter boundaries: at each Mach number a steady flow, forces of small motions about it, and the speeds at which motions of the
//! structure begin to grow.
//!
//! Forces are computed at a few frequencies and at none, and interpolated by rational functions. Where that finds a crossing, forces are
//! computed at its frequency as well, until the speed of no crossing changes by more than is asked: that change is its error bar.
use num_complex::Complex64;

mod record;

pub use record::{Boundary, FlutterAt, FlutterRow, MotionRow};

use super::error::RunError;
use super::folder::{self, Places};
use super::look::reference::chord;
use super::monitor::Monitor;
use super::record::Log;
use super::session::{Outcome, Session};
use super::setup;
use super::solids::with_own_modes;
use super::studies::ForceSource;
use crate::case::{Case, Flutter as Plan};
use crate::geometry::dimension;
use crate::math::rational::Rational;
use crate::structure::Matrices;
use crate::structure::flutter::{Crossing, Flutter, Kind, Point};

/// Misfit of rational functions to the samples.
const MISFIT: f64 = 1e-7;
/// Frequency, over the highest asked for, beyond which motions are not told.
const BEYOND: f64 = 2.0;
/// Frequencies that are nearer to one another than this part are one.
const SAME: f64 = 5e-4;
/// Numbers that turn those of the solver into those of users.
struct Scales {
    /// Half of the reference chord.
    semichord: f64,
    /// Speed of the stream, in sound speeds.
    stream: f64,
    /// Speed of the stream in the units of the case.
    speed: f64,
    /// Solver rate to cycles per unit of time of the case.
    cycles: f64,
    /// V* and V_f of the structure in the case.
    reduced_speed: Option<f64>,
    speed_index: Option<f64>,
}

/// Seeks the boundary of the table `[flutter]`, into a fresh folder; `None` when the monitor says stop.
pub fn flutter(case: &Case, places: &Places, monitor: &mut dyn Monitor) -> Result<Option<Boundary>, RunError> {
    let Some(plan) = case.flutter.clone() else {
        return Err(RunError::Unsupported {
            what: "the case has no table `[flutter]`".into(),
            hint: "add one: `[flutter]` alone seeks the boundary at the Mach number of `[flow]`",
        });
    };
    refused(case)?;
    setup::supported(case)?;
    let case = &with_own_modes(case, &places.input)?;
    let _held = folder::create_once(case, &places.input, &places.out)?;
    let machs = if plan.mach.is_empty() { vec![case.flow.reference().mach] } else { plan.mach.clone() };
    let mut all = Boundary::new(&case.title);
    for mach in machs {
        let Some(found) = at_mach(case, &plan, mach, places, monitor)? else { return Ok(None) };
        all.flutter.push(found);
        all.write(&places.out)?;
    }
    folder::finish(&places.out)?;
    Ok(Some(all))
}

/// What nothing flutters of, or not in one go.
fn refused(case: &Case) -> Result<(), RunError> {
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
            "find their modes first (`[time.modes]` without `[flow]`), and give them as `[[structure.mode]]`",
        ),
        (
            case.flow.velocity.is_some(),
            "the flutter boundary of a stream that is given by `velocity`",
            "give `mach` instead: the speed is what is sought",
        ),
    ];
    match asks.into_iter().find(|a| a.0) {
        Some((_, what, hint)) => {
            Err(RunError::Unsupported { what: format!("this version cannot compute {what}"), hint })
        }
        None => Ok(()),
    }
}

/// The boundary at one Mach number.
fn at_mach(
    case: &Case,
    plan: &Plan,
    mach: f64,
    places: &Places,
    monitor: &mut dyn Monitor,
) -> Result<Option<FlutterAt>, RunError> {
    let own = case.flutter_case(mach);
    let chord = match dimension(case) {
        2 => chord(case, setup::surface::<2>(case, &places.input)?.0.as_ref()),
        _ => chord(case, setup::surface::<3>(case, &places.input)?.0.as_ref()),
    };
    let mut session = Session::open(&own, &places.input)?;
    let mut found = None;
    let mut then = |source: &mut dyn ForceSource, log: &mut Log<'_>| {
        let scales = Scales::of(&own, chord, log);
        found = Some(Search::new(source, &scales, plan).run(log));
        Ok(())
    };
    let outcome = session.solve_then(monitor, Some(&mut then))?;
    let (Outcome::Finished(summary), Some(mut at)) = (outcome, found) else { return Ok(None) };
    at.mach = mach;
    at.steady = [summary.loads.cl, summary.loads.cd, summary.loads.cm];
    at.orders = summary.residual_drop.unwrap_or(0.0);
    (at.particles, at.cpu_seconds) = (summary.particles, summary.cpu_seconds);
    if !summary.succeeded() {
        at.warnings.push("the steady flow did not converge: forces about it are doubtful".into());
    }
    at.warnings.iter().for_each(|w| monitor.warn(&format!("Mach {mach}: {w}")));
    Ok(Some(at))
}

impl Scales {
    fn of(case: &Case, chord: f64, log: &Log<'_>) -> Self {
        let reference = case.flow.reference();
        let structure = &case.structures[0];
        let index = structure.speed_index;
        let root = structure.mass_ratio.map(f64::sqrt);
        let reduced = structure
            .reduced_speed
            .or(structure.reduced_velocity.map(|u| u / std::f64::consts::PI))
            .or(index.zip(root).map(|(v, root)| v * root));
        Self {
            semichord: structure.semichord.map_or(0.5 * chord, |b| b.0),
            stream: reference.mach,
            speed: reference.speed,
            cycles: 1.0 / (log.units.case_time(1.0) * std::f64::consts::TAU),
            reduced_speed: reduced,
            speed_index: index.or(reduced.zip(root).map(|(v, root)| v / root)),
        }
    }

    fn reduced_frequency(&self, kappa: f64) -> f64 {
        kappa * self.semichord / self.stream
    }
}

/// The search at one Mach number.
struct Search<'a> {
    source: &'a mut dyn ForceSource,
    scales: &'a Scales,
    plan: &'a Plan,
    matrices: Matrices,
    samples: Vec<(f64, Vec<Complex64>)>,
    iterations: usize,
    residual: f64,
}

impl<'a> Search<'a> {
    fn new(source: &'a mut dyn ForceSource, scales: &'a Scales, plan: &'a Plan) -> Self {
        let matrices = source.matrices();
        Self { source, scales, plan, matrices, samples: Vec::new(), iterations: 0, residual: 0.0 }
    }

    /// Computes forces at the angular frequency `omega`.
    fn sample(&mut self, omega: f64, log: &mut Log<'_>) {
        let (forces, ended) = self.source.forces(omega);
        let iterations: usize = ended.iter().map(|e| e.iterations).sum();
        let left = ended.iter().map(|e| e.left).fold(0.0, f64::max);
        self.iterations += iterations;
        self.residual = self.residual.max(left);
        log.note(&format!(
            "forces at k = {:.4}: {iterations} linear iterations for {} modes, residual {left:.0e}",
            self.scales.reduced_frequency(omega),
            ended.len()
        ));
        self.samples.push((omega, forces));
        self.samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    fn run(mut self, log: &mut Log<'_>) -> FlutterAt {
        self.sample(0.0, log);
        for k in self.plan.first() {
            self.sample(k * self.scales.stream / self.scales.semichord, log);
        }
        let mut warnings = Vec::new();
        let (mut branches, mut crossings) = self.solved();
        // no change is known of the first ones
        let mut errors = vec![f64::INFINITY; crossings.len()];
        while self.samples.len() < self.plan.frequencies as usize {
            let new = |c: &Crossing| self.samples.iter().all(|(w, _)| (w - c.kappa).abs() > SAME * c.kappa);
            let open = crossings.iter().zip(&errors).filter(|(c, e)| **e > self.plan.accuracy && new(c));
            let Some(worst) = open.max_by(|a, b| a.1.total_cmp(b.1).then(b.0.x.total_cmp(&a.0.x))) else { break };
            let kappa = worst.0.kappa;
            self.sample(kappa, log);
            let before = std::mem::take(&mut crossings);
            (branches, crossings) = self.solved();
            errors = crossings.iter().map(|c| changed(c, &before)).collect();
        }
        for (crossing, error) in crossings.iter().zip(&mut errors) {
            // forces at its own frequency, and no other fit to hold it against
            if !error.is_finite() && crossing.kind == Kind::Divergence {
                *error = self.residual;
            }
            if *error > self.plan.accuracy {
                warnings.push(format!(
                    "the crossing at {:.4} of the speed is known to {:.1} % only: allow more `frequencies`",
                    crossing.x,
                    100.0 * error.min(1.0)
                ));
            }
        }
        self.told(&branches, &crossings, &errors, warnings)
    }

    /// Motions and crossings with the forces known so far.
    fn solved(&self) -> (Vec<Vec<Point>>, Vec<Crossing>) {
        let Some(fit) = Rational::of(&self.samples, MISFIT) else { return (Vec::new(), Vec::new()) };
        let forces = |kappa: f64| fit.at(Complex64::new(0.0, kappa));
        let flutter = Flutter::new(&self.matrices, &forces);
        let mut branches = flutter.branches(self.plan.most);
        let mut crossings = flutter.crossings(&branches, self.plan.most);
        // at the lowest speeds forces hardly act, and would be guessed
        let highest = BEYOND * self.highest();
        branches.iter_mut().for_each(|b| b.retain(|p| p.lambda.im.abs() <= highest * p.x));
        crossings.retain(|c| c.kappa <= highest);
        (branches, crossings)
    }

    /// The highest angular frequency asked for.
    fn highest(&self) -> f64 {
        self.plan.first().last().map_or(0.0, |k| k * self.scales.stream / self.scales.semichord)
    }

    fn told(
        &self,
        branches: &[Vec<Point>],
        crossings: &[Crossing],
        errors: &[f64],
        warnings: Vec<String>,
    ) -> FlutterAt {
        let s = self.scales;
        let last = self.samples.last().map_or(0.0, |x| x.0) * (1.0 + SAME);
        // the frequency of pitch alone: what V* is measured with
        let alone = s.reduced_speed.map(|v| s.stream / (v * s.semichord));
        let row = |(c, error): (&Crossing, &f64)| FlutterRow {
            kind: match c.kind {
                Kind::Flutter => "flutter",
                Kind::Restabilised => "restabilised",
                Kind::Divergence => "divergence",
            },
            mode: c.mode + 1,
            speed_ratio: c.x,
            speed_index: s.speed_index.map(|v| v * c.x),
            reduced_speed: s.reduced_speed.map(|v| v * c.x),
            speed: s.speed * c.x,
            reduced_frequency: s.reduced_frequency(c.kappa),
            frequency: s.cycles * c.frequency,
            frequency_ratio: alone.map(|w| c.frequency / w),
            error: *error,
            extrapolated: c.kappa > last,
        };
        let fastest = branches.iter().flatten().map(|p| p.lambda.norm()).fold(f64::MIN_POSITIVE, f64::max);
        let motion = |(mode, p): (usize, &Point)| MotionRow {
            mode: mode + 1,
            speed_ratio: p.x,
            reduced_frequency: s.reduced_frequency(p.lambda.im.abs() / p.x),
            damping: 2.0 * p.lambda.re / p.lambda.norm(),
            frequency: s.cycles * p.lambda.im.abs(),
            eigenvalue: [p.lambda.re / fastest, p.lambda.im / fastest],
        };
        FlutterAt {
            mach: s.stream,
            crossings: crossings.iter().zip(errors).map(row).collect(),
            motions: branches.iter().enumerate().flat_map(|(m, b)| b.iter().map(move |p| (m, p))).map(motion).collect(),
            reduced_frequencies: self.samples.iter().map(|x| s.reduced_frequency(x.0)).collect(),
            forces: self.samples.iter().map(|x| x.1.iter().map(|z| [z.re, z.im]).collect()).collect(),
            coordinates: self.source.names(),
            steady: [0.0; 3],
            orders: 0.0,
            particles: 0,
            linear_iterations: self.iterations,
            residual: self.residual,
            cpu_seconds: 0.0,
            warnings,
        }
    }
}

/// Relative change of the speed of a crossing since the interpolation before; infinite where that had none like it.
fn changed(crossing: &Crossing, before: &[Crossing]) -> f64 {
    let like = before.iter().filter(|b| b.kind == crossing.kind && b.mode == crossing.mode);
    like.map(|b| (b.x - crossing.x).abs() / crossing.x).fold(f64::INFINITY, f64::min)
}
