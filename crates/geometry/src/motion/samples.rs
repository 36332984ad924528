//! Motion tables: displacements and angles at given times.
use std::f64::consts::PI;

use crate::case::{MotionTable, separator};

/// Columns of a motion table.
#[derive(Debug, Default)]
pub(super) struct Samples {
    pub(super) time: Vec<f64>,
    /// Displacements along x, y, z.
    pub(super) shift: [Option<Vec<f64>>; 3],
    /// Angles [rad].
    pub(super) angle: Option<Vec<f64>>,
}

impl Samples {
    /// The lists of a case as a table.
    pub(super) fn of(table: &MotionTable) -> Self {
        let lengths = |list: &Option<Vec<crate::case::Length>>| list.as_ref().map(|l| l.iter().map(|x| x.0).collect());
        Self {
            time: table.time.iter().flatten().map(|t| t.0).collect(),
            shift: [lengths(&table.x), lengths(&table.y), lengths(&table.z)],
            angle: table.angle.as_ref().map(|l| l.iter().map(|x| x.0).collect()),
        }
    }

    /// Parses a text with a header; columns are separated by commas, semicolons or tabs; lines that start with `#` are
    /// comments.
    pub(super) fn parse(text: &str, periodic: bool, dimension: usize) -> Result<Self, String> {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .delimiter(separator(text) as u8)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let header = reader.headers().map_err(|e| e.to_string())?.clone();
        let mut columns = vec![Vec::new(); header.len()];
        for row in reader.records() {
            let row = row.map_err(|e| e.to_string())?;
            for (column, cell) in columns.iter_mut().zip(&row) {
                let value = cell.parse::<f64>().ok().filter(|x| x.is_finite());
                column.push(value.ok_or_else(|| no_number(cell, &row))?);
            }
        }
        let mut samples = Self::default();
        for (name, column) in header.iter().zip(columns) {
            let degrees = |c: Vec<f64>| Some(c.iter().map(|a| a * PI / 180.0).collect());
            match name {
                "time" => samples.time = column,
                "x" => samples.shift[0] = Some(column),
                "y" => samples.shift[1] = Some(column),
                "z" if dimension == 3 => samples.shift[2] = Some(column),
                "angle_rad" if samples.angle.is_none() => samples.angle = Some(column),
                "angle_deg" if samples.angle.is_none() => samples.angle = degrees(column),
                other => return Err(format!("column `{other}` has no meaning here")),
            }
        }
        samples.checked(periodic)
    }

    fn checked(self, periodic: bool) -> Result<Self, String> {
        if self.time.len() < 2 {
            return Err("it needs a column `time` of two or more rows".to_owned());
        }
        if let Some(w) = self.time.windows(2).find(|w| w[1] <= w[0]) {
            return Err(format!("times do not rise: {} is followed by {}", w[0], w[1]));
        }
        let columns: Vec<&Vec<f64>> = self.shift.iter().chain([&self.angle]).flatten().collect();
        if columns.is_empty() {
            return Err("nothing moves".to_owned());
        }
        if periodic && columns.iter().any(|c| c.first() != c.last()) {
            return Err("it is periodic, but its last row differs from its first".to_owned());
        }
        Ok(self)
    }
}

/// Message about a cell that is not a number.
fn no_number(cell: &str, row: &csv::StringRecord) -> String {
    let line = row.position().map_or_else(String::new, |p| format!("line {}: ", p.line()));
    let comma = cell.replacen(',', ".", 1).parse::<f64>().is_ok();
    let why = if comma { "has a decimal comma: write decimals with a point" } else { "is not a number" };
    format!("{line}`{cell}` {why}")
}
