//! Periodic motion of structures alone: the search harmonic after harmonic, what is recorded of the period, and checkpoints.
use std::f64::consts::TAU;

use super::super::monitor::{Monitor, Tick};
use super::super::time_left::Portion;
use super::march::{Marched, Study, Waves};
use super::pace::Pace;
use super::record::{PeriodicRow, ProbeHarmonic, Row, Work};
use crate::case::{HarmonicCount, Harmonics};
use crate::math::fourier::Instances;
use crate::math::reduce::sum;
use crate::problem::RunError;
use crate::problem::solids::Built;
use crate::solid::Structure;
use crate::solid::forces::State;
use crate::system::Mechanical;
use crate::time::forced::{Forced, NotFound, Place, Stop};
use crate::time::vibration::{Motion, Periodic, Vibration};

/// Rows of `history.csv`, at least, and for each harmonic.
const ROWS: usize = 128;
const ROWS_OF_HARMONIC: usize = 32;
/// Harmonics of `number = "auto"` at first.
const FIRST: usize = 3;

/// Refuses structures whose periodic motion is not found.
pub(crate) fn possible<const D: usize>(built: &Built<D>, plan: &Harmonics) -> Result<(), RunError> {
    let solid = &built.structure.solid;
    if solid.remembers() {
        return Err(RunError::Solid {
            what: "a material that remembers (plastic, viscoelastic, hypoelastic) has no harmonic balance".into(),
            hint: "use an elastic law, `linear`, `saint_venant_kirchhoff` or `neo_hookean`, with `damping` or `stiffness_damping`, or march with `[time.newmark]`".into(),
        });
    }
    if solid.supports.is_empty() {
        return Err(RunError::Solid {
            what: "nothing holds the structure, so that its mean place in a periodic motion is not determined".into(),
            hint: "add `[[body.solid.support]]`, or march with `[time.newmark]`".into(),
        });
    }
    let most = match plan.number {
        HarmonicCount::Fixed(n) => n as usize,
        HarmonicCount::Auto(_) => plan.most as usize,
    };
    let (n, largest) = (built.structure.displacements() * (most + 1), built.structure.largest_factored());
    match n <= largest {
        true => Ok(()),
        false => Err(RunError::Solid {
            what: format!(
                "a harmonic balance factors {} matrices of {} displacements; {largest} in all are the most",
                most + 1,
                n / (most + 1)
            ),
            hint: "take a larger `spacing` or fewer harmonics, or march with `[time.newmark]`".into(),
        }),
    }
}

/// One number of harmonics after another.
struct Balance<'s, 'a, const D: usize> {
    study: &'s Study<'a, D>,
    plan: &'s Harmonics,
    omega: f64,
    /// Iterations with fewer harmonics, linear ones, and halvings.
    before: [u32; 3],
}

/// Finds the periodic motion, from the equilibrium under the mean load or from where a checkpoint has it.
pub(crate) fn solve<const D: usize>(
    study: &Study<'_, D>,
    plan: &Harmonics,
    monitor: &mut dyn Monitor,
) -> Result<Marched, RunError> {
    possible(study.built, plan)?;
    let omega = study.case.balance_frequency().ok_or(RunError::NoStage)?;
    let mut balance = Balance { study, plan, omega, before: [0; 3] };
    balance.all(monitor)
}

