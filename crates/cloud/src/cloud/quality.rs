//! Quality check of a cloud: can a flow be computed on it?
//!
//! The gradient of every fluid and interface particle rests on the offsets d to its neighbours. The measures are the
//! number of neighbours, the condition number of M = Σ d dᵀ/|d|², the one-sidedness |Σ d/|d|²| / Σ 1/|d|, the number of
//! sectors of space (quadrants or octants; half as many in front of walls) without a neighbour, and the distance to the
//! nearest neighbour. For the surface, the measures are the angle between neighbouring normals, the closure of the area
//! vectors (Σ S = 0 for a closed body), and gaps between facing walls with so few spacings that no flow can develop in
//! them. The check changes nothing; the module `repair` changes neighbour lists while a cloud is built.
use serde::Serialize;

use super::Cloud;
use super::grid::Grid;
use super::layer_termination::{self, place};
use super::repair::Sums;
use crate::math::Vector;
use crate::math::parallel::{CHUNK, sweep_each};

/// Number of places listed for each measure.
const WORST: usize = 5;
/// Gaps with fewer spacings between facing walls are reported.
const THIN_GAP: f64 = 4.0;
/// Walls face each other when the cosine between their normals is below this value.
const FACING: f64 = -0.5;
/// Distance beyond the border of a sector, as a fraction of the distance to the neighbour, up to which the neighbour
/// counts for it.
const BORDER: f64 = 0.05;
/// Relative closure defect of the area vectors above which a body is reported as open; the sampling is exact up to
/// round-off.
const OPEN: f64 = 1e-6;
/// Distance from walls, in spacings, from which fluid particles must be surrounded by neighbours on all sides.
const AWAY: f64 = 3.0;

/// Result of the quality check.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// Number of particles without the ghosts.
    pub particles: usize,
    /// Number of interface particles.
    pub interface: usize,
    /// Number of neighbours of the fluid and interface particles.
    pub neighbours: Spread,
    /// Distribution of each measure.
    pub histograms: Vec<Histogram>,
    /// The worst particles for each measure.
    pub worst: Vec<Finding>,
    /// Messages about repairs made when the cloud was built.
    pub repairs: Vec<String>,
    /// Other warnings, for example about thin gaps and open bodies.
    pub notes: Vec<String>,
}

/// Minimum, mean and maximum of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Minimum.
    pub min: f64,
    /// Mean.
    pub mean: f64,
    /// Maximum.
    pub max: f64,
}

/// Histogram of a measure. Values outside the range count in the first or the last bin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Histogram {
    /// Name of the measure.
    pub name: String,
    /// Unit of the measure; empty for a dimensionless one.
    pub unit: String,
    /// Borders of the bins, one more than there are bins.
    pub edges: Vec<f64>,
    /// Number of particles in each bin.
    pub counts: Vec<usize>,
}

/// A particle with one of the worst values of a measure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Index of the particle.
    pub particle: usize,
    /// Position of the particle, in the unit of the geometry.
    pub x: Vec<f64>,
    /// Name of the measure.
    pub measure: String,
    /// Value of the measure.
    pub value: f64,
}

/// A measure: name, unit, borders of the bins, and whether small values are bad.
struct Measure {
    name: &'static str,
    unit: &'static str,
    edges: &'static [f64],
    small_is_bad: bool,
}

