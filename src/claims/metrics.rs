//! Metrics: numbers drawn from samples of a result.
//!
//! All functions take plain slices, work in any order of the samples and return `None` when the samples do not hold the
//! answer. Fronts are located between samples: the accuracy is a fraction of the spacing, not the spacing.
use super::curve::Curve;
use crate::math::Vector;

/// Slope over the steepest slope at which a shock profile is taken to end.
const SHOCK_FOOT: f64 = 0.25;
/// Part of the jump, on either side of its middle, whose samples locate a front.
const FRONT_HALF_WIDTH: f64 = 0.35;
/// Part of the length of a wake, on either side of its end, whose samples locate it.
const WAKE_END: f64 = 0.05;
/// Range of orders that an extrapolation may find.
const ORDER_RANGE: (f64, f64) = (0.2, 6.0);

/// Position of the shock on one side of a section: x of the mid-pressure point of the steepest rise of Cp.
///
/// The steepest rise between neighbours in `window` is widened both ways while the slope stays above a quarter of it; the
/// position is where Cp crosses the mean of both ends, linear between neighbours.
pub fn shock_position(x: &[f64], cp: &[f64], window: (f64, f64)) -> Option<f64> {
    let inside: Vec<(f64, f64)> =
        x.iter().copied().zip(cp.iter().copied()).filter(|(x, _)| window.0 <= *x && *x <= window.1).collect();
    let curve = sorted(inside)?;
    let slope = |i: usize| (curve[i + 1].1 - curve[i].1) / (curve[i + 1].0 - curve[i].0);
    let steepest = (0..curve.len() - 1).max_by(|a, b| slope(*a).total_cmp(&slope(*b)))?;
    let foot = SHOCK_FOOT * slope(steepest);
    if foot <= 0.0 {
        return None;
    }
    let (mut first, mut last) = (steepest, steepest + 1);
    while first > 0 && slope(first - 1) > foot {
        first -= 1;
    }
    while last + 1 < curve.len() && slope(last) > foot {
        last += 1;
    }
    let middle = 0.5 * (curve[first].1 + curve[last].1);
    let above = (first + 1..=last).find(|&i| curve[i].1 >= middle)?;
    let (a, b) = (curve[above - 1], curve[above]);
    Some(a.0 + (b.0 - a.0) * (middle - a.1) / (b.1 - a.1))
}

/// Root mean square of Cp less the reference curve at the same x.
pub fn cp_rms(x: &[f64], cp: &[f64], reference: &Curve) -> Option<f64> {
    cp_rms_exact(x, cp, |x| reference.at(x))
}

/// Root mean square of Cp less an exact function of x.
pub fn cp_rms_exact(x: &[f64], cp: &[f64], exact: impl Fn(f64) -> f64) -> Option<f64> {
    let differences: Vec<f64> = x.iter().zip(cp).map(|(x, cp)| cp - exact(*x)).collect();
    root_mean_square(&differences, None)
}

/// Greatest |value| of the differences of two curves on the points of the first.
pub fn max_difference(values: &[f64], reference: &[f64]) -> Option<f64> {
    let differences = values.iter().zip(reference).map(|(a, b)| (a - b).abs());
    differences.reduce(|a, b| if b.is_nan() { b } else { a.max(b) })
}

/// √(Σ w v² / Σ w); weights of one when absent.
pub fn root_mean_square(values: &[f64], weights: Option<&[f64]>) -> Option<f64> {
    let squares: Vec<f64> = values.iter().map(|v| v * v).collect();
    Some(weighted_mean(&squares, weights)?.sqrt())
}

/// Σ w v / Σ w, the mean pressure of a panel with areas as weights; weights of one when absent.
pub fn weighted_mean(values: &[f64], weights: Option<&[f64]>) -> Option<f64> {
    let weight = |i: usize| weights.map_or(1.0, |w| w.get(i).copied().unwrap_or(0.0));
    let total: f64 = (0..values.len()).map(weight).sum();
    (total > 0.0).then(|| values.iter().enumerate().map(|(i, v)| weight(i) * v).sum::<f64>() / total)
}

