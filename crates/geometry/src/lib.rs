//! Surfaces, how they move, and what carries them.
use alula_base::math;
use alula_case::case;

pub mod geometry;
pub mod motion;
pub mod structure;
