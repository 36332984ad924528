//! Looking at a flow: loads, forces, friction, and the solution as plain tables in the units of the case.
mod axes;
mod field;
pub(crate) mod forces;
pub(crate) mod friction;
mod hull;
mod mesh;
pub(crate) mod momentum;
pub(crate) mod reference;
mod tip_vortex;
mod wall_weights;
mod walls;

pub use field::Snapshot;
pub use tip_vortex::TipVortex;
pub use walls::WallSnapshot;

pub(crate) use axes::{GasView, LoadFrame, load_axes, motion, pressure_load, totals};
pub(crate) use field::{field, pressure_coefficient};
pub(crate) use hull::Hull;
pub(crate) use mesh::Mesh;
pub(crate) use tip_vortex::{WakePlane, tip_vortex};
