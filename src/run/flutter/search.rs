//! The search at one Mach number.
use num_complex::Complex64;

use super::super::record::Log;
use super::super::studies::{ForceSource, Forces};
use super::held::{Held, Mark};
use super::record::{FlutterAt, FlutterRow, MotionRow};
use super::scales::Scales;
use super::shapes::{NaturalMode, shares};
use super::state_space::StateSpaceAt;
use crate::case::{Flutter as Plan, StreamRatio};
use crate::math::rational::Rational;
use crate::structure::flutter::{Crossing, Flutter, Kind, Point};
use crate::structure::{Matrices, Spring};

/// Misfit of rational functions to the samples.
const MISFIT: f64 = 1e-7;
/// Frequency, over the highest asked for, beyond which motions are not told.
const BEYOND: f64 = 2.0;
/// A frequency that forces are computed at for a harmonic, over that of the harmonic: it goes on to rise.
const ABOVE: f64 = 1.1;
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
    samples: Vec<Sample>,
    iterations: usize,
    residual: f64,
}

/// Motions and crossings.
type Solved = (Vec<Vec<Point>>, Vec<Crossing>);

impl<'a> Search<'a> {
    /// Of the structure `held`, with the forces known already.
    pub(super) fn new(held: &Held, scales: &'a Scales, plan: &'a Plan, samples: Vec<Sample>, residual: f64) -> Self {
        let (matrices, names) = (held.matrices.clone(), held.names.clone());
        let (units, still) = (held.units(scales.semichord), vec![0.0; names.len()]);
        Self { scales, plan, matrices, names, units, still, samples, iterations: 0, residual }
    }

