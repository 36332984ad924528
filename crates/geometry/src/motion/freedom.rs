//! Coordinates that are unknowns, and what each of them does to a body.
//!
//! A body on springs, a free body, or one that bends in modes of its own has no x(t) that is known beforehand. Its coordinates q are
//! unknowns beside those of the gas; at any time they, their rates and accelerations make a motion of the same kind as a prescribed
//! one ([`BodyMotion::momentary`]), so that all that moves clouds serves both.
//!
//! The unknowns of a structure stand one coordinate after another, each with its rate: q₀, q₀', q₁, q₁', …
//!
//! [`BodyMotion::momentary`]: super::BodyMotion::momentary
use crate::math::Vector;
use crate::math::jet::Jet;

/// What a coordinate does.
#[derive(Clone, Debug, PartialEq)]
pub enum Role<const D: usize> {
    /// Turns the body about its pivot: in the plane nose up, in space about its axis.
    Turn,
    /// Shifts it along a direction.
    Shift(Vector<D>),
    /// Is a component of its rotation vector, in space.
    Attitude(usize),
    /// Is the coordinate of one of its modes.
    Mode(usize),
    /// Turns a flap by β: sin β and cos β − 1 are the coordinates of two of its modes, [`Hinge`]s that turn and that stretch.
    ///
    /// [`Hinge`]: super::Hinge
    Flap {
        /// The mode of sin β.
        sine: usize,
        /// The mode of cos β − 1.
        cosine: usize,
    },
}

/// The coordinates of one body.
#[derive(Clone, Debug, PartialEq)]
pub struct Freedom<const D: usize> {
    /// The first coordinate of this body among those of all.
    first: usize,
    roles: Vec<Role<D>>,
}

impl<const D: usize> Freedom<D> {
    /// Coordinates of these roles one after another, the first of them number `first` among those of all bodies.
    pub fn new(first: usize, roles: Vec<Role<D>>) -> Self {
        Self { first, roles }
    }

    /// The coordinates that do something, as they are in `jets` of all bodies; at rest where those are missing.
    pub(super) fn moves<'a>(&'a self, jets: &'a [Jet]) -> impl Iterator<Item = (&'a Role<D>, Jet)> {
        let jet = |k: usize| jets.get(self.first + k).copied().unwrap_or(Jet { value: 0.0, first: 0.0, second: 0.0 });
        self.roles.iter().enumerate().map(move |(k, role)| (role, jet(k)))
    }

    /// True when a coordinate turns the body.
    pub(super) fn turns(&self) -> bool {
        self.roles.iter().any(|role| matches!(role, Role::Turn | Role::Attitude(_)))
    }

    /// True when it turns freely in space.
    pub(super) fn turns_in_space(&self) -> bool {
        self.roles.iter().any(|role| matches!(role, Role::Attitude(_)))
    }
}

/// Coordinates at rest where the unknowns `u` of structures have them.
pub fn positions(u: &[f64]) -> Vec<Jet> {
    let at_rest = |pair: &[f64]| Jet { value: pair[0], first: 0.0, second: 0.0 };
    u.chunks_exact(2).map(at_rest).collect()
}
