//! Aeroelastic loads from a surface file, without a mesh.
//!
//! Data flows one way: `case → geometry → cloud → (system, frame) → rhs → integrator → snapshots → observers → files →
//! report`. The modules below stand in reading order, lowest floor first; `ARCHITECTURE.md` says which may use which.
pub mod math;

pub mod case;

pub mod system;

pub mod geometry;

pub mod motion;

pub mod structure;

pub mod physics;

pub mod exact;

pub mod cloud;
pub mod coupling;

pub mod scheme;

pub mod time;

pub mod observe;

pub mod report;

pub mod verify;

pub mod run;
