//! Aeroelastic loads from a surface file, without a mesh.
//!
//! Data flows one way: `case → geometry → cloud → (system, frame) → rhs → integrator → snapshots → observers → files →
//! report`. The modules below stand in reading order, lowest floor first; `ARCHITECTURE.md` says which may use which.
pub mod case;
pub mod cloud;
pub mod exact;
pub mod geometry;
pub mod math;
pub mod observe;
pub mod physics;
pub mod report;
pub mod scheme;
pub mod system;
pub mod time;
