//! Designations of NACA sections.
//!
//! Four digits: camber in hundredths of the chord, its place in tenths, thickness in hundredths. Five digits: design lift
//! coefficient in twentieths of three (2 is 0.3), place of greatest camber in twentieths, 0 for a plain or 1 for a reflexed mean
//! line, thickness. Either may end with a dash and two digits: index of the nose radius (6 as without) and place of greatest
//! thickness in tenths. Jacobs, Ward and Pinkerton, NACA report 460 (1933); Jacobs and Pinkerton, report 537 (1935); Stack and von
//! Doenhoff, report 492 (1934).
use serde::{Deserialize, Serialize};

/// A NACA section.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Naca {
    /// Its designation, `0012`, `23012` or `0012-64`.
    pub digits: String,
    /// How the section ends.
    pub trailing_edge: TrailingEdge,
}

/// Trailing edge of a NACA section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrailingEdge {
    /// Both sides meet at x/c = 1: last thickness coefficient −0.1036, of a modified form no thickness there.
    Closed,
    /// As published, with a base: last thickness coefficient −0.1015, 0.252 % chord for 12 %; of a modified form 0.24 %.
    Blunt,
    /// As published, extended to where the sides meet (x/c = 1.00893 for 0012) and scaled back to unit chord.
    Extended,
}

/// What a designation says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NacaDesign {
    /// Mean line.
    pub line: MeanLine,
    /// Greatest thickness over the chord.
    pub thickness: f64,
    /// Index of the nose radius and place of greatest thickness over the chord, where they are not those of four digits.
    pub modified: Option<(f64, f64)>,
}

/// The line that a section is bent along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeanLine {
    /// Two parabolas that meet at the place of greatest camber.
    Parabolas {
        /// Greatest camber over the chord.
        camber: f64,
        /// Its place over the chord.
        place: f64,
    },
    /// A cubic, straight behind.
    Cubic {
        /// Design lift coefficient.
        lift: f64,
        /// Place of greatest camber in twentieths of the chord, 1 to 5.
        place: usize,
    },
    /// Two cubics, turned up at the end so that the moment about the quarter chord vanishes.
    Reflexed {
        /// Design lift coefficient.
        lift: f64,
        /// Place of greatest camber in twentieths of the chord, 2 to 5.
        place: usize,
    },
}

/// Why a text is no designation of a section that can be made: what is wrong, and what may help.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoSection {
    /// What is wrong.
    pub what: String,
    /// What may help.
    pub hint: &'static str,
}

const FORMS: &str = "for example `0012`, `2412`, `23012`, `23112` or `0012-64`; other sections by their coordinates, `airfoil = \"file\"`";
const SIX: &str = "write its coordinates into a file and name that, `airfoil = \"file\"`: tables of them are published";
const MODIFIED: &str =
    "behind the dash stand the index of the nose radius, 0 to 9, and the place of greatest thickness, 2 to 6 tenths";
const FIVE: &str = "plain mean lines are 210 to 250, reflexed ones 221 to 251, times the first digit over 2";
/// Design lift coefficient that one of the first of five digits stands for.
const LIFT: f64 = 0.15;

impl Naca {
    /// What the designation says.
    pub fn design(&self) -> Result<NacaDesign, NoSection> {
        let text = self.digits.as_str();
        let bad = |what: String, hint: &'static str| NoSection { what, hint };
        let (digits, tail) = text.split_once('-').map_or((text, None), |(d, t)| (d, Some(t)));
        if is_six_series(text) {
            let what = format!("NACA {text} is a section of the 6-series, whose forms are tables");
            return Err(bad(what, SIX));
        }
        let plain = |t: &str| t.bytes().all(|b| b.is_ascii_digit());
        if !(4..=5).contains(&digits.len()) || !plain(digits) {
            return Err(bad(format!("`{text}` is no NACA section of four or five digits"), FORMS));
        }
        let value = |t: &str| t.bytes().fold(0.0, |n, b| 10.0 * n + f64::from(b - b'0'));
        let (line, thick) = digits.split_at(digits.len() - 2);
        let thickness = 0.01 * value(thick);
        if thickness == 0.0 {
            return Err(bad(format!("NACA {text} has no thickness"), "the last two digits are the thickness in %"));
        }
        let modified = match tail {
            None => None,
            Some(tail) if tail.len() == 2 && plain(tail) && (b'2'..=b'6').contains(&tail.as_bytes()[1]) => {
                Some((value(&tail[..1]), 0.1 * value(&tail[1..])))
            }
            Some(_) => return Err(bad(format!("NACA {text} is modified in no known way"), MODIFIED)),
        };
        Ok(NacaDesign { line: mean_line(text, line)?, thickness, modified })
    }
}

