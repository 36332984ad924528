//! How large a cloud may be on this machine.
use super::super::cost::bytes_each;
use crate::case::Case;
use crate::cloud::CloudSpec;
use crate::observe::usage::available_bytes;

/// Part of the memory that a run surely takes of what is expected.
const SURELY: f64 = 0.8;

/// The cloud that a case describes, no larger than what memory holds.
pub(crate) fn spec<const D: usize>(case: &Case) -> CloudSpec<D> {
    let spec = CloudSpec::of_case(case);
    let each = SURELY * bytes_each(case, D);
    let held = available_bytes().map_or(spec.most, |bytes| (bytes as f64 / each) as usize);
    CloudSpec { most: spec.most.min(held), ..spec }
}
