//! How bodies are filled with particles: what is planned is looked at before a particle is made.
use super::super::error::RunError;
use super::cut::{Cut, cut_off, uncut};
use super::size::Size;
use crate::case::{Body, PlaneState, Shape, Solid as Data, SolidFill};
use crate::geometry::Surface;
use crate::math::Vector;
use crate::solid::fill::{Lattice, relaxed};
use crate::solid::particles::Fill;

/// Particles through the thickness where nothing is said: frequencies to half a per cent.
const USUAL: f64 = 9.0;
/// Particles through the thickness below which frequencies are off by more than one per cent.
const FEW: usize = 5;
/// Greatest distance of a body from the origin, in spacings: beyond it, round-off of coordinates opens the divergence theorem by
/// more than what it is closed to.
const FARTHEST: f64 = 1e6;

/// Thickness of a body over its extent and its distance from the origin that round-off of coordinates closes.
const CLOSED: f64 = 1e-13;

/// One body on its way, with what is to fill it.
pub(super) struct Plan<'a, const D: usize> {
    /// What the case says of it.
    pub(super) data: &'a Data,
    /// Its name.
    pub(super) name: String,
    /// Its surface.
    pub(super) surface: Surface<D>,
    /// Planes of symmetry that cut it.
    pub(super) cuts: Vec<Cut>,
    /// All of it follows a prescribed motion.
    pub(super) led: bool,
    /// Distance of particles.
    pub(super) spacing: f64,
    /// Corners that rows of particles lie between; absent where particles are relaxed.
    rows: Option<Vec<Vector<D>>>,
}

/// One body with its particles.
pub(super) struct Part<'a, const D: usize> {
    /// What was planned.
    pub(super) plan: Plan<'a, D>,
    /// Its particles.
    pub(super) fill: Fill<D>,
}

impl<'a, const D: usize> Plan<'a, D> {
    /// How the body `body`, called `name`, is filled, with `factor` times the distance of particles. Refuses what no particles can fill, or
    /// tell apart.
    pub(super) fn new(
        (body, data, factor): (&Body, &'a Data, f64),
        name: String,
        surface: Surface<D>,
        cuts: Vec<Cut>,
    ) -> Result<Self, RunError> {
        let corners = match corners(body, &surface) {
            Some(corners) if !cuts.is_empty() => Some(cut_off(corners, &cuts, &name)?),
            None if !cuts.is_empty() => return Err(uncut(&name)),
            whole => whole,
        };
        let rows = match data.fill {
            Some(SolidFill::Relaxed) => None,
            Some(SolidFill::Lattice) if corners.is_none() => {
                return Err(RunError::Solid {
                    what: format!("`{name}`: rows of particles fill boxes, and polygons of four corners, alone"),
                    hint: "leave `fill` out, or write `fill = \"relaxed\"`".into(),
                });
            }
            Some(SolidFill::Lattice) => corners,
            None if matches!(body.shape, Shape::Box { .. }) || D == 2 => corners,
            None => None,
        };
        let shortest = shortest(&surface, rows.as_deref());
        let through = |count: f64| shortest / ((count - 1.0) / factor).round();
        let given = data.spacing.map(|s| factor * s.0).or(data.through.map(|count| through(f64::from(count))));
        let spacing = given.unwrap_or_else(|| through(USUAL));
        near((&name, body), &surface, spacing)?;
        Ok(Self { data, name, surface, cuts, led: false, spacing, rows })
    }

    /// How many particles will fill the body, and what they take.
    pub(super) fn size(&self) -> Size {
        match &self.rows {
            Some(corners) => Size::of_rows((0..D).map(|d| longest(corners, d) / self.spacing), D),
            None => Size::of_relaxed(&self.surface, self.spacing),
        }
    }

    /// Thickness of the body in distances of its particles: that of a plate with its volume and surface, where there are no rows.
    pub(super) fn through(&self) -> f64 {
        let thickness = match &self.rows {
            Some(corners) => shortest(&self.surface, Some(corners)),
            None => 2.0 * self.surface.volume().abs() / self.surface.area(),
        };
        thickness / self.spacing
    }

    /// Fills the body, and turns it where it is one of revolution; what makes its results doubtful is added to `warnings`.
    pub(super) fn filled(self, warnings: &mut Vec<String>) -> Result<Part<'a, D>, RunError> {
        let (fill, rows) = match &self.rows {
            None => (seen(relaxed(&self.surface, self.spacing), &self.surface), None),
            Some(corners) => {
                let lattice = Lattice::with_spacing(corners.clone(), self.spacing);
                let lattice = Lattice { jitter: self.data.jitter, ..lattice };
                (lattice.fill(), lattice.counts.iter().copied().min())
            }
        };
        warnings.extend(thin(&fill, rows, &self.name)?);
        let round = self.data.plane == PlaneState::Axisymmetric;
        let fill = if round { turned(fill, &self.name)? } else { fill };
        Ok(Part { plan: self, fill })
    }
}

