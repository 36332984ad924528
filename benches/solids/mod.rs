//! Speed of structures of particles.
use alula::math::Vector;
use alula::physics::solid::{Law, Material, Moduli, Plasticity};
use alula::solid::fill::Lattice;
use alula::solid::{Damping, Particles, Parts, Plane, Solid, Structure};
use alula::time::symplectic::{Plan, Symplectic};
use alula::time::{Integrator, Past};
use divan::Bencher;
use divan::counter::ItemsCount;

use super::{THREADS, pool};

/// Particles along each side of the cube that is marched.
const SIDE: usize = 24;

/// A cube in space, or a plate three times as wide in the plane.
pub(crate) fn particles<const D: usize>(side: usize) -> Particles<D> {
    let size: [f64; D] = std::array::from_fn(|d| if D == 2 && d == 0 { 3.0 } else { 1.0 });
    let corners = (0..1 << D).map(|k| Vector::from_fn(|d| if k >> d & 1 == 1 { size[d] } else { 0.0 })).collect();
    let counts = size.map(|s| (s * (side - 1) as f64) as usize + 1);
    Particles::new(vec![Lattice { corners, counts, jitter: 0.1 }.fill()]).unwrap()
}

/// These particles of one material, free of supports and loads.
pub(crate) fn structure<const D: usize>(particles: Particles<D>, law: Law) -> Structure<D> {
    let n = particles.len();
    Structure::new(Solid::new(Parts {
        body: vec![0; n],
        materials: vec![Material::new(1000.0, Moduli { shear: 1e6, bulk: 2e6 }, law)],
        material: vec![0; n],
        plane: Plane::Strain,
        gravity: Vector::ZERO,
        damping: Damping { stabilisation: 0.4, viscosity: 0.0, mass: 0.0, stiffness: 0.0 },
        supports: Vec::new(),
        loads: Vec::new(),
        contact: None,
        ramped: false,
        particles,
    }))
}

/// A march of a structure that is thrown about and bent.
pub(crate) fn thrown<const D: usize>(structure: &Structure<D>) -> Symplectic<'_, Structure<D>> {
    let bend = |i: usize| std::array::from_fn(|a| (3.0 * structure.solid.particles.x[i][(a + 1) % D]).sin());
    Symplectic::new(structure, Plan { cfl: 0.5, until: 1e9 }, Past::default(), structure.start(bend))
}

fn steps<const D: usize>(bencher: Bencher<'_, '_>, threads: usize, law: Law) {
    let (structure, pool) = (structure(particles::<D>(SIDE), law), pool(threads));
    let mut march = thrown(&structure);
    bencher.counter(ItemsCount::new(structure.solid.len())).bench_local(|| pool.install(|| march.advance()).is_ok());
}

/// A whole step of an elastic body.
#[divan::bench(consts = [2, 3], args = THREADS)]
fn solid_step<const D: usize>(bencher: Bencher<'_, '_>, threads: usize) {
    steps::<D>(bencher, threads, Law::NeoHookean);
}

/// A whole step of a metal that yields.
#[divan::bench(consts = [2, 3], args = THREADS)]
fn plastic_step<const D: usize>(bencher: Bencher<'_, '_>, threads: usize) {
    steps::<D>(bencher, threads, Law::Plastic(Plasticity::linear(1e4, 1e5)));
}
