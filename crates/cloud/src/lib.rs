//! Point clouds around surfaces: placement of the particles, neighbour lists, and meshless derivative operators.
use alula_base::math;
use alula_case::case;
use alula_geometry::{geometry, motion};

pub mod cloud;
