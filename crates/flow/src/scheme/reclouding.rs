//! Rebuilding the cloud of Lagrangian particles.
//!
//! The neighbour lists remain valid until the distance of two neighbours has changed by a quarter of their spacing, or
//! a row becomes insufficient. Then the cloud is rebuilt around the particles ([`crate::cloud::travel`]), and the state
//! is transferred (`transfer`).
use std::sync::Arc;

use super::discretisation::CloudMotion;
use super::fluid::{Fluid, Work};
use super::frame::{Discretisation, Frame};
use super::transfer::{RemapLedger, Transfer};
use super::travel::{ParticleKinematics, Travel};
use crate::cloud::repair::WORST_CONDITION;
use crate::cloud::{Cloud, CloudError, Operators};
use crate::math::Vector;
use crate::math::parallel::sweep_each;
use crate::math::reduce::{first, maximum};

/// Relative displacement of neighbours, in mean spacings, after which the neighbour lists are rebuilt.
const SLACK: f64 = 0.25;

/// The flow equations on a rebuilt cloud, with the state.
pub struct Reclouded<const D: usize> {
    /// The flow equations.
    pub fluid: Fluid<D>,
    /// State on the rebuilt cloud.
    pub u: Vec<f64>,
    /// States one and two time steps ago, if they were known.
    pub past: [Vec<f64>; 2],
}

impl<const D: usize> Fluid<D> {
    /// True when the cloud should be rebuilt: its neighbour lists are no longer valid, or a row is insufficient.
    pub fn is_worn(&self, frame: &Frame<D>) -> bool {
        if !matches!(self.cloud_motion, CloudMotion::Travel(_)) {
            return false;
        }
        let (then, now) = (&self.discretisation.cloud, &frame.discretisation.cloud);
        let sick = |i: usize| {
            let well = f64::from(frame.discretisation.operators.condition[i]) < WORST_CONDITION;
            !well && then.first_order.binary_search(&(i as u32)).is_err()
        };
        let operators = &self.discretisation.operators;
        // a cloud that was just built needs no rebuild
        let moved = |i: usize| f64::from(u8::from(now.x[i] != then.x[i]));
        let mut apart = vec![false; operators.fluid_parts().len()];
        sweep_each(&mut apart, |k| {
            operators.edges(k).iter().any(|e| {
                let (i, j) = (e.i(), e.j());
                let d = (now.x[j] - now.x[i]) - (then.x[j] - then.x[i]);
                let slack = 0.5 * SLACK * (then.spacing[i] + then.spacing[j]);
                // written so that positions that are NaN count as moved
                !(d.norm_squared() <= slack * slack)
            })
        });
        apart.contains(&true) || first(then.n_fluid, sick).is_some() && maximum(then.n_fluid, moved) > 0.0
    }

    /// The flow equations on a cloud rebuilt around the particles of `frame`, with the state `u` transferred to it.
    pub fn reclouded(
        &self,
        frame: &Frame<D>,
        (u, past): (&[f64], [&[f64]; 2]),
        work: &mut Work<D>,
        ledger: &mut RemapLedger,
    ) -> Result<Option<Reclouded<D>>, CloudError> {
        let CloudMotion::Travel(travel) = &self.cloud_motion else { return Ok(None) };
        self.fill_states(frame, u, work);
        let old = &frame.discretisation.cloud;
        let recloud = travel.domain.recloud(&travel.poses(frame.time), old)?;
        let transfer = Transfer { fluid: self, old, work, recloud: &recloud, before: u };
        let state = transfer.state(ledger)?;
        let lines = transfer.lines();
        let past = past.map(|p| transfer.past(p, &state, &lines));
        let walls = old.interface_range().map(|w| frame.velocity_of(w));
        let velocity = transfer.directions(&frame.velocity, &lines).into_iter().chain(walls).collect();
        let course = transfer.directions(&frame.lagrangian_step.course, &lines);
        let places = recloud.cloud.x[..recloud.cloud.n_rows()].to_vec();
        let kinematics = ParticleKinematics { now: frame.time, places, velocity, course };
        let fluid = self.on(recloud.cloud, frame.time, kinematics);
        Ok(Some(Reclouded { fluid, u: state, past }))
    }

    /// The flow equations restored from a checkpoint. The neighbour lists are those of the fluid particles at the
    /// positions and time `lists`, or those of this cloud without them; `kinematics` are the present positions and
    /// velocities of the fluid and interface particles.
    pub fn resumed(
        &self,
        lists: Option<(&[Vector<D>], f64)>,
        kinematics: ParticleKinematics<D>,
    ) -> Result<Option<Self>, CloudError> {
        let CloudMotion::Travel(travel) = &self.cloud_motion else { return Ok(None) };
        let Some((lists, since)) = lists else { return Ok(Some(self.moved(kinematics))) };
        let (cloud, _) = travel.domain.cloud(&travel.poses(since), lists)?;
        Ok(Some(self.on(cloud, since, kinematics)))
    }

    /// Time from which these equations replace the previous ones.
    pub fn stood(&self) -> f64 {
        match &self.cloud_motion {
            CloudMotion::Travel(travel) => travel.kinematics.now,
            _ => 0.0,
        }
    }

    /// Positions of the interface particles before any motion.
    pub fn walls_before(&self) -> &[Vector<D>] {
        match &self.cloud_motion {
            CloudMotion::Travel(travel) => travel.domain.walls().0,
            _ => {
                let cloud = &self.discretisation.cloud;
                &cloud.x[cloud.interface_range()]
            }
        }
    }

    /// Volumes for totals and means; for Lagrangian particles, the part of the domain nearest to each.
    pub fn volumes(&self) -> Vec<f64> {
        self.volumes_of(&self.discretisation.cloud)
    }

    /// These volumes for the particles of `cloud`.
    pub(super) fn volumes_of(&self, cloud: &Cloud<D>) -> Vec<f64> {
        match &self.cloud_motion {
            CloudMotion::Travel(travel) => travel.domain.volumes(&travel.poses(travel.since), cloud),
            _ => cloud.volume[..cloud.n_fluid].to_vec(),
        }
    }

    /// Stores these volumes in the cloud, for evaluation after the march.
    pub fn measure(&mut self) {
        let volumes = self.volumes();
        let n = volumes.len();
        Arc::make_mut(&mut self.discretisation).cloud.volume[..n].copy_from_slice(&volumes);
    }

    fn on(&self, cloud: Cloud<D>, since: f64, kinematics: ParticleKinematics<D>) -> Self {
        let operators = Operators::new(&cloud);
        let fields = Self::unknowns(&cloud);
        let discretisation = Arc::new(Discretisation::new(cloud, operators));
        let mut other = Self { fields, discretisation, ..self.moved(kinematics) };
        if let CloudMotion::Travel(travel) = &mut other.cloud_motion {
            travel.since = since;
        }
        other
    }

    /// The same equations and neighbour lists with the particles at other positions.
    fn moved(&self, kinematics: ParticleKinematics<D>) -> Self {
        let CloudMotion::Travel(travel) = &self.cloud_motion else { return self.copy() };
        Self {
            cloud_motion: CloudMotion::Travel(Travel { kinematics: Arc::new(kinematics), ..travel.clone() }),
            ..self.copy()
        }
    }

    fn copy(&self) -> Self {
        Self {
            discretisation: Arc::clone(&self.discretisation),
            cloud_motion: self.cloud_motion.clone(),
            viscous_model: self.viscous_model.clone(),
            far_field: Arc::clone(&self.far_field),
            held: Arc::clone(&self.held),
            ..*self
        }
    }
}
