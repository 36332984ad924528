//! Rows of a flutter boundary: changes from decay to growth, motions at speeds, and where the cloud decides.
use serde::{Deserialize, Serialize};

use super::numbers::or_infinite;
use super::shape::Share;
use super::wall_motion::WallMotion;

/// A change from decay to growth, or back.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct FlutterRow {
    /// `flutter`, `restabilised` or `divergence`.
    pub kind: String,
    /// `mode 1`: that of a natural mode; `divergence 1`: a motion that grows without oscillating.
    pub branch: String,
    /// Number of the mode in still air, from 1; none of a motion that does not oscillate.
    pub mode: Option<usize>,
    /// Speed over that of the structure in the case.
    pub speed_ratio: f64,
    /// Speed index, where the structure has a mass ratio and a frequency of pitch.
    pub speed_index: Option<f64>,
    /// V*, the same times the root of the mass ratio.
    pub reduced_speed: Option<f64>,
    /// Speed in the units of the case.
    pub speed: f64,
    /// Equivalent airspeed in m/s, where the stream has units.
    pub equivalent_airspeed: Option<f64>,
    /// Density in the units of the case.
    pub density: f64,
    /// Dynamic pressure in the units of the case.
    pub dynamic_pressure: f64,
    /// Mass ratio at this density, where the structure is a section.
    pub mass_ratio: Option<f64>,
    /// Geometric altitude in metres, where that is varied.
    pub altitude: Option<f64>,
    /// k.
    pub reduced_frequency: f64,
    /// Frequency in cycles per unit of time of the case.
    pub frequency: f64,
    /// The same over that of pitch alone, where the structure is a section.
    pub frequency_ratio: Option<f64>,
    /// Relative change of the speed, of the root of the dynamic pressure, between the last two interpolations.
    #[serde(deserialize_with = "or_infinite")]
    pub error: f64,
    /// Relative error bar of the same that the spacing of the cloud leaves; none where there is no coarser cloud to tell it.
    pub cloud_error: Option<f64>,
    /// Half widths of error bars: the greater of both errors in the unit of each number.
    #[serde(flatten)]
    pub bars: Bars,
    /// What the g-method finds of the same, less one; none at divergence, and where it finds nothing.
    pub g_method: Option<f64>,
    /// Greatest damping g, growth positive, over the next fifth of the speed; of flutter alone.
    pub growth: Option<f64>,
    /// Structural damping g that holds the motion, where it grows so little that this is usual.
    pub holding_damping: Option<f64>,
    /// Equivalent airspeed over the design speed, less one, where that is given.
    pub margin: Option<f64>,
    /// What is to be said of it, for people.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
    /// True when k lies beyond the frequencies that forces were computed at.
    pub extrapolated: bool,
    /// How much each coordinate takes part.
    pub shape: Vec<Share>,
    /// The walls in this motion with the pressure on them, where the gas was solved here.
    #[serde(skip)]
    pub walls: Option<WallMotion>,
}

impl FlutterRow {
    /// What is to be said of how it begins and grows, for people.
    pub fn told(&self) -> Vec<String> {
        let from_nothing = Some(self.kind.as_str()).filter(|_| self.dynamic_pressure == 0.0);
        let begins = match from_nothing {
            Some("divergence") => Some("diverges at any speed: nothing holds it".to_owned()),
            Some("flutter") => Some("grows from the start: at any density".to_owned()),
            _ => None,
        };
        let shallow = self.growth.zip(self.holding_damping).map(|(growth, holding)| {
            format!(
                "shallow: g up to {growth:.4} over the next 20 % of speed, structural damping g = {holding:.4} holds it"
            )
        });
        begins.into_iter().chain(shallow).collect()
    }

    /// Name of the motion that it belongs to; files of former versions number it alone.
    pub fn name(&self) -> String {
        match (self.branch.is_empty(), self.mode) {
            (true, Some(mode)) => format!("mode {mode}"),
            _ => self.branch.clone(),
        }
    }

