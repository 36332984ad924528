//! Nothing is allocated inside `advance` once the first steps have made what is kept.
//!
//! On one thread, so that only what the steps themselves ask for is counted. A linear solve that needs more vectors than any
//! before it makes them then: such steps do not count.
#![allow(clippy::unwrap_used, reason = "a test may stop anywhere")]
mod common;

use alula::time::control::Control;
use alula::time::dual::{Dual, Plan};
use alula::time::relax::Relax;
use alula::time::{Integrator, Past, Step, TimeError};
use common::{round_body, solver};

/// Steps that may allocate.
const FIRST: u32 = 4;
/// Steps after those.
const COUNTED: u32 = 8;

const CONTROL: Control = Control { cfl: 20.0, ..Control::newton(2) };

/// Runs `f` on this thread alone.
fn alone(f: impl FnOnce() + Send) {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap().install(f);
}

/// Allocations of each step that needs no more linear iterations than one before it.
fn counted(mut advance: impl FnMut() -> Result<Step, TimeError>) -> Vec<u64> {
    let (mut longest, mut linear, mut found) = (0, 0, Vec::new());
    for k in 0..FIRST + COUNTED {
        let mut step = None;
        let made = allocation_counter::measure(|| step = Some(advance().unwrap()));
        let now = step.unwrap().linear;
        let iterations = now - linear;
        if k >= FIRST && iterations <= longest {
            found.push(made.count_total);
        }
        (longest, linear) = (longest.max(iterations), now);
    }
    found
}

/// A circle in a stream, or a viscous one.
fn bodies() -> [String; 2] {
    let plain = round_body(2).replace("spacing = 0.0625", "spacing = 0.125");
    let viscous = plain.replace("mach = 0.3", "mach = 0.3\nreynolds = 100");
    [plain, viscous]
}

#[test]
fn neither_newton_iterations_nor_steps_in_time_allocate() {
    alone(|| {
        for (fluid, u) in bodies().map(|text| solver::<2>(&text)) {
            let mut steady = Relax::new(&fluid, CONTROL, u.clone(), &u, None);
            let mut resume = steady.resume();
            resume.phase.newton = true;
            steady = Relax::new(&fluid, CONTROL, u.clone(), &u, Some(resume));
            let found = counted(|| steady.advance());
            assert!(found.len() > 2 && found.iter().all(|n| *n == 0), "steady: {found:?}");

            let plan = Plan { until: 1e3, step: 0.1, order: 2, orders: 3.0, iterations: 20, adaptive: None };
            let mut march = Dual::new(&fluid, CONTROL, plan, Past::default(), u.clone());
            let found = counted(|| march.advance());
            assert!(found.len() > 2 && found.iter().all(|n| *n == 0), "march: {found:?}");
        }
    });
}
