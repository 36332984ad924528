//! Designations of NACA sections.
//!
//! Four digits: camber in hundredths of the chord, its position in tenths, thickness in hundredths. Five digits: design
//! lift coefficient in units of 0.15 (2 is 0.3), position of the greatest camber in twentieths, 0 for a plain or 1 for
//! a reflexed mean line, thickness. Either may end with a dash and two digits: index of the nose radius (6 is the
//! standard) and position of the greatest thickness in tenths. 6-series: `6`, position of the minimum pressure in
//! tenths, optionally `A` for the form with straight rear sides from 0.8 chord, optionally the range of lift with low
//! drag in tenths (it does not affect the shape), a dash, design lift coefficient in tenths, thickness; `a=0.5` after
//! this is the extent of the uniform load of the mean line (default 1). Jacobs, Ward and Pinkerton, NACA report 460
//! (1933); Jacobs and Pinkerton, report 537 (1935); Stack and von Doenhoff, report 492 (1934); Abbott, von Doenhoff and
//! Stivers, report 824 (1945); Loftin, report 903 (1948).
use super::schema::{Absent, Kind, defaulted, keys, required, words};

keys! {
    /// A NACA section.
    pub struct Naca, NACA.short("digits") {
        /// Its designation.
        digits: String = required(Kind::Matching("^([Nn][Aa][Cc][Aa][ _-]?)?[0-9].{3,}$")),
        /// How the section ends.
        trailing_edge: TrailingEdge = defaulted(Kind::Words(TRAILING_EDGES), Absent::Word("closed")),
    }
}

words! {
    /// Shape of the trailing edge of a NACA section.
    pub enum TrailingEdge, TRAILING_EDGES {
        /// last thickness coefficient -0.1036, no base of a modified form: both sides meet at x/c = 1
        Closed = "closed",
        /// last thickness coefficient -0.1015 as published: a base of 0.252 % chord for 12 %, of a modified form 0.24
        /// %, of 64A010 0.04 %
        Blunt = "blunt",
        /// as published, extended to where the sides meet and scaled back to unit chord
        Extended = "extended",
    }
}

/// Decoded designation of a NACA section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NacaDesign {
    /// Mean line.
    pub line: MeanLine,
    /// Greatest thickness divided by the chord.
    pub thickness: f64,
    /// Thickness distribution.
    pub form: ThicknessForm,
}

/// Thickness distribution along the chord.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ThicknessForm {
    /// That of the four-digit series.
    Standard,
    /// Four-digit series with another nose radius and position of the greatest thickness.
    Modified {
        /// Index of the nose radius; 6 is the standard.
        nose: f64,
        /// Position of the greatest thickness divided by the chord.
        place: f64,
    },
    /// That of the 6-series.
    Six(SixSeries),
}

/// A family of the 6-series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SixSeries {
    /// Position of the minimum pressure in tenths of the chord, 3 to 7.
    pub place: usize,
    /// True for the A-series, with straight sides from 0.8 chord; 3 to 5 only.
    pub straight: bool,
}

/// Mean line of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeanLine {
    /// Two parabolas that meet at the position of the greatest camber.
    Parabolas {
        /// Greatest camber divided by the chord.
        camber: f64,
        /// Its position divided by the chord.
        place: f64,
    },
    /// A cubic followed by a straight line.
    Cubic {
        /// Design lift coefficient.
        lift: f64,
        /// Position of the greatest camber in twentieths of the chord, 1 to 5.
        place: usize,
    },
    /// Two cubics, reflexed so that the moment about the quarter chord vanishes.
    Reflexed {
        /// Design lift coefficient.
        lift: f64,
        /// Position of the greatest camber in twentieths of the chord, 2 to 5.
        place: usize,
    },
    /// Uniform load up to a fraction of the chord, then linearly decreasing to zero.
    Uniform {
        /// Design lift coefficient.
        lift: f64,
        /// Fraction a of the chord.
        to: f64,
    },
    /// The mean line a = 0.8 with a straight end, used by the A-series.
    Straightened {
        /// Design lift coefficient.
        lift: f64,
    },
}

