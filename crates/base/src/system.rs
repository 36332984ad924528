//! Interface between the discretisation in space and the integrators in time.
//!
//! The discretisation in space gives a semi-discrete system dU/dt = R(t, U); the integrators know nothing of its
//! physics. The unknowns are one flat slice, divided into *fields*: the gas, the coordinates of a structure, the
//! displacements of solids and the internal variables of their materials. Data that depend on time and coordinates but
//! are not integrated (positions, velocities, normals and weights of moving particles) form the *frame*, which an
//! evaluation of R reads and does not change. A march keeps one frame; harmonic balance keeps one for each time
//! instance.
//!
//! Particles follow prescribed motions or the unknown *coordinates* of bodies. Particle velocities are computed from
//! positions by the same difference formula as the time derivative of the state, Σ c_k x(t_k, U_k). An [`Instant`]
//! therefore carries this formula with its times and coordinates, so that uniform flow stays uniform to round-off on a
//! moving cloud.
//!
//! The trait [`Preconditioner`] describes how the linear systems of an implicit method are preconditioned.
use std::ops::Range;

use crate::math::fourier::Instances;
use crate::math::krylov::Numbers;
use crate::math::multilevel::Cycle;
use crate::math::parallel::sweep_slots;
use crate::math::reduce::{largest_size, norm};
use crate::math::sparse::Symmetric;

pub use field::{Field, Name, Placed, Ranges, placed, rows, rows_of, unknowns, unknowns_of};

mod field;

/// Step of difference quotients: the change of the state relative to its norm, and the change of coordinates in lengths
/// of the case or in radians.
const DIFFERENCE: f64 = 1e-6;

/// One term c f(t) of a difference formula for ∂f/∂t.
#[derive(Clone, Copy, Debug)]
pub struct Term<'a> {
    /// Coefficient c [1/time] of the term.
    pub coefficient: f64,
    /// Time t of the term.
    pub time: f64,
    /// Coordinates that determine the frame at that time, see [`System::placing`]; empty if all motion is prescribed.
    pub coordinates: &'a [f64],
}

impl Term<'_> {
    /// A term of a formula for prescribed motion, without coordinates.
    pub const fn of_time(coefficient: f64, time: f64) -> Self {
        Self { coefficient, time, coordinates: &[] }
    }
}

/// How particle velocities are computed from positions.
#[derive(Clone, Copy, Debug)]
pub enum Rate<'a> {
    /// All particle velocities are zero: steady flow.
    Still,
    /// Within a step of an explicit method: particles move with constant velocity from their positions at the start of
    /// the step to those at its end.
    Within {
        /// Time at the start of the step.
        start: f64,
        /// Length of the step.
        step: f64,
        /// Elapsed fraction of the step, 0 to 1.
        fraction: f64,
        /// Coordinates that determine the frame at the start and at the end of the step; empty if all motion is
        /// prescribed.
        ends: [&'a [f64]; 2],
    },
    /// Difference formula. If it has a term at the time of the requested frame, that term comes first.
    Formula(&'a [Term<'a>]),
}

/// A time at which a frame is requested, with the rule for particle velocities.
#[derive(Clone, Copy, Debug)]
pub struct Instant<'a> {
    /// Time of the frame.
    pub time: f64,
    /// Coordinates that determine the frame at that time, see [`System::placing`]; empty if all motion is prescribed.
    pub coordinates: &'a [f64],
    /// How particle velocities are computed.
    pub rate: Rate<'a>,
}

impl<'a> Instant<'a> {
    /// An instant at `time` with zero particle velocities and no coordinates.
    pub const fn still(time: f64) -> Self {
        Self { time, coordinates: &[], rate: Rate::Still }
    }

    /// The instant at the fraction `fraction` of the step of length `step` that begins at `start`, for prescribed
    /// motion.
    pub fn within(start: f64, step: f64, fraction: f64) -> Self {
        Self {
            time: start + step * fraction,
            coordinates: &[],
            rate: Rate::Within { start, step, fraction, ends: [&[]; 2] },
        }
    }

    /// The instant at the fraction `fraction` of a step, as [`Instant::within`], where `ends` holds the coordinates at
    /// the start and at the end of the step.
    pub fn between(start: f64, step: f64, fraction: f64, ends: [&'a [f64]; 2]) -> Self {
        Self { time: start + step * fraction, coordinates: ends[1], rate: Rate::Within { start, step, fraction, ends } }
    }

    /// An instant at `time` at which ∂/∂t is approximated by `formula`.
    pub const fn formula(time: f64, formula: &'a [Term<'a>]) -> Self {
        Self { time, coordinates: &[], rate: Rate::Formula(formula) }
    }

