//! From the files of a run to pictures, charts and one self-contained page.
//!
//! Nothing here knows the solver: pictures are made of rasters, points and triangles, the page is made of the files in
//! the run folder. [`canvas`] is a sheet that prints itself as SVG or PNG; [`chart`], [`picture`] and [`surface`] draw on
//! it; `page` is what pages are made of, set by the templates in `templates/`; `overview` gathers everything into `report.html`, `flutter` does so for boundaries, `solids` for structures alone;
//! [`verification`] lists claims and whether they hold.
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

pub mod axes;
pub mod canvas;
pub mod chart;
pub mod colour;
pub mod compare;
mod conditions;
mod contour;
mod error_bars;
pub mod fields;
mod files;
mod flutter;
mod font;
mod grid;
mod last_period;
mod overview;
mod page;
mod paint;
mod periodic;
pub mod picture;
mod polar;
mod pressure;
mod sections;
mod solids;
mod span;
mod stations;
mod stream_lines;
mod structure;
pub mod surface;
mod surface_viewer;
mod surface_views;
mod transfer;
pub mod verification;
mod viewer;
mod walls;
mod words;

pub use chart::{Axis, Chart, Marks, Series};
pub use colour::Colormap;
pub use compare::Comparison;
pub use files::check_reference;
pub use flutter::write_flutter;
pub use overview::write_report;
pub use picture::{Dots, PictureStyle, Raster, Scatter, raster_png, scatter_png};
pub use polar::write_polar;
pub use pressure::write_pressure;
pub use stations::write_stations;
pub use surface::{Shell, SurfaceStyle, surface_png};
pub use surface_views::write_surface_views;
pub use verification::write_verification_page;

/// What can go wrong with a picture or a page.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The operating system refused.
    #[error("cannot {action} `{}`: {source}\nhint: check that the folder exists and is writable", path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// A picture without pixels or with too many.
    #[error("a picture cannot be {width:.0} by {height:.0} pixels; each side must be between 1 and 16384")]
    Size {
        /// Pixels in a row.
        width: f64,
        /// Rows.
        height: f64,
    },
    /// Data that do not fit together.
    #[error("{what} has {found} values instead of {expected}")]
    Shape {
        /// Name of the data.
        what: &'static str,
        /// Values there are.
        found: usize,
        /// Values there should be.
        expected: usize,
    },
    /// A window without area.
    #[error("the window of a picture has no area: from {min:?} to {max:?}")]
    Window {
        /// Smallest coordinates.
        min: [f64; 2],
        /// Largest coordinates.
        max: [f64; 2],
    },
    /// A triangle that refers to a point that is not there.
    #[error("triangle {triangle} refers to a point beyond the {points} there are")]
    Triangle {
        /// Index of the triangle.
        triangle: usize,
        /// Number of points.
        points: usize,
    },
    /// A template that cannot be filled.
    #[error("cannot write a page: {0}")]
    Page(#[from] askama::Error),
    /// The encoder refused.
    #[error("cannot encode a picture as PNG: {0}")]
    Png(String),
}

/// A picture as an address that holds all of it: `kind` is `png` or `svg+xml`.
pub(crate) fn data_address(kind: &str, bytes: &[u8]) -> String {
    format!("data:image/{kind};base64,{}", STANDARD.encode(bytes))
}

/// Writes a file in one step: beside the target first, then renamed.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), ReportError> {
    let failed = |source| ReportError::Io { action: "write", path: path.to_path_buf(), source };
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".alula-").suffix(".tmp");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    file.persist(path).map_err(|e| failed(e.error))?;
    Ok(())
}
