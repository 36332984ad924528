//! `alula schema`.
use alula::case::{reference_markdown, schema_text};

use crate::arguments;
use crate::outcome::Outcome;
use crate::output;

/// Prints the JSON schema or the reference page of the case file.
pub(crate) fn schema(args: &arguments::Schema) -> Outcome {
    if args.markdown {
        return output::data(&reference_markdown());
    }
    output::data(&schema_text())
}
