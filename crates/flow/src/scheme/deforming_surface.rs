//! Deforming walls: normals, areas, curvature and velocity gradient.
//!
//! A surface point X moves to X + u(X) with u = Σ_m q_m φ_m; F = 1 + ∂u/∂X is the deformation gradient. Velocities and
//! accelerations follow from the positions. In addition, the rate Ḟ F⁻¹ of stretching and rotation of the wall is
//! necessary.
//!
//! For a solid of particles, the displacement is known on the surface only. The derivatives of F along the surface come
//! from a parabola through the surrounding interface particles of the same smooth piece; across it, the normal is
//! mapped to the normal. Area vectors, normals and curvature depend on nothing else.
use crate::cloud::{Cloud, Interface, Strain};
use crate::math::Vector;
use crate::math::jet::Jet;
use crate::math::moving_fit::{Basis, weights};
use crate::math::parallel::sweep_slots;
use crate::motion::{BodyMotion, Carried, Expansion, tangents};

/// Number of surrounding interface particles for these derivatives, in 2-D and 3-D.
const AROUND: [usize; 2] = [6, 14];
/// Cosine of the angle between normals below which a particle lies on another side.
const OTHER_SIDE: f64 = 0.3;

/// Modes of the bodies at every interface particle; empty when no body deforms.
#[derive(Clone, Debug, Default)]
pub struct DeformingSurface<const D: usize> {
    modes: Vec<Vec<Expansion<D>>>,
    particles: Vec<Option<Bending<D>>>,
    laws: Vec<BodyMotion<D>>,
}

/// Displacement and local derivative weights at an interface particle of a solid of particles.
#[derive(Clone, Debug)]
struct Bending<const D: usize> {
    body: usize,
    carried: Carried<D>,
    tangents: [Vector<D>; 2],
    around: Vec<u32>,
    /// Weights of differences to the surrounding particles in ∂/∂ξ, ∂/∂η, ∂²/∂ξ², ∂²/∂ξ∂η and ∂²/∂η².
    weights: [Vec<f64>; 5],
}

/// Deformation of the surface at one interface particle at one time.
pub(super) struct SurfaceStrain<const D: usize> {
    /// Deformation gradient and its derivatives.
    pub(super) strain: Strain<D>,
    /// Rows of the rate Ḟ F⁻¹.
    pub(super) rate: [Vector<D>; D],
    /// Displacement in each mode.
    pub(super) shifts: Vec<Vector<D>>,
}

/// Displacement, velocity and acceleration of an interface particle of a solid of particles.
pub(super) type Course<const D: usize> = [Vector<D>; 3];

impl<const D: usize> DeformingSurface<D> {
    /// The surfaces of bodies with the motions `laws`.
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
        if !laws.iter().any(|law| law.net().is_some()) {
            return Self { modes, ..Self::default() };
        }
        let mut particles = vec![None; cloud.interface.len()];
        sweep_slots(&mut particles, |w, slot| *slot = bending(cloud, laws, w));
        Self { modes, particles, laws: laws.to_vec() }
    }

    /// Displacements of the interface particles of solids of particles for the coordinates `jets` of all bodies; empty
    /// when there are no such solids.
    pub(super) fn carried(&self, jets: &[Jet]) -> Vec<Course<D>> {
        if self.particles.is_empty() {
            return Vec::new();
        }
        let parts: [fn(&Jet) -> f64; 3] = [|j| j.value, |j| j.first, |j| j.second];
        let of = |law: &BodyMotion<D>| law.net().map(|net| parts.map(|part| net.of(jets, part)));
        let nodes: Vec<Option<[Vec<Vector<D>>; 3]>> = self.laws.iter().map(of).collect();
        let mut all = vec![[Vector::ZERO; 3]; self.particles.len()];
        sweep_slots(&mut all, |w, slot| {
            let Some(bending) = &self.particles[w] else { return };
            if let Some(nodes) = &nodes[bending.body] {
                *slot = std::array::from_fn(|k| bending.carried.of_nodes(&nodes[k]));
            }
        });
        all
    }

    /// Deformation of the surface of a solid of particles at interface particle `w`; `rest` is its undeformed data.
    pub(super) fn carried_strain(&self, w: usize, at: &[Course<D>], rest: &Interface<D>) -> Option<SurfaceStrain<D>> {
        let bending = self.particles.get(w)?.as_ref()?;
        let sum = |weights: &[f64], part: usize| {
            let around = bending.around.iter().zip(weights);
            around.fold(Vector::ZERO, |sum, (k, weight)| sum + (at[*k as usize][part] - at[w][part]) * *weight)
        };
        let n = rest.normal;
        let along = [0, 1].map(|a| bending.tangents[a] + sum(&bending.weights[a], 0));
        let lifted = lifted::<D>(&along).unwrap_or(n);
        let tangents = bending.tangents;
        // F maps the tangents to the deformed tangents and the normal to the deformed normal
        let map: [Vector<D>; D] =
            std::array::from_fn(|i| (0..D - 1).fold(n * lifted[i], |row, a| row + tangents[a] * along[a][i]));
        let curved = |a: usize, b: usize| tangents[a].dot(&Vector::from_fn(|d| rest.curvature[d].dot(&tangents[b])));
        let mut second = [[Vector::ZERO; D]; D];
        for (a, b, k) in [(0, 0, 2), (0, 1, 3), (1, 0, 3), (1, 1, 4)] {
            if a.max(b) >= D - 1 {
                continue;
            }
            let bent = sum(&bending.weights[k], 0) + (lifted - n) * curved(a, b);
            for i in 0..D {
                (0..D).for_each(|j| second[i][j] += tangents[b] * (bent[i] * tangents[a][j]));
            }
        }
        let strain = Strain { map, second };
        let inverse = strain.inverse();
        let speeds = [0, 1].map(|a| sum(&bending.weights[a], 1));
        let rate = std::array::from_fn(|i| {
            // row i of Ḟ, then multiplied by F⁻¹
            let row = (0..D - 1).fold(Vector::ZERO, |row, a| row + tangents[a] * speeds[a][i]);
            (0..D).fold(Vector::ZERO, |sum: Vector<D>, k| sum + inverse[k] * row[k])
        });
        Some(SurfaceStrain { strain, rate, shifts: Vec::new() })
    }

    /// Deformation of the surface at interface particle `w` at time `t`; `None` when the body does not deform.
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
        // row i of Ḟ multiplied by F⁻¹
        let rate = std::array::from_fn(|i| (0..D).fold(Vector::ZERO, |sum, k| sum + inverse[k] * rates[i][k]));
        Some(SurfaceStrain { strain, rate, shifts: modes.iter().map(|m| m.value).collect() })
    }
}

