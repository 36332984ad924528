//! The numbers of a finished run that claims are about: what is kept of its summary.
use serde::{Deserialize, Serialize};

use crate::observe::cycles::Cycles;
use crate::observe::loads::Coefficients;
use crate::observe::structure::StructureSummary;
use crate::study::{GeneralisedForce, LastPeriod, Summary};

/// The numbers of a finished run that claims are about, in the units of the case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in super::super) struct Numbers {
    /// Particles, images left out.
    pub(in super::super) particles: usize,
    /// Iterations over all stages.
    pub(in super::super) iterations: u64,
    /// Loads from wall pressure and friction.
    pub(in super::super) loads: Coefficients,
    /// The part of the pressure, where the gas has viscosity.
    pub(super) loads_pressure: Option<Coefficients>,
    /// The part of the friction.
    pub(super) loads_friction: Option<Coefficients>,
    /// Loads from the momentum of the gas around the bodies.
    pub(super) loads_momentum_balance: Option<Coefficients>,
    /// x/c where friction first turns against the stream on the upper side.
    pub(super) separation_upper: Option<f64>,
    /// Orders of magnitude that the residual of the last stage fell.
    pub(super) residual_drop: Option<f64>,
    /// False where the goal was not reached.
    pub(super) succeeded: bool,
    /// Relative drift of mass and energy.
    pub(super) drift: Option<[f64; 2]>,
    /// Volume-weighted root mean square error of density.
    pub(super) error_l2_density: Option<f64>,
    /// Chord of the load coefficients.
    pub(super) chord: f64,
    /// Physical time at the end of a march.
    pub(super) time: f64,
    /// Last whole cycles of the lift.
    pub(super) lift_cycles: Option<Cycles>,
    /// Mean and greatest loads of the last period of the motion.
    pub(super) last_period: Option<LastPeriod>,
    /// First harmonics of lift, drag and moment over that of the first motion: real and imaginary parts.
    pub(super) first_harmonics: Option<[[f64; 2]; 3]>,
    /// Forces on the modes of `[gaf]`.
    pub(super) generalised_forces: Vec<GeneralisedForce>,
    /// Motion of bodies on springs.
    pub(super) structure: Vec<StructureSummary>,
    /// Half widths of the error bars of lift, drag and moment that clouds alone give, whatever theory says; infinite where nothing is
    /// known.
    pub(in super::super) half_widths: Option<[f64; 3]>,
}

impl From<&Summary> for Numbers {
    fn from(s: &Summary) -> Self {
        Self {
            particles: s.convergence.particles,
            iterations: s.convergence.iterations,
            loads: s.loads.total,
            loads_pressure: s.loads.pressure,
            loads_friction: s.loads.friction,
            loads_momentum_balance: s.loads.momentum_balance,
            separation_upper: s.loads.separation.iter().find(|p| p.upper).map(|p| p.x_c),
            residual_drop: s.convergence.residual_drop,
            succeeded: s.succeeded(),
            drift: s.convergence.ledger.map(|l| [l.mass, l.energy]),
            error_l2_density: s.convergence.error_l2_density,
            chord: s.conditions.chord,
            time: s.convergence.time,
            lift_cycles: s.periodic.lift_cycles,
            last_period: s.periodic.last_period,
            first_harmonics: s.periodic.first_harmonics.first().map(|h| [h.cl, h.cd, h.cm]),
            generalised_forces: s.periodic.generalised_forces.clone(),
            structure: s.structures.structure.clone(),
            half_widths: s.grid.grid_convergence.as_ref().map(|f| [f.cl, f.cd, f.cm].map(|load| load.told_by_clouds())),
        }
    }
}
