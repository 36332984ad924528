//! Structures of particles against exact solutions and invariants.
use super::body::{Action, Contact, Damping, Load, Parts, Plane, RigidPlane, Solid, Support};
use super::fill::{Lattice, relaxed};
use super::forces::State;
use super::modes::{ModeRequest, modes};
use super::particles::{Facet, Particles};
use super::system::Structure;
use crate::math::Vector;
use crate::physics::solid::{Law, Material, Moduli, Plasticity};
use crate::system::{Mechanical, Moment};
use crate::time::structural::{self, Equilibrium, GeneralisedAlpha, LoadPlan, Newton};
use crate::time::symplectic::{self, Symplectic};
use crate::time::{Integrator, Memory, Past};

const QUIET: Damping = Damping { stabilisation: 0.3, viscosity: 0.0, mass: 0.0, stiffness: 0.0 };

pub(super) fn parts<const D: usize>(
    lattice: &Lattice<D>,
    material: Material,
    held: impl Fn(&Vector<D>) -> bool,
) -> Parts<D> {
    let particles = Particles::new(vec![lattice.fill()]).unwrap();
    let n = particles.len();
    let at_rest = (0..n as u32).filter(|i| held(&particles.x[*i as usize])).collect();
    Parts {
        body: vec![0; n],
        materials: vec![material],
        material: vec![0; n],
        plane: Plane::Strain,
        gravity: Vector::ZERO,
        damping: QUIET,
        supports: vec![Support { particles: at_rest, fixed: [true; D], motion: None }],
        loads: Vec::new(),
        contact: None,
        ramped: false,
        particles,
    }
}

fn solid<const D: usize>(lattice: &Lattice<D>, material: Material, held: impl Fn(&Vector<D>) -> bool) -> Solid<D> {
    Solid::new(parts(lattice, material, held))
}

pub(super) fn rubber() -> Material {
    Material::new(1000.0, Moduli { shear: 1.0, bulk: 2.0 }, Law::NeoHookean)
}

pub(super) fn lattice<const D: usize>(size: [f64; D], counts: [usize; D], jitter: f64) -> Lattice<D> {
    let corners = (0..1 << D).map(|k| Vector::from_fn(|d| if k >> d & 1 == 1 { size[d] } else { 0.0 })).collect();
    Lattice { corners, counts, jitter }
}

/// Uniform deformation has no force inside, and the traction of its stress outside, on any cloud.
fn patch<const D: usize>(lattice: &Lattice<D>) {
    let solid = solid(lattice, rubber(), |_| false);
    assert!(solid.particles.iterations < 300, "{}", solid.particles.iterations);
    let n = solid.len();
    let f: [[f64; D]; D] =
        std::array::from_fn(|a| std::array::from_fn(|b| if a == b { 0.2 } else { 0.1 * (a as f64 - 0.7 * b as f64) }));
    let u: Vec<[f64; D]> =
        solid.particles.x.iter().map(|x| std::array::from_fn(|a| (0..D).map(|b| f[a][b] * x[b]).sum())).collect();
    let still = vec![[0.0; D]; n];
    let state = State { time: 0.0, step: 0.0, displacement: &u, velocity: &still, history: &[] };
    let mut work = solid.work();
    let mut force = vec![[0.0; D]; n];
    solid.stress(&state, &mut work, &mut []);
    solid.forces(&state, &work, &mut force);
    let whole = solid.deformation(0, &u);
    let stress = crate::physics::solid::neo_hookean(&rubber().moduli, &whole);
    let size = solid.particles.spacing[0].powi(D as i32 - 1);
    for i in 0..n {
        for a in 0..D {
            let traction: f64 = (0..D).map(|b| stress[a][b] * solid.particles.area[i][b]).sum();
            assert!((force[i][a] + traction).abs() < 1e-10 * size, "{i} {a}: {} {traction}", force[i][a]);
        }
    }
}

