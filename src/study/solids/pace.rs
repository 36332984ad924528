//! When structures alone write checkpoints: after so many steps, or so much wall-clock time.
use super::super::record::work::Clock;
use crate::case::Output;

/// Times as long as a checkpoint took to write that must pass before the next one is due for the number of steps: explicit steps of
/// structures take microseconds, and checkpoints are to take a twentieth of the time at most.
const APART: f64 = 20.0;

/// When the next checkpoint is due.
pub(super) struct Pace {
    clock: Clock,
    /// Steps and wall seconds between checkpoints, at most.
    most: (u64, f64),
    /// Step and wall seconds at the last one.
    last: (u64, f64),
    /// Wall seconds that it took to write.
    took: f64,
}

impl Pace {
    /// As the case asks for, from step number `iteration` on.
    pub(super) fn new(output: &Output, iteration: u64) -> Self {
        let most = (u64::from(output.checkpoint.max(1)), output.checkpoint_time.0);
        Self { clock: Clock::start(), most, last: (iteration, 0.0), took: 0.0 }
    }

    /// True where a checkpoint is due after step number `iteration`.
    pub(super) fn is_due(&self, iteration: u64) -> bool {
        self.is_due_at(iteration, self.clock.wall_seconds())
    }

    fn is_due_at(&self, iteration: u64, now: f64) -> bool {
        let (steps, seconds) = (iteration.saturating_sub(self.last.0), now - self.last.1);
        seconds >= self.most.1 || (steps >= self.most.0 && seconds >= APART * self.took)
    }

    /// Writes a checkpoint after step number `iteration`.
    pub(super) fn write<E>(&mut self, iteration: u64, write: impl FnOnce() -> Result<(), E>) -> Result<(), E> {
        let began = self.clock.wall_seconds();
        write()?;
        self.written(iteration, (began, self.clock.wall_seconds()));
        Ok(())
    }

    fn written(&mut self, iteration: u64, (began, ended): (f64, f64)) {
        (self.last, self.took) = ((iteration, ended), ended - began);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::WallTime;

    #[test]
    fn checkpoints_are_due_after_steps_or_seconds_and_take_a_twentieth_of_the_time() {
        let output = Output { checkpoint: 10, checkpoint_time: WallTime(60.0), ..Output::default() };
        let mut pace = Pace::new(&output, 100);
        let due = |pace: &Pace, steps: u64, now: f64| pace.is_due_at(100 + steps, now);
        assert!(!due(&pace, 9, 1e-3) && due(&pace, 10, 1e-3) && due(&pace, 1, 60.0));
        pace.written(110, (1.0, 1.5));
        assert!(!due(&pace, 19, 50.0) && !due(&pace, 30, 11.0) && due(&pace, 30, 11.5));
        assert!(!due(&pace, 11, 61.0) && due(&pace, 11, 61.5));
    }
}
