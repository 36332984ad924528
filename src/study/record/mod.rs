//! What a run knows about itself: in memory while it goes on, in a checkpoint between, in the summary at its end.
pub(crate) mod crosscheck;
pub(crate) mod family;
mod history;
mod interval;
mod log;
pub(crate) mod polar;
pub(crate) mod saved;
pub(crate) mod solid_end;
pub(crate) mod trace;
mod trust;
pub(crate) mod work;

pub use history::IterationHistory;
pub(crate) use interval::{NEARLY, passed};
pub(crate) use log::{Log, Record, Scales};
pub(crate) use solid_end::solid_end;