    /// Half length of its error bar, over the speed: the greater of both errors; infinite where nothing is known of it.
    pub fn bar(&self) -> f64 {
        self.cloud_error.map_or(self.error, |cloud| cloud.max(self.error))
    }
}

/// Half widths of error bars, each in the unit of its number; none where that does not vary or nothing is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bars {
    /// Of the speed over that of the case.
    pub speed_ratio_error: Option<f64>,
    /// Of the speed index.
    pub speed_index_error: Option<f64>,
    /// Of V*.
    pub reduced_speed_error: Option<f64>,
    /// Of the speed.
    pub speed_error: Option<f64>,
    /// Of the equivalent airspeed.
    pub equivalent_airspeed_error: Option<f64>,
    /// Of the density.
    pub density_error: Option<f64>,
    /// Of the dynamic pressure.
    pub dynamic_pressure_error: Option<f64>,
    /// Of the altitude.
    pub altitude_error: Option<f64>,
}

/// A motion at a speed.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct MotionRow {
    /// `mode 1`: that of a natural mode; `divergence 1`: a motion that grows without oscillating.
    pub branch: String,
    /// Number of the mode in still air, from 1; none of a motion that does not oscillate.
    pub mode: Option<usize>,
    /// Speed over that of the structure in the case.
    pub speed_ratio: f64,
    /// Speed in the units of the case.
    pub speed: f64,
    /// Equivalent airspeed in m/s, where the stream has units.
    pub equivalent_airspeed: Option<f64>,
    /// Dynamic pressure in the units of the case.
    pub dynamic_pressure: f64,
    /// Density in the units of the case.
    pub density: f64,
    /// Geometric altitude in metres, where that is varied.
    pub altitude: Option<f64>,
    /// k; infinite where nothing flows.
    #[serde(deserialize_with = "or_infinite")]
    pub reduced_frequency: f64,
    /// 2 Re λ/|λ|; of motions that do not oscillate 2 b λ/(U ln 2).
    pub damping: f64,
    /// Cycles per unit of time of the case.
    pub frequency: f64,
    /// λ over the rate of the fastest natural mode: real and imaginary part.
    pub eigenvalue: [f64; 2],
}

impl MotionRow {
    /// True of a mode that decays without oscillating, whose damping says little.
    pub fn rests(&self) -> bool {
        self.frequency == 0.0 && self.eigenvalue[0] <= 0.0
    }
}

/// A range of speed in which the spacing of the cloud decides whether a motion grows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Doubt {
    /// Branch of the motion.
    pub branch: String,
    /// `coarser_cloud_only`, `nearly`, `this_cloud_only` or `gap`.
    pub kind: String,
    /// Speeds over that of the case between which it is.
    pub speed_ratio: [f64; 2],
    /// Speeds in the units of the case.
    pub speed: [f64; 2],
    /// Equivalent airspeeds in m/s, where the stream has units.
    pub equivalent_airspeed: Option<[f64; 2]>,
    /// Dynamic pressures in the units of the case.
    pub dynamic_pressure: [f64; 2],
    /// Altitudes in metres, where these are varied.
    pub altitude: Option<[f64; 2]>,
    /// Greatest damping g there, growth positive; in a gap the least.
    pub damping: f64,
    /// The same on a coarser cloud.
    pub damping_coarser: f64,
    /// Spacing of that cloud over that of this one.
    pub spacing_ratio: f64,
}

/// What is left to the design speed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Clearance {
    /// V_D, equivalent airspeed in m/s.
    pub design_speed: f64,
    /// Equivalent airspeed that must be free of flutter and divergence, in m/s.
    pub required: f64,
    /// Lowest equivalent airspeed at which a motion begins to grow, in m/s; none where none does.
    pub lowest: Option<f64>,
    /// Half width of its error bar.
    pub lowest_error: Option<f64>,
    /// The same over V_D, less one.
    pub margin: Option<f64>,
    /// True where the lower end of the error bar is not below what is required.
    pub passes: bool,
    /// Why, for people.
    pub reason: String,
}
