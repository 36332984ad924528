//! The last line of a run, and what it cost.
use std::time::Instant;

use serde::Serialize;

use super::super::look::forces::GeneralisedForce;
use super::super::look::friction::Separation;
use super::super::look::{TipVortex, WakePlane};
use super::crosscheck::LoadCrosscheck;
use super::polar::PolarPoint;
use super::reference::ReferenceValues;
use super::solid_end::SolidEnd;
use super::trace::{Change, FirstHarmonics, LastPeriod, PeriodicLoads};
use crate::case::{Cloud, FreeStreamScales};
use crate::math::digits::short;
use crate::observe::convergence::Convergence;
use crate::observe::error_bars::ErrorBars;
use crate::observe::hinge::HingeMoment;
use crate::observe::induced::SpanLoad;
use crate::observe::loads::Coefficients;
use crate::observe::strips::RootLoads;
use crate::observe::swing::Swing;
use crate::observe::usage::peak_bytes;

/// The phase in which files, pictures and the report are written.
pub(crate) const FILES: &str = "files and pictures";

/// The phase in which error bars of marches and balances are found.
const BARS: &str = "error bars";

/// What a run found and what it took.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Always `summary`.
    pub event: &'static str,
    /// Title of the case.
    pub case: String,
    /// Run folder.
    pub run: String,
    /// Particles, images left out.
    pub particles: usize,
    /// Iterations over all stages.
    pub iterations: u64,
    /// Orders of magnitude that the residual of the last stage fell; null of a march, each of whose steps has its own, and where the
    /// start was a steady flow already.
    pub residual_drop: Option<f64>,
    /// True where the goal was reached: the residual fell as far as asked, or the loads of a march settled within `periodic_tolerance`.
    /// False too where a march did not come to its end; null where it did and was asked for nothing else.
    pub converged: Option<bool>,
    /// Processor time.
    pub cpu_seconds: f64,
    /// Wall time.
    pub wall_seconds: f64,
    /// Greatest memory of the process; 0 where the system does not tell.
    pub peak_bytes: u64,
    /// Loads from wall pressure and friction: of the steady flow, or of the instant `loads_at`.
    pub loads: Coefficients,
    /// The part of the pressure, where the gas has viscosity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loads_pressure: Option<Coefficients>,
    /// The part of the friction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loads_friction: Option<Coefficients>,
    /// Where friction turns against the stream.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub separation: Vec<Separation>,
    /// Loads from the momentum of the gas around the bodies; null without bodies.
    pub loads_momentum_balance: Option<Coefficients>,
    /// The vortex behind the tip of what lifts, in space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tip_vortex: Option<TipVortex>,
    /// Conservation; null for a harmonic balance, which does not go from one time to another.
    pub ledger: Option<Ledger>,
    /// What acts at the roots of wings and fins.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub root_loads: Vec<RootLoads>,
    /// Moments about the hinges of the case.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hinge_moments: Vec<HingeMoment>,
    /// Lift and induced drag of the load along the span.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub span_load: Option<SpanLoad>,
    /// Lift and drag from planes behind the bodies, the nearest first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wake_planes: Vec<WakePlane>,
    /// Evaluations of the residual of one instance on the cloud of the end, over all stages: those on coarser clouds count with
    /// their part of its particles.
    pub work_units: f64,
    /// Density, pressure, speed, sound speed and Mach number of the free stream, and the ratio of specific heats.
    pub free_stream: FreeStream,
    /// Chord of the load coefficients.
    pub chord: f64,
    /// The cloud of the end in the words of the case file, where the run refined it by what it found without that.
    pub cloud: Cloud,
    /// Time of the instant that `loads`, fields and pictures are of, in the units of the case; null of steady flows.
    pub loads_at: Option<f64>,
    /// Mach number of the free stream.
    pub mach: f64,
    /// Angle of attack in degrees, nose up positive.
    pub alpha_deg: f64,
    /// Reynolds number of the chord; null without viscosity.
    pub reynolds: Option<f64>,
    /// What loads are divided by; null without bodies.
    pub reference: Option<ReferenceValues>,
    /// What a harmonic balance found about itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub harmonic_balance: Option<BalanceReport>,
    /// What became of bodies on springs.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub structure: Vec<crate::observe::structure::StructureSummary>,
    /// What became of bodies made of particles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solid: Option<SolidEnd>,
    /// The last period of every coordinate of the structures, where the march was to find it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub swings: Vec<Option<Swing>>,
    /// Forces on the modes of `[gaf]`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub generalised_forces: Vec<GeneralisedForce>,
    /// Physical time at the end of a march, in the units of the case.
    pub time: f64,
    /// Steps in time whose inner iterations did not reach their goal.
    pub unconverged_steps: u32,
    /// Times a step in time was halved because its equations could not be solved.
    pub halved_steps: u32,
    /// What re-clouding did, where particles travel with the fluid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub re_clouding: Option<Reclouding>,
    /// How the loads of the last period differ from those of the one before, where the motion repeats; absent where there is none before.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub periodic_change: Option<Change>,
    /// First harmonics of the loads per motion, where that repeats.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub first_harmonics: Vec<FirstHarmonics>,
    /// Loads of the last period by momentum balance, against those on the walls.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub momentum_of_period: Option<LoadCrosscheck>,
    /// Mean and greatest loads of the last period of the motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_period: Option<LastPeriod>,
    /// Means and first harmonics of the loads in the last period of the motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub periodic_loads: Option<PeriodicLoads>,
    /// Last whole cycles of the lift of a march, found from its history: a frequency that no motion prescribes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lift_cycles: Option<crate::observe::cycles::Cycles>,
    /// Bytes per particle: cloud, operators, state and integrator.
    pub bytes_per_particle: f64,
    /// Processor milliseconds per particle.
    pub cpu_ms_per_particle: f64,
    /// Linear iterations of the last stage.
    pub linear_iterations: u32,
    /// Volume-weighted root mean square error of density, where the case has an exact solution.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_l2_density: Option<f64>,
    /// Half widths of the error bars of the loads, where they were found on a family of clouds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loads_error: Option<Coefficients>,
    /// That family, and how the loads converge on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid_convergence: Option<Convergence>,
    /// True where the gas is faster than sound somewhere at the end; not written.
    #[serde(skip)]
    pub supersonic: bool,
    /// Numbers of a march or a balance with their error bars, where these are asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_bars: Option<ErrorBars>,
    /// The points of a polar; all else is of the last of them whose flow is known.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub polar: Vec<PolarPoint>,
    /// What makes these results doubtful.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// Change of the loads in the last cycle of adaptation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adapt_change: Option<Coefficients>,
    /// Where the time went: name and wall seconds.
    pub phases: Vec<(String, f64)>,
}

