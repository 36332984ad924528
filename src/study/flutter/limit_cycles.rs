//! Limit cycles at one Mach number: amplitude by amplitude along every branch.
//!
//! What the gas does beyond small motions comes from harmonic balances with the motion found so far; the structure is then solved again with
//! it, until speed and frequency stand still (defect correction). The next amplitude begins with the last two points, and with what the gas
//! did beyond small motions, which grows with the cube of the amplitude. Harmonics are added until two more do not change the speed.
//!
//! A point is stable where the motion decays when it is larger than it, and grows when it is smaller: at the speed of a cycle motions of other
//! amplitudes change as fast as that speed is off theirs. With growth beyond a speed of flutter, the branch is stable where its speed rises
//! with the amplitude; the other way round where motions cease to grow. So it is with densities and pressures where these are varied.
use num_complex::Complex64;

use super::super::record::Log;
use super::super::studies::ForceSource;
use super::search::Search;
use crate::case::{GasResponse, LimitCycles};
use crate::observe::structure::is_angle;
use crate::problem::RunError;
use crate::record::flutter::{LimitCycle, Warning, remedy};
use crate::structure::Spring;
use crate::structure::flutter::Kind;
use crate::structure::limit_cycle::{Borne, Cycle, Oscillator, Periodic};

/// Part of the accuracy by which speed and frequency may change in the last balance.
const STILL: f64 = 0.2;
/// Balances at an amplitude and a number of harmonics, at most.
const BALANCES: usize = 8;
/// Harmonics that are added.
const MORE: usize = 2;
/// Why a branch ends when the monitor says stop.
const STOPPED: &str = "told to stop";
/// Greatest growth of what the gas does beyond small motions that is guessed.
const GROWTH: f64 = 8.0;

