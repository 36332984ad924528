//! Geometry: from the bodies of a case to one discretised surface.
//!
//! Every input is converted to a [`Shell`] of segments in 2-D or triangles in 3-D with outward normals: NACA formulas,
//! airfoil coordinate files, polygons, circles, ellipses, spheres, boxes, STL, OBJ and PLY files. Shells are placed and
//! combined into a [`Surface`], which answers queries for the nearest point, for crossings and for the inside through a
//! bounding-volume tree.
//!
//! Bodies in 3-D that overlap, and overlapping parts of one file, are clipped at their intersection and united.
//!
//! Limits: a surface must enclose a volume (thin sheets and large holes are rejected); bodies in 2-D must not overlap.
//! Only [`load_surface`] opens files; the readers accept any input and never panic.
mod airfoil;
mod bar;
mod chord_line;
mod cross_section;
mod holes;
mod loft;
mod marks;
mod mesh;
mod naca;
mod noise;
mod outline;
mod parts;
mod placement;
mod planform;
mod polygon;
mod primitive;
mod reference;
mod repair;
mod sampling;
mod section;
mod shell;
mod simple_outline;
mod simplex;
mod spline;
mod surface;
#[cfg(test)]
mod tests;
mod tree;
mod union;
mod weld;

pub use cross_section::CrossSection;
pub use planform::{Planform, Station};
pub use primitive::{cuboid, icosphere, write_obj, write_outlines, write_stl};
pub use reference::reference;
pub use sampling::Chain;
pub use shell::{Edge, Exact, Shell};
pub use surface::{Element, Nearest, Projection, Skin, Surface};

use crate::case::{Body, Case, Length, Naca, ProfileSides, Shape, numbers_of, open_regular, refuse_longer};
use crate::math::{Bounds, Vector};
use std::f64::consts::PI;
use std::fs::File;
use std::io;
use std::path::Path;

/// Turning angle above which a corner of a polygon is sharp (rad) (5°); the corners of a polygon are intended.
const POLYGON_CREASE: f64 = 5.0 * PI / 180.0;

/// Distance relative to the size of a body below which another one touches it.
const TOUCHING: f64 = 1e-9;

/// Reason why a surface could not be constructed.
#[derive(Debug, thiserror::Error)]
pub enum GeometryError {
    /// A file could not be read.
    #[error("cannot read `{file}`: {source}\nhint: paths are relative to the case file")]
    Open {
        /// Name of the file in the case.
        file: String,
        /// Cause.
        source: io::Error,
    },
    /// A shape cannot be used.
    #[error("{place}: {what}\nhint: {hint}")]
    Refused {
        /// File and line, or name of the body.
        place: String,
        /// Description of the problem, with the value.
        what: String,
        /// Remedy.
        hint: String,
    },
    /// Several bodies or files cannot be used.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n\n"))]
    Several(Vec<Self>),
}

impl GeometryError {
    fn refused(place: impl Into<String>, what: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::Refused { place: place.into(), what: what.into(), hint: hint.into() }
    }

    /// A single error, or several combined; `None` where there are none.
    fn all(found: Vec<Self>) -> Option<Self> {
        let mut flat: Vec<Self> = found.into_iter().flat_map(Self::parts).collect();
        if flat.len() < 2 { flat.pop() } else { Some(Self::Several(flat)) }
    }

    /// The individual errors.
    pub fn parts(self) -> Vec<Self> {
        match self {
            Self::Several(all) => all,
            one => vec![one],
        }
    }
}

/// A shell of dimension 2 or 3.
enum AnyShell {
    Plane(Shell<2>),
    Space(Shell<3>),
}