/// Reason why a text is not the designation of a section: the problem and a hint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoSection {
    /// Description of the problem.
    pub what: String,
    /// Hint for the correction.
    pub hint: &'static str,
}

const FORMS: &str = "for example `0012`, `2412`, `23012`, `23112`, `0012-64`, `63-415` or `64A010`; other sections by their coordinates, `airfoil = \"file\"`";
const SIX: &str = "for example `63-415`, `65(2)-215`, `66,1-212`, `64A010` or `65-210 a=0.5`; families are 63 to 67 and 63A to 65A; other sections by their coordinates, `airfoil = \"file\"`";
/// Greatest relative thickness for which the mapping of the 6-series is used; published sections have 6 to 21 %.
const SIX_THICKEST: f64 = 0.3;
const MODIFIED: &str =
    "behind the dash stand the index of the nose radius, 0 to 9, and the place of greatest thickness, 2 to 6 tenths";
/// Greatest relative thickness of four- and five-digit sections; published sections have 6 to 25 %, strut fairings up
/// to 40 %.
const THICKEST: f64 = 0.5;
const TOO_THICK: &str = "the last two digits are the thickness in %: published sections have 6 to 25, and up to 50 are taken; thicker bodies are an `ellipse` or a `polygon`";
const FIVE: &str = "plain mean lines are 210 to 250, reflexed ones 221 to 251, times the first digit over 2";
/// Design lift coefficient per unit of the first of five digits.
const LIFT: f64 = 0.15;

impl Naca {
    /// Decodes the designation. Fails when it is not one of a known section.
    pub fn design(&self) -> Result<NacaDesign, NoSection> {
        let text = self.digits.as_str();
        let bad = |what: String, hint: &'static str| NoSection { what, hint };
        let (digits, tail) = text.split_once('-').map_or((text, None), |(d, t)| (d, Some(t)));
        if is_six_series(text) {
            return six_series(text).ok_or_else(|| bad(format!("`{text}` is no section of the 6-series"), SIX));
        }
        let plain = |t: &str| t.bytes().all(|b| b.is_ascii_digit());
        if !(4..=5).contains(&digits.len()) || !plain(digits) {
            return Err(bad(format!("`{text}` is no NACA section of four or five digits"), FORMS));
        }
        let (line, thick) = digits.split_at(digits.len() - 2);
        let thickness = 0.01 * value(thick);
        if thickness == 0.0 {
            return Err(bad(format!("NACA {text} has no thickness"), "the last two digits are the thickness in %"));
        }
        if thickness > THICKEST {
            return Err(bad(format!("NACA {text} would be {thick} % thick"), TOO_THICK));
        }
        let form = match tail {
            None => ThicknessForm::Standard,
            Some(tail) if tail.len() == 2 && plain(tail) && (b'2'..=b'6').contains(&tail.as_bytes()[1]) => {
                ThicknessForm::Modified { nose: value(&tail[..1]), place: 0.1 * value(&tail[1..]) }
            }
            Some(_) => return Err(bad(format!("NACA {text} is modified in no known way"), MODIFIED)),
        };
        Ok(NacaDesign { line: mean_line(text, line)?, thickness, form })
    }
}

/// Number given by decimal digits.
fn value(digits: &str) -> f64 {
    digits.bytes().fold(0.0, |n, b| 10.0 * n + f64::from(b - b'0'))
}

/// Mean line of the two or three first digits of `text`.
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

/// True for a text of the form `64A010`, `63-415`, `65(2)-215`, `66,1-212`, `652-215` or `652215`.
fn is_six_series(text: &str) -> bool {
    let b = text.as_bytes();
    let head = b.len() > 2 && b[0] == b'6' && (b'3'..=b'7').contains(&b[1]);
    head && (!b[2].is_ascii_digit() || b.get(3) == Some(&b'-') || text.split(' ').next().is_some_and(|t| t.len() == 6))
}

