//! The structure of a case before there is a flow: what stored forces must fit.
use crate::coupling::Attached;
use crate::observe::structure::is_angle;
use crate::problem::reference::chord;
use crate::problem::{Problem, ProblemIn, files};
use crate::record::flutter::Mark;
use crate::structure::{Matrices, Model, Spring};

mod translations;

pub(super) use translations::Translation;

/// Structures at rest.
pub(crate) struct Held {
    /// Reference chord.
    pub(crate) chord: f64,
    /// Names of all coordinates.
    pub(crate) names: Vec<String>,
    /// What they move.
    pub(super) marks: Vec<Mark>,
    /// Matrices about the bodies as placed, in units of the solver.
    pub(super) matrices: Matrices,
    /// Springs of all coordinates.
    pub(super) springs: Vec<Spring>,
    /// Displacements of all bodies by the same way, which no steady force follows.
    pub(super) translations: Vec<Translation>,
}

impl Held {
    /// What each coordinate is counted in where shapes are told: rigid bodies are displaced by parts of `b`.
    pub(crate) fn units(&self, b: f64) -> Vec<f64> {
        let unit = |(name, mark): (&String, &Mark)| if mark.pivot.is_some() && !is_angle(name) { b } else { 1.0 };
        self.names.iter().zip(&self.marks).map(unit).collect()
    }

    /// The structures of a problem.
    pub(crate) fn of(problem: &Problem) -> Self {
        match problem {
            Problem::Plane(problem) => Self::within(problem),
            Problem::Space(problem) => Self::within(problem),
        }
    }

    fn within<const D: usize>(problem: &ProblemIn<D>) -> Self {
        let (case, surface, bodies) = (problem.case(), problem.surface(), problem.structures());
        let n = bodies.last().map_or(0, |b| b.range().end);
        let mut matrices = Matrices { mass: vec![0.0; n * n], damping: vec![0.0; n * n], stiffness: vec![0.0; n * n] };
        let (mut names, mut marks, mut springs) = (Vec::new(), Vec::new(), Vec::new());
        for body in bodies {
            let (m, still) = (body.structure.len(), vec![0.0; body.structure.len()]);
            let own = body.structure.matrices(&still, &still);
            let pairs = [
                (&mut matrices.mass, own.mass),
                (&mut matrices.damping, own.damping),
                (&mut matrices.stiffness, own.stiffness),
            ];
            for (whole, part) in pairs {
                part.iter().enumerate().for_each(|(k, x)| whole[(body.first + k / m) * n + body.first + k % m] = *x);
            }
            names.extend(body.structure.coordinates().iter().map(|c| c.name.clone()));
            springs.extend(body.structure.coordinates().iter().map(|c| c.spring));
            marks.extend((0..m).map(|k| mark(problem, body, k)));
        }
        let translations = surface.map_or(Vec::new(), |s| translations::translations(case, s, (bodies, n)));
        Self { chord: chord(case, surface), names, marks, matrices, springs, translations }
    }
}

/// Structures of a problem in the steady flow of a case text at Mach 0.5, for tests.
#[cfg(test)]
pub(crate) fn problem_of(text: &str) -> Problem {
    let case = crate::case::read(text, "case.toml").unwrap_or_else(|e| panic!("{e}"));
    Problem::of_case(&case, "").unwrap_or_else(|e| panic!("{e}"))
}

fn mark<const D: usize>(problem: &ProblemIn<D>, body: &Attached<D>, k: usize) -> Mark {
    let pivot = match body.structure.model() {
        Model::Planar(planar) => Some(planar.pivot.to_vec()),
        Model::Spatial(rigid) => Some(rigid.pivot.to_vec()),
        Model::Floating(body) => Some(body.pivot[..D].to_vec()),
        Model::Modal(_) => None,
    };
    let text = match problem.modes_of(body.body) {
        Some(modes) => modes.get(k).map(|mode| format!("{:?}", mode.table())),
        None => {
            let mode = problem.case().structure_of(body.body).and_then(|s| s.modes.get(k)).filter(|_| pivot.is_none());
            mode.and_then(|mode| files::text(problem.input(), &mode.file).ok())
        }
    };
    Mark { pivot, shape: text.map(|t| format!("{:08x}", crc32fast::hash(t.as_bytes()))) }
}
