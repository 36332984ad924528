//! Spacing of clouds: what is chosen where a case leaves it to the program, and the same cloud coarser or finer.
//!
//! A family of clouds is one cloud seen larger and larger: spacing, layers and what curvature asks for are scaled together.
use super::reference;
use crate::case::{Accuracy, Case, Cloud, Domain, Length, Side, Sides, Wake, WallLayers};
use crate::cloud::CloudSpec;
use crate::cloud::layout::count;
use crate::geometry::Surface;

/// Spacings in the length of the shortest body, in 2-D and 3-D.
const ALONG: [f64; 2] = [64.0, 40.0];
/// The same where the gas has viscosity: layers and wake need as many particles again, and a fourth cloud is to be within reach.
const ALONG_LAYERS: f64 = 48.0;
/// Particles per level of refinement of the cloud with that spacing.
const LAYERS: [f64; 2] = [12.0, 8.0];
/// The same in space where the stream is slower than sound and has no viscosity: there those at the walls count most. 100,000 particles of
/// 4 to a level leave less spurious entropy and nearer loads than 220,000 of 8, whose spacing at the walls is wider
/// (`tests/nightly/bars.py`). Detached shocks and wakes would cross levels that become coarser too soon.
const LAYERS_OF_WINGS: f64 = 4.0;
/// Half-width of their domain in lengths of the bodies: in the plane, beyond 40, where it is otherwise, nearly nothing is spent and
/// lift gains 0.02 %; in space what a body does falls off faster.
const FAR_FIELD: [f64; 2] = [100.0, 30.0];
/// First layers at walls in L/√Re, which is a fifth of a laminar boundary layer, and how layers grow.
pub(crate) const ACROSS: f64 = 16.0;
const GROWTH: f64 = 1.2;
/// Greatest growth of the layers of a coarser cloud.
const STEEPEST: f64 = 1.5;
/// Lengths of the shortest body behind which wakes are followed, and in which spacing, in that at the walls, in 2-D and 3-D.
const WAKE: f64 = 2.0;
const WAKE_SPACING: [f64; 2] = [1.0, 2.0];
/// Particles per level of the cloud of small motions, and greatest number of particles that its spacing is chosen for, as if it were
/// one of a family.
const FEW_LAYERS: f64 = 6.0;
const SMALL_MOTION_PARTICLES: [usize; 2] = [50_000, 100_000];
/// Spacings in the mean thickness of a section in small motion, 2 A/P with its area A and its outline P (0.68 of the greatest one of a
/// NACA section), and greatest number of spacings in its length. Measured on sections of 1, 2, 4 and 12 % at M 0.5: so resolved, phases
/// of the moment about the quarter chord at k = 0.1 are 0.2 to 1.1 degrees from those of clouds four times as fine with twice the
/// layers; 64 spacings at any thickness and the usual levels at edges and noses leave 1.9 to 4.
const THROUGH: f64 = 5.0;
const ALONG_THIN: f64 = 128.0;
/// Spacings at sharp edges in the length of the shortest body: there velocities of small motions have singularities, whose error the
/// moment about the quarter chord shows first.
const AT_EDGES: f64 = 65_536.0;
/// Levels of refinement that noses may ask for: a section of 1 % has a nose radius of 1e-4 chords.
const NOSE_LEVELS: u32 = 10;
/// Fewest particles per level of refinement.
const FEWEST: f64 = 3.0;
/// Cells of the size of the spacing that a domain which a case gives holds a whole number of.
const COARSEST: [f64; 2] = [4.0, 8.0];
/// Particles of a cloud over the cells of its background, at most: those on the walls come to those between them.
const WITH_WALLS: f64 = 1.15;
/// Power of the spacing that the number of particles of a cloud in space goes with, and how often a spacing is corrected.
const POWER: f64 = 2.5;
const ROUNDS: usize = 6;
/// Factor by which few particles may make it coarser: half the shortest body, where edges and noses ask for finer ones anyway.
const COARSE: f64 = 20.0;
/// Mach number of streams below which shocks are rare.
const SMOOTH_BELOW: f64 = 0.6;
/// Cells along the shortest side of a domain that a case gives, at least; greatest number of those between sides that must stay; by how
/// much of a side they may miss it.
const CELLS: f64 = 8.0;
const MOST_CELLS: u32 = 64;
const WHOLE: f64 = 1e-9;

