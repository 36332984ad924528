//! Signals that a run listens to.
//!
//! SIGINT and SIGTERM ask the run to finish its iteration, write a checkpoint and stop; a second one ends the process at
//! once. SIGHUP asks for the same, any number of times (a terminal that closes may send two), unless it was ignored when
//! the program began, as under `nohup`. SIGUSR1 asks for a checkpoint now. Handlers only set flags: the run loop looks at them between iterations.
//! While there are none, as while a cloud is built, nothing would be written down that is not on the disk already: a thread that waits for the same
//! signals ends the process then.
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use signal_hook::iterator::Signals;

use crate::outcome::Outcome;

/// Flags set by signals.
#[derive(Clone, Debug, Default)]
pub(crate) struct Interrupt {
    /// Finish the iteration, write a checkpoint and stop.
    pub(crate) stop: Arc<AtomicBool>,
    /// Write a checkpoint and go on.
    pub(crate) checkpoint: Arc<AtomicBool>,
    /// Nobody asks whether to stop: what goes on has no iterations.
    pub(crate) idle: Arc<AtomicBool>,
}

impl Interrupt {
    /// Starts listening; call it once, before the run.
    pub(crate) fn install() -> io::Result<Self> {
        let flags = Self::default();
        for signal in [SIGINT, SIGTERM] {
            // In this order: the first signal finds `stop` unset and sets it, the second finds it set and exits.
            flag::register_conditional_shutdown(signal, Outcome::Interrupted as i32, Arc::clone(&flags.stop))?;
            flag::register(signal, Arc::clone(&flags.stop))?;
        }
        #[cfg(unix)]
        {
            use signal_hook::consts::{SIGHUP, SIGUSR1};
            flag::register(SIGUSR1, Arc::clone(&flags.checkpoint))?;
            if is_heard(SIGHUP) {
                flag::register(SIGHUP, Arc::clone(&flags.stop))?;
            }
        }
        Ok(flags)
    }

    /// From now on a signal to stop ends the process at once where there are no iterations, after `farewell`.
    pub(crate) fn ends_between_iterations(&self, farewell: impl Fn() + Send + 'static) -> io::Result<()> {
        let idle = Arc::clone(&self.idle);
        let mut signals = Signals::new(to_stop())?;
        std::thread::spawn(move || {
            for _ in signals.forever() {
                if idle.load(Ordering::Relaxed) {
                    farewell();
                    std::process::exit(Outcome::Interrupted as i32);
                }
            }
        });
        Ok(())
    }

    /// True when the run shall stop after this iteration.
    pub(crate) fn stopping(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// True once for every request of a checkpoint.
    pub(crate) fn take_checkpoint(&self) -> bool {
        self.checkpoint.swap(false, Ordering::Relaxed)
    }

    /// What to tell after an interrupted run in the folder `run`.
    pub(crate) fn farewell(run: &Path, iteration: u64) -> String {
        format!("interrupted after iteration {iteration}; go on with `alula resume {}`", run.display())
    }
}

/// Signals that ask a run to stop.
fn to_stop() -> Vec<i32> {
    #[cfg(unix)]
    let hangup = Some(signal_hook::consts::SIGHUP).filter(|hangup| is_heard(*hangup));
    #[cfg(not(unix))]
    let hangup = None;
    [SIGINT, SIGTERM].into_iter().chain(hangup).collect()
}

/// True when the system says that the process was not told to ignore `signal`: a handler would end what `nohup` protects.
#[cfg(unix)]
fn is_heard(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_some_and(|mask| mask >> (signal - 1) & 1 == 0)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use signal_hook::{consts::SIGUSR1, low_level::raise};

    #[test]
    fn signals_set_their_flags_once() {
        let flags = Interrupt::install().unwrap();
        assert!(!flags.stopping() && !flags.take_checkpoint());
        raise(SIGUSR1).unwrap();
        assert!(flags.take_checkpoint() && !flags.take_checkpoint() && !flags.stopping());
        raise(SIGINT).unwrap();
        assert!(flags.stopping());
        assert!(Interrupt::farewell(Path::new("out"), 7).ends_with("`alula resume out`"));
    }
}
