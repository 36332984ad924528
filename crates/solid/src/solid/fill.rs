//! Filling bodies with particles.
//!
//! Boxes, and quadrilaterals in 2-D, are filled with regular rows that include the surfaces. Any other shape first
//! receives particles on its surface, one spacing apart, and then a lattice inside: a square lattice in 2-D and a
//! body-centred cubic one in 3-D, whose simplices are never flat. Near the surface, the lattice is relaxed by
//! repulsion; particles on the surface and deep inside stay. Most particles therefore have the neighbours of a lattice.
use super::particles::{Facet, Fill};
use super::weigh::{weigh_in_plane, weigh_in_space};
use crate::cloud::grid::Grid;
use crate::geometry::Surface;
use crate::math::Vector;
use crate::math::parallel::sweep_each;

/// Minimum initial distance, in spacings, of inner particles from the surface.
const CLEAR: f64 = 0.6;
/// Distance from the surface, in spacings, beyond which particles stay on the lattice.
const DEEP: f64 = std::f64::consts::SQRT_2 + 0.6;
/// Number of sweeps of the relaxation.
const SWEEPS: usize = 40;
/// Step length of a sweep, in spacings.
const STEP: f64 = 0.2;
/// Range of the repulsion, in spacings.
const REPULSION: f64 = 1.5;

/// Regular rows of particles in a box or, in 2-D, a quadrilateral.
#[derive(Clone, Debug)]
pub struct Lattice<const D: usize> {
    /// Corners of the shape; the first axis varies fastest.
    pub corners: Vec<Vector<D>>,
    /// Number of particles along each axis, both ends included.
    pub counts: [usize; D],
    /// Amplitude of the random displacement of inner particles, in spacings.
    pub jitter: f64,
}

impl<const D: usize> Lattice<D> {
    /// Rows with a distance of about `spacing`, at least two along each axis.
    pub fn with_spacing(corners: Vec<Vector<D>>, spacing: f64) -> Self {
        let counts = std::array::from_fn(|d| ((across(&corners, d) / spacing).round() as usize).max(1) + 1);
        Self { corners, counts, jitter: 0.0 }
    }

    /// Positions, volumes and surface of the particles.
    pub fn fill(&self) -> Fill<D> {
        let n: usize = self.counts.iter().product();
        let place = |k: usize| -> [usize; D] {
            let mut k = k;
            self.counts.map(|c| {
                let i = k % c;
                k /= c;
                i
            })
        };
        let at = |place: [f64; D]| self.at(place);
        let moment = vec![Vector::ZERO; if D == 2 { n } else { 0 }];
        let mut fill = Fill { x: Vec::with_capacity(n), volume: vec![0.0; n], moment, ..Fill::default() };
        let mut seed = Noise(1);
        let spacing = self.spacing();
        for k in 0..n {
            let i = place(k);
            fill.rows.push(self.ring(&i));
            let inner = (0..D).all(|d| 0 < i[d] && i[d] + 1 < self.counts[d]);
            let shift = Vector::from_fn(|_| 2.0 * self.jitter * spacing * seed.next());
            let x = at(std::array::from_fn(|d| i[d] as f64 / (self.counts[d] - 1) as f64));
            fill.x.push(if inner { x + shift } else { x });
        }
        self.weigh(&mut fill);
        fill.spacing = spacing;
        if self.jitter > 0.0 {
            let weighed = weighed((&fill.x, n), &[], spacing, &|_| true);
            (fill.volume, fill.moment) = (weighed.volume, weighed.moment);
        }
        surface_first(&fill)
    }

    /// Neighbours of the particle at an index position: all adjacent ones, diagonals included.
    fn ring(&self, place: &[usize; D]) -> Vec<u32> {
        let mut ring = Vec::new();
        for step in 0..3usize.pow(D as u32) {
            let mut rest = step;
            let near: [Option<usize>; D] = std::array::from_fn(|d| {
                let i = (place[d] + rest % 3).checked_sub(1).filter(|i| *i < self.counts[d]);
                rest /= 3;
                i
            });
            let number = (0..D).rev().try_fold(0, |n, d| Some(n * self.counts[d] + near[d]?));
            ring.extend(number.filter(|_| near.iter().zip(place).any(|(a, b)| *a != Some(*b))).map(|n| n as u32));
        }
        ring
    }

