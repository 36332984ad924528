//! Bodies of revolution against exact solutions and invariants.
use super::axis::held_on_axis;
use super::body::{Damping, Parts, Plane, Solid};
use super::fill::{Lattice, relaxed};
use super::forces::State;
use super::modes::{ModeRequest, modes};
use super::particles::{Fill, Particles};
use super::system::Structure;
use crate::math::Vector;
use crate::physics::solid::{Law, Material, Moduli, neo_hookean};
use crate::system::{Mechanical, Moment, System};

const RUBBER: Moduli = Moduli { shear: 1.0, bulk: 2.0 };

/// Rows of particles from one corner to the other, the inner ones shifted at random by a part of their spacing.
fn rows(low: [f64; 2], high: [f64; 2], counts: [usize; 2], jitter: f64) -> Fill<2> {
    let corner = |k: usize| Vector(std::array::from_fn(|d| if k >> d & 1 == 1 { high[d] } else { low[d] }));
    Lattice { corners: (0..4).map(corner).collect(), counts, jitter }.fill()
}

/// A cylinder with a conical foot, filled by a relaxed lattice.
fn conical() -> Fill<2> {
    let case = "title = \"t\"\n[[body]]\npolygon = [[0, 0], [1, 0.2], [1, 1], [0, 1]]\n[flow]\nmach = 0.3\n";
    let case = crate::case::read(case, "case").unwrap();
    let (surface, _) = crate::geometry::load_surface::<2>(&case.bodies, std::path::Path::new("")).unwrap();
    relaxed(&surface, 0.08)
}

/// What is turned: with and without an axis, in rows, shifted and relaxed.
fn sections() -> Vec<Fill<2>> {
    vec![
        rows([0.0, 0.0], [1.0, 1.0], [9, 9], 0.0),
        rows([0.0, 0.0], [1.0, 0.5], [17, 9], 0.2),
        rows([0.7, -1.0], [1.7, 0.0], [13, 13], 0.2),
        conical(),
    ]
}

fn body(section: Fill<2>, material: Material, damping: Damping) -> Solid<2> {
    let particles = Particles::new(vec![section.turned()]).unwrap();
    let n = particles.len();
    Solid::new(Parts {
        body: vec![0; n],
        materials: vec![material],
        material: vec![0; n],
        plane: Plane::Axisymmetric,
        gravity: Vector::ZERO,
        damping,
        supports: held_on_axis(&particles).into_iter().collect(),
        loads: Vec::new(),
        contact: None,
        ramped: false,
        particles,
    })
}

fn rubber(section: Fill<2>) -> Solid<2> {
    let damping = Damping { stabilisation: 0.3, viscosity: 0.0, mass: 0.0, stiffness: 0.0 };
    body(section, Material::new(1000.0, RUBBER, Law::NeoHookean), damping)
}

fn noise(k: usize, size: f64) -> f64 {
    size * ((k * 37 % 101) as f64 / 101.0 - 0.5)
}

/// A displacement without a pattern that leaves the axis where it is.
fn shaken(solid: &Solid<2>, from: usize, size: f64) -> Vec<[f64; 2]> {
    let of = |i: usize, a: usize| if solid.is_held(i, a) { 0.0 } else { noise(2 * i + a + from, size) };
    (0..solid.len()).map(|i| [of(i, 0), of(i, 1)]).collect()
}

fn forces(solid: &Solid<2>, u: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let still = vec![[0.0; 2]; solid.len()];
    let state = State { time: 0.0, step: 0.0, displacement: u, velocity: &still, history: &[] };
    let (mut work, mut force) = (solid.work(), vec![[0.0; 2]; solid.len()]);
    solid.stress(&state, &mut work, &mut []);
    solid.forces(&state, &work, &mut force);
    force
}

