//! What a family of clouds has found: error bars, and whether they are short enough.
use super::{Log, Record};
use crate::case::{Accuracy, Case};
use crate::observe::convergence::{CloudLoads, Convergence, LEAST};
use crate::problem::spacing;
use crate::study::stage::Stage;

/// Change of the loads, in what they are asked to, that counts as rest on the clouds of a family.
pub(crate) const REST: f64 = 1e-3;
/// Time that the next cloud of a family takes over that of all before it.
const NEXT: f64 = 4.0;

/// The error bars of the clouds of a run, and what ended their family; `None` where there are none.
pub(crate) fn found(case: &Case, record: &Record) -> Option<Convergence> {
    let family = Convergence::of(&record.clouds, spacing::asked(case)?.loads.0)?;
    Some(if record.out_of_time { family.out_of_time() } else { family })
}

/// True where the flow came to rest on a coarser cloud of the family than that of a stage that goes back to none.
pub(crate) fn has_steady_before(stage: &Stage, log: &Log<'_>) -> bool {
    !stage.back && log.record.clouds.iter().any(|known| known.steady && known.factor > stage.factor)
}

/// True where the last iterations changed the loads by no more than `REST` of what they are asked to be known to.
pub(crate) fn at_rest(asked: &Accuracy, loads: &CloudLoads) -> bool {
    let short = |(load, change, least): (f64, f64, f64)| change.abs() <= REST * asked.loads.0 * load.abs().max(least);
    let [lift, drag, moment] = LEAST;
    let change = &loads.unsettled;
    [(loads.cl, change.cl, lift), (loads.cd, change.cd, drag), (loads.cm, change.cm, moment)].into_iter().all(short)
}

/// Adds the loads on one more cloud; true when they are known well enough, or when the next cloud would take too long.
pub(crate) fn judge(asked: &Accuracy, loads: CloudLoads, log: &mut Log<'_>) -> bool {
    log.record.clouds.retain(|known| known.factor != loads.factor);
    log.record.clouds.push(loads);
    let family = Convergence::of(&log.record.clouds, asked.loads.0);
    let reached = family.as_ref().is_some_and(|c| c.reached());
    let wall = log.wall_seconds();
    log.record.out_of_time = !reached && asked.time.is_some_and(|t| (1.0 + NEXT) * wall > t.0);
    reached || log.record.out_of_time
}

/// Tells the loads on the last cloud, with their error bars, unless it is one of the clouds of a polar.
pub(crate) fn announce(log: &mut Log<'_>) {
    let Some(loads) = log.record.clouds.last().copied().filter(|_| log.point.is_none()) else { return };
    let bars = found(&log.case, &log.record).map_or_else(String::new, |c| {
        let h = c.half_widths();
        format!(" ± {:.5}, CD {:.5} ± {:.5}, CM {:.5} ± {:.5}", h.cl, loads.cd, h.cd, loads.cm, h.cm)
    });
    log.note(&format!("{} particles: CL {:.5}{bars}", loads.particles, loads.cl));
}
