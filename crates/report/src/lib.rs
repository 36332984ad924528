//! What a run leaves: files, pictures and pages, made from slices and plain data.
use alula_base::math;
use alula_case::case;

pub mod observe;
pub mod record;
pub mod report;
