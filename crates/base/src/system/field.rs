//! Fields of a state: their names, and the ranges of their unknowns and rows.
use std::borrow::Cow;
use std::fmt;
use std::ops::Range;

/// Name of a field, which says what its unknowns are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Name {
    /// Density, momentum and energy of the gas.
    Gas,
    /// Turbulence variables of the gas.
    Turbulence,
    /// Coordinates of elastically supported bodies, each with its rate.
    Structure,
    /// Displacements and velocities of solids, which consist of particles.
    Solid,
    /// Internal variables of materials, which change only when a step is accepted.
    History,
    /// Any other field, with its own name.
    Other(&'static str),
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Gas => "gas",
            Self::Turbulence => "turbulence",
            Self::Structure => "structure",
            Self::Solid => "solid",
            Self::History => "history",
            Self::Other(word) => word,
        })
    }
}

/// A field: unknowns of one kind, stored as `rows` rows of `block` values each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name of the field.
    pub name: Name,
    /// Name of the field whose particles the unknowns belong to. It differs from `name` if the unknowns are stored on
    /// the cloud of another field, which then has the same number of rows.
    pub cloud: Name,
    /// Number of rows: particles of a cloud or coordinates of a structure.
    pub rows: usize,
    /// Number of unknowns of a row; the values of all instances of a period follow one another.
    pub block: usize,
    /// Number of leading unknowns of a row (and instance) that enter the norm of a residual: for a gas, the density
    /// represents all conserved variables.
    pub measured: usize,
    /// Number of time instances that a row holds; 1 unless the solution is periodic in time.
    pub instances: usize,
}

impl Field {
    /// A field whose residual norm includes all its unknowns.
    pub const fn new(name: Name, rows: usize, block: usize) -> Self {
        Self { name, cloud: name, rows, block, measured: block, instances: 1 }
    }

    /// This field, stored on the cloud of the field `cloud`.
    pub const fn on(self, cloud: Name) -> Self {
        Self { cloud, ..self }
    }

    /// This field with a residual norm that includes only the first `measured` unknowns of each row.
    pub const fn measured_by(self, measured: usize) -> Self {
        Self { measured, ..self }
    }

    /// This field at `count` instances of a period.
    pub const fn at_instances(self, count: usize) -> Self {
        Self { block: self.block * count, instances: self.instances * count, ..self }
    }

    /// Number of unknowns.
    pub const fn len(&self) -> usize {
        self.rows * self.block
    }

    /// True if the field has no unknowns.
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A field with the ranges of its unknowns and rows in the whole state.
#[derive(Clone, Debug)]
pub struct Placed {
    /// The field itself.
    pub field: Field,
    /// Range of its unknowns in the state.
    pub unknowns: Range<usize>,
    /// Range of its rows among all rows.
    pub rows: Range<usize>,
}

/// Fields with their ranges, one after another in the order of the state.
pub fn placed(fields: &[Field]) -> impl Iterator<Item = Placed> + '_ {
    let (mut unknown, mut row) = (0, 0);
    fields.iter().map(move |field| {
        let placed = Placed { field: *field, unknowns: unknown..unknown + field.len(), rows: row..row + field.rows };
        (unknown, row) = (placed.unknowns.end, placed.rows.end);
        placed
    })
}

/// Number of unknowns of all fields.
pub fn unknowns(fields: &[Field]) -> usize {
    fields.iter().map(Field::len).sum()
}

/// Number of rows of all fields.
pub fn rows(fields: &[Field]) -> usize {
    fields.iter().map(|f| f.rows).sum()
}

/// Range of the unknowns of the field `name` in the state; empty if there is no such field.
pub fn unknowns_of(fields: &[Field], name: Name) -> Range<usize> {
    placed(fields).find(|at| at.field.name == name).map_or(0..0, |at| at.unknowns)
}

/// Range of the rows of the field `name` among all rows; empty if there is no such field.
pub fn rows_of(fields: &[Field], name: Name) -> Range<usize> {
    placed(fields).find(|at| at.field.name == name).map_or(0..0, |at| at.rows)
}

