//! The gas on a cloud.
use alula_base::{exact, math, physics, system};
use alula_case::case;
use alula_cloud::cloud;
use alula_geometry::{geometry, motion};

pub mod scheme;
