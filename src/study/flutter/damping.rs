//! Damping along the speed: how fast motions grow beyond their crossings, and what two clouds say of it.
//!
//! Where a motion hardly grows, or hardly decays, the error of its damping decides whether there is flutter at all. That error is estimated
//! by the difference to a coarser cloud. A crossing moves by the error of the damping over its slope, ΔV = Δg/|dg/dV|. Two clouds show no
//! order of convergence, so that the error bar of a crossing has a safety factor: Roache's 3/(rᵖ − 1) for r times the spacing, with twice of
//! it 1 at second order and 3 at the first, which shocks leave; with a third cloud 1.25/(r − 1) (J. Fluids Eng. 116, 1994,
//! doi:10.1115/1.2910291).
use crate::problem::coarser::COARSER;
use crate::record::flutter::MotionRow;

/// Safety factor of a difference to a cloud with twice the spacing: the mean of what smooth flow and flow with shocks ask for.
const SAFETY: f64 = 2.0;
/// The same, over r − 1, to a third cloud that is nearer.
const THIRD: f64 = 1.25;
/// Part of the speed on either side of a crossing over which the slope is taken.
const AROUND: f64 = 0.1;
/// Between this part of the speed of a crossing and its inverse both clouds are compared: at one speed alone they may agree by chance.
const COMPARED: f64 = 0.5;
/// Part of the speed beyond a crossing in which growth is looked at.
const BEYOND: f64 = 0.2;
/// Damping g that structures usually have: flutter that grows less is shallow.
const SHALLOW: f64 = 0.03;
/// Damping g that is no growth: structures have more.
pub(super) const LEAST: f64 = 1e-3;

/// The damping of a branch along the root of the dynamic pressure over that of the case.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    pub(super) branch: String,
    points: Vec<Sample>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    place: f64,
    damping: f64,
    frequency: f64,
}

/// Why the cloud decides whether there is flutter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum What {
    /// The motion grows on the coarser cloud, and decays on this one.
    CoarserCloudOnly,
    /// It decays on both, by less than both differ.
    Nearly,
    /// It grows on this cloud, by less than both differ.
    ThisCloudOnly,
    /// Between two ranges in which it grows it decays by less than both clouds differ.
    Gap,
}

impl What {
    /// Its name in files.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::CoarserCloudOnly => "coarser_cloud_only",
            Self::Nearly => "nearly",
            Self::ThisCloudOnly => "this_cloud_only",
            Self::Gap => "gap",
        }
    }
}

/// A range of places in which the cloud decides.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Region {
    pub(super) what: What,
    pub(super) ends: [f64; 2],
    /// Damping nearest to growth, in a gap to decay: on this cloud and on the other.
    pub(super) damping: [f64; 2],
}

/// The same branch on both clouds: place, damping here, damping there.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Pair {
    pub(super) branch: String,
    points: Vec<[f64; 3]>,
}

/// Growth beyond a crossing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Growth {
    /// Greatest damping over the next fifth of the speed.
    pub(super) most: f64,
    /// Damping that would hold the motion, where that grows little.
    pub(super) holding: Option<f64>,
}

/// Safety factor of a difference to a cloud with `ratio` times the spacing.
pub(super) fn safety(ratio: f64) -> f64 {
    if ratio < COARSER { THIRD / (ratio - 1.0) } else { SAFETY }
}

/// Curves of motions that oscillate; `reference` is the dynamic pressure of the case.
pub(super) fn curves(motions: &[MotionRow], reference: f64) -> Vec<Curve> {
    let mut all: Vec<Curve> = Vec::new();
    for m in motions.iter().filter(|m| m.mode.is_some() && m.frequency > 0.0 && m.dynamic_pressure > 0.0) {
        let sample =
            Sample { place: (m.dynamic_pressure / reference).sqrt(), damping: m.damping, frequency: m.frequency };
        match all.iter_mut().find(|c| c.branch == m.branch) {
            Some(own) => own.points.push(sample),
            None => all.push(Curve { branch: m.branch.clone(), points: vec![sample] }),
        }
    }
    all
}

impl Curve {
    /// Damping and frequency at a place; `None` beyond the ends.
    fn at(&self, place: f64) -> Option<[f64; 2]> {
        let after = self.points.iter().position(|p| p.place >= place)?;
        let b = self.points[after];
        let Some(a) = after.checked_sub(1).map(|k| self.points[k]) else {
            return (b.place == place).then_some([b.damping, b.frequency]);
        };
        let part = (place - a.place) / (b.place - a.place);
        let between = |a: f64, b: f64| a + part * (b - a);
        Some([between(a.damping, b.damping), between(a.frequency, b.frequency)])
    }