/// How well the loads are to be known; `None` where they are those of one cloud, as of marches and balances.
pub(crate) fn asked(case: &Case) -> Option<Accuracy> {
    if case.is_unsteady() {
        return None;
    }
    let chosen = case.cloud.spacing.is_none() && !case.bodies.is_empty();
    let usual = || Accuracy::usual(case.dimension.map_or(2, usize::from), case.polar.is_some());
    case.accuracy.or_else(|| chosen.then(usual))
}

/// The cloud that is chosen where a case leaves its spacing to the program, and the accuracy that is then asked for.
pub(crate) struct Chosen {
    /// The cloud.
    pub(crate) cloud: Cloud,
    /// The accuracy.
    pub(crate) accuracy: Option<Accuracy>,
}

impl Chosen {
    /// The choice for a case around `surface`; `None` where the case gives a spacing, and without bodies.
    pub(crate) fn of<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> Option<Self> {
        let surface = surface.filter(|_| case.cloud.spacing.is_none())?;
        let accuracy = asked(case).or(case.accuracy);
        Some(Self { cloud: chosen((case, case.cloud.clone()), surface, accuracy), accuracy })
    }
}

/// The cloud of a case, of which `filled` says all but the spacing; in space the last of its family has no more particles than `accuracy`
/// allows.
fn chosen<const D: usize>(
    (case, mut filled): (&Case, Cloud),
    surface: &Surface<D>,
    accuracy: Option<Accuracy>,
) -> Cloud {
    let length = |body: usize| {
        let extent = surface.bounds_of(body).extent();
        let mut sides: [f64; D] = std::array::from_fn(|d| extent[d]);
        sides.sort_by(f64::total_cmp);
        // the chord of a section and of a wing, the width of a slender body
        sides[1]
    };
    let shortest = (0..surface.bodies.len()).map(length).fold(f64::INFINITY, f64::min);
    let chord = reference::chord(case, Some(surface));
    let reynolds = case.flow.reynolds_number(chord);
    let whole = case.flow.viscous_length(chord);
    // a fifth of a laminar boundary layer
    let thin = reynolds.map(|re| shortest / (ACROSS * (re * shortest / whole).sqrt()));
    let along = shortest / if D == 2 && thin.is_some() { ALONG_LAYERS } else { ALONG[D - 2] };
    filled.far_field = filled.far_field.or(Some(Length(FAR_FIELD[D - 2] * surface.bounds().extent().max_abs())));
    let of_wing = D == 3 && thin.is_none() && case.flow.reference().mach <= 1.0;
    filled.layers = filled.layers.or(Some(if of_wing { LAYERS_OF_WINGS } else { LAYERS[D - 2] }));
    // slow viscous flow needs no layers: what is thin is wider than the spacing
    let thin = thin.filter(|thin| *thin < along);
    let layers = thin.map(|thin| WallLayers { first: Length(thin), growth: GROWTH, count: None });
    filled.wall_layers = filled.wall_layers.or(layers);
    let spaced = |spacing: f64| {
        let mut cloud = spaced::<D>(&filled, &case.boundary, spacing);
        let wake = Wake { length: Length(WAKE * shortest), spacing: Length(WAKE_SPACING[D - 2] * spacing) };
        cloud.wake = cloud.wake.or(thin.map(|_| wake));
        cloud
    };
    if D == 2 {
        return spaced(along);
    }
    // marches and balances have no family
    let most = accuracy.filter(|_| !case.is_unsteady()).unwrap_or(Accuracy::in_dimension(D)).particles;
    let cells = |spacing| count(&CloudSpec::of(&spaced(spacing), &case.boundary), Some(surface), &[]).ok();
    spaced(affordable(&cells, most, along))
}

/// What forces of small motions are wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Forces {
    /// A flutter boundary: a table for each of many Mach numbers, of which the balance of energy counts.
    Boundary,
    /// One table, of which every entry counts with its phase: thickness, nose and edges are resolved.
    Table,
}