/// Indices of the points inside the box with corners `low` and `high`.
pub fn inside<const D: usize>(points: &[Vector<D>], low: &Vector<D>, high: &Vector<D>) -> Vec<usize> {
    let within = |x: &Vector<D>| (0..D).all(|d| low[d] <= x[d] && x[d] <= high[d]);
    (0..points.len()).filter(|&i| within(&points[i])).collect()
}

/// |end − start − inflow| / |start|: drift of a conserved total of which `inflow` came through the sides.
pub fn drift(start: f64, end: f64, inflow: f64) -> f64 {
    (end - start - inflow).abs() / start.abs().max(f64::MIN_POSITIVE)
}

/// Observed order of a method: least-squares slope of ln(error) against ln(spacing), any ratios of spacings.
pub fn observed_order(spacings: &[f64], errors: &[f64]) -> Option<f64> {
    let points: Vec<(f64, f64)> = spacings.iter().zip(errors).map(|(h, e)| (h.ln(), e.ln())).collect();
    if points.iter().any(|(h, e)| !h.is_finite() || !e.is_finite()) {
        return None;
    }
    let n = points.len() as f64;
    let (h, e) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let spread: f64 = points.iter().map(|p| (p.0 - h).powi(2)).sum();
    (spread > 0.0).then(|| points.iter().map(|p| (p.0 - h) * (p.1 - e)).sum::<f64>() / spread)
}

/// A quantity extrapolated to zero spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extrapolation {
    /// Observed order p.
    pub order: f64,
    /// Value at zero spacing.
    pub limit: f64,
}

/// Richardson extrapolation f(h) = f0 + C h^p from three spacings, coarse to fine, with any ratios.
///
/// p solves (f1 − f2)/(f2 − f3) = (h1^p − h2^p)/(h2^p − h3^p). `None` when the values do not approach from one side at
/// an order in 0.2 … 6: then the study is not in its asymptotic range.
///
/// Source: P. J. Roache, *Perspective: a method for uniform reporting of grid refinement studies*, J. Fluids Eng. 116 (1994)
/// 405-413, section on non-integer grid refinement.
pub fn richardson(spacings: &[f64; 3], values: &[f64; 3]) -> Option<Extrapolation> {
    let [h1, h2, h3] = *spacings;
    let [f1, f2, f3] = *values;
    let ratio = (f1 - f2) / (f2 - f3);
    if !(h1 > h2 && h2 > h3 && h3 > 0.0 && ratio > 0.0 && ratio.is_finite()) {
        return None;
    }
    // in units of h2 no power over- or underflows; the excess rises with p
    let (a, b) = (h1 / h2, h3 / h2);
    let excess = |p: f64| (a.powf(p) - 1.0) / (1.0 - b.powf(p)) - ratio;
    let (mut low, mut high) = ORDER_RANGE;
    if excess(low) > 0.0 || excess(high) < 0.0 {
        return None;
    }
    while high - low > 1e-12 {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 { low = middle } else { high = middle }
    }
    let order = 0.5 * (low + high);
    Some(Extrapolation { order, limit: extrapolate(&[h2, h3], &[f2, f3], order)? })
}

/// Limit of a quantity over any number of spacings, coarse to fine: Richardson's from the three finest where the values
/// approach from one side, the finest value (without order) where they do not.
pub fn limit(spacings: &[f64], values: &[f64]) -> Option<(f64, Option<f64>)> {
    let n = spacings.len().min(values.len());
    let finest = *values[..n].last()?;
    let three = (n >= 3)
        .then(|| richardson(&std::array::from_fn(|i| spacings[n - 3 + i]), &std::array::from_fn(|i| values[n - 3 + i])))
        .flatten();
    Some(three.map_or((finest, None), |e| (e.limit, Some(e.order))))
}

/// The limit f0 of f0 + C h^p from two spacings and a known order.
pub fn extrapolate(spacings: &[f64; 2], values: &[f64; 2], order: f64) -> Option<f64> {
    let ratio = (spacings[0] / spacings[1]).powf(order);
    (ratio.is_finite() && ratio > 1.0).then(|| values[1] + (values[1] - values[0]) / (ratio - 1.0))
}

