//! Fields: what the unknowns of a state are, by name, and where they stand in it.
use std::borrow::Cow;
use std::fmt;
use std::ops::Range;

/// What the unknowns of a field are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Name {
    /// Density, momentum and energy of the gas.
    Gas,
    /// Turbulence of the gas.
    Turbulence,
    /// Coordinates of bodies on springs, each with its rate.
    Structure,
    /// Displacements and velocities of bodies made of particles.
    Solid,
    /// What materials remember: it changes at the ends of steps alone.
    History,
    /// Something else, by its own word.
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

/// Unknowns of one kind: `rows` rows of `block` values each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// What they are.
    pub name: Name,
    /// The field whose particles they belong to: itself, unless they live on the cloud of another one, which has as many rows.
    pub cloud: Name,
    /// Rows: particles of a cloud, coordinates of a structure.
    pub rows: usize,
    /// Unknowns of a row, those of all instances of a period one after another.
    pub block: usize,
    /// How many of the unknowns of a row (and instance), the first ones, measure the size of a residual: the density of a gas
    /// stands for all.
    pub measured: usize,
    /// Instances of a period that a row holds; one unless the solution is periodic in time.
    pub instances: usize,
}

impl Field {
    /// A field whose residual is measured by all its unknowns.
    pub const fn new(name: Name, rows: usize, block: usize) -> Self {
        Self { name, cloud: name, rows, block, measured: block, instances: 1 }
    }

    /// The same on the cloud of another field.
    pub const fn on(self, cloud: Name) -> Self {
        Self { cloud, ..self }
    }

    /// The same, measured by the first `measured` unknowns of each row.
    pub const fn measured_by(self, measured: usize) -> Self {
        Self { measured, ..self }
    }

    /// The same at a number of instances of a period.
    pub const fn at_instances(self, count: usize) -> Self {
        Self { block: self.block * count, instances: self.instances * count, ..self }
    }

    /// Unknowns.
    pub const fn len(&self) -> usize {
        self.rows * self.block
    }

    /// True when there are none.
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A field with the place of its unknowns and rows among those of all fields.
#[derive(Clone, Debug)]
pub struct Placed {
    /// The field.
    pub field: Field,
    /// Its unknowns in the state.
    pub unknowns: Range<usize>,
    /// Its rows among all rows.
    pub rows: Range<usize>,
}

/// The fields one after another, as the state holds them.
pub fn placed(fields: &[Field]) -> impl Iterator<Item = Placed> + '_ {
    let (mut unknown, mut row) = (0, 0);
    fields.iter().map(move |field| {
        let placed = Placed { field: *field, unknowns: unknown..unknown + field.len(), rows: row..row + field.rows };
        (unknown, row) = (placed.unknowns.end, placed.rows.end);
        placed
    })
}

/// Unknowns of all fields.
pub fn unknowns(fields: &[Field]) -> usize {
    fields.iter().map(Field::len).sum()
}

/// Rows of all fields.
pub fn rows(fields: &[Field]) -> usize {
    fields.iter().map(|f| f.rows).sum()
}

/// Unknowns of the field `name` in the state; empty where there is none.
pub fn unknowns_of(fields: &[Field], name: Name) -> Range<usize> {
    placed(fields).find(|at| at.field.name == name).map_or(0..0, |at| at.unknowns)
}

/// Rows of the field `name` among all rows; empty where there is none.
pub fn rows_of(fields: &[Field], name: Name) -> Range<usize> {
    placed(fields).find(|at| at.field.name == name).map_or(0..0, |at| at.rows)
}

/// Some of the unknowns of a state, range by range in the order of the state.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ranges(Vec<Range<usize>>);

impl Ranges {
    /// None.
    pub const NONE: &'static Self = &Self(Vec::new());

    /// Those of the fields with these names.
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

    /// The same in a state that holds a number of instances of a period.
    pub fn at_instances(&self, count: usize) -> Self {
        Self(self.0.iter().map(|r| r.start * count..r.end * count).collect())
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.0.iter().map(Range::len).sum()
    }

    /// True when there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// True where all of `range` are among them.
    pub fn contain(&self, range: &Range<usize>) -> bool {
        !range.is_empty() && self.0.iter().any(|r| r.start <= range.start && range.end <= r.end)
    }

    /// Their values in the state `u`, one range after another; none in an empty state.
    pub fn values<'a>(&self, u: &'a [f64]) -> Cow<'a, [f64]> {
        let of = |r: &Range<usize>| u.get(r.clone()).unwrap_or_default();
        match &self.0[..] {
            [] => Cow::Borrowed(&[]),
            [one] => Cow::Borrowed(of(one)),
            several => Cow::Owned(several.iter().flat_map(|r| of(r).iter().copied()).collect()),
        }
    }

    /// Gives them `values` in the state `u`.
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
