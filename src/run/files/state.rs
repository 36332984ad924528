//! The state of ParaView: a script beside the files of a run that shows them.
use std::path::Path;

use crate::observe::table::FileError;
use crate::observe::write_atomic;

/// Its name: a module called `paraview` would hide that of ParaView.
const FILE: &str = "paraview-state.py";
const SCRIPT: &str = include_str!("paraview-state.py");

/// Writes it into the folder of a run. It is the same for all runs but for where they lie, which helps where ParaView does not tell a
/// script its own place.
pub(crate) fn write_state_script(out: &Path) -> Result<(), FileError> {
    let place = std::path::absolute(out).unwrap_or_else(|_| out.to_path_buf());
    // a string of JSON is one of Python
    let place = serde_json::to_string(&place.to_string_lossy()).unwrap_or_else(|_| "\".\"".to_owned());
    write_atomic(&out.join(FILE), |w| w.write_all(SCRIPT.replace("@FOLDER@", &place).as_bytes()))
}
