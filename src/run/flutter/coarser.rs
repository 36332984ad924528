//! How far crossings move on a coarser cloud: what spacing does to them, where interpolation and convergence do little.
use super::super::{accuracy, recipe};
use super::record::FlutterAt;
use crate::case::Case;

/// Spacing of the coarser cloud over that of a case that gives one.
const FACTOR: f64 = 2.0;

/// The case `own`, whose last cloud has so many particles, on a coarser one: the one before where the program chooses clouds, else one with
/// twice the spacing; `None` where that does not fit into the domain.
pub(super) fn coarser(own: &Case, particles: usize) -> Option<Case> {
    if let Some(asked) = accuracy::asked(own) {
        let mut case = own.clone();
        let fewer = particles.saturating_sub(1);
        case.accuracy = Some(crate::case::Accuracy { particles: fewer, ..asked });
        return (fewer > 0).then_some(case);
    }
    recipe::divides(own, FACTOR).then(|| accuracy::scaled(own, FACTOR))
}

/// Tells each crossing of `at` how far the one like it is on the coarser cloud.
pub(super) fn compare(at: &mut FlutterAt, coarse: &FlutterAt) {
    for crossing in &mut at.crossings {
        let like = coarse.crossings.iter().filter(|c| c.kind == crossing.kind && c.mode == crossing.mode);
        let apart = like.map(|c| ((c.dynamic_pressure / crossing.dynamic_pressure).sqrt() - 1.0).abs());
        crossing.cloud_error = apart.min_by(f64::total_cmp);
    }
    at.coarser_particles = coarse.particles;
}

#[cfg(test)]
mod tests {
    use super::super::record::FlutterRow;
    use super::*;

    #[test]
    fn crossings_are_held_against_those_like_them() {
        let row = |kind: &str, mode: usize, dynamic_pressure: f64| FlutterRow {
            kind: kind.into(),
            mode,
            dynamic_pressure,
            ..FlutterRow::default()
        };
        let all = |crossings: Vec<FlutterRow>| FlutterAt { crossings, particles: 7, ..FlutterAt::default() };
        let mut at = all(vec![row("flutter", 1, 1.0), row("divergence", 1, 4.0), row("flutter", 2, 9.0)]);
        compare(&mut at, &all(vec![row("flutter", 1, 1.21), row("flutter", 1, 4.0), row("divergence", 1, 3.61)]));
        let found: Vec<Option<f64>> = at.crossings.iter().map(|c| c.cloud_error).collect();
        assert!((found[0].unwrap() - 0.1).abs() < 1e-12 && (found[1].unwrap() - 0.05).abs() < 1e-12);
        assert_eq!((found[2], at.coarser_particles), (None, 7));
    }

    #[test]
    fn the_coarser_cloud_has_twice_the_spacing_or_is_the_one_before() {
        let case = |cloud: &str| {
            let text = format!("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[flutter]\n{cloud}");
            crate::case::read(&text, "case.toml").unwrap().flutter_case(0.5)
        };
        let given = coarser(&case("[cloud]\nspacing = 0.1\n"), 1000).unwrap();
        assert_eq!((given.cloud.spacing.map(|h| h.0), given.accuracy.is_none()), (Some(0.2), true));
        let chosen = coarser(&case(""), 1000).unwrap();
        assert_eq!((chosen.cloud.spacing.is_none(), chosen.accuracy.map(|a| a.particles)), (true, Some(999)));
        let three = "[cloud]\nspacing = 0.1\ndomain = { min = [-1.5, -1.5], max = [1.5, 1.4] }\n";
        assert!(coarser(&case(three), 1000).is_none());
    }
}
