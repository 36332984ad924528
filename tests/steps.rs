//! Steps in time whose equations cannot be solved.
#![allow(clippy::unwrap_used, reason = "a test may stop anywhere")]

use alula::math::block_matrix::BlockMatrix;
use alula::math::multilevel::Cycle;
use alula::system::{Fault, Moment, System};
use alula::time::control::{Control, Method};
use alula::time::dual::{Dual, Plan};
use alula::time::{March, Past, TimeError};

/// u' = −u, which between two times only steps no longer than `longest` can solve. A change of the state counts `sharp` times as
/// the greatest change at one particle.
struct Decay {
    hard: std::ops::Range<f64>,
    longest: f64,
    sharp: f64,
}

impl System for Decay {
    /// Time and coefficient of the state in its difference formula.
    type Frame = (f64, f64);
    type Work = ();

    fn block(&self) -> usize {
        1
    }
    fn len(&self) -> usize {
        1
    }
    fn frame(&self, moment: &Moment<'_>, _: &[f64]) -> (f64, f64) {
        let mut frame = (0.0, 0.0);
        self.place(moment, &mut frame);
        frame
    }
    fn place(&self, moment: &Moment<'_>, frame: &mut (f64, f64)) {
        *frame = (moment.time(), 0.0);
        if let Moment::By { rate, .. } = moment {
            frame.1 = rate[0].1 - rate[1].1;
        }
    }
    fn follow(&self, _: &[f64], (): &mut (), _: &mut (f64, f64)) {}
    fn work(&self) {}
    fn rhs(&self, _: &(f64, f64), u: &[f64], (): &mut (), du: &mut [f64]) {
        du[0] = -u[0];
    }
    fn spectral_radius(&self, _: &(f64, f64), _: &[f64], (): &mut (), rate: &mut [f64]) {
        rate.fill(1.0);
    }
    fn graph(&self) -> (&[u32], &[u32]) {
        (&[0, 1], &[0])
    }
    fn parts(&self) -> &[std::ops::Range<usize>] {
        #[allow(clippy::single_range_in_vec_init, reason = "one part")]
        const ONE: &[std::ops::Range<usize>] = &[0..1];
        ONE
    }
    fn linearise(&self, _: &(f64, f64), _: &[f64], (): &mut (), matrix: &mut BlockMatrix) {
        matrix.assemble(|_, rows| rows.add(0, 0, |_, _| 1.0));
    }
    fn largest_change(&self, _: &[f64], du: &[f64]) -> f64 {
        self.sharp * du[0].abs()
    }
    fn fault(&self, (time, step): &(f64, f64), _: &[f64]) -> Option<Fault> {
        let refused = self.hard.contains(time) && *step > self.longest;
        refused.then(|| Fault { particle: 0, place: Vec::new(), reason: "refused".into() })
    }
}

fn march(longest: f64) -> Result<(Vec<f64>, f64, u32), TimeError> {
    march_with(Decay { hard: 0.95..1.25, longest, sharp: 1e-3 }, 20)
}

/// Times of the steps, the last state, and how often steps were halved.
fn march_with(system: Decay, iterations: u32) -> Result<(Vec<f64>, f64, u32), TimeError> {
    let control = Control {
        method: Method::NewtonKrylov,
        cfl: 1e3,
        cfl_max: 1e6,
        growth: 2.0,
        tolerance: 1e-3,
        basis: 5,
        group: 4,
        cycle: Cycle { sweeps: 2, visits: 1, levels: 2 },
    };
    let plan = Plan { until: 2.0, step: 0.1, order: 2, orders: 9.0, iterations, adaptive: None };
    let mut march = Dual::new(&system, control, plan, (Past::default(), vec![1.0]));
    let mut times = Vec::new();
    while !march.finished() {
        times.push(march.advance()?.time);
    }
    let state = march.parts().2[0];
    Ok((times, state, march.past().halved))
}

#[test]
fn a_step_that_cannot_be_solved_is_halved_and_leads_back_to_the_times_asked_for() {
    let (times, state, halved) = march(0.03).unwrap();
    assert!(halved >= 2, "{times:?}");
    let on = |k: usize| times.iter().any(|t| (t - 0.1 * k as f64).abs() < 1e-9);
    assert!((1..=20).all(on) && times.len() > 23, "{times:?}");
    assert!((state - (-2.0_f64).exp()).abs() < 1e-3, "{state}");
    let (times, _, halved) = march(1.0).unwrap();
    assert!(times.len() == 20 && halved == 0);
}

#[test]
fn a_march_gives_up_where_no_step_can_be_solved() {
    assert!(matches!(march(0.0), Err(TimeError::Stalled { .. })));
}

#[test]
fn a_step_that_ends_early_is_refused_where_a_particle_runs_away() {
    // the first step needs more than two iterations, of which the first two leave a sixth of its residual
    let all = 0.0..0.0;
    let (times, _, halved) = march_with(Decay { hard: all.clone(), longest: 1.0, sharp: 8.0 }, 2).unwrap();
    assert!(halved > 0 && times[0] < 0.06, "{times:?}");
    let (times, _, halved) = march_with(Decay { hard: all, longest: 1.0, sharp: 5.0 }, 2).unwrap();
    assert!(halved == 0 && times.len() == 20, "{times:?}");
}
