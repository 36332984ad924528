//! The cloud and the equations of a case, without a study.
use std::path::Path;

use super::setup;
use super::stage::Stage;
use crate::case::Case;
use crate::cloud::Cloud;
use crate::geometry::Surface;
use crate::problem::{self, ProblemIn, RunError, spacing};
use crate::scheme::Fluid;

/// Builds the cloud of a case without running it.
pub fn build_cloud<const D: usize>(
    case: &Case,
    input: &Path,
) -> Result<(Option<Surface<D>>, Cloud<D>, Vec<String>), RunError> {
    let (surface, notes) = problem::surface::<D>(case, input)?;
    let chosen = spacing::Chosen::of(case, surface.as_ref()).map(|chosen| chosen.cloud);
    let spec = problem::spec_of(case, chosen.as_ref().unwrap_or(&case.cloud));
    let cloud = Cloud::build(&spec, surface.as_ref(), &[])?;
    Ok((surface, cloud, notes))
}

/// Builds the equations of a case on its own cloud, and the state at the start, without running it.
pub fn build_solver<const D: usize>(case: &Case, input: &Path) -> Result<(Fluid<D>, Vec<f64>), RunError> {
    let problem = ProblemIn::of_case(case, input)?.without_structures();
    let solver = setup::solver(&problem, &Stage::PLAIN, &[], None)?;
    let start = solver.system.start();
    Ok((solver.system, start))
}
