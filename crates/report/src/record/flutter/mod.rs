//! What `alula flutter` finds: written as `flutter.json` and read by the report, the command line and Python with the same types.
//!
//! Every field has a default, so that files of former versions and files that were cut short are read as far as they go.
mod boundary;
mod crossing;
pub mod cycle;
mod numbers;
pub mod remedy;
mod shape;
mod state_space;
pub mod tables;
mod wall_motion;

pub use boundary::{Boundary, CaseReference, FlutterAt, Trim, Warning};
pub use crossing::{Bars, Clearance, Doubt, FlutterRow, MotionRow};
pub use cycle::{LimitCycle, MarchedCycle};
pub use shape::{Mark, NaturalMode, Share};
pub use state_space::StateSpaceAt;
pub use wall_motion::WallMotion;