const MEASURES: [Measure; 7] = [
    Measure {
        name: "neighbours",
        unit: "",
        edges: &[0., 2., 4., 6., 8., 10., 12., 14., 16., 20., 24., 28., 32., 40., 60.],
        small_is_bad: true,
    },
    Measure {
        name: "condition number",
        unit: "",
        edges: &[1., 1.5, 2., 3., 5., 10., 20., 50., 100., 1e3, 1e4, 1e6],
        small_is_bad: false,
    },
    Measure {
        name: "one-sidedness",
        unit: "",
        edges: &[0., 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0],
        small_is_bad: false,
    },
    Measure { name: "empty sectors", unit: "", edges: &[0., 1., 2., 3., 4., 5., 6., 7., 8.], small_is_bad: false },
    Measure {
        name: "nearest neighbour",
        unit: "spacings",
        edges: &[0., 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.5],
        small_is_bad: true,
    },
    Measure {
        name: "angle between neighbouring normals",
        unit: "degrees",
        edges: &[0., 1., 2., 5., 10., 15., 20., 30., 45., 60., 90., 180.],
        small_is_bad: false,
    },
    Measure {
        name: "gap between walls",
        unit: "spacings",
        edges: &[0., 0.5, 1., 1.5, 2., 2.5, 3., 3.5, 4.],
        small_is_bad: true,
    },
];
const ANGLE: usize = 5;
const GAP: usize = 6;

/// Histogram counts and worst values of one chunk of particles, or of all.
#[derive(Clone, Default)]
struct Tally {
    counts: [Vec<usize>; MEASURES.len()],
    worst: [Vec<(f64, usize)>; MEASURES.len()],
    neighbours: (usize, usize, usize),
}

impl Tally {
    fn new() -> Self {
        Self {
            counts: std::array::from_fn(|m| vec![0; MEASURES[m].edges.len() - 1]),
            neighbours: (usize::MAX, 0, 0),
            ..Self::default()
        }
    }

    /// Counts the value of measure `m` at particle `i`.
    fn add(&mut self, m: usize, i: usize, value: f64) {
        let edges = MEASURES[m].edges;
        let bin = edges.partition_point(|e| *e <= value).clamp(1, edges.len() - 1) - 1;
        self.counts[m][bin] += 1;
        let badness = if MEASURES[m].small_is_bad { -value } else { value };
        // a measure that is perfect everywhere has no worst place
        if badness == 0.0 && !MEASURES[m].small_is_bad {
            return;
        }
        let list = &mut self.worst[m];
        if list.len() < WORST || badness > list[WORST - 1].0 {
            let at = list.partition_point(|w| w.0 >= badness);
            list.insert(at, (badness, i));
            list.truncate(WORST);
        }
    }

    fn merge(mut self, other: Self) -> Self {
        for m in 0..MEASURES.len() {
            self.counts[m].iter_mut().zip(&other.counts[m]).for_each(|(a, b)| *a += b);
            self.worst[m].extend(&other.worst[m]);
            self.worst[m].sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            self.worst[m].truncate(WORST);
        }
        let (a, b) = (self.neighbours, other.neighbours);
        self.neighbours = (a.0.min(b.0), a.1 + b.1, a.2.max(b.2));
        self
    }
}

impl Diagnosis {
    /// Examines a cloud. `linear_walls` is the number of wall fits that had to be linear instead of quadratic.
    pub fn of<const D: usize>(cloud: &Cloud<D>, linear_walls: usize) -> Self {
        let n = cloud.n_rows();
        let walls = WallGrid::new(cloud);
        let mut tallies = vec![Tally::default(); n.div_ceil(CHUNK)];
        sweep_each(&mut tallies, |c| {
            let mut tally = Tally::new();
            for i in c * CHUNK..n.min((c + 1) * CHUNK) {
                examine(cloud, &walls, i, &mut tally);
            }
            tally
        });
        let tally = tallies.into_iter().fold(Tally::new(), Tally::merge);
        Self {
            particles: cloud.n_real(),
            interface: cloud.interface.len(),
            neighbours: Spread {
                min: if n > 0 { tally.neighbours.0 as f64 } else { 0.0 },
                mean: tally.neighbours.1 as f64 / n.max(1) as f64,
                max: tally.neighbours.2 as f64,
            },
            histograms: histograms(&tally),
            worst: findings(cloud, &tally),
            repairs: cloud.notes.clone(),
            notes: notes(cloud, &tally, linear_walls),
        }
    }
}

