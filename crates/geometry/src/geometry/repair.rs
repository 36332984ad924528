//! Repair of a triangle soup to a closed, consistently oriented shell.
//!
//! Vertices are merged, and degenerate and repeated triangles removed. Needles are resolved by splitting the triangle
//! on their long side. The orientation is made consistent by a flood fill across edges with exactly two triangles; each
//! component is oriented outward by the sign of its volume. Holes are closed where this is safe ([`super::holes`]), and
//! overlapping parts are united ([`super::parts`]). Defects that cannot be repaired safely are rejected with their
//! position: large holes, edges with an odd number of triangles, one-sided surfaces, and self-intersecting parts.
use super::mesh::Soup;
use super::shell::{Facet, Shell, at, facets, runs};
use super::weld::weld;
use super::{GeometryError, holes, parts, simplex};
use crate::math::{Bounds, Vector};
use std::collections::HashSet;

/// Height of a triangle, as a fraction of the diagonal, below which it is a needle.
const NEEDLE: f64 = 1e-9;
/// Greatest number of rounds of needle removal; each round resolves all needles that do not touch another one.
const ROUNDS: usize = 16;

/// Makes a shell of the triangles of `file`; vertices nearer than `within` are merged if it is given. Notes about
/// repairs are appended to `notes`. Fails when a defect cannot be repaired safely.
pub(super) fn shell(
    file: &str,
    soup: &Soup,
    within: Option<f64>,
    notes: &mut Vec<String>,
) -> Result<Shell<3>, GeometryError> {
    let mut shell = weld(file, soup, within, notes)?;
    split_needles(file, &mut shell, notes);
    let inward = orient(file, &mut shell, notes)?;
    holes::fill(file, &mut shell, notes);
    check_edges(file, &shell, notes)?;
    parts::settle(file, shell, &inward, notes)
}

/// Resolves needles. Removing a needle a-b-c with b on the side a-c would open a crack; instead, the triangle beyond
/// a-c is split at b.
fn split_needles(file: &str, shell: &mut Shell<3>, notes: &mut Vec<String>) {
    let size = Bounds::around(&shell.vertices).extent().norm();
    let mut resolved = 0;
    for _ in 0..ROUNDS {
        let before = shell.elements.len();
        let dropped = split_needles_once(shell, NEEDLE * size);
        resolved += dropped.len();
        if dropped.is_empty() {
            break;
        }
        let keep: Vec<bool> =
            (0..shell.elements.len()).map(|e| e >= before || !dropped.contains(&(e as u32))).collect();
        let (mut e, mut t) = (keep.iter(), keep.iter());
        shell.elements.retain(|_| *e.next().unwrap_or(&true));
        shell.tags.retain(|_| *t.next().unwrap_or(&true));
    }
    if resolved > 0 {
        notes.push(format!("{file}: {resolved} needle triangles are merged into their neighbours"));
    }
}

/// Splits the neighbours of needles that touch no other change of this round; returns the needles to be removed.
fn split_needles_once(shell: &mut Shell<3>, height: f64) -> HashSet<u32> {
    let needles: Vec<(u32, usize)> =
        (0..shell.elements.len()).filter_map(|e| Some((e as u32, needle_tip(&shell.corners(e), height)?))).collect();
    let (mut dropped, mut touched) = (HashSet::new(), HashSet::new());
    if needles.is_empty() {
        return dropped;
    }
    let all = facets(&shell.elements);
    for (e, tip) in needles {
        let [v, w] = [1, 2].map(|k| shell.elements[e as usize][(tip + k) % 3]);
        let edge = [v.min(w), v.max(w)];
        let first = all.partition_point(|f| f.vertices < edge);
        let across: Vec<&Facet> =
            all[first..].iter().take_while(|f| f.vertices == edge).filter(|f| f.element != e).collect();
        let [other] = across[..] else { continue };
        if touched.contains(&e) || touched.contains(&other.element) {
            continue;
        }
        touched.extend([e, other.element]);
        let old = shell.elements[other.element as usize];
        let b = shell.elements[e as usize][tip];
        let (mut first_half, mut second_half) = (old, old);
        first_half[(other.opposite + 1) % 3] = b;
        second_half[(other.opposite + 2) % 3] = b;
        if old.contains(&b) {
            // both triangles collapse to the same three vertices and enclose nothing
            dropped.insert(other.element);
        } else {
            shell.elements[other.element as usize] = first_half;
            shell.elements.push(second_half);
            let tag = shell.tags[other.element as usize];
            shell.tags.push(tag);
        }
        dropped.insert(e);
    }
    dropped
}

