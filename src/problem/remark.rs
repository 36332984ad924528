//! What opening a problem finds worth telling.
use super::modes::ToldOfModes;

/// Something that opening a problem found worth telling.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Remark {
    /// What was repaired, chosen or left out.
    Note(String),
    /// What makes results doubtful.
    Warning(String),
}

/// Notes and warnings about modes, as remarks.
pub(super) fn remarks_on(told: ToldOfModes) -> impl Iterator<Item = Remark> {
    told.notes.into_iter().map(Remark::Note).chain(told.warnings.into_iter().map(Remark::Warning))
}
