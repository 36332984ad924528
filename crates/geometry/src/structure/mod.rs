//! Structures with a few coordinates q, which have masses, springs and dampers:
//!
//! M(q) q'' + g(q, q') + C q' + F(q) = Q + f(t),
//!
//! with the generalised forces Q of the surroundings (by virtual work, [`Placement::add_work`]) and prescribed forces f
//! of time. The models [`PlanarBody`] (typical section with or without flap, rigid body in 2-D), [`RigidBody`] (3-D)
//! and modes have the same interface. Each defines only its inertial forces, once and generic in [`Scalar`]; mass
//! matrix, tangents and accelerations follow from this definition by automatic differentiation. Springs ([`Spring`]:
//! linear, cubic, free play) and dampers act on single coordinates. Coordinates that are not unknowns stay zero, which
//! is the initial placement.
//!
//! Sign conventions: x is directed downstream. Displacements are positive along x, y and z, so that plunge is positive
//! *up* (the flutter literature has h positive down: h = −plunge). Pitch is nose up positive (clockwise in 2-D), a flap
//! trailing edge down positive. Units are those of the solver (density and sound speed of the free stream, unit of
//! length of the case), per unit span in 2-D.
mod describe;
pub mod flutter;
mod force;
mod from_case;
pub mod limit_cycle;
mod placement;
mod planar;
mod spatial;
mod spring;
#[cfg(test)]
mod tests;

pub use force::ForceHistory;
pub use from_case::BodyFrame;
pub use placement::{Placement, Pose};
pub use planar::{Flap, InertiaLaw, PlanarBody};
pub use spatial::RigidBody;
pub use spring::Spring;

use crate::case::Freedom;
use crate::math::jet::{Jet, Scalar};
use crate::math::{Vector, dense, rotation, symmetric};
use placement::{Effect, TurnedFlap};

/// Number of right-hand sides that are solved together.
const AT_ONCE: usize = 8;

/// Structural model: the kind of body and its inertia.
#[derive(Clone, Debug, PartialEq)]
pub enum Model {
    /// A rigid body in 2-D, optionally with a flap; coordinates `surge`, `plunge`, `pitch`, `flap`.
    Planar(PlanarBody),
    /// A rigid body in 3-D; coordinates `surge`, `sway`, `plunge`, `roll`, `pitch`, `yaw`.
    Spatial(RigidBody),
    /// Modes, each with its name and generalised mass.
    Modal(Vec<(String, f64)>),
    /// Plunge, pitch and modes with unit masses and without inertial coupling, for forces of small motions.
    Floating(Floating),
}

/// Plunge, pitch and modes of a body, see [`Model::Floating`].
#[derive(Clone, Debug, PartialEq)]
pub struct Floating {
    /// Centre of rotation of pitch in the initial placement.
    pub pivot: [f64; 3],
    /// Names of the coordinates: [`Floating::RIGID`], followed by those of the modes.
    names: Vec<String>,
}

impl Floating {
    /// Names of the rigid-body coordinates, which precede the modes.
    pub const RIGID: [&str; 2] = ["plunge", "pitch"];

    /// A body with the centre of rotation `pivot` and modes of these names.
    pub fn new(pivot: [f64; 3], modes: impl IntoIterator<Item = String>) -> Self {
        let rigid = Self::RIGID.map(str::to_owned);
        Self { pivot, names: rigid.into_iter().chain(modes).collect() }
    }
}

/// An unknown coordinate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coordinate {
    /// Name of the coordinate in the model.
    pub name: String,
    /// Spring.
    pub spring: Spring,
    /// Coefficient of viscous damping, force divided by velocity.
    pub damping: f64,
    /// Prescribed force as a function of time.
    pub force: ForceHistory,
    /// Initial value.
    pub initial: f64,
    /// Initial rate.
    pub initial_rate: f64,
}

/// An elastically supported or flexible body in `D` dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure<const D: usize> {
    model: Model,
    coordinates: Vec<Coordinate>,
    /// Index of each unknown coordinate among those of the model.
    places: Vec<usize>,
}