    /// Greatest distance between adjacent particles along the rows.
    fn spacing(&self) -> f64 {
        (0..D).map(|d| across(&self.corners, d) / (self.counts[d] - 1) as f64).fold(0.0, f64::max)
    }

    /// The point at these fractions of the length along each axis.
    fn at(&self, part: [f64; D]) -> Vector<D> {
        let weight =
            |k: usize| -> f64 { (0..D).map(|d| if k >> d & 1 == 1 { part[d] } else { 1.0 - part[d] }).product() };
        (0..1usize << D).fold(Vector::ZERO, |x, k| x + self.corners[k] * weight(k))
    }

    /// Computes volumes and facets: each cell between the rows assigns shares of its volume to its corners.
    fn weigh(&self, fill: &mut Fill<D>) {
        let cells: [usize; D] = self.counts.map(|c| c - 1);
        for cell in 0..cells.iter().product::<usize>() {
            let mut rest = cell;
            let low: [usize; D] = cells.map(|c| {
                let i = rest % c;
                rest /= c;
                i
            });
            let part = |k: usize, d: usize| (low[d] + (k >> d & 1)) as f64 / cells[d] as f64;
            let corner = |k: usize| self.at(std::array::from_fn(|d| part(k, d)));
            let corners: Vec<Vector<D>> = (0..1usize << D).map(corner).collect();
            let number = |k: usize| (0..D).rev().fold(0, |n, d| n * self.counts[d] + low[d] + (k >> d & 1));
            let volumes = shares_of_cell(&corners);
            (0..1usize << D).for_each(|k| fill.volume[number(k)] += volumes[k]);
            if D == 2 {
                let left = moment_left(&corners, &volumes);
                (0..4).for_each(|k| fill.moment[number(k)] += left);
            }
            for (d, end) in (0..D).flat_map(|d| [(d, 0), (d, 1)]) {
                if low[d] + end == if end == 0 { 0 } else { cells[d] } {
                    let side = side_of_cell::<D>(d, end);
                    let between: Vec<u32> = side.iter().map(|k| number(*k) as u32).collect();
                    let at: Vec<Vector<D>> = side.iter().map(|k| corners[*k]).collect();
                    fill.facets.push(Facet::new(&between, area_of_side(&at)));
                }
            }
        }
    }
}

/// Greatest length of the rows of a box along axis `d`, projected on their mean direction, so that slanted sides do not
/// count in full.
fn across<const D: usize>(corners: &[Vector<D>], d: usize) -> f64 {
    let edges = || (0..1usize << D).filter(|k| k >> d & 1 == 0).map(|k| corners[k | 1 << d] - corners[k]);
    let along = edges().fold(Vector::ZERO, |sum, e| sum + e).unit();
    edges().map(|e| e.dot(&along)).fold(0.0, f64::max)
}

/// Indices of the corners of a face of a cell, in order when viewed from outside.
fn side_of_cell<const D: usize>(d: usize, end: usize) -> Vec<usize> {
    let all: Vec<usize> = match D {
        2 => match d {
            0 => vec![end, end + 2],
            _ => vec![2 * end + 1, 2 * end],
        },
        _ => {
            let [a, b] = [(d + 1) % 3, (d + 2) % 3].map(|d| 1usize << d);
            [0, a, a + b, b].map(|k| k + (end << d)).to_vec()
        }
    };
    if end == 1 { all } else { all.into_iter().rev().collect() }
}

/// Area vector of a face with corners in order when viewed from outside.
fn area_of_side<const D: usize>(at: &[Vector<D>]) -> Vector<D> {
    if D == 2 {
        let along = at[1] - at[0];
        return Vector::from_fn(|d| if d == 0 { along[1] } else { -along[0] });
    }
    cross(&(at[2] - at[0]), &(at[3] - at[1])) * 0.5
}

fn cross<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> Vector<D> {
    Vector::from_fn(|d| a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3])
}

