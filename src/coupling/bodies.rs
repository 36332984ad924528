//! A structure and the body of the case that it carries.
use std::ops::Range;
use std::sync::Arc;

use crate::cloud::Cloud;
use crate::math::{Vector, dense::Factors};
use crate::motion::{BodyMotion, Freedom, Hinge, ModeShape, Role};
use crate::structure::{Energy, Floating, Model, Placement, Structure};
use crate::system::Fault;

/// Greatest angle, in radians, and displacement, in units of a coordinate, that are believed.
const FARTHEST: f64 = 1e3;

/// A structure that carries a body.
#[derive(Clone, Debug)]
pub struct Attached<const D: usize> {
    /// The structure.
    pub structure: Structure<D>,
    /// Number of the body.
    pub body: usize,
    /// Its first coordinate among those of all structures.
    pub first: usize,
    /// Shapes of its modes.
    pub shapes: Vec<Arc<ModeShape<D>>>,
    /// What is a large change of each coordinate: a radian, a length of the body.
    pub units: Vec<f64>,
    /// Displacements in each mode at the points that are told of.
    probes: Vec<Vec<Vector<D>>>,
    /// Displacements in each mode at the interface particles of the whole cloud; empty for rigid bodies.
    bends: Vec<Vec<Vector<D>>>,
}

impl<const D: usize> Attached<D> {
    /// The structure `structure` of body number `body`, whose length is `length`; its first coordinate is number `first` of all.
    pub fn new(
        structure: Structure<D>,
        body: usize,
        length: f64,
        first: usize,
        shapes: Vec<Arc<ModeShape<D>>>,
    ) -> Self {
        let unit = |k: usize| if structure.is_angle(k) { 1.0 } else { length };
        let units = (0..structure.len()).map(unit).collect();
        Self { structure, body, first, shapes, units, probes: Vec::new(), bends: Vec::new() }
    }

    /// The same with points, as placed, whose displacements in the modes are told beside the coordinates.
    pub fn with_probes(mut self, places: &[Vector<D>]) -> Self {
        self.probes = places.iter().map(|x| self.shapes.iter().map(|shape| shape.at(x)).collect()).collect();
        self
    }

    /// Bodies with coordinates of their own: the first of those that share a structure.
    pub fn distinct(all: &[Self]) -> impl Iterator<Item = &Self> {
        all.iter().enumerate().filter(|(k, body)| all[..*k].iter().all(|b| b.first != body.first)).map(|(_, body)| body)
    }

    /// Numbers that are told beside the coordinates.
    pub fn n_told(&self) -> usize {
        D * self.probes.len()
    }

    /// Displacements of the points that are told of, each with its rate, for the unknowns `u` of all structures.
    pub(super) fn told(&self, u: &[f64]) -> Vec<[f64; 2]> {
        let sums = self.own(u);
        let at = |(shapes, d): (&Vec<Vector<D>>, usize)| {
            [0, 1].map(|part| shapes.iter().zip(&sums[part]).map(|(shape, q)| shape[d] * q).sum())
        };
        self.probes.iter().flat_map(|shapes| (0..D).map(move |d| (shapes, d))).map(at).collect()
    }

    /// The same on a cloud: the modes are known at its interface particles, whose places before any motion are `walls`.
    pub fn on(mut self, walls: &[Vector<D>]) -> Self {
        if !self.shapes.is_empty() {
            self.bends = walls.iter().map(|x| self.shapes.iter().map(|shape| shape.at(x)).collect()).collect();
        }
        self
    }

    /// Its coordinates among those of all structures.
    pub fn range(&self) -> Range<usize> {
        self.first..self.first + self.structure.len()
    }

    /// Coordinates and rates of its own, from the unknowns of all structures.
    fn own(&self, u: &[f64]) -> [Vec<f64>; 2] {
        split(&u[2 * self.first..2 * self.range().end])
    }

    /// Unknowns at the start.
    pub(super) fn initial(&self) -> Vec<f64> {
        let start = self.structure.initial();
        let n = self.structure.len();
        (0..n).flat_map(|k| [start[k], start[n + k]]).collect()
    }

    /// Highest natural frequency, or the rate of a damper where that is more.
    pub(super) fn fastest(&self) -> f64 {
        let n = self.structure.len();
        let frequencies = self.structure.natural_frequencies(&vec![0.0; n]);
        let matrices = self.structure.matrices(&vec![0.0; n], &vec![0.0; n]);
        let damped = (0..n).map(|k| matrices.damping[k * (n + 1)] / matrices.mass[k * (n + 1)]);
        frequencies.into_iter().chain(damped).fold(0.0, f64::max)
    }

