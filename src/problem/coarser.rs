//! The cloud of small motions where the case leaves it to the program, and coarser ones that tell how far its forces are known.
//!
//! In smooth flow one with twice the spacing tells it. A captured shock moves by parts of a cell when the cloud changes, to either side:
//! loads then scatter from cloud to cloud, and two of them may agree by chance. There a third one is asked, with 3/2 of the spacing.
use super::numerics;
use super::spacing::{asked, scaled};
use crate::case::{Case, Cloud};
use crate::math::digits::short;

/// Spacing of the coarser cloud over that of the case, and of the third one where there are shocks.
pub(crate) const COARSER: f64 = 2.0;
pub(crate) const BETWEEN: f64 = 1.5;

/// How wide the spacing of a cloud is beside that of another, for people.
pub(crate) fn times_the_spacing(ratio: f64) -> String {
    if ratio == 2.0 { "twice the spacing".to_owned() } else { format!("{} times the spacing", short(ratio)) }
}

/// The cloud of the case `own`, whose spacing is known, with `ratio` times the spacing; `None` where that does not fit into the domain, and
/// where clouds are refined by what was found on the one before.
pub(crate) fn coarser(own: &Case, ratio: f64) -> Option<Cloud> {
    let one = asked(own).is_none() && own.cloud.spacing.is_some() && own.adapt.cycles == 0;
    (one && numerics::divides(&own.cloud, ratio)).then(|| scaled(&own.cloud, ratio))
}

/// How much finer the cloud `own` is than the one with `ratio` times the spacing where they differ least: a cloud with few particles
/// per level has no fewer on the coarser one, and errors made far from the walls fall no faster than that.
pub(crate) fn refinement(own: &Cloud, ratio: f64) -> f64 {
    ratio.min(own.particles_per_level() / scaled(own, ratio).particles_per_level())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::open::surface;
    use super::super::spacing::{Forces, one_cloud};
    use super::*;
    use crate::geometry::dimension;

    fn case(body: &str, cloud: &str) -> Case {
        let text = format!("[flow]\nmach = 0.5\n[[body]]\n{body}\n[cloud]\n{cloud}\n");
        crate::case::read(&text, "t").unwrap()
    }

    fn cloud(body: &str, cloud: &str) -> Cloud {
        let case = case(body, cloud);
        let one = match dimension(&case) {
            2 => one_cloud(&case, surface::<2>(&case, Path::new("")).unwrap().0.as_ref(), Forces::Table),
            _ => one_cloud(&case, surface::<3>(&case, Path::new("")).unwrap().0.as_ref(), Forces::Table),
        };
        one.unwrap_or(case.cloud)
    }

    #[test]
    fn sections_have_spacings_that_follow_thickness_nose_and_edges() {
        let told = |body: &str, more: &str| {
            let c = cloud(body, more);
            (c.spacing.map_or(0.0, |h| 1.0 / h.0), c.edge_levels, c.curvature_levels)
        };
        assert_eq!(told("naca = \"0012\"", ""), (64.0, 10, 10));
        assert_eq!(told("naca = \"0002\"", ""), (128.0, 9, 10));
        let (spacing, edges, _) = told("naca = \"0008\"", "");
        assert!(90.0 < spacing && spacing < 100.0 && edges == 10, "{spacing} {edges}");
        // turned, a section is as thin as before
        assert_eq!(told("naca = \"0002\"\nrotate = \"-30 deg\"", "").1, 9);
        assert_eq!(told("naca = \"0002\"", "edge_levels = 3\ncurvature_levels = 1"), (128.0, 3, 1));
        assert_eq!(told("naca = \"0002\"", "spacing = 0.1"), (10.0, 2, 3));
        assert_eq!(told("circle = { radius = 0.5 }", ""), (64.0, 10, 10));
        assert_eq!(told("sphere = { radius = 0.5 }", "").1, 2);
    }

    #[test]
    fn spacings_are_told_in_words() {
        let told = [COARSER, BETWEEN, 2.0_f64.sqrt()].map(times_the_spacing);
        assert_eq!(told, ["twice the spacing", "1.5 times the spacing", "1.41421 times the spacing"]);
    }

    #[test]
    fn clouds_with_few_particles_per_level_are_refined_by_less_than_their_spacing() {
        let refined = |layers: &str| refinement(&cloud("naca = \"0012\"", layers), COARSER);
        assert_eq!([refined(""), refined("spacing = 0.1\nlayers = 4")], [2.0, 4.0 / 3.0]);
    }

    #[test]
    fn the_coarser_cloud_has_twice_the_spacing_where_that_fits() {
        let spacing =
            |keys: &str| coarser(&case("naca = \"0012\"", keys), COARSER).and_then(|c| c.spacing.map(|h| h.0));
        assert_eq!(spacing("spacing = 0.015625"), Some(1.0 / 32.0));
        assert_eq!(spacing("spacing = 0.1\ndomain = { min = [-1.5, -1.5], max = [1.5, 1.4] }"), None);
    }
}