/// The mean line of the two or three first digits of `text`.
fn mean_line(text: &str, digits: &str) -> Result<MeanLine, NoSection> {
    let value = |k: usize| digits.as_bytes()[k] - b'0';
    let (first, place) = (f64::from(value(0)), value(1));
    if digits.len() == 2 {
        if (first == 0.0) != (place == 0) {
            let hint = "the first two digits are camber in % and its place in tenths: both zero or both not";
            return Err(NoSection { what: format!("NACA {text} has half a camber line"), hint });
        }
        return Ok(MeanLine::Parabolas { camber: 0.01 * first, place: 0.1 * f64::from(place) });
    }
    let (lift, place) = (LIFT * first, usize::from(place));
    match value(2) {
        0 if first > 0.0 && (1..=5).contains(&place) => Ok(MeanLine::Cubic { lift, place }),
        1 if first > 0.0 && (2..=5).contains(&place) => Ok(MeanLine::Reflexed { lift, place }),
        _ => {
            Err(NoSection { what: format!("NACA {text} has a mean line `{digits}` that is not published"), hint: FIVE })
        }
    }
}

/// True for designations such as `64A010`, `63-415`, `65(2)-215` or `66,1-212`.
fn is_six_series(text: &str) -> bool {
    let mut chars = text.chars();
    let head = (chars.next(), chars.next());
    let six = head.0 == Some('6') && head.1.is_some_and(|c| ('3'..='7').contains(&c));
    six && chars.next().is_some_and(|c| !c.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn design(digits: &str) -> Result<NacaDesign, NoSection> {
        Naca { digits: digits.into(), trailing_edge: TrailingEdge::Closed }.design()
    }

    #[test]
    fn designations_mean_what_the_reports_say() {
        let d = design("2412").unwrap();
        assert_eq!((d.line, d.thickness, d.modified), (MeanLine::Parabolas { camber: 0.02, place: 0.4 }, 0.12, None));
        assert_eq!(design("23012").unwrap().line, MeanLine::Cubic { lift: 0.3, place: 3 });
        let d = design("43115-64").unwrap();
        assert_eq!((d.line, d.thickness), (MeanLine::Reflexed { lift: 0.6, place: 3 }, 0.15));
        assert_eq!(d.modified, Some((6.0, 0.4)));
    }

    #[test]
    fn others_are_refused_with_what_helps() {
        let told = |digits: &str, what: &str, hint: &str| {
            let e = design(digits).unwrap_err();
            assert!(e.what.contains(what) && e.hint.contains(hint), "{digits}: {e:?}");
        };
        for digits in ["64A010", "63-415", "65(2)-215", "66,1-212", "63A-010"] {
            told(digits, "6-series", "airfoil = \"file\"");
        }
        for digits in ["", "12", "00a2", "123456", "00-12", "-12", "NACA0012", "16-012"] {
            told(digits, "is no NACA section", "0012-64");
        }
        told("0000", "no thickness", "%");
        told("2012", "half a camber line", "both");
        told("23612", "mean line `236`", "210 to 250");
        told("21112", "mean line `211`", "221");
        told("0012-61", "modified in no known way", "2 to 6");
        told("0012-6", "modified in no known way", "2 to 6");
    }
}