/// First moment of a quadrilateral that its shares miss, divided by four: one part for each corner.
fn moment_left<const D: usize>(corners: &[Vector<D>], shares: &[f64]) -> Vector<D> {
    let turn = |a: Vector<D>, b: Vector<D>| a[0] * b[1] - a[1] * b[0];
    let of = |[a, b, c]: [usize; 3]| {
        let [a, b, c] = [corners[a], corners[b], corners[c]];
        (a + b + c) * (0.5 * turn(b - a, c - a).abs() / 3.0)
    };
    let whole = of([0, 1, 2]) + of([3, 2, 1]);
    corners.iter().zip(shares).fold(whole, |left, (x, share)| left - *x * *share) * 0.25
}

/// Fractions of the volume of a cell that belong to its corners; a quadrilateral in 2-D, a box in 3-D.
fn shares_of_cell<const D: usize>(corners: &[Vector<D>]) -> Vec<f64> {
    if D != 2 {
        let sides: Vec<Vector<D>> = (0..D).map(|d| corners[1 << d] - corners[0]).collect();
        return vec![cross(&sides[0], &sides[1]).dot(&sides[2]).abs() / 8.0; 8];
    }
    let turn = |a: Vector<D>, b: Vector<D>| a[0] * b[1] - a[1] * b[0];
    let ring = [0, 1, 3, 2];
    let middle = corners.iter().fold(Vector::ZERO, |m, c| m + *c * 0.25);
    let mut volumes = vec![0.0; 4];
    for k in 0..4 {
        let [before, here, after] = [ring[(k + 3) % 4], ring[k], ring[(k + 1) % 4]].map(|c| corners[c]);
        let (first, second) = ((before + here) * 0.5, (here + after) * 0.5);
        volumes[ring[k]] = 0.5 * (turn(here - first, second - first) + turn(first - middle, second - middle)).abs();
    }
    volumes
}

/// Fills any shape with particles: inside closed outlines in 2-D, inside closed surfaces in 3-D.
pub fn relaxed<const D: usize>(surface: &Surface<D>, spacing: f64) -> Fill<D> {
    let (skin, outline) =
        if D == 2 { along_outline(surface, spacing) } else { (on_surface(surface, spacing), Vec::new()) };
    let inner = inside(surface, spacing);
    let n = skin.len();
    let mut x = skin;
    x.extend(inner);
    relax(&mut x, n, surface, spacing);
    kept(weighed((&x, n), &outline, spacing, &|p| surface.inside(p)))
}

/// Volumes and surface of particles from the simplices between them whose centre is `inside`.
fn weighed<const D: usize>(
    (x, skin): (&[Vector<D>], usize),
    outline: &[[u32; 2]],
    spacing: f64,
    inside: &dyn Fn(&Vector<D>) -> bool,
) -> Fill<D> {
    let inside = |p: &[f64]| inside(&Vector::from_fn(|d| p[d]));
    match D {
        2 => {
            let flat = x.iter().map(|x| Vector([x[0], x[1]])).collect();
            raised(weigh_in_plane(flat, outline, spacing, |p| inside(&p.0)))
        }
        _ => {
            let full = x.iter().map(|x| Vector(x.to_3d())).collect();
            raised(weigh_in_space(full, skin, spacing, |p| inside(&p.0)))
        }
    }
}

/// Converts a fill of dimension `E` to the equal dimension `D` of the caller.
fn raised<const E: usize, const D: usize>(fill: Fill<E>) -> Fill<D> {
    let raised = |v: &Vector<E>| Vector::from_fn(|d| v[d]);
    let facets = fill.facets.iter().map(|f| Facet::new(f.corners(), raised(&f.area))).collect();
    Fill {
        x: fill.x.iter().map(raised).collect(),
        volume: fill.volume,
        facets,
        spacing: fill.spacing,
        rows: fill.rows,
        ties: fill.ties,
        moment: fill.moment.iter().map(raised).collect(),
        turn: fill.turn,
    }
}

/// The fill without particles of zero volume.
fn kept<const D: usize>(fill: Fill<D>) -> Fill<D> {
    let order: Vec<usize> = (0..fill.x.len()).filter(|i| fill.volume[*i] > 0.0).collect();
    fill.taken(&order)
}