/// Index of the corner opposite the longest side, when the height of the triangle over it is less than `height`.
fn needle_tip(c: &[Vector<3>; 3], height: f64) -> Option<usize> {
    let side = |k: usize| (c[(k + 2) % 3] - c[(k + 1) % 3]).norm();
    let tip = (0..3).fold(0, |a, k| if side(k) > side(a) { k } else { a });
    (2.0 * simplex::area_vector(c).norm() <= height * side(tip)).then_some(tip)
}

/// Makes the orientation consistent within components and outward by the sign of their volume. Returns for each
/// triangle whether its component was mostly oriented inward.
fn orient(file: &str, shell: &mut Shell<3>, notes: &mut Vec<String>) -> Result<Vec<bool>, GeometryError> {
    let n = shell.elements.len();
    let neighbours = neighbours(shell);
    let mut component = vec![u32::MAX; n];
    let (mut flipped, mut inward) = (vec![false; n], vec![false; n]);
    let mut changed = 0;
    for seed in 0..n {
        if component[seed] != u32::MAX {
            continue;
        }
        component[seed] = seed as u32;
        let mut members = vec![seed];
        let mut next = 0;
        while let Some(&e) = members.get(next) {
            next += 1;
            for &(f, same) in &neighbours[e] {
                if component[f] == u32::MAX {
                    component[f] = seed as u32;
                    flipped[f] = flipped[e] ^ same;
                    members.push(f);
                } else if flipped[f] != flipped[e] ^ same {
                    let what = format!("the surface has one side only near {}", at(&shell.corners(e)[0]));
                    return Err(GeometryError::refused(file, what, "remove the twisted part"));
                }
            }
        }
        let outward = volume(shell, &members, &flipped) >= 0.0;
        let mut turned = 0;
        for &e in &members {
            flipped[e] ^= !outward;
            turned += usize::from(flipped[e]);
        }
        changed += turned;
        members.iter().for_each(|e| inward[*e] = 2 * turned > members.len());
    }
    for e in (0..n).filter(|&e| flipped[e]) {
        shell.elements[e].swap(1, 2);
    }
    if changed > 0 {
        notes.push(format!("{file}: {changed} of {n} triangles are turned to face outward"));
    }
    Ok(inward)
}

/// For each element, the elements across its edges with two triangles, and whether both run along the edge in the same
/// direction, so that one of them must be reversed.
fn neighbours(shell: &Shell<3>) -> Vec<Vec<(usize, bool)>> {
    let all = facets(&shell.elements);
    let mut neighbours = vec![Vec::new(); shell.elements.len()];
    for run in runs(&all).filter(|run| run.len() == 2) {
        let forward = |f: &Facet| shell.elements[f.element as usize][(f.opposite + 1) % 3] == f.vertices[0];
        let same = forward(&run[0]) == forward(&run[1]);
        let (e, f) = (run[0].element as usize, run[1].element as usize);
        neighbours[e].push((f, same));
        neighbours[f].push((e, same));
    }
    neighbours
}

/// Signed volume of a component relative to its first corner.
fn volume(shell: &Shell<3>, members: &[usize], flipped: &[bool]) -> f64 {
    let origin = shell.corners(members[0])[0];
    let flux = |e: usize| {
        let c = shell.corners(e);
        let value = (c[0] - origin).dot(&simplex::area_vector(&c));
        if flipped[e] { -value } else { value }
    };
    members.iter().map(|&e| flux(e)).sum()
}