/// Number of space dimensions of a case: as given, otherwise that of its first body, otherwise 2.
pub fn dimension(case: &Case) -> u8 {
    let of = |body: &Body| match &body.shape {
        Shape::Naca(_) | Shape::Airfoil(_) | Shape::Polygon(_) | Shape::Circle { .. } | Shape::Ellipse { .. } => 2,
        Shape::Sphere { .. }
        | Shape::Surface(_)
        | Shape::Wing(_)
        | Shape::Revolution { .. }
        | Shape::Loft { .. }
        | Shape::Ellipsoid { .. } => 3,
        Shape::Box { size } => {
            if size.len() == 3 {
                3
            } else {
                2
            }
        }
    };
    case.dimension.unwrap_or_else(|| case.bodies.first().map_or(2, of))
}

/// The surface of all bodies, and notes about assumptions and repairs. `folder` is the folder of the files that the
/// bodies name. Fails with one error for each body that cannot be used.
pub fn load_surface<const D: usize>(
    bodies: &[Body],
    folder: &Path,
) -> Result<(Surface<D>, Vec<String>), GeometryError> {
    let mut notes = Vec::new();
    let (mut shells, mut lines) = (Vec::new(), Vec::new());
    let read = load_shells(bodies, folder, &mut notes)?;
    for (body, (name, shell)) in bodies.iter().zip(read) {
        notes.extend(chord_line::wing_astray(&name, body));
        let line = shell.plane().map(|plane| {
            let line = chord_line::chord_line(body, plane);
            notes.extend(chord_line::astray(&name, body, plane, &line));
            line.map(|x| placement::placed(&x, &body.placement))
        });
        lines.push(line.map(|line| line.map(|x| Vector::from_fn(|d| x.to_3d()[d]))));
        let mut shell = shell.in_dimension::<D>().ok_or_else(|| {
            let what = format!("its shape is not {D}-dimensional as the case is");
            GeometryError::refused(format!("body `{name}`"), what, "change the shape or `dimension`")
        })?;
        placement::place(&name, &mut shell, &body.placement)?;
        shells.push((name, shell));
    }
    if D == 2 && shells.len() > 1 {
        refuse_overlap(&shells)?;
    }
    let groups = if D == 2 { (0..shells.len()).map(|k| vec![k]).collect() } else { meeting(&shells) };
    let mut skins = Vec::new();
    for group in &groups {
        skins.push(skin(group, bodies, &shells, &mut notes)?);
    }
    let names: Vec<String> = shells.iter().map(|(name, _)| name.clone()).collect();
    let mut surface = Surface::of(&names, &skins);
    surface.chord_lines = lines;
    for k in groups.iter().filter(|group| group.len() > 1).flatten() {
        surface.keep_whole(*k, &shells[*k].1);
    }
    Ok((surface, notes))
}

/// The shells of all bodies with their names, before union; reports every body that cannot be used.
fn load_shells(
    bodies: &[Body],
    folder: &Path,
    notes: &mut Vec<String>,
) -> Result<Vec<(String, AnyShell)>, GeometryError> {
    let (mut shells, mut refused) = (Vec::new(), Vec::new());
    for (i, body) in bodies.iter().enumerate() {
        let name = body.name.clone().unwrap_or_else(|| format!("body-{}", i + 1));
        match load_shell(&name, body, folder, notes) {
            Ok(shell) => shells.push((name, shell)),
            Err(why) => refused.push(why),
        }
    }
    GeometryError::all(refused).map_or(Ok(shells), Err)
}

