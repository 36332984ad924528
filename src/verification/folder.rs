//! A folder with a case and what it claims.
use std::path::{Path, PathBuf};

use super::WalkError;
use super::store::spacing_of;
use crate::case::{Case, Length, read};
use crate::claims::{ClaimFile, Study};
use crate::problem::files::plain;

/// Files of one case.
pub(super) const FILES: [&str; 2] = ["case.toml", "claim.toml"];

/// A folder with a case and what it claims.
#[derive(Clone, Debug)]
pub struct Folder {
    /// Name of the folder.
    pub name: String,
    /// The folder.
    pub path: PathBuf,
    /// The case.
    pub case: Case,
    /// The claims.
    pub claims: ClaimFile,
}

impl Folder {
    /// Reads one case with its claims.
    pub fn read(path: &Path) -> Result<Self, WalkError> {
        let [case, claims] = FILES.map(|name| path.join(name));
        let text = |p: &Path| plain(p).map_err(|e| unreadable(p, e));
        let wrong = |p: &Path, problem: String| WalkError::Mistakes { path: p.display().to_string(), problem };
        let claims_read = ClaimFile::parse(&text(&claims)?).map_err(|e| wrong(&claims, e.to_string()))?;
        let case_read = read(&text(&case)?, &case.display().to_string()).map_err(|e| wrong(&case, e.to_string()))?;
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        Ok(Self { name, path: path.to_path_buf(), case: case_read, claims: claims_read })
    }

    /// Another case file of the same folder.
    pub(super) fn beside(&self, file: &str) -> Result<Self, WalkError> {
        let path = self.path.join(file);
        let text = plain(&path).map_err(|e| unreadable(&path, e))?;
        let wrong = |e: crate::case::CaseErrors| WalkError::Mistakes {
            path: path.display().to_string(),
            problem: e.to_string(),
        };
        let case = read(&text, &path.display().to_string()).map_err(wrong)?;
        // named after its folder, whichever case it is compared with: both claims share one run
        let folder = self.path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        Ok(Self { name: format!("{folder}/{file}"), case, ..self.clone() })
    }
}

/// A folder or file that cannot be read.
pub(super) fn unreadable(path: &Path, problem: std::io::Error) -> WalkError {
    WalkError::Unreadable { path: path.display().to_string(), problem }
}

/// The case at another spacing.
pub(super) fn respaced(case: &Case, spacing: f64, study: &Study) -> Case {
    let mut case = case.clone();
    let factor = spacing / spacing_of(&case);
    case.cloud.spacing = Some(Length(spacing));
    if study.scale_boxes {
        case.cloud.boxes.iter_mut().for_each(|b| b.spacing.0 *= factor);
    }
    if study.scale_layers {
        case.cloud.layers = Some(case.cloud.particles_per_level() / factor);
    }
    if let Some(layers) = case.cloud.wall_layers.as_mut().filter(|_| study.scale_wall_layers) {
        layers.first.0 *= factor;
    }
    if let Some(wake) = case.cloud.wake.as_mut().filter(|_| study.scale_wake) {
        wake.spacing.0 *= factor;
    }
    case
}
