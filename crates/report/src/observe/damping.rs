//! Frequency and damping of an oscillation from the tail of its history.
//!
//! The tail is taken for a sum of oscillations that grow or decay, drifts and a constant,
//!
//! q(t) = c + Σ_m e^{σ_m t} (a_m cos ω_m t + b_m sin ω_m t).
//!
//! Poles come from the matrix pencil ([`crate::math::pencil`]; Hua and Sarkar 1990) of the differences between even samples of it,
//! which leaves c out exactly; then Gauss-Newton steps fit all unknowns together to the samples as they are, uneven as their steps may
//! be ([`crate::math::exponentials`]), so that resampling costs no accuracy. Of the fits with one to seven poles that with the smallest
//! n ln r² + k ln n counts, k unknowns for n samples with the mean square misfit r² (Schwarz 1978, Ann. Statist. 6, 461): a pole must
//! earn its place. The residual of the fit tells whether to believe it: play and cubic springs make no exponentials.
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use super::cycles::Trace;
use crate::math::exponentials::{Exponentials, Samples, Term};
use crate::math::pencil::Pencil;

/// Poles of a fit, at most: three oscillations and a drift.
const MOST_POLES: usize = 7;
/// Even samples that the pencil sees, at most.
const EVEN: usize = 192;
/// Samples of a tail, at least.
const FEWEST: usize = 12;
/// Part of the history that is its tail.
const TAIL: f64 = 0.5;
/// Cycles in the tail, at least (where there are as many) and at most.
const CYCLES: [f64; 2] = [3.0, 16.0];
/// Cycles without which there is no frequency.
const LEAST_CYCLES: f64 = 1.5;
/// Cycles that tell mean and amplitude, at most.
const LAST: usize = 6;
/// Root mean square deviation over the greatest value below which a history is still: round-off of its values.
const STILL: f64 = 1e-12;
/// Growth or decay over the tail, as an exponent, beyond which a pole is an accident.
const STEEP: f64 = 60.0;
/// Radians over the tail below which a pole drifts.
const SLOW: f64 = 1e-3;
/// Size of an oscillation over the whole above which it lives by cancelling another.
const CANCELLING: f64 = 10.0;
/// Radians over the tail by which frequencies must differ to be two, unless the misfit is below [`EXACT`]: a frequency that changes with
/// amplitude, as with cubic springs and play, looks like two that beat and grow and decay as nothing does.
const APART: f64 = std::f64::consts::TAU;
const EXACT: f64 = 1e-4;
/// Size of an oscillation over the largest below which it is not told.
const FAINT: f64 = 1e-2;

/// Root mean square misfit over that of the tail with which a fit tells nothing.
const UNEXPLAINED: f64 = 0.35;

/// One oscillation; time in the unit of the history.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Oscillation {
    /// Angular frequency ω.
    pub frequency: f64,
    /// Growth rate σ, negative where it decays.
    pub growth_rate: f64,
    /// −σ/√(σ² + ω²).
    pub damping_ratio: f64,
    /// √(a² + b²) e^{σt} at the end of the history.
    pub amplitude: f64,
}

/// What a tail was found to be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DampingFit {
    /// Oscillations, that with the largest mean square first; at least one.
    pub modes: Vec<Oscillation>,
    /// c: where the oscillation would come to rest, or leave from.
    pub constant: f64,
    /// Root mean square misfit over the root mean square deviation of the tail from its mean.
    pub residual: f64,
    /// Time at which the tail begins; it ends with the history.
    pub from: f64,
}

/// Why a history has no frequency.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoFit {
    /// Too few samples.
    #[error("{found} samples are too few for a frequency; at least {FEWEST} are needed")]
    Few {
        /// Samples there are.
        found: usize,
    },
    /// Values that are no numbers.
    #[error("the history holds values that are no numbers")]
    NotFinite,
    /// Nothing moves.
    #[error("nothing moves")]
    Still,
    /// Less than one and a half cycles.
    #[error("the history holds {cycles:.2} cycles; a frequency needs at least {LEAST_CYCLES}")]
    Short {
        /// Cycles there are.
        cycles: f64,
    },
    /// Drifts alone.
    #[error("what moves does not oscillate")]
    NoOscillation,
    /// No sum of a few oscillations.
    #[error("oscillations that grow or decay leave {:.0} % of what moves unexplained", 100.0 * .residual)]
    Unexplained {
        /// Root mean square of what they leave, over that of the tail.
        residual: f64,
    },
}

