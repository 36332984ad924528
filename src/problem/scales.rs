//! Lengths of a case that are out of all measure beside its bodies: mostly those of another unit.
//!
//! Where nothing but the bodies has a length, any length will do; where something else has one, both are in one unit.
use super::modes::UNITS;
use super::reference::of_bodies;
use crate::case::{Case, Length, Shape, Side, rounded};
use crate::cloud::CloudSpec;
use crate::geometry::{Planform, Surface};
use crate::math::{Bounds, Vector};

/// Ratio of two lengths that no shapes explain, but units do: a metre has a thousand millimetres.
const APART: f64 = 200.0;
/// Ratio of a reference chord and that of the bodies beyond which they are of two units, where a unit brings them together.
const OTHER_CHORD: f64 = 20.0;
/// Ratios within which a unit brings them together, and within which it fits well.
const TOGETHER: f64 = 10.0;
const ALIKE: f64 = 1.3;
/// Lengths of the bodies in a domain beyond all far fields.
const VAST: f64 = 1e4;
/// Spacings along a body that no cloud needs.
const FINE: f64 = 1e4;
/// Greatest length of what flies, in metres.
const LONGEST: f64 = 100.0;
/// Chords between a body and a far side below which the stream at the side is anything but free.
const NEAR: f64 = 0.5;
/// Sides of the domain, [axis][0: smallest, 1: largest coordinate].
const SIDES: [[&str; 2]; 3] = [["x_min", "x_max"], ["y_min", "y_max"], ["z_min", "z_max"]];

/// What is told of them.
pub(super) fn doubtful<const D: usize>(case: &Case, surface: &Surface<D>) -> Vec<String> {
    let spec = CloudSpec::<D>::of_case(case);
    let seen = of_bodies(case, surface);
    let mut told = match other_unit(case, &seen, &surface.bounds()) {
        Some(unit) => vec![unit],
        None => references::<D>(case, &seen),
    };
    told.extend(points(case, &surface.bounds()));
    told.extend(bodies(case, surface));
    told.extend(vast(case, &surface.bounds()));
    told.extend(few_levels(&spec));
    told.extend(near_sides(case, &spec, surface, seen.chord));
    told
}

/// Times that one length is the other where that is out of measure.
fn apart(given: f64, seen: f64) -> Option<f64> {
    let ratio = given / seen;
    (ratio.is_finite() && ratio > 0.0 && !(1.0 / APART..=APART).contains(&ratio)).then_some(ratio)
}

/// A reference chord in another unit than the bodies, with the unit that they are likely to be in.
fn other_unit<const D: usize>(case: &Case, seen: &Planform, bodies: &Bounds<D>) -> Option<String> {
    let given = case.reference.chord.as_ref()?.0;
    let apart = |length: f64| (seen.chord * length / given).ln().abs();
    // one that fits well, else the first that brings them together
    let nearest = UNITS.into_iter().min_by(|a, b| apart(a.0).total_cmp(&apart(b.0)));
    let fits = nearest.filter(|unit| apart(unit.0) < ALIKE.ln());
    let (length, unit) = fits.or_else(|| UNITS.into_iter().find(|unit| apart(unit.0) < TOGETHER.ln()))?;
    let file = case.bodies.iter().any(|b| matches!(b.shape, Shape::Surface(_) | Shape::Airfoil(_)));
    (file && apart(1.0) > OTHER_CHORD.ln()).then(|| {
        let extents = bodies.extent().0.map(short).join(" × ");
        format!(
            "`reference.chord` is {}, but the chord of the bodies is {}, and they measure {extents}: they seem to be in {unit}, then \
             `scale = \"{}\"` in `[[body]]`",
            short(given),
            short(seen.chord),
            symbol(length)
        )
    })
}

/// One unit of this length in metres, as a case writes it.
fn symbol(length: f64) -> String {
    let known = [(1e-3, "1 mm"), (1e-2, "1 cm"), (0.0254, "1 in"), (0.3048, "1 ft"), (1e3, "1 km")];
    known.into_iter().find(|(own, _)| *own == length).map_or_else(|| format!("{length} m"), |(_, text)| text.to_owned())
}

