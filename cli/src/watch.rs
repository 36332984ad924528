//! Between a run and its user: progress out, signals in.
use std::sync::atomic::Ordering;
use std::time::Instant;

use alula::run::{Monitor, Portion, Tick, TimeLeft};

use crate::arguments::Verbosity;
use crate::interrupt::Interrupt;
use crate::progress::{self, Left, Progress};

/// Shows progress and passes signals on.
pub(crate) struct Watch {
    progress: Progress,
    interrupt: Interrupt,
    quiet: bool,
    began: Instant,
    time_left: TimeLeft,
    first: Option<u64>,
}

impl Watch {
    /// A watch with the verbosity asked for.
    pub(crate) fn new(verbosity: Verbosity) -> Self {
        Self {
            progress: Progress::new(verbosity),
            interrupt: Interrupt::install().unwrap_or_default(),
            quiet: verbosity.quiet,
            began: Instant::now(),
            time_left: TimeLeft::default(),
            first: None,
        }
    }

    /// The same, which ends the process at once where it is told to stop while nothing is iterated, after `farewell`.
    pub(crate) fn with_farewell(mut self, farewell: impl Fn() + Send + 'static) -> Self {
        let leave = self.progress.leaving();
        let told = self.interrupt.ends_between_iterations(move || {
            leave();
            farewell();
        });
        // what is read before a run begins is not written down
        self.interrupt.idle.store(true, Ordering::Relaxed);
        if let Err(problem) = told {
            self.note(&format!("signals are heard between iterations only: {problem}"));
        }
        self
    }

    /// Time left in this portion of the run.
    fn left(&mut self, now: &Portion) -> Option<Left> {
        let seconds = self.time_left.seconds(now)?;
        Some(Left { seconds, at_most: now.may_end_early })
    }

    /// The line that shows progress, to close it and to print events.
    pub(crate) fn progress(&mut self) -> &mut Progress {
        &mut self.progress
    }
}

impl Monitor for Watch {
    fn tick(&mut self, tick: &Tick) {
        self.interrupt.idle.store(false, Ordering::Relaxed);
        let first = *self.first.get_or_insert(tick.iteration.saturating_sub(1));
        let seconds = self.began.elapsed().as_secs_f64();
        let left = self.left(&tick.portion);
        self.progress.tick(&progress::Tick {
            iteration: tick.iteration,
            orders: -tick.residual.max(f64::MIN_POSITIVE).log10(),
            residual: tick.residual,
            cfl: tick.cfl,
            loads: tick.loads,
            rate: (tick.iteration - first) as f64 / seconds.max(1e-9),
            particles: tick.particles,
            left,
            march: tick.march,
            point: tick.point,
        });
    }

    fn doing(&mut self, what: &str, now: &Portion) {
        self.interrupt.idle.store(true, Ordering::Relaxed);
        let left = self.left(now);
        self.progress.doing(what, left);
    }

    fn note(&mut self, text: &str) {
        if !self.quiet {
            self.progress.note(text);
        }
    }

    fn warn(&mut self, text: &str) {
        if !self.quiet {
            self.progress.warn(text);
        }
    }

    fn stop(&self) -> bool {
        // whoever asks stops by itself
        self.interrupt.idle.store(false, Ordering::Relaxed);
        self.interrupt.stopping()
    }

    fn checkpoint(&self) -> bool {
        self.interrupt.take_checkpoint()
    }
}
