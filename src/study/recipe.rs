//! Recipe of a run: the stages of steady, marched and periodic cases.
use super::accuracy;
use super::stage::{Stage, Task};
use crate::case::{Case, Initial, Temporal};
use crate::problem::numerics::{balance, divides, is_automatic, most, relaxation};
use crate::problem::spacing::{asked, begins_near};

/// Particles above which a case is started on one coarser cloud, on two and so on; in 2-D and 3-D.
const START: [&[usize]; 2] = [&[2_500, 9_000, 33_000, 120_000], &[15_000, 80_000]];
/// Particles above which a cloud that a steady flow in the plane begins on begins on a coarser one itself, and how often at most.
const NEAR_START: f64 = 3_500.0;
const NEAR_STARTS: i32 = 7;
/// Harmonics at which `number = "auto"` begins, and what it adds.
const FIRST: usize = 1;
const MORE: usize = 2;

/// The stages of a case whose own cloud has `n` fluid particles, and others in its family the `sizes`: coarse, fine, adapted, marched, more and more harmonics.
/// A harmonic balance has `least` harmonics or more: the motion has so many.
pub(crate) fn plan(
    case: &Case,
    (n, sizes): (usize, &dyn Fn(f64) -> f64),
    dimension: usize,
    least: usize,
) -> Vec<Stage> {
    if let Some(asked) = asked(case) {
        return at_all_points(case, accuracy::family(case, &asked, sizes, dimension));
    }
    let mut all = Vec::new();
    // a march from a given field starts from that field itself
    let given = case.is_unsteady() && !matches!(case.initial, Initial::FreeStream);
    let relaxes = relaxation(case).is_some() && !case.bodies.is_empty() && !given;
    let steady = |factor: f64, cycle: u32| Stage { factor, cycle, ..Stage::PLAIN };
    if relaxes {
        let factors = starts(case, (n, sizes), dimension);
        if let Some(stages) = balance_from_coarser(case, &factors, least) {
            return stages;
        }
        all.extend(factors.into_iter().map(|f| steady(f, 0)));
    }
    if relaxes || !case.is_unsteady() {
        all.extend((0..=case.adapt.cycles).map(|cycle| steady(1.0, cycle)));
    }
    let cycle = all.last().map_or(0, |s: &Stage| s.cycle);
    all.extend(in_time(case, None, least).into_iter().map(|task| Stage { cycle, task, ..Stage::PLAIN }));
    at_all_points(case, all)
}

/// Factors on the spacing of the coarser clouds that a case begins on.
fn starts(case: &Case, (n, sizes): (usize, &dyn Fn(f64) -> f64), dimension: usize) -> Vec<f64> {
    let coarser = match begins_near(case) {
        true => (0..NEAR_STARTS).take_while(|k| sizes(2f64.powi(*k)) > NEAR_START).count(),
        false => START[dimension - 2].iter().filter(|most| n > **most).count(),
    };
    (1..=coarser as i32).rev().map(|k| 2f64.powi(k)).filter(|f| divides(&case.cloud, *f)).collect()
}

/// The stages of a harmonic balance that begins on coarser clouds with these factors on their spacing, where it can: the steady flow and
/// few harmonics on the coarsest, all of them there and on the others; where their number is found on the way, the first ones.
fn balance_from_coarser(case: &Case, factors: &[f64], least: usize) -> Option<Vec<Stage>> {
    let plan = balance(case).filter(|plan| plan.march == 0 && case.adapt.cycles == 0)?;
    let (coarsest, finer) = factors.split_first()?;
    let tasks = in_time(case, None, least);
    let (early, late) = tasks.split_at(if is_automatic(plan) { 1 } else { tasks.len() });
    let on = |factor: f64| move |task: &Task| Stage { factor, task: *task, ..Stage::PLAIN };
    let mut all: Vec<Stage> = std::iter::once(&Task::Relax).chain(early).map(on(*coarsest)).collect();
    all.extend(finer.iter().chain(&[1.0]).flat_map(|factor| early.last().map(on(*factor))));
    all.extend(late.iter().map(on(1.0)));
    Some(all)
}