    /// How its coordinates place the body, for the unknowns `u` of all structures.
    pub(super) fn placement(&self, u: &[f64]) -> Placement<D> {
        self.structure.placement(&self.own(u)[0])
    }

    /// Adds to `load`, those of its coordinates, the generalised forces of the forces `force` on the interface particles `walls` of its body
    /// on the cloud `before` any motion.
    pub(super) fn add_loads(
        &self,
        (before, placement): (&Cloud<D>, &Placement<D>),
        force: &impl Fn(usize) -> Vector<D>,
        walls: Range<usize>,
        load: &mut [f64],
    ) {
        for w in walls.filter(|w| usize::from(before.interface[*w].body) == self.body) {
            let bends = self.bends.get(w).map_or(&[][..], Vec::as_slice);
            placement.add_work(&before.x[before.n_fluid + w], bends, &force(w), load);
        }
    }

    /// d/dt of its unknowns `u` under the generalised forces `load`.
    pub(super) fn rates(&self, t: f64, u: &[f64], load: &[f64], change: &mut [f64]) {
        let [q, v] = split(u);
        let accelerations = self.structure.accelerations(t, [&q, &v], load);
        for (k, pair) in change.chunks_exact_mut(2).enumerate() {
            (pair[0], pair[1]) = (v[k], accelerations[k]);
        }
    }

    /// d/dτ of its unknowns on their way to equilibrium: M⁻¹ (Q + f − F)/ω, and −ω q'.
    pub(super) fn towards_rest(&self, u: &[f64], load: &[f64], omega: f64, change: &mut [f64]) {
        let [q, v] = split(u);
        let still = vec![0.0; q.len()];
        let accelerations = self.structure.accelerations(0.0, [&q, &still], load);
        for (k, pair) in change.chunks_exact_mut(2).enumerate() {
            (pair[0], pair[1]) = (accelerations[k] / omega, -omega * v[k]);
        }
    }

    /// How [`Self::rates`], or in steady flow [`Self::towards_rest`], changes where the unknowns `u` change by `v` and the generalised forces
    /// `load` by `change`.
    pub(super) fn rates_change(
        &self,
        (t, steady): (f64, Option<f64>),
        [u, v]: [&[f64]; 2],
        [load, change]: [&[f64]; 2],
        out: &mut [f64],
    ) {
        let ([q, rate], [dq, dv], n) = (split(u), split(v), self.structure.len());
        let still = vec![0.0; n];
        let at = self.structure.linearise(t, [&q, if steady.is_some() { &still } else { &rate }], load);
        for (i, pair) in out.chunks_exact_mut(2).enumerate() {
            let times = |by: &[f64], x: &[f64]| by[i * n..][..n].iter().zip(x).map(|(a, b)| a * b).sum::<f64>();
            let pushed = times(&at.by_coordinate, &dq) + times(&at.by_load, change);
            (pair[0], pair[1]) = match steady {
                Some(omega) => (pushed / omega, -omega * dv[i]),
                None => (dv[i], pushed + times(&at.by_rate, &dv)),
            };
        }
    }

    /// d/dτ of its unknowns on their way to where they begin.
    pub(super) fn towards_start(&self, u: &[f64], omega: f64, change: &mut [f64]) {
        for ((change, u), start) in change.iter_mut().zip(u).zip(self.initial()) {
            *change = omega * (start - u);
        }
    }

    /// −∂/∂U of what [`Self::rates`], or in steady flow [`Self::towards_rest`], says under fixed forces of the gas, rows one after
    /// another, for the unknowns of this structure alone.
    pub(super) fn matrix(&self, t: f64, u: &[f64], steady: Option<f64>) -> Vec<f64> {
        let ([q, v], n) = (self.own(u), self.structure.len());
        let load = vec![0.0; n];
        let still = vec![0.0; n];
        let at = self.structure.linearise(t, [&q, if steady.is_some() { &still } else { &v }], &load);
        let mut matrix = vec![0.0; 4 * n * n];
        for i in 0..n {
            let (place, rate) = (2 * i * 2 * n, (2 * i + 1) * 2 * n);
            match steady {
                Some(omega) => {
                    (0..n).for_each(|j| matrix[place + 2 * j] = -at.by_coordinate[i * n + j] / omega);
                    matrix[rate + 2 * i + 1] = omega;
                }
                None => {
                    matrix[place + 2 * i + 1] = -1.0;
                    for j in 0..n {
                        matrix[rate + 2 * j] = -at.by_coordinate[i * n + j];
                        matrix[rate + 2 * j + 1] = -at.by_rate[i * n + j];
                    }
                }
            }
        }
        matrix
    }

