//! Structures made of particles.
pub mod body;
pub mod fill;
pub mod forces;
pub mod particles;
pub mod modes;
mod stiffness;
pub mod system;
#[cfg(test)]
mod tests;
mod weigh;

pub use body::{Action, Damping, Load, Parts, Plane, Solid, Support};
pub use particles::{Particles, Unfit};
pub use system::Structure;
