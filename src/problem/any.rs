//! A problem of either dimension, and the other problems that it gives.
use std::path::Path;

use super::error::RunError;
use super::files;
use super::in_dimension::ProblemIn;
use super::remark::Remark;
use super::small_motion::March;
use super::solids::NaturalModes;
use super::stream::StreamRatio;
use crate::case::{self, AnyMode, Case, Cloud, FreeStreamScales, Gaf, Temporal};
use crate::geometry::dimension;

/// A case with everything that it names, resolved: what a study computes. It is never changed; its methods give other problems.
///
/// ```no_run
/// # fn main() -> Result<(), alula::problem::RunError> {
/// let problem = alula::problem::Problem::open("case.toml")?;
/// println!("Mach {}, {} bodies", problem.reference().mach, problem.case().bodies.len());
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub enum Problem {
    /// In the plane.
    Plane(Box<ProblemIn<2>>),
    /// In space.
    Space(Box<ProblemIn<3>>),
}

/// The same expression for the problem of either dimension.
macro_rules! either {
    ($problem:expr, $p:ident => $value:expr) => {
        match $problem {
            Problem::Plane($p) => $value,
            Problem::Space($p) => $value,
        }
    };
}

/// Another problem of the same dimension.
macro_rules! other {
    ($problem:expr, $p:ident => $value:expr) => {
        Ok(match $problem {
            Problem::Plane($p) => Problem::Plane(Box::new($value)),
            Problem::Space($p) => Problem::Space(Box::new($value)),
        })
    };
}

impl Problem {
    /// Reads the case file `path` and opens its problem; file names in it refer to the folder that it is in.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, RunError> {
        let path = path.as_ref();
        let unread = |e: std::io::Error| RunError::Folder {
            what: format!("cannot read the case file `{}`: {e}", path.display()),
            hint: "check its name and that it can be read".into(),
        };
        let case = case::read(&files::plain(path).map_err(unread)?, &path.display().to_string())?;
        Self::of_case(&case, path.parent().unwrap_or(Path::new("")))
    }

    /// The problem of a case whose file names refer to the folder `input`.
    pub fn of_case(case: &Case, input: impl AsRef<Path>) -> Result<Self, RunError> {
        Ok(match dimension(case) {
            2 => Self::Plane(Box::new(ProblemIn::of_case(case, input.as_ref())?)),
            _ => Self::Space(Box::new(ProblemIn::of_case(case, input.as_ref())?)),
        })
    }

    /// The case with the cloud and the accuracy that are chosen where it leaves them out.
    pub fn case(&self) -> &Case {
        either!(self, p => p.case())
    }

    /// The case as it is given.
    pub(crate) fn given(&self) -> &Case {
        either!(self, p => p.given())
    }

    /// Natural modes of its bodies.
    pub(crate) fn modes(&self) -> &NaturalModes {
        either!(self, p => p.modes())
    }

    /// Folder that file names of the case refer to.
    pub(crate) fn input(&self) -> &Path {
        either!(self, p => p.input())
    }

    /// Free stream, in the units of the case.
    pub fn reference(&self) -> &FreeStreamScales {
        either!(self, p => p.reference())
    }

    /// What opening it found worth telling.
    pub fn remarks(&self) -> &[Remark] {
        either!(self, p => p.remarks())
    }

    /// The same bodies at another Mach number and angle of attack, in radians, nose up positive.
    pub fn at(&self, mach: f64, alpha: f64) -> Result<Self, RunError> {
        other!(self, p => p.at(mach, alpha)?)
    }

    /// The same structures in a stream of the same Mach number with other pressure and temperature.
    pub fn in_stream(&self, ratio: StreamRatio) -> Result<Self, RunError> {
        other!(self, p => p.in_stream(ratio)?)
    }

    /// The same on a cloud with `factor` times the spacing; `None` where that does not fit into the domain, and where clouds follow what is
    /// found on coarser ones.
    pub fn on_spacing(&self, factor: f64) -> Result<Option<Self>, RunError> {
        Ok(match self {
            Self::Plane(p) => p.on_spacing(factor)?.map(|p| Self::Plane(Box::new(p))),
            Self::Space(p) => p.on_spacing(factor)?.map(|p| Self::Space(Box::new(p))),
        })
    }

    /// The same on the cloud `cloud`, without a family of clouds.
    pub(crate) fn on_cloud(&self, cloud: Cloud) -> Result<Self, RunError> {
        other!(self, p => p.on_cloud(cloud)?)
    }

    /// The same with constant forces on the coordinates of all structures, one after another, in the units of the case.
    pub fn with_forces(&self, forces: &[f64]) -> Result<Self, RunError> {
        other!(self, p => p.with_forces(forces)?)
    }

    /// The steady flow at one Mach number about which the structures move a little; they stay where they begin unless they are trimmed.
    pub fn about_steady_flow(&self, mach: f64) -> Result<Self, RunError> {
        other!(self, p => p.about_steady_flow(mach)?)
    }

    /// The march of a periodic motion of the structures, see [`March`].
    pub(crate) fn march_of(&self, march: &March<'_>) -> Result<Self, RunError> {
        other!(self, p => p.march_of(march)?)
    }

    /// The steady flow about which the modes of `[gaf]` move a little.
    pub(crate) fn about_steady_flow_of_gaf(&self, gaf: &Gaf) -> Result<Self, RunError> {
        other!(self, p => p.about_steady_flow_of_gaf(gaf)?)
    }

    /// The motion of one mode of `[gaf]` at the reduced frequency `k`, with `factor` times its amplitude.
    pub(crate) fn in_motion_of_gaf(&self, gaf: &Gaf, mode: AnyMode<'_>, k: f64, factor: f64) -> Result<Self, RunError> {
        other!(self, p => p.in_motion_of_gaf(gaf, mode, k, factor)?)
    }

    /// A further run that tells error bars, see [`ProblemIn::further`].
    pub(crate) fn further(&self, cloud: Cloud, time: Temporal) -> Result<Self, RunError> {
        other!(self, p => p.further(cloud, time)?)
    }
}
