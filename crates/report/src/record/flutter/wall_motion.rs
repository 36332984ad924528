//! Walls in a motion of small size, with the unsteady pressure on them.
use serde::{Deserialize, Serialize};

/// Wall particles in one motion.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct WallMotion {
    /// Places at rest.
    pub points: Vec<[f64; 3]>,
    /// Outlines in the plane.
    pub lines: Vec<Vec<u32>>,
    /// Triangles in space.
    pub triangles: Vec<[u32; 3]>,
    /// Displacement of each: real and imaginary part along each axis.
    pub displacement: Vec<[[f64; 2]; 3]>,
    /// Unsteady pressure over the dynamic pressure of the stream: real and imaginary part.
    pub cp: Vec<[f64; 2]>,
}
