//! A body on springs beside the same body on a prescribed motion.
use std::path::Path;

use alula::coupling::{Attached, Coupled, body_motion};
use alula::scheme::{CloudMotion, Fluid};
use alula::structure::{Coordinate, InertiaLaw, Model, PlanarBody, Spring, Structure};
use alula::system::{Implicit, Name, System};
use alula::time::control::Control;
use alula::time::dual::{Dual, Plan};
use alula::time::relax::Relax;
use alula::time::{Integrator, Past};

use super::{built, once, parsed, tell};

/// NACA 0012 in a subsonic stream; `motion` swings it.
fn case(motion: &str) -> String {
    format!(
        "title = \"bench\"\n[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n{motion}\n[cloud]\nspacing = 0.015625\n\
         [time.dual]\nstep = 1.0\nuntil = 1.0\n"
    )
}

/// Pitch of a degree and plunge of a hundredth of the chord about the axis at 0.3.
const MOTION: &str = "[motion]\nparticles = \"rigid\"\npivot = [0.3, 0.0]\nreduced_frequency = 0.2\npitch = \"1 deg\"\n\
    plunge = { amplitude = 0.01, phase = \"90 deg\" }";
/// Mass and inertia so great that the gas hardly changes the motion.
const HEAVY: f64 = 1e3;
/// Steps that lead past the start, and steps that are timed.
const STEPS: [u32; 2] = [64, 64];
/// Orders of magnitude that a step is solved to, in turn; the first is what the others are held against.
const ORDERS: [f64; 4] = [9.0, 2.0, 3.0, 5.0];
/// Orders of magnitude the steady flow before the march is solved to, and greatest number of iterations for that.
const PRELUDE: (f64, u32) = (1e-2, 80);

/// A step of the march of gas and structure over one of the gas alone around the same motion.
pub(super) fn coupled_step() {
    let (fluid, free, period) = built(&parsed(&case(MOTION)), Path::new(""));
    let u = started(&fluid, &free);
    let (still, _, _) = built(&parsed(&case("")), Path::new(""));
    let system = sprung(still, std::f64::consts::TAU / period);
    let all = system.start_with(&u);
    let plan = |orders| Plan { until: 1e9, step: period / 64.0, order: 2, orders, iterations: 20, adaptive: None };
    let gas = system.unknowns_of(Name::Gas);
    let mut exact = [Vec::new(), Vec::new()];
    for orders in ORDERS {
        let mut prescribed = Dual::new(&fluid, Control::newton(2), plan(orders), Past::default(), u.clone());
        let mut coupled = Dual::new(&system, Control::newton(2), plan(orders), Past::default(), all.clone());
        let mut timed = [Spent::default(); 2];
        for step in 0..STEPS[0] + STEPS[1] {
            // in turns: the clock of a processor changes within seconds
            let both = [spent(&mut prescribed), spent(&mut coupled)];
            if step >= STEPS[0] {
                timed.iter_mut().zip(both).for_each(|(sum, one)| sum.add(one));
            }
        }
        let ends = [prescribed.standing().state.to_vec(), coupled.standing().state[gas.clone()].to_vec()];
        if exact[0].is_empty() {
            exact = ends;
            continue;
        }
        let what = format!("step with structure over one on a prescribed motion, {orders} orders");
        tell(&what, timed[1].seconds / timed[0].seconds, "bar 1.10");
        for ((name, spent), (end, exact)) in ["prescribed", "coupled"].iter().zip(timed).zip(ends.iter().zip(&exact)) {
            let off = end.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let each = |n: u32| f64::from(n) / f64::from(STEPS[1]);
            println!(
                "  {name}: {:.1} ms, {:.2} Newton and {:.2} linear iterations a step; gas off by {off:.1e} at most",
                1e3 * spent.seconds / f64::from(STEPS[1]),
                each(spent.newton),
                each(spent.linear)
            );
        }
    }
}

/// What steps took.
#[derive(Clone, Copy, Default)]
struct Spent {
    seconds: f64,
    newton: u32,
    linear: u32,
}

impl Spent {
    fn add(&mut self, more: Self) {
        self.seconds += more.seconds;
        self.newton += more.newton;
        self.linear += more.linear;
    }
}

/// What one step takes.
fn spent<S: Implicit>(march: &mut Dual<'_, S>) -> Spent {
    let before = march.cost().linear;
    let seconds = once(|| _ = march.advance().unwrap());
    Spent { seconds, newton: march.cost().inner, linear: march.cost().linear - before }
}

/// The steady flow.
fn started(fluid: &Fluid<2>, free: &[f64]) -> Vec<f64> {
    let mut relax = Relax::new(fluid, Control::newton(2), free.to_vec(), free, None);
    while relax.drop() > PRELUDE.0 && relax.iteration < PRELUDE.1 && relax.advance().is_ok() {}
    relax.u.clone()
}

/// The gas with a section on springs that swings as [`MOTION`] has it.
fn sprung(fluid: Fluid<2>, omega: f64) -> Coupled<2> {
    let body = PlanarBody {
        pivot: [0.3, 0.0],
        mass: HEAVY,
        static_moment: [0.0; 2],
        inertia: HEAVY,
        flap: None,
        gravity: [0.0; 2],
        law: InertiaLaw::Exact,
    };
    let spring = Spring::linear(HEAVY * omega * omega);
    let coordinate = |name: &str| Coordinate { name: name.into(), spring, ..Coordinate::default() };
    let plunge = Coordinate { initial: 0.01, ..coordinate("plunge") };
    let pitch = Coordinate { initial_rate: 1f64.to_radians() * omega, ..coordinate("pitch") };
    let structure = Structure::new(Model::Planar(body), vec![plunge, pitch]).unwrap();
    let fluid = Fluid { cloud_motion: CloudMotion::Rigid(body_motion(&structure, 0, &[])), ..fluid };
    Coupled::new(fluid, vec![Attached::new(structure, 0, 1.0, 0, Vec::new())])
}
