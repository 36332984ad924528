//! Bodies made of particles in a gas: uniform flow, exchange, resumed marches, bodies that are led.
use std::sync::Arc;

use crate::common::{direction, product_errors, solver};
use alula::case;
use alula::coupling::solids::{OnCloud, Scales, SolidBody, Solids};
use alula::coupling::{Coupled, March};
use alula::math::Vector;
use alula::motion::{BodyMotion, SurfaceNet};
use alula::physics::solid::{Law, Material, Moduli};
use alula::run::{Session, Silent};
use alula::scheme::{CloudMotion, HasGas};
use alula::solid::fill::Lattice;
use alula::solid::particles::Particles;
use alula::solid::{Damping, Parts, Plane, Solid, Structure};
use alula::system::{Instant, Name, System, Term};
use alula::time::explicit::{Method, Plan};
use alula::time::{Integrator, Memory, Past, Standing};

/// A tube with a body that nothing holds between two columns of gas, which flows at the speed `speed` as the body does.
fn tube(speed: &str, time: &str) -> String {
    format!(
        "title = \"tube\"\ndimension = 2\n[flow]\nmach = 1.0\n[[body]]\nname = \"piston\"\nbox = {{ size = [0.25, 0.4] }}\n\
         [body.solid]\nspacing = 0.03\nvelocity = [\"{speed}\", \"0\"]\nprobe = [{{ name = \"face\", at = [0.125, 0.0] }}]\n\
         material = {{ density = 4.0, young = 40.0, poisson = 0.3 }}\n[reference]\nchord = 0.12\n[cloud]\nspacing = 0.02\n\
         domain = {{ min = [-0.6, -0.06], max = [0.6, 0.06] }}\n[[cloud.box]]\nmin = [-0.6, -0.06]\nmax = [0.6, 0.06]\nspacing = 0.02\n\
         [boundary]\nx_min = \"held\"\nx_max = \"held\"\ny_min = \"symmetry\"\ny_max = \"symmetry\"\n[initial.riemann]\n\
         left = [1.0, {speed}, 0.7142857142857143]\nright = [1.0, {speed}, 0.7142857142857143]\nposition = 10.0\n{time}\n"
    )
}

/// Greatest difference of the pressure from that at the start.
fn disturbed(text: &str) -> f64 {
    let case = case::read(text, "tube").unwrap_or_else(|e| panic!("{e}"));
    let mut session = Session::open(&case, ".").unwrap_or_else(|e| panic!("{e}"));
    session.solve(&mut Silent).unwrap_or_else(|e| panic!("{e}"));
    let pressure = session.field().unwrap().column("pressure").unwrap();
    pressure.iter().fold(0.0, |m: f64, p| m.max((p - 1.0 / 1.4).abs()))
}

#[test]
fn a_body_of_particles_that_drifts_with_a_uniform_gas_leaves_it_uniform() {
    // implicit steps are solved to eight orders
    let implicit = "[time.dual]\nstep = 0.02\nuntil = 0.1\norders = 8.0";
    for (time, bound) in [("[time.explicit]\nuntil = 0.1", 1e-12), (implicit, 1e-9)] {
        let found = disturbed(&tube("0.3", time));
        assert!(found < bound, "{time}: {found:.1e}");
    }
}

/// The body of that tube by hand.
fn piston() -> Solids<2> {
    let at = |k: usize| Vector([if k & 1 == 0 { -0.125 } else { 0.125 }, if k & 2 == 0 { -0.06 } else { 0.06 }]);
    let fill = Lattice { jitter: 0.0, ..Lattice::with_spacing((0..4).map(at).collect(), 0.03) }.fill();
    let particles = Particles::new(vec![fill]).unwrap();
    let n = particles.len();
    let nodes = particles.area.iter().take_while(|a| **a != Vector::ZERO).count();
    let area: Vec<Vector<2>> = particles.area[..nodes].to_vec();
    let net = Arc::new(SurfaceNet::new(0, particles.x[..nodes].to_vec(), &area, 0.03));
    let moduli = Moduli::of_young(40.0, 0.3);
    let solid = Solid::new(Parts {
        body: vec![0; n],
        materials: vec![Material::new(4.0, moduli, Law::NeoHookean)],
        material: vec![0; n],
        plane: Plane::Strain,
        gravity: Vector::ZERO,
        damping: Damping { stabilisation: 0.3, viscosity: 0.1, mass: 0.0, stiffness: 0.0 },
        supports: Vec::new(),
        loads: Vec::new(),
        contact: None,
        ramped: false,
        particles,
    });
    let body = SolidBody { body: 0, particles: 0..n, net, lead: None, probes: Vec::new() };
    let scales = Scales { speed: 1.0, pressure: 1.0 };
    Solids::new(Structure::new(solid), vec![body], scales, 0).with_velocity(&vec![[0.2, 0.0]; n])
}

