//! Foundations without cases or clouds: mathematics, exact solutions, physics at a point, and integrators in time.
pub mod exact;
pub mod math;
pub mod physics;
pub mod system;
pub mod time;
