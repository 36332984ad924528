//! Steps in time whose equations cannot be solved.

use alula::math::multilevel::Cycle;
use alula::system::{Fault, Field, Hierarchy, Implicit, Instant, Name, Period, Rate, System};
use alula::time::control::Control;
use alula::time::dual::{Dual, Plan};
use alula::time::full::Full;
use alula::time::{Integrator, Past, TimeError};

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

    fn fields(&self) -> &[Field] {
        const ONE: [Field; 1] = [Field::new(Name::Other("u"), 1, 1)];
        &ONE
    }
    fn frame(&self, at: &Instant<'_>, _: &[f64]) -> (f64, f64) {
        let mut frame = (0.0, 0.0);
        self.place(at, &mut frame);
        frame
    }
    fn place(&self, at: &Instant<'_>, frame: &mut (f64, f64)) {
        *frame = (at.time, 0.0);
        if let Rate::Formula(rate) = at.rate {
            frame.1 = rate[0].time - rate[1].time;
        }
    }
    fn work(&self) {}
    fn rhs(&self, _: &(f64, f64), u: &[f64], (): &mut (), du: &mut [f64]) {
        du[0] = -u[0];
    }
    fn rates(&self, _: &(f64, f64), _: &[f64], (): &mut (), rate: &mut [f64]) {
        rate.fill(1.0);
    }
    fn largest_change(&self, _: &[f64], du: &[f64]) -> f64 {
        self.sharp * du[0].abs()
    }
    fn check(&self, (time, step): &(f64, f64), _: &[f64]) -> Result<(), Fault> {
        let refused = self.hard.contains(time) && *step > self.longest;
        if refused { Err(Fault { particle: 0, place: Vec::new(), reason: "refused".into() }) } else { Ok(()) }
    }
}

impl Implicit for Decay {
    type Preconditioner = Full;
    fn preconditioner(&self, _: &Hierarchy, period: Option<Period>) -> Full {
        Full::new(self, period)
    }
}

fn march(longest: f64) -> Result<(Vec<f64>, f64, u32), TimeError> {
    march_with(Decay { hard: 0.95..1.25, longest, sharp: 1e-3 }, 20)
}

/// Times of the steps, the last state, and how often steps were halved.
fn march_with(system: Decay, iterations: u32) -> Result<(Vec<f64>, f64, u32), TimeError> {
    let control = Control {
        cfl: 1e3,
        tolerance: 1e-3,
        basis: 5,
        cycle: Cycle { sweeps: 2, visits: 1, levels: 2 },
        ..Control::newton(2)
    };
    let plan = Plan { until: 2.0, step: 0.1, order: 2, orders: 9.0, iterations, adaptive: None };
    let mut march = Dual::new(&system, control, plan, Past::default(), vec![1.0]);
    let mut times = Vec::new();
    while !march.finished() {
        times.push(march.advance()?.time);
    }
    let state = march.standing().state[0];
    Ok((times, state, march.cost().halved))
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