/// Refuses bodies that are so thin, or so far from the origin, that their coordinates do not tell sides or particles apart.
fn near<const D: usize>((name, body): (&str, &Body), surface: &Surface<D>, spacing: f64) -> Result<(), RunError> {
    let (centre, extent) = (surface.bounds().centre(), surface.bounds().extent());
    let thinnest = (0..D).map(|d| extent[d]).fold(f64::INFINITY, f64::min);
    if thinnest <= CLOSED * (centre.norm() + extent.norm()) {
        return Err(RunError::Solid {
            what: format!("`{name}` is {thinnest:.3e} thick: coordinates of its size do not tell its sides apart"),
            hint: "check the units of its lengths".into(),
        });
    }
    if centre.norm() <= FARTHEST * spacing {
        return Ok(());
    }
    let moved: Vec<f64> = body.placement.translate.iter().map(|x| x.0).collect();
    let placed = if moved.is_empty() { String::new() } else { format!(" (`translate` is {moved:?})") };
    Err(RunError::Solid {
        what: format!(
            "the middle of `{name}` is {:.3e} from the origin{placed}, more than {FARTHEST:e} spacings of its \
             particles, {spacing:.3e} each: coordinates there do not tell them apart well enough",
            centre.norm()
        ),
        hint: format!(
            "place it at most {:.3e} from the origin, or take a larger `spacing`, {:.3e} or more",
            FARTHEST * spacing,
            centre.norm() / FARTHEST
        ),
    })
}

/// Without neighbours that do not see one another through the body.
fn seen<const D: usize>(fill: Fill<D>, surface: &Surface<D>) -> Fill<D> {
    /// How far below the surface a particle on it looks from, in spacings, the first of these that is inside: a chord of a hollow side
    /// leaves the body a little, and a sharp edge is thin.
    const BELOW: [f64; 3] = [0.3, 0.1, 0.03];
    let areas = fill.areas();
    let (x, spacing) = (fill.x.clone(), fill.spacing);
    let on = |i: usize| areas[i] != Vector::ZERO;
    let eye = |i: usize| {
        let below = BELOW.iter().map(|part| x[i] - areas[i].unit() * (part * spacing));
        below.into_iter().find(|eye| surface.inside(eye)).unwrap_or(x[i])
    };
    let eyes: Vec<Vector<D>> = (0..x.len()).map(|i| if on(i) { eye(i) } else { x[i] }).collect();
    fill.seen(|i, j| on(i) && on(j) && surface.crosses(&eyes[i], &eyes[j]))
}