/// Where forces are asked for, and what is told.
pub(super) type Source<'s, 'l> = Option<(&'s mut dyn ForceSource, &'s mut Log<'l>)>;

/// A point of a branch.
struct Point {
    amplitude: f64,
    cycle: Cycle,
    beyond: Option<Periodic>,
    error: f64,
    balances: usize,
    extrapolated: bool,
}

/// The search for the cycles of a structure in a stream.
pub(super) struct Seek<'s, 'a> {
    plan: &'s LimitCycles,
    search: &'s mut Search<'a>,
    springs: Vec<Spring>,
    borne: Option<Borne>,
    coordinate: usize,
}

/// The coordinate of `names` whose amplitude `[lco]` gives.
pub(crate) fn coordinate(plan: &LimitCycles, names: &[String]) -> Result<usize, RunError> {
    let refuse = |what: String, hint| RunError::Unsupported { what, hint };
    let named = |wanted: &str| names.iter().position(|n| n == wanted);
    let coordinate = match &plan.coordinate {
        Some(wanted) => named(wanted).ok_or_else(|| {
            let what = format!("`lco.coordinate` is `{wanted}`, but the structure has {}", names.join(", "));
            refuse(what, "name one of its coordinates")
        })?,
        None => named("pitch").unwrap_or(0),
    };
    let Some(name) = names.get(coordinate) else {
        return Err(refuse("`[lco]` of a structure without coordinates".into(), "name those that are free to move"));
    };
    if is_angle(name) == plan.amplitude.is_empty() {
        let (what, hint) = match is_angle(name) {
            true => ("is an angle", "give `amplitude = [\"0.25 deg\", \"4 deg\"]`"),
            false => ("is no angle", "give `displacement` instead of `amplitude`"),
        };
        return Err(refuse(format!("`lco`: the coordinate `{name}` {what}"), hint));
    }
    Ok(coordinate)
}

impl<'s, 'a> Seek<'s, 'a> {
    /// With the forces of small motions that `search` knows.
    pub(super) fn new(
        plan: &'s LimitCycles,
        search: &'s mut Search<'a>,
        (springs, borne): (Vec<Spring>, Option<Borne>),
    ) -> Result<Self, RunError> {
        let coordinate = coordinate(plan, search.names())?;
        Ok(Self { plan, search, springs, borne, coordinate })
    }

    /// All branches; forces beyond small motions are those of `source`, where there is one and the case asks for them.
    pub(super) fn run(mut self, mut source: Source<'_, '_>) -> (Vec<LimitCycle>, Vec<Warning>) {
        let (amplitudes, mut warnings) = (self.plan.amplitudes(), Vec::new());
        let mut begins = self.begins(amplitudes[0]);
        // amplitudes follow what is varied from where forces act
        let all = begins.len();
        begins.retain(|(_, cycle)| cycle.x > 0.0);
        if begins.len() < all {
            let what = "a motion of the least amplitude grows in however thin a gas: no branch begins there";
            warnings.push((what.into(), remedy::DAMPING));
        }
        if begins.is_empty() {
            let what = "no motion of the least amplitude neither grows nor decays up to the greatest speed";
            warnings.push((what.into(), remedy::SEE));
        }
        let mut all = Vec::new();
        for (number, (kind, first)) in begins.into_iter().enumerate() {
            let mut points: Vec<Point> = Vec::new();
            for amplitude in &amplitudes {
                match self.point(*amplitude, &first, &points, &mut source) {
                    Ok(point) => points.push(point),
                    Err(why) => {
                        let told = self.told(*amplitude);
                        let what = format!("branch {} of limit cycles ends before {told}: {why}", number + 1);
                        warnings.push((what, remedy::CYCLES));
                        break;
                    }
                }
            }
            all.extend((0..points.len()).map(|i| self.row(number + 1, kind, &points, i)));
        }
        let open = all.iter().find(|row: &&LimitCycle| row.error > self.plan.accuracy);
        warnings.extend(open.map(|row| {
            let part = 100.0 * row.error.min(1.0);
            let what = format!(
                "the limit cycle of amplitude {} is known to {part:.1} % only: allow more `harmonics`",
                row.amplitude
            );
            (what, remedy::HARMONICS)
        }));
        (all, warnings)
    }

    fn told(&self, amplitude: f64) -> String {
        let name = &self.search.names()[self.coordinate];
        if is_angle(name) {
            format!("{:.3} degrees of {name}", amplitude.to_degrees())
        } else {
            format!("{amplitude:.4e} of {name}")
        }
    }

    fn with<T>(&self, f: impl FnOnce(&Oscillator<'_>) -> T) -> Option<T> {
        let fit = self.search.fit()?;
        let forces = |kappa: f64| fit.at(Complex64::new(0.0, kappa));
        let (matrices, coordinate) = (self.search.matrices(), self.coordinate);
        let (borne, scales) = (self.borne.as_ref(), self.search.scales());
        let speed = |x: f64| scales.at(x).speed;
        let varied = scales.varied(&speed);
        Some(f(&Oscillator { matrices, springs: &self.springs, forces: &forces, varied, coordinate, borne }))
    }

    fn begins(&self, amplitude: f64) -> Vec<(Kind, Cycle)> {
        let mut all = self.with(|own| own.begin(amplitude, self.search.upto())).unwrap_or_default();
        // where forces would be guessed
        all.retain(|(_, cycle)| cycle.kappa() <= self.search.highest_told());
        all
    }

    /// The cycle of an amplitude, with as many harmonics as it needs.
    fn point(
        &mut self,
        amplitude: f64,
        first: &Cycle,
        before: &[Point],
        source: &mut Source<'_, '_>,
    ) -> Result<Point, String> {
        let most = self.plan.harmonics as usize;
        let mut at = guessed(amplitude, first, before);
        let mut n = at.cycle.motion.harmonics.len().saturating_sub(MORE).clamp(1, most);
        loop {
            if let Some((source, log)) = source {
                self.search.reach(*source, n as f64 * at.cycle.kappa(), log).ok_or(STOPPED)?;
            }
            let next = self.converged(&at, n, source)?;
            let error = if at.balances > 0 { (next.cycle.x / at.cycle.x - 1.0).abs() } else { f64::INFINITY };
            at = Point { error, ..next };
            if at.error <= self.plan.accuracy || n >= most {
                break;
            }
            n = (n + MORE).min(most);
        }
        at.extrapolated = n as f64 * at.cycle.kappa() > self.search.highest_known();
        Ok(at)
    }

    /// The cycle with `n` harmonics near that of `from`, and what the gas does there beyond small motions.
    fn converged(&self, from: &Point, n: usize, source: &mut Source<'_, '_>) -> Result<Point, String> {
        let amplitude = from.amplitude;
        let solved = |guess: &Cycle, beyond: Option<&Periodic>| -> Result<Cycle, String> {
            let found = self.with(|own| own.solve(guess, amplitude, n, beyond)).flatten();
            found.ok_or_else(|| "no cycle is found near the last one; take more `points`".to_owned())
        };
        let (mut beyond, mut count) = (from.beyond.clone(), 1);
        let mut cycle = solved(&from.cycle, beyond.as_ref())?;
        if let (Some((source, log)), GasResponse::Nonlinear) = (source, self.plan.gas) {
            loop {
                if log.stopped() {
                    return Err(STOPPED.into());
                }
                let forces = source.swing(&cycle.motion, cycle.kappa())?;
                let own = self.with(|own| own.beyond_small(&cycle, &forces)).unwrap_or_default();
                let next = solved(&cycle, Some(&own))?;
                let moved = [next.x / cycle.x - 1.0, next.omega / cycle.omega - 1.0].map(f64::abs);
                log.note(&format!(
                    "{}, {n} harmonics: {} {:.5} of that of the case, k {:.5}, changed by {:.0e}",
                    self.told(amplitude),
                    self.search.scales().named(),
                    next.x,
                    self.search.reduced_frequency(next.kappa()),
                    moved[0].max(moved[1])
                ));
                (cycle, beyond) = (next, Some(own));
                if moved[0].max(moved[1]) <= STILL * self.plan.accuracy {
                    break;
                }
                if count == BALANCES {
                    return Err(format!("speed and frequency do not stand still after {BALANCES} balances"));
                }
                count += 1;
            }
        }
        let balances = from.balances + count;
        Ok(Point { amplitude, cycle, beyond, error: f64::INFINITY, balances, extrapolated: false })
    }

    fn row(&self, branch: usize, kind: Kind, points: &[Point], i: usize) -> LimitCycle {
        let point = &points[i];
        let (cycle, scales) = (&point.cycle, self.search.scales());
        let stream = scales.at(cycle.x);
        let name = self.search.names()[self.coordinate].clone();
        let unit = |q: f64| if is_angle(&name) { q.to_degrees() } else { q };
        let (from, to) = (&points[i.saturating_sub(1)], &points[(i + 1).min(points.len() - 1)]);
        let rises = to.cycle.x >= from.cycle.x;
        let harmonic = |h: &Vec<Complex64>| h.iter().map(|z| [z.re, z.im]).collect();
        let means: Vec<f64> = cycle.motion.mean.iter().zip(self.search.still()).map(|(q, still)| q + still).collect();
        LimitCycle {
            mach: scales.stream,
            branch,
            amplitude: unit(point.amplitude),
            speed_ratio: cycle.speed,
            speed_index: scales.speed_index.map(|v| v * stream.pressure.sqrt()),
            reduced_speed: scales.reduced_speed.map(|v| v * cycle.speed),
            speed: scales.reference.speed * cycle.speed,
            density: scales.numbers(cycle.x).density,
            dynamic_pressure: scales.reference.dynamic_pressure() * stream.pressure,
            altitude: stream.altitude,
            reduced_frequency: scales.reduced_frequency(cycle.kappa()),
            frequency: scales.cycles * cycle.omega,
            stable: rises == (kind == Kind::Flutter),
            mean: unit(means[self.coordinate]),
            means,
            harmonics: cycle.motion.harmonics.len(),
            error: point.error,
            balances: if self.plan.gas == GasResponse::Nonlinear { point.balances } else { 0 },
            motion: cycle.motion.harmonics.iter().map(harmonic).collect(),
            extrapolated: point.extrapolated,
            march: None,
            coordinate: name,
        }
    }
}

/// What an amplitude begins with: the line through the last two points, or the last, or the first of the branch.
fn guessed(amplitude: f64, first: &Cycle, before: &[Point]) -> Point {
    let at = |cycle: Cycle, beyond: Option<Periodic>| Point {
        amplitude,
        cycle,
        beyond,
        error: f64::INFINITY,
        balances: 0,
        extrapolated: false,
    };
    let Some(last) = before.last() else { return at(first.clone(), None) };
    let none = Periodic { mean: vec![0.0; last.cycle.motion.mean.len()], harmonics: Vec::new() };
    let scaled = |p: &Periodic, by: f64| none.with_harmonics(p.harmonics.len()).towards(p, by);
    let ratio = amplitude / last.amplitude;
    let beyond = last.beyond.as_ref().map(|b| scaled(b, ratio.powi(3).min(GROWTH)));
    let cycle = match before {
        [.., older, last] => {
            let part = (amplitude - older.amplitude) / (last.amplitude - older.amplitude);
            let (a, b) = (&older.cycle, &last.cycle);
            let line = |a: f64, b: f64| (a + part * (b - a)).max(0.5 * b);
            let motion = a.motion.with_harmonics(b.motion.harmonics.len()).towards(&b.motion, part);
            Cycle { x: line(a.x, b.x), speed: line(a.speed, b.speed), omega: line(a.omega, b.omega), motion }
        }
        _ => Cycle { motion: scaled(&last.cycle.motion, ratio), ..last.cycle.clone() },
    };
    at(cycle, beyond)
}
