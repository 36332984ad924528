//! The discrete equations on a cloud.
pub mod adapt;
pub mod balance;
pub mod boundary;
pub mod deforming_surface;
pub mod discretisation;
pub mod edges;
pub mod fluid;
mod isentropic;
pub mod jacobian;
mod loads;
pub mod motion_blending;
pub mod preconditioner;
pub mod probe;
pub mod reconstruct;
mod sides;
pub mod start;
mod transfer;
pub mod travel;
pub mod viscous;
pub mod volume_ratio_check;

pub use deforming_surface::DeformingSurface;
pub use discretisation::{CloudMotion, Discretisation, Frame};
pub use fluid::{Fluid, Work};
pub use transfer::RemapLedger;
pub use travel::{ParticleKinematics, Travel};
pub use viscous::{ViscousModel, WallCondition};