/// Rejects edges with an odd number of triangles.
fn check_edges(file: &str, shell: &Shell<3>, notes: &mut Vec<String>) -> Result<(), GeometryError> {
    let all = facets(&shell.elements);
    let middle = |f: &Facet| (shell.vertices[f.vertices[0] as usize] + shell.vertices[f.vertices[1] as usize]) * 0.5;
    let crowded: Vec<&[Facet]> = runs(&all).filter(|run| run.len() > 2).collect();
    if let Some(odd) = crowded.iter().find(|run| run.len() % 2 == 1) {
        let what = format!("{} triangles meet at the edge near {}", odd.len(), at(&middle(&odd[0])));
        return Err(GeometryError::refused(file, what, "remove inner walls and fins without thickness"));
    }
    if let Some(run) = crowded.first() {
        let place = at(&middle(&run[0]));
        notes.push(format!("{file}: closed parts touch along {} edges, the first near {place}", crowded.len()));
    }
    let open: Vec<Facet> = runs(&all).filter(|run| run.len() == 1).map(|run| run[0]).collect();
    if open.is_empty() {
        return Ok(());
    }
    Err(GeometryError::refused(
        file,
        holes::told(shell, &open),
        "close the surface, which must bound a volume (sheets need a thickness), or join vertices farther apart with `weld` in the table of \
         the body",
    ))
}

#[cfg(test)]
mod tests {
    use super::super::mesh;
    use super::super::primitive::{cuboid, icosphere, write_stl};
    use super::super::surface::Surface;
    use super::*;
    use proptest::prelude::*;

    type Loaded = Result<(Surface<3>, Vec<String>), GeometryError>;

    fn load(file: &str, bytes: &[u8]) -> Loaded {
        let mut notes = Vec::new();
        let shell = shell(file, &mesh::read(file, bytes, &mut notes)?, None, &mut notes)?;
        Ok((Surface::new(&[("body".into(), shell)]), notes))
    }

    fn soup(shells: &[&Shell<3>]) -> Soup {
        let triangles: Vec<_> = shells.iter().flat_map(|s| s.all_corners()).collect();
        Soup { tags: vec![0; triangles.len()], names: vec!["all".into()], triangles }
    }

    fn mend(soup: &Soup) -> Loaded {
        mend_within(soup, None)
    }

    fn mend_within(soup: &Soup, within: Option<f64>) -> Loaded {
        let mut notes = Vec::new();
        let shell = shell("body.stl", soup, within, &mut notes)?;
        Ok((Surface::new(&[("body".into(), shell)]), notes))
    }

    fn stl(subdivisions: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_stl(&mut bytes, &Surface::new(&[(String::new(), icosphere(1.0, subdivisions))])).unwrap();
        bytes
    }

    fn moved(shell: &Shell<3>, by: [f64; 3]) -> Shell<3> {
        let mut shell = shell.clone();
        shell.vertices.iter_mut().for_each(|v| *v += Vector(by));
        shell
    }

    #[test]
    fn a_sphere_survives_the_round_trip() {
        let bytes = stl(4);
        assert_eq!(bytes, stl(4), "the file is the same every time");
        let (surface, notes) = load("ball.stl", &bytes).unwrap();
        assert!(notes.is_empty() && surface.elements.len() == 5120 && surface.vertices.len() == 2562, "{notes:?}");
        assert!((surface.volume() / icosphere_volume(4) - 1.0).abs() < 1e-6 && surface.sharp.is_empty());
    }

    fn icosphere_volume(subdivisions: u32) -> f64 {
        Surface::new(&[(String::new(), icosphere(1.0, subdivisions))]).volume()
    }

    #[test]
    fn flipped_and_repeated_triangles_are_mended() {
        let mut soup = soup(&[&icosphere(1.0, 3)]);
        for k in (0..soup.triangles.len()).step_by(3) {
            soup.triangles[k].swap(0, 1);
        }
        let copies: Vec<_> = soup.triangles.iter().step_by(10).copied().collect();
        soup.triangles.extend(&copies);
        let point = soup.triangles[0][0];
        soup.triangles.push([point, point, soup.triangles[0][1]]);
        soup.tags.resize(soup.triangles.len(), 0);
        let (surface, notes) = mend(&soup).unwrap();
        assert!((surface.volume() / icosphere_volume(3) - 1.0).abs() < 1e-12);
        assert!(notes.len() == 3 && notes.iter().any(|n| n.contains("128 repeated")), "{notes:?}");
        assert!(notes.iter().any(|n| n.contains("427 of 1280 triangles are turned")), "{notes:?}");
    }