/// Position of a front across `x` where `p` passes from `behind` to `ahead`, samples within `window` of x.
///
/// Samples in the middle 70 % of the jump are fitted by x = x_f + c (p − p_mid), which uses all rows of a cloud at once.
pub fn front_position(x: &[f64], p: &[f64], levels: [f64; 2], window: (f64, f64)) -> Option<f64> {
    let rows: Vec<[f64; 2]> = x
        .iter()
        .zip(p)
        .filter(|(x, _)| window.0 <= **x && **x <= window.1)
        .filter_map(|(x, p)| Some([*x, in_front(*p, levels)?]))
        .collect();
    if rows.is_empty() {
        return crossing(x, p, 0.5 * (levels[0] + levels[1]), window);
    }
    let fit = fit_plane(&rows.iter().map(|r| [1.0, r[1], 0.0]).collect::<Vec<_>>(), &column(&rows, 0));
    Some(fit.map_or_else(|| column(&rows, 0).iter().sum::<f64>() / rows.len() as f64, |f| f[0]))
}

/// Angle in radians to the x axis of a straight wave through samples (x, y, p), between pressures `levels` on its sides.
///
/// Half-jump locus: samples in the middle 70 % of the jump are fitted by x = a + b y + c (p − p_mid); tan β = 1/b. The term in
/// p takes out the thickness of the captured wave, so samples need not lie on the locus.
pub fn wave_angle(samples: &[[f64; 3]], levels: [f64; 2]) -> Option<f64> {
    let inside: Vec<[f64; 3]> = samples.iter().filter_map(|s| Some([s[0], s[1], in_front(s[2], levels)?])).collect();
    let rows: Vec<[f64; 3]> = inside.iter().map(|s| [1.0, s[1], s[2]]).collect();
    let x: Vec<f64> = inside.iter().map(|s| s[0]).collect();
    let fit = fit_plane(&rows, &x)?;
    Some(1.0_f64.atan2(fit[1]))
}

/// Greatest x at which samples (x, y, u) near the axis y = 0 pass from u < 0 to u > 0.
///
/// Samples on either side of the right-most crossing are fitted by x = x_0 + b u + c y²: a wake is even in y.
pub fn wake_end(samples: &[[f64; 3]]) -> Option<f64> {
    let take = |k: usize| samples.iter().map(|s| s[k]).collect::<Vec<f64>>();
    if samples.iter().all(|s| s[2] >= 0.0) {
        return None;
    }
    let rough = crossing(&take(0), &take(2), 0.0, (f64::NEG_INFINITY, f64::INFINITY))?;
    let near: Vec<&[f64; 3]> = samples.iter().filter(|s| (s[0] - rough).abs() <= WAKE_END * rough.abs()).collect();
    let rows: Vec<[f64; 3]> = near.iter().map(|s| [1.0, s[2], s[1] * s[1]]).collect();
    let x: Vec<f64> = near.iter().map(|s| s[0]).collect();
    Some(fit_plane(&rows, &x).map_or(rough, |fit| fit[0]))
}

/// (p − p_mid)/jump when it lies in the part of the jump that locates a front.
fn in_front(p: f64, levels: [f64; 2]) -> Option<f64> {
    let part = (p - 0.5 * (levels[0] + levels[1])) / (levels[1] - levels[0]);
    (part.abs() <= FRONT_HALF_WIDTH).then_some(part)
}

/// Right-most crossing of `level`, linear between neighbours in x.
fn crossing(x: &[f64], p: &[f64], level: f64, window: (f64, f64)) -> Option<f64> {
    let pairs = x.iter().copied().zip(p.iter().copied()).filter(|(x, _)| window.0 <= *x && *x <= window.1);
    let curve = sorted(pairs.collect())?;
    let pair = curve.windows(2).rev().find(|w| (w[0].1 - level) * (w[1].1 - level) <= 0.0 && w[0].1 != w[1].1)?;
    Some(pair[0].0 + (pair[1].0 - pair[0].0) * (level - pair[0].1) / (pair[1].1 - pair[0].1))
}

