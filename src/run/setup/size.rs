//! How large a cloud may be on this machine.
use super::super::recipe;
use crate::case::Case;
use crate::cloud::CloudSpec;
use crate::observe::usage::available_bytes;

/// Bytes that each particle of a run takes at least: with explicit steps and with implicit ones, in the plane and in space.
const LEAST_BYTES: [[u64; 2]; 2] = [[1000, 1900], [2100, 4200]];

/// The cloud that a case describes, no larger than what memory holds.
pub(crate) fn spec<const D: usize>(case: &Case) -> CloudSpec<D> {
    let spec = CloudSpec::of_case(case);
    let each = LEAST_BYTES[D - 2][usize::from(recipe::is_implicit(case))];
    let held = available_bytes().map_or(spec.most, |bytes| (bytes / each) as usize);
    CloudSpec { most: spec.most.min(held), ..spec }
}
