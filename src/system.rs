//! The seam between space and time.
//!
//! Space gives a semi-discrete system dU/dt = R(t, U); time integrates it without knowing what it means. What depends on time
//! but is not evolved (states held on the outer boundary, positions, velocities, normals and weights of moving particles) is
//! one value, the *frame at (t, u)*. Marching holds one frame, harmonic balance one per instance.
use crate::math::block_matrix::BlockMatrix;
use crate::math::fourier::Instances;

/// A moment at which a frame is wanted, and how velocities follow from positions there.
#[derive(Clone, Copy, Debug)]
pub enum Moment<'a> {
    /// A time at which everything is looked at as if it stood still: steady flow.
    At {
        /// Time.
        time: f64,
    },
    /// Part of the way through a step: particles go straight from where they are at its start to where they are at its end.
    Within {
        /// Time at the start of the step.
        start: f64,
        /// Length of the step.
        step: f64,
        /// Part of the step that has passed, 0 to 1.
        fraction: f64,
    },
    /// A time at which ∂/∂t is a difference formula: Σ c_k f(t_k).
    By {
        /// Time.
        time: f64,
        /// Coefficients and times of the formula.
        rate: &'a [(f64, f64)],
    },
}

impl Moment<'_> {
    /// The time.
    pub fn time(&self) -> f64 {
        match self {
            Self::At { time } | Self::By { time, .. } => *time,
            Self::Within { start, step, fraction } => start + step * fraction,
        }
    }
}

/// A semi-discrete system dU/dt = R(t, U), eq. (16): the only thing an integrator ever sees.
#[doc(alias = "eq16")]
pub trait System: Sync {
    /// What depends on time but is not evolved.
    type Frame: Clone + Send + Sync;
    /// Storage that an evaluation needs; made once, so that evaluations do not allocate.
    type Work: Send;

    /// Number of unknowns per particle.
    fn block(&self) -> usize;
    /// Instances of a period that the unknowns of a particle hold one after another, and the angular frequency: those of a
    /// periodic solution.
    fn in_time(&self) -> Option<(Instances, f64)> {
        None
    }
    /// Number of unknowns.
    fn len(&self) -> usize;
    /// How many of the unknowns of a particle (and instance), the first ones, measure the size of a residual: the density
    /// of a gas stands for all.
    fn measured(&self) -> usize {
        1
    }
    /// True when there is nothing to evolve.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// The frame at a moment and at the state `u`.
    fn frame(&self, moment: &Moment<'_>, u: &[f64]) -> Self::Frame;
    /// Brings the particles of a frame to a moment; does nothing when they never move.
    fn place(&self, moment: &Moment<'_>, frame: &mut Self::Frame);
    /// Lets particles that follow the state choose where they go in the step that begins, which is meant to be as long as
    /// `step`; the longest step they can take, infinite where none follow it.
    fn set_off(&self, _step: f64, _u: &[f64], _work: &mut Self::Work, _frame: &mut Self::Frame) -> f64 {
        f64::INFINITY
    }
    /// Brings what follows the state (the far field) to the state `u`.
    fn follow(&self, u: &[f64], work: &mut Self::Work, frame: &mut Self::Frame);
    /// Fresh storage.
    fn work(&self) -> Self::Work;
    /// du = R(t, u).
    fn rhs(&self, frame: &Self::Frame, u: &[f64], work: &mut Self::Work, du: &mut [f64]);
    /// Largest rate of change 1/τ of each particle: explicit steps need Δt · rate ≲ 1.
    fn spectral_radius(&self, frame: &Self::Frame, u: &[f64], work: &mut Self::Work, rate: &mut [f64]);
    /// Sparsity of the linearised system: for each particle the others it depends on, itself left out.
    fn graph(&self) -> (&[u32], &[u32]);
    /// Consecutive particles that are assembled and swept together: the same for any number of threads.
    fn parts(&self) -> &[std::ops::Range<usize>];
    /// Fills `matrix` with −∂R/∂U of the first-order scheme, which is what implicit methods are preconditioned with.
    fn linearise(&self, frame: &Self::Frame, u: &[f64], work: &mut Self::Work, matrix: &mut BlockMatrix);
    /// Brings the unknowns of a particle into the axes of that matrix: those of a rigid cloud, so that the matrix goes on to
    /// serve while it turns.
    fn inward(&self, _frame: &Self::Frame, _row: &mut [f32]) {}
    /// Brings them back from there.
    fn outward(&self, _frame: &Self::Frame, _row: &mut [f64]) {}
    /// The largest relative change of a positive quantity (density, pressure) that the update `du` makes; infinite if NaN.
    fn largest_change(&self, u: &[f64], du: &[f64]) -> f64;
    /// The first particle whose state is not physical, if any.
    fn fault(&self, frame: &Self::Frame, u: &[f64]) -> Option<Fault>;
    /// The first particle that motion has brought where the cloud no longer serves, if any.
    fn misplaced(&self, _frame: &Self::Frame) -> Option<Fault> {
        None
    }
    /// Where an unknown of the state is; nothing when it has no place.
    fn locate(&self, _frame: &Self::Frame, _particle: usize) -> Vec<f64> {
        Vec::new()
    }
}

/// A particle whose state is not physical.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Index of the particle.
    pub particle: usize,
    /// Where it is.
    pub place: Vec<f64>,
    /// What is wrong with it.
    pub reason: String,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let place: Vec<String> = self.place.iter().map(|c| format!("{c:.5}")).collect();
        write!(f, "particle {} at ({}): {}", self.particle, place.join(", "), self.reason)
    }
}
