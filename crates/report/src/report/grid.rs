//! The chapter on grid convergence: loads on a family of clouds, their limits and error bars.
use super::chart::{Axis, Chart, Marks, Series};
use super::files::RunFolder;
use super::page::{Block, Table};
use super::words::{grouped, load, number, plain};
use crate::observe::convergence::{CloudLoads, Convergence, FamilyEnd, LoadEstimate};

/// One load of a cloud.
type Pick = fn(&CloudLoads) -> f64;

/// Nothing for a run on one cloud.
pub(super) fn grid(run: &RunFolder) -> Vec<Block> {
    let found = run.json("summary.json").map(|summary| summary["grid_convergence"].clone()).unwrap_or_default();
    let Ok(found) = serde_json::from_value::<Convergence>(found) else { return Vec::new() };
    vec![Block::Text(verdict(&found)), Block::Table(table(&found)), Block::charts(charts(&found).into_iter())]
}

fn loads(found: &Convergence) -> [(&'static str, Pick, &LoadEstimate); 3] {
    [("CL", |l| l.cl, &found.cl), ("CD", |l| l.cd, &found.cd), ("CM", |l| l.cm, &found.cm)]
}

fn verdict(found: &Convergence) -> String {
    // 0.07 times 100 is not quite 7
    let asked = (1e6 * found.asked).round() / 1e4;
    let end = match found.ended_by {
        FamilyEnd::Accuracy => format!("all error bars are within {asked} % of the loads"),
        FamilyEnd::Particles => {
            format!("error bars are longer than {asked} % of the loads, and `accuracy.particles` allows no finer cloud")
        }
        FamilyEnd::Unsteady => format!(
            "error bars are longer than {asked} % of the loads: on a finer cloud the flow came to no rest, and its loads lie within them"
        ),
        FamilyEnd::Time => {
            format!(
                "error bars are longer than {asked} % of the loads, and a finer cloud would not end within `accuracy.time`"
            )
        }
    };
    let shocks = found.moved_shocks().map_or_else(String::new, |why| format!(": {why}"));
    format!(
        "The clouds are alike, each finer than the one before; {end}{shocks}. In the plane a load that approaches its limit with an order \
         has 5/4 of the way to it as part of its error bar (with shocks 5/4 of the last change, or twice that change where it shows another order than 1), another one the spread of the last clouds; in space that part is 5/4 of what \
         half the spacing changed. What the end of the domain does, what wall pressure and momentum differ by (all of it where that is \
         more than the last change, else half of it beyond what the latter may still change by), and what the last iterations changed are \
         the other parts, added as squares. Without shocks and viscosity a plane flow has no drag, and one in space loses no total pressure: \
         what is found of either is an error, and no bar is shorter."
    )
}

/// A row for each cloud, then limit, error bar and order.
fn table(found: &Convergence) -> Table {
    let (all, mut rows) = (loads(found), Vec::new());
    for cloud in &found.clouds {
        let values = all.iter().map(|(_, of, _)| load(of(cloud)));
        let head = [format!("{} × spacing", plain(cloud.factor)), grouped(cloud.particles as f64)];
        rows.push(head.into_iter().chain(values).collect::<Vec<_>>());
    }
    if let Some(finer) = &found.unsteady {
        let head = [format!("{} × spacing, not steady", plain(finer.factor)), grouped(finer.particles as f64)];
        rows.push(head.into_iter().chain(all.iter().map(|(_, of, _)| load(of(finer)))).collect());
    }
    let row = |name: &str, value: &dyn Fn(&LoadEstimate) -> Option<f64>| {
        let values = all.iter().map(|(_, _, e)| value(e).map_or("–".to_owned(), number));
        [name.to_owned(), String::new()].into_iter().chain(values).collect::<Vec<_>>()
    };
    rows.push(row("limit", &|e| e.limit));
    rows.push(row("error bar ±", &|e| Some(e.half_width)));
    rows.push(row("of it: spacing", &|e| Some(e.spacing)));
    rows.push(row("end of the domain", &|e| Some(e.far_field)));
    rows.push(row("wall pressure against momentum", &|e| Some(e.momentum)));
    rows.push(row("last iterations", &|e| Some(e.residual)));
    if all.iter().any(|(_, _, e)| e.theory > 0.0) {
        rows.push(row("theory, at least", &|e| Some(e.theory).filter(|t| *t > 0.0)));
    }
    rows.push(row("observed order", &|e| e.order));
    Table::new(&["cloud", "particles", "CL", "CD", "CM"], rows)
}

/// Loads over 1/N, in proportion to the square of the spacing, between the ends of the error bar.
fn charts(found: &Convergence) -> Vec<Chart> {
    let x: Vec<f64> = found.clouds.iter().map(|c| 1.0 / c.particles as f64).collect();
    let chart = |(name, of, estimate): (&str, Pick, &LoadEstimate)| {
        let y: Vec<f64> = found.clouds.iter().map(of).collect();
        let last = y.last().copied().unwrap_or_default();
        let ends = [0.0, x.first().copied().unwrap_or_default()];
        let [low, high] = [last - estimate.half_width, last + estimate.half_width];
        let (along, gap) = ([ends[0], ends[1], f64::NAN, ends[0], ends[1]], f64::NAN);
        let bar = Series::new("error bar", Marks::Dashes, along.to_vec(), vec![low, low, gap, high, high]);
        let series = vec![Series::new("clouds", Marks::Points, x.clone(), y), bar];
        Chart { title: name.to_owned(), x: Axis::linear("1/particles"), y: Axis::linear(name), series }
    };
    loads(found).into_iter().map(chart).collect()
}
