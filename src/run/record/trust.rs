//! Whether the numbers of a checkpoint are those of a run: checksums tell damage of the file, not what was written into it.
use super::saved::{LagrangianCheckpoint, Saved, require};
use crate::case::Case;
use crate::run::error::RunError;
use crate::run::stage::{Stage, Task};
use crate::run::{accuracy, recipe};
use crate::system::{Field, unknowns};
use crate::time::Memory;

/// Greatest number of stages of any plan: cycles of adaptation, harmonics one by one, clouds of a family.
const MOST_STAGES: usize = 10_000;

impl Saved<'_> {
    /// Refuses numbers that no run of this case writes.
    pub(crate) fn trusted(self, case: &Case) -> Result<Self, RunError> {
        let known = self.stage < self.stages.len() && self.stages.len() <= MOST_STAGES;
        require(known, "its stage is not among its stages")?;
        require(self.stages.iter().all(|s| is_of(case, s)), "its stages are not those of the case")?;
        let points = case.points().len();
        let of_points = self.stages.iter().all(|s| s.point.is_none_or(|point| point < points));
        require(of_points, "its stages are of points that the case does not have")?;
        // a state of several instants never becomes one of fewer
        let grows = self.stages.windows(2).all(|w| w[0].instances() <= w[1].instances());
        require(grows, "its stages are in another order than those of the case")?;
        let (arrays, numbers) = self.reals();
        require(arrays.iter().all(|a| a.iter().all(|x| x.is_finite())), "a field holds what is not a finite number")?;
        require(!numbers.iter().any(|x| x.is_nan()) && self.time.is_finite(), "a number is not one")?;
        if let Memory::Relaxation(relax) = &self.memory {
            require(relax.cfl > 0.0, "its Courant number is not positive")?;
        }
        require(self.start_totals.len() <= 5, "its totals are too many")?;
        let lost = self.lagrangian.as_ref().map_or(0, |l| if l.ledger.renewals > 0 { l.ledger.lost.len() } else { 0 });
        require(self.start_totals.len() >= lost, "its totals are too few")?;
        Ok(self)
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

/// True where a plan of the case may have such a stage.
fn is_of(case: &Case, stage: &Stage) -> bool {
    let cloud = stage.factor.is_finite()
        && 0.0 < stage.factor
        && (stage.cycle <= case.adapt.cycles || accuracy::asked(case).is_some());
    let task = match stage.task {
        Task::Balance { harmonics } => recipe::balance(case).is_some_and(|plan| harmonics <= recipe::most(plan)),
        _ => true,
    };
    cloud && task
}
