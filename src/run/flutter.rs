//! Flutter boundaries in folders: what is kept of them, and their files.
mod files;
mod kept;
mod skin;
mod state_space;

use std::path::{Path, PathBuf};

use self::kept::Kept;
use super::folder::{self, Places};
use super::refusals;
use crate::case::{Case, Matching};
use crate::observe::sums;
use crate::problem::files::text;
use crate::problem::{Problem, RunError};
pub use crate::record::flutter::{
    Bars, Boundary, CaseReference, Clearance, Doubt, FlutterAt, FlutterRow, LimitCycle, MarchedCycle, Mark, MotionRow,
    NaturalMode, Share, StateSpaceAt, Trim,
};
use crate::study::Monitor;
use crate::study::flutter::{
    BoundaryKeeper, Held, InMemory, Scales, Skin, Stored, boundary, coordinate, planned, refused_with_forces,
    unreadable,
};

/// Seeks the boundary of the table `[flutter]`, into a fresh folder; `None` when the monitor says stop.
pub fn flutter(case: &Case, places: &Places, monitor: &mut dyn Monitor) -> Result<Option<Boundary>, RunError> {
    let found = sought(case, (&places.input, Some(&places.out)), None, monitor);
    found.map_err(|problem| refusals::with_other_files(case, &places.input, problem))
}

/// The same without a folder, with the forces of a file where one is given.
pub fn in_memory(
    case: &Case,
    input: &Path,
    forces: Option<&Path>,
    monitor: &mut dyn Monitor,
) -> Result<Option<Boundary>, RunError> {
    sought(case, (input, None), forces, monitor)
}

/// The same with the forces of a file, `flutter.json` of a former run or `gaf.json`: the boundary of the structure alone, without a flow.
/// `None` when the monitor says stop.
pub fn again(
    case: &Case,
    places: &Places,
    forces: &Path,
    monitor: &mut dyn Monitor,
) -> Result<Option<Boundary>, RunError> {
    sought(case, (&places.input, Some(&places.out)), Some(forces), monitor)
}

/// Makes room for a boundary that can be sought, with the forces of a file where one is given: earlier results in its folder are renamed; the new
/// name, if there were any.
pub fn set_aside(case: &Case, places: &Places, forces: Option<&Path>) -> Result<Option<PathBuf>, RunError> {
    folder::make_room(&places.out, || match forces {
        Some(file) => refused_with_forces(case, &planned(case)?).and_then(|()| read(file).map(|_| ())),
        None => rehearse(case, &places.input),
    })
}

/// True where `out` holds a boundary that was interrupted.
pub fn is_interrupted(out: &Path) -> bool {
    out.join(folder::KEPT).exists()
}

/// Goes on with a boundary that was interrupted: with the Mach numbers that are not finished. `None` when the monitor says stop.
pub fn resume(out: &Path, monitor: &mut dyn Monitor) -> Result<Option<Boundary>, RunError> {
    let (case, input) = folder::read_case(out)?;
    folder::check_input(&case, &input, out)?;
    flutter(&case, &Places { input, out: out.to_path_buf() }, monitor)
}

/// Refuses a boundary of which it is known before any flow that it cannot be sought.
pub(super) fn rehearse(case: &Case, input: &Path) -> Result<(), RunError> {
    let plan = planned(case)?;
    // the structure is the same at all Mach numbers
    let Some(mach) = plan.mach.first() else { return Ok(()) };
    let own = Problem::of_case(case, input)?.about_steady_flow(*mach)?;
    let held = Held::of(&own);
    case.lco.as_ref().map_or(Ok(0), |lco| coordinate(lco, &held.names))?;
    refusals::rehearse(&own, !plan.trim)
}

/// Seeks the boundary of a case whose files lie in `input`, into the folder `out` where one is given.
fn sought(
    case: &Case,
    (input, out): (&Path, Option<&Path>),
    forces: Option<&Path>,
    monitor: &mut dyn Monitor,
) -> Result<Option<Boundary>, RunError> {
    let plan = planned(case)?;
    let problem = &Problem::of_case(case, input)?;
    let case = problem.given();
    problem.modes().words().iter().for_each(|told| monitor.note(told));
    forces.map_or(Ok(()), |_| refused_with_forces(case, &plan))?;
    let stored = forces.map(read).transpose()?;
    let stored = stored.as_ref();
    let Some(out) = out else { return boundary(problem, (&plan, stored), &mut InMemory, monitor) };
    let _held = folder::create_once(case, input, out)?;
    let kept = Kept::of(case, input, out)?;
    kept.write(out)?;
    let mut folder = Folder { out, problem, kept, draws: case.output.report, skin: None };
    let found = boundary(problem, (&plan, stored), &mut folder, monitor)?;
    if found.is_some() {
        folder::finish(out)?;
        folder::forget_kept(out);
    }
    Ok(found)
}

/// Reads the forces of a file.
fn read(path: &Path) -> Result<Stored, RunError> {
    let file = path.display().to_string();
    let (place, name) = (path.parent().unwrap_or(Path::new("")), path.file_name().unwrap_or_default());
    sums::check_file(path)?;
    let text = text(place, &name.to_string_lossy()).map_err(|e| unreadable(&file, &format!("cannot be read: {e}")))?;
    Stored::parse(&file, &text)
}

/// Keeps a boundary in a folder.
struct Folder<'a> {
    out: &'a Path,
    problem: &'a Problem,
    kept: Kept,
    draws: bool,
    /// What draws motions of the structures.
    skin: Option<Skin>,
}

impl BoundaryKeeper for Folder<'_> {
    fn known(&self, mach: f64) -> Option<FlutterAt> {
        self.kept.at(mach)
    }

    fn keep(&mut self, at: &FlutterAt) -> Result<(), RunError> {
        self.kept.add(at);
        self.kept.write(self.out)
    }

    fn so_far(&mut self, boundary: &Boundary) -> Result<(), RunError> {
        if let (true, None, Some(last)) = (self.draws, &self.skin, boundary.flutter.last()) {
            self.skin = Some(skin(self.problem, last.mach)?);
        }
        files::write(boundary, self.skin.as_ref(), self.out)
    }

    fn draws(&self) -> bool {
        self.draws
    }
}

/// What draws motions of the structures.
fn skin(problem: &Problem, mach: f64) -> Result<Skin, RunError> {
    let own = problem.about_steady_flow(mach)?;
    let held = Held::of(&own);
    let b = Scales::of(own.case(), held.chord, Matching::None).semichord;
    Ok(Skin::of(&own, &held.units(b)))
}