    /// Computes forces at the angular frequency `omega`.
    fn sample(&mut self, source: &mut dyn ForceSource, omega: f64, log: &mut Log<'_>) {
        let Forces { generalised, ended, .. } = source.forces(omega);
        let iterations: usize = ended.iter().map(|e| e.iterations).sum();
        let left = ended.iter().map(|e| e.left).fold(0.0, f64::max);
        self.iterations += iterations;
        self.residual = self.residual.max(left);
        log.note(&format!(
            "forces at k = {:.4}: {iterations} linear iterations for {} modes, residual {left:.0e}",
            self.scales.reduced_frequency(omega),
            ended.len()
        ));
        self.samples.push((omega, generalised));
        self.samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    /// Computes forces at the angular frequency `omega` where none are known that high.
    pub(super) fn reach(&mut self, source: &mut dyn ForceSource, omega: f64, log: &mut Log<'_>) {
        if self.highest_known() < omega {
            self.sample(source, ABOVE * omega, log);
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

    /// The boundary with forces of `source`, of which those near the crossings are asked for.
    pub(super) fn run(
        &mut self,
        (source, stream): (&mut dyn ForceSource, StreamRatio),
        log: &mut Log<'_>,
    ) -> FlutterAt {
        self.matrices = of_the_case(source.matrices(), stream);
        (self.names, self.still) = (source.names(), source.still());
        self.sample(source, 0.0, log);
        for k in self.plan.first() {
            self.sample(source, self.scales.angular_frequency(k), log);
        }
        let (mut branches, mut crossings) = self.solved(&self.samples);
        // no change is known of the first ones
        let mut errors = vec![f64::INFINITY; crossings.len()];
        while self.samples.len() < self.plan.frequencies as usize {
            let new = |c: &Crossing| self.samples.iter().all(|(w, _)| (w - c.kappa).abs() > SAME * c.kappa);
            let open = crossings.iter().zip(&errors).filter(|(c, e)| **e > self.plan.accuracy && new(c));
            let Some(worst) = open.max_by(|a, b| a.1.total_cmp(b.1).then(b.0.x.total_cmp(&a.0.x))) else { break };
            let kappa = worst.0.kappa;
            self.sample(source, kappa, log);
            let before = std::mem::take(&mut crossings);
            (branches, crossings) = self.solved(&self.samples);
            errors = crossings.iter().map(|c| changed(c, &before)).collect();
        }
        let warnings = self.doubts(&crossings, &mut errors, "allow more `frequencies`");
        self.told(&branches, &crossings, &errors, warnings)
    }

    /// The boundary with the forces that there are.
    pub(super) fn again(&self) -> FlutterAt {
        let (branches, crossings) = self.solved(&self.samples);
        let mut errors: Vec<f64> = crossings.iter().map(|c| self.without_nearest(c)).collect();
        let mut warnings = self.doubts(&crossings, &mut errors, "forces that are read cannot be refined there");
        if self.samples.first().is_none_or(|s| s.0 > 0.0) {
            warnings.push("there are no forces at rest: speeds of divergence are extrapolated".into());
        }
        self.told(&branches, &crossings, &errors, warnings)
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
        changed(crossing, &self.solved(&others).1)
    }

    /// What is not known well enough; sets the errors of divergence.
    fn doubts(&self, crossings: &[Crossing], errors: &mut [f64], hint: &str) -> Vec<String> {
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
                warnings.push(format!("the crossing at {place:.4} of the speed is known to {part:.1} % only: {hint}"));
            }
        }
        warnings
    }

    /// Motions and crossings with forces at some frequencies.
    fn solved(&self, samples: &[Sample]) -> Solved {
        let Some(fit) = Rational::of(samples, MISFIT) else { return (Vec::new(), Vec::new()) };
        let speed = |x: f64| self.scales.at(x).speed;
        // motions that do not oscillate, divergence among them, have the forces found at rest where these are known
        let rest = samples.first().filter(|s| s.0 == 0.0);
        let fitted = |kappa: f64| fit.at(Complex64::new(0.0, kappa));
        let forces = |kappa: f64| rest.filter(|_| kappa == 0.0).map_or_else(|| fitted(kappa), |s| s.1.clone());
        let flutter = Flutter::new(&self.matrices, &forces).varying(self.scales.varied(&speed));
        let upto = self.scales.upto(self.plan.most);
        let mut branches = flutter.branches(upto);
        let mut crossings = flutter.crossings(&branches, upto);
        // at the lowest speeds forces hardly act, and would be guessed
        let highest = self.highest_told();
        branches.iter_mut().for_each(|b| b.retain(|p| p.lambda.im.abs() <= highest * p.speed));
        crossings.retain(|c| c.kappa <= highest);
        (branches, crossings)
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
        let found = crossings.iter().map(|c| flutter.damping_perturbation(c)).collect();
        let first = crossings.iter().find(|c| c.kind == Kind::Flutter).or(crossings.first());
        let stream = first.map_or_else(|| self.scales.at(1.0), |c| self.scales.at(c.x));
        let last = self.samples.last().map_or(0.0, |s| s.0);
        let system = || StateSpaceAt::of((&self.matrices, &self.names), &forces, last, (&stream, self.scales));
        (found, self.plan.state_space.then(system).flatten())
    }

    fn told(
        &self,
        branches: &[Vec<Point>],
        crossings: &[Crossing],
        errors: &[f64],
        mut warnings: Vec<String>,
    ) -> FlutterAt {
        let s = self.scales;
        if branches.iter().all(Vec::is_empty) {
            warnings.push(format!(
                "no motion has a reduced frequency below {:.3}, twice the highest known: give higher `reduced_frequencies`",
                BEYOND * s.reduced_frequency(self.highest())
            ));
        }
        let (checks, state_space) = self.checked(crossings);
        let rows = crossings.iter().zip(errors).zip(&checks);
        let fastest = branches.iter().flatten().map(|p| p.lambda.norm()).fold(f64::MIN_POSITIVE, f64::max);
        let motion = |(mode, p): (usize, &Point)| {
            let stream = s.at(p.x);
            MotionRow {
                mode: mode + 1,
                speed_ratio: p.speed,
                dynamic_pressure: s.reference.dynamic_pressure() * stream.pressure,
                density: s.reference.density * stream.density(),
                altitude: stream.altitude,
                reduced_frequency: s.reduced_frequency(p.lambda.im.abs() / p.speed),
                damping: 2.0 * p.lambda.re / p.lambda.norm(),
                frequency: s.cycles * p.lambda.im.abs(),
                eigenvalue: [p.lambda.re / fastest, p.lambda.im / fastest],
            }
        };
        FlutterAt {
            mach: s.stream,
            matching: s.matching,
            crossings: rows.map(|((c, error), check)| self.row(c, *error, *check)).collect(),
            natural: self.natural(),
            reference: s.case_reference(),
            motions: branches.iter().enumerate().flat_map(|(m, b)| b.iter().map(move |p| (m, p))).map(motion).collect(),
            state_space,
            reduced_frequencies: self.samples.iter().map(|x| s.reduced_frequency(x.0)).collect(),
            forces: self.samples.iter().map(|x| x.1.iter().map(|z| [z.re, z.im]).collect()).collect(),
            coordinates: self.names.clone(),
            still: self.still.clone(),
            moved: vec![Mark::default(); self.names.len()],
            semichord: s.semichord,
            linear_iterations: self.iterations,
            residual: self.residual,
            warnings,
            ..FlutterAt::default()
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
        let s = self.scales;
        let last = self.samples.last().map_or(0.0, |x| x.0) * (1.0 + SAME);
        let equivalent = c.pressure.sqrt();
        let density = c.pressure / (c.speed * c.speed);
        // the frequency of pitch alone: what V* is measured with
        let alone = s.reduced_speed.map(|v| s.stream / (v * s.semichord));
        FlutterRow {
            kind: match c.kind {
                Kind::Flutter => "flutter",
                Kind::Restabilised => "restabilised",
                Kind::Divergence => "divergence",
            }
            .to_owned(),
            mode: c.mode + 1,
            speed_ratio: c.speed,
            speed_index: s.speed_index.map(|v| v * equivalent),
            reduced_speed: s.reduced_speed.map(|v| v * c.speed),
            speed: s.reference.speed * c.speed,
            density: s.reference.density * density,
            dynamic_pressure: s.reference.dynamic_pressure() * c.pressure,
            mass_ratio: s.mass_ratio.map(|mu| mu / density),
            altitude: s.at(c.x).altitude,
            reduced_frequency: s.reduced_frequency(c.kappa),
            frequency: s.cycles * c.frequency,
            frequency_ratio: alone.map(|w| c.frequency / w),
            error,
            cloud_error: None,
            shape: shares(&self.names, &self.units, &c.shape),
            g_method: check.map(|x| s.at(x).pressure.sqrt() / equivalent - 1.0),
            extrapolated: c.kappa > last || self.samples.first().is_none_or(|x| c.kappa < x.0 * (1.0 - SAME)),
        }
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
    let like = before.iter().filter(|b| b.kind == crossing.kind && b.mode == crossing.mode);
    like.map(|b| ((b.pressure / crossing.pressure).sqrt() - 1.0).abs()).fold(f64::INFINITY, f64::min)
}
