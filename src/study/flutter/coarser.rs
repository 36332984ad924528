//! What the spacing of the cloud does to a boundary: how far crossings move on coarser clouds, and which motions grow on one of two alone.
use super::damping::{Pair, What, curves, pairs, safety};
use super::scales::Scales;
use crate::problem::coarser::times_the_spacing;
use crate::record::flutter::{Doubt, FlutterAt, remedy};

/// Tells the error that the cloud leaves in each crossing of `at`, and where the cloud decides whether motions grow, from the boundaries
/// on coarser clouds, each with its spacing over that of `at`.
pub(super) fn compare(at: &mut FlutterAt, others: &[(f64, FlutterAt)], scales: &Scales) {
    let mut doubts: Vec<Doubt> = Vec::new();
    for (ratio, coarse) in others {
        for doubt in held_against(at, (*ratio, coarse), scales) {
            // the same range of another cloud
            let same = |d: &Doubt| d.branch == doubt.branch && meet(d.speed_ratio, doubt.speed_ratio);
            let wider = |d: &Doubt| (d.damping - d.damping_coarser).abs();
            match doubts.iter_mut().find(|d| same(d)) {
                Some(known) if wider(known) >= wider(&doubt) => {}
                Some(known) => *known = doubt,
                None => doubts.push(doubt),
            }
        }
    }
    at.coarser_particles = others.iter().map(|(_, coarse)| coarse.particles).min().unwrap_or(0);
    doubts.iter().for_each(|doubt| at.warn((in_words(doubt, at.dimensional), remedy::SPACING)));
    at.doubts = doubts;
}

/// True where two ranges have something in common.
fn meet(a: [f64; 2], b: [f64; 2]) -> bool {
    a[0].min(a[1]) <= b[0].max(b[1]) && b[0].min(b[1]) <= a[0].max(a[1])
}

/// The same from one cloud; what it doubts.
fn held_against(at: &mut FlutterAt, (ratio, coarse): (f64, &FlutterAt), scales: &Scales) -> Vec<Doubt> {
    let reference = at.reference.dynamic_pressure;
    let [fine, other] = [&*at, coarse].map(|at| curves(&at.motions, reference));
    let both = pairs(&fine, &other);
    for crossing in &mut at.crossings {
        let like = coarse.crossings.iter().filter(|c| c.kind == crossing.kind && c.branch == crossing.branch);
        let moved = like.map(|c| apart(c.dynamic_pressure, crossing.dynamic_pressure)).min_by(f64::total_cmp);
        let place = (crossing.dynamic_pressure / reference).sqrt();
        let own = both.iter().find(|p| p.branch == crossing.branch);
        let moves = own.and_then(|pair| pair.moves(place));
        let error = moved.into_iter().chain(moves).reduce(f64::max).map(|error| safety(ratio) * error);
        // a crossing at zero has no part of it to be off by
        let error = error.filter(|e| e.is_finite());
        crossing.cloud_error = crossing.cloud_error.into_iter().chain(error).reduce(f64::max);
    }
    both.iter().flat_map(|pair| told(pair, ratio, scales)).collect()
}

/// Relative distance of two crossings, of the root of the dynamic pressure.
fn apart(a: f64, b: f64) -> f64 {
    if a == b { 0.0 } else { ((a / b).sqrt() - 1.0).abs() }
}

fn told(pair: &Pair, ratio: f64, scales: &Scales) -> Vec<Doubt> {
    let doubt = |region: super::damping::Region| {
        let [a, b] = region.ends.map(|place| scales.numbers(scales.place(place * place)));
        let ends = |of: fn(&super::scales::StreamNumbers) -> Option<f64>| Some([of(&a)?, of(&b)?]);
        Doubt {
            branch: pair.branch.clone(),
            kind: region.what.name().to_owned(),
            speed_ratio: [a.speed_ratio, b.speed_ratio],
            speed: [a.speed, b.speed],
            equivalent_airspeed: ends(|s| s.equivalent_airspeed),
            dynamic_pressure: [a.dynamic_pressure, b.dynamic_pressure],
            altitude: ends(|s| s.altitude),
            damping: region.damping[0],
            damping_coarser: region.damping[1],
            spacing_ratio: ratio,
        }
    };
    pair.regions().into_iter().map(doubt).collect()
}

