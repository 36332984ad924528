//! Aeroelastic loads from a surface file, without a mesh.
//!
//! Data flows one way: `case → geometry → cloud → (system, frame) → rhs → integrator → snapshots → observers → files →
//! report`. The modules below stand roughly in reading order; `ARCHITECTURE.md` says which may use which.
//!
//! A case file becomes a [`problem::Problem`], and a [`study`] of it a value; [`run::run`] keeps one in a folder. The parts serve without a
//! case:
//!
//! | program in `examples/` | shows |
//! |---|---|
//! | `steady`, `polar`, `flutter`, `solid` | [`study`]: a problem in, loads, boundaries and modes out |
//! | `own_structure` | [`study::forces`] about a flow with matrices of one's own |
//! | `derivative` | [`cloud::CloudSpec`] → [`cloud::Cloud`] → [`cloud::Operators`]: a gradient on particles without any order |
//! | `shock_tube` | [`scheme::Fluid`] with a start of its own, marched by [`time::explicit`], against [`exact::riemann`] |
//! | `van_der_pol` | [`time::ordinary`]: equations of one's own by [`time::harmonic`] and by a march |
//! | `section_on_springs` | [`structure`] and gas as one system, [`coupling::Coupled`] |
pub use alula_base::{exact, math, physics, system, time};
pub use alula_case::case;
pub use alula_cloud::cloud;
pub use alula_flow::scheme;
pub use alula_geometry::{geometry, motion, structure};
pub use alula_report::{observe, record, report};
pub use alula_solid::solid;

pub mod claims;
pub mod coupling;
pub mod problem;
pub mod run;
pub mod study;
pub mod verification;
