//! Reference tables: comma-separated values under `#` lines that name their source.
//!
//! The first line that is neither blank nor starts with `#` names the columns. Numbers and words may be mixed: words select
//! rows (`surface = upper`), numbers form curves.

/// Why a reference table cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TableError {
    /// Nothing but comments.
    #[error("table has no line of column names\nhint: put names such as `x_c,Cp` above the numbers")]
    Empty,
    /// A line with another number of fields than there are names.
    #[error("line {line} has {found} fields, the header names {expected}\nhint: correct this line")]
    Fields {
        /// Line in the file, from one.
        line: usize,
        /// Fields on the line.
        found: usize,
        /// Fields of the header.
        expected: usize,
    },
    /// A column that is not there.
    #[error("table has no column `{name}`, only {names}\nhint: rename a column")]
    Column {
        /// The name asked for.
        name: String,
        /// Names of the header.
        names: String,
    },
    /// A field that is not a number.
    #[error("column `{name}` holds `{field}`, not a number\nhint: correct this field")]
    Number {
        /// Column.
        name: String,
        /// Field.
        field: String,
    },
    /// Too few rows for a curve.
    #[error("curve has {points} points, needs 2\nhint: add rows or relax the selection")]
    Short {
        /// Rows selected.
        points: usize,
    },
}

/// A table of named columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// Points (x, y) in rising order of x, joined by straight lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Table {
    /// Reads a table.
    pub fn parse(text: &str) -> Result<Self, TableError> {
        let mut lines = text
            .lines()
            .enumerate()
            .map(|(i, line)| (i + 1, line.trim()))
            .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let fields = |line: &str| line.split(',').map(|f| f.trim().to_string()).collect::<Vec<_>>();
        let names = lines.next().map(|(_, line)| fields(line)).ok_or(TableError::Empty)?;
        let expected = names.len();
        let rows = lines
            .map(|(line, text)| {
                let row = fields(text);
                if row.len() == expected {
                    Ok(row)
                } else {
                    Err(TableError::Fields { line, found: row.len(), expected })
                }
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { names, rows })
    }

    /// The rows whose column `name` holds `value`; all rows when there is no such column.
    pub fn only(&self, name: &str, value: &str) -> Self {
        let rows = match self.position(name) {
            Some(k) => self.rows.iter().filter(|row| row[k] == value).cloned().collect(),
            None => self.rows.clone(),
        };
        Self { names: self.names.clone(), rows }
    }

    /// The texts of a column.
    pub fn text(&self, name: &str) -> Result<Vec<String>, TableError> {
        let Some(k) = self.position(name) else {
            return Err(TableError::Column { name: name.to_string(), names: self.names.join(", ") });
        };
        Ok(self.rows.iter().map(|row| row[k].clone()).collect())
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The numbers of column `name`.
    pub fn column(&self, name: &str) -> Result<Vec<f64>, TableError> {
        let k = self
            .position(name)
            .ok_or_else(|| TableError::Column { name: name.into(), names: format!("`{}`", self.names.join("`, `")) })?;
        self.rows
            .iter()
            .map(|row| row[k].parse().map_err(|_| TableError::Number { name: name.into(), field: row[k].clone() }))
            .collect()
    }

    /// Columns `x` and `y` as a curve.
    pub fn curve(&self, x: &str, y: &str) -> Result<Curve, TableError> {
        Curve::new(&self.column(x)?, &self.column(y)?)
    }

    fn position(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }
}

impl Curve {
    /// A curve through points in any order; points that are not finite are left out.
    pub fn new(x: &[f64], y: &[f64]) -> Result<Self, TableError> {
        let mut points: Vec<(f64, f64)> =
            x.iter().copied().zip(y.iter().copied()).filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if points.len() < 2 {
            return Err(TableError::Short { points: points.len() });
        }
        let (x, y) = points.into_iter().unzip();
        Ok(Self { x, y })
    }

    /// Abscissae, rising.
    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// Ordinates.
    pub fn y(&self) -> &[f64] {
        &self.y
    }

    /// The value at `x` by linear interpolation, the end values outside.
    pub fn at(&self, x: f64) -> f64 {
        let upper = self.x.partition_point(|a| *a <= x).clamp(1, self.x.len() - 1);
        let (x0, x1) = (self.x[upper - 1], self.x[upper]);
        let fraction = if x1 > x0 { ((x - x0) / (x1 - x0)).clamp(0.0, 1.0) } else { 0.0 };
        (1.0 - fraction) * self.y[upper - 1] + fraction * self.y[upper]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TEXT: &str =
        "# case\n# source\nsurface,x_c,Cp\nupper,1.0,0.2\nupper,0.0,1.0\nlower,0.5,-0.3\n\nlower,1.0,0.2\n";

    #[test]
    fn reads_columns_and_selects_rows() {
        let table = Table::parse(TEXT).unwrap();
        assert_eq!(table.len(), 4);
        let upper = table.only("surface", "upper").curve("x_c", "Cp").unwrap();
        assert_eq!((upper.at(0.25), upper.at(-1.0), upper.at(9.0)), (0.8, 1.0, upper.y()[1]));
        assert_eq!(table.only("side", "upper").len(), 4);
        assert!(matches!(table.column("Cq"), Err(TableError::Column { .. })));
        assert!(matches!(table.column("surface"), Err(TableError::Number { .. })));
    }

    #[test]
    fn reads_tables_of_linear_theory() {
        // two rows of reference/harmonics/possio_subsonic_flatplate.csv, some columns left out
        let text = "# Possio integral equation\n# Convention: e^{+i omega t}; b=c/2\naxis,a,M,k,cl_alpha_abs,cl_alpha_phase_deg\n\
                    quarter-chord,-0.5,0.5,0.1,5.825394482,-6.32886309\nquarter-chord,-0.5,0.5,0.3,4.781501324,8.707198056\n";
        let table = Table::parse(text).unwrap().only("axis", "quarter-chord").only("M", "0.5");
        let lift = table.curve("k", "cl_alpha_abs").unwrap();
        let phase = table.only("k", "0.3").column("cl_alpha_phase_deg").unwrap();
        assert_eq!((lift.at(0.1), phase[0]), (5.825394482, 8.707198056));
    }

    #[test]
    fn names_the_bad_line() {
        assert_eq!(Table::parse("# only\n"), Err(TableError::Empty));
        assert_eq!(Table::parse("a,b\n1,2\n1\n"), Err(TableError::Fields { line: 3, found: 1, expected: 2 }));
        assert!(Curve::new(&[1.0, f64::NAN], &[1.0, 2.0]).is_err());
        assert_eq!(Curve::new(&[1.0, 1.0], &[3.0, 3.0]).unwrap().at(1.0), 3.0);
    }

    proptest! {
        #[test]
        fn never_panics(text in "[#a-z0-9,.\\n -]{0,200}") {
            if let Ok(table) = Table::parse(&text) {
                let _ = table.curve("a", "b").map(|c| c.at(0.5));
            }
        }
    }
}
