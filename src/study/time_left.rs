//! Time left of a whole run, of which the work of each part is known beside that of the others.
//!
//! A run goes through parts: clouds of a family, points of a polar, a steady start and a march, frequencies of small motions at some Mach
//! numbers. What a part takes is expected from those before it, seconds for each share of the work, and learned from its own pace the
//! more of it is done: with the done part d and t seconds so far, left = (1 − w)(T − t) + w t (1 − d)/d. The seconds T that were
//! expected count the less the more is done and the more of them are over: w = max(d², (t/T)⁴), 1 from t = T on. Where as much is done in
//! each second, as in a march, w = 1: the first steps say more than another part of the run.
//!
//! Parts that are left out, as the finest cloud of a point of a polar whose loads are known already, took no time, and as large a part of what is
//! to come is expected to be left out. What is told begins with a fiftieth of the work and does not rise, unless it would be far from
//! what is known by then.
use std::time::Instant;

/// Least done part that tells a pace.
const LEAST: f64 = 0.02;
/// Share of the work and seconds after which something is told for the first time.
const FIRST_SHARE: f64 = 0.02;
const FIRST_SECONDS: f64 = 1.5;
/// Longer times are told only where they are more than this many times what was told before, and this many seconds more.
const FAR: f64 = 1.5;
const FAR_SECONDS: f64 = 5.0;
/// A gap between two parts that is no round-off.
const GAP: f64 = 1e-9;

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
    /// True where as much is done in each second, as in a march.
    pub is_even: bool,
}

impl Portion {
    /// The only part of a run, of which this is done.
    pub const fn whole(done: f64) -> Self {
        Self { before: 0.0, own: 1.0, done, may_end_early: false, is_even: false }
    }

    /// The same of a run in which as much is done in each second.
    pub const fn even(done: f64) -> Self {
        Self { is_even: true, ..Self::whole(done) }
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
            may_end_early: self.may_end_early || outer.may_end_early,
            ..self
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
    /// What was told last, in seconds.
    told: Option<f64>,
}

/// Where a run was seen for the first time, and its present part; times in seconds since the beginning.
#[derive(Clone, Copy, Debug)]
struct Watched {
    /// Share of the work that was done before: that of an earlier run, which this one goes on with.
    first: f64,
    /// Share of the work that was left out.
    left_out: f64,
    /// Share before the present part and at its end, the done part of it that was there at its beginning, and when that was.
    part: f64,
    end: f64,
    done: f64,
    since: f64,
    /// When the run was seen last.
    last: f64,
}

impl Watched {
    /// The run in the first portion of it that is seen.
    fn first(now: &Portion) -> Self {
        let end = now.before + now.own;
        Self { first: now.place(), left_out: 0.0, part: now.before, end, done: now.done, since: 0.0, last: 0.0 }
    }

    /// The run in its next part, `seconds` after the beginning. What lies between two parts, as building a cloud, belongs to the second; a part that
    /// did not know that others follow, as what is done before a run is planned, lasted until then.
    fn follow(&mut self, now: &Portion, seconds: f64) {
        let gap = now.before - self.end;
        let left_out = self.left_out + if gap > GAP { gap } else { 0.0 };
        let since = if gap < -GAP { seconds } else { self.last };
        let (part, end) = (now.before, now.before + now.own);
        *self = Self { part, end, left_out, done: 0.0, since, ..*self };
    }

    /// Share of the work up to `place` that was done since the run was seen first.
    fn passed(&self, place: f64) -> f64 {
        (place - self.first - self.left_out).max(0.0)
    }

    /// Part of the work to come that is not expected to be left out.
    fn kept(&self) -> f64 {
        let passed = self.passed(self.part);
        if self.left_out > 0.0 { passed / (passed + self.left_out) } else { 1.0 }
    }

    /// Seconds left of the present part, `seconds` after the beginning; `None` where no pace is known.
    fn of_part(&self, seconds: f64, now: &Portion) -> Option<f64> {
        let (spent, done) = (seconds - self.since, (now.done - self.done).max(0.0));
        let before = self.passed(now.before);
        let rate = (before > 0.0 && self.since > 0.0).then(|| self.since / before);
        let expected = rate.map(|rate| rate * now.own * (1.0 - self.done));
        let paced = (done > LEAST).then(|| spent * (1.0 - now.done) / done);
        let (Some(expected), Some(paced)) = (expected, paced) else {
            return expected.map(|expected| (expected - spent).max(0.0)).or(paced);
        };
        let learned = (now.done * now.done).max((spent / expected.max(f64::MIN_POSITIVE)).min(1.0).powi(4));
        let own = if now.is_even { 1.0 } else { learned };
        Some((expected - spent).max(0.0) * (1.0 - own) + paced * own)
    }
}

impl Default for TimeLeft {
    fn default() -> Self {
        Self { began: Instant::now(), watched: None, told: None }
    }
}

impl TimeLeft {
    /// Seconds left of the whole run, which is in this portion now; `None` where nothing is known of its pace yet.
    pub fn seconds(&mut self, now: &Portion) -> Option<f64> {
        self.told_after(self.began.elapsed().as_secs_f64(), now)
    }