/// Corners of a box or a quadrilateral as rows want them; `None` for other shapes.
fn corners<const D: usize>(body: &Body, surface: &Surface<D>) -> Option<Vec<Vector<D>>> {
    let v = &surface.vertices;
    match (&body.shape, D) {
        (Shape::Box { .. } | Shape::Polygon(_), 2) if v.len() == 4 => Some(vec![v[0], v[1], v[3], v[2]]),
        (Shape::Box { size }, 3) => {
            let bounds = surface.bounds();
            let centre = bounds.centre();
            // the three sides that meet in the first corner
            let mut edges: Vec<Vector<D>> = v.iter().map(|x| *x - v[0]).collect();
            edges.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
            let mut sides: Vec<Vector<D>> = Vec::new();
            for edge in edges.into_iter().filter(|e| e.norm() > 0.0) {
                let square = sides.iter().all(|s| s.dot(&edge).abs() < 1e-9 * s.norm() * edge.norm());
                if square && sides.len() < size.len() {
                    sides.push(edge);
                }
            }
            // one that round-off of the coordinates has closed is no box
            if sides.len() < D {
                return None;
            }
            // along the axes as far as they go
            sides.sort_by_key(|s| (0..D).max_by(|a, b| s[*a].abs().total_cmp(&s[*b].abs())));
            let low = centre - sides.iter().fold(Vector::ZERO, |sum: Vector<D>, s| sum + *s * 0.5);
            let corner = |k: usize| (0..3).fold(low, |x, d| if k >> d & 1 == 1 { x + sides[d] } else { x });
            Some((0..8).map(corner).collect())
        }
        _ => None,
    }
}

/// The shortest side of a body.
fn shortest<const D: usize>(surface: &Surface<D>, corners: Option<&[Vector<D>]>) -> f64 {
    match corners {
        Some(corners) => (0..D).map(|d| longest(corners, d)).fold(f64::INFINITY, f64::min),
        None => {
            let extent = surface.bounds().extent();
            (0..D).map(|d| extent[d]).fold(f64::INFINITY, f64::min)
        }
    }
}

/// The longest edge of a box along its axis `d`.
fn longest<const D: usize>(corners: &[Vector<D>], d: usize) -> f64 {
    let edges = (0..1usize << D).filter(|k| k >> d & 1 == 0);
    edges.map(|k| (corners[k | 1 << d] - corners[k]).norm()).fold(0.0, f64::max)
}

/// Refuses a body that is little more than its two skins; says where it is thin.
fn thin<const D: usize>(fill: &Fill<D>, rows: Option<usize>, name: &str) -> Result<Option<String>, RunError> {
    /// Fewer than these through the thickness do not bend.
    const LEAST: f64 = 2.5;
    let whole: f64 = fill.volume.iter().sum();
    let area: f64 = fill.facets.iter().map(|f| f.area.norm()).sum();
    // twice volume over area is the thickness of a plate; of nothing it is no number
    let through = rows.map_or(2.0 * whole / (area * fill.spacing) + 1.0, |n| n as f64);
    if !(through >= LEAST) {
        return Err(RunError::Solid {
            what: format!("`{name}` has {through:.1} particles through its thickness, too few to bend"),
            hint: format!(
                "take a smaller `spacing` (now {:.4e}), five particles through the thickness or more; for thin shells give modes instead: \
                 `[[structure]]` with `model = \"modal\"`",
                fill.spacing
            ),
        });
    }
    Ok((through < FEW as f64 - 0.5).then(|| {
        format!("`{name}` has about {through:.1} particles through its thickness: frequencies are off by one to three per cent")
    }))
}

/// The section of a body, turned about the y axis, which it must not cross.
fn turned<const D: usize>(fill: Fill<D>, name: &str) -> Result<Fill<D>, RunError> {
    /// How far beyond the axis a particle may be by round-off, in spacings.
    const ROUND_OFF: f64 = 1e-9;
    let least = fill.x.iter().min_by(|a, b| a[0].total_cmp(&b[0])).filter(|x| x[0] < -ROUND_OFF * fill.spacing);
    if let Some(x) = least {
        return Err(RunError::Solid {
            what: format!("`{name}` reaches ({:.6}, {:.6}), beyond the axis of revolution x = 0", x[0], x[1]),
            hint: "x is the radius of an axisymmetric body: give the half of its section with x ≥ 0, or `translate` it"
                .into(),
        });
    }
    let fill = fill.turned();
    match (0..fill.x.len()).find(|i| !(fill.turn[*i] > 0.0 && fill.volume[*i] > 0.0)) {
        None => Ok(fill),
        Some(i) => Err(RunError::Solid {
            what: format!("a particle of `{name}` at ({:.6}, {:.6}) has no volume", fill.x[i][0], fill.x[i][1]),
            hint: "take a smaller `spacing`: at sharp edges of the section it decides".into(),
        }),
    }
}