/// The last whole cycles of an oscillation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LastCycles {
    /// Cycles that were looked at.
    pub cycles: usize,
    /// Mean over them.
    pub mean: f64,
    /// Half of greatest less smallest value in a cycle, mean of the cycles.
    pub amplitude: f64,
    /// Greatest less smallest amplitude of the cycles over their mean: small in a limit cycle.
    pub spread: f64,
}

/// A history or a part of it at rising times.
#[derive(Clone, Copy)]
pub(super) struct Tail<'a> {
    pub(super) time: &'a [f64],
    pub(super) values: &'a [f64],
}

impl DampingFit {
    /// Frequency and damping of the tail of a history. Of times that do not rise all the way, the last rising part counts: a march may
    /// follow iterations without time.
    pub fn of(time: &[f64], values: &[f64]) -> Result<Self, NoFit> {
        let whole = Tail { time, values }.rising();
        whole.check()?;
        let tail = whole.late();
        tail.check()?;
        let scaled = Scaled::of(tail);
        let candidates = scaled.candidates();
        let best = candidates.into_iter().min_by(|a, b| a.price.total_cmp(&b.price)).ok_or(NoFit::NoOscillation)?;
        scaled.told(&best)
    }
}

impl LastCycles {
    /// Mean and amplitude of the last whole cycles of an oscillation with the angular `frequency`; `None` without a whole one.
    pub fn of(time: &[f64], values: &[f64], frequency: f64) -> Option<Self> {
        let tail = Tail { time, values }.rising();
        let (start, end, period) = (*tail.time.first()?, *tail.time.last()?, std::f64::consts::TAU / frequency);
        let cycles = (((end - start) / period * (1.0 + f64::EPSILON)) as usize).min(LAST);
        if cycles == 0 || tail.time.len() < FEWEST {
            return None;
        }
        let begin = |k: usize| end - period * k as f64;
        let amplitudes = (0..cycles).map(|k| tail.cut(begin(k + 1), begin(k)).half_range());
        let sizes = amplitudes.fold([f64::INFINITY, 0.0, 0.0], |[l, h, s], a| [a.min(l), a.max(h), s + a]);
        let amplitude = sizes[2] / cycles as f64;
        let mean = tail.trace().mean((begin(cycles).max(start), end));
        let spread = if amplitude > 0.0 { (sizes[1] - sizes[0]) / amplitude } else { 0.0 };
        Some(Self { cycles, mean, amplitude, spread })
    }
}

/// Energy exchanged over the last whole cycle of an oscillation with the angular `frequency`: the integral of `power` by the
/// trapezoidal rule of the steps. `None` without a whole cycle.
pub fn energy_per_cycle(time: &[f64], power: &[f64], frequency: f64) -> Option<f64> {
    let tail = Tail { time, values: power }.rising();
    let (start, end, period) = (*tail.time.first()?, *tail.time.last()?, std::f64::consts::TAU / frequency);
    (period <= end - start).then(|| tail.trace().mean((end - period, end)) * period)
}

impl<'a> Tail<'a> {
    /// The last part in which time rises.
    pub(super) fn rising(self) -> Self {
        let n = self.time.len().min(self.values.len());
        let falls = (1..n).rev().find(|k| !(self.time[k - 1] < self.time[*k])).unwrap_or(0);
        Self { time: &self.time[falls..n], values: &self.values[falls..n] }
    }

