//! Bodies of revolution about the y axis: x is the radius, and each particle represents a complete ring.
//!
//! In addition to the gradient in the plane there is the hoop strain, F₃₃ = 1 + u_x/x. A ring has the volume V = 2π x
//! a, where a is its share of the plane area. The energy W = Σ V ψ(F) yields the radial force −V P₃₃/x in addition to
//! the pair forces. Integration by parts in the cylinder,
//!
//! ∫ (P : ∇v + P₃₃ v_x/x) x dA = ∮ v·P·n x ds − ∫ v·(div P + (P e_x − P₃₃ e_x)/x) x dA,
//!
//! holds for every constant P, and exactly and without an internal force where P₁₁ = P₃₃ and P₁₂ = 0, if Σ_i V_i g_ij =
//! A_j − 2π a_j e_x, with the areas A_j = 2π ∮ N_j x n ds of hat functions N_j along the surface. The remaining defect
//! is orthogonal to linear fields, so that the correction of [`super::particles`] exists, if Σ a_j and Σ a_j x_j are
//! the area and the first moment of the section. Plain shares of the simplex areas miss part of the first moment of
//! each simplex. The missing moment M_j around particle j is therefore distributed to its neighbours by the weights of
//! the fit, δa_i = M_j·g_ji. This changes an area by a few per cent; it changes nothing for particles in regular rows.
//!
//! On the axis u_x is constrained to zero, and the limit of the strain is F₃₃ = F₁₁. The work of P₃₃ is included there
//! by replacing P₁₁ with P₁₁ + P₃₃. A particle m on the axis represents the core of its ring, V_m = 2π a_m r/4, where r
//! is the mean radius of its neighbours and half of r is the radius of the core. Its gradient is the uncorrected fit.
//! The particles around it lose the core by its weights, V_j = x_j (2π a_j − Σ_m V_m g_mj·e_x), which preserves the
//! volume of the body and the forces of constant P with P₁₁ = P₃₃.
use super::body::{Plane, Solid, Support};
use super::particles::{Fill, Particles};
use super::rows::Columns;
use crate::math::least_squares::{gradient_weight, normal_inverse, normal_matrix};
use crate::physics::solid::Tensor;

/// Index of the hoop component of a gradient or a stress, within its first column.
pub(super) const HOOP: usize = 2;
/// Particles nearer to the axis than this, in spacings, count as lying on it.
const ON_AXIS: f64 = 1e-9;

/// Contribution of hoop strain and hoop stress to the tangent of a particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct HoopTangent<const D: usize> {
    /// ∂P/∂F₃₃.
    pub(super) of_strain: [[f64; D]; D],
    /// ∂P₃₃/∂F.
    pub(super) of_stress: [[f64; D]; D],
    /// ∂P₃₃/∂F₃₃.
    pub(super) own: f64,
}

impl<const D: usize> HoopTangent<D> {
    pub(super) const ZERO: Self = Self { of_strain: [[0.0; D]; D], of_stress: [[0.0; D]; D], own: 0.0 };

    /// Adds the hoop terms to the change of a stress due to the `change` of the deformation gradient.
    #[inline(always)]
    pub(super) fn add_to(&self, stress: &mut Columns<D>, change: &Columns<D>) {
        let hoop = change[0][HOOP];
        let mut own = self.own * hoop;
        for (a, b) in (0..D).flat_map(|a| (0..D).map(move |b| (a, b))) {
            own += self.of_stress[a][b] * change[b][a];
            stress[b][a] += self.of_strain[a][b] * hoop;
        }
        stress[0][HOOP] = own;
    }
}

/// Tangent on the axis for one component of the gradient in the plane, where `change` is the derivative of the stress
/// with respect to a component of F: F₃₃ equals F₁₁, and P₃₃ acts together with P₁₁.
pub(super) fn axis_tangent(component: [usize; 2], change: impl Fn([usize; 2]) -> Tensor) -> Tensor {
    let mut all = change(component);
    if component == [0, 0] {
        let of_hoop = change([2, 2]);
        (0..3).for_each(|a| (0..3).for_each(|b| all[a][b] += of_hoop[a][b]));
    }
    all[0][0] += all[2][2];
    all
}

