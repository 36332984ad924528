//! The search at one Mach number.
use std::f64::consts::LN_2;

use num_complex::Complex64;

use super::super::record::Log;
use super::super::studies::{ForceSource, Forces, in_order};
use super::held::{Held, Translation};
use super::scales::Scales;
use super::shapes::shares;
use super::state_space::state_space;
use super::wall_motion::{Pressures, wall_motion};
use crate::case::Flutter as Plan;
use crate::math::rational::Rational;
use crate::problem::StreamRatio;
use crate::record::flutter::{
    Bars, FlutterAt, FlutterRow, Mark, MotionRow, NaturalMode, StateSpaceAt, Warning, remedy,
};
use crate::structure::flutter::{Branch, Crossing, Flutter, Kind, Point, StillMotions};
use crate::structure::{Matrices, Spring};

/// Misfit of rational functions to the samples.
const MISFIT: f64 = 1e-7;
/// Frequency, over the highest asked for, beyond which motions are not told.
const BEYOND: f64 = 2.0;
/// A frequency that forces are computed at for a harmonic, over that of the harmonic: it goes on to rise.
const ABOVE: f64 = 1.1;
/// Square of the frequency that the softest spring has, over the largest: a body is free without it.
const SOFTEST: f64 = 1e-9;
/// Greatest part of the frequencies that counts as known while others are sought.
const NEARLY_ALL: f64 = 0.9;
/// Frequencies that are nearer to one another than this part are one.
const SAME: f64 = 5e-4;

/// Forces at an angular frequency.
type Sample = (f64, Vec<Complex64>);

/// The search at one Mach number.
pub(super) struct Search<'a> {
    scales: &'a Scales,
    plan: &'a Plan,
    matrices: Matrices,
    names: Vec<String>,
    /// What coordinates are counted in where shapes are told.
    units: Vec<f64>,
    /// Coordinates of the steady flow.
    still: Vec<f64>,
    /// Displacements that no steady force follows.
    translations: Vec<Translation>,
    samples: Vec<Sample>,
    /// Pressures on walls at the same frequencies, where these were computed here.
    pressures: Vec<Pressures>,
    iterations: usize,
    residual: f64,
}

/// Motions and crossings.
#[derive(Default)]
struct Solved {
    /// Those that oscillate, mode by mode.
    branches: Vec<Vec<Point>>,
    still: StillMotions,
    /// λ where nothing flows, mode by mode.
    in_still_air: Vec<Complex64>,
    crossings: Vec<Crossing>,
    /// Modes that grow from where forces are known for the first time, and where their growth is beyond doubt.
    from_start: Vec<(usize, Point)>,
    /// Coordinates in which the body is free, and where divergence begins when the softest springs are put there.
    free: Option<(Vec<usize>, Option<f64>)>,
}

impl<'a> Search<'a> {
    /// Of the structure `held`, with the forces known already.
    pub(super) fn new(held: &Held, scales: &'a Scales, plan: &'a Plan, samples: Vec<Sample>, residual: f64) -> Self {
        let (matrices, names) = (held.matrices.clone(), held.names.clone());
        let (units, still) = (held.units(scales.semichord), vec![0.0; names.len()]);
        let translations = held.translations.clone();
        let (pressures, iterations) = (Vec::new(), 0);
        Self { scales, plan, matrices, names, units, still, translations, samples, pressures, iterations, residual }
    }

    /// Computes forces at the angular frequency `omega`; `None` when the monitor says stop.
    fn sample(&mut self, source: &mut dyn ForceSource, omega: f64, log: &mut Log<'_>) -> Option<()> {
        let known = self.samples.len() as f64 / self.plan.expected() as f64;
        log.portion = log.portion.at(known.min(NEARLY_ALL));
        let k = self.scales.reduced_frequency(omega);
        log.doing(&format!("forces at k = {k:.4}, frequency {}", self.samples.len() + 1));
        let Forces { generalised, ended, pressures, .. } = source.forces_unless(omega, &|| log.stopped())?;
        let iterations: usize = ended.iter().map(|e| e.iterations).sum();
        let left = ended.iter().map(|e| e.left).fold(0.0, f64::max);
        self.iterations += iterations;
        self.residual = self.residual.max(left);
        log.note(&format!(
            "forces at k = {k:.4}: {iterations} linear iterations for {} modes, residual {left:.0e}",
            ended.len()
        ));
        self.samples.push((omega, generalised));
        self.samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.pressures.push((omega, pressures));
        self.pressures.sort_by(|a, b| a.0.total_cmp(&b.0));
        Some(())
    }