#[test]
fn uniform_deformation_has_no_force_inside_on_any_cloud() {
    patch(&lattice([1.0, 1.0], [9, 9], 0.0));
    patch(&lattice([1.0, 1.0], [17, 17], 0.2));
    patch(&lattice([1.0, 1.0, 1.0], [8, 8, 8], 0.0));
    patch(&lattice([1.0, 1.0, 1.0], [9, 9, 9], 0.2));
}

#[test]
fn the_matrix_is_the_product_and_the_product_is_the_derivative_of_forces() {
    let structure = Structure::new(solid(&lattice([1.0, 0.5], [9, 5], 0.2), rubber(), |_| false));
    let n = structure.displacements();
    let noise = |k: usize, s: f64| s * ((k * 37 % 101) as f64 / 101.0 - 0.5);
    let mut u: Vec<f64> = (0..n).map(|k| noise(k, 0.02)).collect();
    let w: Vec<f64> = (0..n).map(|k| noise(k + 13, 1.0)).collect();
    let still = vec![0.0; n];
    let mut work = crate::system::System::work(&structure);
    let stiffness = structure
        .linearise(&Moment { time: 0.0, step: 0.0, displacement: &u, velocity: &still, history: &[] }, [1.0, 0.0]);
    let (mut product, mut assembled) = (vec![0.0; n], vec![0.0; n]);
    structure.stiffness(&stiffness, &w, &mut work, &mut product);
    structure.matrix(&stiffness, 1.0, 0.0).product(&w, &mut assembled);
    let mut forces = [vec![0.0; n], vec![0.0; n]];
    for (side, force) in [1.0, -1.0].into_iter().zip(&mut forces) {
        u.iter_mut().zip(&w).for_each(|(u, w)| *u += side * 1e-6 * w);
        structure.forces(
            &Moment { time: 0.0, step: 0.0, displacement: &u, velocity: &still, history: &[] },
            &mut work,
            force,
            &mut [],
        );
        u.iter_mut().zip(&w).for_each(|(u, w)| *u -= side * 1e-6 * w);
    }
    for k in 0..n {
        assert!((product[k] - assembled[k]).abs() < 1e-11, "{} {}", product[k], assembled[k]);
        let slope = (forces[1][k] - forces[0][k]) / 2e-6;
        assert!((product[k] - slope).abs() < 1e-7, "{} {slope}", product[k]);
    }
}

// a plate of 0.2 m by 0.02 m in plane strain, clamped at one end: quadratic elements, 160 by 16, have these frequencies to
// 0.01 %; the thin plate of Landau and Lifshitz (Theory of elasticity, 1986, section 25) has 24.726 for the first
#[test]
fn frequencies_of_a_cantilever_are_those_of_plane_elasticity() {
    for (through, jitter, bar) in
        [(5, 0.0, 1.5), (5, 0.2, 1.5), (9, 0.0, 0.5), (9, 0.2, 0.5), (17, 0.0, 0.2), (17, 0.2, 0.2)]
    {
        let structure = cantilever(through, jitter);
        let start = structure.start(|_| [0.0; 2]);
        let found = modes(&structure, &start, &ModeRequest { count: 3, above: 0.0 }).unwrap();
        for (mode, exact) in found.iter().zip([24.6149, 146.467, 382.05]) {
            let error = 100.0 * (mode.omega / exact - 1.0);
            assert!(error.abs() < bar, "{through} {jitter}: {error} %");
            assert!(mode.left < 1e-5, "{}", mode.left);
        }
    }
}

pub(super) fn cantilever(through: usize, jitter: f64) -> Structure<2> {
    let material =
        Material::new(1000.0, Moduli::of_young(3.0 * 3.25e6 * (1.0 - 2.0 * 0.3975), 0.3975), Law::NeoHookean);
    let lattice = lattice([0.2, 0.02], [10 * (through - 1) + 1, through], jitter);
    Structure::new(solid(&lattice, material, |x| x[0] < 1e-9))
}