#[test]
fn volumes_and_areas_are_those_of_a_whole_turn() {
    let tau = std::f64::consts::TAU;
    for (section, exact) in sections().into_iter().zip([0.5, 0.25, 1.2, 13.0 / 30.0]) {
        let solid = rubber(section);
        let whole = solid.particles.whole();
        assert!((whole / (tau * exact) - 1.0).abs() < 1e-12, "{whole}");
        assert!((solid.mass().iter().sum::<f64>() / (1000.0 * whole) - 1.0).abs() < 1e-12);
        assert!(solid.mass().iter().chain(&solid.particles.volume).all(|v| *v > 0.0));
        let area = solid.particles.area.iter().fold(Vector::ZERO, |sum: Vector<2>, a| sum + *a);
        // across the axis areas add up to those of the two halves of the section
        assert!(area[1].abs() < 1e-12);
    }
}

#[test]
fn particles_on_the_axis_hold_the_core_of_their_ring() {
    let solid = rubber(rows([0.0, 0.0], [1.0, 1.0], [9, 9], 0.0));
    let (h, particles) = (0.125f64, &solid.particles);
    for i in (0..solid.len()).filter(|i| particles.x[*i][0] == 0.0) {
        let y = particles.x[i][1];
        let height = if y > 0.0 && y < 1.0 { h } else { 0.5 * h };
        assert!((particles.volume[i] / (std::f64::consts::PI * 0.25 * h * h * height) - 1.0).abs() < 1e-12);
    }
}

/// The stress of F = [[1 + a, 0], [c, 1 + b]] with the hoop strain a is uniform: only its parts P₁₂ and P₁₁ − P₃₃ ask for a force inside.
#[test]
fn uniform_stress_has_the_forces_of_equilibrium_in_the_cylinder() {
    for ([a, b, c], section) in [[0.2, 0.0, 0.0], [0.0, -0.2, 0.0], [0.1, 0.2, 0.0], [0.1, 0.2, 0.3]]
        .into_iter()
        .flat_map(|f| sections().into_iter().map(move |s| (f, s)))
    {
        let solid = rubber(section);
        let u: Vec<[f64; 2]> = solid.particles.x.iter().map(|x| [a * x[0], b * x[1] + c * x[0]]).collect();
        let stress = neo_hookean(&RUBBER, &[[1.0 + a, 0.0, 0.0], [c, 1.0 + b, 0.0], [0.0, 0.0, 1.0 + a]]);
        let force = forces(&solid, &u);
        let largest = solid.particles.area.iter().fold(0.0f64, |m, a| m.max(a.norm()));
        for i in 0..solid.len() {
            let (area, turn) = (solid.particles.area[i], solid.particles.turn(i));
            let traction = |r: usize| (0..2).map(|s| stress[r][s] * area[s]).sum::<f64>();
            let inside = [turn * (stress[0][0] - stress[2][2]), turn * stress[1][0]];
            for r in (0..2).filter(|r| !solid.is_held(i, *r)) {
                let left = force[i][r] + traction(r) - inside[r];
                assert!(left.abs() < 1e-10 * largest, "{a} {b} {c}: {left} of {}", force[i][r]);
            }
        }
    }
}

#[test]
fn forces_are_the_derivative_of_the_energy_and_move_nothing_along_the_axis() {
    for section in sections() {
        let solid = rubber(section);
        let (u, w) = (shaken(&solid, 0, 0.02), shaken(&solid, 13, 1.0));
        let force = forces(&solid, &u);
        let power: f64 = force.iter().zip(&w).map(|(f, w)| f[0] * w[0] + f[1] * w[1]).sum();
        let still = vec![[0.0; 2]; solid.len()];
        let energy = |size: f64| {
            let at: Vec<[f64; 2]> = u.iter().zip(&w).map(|(u, w)| [u[0] + size * w[0], u[1] + size * w[1]]).collect();
            let state = State { time: 0.0, step: 0.0, displacement: &at, velocity: &still, history: &[] };
            let e = solid.energy(&state);
            e.strain + e.stabilisation
        };
        let slope = (energy(1e-5) - energy(-1e-5)) / 2e-5;
        let size: f64 = force.iter().zip(&w).map(|(f, w)| (f[0] * w[0]).abs() + (f[1] * w[1]).abs()).sum();
        assert!((power + slope).abs() < 1e-7 * size, "{power} {slope} {size}");
        let along: f64 = force.iter().map(|f| f[1]).sum();
        assert!(along.abs() < 1e-13 * force.iter().map(|f| f[1].abs()).sum::<f64>(), "{along}");
    }
}