/// What a doubt says.
fn in_words(doubt: &Doubt, dimensional: bool) -> String {
    let Doubt { branch, damping: here, damping_coarser: there, spacing_ratio, .. } = doubt;
    let spacing = times_the_spacing(*spacing_ratio);
    let [from, to] = doubt.speed_ratio;
    let range = match (dimensional, doubt.equivalent_airspeed) {
        (true, Some([a, b])) => format!("between {a:.1} and {b:.1} m/s EAS"),
        _ => {
            let [a, b] = [from, to];
            format!("between {a:.4} and {b:.4} of the speed of the case")
        }
    };
    let what = if doubt.kind == What::CoarserCloudOnly.name() {
        format!("grows {range} on a cloud with {spacing} (g up to {there:+.4}), but not on this one ({here:+.4})")
    } else if doubt.kind == What::Nearly.name() {
        format!(
            "comes nearer to growth {range} (g up to {here:+.4}) than the damping is known: {there:+.4} on a cloud with {spacing}"
        )
    } else if doubt.kind == What::ThisCloudOnly.name() {
        format!(
            "grows {range} by less (g up to {here:+.4}) than the damping is known: {there:+.4} on a cloud with {spacing}"
        )
    } else {
        format!(
            "decays again {range} by less (g down to {here:+.4}) than the damping is known: {there:+.4} on a cloud with {spacing}"
        )
    };
    format!("{branch} {what}; a finer `spacing` decides whether it flutters there")
}

#[cfg(test)]
mod tests {
    use super::super::held::problem_of;
    use super::*;
    use crate::case::{Case, Matching};
    use crate::record::flutter::CaseReference;
    use crate::record::flutter::{FlutterRow, MotionRow};

    fn case(cloud: &str) -> Case {
        let text = format!(
            "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[structure]\nelastic_axis = -0.4\nmass_ratio = 30\nx_alpha = 0.2\n\
             r_alpha2 = 0.25\nfrequency_ratio = 0.4\nspeed_index = 2.0\n[flutter]\n{cloud}"
        );
        problem_of(&text).about_steady_flow(0.5).unwrap().case().clone()
    }

    fn at(crossings: Vec<FlutterRow>, motions: Vec<MotionRow>) -> FlutterAt {
        let reference = CaseReference { dynamic_pressure: 1.0, ..CaseReference::default() };
        FlutterAt { crossings, motions, reference, particles: 7, ..FlutterAt::default() }
    }

    #[test]
    fn crossings_are_held_against_those_like_them() {
        let row = |kind: &str, branch: &str, dynamic_pressure: f64| FlutterRow {
            kind: kind.into(),
            branch: branch.into(),
            dynamic_pressure,
            ..FlutterRow::default()
        };
        let scales = Scales::of(&case(""), 1.0, Matching::None);
        let own = ["flutter", "divergence", "flutter"].into_iter().zip(["mode 1", "divergence 1", "mode 2"]);
        let own = own.zip([1.0, 4.0, 9.0]).map(|((kind, branch), q)| row(kind, branch, q)).collect();
        let mut fine = at(own, Vec::new());
        let other = vec![
            row("flutter", "mode 1", 1.21),
            row("flutter", "mode 1", 4.0),
            row("divergence", "divergence 1", 3.61),
        ];
        compare(&mut fine, &[(2.0, at(other, Vec::new()))], &scales);
        let found: Vec<Option<f64>> = fine.crossings.iter().map(|c| c.cloud_error).collect();
        let [first, second] = [0.1, 0.05].map(|moved| safety(2.0) * moved);
        assert!((found[0].unwrap() - first).abs() < 1e-12 && (found[1].unwrap() - second).abs() < 1e-12);
        assert_eq!((found[2], fine.coarser_particles), (None, 7));
    }

    /// Mode 1 with a hump of damping whose top is `top` where the speed is that of the case.
    fn hump(top: f64) -> Vec<MotionRow> {
        let motion = |k: i32| {
            let place = 0.02 * f64::from(k);
            MotionRow {
                branch: "mode 1".into(),
                mode: Some(1),
                speed_ratio: place,
                speed: place,
                equivalent_airspeed: None,
                dynamic_pressure: place * place,
                density: 1.0,
                altitude: None,
                reduced_frequency: 0.1,
                damping: top - (place - 1.0).powi(2),
                frequency: 1.0,
                eigenvalue: [0.0, 1.0],
            }
        };
        (1..=100).map(motion).collect()
    }

    #[test]
    fn flutter_on_the_other_cloud_alone_is_a_warning_with_its_range() {
        let scales = Scales::of(&case(""), 1.0, Matching::None);
        let mut fine = at(Vec::new(), hump(-0.014));
        compare(&mut fine, &[(2.0, at(Vec::new(), hump(0.030))), (1.5, at(Vec::new(), hump(0.010)))], &scales);
        let [doubt] = &fine.doubts[..] else { panic!("{:?}", fine.doubts) };
        assert_eq!((doubt.kind.as_str(), doubt.branch.as_str()), ("coarser_cloud_only", "mode 1"));
        assert!((doubt.damping + 0.014).abs() < 1e-9 && (doubt.damping_coarser - 0.03).abs() < 1e-9);
        assert!(doubt.speed_ratio[0] < 0.9 && doubt.speed_ratio[1] > 1.1, "{doubt:?}");
        assert!(fine.warnings[0].contains("mode 1 grows between") && fine.warnings[0].contains("spacing"));
        let mut sure = at(Vec::new(), hump(-0.2));
        compare(&mut sure, &[(2.0, at(Vec::new(), hump(-0.19)))], &scales);
        assert!(sure.doubts.is_empty() && sure.warnings.is_empty());
    }
}
