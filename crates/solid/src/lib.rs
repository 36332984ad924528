//! Deformable solids discretised by particles.
#[cfg(test)]
use alula_base::time;
use alula_base::{math, physics, system};
#[cfg(test)]
use alula_case::case;
use alula_cloud::cloud;
use alula_geometry::geometry;

pub mod solid;
