//! Problems: a case with all that it names, resolved once and not changed afterwards.
mod any;
mod assemble;
pub(crate) mod coarser;
mod error;
pub(crate) mod files;
mod in_dimension;
mod modes;
mod motion_feasibility;
pub(crate) mod numerics;
mod open;
pub(crate) mod reference;
mod remark;
mod sanity;
mod scales;
mod size;
mod small_motion;
pub(crate) mod solids;
mod solids_in_gas;
pub(crate) mod spacing;
mod stream;
mod structures;
mod supported;

pub use any::Problem;
pub(crate) use assemble::{coupled, gas, in_stream};
pub use error::{Blame, RunError};
pub use in_dimension::ProblemIn;
pub(crate) use motion_feasibility::check as check_motion;
#[cfg(test)]
pub(crate) use open::motions;
pub(crate) use open::surface;
pub use remark::Remark;
pub(crate) use sanity::rough;
#[cfg(test)]
pub(crate) use sanity::sane;
pub(crate) use size::{bytes_each, spec};
pub(crate) use small_motion::March;
pub use stream::StreamRatio;
pub(crate) use structures::Described;
pub(crate) use supported::supported;
