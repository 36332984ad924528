//! The life of a preconditioner: made, kept while it serves, dropped.
//!
//! A short step in time feels its neighbours only ([`Reach::Near`]); where linear solves grow long all the same, the systems
//! reach across the cloud ([`Reach::Far`]) for a while. One that was made for a step in time goes on to serve the steps after
//! it, as long as solves stay short and Newton's method falls well.
use crate::system::{Implicit, Preconditioner, Reach, RightHandSide, Shift};

/// Iterations of a linear solve up to which its preconditioner goes on to serve in the next step.
const EASY: usize = 4;
/// Iterations after which a linear solve that should reach near only is given up: its step is taken, and those after it reach far.
const MOST_NEAR: usize = 16;

/// A preconditioner and how it serves.
pub(super) struct Preconditioning<P> {
    inner: P,
    /// It was made for this step in time or one not long before, and still serves.
    kept: bool,
    /// It was made within an iteration.
    remade: bool,
    /// Iterations of the longest linear solve since the step in time began.
    longest: usize,
    /// Linear systems of steps in time reach across the cloud.
    pub(super) reach: Reach,
}

impl<P> Preconditioning<P> {
    pub(super) fn new(inner: P) -> Self {
        Self { inner, kept: false, remade: false, longest: 0, reach: Reach::Near }
    }

    /// Has the next iteration make it.
    pub(super) fn drop(&mut self) {
        (self.kept, self.remade) = (false, false);
    }

    /// It no longer fits: a step was refused, or the residual fell badly.
    pub(super) fn give_up(&mut self) {
        self.kept = false;
    }

    /// A step in time begins.
    pub(super) fn begin_step(&mut self) {
        self.longest = 0;
    }

    /// True when it need not be made for the next iteration.
    pub(super) fn is_kept(&self) -> bool {
        self.kept
    }

    /// True while one that was made before the step began serves.
    pub(super) fn still_serves(&self) -> bool {
        self.kept && !self.remade && self.longest <= EASY
    }

    /// Greatest number of iterations of a linear solve of this reach.
    pub(super) fn most(reach: Reach) -> usize {
        if reach == Reach::Near { MOST_NEAR } else { usize::MAX }
    }

    /// Learns how long a linear solve took.
    pub(super) fn served(&mut self, reach: Reach, iterations: usize) {
        if reach == Reach::Near && iterations == MOST_NEAR {
            // one that was made for another step is first made anew
            self.reach = if self.remade { Reach::Far } else { Reach::Near };
            self.kept = false;
        }
        self.longest = self.longest.max(iterations);
    }

    /// Makes it before a step in time begins, at `at`.
    pub(super) fn make_ahead<S: Implicit<Preconditioner = P>>(
        &mut self,
        system: &S,
        at: (&S::Frame, &[f64]),
        work: &mut S::Work,
        shift: &Shift<'_>,
    ) where
        P: Preconditioner<S>,
    {
        self.inner.update(system, at, work, shift);
        self.kept = true;
    }

    /// Makes it within an iteration; `keep`: it may go on to serve.
    pub(super) fn make<S: Implicit<Preconditioner = P>>(
        &mut self,
        system: &S,
        at: (&S::Frame, &[f64]),
        work: &mut S::Work,
        (shift, keep): (&Shift<'_>, bool),
    ) where
        P: Preconditioner<S>,
    {
        self.inner.update(system, at, work, shift);
        (self.kept, self.remade) = (keep, true);
    }

    pub(super) fn apply<S: Implicit<Preconditioner = P>>(
        &mut self,
        system: &S,
        frame: &S::Frame,
        r: &RightHandSide<'_>,
        z: &mut [f64],
    ) where
        P: Preconditioner<S>,
    {
        self.inner.apply(system, &[frame], r, z);
    }

    pub(super) fn bytes<S: Implicit<Preconditioner = P>>(&self) -> usize
    where
        P: Preconditioner<S>,
    {
        self.inner.bytes()
    }
}
