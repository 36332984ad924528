//! Definition of a solid: particles, materials, supports, loads and contact. SI units unless stated otherwise.
use std::ops::Deref;
use std::sync::OnceLock;

use super::particles::Particles;
use super::rows::{Row, row};
use crate::math::Vector;
use crate::physics::solid::{MOST_HISTORY, Material};

/// Cells between the particles, for visualisation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cells {
    /// Triangles of 2-D bodies, counterclockwise in the undeformed state.
    pub triangles: Vec<[u32; 3]>,
    /// Tetrahedra of 3-D bodies, with positive volume in the undeformed state.
    pub tetrahedra: Vec<[u32; 4]>,
}

/// Assumption for the direction normal to a 2-D body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// Plane strain: F₃₃ = 1.
    Strain,
    /// Plane stress: P₃₃ = 0.
    Stress,
    /// Axial symmetry about the y axis, where x is the radius: F₃₃ = 1 + u_x/x. The particles must be those of a
    /// section made into a body of revolution by [`turned`](super::particles::Fill::turned).
    Axisymmetric,
}

/// A function of time [s].
pub type InTime<T> = Box<dyn Fn(f64) -> T + Send + Sync>;

/// A support: particles whose displacement is prescribed along some axes.
pub struct Support<const D: usize> {
    /// Indices of the particles.
    pub particles: Vec<u32>,
    /// True for the axes along which the displacement is prescribed.
    pub fixed: [bool; D],
    /// Displacement along these axes as a function of time; `None`: zero.
    pub motion: Option<InTime<Vector<D>>>,
}

/// Kind of a load on the surface.
pub enum Action<const D: usize> {
    /// Pressure [Pa] normal to the deformed surface (follower load).
    Pressure(f64),
    /// Force per undeformed area [Pa], with a fixed direction.
    Traction(Vector<D>),
}

/// A load on part of the surface.
pub struct Load<const D: usize> {
    /// Particles with the part of their undeformed area vector on which the load acts.
    pub areas: Vec<(u32, Vector<D>)>,
    /// Kind and magnitude of the load.
    pub action: Action<D>,
    /// Factor as a function of time.
    pub history: InTime<f64>,
}

/// A rigid plane. Bodies lie on the side to which its unit normal points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidPlane<const D: usize> {
    /// A point of the plane.
    pub point: Vector<D>,
    /// Unit normal.
    pub normal: Vector<D>,
}

/// Contact conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact<const D: usize> {
    /// Rigid planes.
    pub planes: Vec<RigidPlane<D>>,
    /// True when the bodies can touch one another.
    pub bodies: bool,
    /// Penalty factor s: contact stiffness relative to that of a column of the body one spacing high.
    pub stiffness: f64,
    /// Coefficient of Coulomb friction on the planes.
    pub friction: f64,
}

/// Stabilisation and damping in addition to the material laws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damping {
    /// Stabilising stiffness α of the displacement residuals, in shear moduli.
    pub stabilisation: f64,
    /// Viscosity β of the velocity residuals, in ρ c h.
    pub viscosity: f64,
    /// Damping proportional to mass: decay rate [1/s].
    pub mass: f64,
    /// Damping proportional to stiffness [s]: stress due to the strain rate divided by the stress due to the strain.
    pub stiffness: f64,
}

/// A solid of one or several bodies that are not connected: its definition and quantities derived from it.
pub struct Solid<const D: usize> {
    parts: Parts<D>,
    /// Undeformed positions of the particles.
    pub(super) places: Vec<Row>,
    /// Mass of each particle [kg].
    pub(super) mass: Vec<f64>,
    /// Axes along which each particle is constrained, as bits.
    pub(super) held: Vec<u8>,
    /// Weight of the residuals around each particle: volume times number of dimensions divided by number of neighbours.
    pub(super) weight: Vec<f64>,
    /// Coefficient c of the velocity residuals, β ρ c_p h times that weight, plus the damping proportional to
    /// stiffness.
    pub(super) viscous: Vec<f64>,
    /// Number of history variables of a particle.
    pub(super) width: usize,
    /// 1/x in a body of revolution, 0 on its axis; empty for other bodies.
    pub(super) per_radius: Vec<f64>,
    /// Stable step with and without damping as a multiple of the smallest h/c, computed at the first use.
    pub(super) factor: OnceLock<[f64; 2]>,
    /// Cells between the particles, computed at the first use.
    pub(super) cells: OnceLock<Cells>,
}

