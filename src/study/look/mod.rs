//! Looking at a flow: loads, forces, friction, and the solution as plain tables in the units of the case.
mod axes;
mod field;
pub(crate) mod forces;
pub(crate) mod friction;
mod held;
mod hinge;
mod hull;
mod mesh;
pub(crate) mod momentum;
pub(crate) mod raster;
mod rim;
mod span;
mod symmetry;
mod tip_vortex;
mod wake;
mod wall_weights;
mod walls;

pub use field::Snapshot;
pub use walls::WallSnapshot;

pub(crate) use axes::{GasView, LoadFrame, load_axes, motion, pressure_load, totals};
pub(crate) use field::{field, pressure_coefficient};
pub(crate) use held::Held;
pub(crate) use hinge::hinge_moments;
pub(crate) use hull::Hull;
pub(crate) use mesh::Mesh;
pub(crate) use rim::{Rim, SHADE, planes};
pub(crate) use span::{span_load, span_loads};
pub(crate) use symmetry::side_of_symmetry;
pub(crate) use tip_vortex::{CrossPlane, tip_vortex};
pub(crate) use wake::{entropy_drag, wake_planes};
