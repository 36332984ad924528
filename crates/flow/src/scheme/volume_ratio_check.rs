//! A watch over clouds whose particles follow bodies: have neighbours come too close?
//!
//! Fitted with the weights of the cloud before any motion, F_i = 1 + ∂(x − X)/∂X is the gradient of the motion at a
//! particle, and det F the volume that its surroundings keep. Where it falls to nothing particles overtake one another: a body
//! runs into another one or into a side of the domain, or moves too far for the cloud between them.
use crate::math::square::determinant;
use crate::system::Fault;

use super::discretisation::CloudMotion;
use super::fluid::Fluid;
use super::frame::Frame;

/// Least part of its volume to which the surroundings of a particle may shrink.
const LEAST: f64 = 0.05;

impl<const D: usize> Fluid<D> {
    /// The first particle whose surroundings have shrunk to almost nothing or folded.
    pub(super) fn volume_ratio_check(&self, frame: &Frame<D>) -> Option<Fault> {
        if !matches!(self.cloud_motion, CloudMotion::Along { .. }) {
            return None;
        }
        let volume = self.stretch(frame);
        let i = volume.iter().position(|v| !(*v > LEAST))?;
        let part = 100.0 * volume[i];
        let reason = match part > 0.0 {
            true => format!("its surroundings are squeezed to {part:.1} % of their volume (least {} %)", 100.0 * LEAST),
            false => "the cloud folds over there: particles have overtaken their neighbours".into(),
        };
        Some(Fault { particle: i, place: frame.place(i).0.to_vec(), reason })
    }

    /// Volume of the surroundings of each fluid particle over what it was before any motion.
    pub(super) fn stretch(&self, frame: &Frame<D>) -> Vec<f64> {
        let (before, now) = (&self.discretisation, &frame.discretisation.cloud);
        let gradients = before.operators.displacement_gradients(now, &before.cloud);
        let mut volume: Vec<f64> = gradients[..before.cloud.n_fluid].iter().map(determinant).collect();
        // rows of first order do not know their surroundings
        let unknown = before.cloud.first_order.iter().map(|i| *i as usize);
        unknown.filter(|i| *i < before.cloud.n_fluid).for_each(|i| volume[i] = 1.0);
        volume
    }
}
