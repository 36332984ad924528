//! The equations on a cloud from plain values: what is not said is at rest, inviscid and starts as the free stream.
use std::sync::Arc;

use super::fluid::Fluid;
use super::motion_blending::MotionBlending;
use super::reconstruct::Reconstruction;
use super::start::{FreeStream, Stream};
use super::{CloudMotion, DeformingSurface, Discretisation, ViscousModel, WallCondition};
use crate::case::{Body, Case, Scheme, Wall};
use crate::cloud::conservative::conservative;
use crate::cloud::{Cloud, Operators};
use crate::math::Vector;
use crate::motion::BodyMotion;
use crate::physics::{Gas, Newtonian};

/// Threshold of limiters in plane flow without viscosity.
const THRESHOLD: f64 = 0.1;
/// The same in space, whose coarser clouds have greater differences where the flow is smooth: on
/// the ONERA M6 at 56 thousand particles 0.1 costs 0.8 % of the lift and adds 22 counts of drag; and in viscous layers, where with 0.1
/// friction on a flat plate is off by 2.4 % at most, with this by 1.5 %.
const SMOOTH_THRESHOLD: f64 = 0.4;

impl Reconstruction {
    /// What the scheme of a case says in `D` dimensions, for a gas with or without viscosity.
    pub fn of_scheme<const D: usize>(scheme: &Scheme, viscous: bool) -> Self {
        let usual = if D == 2 && !viscous { THRESHOLD } else { SMOOTH_THRESHOLD };
        Self {
            second_order: scheme.order == 2,
            kappa: scheme.kappa,
            low_mach: scheme.low_mach,
            threshold: scheme.limiter_threshold.unwrap_or(usual),
        }
    }
}

impl<const D: usize> Fluid<D> {
    /// An inviscid gas on a cloud at rest in a free stream without circulation, which is also its start. Coefficients are
    /// conservative unless the scheme says otherwise. Other fields are set by hand: `Fluid { held, ..Fluid::new(..) }`.
    pub fn new(mut cloud: Cloud<D>, stream: &FreeStream, scheme: &Scheme) -> Self {
        let mut operators = Operators::new(&cloud);
        let conserves = scheme.conservative.unwrap_or(true);
        if conserves {
            conservative(&mut cloud, &mut operators);
        }
        let free = stream.state();
        Self {
            fields: Self::unknowns(&cloud),
            gas: Gas { gamma: stream.gamma },
            isentropic: false,
            flux: scheme.flux,
            limiter: scheme.limiter,
            reconstruction: Reconstruction::of_scheme::<D>(scheme, false),
            conservative: conserves,
            viscous_model: None,
            far_field: Arc::new(Stream::new(stream, &Vector::ZERO, false)),
            held: Arc::new(move |_| free),
            cloud_motion: CloudMotion::Still,
            discretisation: Arc::new(Discretisation::new(cloud, operators)),
        }
    }
}

impl<const D: usize> CloudMotion<D> {
    /// Particles follow bodies that move by `laws` and rest far away; the greatest displacement is looked for until `until`.
    pub fn deforming(cloud: &Cloud<D>, laws: Vec<BodyMotion<D>>, until: f64) -> Self {
        let deforming_surface = Arc::new(DeformingSurface::new(cloud, &laws));
        Self::Along { path: Arc::new(MotionBlending::new(cloud, &laws, until)), laws, deforming_surface }
    }
}

impl ViscousModel {
    /// Viscosity of a case in the units of the solver, and what the gas does on each body; `None` for an inviscid gas.
    /// `chord` is the reference chord.
    pub fn of_case(case: &Case, chord: f64) -> Option<Self> {
        let viscous = case.flow.viscous(chord)?;
        let scales = case.flow.reference();
        let kelvin = if case.flow.is_dimensional() { case.flow.kelvin() } else { 1.0 };
        let wall_condition = |body: &Body| match case.flow.wall(body) {
            Wall::Slip => WallCondition::Slip,
            Wall::Adiabatic => WallCondition::Adiabatic,
            Wall::Temperature { value } => WallCondition::Temperature(value.0 / kelvin),
        };
        let viscosity = viscous.viscosity / (scales.density * scales.sound_speed);
        let medium = Newtonian { viscosity, sutherland: viscous.sutherland, prandtl: viscous.prandtl };
        Some(Self { medium, wall_conditions: case.bodies.iter().map(wall_condition).collect() })
    }
}