/// The stages of a harmonic balance of a motion with harmonics of these numbers that no coarser cloud gives a start.
pub(crate) fn balance_from_rest(case: &Case, multiples: &[usize]) -> Vec<Stage> {
    let least = multiples.last().copied().unwrap_or(FIRST);
    let tasks = std::iter::once(Task::Relax).chain(in_time(case, None, least));
    tasks.map(|task| Stage { task, ..Stage::PLAIN }).collect()
}

/// The stages of one point, for every point of a polar.
fn at_all_points(case: &Case, stages: Vec<Stage>) -> Vec<Stage> {
    let Some(polar) = &case.polar else { return stages };
    (0..polar.len()).flat_map(|point| stages.iter().map(move |s| Stage { point: Some(point), ..*s })).collect()
}

/// The stages of a case that begins from the last state of another run, reached at the stage `from`, on the same cloud.
pub(crate) fn plan_from(case: &Case, from: &Stage) -> Vec<Stage> {
    let held = match from.task {
        Task::Balance { harmonics } => Some(harmonics),
        _ => None,
    };
    let tasks = if case.is_unsteady() { in_time(case, held, FIRST) } else { vec![Task::Relax] };
    tasks.into_iter().map(|task| Stage { task, back: false, ..*from }).collect()
}

/// What is done in time after any steady start; `held`: harmonics of the state it begins from; `least`: harmonics that the motion
/// has.
fn in_time(case: &Case, held: Option<usize>, least: usize) -> Vec<Task> {
    match &case.time {
        Temporal::Steady(_) | Temporal::Newmark(_) | Temporal::Modes(_) => Vec::new(),
        Temporal::Explicit(_) | Temporal::Dual(_) => vec![Task::March],
        Temporal::Harmonics(plan) => {
            let (most, auto) = (most(plan), is_automatic(plan));
            let lead = held.is_none() && plan.march > 0;
            let first = match held {
                Some(held) if auto => held.min(most),
                None if auto || !lead => least.clamp(FIRST, most),
                _ => most,
            };
            let more = |n: &usize| (*n < most).then(|| if auto { (n + MORE).min(most) } else { most });
            let balances = std::iter::successors(Some(first), more).map(|harmonics| Task::Balance { harmonics });
            lead.then_some(Task::Lead).into_iter().chain(balances).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balances_begin_on_the_coarsest_cloud() {
        let planned = |time: &str, n: usize| -> Vec<(f64, usize)> {
            let text = format!(
                "title = \"t\"\n[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[motion]\nreduced_frequency = 0.3\nplunge = 0.01\n\
                 [cloud]\nspacing = 0.01\n{time}\n"
            );
            let case = crate::case::read(&text, "t").unwrap();
            plan(&case, (n, &|_| 0.0), 2, 1).iter().map(|s| (s.factor, s.instances() / 2)).collect()
        };
        assert_eq!(planned("[time]\nharmonics = 3", 10_000), [(4.0, 0), (4.0, 1), (4.0, 3), (2.0, 3), (1.0, 3)]);
        assert_eq!(planned("[time]\nharmonics = 1", 4_000), [(2.0, 0), (2.0, 1), (1.0, 1)]);
        assert_eq!(planned("[time]\nharmonics = 2", 1_000), [(1.0, 0), (1.0, 1), (1.0, 2)]);
        let automatic = planned("[time]\nharmonics = \"auto\"", 4_000);
        assert_eq!(automatic[..4], [(2.0, 0), (2.0, 1), (1.0, 1), (1.0, 3)], "{automatic:?}");
        // a march leads to the instances of all harmonics, from a steady flow on the same cloud
        let led = planned("[time.harmonics]\nnumber = 2\nmarch = 3", 4_000);
        assert_eq!(led, [(2.0, 0), (1.0, 0), (1.0, 0), (1.0, 2)]);
    }
}
