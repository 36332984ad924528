//! Whether the numbers of a checkpoint are those of a run: checksums tell damage of the file, not what was written into it.
use super::history::IterationHistory;
use super::saved::{LagrangianCheckpoint, Saved, require};
use crate::case::{Case, Polar};
use crate::observe::convergence::CloudLoads;
use crate::observe::loads::Coefficients;
use crate::problem::RunError;
use crate::problem::numerics;
use crate::problem::spacing;
use crate::record::summary::PolarPoint;
use crate::study::stage::{Stage, Task};
use crate::system::{Field, unknowns};
use crate::time::Memory;

/// Greatest number of stages of any plan: cycles of adaptation, harmonics one by one, clouds of a family.
const MOST_STAGES: usize = 10_000;
/// Difference of loads that are told twice, over one more than their size: both are of the same state.
const SAME: f64 = 1e-9;

impl Saved<'_> {
    /// Refuses numbers that no run of this case writes.
    pub(crate) fn trusted(self, case: &Case) -> Result<Self, RunError> {
        let known = self.stage < self.stages.len() && self.stages.len() <= MOST_STAGES;
        require(known, "its stage is not among its stages")?;
        require(self.stages.iter().all(|s| is_of(case, s)), "its stages are not those of the case")?;
        let points = case.polar.as_ref().map_or(1, Polar::len);
        let of_points = self.stages.iter().all(|s| s.point.is_none_or(|point| point < points));
        require(of_points, "its stages are of points that the case does not have")?;
        // a state of several instants never becomes one of fewer
        let grows = self.stages.windows(2).all(|w| w[0].instances() <= w[1].instances());
        require(grows, "its stages are in another order than those of the case")?;
        let (arrays, numbers) = self.reals();
        require(arrays.iter().all(|a| a.iter().all(|x| x.is_finite())), "a field holds what is not a finite number")?;
        require(!numbers.iter().any(|x| x.is_nan()) && self.time.is_finite(), "a number is not one")?;
        require(case.is_unsteady() || self.time == 0.0, "a steady flow has no time")?;
        if let Memory::Relaxation(relax) = &self.memory {
            require(relax.cfl > 0.0, "its Courant number is not positive")?;
        }
        require(self.start_totals.len() <= 5, "its totals are too many")?;
        let lost = self.lagrangian.as_ref().map_or(0, |l| if l.ledger.renewals > 0 { l.ledger.lost.len() } else { 0 });
        require(self.start_totals.len() >= lost, "its totals are too few")?;
        require(self.cpu_seconds >= 0.0 && self.wall_seconds >= 0.0, "it took less than no time")?;
        require(self.clouds.iter().all(is_of_a_cloud), "the loads of its clouds are none that a cloud has")?;
        self.points_of(case)?;
        Ok(self)
    }

    /// Refuses points that are not those of the polar of the case, or not as a run tells them.
    fn points_of(&self, case: &Case) -> Result<(), RunError> {
        let (points, asked) = (&self.polar.points, case.streams());
        let present = self.stages[self.stage].point;
        // the row of the present point may be there already
        let over = present.unwrap_or(0) <= points.len() && points.len() <= asked.len();
        require(points.is_empty() || over, "its points are not those of the case")?;
        let of_case = points.iter().zip(&asked).all(|(point, stream)| {
            let own = PolarPoint::of(stream);
            (point.mach, point.alpha_deg) == (own.mach, own.alpha_deg)
        });
        require(of_case, "its points are at other angles or Mach numbers than the case asks for")?;
        require(points.iter().all(is_of_a_point), "a point of its polar has numbers that no point has")?;
        let iterations = points.iter().try_fold(0_u64, |sum, point| sum.checked_add(point.iterations));
        require(iterations.is_some_and(|n| n <= self.iteration), "its points took more iterations than the run")
    }

    /// Refuses loads of points, clouds and cycles that are not those of an iteration of the run.
    pub(crate) fn agrees(&self, history: &IterationHistory) -> Result<(), RunError> {
        let told = ["cl", "cd", "cm", "point"].map(|name| history.column(name));
        let [Some(cl), Some(cd), Some(cm), point] = told else { return Ok(()) };
        let counted = history.column("iteration").and_then(|all| all.last().copied());
        require(counted.is_none_or(|last| last == self.iteration as f64), "its history ends at another iteration")?;
        let same = |a: f64, b: f64| a == b || (a - b).abs() <= SAME * (1.0 + b.abs());
        let is_at = |loads: [f64; 3], row: usize| [cl, cd, cm].iter().zip(loads).all(|(told, a)| same(a, told[row]));
        for (k, own) in self.polar.points.iter().enumerate() {
            let last = point.and_then(|all| all.iter().rposition(|p| *p == (k + 1) as f64));
            let (Some(Coefficients { cl, cd, cm }), Some(last)) = (own.loads, last) else { continue };
            require(is_at([cl, cd, cm], last), "a point of its polar has other loads than its last iteration")?;
        }
        let clouds = self.clouds.iter().map(|c| [c.cl, c.cd, c.cm]);
        let mut all = clouds.chain(self.cycles.iter().map(|c| [c[2], c[3], c[4]]));
        let known = |loads: [f64; 3]| (0..cl.len()).rev().any(|row| is_at(loads, row));
        // a flow that began steady has no iteration of its own
        let skipped = self.clouds_seen(history) < self.clouds.len().max(self.cycles.len());
        require(skipped || all.all(known), "a cloud has other loads than any iteration of the run")
    }

    /// Number of clouds of the present point with iterations in the history.
    fn clouds_seen(&self, history: &IterationHistory) -> usize {
        let [sizes, point] = ["fluid_particles", "point"].map(|name| history.column(name));
        let present = self.stages[self.stage].point.map(|k| (k + 1) as f64);
        let here = |row: &usize| point.zip(present).is_none_or(|(all, present)| all[*row] == present);
        let mut sizes: Vec<f64> =
            (0..sizes.map_or(0, <[f64]>::len)).filter(here).filter_map(|row| Some(sizes?[row])).collect();
        sizes.dedup();
        sizes.len()
    }

    /// Refuses arrays of another length than the equations at one instant, with these `fields`, ask for.
    pub(crate) fn fits(&self, fields: &[Field]) -> Result<(), RunError> {
        let wanted = unknowns(fields) * self.stages.get(self.stage).map_or(0, Stage::instances);
        let rows: usize = fields.iter().map(|f| f.rows).sum();
        let others = match &self.memory {
            Memory::Relaxation(relax) => {
                require(relax.scale.len() == rows, "its local times are of another cloud")?;
                Vec::new()
            }
            Memory::March(past) => vec![(&past.before, wanted), (&past.older, wanted)],
        };
        require(self.state.len() == wanted, "its state is of another cloud")?;
        let fits = others.iter().all(|(v, n)| v.is_empty() || v.len() == *n);
        require(fits, "its fields are of different lengths")
    }

    /// All arrays of numbers, and all numbers that stand alone.
    fn reals(&self) -> (Vec<&[f64]>, Vec<f64>) {
        let mut arrays: Vec<&[f64]> = vec![&self.state, &self.sources, &self.start_totals];
        arrays.extend(self.settling.recent.iter().map(Vec::as_slice));
        arrays.extend(self.cycles.iter().map(<[f64; 5]>::as_slice));
        arrays.extend(self.lagrangian.iter().flat_map(LagrangianCheckpoint::arrays));
        let mut numbers = vec![self.cpu_seconds, self.wall_seconds, self.settling.best];
        match &self.memory {
            Memory::Relaxation(r) => {
                arrays.push(&r.scale);
                numbers.extend([r.cfl, r.phase.best]);
            }
            Memory::March(p) => {
                arrays.extend([p.before.as_slice(), &p.older]);
                numbers.extend([p.time, p.last, p.next, p.made]);
            }
        }
        (arrays, numbers)
    }
}

