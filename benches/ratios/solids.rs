//! Bodies of particles: their set-up beside their march, and steps with them beside steps of the gas alone.
use alula::physics::solid::Law;
use alula::run::{Session, Silent};
use alula::solid::Particles;
use alula::time::Integrator;

use super::{once, parsed, seconds, tell};
use crate::solids::{particles, structure, thrown};

/// Steps of a structure that its set-up is held against.
const STEPS: f64 = 100.0;

/// Consistent gradients of a plate and a cube over so many steps of their march.
pub(super) fn solid_setup() {
    tell("set-up of a plane structure, over 100 of its steps", setup::<2>(48), "bar 1");
    tell("set-up of a structure in space, over 100 of its steps", setup::<3>(24), "bar 1");
}

fn setup<const D: usize>(side: usize) -> f64 {
    let mut found = None;
    let setup = once(|| found = Some(particles::<D>(side)));
    let Some(particles): Option<Particles<D>> = found else { return f64::NAN };
    let structure = structure(particles, Law::NeoHookean);
    let mut march = thrown(&structure);
    setup / (STEPS * seconds(|| drop(march.advance())))
}

/// An aerofoil that pitches, its cloud deforming: rigid, or of particles that are led alike.
fn pitching(solid: &str, time: &str) -> String {
    format!(
        "title = \"bench\"\n[flow]\nmach = 0.5\n[motion]\nparticles = \"deforming\"\npivot = [0.25, 0.0]\npitch = \"1 deg\"\n\
         reduced_frequency = 0.5\n[[body]]\nname = \"naca0012\"\nnaca = \"0012\"\n{solid}\n[cloud]\nspacing = 0.015625\n{time}\n"
    )
}

/// Aluminium in air at sea level, in units of the gas.
const SOLID: &str = "[body.solid]\nspacing = 0.01\nmaterial = { density = 2204.0, young = 4.93e5, poisson = 0.33 }";

/// A step of gas and structure over one of the gas alone around the same motion.
pub(super) fn solid_in_gas() {
    for (what, time) in
        [("implicit", "[time.dual]\nstep = 0.1\nuntil = 1.0"), ("explicit", "[time.explicit]\nuntil = 0.1")]
    {
        let [gas, both] = ["", SOLID].map(|solid| step(&pitching(solid, time)));
        tell(&format!("{what} step with a body of particles, over one of the gas alone"), both / gas, "bar 1.15");
    }
}

/// Time of a step of a march.
fn step(text: &str) -> f64 {
    let least = |_| {
        let mut session = Session::open(&parsed(text), ".").unwrap();
        let spent = once(|| drop(session.solve(&mut Silent)));
        spent / session.summary().unwrap().convergence.iterations as f64
    };
    (0..3).map(least).fold(f64::INFINITY, f64::min)
}