    fn trace(&self) -> Trace<'a> {
        Trace { time: self.time, values: self.values }
    }

    fn check(&self) -> Result<(), NoFit> {
        let found = self.time.len();
        if found < FEWEST {
            return Err(NoFit::Few { found });
        }
        if !self.time.iter().chain(self.values).all(|x| x.is_finite()) {
            return Err(NoFit::NotFinite);
        }
        let largest = self.values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if self.deviation() > STILL * largest { Ok(()) } else { Err(NoFit::Still) }
    }

    fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len() as f64
    }

    /// Root mean square deviation from the mean.
    fn deviation(&self) -> f64 {
        let mean = self.mean();
        (self.values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / self.values.len() as f64).sqrt()
    }

    fn cut(&self, from: f64, to: f64) -> Self {
        let [first, last] = [from, to].map(|bound| self.time.partition_point(|t| *t < bound));
        let range = first..(last + 1).min(self.time.len());
        Self { time: &self.time[range.clone()], values: &self.values[range] }
    }

    /// The last part of the history: half of it, but neither too few cycles nor too many.
    fn late(&self) -> Self {
        let (start, end) = (self.time[0], self.time[self.time.len() - 1]);
        let half = end - TAIL * (end - start);
        let found = self.trace().dominant((half, end));
        let period = found.map_or(end - start, |frequency| 1.0 / frequency);
        let [least, most] = CYCLES.map(|cycles| end - cycles * period);
        self.cut(half.min(least).max(most).max(start), end)
    }

    /// Half of greatest less smallest value, with parabolas through the extremes and what stands beside them.
    fn half_range(&self) -> f64 {
        let extreme = |sign: f64| {
            let size = |k: usize| sign * self.values[k];
            let k = (1..self.values.len()).fold(0, |best, k| if size(k) > size(best) { k } else { best });
            let inside = 0 < k && k + 1 < self.values.len();
            sign * if inside { self.vertex(k, sign) } else { size(k) }
        };
        0.5 * (extreme(1.0) - extreme(-1.0))
    }

    /// Greatest value of the parabola through sample `k`, which is none less than its neighbours, and these.
    fn vertex(&self, k: usize, sign: f64) -> f64 {
        let [left, right] = [k - 1, k + 1].map(|j| self.time[j] - self.time[k]);
        let [low, high] = [k - 1, k + 1].map(|j| sign * (self.values[j] - self.values[k]));
        // y = b t + c t²
        let c = (high / right - low / left) / (right - left);
        let b = low / left - c * left;
        sign * self.values[k] + if c < 0.0 { -0.25 * b * b / c } else { 0.0 }
    }

    /// Value at `t` of the cubic through the four samples around it.
    fn at(&self, t: f64) -> f64 {
        let n = self.time.len();
        let first = self.time.partition_point(|s| *s <= t).saturating_sub(2).min(n - 4);
        let weight = |i: usize| {
            let others = (first..first + 4).filter(|j| *j != i);
            others.map(|j| (t - self.time[j]) / (self.time[i] - self.time[j])).product::<f64>()
        };
        (first..first + 4).map(|i| weight(i) * self.values[i]).sum()
    }

    /// Differences between even samples.
    fn differences(&self, count: usize) -> Vec<f64> {
        let (start, end) = (self.time[0], self.time[self.time.len() - 1]);
        let step = (end - start) / (count - 1) as f64;
        let even: Vec<f64> = (0..count).map(|k| self.at(start + step * k as f64)).collect();
        even.windows(2).map(|w| w[1] - w[0]).collect()
    }
}

/// A tail with times from −1 to 0 and values of mean zero and deviation one.
struct Scaled {
    time: Vec<f64>,
    values: Vec<f64>,
    /// Mean square of the round-off of the values.
    floor: f64,
    mean: f64,
    deviation: f64,
    length: f64,
    from: f64,
}

/// A fit and what it costs.
struct Candidate {
    fit: Exponentials,
    price: f64,
}

impl Scaled {
    fn of(tail: Tail<'_>) -> Self {
        let (from, end) = (tail.time[0], tail.time[tail.time.len() - 1]);
        let (mean, deviation, length) = (tail.mean(), tail.deviation(), end - from);
        let largest = tail.values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        Self {
            time: tail.time.iter().map(|t| (t - end) / length).collect(),
            values: tail.values.iter().map(|v| (v - mean) / deviation).collect(),
            floor: (4.0 * f64::EPSILON * largest / deviation).max(STILL).powi(2),
            mean,
            deviation,
            length,
            from,
        }
    }