/// The one cloud of a case that leaves all of it to the program: for forces of small motions, which are surer on it than drag is. `None` for
/// other cases.
pub(crate) fn one_cloud<const D: usize>(case: &Case, surface: Option<&Surface<D>>, wanted: Forces) -> Option<Cloud> {
    let surface = surface.filter(|_| case.cloud.spacing.is_none() && case.accuracy.is_none())?;
    let few = Cloud { layers: case.cloud.layers.or(Some(FEW_LAYERS)), ..case.cloud.clone() };
    let asked = Accuracy { particles: SMALL_MOTION_PARTICLES[D - 2], ..Accuracy::in_dimension(D) };
    let one = chosen((case, few), surface, Some(asked));
    Some(match D == 2 && wanted == Forces::Table && one.wall_layers.is_none() {
        true => of_section(one, &case.boundary, surface),
        false => one,
    })
}

/// The cloud of a section without layers at its walls, with a spacing that follows its thickness and with levels that follow its nose and
/// its edges, as far as the particles of small motions go. Levels that the case gives stay.
fn of_section<const D: usize>(cloud: Cloud, sides: &Sides, surface: &Surface<D>) -> Cloud {
    let usual = CloudSpec::<D>::new(1.0);
    let along = cloud.spacing.map_or(0.0, |h| h.0);
    let thickness = 2.0 * surface.volume().abs() / surface.area();
    let least = along * ALONG[D - 2] / ALONG_THIN;
    let cloud = spaced::<D>(&cloud, sides, (thickness / THROUGH).max(least).min(along));
    let spacing = cloud.spacing.map_or(along, |h| h.0);
    let at_edges = (AT_EDGES * spacing / (along * ALONG[D - 2])).log2().ceil() as u32;
    let levels =
        |given: u32, usual: u32, most: u32| if given == usual { usual..=most.max(usual) } else { given..=given };
    let edges = levels(cloud.edge_levels, usual.edge_levels, at_edges);
    let noses = levels(cloud.curvature_levels, usual.curvature_levels, NOSE_LEVELS);
    let fewer = |by: u32| Cloud {
        edge_levels: edges.end().saturating_sub(by).max(*edges.start()),
        curvature_levels: noses.end().saturating_sub(by).max(*noses.start()),
        ..cloud.clone()
    };
    let fits = |cloud: &Cloud| {
        let counted = count(&CloudSpec::of(cloud, sides), Some(surface), &[]);
        counted.is_ok_and(|cells| cells <= SMALL_MOTION_PARTICLES[D - 2])
    };
    (0..=NOSE_LEVELS.max(at_edges)).map(fewer).find(fits).unwrap_or_else(|| cloud.clone())
}

/// The spacing in space, no finer than `spacing`, at which the last of the clouds that an error bar takes has no more particles than are allowed:
/// thin edges and noses ask for more than the size of a body tells. Particles are more than cells of the background, by those on the
/// walls.
fn affordable(cells: &impl Fn(f64) -> Option<usize>, most: usize, spacing: f64) -> f64 {
    let room = most as f64 / WITH_WALLS;
    let (mut spacing, coarsest) = (spacing, COARSE * spacing);
    for _ in 0..ROUNDS {
        let Some(cells) = cells(spacing) else { break };
        let over = cells as f64 / room;
        if over <= 1.0 {
            break;
        }
        spacing = (spacing * over.powf(1.0 / POWER)).min(coarsest);
    }
    spacing
}

/// The cloud with this spacing. A domain that it gives is widened at far sides until it holds whole cells of the coarsest cloud; where
/// two sides of an axis must stay, the spacing is one that fits between them.
fn spaced<const D: usize>(cloud: &Cloud, sides: &Sides, spacing: f64) -> Cloud {
    let coarsest = COARSEST[D - 2];
    let mut cloud = Cloud { spacing: Some(Length(spacing)), ..cloud.clone() };
    let sides = CloudSpec::<D>::of(&cloud, sides).sides;
    let Some(Domain { min, max }) = cloud.domain.as_mut() else { return cloud };
    let lengths: [f64; D] = std::array::from_fn(|d| max[d].0 - min[d].0);
    let shortest = lengths.into_iter().fold(f64::INFINITY, f64::min);
    // the first cloud fits as often as a power of two into cells that are small beside the domain
    let cells = |cell: f64| (cell / (coarsest * spacing)).log2();
    let mut cell = coarsest * spacing * 2f64.powf(cells(shortest / CELLS).floor().max(0.0));
    let whole = |length: f64, cell: f64| (length / cell - (length / cell).round()).abs() < WHOLE * length / cell;
    let far = |d: usize, end: usize| sides[d][end] == Side::FarField;
    let fixed = || (0..D).filter(|d| !far(*d, 0) && !far(*d, 1)).map(|d| lengths[d]);
    if let Some(first) = fixed().reduce(f64::min) {
        let fitting = (1..=MOST_CELLS).map(|n| first / f64::from(n)).find(|c| fixed().all(|length| whole(length, *c)));
        cell = fitting.unwrap_or(first);
        cloud.spacing = Some(Length(cell / (coarsest * 2f64.powf(cells(cell).round().max(0.0)))));
    }
    for d in (0..D).filter(|d| !whole(lengths[*d], cell)) {
        let more = (lengths[d] / cell).ceil() * cell - lengths[d];
        match (far(d, 0), far(d, 1)) {
            (true, true) => (min[d].0, max[d].0) = (min[d].0 - 0.5 * more, max[d].0 + 0.5 * more),
            (true, false) => min[d].0 -= more,
            (false, true) => max[d].0 += more,
            (false, false) => {}
        }
    }
    cloud
}