    /// This instant with the coordinates `coordinates`.
    pub const fn with(self, coordinates: &'a [f64]) -> Self {
        Self { coordinates, ..self }
    }
}

/// A semi-discrete system dU/dt = R(t, U), eq. (16): the interface on which all integrators rest.
#[doc(alias = "eq16")]
pub trait System: Sync {
    /// Geometry that depends on time and state but is not integrated.
    type Frame: Clone + Send + Sync;
    /// Working storage of an evaluation; it is created once, so that evaluations do not allocate.
    type Work: Send;

    /// Fields of unknowns, in the order in which the state holds them.
    fn fields(&self) -> &[Field];
    /// Number of unknowns.
    fn len(&self) -> usize {
        unknowns(self.fields())
    }
    /// True if there are no unknowns.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Range of the unknowns of a field in the state; empty if the system has no field of that name.
    fn unknowns_of(&self, name: Name) -> Range<usize> {
        unknowns_of(self.fields(), name)
    }
    /// Range of the rows of a field among all rows; empty if the system has no field of that name.
    fn rows_of(&self, name: Name) -> Range<usize> {
        rows_of(self.fields(), name)
    }
    /// Unknowns on which frames depend, which are the coordinates of bodies, as whole fields; empty if all motion is
    /// prescribed.
    fn placing(&self) -> &Ranges {
        Ranges::NONE
    }
    /// Updates the [internal variables of the materials](Name::History) at the end of an accepted step. All other
    /// unknowns of `u` are already solved.
    fn settle(&self, _frame: &Self::Frame, _work: &mut Self::Work, _u: &mut [f64]) {}
    /// Creates working storage.
    fn work(&self) -> Self::Work;
    /// The frame at the instant `at` and at the state `u`.
    fn frame(&self, at: &Instant<'_>, u: &[f64]) -> Self::Frame;
    /// Moves the particles of `frame` to the instant `at`; does nothing if they never move.
    fn place(&self, at: &Instant<'_>, frame: &mut Self::Frame);
    /// Imposes the prescribed unknowns at the time `_time` on the state `_u`, where a solve begins.
    fn prescribe(&self, _time: f64, _u: &mut [f64]) {}
    /// Predictor: advances the prescribed part of the state `u` from the time `_from` to the time `to`. The result is
    /// an initial guess; its difference from the solution varies less in time than the state itself.
    fn lead(&self, _from: f64, to: f64, u: &mut [f64]) {
        self.prescribe(to, u);
    }
    /// Plans the displacement of particles that move with the fluid (Lagrangian particles) in the next step, whose
    /// intended length is `_step`. Returns the longest step that they allow; infinite if there are no such particles.
    fn plan_lagrangian_step(&self, _step: f64, _u: &[f64], _work: &mut Self::Work, _frame: &mut Self::Frame) -> f64 {
        f64::INFINITY
    }
    /// Evaluates du = R(t, u), including the contributions of the boundary conditions.
    fn rhs(&self, frame: &Self::Frame, u: &[f64], work: &mut Self::Work, du: &mut [f64]);
    /// Computes out = ∂R/∂U v at `[u, v]` in a fixed frame. The product is exact if the system implements its
    /// derivative, else a central difference, whose relative error is about 1e-8 where R is smooth. Internal variables
    /// of materials are taken as constant.
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
    /// Computes out = dR/dU v at `[u, v]` when the frame follows the state: the product [`jvp`](Self::jvp) plus the
    /// change of R with the frame. The second part is a central difference of two frames, which `place` sets to given
    /// coordinates, see [`placing`](Self::placing). Its relative error is at most 1e-6 where R is smooth, whether the
    /// coordinates move clouds rigidly or deform them; it vanishes if all motion is prescribed.
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
    /// Maximum rate of change 1/τ of each row [1/time]: explicit steps need Δt · rate ≲ 1.
    fn rates(&self, frame: &Self::Frame, u: &[f64], work: &mut Self::Work, rate: &mut [f64]);
    /// Maximum relative change of a positive quantity (density, pressure) by the update `du`, or maximum change of a
    /// coordinate in its unit; infinite if a value is NaN.
    fn largest_change(&self, u: &[f64], du: &[f64]) -> f64;
    /// Scales the update `du` so that its [largest change](Self::largest_change) is at most `largest`. Systems that
    /// know the change of each row may scale row by row: near a moving shock, a few particles must not limit the update
    /// of all others. By default the whole update is scaled.
    fn shorten(&self, u: &[f64], du: &mut [f64], largest: f64) {
        let change = self.largest_change(u, du);
        if change > largest && change.is_finite() {
            sweep_slots(du, |_, du| *du *= largest / change);
        }
    }
    /// Ratio of the greatest to the smallest value of the quantity that jumps at discontinuities (the pressure of a gas)
    /// in the state `_u`, which indicates how strong they can be; infinite if unknown.
    fn contrast(&self, _u: &[f64]) -> f64 {
        f64::INFINITY
    }
    /// Returns an error with the row and its position if the state `u` is not physical.
    fn check(&self, frame: &Self::Frame, u: &[f64]) -> Result<(), Fault>;
    /// Returns an error if the motion has made the cloud of the frame unusable, e.g. because neighbours no longer
    /// determine a gradient.
    fn check_frame(&self, _frame: &Self::Frame) -> Result<(), Fault> {
        Ok(())
    }
    /// Position of a row of the state; empty if the row has no position.
    fn locate(&self, _frame: &Self::Frame, _row: usize) -> Vec<f64> {
        Vec::new()
    }
}

/// State of a structure at one time, at which forces are evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Time at which forces are evaluated.
    pub time: f64,
    /// Time since the last update of the internal variables; 0 for a single instant.
    pub step: f64,
    /// Displacements of all degrees of freedom.
    pub displacement: &'a [f64],
    /// Velocities of all degrees of freedom.
    pub velocity: &'a [f64],
    /// Internal variables of the materials.
    pub history: &'a [f64],
}

/// Rayleigh damping α M + β K of a structure, with the stiffness K of the undeformed shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// Coefficient α of the damping proportional to mass [1/time].
    pub mass: f64,
    /// Coefficient β of the damping proportional to stiffness (time).
    pub stiffness: f64,
    /// True if there is damping other than that proportional to mass.
    pub is_viscous: bool,
}