#[test]
fn the_matrix_is_the_product_and_the_product_is_the_derivative_of_forces() {
    for section in sections() {
        let structure = Structure::new(rubber(section));
        let n = structure.displacements();
        let flat = |v: Vec<[f64; 2]>| v.into_iter().flatten().collect::<Vec<f64>>();
        let (u, w) = (flat(shaken(&structure.solid, 0, 0.02)), flat(shaken(&structure.solid, 13, 1.0)));
        let (still, mut work) = (vec![0.0; n], structure.work());
        fn at<'a>(displacement: &'a [f64], velocity: &'a [f64]) -> Moment<'a> {
            Moment { time: 0.0, step: 0.0, displacement, velocity, history: &[] }
        }
        let stiffness = structure.linearise(&at(&u, &still), [1.0, 0.0]);
        let (mut product, mut assembled, mut unit) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        structure.stiffness(&stiffness, &w, &mut work, &mut product);
        structure.matrix(&stiffness, 1.0, 0.0).product(&w, &mut assembled);
        let mut force = [vec![0.0; n], vec![0.0; n]];
        for (side, force) in [1e-6, -1e-6].into_iter().zip(&mut force) {
            let moved: Vec<f64> = u.iter().zip(&w).map(|(u, w)| u + side * w).collect();
            structure.forces(&at(&moved, &still), &mut work, force, &mut []);
        }
        let size = product.iter().fold(0.0f64, |m, p| m.max(p.abs()));
        for k in (0..n).filter(|k| !structure.is_held(*k)) {
            assert!((product[k] - assembled[k]).abs() < 1e-12 * size, "{k}: {} {}", product[k], assembled[k]);
            let slope = (force[1][k] - force[0][k]) / 2e-6;
            assert!((product[k] - slope).abs() < 1e-7 * size, "{k}: {} {slope}", product[k]);
        }
        let diagonal = structure.diagonal(&stiffness);
        for k in (0..n).step_by(7).filter(|k| !structure.is_held(*k)) {
            unit.fill(0.0);
            unit[k] = 1.0;
            structure.stiffness(&stiffness, &unit, &mut work, &mut product);
            assert!((diagonal[k] - product[k]).abs() < 1e-12 * size, "{k}: {} {}", diagonal[k], product[k]);
        }
    }
}

// Love (1892), Mathematical theory of elasticity, section 293: a thin ring breathes at √(E/ρ)/R
#[test]
fn a_thin_ring_breathes_as_it_should() {
    let material = Material::new(2.0, Moduli::of_young(8.0, 0.3), Law::Linear);
    let damping = Damping { stabilisation: 0.3, viscosity: 0.0, mass: 0.0, stiffness: 0.0 };
    let structure = Structure::new(body(rows([0.99, -0.01], [1.01, 0.01], [5, 5], 0.0), material, damping));
    let found = modes(&structure, &structure.start(|_| [0.0; 2]), &ModeRequest { count: 3, above: 0.0 }).unwrap();
    assert_eq!(found[0].omega, 0.0);
    // the first is the motion along the axis; a section 0.02 wide turns and breathes at next to the same frequency
    let nearest = found.iter().map(|m| (m.omega / 2.0 - 1.0).abs()).fold(1.0, f64::min);
    assert!(nearest < 1e-4, "{nearest}");
}