/// The outer surface of a group of bodies that intersect, or of a single body.
fn skin<const D: usize>(
    group: &[usize],
    bodies: &[Body],
    shells: &[(String, Shell<D>)],
    notes: &mut Vec<String>,
) -> Result<Skin<D>, GeometryError> {
    let (name, shell) = &shells[group[0]];
    if group.len() == 1 {
        return Ok(Skin { shell: shell.clone(), owner: vec![group[0] as u16] });
    }
    let place = format!("body `{name}`");
    let others: Vec<String> = group[1..].iter().map(|k| format!("`{}`", shells[*k].0)).collect();
    let refused = |what: String, hint: &str| Err(GeometryError::refused(&place, what, hint));
    let solid: Option<Vec<Shell<3>>> = group.iter().map(|k| shells[*k].1.clone().cast()).collect();
    let Some(solid) = solid else {
        return refused(format!("meets body {}", others.join(", ")), "move the bodies apart");
    };
    if let Some(k) = group.iter().find(|k| bodies[**k].motion != bodies[group[0]].motion) {
        let what = format!("meets body `{}`, which moves in another way", shells[*k].0);
        return refused(what, "bodies that intersect are one solid: give them the same motion, or move them apart");
    }
    for (i, a) in group.iter().enumerate() {
        for (j, b) in group.iter().enumerate().skip(i + 1) {
            let name = |k: &usize| format!("body `{}`", shells[*k].0);
            let (inner, outer) = match union::meeting(&solid[i], &solid[j]) {
                Ok(union::Meeting::Within) => (a, b),
                Ok(union::Meeting::Around) => (b, a),
                Ok(union::Meeting::Touching) if touch(&shells[*a], &shells[*b]) => {
                    let what = format!("touches {} without overlapping it", name(b));
                    return Err(GeometryError::refused(name(a), what, "move them apart, or into one another"));
                }
                _ => continue,
            };
            let what = format!("lies inside {}, or is the same", name(outer));
            return Err(GeometryError::refused(name(inner), what, "remove it: no gas reaches it"));
        }
    }
    let united = match union::united(&solid.iter().collect::<Vec<_>>()) {
        Ok(united) => united,
        Err(why) => return refused(format!("meets body {}: {why}", others.join(", ")), "unite them before the export"),
    };
    if let Some(k) = (0..group.len()).find(|k| !united.owner.contains(&(*k as u16))) {
        let what = format!("body `{}` lies inside other bodies", shells[group[k]].0);
        return refused(what, "remove it: no gas reaches it");
    }
    notes.push(format!("bodies `{name}` and {} intersect: they are clipped there and closed", others.join(", ")));
    let owner = united.owner.iter().map(|k| group[usize::from(*k)] as u16).collect();
    let shell = united.shell.cast().unwrap_or_else(|| shell.clone());
    Ok(Skin { shell, owner })
}

fn load_shell(name: &str, body: &Body, folder: &Path, notes: &mut Vec<String>) -> Result<AnyShell, GeometryError> {
    let place = format!("body `{name}`");
    Ok(match &body.shape {
        Shape::Naca(naca) => AnyShell::Plane(naca::shell(naca)?),
        Shape::Airfoil(file) => {
            AnyShell::Plane(airfoil::read(file, opened(folder, file, airfoil::LONGEST)?, body.placement.scale, notes)?)
        }
        Shape::Polygon(points) => {
            let points: Vec<Vector<2>> = points.iter().map(|p| Vector(*p)).collect();
            AnyShell::Plane(outline::polygon(&place, &points, POLYGON_CREASE, notes)?)
        }
        Shape::Circle { radius } => AnyShell::Plane(primitive::circle(positive(&place, "radius", radius.0)?)),
        Shape::Ellipse { size: [a, b] } => {
            let (a, b) = (positive(&place, "size", a.0)?, positive(&place, "size", b.0)?);
            AnyShell::Plane(primitive::ellipse([0.5 * a, 0.5 * b]))
        }
        Shape::Sphere { radius } => AnyShell::Space(primitive::sphere(positive(&place, "radius", radius.0)?)),
        Shape::Box { size } => box_shell(&place, size, notes)?,
        Shape::Surface(file) => {
            let within = body.weld.map(|l| l.0 / body.placement.scale);
            let soup = mesh::read(file, opened(folder, file, mesh::LONGEST)?, notes)?;
            let shell = repair::shell(file, &soup, within, notes)?;
            notes.extend(shell.noise(&shell.joints()).map(|noise| noise.told(file, shell.crease)));
            AnyShell::Space(shell)
        }
        Shape::Wing(wing) => {
            let root = section_of(&wing.naca, &wing.airfoil, folder, notes);
            let tip = section_of(&wing.tip_naca, &wing.tip_airfoil, folder, notes);
            let (root, tip) = match (root, tip) {
                (Err(root), Err(tip)) => return Err(GeometryError::Several(vec![root, tip])),
                (root, tip) => (root?, tip?),
            };
            let root = root.ok_or_else(|| GeometryError::refused(&place, "a wing has no section", "add `naca`"))?;
            AnyShell::Space(loft::wing(&place, wing, [&root, tip.as_ref().unwrap_or(&root)])?)
        }
        Shape::Revolution { profile, sides } => {
            let points: Vec<Vector<2>> = profile.iter().map(|p| Vector(*p)).collect();
            AnyShell::Space(creased(*sides, |straight| loft::revolution(&outline::profile(&points, straight))))
        }
        Shape::Loft { stations, exponent, sides } => {
            AnyShell::Space(creased(*sides, |straight| loft::through(stations, *exponent, straight)))
        }
        Shape::Ellipsoid { size } => {
            let [a, b, c] = size.map(|l| positive(&place, "size", l.0));
            AnyShell::Space(loft::ellipsoid(primitive::sphere(1.0), [0.5 * a?, 0.5 * b?, 0.5 * c?]))
        }
    })
}