/// Reason why a structure could not be constructed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StructureError {
    /// There are no unknown coordinates.
    #[error("the structure has no coordinates\nhint: name those that are free to move")]
    Empty,
    /// The model has no coordinate of this name, or it was given twice.
    #[error(
        "the structure has no coordinate `{name}`, or has it already\nhint: its coordinates are {known}, each once"
    )]
    Unknown {
        /// Name of the coordinate.
        name: String,
        /// Names of the coordinates of the model.
        known: String,
    },
    /// The model has another dimension.
    #[error(
        "a structure in {wanted} dimensions cannot be in {dimension}\nhint: sections are plane, rigid bodies in space are not"
    )]
    Dimension {
        /// Dimension of the model.
        wanted: usize,
        /// Dimension of the case.
        dimension: usize,
    },
    /// The mass matrix is not positive definite.
    #[error(
        "the mass matrix of the structure is not positive definite\n\
         hint: masses and inertias are positive, and m I > S²: the square of the radius of gyration is greater than that of the unbalance"
    )]
    Inertia,
}

/// Matrices of small motions about a state, M δq'' + C δq' + K δq = δQ; row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrices {
    /// Mass matrix M.
    pub mass: Vec<f64>,
    /// Damping matrix C, including the contribution of inertial forces.
    pub damping: Vec<f64>,
    /// Tangent stiffness matrix K.
    pub stiffness: Vec<f64>,
}

/// Accelerations with their derivatives; row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearisation {
    /// Accelerations q''.
    pub acceleration: Vec<f64>,
    /// Derivative by the coordinates, ∂q''/∂q = −M⁻¹K.
    pub by_coordinate: Vec<f64>,
    /// Derivative by the rates, ∂q''/∂q' = −M⁻¹C.
    pub by_rate: Vec<f64>,
    /// Derivative by the generalised forces, ∂q''/∂Q = M⁻¹.
    pub by_load: Vec<f64>,
}

/// Energies of a structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy {
    /// Kinetic energy q'ᵀ M q'/2.
    pub kinetic: f64,
    /// Potential energy of springs and gravity; zero in the initial placement with unloaded springs.
    pub potential: f64,
    /// Power dissipated by the dampers.
    pub dissipation: f64,
}

impl Model {
    /// Names of the coordinates of the model.
    pub fn names(&self) -> Vec<&str> {
        match self {
            Self::Planar(body) => planar::NAMES[..if body.flap.is_some() { 4 } else { 3 }].to_vec(),
            Self::Spatial(_) => spatial::NAMES.to_vec(),
            Self::Modal(modes) => modes.iter().map(|(name, _)| name.as_str()).collect(),
            Self::Floating(body) => body.names.iter().map(String::as_str).collect(),
        }
    }

    /// Number of coordinates of the model.
    fn width(&self) -> usize {
        match self {
            Self::Planar(_) => planar::NAMES.len(),
            Self::Spatial(_) => spatial::NAMES.len(),
            Self::Modal(modes) => modes.len(),
            Self::Floating(body) => body.names.len(),
        }
    }

    fn inertial<S: Scalar>(&self, q: &[S], v: &[S], a: &[S]) -> Vec<S> {
        match self {
            Self::Planar(body) => body.inertial(q, v, a),
            Self::Spatial(body) => body.inertial(q, v, a),
            Self::Modal(modes) => modes.iter().zip(a).map(|((_, mass), a)| S::constant(*mass) * *a).collect(),
            Self::Floating(_) => a.to_vec(),
        }
    }
}

impl<const D: usize> Structure<D> {
    /// The structure with the unknowns `coordinates` of `model`, in this order. Fails when a coordinate does not exist
    /// or the mass matrix is not positive definite.
    pub fn new(model: Model, coordinates: Vec<Coordinate>) -> Result<Self, StructureError> {
        let wanted = match &model {
            Model::Planar(_) => 2,
            Model::Spatial(_) => 3,
            Model::Modal(_) | Model::Floating(_) => D,
        };
        if wanted != D {
            return Err(StructureError::Dimension { wanted, dimension: D });
        }
        let mut places: Vec<usize> = Vec::new();
        for coordinate in &coordinates {
            let known = model.names();
            let place = known.iter().position(|n| *n == coordinate.name).filter(|p| !places.contains(p));
            let unknown = || StructureError::Unknown { name: coordinate.name.clone(), known: known.join(", ") };
            places.push(place.ok_or_else(unknown)?);
        }
        let structure = Self { model, coordinates, places };
        if structure.is_empty() {
            return Err(StructureError::Empty);
        }
        let mass = structure.matrices(&vec![0.0; structure.len()], &vec![0.0; structure.len()]).mass;
        match symmetric::cholesky(&mass, structure.len()) {
            Some(_) => Ok(structure),
            None => Err(StructureError::Inertia),
        }
    }