/// The gas of that tube around the body by hand, and the state at the start.
fn piston_in_tube() -> (Coupled<2>, Vec<f64>) {
    // the gas around a rigid body
    let text = tube("0.0", "[time.explicit]\nuntil = 0.1");
    let of_solid =
        |l: &&str| ["[body.solid]", "spacing = 0.03", "velocity", "probe", "material"].iter().any(|k| l.starts_with(k));
    let text = text.lines().filter(|l| !of_solid(l)).collect::<Vec<_>>().join("\n");
    let (mut fluid, gas) = solver::<2>(&text);
    let solids = Arc::new(piston());
    let net = Arc::clone(&solids.bodies[0].net);
    fluid.cloud_motion =
        CloudMotion::deforming(&fluid.discretisation.cloud, vec![BodyMotion::fixed().with_net(net)], 0.1);
    let on = OnCloud::new(Arc::clone(&solids), &fluid);
    let system = Coupled::new(fluid, Vec::new()).with_solids(on);
    let begin = system.start_with(&gas);
    (system, begin)
}

#[test]
fn products_with_a_body_of_particles_are_those_of_the_residual() {
    let (system, mut u) = piston_in_tube();
    let own = system.unknowns_of(Name::Solid);
    u[own].iter_mut().enumerate().for_each(|(k, u)| *u += 1e-3 * (0.7 * k as f64).sin());
    let old = system.placing().values(&u).iter().map(|q| 0.99 * q).collect::<Vec<_>>();
    let place = |q: &[f64], frame: &mut _| {
        let terms = [(20.0, 0.05, q), (-20.0, 0.0, &old[..])];
        let terms = terms.map(|(coefficient, time, coordinates)| Term { coefficient, time, coordinates });
        system.place(&Instant::formula(0.05, &terms).with(q), frame);
    };
    let mut v = direction(&u);
    v[system.unknowns_of(Name::Solid)].iter_mut().for_each(|v| *v *= 1e-2);
    for (name, found) in product_errors(&system, [&u, &v], &place) {
        println!("{name:?} {found:.1e}");
        assert!(found < 1e-6, "{name:?} {found:.1e}");
    }
}

#[test]
fn impulse_and_work_pass_to_round_off_and_a_march_goes_on_to_the_same_bits() {
    let (system, begin) = piston_in_tube();
    let solids = Arc::clone(&system.solids().unwrap().solids);
    let plan = Plan { method: Method::Ssprk3, cfl: 0.5, until: 0.1 };
    let mut march = March::new(&system, system.solids().unwrap(), plan, Past::default(), begin);
    let momentum = |u: &[f64]| {
        let own = &u[system.unknowns_of(Name::Solid)];
        let mass = solids.structure.solid.mass();
        own.chunks_exact(4).zip(mass).map(|(row, m)| m * row[1]).sum::<f64>()
    };
    let mut saved = None;
    for k in 0..12 {
        let before = momentum(march.standing().state);
        let step = march.advance().unwrap();
        let dt = march.mark().last;
        let Standing { frame, work, state, .. } = march.standing();
        let exchange = system.exchange(frame, state, work).unwrap();
        let force: f64 = frame.gas.taken.iter().map(|t| t.force[0]).sum();
        let gained = momentum(state) - before;
        assert!((gained - force * dt).abs() < 1e-14, "step {}: {gained} {}", step.iteration, force * dt);
        assert!((exchange.power - exchange.wall_power).abs() < 1e-14 * exchange.power.abs().max(1.0));
        if k == 5 {
            let Memory::March(past) = march.memory() else { panic!("a march remembers") };
            saved = Some((past, march.standing().state.to_vec()));
        }
    }
    let (past, u) = saved.unwrap();
    let mut again = March::new(&system, system.solids().unwrap(), plan, past, u);
    for _ in 0..6 {
        again.advance().unwrap();
    }
    assert_eq!(again.standing().state, march.standing().state);
}