    #[test]
    fn inward_bodies_are_turned_and_parts_inside_others_are_left_out() {
        let mut inside_out = icosphere(1.0, 2);
        inside_out.elements.iter_mut().for_each(|e| e.swap(0, 1));
        let (surface, notes) = mend(&soup(&[&inside_out, &moved(&icosphere(1.0, 2), [3.0, 0.0, 0.0])])).unwrap();
        assert!((surface.volume() / icosphere_volume(2) - 2.0).abs() < 1e-12 && notes.len() == 1, "{notes:?}");
        let (surface, notes) = mend(&soup(&[&icosphere(0.5, 2), &icosphere(1.0, 3)])).unwrap();
        assert!(surface.elements.len() == 1280 && notes[0].contains("lies inside part 2"), "{notes:?}");
        let mut cavity = icosphere(0.5, 2);
        cavity.elements.iter_mut().for_each(|e| e.swap(0, 1));
        let hollow = mend(&soup(&[&cavity, &icosphere(1.0, 2)])).unwrap_err().to_string();
        assert!(hollow.contains("faces the other way"), "{hollow}");
    }

    #[test]
    fn small_holes_are_closed_and_large_ones_listed() {
        let mut all = soup(&[&icosphere(1.0, 5)]);
        all.triangles.truncate(20_477);
        all.triangles.remove(40);
        let (surface, notes) = mend(&all).unwrap();
        assert!(notes.iter().any(|n| n.contains("small holes are closed")), "{notes:?}");
        assert!(surface.is_closed());
        let areas = (0..surface.elements.len() as u32).map(|e| surface.element_area_vector(e));
        let area = areas.fold(Vector::ZERO, |a, b| a + b);
        assert!(area.norm() < 1e-12, "{area:?}");
        let far = |t: &[Vector<3>; 3]| (0..3).all(|d| t.iter().all(|x| x[d].abs() < 0.75));
        let mut open = soup(&[&icosphere(1.0, 3)]);
        open.triangles.retain(|t| !far(t));
        let error = mend(&open).unwrap_err().to_string();
        assert!(error.contains("open edges in 8 holes") && error.matches(" edges, ").count() == 8, "{error}");
    }

    /// A wing without sweep whose section is a wedge, open at the root, along the base of this height, or at both ends.
    fn wedge(base: f64, [root, rear, tip]: [bool; 3]) -> Soup {
        let n = 40;
        let at = |k: usize, corner: usize| {
            let (x, z) = [(1.0, 0.5 * base), (0.0, 0.0), (1.0, -0.5 * base)][corner];
            Vector([x, 4.0 * k as f64 / n as f64, z])
        };
        let mut triangles = Vec::new();
        for k in 0..n {
            for side in (0..3).filter(|side| *side < 2 || !rear) {
                let [a, b] = [side, (side + 1) % 3];
                triangles.extend([[at(k, a), at(k + 1, a), at(k, b)], [at(k + 1, a), at(k + 1, b), at(k, b)]]);
            }
        }
        triangles.extend(
            [root, tip].iter().zip([0, n]).filter(|(open, _)| !**open).map(|(_, k)| [0, 1, 2].map(|c| at(k, c))),
        );
        Soup { tags: vec![0; triangles.len()], names: vec!["wing".into()], triangles }
    }

