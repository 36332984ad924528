//! Union of intersecting bodies: the walls of the volume that they enclose together.
//!
//! Triangles are clipped by the `manifold-rust` library, a port of Lalish's Manifold, whose result is closed
//! independent of round-off (Smith and Dodgson, *A topologically robust algorithm for Boolean operations on polyhedral
//! shapes using approximate arithmetic*, Computer-Aided Design 39, 2007). Each resulting triangle refers to its
//! original, whose body, tag and normals it keeps: the shape that the triangles approximate does not change.
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{Error, MeshGL64, OpType};

use super::shell::{Exact, Features, Shell, root, unite};
use super::simplex;
use crate::math::Vector;

/// Relative volume or area that counts as zero: triangulations of the same shape may differ by this much.
const NOTHING: f64 = 1e-6;

/// Union of bodies.
pub(super) struct United {
    pub(super) shell: Shell<3>,
    /// For each triangle, the index of its original among the united shells.
    pub(super) owner: Vec<u16>,
}

/// Relative position of two closed shells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meeting {
    /// They have a common volume, which is a part of both.
    Overlapping,
    /// They share walls, or parts of walls, but no volume.
    Joined,
    /// They touch only at points or edges.
    Touching,
    /// The first lies inside the second or coincides with it.
    Within,
    /// The second lies inside the first.
    Around,
}

/// Relative position of `a` and `b`; an error message where it cannot be determined.
pub(super) fn meeting(a: &Shell<3>, b: &Shell<3>) -> Result<Meeting, String> {
    let solids = solids(&[a, b], &[0, a.elements.len()])?;
    let both = solids[0].union(&solids[1]);
    let [va, vb, all] = [&solids[0], &solids[1], &both].map(Manifold::volume);
    let [sa, sb, skin] = [&solids[0], &solids[1], &both].map(Manifold::surface_area);
    let shared = va + vb - all;
    Ok(if shared >= (1.0 - NOTHING) * va {
        Meeting::Within
    } else if shared >= (1.0 - NOTHING) * vb {
        Meeting::Around
    } else if shared > NOTHING * va.min(vb) {
        Meeting::Overlapping
    } else if skin < (1.0 - NOTHING) * (sa + sb) {
        Meeting::Joined
    } else {
        Meeting::Touching
    })
}

/// The shells as solids of the library, with triangles numbered from those in `first`.
fn solids(shells: &[&Shell<3>], first: &[usize]) -> Result<Vec<Manifold>, String> {
    let solid = |k: usize| {
        let solid = Manifold::from_mesh_gl64(&mesh(shells[k], first[k]));
        match solid.status() {
            Error::NoError => Ok(solid),
            problem => Err(format!("part {} is no closed body ({problem:?})", k + 1)),
        }
    };
    (0..shells.len()).map(solid).collect()
}

/// Union of closed shells; an error message where it cannot be computed.
pub(super) fn united(shells: &[&Shell<3>]) -> Result<United, String> {
    let mut first = vec![0];
    for shell in shells {
        first.push(first[first.len() - 1] + shell.elements.len());
    }
    let solids = solids(shells, &first)?;
    let found = Manifold::batch_boolean(&solids, OpType::Add);
    if found.status() != Error::NoError || found.is_empty() {
        return Err(format!("they cannot be united ({:?})", found.status()));
    }
    Ok(traced(&found.get_mesh_gl64(-1), shells, &first))
}

/// A shell as a mesh of the library, with triangles numbered from `from`.
fn mesh(shell: &Shell<3>, from: usize) -> MeshGL64 {
    MeshGL64 {
        num_prop: 3,
        vert_properties: shell.vertices.iter().flat_map(|x| x.0).collect(),
        tri_verts: shell.elements.iter().flatten().map(|v| u64::from(*v)).collect(),
        face_id: (0..shell.elements.len()).map(|e| (from + e) as u64).collect(),
        ..MeshGL64::default()
    }
}

/// The result, in which each triangle has the data of its original.
fn traced(mesh: &MeshGL64, shells: &[&Shell<3>], first: &[usize]) -> United {
    let width = mesh.num_prop as usize;
    let vertices: Vec<Vector<3>> = mesh.vert_properties.chunks(width).map(|c| Vector([c[0], c[1], c[2]])).collect();
    let mut same: Vec<u32> = (0..vertices.len() as u32).collect();
    mesh.merge_from_vert.iter().zip(&mesh.merge_to_vert).for_each(|(a, b)| unite(&mut same, *a as u32, *b as u32));
    let mut all: Vec<(usize, [u32; 3])> = mesh
        .tri_verts
        .chunks(3)
        .zip(&mesh.face_id)
        .map(|(t, face)| (*face as usize, [t[0], t[1], t[2]].map(|v| root(&mut same, v as u32))))
        .collect();
    all.sort_unstable();
    let source = |face: usize| first.partition_point(|f| *f <= face) - 1;
    let features: Vec<Features<3>> = shells.iter().map(|s| s.features()).collect();
    let mut tag_names: Vec<String> = Vec::new();
    let mut tag = |k: usize, e: usize| {
        let own = shells[k].tags.get(e).and_then(|t| shells[k].tag_names.get(usize::from(*t)));
        let name = own.map_or("", String::as_str);
        tag_names.iter().position(|n| n == name).unwrap_or_else(|| {
            tag_names.push(name.to_owned());
            tag_names.len() - 1
        }) as u16
    };
    let (mut owner, mut curvature) = (Vec::new(), Vec::new());
    let (mut tags, mut elements, mut kept) = (Vec::new(), Vec::new(), Vec::new());
    for (face, corners) in all {
        let k = source(face);
        let e = face - first[k];
        let original = shells[k].corners(e);
        let normal = |v: u32| {
            let weights = simplex::closest(&vertices[v as usize], &original);
            simplex::blend(&features[k].normals[e], &weights).unit()
        };
        owner.push(k as u16);
        curvature.push(features[k].curvature[e]);
        tags.push(tag(k, e));
        kept.push(corners.map(normal));
        elements.push(corners);
    }
    let (vertices, elements) = compact(&vertices, elements);
    let crease = shells.iter().fold(f64::INFINITY, |m, s| m.min(s.crease));
    let (normals, curvature) = (Some(kept), Some(curvature));
    let shell = Shell { vertices, elements, normals, curvature, tags, tag_names, exact: Exact::None, crease };
    United { shell, owner }
}