/// A second-order system M u″ = f(t, u, u′, history): a structure. Its state consists of the displacements, the
/// velocities and the internal variables of the materials, which change only when a step is accepted.
pub trait Mechanical: System {
    /// Stiffness matrix, with damping, linearised about a state.
    type Stiffness: Send;

    /// Number of displacements.
    fn displacements(&self) -> usize;
    /// Mass of the degree of freedom `k`.
    fn mass(&self, k: usize) -> f64;
    /// True if a support prescribes the degree of freedom `k`.
    fn is_held(&self, k: usize) -> bool;
    /// Imposes the displacements of the supports at the time `time`.
    fn hold(&self, time: f64, displacement: &mut [f64]);
    /// Computes the forces at `at`, and the internal variables `after` that result from it.
    fn forces(&self, at: &Moment<'_>, work: &mut Self::Work, force: &mut [f64], after: &mut [f64]);
    /// Returns an error if the state of the last evaluation of forces with `work` is not physical.
    fn check_forces(&self, work: &Self::Work, displacement: &[f64]) -> Result<(), Fault>;
    /// Largest time step for which explicit methods are stable.
    fn stable_step(&self, displacement: &[f64]) -> f64;
    /// Linearises the forces: `parts[0]` times the stiffness plus `parts[1]` times the damping −∂f/∂u′, without the
    /// damping proportional to mass.
    fn linearise(&self, at: &Moment<'_>, parts: [f64; 2]) -> Self::Stiffness;
    /// Coefficients of the damping.
    fn damping(&self) -> Damping;
    /// Computes out = K w.
    fn stiffness(&self, stiffness: &Self::Stiffness, w: &[f64], work: &mut Self::Work, out: &mut [f64]);
    /// The matrix `scale` K + `shift` M of the free degrees of freedom, with the identity for those of supports.
    fn matrix(&self, stiffness: &Self::Stiffness, scale: f64, shift: f64) -> Symmetric;
    /// Diagonal of K.
    fn diagonal(&self, stiffness: &Self::Stiffness) -> Vec<f64>;
    /// Number of unknowns up to which the matrix is factored; larger systems are solved by conjugate gradients without
    /// a factorisation.
    fn largest_factored(&self) -> usize;
}

/// A system that implicit methods can integrate, because it has a preconditioner.
pub trait Implicit: System {
    /// Preconditioner of the linear systems.
    type Preconditioner: Preconditioner<Self>;

    /// Creates an empty preconditioner; with a `period`, one for all instances of the period together.
    fn preconditioner(&self, plan: &Hierarchy, period: Option<Period>) -> Self::Preconditioner;
}

/// Levels of a multilevel preconditioner.
#[derive(Clone, Copy, Debug)]
pub struct Hierarchy {
    /// Number of rows that form one row of the next coarser level.
    pub group: usize,
    /// Multigrid cycle: the order in which levels are visited.
    pub cycle: Cycle,
}

/// Time instances of a solution that is periodic in time.
#[derive(Clone, Copy, Debug)]
pub struct Period {
    /// Instances of one period.
    pub instances: Instances,
    /// Angular frequency ω [rad/time].
    pub omega: f64,
    /// False if the unknown has a zero mean over the period, as in linearised problems.
    pub mean: bool,
}

/// Range over which the unknowns of a linear system are coupled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reach {
    /// Local coupling between neighbours: short time steps.
    #[default]
    Near,
    /// Global coupling across the cloud: long time steps and steady flow.
    Far,
}

/// Diagonal that is added to −∂R/∂U in a linear system.
#[derive(Clone, Copy, Debug)]
pub struct Shift<'a> {
    /// Maximum rate of change of each row, 1/τ [1/time].
    pub rates: &'a [f64],
    /// Courant number Δτ/τ of the pseudo-time step.
    pub cfl: f64,
    /// Coefficient c of the new state in the difference formula of ∂/∂t [1/time].
    pub coefficient: f64,
    /// Range of the coupling between unknowns.
    pub reach: Reach,
}

