//! How a relaxation is steered: its method, Courant numbers and linear solver.
use crate::math::multilevel::Cycle;

/// How a steady state is approached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Newton-GMRES.
    NewtonKrylov,
    /// Sweeps alone.
    Sweeps,
    /// Explicit five-stage Runge-Kutta with local steps (Jameson 1991).
    RungeKutta,
}

/// Numbers that steer the relaxation.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    /// Method.
    pub method: Method,
    /// Courant number at the start.
    pub cfl: f64,
    /// Greatest Courant number.
    pub cfl_max: f64,
    /// Greatest growth of the Courant number in one step.
    pub growth: f64,
    /// Reduction asked of each linear solve.
    pub tolerance: f64,
    /// Basis vectors of GMRES.
    pub basis: usize,
    /// Rows a group of the hierarchy.
    pub group: usize,
    /// Visits of the levels.
    pub cycle: Cycle,
}

impl Control {
    /// Newton-GMRES in `dimension` dimensions, as every case is solved by default.
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

/// Which of the two ways a Newton-Krylov relaxation is going, and how well.
#[derive(Clone, Copy, Debug)]
pub struct Phase {
    /// Newton's method rather than sweeps alone.
    pub newton: bool,
    /// Iterations in this phase.
    pub age: u32,
    /// Smallest residual in this phase.
    pub best: f64,
    /// When that was.
    pub best_age: u32,
}

impl Default for Phase {
    fn default() -> Self {
        Self { newton: false, age: 0, best: f64::INFINITY, best_age: 0 }
    }
}
