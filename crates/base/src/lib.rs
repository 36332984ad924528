//! The ground floor: what knows neither a case nor a cloud.
pub mod exact;
pub mod math;
pub mod physics;
pub mod system;
pub mod time;
