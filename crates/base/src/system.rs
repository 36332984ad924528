//! The seam between space and time.
//!
//! Space gives a semi-discrete system dU/dt = R(t, U); time integrates it without knowing what it means. The unknowns are one
//! flat slice that is cut into *fields*: the gas, a structure's coordinates, bodies of particles and what
//! their materials remember. What depends on time and coordinates but is not evolved (positions, velocities, normals and weights of moving
//! particles) is one value, the *frame*: an evaluation reads it and changes nothing in it. Marching holds one frame, harmonic balance one per time instance.
//!
//! Particles move where prescribed motions or unknown *coordinates* of bodies put them. Their velocities follow from positions
//! by the difference formula of the state itself, Σ c_k x(t_k, U_k): an [`Instant`] carries that formula with times and
//! coordinates, so that uniform flow stays uniform to round-off whatever moves the cloud.
//!
//! How the linear systems of an implicit method are preconditioned is a thing of its own, [`Preconditioner`].
use std::ops::Range;

use crate::math::fourier::Instances;
use crate::math::krylov::Numbers;
use crate::math::multilevel::Cycle;
use crate::math::parallel::sweep_slots;
use crate::math::reduce::{largest_size, norm};
use crate::math::sparse::Symmetric;

pub use field::{Field, Name, Placed, Ranges, placed, rows, rows_of, unknowns, unknowns_of};

mod field;

/// Change of the state in derivatives that are differences, over its size, and of coordinates, in lengths of the case and radians.
const DIFFERENCE: f64 = 1e-6;

/// One term c f(t) of a difference formula for ∂f/∂t.
#[derive(Clone, Copy, Debug)]
pub struct Term<'a> {
    /// Coefficient c.
    pub coefficient: f64,
    /// Time t.
    pub time: f64,
    /// The unknowns that place the frame at that time, see [`System::placing`]; empty where motion is prescribed.
    pub coordinates: &'a [f64],
}

impl Term<'_> {
    /// A term of a formula in time alone.
    pub const fn of_time(coefficient: f64, time: f64) -> Self {
        Self { coefficient, time, coordinates: &[] }
    }
}

/// How velocities follow from positions.
#[derive(Clone, Copy, Debug)]
pub enum Rate<'a> {
    /// Everything is looked at as if it stood still: steady flow.
    Still,
    /// Part of the way through a step of an explicit method: particles go straight from where they are at its start to where
    /// they are at its end.
    Within {
        /// Time at the start of the step.
        start: f64,
        /// Length of the step.
        step: f64,
        /// Part of the step that has passed, 0 to 1.
        fraction: f64,
        /// The unknowns that place the frame at the start and at the end; empty where all motion is prescribed.
        ends: [&'a [f64]; 2],
    },
    /// By a difference formula; its first term is that of the time at which the frame is wanted, where it has one.
    Formula(&'a [Term<'a>]),
}

/// A time at which a frame is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Instant<'a> {
    /// Time.
    pub time: f64,
    /// The unknowns that place the frame then, see [`System::placing`].
    pub coordinates: &'a [f64],
    /// How velocities follow.
    pub rate: Rate<'a>,
}

impl<'a> Instant<'a> {
    /// A time at which everything stands still.
    pub const fn still(time: f64) -> Self {
        Self { time, coordinates: &[], rate: Rate::Still }
    }

    /// Part `fraction` of the way through the step of length `step` that begins at `start`.
    pub fn within(start: f64, step: f64, fraction: f64) -> Self {
        Self {
            time: start + step * fraction,
            coordinates: &[],
            rate: Rate::Within { start, step, fraction, ends: [&[]; 2] },
        }
    }

    /// The same where unknowns place the frame, those at the start and at the end of the step.
    pub fn between(start: f64, step: f64, fraction: f64, ends: [&'a [f64]; 2]) -> Self {
        Self { time: start + step * fraction, coordinates: ends[1], rate: Rate::Within { start, step, fraction, ends } }
    }

    /// A time at which ∂/∂t is `formula`.
    pub const fn formula(time: f64, formula: &'a [Term<'a>]) -> Self {
        Self { time, coordinates: &[], rate: Rate::Formula(formula) }
    }

    /// The same with the unknowns that place the frame.
    pub const fn with(self, coordinates: &'a [f64]) -> Self {
        Self { coordinates, ..self }
    }
}

/// A semi-discrete system dU/dt = R(t, U), eq. (16): the only thing an integrator ever sees.
#[doc(alias = "eq16")]
pub trait System: Sync {
    /// What depends on time and state but is not evolved.
    type Frame: Clone + Send + Sync;
    /// Storage that an evaluation needs; made once, so that evaluations do not allocate.
    type Work: Send;