impl Shift<'_> {
    /// Diagonal entry 1/Δτ + c of row `i`.
    #[inline(always)]
    pub fn of(&self, i: usize) -> f64 {
        self.rates[i] / self.cfl + self.coefficient
    }
}

/// Right-hand side of a linear system.
#[derive(Clone, Copy, Debug)]
pub enum RightHandSide<'a> {
    /// Stored values, each row of which is divided by its scale.
    Scaled {
        /// Stored values, one for each unknown.
        values: Numbers<'a>,
        /// Scale, one for each row.
        scale: &'a [f64],
    },
    /// Values without scaling, one for each unknown.
    Plain(&'a [f64]),
}

impl RightHandSide<'_> {
    /// Writes row `i`, whose first unknown has the index `at`, in single precision.
    #[inline(always)]
    pub fn row(&self, i: usize, at: usize, row: &mut [f32]) {
        match self {
            Self::Scaled { values, scale } => {
                values.each(at, row, |row, r| *row = (f64::from(r) / scale[i]) as f32);
            }
            Self::Plain(values) => row.iter_mut().zip(&values[at..]).for_each(|(row, r)| *row = *r as f32),
        }
    }

    /// Writes row `i`, whose first unknown has the index `at`, in double precision.
    pub fn row_in_full(&self, i: usize, at: usize, row: &mut [f64]) {
        match self {
            Self::Scaled { values, scale } => {
                values.each(at, row, |row, r| *row = f64::from(r) / scale[i]);
            }
            Self::Plain(values) => row.iter_mut().zip(&values[at..]).for_each(|(row, r)| *row = *r),
        }
    }

    /// The part of this right-hand side that belongs to one field.
    pub fn of<'b>(&'b self, field: &Placed) -> RightHandSide<'b> {
        match self {
            Self::Scaled { values, scale } => {
                RightHandSide::Scaled { values: values.of(field.unknowns.clone()), scale: &scale[field.rows.clone()] }
            }
            Self::Plain(values) => RightHandSide::Plain(&values[field.unknowns.clone()]),
        }
    }
}

/// Approximate inverse of shift − ∂R/∂U. It is built from the linearisation at one or several points, applied many
/// times, and rebuilt when the integrator requests it.
///
/// In harmonic balance, ∂/∂t couples the instances of a row. The preconditioner must include this coupling: the
/// iteration diverges if the coupling is lagged.
pub trait Preconditioner<S: System + ?Sized>: Send {
    /// Discards the matrix and starts the average of the linearisations at `points` points.
    fn begin(&mut self, points: usize);
    /// Adds the linearisation at the state `u` to the average.
    fn add(&mut self, system: &S, frame: &S::Frame, u: &[f64], work: &mut S::Work);
    /// Completes the preconditioner with the diagonal that is added to −∂R/∂U.
    fn finish(&mut self, shift: &Shift<'_>);
    /// Computes z ≈ (shift − ∂R/∂U)⁻¹ r in the current frames, which may differ from those of the linearisation: one
    /// frame in a march, one for each instance of a periodic solution.
    fn apply(&mut self, system: &S, frames: &[&S::Frame], r: &RightHandSide<'_>, z: &mut [f64]);
    /// Memory in use (bytes).
    fn bytes(&self) -> usize;

    /// Builds the preconditioner from the linearisation at one point.
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
    /// Position of the row; empty if it has none.
    pub place: Vec<f64>,
    /// Description of the fault.
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
