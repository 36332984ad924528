//! What unit tests compute on: the gas of a case that is written in the test, at rest.
use std::path::Path;
use std::sync::Arc;

use super::start::FreeStream;
use super::{Fluid, ViscousModel};
use crate::case::read;
use crate::cloud::{Cloud, CloudSpec};
use crate::geometry::load_surface;

/// The gas of a case, reference chord 1, whatever moves in it at rest.
pub(super) fn fluid(text: &str) -> Fluid<2> {
    let case = read(text, "case.toml").unwrap_or_else(|e| panic!("{e}"));
    let surface = load_surface(&case.bodies, Path::new("")).unwrap().0;
    let surface = (!case.bodies.is_empty()).then_some(&surface);
    let cloud = Cloud::build(&CloudSpec::of_case(&case), surface, &[]).unwrap();
    let viscous_model = ViscousModel::of_case(&case, 1.0).map(Arc::new);
    Fluid { viscous_model, ..Fluid::new(cloud, &FreeStream::of_case(&case), &case.scheme) }
}
