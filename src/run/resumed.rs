//! Going on with a run from its checkpoint.
use std::path::Path;

use super::session::Session;
use super::{checkpoint, folder};
use crate::problem::RunError;
use crate::study::flow::Origin;
use crate::study::record::saved::equations_of;

/// A session that goes on with the run in `out` from its checkpoint, to the same bits as if it had not been stopped.
pub fn continued(out: &Path) -> Result<Session, RunError> {
    let (case, input) = folder::read_case(out)?;
    folder::check_input(&case, &input, out)?;
    folder::check_begun(out)?;
    let held = folder::hold(out)?;
    let saved = checkpoint::read(out)?.trusted(&case)?;
    if saved.equations.is_some_and(|known| known != equations_of(&case)) {
        return Err(RunError::OtherRun {
            what: format!("`{}/case.toml` has other equations than those that the run began with", out.display()),
            hint: "only `[time]`, `[accuracy]`, `[adapt]`, `[output]` and what is told of the loads may change: `alula run --from` begins \
                   another case from the last state",
        });
    }
    folder::reopen(out)?;
    Ok(Session::open(&case, input)?.kept_in(out, held).from(Origin::Own(Box::new(saved))))
}
