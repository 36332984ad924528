//! What stands on the axis of a body: the line through its middle along the stream.
use super::{Measured, Value};
use crate::claims::metrics;
use crate::exact::shock::{normal_shock, rayleigh_pitot_coefficient};
use crate::math::Vector;

/// Half-width of the strip along the axis, in local spacings.
const AXIS: f64 = 2.0;

/// A particle of that strip.
struct Sample {
    /// Place along the stream from the middle of the body, and distance from the axis.
    at: [f64; 2],
    density: f64,
    /// Velocity along the stream.
    along: f64,
}

impl Measured {
    /// Length in chords over which the gas behind the body runs against the stream.
    pub(super) fn wake_length(&self) -> Value {
        let rear = self.reach(1.0);
        let behind = self.on_axis()?.into_iter().filter(|s| s.at[0] > rear);
        let samples: Vec<[f64; 3]> = behind.map(|s| [s.at[0] - rear, s.at[1], s.along]).collect();
        let end = metrics::wake_end(&samples).ok_or("no gas behind the body runs against the stream")?;
        Ok(end / self.chord())
    }

    /// Greatest pressure on the wall over that behind a normal shock, brought to rest.
    pub(super) fn pitot_pressure(&self) -> Value {
        let (mach, gamma) = (self.case.flow.reference().mach, self.case.flow.gamma);
        let cp = rayleigh_pitot_coefficient(mach, gamma).map_err(|e| e.to_string())?;
        let found = self.wall.cp.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let pressure = |cp: f64| 1.0 + 0.5 * gamma * mach * mach * cp;
        Ok(pressure(found) / pressure(cp))
    }

    /// Distance of the bow shock from the nose in half lengths of the body.
    pub(super) fn stand_off(&self) -> Value {
        let flow = &self.case.flow;
        let jump = normal_shock(flow.reference().mach, flow.gamma).map_err(|e| e.to_string())?;
        let middle = 0.5 * (1.0 + jump.density) * self.stream().density;
        let nose = self.reach(-1.0);
        let mut samples = self.on_axis()?;
        samples.retain(|s| s.at[0] < -nose);
        samples.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
        let first = samples.iter().position(|s| s.density > middle).filter(|k| *k > 0).ok_or("no shock ahead")?;
        // particles beside the axis come in turn: the last ones ahead and the first ones behind, on either side of it
        let [ahead, behind] = [&samples[first - 1], &samples[first]];
        let part = (middle - ahead.density) / (behind.density - ahead.density);
        let shock = ahead.at[0] + part * (behind.at[0] - ahead.at[0]);
        Ok((-nose - shock) / (0.5 * (nose + self.reach(1.0))))
    }

    /// How far the body reaches from its middle along the stream times `sign`.
    fn reach(&self, sign: f64) -> f64 {
        let (centre, along) = (self.body_centre(), self.along());
        self.wall.x.iter().map(|x| sign * (*x - centre).dot(&along)).fold(f64::NEG_INFINITY, f64::max)
    }

    fn along(&self) -> Vector<3> {
        let stream = self.stream().velocity;
        stream * (1.0 / stream.norm())
    }

    /// The fluid particles near the axis.
    fn on_axis(&self) -> Result<Vec<Sample>, String> {
        let (centre, along) = (self.body_centre(), self.along());
        let (velocity, spacing) = (self.column("velocity")?, self.column("spacing")?);
        let density = self.column("density")?;
        let sample = |i: usize| {
            let d = Vector(self.field.points[i]) - centre;
            let v = Vector::<3>::from_fn(|k| velocity[3 * i + k]);
            let x = d.dot(&along);
            let across = (d - along * x).norm();
            (across <= AXIS * spacing[i]).then(|| Sample { at: [x, across], density: density[i], along: v.dot(&along) })
        };
        Ok(self.fluid()?.into_iter().filter_map(sample).collect())
    }
}
