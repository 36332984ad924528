//! Particles around surfaces, and derivatives on them.
use alula_base::math;
use alula_case::case;
use alula_geometry::{geometry, motion};

pub mod cloud;
