//! `alula compare`.
use alula::report::Comparison;

use crate::arguments;
use crate::outcome::Outcome;
use crate::output;

/// Sets two runs of a periodic flow side by side.
pub(crate) fn compare(args: &arguments::Compare) -> Outcome {
    let comparison = match Comparison::of(&args.a, &args.b) {
        Ok(comparison) => comparison,
        Err(problem) => {
            let (what, hint) = problem.split_once("\nhint: ").unwrap_or((&problem, ""));
            output::error(what, hint);
            return Outcome::BadInput;
        }
    };
    let out = args.out.clone().unwrap_or_else(|| "comparison".into());
    match comparison.write(&out) {
        Ok(path) => output::data(&format!("{}page: {}\n", comparison.text(), path.display())),
        Err(problem) => {
            output::error(&problem.to_string(), "choose another folder with `--out`");
            Outcome::BadInput
        }
    }
}
