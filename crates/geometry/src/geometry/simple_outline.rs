//! Outlines that run exactly once around a body without overlapping themselves.
//!
//! The turning angles of such an outline sum to 360 deg (counter-clockwise) or −360 deg (H. Hopf, *Compositio
//! Mathematica* 2, 1935). A list of points that runs around twice has a sum of 720 deg although its sides cross
//! nowhere: they coincide. The loads on it would be twice those of the body.
use super::GeometryError;
use super::marks::{Mark, SAME, at, extent, straight_shell};
use super::surface::Surface;
use std::f64::consts::PI;

/// Difference of a turning angle from 180 deg below which its sign is undetermined, because the outline reverses there.
const BACK: f64 = 1e-9;
/// Round-off of a sum of turning angles (rad).
const ROUNDING: f64 = 1e-6;

/// Treatment of coinciding sides of opposite direction, which occur at thin trailing edges in files of few digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Opposite {
    Allowed,
    Refused,
}

/// Removes repetitions of the first round, which has at least `fewest` points, from a closed outline, and reports them.
pub(super) fn drop_further_rounds(name: &str, marks: &mut Vec<Mark>, fewest: usize, notes: &mut Vec<String>) {
    let n = marks.len();
    let points: Vec<_> = marks.iter().map(|m| m.point).collect();
    let within = SAME * extent(&points);
    let repeats = |round: &usize| (*round..n).all(|k| (points[k] - points[k - round]).norm() <= within);
    let rounds = (2..=n / fewest).filter(|times| n.is_multiple_of(*times)).map(|times| n / times);
    // the shortest possible round
    let Some(round) = rounds.filter(repeats).min() else { return };
    let times = if n / round == 2 { "twice".to_owned() } else { format!("{} times", n / round) };
    let line = marks[round].line;
    marks.truncate(round);
    notes.push(format!("{name}: the outline is drawn {times}: its points from line {line} on are left out"));
}

/// Rejects an outline whose sides cross.
pub(super) fn refuse_crossing(name: &str, marks: &[Mark]) -> Result<(), GeometryError> {
    let Some((x, sides)) = straight(marks).intersection() else { return Ok(()) };
    let [e, f] = sides.map(|e| side(marks, e));
    let what = format!("the outline crosses itself at ({:.6}, {:.6}): {e} and {f}", x[0], x[1]);
    Err(GeometryError::refused(name, what, "check the order of these points"))
}

/// Rejects an outline without crossings whose sides coincide, or that does not run exactly once around a body.
pub(super) fn refuse_overlap(name: &str, marks: &[Mark], opposite: Opposite) -> Result<(), GeometryError> {
    let hint = "list every point once, in their order around the body";
    let points: Vec<_> = marks.iter().map(|m| m.point).collect();
    let counted = |along: f64| along > 0.0 || opposite == Opposite::Refused;
    if let Some((x, sides)) = straight(marks).overlap(SAME * extent(&points), counted) {
        let [e, f] = sides.map(|e| side(marks, e));
        let what = format!("the outline runs over itself at ({:.6}, {:.6}): {e} and {f}", x[0], x[1]);
        return Err(GeometryError::refused(name, what, hint));
    }
    let Some(turned) = other_turn(marks) else { return Ok(()) };
    let what = format!(
        "the outline touches itself or runs around several times: its turns sum to {:.0} deg, those of an outline that \
         runs once around to 360 deg",
        turned.to_degrees()
    );
    Err(GeometryError::refused(name, what, hint))
}

fn straight(marks: &[Mark]) -> Surface<2> {
    Surface::new(&[(String::new(), straight_shell(marks))])
}

/// Both ends of a side, for messages.
fn side(marks: &[Mark], e: u32) -> String {
    let (a, b) = (&marks[e as usize], &marks[(e as usize + 1) % marks.len()]);
    format!("from {} to {}", at(a), at(b))
}

