//! What a run tells while it goes, and what it is told.
use super::time_left::Portion;

/// What a run tells while it goes, and what it is told.
pub trait Monitor {
    /// After every iteration.
    fn tick(&mut self, tick: &Tick);
    /// What begins now and tells of no iterations, as building a cloud; it is over with the next thing that is told.
    fn doing(&mut self, _: &str, _: &Portion) {}
    /// Something worth a line.
    fn note(&mut self, text: &str);
    /// Something that makes results doubtful; a note with that word unless a monitor has another way to tell it.
    fn warn(&mut self, text: &str) {
        self.note(&format!("warning: {text}"));
    }
    /// True when the run should write a checkpoint and stop.
    fn stop(&self) -> bool {
        false
    }
    /// True when a checkpoint should be written now.
    fn checkpoint(&self) -> bool {
        false
    }
}

/// A monitor that says nothing.
pub struct Silent;
impl Monitor for Silent {
    fn tick(&mut self, _: &Tick) {}
    fn note(&mut self, _: &str) {}
}

/// Passes on all but notes and warnings.
pub(crate) struct Quiet<'a> {
    pub(crate) monitor: &'a mut dyn Monitor,
}

impl Monitor for Quiet<'_> {
    fn tick(&mut self, tick: &Tick) {
        self.monitor.tick(tick);
    }
    fn doing(&mut self, what: &str, now: &Portion) {
        self.monitor.doing(what, now);
    }
    fn note(&mut self, _: &str) {}
    fn stop(&self) -> bool {
        self.monitor.stop()
    }
    fn checkpoint(&self) -> bool {
        self.monitor.checkpoint()
    }
}

/// Passes on all that a run tells which is the part `outer` of a larger one.
pub(crate) struct Within<'a> {
    pub(crate) monitor: &'a mut dyn Monitor,
    pub(crate) outer: Portion,
}

impl Monitor for Within<'_> {
    fn tick(&mut self, tick: &Tick) {
        self.monitor.tick(&Tick { portion: tick.portion.within(&self.outer), ..*tick });
    }
    fn doing(&mut self, what: &str, now: &Portion) {
        self.monitor.doing(what, &now.within(&self.outer));
    }
    fn note(&mut self, text: &str) {
        self.monitor.note(text);
    }
    fn warn(&mut self, text: &str) {
        self.monitor.warn(text);
    }
    fn stop(&self) -> bool {
        self.monitor.stop()
    }
    fn checkpoint(&self) -> bool {
        self.monitor.checkpoint()
    }
}

/// State of a run after an iteration.
#[derive(Clone, Copy, Debug)]
pub struct Tick {
    /// Iterations over all stages.
    pub iteration: u64,
    /// Part of the whole run that it is in, and how far that is.
    pub portion: Portion,
    /// Residual over its first value.
    pub residual: f64,
    /// Courant number.
    pub cfl: f64,
    /// CL, CD, CM when there are bodies.
    pub loads: Option<[f64; 3]>,
    /// Number of fluid particles.
    pub particles: usize,
    /// Where a march stands; absent elsewhere.
    pub march: Option<MarchTick>,
    /// Present point of a polar from 0, and their number; absent elsewhere.
    pub point: Option<[usize; 2]>,
}

/// Where a march stands; times are in the units of the case.
#[derive(Clone, Copy, Debug)]
pub struct MarchTick {
    /// Time.
    pub time: f64,
    /// Time at which it ends.
    pub until: f64,
    /// Period of the motion, where that repeats.
    pub period: Option<f64>,
    /// Angle of the first body that moves, radians, nose up, where something moves.
    pub angle: Option<f64>,
    /// Lift a period ago, where there is one.
    pub lift_before: Option<f64>,
}
