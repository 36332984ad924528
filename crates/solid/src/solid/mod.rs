//! Deformable solids discretised by particles (total Lagrangian).
//!
//! The undeformed cloud of particles has least-squares gradients that satisfy the divergence theorem ([`particles`]).
//! The forces are derivatives of the energy of deformation ([`forces`]). Materials, supports and loads belong to
//! [`body`]; [`system`] connects a solid to the time integrators. Bodies of revolution are computed on their section
//! (`axis`). Natural modes of 3-D bodies can also be computed with B-splines instead of particles ([`splines`]). See
//! the book page `solid-particles`.
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
pub use particles::{Particles, ParticlesError};
pub use system::Structure;
