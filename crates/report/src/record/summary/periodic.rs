//! Loads of motions that repeat.
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::observe::cycles::Cycles;
use crate::observe::loads::Coefficients;

/// Loads of a motion that repeats.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Periodic {
    /// What a harmonic balance found about itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub harmonic_balance: Option<BalanceReport>,
    /// Forces on the modes of `[gaf]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub generalised_forces: Vec<GeneralisedForce>,
    /// How the loads of the last period differ from those of the one before, where the motion repeats; absent where there is none before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic_change: Option<Change>,
    /// First harmonics of the loads per motion, where that repeats.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub first_harmonics: Vec<FirstHarmonics>,
    /// Loads of the last period by momentum balance, against those on the walls.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub momentum_of_period: Option<LoadCrosscheck>,
    /// Mean and greatest loads of the last period of the motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_period: Option<LastPeriod>,
    /// Means and first harmonics of the loads in the last period of the motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic_loads: Option<PeriodicLoads>,
    /// Last whole cycles of the lift of a march, found from its history: a frequency that no motion prescribes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lift_cycles: Option<Cycles>,
}

/// What a harmonic balance found about itself.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct BalanceReport {
    /// Number of harmonics N.
    pub harmonics: usize,
    /// Instances at which the equations were evaluated.
    pub instances: usize,
    /// Part of the last harmonic in all harmonics of the loads; absent with one harmonic.
    pub tail_loads: Option<f64>,
    /// The same of the density, root mean square over the volume.
    pub tail_density: Option<f64>,
    /// |ωD x − ẋ|/|ẋ| of the walls, root mean squares over walls and instances: what the harmonics lose of the motion.
    pub wall_velocity_error: f64,
    /// Evaluations of the residual of one instance, those on coarser clouds among them.
    pub evaluations: u64,
    /// How far a march from there ends from it, where `check` asks for one.
    pub march: Option<MarchingCheck>,
}

/// How far a march from a harmonic balance ends from it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MarchingCheck {
    /// Periods marched.
    pub periods: u32,
    /// Steps of each.
    pub steps_per_period: u32,
    /// Steps that did not reach their goal.
    pub unconverged: u32,
    /// Lift, where it has a first harmonic.
    pub cl: Option<Apart>,
    /// Drag.
    pub cd: Option<Apart>,
    /// Moment.
    pub cm: Option<Apart>,
}

/// A load in the last period of a march against that of the balance, over the first harmonic of the balance.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Apart {
    /// Difference of the means.
    pub mean: f64,
    /// Size of the difference of the first harmonics, complex.
    pub first_harmonic: f64,
}

impl MarchingCheck {
    /// A line for those who watch.
    pub fn told(&self) -> String {
        let named = [("lift", self.cl), ("drag", self.cd), ("moment", self.cm)];
        let apart = |(name, a): (&str, Option<Apart>)| {
            let a = a?;
            Some(format!("{name} {:.2} % (mean {:+.2} %)", 100.0 * a.first_harmonic, 100.0 * a.mean))
        };
        let all: Vec<String> = named.into_iter().filter_map(apart).collect();
        format!(
            "after {} periods of marching the first harmonics differ from the balance, in parts of themselves: {}",
            self.periods,
            if all.is_empty() { "no load has one".into() } else { all.join(", ") }
        )
    }
}

/// Generalised force on one mode over a period.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GeneralisedForce {
    /// Name of the mode.
    pub mode: String,
    /// Mean.
    pub mean: f64,
    /// First harmonic, f(t) = Re f exp(iωt): real and imaginary part.
    pub first: [f64; 2],
}

impl GeneralisedForce {
    /// First harmonic over that of a coordinate that goes as amplitude · sin ωt.
    pub fn per(&self, amplitude: f64) -> Complex64 {
        Complex64::new(self.first[0], self.first[1]) / Complex64::new(0.0, -amplitude)
    }
}

/// How the loads differ from those one period before.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Change {
    /// Periods marched.
    pub periods: f64,
    /// Greatest change of a mean over the first harmonic.
    pub mean: f64,
    /// Greatest change of a first harmonic over itself.
    pub first_harmonic: f64,
}

/// Loads over the last period of the motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LastPeriod {
    /// Mean of the lift.
    pub mean_cl: f64,
    /// Greatest lift.
    pub peak_cl: f64,
    /// Mean of the drag.
    pub mean_cd: f64,
    /// Greatest drag.
    pub peak_cd: f64,
}

/// First harmonics of the loads over that of one part of the motion: real and imaginary parts. Where a part has other harmonics, as
/// with several frequencies on their common one, so do these.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FirstHarmonics {
    /// `angle` (loads per radian), `shift_x`, `shift_y`, `shift_z` (per length) or `mode` (per unit of its coordinate).
    pub motion: String,
    /// Number of the harmonic.
    pub harmonic: usize,
    /// Lift.
    pub cl: [f64; 2],
    /// Drag.
    pub cd: [f64; 2],
    /// Sample.
    pub cm: [f64; 2],
}

/// Loads of the last period: f(t) = mean + amplitude cos(ωt + phase) and higher harmonics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeriodicLoads {
    /// Means.
    pub mean: Coefficients,
    /// Amplitudes of the harmonic that the motion has most of: the first, but for motions of several frequencies.
    pub amplitude: Coefficients,
    /// What that harmonic leads the motion by, degrees from -180 to 180.
    pub phase_deg: Coefficients,
    /// Amplitudes over that of the motion: per radian, per length or per unit of the coordinate of a mode.
    pub per_motion: Coefficients,
    /// Amplitude of the motion in that harmonic, in radians, lengths or units of its coordinate.
    pub motion_amplitude: f64,
    /// Number of the harmonic.
    pub harmonic: usize,
    /// Part of the motion that phases are measured against.
    pub motion: String,
}

/// How far two evaluations of a load lie apart over a period.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadsApart {
    /// Mean difference, momentum balance less walls.
    pub mean: f64,
    /// Root mean square of the difference.
    pub rms: f64,
    /// Greatest less smallest load on the walls at these moments.
    pub range: f64,
}

/// Loads of the last period by momentum balance, against those on the walls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadCrosscheck {
    /// Moments at which both were evaluated: of a march, or the instances of a harmonic balance.
    pub moments: usize,
    /// Lift.
    pub cl: LoadsApart,
    /// Drag.
    pub cd: LoadsApart,
    /// Moment.
    pub cm: LoadsApart,
}
