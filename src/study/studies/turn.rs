//! A stage among all: where it starts, where it ends.
use super::super::keeper::Camera;
use super::super::record::saved::Position;
use crate::system::System;
use crate::time::Memory;

/// Where a stage starts.
pub(crate) enum Start {
    /// From a state.
    Fresh(Vec<f64>),
    /// Where a checkpoint stands: state and what the integrator must remember.
    Resume(Vec<f64>, Memory),
}

impl Start {
    /// The state.
    pub(crate) fn into_state(self) -> Vec<f64> {
        match self {
            Self::Fresh(u) | Self::Resume(u, _) => u,
        }
    }
}

/// A stage among all.
pub(crate) struct Turn<'a, const D: usize> {
    /// Who writes fields.
    pub(crate) camera: Option<&'a dyn Camera<D>>,
    /// Where the run stands among its stages.
    pub(crate) at: &'a Position<'a>,
}

impl<const D: usize> Turn<'_, D> {
    /// The stage.
    pub(crate) fn stage(&self) -> &super::super::stage::Stage {
        &self.at.stages[self.at.stage]
    }

    /// The one after it in the same free stream.
    pub(crate) fn next(&self) -> Option<&super::super::stage::Stage> {
        self.at.stages.get(self.at.stage + 1).filter(|next| next.point == self.stage().point)
    }

    /// True for the last one in its free stream.
    pub(crate) fn last(&self) -> bool {
        self.next().is_none()
    }
}

/// Where a stage ends.
pub(crate) struct Reached<S: System> {
    /// State that the next stage goes on from.
    pub(crate) state: Vec<f64>,
    /// Frame and state at the end of the run, where this may be it.
    pub(crate) end: Option<(S::Frame, Vec<f64>)>,
    /// True when the stages that follow are not needed.
    pub(crate) enough: bool,
    /// True when no steady flow was found for want of one, not of iterations.
    pub(crate) unsteady: bool,
}

impl<S: System> Reached<S> {
    /// The end of a stage whose state may be that of the run.
    pub(crate) fn at(frame: S::Frame, state: Vec<f64>) -> Self {
        Self { end: Some((frame, state.clone())), state, enough: false, unsteady: false }
    }
}