#[test]
fn a_free_body_has_all_its_rigid_motions() {
    let structure = Structure::new(solid(&lattice([1.0, 0.5, 0.3], [7, 5, 4], 0.1), rubber(), |_| false));
    let start = structure.start(|_| [0.0; 3]);
    let found = modes(&structure, &start, &ModeRequest { count: 8, above: 0.0 }).unwrap();
    assert!(found[..6].iter().all(|m| m.omega == 0.0) && found[6].omega > 0.0);
}

fn settled<const D: usize>(structure: &Structure<D>) -> Vec<f64> {
    let plan = LoadPlan { steps: 1, newton: Newton { tolerance: 1e-9, iterations: 20 } };
    let mut way = Equilibrium::new(structure, plan, Past::default(), structure.start(|_| [0.0; D]));
    while !way.finished() {
        way.advance().unwrap();
    }
    way.standing().state.to_vec()
}

// Cook's membrane, 33 by 33 particles; the middle of the right side by quadratic elements, 32 by 32: 23.961 in plane stress with
// Poisson's ratio 1/3, 18.378 in plane strain with 0.4999
#[test]
fn cooks_membrane_bends_as_it_should_and_does_not_lock() {
    for (plane, poisson, exact, bar) in [(Plane::Stress, 1.0 / 3.0, 23.961, 0.5), (Plane::Strain, 0.4999, 18.378, 1.0)]
    {
        let corners = [[0.0, 0.0], [48.0, 44.0], [0.0, 44.0], [48.0, 60.0]].map(Vector).to_vec();
        let lattice = Lattice { corners, counts: [33, 33], jitter: 0.0 };
        let material = Material::new(1.0, Moduli::of_young(1.0, poisson), Law::Linear);
        let mut body = parts(&lattice, material, |x| x[0] < 1e-9);
        let x = body.particles.x.clone();
        let mut shares = vec![Vector::ZERO; x.len()];
        let right = |f: &&Facet<2>| f.corners().iter().all(|i| x[*i as usize][0] > 48.0 - 1e-9);
        for f in body.particles.facets.iter().filter(right) {
            f.shares().for_each(|(i, area)| shares[i] += area);
        }
        let areas = (0..).zip(shares).filter(|(_, a)| a.norm() > 0.0).collect();
        let action = Action::Traction(Vector([0.0, 1.0 / 16.0]));
        body.loads.push(Load { areas, action, history: Box::new(|t| t) });
        body.plane = plane;
        let structure = Structure::new(Solid::new(body));
        let u = settled(&structure);
        let middle = x.iter().position(|x| (*x - Vector([48.0, 52.0])).norm() < 1e-9).unwrap();
        let error = 100.0 * (u[2 * middle + 1] / exact - 1.0);
        assert!(error.abs() < bar, "{plane:?}: {error} %");
    }
}

/// Energy of a structure where a march stands.
fn energy<const D: usize>(structure: &Structure<D>, march: &mut dyn Integrator<Structure<D>>) -> f64 {
    let time = march.mark().time;
    let e = structure.solid.energy(&structure.state(time, march.standing().state));
    e.kinetic + e.strain + e.stabilisation + e.contact
}

#[test]
fn a_cantilever_swings_at_its_frequency_and_keeps_its_energy() {
    let structure = cantilever(5, 0.0);
    let n = structure.displacements();
    let rest = structure.start(|_| [0.0; 2]);
    let mode = modes(&structure, &rest, &ModeRequest { count: 1, above: 0.0 }).unwrap().remove(0);
    let period = std::f64::consts::TAU / mode.omega;
    let mut u = rest;
    (0..n).for_each(|k| u[n + k] = 0.001 * mode.omega * mode.shape[k]);
    // ten periods and a quarter: the tip is at its end
    let until = 10.25 * period;
    let newton = Newton { tolerance: 1e-9, iterations: 20 };
    let implicit = structural::Plan { step: period / 200.0, until, radius: 1.0, newton };
    let explicit = symplectic::Plan { cfl: 0.8, until };
    let marches: [Box<dyn Integrator<Structure<2>>>; 2] = [
        Box::new(Symplectic::new(&structure, explicit, Past::default(), u.clone())),
        Box::new(GeneralisedAlpha::new(&structure, implicit, Past::default(), u)),
    ];
    for mut march in marches {
        let begin = energy(&structure, march.as_mut());
        let tip = mode.shape.iter().position(|x| x.abs() == 1.0).unwrap();
        let mut largest = 0.0f64;
        while !march.finished() {
            march.advance().unwrap();
            if march.mark().time > 9.9 * period {
                largest = largest.max(march.standing().state[tip].abs());
            }
        }
        assert!((energy(&structure, march.as_mut()) / begin - 1.0).abs() < 1e-5);
        assert!((largest / 0.001 - 1.0).abs() < 2e-3, "{largest}");
    }
}

