//! `alula report`.
use crate::arguments;
use crate::outcome::Outcome;
use crate::output;

/// Writes the report of a run again.
pub(crate) fn report(args: &arguments::Report) -> Outcome {
    match alula::report::write_report(&args.run) {
        Ok(path) => output::data(&format!("{}\n", path.display())),
        Err(problem) => {
            output::error(&problem.to_string(), "name the folder of a run");
            Outcome::BadInput
        }
    }
}
