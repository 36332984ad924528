//! The discrete equations on a cloud.
pub mod adapt;
pub mod balance;
pub mod blend;
pub mod boundary;
pub mod edges;
pub mod fluid;
mod isentropic;
pub mod jacobian;
pub mod probe;
pub mod reconstruct;
pub mod shape;
mod sides;
pub mod skin;
pub mod start;
mod transfer;
pub mod travel;
pub mod viscous;
pub mod watch;

pub use fluid::{Fluid, Work};
pub use shape::{CloudMotion, Discretisation, Frame};
pub use skin::DeformingSurface;
pub use transfer::RemapLedger;
pub use travel::{ParticleKinematics, Travel};
pub use viscous::{ViscousModel, WallCondition};
