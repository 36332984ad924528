//! What a structure of particles is: the cloud, its materials, where it is held and what acts on it.
use std::ops::Deref;
use std::sync::OnceLock;

use super::particles::Particles;
use super::rows::{Row, row};
use crate::math::Vector;
use crate::physics::solid::{MOST_HISTORY, Material};

/// Cells between particles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cells {
    /// Triangles of plane bodies, counterclockwise at rest.
    pub triangles: Vec<[u32; 3]>,
    /// Tetrahedra of bodies in space, of positive volume at rest.
    pub tetrahedra: Vec<[u32; 4]>,
}

/// What happens across a plane body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// It cannot widen or shrink: F₃₃ = 1.
    Strain,
    /// Nothing holds it: P₃₃ = 0.
    Stress,
    /// The y axis is an axis of revolution, x the radius: F₃₃ = 1 + u_x/x. Particles are those of a section that was
    /// [`turned`](super::particles::Fill::turned).
    Axisymmetric,
}

/// What a function of time is.
pub type InTime<T> = Box<dyn Fn(f64) -> T + Send + Sync>;

/// Particles that are held along some axes.
pub struct Support<const D: usize> {
    /// Which.
    pub particles: Vec<u32>,
    /// True for axes along which they are held.
    pub fixed: [bool; D],
    /// Displacement along these axes; `None` where they stay.
    pub motion: Option<InTime<Vector<D>>>,
}

/// What acts on particles of the surface.
pub enum Action<const D: usize> {
    /// A pressure against the surface, which follows it.
    Pressure(f64),
    /// A force per area at rest, whose direction stays.
    Traction(Vector<D>),
}

/// A load on parts of the surface.
pub struct Load<const D: usize> {
    /// Area at rest that each particle has in it, as a vector.
    pub areas: Vec<(u32, Vector<D>)>,
    /// What acts there.
    pub action: Action<D>,
    /// Factor that depends on time.
    pub history: InTime<f64>,
}

/// A rigid plane; bodies are where its unit normal points to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidPlane<const D: usize> {
    /// A point of it.
    pub point: Vector<D>,
    /// Unit normal.
    pub normal: Vector<D>,
}

/// What touches.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact<const D: usize> {
    /// Rigid planes.
    pub planes: Vec<RigidPlane<D>>,
    /// Bodies touch one another.
    pub bodies: bool,
    /// s, the stiffness over that of a column of the body one spacing high.
    pub stiffness: f64,
    /// Coefficient of Coulomb's friction on planes.
    pub friction: f64,
}

/// How much is smoothed and lost beside what the materials say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damping {
    /// α of the residual's stiffness, in shear moduli.
    pub stabilisation: f64,
    /// β of the residual's viscosity, in ρ c h.
    pub viscosity: f64,
    /// Rate of decay in proportion to mass, 1/s.
    pub mass: f64,
    /// Damping in proportion to stiffness, s: stress of the rate of strain over that of the strain.
    pub stiffness: f64,
}

/// A structure of particles, one or several bodies, which do not see one another: its parts, and what follows from them.
pub struct Solid<const D: usize> {
    parts: Parts<D>,
    /// Places at rest.
    pub(super) places: Vec<Row>,
    /// Mass of each particle.
    pub(super) mass: Vec<f64>,
    /// Axes along which each particle is held, one bit each.
    pub(super) held: Vec<u8>,
    /// V times the number of dimensions over the number of neighbours: weight of the residuals around each particle.
    pub(super) weight: Vec<f64>,
    /// c of the residuals of velocity, β ρ c_p h times that weight, and what is damped in proportion to stiffness.
    pub(super) viscous: Vec<f64>,
    /// Numbers of history of a particle.
    pub(super) width: usize,
    /// 1/x about an axis of revolution, 0 on it; empty elsewhere.
    pub(super) per_radius: Vec<f64>,
    /// The longest stable step over the least h/c, and that without damping, once they are known.
    pub(super) factor: OnceLock<[f64; 2]>,
    /// Cells between the particles, once they are known.
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

/// Mass of a particle in ρ h^D, of a whole turn about an axis, below which it takes from its neighbours: those at sharp edges hold so little that they would decide
/// the time step.
const LEAST_MASS: f64 = 0.25;

/// Mass of each particle: that of its volume, but the lightest take what they lack from heavier neighbours, as far as these can give.
fn masses<const D: usize>(particles: &Particles<D>, density: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut mass: Vec<f64> = (0..particles.len()).map(|i| density(i) * particles.volume[i]).collect();
    let over: Vec<f64> = mass
        .iter()
        .enumerate()
        .map(|(i, m)| m - LEAST_MASS * density(i) * particles.spacing[i].powi(D as i32) * particles.around(i))
        .collect();
    let near = |i: usize| particles.of(i).iter().map(|e| e.other as usize);
    // what each light particle asks of all its neighbours over what they have to give, and what is asked of each of these
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

/// All that a structure is made of.
pub struct Parts<const D: usize> {
    /// The cloud.
    pub particles: Particles<D>,
    /// Body of each particle.
    pub body: Vec<u16>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Material of each particle.
    pub material: Vec<u16>,
    /// What happens across a plane body.
    pub plane: Plane,
    /// Acceleration of gravity.
    pub gravity: Vector<D>,
    /// Damping.
    pub damping: Damping,
    /// Supports.
    pub supports: Vec<Support<D>>,
    /// Loads.
    pub loads: Vec<Load<D>>,
    /// What touches.
    pub contact: Option<Contact<D>>,
    /// Time is the part of loads, gravity and motions that acts: for equilibrium.
    pub ramped: bool,
}

impl<const D: usize> Solid<D> {
    /// The structure made of `parts`.
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
        // one more for what is lost, and for the stretch across a plane body
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

    /// True when there are none.
    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }

    /// Material of a particle.
    #[inline(always)]
    pub fn material_of(&self, i: usize) -> &Material {
        &self.materials[usize::from(self.material[i])]
    }

    /// Mass of each particle.
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// True where a particle is held along an axis.
    #[inline(always)]
    pub fn is_held(&self, i: usize, axis: usize) -> bool {
        self.held[i] >> axis & 1 == 1
    }

    /// Numbers of history of a particle.
    pub fn history_width(&self) -> usize {
        self.width
    }

    /// True when a material remembers: what it does next depends on more than its deformation.
    pub fn remembers(&self) -> bool {
        self.materials.iter().any(|m| m.history_len() > 0)
    }

    /// History of the virgin structure.
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

    /// Part of what acts at time `t`.
    pub(super) fn part(&self, t: f64) -> f64 {
        if self.ramped { t } else { 1.0 }
    }

    /// Where in the history of a particle that is lost stands which its material has lost; `None` where none loses.
    #[inline(always)]
    pub(super) fn lost_at(&self) -> Option<usize> {
        (self.width + usize::from(self.plane != Plane::Stress)).checked_sub(2)
    }

    /// Puts held particles where they are to be at time `t`.
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
