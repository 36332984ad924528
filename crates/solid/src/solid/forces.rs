//! Internal and external forces on the particles of a solid.
//!
//! The energy W(u) = Σ V ψ(F) + E_s with F_i = 1 + Σ_j (u_j − u_i) ⊗ g_ij yields the forces −∂W/∂u,
//!
//! f_i = Σ_j (P_i V_i g_ij − P_j V_j g_ji) + Σ_j w [(c_i + c_j)(u_j − u_i) − (c_i A_i + c_j A_j) d_ij],
//!
//! where P is the first Piola-Kirchhoff stress. The forces of a pair are opposite, and W is invariant under rotation,
//! so that momentum and angular momentum are conserved. The second sum comes from the stabilisation energy E_s = ½ Σ_i
//! c_i Σ_j w |u_j − u_i − A_i d_ij|², the residuals of the uncorrected fits A_i of the displacement gradient, with
//! c = α μ V D/n. It stabilises the modes that the fits do not represent and vanishes for uniform deformation. Because
//! A_i minimises the inner sum, its variation contributes no force. The same sum over velocities with c = β ρ c_p h V
//! D/n damps these modes. Where a material has yielded, the stabilising stiffness is multiplied by s = σ_y/(σ_y + 3 μ
//! ε_p), and the damping by √s.
//!
//! Damping proportional to stiffness is Kelvin-Voigt damping in the undeformed configuration: the second
//! Piola-Kirchhoff stress gains β C₀ : Ė with the rate of the Green-Lagrange strain E and the initial elastic moduli
//! C₀, and the velocity residuals gain c = β α μ V D/n. For small vibrations about the undeformed state this is
//! Rayleigh's −β K v. The stress is symmetric, so that angular momentum is conserved; it does not affect motions
//! without strain, and dissipates β Ė : C₀ : Ė ≥ 0 (Holzapfel 2000, *Nonlinear Solid Mechanics*, section 6.10; Bathe
//! 2014, *Finite Element Procedures*, section 9.3.3). The damping of the velocity residuals also resists the rotation
//! of zigzag displacements.
use multiversion::multiversion;

use super::axis::{HOOP, HoopTangent, axis_tangent};
use super::body::{Action, Plane, Solid};
use super::pairs::{self, ParticleStress, StabilisedFields, gradients, plain_gradient};
use super::particles::Edge;
use super::rows::{Columns, columns, row};
use crate::math::Vector;
use crate::math::dual::Dual;
use crate::math::least_squares::smallest_eigenvalue;
use crate::math::parallel::{CHUNK, parts, sweep, sweep_parts, sweep_slots, sweep_two_parts};
use crate::math::reduce::{first, maximum, sum};
use crate::physics::solid::tensor::{determinant, product_transposed, times};
use crate::physics::solid::{Law, MOST_HISTORY, Material, Moduli, Response, Tensor, plane_stress};
use crate::system::Fault;

/// A square matrix: the rows are components, the columns axes of the undeformed body.
pub type Matrix<const D: usize> = [[f64; D]; D];

/// Energies of a solid (J); for 2-D bodies per unit of thickness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy ½ Σ m v².
    pub kinetic: f64,
    /// Elastic energy Σ V ψ of the materials.
    pub strain: f64,
    /// Energy of the stabilisation.
    pub stabilisation: f64,
    /// Elastic energy of contact.
    pub contact: f64,
    /// Energy dissipated by the materials so far.
    pub dissipated: f64,
}

impl Energy {
    /// All energies multiplied by `thickness`.
    pub fn times(&self, thickness: f64) -> Self {
        Self {
            kinetic: self.kinetic * thickness,
            strain: self.strain * thickness,
            stabilisation: self.stabilisation * thickness,
            contact: self.contact * thickness,
            dissipated: self.dissipated * thickness,
        }
    }
}

/// Work arrays for the evaluation of forces.
pub struct Work<const D: usize> {
    /// Stresses and stabilisation coefficients of all particles.
    pub stressed: Vec<ParticleStress<D>>,
}

/// Tangents of all particles at a state: `all[i][a][b]` is the derivative ∂P/∂F_ab at particle i.
pub struct Tangents<const D: usize> {
    pub(super) all: Vec<[[Matrix<D>; D]; D]>,
    pub(super) stiff: Vec<f64>,
    /// Hoop terms; empty unless the solid is a body of revolution.
    pub(super) hoop: Vec<HoopTangent<D>>,
}

