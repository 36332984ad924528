//! The computation, beside the interpreter.
//!
//! A case is solved in threads of its own while the thread that asked waits without the interpreter lock. That thread alone
//! meets Python: it calls the callback, hears Ctrl-C, and tells the computation to stop after its iteration.
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use solver::case::Case;
use solver::observe::usage::threads_of_environment;
use solver::run::{
    Monitor, Outcome, RunError, Session, SolidOutcome, SolidSolution, Solution, Tick, case_of, continued, flutter,
    inspect, inspect_structure, is_finished, refusals, resume_solid,
};

use crate::aeroelastic::Flutter;
use crate::cases::Given;
use crate::faults;
use crate::results::Result as Found;
use crate::solids::Solid;
use crate::tables::python_of;

/// Longest wait between two looks at signals.
const PAUSE: Duration = Duration::from_millis(50);
/// Events that may wait for a slow callback before the computation waits as well.
const WAITING: usize = 64;
/// Stack of a thread that computes, as large as that of a program.
const STACK: usize = 8 << 20;

/// Solves a case.
///
/// Parameters
/// ----------
/// case : str, os.PathLike or dict
///     Path of a case file, or its keys as a dict. File names in a dict refer to the working folder.
/// out : str or os.PathLike, optional
///     Folder for tables, checkpoints, fields, pictures and the report; it must hold no run. Without it no file is written.
/// progress : callable, optional
///     Called with a dict: after every iteration `{"event": "iteration", ...}` with `iteration`, `residual` (over its first value),
///     `orders` (of magnitude that it fell), `cfl`, `cl`, `cd`, `cm` (None without bodies), `particles`, `time` and `until` (of a
///     march, else None), `point` and `points` (of a polar, else None); `{"event": "note", "message": ...}` for what is worth a
///     line, `"warning"` for what makes results doubtful. An exception in it ends the run as Ctrl-C does, and is raised.
/// threads : int, optional
///     Number of threads; default: one for each core. Results do not depend on it.
///
/// Returns
/// -------
/// Result
///     Loads, fields and history. `converged` tells whether the goal was reached; None of a march to its end.
///
/// Raises
/// ------
/// CaseError
///     The case has mistakes, all of which are told, or cannot be computed as it is.
/// ComputationError
///     The computation broke off.
/// OSError
///     A file cannot be read or written, or `out` holds a run already.
/// KeyboardInterrupt
///     Ctrl-C: the iteration was finished and, with `out`, a checkpoint written; `resume` goes on from there.
///
/// What makes results doubtful is told as a `UserWarning`.
#[pyfunction]
#[pyo3(signature = (case, out=None, progress=None, threads=None))]
pub(crate) fn run(
    py: Python<'_>,
    case: &Bound<'_, PyAny>,
    out: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> PyResult<Found> {
    let wishes = Wishes::of(py, progress, threads)?;
    let Given { case, input } = Given::of(case)?.with_gas(py)?;
    let folder = out.clone();
    let (case, found) = computed(py, wishes, move |relay| {
        let session = Session::open(&case, &input)?;
        let session = match &folder {
            Some(folder) => session.keep_in(folder, relay)?,
            None => session,
        };
        solve(session, relay)
    })?;
    Found::of(py, &case, found, out)
}

/// Goes on with what was stopped in a folder, from its checkpoint, to the same bits as if it had not been: a run, a structure alone, or a
/// flutter boundary, of which the Mach numbers go on that were not finished.
///
/// Parameters
/// ----------
/// out : str or os.PathLike
///     The folder.
/// progress, threads : optional
///     As for `run`.
///
/// Returns
/// -------
/// Result, Solid or Flutter
///     As of `run`, `solid` or `flutter`; histories begin where the run began.
///
/// Raises
/// ------
/// CaseError
///     The folder holds no run that can go on, or one that is finished.
/// ComputationError, OSError, KeyboardInterrupt
///     As for `run`.
#[pyfunction]
#[pyo3(signature = (out, progress=None, threads=None))]
pub(crate) fn resume(
    py: Python<'_>,
    out: PathBuf,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> PyResult<Py<PyAny>> {
    let wishes = Wishes::of(py, progress, threads)?;
    if is_finished(&out) {
        let text = format!(
            "the run in `{}` is finished\nhint: its tables and fields are there; `run` computes a case anew",
            out.display()
        );
        return Err(faults::single(py, &text));
    }
    let folder = out.clone();
    if flutter::is_interrupted(&out) {
        let found = computed(py, wishes, move |relay| flutter::resume(&folder, relay))?;
        return Ok(Py::new(py, Flutter::of(py, &found, Some(out))?)?.into_any());
    }
    let case = case_of(&out).map_err(|problem| faults::of_run(py, &problem))?;
    if !case.has_gas() {
        let found = computed(py, wishes, move |relay| resume_solid(&folder, relay).map(of_solid))?;
        return Ok(Py::new(py, Solid::of(py, &case, *found, Some(out))?)?.into_any());
    }
    let (case, found) = computed(py, wishes, move |relay| solve(continued(&folder)?, relay))?;
    Ok(Py::new(py, Found::of(py, &case, found, Some(out))?)?.into_any())
}

/// What was found of a structure alone; `None` when told to stop.
pub(crate) fn of_solid(ended: SolidOutcome) -> Option<Box<SolidSolution>> {
    match ended {
        SolidOutcome::Finished(found) => Some(found),
        SolidOutcome::Interrupted(_) => None,
    }
}

/// What a caller wants beside the result.
pub(crate) struct Wishes {
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
    /// An exception waits for the end of the iteration; else what is computed is left alone and dropped at its end.
    waits: bool,
}

impl Wishes {
    /// Those of what nobody can stop: clouds and surfaces.
    pub(crate) const NONE: Self = Self { progress: None, threads: None, waits: false };

    pub(crate) fn of(py: Python<'_>, progress: Option<Py<PyAny>>, threads: Option<usize>) -> PyResult<Self> {
        if let Some(other) = progress.as_ref().map(|p| p.bind(py)).filter(|p| !p.is_callable()) {
            let kind = other.get_type().name()?;
            let text = format!("`progress` is a `{kind}`; allowed: what can be called with a dict");
            return Err(PyTypeError::new_err(text));
        }
        if threads == Some(0) {
            let text = "`threads` is 0; allowed: 1 or more\nhint: leave it out for one for each core";
            return Err(PyValueError::new_err(text));
        }
        Ok(Self { progress, threads, waits: true })
    }
}

/// Does `work` in threads of its own; its result, `None` only when it was told to stop.
pub(crate) fn computed<T: Send + 'static>(
    py: Python<'_>,
    wishes: Wishes,
    work: impl FnOnce(&mut Relay) -> Result<Option<T>, RunError> + Send + 'static,
) -> PyResult<T> {
    let Wishes { progress, threads, waits } = wishes;
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or_else(threads_of_environment)).stack_size(STACK);
    let pool = pool.build().map_err(|problem| PyRuntimeError::new_err(format!("cannot start threads: {problem}")))?;
    let progress = progress.as_ref();
    let (done, told) = py.detach(move || {
        let (sender, events) = sync_channel(WAITING);
        let stop = Arc::new(AtomicBool::new(false));
        // it ends with the computation, and with it the events
        let mut relay = Relay { events: sender, stop: Arc::clone(&stop), ticks: progress.is_some() };
        let working = thread::spawn(move || pool.install(|| work(&mut relay)));
        let told = attend(&events, progress, &stop, waits);
        (if told.is_ok() || waits { Some(working.join()) } else { None }, told)
    });
    let done = done.map(|done| done.unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
    told?;
    let found = done.transpose().map_err(|problem| faults::of_run(py, &problem))?;
    found.flatten().ok_or_else(|| PyRuntimeError::new_err("the run was told to stop"))
}

/// Reads a case, builds its cloud, and tells what it means and what a run will take; computes no flow.
///
/// Parameters
/// ----------
/// case : str, os.PathLike or dict
///     As for `run`.
///
/// Returns
/// -------
/// dict
///     `title`; `understood`: Mach number, sound speed, dynamic pressure, Reynolds number, reference values, boxes around the bodies,
///     period and steps, in SI units where `understood["dimensional"]` is true; `particles`, `fluid`, `interface`, `outer`,
///     `neighbours`, `spacing`, `worst_condition`; `cost` of a run in `bytes` and `seconds` on this machine, and `gaf`, that of
///     `alula gaf` where the case asks for it; `notes` and `warnings`. Of a structure alone: particles, mass, spacing, held particles, forces,
///     the longest step and the number of steps.
///
/// Raises
/// ------
/// CaseError
///     The case has mistakes, all of which are told, or cannot be computed as it is.
/// OSError
///     A file cannot be read.
/// KeyboardInterrupt
///     Ctrl-C.
#[pyfunction]
pub(crate) fn check(py: Python<'_>, case: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    let Given { case, input } = Given::of(case)?;
    let title = case.title.clone();
    let report = computed(py, Wishes::NONE, move |_| {
        let refused = refusals(&case, &input);
        if !refused.is_empty() {
            return Ok(Some(Err(refused)));
        }
        let report = match case.has_gas() {
            true => serde_json::to_value(inspect(&case, &input, None)?),
            false => serde_json::to_value(inspect_structure(&case, &input)?),
        };
        Ok(Some(Ok(report.unwrap_or_default())))
    })?;
    let mut told = report.map_err(|problems| faults::of_all(py, &problems))?;
    told["title"] = title.into();
    python_of(py, &told)
}

/// The case and what was found; `None` when told to stop.
fn solve(mut session: Session, relay: &mut Relay) -> Result<Option<(Case, Solution)>, RunError> {
    match solver::run::solve(&mut session, relay)? {
        Outcome::Interrupted { .. } => Ok(None),
        Outcome::Finished(_) | Outcome::Structure(_) | Outcome::AlreadyFinished { .. } => {
            let case = session.case().clone();
            Ok(session.into_solution().map(|solution| (case, solution)))
        }
    }
}

/// What a computation tells.
enum Event {
    Iteration(Tick),
    Note(String),
    Warning(String),
}

/// The end of the computation.
pub(crate) struct Relay {
    events: SyncSender<Event>,
    stop: Arc<AtomicBool>,
    /// Somebody listens to iterations.
    ticks: bool,
}

impl Relay {
    fn send(&self, event: Event) {
        // whoever listened is gone only when all is over
        let _ = self.events.send(event);
    }
}

impl Monitor for Relay {
    fn tick(&mut self, tick: &Tick) {
        if self.ticks {
            self.send(Event::Iteration(*tick));
        }
    }

    fn note(&mut self, text: &str) {
        self.send(Event::Note(text.to_owned()));
    }

    fn warn(&mut self, text: &str) {
        self.send(Event::Warning(text.to_owned()));
    }

    fn stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Passes on what happens until all is over; the first exception stops the computation and is kept, or ends this where nobody `waits`.
fn attend(events: &Receiver<Event>, progress: Option<&Py<PyAny>>, stop: &AtomicBool, waits: bool) -> PyResult<()> {
    let mut first = Ok(());
    loop {
        let event = match events.recv_timeout(PAUSE) {
            Ok(event) => Some(event),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return first,
        };
        if first.is_err() {
            continue;
        }
        first = Python::attach(|py| {
            event.map_or(Ok(()), |event| tell(py, &event, progress))?;
            py.check_signals()
        });
        stop.store(first.is_err(), Ordering::Relaxed);
        if first.is_err() && !waits {
            return first;
        }
    }
}

fn tell(py: Python<'_>, event: &Event, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    if let Event::Warning(text) = event {
        let text = std::ffi::CString::new(text.as_str())?;
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)?;
    }
    let Some(progress) = progress else { return Ok(()) };
    let told = PyDict::new(py);
    match event {
        Event::Iteration(tick) => describe(&told, tick)?,
        Event::Note(text) | Event::Warning(text) => {
            let kind = if matches!(event, Event::Note(_)) { "note" } else { "warning" };
            told.set_item("event", kind)?;
            told.set_item("message", text)?;
        }
    }
    progress.call1(py, (told,)).map(|_| ())
}

fn describe(told: &Bound<'_, PyDict>, tick: &Tick) -> PyResult<()> {
    told.set_item("event", "iteration")?;
    told.set_item("iteration", tick.iteration)?;
    told.set_item("residual", tick.residual)?;
    told.set_item("orders", -tick.residual.max(f64::MIN_POSITIVE).log10())?;
    told.set_item("cfl", tick.cfl)?;
    for (k, name) in ["cl", "cd", "cm"].into_iter().enumerate() {
        told.set_item(name, tick.loads.map(|loads| loads[k]))?;
    }
    told.set_item("particles", tick.particles)?;
    told.set_item("time", tick.march.map(|march| march.time))?;
    told.set_item("until", tick.march.map(|march| march.until))?;
    told.set_item("point", tick.point.map(|[point, _]| point + 1))?;
    told.set_item("points", tick.point.map(|[_, points]| points))
}
