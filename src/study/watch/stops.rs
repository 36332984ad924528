//! When to stop.
use super::super::record::Log;
use super::drive::{Now, Observer, Wish};
use crate::observe::swing::Swing;
use crate::scheme::HasGas;
use crate::system::System;

/// Ends after a number of iterations.
pub(crate) struct Limit {
    /// The number.
    pub(crate) iterations: u32,
}

impl<S: System> Observer<S, Log<'_>> for Limit {
    fn wish(&mut self, now: &mut Now<'_, S>, _: &Log<'_>) -> Option<Wish> {
        (now.mark().iteration >= self.iterations).then_some(Wish::GiveUp)
    }
}

/// Ends a relaxation that has not come nearer to a steady state for a number of iterations.
pub(crate) struct Resting {
    /// The number.
    pub(crate) patience: u32,
}

impl<S: System> Observer<S, Log<'_>> for Resting {
    fn wish(&mut self, now: &mut Now<'_, S>, _: &Log<'_>) -> Option<Wish> {
        (now.mark().resting >= self.patience).then_some(Wish::GiveUp)
    }
}

/// Ends a relaxation before another one whose residual falls no more and whose loads have come to rest: it has given what the next
/// one begins from.
pub(crate) struct Given {
    /// Iterations without a new smallest residual.
    pub(crate) patience: u32,
    /// Range of loads over as many iterations and the last one that fell, in the largest of them, that counts as rest.
    pub(crate) range: f64,
}

impl<S: System> Observer<S, Log<'_>> for Given {
    fn wish(&mut self, now: &mut Now<'_, S>, log: &Log<'_>) -> Option<Wish> {
        let resting = now.mark().resting >= self.patience;
        (resting && at_rest(log, self.patience as usize + 1, self.range)).then_some(Wish::GiveUp)
    }
}

/// True where loads kept within `range`, in the largest of them, over the last `iterations`.
fn at_rest(log: &Log<'_>, iterations: usize, range: f64) -> bool {
    let ends = log.record.history.last_loads(iterations);
    let largest = ends.iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs()));
    ends.iter().all(|[low, high]| high - low <= range * largest)
}

/// Ends a relaxation whose residual, over all of it, has found no new smallest value for a number of iterations: one that swings may
/// begin anew again and again.
pub(crate) struct Swinging {
    /// The number.
    pub(crate) patience: usize,
}

impl<S: System> Observer<S, Log<'_>> for Swinging {
    fn wish(&mut self, now: &mut Now<'_, S>, log: &Log<'_>) -> Option<Wish> {
        let since = log.record.history.since_smallest(now.mark().iteration as usize);
        (since >= self.patience).then_some(Wish::GiveUp)
    }
}

/// Ends a relaxation whose loads have come to rest, though its residual falls on slowly: a wake may take hundreds of iterations to
/// settle that move no load.
pub(crate) struct Flat {
    /// Residual over its first value from which on loads are looked at.
    pub(crate) residual: f64,
    /// Range of loads over the last iterations, in the largest of them, that counts as rest.
    pub(crate) range: f64,
    /// How many iterations these are.
    pub(crate) iterations: usize,
}

impl<S: System> Observer<S, Log<'_>> for Flat {
    fn wish(&mut self, now: &mut Now<'_, S>, log: &Log<'_>) -> Option<Wish> {
        let mark = now.mark();
        if mark.residual > self.residual || (mark.iteration as usize) < self.iterations {
            return None;
        }
        at_rest(log, self.iterations, self.range).then_some(Wish::Finish)
    }
}

/// Ends where the monitor says so.
pub(crate) struct Told;

impl<S: System> Observer<S, Log<'_>> for Told {
    fn wish(&mut self, _: &mut Now<'_, S>, log: &Log<'_>) -> Option<Wish> {
        log.stopped().then_some(Wish::Stop)
    }
}

/// Ends a march at the end of a period whose loads are those of the period before.
pub(crate) struct Periodic {
    /// Change below which they are.
    pub(crate) tolerance: f64,
}

impl<S: System> Observer<S, Log<'_>> for Periodic {
    fn wish(&mut self, now: &mut Now<'_, S>, log: &Log<'_>) -> Option<Wish> {
        let mark = now.mark();
        // a checkpoint may have been written by the very step that ended the march
        let change = log.change_of_period(mark.time, now.before).filter(|_| mark.iteration > 0)?;
        (change < self.tolerance).then_some(Wish::Finish)
    }
}

/// Ends a march whose structures move in a period as they did in the one before.
pub(crate) struct Alike {
    /// About the period, in the time of the case.
    pub(crate) period: f64,
    /// Periods that were looked at.
    pub(crate) seen: u64,
}

impl Alike {
    /// Change of an amplitude from one period to the next below which they are alike.
    pub(crate) const CHANGE: f64 = 0.002;
    /// Periods after which that is looked at.
    const LEAST: u64 = 6;
    /// Amplitude over the largest below which a coordinate may do as it likes.
    const FAINT: f64 = 1e-3;
}

impl<S: System> Observer<S, Log<'_>> for Alike {
    fn wish(&mut self, _: &mut Now<'_, S>, log: &Log<'_>) -> Option<Wish> {
        let time = log.record.structures.time.last()?;
        let periods = (time / self.period * (1.0 + f64::EPSILON)) as u64;
        if periods <= self.seen.max(Self::LEAST - 1) {
            return None;
        }
        self.seen = periods;
        let swings: Vec<Swing> = log.swings(self.period).into_iter().flatten().collect();
        let least = Self::FAINT * swings.iter().map(|s| s.amplitude).fold(0.0, f64::max);
        let alike = |s: &Swing| s.change < Self::CHANGE || s.amplitude < least;
        (!swings.is_empty() && swings.iter().all(alike)).then_some(Wish::Finish)
    }
}

/// Pauses a march whose particles have left their lists.
pub(crate) struct Worn<'a, S, const D: usize> {
    /// The system.
    pub(crate) system: &'a S,
}

impl<S: HasGas<D>, const D: usize> Observer<S, Log<'_>> for Worn<'_, S, D> {
    fn wish(&mut self, now: &mut Now<'_, S>, _: &Log<'_>) -> Option<Wish> {
        let frame = self.system.gas_frame(now.standing().frame);
        self.system.gas().is_worn(frame).then_some(Wish::Pause)
    }
}