/// The free stream in the units of the case.
#[derive(Clone, Debug, Serialize)]
pub struct FreeStream {
    /// Its state.
    #[serde(flatten)]
    pub state: FreeStreamScales,
    /// Ratio of specific heats.
    pub gamma: f64,
}

/// What a harmonic balance found about itself.
#[derive(Clone, Debug, Serialize)]
pub struct BalanceReport {
    /// Number of harmonics N.
    pub harmonics: usize,
    /// Instances at which the equations were evaluated.
    pub instances: usize,
    /// Part of the last harmonic in all harmonics of the loads; absent with one harmonic.
    pub tail_loads: Option<f64>,
    /// The same of the density, root mean square over the volume.
    pub tail_density: Option<f64>,
    /// |ωD x − ẋ|/|ẋ| of the walls, root mean squares over walls and instances: what the harmonics lose of the motion.
    pub wall_velocity_error: f64,
    /// Evaluations of the residual of one instance, those on coarser clouds among them.
    pub evaluations: u64,
    /// How far a march from there ends from it, where `check` asks for one.
    pub march: Option<MarchingCheck>,
}

/// How far a march from a harmonic balance ends from it.
#[derive(Clone, Debug, Serialize)]
pub struct MarchingCheck {
    /// Periods marched.
    pub periods: u32,
    /// Steps of each.
    pub steps_per_period: u32,
    /// Steps that did not reach their goal.
    pub unconverged: u32,
    /// Lift, where it has a first harmonic.
    pub cl: Option<Apart>,
    /// Drag.
    pub cd: Option<Apart>,
    /// Moment.
    pub cm: Option<Apart>,
}

/// A load in the last period of a march against that of the balance, over the first harmonic of the balance.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Apart {
    /// Difference of the means.
    pub mean: f64,
    /// Size of the difference of the first harmonics, complex.
    pub first_harmonic: f64,
}

impl MarchingCheck {
    /// A line for those who watch.
    pub(crate) fn told(&self) -> String {
        let named = [("lift", self.cl), ("drag", self.cd), ("moment", self.cm)];
        let apart = |(name, a): (&str, Option<Apart>)| {
            let a = a?;
            Some(format!("{name} {:.2} % (mean {:+.2} %)", 100.0 * a.first_harmonic, 100.0 * a.mean))
        };
        let all: Vec<String> = named.into_iter().filter_map(apart).collect();
        format!(
            "after {} periods of marching the first harmonics differ from the balance, in parts of themselves: {}",
            self.periods,
            if all.is_empty() { "no load has one".into() } else { all.join(", ") }
        )
    }
}