    fn samples(&self) -> Samples<'_> {
        Samples { times: &self.time, values: &self.values }
    }

    /// A fit for each number of poles.
    fn candidates(&self) -> Vec<Candidate> {
        let tail = Tail { time: &self.time, values: &self.values };
        let count = self.time.len().min(EVEN);
        let pencil = Pencil::of(&tail.differences(count));
        let step = 1.0 / (count - 1) as f64;
        let found = (1..=MOST_POLES).filter_map(|n| pencil.poles(n)).map(|poles| rates(&poles, step));
        found.filter_map(|poles| self.candidate(&poles)).collect()
    }

    /// The fit near some poles; `None` where oscillations cancel one another or cannot be told apart.
    fn candidate(&self, poles: &[Complex64]) -> Option<Candidate> {
        let fit = Exponentials::fit(self.samples(), poles)?;
        let n = self.time.len() as f64;
        let square = fit.misfit(self.samples()) / n;
        let price = n * (square + self.floor).ln() + fit.unknowns() as f64 * n.ln();
        let swings: Vec<&Term> = fit.terms.iter().filter(|term| !term.is_drift()).collect();
        let apart = |k: usize| swings[..k].iter().all(|other| (other.frequency - swings[k].frequency).abs() >= APART);
        let sound = swings.iter().all(|term| term.size(&self.time) < CANCELLING)
            && (square < EXACT * EXACT || (0..swings.len()).all(apart));
        (sound && price.is_finite()).then_some(Candidate { fit, price })
    }

    /// The fit in the units of the history.
    fn told(&self, best: &Candidate) -> Result<DampingFit, NoFit> {
        let mut terms: Vec<&Term> = best.fit.terms.iter().filter(|term| !term.is_drift()).collect();
        terms.sort_by(|a, b| b.size(&self.time).total_cmp(&a.size(&self.time)));
        let largest = terms.first().ok_or(NoFit::NoOscillation)?;
        let (faint, cycles) = (FAINT * largest.size(&self.time), largest.frequency / std::f64::consts::TAU);
        terms.retain(|term| term.size(&self.time) >= faint && term.frequency >= LEAST_CYCLES * std::f64::consts::TAU);
        if terms.is_empty() {
            return Err(NoFit::Short { cycles });
        }
        let residual = (best.fit.misfit(self.samples()) / self.time.len() as f64).sqrt();
        if residual > UNEXPLAINED {
            return Err(NoFit::Unexplained { residual });
        }
        Ok(DampingFit {
            modes: terms.into_iter().map(|term| self.oscillation(term)).collect(),
            constant: self.mean + self.deviation * best.fit.constant,
            residual,
            from: self.from,
        })
    }

    fn oscillation(&self, term: &Term) -> Oscillation {
        Oscillation {
            frequency: term.frequency / self.length,
            growth_rate: term.growth / self.length,
            damping_ratio: -term.growth / term.growth.hypot(term.frequency),
            amplitude: self.deviation * term.cosine.hypot(term.sine),
        }
    }
}