    /// What the unknowns are, in the order in which the state holds them.
    fn fields(&self) -> &[Field];
    /// Number of unknowns.
    fn len(&self) -> usize {
        unknowns(self.fields())
    }
    /// True when there is nothing to evolve.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// The unknowns of a field in the state; empty where the system has none of that name.
    fn unknowns_of(&self, name: Name) -> Range<usize> {
        unknowns_of(self.fields(), name)
    }
    /// The rows of a field among all rows; empty where the system has none of that name.
    fn rows_of(&self, name: Name) -> Range<usize> {
        rows_of(self.fields(), name)
    }
    /// The unknowns that frames depend on: coordinates of bodies. Whole fields; empty where all motion is prescribed.
    fn placing(&self) -> &Ranges {
        Ranges::NONE
    }
    /// Has the unknowns that [remember](Name::History) take in the step that has led to the state `u`, whose other unknowns are solved.
    fn settle(&self, _frame: &Self::Frame, _work: &mut Self::Work, _u: &mut [f64]) {}
    /// Fresh storage.
    fn work(&self) -> Self::Work;
    /// The frame at an instant and at the state `u`.
    fn frame(&self, at: &Instant<'_>, u: &[f64]) -> Self::Frame;
    /// Brings the particles of a frame to an instant; does nothing when they never move.
    fn place(&self, at: &Instant<'_>, frame: &mut Self::Frame);
    /// Puts unknowns that are prescribed where they are to be at a time: where a solve begins.
    fn prescribe(&self, _time: f64, _u: &mut [f64]) {}
    /// Brings a state from one time to another as far as what is prescribed leads it: a guess to begin with, whose difference from the
    /// truth varies less than the state.
    fn lead(&self, _from: f64, to: f64, u: &mut [f64]) {
        self.prescribe(to, u);
    }
    /// Lets particles that travel with the state choose where they go in the step that begins, which is meant to be as long as
    /// `step`; the longest step they can take, infinite where none do.
    fn plan_lagrangian_step(&self, _step: f64, _u: &[f64], _work: &mut Self::Work, _frame: &mut Self::Frame) -> f64 {
        f64::INFINITY
    }
    /// du = R(t, u), what the boundary holds beside the state `u` included.
    fn rhs(&self, frame: &Self::Frame, u: &[f64], work: &mut Self::Work, du: &mut [f64]);
    /// out = ∂R/∂U v at `[u, v]` in a frame that stays as it is: exact where a system knows its derivative, else a central difference, whose
    /// relative error is about 1e-8 where R is smooth. What unknowns remember counts as constant.
    fn jvp(&self, frame: &Self::Frame, [u, v]: [&[f64]; 2], work: &mut Self::Work, out: &mut [f64]) {
        let size = norm(v);
        if size == 0.0 {
            return out.fill(0.0);
        }
        let step = DIFFERENCE * norm(u).max(f64::MIN_POSITIVE.sqrt()) / size;
        let mut moved: Vec<f64> = u.iter().zip(v).map(|(u, v)| u + step * v).collect();
        self.rhs(frame, &moved, work, out);
        moved.iter_mut().zip(u.iter().zip(v)).for_each(|(m, (u, v))| *m = u - step * v);
        let mut back = vec![0.0; out.len()];
        self.rhs(frame, &moved, work, &mut back);
        out.iter_mut().zip(&back).for_each(|(o, b)| *o = (*o - b) / (2.0 * step));
    }
    /// out = dR/dU v at `[u, v]` where the frame goes with the state: [`jvp`](Self::jvp), and how R changes with the frame, from two frames
    /// beside it that `place` brings to coordinates, see [`placing`](Self::placing). The relative error of that part is at most 1e-6 where R is
    /// smooth, whether coordinates move clouds rigidly or deform them; there is no such part, and no error, where all motion is prescribed.
    fn jvp_with_frame(
        &self,
        frame: &Self::Frame,
        place: &dyn Fn(&[f64], &mut Self::Frame),
        [u, v]: [&[f64]; 2],
        work: &mut Self::Work,
        out: &mut [f64],
    ) {
        self.jvp(frame, [u, v], work, out);
        let [q, dq] = [u, v].map(|all| self.placing().values(all));
        let fastest = largest_size(dq.len(), |k| dq[k]);
        if fastest == 0.0 {
            return;
        }
        let step = DIFFERENCE / fastest;
        let (mut beside, mut there) = (frame.clone(), vec![0.0; out.len()]);
        for side in [step, -step] {
            let moved: Vec<f64> = q.iter().zip(dq.iter()).map(|(q, dq)| q + side * dq).collect();
            place(&moved, &mut beside);
            self.rhs(&beside, u, work, &mut there);
            out.iter_mut().zip(&there).for_each(|(o, r)| *o += r / (2.0 * side));
        }
    }
    /// Largest rate of change 1/τ of each row: explicit steps need Δt · rate ≲ 1.
    fn rates(&self, frame: &Self::Frame, u: &[f64], work: &mut Self::Work, rate: &mut [f64]);
    /// The largest relative change of a positive quantity (density, pressure) that the update `du` makes, or of a coordinate in
    /// its unit; infinite if NaN.
    fn largest_change(&self, u: &[f64], du: &[f64]) -> f64;
    /// Shortens the update `du` until its [largest change](Self::largest_change) is at most `largest`. Rows whose changes are known one by
    /// one are shortened one by one: where a shock passes, a few particles must not hold back all others. Others as a whole.
    fn shorten(&self, u: &[f64], du: &mut [f64], largest: f64) {
        let change = self.largest_change(u, du);
        if change > largest && change.is_finite() {
            sweep_slots(du, |_, du| *du *= largest / change);
        }
    }
    /// Largest pressure of a gas over its smallest in the state `u`, from which follows how strong shocks can be; infinite where unknown.
    fn pressure_ratio(&self, _u: &[f64]) -> f64 {
        f64::INFINITY
    }
    /// Refuses a state that is not physical.
    fn check(&self, frame: &Self::Frame, u: &[f64]) -> Result<(), Fault>;
    /// Refuses a frame whose particles motion has brought where the cloud no longer serves.
    fn check_frame(&self, _frame: &Self::Frame) -> Result<(), Fault> {
        Ok(())
    }
    /// Where a row of the state is; nothing when it has no place.
    fn locate(&self, _frame: &Self::Frame, _row: usize) -> Vec<f64> {
        Vec::new()
    }
}

/// A structure at a moment.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Time.
    pub time: f64,
    /// Time since materials had their history; 0 for an instant.
    pub step: f64,
    /// Displacements.
    pub displacement: &'a [f64],
    /// Their rates.
    pub velocity: &'a [f64],
    /// What materials remember.
    pub history: &'a [f64],
}

/// How a structure is damped: by α M + β K about the shape at rest, as far as that goes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// α, in proportion to mass.
    pub mass: f64,
    /// β, in proportion to stiffness.
    pub stiffness: f64,
    /// False where there is none but in proportion to mass.
    pub is_viscous: bool,
}