/// Removes vertices that no element uses.
pub(super) fn compact(vertices: &[Vector<3>], mut elements: Vec<[u32; 3]>) -> (Vec<Vector<3>>, Vec<[u32; 3]>) {
    let (mut number, mut kept) = (vec![u32::MAX; vertices.len()], Vec::new());
    for v in elements.iter_mut().flatten() {
        let slot = &mut number[*v as usize];
        if *slot == u32::MAX {
            *slot = kept.len() as u32;
            kept.push(vertices[*v as usize]);
        }
        *v = *slot;
    }
    (kept, elements)
}

#[cfg(test)]
mod tests {
    use super::super::primitive::{cuboid, icosphere};
    use super::super::surface::Surface;
    use super::*;

    fn moved(shell: &Shell<3>, by: [f64; 3]) -> Shell<3> {
        Shell {
            vertices: shell.vertices.iter().map(|x| *x + Vector(by)).collect(),
            exact: Exact::None,
            ..shell.clone()
        }
    }

    #[test]
    fn two_boxes_enclose_what_the_books_say() {
        let (a, b) = (cuboid([2.0, 1.0, 1.0]), moved(&cuboid([1.0, 1.0, 3.0]), [0.25, 0.25, 0.0]));
        let found = united(&[&a, &b]).unwrap();
        let surface = Surface::new(&[("both".into(), found.shell.clone())]);
        assert!(surface.is_closed() && (surface.volume() - (2.0 + 3.0 - 0.75)).abs() < 1e-12, "{}", surface.volume());
        let all = 0..surface.elements.len() as u32;
        let sum = all.map(|e| surface.element_area_vector(e)).fold(Vector::ZERO, |a, b| a + b);
        assert!(sum.norm() < 1e-12, "{sum:?}");
        assert!(found.owner.contains(&0) && found.owner.contains(&1));
    }

    #[test]
    fn bodies_that_add_nothing_or_only_touch_are_told() {
        let ball = icosphere(1.0, 3);
        let small = Shell { vertices: ball.vertices.iter().map(|x| *x * 0.5).collect(), ..ball.clone() };
        let tip = ball.vertices.iter().fold(0.0, |m: f64, x| m.max(x[0]));
        let cube = cuboid([1.0; 3]);
        for (other, expected) in [
            (ball.clone(), Meeting::Within),
            (small.clone(), Meeting::Around),
            (moved(&ball, [1.0, 0.0, 0.0]), Meeting::Overlapping),
            (moved(&ball, [2.0 * tip, 0.0, 0.0]), Meeting::Touching),
        ] {
            assert_eq!(meeting(&ball, &other), Ok(expected));
        }
        assert_eq!(meeting(&small, &ball), Ok(Meeting::Within));
        assert_eq!(meeting(&cube, &moved(&cube, [1.0, 0.0, 0.0])), Ok(Meeting::Joined));
    }

    #[test]
    fn spheres_keep_their_normals_and_meet_at_an_edge() {
        let ball = icosphere(1.0, 4);
        let other = moved(&ball, [1.0, 0.0, 0.0]);
        let found = united(&[&ball, &other]).unwrap();
        for (e, normals) in found.shell.normals.as_ref().unwrap().iter().enumerate() {
            let centre = Vector([if found.owner[e] == 0 { 0.0 } else { 1.0 }, 0.0, 0.0]);
            for (v, n) in found.shell.elements[e].iter().zip(normals) {
                let radial = (found.shell.vertices[*v as usize] - centre).unit();
                assert!((radial - *n).norm() < 2e-3, "{radial:?} {n:?}");
            }
        }
        let surface = Surface::new(&[("both".into(), found.shell)]);
        // two caps of height 1/2 are missing: 2 · 4π/3 − 2 · π h² (3 − h)/3
        let exact = std::f64::consts::PI * (8.0 / 3.0 - 2.0 * 0.25 * 2.5 / 3.0);
        assert!(surface.is_closed() && (surface.volume() / exact - 1.0).abs() < 5e-3, "{}", surface.volume());
        assert!(surface.sharp.iter().all(|e| e.turn < 0.0 && (e.ends[0][0] - 0.5).abs() < 0.01), "a concave edge");
    }
}
