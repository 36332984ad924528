//! Whether the numbers of a checkpoint are those of a run: checksums tell damage of the file, not what was written into it.
use super::saved::{LagrangianCheckpoint, Saved};
use crate::case::Case;
use crate::run::error::RunError;
use crate::run::recipe;
use crate::run::stage::{Stage, Task};
use crate::time::Memory;

/// Greatest number of stages of any plan: cycles of adaptation, harmonics one by one, clouds of a family.
const MOST_STAGES: usize = 10_000;

impl Saved {
    /// Refuses numbers that no run of this case writes.
    pub(crate) fn trusted(self, case: &Case) -> Result<Self, RunError> {
        let known = self.stage < self.stages.len() && self.stages.len() <= MOST_STAGES;
        require(known, "its stage is not among its stages")?;
        require(self.stages.iter().all(|s| is_of(case, s)), "its stages are not those of the case")?;
        let (arrays, numbers) = self.reals();
        require(arrays.iter().all(|a| a.iter().all(|x| x.is_finite())), "a field holds what is not a finite number")?;
        require(!numbers.iter().any(|x| x.is_nan()) && self.time.is_finite(), "a number is not one")?;
        require(self.start_totals.len() <= 5, "its totals are too many")?;
        Ok(self)
    }

    /// Refuses fields of another length than `unknowns`, those of the equations at one instant, ask for.
    pub(crate) fn fits(&self, unknowns: usize) -> Result<(), RunError> {
        let wanted = unknowns * self.stages.get(self.stage).map_or(0, Stage::instances);
        let others: Vec<&Vec<f64>> = match &self.memory {
            Memory::Relaxation(relax) => vec![&relax.scale],
            Memory::March(past) => vec![&past.before, &past.older],
        };
        require(self.state.len() == wanted, "its state is of another cloud")?;
        // a time scale may stand for each row of unknowns
        let fits = |v: &&Vec<f64>| v.is_empty() || (v.len() <= wanted && wanted.is_multiple_of(v.len()));
        require(others.iter().all(fits), "its fields are of different lengths")
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
                numbers.extend([r.cfl, r.first_norm, r.phase.best]);
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
    let cloud = stage.factor.is_finite() && 0.0 < stage.factor && stage.cycle <= case.adapt.cycles;
    let task = match stage.task {
        Task::Balance { harmonics } => recipe::balance(case).is_some_and(|plan| harmonics <= recipe::most(plan)),
        _ => true,
    };
    cloud && task
}

/// Nothing, or what is wrong with a checkpoint.
pub(crate) fn require(holds: bool, problem: &'static str) -> Result<(), RunError> {
    if holds { Ok(()) } else { Err(RunError::Untrue { file: super::saved::FILE, problem }) }
}