/// The state of motion of a solid at one time.
#[derive(Clone, Copy, Debug)]
pub struct State<'a, const D: usize> {
    /// Time (s).
    pub time: f64,
    /// Time since `history` was valid (s); 0 for an instantaneous response.
    pub step: f64,
    /// Displacement of each particle.
    pub displacement: &'a [[f64; D]],
    /// Velocity of each particle.
    pub velocity: &'a [[f64; D]],
    /// History variables of all particles.
    pub history: &'a [f64],
}

/// The 3-D deformation gradient of a displacement gradient; in 2-D without strain normal to the plane.
#[inline(always)]
fn deformation<const D: usize>(gradient: &Columns<D>) -> Tensor {
    let mut f = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for a in 0..D {
        for b in 0..D {
            f[a][b] += gradient[b][a];
        }
    }
    f
}

/// The 3-D deformation gradient with the hoop strain, for a body of revolution.
#[inline(always)]
fn deformation_with_hoop<const D: usize>(gradient: &Columns<D>) -> Tensor {
    let mut f = deformation(gradient);
    if D == 2 {
        f[2][2] += gradient[0][HOOP];
    }
    f
}

impl<const D: usize> Solid<D> {
    /// New work arrays.
    pub fn work(&self) -> Work<D> {
        Work { stressed: vec![ParticleStress::ZERO; self.len()] }
    }

    /// New arrays for tangents.
    pub fn tangents(&self) -> Tangents<D> {
        let (n, round) = (self.len(), if self.is_round() { self.len() } else { 0 });
        Tangents { all: vec![[[[[0.0; D]; D]; D]; D]; n], stiff: vec![0.0; n], hoop: vec![HoopTangent::ZERO; round] }
    }