    /// What is told `seconds` after the beginning: no more than before, unless that was far too short.
    fn told_after(&mut self, seconds: f64, now: &Portion) -> Option<f64> {
        let left = self.after(seconds, now)?;
        let before = match self.told {
            Some(before) => before,
            None => {
                let passed = self.watched.map_or(0.0, |seen| seen.passed(now.place()));
                (passed >= FIRST_SHARE && seconds >= FIRST_SECONDS).then_some(left)?
            }
        };
        let is_far = left > FAR * before && left > before + FAR_SECONDS;
        self.told = Some(if is_far { left } else { left.min(before) });
        self.told
    }

    /// What is expected then.
    fn after(&mut self, seconds: f64, now: &Portion) -> Option<f64> {
        if self.watched.is_none() && now.done == 0.0 && now.before > 0.0 {
            // a run that goes on says what it does before it is where it was
            return None;
        }
        let seen = self.watched.get_or_insert(Watched::first(now));
        if seen.part != now.before {
            seen.follow(now, seconds);
        }
        seen.last = seconds;
        let left = seen.of_part(seconds, now)?;
        let until_then = seen.passed(now.before + now.own);
        let to_come = seen.kept() * (1.0 - now.before - now.own).max(0.0);
        Some(left + to_come * (seconds + left) / until_then.max(f64::MIN_POSITIVE))
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
        let outer = Portion { before: 0.5, own: 0.5, ..Portion::whole(0.0) };
        let inner = Portion::of(1, &[1.0, 3.0]).at(0.2).within(&outer);
        assert_eq!(inner, Portion { before: 0.625, own: 0.375, ..Portion::whole(0.2) });
    }

    #[test]
    fn parts_that_are_left_out_take_no_time_and_more_of_them_are_expected() {
        // points of a polar: a cloud of one share, and one of four that no point needs; a second each
        let (mut left, work) = (TimeLeft::default(), [1.0, 4.0].repeat(5));
        let mut told = Vec::new();
        for tick in 1..50 {
            let now = 0.1 * f64::from(tick);
            let portion = Portion::of(2 * now as usize, &work).at(now.fract());
            told.push((now, left.told_after(now, &portion)));
        }
        for (now, found) in told.iter().filter(|(now, _)| *now > 2.0) {
            let (found, right) = (found.unwrap(), 5.0 - now);
            // whether the present point needs its second cloud is not known
            assert!((found - right).abs() < 0.9 + 0.1 * right, "{now}: {found} for {right}");
        }
        assert!(told.windows(2).all(|w| w[1].1.unwrap_or(0.0) <= w[0].1.unwrap_or(f64::INFINITY)), "{told:?}");
    }

    #[test]
    fn what_is_told_begins_late_and_rises_only_where_it_was_far_too_short() {
        // a steady start that is said to take a fifth of the work, and a march that takes longer than that
        for (march, most_rises) in [(5.0, 0), (60.0, 1)] {
            let (mut left, work) = (TimeLeft::default(), [1.0, 4.0]);
            let mut told = vec![];
            for tick in 1..(10.0 * (1.0 + march)) as usize {
                let now = 0.1 * tick as f64;
                let k = usize::from(now >= 1.0);
                let done = if k == 0 { now } else { (now - 1.0) / march };
                let portion = Portion { is_even: k == 1, ..Portion::of(k, &work).at(done) };
                let found = left.told_after(now, &portion);
                assert!(now >= FIRST_SECONDS - 1e-9 || found.is_none(), "{now}");
                told.extend(found.map(|found| (now, found)));
            }
            let rises = told.windows(2).filter(|w| w[1].1 > w[0].1).count();
            assert!(rises <= most_rises, "{march}: {told:?}");
            for (now, found) in told.iter().filter(|(now, _)| *now > 1.1 + LEAST * march) {
                let right = 1.0 + march - now;
                assert!((found - right).abs() < 0.5 + 0.1 * right, "{now}: {found} for {right}");
            }
        }
    }
}
