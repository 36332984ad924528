//! Cells between particles, for tools that contour, cut and integrate.
//!
//! In the plane the particles, those on walls and on the border included, are the corners of a constrained Delaunay
//! triangulation. Outlines of bodies are sides of it, so that no triangle reaches through a wall, and triangles inside bodies are
//! left out. Planes of symmetry are reached too (`rim`). In space they are the corners of a Delaunay tetrahedralisation without the tetrahedra that lie in bodies or reach
//! through their walls; beyond a million particles they stay vertices, for the tetrahedra would take more memory than the solver.
use super::held::Held;
use super::rim::Rim;
use crate::cloud::Cloud;
use crate::math::Vector;
use crate::math::tetrahedra::{MOST, tetrahedralise_within};
use crate::math::triangulation::triangulate_within;
use crate::observe::vtk::{Cells, Facets};

/// Two panels meet when their ends are nearer to one another than this part of their mean length.
const MEETING: f64 = 0.5;

/// What ties particles together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mesh {
    /// Chains of wall particles, counted from the first of them; a closed one ends where it began.
    pub(crate) outlines: Vec<Vec<u32>>,
    /// Walls in space: triangles of wall particles, counted from the first of them, counterclockwise as seen from the gas.
    pub(crate) walls: Vec<[u32; 3]>,
    /// Triangles of particles, counterclockwise.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Tetrahedra of particles, of positive volume.
    pub(crate) tetrahedra: Vec<[u32; 4]>,
}

impl Mesh {
    /// The cells between those particles of a cloud that are held and the points on planes of symmetry, in their numbers.
    pub(crate) fn of<const D: usize>(cloud: &Cloud<D>, held: &Held, rim: &Rim) -> Self {
        match D {
            2 => Self::of_plane(cloud, held, rim),
            3 if held.len() <= MOST => Self::of_space(cloud, held, rim),
            _ => Self::default(),
        }
    }

    fn of_space<const D: usize>(cloud: &Cloud<D>, held: &Held, rim: &Rim) -> Self {
        let points: Vec<Vector<3>> =
            rim.with_places(held.numbers().map(|i| cloud.x[i].to_3d()).collect()).into_iter().map(Vector).collect();
        let normals: Vec<Vector<3>> = cloud.interface.iter().map(|w| Vector(w.normal.to_3d())).collect();
        let stretch = held.stretch(D);
        let spacing = held.numbers().map(|i| cloud.spacing[i] * stretch).collect::<Vec<f64>>();
        let spacing = rim.with_values("spacing", 1, spacing.into());
        let (first, n) = (held.n_fluid(), held.len());
        let wall = |row: usize| row.checked_sub(first).filter(|w| *w < normals.len());
        let normal = |i: u32| wall(rim.particle(i as usize, n)).map(|w| normals[w]);
        let tetrahedra = tetrahedralise_within(&points, &spacing, normal);
        Self { walls: walls(&tetrahedra, |i| wall(i as usize).map(|w| w as u32)), tetrahedra, ..Self::default() }
    }

    fn of_plane<const D: usize>(cloud: &Cloud<D>, held: &Held, rim: &Rim) -> Self {
        let flat = |x: &Vector<D>| Vector([x[0], x[1]]);
        let places = held.numbers().map(|i| flat(&cloud.x[i]).0).collect();
        let points: Vec<Vector<2>> = rim.with_places(places).into_iter().map(Vector).collect();
        let (first, n) = (held.n_fluid(), held.len());
        let walls = Walls {
            places: &points[first..first + cloud.interface.len()],
            normals: cloud.interface.iter().map(|w| flat(&w.normal)).collect(),
            lengths: cloud.interface.iter().map(|w| w.area.norm()).collect(),
            pieces: cloud.interface.iter().map(|w| w.piece).collect(),
        };
        let outlines = walls.outlines();
        let edge = |pair: &[u32]| [pair[0], pair[1]].map(|w| w + first as u32);
        let wall = |i: u32| rim.particle(i as usize, n).checked_sub(first).filter(|w| *w < cloud.interface.len());
        // an outline goes on to where it meets the plane
        let feet = (n..points.len())
            .map(|row| [rim.particle(row, n) as u32, row as u32])
            .filter(|foot| wall(foot[1]).is_some());
        let edges: Vec<[u32; 2]> = outlines.iter().flat_map(|line| line.windows(2).map(edge)).chain(feet).collect();
        let triangles = triangulate_within(&points, &edges, |i| wall(i).map(|w| walls.normals[w]));
        Self { outlines, triangles, ..Self::default() }
    }

