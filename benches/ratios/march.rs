//! Implicit marching.
use std::path::Path;

use alula::system::{Instant, System, Term};
use alula::time::control::Control;
use alula::time::dual::{Dual, Plan};
use alula::time::relax::Relax;
use alula::time::{Integrator, Past};

use super::{built, once, parsed, tell};

/// RAE 2822 in pitch and plunge: viscous, layered, rigid.
const CASE: &str = "title = \"bench\"\n[flow]\nmach = 0.7\nreynolds = 3.1e5\ntemperature = \"288.15 K\"\n\
    [[body]]\nname = \"rae2822\"\nairfoil = \"rae2822.dat\"\n\
    [motion]\nparticles = \"rigid\"\npivot = [0.0, 0.0]\nreduced_frequency = 1.3192\n\
    pitch = { amplitude = \"4 deg\", phase = \"180 deg\" }\nplunge = 0.1\n\
    [cloud]\nspacing = 0.015625\nwall_layers = { first = 0.0003, growth = 1.25 }\nwake = { length = 1.0, spacing = 0.015625 }\n\
    [time.dual]\nsteps_per_period = 64\nperiods = 5\n";
/// Steps that lead past the start, and steps that are timed.
const STEPS: [u32; 2] = [192, 64];
/// Orders of magnitude the steady flow before the march is solved to, and greatest number of iterations for that.
const PRELUDE: (f64, u32) = (1e-2, 80);

/// A step in time over a residual, periodic state.
pub(super) fn dual_step() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("verification/rae2822_m073_a319");
    let (fluid, free, period) = built(&parsed(CASE), &folder);
    let mut relax = Relax::new(&fluid, Control::newton(2), free.clone(), &free, None);
    while relax.drop() > PRELUDE.0 && relax.iteration < PRELUDE.1 && relax.advance().is_ok() {}
    let u = relax.u.clone();
    drop(relax);
    let step = period / 64.0;
    let plan = Plan { until: 1e9, step, order: 2, orders: 2.0, iterations: 20, adaptive: None };
    let mut march = Dual::new(&fluid, Control::newton(2), plan, Past::default(), u);
    (0..STEPS[0]).for_each(|_| {
        march.advance().unwrap();
    });
    let (mut inner, linear, mut spent, mut one) = (0, march.cost().linear, 0.0, 0.0);
    let time = march.mark().time;
    let frame = fluid.frame(
        &Instant::formula(time, &[Term::of_time(1.0 / step, time), Term::of_time(-1.0 / step, time - step)]),
        &free,
    );
    let (mut work, mut du) = (fluid.work(), vec![0.0; free.len()]);
    for _ in 0..STEPS[1] {
        // in turns: the clock of a processor changes within seconds
        spent += once(|| _ = march.advance().unwrap());
        let state = march.standing().state;
        one += once(|| fluid.rhs(&frame, state, &mut work, &mut du));
        inner += march.cost().inner;
    }
    let (linear, steps) = (march.cost().linear - linear, f64::from(STEPS[1]));
    tell("dual-time step over a residual", spent / one, "bar 12");
    tell("  Newton iterations a step", f64::from(inner) / steps, "");
    tell("  linear iterations a step", f64::from(linear) / steps, "");
    tell("  steps that missed their goal", f64::from(march.cost().unconverged), "");
    let n = fluid.discretisation.cloud.n_fluid as f64;
    println!("  {n} particles, a residual takes {:.2} µs a particle", 1e6 * one / steps / n);
}
