//! Parameters of a relaxation: its method, Courant numbers and linear solver.
use crate::math::multilevel::Cycle;

/// Method of relaxation to a steady state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Newton-GMRES (Newton-Krylov) method.
    NewtonKrylov,
    /// Sweeps of the preconditioner alone (LU-SGS).
    Sweeps,
    /// Explicit five-stage Runge-Kutta with local time steps (Jameson 1991).
    RungeKutta,
}

/// Parameters of a relaxation.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    /// Method of relaxation.
    pub method: Method,
    /// Courant number at the start.
    pub cfl: f64,
    /// Maximum Courant number.
    pub cfl_max: f64,
    /// Maximum factor by which the Courant number grows in one step.
    pub growth: f64,
    /// Relative reduction of the residual in each linear solve.
    pub tolerance: f64,
    /// Maximum number of basis vectors of GMRES.
    pub basis: usize,
    /// Number of rows that form one row of the next coarser level.
    pub group: usize,
    /// Multigrid cycle: the order in which levels are visited.
    pub cycle: Cycle,
}

impl Control {
    /// Newton-GMRES in `dimension` dimensions, with the default values of all cases.
    pub const fn newton(dimension: usize) -> Self {
        Self {
            method: Method::NewtonKrylov,
            cfl: 10.0,
            cfl_max: 1e6,
            growth: 4.0,
            tolerance: 0.1,
            basis: 30,
            group: 1 << dimension,
            cycle: Cycle { sweeps: 2, visits: 1, levels: 8 },
        }
    }
}

/// Phase of a Newton-Krylov relaxation, and its progress.
#[derive(Clone, Copy, Debug)]
pub struct Phase {
    /// True for Newton's method, false for sweeps alone.
    pub newton: bool,
    /// Number of iterations in this phase.
    pub age: u32,
    /// Minimum residual in this phase.
    pub best: f64,
    /// Iteration of the phase at which the minimum was reached.
    pub best_age: u32,
}

impl Default for Phase {
    fn default() -> Self {
        Self { newton: false, age: 0, best: f64::INFINITY, best_age: 0 }
    }
}
