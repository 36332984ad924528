//! Closed parts of one file: overlapping parts are united, and parts inside others are removed.
//!
//! A part consists of the triangles that are connected across edges with two triangles. Parts that share a volume, or a
//! piece of wall, are clipped at their intersection and united ([`super::union`]), so that their walls bound one
//! volume. A part inside another one with the same orientation is not reached by the gas. A part with the opposite
//! orientation is a cavity or the room around a model, which only the user can decide.
use super::GeometryError;
use super::shell::{Exact, Shell, at, facets, root, unite};
use super::surface::Surface;
use super::union::{self, Meeting};
use crate::math::Bounds;
use std::collections::BTreeMap;

/// Smallest volume of a part relative to its area to the power 3/2; a plate a hundred thousand times as long as thick
/// has 4e-6.
const THINNEST: f64 = 1e-9;
/// Greatest number of parts that a message names.
const NAMED: usize = 4;
/// Name of solids and groups without a name.
pub(super) const UNNAMED: &str = "unnamed";

/// A closed part.
struct Part {
    shell: Shell<3>,
    surface: Surface<3>,
    name: String,
    /// Its triangles in the shell of the file.
    members: Vec<usize>,
    /// True when it was oriented inward in the file.
    inward: bool,
}

/// The walls of the volume that the parts of `shell` enclose together; `inward` marks triangles of parts that were
/// oriented inward.
pub(super) fn settle(
    file: &str,
    shell: Shell<3>,
    inward: &[bool],
    notes: &mut Vec<String>,
) -> Result<Shell<3>, GeometryError> {
    let parts = parts(&shell, inward);
    for part in &parts {
        refuse_sheet(file, part)?;
        refuse_crossing(file, part)?;
    }
    let mut left_out = vec![false; parts.len()];
    let mut group: Vec<u32> = (0..parts.len() as u32).collect();
    for (a, b) in meeting(&parts) {
        if left_out[a] || left_out[b] {
            continue;
        }
        match stand(file, &parts[a], &parts[b])? {
            Meeting::Within => left_out[inside(file, [&parts[a], &parts[b]], [a, b], notes)?] = true,
            Meeting::Around => left_out[inside(file, [&parts[b], &parts[a]], [b, a], notes)?] = true,
            Meeting::Overlapping | Meeting::Joined => unite(&mut group, a as u32, b as u32),
            Meeting::Touching => {}
        }
    }
    let mut groups: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for k in (0..parts.len()).filter(|k| !left_out[*k]) {
        groups.entry(root(&mut group, k as u32)).or_default().push(k);
    }
    let (single, several): (Vec<_>, Vec<_>) = groups.into_values().partition(|g| g.len() == 1);
    if several.is_empty() && !left_out.contains(&true) {
        return Ok(shell);
    }
    let mut alone: Vec<usize> = single.iter().flatten().flat_map(|k| parts[*k].members.iter().copied()).collect();
    alone.sort_unstable();
    let mut all = subset(&shell, &alone);
    for group in &several {
        let members: Vec<&Part> = group.iter().map(|k| &parts[*k]).collect();
        all = joined(all, united(file, &members, notes)?);
    }
    Ok(all)
}

/// Relative position of two parts that intersect.
fn stand(file: &str, a: &Part, b: &Part) -> Result<Meeting, GeometryError> {
    let hint = "unite the parts before the export";
    let refused = |what: String| GeometryError::refused(file, what, hint);
    let found = union::meeting(&a.shell, &b.shell)
        .map_err(|why| refused(format!("{} and {} intersect: {why}", a.name, b.name)))?;
    match a.surface.crossing(&b.surface) {
        Some(x) if found == Meeting::Touching => {
            Err(refused(format!("{} touches {} without overlapping it at {}", a.name, b.name, at(&x))))
        }
        _ => Ok(found),
    }
}

/// Index of the inner of two parts, which is removed; rejects a cavity.
fn inside(
    file: &str,
    [inner, outer]: [&Part; 2],
    [number, _]: [usize; 2],
    notes: &mut Vec<String>,
) -> Result<usize, GeometryError> {
    let (name, around) = (&inner.name, &outer.name);
    if inner.inward != outer.inward {
        let what =
            format!("{name} lies inside {around} and faces the other way: it is a cavity, or a room around a model");
        let hint = "keep only the walls that the stream reaches: remove inner walls and cavities before the export";
        return Err(GeometryError::refused(file, what, hint));
    }
    notes.push(format!("{file}: {name} lies inside {around}, where no gas reaches it: it is left out"));
    Ok(number)
}

/// Rejects a part that encloses no volume: a folded sheet.
fn refuse_sheet(file: &str, part: &Part) -> Result<(), GeometryError> {
    if part.surface.volume() > THINNEST * part.surface.area().powf(1.5) {
        return Ok(());
    }
    let what = format!("{} bounds no volume", part.name);
    Err(GeometryError::refused(file, what, "give sheets a thickness, or remove them"))
}