/// True for loads that are numbers.
fn are_finite(loads: &Coefficients) -> bool {
    [loads.cl, loads.cd, loads.cm].iter().all(|c| c.is_finite())
}

/// True for loads on a cloud that has particles, a spacing and a domain.
fn is_of_a_cloud(cloud: &CloudLoads) -> bool {
    let loads = Coefficients { cl: cloud.cl, cd: cloud.cd, cm: cloud.cm };
    let sizes = [cloud.factor, cloud.reach].iter().all(|x| x.is_finite() && *x > 0.0);
    let told = [Some(loads), cloud.momentum, Some(cloud.unsettled)];
    sizes
        && cloud.particles > 0
        && told.iter().flatten().all(are_finite)
        && cloud.spurious_drag.is_none_or(f64::is_finite)
}

/// True for a row of a polar that contradicts neither itself nor what such numbers may be.
fn is_of_a_point(point: &PolarPoint) -> bool {
    let loads = [point.loads, point.loads_momentum_balance, point.loads_error];
    let bars = point.loads_error.is_none_or(|bar| [bar.cl, bar.cd, bar.cm].iter().all(|half| *half >= 0.0));
    let names = point.long_bars.iter().all(|name| ["CL", "CD", "CM"].contains(&name.as_str()));
    let judged = point.within_accuracy.is_none_or(|within| within == point.long_bars.is_empty());
    let spent = point.cpu_seconds.is_finite() && point.cpu_seconds >= 0.0 && point.residual_drop.is_finite();
    let stood = point.loads.is_none() || point.particles > 0;
    let told = !point.converged || point.reason.is_empty();
    loads.iter().flatten().all(are_finite) && bars && names && judged && spent && stood && told
}

/// True where a plan of the case may have such a stage.
fn is_of(case: &Case, stage: &Stage) -> bool {
    let cloud = stage.factor.is_finite()
        && 0.0 < stage.factor
        && (stage.cycle <= case.adapt.cycles || spacing::asked(case).is_some());
    let task = match stage.task {
        Task::Balance { harmonics } => numerics::balance(case).is_some_and(|plan| harmonics <= numerics::most(plan)),
        _ => true,
    };
    cloud && task
}