/// A rectangle of two sides, or a cuboid of three.
fn box_shell(place: &str, size: &[Length], notes: &mut Vec<String>) -> Result<AnyShell, GeometryError> {
    let size: Vec<f64> = size.iter().map(|l| positive(place, "size", l.0)).collect::<Result<_, _>>()?;
    match size[..] {
        [a, b] => {
            let corners = primitive::rectangle([a, b]);
            Ok(AnyShell::Plane(outline::polygon(place, &corners, POLYGON_CREASE, notes)?))
        }
        [a, b, c] => Ok(AnyShell::Space(primitive::cuboid([a, b, c]))),
        _ => {
            let what = format!("`size` has {} numbers", size.len());
            Err(GeometryError::refused(place, what, "give two (2-D) or three (3-D)"))
        }
    }
}

/// The section at one end of a wing, from its NACA designation or its file; `None` where neither is given.
fn section_of(
    naca: &Option<Naca>,
    file: &Option<String>,
    folder: &Path,
    notes: &mut Vec<String>,
) -> Result<Option<Shell<2>>, GeometryError> {
    match (naca, file) {
        (Some(naca), _) => naca::shell(naca).map(Some),
        (_, Some(file)) => {
            let outline = airfoil::read(file, opened(folder, file, airfoil::LONGEST)?, 1.0, notes)?;
            chord_line::section_of_wing(file, outline, notes).map(Some)
        }
        _ => Ok(None),
    }
}

/// Opens a file in `folder` that has at most so many bytes.
fn opened(folder: &Path, file: &str, most: u64) -> Result<File, GeometryError> {
    let opened = open_regular(&folder.join(file));
    let opened = opened.and_then(|opened| refuse_longer(&opened, most).map(|()| opened));
    opened.map_err(|source| GeometryError::Open { file: file.to_string(), source })
}

/// The shell that `make` returns for straight or smooth sides; every corner between straight sides is sharp.
fn creased(sides: ProfileSides, make: impl Fn(bool) -> Shell<3>) -> Shell<3> {
    match sides {
        ProfileSides::Smooth => make(false),
        ProfileSides::Straight => Shell { crease: POLYGON_CREASE, ..make(true) },
    }
}

/// The text of a coordinate file, with all line ends converted to `\n`.
fn plain(file: &str, bytes: &[u8]) -> Result<String, GeometryError> {
    let broken = |_| GeometryError::refused(file, "is broken UTF-16 text", "save it as UTF-8 or ASCII text");
    numbers_of(bytes).map_err(broken).map(|text| text.replace("\r\n", "\n").replace('\r', "\n"))
}

fn positive(place: &str, key: &str, value: f64) -> Result<f64, GeometryError> {
    if 0.0 < value && value < 1e50 {
        return Ok(value);
    }
    Err(GeometryError::refused(place, format!("`{key}` is {value}"), "use a positive length"))
}