/// A system of second order, M u″ = f(t, u, u′, history): structures. Its state is displacements, as many velocities, and what
/// materials remember, which grows with each step that is taken and not in between.
pub trait Mechanical: System {
    /// The stiffness at a state.
    type Stiffness: Send;

    /// Number of displacements.
    fn displacements(&self) -> usize;
    /// Mass that displacement number `k` moves.
    fn mass(&self, k: usize) -> f64;
    /// True where a support decides on displacement number `k`.
    fn is_held(&self, k: usize) -> bool;
    /// Puts what is held where it is to be at a time.
    fn hold(&self, time: f64, displacement: &mut [f64]);
    /// Forces at a moment, and what materials remember of it.
    fn forces(&self, at: &Moment<'_>, work: &mut Self::Work, force: &mut [f64], after: &mut [f64]);
    /// Refuses a state whose forces were found last with `work`.
    fn check_forces(&self, work: &Self::Work, displacement: &[f64]) -> Result<(), Fault>;
    /// The longest step for which explicit methods are stable.
    fn stable_step(&self, displacement: &[f64]) -> f64;
    /// `parts[0]` times the stiffness and `parts[1]` times the damping −∂f/∂u′ at a moment, without that in proportion to mass.
    fn linearise(&self, at: &Moment<'_>, parts: [f64; 2]) -> Self::Stiffness;
    /// How it is damped.
    fn damping(&self) -> Damping;
    /// out = K w.
    fn stiffness(&self, stiffness: &Self::Stiffness, w: &[f64], work: &mut Self::Work, out: &mut [f64]);
    /// `scale` K + `shift` M among what is free, one for what is held.
    fn matrix(&self, stiffness: &Self::Stiffness, scale: f64, shift: f64) -> Symmetric;
    /// The diagonal of K.
    fn diagonal(&self, stiffness: &Self::Stiffness) -> Vec<f64>;
    /// Unknowns of the largest matrix that is factored; conjugate gradients do without beyond.
    fn largest_factored(&self) -> usize;
}

/// What an implicit method needs besides.
pub trait Implicit: System {
    /// How its linear systems are preconditioned.
    type Preconditioner: Preconditioner<Self>;

    /// An empty preconditioner; for all instances of a period at once where a `period` is given.
    fn preconditioner(&self, plan: &Hierarchy, period: Option<Period>) -> Self::Preconditioner;
}

/// How a preconditioner may spread over a cloud.
#[derive(Clone, Copy, Debug)]
pub struct Hierarchy {
    /// Rows that are gathered into one of the next coarser level.
    pub group: usize,
    /// Visits of the levels.
    pub cycle: Cycle,
}

/// Instances of a period of a solution that is periodic in time.
#[derive(Clone, Copy, Debug)]
pub struct Period {
    /// The instances.
    pub instances: Instances,
    /// Angular frequency.
    pub omega: f64,
    /// False where what is sought has no mean over the period.
    pub mean: bool,
}

/// How far the unknowns of a linear system feel one another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reach {
    /// As far as their neighbours: a short step in time.
    #[default]
    Near,
    /// Across the cloud.
    Far,
}

/// What is added to −∂R/∂U in a linear system.
#[derive(Clone, Copy, Debug)]
pub struct Shift<'a> {
    /// How fast each row can change, 1/τ.
    pub rates: &'a [f64],
    /// Courant number: Δτ over τ.
    pub cfl: f64,
    /// Coefficient c of the state sought in the formula of ∂/∂t.
    pub coefficient: f64,
    /// How far the system reaches.
    pub reach: Reach,
}

