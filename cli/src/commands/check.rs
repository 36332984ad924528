//! `alula check`.
use std::path::{Path, PathBuf};

use alula::case::{Case, write};
use alula::run;
use serde_json::{Value, json};

use crate::arguments;
use crate::outcome::Outcome;
use crate::output;

/// Reads a case, builds its cloud, and tells what a run would meet and take.
pub(crate) fn check(args: &arguments::Check) -> Outcome {
    let case = match super::load(&args.case) {
        Ok(case) => case,
        Err(outcome) => return outcome,
    };
    if args.resolved {
        return output::data(&write(&case));
    }
    let input = args.case.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    match run::inspect(&case, &input, None) {
        Ok(report) if args.json => {
            let mut fields = json!({ "file": args.case, "title": case.title });
            if let (Some(fields), Ok(Value::Object(known))) = (fields.as_object_mut(), serde_json::to_value(&report)) {
                fields.extend(known);
            }
            output::event("check", fields)
        }
        Ok(report) => {
            let title = format!("{}: no mistakes in `{}`\n", args.case.display(), case.title);
            output::data(&(title + &points(&case) + &super::cloud::describe(&report)))
        }
        Err(problem) => super::refuse(&problem),
    }
}

/// How many points a polar has; nothing for a single flow.
fn points(case: &Case) -> String {
    let Some(polar) = &case.polar else { return String::new() };
    let (all, angles) = (polar.len(), polar.angles());
    format!("polar          {all} points: {angles} angles at {} Mach numbers\n", all / angles)
}