impl<const D: usize> std::fmt::Debug for Solid<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Solid").field("particles", &self.parts.particles.len()).finish_non_exhaustive()
    }
}

impl<const D: usize> Deref for Solid<D> {
    type Target = Parts<D>;

    #[inline(always)]
    fn deref(&self) -> &Parts<D> {
        &self.parts
    }
}

/// Smallest mass of a particle in units of ρ h^D (of a complete ring in a body of revolution). Lighter particles take
/// mass from their neighbours: those at sharp edges represent so little volume that they would determine the time step.
const MIN_MASS: f64 = 0.25;

/// Mass of each particle: that of its volume, but particles below the smallest mass take the difference from heavier
/// neighbours as far as these exceed it.
fn masses<const D: usize>(particles: &Particles<D>, density: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut mass: Vec<f64> = (0..particles.len()).map(|i| density(i) * particles.volume[i]).collect();
    let over: Vec<f64> = mass
        .iter()
        .enumerate()
        .map(|(i, m)| m - MIN_MASS * density(i) * particles.spacing[i].powi(D as i32) * particles.around(i))
        .collect();
    let near = |i: usize| particles.of(i).iter().map(|e| e.other as usize);
    // the mass that each light particle lacks, relative to what its neighbours can give, and the total request to each
    // of these
    let ask = |i: usize| -over[i].min(0.0) / near(i).map(|j| over[j].max(0.0)).sum::<f64>().max(f64::MIN_POSITIVE);
    let asks: Vec<f64> = (0..mass.len()).map(|i| ask(i).min(1.0)).collect();
    let asked: Vec<f64> = (0..mass.len()).map(|j| near(j).map(|i| asks[i]).sum::<f64>()).collect();
    for i in (0..mass.len()).filter(|i| asks[*i] > 0.0) {
        for j in near(i) {
            let given = over[j].max(0.0) * asks[i] / asked[j].max(1.0);
            mass[i] += given;
            mass[j] -= given;
        }
    }
    mass
}

/// Definition of a solid.
pub struct Parts<const D: usize> {
    /// The undeformed particles with their gradients.
    pub particles: Particles<D>,
    /// Index of the body of each particle.
    pub body: Vec<u16>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Index of the material of each particle.
    pub material: Vec<u16>,
    /// Assumption for the direction normal to a 2-D body.
    pub plane: Plane,
    /// Acceleration of gravity [m/s²].
    pub gravity: Vector<D>,
    /// Stabilisation and damping.
    pub damping: Damping,
    /// Supports.
    pub supports: Vec<Support<D>>,
    /// Loads.
    pub loads: Vec<Load<D>>,
    /// Contact conditions, if any.
    pub contact: Option<Contact<D>>,
    /// True when time is a load factor from 0 to 1 on loads, gravity and prescribed motions, for static equilibrium.
    pub ramped: bool,
}