/// How often the cloud of travelling particles was built anew, and what that did.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Reclouding {
    /// Times the cloud was built anew; the last one is for the files.
    pub renewals: u32,
    /// Particles inserted into holes and at sides where the gas enters.
    pub inserted: u64,
    /// Particles removed where they were too near to others, to a wall or to a side.
    pub removed: u64,
    /// Greatest number of rows that fell back to first order.
    pub first_order: u32,
    /// What replacing particles added to the totals, over those at the start; momentum over the mass.
    pub transfer: Ledger,
}

/// What was lost, relative. Marching: change of the totals, what crossed open sides not counted as lost. Steady: net flux
/// through a zone around the bodies over the flux that enters it.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Ledger {
    /// Mass.
    pub mass: f64,
    /// Momentum: difference of the two load evaluations, in coefficients.
    pub momentum: f64,
    /// Energy.
    pub energy: f64,
}

/// Work of a run: evaluations of the residual of one instance times fluid particles, over all stages.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Work {
    /// So far.
    pub(crate) total: u64,
    /// Evaluations of the present stage that are in it.
    counted: u64,
}

impl Work {
    /// What was done before a restart.
    pub(crate) fn before(total: u64) -> Self {
        Self { total, counted: 0 }
    }

    /// A stage begins whose integrator has counted `evaluations` already.
    pub(crate) fn begin(&mut self, evaluations: u64) {
        self.counted = evaluations;
    }

    /// The integrator has counted up to `evaluations`, each of so many particles.
    pub(crate) fn add(&mut self, evaluations: u64, particles: usize) {
        self.total += evaluations.saturating_sub(self.counted) * particles as u64;
        self.counted = evaluations;
    }
}

impl Summary {
    /// False where the goal was not reached. A march to its end has reached all that it was asked for.
    pub fn succeeded(&self) -> bool {
        self.converged != Some(false)
    }

    /// Stream and reference values in one line; the stream of a polar differs from point to point.
    pub fn conditions(&self) -> String {
        let alone = self.polar.is_empty();
        let stream = format!("M {}, alpha {} deg", short(self.mach), short(self.alpha_deg));
        let reynolds = self.reynolds.filter(|_| alone).map(|re| format!("Re {}", short(re)));
        let reference = self.reference.as_ref().map(ReferenceValues::told);
        let all = [alone.then_some(stream), reynolds, reference];
        all.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }

    /// True where the loads are those of an instant: of a march, not of a balance.
    pub fn is_march(&self) -> bool {
        self.loads_at.is_some() && self.harmonic_balance.is_none()
    }

    /// Adds what finding the error bars took to the cost; `[processor, wall]` seconds as below.
    pub(crate) fn spent_on_bars(&mut self, [cpu, wall]: [f64; 2]) {
        self.phases.insert(1.min(self.phases.len()), (BARS.into(), wall - self.wall_seconds));
        (self.cpu_seconds, self.wall_seconds) = (cpu, wall);
    }

    /// Brings what the run cost up to date: `[processor, wall]` seconds since its beginning, the rest as the system tells it.
    pub(crate) fn spent(&mut self, [cpu, wall]: [f64; 2]) {
        let files = self.phases.iter_mut().find(|(name, _)| name == FILES);
        files.into_iter().for_each(|(_, seconds)| *seconds += wall - self.wall_seconds);
        (self.cpu_seconds, self.wall_seconds, self.peak_bytes) = (cpu, wall, peak_bytes());
        self.cpu_ms_per_particle = 1e3 * cpu / self.particles as f64;
    }
}

/// Processor and wall time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    wall: Instant,
    cpu: f64,
}

impl Clock {
    /// Starts now.
    pub(crate) fn start() -> Self {
        Self { wall: Instant::now(), cpu: crate::observe::usage::cpu_seconds() }
    }

    /// Wall seconds since the start.
    pub(crate) fn wall_seconds(&self) -> f64 {
        self.wall.elapsed().as_secs_f64()
    }

    /// Processor seconds since the start.
    pub(crate) fn cpu_seconds(&self) -> f64 {
        // threads that have ended are not counted any more
        (crate::observe::usage::cpu_seconds() - self.cpu).max(0.0)
    }
}
