//! Required accuracy of the loads: the table `[accuracy]`.
use super::kinds::COUNT;
use super::quantity::{Ratio, WallTime};
use super::schema::{Absent, Kind, Range, defaulted, keys, optional, words};

keys! {
    /// Required accuracy of the loads of a steady case, and the kinds of errors that are estimated in other cases.
    #[derive(Copy)]
    pub struct Accuracy, ACCURACY {
        /// Half width of the error bars of CL, CD and CM over their value, or over 0.1, 0.01 and 0.02 where that is
        /// smaller. Polars: 5 %, in 3-D 10 %.
        loads: Ratio = defaulted(
            Kind::Quantity(Ratio::DIMENSION, Range { min: 0.0, max: 0.5, closed: false }), Absent::Number(0.01),
        ),
        /// Greatest number of particles: the run ends on the finest cloud below it where the error bars are not short
        /// enough before (in 3-D: 250 000).
        particles: usize = defaulted(COUNT, Absent::Integer(50_000)),
        /// Wall-clock time, a plain number in seconds: the run ends on the cloud after which the next, finer one would
        /// not end within it.
        time: Option<WallTime> = optional(Kind::Quantity(WallTime::DIMENSION, Range::POSITIVE), "none"),
        /// Errors of the loads of a march or a harmonic balance that are told, each by one further run. Steady cases
        /// have a family of clouds.
        #[serde(default)]
        error: LoadErrors = defaulted(Kind::Words(LOAD_ERRORS), Absent::Word("none")),
    }
}

words! {
    /// Errors of the loads of a time march or a harmonic balance that are estimated by additional runs.
    pub enum LoadErrors, LOAD_ERRORS = None {
        /// none, without a further run
        None = "none",
        /// that of the cloud, by a run with twice the spacing: a quarter of the time more in the plane, a tenth in
        /// space
        Cloud = "cloud",
        /// that of the step in time of a march, by a run with twice the step (three quarters of the time more), of
        /// explicit steps by one with half of it (twice the time more)
        Step = "step",
        /// that of the number of harmonics of a balance, by a run with one harmonic less, of one or two with one more:
        /// about as much time again
        Harmonics = "harmonics",
        /// that of the cloud, and that of the step or of the number of harmonics
        All = "all",
    }
}

impl Default for Accuracy {
    fn default() -> Self {
        ACCURACY.value()
    }
}

impl Accuracy {
    /// Default limit of the number of particles in 3-D.
    pub const PARTICLES_IN_SPACE: usize = 250_000;

    /// Default of the relative half-width of the error bars for the points of a polar, in 2-D and 3-D. It is larger
    /// than for single cases, because a point is judged together with its neighbours. In 2-D, 5 % is 5 drag counts
    /// where the drag is near zero.
    pub const OF_POLARS: [f64; 2] = [0.05, 0.1];

    /// Defaults for a case of this dimension.
    pub fn in_dimension(dimension: usize) -> Self {
        let usual = Self::default();
        Self { particles: if dimension == 3 { Self::PARTICLES_IN_SPACE } else { usual.particles }, ..usual }
    }

    /// Defaults for a case with or without a polar.
    pub fn usual(dimension: usize, polar: bool) -> Self {
        let one = Self::in_dimension(dimension);
        Self { loads: if polar { Ratio(Self::OF_POLARS[dimension - 2]) } else { one.loads }, ..one }
    }
}