/// Chord and area that are none of the bodies.
fn references<const D: usize>(case: &Case, seen: &Planform) -> Vec<String> {
    let chord = ("reference.chord", case.reference.chord.map(|c| c.0), seen.chord, "chord");
    let area = ("reference.area", case.reference.area.filter(|_| D == 3), seen.area, "area of the planform");
    let one = |(key, given, seen, what): (&str, Option<f64>, f64, &str)| {
        let given = given?;
        let ratio = apart(given, seen)?;
        Some(format!(
            "`{key}` is {}, {ratio:.3e} times the {what} of the bodies, {}: is it in their unit?",
            short(given),
            short(seen)
        ))
    };
    [chord, area].into_iter().filter_map(one).collect()
}

/// Points of moments, hinges and turns that lie far from the bodies.
fn points<const D: usize>(case: &Case, bodies: &Bounds<D>) -> Vec<String> {
    let mut all: Vec<(String, Option<&Vec<Length>>)> = Vec::new();
    all.push(("reference.moment_point".into(), case.reference.moment_point.as_ref()));
    for (i, hinge) in case.hinge.iter().enumerate() {
        all.push((format!("hinge[{i}].from"), Some(&hinge.from)));
        all.push((format!("hinge[{i}].to"), hinge.to.as_ref()));
    }
    all.push(("motion.pivot".into(), case.motion.as_ref().and_then(|m| m.law.pivot.as_ref())));
    for (i, body) in case.bodies.iter().enumerate() {
        all.push((format!("body[{i}].motion.pivot"), body.motion.as_ref().and_then(|law| law.pivot.as_ref())));
    }
    let size = bodies.extent().max_abs();
    let far = |(key, point): (String, Option<&Vec<Length>>)| {
        let point = point?;
        let x = Vector::<D>::from_fn(|d| point.get(d).map_or(0.0, |l| l.0));
        let away = bodies.distance_squared(&x).sqrt() / size;
        (away > APART)
            .then(|| format!("`{key}` lies {away:.3e} lengths of the bodies away from them: is it in their unit?"))
    };
    all.into_iter().filter_map(far).collect()
}

/// Bodies whose lengths are of different units, or not of that of the stream and the spacing.
fn bodies<const D: usize>(case: &Case, surface: &Surface<D>) -> Vec<String> {
    let millimetres = "is it in millimetres? then `scale = \"1 mm\"`";
    let lengths: Vec<f64> = (0..surface.bodies.len()).map(|b| surface.bounds_of(b).extent().max_abs()).collect();
    let mut told = Vec::new();
    let order = |a: &&usize, b: &&usize| lengths[**a].total_cmp(&lengths[**b]);
    let all: Vec<usize> = (0..lengths.len()).collect();
    if let (Some(&small), Some(&large)) = (all.iter().min_by(order), all.iter().max_by(order))
        && let Some(ratio) = apart(lengths[large], lengths[small])
    {
        let [a, b] = [large, small].map(|k| (&surface.bodies[k], short(lengths[k])));
        told.push(format!(
            "body `{}` is {} long, {ratio:.0} times as long as body `{}`, {}: are both in the same unit?",
            a.0, a.1, b.0, b.1
        ));
    }
    for (name, (length, body)) in surface.bodies.iter().zip(lengths.iter().zip(&case.bodies)) {
        let file = matches!(body.shape, Shape::Surface(_) | Shape::Airfoil(_));
        let spacings = case.cloud.spacing.map_or(0.0, |s| length / s.0);
        if case.flow.is_dimensional() && file && *length > LONGEST {
            let extents =
                surface.bounds_of(surface.bodies.iter().position(|b| b == name).unwrap_or(0)).extent().0.map(short);
            told.push(format!("body `{name}` is {} m long ({}): {millimetres}", short(*length), extents.join(" × ")));
        } else if spacings > FINE {
            told.push(format!(
                "body `{name}` is {} long, {spacings:.3e} times `cloud.spacing`: {millimetres}",
                short(*length)
            ));
        }
    }
    told
}