/// Rejects overlapping or touching bodies in 2-D; the error names all pairs.
fn refuse_overlap<const D: usize>(shells: &[(String, Shell<D>)]) -> Result<(), GeometryError> {
    let boxes: Vec<Bounds<D>> = shells.iter().map(|(_, shell)| Bounds::around(&shell.vertices)).collect();
    let near = |[a, b]: &[usize; 2]| {
        let margin = TOUCHING * boxes[*a].extent().max_abs().max(boxes[*b].extent().max_abs());
        boxes[*a].meets(&boxes[*b], margin)
    };
    let pairs = (0..shells.len()).flat_map(|a| (a + 1..shells.len()).map(move |b| [a, b]));
    let pairs: Vec<[usize; 2]> = pairs.filter(near).collect();
    if pairs.is_empty() {
        return Ok(());
    }
    let alone: Vec<Surface<D>> = shells.iter().map(|shell| Surface::new(std::slice::from_ref(shell))).collect();
    let within = |a: usize, b: usize| {
        let (other, touching) = (&shells[a].1.vertices, TOUCHING * alone[b].bounds().extent().max_abs());
        let meets = |x: &&Vector<D>| alone[b].nearest(x, touching).is_some();
        other.first().filter(|x| alone[b].inside(x)).or_else(|| other.iter().find(meets)).copied()
    };
    let crossed = Surface::new(shells).intersection().is_some();
    let crossing = |a: usize, b: usize| {
        let two = Surface::new(&[shells[a].clone(), shells[b].clone()]);
        two.intersection().map(|(x, _)| x)
    };
    let meeting = |[a, b]: [usize; 2]| {
        let x = within(a, b).or_else(|| within(b, a)).or_else(|| if crossed { crossing(a, b) } else { None })?;
        let [a, b] = [a, b].map(|k| &shells[k].0);
        Some((format!("body `{a}`"), format!("overlaps or touches body `{b}` at {x}")))
    };
    let mut found = pairs.into_iter().filter_map(meeting);
    let Some((place, mut what)) = found.next() else { return Ok(()) };
    found.for_each(|(place, more)| what.push_str(&format!("; {place} {more}")));
    Err(GeometryError::refused(place, what, "move the bodies apart, or unite them in one outline"))
}

/// True when two bodies overlap or touch.
fn touch<const D: usize>(a: &(String, Shell<D>), b: &(String, Shell<D>)) -> bool {
    let [a, b] = [a, b].map(|body| Surface::new(std::slice::from_ref(body)));
    a.meets(&b)
}

/// Groups of bodies that overlap or touch, directly or through others.
fn meeting<const D: usize>(shells: &[(String, Shell<D>)]) -> Vec<Vec<usize>> {
    let mut group: Vec<u32> = (0..shells.len() as u32).collect();
    let alone: Vec<Surface<D>> = shells.iter().map(|body| Surface::new(std::slice::from_ref(body))).collect();
    for a in 0..shells.len() {
        for b in (a + 1..shells.len()).filter(|b| alone[a].meets(&alone[*b])) {
            shell::unite(&mut group, a as u32, b as u32);
        }
    }
    let roots: Vec<u32> = (0..shells.len()).map(|k| shell::root(&mut group, k as u32)).collect();
    let of = |k: usize| (0..shells.len()).filter(|i| roots[*i] == k as u32).collect::<Vec<_>>();
    (0..shells.len()).map(of).filter(|members| !members.is_empty()).collect()
}

impl AnyShell {
    /// The shell, if it is two-dimensional.
    fn plane(&self) -> Option<&Shell<2>> {
        if let Self::Plane(shell) = self { Some(shell) } else { None }
    }

    /// The shell, if its dimension is `D`.
    fn in_dimension<const D: usize>(self) -> Option<Shell<D>> {
        match self {
            Self::Plane(shell) => shell.cast(),
            Self::Space(shell) => shell.cast(),
        }
    }
}
