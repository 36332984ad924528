//! What a problem is made from, besides the files that its case names.
use super::solids::NaturalModes;
use crate::case::Case;

/// What a problem is made from: a case, and what was found before it. It is the problem's own; other problems change a copy of it.
#[derive(Clone, Debug)]
pub(super) struct Given {
    /// The case.
    pub(super) case: Case,
    /// Natural modes of its bodies.
    pub(super) modes: NaturalModes,
}
