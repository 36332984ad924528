//! Structures made of particles.
//!
//! A cloud at rest, with least-squares gradients that fulfil the divergence theorem ([`particles`]); an energy of its deformation
//! whose derivatives are forces ([`forces`]); materials, supports and loads ([`body`]); and what integrators see of it all
//! ([`system`]). Bodies of revolution are sections that are turned (`axis`). Natural modes of bodies in space are found without
//! particles as well, among splines ([`splines`]). Book page `solid-particles`.
mod axis;
pub mod body;
mod cells;
pub mod contact;
pub mod fill;
pub mod forces;
pub mod modes;
mod pairs;
pub mod particles;
mod rows;
pub mod splines;
mod stable;
mod stiffness;
pub mod system;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_revolution;
mod weigh;

pub use axis::held_on_axis;
pub use body::{Action, Cells, Contact, Damping, Load, Parts, Plane, RigidPlane, Solid, Support};
pub use particles::{Particles, Unfit};
pub use system::Structure;