/// Unit normal of the surface with these two tangents; in 2-D the second one is ignored.
fn lifted<const D: usize>(along: &[Vector<D>; 2]) -> Option<Vector<D>> {
    let normal = match D {
        2 => Vector::from_fn(|d| if d == 0 { along[0][1] } else { -along[0][0] }),
        _ => {
            let [a, b] = along.map(|v| v.to_3d());
            let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            Vector::from_fn(|d| cross[d])
        }
    };
    let size = normal.norm();
    (size > 0.0 && size.is_finite()).then(|| normal * (1.0 / size))
}

/// Local derivative weights of an interface particle; `None` when its body is not a solid of particles.
fn bending<const D: usize>(cloud: &Cloud<D>, laws: &[BodyMotion<D>], w: usize) -> Option<Bending<D>> {
    let own = &cloud.interface[w];
    let net = laws.get(usize::from(own.body))?.net()?;
    let place = |k: usize| cloud.x[cloud.n_fluid + k];
    let like = |k: &usize| {
        let other = &cloud.interface[*k];
        *k != w && other.body == own.body && other.piece == own.piece && other.normal.dot(&own.normal) > OTHER_SIDE
    };
    let distance = |k: usize| (place(k) - place(w)).norm_squared();
    let mut near: Vec<(f64, u32)> = (0..cloud.interface.len()).filter(like).map(|k| (distance(k), k as u32)).collect();
    let count = AROUND[D - 2].min(near.len());
    if count < near.len() {
        near.select_nth_unstable_by(count, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.truncate(count);
    }
    near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let tangents = tangents(&own.normal);
    let scale = near.last().map_or(1.0, |(r2, _)| r2.sqrt()).max(f64::MIN_POSITIVE);
    let offset = |k: u32| {
        let d = (place(k as usize) - place(w)) * (1.0 / scale);
        [d.dot(&tangents[0]), d.dot(&tangents[1])]
    };
    // power of both coordinates, and which of the five derivatives it has
    let powers: &[([i32; 2], usize, f64)] = match D {
        2 => &[([1, 0], 0, 1.0), ([2, 0], 2, 2.0)],
        _ => &[([1, 0], 0, 1.0), ([0, 1], 1, 1.0), ([2, 0], 2, 2.0), ([1, 1], 3, 1.0), ([0, 2], 4, 2.0)],
    };
    let basis = powers.iter().map(|(power, which, size)| {
        let at = |(_, k): &(f64, u32)| {
            let [x, y] = offset(*k);
            x.powi(power[0]) * y.powi(power[1])
        };
        let mut asked = vec![0.0; 5];
        asked[*which] = size / scale.powi(power[0] + power[1]);
        Basis { at_nodes: near.iter().map(at).collect(), asked }
    });
    let of_values: Vec<f64> = near.iter().map(|(r2, _)| scale * scale / r2.max(f64::MIN_POSITIVE)).collect();
    let all = weights(basis.collect(), &of_values);
    let n = near.len();
    Some(Bending {
        body: usize::from(own.body),
        carried: net.on_surface(&place(w), &own.normal),
        tangents,
        around: near.iter().map(|(_, k)| *k).collect(),
        weights: std::array::from_fn(|k| all.get(k * n..(k + 1) * n).unwrap_or_default().to_vec()),
    })
}