#[test]
fn a_spun_plate_keeps_its_momenta_over_twenty_turns() {
    let material = Material::new(1.0, Moduli { shear: 1.0, bulk: 2.0 }, Law::NeoHookean);
    let structure = Structure::new(solid(&lattice([1.0, 0.2], [11, 3], 0.2), material, |_| false));
    let (spin, x) = (0.4, structure.solid.particles.x.clone());
    let u = structure.start(|i| [0.1 - spin * (x[i][1] - 0.1), spin * (x[i][0] - 0.5)]);
    let until = 20.0 * std::f64::consts::TAU / spin;
    let mut march = Symplectic::new(&structure, symplectic::Plan { cfl: 0.8, until }, Past::default(), u);
    let n = structure.displacements();
    let momenta = |u: &[f64]| {
        (0..x.len()).fold([0.0; 3], |[a, b, c], i| {
            let (m, v) = (structure.solid.mass()[i], [u[n + 2 * i], u[n + 2 * i + 1]]);
            let at = [x[i][0] + u[2 * i], x[i][1] + u[2 * i + 1]];
            [a + m * v[0], b + m * v[1], c + m * (at[0] * v[1] - at[1] * v[0])]
        })
    };
    let (before, start) = (momenta(march.standing().state), energy(&structure, &mut march));
    while !march.finished() {
        march.advance().unwrap();
    }
    let after = momenta(march.standing().state);
    assert!((0..3).all(|k| (after[k] - before[k]).abs() < 1e-12), "{before:?} {after:?}");
    assert!((energy(&structure, &mut march) / start - 1.0).abs() < 1e-3);
}

#[test]
fn a_block_bounces_off_a_rigid_plane_with_what_it_brought() {
    let material = Material::new(1.0, Moduli { shear: 1.0, bulk: 2.0 }, Law::NeoHookean);
    let mut body = parts(&lattice([1.0, 0.5], [11, 6], 0.0), material, |_| false);
    let plane = RigidPlane { point: Vector([-0.05, 0.0]), normal: Vector([1.0, 0.0]) };
    body.contact = Some(Contact { planes: vec![plane], bodies: false, stiffness: 0.5, friction: 0.0 });
    let structure = Structure::new(Solid::new(body));
    let u = structure.start(|_| [-0.05, 0.0]);
    let mut march = Symplectic::new(&structure, symplectic::Plan { cfl: 0.5, until: 4.0 }, Past::default(), u);
    let begin = energy(&structure, &mut march);
    while !march.finished() {
        march.advance().unwrap();
    }
    assert!((energy(&structure, &mut march) / begin - 1.0).abs() < 5e-3);
    let n = structure.displacements();
    let away: f64 =
        march.standing().state[n..2 * n].iter().step_by(2).zip(structure.solid.mass()).map(|(v, m)| v * m).sum();
    assert!(away > 0.5 * 0.05 * 0.5, "{away}");
}