/// Rates s = ln z / Δt of the poles with ω ≥ 0 that can be told from accidents.
fn rates(poles: &[Complex64], step: f64) -> Vec<Complex64> {
    let own = poles.iter().map(|z| z.ln() / step);
    // a negative real pole is an oscillation as fast as samples can tell: noise
    let fastest = 0.99 * std::f64::consts::PI / step;
    let told = own.filter(|s| s.re.abs() < STEEP && -SLOW < s.im && s.im < fastest);
    told.map(|s| if s.im < SLOW { Complex64::new(s.re, 0.0) } else { s }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// e^{σt} a cos(ωt + φ).
    #[derive(Clone, Copy)]
    struct Swing {
        growth: f64,
        frequency: f64,
        size: f64,
        phase: f64,
    }

    const fn swing(growth: f64, frequency: f64, size: f64, phase: f64) -> Swing {
        Swing { growth, frequency, size, phase }
    }

    fn value(swings: &[Swing], t: f64) -> f64 {
        swings.iter().map(|s| s.size * (s.growth * t).exp() * (s.frequency * t + s.phase).cos()).sum()
    }

    /// Times with steps that are not equal when `uneven`.
    fn times(n: usize, uneven: bool) -> Vec<f64> {
        (0..n).map(|k| 0.1 * k as f64 + if uneven { 0.02 * (k as f64).sin() } else { 0.0 }).collect()
    }

    fn assert_exact(offset: f64, swings: &[Swing], uneven: bool) {
        let time = times(600, uneven);
        let history: Vec<f64> = time.iter().map(|t| offset + value(swings, *t)).collect();
        let fit = DampingFit::of(&time, &history).unwrap();
        assert!(fit.residual < 1e-9 && (fit.constant - offset).abs() < 1e-8, "{fit:?}");
        assert_eq!(fit.modes.len(), swings.len(), "{fit:?}");
        for s in swings {
            let near = |m: &&Oscillation| (m.frequency - s.frequency).abs() < 1e-2;
            let m = fit.modes.iter().find(near).unwrap_or_else(|| panic!("{}: {fit:?}", s.frequency));
            assert!((m.frequency / s.frequency - 1.0).abs() < 1e-6, "{fit:?}");
            let scale = if s.growth == 0.0 { s.frequency } else { s.growth.abs() };
            assert!((m.growth_rate - s.growth).abs() < 1e-6 * scale, "{fit:?}");
            assert!((m.damping_ratio + s.growth / s.growth.hypot(s.frequency)).abs() < 1e-6);
            let end = time[time.len() - 1];
            assert!((m.amplitude / (s.size * (s.growth * end).exp()) - 1.0).abs() < 1e-6, "{fit:?}");
        }
    }

    #[test]
    fn exact_oscillations_are_found_to_round_off() {
        for uneven in [false, true] {
            assert_exact(0.0, &[swing(-0.01, 2.0, 0.3, 0.4)], uneven);
            assert_exact(5.0, &[swing(0.03, 1.3, 1e-4, -1.0)], uneven);
            assert_exact(-0.2, &[swing(0.0, 1.1, 0.6, 2.0)], uneven);
            assert_exact(0.1, &[swing(-0.02, 1.0, 0.3, 0.4), swing(0.005, 1.15, 0.2, 1.0)], uneven);
            let three = [swing(-0.02, 1.0, 0.3, 0.4), swing(0.01, 1.5, 0.2, 1.0), swing(-0.01, 3.1, 0.1, 0.0)];
            assert_exact(0.7, &three, uneven);
        }
    }

    #[test]
    fn noise_costs_as_much_as_it_must() {
        let (time, exact) = (times(600, true), [swing(-0.02, 1.0, 0.3, 0.4), swing(0.01, 1.3, 0.2, 1.0)]);
        let mut seed = 7_u64;
        let mut noise = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            1e-6 * ((seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
        };
        let history: Vec<f64> = time.iter().map(|t| 0.3 + value(&exact, *t) + noise()).collect();
        let fit = DampingFit::of(&time, &history).unwrap();
        assert!(fit.modes.len() == 2 && 1e-7 < fit.residual && fit.residual < 1e-5, "{fit:?}");
        for (m, s) in fit.modes.iter().zip([exact[1], exact[0]]) {
            let error = (m.frequency - s.frequency).abs().max((m.growth_rate - s.growth).abs());
            assert!(error < 2e-6, "{error:e} {fit:?}");
        }
    }

    #[test]
    fn a_drift_is_no_oscillation_and_does_no_harm() {
        let time = times(500, true);
        let history: Vec<f64> =
            time.iter().map(|t| (-0.05 * t).exp() + value(&[swing(-0.01, 1.7, 0.1, 0.0)], *t)).collect();
        let fit = DampingFit::of(&time, &history).unwrap();
        assert!((fit.modes[0].frequency - 1.7).abs() < 1e-6 && (fit.modes[0].growth_rate + 0.01).abs() < 1e-6);
        let drift: Vec<f64> = time.iter().map(|t| (-0.05 * t).exp()).collect();
        assert_eq!(DampingFit::of(&time, &drift), Err(NoFit::NoOscillation));
    }

    #[test]
    fn what_has_no_frequency_is_refused() {
        let time = times(200, false);
        let of = |f: &dyn Fn(f64) -> f64| DampingFit::of(&time, &time.iter().map(|t| f(*t)).collect::<Vec<_>>());
        let short = |cycles: f64| std::f64::consts::TAU * cycles / time[time.len() - 1];
        assert!(matches!(of(&|t| (short(1.4) * t).sin()), Err(NoFit::Short { cycles }) if (cycles - 1.4).abs() < 1e-3));
        assert!((of(&|t| (short(1.6) * t).sin()).unwrap().modes[0].frequency / short(1.6) - 1.0).abs() < 1e-6);
        assert_eq!(of(&|_| 0.3), Err(NoFit::Still));
        assert_eq!(of(&|_| f64::NAN), Err(NoFit::NotFinite));
        assert_eq!(DampingFit::of(&[], &[]), Err(NoFit::Few { found: 0 }));
        let still = vec![0.0; 40];
        assert_eq!(DampingFit::of(&still, &still), Err(NoFit::Few { found: 1 }), "no time passes");
        let told = NoFit::Short { cycles: 1.4 }.to_string();
        assert_eq!(told, "the history holds 1.40 cycles; a frequency needs at least 1.5");
    }

    /// q'' = f(q, q') by the method of Runge and Kutta, from q = 1.
    fn marched(steps: usize, step: f64, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let rate = |[x, v]: [f64; 2]| [v, f(x, v)];
        let mut state = [1.0, 0.0];
        let advance = |_| {
            let now = state;
            let moved = |k: [f64; 2], h: f64| [now[0] + h * k[0], now[1] + h * k[1]];
            let a = rate(now);
            let b = rate(moved(a, 0.5 * step));
            let c = rate(moved(b, 0.5 * step));
            let d = rate(moved(c, step));
            state = std::array::from_fn(|i| now[i] + step / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
            now[0]
        };
        (0..steps).map(advance).collect()
    }

    #[test] // Van der Pol, ε = 0.1: amplitude 2 + ε²/96, ω = 1 − ε²/16 (Andersen and Geer 1982)
    fn limit_cycles_have_a_frequency_and_an_amplitude() {
        let history = marched(8000, 0.05, |x, v| 0.1 * (1.0 - x * x) * v - x);
        let time: Vec<f64> = (0..8000).map(|k| 0.05 * f64::from(k)).collect();
        let fit = DampingFit::of(&time, &history).unwrap();
        let first = fit.modes[0];
        assert!((first.frequency - (1.0 - 0.01 / 16.0)).abs() < 1e-5, "{fit:?}");
        assert!(first.growth_rate.abs() < 1e-5 && fit.residual < 1e-3, "{fit:?}");
        let last = LastCycles::of(&time, &history, first.frequency).unwrap();
        assert!((last.amplitude - 2.0 - 0.01 / 96.0).abs() < 1e-4 && last.mean.abs() < 1e-3, "{last:?}");
        assert!(last.cycles == LAST && last.spread < 1e-4);
    }

    #[test] // q'' + 0.02 q' + q + q³/2 = 0 decays at half its damping for any spring; its frequency falls from 1.15 to 1
    fn a_frequency_that_changes_with_amplitude_is_one_that_decays() {
        let history = marched(2000, 0.05, |x, v| -x - 0.5 * x * x * x - 0.02 * v);
        let time: Vec<f64> = (0..2000).map(|k| 0.05 * f64::from(k)).collect();
        let fit = DampingFit::of(&time, &history).unwrap();
        let first = fit.modes[0];
        assert!((first.frequency - 1.04).abs() < 0.02 && (first.growth_rate + 0.01).abs() < 0.002, "{fit:?}");
        assert!(fit.residual > 1e-3 && fit.modes.iter().all(|m| m.growth_rate < 0.0), "the misfit tells: {fit:?}");
    }

    #[test]
    fn energy_of_a_cycle_is_the_integral_of_power() {
        let time = times(400, true);
        let power: Vec<f64> = time.iter().map(|t| 0.3 * (2.0 * t).cos().powi(2)).collect();
        let energy = energy_per_cycle(&time, &power, 2.0).unwrap();
        assert!((energy - 0.15 * std::f64::consts::PI).abs() < 1e-3, "{energy}");
        assert_eq!(energy_per_cycle(&time, &power, 0.1), None);
        assert_eq!(energy_per_cycle(&[], &[], 1.0), None);
    }
}