/// Decodes a designation of the 6-series.
fn six_series(text: &str) -> Option<NacaDesign> {
    let (text, to) = match text.split_once(char::is_whitespace) {
        Some((head, tail)) => (head, Some(tail.trim().strip_prefix("a=")?.parse::<f64>().ok()?)),
        None => (text, None),
    };
    // the part before the last three digits: family, `A`, range of low drag, dash
    let split = text.len().checked_sub(3).filter(|&i| text.is_char_boundary(i))?;
    let (head, digits) = text.split_at(split);
    let dashed = head.ends_with('-');
    let (family, rest) = head.strip_suffix('-').unwrap_or(head).split_at_checked(2)?;
    let straight = rest.contains(['A', 'a']);
    let range = rest.replacen(['A', 'a'], "", 1);
    let range = range.strip_prefix('(').and_then(|r| r.strip_suffix(')')).or(range.strip_prefix(',')).unwrap_or(&range);
    let known = range.len() <= 1 && range.bytes().all(|b| b.is_ascii_digit());
    let place = usize::from(family.as_bytes()[1] - b'0');
    let separate = dashed || straight || !range.is_empty();
    let thickness = 0.01 * value(digits.get(1..).filter(|t| t.bytes().all(|b| b.is_ascii_digit()))?);
    let lift = 0.1 * value(digits.get(..1).filter(|t| t.bytes().all(|b| b.is_ascii_digit()))?);
    let made = (3..=if straight { 5 } else { 7 }).contains(&place) && thickness > 0.0 && thickness <= SIX_THICKEST;
    let line = match to {
        None if straight => MeanLine::Straightened { lift },
        Some(to) if !straight && (0.0..=1.0).contains(&to) => MeanLine::Uniform { lift, to },
        None => MeanLine::Uniform { lift, to: 1.0 },
        Some(_) => return None,
    };
    let form = ThicknessForm::Six(SixSeries { place, straight });
    (known && separate && made).then_some(NacaDesign { line, thickness, form })
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
        let plain = (MeanLine::Parabolas { camber: 0.02, place: 0.4 }, 0.12, ThicknessForm::Standard);
        assert_eq!((d.line, d.thickness, d.form), plain);
        assert_eq!(design("23012").unwrap().line, MeanLine::Cubic { lift: 0.3, place: 3 });
        let d = design("43115-64").unwrap();
        assert_eq!((d.line, d.thickness), (MeanLine::Reflexed { lift: 0.6, place: 3 }, 0.15));
        assert_eq!(d.form, ThicknessForm::Modified { nose: 6.0, place: 0.4 });
    }

    #[test]
    fn designations_of_the_six_series_are_read_in_all_spellings() {
        let six = |place, straight| ThicknessForm::Six(SixSeries { place, straight });
        for digits in ["65-215", "65(2)-215", "65,2-215", "652-215", "652215"] {
            let d = design(digits).unwrap();
            assert_eq!((d.form, d.thickness), (six(5, false), 0.15), "{digits}");
            assert_eq!(d.line, MeanLine::Uniform { lift: 0.2, to: 1.0 }, "{digits}");
        }
        assert_eq!(design("65-210 a=0.5").unwrap().line, MeanLine::Uniform { lift: 0.2, to: 0.5 });
        for digits in ["64A410", "64a410", "64(1)A410", "64A-410"] {
            let d = design(digits).unwrap();
            assert_eq!((d.form, d.line), (six(4, true), MeanLine::Straightened { lift: 0.4 }), "{digits}");
        }
    }

    #[test]
    fn others_are_refused_with_what_helps() {
        let told = |digits: &str, what: &str, hint: &str| {
            let e = design(digits).unwrap_err();
            assert!(e.what.contains(what) && e.hint.contains(hint), "{digits}: {e:?}");
        };
        for digits in
            ["66A010", "63-41", "65(215)-215", "64A010 a=0.5", "63-415 a=2", "63-400", "64-250", "63é-410", "64A"]
        {
            told(digits, "no section of the 6-series", "airfoil = \"file\"");
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