impl Shift<'_> {
    /// 1/Δτ + c of row `i`.
    #[inline(always)]
    pub fn of(&self, i: usize) -> f64 {
        self.rates[i] / self.cfl + self.coefficient
    }
}

/// The right-hand side of a linear system; rows scaled by `scale` where it is not empty.
#[derive(Clone, Copy, Debug)]
pub enum RightHandSide<'a> {
    /// Divided by the scale of each row.
    Scaled {
        /// Values.
        values: Numbers<'a>,
        /// Scale of each row.
        scale: &'a [f64],
    },
    /// As it is.
    Plain(&'a [f64]),
}

impl RightHandSide<'_> {
    /// Row `i`, which begins at unknown number `at`.
    #[inline(always)]
    pub fn row(&self, i: usize, at: usize, row: &mut [f32]) {
        match self {
            Self::Scaled { values, scale } => {
                values.each(at, row, |row, r| *row = (f64::from(r) / scale[i]) as f32);
            }
            Self::Plain(values) => row.iter_mut().zip(&values[at..]).for_each(|(row, r)| *row = *r as f32),
        }
    }

    /// The same in double precision.
    pub fn row_in_full(&self, i: usize, at: usize, row: &mut [f64]) {
        match self {
            Self::Scaled { values, scale } => {
                values.each(at, row, |row, r| *row = f64::from(r) / scale[i]);
            }
            Self::Plain(values) => row.iter_mut().zip(&values[at..]).for_each(|(row, r)| *row = *r),
        }
    }

    /// The part of it that belongs to one field.
    pub fn of<'b>(&'b self, field: &Placed) -> RightHandSide<'b> {
        match self {
            Self::Scaled { values, scale } => {
                RightHandSide::Scaled { values: values.of(field.unknowns.clone()), scale: &scale[field.rows.clone()] }
            }
            Self::Plain(values) => RightHandSide::Plain(&values[field.unknowns.clone()]),
        }
    }
}

/// Approximate inverses of shift − ∂R/∂U, one after another: made from one or several points, applied many times, made again
/// when the integrator asks for it.
///
/// In harmonic balance the instances of a row are tied together by ∂/∂t, which belongs to the preconditioner as well: lagging
/// it outside diverges.
pub trait Preconditioner<S: System + ?Sized>: Send {
    /// Begins anew with the mean of the linearisations at `points` points.
    fn begin(&mut self, points: usize);
    /// Adds the linearisation at the state `u`.
    fn add(&mut self, system: &S, frame: &S::Frame, u: &[f64], work: &mut S::Work);
    /// Completes it with what is added to −∂R/∂U.
    fn finish(&mut self, shift: &Shift<'_>);
    /// z ≈ (shift − ∂R/∂U)⁻¹ r, in the frames at hand: one when marching, one for each instance that the unknowns hold in a
    /// periodic solution. They may have moved on since it was made.
    fn apply(&mut self, system: &S, frames: &[&S::Frame], r: &RightHandSide<'_>, z: &mut [f64]);
    /// Bytes held.
    fn bytes(&self) -> usize;

    /// Makes it at one point.
    fn update(&mut self, system: &S, at: (&S::Frame, &[f64]), work: &mut S::Work, shift: &Shift<'_>) {
        self.begin(1);
        self.add(system, at.0, at.1, work);
        self.finish(shift);
    }
}

/// A row whose state is not physical.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Index of the row.
    pub particle: usize,
    /// Where it is.
    pub place: Vec<f64>,
    /// What is wrong with it.
    pub reason: String,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let place: Vec<String> = self.place.iter().map(|c| format!("{c:.5}")).collect();
        match place.is_empty() {
            true => write!(f, "{}", self.reason),
            false => write!(f, "particle {} at ({}): {}", self.particle, place.join(", "), self.reason),
        }
    }
}
