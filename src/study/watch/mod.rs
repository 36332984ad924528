//! Watching: one loop that drives any integrator, and the small scheduled things that watch it.
//!
//! An [`Observer`] looks at an integrator before and after its steps and may wish that it end. None of them knows which method
//! it watches; those that look at a flow know a system of which the gas is a part.
mod checkpoint;
mod crosscheck;
mod drive;
pub(crate) mod progress;
mod series;
mod stops;
mod structures;

pub(crate) use checkpoint::{Checkpoint, Particles};
pub(crate) use crosscheck::{CrossCheck, compare};
pub(crate) use drive::{Ending, Now, Observer, Wish, drive};
pub(crate) use progress::{Aim, Effort, Eyes, GasEyes, Progress};
pub(crate) use series::{FieldSeries, Film};
pub(crate) use stops::{Alike, Flat, Given, Limit, Periodic, Resting, Swinging, Told, Worn};
pub(crate) use structures::{Structures, sample};
