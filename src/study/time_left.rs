//! Time left of a whole run, of which the work of each part is known beside that of the others.
//!
//! A run goes through parts: clouds of a family, points of a polar, a steady start and a march, frequencies of small motions at some Mach
//! numbers. What a part takes is expected from those before it, seconds for each share of the work, and learned from its own pace the
//! more of it is done: with the done part d and t seconds so far, left = (1 − w)(T − t) + w t (1 − d)/d. The seconds T that were
//! expected count the less the more is done and the more of them are over: w = max(d², (t/T)⁴), 1 from t = T on.
use std::time::Instant;

/// Least done part that tells a pace.
const LEAST: f64 = 0.02;

/// A part of a run, as shares of the work of the whole, and how much of it is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Portion {
    /// Share of the work before the part, from 0 to 1.
    pub before: f64,
    /// Share of the part.
    pub own: f64,
    /// Done part of it, from 0 to 1.
    pub done: f64,
    /// True where the run may end before its last part: when the loads are known well enough.
    pub may_end_early: bool,
}

impl Portion {
    /// The only part of a run, of which this is done.
    pub const fn whole(done: f64) -> Self {
        Self { before: 0.0, own: 1.0, done, may_end_early: false }
    }

    /// Part number `k` of those that take these shares of `work`, in any unit.
    pub(crate) fn of(k: usize, work: &[f64]) -> Self {
        let all = work.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let before = work[..k.min(work.len())].iter().sum::<f64>() / all;
        Self { before, own: work.get(k).map_or(0.0, |w| w / all), ..Self::whole(0.0) }
    }

    /// The same with another done part.
    pub(crate) fn at(self, done: f64) -> Self {
        Self { done: done.clamp(0.0, 1.0), ..self }
    }

    /// The same where the run is itself the part `outer` of a larger one.
    pub(crate) fn within(self, outer: &Self) -> Self {
        Self {
            before: outer.before + outer.own * self.before,
            own: outer.own * self.own,
            done: self.done,
            may_end_early: self.may_end_early || outer.may_end_early,
        }
    }

    /// Share of the work of the whole that is done.
    fn place(&self) -> f64 {
        self.before + self.own * self.done
    }
}

/// Tells the time that is left from the portions that a run says it is in.
#[derive(Clone, Copy, Debug)]
pub struct TimeLeft {
    began: Instant,
    watched: Option<Watched>,
}

/// Where a run was seen for the first time, and its present part; times in seconds since the beginning.
#[derive(Clone, Copy, Debug)]
struct Watched {
    /// Share of the work that was done before: that of an earlier run, which this one goes on with.
    first: f64,
    /// Share before the present part, the done part of it that was there at its beginning, and when that was.
    part: f64,
    done: f64,
    since: f64,
    /// When the run was seen last.
    last: f64,
}

impl Default for TimeLeft {
    fn default() -> Self {
        Self { began: Instant::now(), watched: None }
    }
}

impl TimeLeft {
    /// Seconds left of the whole run, which is in this portion now; `None` where nothing is known of its pace yet.
    pub fn seconds(&mut self, now: &Portion) -> Option<f64> {
        self.after(self.began.elapsed().as_secs_f64(), now)
    }

    /// The same `seconds` after the beginning.
    fn after(&mut self, seconds: f64, now: &Portion) -> Option<f64> {
        if self.watched.is_none() && now.done == 0.0 && now.before > 0.0 {
            // a run that goes on says what it does before it is where it was
            return None;
        }
        let start = Watched { first: now.place(), part: now.before, done: now.done, since: 0.0, last: 0.0 };
        let seen = self.watched.get_or_insert(start);
        if seen.part != now.before {
            // what lies between two parts, as building a cloud, belongs to the second
            *seen = Watched { part: now.before, done: 0.0, since: seen.last, ..*seen };
        }
        seen.last = seconds;
        let (spent, done) = (seconds - seen.since, (now.done - seen.done).max(0.0));
        let before = now.before - seen.first;
        let rate = (before > 0.0).then(|| seen.since / before);
        let expected = rate.map(|rate| rate * now.own * (1.0 - seen.done));
        let paced = (done > LEAST).then(|| spent * (1.0 - now.done) / done);
        let left = match (expected, paced) {
            (Some(expected), Some(paced)) => {
                let own = (now.done * now.done).max((spent / expected.max(f64::MIN_POSITIVE)).min(1.0).powi(4));
                (expected - spent).max(0.0) * (1.0 - own) + paced * own
            }
            (expected, paced) => expected.map(|expected| (expected - spent).max(0.0)).or(paced)?,
        };
        let until_then = now.before + now.own - seen.first;
        Some(left + (1.0 - now.before - now.own).max(0.0) * (seconds + left) / until_then.max(f64::MIN_POSITIVE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is told at the times of `at`, of parts that take these seconds and are said to take these shares of work.
    fn told(takes: &[f64], work: &[f64], at: &[f64]) -> Vec<Option<f64>> {
        let mut left = TimeLeft::default();
        let end: f64 = takes.iter().sum();
        let mut all = Vec::new();
        for tick in 1..(end * 10.0) as usize {
            let now = 0.1 * tick as f64;
            let (mut k, mut start) = (0, 0.0);
            while now >= start + takes[k] {
                (k, start) = (k + 1, start + takes[k]);
            }
            // the residual falls faster and faster
            let done = ((now - start) / takes[k]).powi(2);
            let found = left.after(now, &Portion::of(k, work).at(done));
            if at.iter().any(|t| (t - now).abs() < 1e-9) {
                all.push(found);
            }
        }
        all
    }

    #[test]
    fn time_left_is_that_of_the_whole_run_and_not_of_its_present_part() {
        let takes = [1.0, 4.0, 16.0];
        let all = told(&takes, &takes, &[1.5, 4.5, 5.5, 10.0, 15.0, 20.0]);
        for (found, now) in all.into_iter().zip([1.5, 4.5, 5.5, 10.0, 15.0, 20.0]) {
            let (found, right) = (found.unwrap(), 21.0 - now);
            assert!((found - right).abs() < 1.0 + 0.3 * right, "{now}: {found} for {right}");
        }
    }

    #[test]
    fn parts_that_take_longer_than_expected_are_told_by_their_own_pace() {
        let found = told(&[1.0, 10.0], &[1.0, 3.0], &[9.0])[0].unwrap();
        assert!(found > 1.0 && found < 5.0, "{found}");
        assert_eq!(told(&[10.0], &[1.0], &[0.5]), [None]);
    }

    #[test]
    fn a_run_that_goes_on_knows_its_own_pace_alone() {
        let mut left = TimeLeft::default();
        assert_eq!(left.after(0.5, &Portion { before: 0.5, own: 0.5, ..Portion::whole(0.0) }), None);
        assert_eq!(left.after(1.0, &Portion::whole(0.8)), None);
        // a tenth in two seconds
        let found = left.after(2.0, &Portion::whole(0.9)).unwrap();
        assert!((found - 2.0).abs() < 1e-9, "{found}");
    }

    #[test]
    fn runs_within_runs_have_shares_of_shares() {
        let outer = Portion { before: 0.5, own: 0.5, done: 0.0, may_end_early: false };
        let inner = Portion::of(1, &[1.0, 3.0]).at(0.2).within(&outer);
        assert_eq!(inner, Portion { before: 0.625, own: 0.375, done: 0.2, may_end_early: false });
    }
}