    #[test]
    fn open_roots_and_trailing_edges_are_closed() {
        for (open, kinds) in [
            ([true, false, false], vec!["flat"]),
            ([false, true, false], vec!["flat"]),
            ([true, true, true], vec!["narrow"]),
            ([true, false, true], vec!["flat", "flat"]),
        ] {
            let (surface, notes) = mend(&wedge(0.01, open)).unwrap();
            assert!(
                surface.is_closed() && (surface.volume() - 0.02).abs() < 1e-12,
                "{open:?} {notes:?} {}",
                surface.volume()
            );
            let told: Vec<&String> = notes.iter().filter(|n| n.contains("opening")).collect();
            assert_eq!(told.len(), kinds.len(), "{notes:?}");
            assert!(told.iter().zip(&kinds).all(|(n, kind)| n.contains(kind)), "{notes:?}");
            assert_eq!(surface.intersection(), None);
        }
        let sheet = wedge(0.0, [true; 3]);
        let one_side = sheet.triangles.iter().step_by(4).chain(sheet.triangles.iter().skip(1).step_by(4));
        let triangles: Vec<_> = one_side.copied().collect();
        let half = Soup { tags: vec![0; triangles.len()], names: vec![], triangles };
        assert!(mend(&half).unwrap_err().to_string().contains("open edges"));
        assert!(mend(&sheet).unwrap_err().to_string().contains("bounds no volume"));
    }

    #[test]
    fn walls_between_parts_go() {
        let half = wedge(0.1, [false; 3]);
        let mirror = |t: &[Vector<3>; 3]| [0, 2, 1].map(|k: usize| Vector([t[k][0], -t[k][1], t[k][2]]));
        let triangles: Vec<_> = half.triangles.iter().copied().chain(half.triangles.iter().map(mirror)).collect();
        let (surface, notes) = mend(&Soup { tags: vec![0; triangles.len()], names: vec![], triangles }).unwrap();
        assert!(surface.is_closed() && (surface.volume() - 0.4).abs() < 1e-12, "{notes:?}");
        assert!(notes.iter().any(|n| n.contains("1 pairs of triangles between parts")), "{notes:?}");
    }

