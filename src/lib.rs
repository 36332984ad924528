//! Aeroelastic loads from a surface file, without a mesh.
//!
//! Data flows one way: `case → geometry → cloud → (system, frame) → rhs → integrator → snapshots → observers → files →
//! report`. The modules below stand roughly in reading order; `ARCHITECTURE.md` says which may use which.
//!
//! A case file is one way in: [`run::Session`] solves it in memory, [`run::run`] into a folder. The parts serve without one:
//!
//! | program in `examples/` | shows |
//! |---|---|
//! | `derivative` | [`cloud::CloudSpec`] → [`cloud::Cloud`] → [`cloud::Operators`]: a gradient on particles without any order |
//! | `shock_tube` | [`scheme::Fluid`] with a start of its own, marched by [`time::explicit`], against [`exact::riemann`] |
//! | `polar` | a section in a loop over angles of attack, each flow relaxed by [`time::relax`] |
//! | `van_der_pol` | [`time::ordinary`]: equations of one's own by [`time::harmonic`] and by a march |
//! | `section_on_springs` | [`structure`] and gas as one system, [`coupling::Coupled`] |
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

pub mod solid;

pub mod time;

pub mod observe;

pub mod problem;

pub mod record;

pub mod report;

pub mod verify;

pub mod run;
