//! Clouds that deform, and particles that travel.
use std::path::Path;

use alula::scheme::RemapLedger;
use alula::system::{Instant, System, Term};
use alula::time::explicit::{Explicit, Method, Plan};
use alula::time::{Integrator, Past};

use super::{built, parsed, residual, seconds, tell};

/// NACA 0012 in pitch on a cloud that deforms.
const DEFORMING: &str = "title = \"bench\"\n[flow]\nmach = 0.6\nalpha = \"4.86 deg\"\n\
    [motion]\nparticles = \"deforming\"\npivot = [0.25, 0.0]\npitch = \"2.44 deg\"\nreduced_frequency = 0.081\n\
    [[body]]\nname = \"naca0012\"\nnaca = \"0012\"\n[cloud]\nspacing = 0.015625\nlayers = 12.0\n\
    [time.dual]\nsteps_per_period = 96\nperiods = 3\n";

/// Places and weights of a deforming cloud made anew.
pub(super) fn deforming() {
    let (fluid, u, period) = built(&parsed(DEFORMING), Path::new(""));
    let mut frame = fluid.frame(&Instant::still(0.0), &u);
    let step = period / 96.0;
    let mut n = 0.0;
    let anew = seconds(|| {
        n += 1.0;
        let time = n * step;
        fluid.place(
            &Instant::formula(time, &[Term::of_time(1.0 / step, time), Term::of_time(-1.0 / step, time - step)]),
            &mut frame,
        );
    });
    let formula = [Term::of_time(1.0 / step, step), Term::of_time(-1.0 / step, 0.0)];
    let moment = Instant::formula(step, &formula);
    tell("deforming cloud placed and fitted anew, over a residual", anew / residual(&fluid, &moment, &u), "bar 1.5");
}

/// A cloud of travelling particles built anew, and a step of three stages.
pub(super) fn travelling() {
    let (fluid, u) = crate::travelling::<2>();
    let (mut work, mut ledger) = (fluid.work(), RemapLedger::default());
    let moment = Instant::still(0.0);
    let one = residual(&fluid, &moment, &u);
    let frame = fluid.frame(&moment, &u);
    let anew = seconds(|| drop(fluid.reclouded(&frame, (&u, [&[], &[]]), &mut work, &mut ledger)));
    let mut operators = fluid.discretisation.operators.clone();
    let refit = seconds(|| operators.refit(&fluid.discretisation.cloud));
    let mut march =
        Explicit::new(&fluid, Plan { method: Method::Ssprk3, cfl: 0.1, until: 1e9 }, Past::default(), u.clone());
    let step = seconds(|| drop(march.advance()));
    tell("travelling particles searched and fitted anew, over a residual", anew / one, "bar 4");
    tell("weights fitted anew on the same lists", refit / one, "");
    tell("Runge-Kutta step of three stages on particles that travel", step / one, "");
}