/// A domain beside which the bodies are points.
fn vast<const D: usize>(case: &Case, bodies: &Bounds<D>) -> Option<String> {
    let widths = case.cloud.domain.as_ref().map(|domain| {
        let widths = domain.min.iter().zip(&domain.max).map(|(a, b)| b.0 - a.0);
        ("cloud.domain", widths.fold(0.0, f64::max))
    });
    let (key, wide) = widths.or(case.cloud.far_field.map(|half| ("cloud.far_field", 2.0 * half.0)))?;
    let ratio = wide / bodies.extent().max_abs();
    (ratio > VAST).then(|| format!("`{key}` is {ratio:.3e} lengths of the bodies wide: are both in the same unit?"))
}

/// A domain that is no multiple of a large power of two of the spacing: nowhere can the cloud be as coarse as it could.
fn few_levels<const D: usize>(spec: &CloudSpec<D>) -> Option<String> {
    /// Coarsest spacings along the longest side above which particles are wasted, in the plane and in space.
    const MANY: [u64; 2] = [256, 40];
    let far = spec.sides.iter().all(|ends| ends.contains(&Side::FarField));
    let domain = spec.domain.as_ref().filter(|_| far)?;
    let cells: [u64; D] = std::array::from_fn(|d| ((domain.max[d] - domain.min[d]) / spec.spacing).round() as u64);
    let shift = cells.iter().map(|c| c.trailing_zeros()).min()?;
    let longest = *cells.iter().max()?;
    (longest >> shift > MANY[D - 2] && shift < 10).then(|| {
        format!(
            "the sides of `cloud.domain` are {} times `cloud.spacing`, which have the factor {} and no greater power of two in common: no              spacing is coarser than that many, and the cloud is larger than it need be; take {} for the longest side",
            cells.map(|c| c.to_string()).join(" × "),
            1u64 << shift,
            longest.next_power_of_two()
        )
    })
}

/// Far sides so near that the stream is not free there; supersonic streams know nothing of what is behind or beside.
fn near_sides<const D: usize>(case: &Case, spec: &CloudSpec<D>, surface: &Surface<D>, chord: f64) -> Option<String> {
    let bodies = surface.bounds();
    let reach = |d: usize| spec.far_field.map(|half| half - 0.5 * bodies.extent()[d]);
    let gap = |d: usize, end: usize| match (&spec.domain, end) {
        (Some(domain), 0) => Some(bodies.min[d] - domain.min[d]),
        (Some(domain), _) => Some(domain.max[d] - bodies.max[d]),
        (None, _) => reach(d),
    };
    let all = (0..D).flat_map(|d| [(d, 0), (d, 1)]).filter(|(d, end)| spec.sides[*d][*end] == Side::FarField);
    // what reaches a side ends there on purpose
    let gaps = all.filter_map(|(d, end)| Some((gap(d, end)?, SIDES[d][end]))).filter(|(gap, _)| *gap > 0.0);
    let (gap, side) = gaps.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let mach = case.flow.reference().mach;
    (0.0 < mach && mach < 1.0 && gap < NEAR * chord).then(|| {
        format!(
            "the far side `{side}` is only {} chords from the bodies, where the stream is not free: loads need several chords; without \
             `cloud.domain` and `cloud.far_field` they are {}",
            short(gap / chord),
            if D == 2 { "40" } else { "10" }
        )
    })
}

/// Three digits are enough to recognise a length.
pub(super) fn short(value: f64) -> String {
    rounded(value, 3)
}

#[cfg(test)]
mod tests {
    use super::super::open::surface;
    use super::*;
    use std::path::Path;

    fn told(bodies: &str, more: &str) -> Vec<String> {
        let case = crate::case::read(&format!("[flow]\nmach = 0.5\n{bodies}{more}"), "t").unwrap();
        let (surface, _) = surface::<2>(&case, Path::new("")).unwrap();
        doubtful(&case, surface.as_ref().unwrap())
    }

