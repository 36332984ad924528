//! A periodic state that was found: its loads and fields.
use num_complex::Complex64;

use super::super::keeper::{Camera, FILM, together};
use super::super::look::{GasView, motion, pressure_coefficient};
use super::super::record::Log;
use super::super::record::trace::Sample;
use super::super::watch::{compare, sample};
use super::settled::PeriodicEyes;
use crate::case::{Case, Harmonics};
use crate::geometry::Surface;
use crate::math::Vector;
use crate::math::fourier::{Instances, Series};
use crate::math::jet::Jet;
use crate::motion::{BodyMotion, Motions, positions};
use crate::observe::loads::Coefficients;
use crate::problem::RunError;
use crate::scheme::{Exchange, Fluid, HasGas, Work};
use crate::system::{Instant, System};
use crate::time::harmonic::HarmonicBalance;

/// Samples of the loops.
const SAMPLES: usize = 256;
/// Steps in each of the periods that the table of structures holds, and these.
const STEPS: usize = 128;
const PERIODS: usize = 2;

/// Harmonics of a product of two flows over those of each.
const PRODUCTS: usize = 2;

/// Part of a length or radian by which a motion may miss itself a period later.
const REPEATS: f64 = 1e-9;
/// Parts of a period at which that is looked at.
const LOOKED_AT: [f64; 4] = [0.0, 0.13, 0.41, 0.77];

/// The equations of a period with a number of harmonics.
pub(super) fn build<'a, S: System>(
    system: &'a S,
    plan: &Harmonics,
    harmonics: usize,
    period: f64,
) -> HarmonicBalance<'a, S> {
    let omega = std::f64::consts::TAU / period;
    HarmonicBalance::new(system, Instances::of_harmonics(harmonics), omega, plan.oversample)
}

/// The period of a motion that repeats.
pub(super) fn period_of<S: HasGas<D>, const D: usize>(system: &S, log: &Log<'_>) -> Result<f64, RunError> {
    let period = log.period.ok_or_else(without_period)?;
    repeats(system.gas().cloud_motion.laws().iter(), period)?;
    Ok(period)
}

/// Refuses motions of bodies that do not come back after a period, or have none.
pub(crate) fn check_period<const D: usize>(motions: &Motions<D>) -> Result<(), RunError> {
    let period = motions.period().ok_or_else(without_period)?;
    repeats((0..motions.len()).map(|body| motions.of(body)), period)
}

fn without_period() -> RunError {
    RunError::NotPeriodic {
        what: "the motion does not repeat, but `[time] harmonics` finds flows that do".into(),
        hint: "take out what drifts in `[motion]`, a translation or a formula that does not return after the period, or \
               march with `[time.dual]`",
    }
}

/// Refuses laws that do not come back after a period.
fn repeats<'a, const D: usize>(laws: impl Iterator<Item = &'a BodyMotion<D>>, period: f64) -> Result<(), RunError> {
    for (body, law) in laws.enumerate() {
        for part in LOOKED_AT {
            let (a, b) = (law.pose(part * period), law.pose((part + 1.0) * period));
            let places = std::iter::once(Vector::ZERO).chain((0..D).map(Vector::axis));
            let miss = places.map(|x| (a.point(&x) - b.point(&x)).norm()).fold(0.0, f64::max);
            let (p, q) = (law.coordinates(part * period), law.coordinates((part + 1.0) * period));
            let bend = p.iter().zip(&q).zip(law.shapes()).map(|((p, q), shape)| (p - q).abs() * shape.size());
            let miss = bend.fold(miss, f64::max);
            if miss > REPEATS {
                return Err(RunError::NotPeriodic {
                    what: format!("the motion of body {body} misses itself by {miss:.3e} after a period"),
                    hint: "harmonic balance needs a motion that repeats; march with `[time.dual]` instead",
                });
            }
        }
    }
    Ok(())
}

/// f_1, f_2, … of a series.
pub(super) fn terms(series: &Series) -> Vec<Complex64> {
    let (c, n) = (series.coefficients(), series.instances().harmonics());
    (1..=n).map(|m| Complex64::new(c[m], -c[n + m])).collect()
}

/// The gas of a periodic solution at the instances that hold it.
pub(crate) struct PeriodFields<'a, const D: usize> {
    /// Equations.
    pub(crate) gas: &'a Fluid<D>,
    /// The instances.
    pub(crate) instances: Instances,
    /// Density, velocity, pressure, Cp and displacement of all real particles: quantity, particle, instance.
    pub(crate) moments: Vec<Vec<Vec<f64>>>,
}

