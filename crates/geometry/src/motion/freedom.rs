//! Unknown coordinates of a body and their effect on its position.
//!
//! The position x(t) of an elastically supported, free or flexible body is not known in advance. Its coordinates q are
//! unknowns in addition to those of the gas. At any time, the coordinates with their rates and accelerations define a
//! motion of the same kind as a prescribed one ([`BodyMotion::momentary`]), so that the same code moves the cloud in
//! both cases.
//!
//! The unknowns of a structure are stored one coordinate after another, each followed by its rate: q₀, q₀', q₁, q₁', …
//!
//! [`BodyMotion::momentary`]: super::BodyMotion::momentary
use crate::math::Vector;
use crate::math::jet::Jet;

/// Effect of a coordinate.
#[derive(Clone, Debug, PartialEq)]
pub enum Role<const D: usize> {
    /// Rotation of the body about its pivot: nose up in 2-D, about its axis in 3-D.
    Turn,
    /// Displacement along a direction.
    Shift(Vector<D>),
    /// A component of the rotation vector in 3-D.
    Attitude(usize),
    /// Coordinate of one of the modes of the body.
    Mode(usize),
    /// Rotation of a flap by β: sin β and cos β − 1 are the coordinates of two modes, [`Hinge`]s that rotate and
    /// stretch.
    ///
    /// [`Hinge`]: super::Hinge
    Flap {
        /// Index of the mode with the coordinate sin β.
        sine: usize,
        /// Index of the mode with the coordinate cos β − 1.
        cosine: usize,
    },
}

/// The unknown coordinates of one body.
#[derive(Clone, Debug, PartialEq)]
pub struct Freedom<const D: usize> {
    /// Index of the first coordinate of this body among those of all bodies.
    first: usize,
    roles: Vec<Role<D>>,
}

impl<const D: usize> Freedom<D> {
    /// Coordinates with these roles, in this order; `first` is the index of the first one among those of all bodies.
    pub fn new(first: usize, roles: Vec<Role<D>>) -> Self {
        Self { first, roles }
    }

    /// The roles of the coordinates with their values from the `jets` of all bodies; missing coordinates are omitted.
    pub(super) fn moves<'a>(&'a self, jets: &'a [Jet]) -> impl Iterator<Item = (&'a Role<D>, Jet)> {
        let jet = |k: usize| jets.get(self.first + k).copied().unwrap_or(Jet { value: 0.0, first: 0.0, second: 0.0 });
        self.roles.iter().enumerate().map(move |(k, role)| (role, jet(k)))
    }

    /// True when a coordinate rotates the body.
    pub(super) fn turns(&self) -> bool {
        self.roles.iter().any(|role| matches!(role, Role::Turn | Role::Attitude(_)))
    }

    /// True when the body has a free attitude in 3-D.
    pub(super) fn turns_in_space(&self) -> bool {
        self.roles.iter().any(|role| matches!(role, Role::Attitude(_)))
    }
}

/// Coordinates, without their rates, from the unknowns `u` of structures.
pub fn positions(u: &[f64]) -> Vec<Jet> {
    let at_rest = |pair: &[f64]| Jet { value: pair[0], first: 0.0, second: 0.0 };
    u.chunks_exact(2).map(at_rest).collect()
}