    /// Computes forces at the angular frequency `omega` where none are known that high; `None` when the monitor says stop.
    pub(super) fn reach(&mut self, source: &mut dyn ForceSource, omega: f64, log: &mut Log<'_>) -> Option<()> {
        match self.highest_known() < omega {
            true => self.sample(source, ABOVE * omega, log),
            false => Some(()),
        }
    }

    /// The highest angular frequency that forces are known at.
    pub(super) fn highest_known(&self) -> f64 {
        self.samples.last().map_or(0.0, |s| s.0)
    }

    /// Forces between the frequencies that are known; `None` where these are too few.
    pub(super) fn fit(&self) -> Option<Rational> {
        Rational::of(&self.samples, MISFIT)
    }

    pub(super) fn matrices(&self) -> &Matrices {
        &self.matrices
    }

    /// Coordinates of the steady flow.
    pub(super) fn still(&self) -> &[f64] {
        &self.still
    }

    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    pub(super) fn scales(&self) -> &Scales {
        self.scales
    }

    pub(super) fn reduced_frequency(&self, kappa: f64) -> f64 {
        self.scales.reduced_frequency(kappa)
    }

    /// Greatest speed looked at.
    pub(super) fn upto(&self) -> f64 {
        self.scales.upto(self.plan.most)
    }

    /// The boundary with forces of `source`, of which those near the crossings are asked for; `None` when the monitor says stop.
    pub(super) fn run(
        &mut self,
        (source, stream): (&mut dyn ForceSource, StreamRatio),
        log: &mut Log<'_>,
    ) -> Option<FlutterAt> {
        self.matrices = of_the_case(source.matrices(), stream);
        (self.names, self.still) = (source.names(), source.still());
        let mut first = vec![0.0];
        first.extend(self.plan.first().into_iter().filter(|k| *k > 0.0));
        for k in in_order(&first) {
            self.sample(source, self.scales.angular_frequency(k), log)?;
        }
        let mut solved = self.solved(&self.samples);
        // no change is known of the first ones
        let mut errors = vec![f64::INFINITY; solved.crossings.len()];
        while self.samples.len() < self.plan.frequencies as usize {
            let new = |c: &Crossing| self.samples.iter().all(|(w, _)| (w - c.kappa).abs() > SAME * c.kappa);
            let open = solved.crossings.iter().zip(&errors).filter(|(c, e)| **e > self.plan.accuracy && new(c));
            let Some(worst) = open.max_by(|a, b| a.1.total_cmp(b.1).then(b.0.x.total_cmp(&a.0.x))) else { break };
            let kappa = worst.0.kappa;
            self.sample(source, kappa, log)?;
            let before = std::mem::take(&mut solved.crossings);
            solved = self.solved(&self.samples);
            errors = solved.crossings.iter().map(|c| changed(c, &before)).collect();
        }
        let warnings = self.doubts(&solved.crossings, &mut errors, ("allow more `frequencies`", remedy::FREQUENCIES));
        Some(self.told(&solved, &errors, warnings))
    }

    /// Adds the walls as they move at the crossings of a boundary, with the pressure on them.
    pub(super) fn show(&self, found: &mut FlutterAt, source: &dyn ForceSource) {
        if found.crossings.is_empty() {
            return;
        }
        let walls = source.walls();
        for row in &mut found.crossings {
            let motion = (self.scales.angular_frequency(row.reduced_frequency), self.scales.stream);
            row.walls = wall_motion(&walls, (&row.shape, &self.units), &self.pressures, motion);
        }
    }

    /// The boundary with the forces that there are.
    pub(super) fn again(&self) -> FlutterAt {
        let solved = self.solved(&self.samples);
        let mut errors: Vec<f64> = solved.crossings.iter().map(|c| self.without_nearest(c)).collect();
        let refined = ("forces that are read cannot be refined there", remedy::SEE);
        let mut warnings = self.doubts(&solved.crossings, &mut errors, refined);
        if self.samples.first().is_none_or(|s| s.0 > 0.0) {
            let what = "there are no forces at rest: speeds of divergence are extrapolated";
            warnings.push((what.into(), remedy::SEE));
        }
        self.told(&solved, &errors, warnings)
    }

