//! Harmonic balance.
use std::path::Path;
use std::time;

use alula::math::fourier::Instances;
use alula::scheme::Fluid;
use alula::system::{Hierarchy, Implicit, Instant, Preconditioner, Reach, RightHandSide, Shift, System, Term, rows};
use alula::time::control::Control;
use alula::time::dual::{Dual, Plan};
use alula::time::harmonic::HarmonicBalance;
use alula::time::relax::Relax;
use alula::time::{Integrator, Past};

use super::{built, parsed, residual, seconds, tell};

/// NACA 0010 in pitch.
const CASE: &str = "title = \"bench\"\n[flow]\nmach = 0.7\n[[body]]\nname = \"foil\"\nnaca = \"0010\"\n\
    [motion]\nparticles = \"rigid\"\npivot = [0.25, 0.0]\npitch = \"1 deg\"\nreduced_frequency = 0.2\n\
    [cloud]\nspacing = 0.0078125\n[time.dual]\nsteps_per_period = 64\nperiods = 3\n";
/// Newton steps that the memory of either method is read after.
const WARM: usize = 12;
/// Iterations of the relaxation that threads are compared by.
const SOLVED: usize = 40;
/// Shift of the diagonal in units of the rate of a particle: what a Courant number of a hundred gives.
const SHIFT: f64 = 0.01;

/// Costs of one instance of a period beside those of one state.
pub(super) fn balance() {
    let (fluid, u, period) = built(&parsed(CASE), Path::new(""));
    let omega = std::f64::consts::TAU / period;
    let step = period / 64.0;
    let formula = [Term::of_time(1.0 / step, 0.0), Term::of_time(-1.0 / step, -step)];
    let one = residual(&fluid, &Instant::formula(0.0, &formula), &u);
    let (steady, _) = preconditioner(&fluid, &u);
    println!("  {} particles, a residual takes {:.1} ms", fluid.discretisation.cloud.n_fluid, 1e3 * one);
    tell("preconditioner of one state over a residual", steady / one, "");
    let marching = marching_bytes(&fluid, &u, period / 64.0);
    println!("  bytes per particle of an implicit march: {marching:.0}");
    for harmonics in [1, 2, 3] {
        let balance = HarmonicBalance::new(&fluid, Instances::of_harmonics(harmonics), omega, 1.0);
        let (count, all) = ((2 * harmonics + 1) as f64, balance.copies(&u));
        let (frame, mut work, mut du) = (balance.frame(&Instant::still(0.0), &all), balance.work(), all.clone());
        let rhs = seconds(|| balance.rhs(&frame, &all, &mut work, &mut du));
        let (applied, refreshed) = preconditioner(&balance, &all);
        let name = format!("{count} instances: residual of all over as many of one");
        tell(&name, rhs / one / count, "about 1");
        tell("  preconditioner of an instance over that of one state", applied / steady / count, "");
        tell("  linearisation and refresh of all over residuals of one", refreshed / one, "");
        let mut relax = Relax::new(&balance, Control::newton(2), all.clone(), &all, None);
        (0..WARM).for_each(|_| drop(relax.advance()));
        let held =
            bytes(&fluid) + 8 * 2 * u.len() + 8 * frame.len() * 2 * fluid.discretisation.cloud.len() + relax.bytes();
        let each = held as f64 / count / particles(&fluid);
        tell("  bytes of an instance over those of a march", each / marching, "bar 0.6");
        println!("    bytes per particle and instance {each:.0}");
    }
}

/// Wall time of a relaxation with three instances on one thread over that on two.
pub(super) fn threads() {
    let (fluid, u, period) = built(&parsed(CASE), Path::new(""));
    let balance = HarmonicBalance::new(&fluid, Instances::of_harmonics(1), std::f64::consts::TAU / period, 1.0);
    let all = balance.copies(&u);
    let solve = |threads: usize| {
        let clock = time::Instant::now();
        let steps = || {
            let mut relax = Relax::new(&balance, Control::newton(2), all.clone(), &all, None);
            (0..SOLVED).for_each(|_| drop(relax.advance()));
        };
        crate::pool(threads).install(steps);
        clock.elapsed().as_secs_f64()
    };
    let [one, two] = [1, 2].map(|n| solve(n).min(solve(n)));
    tell("3 instances: relaxation on one thread over that on two", one / two, "bar 1.8");
    println!("  {SOLVED} iterations on one thread take {one:.2} s");
}

fn particles(fluid: &Fluid<2>) -> f64 {
    fluid.discretisation.cloud.n_fluid as f64
}

/// Times of one application of the preconditioner, and of making it.
fn preconditioner<S: Implicit>(system: &S, u: &[f64]) -> (f64, f64) {
    let Control { group, cycle, .. } = Control::newton(2);
    let mut inner = system.preconditioner(&Hierarchy { group, cycle }, None);
    let (frame, mut work) = (system.frame(&Instant::still(0.0), u), system.work());
    let mut rate = vec![0.0; rows(system.fields())];
    system.rates(&frame, u, &mut work, &mut rate);
    let shift = Shift { rates: &rate, cfl: 1.0 / SHIFT, coefficient: 0.0, reach: Reach::Far };
    let made = seconds(|| inner.update(system, (&frame, u), &mut work, &shift));
    let right: Vec<f64> = (0..u.len()).map(|k| (k as f64 * 0.1).sin()).collect();
    let mut z = vec![0.0; u.len()];
    (seconds(|| inner.apply(system, &[&frame], &RightHandSide::Plain(&right), &mut z)), made)
}

/// Bytes of the cloud, its operators and the storage of one residual.
fn bytes(fluid: &Fluid<2>) -> usize {
    let cloud = &fluid.discretisation.cloud;
    let points = cloud.len() * (size_of::<[f64; 2]>() + 2 * size_of::<f64>());
    let rows = 4 * (cloud.neighbours.first.len() + cloud.neighbours.index.len());
    // states and gradients of the primitive variables
    points + rows + fluid.discretisation.operators.bytes() + 8 * cloud.len() * 4 * (1 + 2)
}

/// Bytes per particle of a march that has taken a few steps.
fn marching_bytes(fluid: &Fluid<2>, u: &[f64], step: f64) -> f64 {
    let plan = Plan { until: 1e9, step, order: 2, orders: 2.0, iterations: 20, adaptive: None };
    let mut march = Dual::new(fluid, Control::newton(2), plan, Past::default(), u.to_vec());
    (0..3).for_each(|_| drop(march.advance()));
    let velocity = 8 * 2 * fluid.discretisation.cloud.len();
    (bytes(fluid) + velocity + march.cost().bytes) as f64 / particles(fluid)
}