    /// What a file of the walls holds: outlines in the plane, triangles in space, else each particle by itself.
    pub(crate) fn facets(&self) -> Facets<'_> {
        match self {
            Self { outlines, .. } if !outlines.is_empty() => Facets::Polylines(outlines),
            Self { walls, .. } if !walls.is_empty() => Facets::Triangles(walls),
            _ => Facets::Vertices,
        }
    }

    /// What a field file holds: tetrahedra or triangles where there are any, else each particle by itself.
    pub(crate) fn cells(&self) -> Cells<'_> {
        match self {
            Self { tetrahedra, .. } if !tetrahedra.is_empty() => Cells::Tetrahedra(tetrahedra),
            Self { triangles, .. } if !triangles.is_empty() => Cells::Triangles(triangles),
            _ => Cells::Vertices,
        }
    }
}

/// Faces between three wall particles that one tetrahedron has alone, in the numbers that `wall` gives these.
fn walls(tetrahedra: &[[u32; 4]], wall: impl Fn(u32) -> Option<u32>) -> Vec<[u32; 3]> {
    let faces = |t: &[u32; 4]| [[t[0], t[1], t[2]], [t[0], t[3], t[1]], [t[1], t[3], t[2]], [t[2], t[3], t[0]]];
    let on_wall = |[a, b, c]: [u32; 3]| Some([wall(a)?, wall(b)?, wall(c)?]);
    let mut all: Vec<[u32; 3]> = tetrahedra.iter().flat_map(faces).filter_map(on_wall).collect();
    let sorted = |face: &[u32; 3]| {
        let mut face = *face;
        face.sort_unstable();
        face
    };
    all.sort_unstable_by_key(sorted);
    all.chunk_by(|a, b| sorted(a) == sorted(b)).filter(|same| same.len() == 1).map(|same| same[0]).collect()
}

/// The wall particles of a plane cloud, each in the middle of a panel.
struct Walls<'a> {
    places: &'a [Vector<2>],
    /// Into the gas.
    normals: Vec<Vector<2>>,
    lengths: Vec<f64>,
    /// Smooth piece of outline that each belongs to; the particles of one follow one another.
    pieces: Vec<u32>,
}

impl Walls<'_> {
    /// Pieces of outline, joined where the end of one is the beginning of another or its own.
    fn outlines(&self) -> Vec<Vec<u32>> {
        let mut pieces: Vec<Vec<u32>> = Vec::new();
        for (w, piece) in self.pieces.iter().enumerate() {
            match pieces.last_mut().filter(|_| w > 0 && self.pieces[w - 1] == *piece) {
                Some(line) => line.push(w as u32),
                None => pieces.push(vec![w as u32]),
            }
        }
        let next: Vec<Option<usize>> = pieces.iter().map(|piece| self.follower(piece, &pieces)).collect();
        let led: Vec<bool> = (0..pieces.len()).map(|k| next.contains(&Some(k))).collect();
        let mut used = vec![false; pieces.len()];
        let mut outlines = Vec::new();
        // open chains begin with a piece that follows none, what is left closes on itself
        for start in (0..pieces.len()).filter(|k| !led[*k]).chain(0..pieces.len()) {
            let (mut line, mut at) = (Vec::new(), Some(start).filter(|k| !used[*k]));
            while let Some(k) = at.filter(|k| !used[*k]) {
                used[k] = true;
                line.extend(&pieces[k]);
                at = next[k];
            }
            if at == Some(start) {
                line.push(pieces[start][0]);
            }
            outlines.extend(Some(line).filter(|line| line.len() > 1));
        }
        outlines
    }

    /// The piece that begins where `piece` ends.
    fn follower(&self, piece: &[u32], pieces: &[Vec<u32>]) -> Option<usize> {
        let last = *piece.last()? as usize;
        let gap = |other: &Vec<u32>| (self.end(last, piece) - self.begin(other[0] as usize, other)).norm();
        let nearest = (0..pieces.len()).min_by(|a, b| gap(&pieces[*a]).total_cmp(&gap(&pieces[*b])))?;
        let mean = f64::midpoint(self.lengths[last], self.lengths[pieces[nearest][0] as usize]);
        (gap(&pieces[nearest]) < MEETING * mean).then_some(nearest)
    }

    /// Where the panel of `w`, the last of `piece`, ends.
    fn end(&self, w: usize, piece: &[u32]) -> Vector<2> {
        self.places[w] + self.along(w, piece) * (0.5 * self.lengths[w])
    }

    /// Where the panel of `w`, the first of `piece`, begins.
    fn begin(&self, w: usize, piece: &[u32]) -> Vector<2> {
        self.places[w] - self.along(w, piece) * (0.5 * self.lengths[w])
    }

    /// Tangent of the panel of `w` in the order of its piece.
    fn along(&self, w: usize, piece: &[u32]) -> Vector<2> {
        let n = self.normals[w];
        let tangent = Vector([n[1], -n[0]]);
        let [first, second] = [0, 1].map(|k| self.places[piece[k.min(piece.len() - 1)] as usize]);
        let [before, last] = [2, 1].map(|k| self.places[piece[piece.len().saturating_sub(k)] as usize]);
        let forward = if piece.last() == Some(&(w as u32)) { last - before } else { second - first };
        if forward.dot(&tangent) < 0.0 { tangent * -1.0 } else { tangent }
    }
}
