//! Estimate of the number of particles of a cloud before it is built.
//!
//! Around a surface of area S, the levels of sizes s = h, 2h, 4h, … follow one another, each n = `layers` cells deep:
//! the level of size s fills the gas within n s/2 of the surface that finer levels have not filled. Its volume is
//! estimated by Steiner's formula for a convex body, S r + ω_D r^D with r = n s/2, and limited to the volume of the
//! domain. A box with a spacing of its own holds V/s^D cells. Refinement at edges and by curvature is not included: the
//! estimate serves to reject clouds that are far too large.
use super::sources::SourceBox;
use super::{CloudError, CloudSpec};
use crate::geometry::Surface;
use crate::math::Bounds;
use crate::math::digits::short;

/// Factor of uncertainty of the estimate: only a cloud that exceeds the limit by more is rejected before it is built.
const TRUST: f64 = 3.0;
/// Number of tree cells per particle, including parents and cells inside bodies.
const CELLS: usize = 2;
/// Number of cells that is always permitted.
const FEW: usize = 1 << 16;
/// Length of a body above which the message asks about its unit: few aircraft are longer in metres.
const LONG: f64 = 90.0;
/// Volume of the unit disc and of the unit ball.
const UNIT_BALL: [f64; 2] = [std::f64::consts::PI, 4.0 / 3.0 * std::f64::consts::PI];

/// Contributions to the number of particles, each with a remedy for the message.
pub(super) struct Estimate {
    shares: Vec<(f64, String)>,
}

impl Estimate {
    /// Estimates the contributions of the surface and of each of the `boxes`, the wake among them.
    pub(super) fn new<const D: usize>(
        spec: &CloudSpec<D>,
        domain: &Bounds<D>,
        surface: Option<&Surface<D>>,
        boxes: &[SourceBox<D>],
    ) -> Self {
        let mut shares: Vec<(f64, String)> = boxes
            .iter()
            .enumerate()
            .map(|(k, b)| (cells(&common(&b.bounds, domain), b.spacing), name_of(k, spec, surface.is_some())))
            .collect();
        shares.extend(surface.map(|s| (around(spec, domain, s), reason(spec, s))));
        Self { shares }
    }

    /// Rejects a cloud that has more than `most` particles for certain.
    pub(super) fn check(&self, most: usize) -> Result<(), CloudError> {
        let sum: f64 = self.shares.iter().map(|s| s.0).sum();
        // written so that NaN is rejected too: infinitely many cells of infinitely small size
        if sum <= TRUST * most as f64 {
            return Ok(());
        }
        let about = if sum.is_finite() { format!("about {sum:.1e}") } else { "countless".to_owned() };
        Err(self.refused(about, most))
    }

    /// Greatest number of cells of a tree of at most `most` particles.
    pub(super) fn most_cells(&self, most: usize) -> usize {
        most.saturating_mul(CELLS).max(FEW)
    }

    /// The error for a cloud of too many `particles`, with a remedy for the largest contribution.
    pub(super) fn refused(&self, particles: String, most: usize) -> CloudError {
        let largest = self.shares.iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let hint = largest.map_or_else(|| "raise `cloud.spacing`".to_owned(), |s| s.1.clone());
        CloudError::TooLarge { particles, most, hint }
    }
}

/// Number of cells of the levels around a surface.
fn around<const D: usize>(spec: &CloudSpec<D>, domain: &Bounds<D>, surface: &Surface<D>) -> f64 {
    let area: f64 = (0..surface.elements.len() as u32).map(|e| surface.element_area_vector(e).norm()).sum();
    let whole = volume(domain);
    // the interface particles on the surface itself
    let mut count = area / spec.spacing.powi(D as i32 - 1);
    let (mut size, mut filled) = (spec.spacing, 0.0);
    while filled < whole && count.is_finite() {
        let reach = 0.5 * spec.layers * size;
        let within = (area * reach + UNIT_BALL[D - 2] * reach.powi(D as i32)).min(whole);
        count += (within - filled) / size.powi(D as i32);
        (filled, size) = (within, 2.0 * size);
    }
    count
}

/// Remedy where the surface is the largest contribution.
fn reason<const D: usize>(spec: &CloudSpec<D>, surface: &Surface<D>) -> String {
    /// A greater number of cells per level of refinement is never necessary.
    const MANY: f64 = 64.0;
    let length = surface.bounds().extent().max_abs();
    if length > LONG && length > 1e3 * spec.spacing {
        return format!(
            "the bodies are {} long: are they in millimetres? then `scale = \"1 mm\"`; else raise `cloud.spacing` ({})",
            short(length),
            short(spec.spacing)
        );
    }
    if spec.layers > MANY {
        return format!("lower `cloud.layers` ({}): 6 to 24 are usual", spec.layers);
    }
    format!("raise `cloud.spacing` ({}): the bodies are {} long", short(spec.spacing), short(length))
}

/// Remedy where the `k`-th box is the largest contribution: boxes of the user, then the wake, or the domain.
fn name_of<const D: usize>(k: usize, spec: &CloudSpec<D>, has_bodies: bool) -> String {
    if k < spec.boxes.len() {
        return format!("raise `cloud.box[{k}].spacing` ({}), or make the box smaller", short(spec.boxes[k].spacing));
    }
    match (&spec.wake, has_bodies) {
        (Some(wake), true) => {
            format!("raise `cloud.wake.spacing` ({}), or shorten `cloud.wake.length`", short(wake.spacing.0))
        }
        _ => format!("raise `cloud.spacing` ({}), or make `cloud.domain` smaller", short(spec.spacing)),
    }
}

fn cells<const D: usize>(bounds: &Bounds<D>, size: f64) -> f64 {
    (0..D).map(|d| (bounds.extent()[d].max(0.0) / size).max(1.0)).product()
}

fn volume<const D: usize>(bounds: &Bounds<D>) -> f64 {
    (0..D).map(|d| bounds.extent()[d]).product()
}

fn common<const D: usize>(a: &Bounds<D>, b: &Bounds<D>) -> Bounds<D> {
    Bounds { min: a.min.max(&b.min), max: a.max.min(&b.max) }
}