/// The fill with the surface particles first.
fn surface_first<const D: usize>(fill: &Fill<D>) -> Fill<D> {
    let mut on = vec![false; fill.x.len()];
    fill.facets.iter().flat_map(|f| f.corners()).for_each(|i| on[*i as usize] = true);
    let (skin, inner): (Vec<usize>, Vec<usize>) = (0..fill.x.len()).partition(|i| on[*i]);
    fill.taken(&[skin, inner].concat())
}

/// Particles along the outlines, corners included, and the sides between them.
fn along_outline<const D: usize>(surface: &Surface<D>, spacing: f64) -> (Vec<Vector<D>>, Vec<[u32; 2]>) {
    let (mut x, mut sides): (Vec<Vector<D>>, Vec<[u32; 2]>) = (Vec::new(), Vec::new());
    let mut grid = Grid::new(spacing);
    let mut number = |p: Vector<D>, x: &mut Vec<Vector<D>>| {
        let mut same = None;
        grid.near(&p, 1e-9 * spacing, |k| {
            if (x[k as usize] - p).norm() < 1e-9 * spacing {
                same = Some(k);
            }
        });
        same.unwrap_or_else(|| {
            grid.insert(&p, x.len() as u32);
            x.push(p);
            x.len() as u32 - 1
        })
    };
    for chain in surface.chains() {
        let ends = |e: u32| surface.corners(e);
        let lengths: Vec<f64> = chain.elements.iter().map(|e| (ends(*e)[1] - ends(*e)[0]).norm()).collect();
        let whole: f64 = lengths.iter().sum();
        let count = ((whole / spacing).round() as usize).max(if chain.closed { 4 } else { 1 });
        let (mut numbers, mut before, mut k) = (Vec::new(), 0.0, 0);
        for step in 0..=count {
            let at = whole * step as f64 / count as f64;
            while k + 1 < lengths.len() && before + lengths[k] < at {
                before += lengths[k];
                k += 1;
            }
            let [a, b] = [0, 1].map(|c| ends(chain.elements[k])[c]);
            let p = a + (b - a) * ((at - before) / lengths[k]).clamp(0.0, 1.0);
            numbers.push(number(p, &mut x));
        }
        sides.extend(numbers.windows(2).map(|w| [w[0], w[1]]));
    }
    (x, sides)
}

/// Particles on a surface in 3-D: first along sharp edges, then evenly spread over the rest.
fn on_surface<const D: usize>(surface: &Surface<D>, spacing: f64) -> Vec<Vector<D>> {
    let mut x: Vec<Vector<D>> = Vec::new();
    let mut grid = Grid::new(spacing);
    let mut add = |p: &Vector<D>, apart: f64, x: &mut Vec<Vector<D>>| {
        let mut free = true;
        grid.near(p, apart, |k| free &= (x[k as usize] - *p).norm() >= apart);
        if free {
            grid.insert(p, x.len() as u32);
            x.push(*p);
        }
    };
    for corner in corners(surface) {
        add(&corner, 1e-6 * spacing, &mut x);
    }
    surface.for_each_sharp_point(0.6, 0.1 * spacing, |p| add(p, 0.9 * spacing, &mut x));
    let fixed = x.len();
    let candidates = surface.pieces(|_| 0.2 * spacing, |p, _, _, _| Some(*p));
    candidates.iter().for_each(|p| add(p, 0.85 * spacing, &mut x));
    spread(&mut x, fixed, surface, spacing);
    x
}

/// Points at which three or more sharp edges meet.
fn corners<const D: usize>(surface: &Surface<D>) -> Vec<Vector<D>> {
    let ends: Vec<Vector<D>> = surface.sharp.iter().filter(|e| e.turn.abs() > 0.6).flat_map(|e| e.ends).collect();
    let size = surface.bounds().extent().max_abs() * 1e-9;
    let mut grid = Grid::new(surface.bounds().extent().max_abs() / 64.0);
    ends.iter().enumerate().for_each(|(k, x)| grid.insert(x, k as u32));
    let meet = |x: &Vector<D>| {
        let mut first = None;
        let mut count = 0;
        grid.near(x, size, |k| {
            if (ends[k as usize] - *x).norm() <= size {
                count += 1;
                first = Some(first.map_or(k, |f: u32| f.min(k)));
            }
        });
        (count, first)
    };
    let is_corner = |(k, x): (usize, &Vector<D>)| match meet(x) {
        (count, Some(first)) if count > 2 && first == k as u32 => Some(*x),
        _ => None,
    };
    ends.iter().enumerate().filter_map(is_corner).collect()
}

