//! Placement of bodies: scaling, rotation about the origin of the shape, translation.
//!
//! In 2-D a positive angle raises the nose for flow along +x, which is a clockwise rotation. In 3-D the rotations are
//! about x, then y, then z, right-handed: a positive rotation about y raises the nose (z up).
use super::GeometryError;
use super::shell::{Exact, Shell};
use crate::case::Placement;
use crate::math::{Bounds, Vector};

/// Greatest distance of a body from the origin, in body lengths: farther away, coordinates in double precision
/// represent its shape with fewer than eight digits.
const FARTHEST: f64 = 1e8;

/// Applies `placement` to `shell`; `body` is its name for messages.
pub(super) fn place<const D: usize>(
    body: &str,
    shell: &mut Shell<D>,
    placement: &Placement,
) -> Result<(), GeometryError> {
    let bad = |what: String, hint: &str| GeometryError::refused(format!("body `{body}`"), what, hint);
    let scale = placement.scale;
    if !(0.0 < scale && scale < 1e50) {
        return Err(bad(format!("`scale` is {scale}"), "use a positive number"));
    }
    let angles: Vec<f64> = placement.rotate.iter().map(|a| a.0).collect();
    let shift: Vec<f64> = placement.translate.iter().map(|l| l.0).collect();
    if !(shift.is_empty() || shift.len() == D) || shift.iter().any(|v| !v.is_finite()) {
        return Err(bad(format!("`translate` is {shift:?}"), &format!("give {D} finite numbers")));
    }
    let wanted = if D == 2 { 1 } else { 3 };
    if !(angles.is_empty() || angles.len() == wanted) || angles.iter().any(|v| !v.is_finite()) {
        let hint = if D == 2 { "give one angle, nose up positive" } else { "give three angles, about x, y and z" };
        return Err(bad(format!("`rotate` is {angles:?}"), hint));
    }
    let turn = |x: &Vector<D>| rotated(x, &angles);
    let moved = |x: &Vector<D>| placed(x, placement);
    let size = scale * Bounds::around(&shell.vertices).extent().max_abs();
    let reach = shift.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    if reach > FARTHEST * size {
        let what =
            format!("`translate` is {shift:?}, too far from the origin to hold the shape of a body {size:e} long");
        return Err(bad(
            what,
            &format!("allowed: from {:e} to {:e} along each axis", -FARTHEST * size, FARTHEST * size),
        ));
    }
    shell.vertices.iter_mut().for_each(|v| *v = moved(v));
    for normal in shell.normals.iter_mut().flatten().flatten() {
        *normal = turn(normal);
    }
    shell.curvature.iter_mut().flatten().for_each(|k| *k /= scale);
    if let Exact::Ball { centre, radius } = &mut shell.exact {
        (*centre, *radius) = (moved(centre), *radius * scale);
    }
    Ok(())
}

/// Position of a point of a shape after placement.
pub(super) fn placed<const D: usize>(x: &Vector<D>, placement: &Placement) -> Vector<D> {
    turned(x, placement) * placement.scale + shift(placement)
}

/// Direction of a shape after placement.
pub(super) fn turned<const D: usize>(x: &Vector<D>, placement: &Placement) -> Vector<D> {
    rotated(x, &placement.rotate.iter().map(|a| a.0).collect::<Vec<_>>())
}

/// Translation of the origin of a shape.
pub(super) fn shift<const D: usize>(placement: &Placement) -> Vector<D> {
    Vector::from_fn(|d| placement.translate.get(d).map_or(0.0, |l| l.0))
}

fn rotated<const D: usize>(x: &Vector<D>, angles: &[f64]) -> Vector<D> {
    let mut x = *x;
    for (axis, angle) in angles.iter().enumerate() {
        // clockwise in 2-D, right-handed about `axis` in 3-D
        let (i, j, angle) = if D == 2 { (0, 1, -angle) } else { ((axis + 1) % 3, (axis + 2) % 3, *angle) };
        let (sin, cos) = angle.sin_cos();
        (x[i], x[j]) = (cos * x[i] - sin * x[j], sin * x[i] + cos * x[j]);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn positive_angles_lift_the_nose() {
        let nose = rotated(&Vector([-1.0, 0.0]), &[0.1]);
        assert!((nose - Vector([-0.1_f64.cos(), 0.1_f64.sin()])).norm() < 1e-15);
        let nose = rotated(&Vector([-1.0, 0.0, 0.0]), &[0.0, 0.1, 0.0]);
        assert!((nose - Vector([-0.1_f64.cos(), 0.0, 0.1_f64.sin()])).norm() < 1e-15);
    }

    #[test]
    fn bodies_too_far_from_the_origin_are_refused() {
        let told = |at: &str, shape: &str| {
            let text = format!("[flow]\nmach = 0.3\n[[body]]\nname = \"a\"\n{shape}\ntranslate = {at}\n");
            let case = crate::case::read(&text, "t").unwrap();
            let loaded = super::super::load_surface::<2>(&case.bodies, std::path::Path::new("."));
            loaded.map(drop).map_err(|e| e.to_string())
        };
        assert!(told("[1e16, 0]", "box = { size = [2, 0.5] }").unwrap_err().contains("from -2e8 to 2e8"));
        for shape in ["box = { size = [2, 0.5] }", "circle = { radius = 1 }", "naca = \"0012\"\nscale = 2"] {
            let far = told("[1e16, 0]", shape).unwrap_err();
            let words = ["body `a`: `translate` is [1e16, 0.0]", "hint: allowed: from -", "e8 along each axis"];
            words.iter().for_each(|w| assert!(far.contains(w), "{far}"));
            assert_eq!(told("[1e6, -1e6]", shape), Ok(()));
        }
    }

    #[test]
    fn rotations_in_space_follow_the_order_x_y_z() {
        let x = rotated(&Vector([0.0, 1.0, 0.0]), &[0.5 * PI, 0.5 * PI, 0.0]);
        assert!((x - Vector([1.0, 0.0, 0.0])).norm() < 1e-15, "{x:?}");
    }
}
