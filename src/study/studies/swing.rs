//! Forces of the gas on the coordinates of bodies in a periodic motion of any size: harmonic balance with that motion.
use crate::coupling::led::Led;
use crate::coupling::{Attached, Coupled};
use crate::math::fourier::Instances;
use crate::scheme::HasGas;
use crate::structure::limit_cycle::Periodic;
use crate::system::System;
use crate::time::control::Control;
use crate::time::harmonic::HarmonicBalance;
use crate::time::relax::Relax;

/// Courant numbers of Newton's method from a flow that is near.
const CFL: f64 = 1e4;
const CFL_MAX: f64 = 1e8;
/// Residual over that of the free stream that ends a balance, and that which may go on to tremble.
const CONVERGED: [f64; 2] = [1e-7, 1e-5];
/// Iterations, at most, and those without a smaller residual after which it trembles.
const ITERATIONS: u32 = 120;
const PATIENCE: u32 = 8;
/// Harmonics of forces, which are products, over those of the flow.
const PRODUCTS: usize = 2;

/// The flow at the instances of a period, as one state, and how many there are.
pub(super) struct Flow {
    state: Vec<f64>,
    instances: Instances,
}

/// The flow with the motion `motion` of angular frequency `omega` about the steady state `steady`, and the forces on all coordinates; begins from
/// `before` where there is one. Fails with what stands in the way.
pub(super) fn swing<const D: usize>(
    coupled: &Coupled<D>,
    steady: &[f64],
    (motion, omega): (&Periodic, f64),
    before: Option<Flow>,
) -> Result<(Flow, Periodic), String> {
    let led = Led::new(coupled, steady, motion, omega);
    let instances = Instances::of_harmonics(motion.harmonics.len());
    let balance = HarmonicBalance::new(&led, instances, omega, 1.0);
    let mut state = match before {
        Some(before) => balance.led_resampled(&before.state, before.instances),
        None => balance.led_copies(steady),
    };
    balance.prescribe(0.0, &mut state);
    let origin = balance.copies(&coupled.start());
    let control = Control { cfl: CFL, cfl_max: CFL_MAX, ..Control::newton(D) };
    let mut relax = Relax::new(&balance, control, state, &origin, None);
    drop(origin);
    relax.begin_with_newton();
    while relax.iteration == 0 || relax.drop() > CONVERGED[0] {
        if relax.iteration >= ITERATIONS || relax.resting() > PATIENCE {
            break;
        }
        relax.advance().map_err(|e| e.to_string())?;
    }
    if !(relax.drop() <= CONVERGED[1]) {
        return Err(format!(
            "harmonic balance left a residual of {:.1e}; the largest is at {}",
            relax.drop(),
            relax.worst()
        ));
    }
    let forces = forces(coupled, &balance, &relax.u);
    Ok((Flow { state: relax.u, instances }, forces))
}

/// Forces on all coordinates, with as many harmonics as the flow has.
fn forces<const D: usize>(coupled: &Coupled<D>, balance: &HarmonicBalance<'_, Led<'_, D>>, u: &[f64]) -> Periodic {
    let harmonics = balance.instances().harmonics();
    let looked_at = Instances::of_harmonics(PRODUCTS * harmonics + 1);
    let (mut work, mut one) = (coupled.work(), vec![0.0; coupled.len()]);
    let at = |phase: f64| {
        balance.at_phase(u, phase, &mut one);
        let frame = balance.with_instant(u, phase, |at| coupled.frame(at, &one));
        let all = coupled.exchange(&frame, &one, &mut work).map_or_else(Vec::new, |e| e.loads);
        own_loads(coupled.bodies(), &all)
    };
    Periodic::of_values(&looked_at.times(1.0).into_iter().map(at).collect::<Vec<_>>(), harmonics)
}

/// Of the loads of an exchange those on coordinates, without what is told beside them.
pub(super) fn own_loads<const D: usize>(bodies: &[Attached<D>], all: &[f64]) -> Vec<f64> {
    let (mut rest, mut own) = (all, Vec::new());
    for body in bodies {
        let (loads, after) = rest.split_at(body.structure.len());
        own.extend_from_slice(loads);
        rest = &after[body.n_told()..];
    }
    own
}
