//! Surfaces of bodies, their motion, and elastic structures.
use alula_base::math;
use alula_case::case;

pub mod geometry;
pub mod motion;
pub mod structure;
