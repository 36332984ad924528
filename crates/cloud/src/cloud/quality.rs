//! The cloud doctor: is this cloud fit for a flow?
//!
//! For every fluid and interface particle it looks at what its gradient rests on, the offsets d to its neighbours: their
//! number, the condition number of M = Σ d dᵀ/|d|², how far they lie to one side, |Σ d/|d|²| / Σ 1/|d|, the sectors of space
//! (quadrants, octants; in front of walls halves, quarters) that hold none, and the nearest one. For the surface it looks at
//! the angle between neighbouring normals, at the closure of the area vectors, Σ S = 0 for a whole body, and at gaps with so
//! few spacings between facing walls that no flow can form in them. It changes nothing: `repair` does, while a cloud is
//! built.
use serde::Serialize;

use super::Cloud;
use super::grid::Grid;
use super::layer_termination::{self, place};
use super::repair::Sums;
use crate::math::Vector;
use crate::math::parallel::{CHUNK, sweep_each};

/// Places listed for each measure.
const WORST: usize = 5;
/// Gaps with fewer spacings of fluid between facing walls are noted.
const THIN_GAP: f64 = 4.0;
/// Walls face each other when the cosine between their normals is below this.
const FACING: f64 = -0.5;
/// A neighbour this far, in parts of its distance, beyond the border of a sector still counts for it.
const BORDER: f64 = 0.05;
/// Relative closure defect of area vectors above which a body is noted as open; sampling is exact to round-off.
const OPEN: f64 = 1e-6;
/// Fluid particles this many spacings or more from walls must be surrounded.
const AWAY: f64 = 3.0;

/// What the doctor found.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// Number of particles without images.
    pub particles: usize,
    /// Number of interface particles among them.
    pub interface: usize,
    /// Neighbours of fluid and interface particles.
    pub neighbours: Spread,
    /// How the measures are distributed.
    pub histograms: Vec<Histogram>,
    /// The worst places of each measure.
    pub worst: Vec<Finding>,
    /// What was repaired when the cloud was built.
    pub repairs: Vec<String>,
    /// What else is worth knowing.
    pub notes: Vec<String>,
}

/// Extremes and mean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Smallest.
    pub min: f64,
    /// Mean.
    pub mean: f64,
    /// Largest.
    pub max: f64,
}

/// Counts between edges; values outside count in the first or last bin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Histogram {
    /// What is counted.
    pub name: String,
    /// Unit, empty for plain numbers.
    pub unit: String,
    /// Borders of the bins: one more than bins.
    pub edges: Vec<f64>,
    /// Particles in each bin.
    pub counts: Vec<usize>,
}

/// A place that stands out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Index of the particle.
    pub particle: usize,
    /// Its place.
    pub x: Vec<f64>,
    /// Name of the measure.
    pub measure: String,
    /// Value of the measure.
    pub value: f64,
}

/// One measure: name, unit, borders of the bins, and whether small values are the bad ones.
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

/// Counts of one chunk of particles, or of all.
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

    /// Counts `value` of measure `m` at particle `i`.
    fn add(&mut self, m: usize, i: usize, value: f64) {
        let edges = MEASURES[m].edges;
        let bin = edges.partition_point(|e| *e <= value).clamp(1, edges.len() - 1) - 1;
        self.counts[m][bin] += 1;
        let badness = if MEASURES[m].small_is_bad { -value } else { value };
        // nothing stands out where nothing is missing
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
    /// Examines a cloud; `linear_walls` is the number of wall fits that fell back to a linear one.
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
            // a JSON number must be finite
            value: badness.abs().min(f64::MAX),
        })
    };
    (0..MEASURES.len()).flat_map(of).collect()
}

/// Takes all measures of particle `i`.
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
                // in layers the last axis is the normal already
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

/// Components of `d` in axes of which the last is the normal.
fn across<const D: usize>(d: &Vector<D>, normal: &Vector<D>) -> Vector<D> {
    // Householder reflection that takes the normal to the last axis
    let mut v = *normal;
    v[D - 1] += if normal[D - 1] >= 0.0 { 1.0 } else { -1.0 };
    *d - v * (2.0 * d.dot(&v) / v.norm_squared())
}

/// The sectors that hold `d`, one bit each: 2^D by the signs of the components, or 2^(D−1) leaving out the last one.
fn sectors<const D: usize>(d: &Vector<D>, half: bool) -> u32 {
    let axes = if half { D - 1 } else { D };
    let border = BORDER * d.norm();
    (0..1u32 << axes)
        .filter(|s| (0..axes).all(|a| if s >> a & 1 == 1 { d[a] > -border } else { d[a] < border }))
        .fold(0, |bits, s| bits | 1 << s)
}

/// Interface particles in bins, to find walls that face one another.
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

    /// Distance, in spacings, to the nearest wall of the same or half the spacing that faces particle `i` across less than
    /// `THIN_GAP` of them.
    fn gap(&self, i: usize, normal: &Vector<D>) -> Option<f64> {
        let (x, h) = (self.cloud.x[i], self.cloud.spacing[i]);
        let mut gap = THIN_GAP;
        for grid in self.grids.range((0.45 * h).to_bits()..=(2.1 * h).to_bits()).map(|g| g.1) {
            grid.near(&x, THIN_GAP * h, |j| {
                let other = &self.cloud.interface[j as usize - self.cloud.n_fluid].normal;
                let d = self.cloud.x[j as usize] - x;
                let r = d.norm();
                // both look at each other across the fluid, not through a body or along a wall
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
            "{n_gap} interface particles face another wall across less than {THIN_GAP} spacings; the narrowest gap has {:.1} at {}; hint: refine there with a `cloud.box`",
            -gap, place(&cloud.x[*i])
        ));
    }
    if linear_walls > 0 {
        notes.push(format!("{linear_walls} of {} wall fits fell back to linear", cloud.interface.len()));
    }
    if let Some((angle, i)) = tally.worst[ANGLE].first().filter(|w| w.0 > 30.0) {
        notes.push(format!(
            "neighbouring normals turn by up to {angle:.0} degrees, at {}; hint: raise `cloud.curvature_levels`",
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

/// Σ S and Σ |S| of every body.
fn closure<const D: usize>(cloud: &Cloud<D>) -> Vec<(Vector<D>, f64)> {
    let n = cloud.interface.iter().map(|w| usize::from(w.body) + 1).max().unwrap_or(0);
    let mut sums = vec![(Vector::ZERO, 0.0); n];
    for w in &cloud.interface {
        sums[usize::from(w.body)].0 += w.area;
        sums[usize::from(w.body)].1 += w.area.norm();
    }
    sums
}
