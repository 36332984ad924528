//! Contour lines of a raster by marching squares.
//!
//! In a cell with corner values a, b, c, d the line crosses an edge where the level lies between its ends, at the place
//! that linear interpolation gives. A saddle (all four edges crossed) is split by the mean of the corners. Cells with a
//! corner that is not a number have no line.

/// Segments of the line `level` in pixel coordinates: pixel (k, l) has its value at (k, l), row by row.
pub(super) fn segments(values: &[f64], width: usize, level: f64) -> Vec<[[f64; 2]; 2]> {
    let height = values.len().checked_div(width).unwrap_or(0);
    let mut all = Vec::new();
    for l in 0..height.saturating_sub(1) {
        for k in 0..width - 1 {
            let at = |dk: usize, dl: usize| values[(l + dl) * width + k + dk] - level;
            let corners = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
            cell(corners, [k as f64, l as f64], &mut all);
        }
    }
    all
}

fn cell(corners: [f64; 4], origin: [f64; 2], all: &mut Vec<[[f64; 2]; 2]>) {
    const PLACE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    if corners.iter().any(|c| !c.is_finite()) {
        return;
    }
    let mut crossings = [[0.0; 2]; 4];
    let mut n = 0;
    for e in 0..4 {
        let (a, b) = (corners[e], corners[(e + 1) % 4]);
        if (a < 0.0) != (b < 0.0) {
            let s = a / (a - b);
            let (p, q) = (PLACE[e], PLACE[(e + 1) % 4]);
            crossings[n] = [origin[0] + p[0] + s * (q[0] - p[0]), origin[1] + p[1] + s * (q[1] - p[1])];
            n += 1;
        }
    }
    let [a, b, c, d] = crossings;
    match n {
        2 => all.push([a, b]),
        // Edge 0 joins edge 1 around corner 1 when the middle sides with corner 0.
        4 if (corners.iter().sum::<f64>() < 0.0) == (corners[0] < 0.0) => all.extend([[a, b], [c, d]]),
        4 => all.extend([[a, d], [b, c]]),
        _ => (),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_contour_of_a_cone_is_a_circle() {
        let n = 81;
        let values: Vec<f64> = (0..n * n).map(|i| ((i % n) as f64 - 40.0).hypot((i / n) as f64 - 40.0)).collect();
        let circle = segments(&values, n, 30.0);
        let length: f64 = circle.iter().map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
        assert!((length - 60.0 * std::f64::consts::PI).abs() < 0.2, "{length}");
        assert!(circle.iter().flatten().all(|p| ((p[0] - 40.0).hypot(p[1] - 40.0) - 30.0).abs() < 0.02));
    }

    #[test]
    fn saddles_and_holes_are_handled() {
        assert_eq!(segments(&[1.0, -1.0, -1.0, 1.0], 2, 0.0).len(), 2);
        assert!(segments(&[1.0, -1.0, f64::NAN, 1.0], 2, 0.0).is_empty());
        assert!(segments(&[], 0, 0.0).is_empty());
    }
}