    #[test]
    fn lengths_in_other_units_are_told() {
        let body = "[[body]]\nnaca = \"0012\"\n";
        let alone = |more: &str| told(body, more);
        let one = |told: Vec<String>, words: &str| assert!(matches!(&told[..], [t] if t.contains(words)), "{told:?}");
        one(alone("[reference]\nchord = 1e9\n"), "`reference.chord` is 1e9, 1.000e9 times the chord of the bodies, 1:");
        one(alone("[reference]\nmoment_point = [250, 0]\n"), "`reference.moment_point` lies 2.490e2 lengths");
        one(alone("[[hinge]]\nfrom = [1e6, 0]\n"), "`hinge[0].from` lies");
        one(alone("[cloud]\nspacing = 1e-5\n"), "is 1 long, 1.000e5 times `cloud.spacing`: is it in millimetres?");
        one(alone("[cloud]\nspacing = 0.01\nfar_field = 40000\n"), "`cloud.far_field` is 8.000e4 lengths");
        let two = "[[body]]\ncircle = { radius = 500 }\ntranslate = [2000, 0]\n";
        one(told(&format!("{body}{two}"), ""), "`body-2` is 1000 long, 1000 times as long as body `body-1`, 1:");
        for good in ["[reference]\nchord = 2\nmoment_point = [0, -3]\n", "[cloud]\nspacing = 0.002\nfar_field = 100\n"]
        {
            assert_eq!(alone(good), Vec::<String>::new());
        }
    }

    #[test]
    fn a_chord_in_another_unit_than_a_surface_file_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let wing = Surface::new(&[("w".to_owned(), crate::geometry::cuboid([150.0, 1200.0, 18.0]))]);
        crate::geometry::write_stl(&mut std::fs::File::create(folder.path().join("w.stl")).unwrap(), &wing).unwrap();
        let told = |reference: &str, stream: &str| {
            let text = format!(
                "[flow]\nmach = 0.5\n{stream}[[body]]\nsurface = \"w.stl\"\n[reference]\nchord = \"{reference}\"\n"
            );
            let case = crate::case::read(&text, "t").unwrap();
            let (surface, _) = surface::<3>(&case, folder.path()).unwrap();
            doubtful(&case, surface.as_ref().unwrap()).join("; ")
        };
        let metre = told("1 m", "");
        assert!(metre.contains("they measure 150 × 1200 × 18: they seem to be in millimetres"), "{metre}");
        assert!(metre.contains("`scale = \"1 mm\"`") && metre.contains("`reference.chord` is 1,"), "{metre}");
        assert_eq!(told("140 m", ""), "");
        let air = told("1 m", "pressure = 101325\ntemperature = \"15 degC\"\n");
        assert!(air.contains("1200 m long (150 × 1200 × 18): is it in millimetres?"), "{air}");
    }

    #[test]
    fn domains_that_no_power_of_two_divides_are_told() {
        let told = |spacing: f64| {
            let cloud =
                format!("[cloud]\nspacing = {spacing}\ndomain = {{ min = [-3.03, -3.03], max = [3.03, 3.03] }}\n");
            told("[[body]]\nnaca = \"0012\"\n", &cloud)
        };
        let odd = told(0.01);
        assert!(odd[0].contains("606 × 606 times `cloud.spacing`, which have the factor 2"), "{odd:?}");
        assert!(odd[0].ends_with("take 1024 for the longest side"), "{odd:?}");
        assert_eq!(told(6.06 / 512.0), Vec::<String>::new());
    }

    #[test]
    fn far_sides_beside_the_body_are_told() {
        let domain = |min: &str, more: &str| {
            told(
                "[[body]]\nnaca = \"0012\"\n",
                &format!("{more}[cloud]\nspacing = 0.01\ndomain = {{ min = [{min}], max = [4, 4] }}\n"),
            )
        };
        let near = domain("-0.02, -4", "");
        assert!(
            near.iter().any(|t| t.contains("the far side `x_min` is only 0.02 chords from the bodies")),
            "{near:?}"
        );
        assert_eq!(domain("-0.8, -4", ""), Vec::<String>::new());
        assert_eq!(domain("-4, 0", "[boundary]\ny_min = \"symmetry\"\n"), Vec::<String>::new());
        assert!(
            told("[[body]]\nnaca = \"0012\"\n", "[cloud]\nspacing = 0.01\nfar_field = 0.6\n")[0].contains("0.1 chords")
        );
    }
}
