//! Bodies of revolution about the y axis: x is the radius, and particles are rings of a whole turn.
//!
//! Beside the gradient in the plane there is the hoop strain, F₃₃ = 1 + u_x/x, and a ring has the volume V = 2π x a, where a is
//! its share of the plane area. From W = Σ V ψ(F) follows the force −V P₃₃/x along the radius beside those of pairs. Integration by
//! parts in the cylinder,
//!
//! ∫ (P : ∇v + P₃₃ v_x/x) x dA = ∮ v·P·n x ds − ∫ v·(div P + (P e_x − P₃₃ e_x)/x) x dA,
//!
//! holds for every constant P, and exactly without a force inside where P₁₁ = P₃₃ and P₁₂ = 0, if Σ_i V_i g_ij = A_j − 2π a_j e_x, with
//! the areas A_j = 2π ∮ N_j x n ds of hat functions N_j along the surface. Linear fields are orthogonal to what is left of it,
//! so that the correction of [`super::particles`] exists, if Σ a_j and Σ a_j x_j are area and first moment of the section: shares of
//! areas, which leave some of the first moment of each simplex, are changed for this: M_j, what they leave around j, goes to the
//! particles around it by the weights of its fit, δa_i = M_j·g_ji, which is a few per cent of an area, and nothing in rows.
//!
//! On the axis u_x is held, and the limit of the strain is F₃₃ = F₁₁: what P₃₃ does there is done by P₁₁ + P₃₃ in the place of P₁₁. A
//! particle m there has the core of its ring, V_m = 2π a_m r/4 with the mean radius r of its neighbours, half of which is the
//! radius of the core. Its gradient is the plain fit, without a correction, and those around it lose the core by its weights, V_j = x_j (2π a_j − Σ_m
//! V_m g_mj·e_x), which leaves the volume of the body and the forces of constant P with P₁₁ = P₃₃ what they were.
use super::body::{Plane, Solid, Support};
use super::particles::{Fill, Particles};
use super::rows::Columns;
use crate::math::least_squares::{gradient_weight, normal_inverse, normal_matrix};
use crate::physics::solid::Tensor;

/// Where the hoop component of a gradient or a stress stands: in its first column.
pub(super) const HOOP: usize = 2;
/// Particles this near to the axis are on it, in spacings.
const ON_AXIS: f64 = 1e-9;

/// What hoop strain and stress add to the tangent of a particle.
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

    /// Adds the hoop parts to the change of a stress with that of the deformation.
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

/// Change of the stress that acts on the axis with one component of the gradient in the plane, where `change` is that of the stress
/// with one of F: F₃₃ goes with F₁₁, and P₃₃ acts with P₁₁.
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
    /// The section that this is, turned about the y axis: volumes and areas are those of a whole turn.
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
            // ∫ N_a x ds over ∫ x ds; on the axis there is no area to share
            let first = if sum > 0.0 { (2.0 * a + b) / (3.0 * sum) } else { 0.5 };
            *facet = facet.weighted(facet.area * (0.5 * tau * sum), [first, 1.0 - first]);
        }
        self
    }

    /// Gives particles on the axis their cores, which those around them lose.
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

    /// Plane areas of particles whose sum and first moment are those of the section, and of any part of it.
    fn balanced(&self) -> Vec<f64> {
        let mut areas = self.volume.clone();
        for (j, row) in self.rows.iter().enumerate() {
            let offset = |i: &u32| self.x[*i as usize] - self.x[j];
            // what has too few neighbours is refused where fits are made
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

/// Particles on the axis, held along the radius; `None` where there are none.
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
    /// True about an axis of revolution.
    #[inline(always)]
    pub(super) fn is_round(&self) -> bool {
        self.plane == Plane::Axisymmetric
    }

    /// Puts the hoop strain of a displacement along the radius into a gradient.
    #[inline(always)]
    pub(super) fn put_hoop(&self, i: usize, gradient: &mut Columns<D>, along_radius: f64) {
        if !self.is_round() {
            return;
        }
        gradient[0][HOOP] = if self.is_on_axis(i) { gradient[0][0] } else { along_radius * self.per_radius[i] };
    }

    /// Puts the hoop stress into a stress.
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

    /// True on the axis of revolution.
    #[inline(always)]
    pub(super) fn is_on_axis(&self, i: usize) -> bool {
        self.is_round() && self.per_radius[i] == 0.0
    }

    /// V/x, what a hoop stress is taken times for its force along the radius; 0 on the axis.
    #[inline(always)]
    pub(super) fn hoop_weight(&self, i: usize) -> f64 {
        self.particles.volume[i] * self.per_radius[i]
    }
}