    /// Number of unknown coordinates.
    pub fn len(&self) -> usize {
        self.coordinates.len()
    }

    /// Always false: [`Structure::new`] rejects structures without coordinates.
    pub fn is_empty(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// The structural model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The unknown coordinates.
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    /// True when coordinate `k` is an angle in radians; coordinates of sections and rigid bodies may be, those of modes
    /// are not, whatever their name.
    pub fn is_angle(&self, k: usize) -> bool {
        let turns = |name: &str| Freedom::ALL.iter().any(|f| f.turns() && f.name() == name);
        match &self.model {
            Model::Modal(_) => false,
            Model::Floating(_) => self.coordinates[k].name == Floating::RIGID[1],
            _ => turns(&self.coordinates[k].name),
        }
    }

    /// Initial state [q, q'].
    pub fn initial(&self) -> Vec<f64> {
        let (q, v) = (self.coordinates.iter().map(|c| c.initial), self.coordinates.iter().map(|c| c.initial_rate));
        q.chain(v).collect()
    }

    /// Values of all coordinates of the model; coordinates that are not unknowns are zero.
    fn spread<S: Scalar>(&self, values: &[S]) -> Vec<S> {
        let mut all = vec![S::constant(0.0); self.model.width()];
        self.places.iter().zip(values).for_each(|(place, value)| all[*place] = *value);
        all
    }

    /// Internal forces M(q) a + g(q, v) + C v + F(q).
    fn internal<S: Scalar>(&self, q: &[S], v: &[S], a: &[S]) -> Vec<S> {
        let inertial = self.model.inertial(&self.spread(q), &self.spread(v), &self.spread(a));
        let parts = self.coordinates.iter().zip(&self.places).enumerate();
        parts.map(|(k, (c, place))| inertial[*place] + c.spring.force(q[k]) + S::constant(c.damping) * v[k]).collect()
    }

    /// Residual M(q) a + g(q, v) + C v + F(q) − Q − f(t) of the equations of motion, for q, v, a and the generalised
    /// forces `load` = Q.
    pub fn residual(&self, t: f64, [q, v, a]: [&[f64]; 3], load: &[f64]) -> Vec<f64> {
        let internal = self.internal(q, v, a);
        let outer = self.coordinates.iter().zip(load).map(|(c, load)| c.force.at(t) + load);
        internal.iter().zip(outer).map(|(i, o)| i - o).collect()
    }

    /// Derivatives of the internal forces by q, v or a; `which` is its index.
    fn derivative(&self, point: [&[f64]; 3], which: usize) -> Vec<f64> {
        let n = self.len();
        let mut matrix = vec![0.0; n * n];
        let mut jets = point.map(|values| values.iter().map(|x| Jet::constant(*x)).collect::<Vec<Jet>>());
        for j in 0..n {
            jets[which][j].first = 1.0;
            let column = self.internal(&jets[0], &jets[1], &jets[2]);
            (0..n).for_each(|i| matrix[i * n + j] = column[i].first);
            jets[which][j].first = 0.0;
        }
        matrix
    }

    /// Angular frequencies of small undamped vibrations about the coordinates `q`, ascending; those of unstable motions
    /// count as zero.
    pub fn natural_frequencies(&self, q: &[f64]) -> Vec<f64> {
        let matrices = self.matrices(q, &vec![0.0; self.len()]);
        let squares = symmetric::generalised_eigenvalues(&matrices.stiffness, &matrices.mass, self.len());
        squares.into_iter().map(|square| square.max(0.0).sqrt()).collect()
    }

    /// Matrices of small motions about the coordinates `q` and rates `v`, without acceleration.
    pub fn matrices(&self, q: &[f64], v: &[f64]) -> Matrices {
        let zero = vec![0.0; self.len()];
        let by = |which| self.derivative([q, v, &zero], which);
        Matrices { mass: by(2), damping: by(1), stiffness: by(0) }
    }

    /// Accelerations q'' for the generalised forces `load`.
    pub fn accelerations(&self, t: f64, [q, v]: [&[f64]; 2], load: &[f64]) -> Vec<f64> {
        let zero = vec![0.0; self.len()];
        let mut mass = self.derivative([q, v, &zero], 2);
        let mut right: Vec<[f64; 1]> = self.residual(t, [q, v, &zero], load).iter().map(|r| [-r]).collect();
        dense::solve(&mut mass, &mut right);
        right.into_iter().map(|[a]| a).collect()
    }

    /// Accelerations q'' with their derivatives.
    pub fn linearise(&self, t: f64, [q, v]: [&[f64]; 2], load: &[f64]) -> Linearisation {
        let n = self.len();
        let acceleration = self.accelerations(t, [q, v], load);
        let by = |which| self.derivative([q, v, &acceleration], which);
        let mut right: Vec<f64> = vec![0.0; n * 3 * n];
        let (stiffness, damping) = (by(0), by(1));
        for (i, row) in right.chunks_exact_mut(3 * n).enumerate() {
            row[..n].iter_mut().zip(&stiffness[i * n..]).for_each(|(r, k)| *r = -k);
            row[n..2 * n].iter_mut().zip(&damping[i * n..]).for_each(|(r, c)| *r = -c);
            row[2 * n + i] = 1.0;
        }
        solve_columns(&by(2), &mut right, n);
        let part = |from: usize| right.chunks_exact(3 * n).flat_map(|row| row[from * n..][..n].to_vec()).collect();
        let (by_coordinate, by_rate, by_load) = (part(0), part(1), part(2));
        Linearisation { acceleration, by_coordinate, by_rate, by_load }
    }

    /// Time derivative of the state u = [q, q'].
    pub fn rates(&self, t: f64, u: &[f64], load: &[f64]) -> Vec<f64> {
        let (q, v) = u.split_at(self.len());
        v.iter().copied().chain(self.accelerations(t, [q, v], load)).collect()
    }

    /// Prescribed forces f(t).
    pub fn forces(&self, t: f64) -> Vec<f64> {
        self.coordinates.iter().map(|c| c.force.at(t)).collect()
    }

    /// Energies and dissipated power.
    pub fn energy(&self, q: &[f64], v: &[f64]) -> Energy {
        let n = self.len();
        let mass = self.derivative([q, v, &vec![0.0; n]], 2);
        let kinetic = 0.5 * (0..n * n).map(|k| v[k / n] * mass[k] * v[k % n]).sum::<f64>();
        let springs: f64 = self.coordinates.iter().zip(q).map(|(c, q)| c.spring.energy(*q)).sum();
        let at_ease: f64 = self.coordinates.iter().map(|c| c.spring.energy(c.spring.rest)).sum();
        let weight = match &self.model {
            Model::Planar(body) => body.weight_energy(&self.spread(q)),
            Model::Spatial(body) => body.weight_energy(&self.spread(q)),
            Model::Modal(_) | Model::Floating(_) => 0.0,
        };
        let dissipation = self.coordinates.iter().zip(v).map(|(c, v)| c.damping * v * v).sum();
        Energy { kinetic, potential: springs - at_ease + weight, dissipation }
    }

    /// A message when the coordinates `q` are not admissible: not finite, or a rotation beyond a full turn; `None`
    /// otherwise.
    pub fn fault(&self, q: &[f64]) -> Option<String> {
        if let Some(k) = q.iter().position(|q| !q.is_finite()) {
            return Some(format!("`{}` is {}", self.coordinates[k].name, q[k]));
        }
        let all = self.spread(q);
        let turn = if matches!(self.model, Model::Spatial(_)) { Vector([all[3], all[4], all[5]]).norm() } else { 0.0 };
        let far = || format!("the body has turned by {:.1} degrees, and a full turn is beyond it", turn.to_degrees());
        (turn > spatial::LARGEST_TURN).then(far)
    }

    /// Position of the body for the coordinates `q`.
    pub fn placement(&self, q: &[f64]) -> Placement<D> {
        let all = self.spread(q);
        let still = Placement {
            pivot: Vector::ZERO,
            rotation: std::array::from_fn(Vector::axis),
            shift: Vector::ZERO,
            flap: None,
            amplitudes: Vec::new(),
            effects: self.places.iter().map(|place| Effect::Mode(*place)).collect(),
        };
        match &self.model {
            Model::Modal(_) => Placement { amplitudes: all, ..still },
            Model::Floating(body) => {
                let turned = |angle: f64, along: Option<usize>| match D {
                    2 if along.is_none() => clockwise(angle),
                    2 => clockwise_derivative(angle),
                    _ => spatial_rows([0.0, angle, 0.0], along),
                };
                let effect = |place: &usize| match place {
                    0 => Effect::Shift(Vector::axis(D - 1)),
                    1 => Effect::Turn(turned(all[1], Some(1))),
                    k => Effect::Mode(*k - Floating::RIGID.len()),
                };
                Placement {
                    pivot: Vector::from_fn(|d| body.pivot[d]),
                    rotation: turned(all[1], None),
                    shift: Vector::axis(D - 1) * all[0],
                    amplitudes: all[Floating::RIGID.len()..].to_vec(),
                    effects: self.places.iter().map(effect).collect(),
                    ..still
                }
            }
            Model::Planar(body) => Placement {
                pivot: Vector::from_fn(|d| body.pivot[d]),
                rotation: clockwise(all[2]),
                shift: Vector::from_fn(|d| all[d]),
                flap: body.flap.as_ref().map(|flap| turned_flap(flap, all[3])),
                effects: self.effects(2, |_| clockwise_derivative(all[2])),
                ..still
            },
            Model::Spatial(body) => Placement {
                pivot: Vector::from_fn(|d| body.pivot[d]),
                rotation: spatial_rows([all[3], all[4], all[5]], None),
                shift: Vector::from_fn(|d| all[d]),
                effects: self.effects(3, |k| spatial_rows([all[3], all[4], all[5]], Some(k))),
                ..still
            },
        }
    }

    /// Effects of the unknown coordinates of a rigid body: `shifts` displacements, then angles, then a flap in 2-D.
    fn effects(&self, shifts: usize, derivative: impl Fn(usize) -> [Vector<D>; D]) -> Vec<Effect<D>> {
        let effect = |place: &usize| match place {
            k if *k < shifts => Effect::Shift(Vector::axis(*k)),
            k if D == 2 && *k > shifts => Effect::Flap,
            k => Effect::Turn(derivative(*k - shifts)),
        };
        self.places.iter().map(effect).collect()
    }
}

/// Rows of the clockwise rotation by `angle` in 2-D.
fn clockwise<const D: usize>(angle: f64) -> [Vector<D>; D] {
    let columns = [[1.0, 0.0], [0.0, 1.0]].map(|axis| planar::turn(angle, &axis));
    std::array::from_fn(|i| Vector::from_fn(|j| columns[j][i]))
}

/// Rows of its derivative by the angle.
fn clockwise_derivative<const D: usize>(angle: f64) -> [Vector<D>; D] {
    clockwise(angle + std::f64::consts::FRAC_PI_2)
}

fn turned_flap<const D: usize>(flap: &Flap, angle: f64) -> TurnedFlap<D> {
    TurnedFlap {
        hinge: Vector::from_fn(|d| flap.hinge[d]),
        blend: flap.blend,
        rotation: clockwise(angle),
        derivative: clockwise_derivative(angle),
    }
}

/// Rows of R(θ), or of its derivative by component `along` of θ.
fn spatial_rows<const D: usize>(theta: [f64; 3], along: Option<usize>) -> [Vector<D>; D] {
    let mut jets = theta.map(Jet::constant);
    if let Some(k) = along {
        jets[k].first = 1.0;
    }
    let columns: [[Jet; 3]; 3] = std::array::from_fn(|j| {
        rotation::rotate(&jets, &std::array::from_fn(|i| Jet::constant(if i == j { 1.0 } else { 0.0 })))
    });
    let entry = |i: usize, j: usize| if along.is_some() { columns[j][i].first } else { columns[j][i].value };
    std::array::from_fn(|i| Vector::from_fn(|j| entry(i, j)))
}

/// Solves A X = B in place, for the rows of B one after another.
fn solve_columns(matrix: &[f64], right: &mut [f64], n: usize) {
    let width = right.len() / n;
    for from in (0..width).step_by(AT_ONCE) {
        let count = AT_ONCE.min(width - from);
        let part =
            |row: &[f64]| std::array::from_fn::<f64, AT_ONCE, _>(|m| if m < count { row[from + m] } else { 0.0 });
        let mut some: Vec<[f64; AT_ONCE]> = right.chunks_exact(width).map(part).collect();
        dense::solve(&mut matrix.to_vec(), &mut some);
        for (row, found) in right.chunks_exact_mut(width).zip(&some) {
            row[from..from + count].copy_from_slice(&found[..count]);
        }
    }
}
