//! Points of a polar.
use serde::{Deserialize, Serialize};

use crate::case::Flow;
use crate::math::digits::{fixed, short};
use crate::observe::loads::Coefficients;

/// One point of a polar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolarPoint {
    /// Mach number of the free stream.
    pub mach: f64,
    /// Angle of attack in degrees, nose up positive.
    pub alpha_deg: f64,
    /// Loads on the walls; absent where the point failed.
    pub loads: Option<Coefficients>,
    /// Loads from the momentum of the gas around the bodies.
    pub loads_momentum_balance: Option<Coefficients>,
    /// Half widths of the error bars, where the loads were found on a family of clouds.
    pub loads_error: Option<Coefficients>,
    /// Whether they are as short as was asked for.
    pub within_accuracy: Option<bool>,
    /// Names of the loads whose error bars are longer than was asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub long_bars: Vec<String>,
    /// Particles, images left out.
    pub particles: usize,
    /// Orders of magnitude that the residual fell on the last cloud.
    pub residual_drop: f64,
    /// Iterations on all clouds.
    pub iterations: u64,
    /// True where it was started from rest, not from a neighbouring point.
    pub from_rest: bool,
    /// Processor seconds.
    pub cpu_seconds: f64,
    /// True when the goal was reached.
    pub converged: bool,
    /// Why it was not; empty where it was.
    pub reason: String,
}

impl PolarPoint {
    /// The point in the free stream `flow`, of which nothing is known yet.
    pub fn of(flow: &Flow) -> Self {
        Self {
            mach: flow.reference().mach,
            alpha_deg: flow.alpha.degrees(),
            loads: None,
            loads_momentum_balance: None,
            loads_error: None,
            within_accuracy: None,
            long_bars: Vec::new(),
            particles: 0,
            residual_drop: 0.0,
            iterations: 0,
            from_rest: false,
            cpu_seconds: 0.0,
            converged: false,
            reason: String::new(),
        }
    }

    /// True where the error bars are longer than was asked for.
    pub fn is_short(&self) -> bool {
        self.within_accuracy == Some(false)
    }

    /// Which error bars are longer than was asked for, for people.
    pub fn long_in_words(&self) -> String {
        match &self.long_bars[..] {
            [] => "longer error bars than asked for".to_owned(),
            names => format!("error bar of {} longer than asked for", names.join(", ")),
        }
    }

    /// The point in one line for those who watch.
    pub fn told(&self) -> String {
        let at = format!("M {}, alpha {} deg", short(self.mach), short(self.alpha_deg));
        let bars = self.loads_error;
        let load = |name: &str, value: f64, bar: fn(&Coefficients) -> f64| {
            let bar = bars.as_ref().map_or_else(String::new, |b| format!(" ± {:.5}", bar(b)));
            format!("{name} {}{bar}", fixed(value, 5))
        };
        let loads = self.loads.map(|c| {
            let all = [load("CL", c.cl, |b| b.cl), load("CD", c.cd, |b| b.cd), load("CM", c.cm, |b| b.cm)];
            all.join(", ")
        });
        let loads = loads.map(|l| if self.is_short() { format!("{l} ({})", self.long_in_words()) } else { l });
        let parts = [Some(at), loads, (!self.converged).then(|| format!("not converged: {}", self.reason))];
        parts.into_iter().flatten().collect::<Vec<_>>().join(": ")
    }
}
