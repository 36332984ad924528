//! A finished run as it is measured, and as it is kept in a file.
use std::borrow::Cow;

use super::{Measured, Numbers};
use crate::case::Case;
use crate::claims::{Loops, Wall};
use crate::math::Vector;
use crate::observe::{Array, Checkpoint, Field};
use crate::run::Session;
use crate::study::Snapshot;

/// Columns of a solution that claims are about, with their components.
const COLUMNS: [(&str, usize); 6] =
    [("kind", 1), ("density", 1), ("velocity", 3), ("pressure", 1), ("cp", 1), ("spacing", 1)];
/// Names of the columns of a wall, vectors first.
const WALL: [&str; 6] = ["wall_x", "wall_normal", "wall_area", "wall_x_c", "wall_cp", "wall_cf"];
/// Name of the positions of particles.
const POINTS: &str = "points";
/// Names of the loads over the last period.
const LOOPS: [&str; 2] = ["loop_cl", "loop_cd"];

impl Measured {
    /// What claims measure of a session whose case has been solved, with its `numbers`; `None` where it left no solution.
    pub(in super::super) fn of(case: &Case, numbers: Numbers, session: &Session) -> Option<Self> {
        let whole = session.field()?;
        let column = |(name, parts): (&'static str, usize)| Some((name, parts, whole.column(name)?.to_vec()));
        let columns = COLUMNS.into_iter().filter_map(column).collect();
        let field = Snapshot { points: whole.points.clone(), columns };
        Some(Self { case: case.clone(), numbers, field, wall: session.wall()?, loops: session.loops()?.clone() })
    }

    /// All that is no single number, for a file.
    pub(in super::super) fn arrays(&self) -> Vec<Field<'_>> {
        let array = |name: &str, values: Cow<'_, [f64]>| Field {
            name: name.to_owned(),
            shape: vec![values.len()],
            data: Array::F64(Cow::Owned(values.into_owned())),
        };
        let vectors = |v: &[Vector<3>]| Cow::Owned(v.iter().flat_map(|x| x.0).collect());
        let wall = &self.wall;
        let of_wall = [vectors(&wall.x), vectors(&wall.normal)];
        let of_wall =
            of_wall.into_iter().chain([&wall.area, &wall.x_c, &wall.cp, &wall.cf].map(|v| Cow::Borrowed(&v[..])));
        let mut all = vec![array(POINTS, Cow::Borrowed(self.field.points.as_flattened()))];
        all.extend(self.field.columns.iter().map(|(name, _, values)| array(name, Cow::Borrowed(values))));
        all.extend(WALL.iter().zip(of_wall).map(|(name, values)| array(name, values)));
        all.extend(LOOPS.iter().zip([&self.loops.cl, &self.loops.cd]).map(|(name, v)| array(name, Cow::Borrowed(v))));
        all
    }

    /// The run of `case` that a file holds, with its `numbers`; `None` where the file is of another kind.
    pub(in super::super) fn from_file(case: &Case, numbers: Numbers, file: &Checkpoint<'_>) -> Option<Self> {
        let values = |name: &str| file.f64(name).ok();
        let list = |name: &str| values(name).map(<[f64]>::to_vec);
        let vectors = |name: &str| Some(values(name)?.as_chunks::<3>().0.iter().map(|x| Vector(*x)).collect());
        let wall = Wall {
            x: vectors(WALL[0])?,
            normal: vectors(WALL[1])?,
            area: list(WALL[2])?,
            x_c: list(WALL[3])?,
            cp: list(WALL[4])?,
            cf: list(WALL[5])?,
        };
        let columns = COLUMNS.into_iter().filter_map(|(name, parts)| Some((name, parts, list(name)?))).collect();
        let field = Snapshot { points: values(POINTS)?.as_chunks::<3>().0.to_vec(), columns };
        let loops = Loops { cl: list(LOOPS[0])?, cd: list(LOOPS[1])? };
        Some(Self { case: case.clone(), numbers, field, wall, loops })
    }
}
