//! Positions of fixed sets of points at many times: modal displacements at the points are evaluated once.
use super::law::BodyMotion;
use super::surface_net::Carried;
use crate::math::Vector;
use crate::math::jet::Jet;
use crate::math::parallel::sweep;

/// Points of one body with their displacement in each of its modes.
#[derive(Clone, Debug)]
pub struct PointTrajectory<const D: usize> {
    law: BodyMotion<D>,
    /// Displacement φ of each mode at each point.
    shifts: Vec<Vec<Vector<D>>>,
    /// Relation of each point to the surface of a solid of particles, and whether the point lies on it.
    carried: Vec<(Carried<D>, bool)>,
}

impl<const D: usize> PointTrajectory<D> {
    /// Trajectories of points of a body with the motion `law`; `points` are positions before any motion.
    pub fn new(law: &BodyMotion<D>, points: &[Vector<D>]) -> Self {
        Self::of_those(law, points, |_| true)
    }

    /// Trajectories for which the modes displace only the points selected by `moves`.
    pub fn of_those(law: &BodyMotion<D>, points: &[Vector<D>], moves: impl Fn(usize) -> bool + Send + Sync) -> Self {
        let at = |shape: &super::ModeShape<D>| {
            let mut all = vec![Vector::ZERO; points.len()];
            sweep(&mut all, |k| if moves(k) { shape.at(&points[k]) } else { Vector::ZERO });
            all
        };
        Self { law: law.clone(), shifts: law.shapes().map(at).collect(), carried: Vec::new() }
    }

    /// Trajectories of points on and around a solid of particles, given by `carried`; true for points on the surface.
    pub fn carried_by(self, carried: Vec<(Carried<D>, bool)>) -> Self {
        Self { carried, ..self }
    }

    /// The motion of the body.
    pub fn law(&self) -> &BodyMotion<D> {
        &self.law
    }

    /// A function to the position at time `t` of point number `k`, which is at `x` before any motion.
    pub fn at(&self, t: f64) -> impl Fn(usize, &Vector<D>) -> Vector<D> + Send + Sync + '_ {
        self.with(t, &[])
    }

    /// The same function for the values `jets` of the unknown coordinates of all bodies.
    pub fn with(&self, t: f64, jets: &[Jet]) -> impl Fn(usize, &Vector<D>) -> Vector<D> + Send + Sync + use<'_, D> {
        let law = self.law.momentary(t, jets);
        let (pose, coordinates) = (law.pose(t), law.coordinates(t));
        let net = self.law.net().filter(|_| !self.carried.is_empty()).map(|net| net.displacement(jets));
        move |k, x| {
            if let Some(at) = &net {
                let (carried, on) = &self.carried[k];
                return *x + if *on { carried.on(at) } else { carried.of_groups(at) };
            }
            let bend = |sum: Vector<D>, (q, shift): (&f64, &Vec<Vector<D>>)| sum + shift[k] * *q;
            pose.point(&coordinates.iter().zip(&self.shifts).fold(*x, bend))
        }
    }
}