/// Rejects a self-intersecting part.
fn refuse_crossing(file: &str, part: &Part) -> Result<(), GeometryError> {
    let Some((x, [e, f])) = part.surface.intersection() else { return Ok(()) };
    let shell = &part.shell;
    let tag = |e: u32| shell.tags.get(e as usize).and_then(|&t| shell.tag_names.get(usize::from(t)));
    let what = match (tag(e), tag(f)) {
        (Some(a), Some(b)) if a != b => format!("`{a}` and `{b}` intersect"),
        _ => "the surface crosses itself".to_owned(),
    };
    let hint = "mend it before the export; parts that overlap are united where each is closed by itself";
    Err(GeometryError::refused(file, format!("{what} at {}", at(&x)), hint))
}

/// Pairs of parts that overlap or touch.
fn meeting(parts: &[Part]) -> Vec<(usize, usize)> {
    let pairs = (0..parts.len()).flat_map(|a| (a + 1..parts.len()).map(move |b| (a, b)));
    pairs.filter(|&(a, b)| parts[a].surface.meets(&parts[b].surface)).collect()
}

/// The walls of the volume that overlapping parts enclose together.
fn united(file: &str, parts: &[&Part], notes: &mut Vec<String>) -> Result<Shell<3>, GeometryError> {
    let shells: Vec<&Shell<3>> = parts.iter().map(|p| &p.shell).collect();
    let names = listed(parts.iter().map(|p| p.name.as_str()));
    let united = union::united(&shells).map_err(|why| {
        GeometryError::refused(file, format!("{names} overlap: {why}"), "unite the parts before the export")
    })?;
    notes.push(format!("{file}: {names} overlap: they are clipped there and closed"));
    for (_, part) in parts.iter().enumerate().filter(|(k, _)| !united.owner.contains(&(*k as u16))) {
        notes.push(format!("{file}: {} lies inside the others, where no gas reaches it: it is left out", part.name));
    }
    Ok(united.shell)
}

/// A list of names, truncated after a few.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    let (last, more) = (names.len().min(NAMED) - 1, names.len().saturating_sub(NAMED));
    let told = format!("{} and {}", names[..last].join(", "), names[last]);
    if more > 0 { format!("{}, {} and {more} others", names[..last].join(", "), names[last]) } else { told }
}

/// The closed parts of a shell, in the order of their first triangles.
fn parts(shell: &Shell<3>, inward: &[bool]) -> Vec<Part> {
    let mut of_part: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (e, first) in shell.edge_connected(&facets(&shell.elements)).into_iter().enumerate() {
        of_part.entry(first).or_default().push(e);
    }
    let several = of_part.len() > 1;
    let part = |(k, members): (usize, Vec<usize>)| {
        let own = if several { subset(shell, &members) } else { shell.clone() };
        let surface = Surface::new(&[(String::new(), own.clone())]);
        let name = name(&own, k + 1);
        Part { surface, name, inward: inward.get(members[0]).copied().unwrap_or(false), shell: own, members }
    };
    let mut parts: Vec<Part> = of_part.into_values().enumerate().map(part).collect();
    let mut times: BTreeMap<String, usize> = BTreeMap::new();
    parts.iter().for_each(|part| *times.entry(part.name.clone()).or_default() += 1);
    for (k, part) in parts.iter_mut().enumerate().filter(|(_, part)| times[&part.name] > 1) {
        part.name = by_place(&part.shell, k + 1);
    }
    parts
}

/// Name of a part: that of its solid or group if it is unique, otherwise its number and position.
fn name(part: &Shell<3>, number: usize) -> String {
    let first = part.tags.first().filter(|t| part.tags.iter().all(|u| u == *t));
    match first.and_then(|t| part.tag_names.get(usize::from(*t))) {
        Some(name) if name != UNNAMED => format!("`{name}`"),
        _ => by_place(part, number),
    }
}

fn by_place(part: &Shell<3>, number: usize) -> String {
    format!("part {number} around {}", at(&Bounds::around(&part.vertices).centre()))
}

/// A shell of some triangles and their vertices, without normals.
fn subset(shell: &Shell<3>, members: &[usize]) -> Shell<3> {
    let elements = members.iter().map(|e| shell.elements[*e]).collect();
    let (vertices, elements) = union::compact(&shell.vertices, elements);
    Shell {
        vertices,
        elements,
        normals: None,
        curvature: None,
        tags: members.iter().filter_map(|e| shell.tags.get(*e).copied()).collect(),
        tag_names: shell.tag_names.clone(),
        exact: Exact::None,
        crease: shell.crease,
    }
}

/// Two shells combined to one.
fn joined(a: Shell<3>, b: Shell<3>) -> Shell<3> {
    let (first, second) = (a.features(), b.features());
    let mut all = a;
    let moved = all.vertices.len() as u32;
    let mut number = |name: &String| {
        all.tag_names.iter().position(|n| n == name).unwrap_or_else(|| {
            all.tag_names.push(name.clone());
            all.tag_names.len() - 1
        }) as u16
    };
    let numbers: Vec<u16> = b.tag_names.iter().map(&mut number).collect();
    all.tags.extend(b.tags.iter().map(|t| numbers[usize::from(*t)]));
    all.vertices.extend(b.vertices);
    all.elements.extend(b.elements.iter().map(|e| e.map(|v| v + moved)));
    all.normals = Some([first.normals, second.normals].concat());
    all.curvature = Some([first.curvature, second.curvature].concat());
    all
}