    /// Growth beyond the crossing at `place`.
    pub(super) fn growth(&self, place: f64) -> Option<Growth> {
        let beyond = || self.points.iter().filter(|p| p.place > place);
        let most = beyond().take_while(|p| p.place <= (1.0 + BEYOND) * place).map(|p| p.damping).reduce(f64::max)?;
        // a hump that ends is held by its top
        let hump = beyond().take_while(|p| p.damping > 0.0).map(|p| p.damping).fold(0.0, f64::max);
        let ends = beyond().any(|p| p.damping <= 0.0);
        let holding = if ends { hump } else { most };
        Some(Growth { most, holding: (most < SHALLOW).then_some(holding) })
    }
}

/// Branches of this cloud beside those of the other that move alike: at each place the nearest roots belong together.
pub(super) fn pairs(fine: &[Curve], coarse: &[Curve]) -> Vec<Pair> {
    let mut all: Vec<Pair> = fine.iter().map(|c| Pair { branch: c.branch.clone(), ..Pair::default() }).collect();
    let mut places: Vec<f64> = fine.iter().flat_map(|c| &c.points).map(|p| p.place).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    for place in places {
        let [here, there] = [fine, coarse].map(|all| all.iter().map(|c| c.at(place)).collect::<Vec<_>>());
        let apart = |a: &[f64; 2], b: &[f64; 2]| (a[1] / b[1] - 1.0).hypot(0.5 * (a[0] - b[0]));
        let mut near: Vec<(f64, usize, usize)> = Vec::new();
        for (i, a) in here.iter().enumerate() {
            near.extend(there.iter().enumerate().filter_map(|(j, b)| Some((apart(a.as_ref()?, b.as_ref()?), i, j))));
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut left, mut right) = (vec![false; fine.len()], vec![false; coarse.len()]);
        for (_, i, j) in near {
            let own = fine[i].points.iter().any(|p| p.place == place);
            if !left[i] && !right[j] {
                (left[i], right[j]) = (true, true);
                if let (Some(a), Some(b), true) = (here[i], there[j], own) {
                    all[i].points.push([place, a[0], b[0]]);
                }
            }
        }
    }
    all
}

impl Pair {
    /// By which part of the speed the crossing at `place` may move: difference of damping around it over its slope. Damping goes with the
    /// speed, and so does its difference.
    pub(super) fn moves(&self, place: f64) -> Option<f64> {
        let around: Vec<&[f64; 3]> = self.points.iter().filter(|p| (p[0] / place - 1.0).abs() <= AROUND).collect();
        let (first, last) = (around.first()?, around.last()?);
        let slope = (last[1] - first[1]) / (last[0] - first[0]) * place;
        let compared = self.points.iter().filter(|p| (COMPARED..=COMPARED.recip()).contains(&(p[0] / place)));
        let squares: Vec<f64> = compared.map(|p| ((p[1] - p[2]) * place / p[0]).powi(2)).collect();
        let apart = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        (around.len() > 1 && slope != 0.0).then(|| apart / slope.abs())
    }

    /// Ranges in which the cloud decides whether the motion grows.
    pub(super) fn regions(&self) -> Vec<Region> {
        let p = &self.points;
        let apart = |k: usize| (p[k][1] - p[k][2]).abs();
        let grows: Vec<[usize; 2]> = runs(p.len(), |k| p[k][1] > 0.0);
        let top = |[a, b]: [usize; 2], c: usize, sign: f64| {
            sign * p[a..=b].iter().map(|p| sign * p[c]).fold(f64::NEG_INFINITY, f64::max)
        };
        let region = |what: What, run: [usize; 2], sign: f64| Region {
            what,
            ends: run.map(|k| p[k][0]),
            damping: [top(run, 1, sign), top(run, 2, sign)],
        };
        let mut all = Vec::new();
        for run in runs(p.len(), |k| p[k][1] + apart(k) > 0.0) {
            let within = |g: &[usize; 2]| g[0] <= run[1] && run[0] <= g[1];
            let matters = (run[0]..=run[1]).any(|k| p[k][1] + apart(k) > LEAST);
            if matters && !grows.iter().any(within) {
                let what = if top(run, 2, 1.0) > 0.0 { What::CoarserCloudOnly } else { What::Nearly };
                all.push(region(what, run, 1.0));
            }
        }
        for run in &grows {
            let sure = (run[0]..=run[1]).any(|k| p[k][1] > apart(k));
            // flutter that has only just begun where nothing more is looked at
            let just = run[1] + 1 == p.len() && p[run[1]][2] > 0.0;
            if !sure && !just {
                all.push(region(What::ThisCloudOnly, *run, 1.0));
            }
        }
        for pair in grows.windows(2) {
            let gap = [pair[0][1] + 1, pair[1][0] - 1];
            if (gap[0]..=gap[1]).all(|k| p[k][1] + apart(k) >= 0.0) {
                all.push(region(What::Gap, gap, -1.0));
            }
        }
        all.sort_by(|a, b| a.ends[0].total_cmp(&b.ends[0]));
        all
    }
}

