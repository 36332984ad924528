//! What every iteration of a run leaves: a row of `history.csv`, and the same in memory.
use crate::case::Case;

/// Columns of every history.
const COLUMNS: [&str; 10] =
    ["cycle", "iteration", "time", "cfl", "residual", "cl", "cd", "cm", "seconds", "fluid_particles"];
/// More of them when something moves: iterations within the step, angle and displacement of the first body that moves.
const MOVING: [&str; 5] = ["inner", "angle_deg", "shift_x", "shift_y", "shift_z"];
/// One more when a body bends: the coordinate of the first mode of that body.
const BENDING: &str = "mode";
/// One more for a polar: the number of the point, from 1.
const POINT: &str = "point";

/// A column for each quantity, an entry for each iteration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IterationHistory {
    /// Names of the columns, as in `history.csv`.
    pub names: Vec<&'static str>,
    /// Their values, in the units of the case.
    pub columns: Vec<Vec<f64>>,
}

/// Part of the smallest residual that counts as a new one.
const PROGRESS: f64 = 0.98;

impl IterationHistory {
    /// An empty history with the columns of a case.
    pub(crate) fn of(case: &Case) -> Self {
        let moving = MOVING.into_iter().filter(|_| case.moves());
        let point = case.polar.as_ref().map(|_| POINT);
        let names: Vec<_> =
            COLUMNS.into_iter().chain(moving).chain(case.bends().then_some(BENDING)).chain(point).collect();
        Self { columns: vec![Vec::new(); names.len()], names }
    }

    /// The same with the rows of the text of a `history.csv` that has these columns.
    pub(crate) fn with_rows(mut self, text: &str) -> Self {
        for line in text.lines().skip(1) {
            let row: Vec<f64> = line.split(',').map(|v| v.parse().unwrap_or(f64::NAN)).collect();
            self.push(&row);
        }
        self
    }

    /// Adds an iteration.
    pub(crate) fn push(&mut self, row: &[f64]) {
        self.columns.iter_mut().zip(row).for_each(|(column, value)| column.push(*value));
    }

    /// The column of this name; `None` where the case has no such quantity.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let at = self.names.iter().position(|n| *n == name)?;
        Some(&self.columns[at])
    }

    /// Least and greatest lift, drag and moment of the last `n` iterations.
    pub(crate) fn last_loads(&self, n: usize) -> [[f64; 2]; 3] {
        ["cl", "cd", "cm"].map(|name| {
            let column = self.column(name).unwrap_or_default();
            let tail = &column[column.len().saturating_sub(n)..];
            tail.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(*v), h.max(*v)])
        })
    }

    /// Iterations since the residual was last smaller, by a fiftieth, than ever before among the last `n`.
    pub(crate) fn since_smallest(&self, n: usize) -> usize {
        let column = self.column("residual").unwrap_or_default();
        let tail = &column[column.len().saturating_sub(n)..];
        let (mut best, mut since) = (f64::INFINITY, 0);
        for residual in tail {
            (best, since) = if *residual < PROGRESS * best { (*residual, 0) } else { (best, since + 1) };
        }
        since
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_residual_that_swings_finds_no_new_smallest_value() {
        let mut history =
            IterationHistory::of(&crate::case::read("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n", "t").unwrap());
        let place = history.names.iter().position(|n| *n == "residual").unwrap();
        for residual in [1e-9, 1.0, 0.5, 0.2, 0.3, 0.199, 0.4] {
            let row: Vec<f64> = (0..history.names.len()).map(|k| if k == place { residual } else { 0.0 }).collect();
            history.push(&row);
        }
        assert_eq!([6, 7, 1].map(|n| history.since_smallest(n)), [3, 6, 0]);
    }

    #[test]
    fn rows_of_a_file_and_of_a_run_are_the_same() {
        let case = crate::case::read("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n", "t").unwrap();
        let mut history = IterationHistory::of(&case);
        history.push(&[0.0, 1.0, 0.0, 5.0, 1.0, 0.1, 0.2, 0.3, 0.5, 99.0]);
        let text = format!("{}\n0,1,0,5,1,0.1,0.2,0.3,0.5,99\n", history.names.join(","));
        assert_eq!(IterationHistory::of(&case).with_rows(&text), history);
        assert_eq!(history.column("cl"), Some(&[0.1][..]));
        assert_eq!(history.column("angle_deg"), None);
    }
}