    /// A sphere whose vertices are `size` apart where they should be one.
    fn noisy(size: f64) -> Soup {
        let mut all = soup(&[&icosphere(1.0, 4)]);
        let mut state = 1u64;
        for x in all.triangles.iter_mut().flatten() {
            *x = Vector::from_fn(|d| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                x[d] + size * ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5)
            });
        }
        all
    }

    #[test]
    fn vertices_are_joined_as_far_apart_as_is_asked() {
        let rough = noisy(5e-3);
        assert!(mend(&rough).is_err());
        assert_eq!(mend_within(&rough, Some(0.01)).unwrap().0.vertices.len(), 2562);
        assert!(mend_within(&rough, Some(1e-3)).is_err());
        assert!(mend_within(&rough, Some(10.0)).is_err());
    }

    #[test]
    fn noise_is_welded_and_thin_edges_are_kept() {
        let (surface, notes) = mend(&noisy(2e-5)).unwrap();
        assert!(surface.vertices.len() == 2562 && notes.iter().any(|n| n.contains("joined")), "{notes:?}");
        // a plate of a hundred-thousandth of its length with a crack of the same width keeps its two sides
        let mut plate = soup(&[&cuboid([1.0, 1.0, 1e-5])]);
        plate.triangles[0][0] += Vector([2e-5, 0.0, 0.0]);
        assert!(mend(&plate).is_err());
    }

    #[test]
    fn a_pinhole_is_allowed() {
        let mut shell = icosphere(1.0, 2);
        // A vertex surrounded by a pulled-in ring, its own triangles missing.
        let tip = 0_u32;
        let centre = shell.vertices[0];
        let ring: HashSet<u32> = shell.elements.iter().filter(|e| e.contains(&tip)).flatten().copied().collect();
        for v in ring {
            shell.vertices[v as usize] = centre + (shell.vertices[v as usize] - centre) * 1e-4;
        }
        shell.elements.retain(|e| !e.contains(&tip));
        let (surface, notes) = mend(&soup(&[&shell])).unwrap();
        assert!(notes.iter().any(|n| n.contains("1 small hole is closed")), "{notes:?}");
        assert!(surface.inside(&(centre * 0.9)) && !surface.inside(&(centre * 1.1)));
    }

    #[test]
    fn single_precision_cracks_are_welded() {
        let mut all = soup(&[&icosphere(1.0, 3)]);
        for (k, triangle) in all.triangles.iter_mut().enumerate() {
            triangle[0] = triangle[0] * (1.0 + 1e-7 * (k % 3) as f64);
        }
        let (surface, notes) = mend(&all).unwrap();
        assert!(surface.vertices.len() == 642 && notes.iter().any(|n| n.contains("joined")), "{notes:?}");
    }

    #[test]
    fn needles_are_merged_without_a_crack() {
        let mut all = soup(&[&cuboid([1.0, 1.0, 1.0])]);
        let [a, b, c] = all.triangles[0];
        let middle = (a + b) * 0.5;
        all.triangles[0] = [a, middle, c];
        all.triangles.push([middle, b, c]);
        all.triangles.push([a, b, middle]);
        all.tags.extend([0, 0]);
        let (surface, notes) = mend(&all).unwrap();
        assert!(surface.elements.len() == 14 && (surface.volume() - 1.0).abs() < 1e-12, "{notes:?}");
        assert!(notes.iter().any(|n| n.contains("1 needle")), "{notes:?}");
        assert_eq!(surface.intersection(), None);
    }

    #[test]
    fn parts_that_overlap_are_united_and_those_that_cross_themselves_or_have_fins_refused() {
        let (a, b) = (icosphere(1.0, 3), moved(&icosphere(1.0, 3), [0.5, 0.1, 0.2]));
        let far = moved(&icosphere(1.0, 2), [5.0, 0.0, 0.0]);
        let (surface, notes) = mend(&soup(&[&a, &far, &b])).unwrap();
        assert!(surface.is_closed() && notes.len() == 1 && notes[0].contains("overlap"), "{notes:?}");
        let areas = (0..surface.elements.len() as u32).map(|e| surface.element_area_vector(e));
        assert!(areas.fold(Vector::ZERO, |a, b| a + b).norm() < 1e-12 * surface.area());
        let (alone, apart) = (icosphere_volume(3), 0.3_f64.sqrt());
        // the lens that both share: π (2 − d)² (d² + 4 d)/(12 d) of two unit spheres d apart
        let lens = std::f64::consts::PI * (2.0 - apart).powi(2) * (apart + 4.0) / 12.0;
        let expected = 2.0 * alone - lens + icosphere_volume(2);
        assert!((surface.volume() / expected - 1.0).abs() < 0.01, "{} {expected}", surface.volume());
        assert!(surface.curvature.iter().all(|k| (k - 1.0).abs() < 0.1), "they stay spheres");
        let mut folded = icosphere(1.0, 2);
        folded.vertices[0] = folded.vertices[0] * -2.0;
        assert!(mend(&soup(&[&folded])).unwrap_err().to_string().contains("crosses itself at ("));
        let mut fin = soup(&[&cuboid([1.0, 1.0, 1.0])]);
        let [a, b, _] = fin.triangles[0];
        fin.triangles.push([a, b, Vector([-2.0, -3.0, -4.0])]);
        fin.tags.push(0);
        assert!(mend(&fin).unwrap_err().to_string().contains("3 triangles meet at the edge near"));
    }

    fn text(shell: &Shell<3>, name: &str) -> String {
        let vertex = |v: &Vector<3>| format!("  vertex {} {} {}\n", v[0], v[1], v[2]);
        let facet = |c: &[Vector<3>; 3]| {
            let vertices: String = c.iter().map(vertex).collect();
            format!(" facet normal 0 0 0\n  outer loop\n{vertices}  endloop\n endfacet\n")
        };
        let facets: String = shell.all_corners().iter().map(facet).collect();
        format!("solid {name}\n{facets}endsolid {name}\n")
    }

    #[test]
    fn solids_and_groups_become_tags() {
        let (first, second) = (cuboid([1.0, 1.0, 1.0]), moved(&cuboid([1.0, 2.0, 1.0]), [3.0, 0.0, 0.0]));
        let (surface, _) = load("two.stl", (text(&first, "left wing") + &text(&second, "right")).as_bytes()).unwrap();
        assert!(
            surface.tags == ["left wing", "right"] && surface.elements[0].tag == 0 && surface.elements[23].tag == 1
        );
        assert!((surface.volume() - 3.0).abs() < 1e-12 && surface.sharp.len() == 24);
        let vertices: String = first.vertices.iter().map(|v| format!("v {} {} {}\n", v[0], v[1], v[2])).collect();
        let faces = "g lower\nf 1 3 4 2\ng rest\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
        let (surface, notes) = load("box.obj", (vertices + faces).as_bytes()).unwrap();
        assert!((surface.volume() - 1.0).abs() < 1e-12 && surface.tags == ["lower", "rest"], "{notes:?}");
        assert_eq!(surface.sharp.len(), 12);
    }

    #[test]
    fn broken_files_are_refused_with_their_place() {
        let error = |file: &str, bytes: &[u8]| load(file, bytes).unwrap_err().to_string();
        let whole = stl(1);
        assert!(error("a.stl", &whole[..1000]).contains("announces 80 triangles, 4084 bytes, but holds 1000 bytes"));
        assert!(error("a.stl", b"nothing").contains("no STL file"));
        let box_text = text(&cuboid([1.0, 1.0, 1.0]), "box");
        let cut = box_text[..200].rfind('\n').unwrap();
        assert!(error("a.stl", &box_text.as_bytes()[..cut]).contains("cut short"));
        assert!(error("a.stl", box_text.replace("0.5 0.5", "0.5 oops").as_bytes()).contains("is not a vertex"));
        assert!(error("a.stl", b"solid\nendsolid\n").contains("holds no triangles"));
        assert!(
            error("a.obj", b"v 0 0 0\nv 1 0 0\nv oops\n").contains("a.obj, line 3"),
            "{}",
            error("a.obj", b"v oops")
        );
        assert!(error("a.step", b"").contains("neither"));
        let mut named = whole.clone();
        named[..5].copy_from_slice(b"solid");
        assert!(load("a.stl", &named).is_ok(), "binary files may begin with `solid`");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300), solid in any::<bool>()) {
            let head: &[u8] = if solid { b"solid x\n facet\n" } else { b"" };
            let bytes = [head, &bytes].concat();
            let _ = load("x.stl", &bytes);
            let _ = load("x.obj", &bytes);
            let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                          element face 2\nproperty list uchar int vertex_indices\nend_header\n";
            let _ = load("x.ply", &[header.as_bytes(), &bytes].concat());
        }

        #[test]
        fn no_mutated_binary_panics(changes in proptest::collection::vec((80..4084_usize, any::<u8>()), 1..20), cut in 0..6000_usize) {
            let mut bytes = stl(1);
            changes.iter().for_each(|(at, byte)| bytes[*at] = *byte);
            bytes.truncate(cut);
            let _ = load("x.stl", &bytes);
        }

        #[test]
        fn no_mutated_text_panics(at in 0..2000_usize, byte in any::<u8>(), drop in 0..40_usize) {
            let mut bytes = text(&cuboid([1.0, 1.0, 1.0]), "box").into_bytes();
            let at = at % bytes.len();
            bytes[at] = byte;
            bytes.drain(at..(at + drop).min(bytes.len()));
            let _ = load("x.stl", &bytes);
        }

        #[test]
        fn no_lines_of_obj_panic(lines in proptest::collection::vec("(v|f|g|o|vn|l|p|usemtl|mtllib)( -?[0-9]{1,2}(/[0-9]?)?(/[0-9])?){0,5}", 0..20)) {
            let _ = load("x.obj", lines.join("\n").as_bytes());
        }

        #[test]
        fn no_integer_soup_panics(v in proptest::collection::vec(proptest::array::uniform9(-2..3_i32), 1..12)) {
            let triangle = |c: &[i32; 9]| [0, 3, 6].map(|k| Vector([c[k], c[k + 1], c[k + 2]].map(f64::from)));
            let triangles: Vec<_> = v.iter().map(triangle).collect();
            let _ = mend(&Soup { tags: vec![0; triangles.len()], names: vec![], triangles });
        }
    }
}