/// Ranges of numbers below `n` that are such.
fn runs(n: usize, such: impl Fn(usize) -> bool) -> Vec<[usize; 2]> {
    let mut all: Vec<[usize; 2]> = Vec::new();
    for k in (0..n).filter(|k| such(*k)) {
        match all.last_mut().filter(|run| run[1] + 1 == k) {
            Some(run) => run[1] = k,
            None => all.push([k, k]),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(branch: &str, frequency: f64, damping: impl Fn(f64) -> f64) -> Curve {
        let sample = |k: i32| {
            let place = 0.02 * f64::from(k);
            Sample { place, damping: damping(place), frequency }
        };
        Curve { branch: branch.into(), points: (1..=200).map(sample).collect() }
    }

    /// A hump around 1 whose top is `top`, and flutter from 3 on.
    fn hump(top: f64) -> impl Fn(f64) -> f64 {
        move |x: f64| top - (x - 1.0).powi(2) + if x > 2.0 { (x - 2.0).powi(2) * 2.0 } else { 0.0 }
    }

    fn regions(fine: f64, coarse: f64) -> Vec<(What, bool)> {
        let [a, b] = [fine, coarse].map(|top| [curve("mode 1", 1.0, hump(top)), curve("mode 2", 2.0, |x| -0.1 * x)]);
        let all: Vec<Region> = pairs(&a, &b).iter().flat_map(Pair::regions).collect();
        all.iter().map(|r| (r.what, r.ends[0] < 1.0 && r.ends[1] > 1.0 && r.ends[1] < 2.0)).collect()
    }

    #[test] // the tops of mode 1 at Mach .90 with spacings of 1/64, 1/128 and 1/256: −.021, +.030, −.014
    fn flutter_that_a_cloud_makes_or_hides_is_told() {
        assert_eq!(regions(-0.014, 0.030), [(What::CoarserCloudOnly, true)]);
        assert_eq!(regions(0.030, -0.021), [(What::ThisCloudOnly, true)]);
        assert_eq!(regions(-0.010, -0.025), [(What::Nearly, true)]);
        assert_eq!(regions(-0.010, -0.012), []);
        assert_eq!(regions(0.1, 0.09), []);
    }

    #[test]
    fn decay_between_two_ranges_of_growth_that_a_cloud_decides_is_told() {
        let two = |depth: f64| move |x: f64| (x - 1.0) * (3.0 - x) * ((x - 2.0).powi(2) - depth);
        let [a, b] = [0.01, -0.01].map(|depth| [curve("mode 1", 1.0, two(depth))]);
        let found: Vec<What> = pairs(&a, &b)[0].regions().iter().map(|r| r.what).collect();
        assert_eq!(found, [What::Gap]);
        let [a, b] = [0.3, 0.28].map(|depth| [curve("mode 1", 1.0, two(depth))]);
        assert_eq!(pairs(&a, &b)[0].regions(), []);
    }

    #[test]
    fn a_crossing_moves_by_the_difference_of_damping_over_its_slope() {
        let [a, b] = [0.0, 0.002].map(|by| [curve("mode 1", 1.0, move |x| 0.2 * (x - 2.0) + by * x)]);
        let moves = pairs(&a, &b)[0].moves(2.0).unwrap();
        assert!((moves - 0.004 / 0.2 / 2.0).abs() < 1e-9, "{moves}");
        // where both agree by chance the difference at other speeds tells
        let [a, b] = [0.0, 0.01].map(|by| [curve("mode 1", 1.0, move |x| 0.2 * (x - 2.0) + by * (x - 2.0))]);
        assert!(pairs(&a, &b)[0].moves(2.0).unwrap() > 0.01);
    }

    #[test] // roots that lie near one another belong together, whatever their numbers
    fn branches_are_those_that_move_alike() {
        let a = [curve("mode 1", 1.0, |x| 0.1 * x), curve("mode 2", 1.5, |x| -0.1 * x)];
        let b = [curve("mode 1", 1.5, |x| -0.1 * x), curve("mode 2", 1.0, |x| 0.1 * x)];
        let all = pairs(&a, &b);
        assert!(all.iter().all(|p| p.points.len() == 200 && p.points.iter().all(|p| p[1] == p[2])));
    }

    #[test]
    fn shallow_flutter_is_held_by_the_top_of_its_hump() {
        let low = curve("mode 1", 1.0, hump(0.02));
        let begins = 1.0 - 0.02f64.sqrt();
        let growth = low.growth(begins).unwrap();
        assert!((growth.most - 0.02).abs() < 1e-3 && growth.holding == Some(growth.most), "{growth:?}");
        let steep = curve("mode 1", 1.0, |x| x - 1.0).growth(1.0).unwrap();
        assert!((steep.most - 0.2).abs() < 1e-9 && steep.holding.is_none());
        assert!(low.growth(5.0).is_none());
    }
}