impl<const D: usize> Fill<D> {
    /// The body of revolution of this section about the y axis; volumes and areas become those of complete rings.
    pub fn turned(mut self) -> Self {
        let near = ON_AXIS * self.spacing;
        self.x.iter_mut().filter(|x| x[0].abs() <= near).for_each(|x| x[0] = 0.0);
        self.find_rows();
        let areas = self.balanced();
        let tau = std::f64::consts::TAU;
        for (i, area) in areas.iter().enumerate() {
            self.volume[i] = tau * self.x[i][0] * area;
        }
        self.turn = areas.into_iter().map(|area| tau * area).collect();
        self.fill_axis();
        let radius = |i: u32| self.x[i as usize][0];
        for facet in &mut self.facets {
            let [a, b] = [0, 1].map(|k| radius(facet.corners()[k]));
            let sum = a + b;
            // ∫ N_a x ds over ∫ x ds; on the axis there is no area to be shared
            let first = if sum > 0.0 { (2.0 * a + b) / (3.0 * sum) } else { 0.5 };
            *facet = facet.weighted(facet.area * (0.5 * tau * sum), [first, 1.0 - first]);
        }
        self
    }

    /// Gives the particles on the axis their cores and subtracts these from the particles around them.
    fn fill_axis(&mut self) {
        for m in (0..self.x.len()).filter(|m| self.x[*m][0] == 0.0) {
            let offset = |i: &u32| self.x[*i as usize] - self.x[m];
            let row = &self.rows[m];
            let Some((inverse, _)) = normal_inverse(&normal_matrix(row.iter().map(offset)).0) else { continue };
            let off: Vec<f64> = row.iter().map(|i| self.x[*i as usize][0]).filter(|x| *x > 0.0).collect();
            let core = self.turn[m] * 0.25 * off.iter().sum::<f64>() / off.len() as f64;
            self.volume[m] = core;
            for i in row {
                self.volume[*i as usize] -= core * self.x[*i as usize][0] * gradient_weight(&inverse, &offset(i))[0];
            }
        }
    }

    /// Plane areas of the particles, whose sum and first moment are exact for the section and for any part of it.
    fn balanced(&self) -> Vec<f64> {
        let mut areas = self.volume.clone();
        for (j, row) in self.rows.iter().enumerate() {
            let offset = |i: &u32| self.x[*i as usize] - self.x[j];
            // a particle with too few neighbours is reported where its gradient is fitted
            let Some((inverse, _)) = normal_inverse(&normal_matrix(row.iter().map(offset)).0) else { continue };
            for i in row {
                let moved = gradient_weight(&inverse, &offset(i)).dot(&self.moment[j]);
                areas[*i as usize] += moved;
                areas[j] -= moved;
            }
        }
        areas
    }
}

/// Support that constrains the radial displacement of the particles on the axis; `None` where there are none.
pub fn held_on_axis<const D: usize>(particles: &Particles<D>) -> Option<Support<D>> {
    if !particles.is_round() {
        return None;
    }
    let on = |i: &u32| particles.x[*i as usize][0] == 0.0;
    let held: Vec<u32> = (0..particles.len() as u32).filter(on).collect();
    let fixed = std::array::from_fn(|d| d == 0);
    (!held.is_empty()).then_some(Support { particles: held, fixed, motion: None })
}

impl<const D: usize> Solid<D> {
    /// True for a body of revolution.
    #[inline(always)]
    pub(super) fn is_round(&self) -> bool {
        self.plane == Plane::Axisymmetric
    }

    /// Sets the hoop strain due to the radial displacement in a gradient.
    #[inline(always)]
    pub(super) fn put_hoop(&self, i: usize, gradient: &mut Columns<D>, along_radius: f64) {
        if !self.is_round() {
            return;
        }
        gradient[0][HOOP] = if self.is_on_axis(i) { gradient[0][0] } else { along_radius * self.per_radius[i] };
    }

    /// Sets the hoop stress in a stress.
    #[inline(always)]
    pub(super) fn put_hoop_stress(&self, i: usize, stress: &mut Columns<D>, hoop: f64) {
        if !self.is_round() {
            return;
        }
        if self.is_on_axis(i) {
            stress[0][0] += hoop;
        } else {
            stress[0][HOOP] = hoop;
        }
    }

    /// True for a particle on the axis of revolution.
    #[inline(always)]
    pub(super) fn is_on_axis(&self, i: usize) -> bool {
        self.is_round() && self.per_radius[i] == 0.0
    }

    /// Factor V/x between the hoop stress and its radial force; 0 on the axis.
    #[inline(always)]
    pub(super) fn hoop_weight(&self, i: usize) -> f64 {
        self.particles.volume[i] * self.per_radius[i]
    }
}
