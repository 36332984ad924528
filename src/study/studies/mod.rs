//! What is done on a cloud: relaxing, marching, finding a periodic state. Each study builds an integrator, chooses who watches
//! it, lets it be driven, and tells how far it came.
mod balance;
mod check;
mod forces;
mod lead;
mod march;
mod periodic;
mod settled;
mod steady;
mod swing;
mod turn;

pub(crate) use balance::balance;
pub(crate) use forces::{ForceSource, Forces, MovingWalls, SOLVED, SmallMotion, in_order};
pub(crate) use lead::lead;
pub(crate) use march::march;
pub(crate) use periodic::{PeriodFields, check_period};
pub(crate) use steady::relax;
pub(crate) use turn::{Reached, Start, Turn};