    /// History variables of particle `i`.
    #[inline(always)]
    fn history_of<'a>(&self, history: &'a [f64], i: usize) -> &'a [f64] {
        &history[i * self.width..(i + 1) * self.width]
    }

    /// Response of a material to the deformation gradient `f`; writes the new history variables.
    #[inline(always)]
    fn respond(&self, material: &Material, f: &Tensor, (old, step): (&[f64], f64), new: &mut [f64]) -> Response<f64> {
        let own = material.history_len();
        match self.plane {
            Plane::Strain | Plane::Axisymmetric => material.respond(f, &old[..own], step, &mut new[..own]),
            Plane::Stress => {
                let across = self.width - 1;
                let (response, stretch) = plane_stress(material, f, old[across], &old[..own], step, &mut new[..own]);
                new[across] = stretch;
                response
            }
        }
    }

    /// Computes the stresses of a state into `work` and the resulting history variables into `after`.
    pub fn stress(&self, state: &State<'_, D>, work: &mut Work<D>, after: &mut [f64]) {
        let parts = parts(self.len(), CHUNK);
        sweep_two_parts((&parts, 1, &mut work.stressed), (&parts, self.width, after), &|k, stressed, after| {
            stresses(self, state, parts[k].start, stressed, after);
        });
    }

    /// Stress of particle `i`.
    #[inline(always)]
    fn stress_of(&self, i: usize, state: &State<'_, D>, new: &mut [f64]) -> ParticleStress<D> {
        let (gradient, plain) = gradients(self, i, |j| row(&state.displacement[j]));
        match self.is_round() {
            true => self.stress_of_ring(i, state, new, (gradient, plain)),
            // the assumption of plane strain here saves a fifth of the time
            false => self.stress_at(i, state, new, (&deformation(&gradient), plain)),
        }
    }

    /// Stress of particle `i` of a body of revolution.
    #[inline(never)]
    fn stress_of_ring(
        &self,
        i: usize,
        state: &State<'_, D>,
        new: &mut [f64],
        (mut gradient, plain): (Columns<D>, Columns<D>),
    ) -> ParticleStress<D> {
        self.put_hoop(i, &mut gradient, state.displacement[i][0]);
        self.stress_at(i, state, new, (&deformation_with_hoop(&gradient), plain))
    }

    /// Stress of particle `i` with the deformation gradient `f` and the uncorrected displacement gradient `plain`.
    #[inline(always)]
    fn stress_at(
        &self,
        i: usize,
        state: &State<'_, D>,
        new: &mut [f64],
        (f, plain): (&Tensor, Columns<D>),
    ) -> ParticleStress<D> {
        let (material, old) = (self.material_of(i), self.history_of(state.history, i));
        let elastic = if self.width == 0 { material.elastic_stress(f) } else { None };
        let stress = elastic.unwrap_or_else(|| {
            let response = self.respond(material, f, (old, state.step), new);
            if let Some(lost) = self.lost_at() {
                new[lost] = old[lost] + response.dissipated;
            }
            response.stress
        });
        let [stiff, viscous] = self.holding(i, material, old);
        let mut smooth = plain.map(|column| column.map(|a| a * stiff));
        let mut stress = stress;
        if self.is_viscous() {
            let rate = plain_gradient(self, i, |j| row(&state.velocity[j]));
            (0..D).for_each(|b| (0..D).for_each(|a| smooth[b][a] += viscous * rate[b][a]));
            if self.damping.stiffness > 0.0 {
                self.add_damping(i, state.velocity, f, &mut stress);
            }
        }
        let hoop = stress[2][2];
        let mut stress: Columns<D> = std::array::from_fn(|b| row::<D>(&std::array::from_fn(|a| stress[a][b])));
        self.put_hoop_stress(i, &mut stress, hoop);
        ParticleStress { stress, smooth, stiff, viscous, volume: determinant(f) }
    }

    /// Adds the stress of damping proportional to stiffness; a function of its own, so that particles without damping
    /// stay fast.
    #[inline(never)]
    fn add_damping(&self, i: usize, v: &[[f64; D]], f: &Tensor, stress: &mut Tensor) {
        let damped = self.damping_stress(self.material_of(i), f, &self.rate_of(i, v).0);
        (0..3).for_each(|a| (0..3).for_each(|b| stress[a][b] += damped[a][b]));
    }

    /// Velocity gradients at particle `i`: the consistent one in 3-D where it is needed, and the uncorrected fit.
    fn rate_of(&self, i: usize, v: &[[f64; D]]) -> (Tensor, Columns<D>) {
        if self.damping.stiffness == 0.0 {
            return ([[0.0; 3]; 3], plain_gradient(self, i, |j| row(&v[j])));
        }
        let (mut full, plain) = gradients(self, i, |j| row(&v[j]));
        self.put_hoop(i, &mut full, v[i][0]);
        let mut rate = deformation_with_hoop(&full);
        (0..3).for_each(|a| rate[a][a] -= 1.0);
        (rate, plain)
    }

    /// First Piola-Kirchhoff stress of damping proportional to stiffness, F β C₀ : Ė, for the rate `rate` of the
    /// displacement gradient; F = 1 for materials of small strain.
    fn damping_stress(&self, material: &Material, f: &Tensor, rate: &Tensor) -> Tensor {
        let small = matches!(material.law, Law::Linear);
        let f = |a: usize, b: usize| if small { f64::from(u8::from(a == b)) } else { f[a][b] };
        let Moduli { shear, bulk } = material.moduli;
        let lame = bulk - 2.0 / 3.0 * shear;
        let lame = if self.plane == Plane::Stress { 2.0 * lame * shear / (lame + 2.0 * shear) } else { lame };
        // no strain rate normal to a plane body
        let n = if self.is_round() { 3 } else { D };
        let twice = |a: usize, b: usize| (0..n).map(|k| f(k, a) * rate[k][b] + rate[k][a] * f(k, b)).sum::<f64>();
        let mut second = [[0.0; 3]; 3];
        (0..n).for_each(|a| (0..n).for_each(|b| second[a][b] = 0.5 * twice(a, b)));
        let widening: f64 = (0..n).map(|a| second[a][a]).sum();
        let beta = self.damping.stiffness;
        if let Law::Orthotropic(law) = &material.law {
            second = times(&law.second(&second), beta);
            return std::array::from_fn(|a| std::array::from_fn(|b| (0..n).map(|k| f(a, k) * second[k][b]).sum()));
        }
        for (a, b) in (0..n).flat_map(|a| (0..n).map(move |b| (a, b))) {
            second[a][b] = beta * (2.0 * shear * second[a][b] + if a == b { lame * widening } else { 0.0 });
        }
        std::array::from_fn(|a| std::array::from_fn(|b| (0..n).map(|k| f(a, k) * second[k][b]).sum()))
    }

    /// Coefficients c of the displacement and velocity residuals. Both are reduced where the material has yielded. The
    /// damping is multiplied by the root of the factor of the stiffness: undiminished damping would do much of the work
    /// in plastic flow, the more the larger the spacing.
    #[inline(always)]
    fn holding(&self, i: usize, material: &Material, history: &[f64]) -> [f64; 2] {
        /// Smallest factor on the stabilising stiffness.
        const MIN_FACTOR: f64 = 0.002;
        let shear = material.moduli.shear;
        let soft = match material.yield_stress() {
            Some(yields) => {
                let strained = material.plastic_strain(&history[..material.history_len()]);
                yields / (yields + 3.0 * shear * strained) + MIN_FACTOR / self.damping.stabilisation.max(MIN_FACTOR)
            }
            None => 1.0,
        };
        let soft = soft.min(1.0);
        [self.damping.stabilisation * soft * shear * self.weight[i], self.viscous[i] * soft.sqrt()]
    }

    /// These coefficients in a given state.
    fn holding_in(&self, i: usize, state: &State<'_, D>) -> [f64; 2] {
        self.holding(i, self.material_of(i), self.history_of(state.history, i))
    }

    /// True when forces depend on the velocity gradient.
    pub(super) fn is_viscous(&self) -> bool {
        self.damping.viscosity > 0.0 || self.damping.stiffness > 0.0
    }

    /// Forces on all particles due to the stresses in `work`, stabilisation, contact, gravity and loads.
    pub fn forces(&self, state: &State<'_, D>, work: &Work<D>, force: &mut [[f64; D]]) {
        let gravity = self.gravity * self.part(state.time);
        let velocity = self.is_viscous().then_some(state.velocity);
        self.internal(StabilisedFields { displacement: state.displacement, velocity }, work, force);
        sweep_slots(force, |i, f| (0..D).for_each(|a| f[a] += gravity[a] * self.mass[i]));
        self.add_loads(state, force);
        self.add_contact(state, force);
        if self.damping.mass > 0.0 {
            let rate = self.damping.mass;
            sweep_slots(force, |i, f| {
                (0..D).for_each(|a| f[a] -= rate * self.mass[i] * state.velocity[i][a]);
            });
        }
    }

    /// Forces of the neighbours on all particles.
    fn internal(&self, pulling: StabilisedFields<'_, D>, work: &Work<D>, force: &mut [[f64; D]]) {
        let parts = parts(self.len(), CHUNK);
        sweep_parts(&parts, 1, force, &|k, force| {
            pairs::internal(self, parts[k].start, pulling, &work.stressed, force);
        });
        if self.is_round() {
            sweep_slots(force, |i, f| f[0] -= self.hoop_weight(i) * work.stressed[i].stress[0][HOOP]);
        }
    }

    /// Adds the loads on the surface.
    fn add_loads(&self, state: &State<'_, D>, force: &mut [[f64; D]]) {
        for load in &self.loads {
            let factor = (load.history)(state.time) * self.part(state.time);
            for (i, area) in &load.areas {
                let i = *i as usize;
                let acts = match &load.action {
                    Action::Traction(t) => *t * (factor * area.norm()),
                    Action::Pressure(p) => self.carried(i, state.displacement, area) * (-p * factor),
                };
                (0..D).for_each(|a| force[i][a] += acts[a]);
            }
        }
    }

    /// Area vector in the deformed state of the undeformed area vector `area` at particle `i`: J F⁻ᵀ A (Nanson).
    pub fn carried(&self, i: usize, u: &[[f64; D]], area: &Vector<D>) -> Vector<D> {
        let f = self.deformation(i, u);
        let cofactor = |a: usize, b: usize| {
            let [r, s] = [(a + 1) % 3, (a + 2) % 3];
            let [p, q] = [(b + 1) % 3, (b + 2) % 3];
            f[r][p] * f[s][q] - f[r][q] * f[s][p]
        };
        Vector::from_fn(|a| (0..D).map(|b| cofactor(a, b) * area[b]).sum())
    }

    /// Computes the tangents that [`Self::stiffness`] uses: `elastic` times the tangent for the displacement plus
    /// `viscous` times that for the velocity, without damping proportional to mass.
    pub fn linearise(&self, state: &State<'_, D>, parts: [f64; 2], tangents: &mut Tangents<D>) {
        let [elastic, viscous] = parts;
        sweep_slots(&mut tangents.all, |i, t| {
            let f = self.deformation(i, state.displacement);
            for (a, b) in (0..D).flat_map(|a| (0..D).map(move |b| (a, b))) {
                let change = |component: [usize; 2]| self.tangent(i, (&f, component), state, parts);
                let on_axis = self.is_on_axis(i);
                t[a][b] = in_plane(&if on_axis { axis_tangent([a, b], change) } else { change([a, b]) });
            }
        });
        sweep_slots(&mut tangents.hoop, |i, t| {
            if self.is_on_axis(i) {
                return;
            }
            let f = self.deformation(i, state.displacement);
            let of_hoop = self.tangent(i, (&f, [2, 2]), state, parts);
            (t.of_strain, t.own) = (in_plane(&of_hoop), of_hoop[2][2]);
            for (a, b) in (0..D).flat_map(|a| (0..D).map(move |b| (a, b))) {
                t.of_stress[a][b] = self.tangent(i, (&f, [a, b]), state, parts)[2][2];
            }
        });
        sweep(&mut tangents.stiff, |i| {
            let [stiffness, damping] = self.holding_in(i, state);
            elastic * stiffness + viscous * damping
        });
    }

    /// The product K w: minus the change of the forces due to the displacements `w`; the change of follower loads is
    /// neglected.
    pub fn stiffness(&self, tangents: &Tangents<D>, w: &[[f64; D]], work: &mut Work<D>, out: &mut [[f64; D]]) {
        sweep(&mut work.stressed, |i| {
            let (mut change, plain) = gradients(self, i, |j| row(&w[j]));
            self.put_hoop(i, &mut change, w[i][0]);
            let mut stress = [[0.0; D]; D];
            for (a, b) in (0..D).flat_map(|a| (0..D).map(move |b| (a, b))) {
                let t = &tangents.all[i][a][b];
                (0..D).for_each(|r| (0..D).for_each(|s| stress[r][s] += t[r][s] * change[b][a]));
            }
            let (stiff, mut stress) = (tangents.stiff[i], columns(&stress));
            if let Some(hoop) = tangents.hoop.get(i) {
                hoop.add_to(&mut stress, &change);
            }
            let smooth = plain.map(|column| column.map(|a| a * stiff));
            ParticleStress { stress, smooth, stiff, viscous: 0.0, volume: 1.0 }
        });
        self.internal(StabilisedFields { displacement: w, velocity: None }, work, out);
        sweep_slots(out, |_, f| *f = f.map(|f| -f));
    }

    /// Derivative of the stress of a particle with respect to one component of its deformation gradient: `elastic`
    /// times that of the material plus `viscous` times that of the damping.
    fn tangent(
        &self,
        i: usize,
        (f, component): (&Tensor, [usize; 2]),
        state: &State<'_, D>,
        [elastic, viscous]: [f64; 2],
    ) -> Tensor {
        let (material, old, step) = (self.material_of(i), self.history_of(state.history, i), state.step);
        let one = |a: usize, b: usize| f64::from(u8::from([a, b] == component));
        let mut change = [[0.0; 3]; 3];
        if elastic > 0.0 {
            let dual: Tensor<Dual> =
                std::array::from_fn(|a| std::array::from_fn(|b| Dual { value: f[a][b], derivative: one(a, b) }));
            let mut scratch = [Dual { value: 0.0, derivative: 0.0 }; MOST_HISTORY];
            let own = material.history_len();
            let response = match self.plane {
                Plane::Strain | Plane::Axisymmetric => material.respond(&dual, &old[..own], step, &mut scratch[..own]),
                Plane::Stress => {
                    plane_stress(material, &dual, old[self.width - 1], &old[..own], step, &mut scratch[..own]).0
                }
            };
            change = response.stress.map(|row| row.map(|s| elastic * s.derivative));
        }
        if viscous > 0.0 && self.damping.stiffness > 0.0 {
            let rubbed = self.damping_stress(material, f, &std::array::from_fn(|a| std::array::from_fn(|b| one(a, b))));
            (0..3).for_each(|a| (0..3).for_each(|b| change[a][b] += viscous * rubbed[a][b]));
        }
        change
    }

    /// Sets `force` to the external forces: gravity and loads.
    pub fn outside(&self, state: &State<'_, D>, force: &mut [[f64; D]]) {
        let gravity = self.gravity * self.part(state.time);
        sweep(force, |i| (gravity * self.mass[i]).0);
        self.add_loads(state, force);
    }

    /// Sets `force` to the external forces at full load, where they grow with time.
    pub fn all_outside(&self, state: &State<'_, D>, force: &mut [[f64; D]]) {
        let time = if self.ramped { 1.0 } else { state.time };
        self.outside(&State { time, ..*state }, force);
    }

    /// Power dissipated by damping in a state (W).
    pub fn damped(&self, state: &State<'_, D>) -> f64 {
        let v = state.velocity;
        let slowed = sum(self.len(), |i| self.damping.mass * self.mass[i] * Vector(v[i]).norm_squared());
        let slowed = slowed + self.rubbed(state);
        if !self.is_viscous() {
            return slowed;
        }
        slowed
            + sum(self.len(), |i| {
                let (full, plain) = self.rate_of(i, v);
                let left = |e: &Edge<D>| self.left(i, e, v, &plain);
                let [_, viscous] = self.holding_in(i, state);
                let smoothed = viscous * self.particles.of(i).iter().map(left).sum::<f64>();
                if self.damping.stiffness == 0.0 {
                    return smoothed;
                }
                let f = self.deformation(i, state.displacement);
                let stress = self.damping_stress(self.material_of(i), &f, &full);
                let power = |(a, b): (usize, usize)| stress[a][b] * full[a][b];
                let all = (0..3).flat_map(|a| (0..3).map(move |b| (a, b)));
                smoothed + self.particles.volume[i] * all.map(power).sum::<f64>()
            })
    }

    /// Weighted square of the residual of a pair, w |q_j − q_i − A d|².
    fn left(&self, i: usize, e: &Edge<D>, q: &[[f64; D]], plain: &Columns<D>) -> f64 {
        let j = e.other as usize;
        let d = self.particles.x[j] - self.particles.x[i];
        let change = Vector(q[j]) - Vector(q[i]);
        let residual = Vector::<D>::from_fn(|a| change[a] - (0..D).map(|b| plain[b][a] * d[b]).sum::<f64>());
        residual.norm_squared() * e.weight
    }

    /// Energies in a state.
    pub fn energy(&self, state: &State<'_, D>) -> Energy {
        let n = self.len();
        let kinetic = sum(n, |i| 0.5 * self.mass[i] * Vector(state.velocity[i]).norm_squared());
        let strain = sum(n, |i| {
            let mut scratch = [0.0; MOST_HISTORY + 2];
            let old = self.history_of(state.history, i);
            let f = self.deformation(i, state.displacement);
            self.particles.volume[i] * self.respond(self.material_of(i), &f, (old, 0.0), &mut scratch).stored
        });
        let stabilisation = sum(n, |i| {
            let plain = plain_gradient(self, i, |j| row(&state.displacement[j]));
            let [c, _] = self.holding_in(i, state);
            let left = |e: &Edge<D>| self.left(i, e, state.displacement, &plain);
            0.5 * c * self.particles.of(i).iter().map(left).sum::<f64>()
        });
        let lost = |at: usize| sum(n, |i| self.particles.volume[i] * self.history_of(state.history, i)[at]);
        let dissipated = self.lost_at().map_or(0.0, lost);
        Energy { kinetic, strain, stabilisation, contact: self.contact_energy(state), dissipated }
    }

    /// Cauchy stress at particle `i` (Pa).
    pub fn cauchy(&self, i: usize, state: &State<'_, D>) -> Tensor {
        let mut f = self.deformation(i, state.displacement);
        let old = self.history_of(state.history, i);
        let mut scratch = [0.0; MOST_HISTORY + 2];
        let stress = self.respond(self.material_of(i), &f, (old, 0.0), &mut scratch).stress;
        if self.plane == Plane::Stress {
            f[2][2] = scratch[self.width - 1];
        }
        let size = 1.0 / determinant(&f);
        product_transposed(&stress, &f).map(|row| row.map(|s| s * size))
    }

    /// History variables of the material of particle `i`.
    pub fn memory<'a>(&self, i: usize, history: &'a [f64]) -> &'a [f64] {
        &self.history_of(history, i)[..self.material_of(i).history_len()]
    }

    /// 3-D deformation gradient at particle `i`.
    pub fn deformation(&self, i: usize, u: &[[f64; D]]) -> Tensor {
        let (mut gradient, _) = gradients(self, i, |j| row(&u[j]));
        self.put_hoop(i, &mut gradient, u[i][0]);
        deformation_with_hoop(&gradient)
    }

    /// Rejects a state in which a displacement is not finite or a particle is inverted.
    pub fn check(&self, displacement: &[[f64; D]]) -> Result<(), Fault> {
        self.check_volumes(displacement, |i| determinant(&self.deformation(i, displacement)))
    }

    /// The same check where the stresses in `work` belong to the state, which saves their volumes from being
    /// recomputed.
    pub fn check_stressed(&self, displacement: &[[f64; D]], work: &Work<D>) -> Result<(), Fault> {
        self.check_volumes(displacement, |i| work.stressed[i].volume)
    }

    fn check_volumes(&self, displacement: &[[f64; D]], kept: impl Fn(usize) -> f64 + Sync) -> Result<(), Fault> {
        /// Smallest permitted volume ratio of a particle.
        const MIN_VOLUME_RATIO: f64 = 0.05;
        let Some(i) = first(self.len(), |i| !(kept(i) > MIN_VOLUME_RATIO)) else { return Ok(()) };
        let reason = match kept(i) {
            j if j.is_finite() => {
                format!(
                    "a particle of the solid is compressed to {j:.3} of its volume; the minimum is {MIN_VOLUME_RATIO}"
                )
            }
            _ => "the displacement of a particle of the solid is not a finite number".to_owned(),
        };
        let place = (0..D).map(|a| self.particles.x[i][a] + displacement[i][a]).collect();
        Err(Fault { particle: i, place, reason })
    }

    /// Longest stable step of explicit integration (s): that of the undeformed solid, reduced where it is compressed.
    pub fn stable_step(&self, u: &[[f64; D]]) -> f64 {
        self.step_factors()[0] / self.fastest(u)
    }

    /// Longest stable step without damping (s).
    pub fn undamped_step(&self, u: &[[f64; D]]) -> f64 {
        self.step_factors()[1] / self.fastest(u)
    }

    /// Largest number of particle distances that a wave travels per unit of time.
    fn fastest(&self, u: &[[f64; D]]) -> f64 {
        maximum(self.len(), |i| {
            let speed = self.material_of(i).pressure_wave_speed();
            speed / (self.particles.spacing[i] * least_stretch(&self.deformation(i, u)))
        })
    }
}

/// The components of a tensor in the plane, or all of them in 3-D.
fn in_plane<const D: usize>(t: &Tensor) -> Matrix<D> {
    std::array::from_fn(|a| std::array::from_fn(|b| t[a][b]))
}

/// A lower bound of the smallest principal stretch: the smaller of 1 and J divided by the product of the other
/// stretches.
fn least_stretch(f: &Tensor) -> f64 {
    let c: Tensor = std::array::from_fn(|a| std::array::from_fn(|b| (0..3).map(|k| f[k][a] * f[k][b]).sum()));
    smallest_eigenvalue::<3>(&c).max(1e-6).sqrt().min(1.0)
}

/// Stresses of the particles from `first` on, and the resulting history variables.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn stresses<const D: usize>(
    solid: &Solid<D>,
    state: &State<'_, D>,
    first: usize,
    stressed: &mut [ParticleStress<D>],
    after: &mut [f64],
) {
    let width = solid.width;
    for (k, one) in stressed.iter_mut().enumerate() {
        *one = solid.stress_of(first + k, state, &mut after[k * width..(k + 1) * width]);
    }
}
