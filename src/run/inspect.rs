//! The cloud of a case without a run, in a folder: what `check` and `cloud` do.
use std::path::Path;
use std::time;

use super::about;
use super::files::{Scene, Target, write_cloud};
use super::folder;
use crate::case::Case;
use crate::cloud::Diagnosis;
use crate::observe::table::write_json;
use crate::observe::vtk::{Column, write_cells};
use crate::problem::solids::with_gas;
use crate::problem::{Problem, ProblemIn, RunError};
use crate::scheme::{Fluid, View};
use crate::study::CloudReport;
use crate::study::inspect::{Inspected, inspect as inspected};
use crate::study::look::{Held, Mesh, Rim};
use crate::system::{Instant, System};

/// Builds the cloud of a case, whose file names refer to the folder `input`, and judges it; writes it into the folder `out` if
/// one is given.
pub fn inspect(case: &Case, input: &Path, out: Option<&Path>) -> Result<CloudReport, RunError> {
    let began = time::Instant::now();
    with_gas(case)?;
    match Problem::of_case(case, input)? {
        Problem::Plane(problem) => within(&problem, began, out),
        Problem::Space(problem) => within(&problem, began, out),
    }
}

fn within<const D: usize>(
    problem: &ProblemIn<D>,
    began: time::Instant,
    out: Option<&Path>,
) -> Result<CloudReport, RunError> {
    folder::check_compared(problem.case(), problem.input())?;
    let Inspected { report, solver } = inspected(problem, out.is_none(), began)?;
    if let Some(out) = out {
        let _held = folder::create_once(problem.case(), problem.input(), out)?;
        write(&Target { case: problem.case(), out }, problem, &solver.system)?;
    }
    Ok(report)
}

fn write<const D: usize>(to: &Target<'_>, problem: &ProblemIn<D>, fluid: &Fluid<D>) -> Result<(), RunError> {
    let (frame, mut work) = (fluid.frame(&Instant::still(0.0), &fluid.start()), fluid.work());
    fluid.fill_states(&frame, &fluid.start(), &mut work);
    let cloud = &fluid.discretisation.cloud;
    let n = cloud.n_real();
    let held = Held::of(to.case, cloud);
    let rim = Rim::of(to.case, cloud, &held);
    let points = rim.with_places(held.numbers().map(|i| cloud.x[i].to_3d()).collect());
    let mut condition: Vec<f64> = fluid.discretisation.operators.condition.iter().map(|c| f64::from(*c)).collect();
    condition.resize(n, 1.0);
    let told = [("spacing", &cloud.spacing[..n]), ("volume", &cloud.volume[..n]), ("condition", &condition)];
    let told = told.map(|(name, values)| (name, rim.with_values(name, 1, held.rows(1, values))));
    let columns = told.each_ref().map(|(name, values)| Column { name, components: 1, values });
    let about = about::gas(to.case, "spacing", None);
    write_cells(&to.out.join("cloud.vtu"), &about, &points, Mesh::of(cloud, &held, &rim).cells(), &columns)?;
    write_json(&to.out.join("doctor.json"), &Diagnosis::of(cloud, fluid.discretisation.walls.n_linear))?;
    let view = View::new(fluid, &frame, &work);
    write_cloud(&Scene { to: *to, view, surface: problem.surface(), chord: 1.0, vortex: None })
}