impl<'s, const D: usize> Balance<'s, '_, D> {
    /// Harmonics of the stage that begins with those of `held`; `None` where these are enough.
    fn next(&self, held: Instances, tail: Option<f64>) -> Option<Instances> {
        let now = held.harmonics();
        let next = match self.plan.number {
            HarmonicCount::Fixed(n) => n as usize,
            // bending that stretches does so twice a period
            HarmonicCount::Auto(_) if now == 0 => FIRST.min(self.plan.most.max(1) as usize),
            HarmonicCount::Auto(_) if tail.is_some_and(|t| t <= self.plan.tail) => now,
            HarmonicCount::Auto(_) => (now + 2).min(self.plan.most.max(1) as usize),
        };
        (next > now).then(|| Instances::of_harmonics(next))
    }

    /// The equations with the harmonics of `held`; the mean is taken over as many instances as the harmonics wanted need.
    fn vibration(&self, held: Instances) -> Vibration<'s, Structure<D>> {
        let wanted = match self.plan.number {
            HarmonicCount::Fixed(n) => n as usize,
            HarmonicCount::Auto(_) => self.plan.most as usize,
        };
        let harmonics = if held.harmonics() == 0 { wanted } else { held.harmonics() };
        let seen = Instances::of_harmonics((self.plan.oversample.max(1.0) * harmonics as f64).ceil() as usize);
        let structure: &'s Structure<D> = &self.study.built.structure;
        Vibration::new(structure, Periodic { omega: self.omega, held, seen }, structure.solid.virgin())
    }

    fn all(&mut self, monitor: &mut dyn Monitor) -> Result<Marched, RunError> {
        let mut held = Instances::of_harmonics(0);
        let mut u = vec![0.0; self.study.built.structure.displacements()];
        let (mut place, mut pace) = (None, Pace::new(&self.study.case.output, 0));
        let saved = self.study.keeper.map_or(Ok(None), |keeper| keeper.sought(self.plan, self.study.built))?;
        if let Some(found) = saved {
            let iterations = found.before[0] + found.place.iterations;
            pace = Pace::new(&self.study.case.output, u64::from(iterations));
            (held, place, self.before) = (found.held, Some(found.place), found.before);
        }
        let stop = Stop { orders: self.plan.orders, tolerance: self.plan.tolerance, iterations: self.plan.iterations };
        loop {
            let mut vibration = self.vibration(held);
            let mut search = match place.take() {
                Some(place) => Forced::at(&mut vibration, stop, place),
                None => match Forced::new(&mut vibration, stop, u) {
                    Ok(search) => search,
                    Err(problem) => return Err(lost(&problem)),
                },
            };
            let stopped = self.search(&mut search, held, &mut pace, monitor)?;
            let found = std::mem::take(&mut search.place);
            if stopped {
                return Ok(self.marched(&vibration, held, &found, true));
            }
            let tail = vibration.tail(&found.u);
            let Some(more) = self.next(held, tail) else {
                self.frames(&vibration, held, &found.u)?;
                let done = self.marched(&vibration, held, &found, false);
                self.study.history(&done.rows)?;
                return Ok(done);
            };
            for (sum, more) in self.before.iter_mut().zip([found.iterations, found.linear, found.halved]) {
                *sum += more;
            }
            let next = self.vibration(more);
            u = next.resampled(&found.u, held);
            held = more;
        }
    }

    /// Searches with one number of harmonics; true where it was told to stop.
    fn search(
        &mut self,
        search: &mut Forced<'_, '_, Structure<D>>,
        held: Instances,
        pace: &mut Pace,
        monitor: &mut dyn Monitor,
    ) -> Result<bool, RunError> {
        while !search.finished() {
            let told = match search.step() {
                Ok(told) => told,
                Err(problem) => {
                    self.keep(&search.place, held)?;
                    return Err(lost(&problem));
                }
            };
            monitor.tick(&Tick {
                iteration: u64::from(self.before[0] + search.place.iterations),
                portion: Portion::whole((-told.residual.max(1e-16).log10() / self.plan.orders).clamp(0.0, 1.0)),
                residual: told.residual,
                cfl: told.taken,
                loads: None,
                particles: self.study.built.structure.solid.len(),
                march: None,
                point: None,
            });
            let (stopped, step) = (monitor.stop(), u64::from(self.before[0] + search.place.iterations));
            if (stopped || monitor.checkpoint() || pace.is_due(step)) && !search.finished() {
                pace.write(step, || self.keep(&search.place, held))?;
                if stopped {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// The state of the structure in a motion.
    fn state(&self, motion: &Motion) -> Vec<f64> {
        let history = self.study.built.structure.solid.virgin();
        [&motion.displacement[..], &motion.velocity, &history].concat()
    }

    /// A field file for each instance.
    fn frames(&self, vibration: &Vibration<'_, Structure<D>>, held: Instances, u: &[f64]) -> Result<(), RunError> {
        held.times(self.omega).into_iter().enumerate().try_for_each(|(n, time)| {
            let state = self.state(&vibration.at_phase(u, self.omega * time));
            self.study.keeper.map_or(Ok(()), |keeper| keeper.frame(n, time, self.study.built, &state))
        })
    }

    /// What was found.
    fn marched(
        &self,
        vibration: &Vibration<'_, Structure<D>>,
        held: Instances,
        place: &Place,
        stopped: bool,
    ) -> Marched {
        let [iterations, linear, halved] = self.before;
        let row = PeriodicRow {
            frequency: self.omega / TAU,
            omega: self.omega,
            harmonics: held.harmonics(),
            tail: vibration.tail(&place.u),
            iterations: iterations + place.iterations,
            linear: linear + place.linear,
        };
        Marched {
            state: self.state(&vibration.at_phase(&place.u, 0.0)),
            time: 0.0,
            iteration: u64::from(row.iterations),
            rows: if stopped { Vec::new() } else { self.rows(vibration, held, &place.u) },
            stopped,
            halved: halved + place.halved,
            residual: None,
            periodic: Some((row, self.probes(vibration, held, &place.u))),
        }
    }

    /// Mean and harmonics of the probes.
    fn probes(&self, vibration: &Vibration<'_, Structure<D>>, held: Instances, u: &[f64]) -> Vec<Waves> {
        let structure = &self.study.built.structure;
        let at = |n: usize| {
            let state = self.state(&vibration.at_phase(u, TAU * n as f64 / held.count() as f64));
            self.study.probes(&structure.state(0.0, &state))
        };
        let all: Vec<Vec<[f64; 3]>> = (0..held.count()).map(at).collect();
        let forward = held.to_coefficients();
        let h = held.harmonics();
        let probe = |p: usize| {
            let series = |a: usize| forward.apply(&all.iter().map(|probes| probes[p][a]).collect::<Vec<_>>());
            let axes: Vec<Vec<f64>> = (0..D).map(series).collect();
            let wave = |k: usize| ProbeHarmonic {
                harmonic: k,
                amplitude: axes.iter().map(|s| s[k].hypot(s[k + h])).collect(),
                phase_deg: axes.iter().map(|s| (-s[k + h]).atan2(s[k]).to_degrees()).collect(),
            };
            (axes.iter().map(|s| s[0]).collect(), (1..=h).map(wave).collect())
        };
        (0..self.study.built.probes.len()).map(probe).collect()
    }

    /// The period moment by moment: energies, probes, and work since its start by the trapezoidal rule.
    fn rows(&self, vibration: &Vibration<'_, Structure<D>>, held: Instances, u: &[f64]) -> Vec<Row> {
        let structure = &self.study.built.structure;
        let count = ROWS.max(ROWS_OF_HARMONIC * held.harmonics());
        let length = TAU / self.omega / count as f64;
        let (mut work, mut before) = (Work::default(), None::<[f64; 3]>);
        let one = |n: usize| {
            let motion = vibration.at_phase(u, TAU * n as f64 / count as f64);
            let state = self.state(&motion);
            let at = structure.state(n as f64 * length, &state);
            let powers = self.powers(&at, &motion);
            if let Some([loads, supports, damped]) = before {
                work.loads += 0.5 * length * (powers[0] + loads);
                work.supports += 0.5 * length * (powers[1] + supports);
                work.damped += 0.5 * length * (powers[2] + damped);
            }
            before = Some(powers);
            let (energy, probes) = (structure.solid.energy(&at), self.study.probes(&at));
            let thickness = self.study.built.thickness;
            Row { step: n as u32, time: at.time, energy: energy.times(thickness), work: work.times(thickness), probes }
        };
        (0..=count).map(one).collect()
    }

    /// Power of loads, of supports that move, and of damping.
    fn powers(&self, at: &State<'_, D>, motion: &Motion) -> [f64; 3] {
        let solid = &self.study.built.structure.solid;
        let mut force = vec![[0.0; D]; solid.len()];
        solid.outside(at, &mut force);
        let free = |i: usize, a: usize| if solid.is_held(i, a) { 0.0 } else { force[i][a] * at.velocity[i][a] };
        let loads = sum(solid.len(), |i| (0..D).map(|a| free(i, a)).sum());
        let mut supports = 0.0;
        if solid.is_moved() {
            let (mut storage, mut scratch) = (solid.work(), vec![0.0; at.history.len()]);
            solid.stress(at, &mut storage, &mut scratch);
            solid.forces(at, &storage, &mut force);
            let inertia = |i: usize, a: usize| solid.mass()[i] * motion.acceleration[i * D + a];
            let power = |i: usize, a: usize| (inertia(i, a) - force[i][a]) * at.velocity[i][a];
            let held = |i: usize, a: usize| if solid.is_held(i, a) { power(i, a) } else { 0.0 };
            supports = sum(solid.len(), |i| (0..D).map(|a| held(i, a)).sum());
        }
        [loads, supports, solid.damped(at)]
    }

    /// Writes a checkpoint.
    fn keep(&self, place: &Place, held: Instances) -> Result<(), RunError> {
        self.study.keeper.map_or(Ok(()), |keeper| keeper.keep_search(place, held, self.before))
    }
}

fn lost(problem: &NotFound) -> RunError {
    let text = problem.to_string();
    let (what, hint) = text.split_once("\nhint: ").unwrap_or((&text, ""));
    RunError::Solid { what: what.to_owned(), hint: hint.to_owned() }
}