#[test]
fn a_body_without_supports_follows_its_motion_and_its_particles_have_the_velocity_of_the_harmonics() {
    let text = "title = \"led\"\n[flow]\nmach = 0.3\n[[body]]\nellipse = { size = [1.0, 0.2] }\n[body.solid]\nspacing = 0.03\n\
                material = { density = 100.0, young = 1e4, poisson = 0.3 }\nprobe = [{ name = \"tail\", at = [0.5, 0.0] }]\n\
                [motion]\npivot = [-0.25, 0.0]\npitch = \"3 deg\"\nreduced_frequency = 0.2\n[cloud]\nspacing = 0.08\nfar_field = 6.0\n[time.harmonics]\nnumber = 1\n";
    let case = case::read(text, "led").unwrap_or_else(|e| panic!("{e}"));
    let mut session = Session::open(&case, ".").unwrap_or_else(|e| panic!("{e}"));
    session.solve(&mut Silent).unwrap_or_else(|e| panic!("{e}"));
    let structure = &session.summary().unwrap().structures.structure[0];
    let tail = structure.coordinates.iter().find(|c| c.name == "tail_y").unwrap();
    // about the quarter chord, 0.75 from the tail
    let exact = 0.75 * 3f64.to_radians().sin();
    assert!((tail.amplitude.unwrap() / exact - 1.0).abs() < 0.02, "{tail:?} {exact}");
    assert!(structure.lost_power < 1e-11, "{}", structure.lost_power);
}

/// A slab clamped at its back that a shock hits, of a material and with a way of marching: how far its face has gone.
fn slab(material: &str, time: &str) -> f64 {
    let text = format!(
        "title = \"slab\"\ndimension = 2\n[flow]\nmach = 1.0\n[[body]]\nname = \"slab\"\nbox = {{ size = [0.3, 0.4] }}\ntranslate = [0.15, 0.0]\n\
         [body.solid]\nspacing = 0.015\nmaterial = {{ density = 4.0, young = 400.0, poisson = 0.3, {material} }}\n\
         probe = [{{ name = \"face\", at = [0.0, 0.0] }}]\n[[body.solid.support]]\nwhere = {{ x_min = 0.29999 }}\n[reference]\nchord = 0.06\n\
         [cloud]\nspacing = 0.015\ndomain = {{ min = [-0.9, -0.03], max = [0.3, 0.03] }}\n[[cloud.box]]\nmin = [-0.9, -0.03]\nmax = [0.3, 0.03]\n\
         spacing = 0.015\n[boundary]\nx_min = \"held\"\nx_max = \"symmetry\"\ny_min = \"symmetry\"\ny_max = \"symmetry\"\n[initial.riemann]\n\
         left = [2.818181818181819, 1.3576884666042615, 3.5714285714285716]\nright = [1.0, 0.0, 0.7142857142857143]\nposition = -0.1\n{time}\n"
    );
    let case = case::read(&text, "slab").unwrap_or_else(|e| panic!("{e}"));
    let mut session = Session::open(&case, ".").unwrap_or_else(|e| panic!("{e}"));
    session.solve(&mut Silent).unwrap_or_else(|e| panic!("{e}"));
    let structure = &session.summary().unwrap().structures.structure[0];
    structure.coordinates.iter().find(|c| c.name == "face_x").unwrap().largest
}

#[test]
fn materials_that_remember_march_in_implicit_steps_as_in_explicit_ones() {
    let (explicit, implicit) = ("[time.explicit]\nuntil = 0.2", "[time.dual]\nstep = 0.002\nuntil = 0.2");
    let elastic = slab("law = \"neo_hookean\"", explicit);
    for (material, more) in [("yield = 4.0, hardening = 40.0", 1.05), ("relaxation = [[0.5, 0.02]]", 1.05)] {
        let [a, b] = [explicit, implicit].map(|time| slab(material, time));
        assert!((a / b - 1.0).abs() < 0.04, "{material}: {a} {b}");
        // it gives way
        assert!(a > more * elastic, "{material}: {a}, elastic {elastic}");
    }
}

#[test]
fn a_block_that_drifts_against_a_stop_comes_back() {
    let text = tube("0.2", "[time.explicit]\nuntil = 1.0")
        .replace("[initial.riemann]\nleft = [1.0, 0.2, 0.7142857142857143]\nright = [1.0, 0.2, 0.7142857142857143]\nposition = 10.0\n", "")
        .replace("x_min = \"held\"\nx_max = \"held\"", "x_min = \"symmetry\"\nx_max = \"symmetry\"")
        .replace("density = 4.0, young = 40.0", "density = 400.0, young = 4000.0")
        .replace("[reference]", "[contact]\nplanes = [{ point = [0.175, 0.0], normal = [-1.0, 0.0] }]\n[reference]");
    let case = case::read(&text, "stop").unwrap_or_else(|e| panic!("{e}"));
    let mut session = Session::open(&case, ".").unwrap_or_else(|e| panic!("{e}"));
    session.solve(&mut Silent).unwrap_or_else(|e| panic!("{e}"));
    let structure = &session.summary().unwrap().structures.structure[0];
    let face = structure.coordinates.iter().find(|c| c.name == "face_x").unwrap();
    // its face is 0.05 before the stop at first; nothing before it, it would drift by 0.2
    assert!((0.05..0.1).contains(&face.largest), "{face:?}");
    assert!(structure.lost_power < 1e-12, "{}", structure.lost_power);
}
