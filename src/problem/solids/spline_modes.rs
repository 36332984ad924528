//! Own modes of bodies in space, among splines over the body: no particles fill it.
use std::path::Path;

use super::super::error::RunError;
use super::cut::cuts;
use super::material::material;
use super::natural::{Found, NaturalMode};
use crate::case::formula::Formula;
use crate::case::{Case, ModeTable, Solid, SolidPlace, SolidSupport};
use crate::geometry::{Surface, load_surface};
use crate::math::Vector;
use crate::physics::solid::Material;
use crate::solid::splines::{self, HeldBox, Mirror, SplineModes, SplineModesError, modes};

/// Points of the surface that carry the shapes.
const POINTS: usize = 800;
/// How far the volumes by rays and by triangles may be apart.
const LEAK: f64 = 1e-2;

/// The lowest `count` modes of body number `body`.
pub(super) fn spline_modes(case: &Case, input: &Path, body: usize, count: usize) -> Result<Vec<NaturalMode>, RunError> {
    let data = &case.bodies[body];
    let Some(solid) = &data.solid else { return Ok(Vec::new()) };
    let name = data.name.clone().unwrap_or_else(|| format!("body {}", body + 1));
    let (surface, _) = load_surface::<3>(std::slice::from_ref(data), input)?;
    let materials = materials(solid, &name)?;
    let held: Vec<HeldBox> = supports(solid);
    let mirrors: Vec<Mirror> = cuts(case, &surface.bounds())
        .iter()
        .map(|cut| Mirror { axis: cut.axis, place: cut.place, below: cut.below })
        .collect();
    let region = |x: &Vector<3>| solid.regions.iter().rposition(|r| r.place.contains(&x.0, 0.0)).map_or(0, |r| r + 1);
    let of = splines::Body {
        surface: &surface,
        materials: &materials,
        material: &region,
        held: &held,
        mirrors: &mirrors,
        size: solid.spacing.map(|s| s.0),
    };
    let mut found = modes(&of, count).map_err(|e| refused(&e, &name, &surface))?;
    leaks(&found, &surface, &mirrors, &name)?;
    let points = splines::spread(&of, POINTS);
    Ok((0..found.modes.len()).map(|k| natural(&mut found, k, solid, &points).into()).collect())
}

/// The material of the body and those of its regions.
fn materials(solid: &Solid, name: &str) -> Result<Vec<Material>, RunError> {
    let mut all = vec![material(&solid.material, &format!("material of `{name}`"))?.as_elastic()];
    for (r, region) in solid.regions.iter().enumerate() {
        all.push(material(&region.material, &format!("material of region {} of `{name}`", r + 1))?.as_elastic());
    }
    if all.iter().any(|m| m.history_len() > 0) {
        return Err(RunError::Solid {
            what: format!("a material of `{name}` remembers (viscoelastic, hypoelastic): it has no natural modes"),
            hint: "use an elastic law: `linear`, `saint_venant_kirchhoff`, `neo_hookean`, `orthotropic`".into(),
        });
    }
    Ok(all)
}

/// Where the body is held.
fn supports(solid: &Solid) -> Vec<HeldBox> {
    let one = |place: &SolidSupport| {
        let axes: Vec<usize> = place.axes(3).into_iter().map(|a| a.index()).collect();
        let bounds = match &place.place {
            SolidPlace::Box(sides) => sides.bounds(),
            SolidPlace::All(_) => [[f64::NEG_INFINITY, f64::INFINITY]; 3],
        };
        HeldBox { place: bounds, fixed: std::array::from_fn(|d| axes.contains(&d)) }
    };
    solid.supports.iter().map(one).collect()
}

fn refused(unfit: &SplineModesError, name: &str, surface: &Surface<3>) -> RunError {
    let bounds = surface.bounds();
    let side = |d: usize| format!("{} from {:.6} to {:.6}", ["x", "y", "z"][d], bounds.min[d], bounds.max[d]);
    let hint = match unfit {
        SplineModesError::Unsupported { .. } => {
            format!("the body has {}", (0..3).map(side).collect::<Vec<_>>().join(", "))
        }
        SplineModesError::Hollow => "repair the surface: `alula check` tells of its holes".to_owned(),
        SplineModesError::TooLarge { .. } => "give a larger `spacing` in `[body.solid]`, or leave it out".to_owned(),
        SplineModesError::Soft => "check the elastic constants".to_owned(),
    };
    RunError::Solid { what: format!("own modes of `{name}`: {unfit}"), hint }
}

/// Refuses a surface that leaks.
fn leaks(found: &SplineModes, surface: &Surface<3>, mirrors: &[Mirror], name: &str) -> Result<(), RunError> {
    let off = found.volume / surface.volume() - 1.0;
    if off.abs() < LEAK || !mirrors.is_empty() {
        return Ok(());
    }
    Err(RunError::Solid {
        what: format!(
            "own modes of `{name}`: rays find a volume {:.1} % off that within its surface, which is not closed or runs through itself",
            100.0 * off
        ),
        hint: "repair the surface: `alula check` tells of its holes".into(),
    })
}

/// Mode number `k`, so that its greatest displacement is 1.
fn natural(found: &mut SplineModes, k: usize, solid: &Solid, points: &[Vector<3>]) -> Found {
    let shape = |found: &SplineModes| points.iter().map(|x| found.displacement(k, x)).collect::<Vec<_>>();
    let largest = |m: f64, u: &Vector<3>| u.0.iter().fold(m, |m, x| if x.abs() > m.abs() { *x } else { m });
    let greatest = shape(found).iter().fold(0.0, largest);
    found.scale(k, greatest);
    let velocity: Vec<Formula> = solid.velocity.iter().filter_map(|text| Formula::parse_in(text, 3).ok()).collect();
    let moved = |x: &Vector<3>| Vector::from_fn(|d| velocity.get(d).map_or(0.0, |f| f.value_at(&x.0, 0.0, 0.0)));
    let gravity = Vector::from_fn(|d| solid.gravity.get(d).map_or(0.0, |g| g.0));
    let mode = &found.modes[k];
    Found {
        omega: mode.omega,
        mass: mode.generalised_mass,
        weight: if gravity == Vector::ZERO { 0.0 } else { found.along(k, |_| gravity) },
        momentum: if velocity.is_empty() { 0.0 } else { found.along(k, moved) },
        damping: [solid.damping.0, solid.stiffness_damping.0],
        error: Some(mode.error),
        table: ModeTable {
            points: points.iter().map(|x| x.0).collect(),
            displacements: shape(found).iter().map(|u| u.0).collect(),
        },
    }
}
