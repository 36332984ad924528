//! The flow on the walls as plain tables in the units of the case.
use super::field::{Snapshot, pressure_coefficient};
use super::friction::wall_friction;
use crate::case::Case;
use crate::claims::wall::Wall;
use crate::math::Vector;
use crate::scheme::View;
use crate::scheme::start::free_stream;

/// Named columns over the interface particles, and the parts of bodies that these stand on.
///
/// The columns are `normal` (into the gas), `area`, `arc` (length along the outline), `x_c` (distance from the nose over the extent of
/// the bodies), `pressure`, `cp`, `mach`, `density`, `velocity`, with viscosity `cf`, `heat_flux` and `y_plus`, and `area_vector`, whose
/// sums over a body are exact where those of `normal` times `area` are so up to the curvature within a particle.
#[derive(Clone, Debug, Default)]
pub struct WallSnapshot {
    /// Positions and columns.
    pub on: Snapshot,
    /// Body of each particle, an index into `bodies`.
    pub body: Vec<u16>,
    /// Part of each particle, an index into `tags`.
    pub tag: Vec<u16>,
    /// Names of bodies.
    pub bodies: Vec<String>,
    /// Names of their parts.
    pub tags: Vec<String>,
}

impl WallSnapshot {
    /// All interface particles; `chordwise` are their distances from the nose, `names` those of bodies and parts.
    pub(crate) fn of<const D: usize>(
        case: &Case,
        view: &View<'_, D>,
        chordwise: Vec<f64>,
        [bodies, tags]: [Vec<String>; 2],
    ) -> Self {
        let (cloud, gas) = (view.cloud(), view.fluid.gas);
        let (free, units) = (free_stream::<D>(case), case.flow.units());
        let (walls, n) = (&cloud.interface, cloud.interface.len());
        let state = |w: usize| view.state(cloud.n_fluid + w);
        let column = |f: &dyn Fn(usize) -> f64| (0..n).map(f).collect::<Vec<f64>>();
        let vectors = |f: &dyn Fn(usize) -> Vector<D>| (0..n).flat_map(|w| f(w).to_3d()).collect::<Vec<f64>>();
        let mut columns = vec![
            ("normal", 3, vectors(&|w| view.normal(w))),
            ("area", 1, column(&|w| walls[w].area.norm())),
            ("arc", 1, column(&|w| walls[w].arc)),
            ("x_c", 1, chordwise),
            ("pressure", 1, column(&|w| state(w).pressure * units.pressure())),
            ("cp", 1, column(&|w| pressure_coefficient(&state(w), &free))),
            ("mach", 1, column(&|w| state(w).velocity.norm() / gas.sound_speed(&state(w)))),
            ("density", 1, column(&|w| state(w).density * units.density)),
            ("velocity", 3, vectors(&|w| state(w).velocity * units.speed)),
        ];
        if let Some(friction) = wall_friction(case, view) {
            columns.extend([
                ("cf", 1, column(&|w| friction[w].cf)),
                ("heat_flux", 1, column(&|w| friction[w].heat_flux)),
                ("y_plus", 1, column(&|w| friction[w].y_plus)),
            ]);
        }
        columns.push(("area_vector", 3, vectors(&|w| view.area(w))));
        Self {
            on: Snapshot { points: cloud.interface_range().map(|i| view.place(i).to_3d()).collect(), columns },
            body: walls.iter().map(|w| w.body).collect(),
            tag: walls.iter().map(|w| w.tag).collect(),
            bodies,
            tags,
        }
    }

    /// What claims are measured on.
    pub(crate) fn measured(&self) -> Wall {
        let values = |name: &str| self.on.column(name).unwrap_or_default().to_vec();
        Wall {
            x: self.on.points.iter().map(|x| Vector(*x)).collect(),
            normal: values("normal").as_chunks::<3>().0.iter().map(|n| Vector(*n)).collect(),
            area: values("area"),
            x_c: values("x_c"),
            cp: values("cp"),
            cf: values("cf"),
        }
    }
}
