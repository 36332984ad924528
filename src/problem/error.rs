//! Why a run fails, and what may help.
use crate::case::{CaseErrors, abridged};
use crate::cloud::CloudError;
use crate::geometry::GeometryError;
use crate::motion::MotionError;
use crate::observe::{CheckpointError, FileError, VtkError};
use crate::scheme::start::StartError;
use crate::structure::StructureError;
use crate::time::TimeError;

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// Geometry.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Several files of a case that cannot be used.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n\n"))]
    Several(Vec<Self>),
    /// A structure.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// Cloud.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// Initial field.
    #[error(transparent)]
    Start(#[from] StartError),
    /// Integration.
    #[error("{source}{reached}{}", last_good(checkpoint))]
    Time {
        /// Why.
        source: Box<TimeError>,
        /// How far bodies on springs had come, as a line of its own; empty without them.
        reached: String,
        /// Checkpoint with the last good state, where one is written.
        checkpoint: Option<String>,
    },
    /// The cloud of particles that travel with the fluid could not be built anew.
    #[error("at time {time:.6} the cloud cannot be built anew: {source}{}", last_good(checkpoint))]
    Recloud {
        /// Time reached.
        time: f64,
        /// Why.
        source: CloudError,
        /// Checkpoint with the last good state, where one is written.
        checkpoint: Option<String>,
    },
    /// Bodies go where no particles can follow.
    #[error("{what}\nhint: {hint}")]
    Motion {
        /// Which, where and when.
        what: String,
        /// What may help.
        hint: &'static str,
    },
    /// The motion of a case cannot be made.
    #[error(transparent)]
    Law(#[from] MotionError),
    /// A motion that should repeat does not.
    #[error("{what}\nhint: {hint}")]
    NotPeriodic {
        /// Which.
        what: String,
        /// What may help.
        hint: &'static str,
    },
    /// A march is as long as periods of a motion that has none.
    #[error(
        "`[time.{table}]` counts periods of a motion that has none\nhint: give `until` and the length of a step, or a `period` of `[motion]`"
    )]
    NoPeriod {
        /// The table of the case.
        table: &'static str,
    },
    /// A run for generalised forces in which nothing moved.
    #[error("the run of {mode} shows no motion")]
    NothingMoved {
        /// Name of the mode.
        mode: String,
    },
    /// A file could not be written or read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A field file could not be written.
    #[error(transparent)]
    Vtk(#[from] VtkError),
    /// A checkpoint could not be written or read.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A checkpoint of another version of the program.
    #[error(
        "`{file}` was written by another version: {problem}\nhint: go on with the version that wrote it, or start again"
    )]
    OtherVersion {
        /// Name of the checkpoint.
        file: &'static str,
        /// What is different.
        problem: String,
    },
    /// A checkpoint with numbers that no run writes.
    #[error(
        "`{file}` was not written by a run of this case: {problem}\nhint: put back the file as it was, or start the run again"
    )]
    Untrue {
        /// Name of the checkpoint.
        file: &'static str,
        /// What is wrong.
        problem: &'static str,
    },
    /// A picture or the report could not be written.
    #[error("{0}")]
    Report(Box<dyn std::error::Error + Send + Sync>),
    /// The run folder cannot be used.
    #[error("{what}\nhint: {hint}")]
    Folder {
        /// Which, and why.
        what: String,
        /// What may help.
        hint: String,
    },
    /// A folder without a run.
    #[error("`{folder}` is not a run folder: cannot read `case.toml`: {source}")]
    NoRun {
        /// The folder.
        folder: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The folder of the case file is gone.
    #[error("the folder `{folder}` of the case file cannot be found again: {source}")]
    LostInput {
        /// The folder.
        folder: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The case in a run folder has mistakes.
    #[error(transparent)]
    Case(#[from] CaseErrors),
    /// Another run whose last state cannot be the start of this one.
    #[error("{what}\nhint: {hint}")]
    OtherRun {
        /// Which, and why.
        what: String,
        /// What may help.
        hint: &'static str,
    },
    /// The checkpoint stands at a stage that the run does not have.
    #[error("the checkpoint names no stage")]
    NoStage,
    /// The case asks for something that no body or wave could be seen with.
    #[error("{what}\nhint: {hint}")]
    Senseless {
        /// What.
        what: String,
        /// What may help.
        hint: String,
    },
    /// A structure of particles that cannot be made.
    #[error("{what}\nhint: {hint}")]
    Solid {
        /// Why.
        what: String,
        /// What may help.
        hint: String,
    },
    /// The case asks for something that can be written down but not yet computed.
    #[error("{what}\nhint: {hint}")]
    Unsupported {
        /// What.
        what: String,
        /// What may help.
        hint: &'static str,
    },
}

/// Who has to act on a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blame {
    /// Whoever wrote the case: it cannot be computed as it is.
    Case,
    /// Whoever owns the files: they cannot be read or written, or do not belong to the run.
    Files,
    /// Nobody before the run: the computation broke off.
    Computation,
}

impl RunError {
    /// The reasons in words, one by one, each with its hint.
    pub fn messages(&self) -> Vec<String> {
        match self {
            Self::Several(all) => all.iter().flat_map(Self::messages).collect(),
            Self::Geometry(GeometryError::Several(all)) => all.iter().map(|e| abridged(&e.to_string())).collect(),
            one => vec![abridged(&one.to_string())],
        }
    }

    /// The reasons one by one.
    pub(crate) fn parts(self) -> Vec<Self> {
        match self {
            Self::Several(all) => all.into_iter().flat_map(Self::parts).collect(),
            Self::Geometry(why) => why.parts().into_iter().map(Self::Geometry).collect(),
            one => vec![one],
        }
    }

    /// One of several, or all of them together; `None` where there are none.
    pub(crate) fn all(mut found: Vec<Self>) -> Option<Self> {
        if found.len() < 2 { found.pop() } else { Some(Self::Several(found)) }
    }

    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::Time { .. } | Self::Recloud { .. } | Self::NothingMoved { .. } | Self::NoStage => Blame::Computation,
            Self::File(_)
            | Self::Vtk(_)
            | Self::Checkpoint(_)
            | Self::OtherVersion { .. }
            | Self::Untrue { .. }
            | Self::Report(_)
            | Self::Folder { .. }
            | Self::NoRun { .. }
            | Self::LostInput { .. }
            | Self::OtherRun { .. } => Blame::Files,
            Self::Several(all) if all.iter().all(|one| one.blame() == Blame::Files) => Blame::Files,
            Self::Several(_)
            | Self::Geometry(_)
            | Self::Structure(_)
            | Self::Cloud(_)
            | Self::Start(_)
            | Self::Motion { .. }
            | Self::Law(_)
            | Self::NotPeriodic { .. }
            | Self::NoPeriod { .. }
            | Self::Case(_)
            | Self::Senseless { .. }
            | Self::Solid { .. }
            | Self::Unsupported { .. } => Blame::Case,
        }
    }
}

/// Where the last good state is.
fn last_good(checkpoint: &Option<String>) -> String {
    checkpoint.as_ref().map_or_else(String::new, |c| format!("\nthe last good state is in `{c}`"))
}