/// The sum of the turns of a closed outline, radians, where that of a simple one is another.
fn other_turn(marks: &[Mark]) -> Option<f64> {
    let n = marks.len();
    let turn = |i: usize| {
        let (before, here, after) = (marks[(i + n - 1) % n].point, marks[i].point, marks[(i + 1) % n].point);
        let (u, v) = (here - before, after - here);
        (u[0] * v[1] - u[1] * v[0]).atan2(u.dot(&v))
    };
    let (back, others): (Vec<f64>, Vec<f64>) = (0..n).map(turn).partition(|t| t.abs() > PI - BACK);
    let (back, sum) = (back.len(), others.iter().sum::<f64>());
    // each turn of 180 deg may be one to the left or one to the right
    let sums = (0..=back).map(|left| sum + PI * (2.0 * left as f64 - back as f64));
    let mut off = sums.map(|sum| (sum.abs() - 2.0 * PI).abs());
    (!off.any(|off| off <= ROUNDING)).then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::super::outline::polygon;
    use super::*;
    use crate::math::Vector;

    fn told(points: &[[f64; 2]]) -> Result<(f64, Vec<String>), String> {
        let points: Vec<Vector<2>> = points.iter().map(|p| Vector(*p)).collect();
        let mut notes = Vec::new();
        let shell = polygon("p", &points, 0.1, &mut notes).map_err(|e| e.to_string())?;
        Ok((Surface::new(&[("p".to_owned(), shell)]).volume(), notes))
    }

    #[test]
    fn further_rounds_are_left_out_and_told() {
        let once = [[0.0, 0.0], [1.0, -0.1], [1.0, 0.1]];
        let closed = [once.to_vec(), vec![once[0]]].concat();
        let (area, notes) = told(&once).unwrap();
        assert!((area - 0.1).abs() < 1e-15 && notes.is_empty());
        for (list, times) in [(once.repeat(2), "twice"), (closed.repeat(2), "twice"), (once.repeat(3), "3 times")] {
            let (area, notes) = told(&list).unwrap();
            let found = notes.iter().any(|n| n.contains(&format!("drawn {times}: its points from line ")));
            assert!((area - 0.1).abs() < 1e-15 && found, "{area} {notes:?}");
        }
    }

    #[test]
    fn outlines_that_run_over_themselves_or_touch_themselves_are_refused() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert!(told(&square).is_ok());
        // points on the sides of the second round
        let mut twice = square.to_vec();
        twice.extend([[0.0, 0.5], [0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        // a fin without thickness; a hole at the end of a slit
        let fin = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 1.0], [0.5, 2.0], [0.5, 1.0], [0.0, 1.0]];
        let slit = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 2.0],
            [1.0, 2.0],
            [2.0, 3.0],
            [3.0, 2.0],
            [2.0, 1.0],
            [1.0, 2.0],
            [0.0, 2.0],
        ];
        for list in [&twice[..], &fin, &slit] {
            let found = told(list).unwrap_err();
            assert!(found.contains("runs over itself at") && found.contains("in line"), "{found}");
        }
        let eight = [[0.0, 0.0], [1.0, -0.5], [1.0, 0.7], [0.0, 0.0], [-1.0, -0.5], [-1.0, 0.5]];
        let found = told(&eight).unwrap_err();
        assert!(found.contains("touches itself") || found.contains("crosses itself"), "{found}");
    }

    #[test]
    fn turns_of_180_degrees_may_have_either_sense() {
        let marks = |points: &[[f64; 2]]| {
            points.iter().zip(1..).map(|(p, line)| Mark { point: Vector(*p), line }).collect::<Vec<_>>()
        };
        let thin = marks(&[[1.0, 0.0], [0.9, 0.0], [0.5, 0.1], [0.0, 0.0], [0.5, -0.1], [0.9, 0.0]]);
        assert!(refuse_overlap("t", &thin, Opposite::Allowed).is_ok(), "a trailing edge without thickness");
        assert!(refuse_overlap("t", &thin, Opposite::Refused).is_err());
        let reversed: Vec<Mark> = thin.iter().rev().copied().collect();
        assert!(other_turn(&thin).is_none() && other_turn(&reversed).is_none());
    }
}
