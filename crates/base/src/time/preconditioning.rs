//! Management of a preconditioner: when it is built, reused and discarded.
//!
//! A short time step couples neighbours only ([`Reach::Near`]). If linear solves nevertheless need many iterations, the
//! systems are treated as globally coupled ([`Reach::Far`]) for some steps. A preconditioner that was built for one
//! time step is reused in the following ones as long as linear solves need few iterations and Newton's method converges
//! well.
use crate::system::{Implicit, Preconditioner, Reach, RightHandSide, Shift};

/// Maximum number of iterations of a linear solve for which its preconditioner is reused in the next step.
const EASY: usize = 4;
/// Number of iterations after which a linear solve with local coupling is stopped: its step is used, and later solves
/// assume global coupling.
const MOST_NEAR: usize = 16;

/// A preconditioner with a record of its use.
pub(super) struct Preconditioning<P> {
    inner: P,
    /// True if it was built for this time step or a recent one, and remains in use.
    kept: bool,
    /// True if it was built within an iteration.
    remade: bool,
    /// Number of iterations of the longest linear solve since the start of the time step.
    longest: usize,
    /// Range of coupling of the linear systems of time steps.
    pub(super) reach: Reach,
}

impl<P> Preconditioning<P> {
    pub(super) fn new(inner: P) -> Self {
        Self { inner, kept: false, remade: false, longest: 0, reach: Reach::Near }
    }

    /// Discards the preconditioner, so that the next iteration builds a new one.
    pub(super) fn drop(&mut self) {
        (self.kept, self.remade) = (false, false);
    }

    /// Discards the preconditioner because a step was rejected or the residual rose.
    pub(super) fn give_up(&mut self) {
        self.kept = false;
    }

    /// Resets the record at the start of a time step.
    pub(super) fn begin_step(&mut self) {
        self.longest = 0;
    }

    /// True if the next iteration can use the existing preconditioner.
    pub(super) fn is_kept(&self) -> bool {
        self.kept
    }

    /// True while a preconditioner from before the start of the step is in use.
    pub(super) fn still_serves(&self) -> bool {
        self.kept && !self.remade && self.longest <= EASY
    }

    /// Maximum number of iterations of a linear solve with this range of coupling.
    pub(super) fn most(reach: Reach) -> usize {
        if reach == Reach::Near { MOST_NEAR } else { usize::MAX }
    }

    /// Records the number of iterations of a linear solve.
    pub(super) fn served(&mut self, reach: Reach, iterations: usize) {
        if reach == Reach::Near && iterations == MOST_NEAR {
            // a preconditioner of another step is rebuilt before the coupling is changed
            self.reach = if self.remade { Reach::Far } else { Reach::Near };
            self.kept = false;
        }
        self.longest = self.longest.max(iterations);
    }

    /// Builds the preconditioner for `at`, before a time step begins.
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

    /// Builds the preconditioner within an iteration; `keep` allows later iterations to reuse it.
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
