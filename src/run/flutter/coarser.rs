//! How far crossings move on a coarser cloud: what spacing does to them, where interpolation and convergence do little.
use super::super::{accuracy, recipe};
use super::record::FlutterAt;
use crate::case::Case;

/// Spacing of the coarser cloud over that of the case.
const FACTOR: f64 = 2.0;

/// The case `own` with twice the spacing; `None` where that does not fit into the domain, or the case asks for a family of clouds.
pub(super) fn coarser(own: &Case) -> Option<Case> {
    let one = accuracy::asked(own).is_none() && own.cloud.spacing.is_some();
    (one && recipe::divides(own, FACTOR)).then(|| accuracy::scaled(own, FACTOR))
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
    use std::path::Path;

    use super::super::super::setup;
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
    fn the_coarser_cloud_has_twice_the_spacing_of_one_that_is_known() {
        let case = |cloud: &str| {
            let text = format!("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[flutter]\n{cloud}");
            crate::case::read(&text, "case.toml").unwrap().flutter_case(0.5)
        };
        let given = coarser(&case("[cloud]\nspacing = 0.1\n")).unwrap();
        assert_eq!(given.cloud.spacing.map(|h| h.0), Some(0.2));
        let open = case("");
        assert!(coarser(&open).is_none());
        let surface = setup::surface::<2>(&open, Path::new("")).unwrap().0;
        let chosen = coarser(&accuracy::on_one_cloud(open, surface.as_ref())).unwrap();
        assert_eq!((chosen.cloud.spacing.map(|h| h.0), chosen.accuracy.is_none()), (Some(1.0 / 32.0), true));
        let three = "[cloud]\nspacing = 0.1\ndomain = { min = [-1.5, -1.5], max = [1.5, 1.4] }\n";
        assert!(coarser(&case(three)).is_none());
        assert!(coarser(&case("[accuracy]\nloads = 0.02\n")).is_none());
    }
}