impl<const D: usize> Solid<D> {
    /// Prepares a solid of these `parts`.
    pub fn new(parts: Parts<D>) -> Self {
        let particles = &parts.particles;
        let (n, h) = (particles.len(), &particles.spacing);
        let material = |i: usize| &parts.materials[usize::from(parts.material[i])];
        let weight: Vec<f64> = (0..n).map(|i| particles.volume[i] * D as f64 / particles.of(i).len() as f64).collect();
        let viscous = |i: usize| {
            let impedance = material(i).density * material(i).pressure_wave_speed();
            let stiff = parts.damping.stiffness * parts.damping.stabilisation * material(i).moduli.shear;
            (parts.damping.viscosity * impedance * h[i] + stiff) * weight[i]
        };
        let mut held = vec![0u8; n];
        for support in &parts.supports {
            let bits = (0..D).filter(|d| support.fixed[*d]).map(|d| 1u8 << d).sum::<u8>();
            support.particles.iter().for_each(|i| held[*i as usize] |= bits);
        }
        // one more for the dissipated energy, and one for the stretch normal to the plane
        let own = parts.materials.iter().map(Material::history_len).max().unwrap_or(0);
        let width = own + usize::from(own > 0) + usize::from(parts.plane == Plane::Stress);
        assert!(own <= MOST_HISTORY, "a material keeps more history than there is room for");
        let round = parts.plane == Plane::Axisymmetric;
        assert!(round == particles.is_round(), "bodies of revolution are made of particles that were turned");
        let per_radius = |x: &Vector<D>| if x[0] > 0.0 { 1.0 / x[0] } else { 0.0 };
        Self {
            per_radius: if round { particles.x.iter().map(per_radius).collect() } else { Vec::new() },
            places: particles.x.iter().map(|x| row(&x.0)).collect(),
            mass: masses(particles, |i| material(i).density),
            viscous: (0..n).map(viscous).collect(),
            held,
            weight,
            width,
            factor: OnceLock::new(),
            cells: OnceLock::new(),
            parts,
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.particles.len()
    }

    /// True when there are no particles.
    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }

    /// Material of particle `i`.
    #[inline(always)]
    pub fn material_of(&self, i: usize) -> &Material {
        &self.materials[usize::from(self.material[i])]
    }

    /// Mass of each particle [kg].
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// True when particle `i` is constrained along an axis.
    #[inline(always)]
    pub fn is_held(&self, i: usize, axis: usize) -> bool {
        self.held[i] >> axis & 1 == 1
    }

    /// Number of history variables of a particle.
    pub fn history_width(&self) -> usize {
        self.width
    }

    /// True when the response of a material depends on its history.
    pub fn remembers(&self) -> bool {
        self.materials.iter().any(|m| m.history_len() > 0)
    }

    /// History variables of the undeformed solid that was never loaded.
    pub fn virgin(&self) -> Vec<f64> {
        let mut history = vec![0.0; self.len() * self.width];
        if self.width > 0 {
            for (i, row) in history.chunks_exact_mut(self.width).enumerate() {
                let material = self.material_of(i);
                material.begin(&mut row[..material.history_len()]);
                if self.plane == Plane::Stress {
                    row[self.width - 1] = 1.0;
                }
            }
        }
        history
    }

    /// Load factor at time `t`.
    pub(super) fn part(&self, t: f64) -> f64 {
        if self.ramped { t } else { 1.0 }
    }

    /// Index, in the history of a particle, of the energy dissipated by its material; `None` where no material
    /// dissipates.
    #[inline(always)]
    pub(super) fn lost_at(&self) -> Option<usize> {
        (self.width + usize::from(self.plane != Plane::Stress)).checked_sub(2)
    }

    /// Sets the prescribed displacements at time `t`.
    pub fn hold(&self, t: f64, displacement: &mut [[f64; D]]) {
        for support in &self.supports {
            let moved = support.motion.as_ref().map_or(Vector::ZERO, |motion| motion(t) * self.part(t));
            for i in &support.particles {
                let u = &mut displacement[*i as usize];
                (0..D).filter(|d| support.fixed[*d]).for_each(|d| u[d] = moved[d]);
            }
        }
    }

    /// True when a support moves.
    pub fn is_moved(&self) -> bool {
        self.supports.iter().any(|s| s.motion.is_some())
    }
}