    /// Change of a crossing when the forces nearest to its frequency are left out.
    fn without_nearest(&self, crossing: &Crossing) -> f64 {
        let distance = |s: &Sample| (s.0 - crossing.kappa).abs();
        let nearest = self.samples.iter().map(distance).fold(f64::INFINITY, f64::min);
        // steady forces are those of divergence
        if crossing.kind == Kind::Divergence && nearest == 0.0 {
            return f64::INFINITY;
        }
        let others: Vec<Sample> = self.samples.iter().filter(|s| distance(s) > nearest).cloned().collect();
        changed(crossing, &self.solved(&others).crossings)
    }

    /// What is not known well enough; sets the errors of divergence.
    fn doubts(&self, crossings: &[Crossing], errors: &mut [f64], (hint, remedy): (&str, &'static str)) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let still = self.samples.first().is_some_and(|s| s.0 == 0.0);
        for (crossing, error) in crossings.iter().zip(errors) {
            // forces at its own frequency, so that no fit changes it, or there is no other fit to hold it against
            if crossing.kind == Kind::Divergence && still {
                *error = if error.is_finite() { error.max(self.residual) } else { self.residual };
            }
            if *error > self.plan.accuracy {
                let part = 100.0 * error.min(1.0);
                let place = crossing.pressure.sqrt();
                let what = format!("the crossing at {place:.4} of the speed is known to {part:.1} % only: {hint}");
                warnings.push((what, remedy));
            }
        }
        warnings
    }

    /// Motions and crossings with forces at some frequencies.
    fn solved(&self, samples: &[Sample]) -> Solved {
        let Some(fit) = Rational::of(samples, MISFIT) else { return Solved::default() };
        let speed = |x: f64| self.scales.at(x).speed;
        // motions that do not oscillate, divergence among them, have the forces found at rest where these are known
        let rest = samples.first().filter(|s| s.0 == 0.0).map(|s| self.at_rest(s));
        let fitted = |kappa: f64| fit.at(Complex64::new(0.0, kappa));
        let forces = |kappa: f64| rest.clone().filter(|_| kappa == 0.0).unwrap_or_else(|| fitted(kappa));
        let flutter = Flutter::new(&self.matrices, &forces).varying(self.scales.varied(&speed));
        let upto = self.scales.upto(self.plan.most);
        let mut branches = flutter.branches(upto);
        let (mut crossings, still) = (flutter.crossings(&branches, upto), flutter.still_motions(&branches, upto));
        // at the lowest speeds forces hardly act, and would be guessed
        let (highest, known) = (self.highest_told(), self.highest() * (1.0 + SAME));
        branches.iter_mut().for_each(|b| b.retain(|p| p.lambda.im.abs() <= highest * p.speed));
        // what grows from zero on has one frequency there, at which forces are known or are not
        let begins_at_zero = |c: &Crossing| c.kind == Kind::Flutter && c.x == 0.0;
        crossings.retain(|c| c.kappa <= if begins_at_zero(c) { known } else { highest });
        let of_known = |b: &Vec<Point>| b.iter().position(|p| p.lambda.im <= known * p.speed).unwrap_or(b.len());
        let grows = |(m, b): (usize, &Vec<Point>)| {
            let own = &b[of_known(b)..];
            flutter.grows_from(m, own).map(|k| (m, own[k].clone()))
        };
        let from_start = branches.iter().enumerate().filter_map(grows).collect();
        let free = self.free(&flutter, &forces);
        Solved { branches, still, in_still_air: flutter.in_still_air(), crossings, from_start, free }
    }

    /// Forces of steady displacements: none where all bodies are displaced by the same way.
    fn at_rest(&self, (_, forces): &Sample) -> Vec<Complex64> {
        let mut forces = forces.clone();
        self.translations.iter().for_each(|t| t.clear(&mut forces));
        forces
    }

    /// Coordinates in which the body is free, and where divergence begins when springs hold it there, however soft; `None` where it is held.
    fn free(&self, flutter: &Flutter<'_>, forces: &dyn Fn(f64) -> Vec<Complex64>) -> Option<(Vec<usize>, Option<f64>)> {
        let (n, displacements) = (self.names.len(), flutter.free_displacements());
        let largest = |shape: &Vec<Complex64>| {
            let share = |j: &usize| shape[*j].norm() / self.units[*j];
            (0..n).max_by(|a, b| share(a).total_cmp(&share(b)))
        };
        let mut coordinates: Vec<usize> = displacements.iter().filter_map(largest).collect();
        coordinates.sort_unstable();
        coordinates.dedup();
        if coordinates.is_empty() {
            return None;
        }
        let mut softly = self.matrices.clone();
        let square = flutter.natural().last().map_or(0.0, |mode| mode.0 * mode.0);
        coordinates.iter().for_each(|j| softly.stiffness[j * (n + 1)] += SOFTEST * square * softly.mass[j * (n + 1)]);
        let speed = |x: f64| self.scales.at(x).speed;
        let held = Flutter::new(&softly, forces).varying(self.scales.varied(&speed));
        let first = held.crossings(&[], self.upto()).into_iter().map(|c| c.x).find(|x| *x > 0.0);
        Some((coordinates, first))
    }

    /// The highest angular frequency of motions that are told.
    pub(super) fn highest_told(&self) -> f64 {
        BEYOND * self.highest()
    }

    /// The highest angular frequency asked for, or known.
    fn highest(&self) -> f64 {
        let known = self.highest_known();
        self.plan.first().last().map_or(known, |k| self.scales.angular_frequency(*k).min(known))
    }

    /// Where the g-method has the crossings, and the system at the first of them.
    fn checked(&self, crossings: &[Crossing]) -> (Vec<Option<f64>>, Option<StateSpaceAt>) {
        let Some(fit) = self.fit() else { return (vec![None; crossings.len()], None) };
        let speed = |x: f64| self.scales.at(x).speed;
        let forces = |kappa: f64| fit.at(Complex64::new(0.0, kappa));
        let flutter = Flutter::new(&self.matrices, &forces).varying(self.scales.varied(&speed));
        // nothing acts at zero
        let acts = |c: &&Crossing| c.x > 0.0;
        let found =
            crossings.iter().map(|c| Some(c).filter(acts).and_then(|c| flutter.damping_perturbation(c))).collect();
        let moving = || crossings.iter().filter(acts);
        let first = moving().find(|c| c.kind == Kind::Flutter).or(moving().next());
        let stream = first.map_or_else(|| self.scales.at(1.0), |c| self.scales.at(c.x));
        let last = self.samples.last().map_or(0.0, |s| s.0);
        let system = || state_space((&self.matrices, &self.names), &forces, last, (&stream, self.scales));
        (found, self.plan.state_space.then(system).flatten())
    }

    fn told(&self, solved: &Solved, errors: &[f64], mut warnings: Vec<Warning>) -> FlutterAt {
        let (s, crossings) = (self.scales, &solved.crossings);
        if solved.branches.iter().all(Vec::is_empty) && solved.still.growing.is_empty() {
            let what = format!(
                "no motion has a reduced frequency below {:.3}, twice the highest known: give higher `reduced_frequencies`",
                BEYOND * s.reduced_frequency(self.highest())
            );
            warnings.push((what, remedy::HIGHER));
        }
        let (names, told): (Vec<_>, Vec<_>) = self.grow_from_the_start(solved).into_iter().unzip();
        let growing_from_start = names.into_iter().flatten().collect();
        warnings.extend::<Vec<Warning>>(told);
        let (warnings, remedies) = warnings.into_iter().map(|(what, remedy)| (what, remedy.to_owned())).unzip();
        let notes = self.of_a_free_body(solved).into_iter().collect();
        let (checks, state_space) = self.checked(crossings);
        let rows = crossings.iter().zip(errors).zip(&checks);
        FlutterAt {
            mach: s.stream,
            matching: s.matching,
            dimensional: s.dimensional,
            dimension: s.dimension,
            crossings: rows.map(|((c, error), check)| self.row(c, *error, *check)).collect(),
            natural: self.natural(),
            reference: s.case_reference(),
            motions: self.motions(solved),
            state_space,
            reduced_frequencies: self.samples.iter().map(|x| s.reduced_frequency(x.0)).collect(),
            forces: self.samples.iter().map(|x| x.1.iter().map(|z| [z.re, z.im]).collect()).collect(),
            coordinates: self.names.clone(),
            still: self.still.clone(),
            moved: vec![Mark::default(); self.names.len()],
            semichord: s.semichord,
            linear_iterations: self.iterations,
            residual: self.residual,
            growing_from_start,
            warnings,
            remedies,
            notes,
            ..FlutterAt::default()
        }
    }

    /// What grows already where it is told for the first time: its name where it has no crossing, and words.
    fn grow_from_the_start(&self, solved: &Solved) -> Vec<(Option<String>, Warning)> {
        let grows = |(m, point): &(usize, Point)| {
            let mut own = solved.crossings.iter().filter(|c| c.branch == Branch::Mode(*m) && c.x <= point.x);
            let (name, damping) = (name(Branch::Mode(*m)), 2.0 * point.lambda.re / point.lambda.norm());
            match own.next() {
                None => {
                    let words = format!(
                        "{name} grows already at the lowest {} at which its forces are known, {:.4} of that of the case (g {damping:+.1e}): \
                         it has no crossing there",
                        self.scales.named(),
                        point.x
                    );
                    Some((Some(name), (words, remedy::LOWEST)))
                }
                Some(c) if c.x == 0.0 && c.kind == Kind::Flutter => {
                    Some((None, (self.words_from_zero(&name, point, damping), remedy::DAMPING)))
                }
                Some(_) => None,
            }
        };
        solved.from_start.iter().filter_map(grows).collect()
    }

    /// Words for a motion that grows at every density.
    fn words_from_zero(&self, name: &str, point: &Point, damping: f64) -> String {
        let stream = self.scales.numbers(point.x);
        let place = match stream.altitude {
            Some(altitude) => format!("{:.1} km of altitude", altitude / 1000.0),
            None => format!("{:.1e} of the density of the case", point.x),
        };
        format!(
            "{name} grows in however thin a gas, already at {place} (g {damping:+.1e}): its flutter is told at the density 0; structural damping, \
             of which there is too little for this, would move it"
        )
    }

    /// Words for divergence of a body that is free, beside that of one that springs hold softly.
    fn of_a_free_body(&self, solved: &Solved) -> Option<String> {
        let (coordinates, softly) = solved.free.as_ref()?;
        let c = solved.crossings.iter().find(|c| c.kind == Kind::Divergence && c.x > 0.0)?;
        let names: Vec<String> = coordinates.iter().map(|j| format!("`{}`", self.names[*j])).collect();
        let (names, varied) = (names.join(", "), self.scales.named());
        let other = match softly {
            Some(x) => format!("it begins at {x:.4}"),
            None => "there is none as far as was looked at".to_owned(),
        };
        Some(format!(
            "{} at {:.4} of the {varied} of the case is that of a body that is free in {names} and accelerates under its load (inertia relief): with a \
             spring of {names}, however soft, {other}",
            name(c.branch),
            c.x
        ))
    }

    /// Motions at all speeds: each mode from still air on, then those that grow without oscillating.
    fn motions(&self, solved: &Solved) -> Vec<MotionRow> {
        let all = || solved.branches.iter().flatten().map(|p| p.lambda.norm());
        let fastest = all().chain(solved.in_still_air.iter().map(|z| z.norm())).fold(f64::MIN_POSITIVE, f64::max);
        let mut rows = Vec::new();
        for (m, lambda) in solved.in_still_air.iter().enumerate() {
            let air = Point { x: 0.0, speed: self.scales.at(0.0).speed, lambda: *lambda, shape: Vec::new() };
            let [moving, resting] =
                [&solved.branches, &solved.still.resting].map(|all| all.get(m).into_iter().flatten());
            let points = std::iter::once(&air).chain(moving).chain(resting);
            rows.extend(points.map(|p| self.motion(Branch::Mode(m), p, fastest)));
        }
        for (k, branch) in solved.still.growing.iter().enumerate() {
            rows.extend(branch.iter().map(|p| self.motion(Branch::Divergence(k), p, fastest)));
        }
        rows
    }

    fn motion(&self, branch: Branch, p: &Point, fastest: f64) -> MotionRow {
        let (s, lambda, stream) = (self.scales, p.lambda, self.scales.numbers(p.x));
        let reduced = |rate: f64| if rate > 0.0 { s.reduced_frequency(rate / p.speed) } else { 0.0 };
        let damping = match (lambda.im != 0.0, lambda.re == 0.0) {
            (true, _) => 2.0 * lambda.re / lambda.norm(),
            (_, true) => 0.0,
            // growth over a chord of the way, in doublings, which vanishes where a motion is neutral
            _ => 2.0 * s.reduced_frequency(lambda.re / p.speed) / LN_2,
        };
        MotionRow {
            branch: name(branch),
            mode: number(branch),
            speed_ratio: stream.speed_ratio,
            speed: stream.speed,
            equivalent_airspeed: stream.equivalent_airspeed,
            dynamic_pressure: stream.dynamic_pressure,
            density: stream.density,
            altitude: stream.altitude,
            reduced_frequency: reduced(lambda.im.abs()),
            damping,
            frequency: s.cycles * lambda.im.abs(),
            eigenvalue: [lambda.re / fastest, lambda.im / fastest],
        }
    }

    fn natural(&self) -> Vec<NaturalMode> {
        let none = |_: f64| Vec::new();
        let all = Flutter::new(&self.matrices, &none).natural();
        let mode = |(m, (omega, shape)): (usize, (f64, Vec<Complex64>))| NaturalMode {
            mode: m + 1,
            frequency: self.scales.cycles * omega,
            shape: shares(&self.names, &self.units, &shape),
        };
        all.into_iter().enumerate().map(mode).collect()
    }

    fn row(&self, c: &Crossing, error: f64, check: Option<f64>) -> FlutterRow {
        let (s, stream) = (self.scales, self.scales.numbers(c.x));
        let last = self.samples.last().map_or(0.0, |x| x.0) * (1.0 + SAME);
        let equivalent = c.pressure.sqrt();
        // the frequency of pitch alone: what V* is measured with
        let alone = s.reduced_speed.map(|v| s.stream / (v * s.semichord));
        FlutterRow {
            kind: match c.kind {
                Kind::Flutter => "flutter",
                Kind::Restabilised => "restabilised",
                Kind::Divergence => "divergence",
            }
            .to_owned(),
            branch: name(c.branch),
            mode: number(c.branch),
            speed_ratio: stream.speed_ratio,
            speed_index: s.speed_index.map(|v| v * equivalent),
            reduced_speed: s.reduced_speed.map(|v| v * c.speed),
            speed: stream.speed,
            equivalent_airspeed: stream.equivalent_airspeed,
            density: stream.density,
            dynamic_pressure: stream.dynamic_pressure,
            mass_ratio: s.mass_ratio.map(|mu| mu * s.reference.density / stream.density).filter(|mu| mu.is_finite()),
            altitude: stream.altitude,
            reduced_frequency: s.reduced_frequency(c.kappa),
            frequency: s.cycles * c.frequency,
            frequency_ratio: alone.map(|w| c.frequency / w),
            error,
            cloud_error: None,
            bars: Bars::default(),
            shape: shares(&self.names, &self.units, &c.shape),
            walls: None,
            g_method: check.map(|x| s.at(x).pressure.sqrt() / equivalent - 1.0),
            growth: None,
            holding_damping: None,
            margin: None,
            remarks: Vec::new(),
            extrapolated: c.kappa > last || self.samples.first().is_none_or(|x| c.kappa < x.0 * (1.0 - SAME)),
        }
    }
}

/// What a branch is called.
fn name(branch: Branch) -> String {
    match branch {
        Branch::Mode(m) => format!("mode {}", m + 1),
        Branch::Divergence(k) => format!("divergence {}", k + 1),
    }
}

/// The number of a natural mode.
fn number(branch: Branch) -> Option<usize> {
    match branch {
        Branch::Mode(m) => Some(m + 1),
        Branch::Divergence(_) => None,
    }
}

/// Matrices in units of the case's stream from those of another one.
fn of_the_case(matrices: Matrices, stream: StreamRatio) -> Matrices {
    let [stiffness, damping, mass] = stream.structural();
    let over = |all: Vec<f64>, unit: f64| all.into_iter().map(|x| x / unit).collect();
    Matrices {
        mass: over(matrices.mass, mass),
        damping: over(matrices.damping, damping),
        stiffness: over(matrices.stiffness, stiffness),
    }
}

/// Springs in units of the case's stream from those of another one.
pub(super) fn springs_of_the_case(springs: Vec<Spring>, stream: StreamRatio) -> Vec<Spring> {
    let [unit, ..] = stream.structural();
    springs.into_iter().map(|s| Spring { stiffness: s.stiffness / unit, cubic: s.cubic / unit, ..s }).collect()
}

/// Relative change of the speed of a crossing (of the root of its dynamic pressure) since another interpolation; infinite where that had
/// none like it.
fn changed(crossing: &Crossing, before: &[Crossing]) -> f64 {
    let like = before.iter().filter(|b| b.kind == crossing.kind && b.branch == crossing.branch);
    let apart = |b: &Crossing| match b.pressure == crossing.pressure {
        true => 0.0,
        false => ((b.pressure / crossing.pressure).sqrt() - 1.0).abs(),
    };
    like.map(apart).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests;