/// The solution of a balance.
pub(super) struct PeriodicState<'a, S: System, const D: usize> {
    /// The equations of all instances.
    pub(super) balance: &'a HarmonicBalance<'a, S>,
    /// Those of one.
    pub(super) system: &'a S,
    /// The state of all instances.
    pub(super) state: &'a [f64],
    /// Period.
    pub(super) period: f64,
}

impl<S: HasGas<D>, const D: usize> PeriodicState<'_, S, D> {
    /// Frames at the instances where the equations are evaluated.
    pub(super) fn frames(&self) -> Vec<S::Frame> {
        self.balance.frame(&Instant::still(0.0), self.state)
    }

    /// The unknowns of the gas at all instances.
    pub(super) fn gas(&self) -> &[f64] {
        let (own, count) = (self.system.gas_unknowns(), self.balance.instances().count());
        &self.state[own.start * count..own.end * count]
    }

    /// Series of the loads; `None` without bodies.
    pub(super) fn loads(&self, log: &Log<'_>) -> Option<[Series; 3]> {
        PeriodicEyes::new(self.balance, self.system).series(&self.frames(), self.state, log)
    }

    /// Series of the loads of the flow between its instances; `None` without bodies.
    fn loads_between(&self, log: &Log<'_>) -> Option<[Series; 3]> {
        let mut all = [Vec::new(), Vec::new(), Vec::new()];
        self.between(|view, work| {
            let loads = view.coefficients(&log.axes, work).map_or([f64::NAN; 3], |c| [c.cl, c.cd, c.cm]);
            loads.into_iter().zip(&mut all).for_each(|(v, all)| all.push(v));
        });
        if self.system.gas().discretisation.cloud.interface.is_empty() {
            return None;
        }
        let [a, b, c] = all.map(|values| Series::of_values(&values).ok());
        Some([a?, b?, c?])
    }

    /// Calls `f` with the gas at instants that loads are told from.
    ///
    /// Loads are products, pressure times a normal that turns, and hold twice the harmonics of the flow: from as few samples as there
    /// are instances the second would seem to be a first.
    pub(super) fn between(&self, mut f: impl FnMut(&GasView<'_, D>, &mut Work<D>)) {
        let held = Instances::of_harmonics(PRODUCTS * self.balance.instances().harmonics() + 1);
        let mut work = self.system.work();
        for phase in held.times(1.0) {
            let one = self.state_at(phase);
            let frame = self.frame_at(phase, &one);
            f(&GasView::of(self.system, &frame, &one), self.system.gas_work(&mut work));
        }
    }

    /// The state at a phase.
    pub(super) fn state_at(&self, phase: f64) -> Vec<f64> {
        let mut one = vec![0.0; self.system.len()];
        self.balance.at_phase(self.state, phase, &mut one);
        one
    }

    /// Frame and state at an instance that holds the solution, to the bit.
    pub(super) fn instance(&self, n: usize) -> (S::Frame, Vec<f64>) {
        let mut one = vec![0.0; self.system.len()];
        self.balance.instance(self.state, n, &mut one);
        let phase = std::f64::consts::TAU * n as f64 / self.balance.instances().count() as f64;
        (self.frame_at(phase, &one), one)
    }

    fn frame_at(&self, phase: f64, one: &[f64]) -> S::Frame {
        self.balance.with_instant(self.state, phase, |at| self.system.frame(at, one))
    }

    /// Puts the loads of one period where those of the last period of a march would be; gives their series.
    pub(super) fn trace(&self, log: &mut Log<'_>) -> Option<[Series; 3]> {
        let (period, gas) = (self.period, self.system.gas());
        let [cl, cd, cm] = self.loads_between(log)?;
        log.record.trace.clear();
        for k in 0..=SAMPLES {
            let part = 1.0 + k as f64 / SAMPLES as f64;
            let phase = std::f64::consts::TAU * part;
            let loads = Coefficients { cl: cl.at(phase), cd: cd.at(phase), cm: cm.at(phase) };
            let time = part * period;
            let motion = motion(gas, time, &self.jets(phase));
            log.record.trace.push(Sample { time: log.units.case_time(time), loads, motion });
        }
        let instance = |time: f64| {
            let phase = std::f64::consts::TAU * time / period;
            let [angle, x, y, z, mode] = motion(gas, time, &self.jets(phase));
            let shift = [x, y, z, mode].into_iter().find(|s| s.abs() > 0.0).unwrap_or(0.0);
            [time / period, angle.to_degrees(), shift, cl.at(phase), cd.at(phase), cm.at(phase)]
        };
        let frames = self.frames();
        log.record.instances = frames.iter().map(|f| instance(self.system.gas_frame(f).time)).collect();
        Some([cl, cd, cm])
    }

    /// Coordinates of bodies that are unknowns, at a phase.
    fn jets(&self, phase: f64) -> Vec<Jet> {
        self.balance.with_instant(self.state, phase, |at| positions(at.coordinates))
    }

    /// Puts two periods of the structures where the steps of a march would be; nothing without structures.
    pub(super) fn sample_structures(&self, log: &mut Log<'_>) -> Result<(), RunError> {
        if log.structures.is_empty() {
            return Ok(());
        }
        let mut work = self.system.work();
        let at = |k: usize| {
            let phase = std::f64::consts::TAU * k as f64 / STEPS as f64;
            let one = self.state_at(phase);
            self.system.exchange(&self.frame_at(phase, &one), &one, &mut work)
        };
        let Some(period) = (0..STEPS).map(at).collect::<Option<Vec<Exchange>>>() else { return Ok(()) };
        // a run that is interrupted now does this again
        let iteration = log.record.iteration + 1;
        for k in 0..=PERIODS * STEPS {
            let time = self.period * k as f64 / STEPS as f64;
            log.structure(iteration, &sample(time, period[k % STEPS].clone(), &log.units))?;
        }
        log.record.balanced = Some(log.units.case_rate(std::f64::consts::TAU / self.period));
        Ok(())
    }

    /// Loads at the instances, evaluated twice.
    pub(super) fn compare(&self, log: &mut Log<'_>) -> Result<(), RunError> {
        let mut work = self.system.work();
        for n in 0..self.balance.instances().count() {
            let (frame, one) = self.instance(n);
            let view = GasView::of(self.system, &frame, &one);
            // a run that is interrupted now does this again
            let iteration = log.record.iteration + 1;
            compare(&view, self.system.gas_work(&mut work), iteration, view.frame.time, log)?;
        }
        Ok(())
    }

    /// Hands loads at the instances, pictures at phases, and coefficients in time of walls and field to `camera`.
    pub(super) fn write(
        &self,
        film: Option<&Surface<D>>,
        camera: &dyn Camera<D>,
        log: &Log<'_>,
    ) -> Result<(), RunError> {
        let case = &log.case;
        if let Some(surface) = film {
            let parts = FILM as usize;
            together(parts, |k| {
                let phase = std::f64::consts::TAU * ((k + 1) as f64 / parts as f64);
                let one = self.state_at(phase);
                let (frame, mut work) = (self.frame_at(phase, &one), self.system.work());
                let view = GasView::of(self.system, &frame, &one);
                camera.picture(case, surface, &view, self.system.gas_work(&mut work), k as u64 + 1)
            })?;
        }
        let (gas, instances) = (self.system.gas(), self.balance.instances());
        camera.period(case, &log.record.instances, &PeriodFields { gas, instances, moments: self.moments(case) })
    }

    /// Values of all real particles at the instances that hold the solution: density, velocity, pressure, Cp, and how far each is
    /// from where it is before any motion.
    fn moments(&self, case: &Case) -> Vec<Vec<Vec<f64>>> {
        let (system, fluid) = (self.system, self.system.gas());
        let (units, free) = (case.flow.units(), crate::scheme::start::free_stream::<D>(case));
        let rows = fluid.discretisation.cloud.n_real();
        let mut values = vec![vec![Vec::new(); rows]; 2 * D + 3];
        let mut work = system.work();
        for n in 0..self.balance.instances().count() {
            let (frame, one) = self.instance(n);
            let view = GasView::of(system, &frame, &one);
            let work = system.gas_work(&mut work);
            fluid.fill_states(view.frame, view.state, work);
            for (i, q) in work.state[..rows].iter().enumerate() {
                let velocity = view.frame.to_inertial_axes(&q.velocity) * units.speed;
                values[0][i].push(q.density * units.density);
                (0..D).for_each(|d| values[1 + d][i].push(velocity[d]));
                values[D + 1][i].push(q.pressure * units.pressure());
                values[D + 2][i].push(pressure_coefficient(q, &free));
                let shift = view.frame.place(i) - fluid.discretisation.cloud.x[i];
                (0..D).for_each(|d| values[D + 3 + d][i].push(shift[d]));
            }
        }
        values
    }
}