/// A subset of the unknowns of a state, as ranges in the order of the state.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ranges(Vec<Range<usize>>);

impl Ranges {
    /// The empty subset.
    pub const NONE: &'static Self = &Self(Vec::new());

    /// Unknowns of the fields with the given names.
    pub fn of_fields(fields: &[Field], names: &[Name]) -> Self {
        let mut all: Vec<Range<usize>> = Vec::new();
        for at in placed(fields).filter(|at| names.contains(&at.field.name) && !at.unknowns.is_empty()) {
            match all.last_mut() {
                Some(last) if last.end == at.unknowns.start => last.end = at.unknowns.end,
                _ => all.push(at.unknowns),
            }
        }
        Self(all)
    }

    /// Corresponding ranges in a state that holds `count` instances of a period.
    pub fn at_instances(&self, count: usize) -> Self {
        Self(self.0.iter().map(|r| r.start * count..r.end * count).collect())
    }

    /// Number of unknowns in the subset.
    pub fn len(&self) -> usize {
        self.0.iter().map(Range::len).sum()
    }

    /// True if the subset is empty.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// True if the subset contains every index of `range`.
    pub fn contain(&self, range: &Range<usize>) -> bool {
        !range.is_empty() && self.0.iter().any(|r| r.start <= range.start && range.end <= r.end)
    }

    /// Values of the subset in the state `u`, one range after another; empty if the state is empty.
    pub fn values<'a>(&self, u: &'a [f64]) -> Cow<'a, [f64]> {
        let of = |r: &Range<usize>| u.get(r.clone()).unwrap_or_default();
        match &self.0[..] {
            [] => Cow::Borrowed(&[]),
            [one] => Cow::Borrowed(of(one)),
            several => Cow::Owned(several.iter().flat_map(|r| of(r).iter().copied()).collect()),
        }
    }

    /// Sets the unknowns of the subset in the state `u` to `values`.
    pub fn set(&self, values: &[f64], u: &mut [f64]) {
        let mut rest = values;
        for r in &self.0 {
            let (own, after) = rest.split_at(r.len());
            u[r.clone()].copy_from_slice(own);
            rest = after;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields() -> Vec<Field> {
        vec![
            Field::new(Name::Gas, 10, 4),
            Field::new(Name::Structure, 2, 2),
            Field::new(Name::Turbulence, 10, 1).on(Name::Gas),
            Field::new(Name::Solid, 3, 4),
            Field::new(Name::History, 3, 5).on(Name::Solid),
        ]
    }

    #[test]
    fn fields_are_found_by_name() {
        let all = fields();
        assert_eq!(
            [Name::Gas, Name::Structure, Name::Turbulence].map(|n| unknowns_of(&all, n)),
            [0..40, 40..44, 44..54]
        );
        assert_eq!(rows_of(&all, Name::History), 25..28);
        assert_eq!(unknowns_of(&all[..1], Name::Solid), 0..0);
        let same_cloud = |f: &&Field| rows_of(&all, f.cloud).len() == f.rows;
        assert_eq!(all.iter().filter(same_cloud).count(), all.len());
    }

    #[test]
    fn ranges_need_not_follow_one_another() {
        let all = fields();
        let places = Ranges::of_fields(&all, &[Name::Structure, Name::Solid]);
        let u: Vec<f64> = (0..unknowns(&all)).map(|k| k as f64).collect();
        let values = places.values(&u).into_owned();
        assert_eq!((places.len(), values[3], values[4]), (16, 43.0, 54.0));
        let mut back = vec![-1.0; u.len()];
        places.set(&values, &mut back);
        assert!(
            back.iter()
                .zip(&u)
                .enumerate()
                .all(|(k, (b, u))| *b == if places.contain(&(k..k + 1)) { *u } else { -1.0 })
        );
        assert!(matches!(Ranges::of_fields(&all, &[Name::Solid, Name::History]).values(&u), Cow::Borrowed(_)));
        assert_eq!(places.at_instances(3).len(), 48);
    }
}