fn histograms(tally: &Tally) -> Vec<Histogram> {
    let filled = MEASURES.iter().zip(&tally.counts).filter(|(_, counts)| counts.iter().any(|c| *c > 0));
    filled
        .map(|(m, counts)| Histogram {
            name: m.name.into(),
            unit: m.unit.into(),
            edges: m.edges.to_vec(),
            counts: counts.clone(),
        })
        .collect()
}

fn findings<const D: usize>(cloud: &Cloud<D>, tally: &Tally) -> Vec<Finding> {
    let of = |m: usize| {
        tally.worst[m].iter().map(move |(badness, i)| Finding {
            particle: *i,
            x: cloud.x[*i].0.to_vec(),
            measure: MEASURES[m].name.into(),
            // JSON has no infinite numbers
            value: badness.abs().min(f64::MAX),
        })
    };
    (0..MEASURES.len()).flat_map(of).collect()
}

/// Evaluates all measures at particle `i`.
fn examine<const D: usize>(cloud: &Cloud<D>, walls: &WallGrid<'_, D>, i: usize, tally: &mut Tally) {
    let row = cloud.neighbours.of(i);
    let h = cloud.spacing[i];
    let layered = cloud.layers.in_steps(i).is_some();
    let wall = (i >= cloud.n_fluid).then(|| &cloud.interface[i - cloud.n_fluid]);
    let mut sums = Sums::default();
    let mut nearest = f64::INFINITY;
    let mut seen = 0u32;
    for j in row {
        let d = cloud.offset(i, *j as usize);
        sums.add(&d);
        let apart = cloud.judged_offset(i, *j as usize).norm();
        nearest = nearest.min(apart / (0.5 * (h + cloud.spacing[*j as usize])));
        seen |= sectors(
            &match wall {
                // inside layers the last axis already is the normal
                Some(w) if !layered => across(&d, &w.normal),
                _ => d,
            },
            wall.is_some(),
        );
    }
    let n = row.len();
    tally.neighbours = (tally.neighbours.0.min(n), tally.neighbours.1 + n, tally.neighbours.2.max(n));
    let all = 1u32 << if wall.is_some() { D - 1 } else { D };
    tally.add(0, i, n as f64);
    tally.add(1, i, sums.condition());
    if wall.is_none() {
        tally.add(2, i, sums.one_sided());
    }
    if wall.is_some() || cloud.wall_distance[i] >= AWAY * h {
        tally.add(3, i, f64::from(all - seen.count_ones()));
    }
    tally.add(4, i, nearest);
    if let Some(w) = wall {
        examine_wall(cloud, walls, i, &w.normal, tally);
    }
}

fn examine_wall<const D: usize>(
    cloud: &Cloud<D>,
    walls: &WallGrid<'_, D>,
    i: usize,
    normal: &Vector<D>,
    tally: &mut Tally,
) {
    let range = cloud.interface_range();
    let beside = cloud.neighbours.of(i).iter().map(|j| *j as usize).filter(|j| range.contains(j));
    let cosine = beside.map(|j| cloud.interface[j - cloud.n_fluid].normal.dot(normal)).fold(1.0, f64::min);
    tally.add(ANGLE, i, cosine.clamp(-1.0, 1.0).acos().to_degrees());
    if let Some(gap) = walls.gap(i, normal) {
        tally.add(GAP, i, gap);
    }
}

/// Components of `d` in orthonormal axes of which the last is the normal.
fn across<const D: usize>(d: &Vector<D>, normal: &Vector<D>) -> Vector<D> {
    // Householder reflection that maps the normal to the last axis
    let mut v = *normal;
    v[D - 1] += if normal[D - 1] >= 0.0 { 1.0 } else { -1.0 };
    *d - v * (2.0 * d.dot(&v) / v.norm_squared())
}

/// The sectors that contain `d`, as bits: 2^D sectors by the signs of the components, or 2^(D−1) when the last
/// component is ignored.
fn sectors<const D: usize>(d: &Vector<D>, half: bool) -> u32 {
    let axes = if half { D - 1 } else { D };
    let border = BORDER * d.norm();
    (0..1u32 << axes)
        .filter(|s| (0..axes).all(|a| if s >> a & 1 == 1 { d[a] > -border } else { d[a] < border }))
        .fold(0, |bits, s| bits | 1 << s)
}

