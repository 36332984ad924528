//! A pilot: the steady flow of a case on a coarser cloud, solved in a moment to learn what such a flow costs on this machine.
//!
//! How many iterations a flow takes, and how far they run in parallel, nobody knows who has not seen it: a bow shock takes five times
//! those of a section at Mach 0.5. What does not depend on the number of particles is seen on few of them.
use std::path::Path;
use std::time::{Duration, Instant};

use super::accuracy;
use super::cost::Pilot;
use super::look::Snapshot;
use super::monitor::{Monitor, Tick};
use super::recipe;
use super::session::Session;
use super::setup::behind_shocks;
use crate::case::{Case, Initial, Temporal};
use crate::cloud::CloudSpec;
use crate::cloud::layout::count;
use crate::geometry::Surface;

/// Greatest number of particles of a pilot: a fraction of a second in the plane.
const MOST: f64 = 6000.0;
/// Factors on the spacing.
const FACTORS: [f64; 2] = [2.0, 4.0];

/// Longest that a pilot may take, in 2-D and 3-D, where the cloud of the case itself takes longer: a flow that is not solved by then
/// tells nothing.
const LONGEST: [Duration; 2] = [Duration::from_secs(2), Duration::from_secs(10)];

/// Ends a run at a moment.
struct Bounded(Instant);

impl Monitor for Bounded {
    fn tick(&mut self, _: &Tick) {}
    fn note(&mut self, _: &str) {}
    fn stop(&self) -> bool {
        Instant::now() > self.0
    }
}

/// Solves the steady flow around the bodies of a case, whose cloud has `n` particles, on a coarser cloud. `None` where a run has no
/// such start or it counts for little, where even the coarser cloud has many particles, and where it is not solved soon.
pub(super) fn fly<const D: usize>(case: &Case, input: &Path, surface: Option<&Surface<D>>, n: usize) -> Option<Pilot> {
    let relaxation = recipe::relaxation(case).filter(|_| !matches!(case.time, Temporal::Harmonics(_)))?;
    if case.bodies.is_empty() || !matches!(case.initial, Initial::FreeStream) {
        return None;
    }
    let factor = FACTORS.into_iter().find(|f| n as f64 / f.powi(D as i32) <= MOST)?;
    let mut coarse = accuracy::scaled(case.points().first()?, factor);
    (coarse.time, coarse.accuracy) = (Temporal::Steady(relaxation), None);
    (coarse.motion, coarse.gaf) = (None, None);
    // what moves in modes alone is rigid here, and not made of particles
    let full: Vec<usize> = coarse.solids().map(|(i, ..)| i).collect();
    for (i, body) in coarse.bodies.iter_mut().enumerate() {
        body.motion = None;
        body.solid = body.solid.take().filter(|_| full.contains(&i));
    }
    coarse.structures.clear();
    coarse.compare.clear();
    coarse.adapt.cycles = 0;
    let mut session = Session::open(&coarse, input).ok()?;
    session.solve(&mut Bounded(Instant::now() + LONGEST[D - 2])).ok()?;
    let found = session.summary()?;
    let following = followed(case, surface?, session.field()?).unwrap_or(1.0);
    Some(Pilot { particles: found.particles as f64, seconds: found.wall_seconds, following })
}

/// Particles of the cloud of a case that follows the shocks in `field` over those of one that does not; `None` where it does not.
fn followed<const D: usize>(case: &Case, surface: &Surface<D>, field: &Snapshot) -> Option<f64> {
    let sources = behind_shocks(case, surface, field, 1.0);
    if sources.is_empty() {
        return None;
    }
    let cells = |sources: &[_]| count(&CloudSpec::of_case(case), Some(surface), sources).ok();
    Some(cells(&sources)? as f64 / cells(&[])? as f64)
}