    pub(super) fn energy(&self, u: &[f64]) -> Energy {
        let [q, v] = self.own(u);
        self.structure.energy(&q, &v)
    }

    /// Refuses coordinates that are none; `row` is the first row of the structures.
    pub(super) fn check(&self, u: &[f64], row: usize) -> Result<(), Fault> {
        let [q, _] = self.own(u);
        let far = || {
            let mut all = self.structure.coordinates().iter().zip(q.iter().zip(&self.units));
            let found = all.find(|(_, (q, unit))| !(q.abs() < FARTHEST * **unit));
            found.map(|(c, (q, _))| format!("coordinate `{}` has run away to {q:.3e}", c.name))
        };
        match self.structure.fault(&q).or_else(far) {
            Some(reason) => Err(Fault { particle: row + self.first, place: Vec::new(), reason }),
            None => Ok(()),
        }
    }

    /// True when springs alone hold every coordinate.
    pub fn is_held(&self) -> bool {
        let n = self.structure.len();
        let stiffness = self.structure.matrices(&vec![0.0; n], &vec![0.0; n]).stiffness;
        Factors::new(n, stiffness).is_some()
    }
}

/// Coordinates, and their rates.
fn split(u: &[f64]) -> [Vec<f64>; 2] {
    [0, 1].map(|part| u.chunks_exact(2).map(|pair| pair[part]).collect())
}

/// How the coordinates of a structure move its body, the first of them number `first` among those of all structures.
pub fn body_motion<const D: usize>(
    structure: &Structure<D>,
    first: usize,
    shapes: &[Arc<ModeShape<D>>],
) -> BodyMotion<D> {
    let names: Vec<&str> = structure.coordinates().iter().map(|c| c.name.as_str()).collect();
    let (pivot, mut modes) = (pivot(structure), shapes.to_vec());
    let mut roles = Vec::new();
    // of a body that plunges and pitches as well, modes are the last coordinates
    let bent = |k: usize| k + shapes.len() - structure.len();
    for (k, name) in names.iter().enumerate() {
        roles.push(match (structure.model(), *name) {
            (Model::Modal(_), _) => Role::Mode(k),
            (Model::Floating(_), name) if !Floating::RIGID.contains(&name) => Role::Mode(bent(k)),
            (_, "surge") => Role::Shift(Vector::axis(0)),
            (_, "sway") => Role::Shift(Vector::axis(1)),
            (_, "plunge") => Role::Shift(Vector::axis(D - 1)),
            (Model::Spatial(_), "roll") => Role::Attitude(0),
            (Model::Spatial(_), "pitch") => Role::Attitude(1),
            (Model::Spatial(_), "yaw") => Role::Attitude(2),
            (Model::Planar(body), "flap") => {
                let place = body.flap.as_ref().map_or(Vector::ZERO, |f| Vector::from_fn(|d| f.hinge[d]));
                let blend = body.flap.as_ref().map_or(0.0, |f| f.blend);
                let hinge = |rows| Arc::new(ModeShape::hinged(Hinge { place, blend, rows }, 1.0));
                // by the sine a quarter turn clockwise, by the cosine the arm itself
                let quarter = std::array::from_fn(|i| {
                    Vector::from_fn(|j| {
                        if i == j {
                            0.0
                        } else if i == 0 {
                            1.0
                        } else {
                            -1.0
                        }
                    })
                });
                modes.push(hinge(quarter));
                modes.push(hinge(std::array::from_fn(Vector::axis)));
                Role::Flap { sine: modes.len() - 2, cosine: modes.len() - 1 }
            }
            _ => Role::Turn,
        });
    }
    BodyMotion::about(pivot, None).with_freedom(Freedom::new(first, roles), modes)
}

fn pivot<const D: usize>(structure: &Structure<D>) -> Vector<D> {
    match structure.model() {
        Model::Planar(body) => Vector::from_fn(|d| body.pivot[d]),
        Model::Spatial(body) => Vector::from_fn(|d| body.pivot[d]),
        Model::Floating(body) => Vector::from_fn(|d| body.pivot[d]),
        Model::Modal(_) => Vector::ZERO,
    }
}