/// The cloud with the spacing, the particles per level and what curvature asks for scaled by `factor`: it is alike, and has factor⁻ᵈ as many
/// particles.
pub(crate) fn scaled(cloud: &Cloud, factor: f64) -> Cloud {
    let mut cloud = cloud.clone();
    if factor == 1.0 {
        return cloud;
    }
    let scale = |l: &mut Length| l.0 *= factor;
    cloud.spacing.iter_mut().for_each(scale);
    cloud.boxes.iter_mut().for_each(|b| scale(&mut b.spacing));
    if let Some(wake) = cloud.wake.as_mut() {
        scale(&mut wake.spacing);
    }
    if let Some(layers) = cloud.wall_layers.as_mut() {
        scale(&mut layers.first);
        layers.growth = (1.0 + (layers.growth - 1.0) * factor).min(STEEPEST.max(layers.growth));
    }
    cloud.curvature = (cloud.curvature * factor).min(1.0);
    cloud.layers = Some((cloud.particles_per_level() / factor).max(FEWEST));
    cloud
}

/// The cloud of a stage of a run, with `factor` times the spacing of the case. Clouds of a family are alike; those that a single cloud
/// in the plane is begun on have as many particles per level as that one ([`begins_near`]).
pub(crate) fn of_stage(case: &Case, factor: f64) -> Cloud {
    let mut alike = scaled(&case.cloud, factor);
    if begins_near(case) {
        alike.layers = case.cloud.layers;
    }
    alike
}

/// True for the steady inviscid flow on a single cloud in the plane in a stream in which shocks are to be expected. It begins on clouds that are
/// coarser at the walls alone: loads on them differ by tenths of a per cent, not by several, so that shocks stand within a row or two of
/// where they belong. On clouds that are coarser everywhere, which have fewer particles and serve smooth flows better, a section at
/// Mach 0.84 takes 89 iterations on the last of 25,000 particles, on these 28.
pub(crate) fn begins_near(case: &Case) -> bool {
    let fast = case.flow.reference().mach > SMOOTH_BELOW && case.flow.viscous(1.0).is_none();
    fast && crate::geometry::dimension(case) == 2 && !case.is_unsteady() && asked(case).is_none()
}

/// Particles of the cloud with a factor on the spacing of the case, whose own has `n`: as many more as the background has cells.
pub(crate) fn sizes<'a, const D: usize>(
    case: &'a Case,
    surface: Option<&'a Surface<D>>,
    n: usize,
) -> impl Fn(f64) -> f64 + 'a {
    let cells =
        move |factor: f64| count(&CloudSpec::<D>::of(&of_stage(case, factor), &case.boundary), surface, &[]).ok();
    move |factor| {
        let over = || Some(cells(factor)? as f64 / cells(1.0)? as f64);
        let alike = || factor.powi(-(D as i32));
        n as f64 * if factor == 1.0 { 1.0 } else { over().unwrap_or_else(alike) }
    }
}

/// Particles of a cloud with `factor` times the spacing over those of the one with that spacing, about.
pub(crate) fn alike(factor: f64, dimension: usize) -> f64 {
    factor.powf(if dimension == 2 { -2.0 } else { -POWER })
}