/// Points in rising x, those at the same x averaged; `None` with fewer than two or with numbers that are not finite.
fn sorted(mut points: Vec<(f64, f64)>) -> Option<Vec<(f64, f64)>> {
    if points.iter().any(|p| !p.0.is_finite() || !p.1.is_finite()) {
        return None;
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut out: Vec<(f64, f64, f64)> = Vec::with_capacity(points.len());
    for (x, y) in points {
        match out.last_mut() {
            Some(last) if last.0 == x => *last = (x, last.1 + y, last.2 + 1.0),
            _ => out.push((x, y, 1.0)),
        }
    }
    (out.len() >= 2).then(|| out.into_iter().map(|(x, sum, n)| (x, sum / n)).collect())
}

fn column(rows: &[[f64; 2]], k: usize) -> Vec<f64> {
    rows.iter().map(|r| r[k]).collect()
}

/// Least-squares coefficients of up to three columns; a column of zeros gets coefficient zero. `None` when singular.
fn fit_plane(rows: &[[f64; 3]], values: &[f64]) -> Option<[f64; 3]> {
    let n = rows.len() as f64;
    let mean = |k: usize| rows.iter().map(|r| r[k]).sum::<f64>() / n;
    let (m1, m2, mv) = (mean(1), mean(2), values.iter().sum::<f64>() / n);
    let [mut s11, mut s12, mut s22, mut s1v, mut s2v] = [0.0; 5];
    for (r, v) in rows.iter().zip(values) {
        let (a, b, v) = (r[1] - m1, r[2] - m2, v - mv);
        s11 += a * a;
        s12 += a * b;
        s22 += b * b;
        s1v += a * v;
        s2v += b * v;
    }
    let (b1, b2) = if s22 == 0.0 {
        if s11 == 0.0 || n < 2.0 {
            return None;
        }
        (s1v / s11, 0.0)
    } else {
        let determinant = s11 * s22 - s12 * s12;
        // the determinant is relative: two columns that are parallel to round-off define no plane
        if determinant <= 1e-12 * s11 * s22 || n < 3.0 {
            return None;
        }
        ((s1v * s22 - s2v * s12) / determinant, (s2v * s11 - s1v * s12) / determinant)
    };
    Some([mv - b1 * m1 - b2 * m2, b1, b2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shock_is_found_between_samples() {
        for shift in [0.0, 0.003, 0.007] {
            let x: Vec<f64> = (0..101).map(|i| f64::from(i) * 0.01).collect();
            let cp: Vec<f64> =
                x.iter().map(|x| -0.8 - 0.3 * x + 0.6 * (1.0 + ((x - 0.62 - shift) / 0.008).tanh())).collect();
            let found = shock_position(&x, &cp, (0.05, 0.95)).unwrap();
            assert!((found - 0.62 - shift).abs() < 0.0015, "{found} {shift}");
        }
        assert_eq!(shock_position(&[0.1, 0.2, 0.3], &[1.0, 0.5, 0.0], (0.0, 1.0)), None);
        assert_eq!(shock_position(&[], &[], (0.0, 1.0)), None);
        assert_eq!(shock_position(&[0.1, 0.2], &[f64::NAN, 0.5], (0.0, 1.0)), None);
    }

    #[test]
    fn curves_are_compared() {
        let reference = Curve::new(&[0.0, 1.0], &[0.0, 1.0]).unwrap();
        assert!((cp_rms(&[0.0, 0.5, 1.0], &[0.1, 0.6, 1.1], &reference).unwrap() - 0.1).abs() < 1e-15);
        assert_eq!(max_difference(&[1.0, 2.0], &[1.5, 1.0]), Some(1.0));
        assert!(max_difference(&[1.0, f64::NAN], &[1.5, 1.0]).unwrap().is_nan());
        assert_eq!(weighted_mean(&[1.0, 3.0], Some(&[3.0, 1.0])), Some(1.5));
        assert_eq!(weighted_mean(&[], None), None);
        assert_eq!(root_mean_square(&[3.0, 4.0], Some(&[1.0, 0.0])), Some(3.0));
        assert!((drift(2.0, 2.5, 0.4) - 0.05).abs() < 1e-15);
        let points = [Vector([0.0, 0.0]), Vector([1.0, 1.0])];
        assert_eq!(inside(&points, &Vector([0.5, 0.5]), &Vector([2.0, 2.0])), vec![1]);
    }

    #[test]
    fn the_end_of_a_wake_is_found_between_samples() {
        let u = |x: f64, y: f64| -0.2 * x * (2.236 - x) * (1.0 - 0.1 * (x - 2.236)) + 0.8 * y * y;
        let cell = |k: i32| [0.05 * f64::from(k / 4), 0.05 * (f64::from(k % 4) - 1.7)];
        let samples: Vec<[f64; 3]> = (4..320).map(cell).map(|[x, y]| [x, y, u(x, y)]).collect();
        let found = wake_end(&samples).unwrap();
        assert!((found - 2.236).abs() < 5e-3, "{found}");
        assert_eq!(wake_end(&[[0.1, 0.0, 0.2], [0.2, 0.0, 0.3]]), None);
        assert_eq!(wake_end(&[]), None);
    }

    #[test]
    fn order_and_limit_are_recovered_for_any_ratios() {
        let h = [0.05, 0.03, 0.011];
        for p in [0.7, 1.0, 2.0, 3.5] {
            let error = h.map(|h: f64| 0.4 * h.powf(p));
            assert!((observed_order(&h, &error).unwrap() - p).abs() < 1e-12);
            let e = richardson(&h, &error.map(|e| 1.3 - e)).unwrap();
            assert!((e.order - p).abs() < 1e-6 && (e.limit - 1.3).abs() < 1e-9, "{e:?}");
        }
        assert_eq!(richardson(&h, &[1.0, 1.1, 1.05]), None, "values that swing have no limit");
        assert_eq!(richardson(&h, &[1.0, 1.0, 1.0]), None);
        assert_eq!(observed_order(&[0.1, 0.05], &[0.0, 1.0]), None);
        assert_eq!(limit(&h, &[1.0, 1.1, 1.05]), Some((1.05, None)));
        assert!((limit(&h, &h.map(|h| 1.0 + h * h)).unwrap().0 - 1.0).abs() < 1e-9);
        assert_eq!(limit(&[], &[]), None);
        assert!((extrapolate(&[2.0, 1.0], &[1.4, 1.1], 2.0).unwrap() - 1.0).abs() < 1e-12);
    }

    /// A captured wave from the origin at `angle`, four spacings thick, on a shaken lattice.
    fn captured_wave(angle: f64, h: f64) -> Vec<[f64; 3]> {
        let mut samples = Vec::new();
        for i in 0..100 {
            for j in 0..60 {
                let shake = |k: i32| 0.3 * h * (f64::from(i * 31 + j * 17 + k * 7) * 12.9898).sin();
                let (x, y) = (f64::from(i) * h + shake(0), f64::from(j) * h + shake(1));
                let distance = x * angle.sin() - y * angle.cos();
                samples.push([x, y, 1.35 + 0.35 * (distance / (1.2 * h)).tanh()]);
            }
        }
        samples
    }

    #[test]
    fn wave_angle_is_exact_to_a_tenth_of_a_degree() {
        for degrees in [25.0, 39.31393, 60.0, 85.0] {
            let samples = captured_wave(f64::to_radians(degrees), 0.01);
            let found = wave_angle(&samples, [1.0, 1.7]).unwrap().to_degrees();
            assert!((found - degrees).abs() < 0.1, "{found} {degrees}");
        }
        assert_eq!(wave_angle(&[], [1.0, 2.0]), None);
        assert_eq!(wave_angle(&[[0.0, 0.0, 1.5]; 5], [1.0, 2.0]), None);
    }

    #[test]
    fn front_is_found_between_samples() {
        let samples = captured_wave(std::f64::consts::FRAC_PI_2, 0.01);
        let x: Vec<f64> = samples.iter().map(|s| s[0] + 0.4037).collect();
        let p: Vec<f64> = samples.iter().map(|s| s[2]).collect();
        // the wave stands at the left end of the lattice: half of it is there
        assert!((front_position(&x, &p, [1.0, 1.7], (0.3, 0.9)).unwrap() - 0.4037).abs() < 1e-3);
        let step = front_position(&[0.0, 1.0, 2.0], &[2.0, 2.0, 1.0], [2.0, 1.0], (0.0, 2.0)).unwrap();
        assert_eq!(step, 1.5);
        assert_eq!(front_position(&[0.0], &[1.0], [1.0, 2.0], (0.0, 1.0)), None);
    }
}
