//! The cloud of a case as plain tables: places, kinds, sizes, and what each particle on a boundary belongs to.
use std::path::Path;

use super::build::build_cloud;
use super::look::Snapshot;
use crate::case::{Case, Sides};
use crate::cloud::Cloud;
use crate::geometry::dimension;
use crate::math::Vector;
use crate::problem;
use crate::problem::RunError;

/// Names of the sides of the domain: the smallest and the largest coordinate of each axis.
const SIDES: [[&str; 2]; 3] = [["x_min", "x_max"], ["y_min", "y_max"], ["z_min", "z_max"]];
/// Body and boundary of particles that are on none.
const NONE: i32 = -1;

/// The cloud of a case before a run, without images of particles.
#[derive(Clone, Debug)]
pub struct CloudTable {
    /// Places, with the columns `spacing`, `volume` (that a particle stands for, area in the plane), `normal` (unit: of walls into the gas, of sides
    /// of the domain out of it, zero of fluid particles) and `area_vector` (of walls, area times normal, else zero).
    pub on: Snapshot,
    /// 0 fluid, 1 on a wall, 2 on a side of the domain.
    pub kind: Vec<u8>,
    /// Index into `bodies`; −1 of particles on no body.
    pub body: Vec<i32>,
    /// Index into `boundaries`; −1 of fluid particles.
    pub boundary: Vec<i32>,
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// Names of the parts of bodies (a body without parts is one), then of the sides of the domain, `x_min` to `z_max`.
    pub boundaries: Vec<String>,
    /// Condition of each side of the domain, in the words of the case file.
    pub conditions: Vec<(&'static str, serde_json::Value)>,
    /// What was repaired or assumed.
    pub notes: Vec<String>,
}

/// Builds the cloud of a case whose file names refer to the folder `input`, without running it.
pub fn cloud_table(case: &Case, input: &Path) -> Result<CloudTable, RunError> {
    problem::solids::with_gas(case)?;
    problem::supported(case)?;
    match dimension(case) {
        2 => table::<2>(case, input),
        _ => table::<3>(case, input),
    }
}

fn table<const D: usize>(case: &Case, input: &Path) -> Result<CloudTable, RunError> {
    let (surface, cloud, mut notes) = build_cloud::<D>(case, input)?;
    notes.extend(cloud.notes.iter().cloned().chain(cloud.early_ends()));
    let (bodies, parts) = surface.map_or_else(Default::default, |s| (s.bodies, s.tags));
    let (n, fluid) = (cloud.n_real(), 0..cloud.n_fluid);
    let walls = || cloud.interface.iter();
    let side = |o: &crate::cloud::Outer| parts.len() + 2 * usize::from(o.outward.0) + usize::from(o.outward.1);
    let boundary = walls().map(|w| i32::from(w.tag)).chain(cloud.outer.iter().map(|o| side(o) as i32));
    let body = walls().map(|w| i32::from(w.body)).chain(cloud.outer.iter().map(|_| NONE));
    let kind = |i: usize| u8::from(i >= cloud.n_fluid) + u8::from(i >= cloud.n_rows());
    Ok(CloudTable {
        on: snapshot(&cloud),
        kind: (0..n).map(kind).collect(),
        body: fluid.clone().map(|_| NONE).chain(body).collect(),
        boundary: fluid.map(|_| NONE).chain(boundary).collect(),
        bodies,
        boundaries: parts
            .iter()
            .map(String::as_str)
            .chain(SIDES[..D].iter().flatten().copied())
            .map(str::to_owned)
            .collect(),
        conditions: conditions(&case.boundary, D),
        notes,
    })
}

fn snapshot<const D: usize>(cloud: &Cloud<D>) -> Snapshot {
    let n = cloud.n_real();
    let vectors = |on_wall: &dyn Fn(usize) -> Vector<D>, on_side: &dyn Fn(usize) -> Vector<D>| {
        let still = std::iter::repeat_n(Vector::ZERO, cloud.n_fluid);
        let all = still.chain((0..cloud.interface.len()).map(on_wall)).chain((0..cloud.outer.len()).map(on_side));
        all.flat_map(|v: Vector<D>| v.to_3d()).collect::<Vec<f64>>()
    };
    let normal = vectors(&|w| cloud.interface[w].normal, &|k| cloud.outer[k].normal());
    let area = vectors(&|w| cloud.interface[w].area, &|_| Vector::ZERO);
    Snapshot {
        points: cloud.x[..n].iter().map(Vector::to_3d).collect(),
        columns: vec![
            ("spacing", 1, cloud.spacing[..n].to_vec()),
            ("volume", 1, cloud.volume[..n].to_vec()),
            ("normal", 3, normal),
            ("area_vector", 3, area),
        ],
    }
}

/// The condition of each side.
fn conditions(b: &Sides, dimension: usize) -> Vec<(&'static str, serde_json::Value)> {
    let all = b.pairs();
    let sides = SIDES.iter().flatten().zip(all.iter().flatten()).take(2 * dimension);
    sides.map(|(name, side)| (*name, serde_json::to_value(side).unwrap_or_default())).collect()
}