#[test]
fn a_resumed_march_goes_on_to_the_same_bits() {
    let material = Material::new(1.0, Moduli { shear: 1.0, bulk: 2.0 }, Law::Plastic(Plasticity::linear(0.02, 0.1)));
    let body = || {
        let mut body = parts(&lattice([1.0, 0.5], [9, 5], 0.1), material, |x| x[0] < 1e-9);
        body.damping.viscosity = 0.1;
        Structure::new(Solid::new(body))
    };
    let structure = body();
    let start = structure.start(|_| [0.1, 0.05]);
    let plan = symplectic::Plan { cfl: 0.8, until: 2.0 };
    let mut whole = Symplectic::new(&structure, plan, Past::default(), start);
    for _ in 0..7 {
        whole.advance().unwrap();
    }
    let Memory::March(past) = whole.memory() else { panic!("a march remembers a march") };
    let again = body();
    let mut resumed = Symplectic::new(&again, plan, past, whole.standing().state.to_vec());
    while !whole.finished() {
        whole.advance().unwrap();
        resumed.advance().unwrap();
    }
    let bits = |u: &[f64]| u.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(whole.standing().state), bits(resumed.standing().state));
    let lost = structure.solid.energy(&structure.state(2.0, whole.standing().state)).dissipated;
    assert!(lost > 0.0);
}

#[test]
fn what_has_yielded_is_damped_less_by_the_root_of_what_is_left_of_its_stiffness() {
    let (yields, strained) = (0.02, 0.5);
    let law = Law::Plastic(Plasticity::linear(yields, 0.1));
    let material = Material::new(1.0, Moduli { shear: 1.0, bulk: 2.0 }, law);
    let mut body = parts(&lattice([1.0, 0.5], [9, 5], 0.1), material, |_| false);
    body.damping.viscosity = 0.1;
    let solid = Solid::new(body);
    let (n, virgin) = (solid.len(), solid.virgin());
    let width = virgin.len() / n;
    let with = |k: usize| [&virgin[..k], &[strained], &virgin[k + 1..]].concat();
    let at = (0..width).find(|k| material.plastic_strain(&with(*k)) == strained).expect("a plastic strain");
    let mut flowed = virgin.clone();
    flowed.iter_mut().skip(at).step_by(width).for_each(|strain| *strain = strained);
    let still = vec![[0.0; 2]; n];
    let zigzag: Vec<[f64; 2]> = (0..n).map(|i| [(i * 5 % 7) as f64, (i * 3 % 11) as f64]).collect();
    let powers = |history: &[f64]| {
        let state = State { time: 0.0, step: 0.0, displacement: &still, velocity: &zigzag, history };
        let (mut work, mut after, mut force) = (solid.work(), history.to_vec(), still.clone());
        solid.stress(&state, &mut work, &mut after);
        solid.forces(&state, &work, &mut force);
        let given: f64 = force.iter().flatten().zip(zigzag.iter().flatten()).map(|(f, v)| f * v).sum();
        (-given, solid.damped(&state))
    };
    let (at_first, then) = (powers(&virgin), powers(&flowed));
    let soft: f64 = yields / (yields + 3.0 * strained) + 0.002 / QUIET.stabilisation;
    assert!((then.1 / at_first.1 / soft.sqrt() - 1.0).abs() < 1e-12, "{then:?} {at_first:?}");
    [at_first, then].iter().for_each(|(given, taken)| assert!((given / taken - 1.0).abs() < 1e-10, "{given} {taken}"));
}

#[test]
fn a_cylinder_and_a_disc_are_filled_and_carry_uniform_stress() {
    let case = "title = \"t\"\n[[body]]\nrevolution = [[0, 0], [0, 0.4], [2, 0.4], [2, 0]]\n";
    let case = crate::case::read(&format!("{case}[flow]\nmach = 0.3\n"), "case").unwrap();
    let (surface, _) = crate::geometry::load_surface::<3>(&case.bodies, std::path::Path::new("")).unwrap();
    let fill = relaxed(&surface, 0.1);
    let particles = Particles::new(vec![fill]).unwrap();
    assert!((particles.whole() / surface.volume() - 1.0).abs() < 0.02);
    assert!(
        particles.correction < 0.5 && particles.iterations < 1000,
        "{} {}",
        particles.correction,
        particles.iterations
    );
}
