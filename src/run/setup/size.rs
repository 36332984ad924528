//! How large a cloud may be on this machine.
use super::super::accuracy;
use super::super::cost::bytes_each;
use crate::case::Case;
use crate::cloud::sources::Source;
use crate::cloud::{Cloud, CloudError, CloudSpec};
use crate::geometry::Surface;
use crate::observe::usage::available_bytes;

/// Part of the memory that a run surely takes of what is expected.
const SURELY: f64 = 0.8;

/// Factors on the spacing at shocks that are tried until the cloud is no larger than it may be.
const COARSER: [f64; 3] = [1.0, 2.0, 4.0];

/// The cloud that a case describes, no larger than what memory holds.
pub(crate) fn spec<const D: usize>(case: &Case) -> CloudSpec<D> {
    let spec = CloudSpec::of_case(case);
    let each = SURELY * bytes_each(case, D);
    let held = available_bytes().map_or(spec.most, |bytes| (bytes as f64 / each) as usize);
    CloudSpec { most: spec.most.min(held), ..spec }
}

/// The cloud of a case that is fine at `sources`: as fine there as the particles allow that its accuracy may cost.
pub(crate) fn cloud<const D: usize>(
    case: &Case,
    surface: Option<&Surface<D>>,
    sources: &[Source<D>],
) -> Result<Cloud<D>, CloudError> {
    let spec = spec(case);
    let Some(most) = accuracy::asked(case).map(|asked| asked.particles).filter(|_| !sources.is_empty()) else {
        return Cloud::build(&spec, surface, sources);
    };
    for coarser in COARSER {
        let sources: Vec<_> = sources.iter().map(|s| Source { spacing: coarser * s.spacing, ..*s }).collect();
        match Cloud::build(&CloudSpec { most: spec.most.min(most), ..spec.clone() }, surface, &sources) {
            Err(CloudError::TooLarge { .. }) => {}
            other => return other,
        }
    }
    Cloud::build(&spec, surface, &[])
}