/// Interface particles in a hash grid, for the search of facing walls.
struct WallGrid<'a, const D: usize> {
    cloud: &'a Cloud<D>,
    grids: std::collections::BTreeMap<u64, Grid<D>>,
}

impl<'a, const D: usize> WallGrid<'a, D> {
    fn new(cloud: &'a Cloud<D>) -> Self {
        let mut grids = std::collections::BTreeMap::new();
        for i in cloud.interface_range() {
            let h = cloud.spacing[i];
            grids.entry(h.to_bits()).or_insert_with(|| Grid::new(THIN_GAP * h)).insert(&cloud.x[i], i as u32);
        }
        Self { cloud, grids }
    }

    /// Distance, in spacings, to the nearest wall of the same or half the spacing that faces particle `i`; `None` when
    /// it is `THIN_GAP` spacings or more.
    fn gap(&self, i: usize, normal: &Vector<D>) -> Option<f64> {
        let (x, h) = (self.cloud.x[i], self.cloud.spacing[i]);
        let mut gap = THIN_GAP;
        for grid in self.grids.range((0.45 * h).to_bits()..=(2.1 * h).to_bits()).map(|g| g.1) {
            grid.near(&x, THIN_GAP * h, |j| {
                let other = &self.cloud.interface[j as usize - self.cloud.n_fluid].normal;
                let d = self.cloud.x[j as usize] - x;
                let r = d.norm();
                // the walls must face each other across the fluid, not through a body or along a wall
                if other.dot(normal) < FACING && d.dot(normal) > 0.7 * r && d.dot(other) < -0.7 * r {
                    gap = gap.min(r / h);
                }
            });
        }
        (gap < THIN_GAP).then_some(gap)
    }
}

fn notes<const D: usize>(cloud: &Cloud<D>, tally: &Tally, linear_walls: usize) -> Vec<String> {
    let mut notes = Vec::new();
    let n_gap: usize = tally.counts[GAP].iter().sum();
    if let Some((gap, i)) = tally.worst[GAP].first() {
        notes.push(format!(
            "{n_gap} interface particles face another wall at less than {THIN_GAP} spacings; the narrowest gap is {:.1} spacings wide, at {}; hint: refine there with a `cloud.box`",
            -gap, place(&cloud.x[*i])
        ));
    }
    if linear_walls > 0 {
        notes.push(format!("{linear_walls} of {} wall fits are linear instead of quadratic", cloud.interface.len()));
    }
    if let Some((angle, i)) = tally.worst[ANGLE].first().filter(|w| w.0 > 30.0) {
        notes.push(format!(
            "neighbouring wall normals differ by up to {angle:.0} degrees, at {}; hint: raise `cloud.curvature_levels`",
            place(&cloud.x[*i])
        ));
    }
    notes.extend(layer_termination::notes(cloud));
    let cut = cloud.transforms.iter().any(|t| t.sign != Vector::splat(1.0));
    for (body, (sum, total)) in closure(cloud).into_iter().enumerate() {
        if !cut && sum.norm() > OPEN * total {
            notes.push(format!(
                "area vectors of body {} do not close: {:.1e} of its area is missing",
                body + 1,
                sum.norm() / total
            ));
        }
    }
    notes
}

/// Sums Σ S and Σ |S| of the area vectors of every body.
fn closure<const D: usize>(cloud: &Cloud<D>) -> Vec<(Vector<D>, f64)> {
    let n = cloud.interface.iter().map(|w| usize::from(w.body) + 1).max().unwrap_or(0);
    let mut sums = vec![(Vector::ZERO, 0.0); n];
    for w in &cloud.interface {
        sums[usize::from(w.body)].0 += w.area;
        sums[usize::from(w.body)].1 += w.area.norm();
    }
    sums
}
