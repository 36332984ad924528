//! Walls that bend: normals, areas, curvature and velocity gradient of a surface that its modes deform.
//!
//! A surface point X goes to X + u(X) with u = Σ_m q_m φ_m, and F = 1 + ∂u/∂X is the gradient of that map. Velocities and
//! accelerations follow from the positions; what is needed besides is the rate Ḟ F⁻¹ at which the wall stretches and turns.
use crate::cloud::{Cloud, Strain};
use crate::math::Vector;
use crate::math::sweep::sweep_slots;
use crate::motion::{BodyMotion, Expansion};

/// The modes of the bodies at every interface particle; empty where no body bends.
#[derive(Clone, Debug, Default)]
pub struct DeformingSurface<const D: usize> {
    modes: Vec<Vec<Expansion<D>>>,
}

/// How the surface at one interface particle is deformed at one time.
pub(super) struct SurfaceStrain<const D: usize> {
    /// The map and its second derivatives.
    pub(super) strain: Strain<D>,
    /// Rows of Ḟ F⁻¹.
    pub(super) rate: [Vector<D>; D],
    /// Displacement in each mode.
    pub(super) shifts: Vec<Vector<D>>,
}

impl<const D: usize> DeformingSurface<D> {
    /// The surfaces of bodies that follow `laws`.
    pub fn new(cloud: &Cloud<D>, laws: &[BodyMotion<D>]) -> Self {
        if !laws.iter().any(BodyMotion::bends) {
            return Self::default();
        }
        let mut modes = vec![Vec::new(); cloud.interface.len()];
        sweep_slots(&mut modes, |w, slot| {
            if let Some(law) = laws.get(usize::from(cloud.interface[w].body)) {
                *slot = law.shapes().map(|shape| shape.expand(&cloud.x[cloud.n_fluid + w])).collect();
            }
        });
        Self { modes }
    }

    /// The surface at interface particle `w` at time `t`; `None` where it does not bend.
    pub(super) fn surface_strain(&self, w: usize, law: &BodyMotion<D>, t: f64) -> Option<SurfaceStrain<D>> {
        let modes = self.modes.get(w).filter(|m| !m.is_empty())?;
        let mut strain = Strain { map: std::array::from_fn(Vector::axis), second: [[Vector::ZERO; D]; D] };
        let mut rates = [Vector::ZERO; D];
        for (q, mode) in law.coordinates_with_rates(t).iter().zip(modes) {
            for i in 0..D {
                strain.map[i] += mode.gradient[i] * q.value;
                rates[i] += mode.gradient[i] * q.first;
                (0..D).for_each(|j| strain.second[i][j] += mode.second[i][j] * q.value);
            }
        }
        let inverse = strain.inverse();
        // row i of Ḟ times F⁻¹
        let rate = std::array::from_fn(|i| (0..D).fold(Vector::ZERO, |sum, k| sum + inverse[k] * rates[i][k]));
        Some(SurfaceStrain { strain, rate, shifts: modes.iter().map(|m| m.value).collect() })
    }
}