/// Spreads the particles of a surface evenly, except the first `fixed` ones.
fn spread<const D: usize>(x: &mut [Vector<D>], fixed: usize, surface: &Surface<D>, spacing: f64) {
    for _ in 0..SWEEPS {
        let mut next = x.to_vec();
        let push = repulsion(x, spacing);
        sweep_each(&mut next, |i| {
            if i < fixed {
                return x[i];
            }
            let moved = x[i] + push(i) * (STEP * spacing);
            surface.nearest(&moved, spacing).map_or(x[i], |near| surface.project(&near).point)
        });
        drop(push);
        x.copy_from_slice(&next);
    }
}

/// Repulsive displacement of a particle by its neighbours.
fn repulsion<'a, const D: usize>(x: &'a [Vector<D>], spacing: f64) -> impl Fn(usize) -> Vector<D> + Sync + 'a {
    let reach = REPULSION * spacing;
    let mut grid = Grid::new(reach);
    x.iter().enumerate().for_each(|(k, x)| grid.insert(x, k as u32));
    move |i| {
        let mut near = Vec::new();
        grid.near(&x[i], reach, |j| near.push(j));
        near.sort_unstable();
        near.iter().fold(Vector::ZERO, |sum, j| {
            let d = x[i] - x[*j as usize];
            let r = d.norm();
            if r <= 0.0 || r >= reach {
                return sum;
            }
            let q = 1.0 - r / reach;
            sum + d * (q * q / r)
        })
    }
}

/// Lattice points inside the body.
fn inside<const D: usize>(surface: &Surface<D>, spacing: f64) -> Vec<Vector<D>> {
    let bounds = surface.bounds();
    let extent = bounds.extent();
    // 2-D: squares; 3-D: cubes with an additional particle at the centre of each
    let (step, halves) = if D == 2 { (spacing, 1) } else { (2.0 / 3f64.sqrt() * spacing, 2) };
    let steps = [step; D];
    let counts = std::array::from_fn::<_, D, _>(|d| (extent[d] / steps[d]).ceil() as usize + 1);
    let n: usize = counts.iter().product();
    let mut rows = vec![Vec::new(); n];
    let centre = bounds.centre();
    sweep_each(&mut rows, |k| {
        let mut rest = k;
        let cell: [f64; D] = std::array::from_fn(|d| {
            let i = rest % counts[d];
            rest /= counts[d];
            i as f64 - 0.5 * (counts[d] - 1) as f64
        });
        let points = [0.0, 0.5].map(|half| Vector::from_fn(|d| centre[d] + (cell[d] + half) * steps[d]));
        let free = |p: &Vector<D>| surface.inside(p) && surface.nearest(p, CLEAR * spacing).is_none();
        points.into_iter().take(halves).filter(free).collect()
    });
    rows.concat()
}

/// Relaxes the positions of all particles except the first `fixed` ones.
fn relax<const D: usize>(x: &mut [Vector<D>], fixed: usize, surface: &Surface<D>, spacing: f64) {
    let near = |x: &Vector<D>| surface.nearest(x, DEEP * spacing).is_some();
    let moves: Vec<bool> = x.iter().enumerate().map(|(i, x)| i >= fixed && near(x)).collect();
    for sweep in 0..SWEEPS {
        let mut next = x.to_vec();
        let push = repulsion(x, spacing);
        let step = STEP * spacing * (1.0 - 0.7 * sweep as f64 / SWEEPS as f64);
        sweep_each(&mut next, |i| {
            if !moves[i] {
                return x[i];
            }
            let moved = x[i] + push(i) * step;
            // no particle leaves the body or comes near the surface
            if surface.inside(&moved) && surface.nearest(&moved, 0.4 * spacing).is_none() { moved } else { x[i] }
        });
        drop(push);
        x.copy_from_slice(&next);
    }
}

/// Pseudo-random numbers from −1/2 to 1/2 (xorshift: Marsaglia 2003, doi:10.18637/jss.v008.i14).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut s = self.0;
        s = (s ^ s >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        s = (s ^ s >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        s ^= s >> 31;
        (s >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }
}
