//! A stroke font, so that pictures carry text without any font file.
//!
//! Letters live on a grid: baseline 0, x-height 10, capitals 14, descenders −4, [`EM`] units to the em. A glyph is a
//! string of commands: `M x y` moves, `L x y` draws a line, `A cx cy rx ry from to` draws an elliptic arc between two
//! angles in degrees (counter-clockwise when `to > from`) after a line to its start, `a …` the same without that line.

/// Between two pieces of one path.
pub(crate) const LIFTED: [f64; 2] = [f64::NAN; 2];

/// Grid units to the em: text of size s pixels has capitals of 14 s / 20 pixels.
pub(crate) const EM: f64 = 20.0;

/// Letters of other fonts are wider than ours, at most about this much.
pub(super) const OTHER_FONTS: f64 = 1.15;

/// Added to every advance width: text on a screen wants air between letters.
const TRACKING: f64 = 0.6;

/// Segments per full turn of an arc; text is at most a few dozen pixels tall.
const SEGMENTS_PER_TURN: f64 = 32.0;

/// Advance width and commands, by character.
#[rustfmt::skip]
const GLYPHS: &[(char, f64, &str)] = &[
    (' ', 5.5, ""),
    ('0', 10.0, "a 5 7 3.7 7 90 450"),
    ('1', 10.0, "M 2.2 11 L 5.6 14 L 5.6 0"),
    ('2', 10.0, "a 5 10.2 3.6 3.8 170 -30 L 1.4 0 L 8.7 0"),
    ('3', 10.0, "a 4.8 10.5 3.3 3.5 155 -90 A 4.7 3.5 3.8 3.5 90 -155"),
    ('4', 10.0, "M 6.9 0 L 6.9 14 L 1 4.2 L 9.1 4.2"),
    ('5', 10.0, "M 8.2 14 L 2.5 14 L 2 7.8 A 4.9 4.6 3.7 4.6 125 -150"),
    ('6', 10.0, "a 5 4.4 3.7 4.4 0 360 a 8.3 4.4 7 9.6 180 100"),
    ('7', 10.0, "M 1.4 14 L 8.7 14 L 3.8 0"),
    ('8', 10.0, "a 5 10.6 3.2 3.4 0 360 a 5 3.6 3.8 3.6 0 360"),
    ('9', 10.0, "a 5 9.6 3.7 4.4 0 360 a 1.7 9.6 7 9.6 0 -80"),
    ('A', 11.6, "M 0.8 0 L 5.8 14 L 10.8 0 M 2.5 4.6 L 9.1 4.6"),
    ('B', 10.6, "M 1.6 7.2 L 1.6 0 L 5.6 0 A 5.6 3.6 3.6 3.6 -90 90 L 1.6 7.2 L 1.6 14 L 5.2 14 A 5.2 10.6 3.2 3.4 90 -90"),
    ('C', 11.4, "a 6.6 7 5.2 7 50 310"),
    ('D', 11.6, "M 1.6 0 L 1.6 14 L 4.6 14 A 4.6 7 5.6 7 90 -90 L 1.6 0"),
    ('E', 9.8, "M 8.6 14 L 1.6 14 L 1.6 0 L 8.6 0 M 1.6 7.2 L 7.6 7.2"),
    ('F', 9.2, "M 8.4 14 L 1.6 14 L 1.6 0 M 1.6 7 L 7.4 7"),
    ('G', 13.0, "a 6.6 7 5.2 7 50 345 L 11.7 6.6 L 7.6 6.6"),
    ('H', 11.4, "M 1.6 0 L 1.6 14 M 9.8 0 L 9.8 14 M 1.6 7.2 L 9.8 7.2"),
    ('I', 4.0, "M 2 0 L 2 14"),
    ('J', 7.6, "M 6 14 L 6 3.6 A 3.4 3.6 2.6 3.6 0 -150"),
    ('K', 10.2, "M 1.6 0 L 1.6 14 M 9 14 L 1.6 5.6 M 4.4 8.6 L 9.6 0"),
    ('L', 8.8, "M 1.6 14 L 1.6 0 L 8 0"),
    ('M', 13.6, "M 1.6 0 L 1.6 14 L 6.8 4 L 12 14 L 12 0"),
    ('N', 11.4, "M 1.6 0 L 1.6 14 L 9.8 0 L 9.8 14"),
    ('O', 13.4, "a 6.7 7 5.3 7 0 360"),
    ('P', 10.0, "M 1.6 0 L 1.6 14 L 5.4 14 A 5.4 10.1 3.6 3.9 90 -90 L 1.6 6.2"),
    ('Q', 13.4, "a 6.7 7 5.3 7 0 360 M 7.6 3.4 L 11.6 -1"),
    ('R', 10.4, "M 1.6 0 L 1.6 14 L 5.4 14 A 5.4 10.1 3.6 3.9 90 -90 L 1.6 6.2 M 5.6 6.2 L 9.4 0"),
    ('S', 10.0, "a 5 10.45 3.5 3.55 35 270 A 5 3.45 3.9 3.45 90 -145"),
    ('T', 10.4, "M 0.6 14 L 9.8 14 M 5.2 14 L 5.2 0"),
    ('U', 11.2, "M 1.6 14 L 1.6 4.4 A 5.6 4.4 4 4.4 180 360 L 9.6 14"),
    ('V', 11.2, "M 0.8 14 L 5.6 0 L 10.4 14"),
    ('W', 15.6, "M 0.8 14 L 4.2 0 L 7.8 12 L 11.4 0 L 14.8 14"),
    ('X', 10.4, "M 1 14 L 9.4 0 M 9.4 14 L 1 0"),
    ('Y', 10.4, "M 0.8 14 L 5.2 7 L 9.6 14 M 5.2 7 L 5.2 0"),
    ('Z', 10.2, "M 1.2 14 L 9 14 L 1 0 L 9.2 0"),
    ('a', 10.3, "a 4.9 5 3.8 5 0 360 M 8.7 10 L 8.7 0"),
    ('b', 10.2, "M 1.5 14.5 L 1.5 0 a 5.3 5 3.8 5 0 360"),
    ('c', 9.0, "a 5 5 3.9 5 50 310"),
    ('d', 10.2, "M 8.7 14.5 L 8.7 0 a 4.9 5 3.8 5 0 360"),
    ('e', 9.9, "M 1.2 5.2 L 8.8 5.2 A 5 5 3.8 5 2 315"),
    ('f', 6.0, "M 2.6 0 L 2.6 11.4 A 5.1 11.4 2.5 3.1 180 80 M 0.6 10 L 5.4 10"),
    ('g', 10.2, "a 4.9 5 3.8 5 0 360 M 8.7 10 L 8.7 -1 A 5 -1 3.7 3.2 0 -150"),
    ('h', 10.0, "M 1.5 14.5 L 1.5 0 M 1.5 6 A 5 6 3.5 4 180 0 L 8.5 0"),
    ('i', 3.6, "M 1.8 0 L 1.8 10 M 1.8 13.4 L 1.8 13.6"),
    ('j', 4.2, "M 2.6 10 L 2.6 -1.4 A 0.4 -1.4 2.2 2.6 0 -80 M 2.6 13.4 L 2.6 13.6"),
    ('k', 8.6, "M 1.5 14.5 L 1.5 0 M 7.6 10 L 1.5 4 M 3.8 6.3 L 8.2 0"),
    ('l', 4.4, "M 1.7 14.5 L 1.7 2 A 3.5 2 1.8 2 180 275"),
    ('m', 15.0, "M 1.5 10 L 1.5 0 M 1.5 6.6 A 4.5 6.6 3 3.4 180 0 L 7.5 0 M 7.5 6.6 A 10.5 6.6 3 3.4 180 0 L 13.5 0"),
    ('n', 10.0, "M 1.5 10 L 1.5 0 M 1.5 6 A 5 6 3.5 4 180 0 L 8.5 0"),
    ('o', 10.2, "a 5.1 5 4 5 0 360"),
    ('p', 10.2, "M 1.5 10 L 1.5 -4 a 5.3 5 3.8 5 0 360"),
    ('q', 10.2, "M 8.7 10 L 8.7 -4 a 4.9 5 3.8 5 0 360"),
    ('r', 6.4, "M 1.5 10 L 1.5 0 M 1.5 5.6 A 4.7 5.6 3.2 4.4 180 75"),
    ('s', 8.4, "a 4.2 7.5 2.8 2.5 30 270 A 4.2 2.5 3.1 2.5 90 -150"),
    ('t', 6.6, "M 3 13.4 L 3 2.6 A 5.4 2.6 2.4 2.6 180 280 M 0.8 10 L 5.8 10"),
    ('u', 10.0, "M 1.5 10 L 1.5 4 A 5 4 3.5 4 180 360 M 8.5 10 L 8.5 0"),
    ('v', 9.2, "M 0.8 10 L 4.6 0 L 8.4 10"),
    ('w', 13.2, "M 0.8 10 L 3.6 0 L 6.6 9 L 9.6 0 L 12.4 10"),
    ('x', 8.8, "M 1 10 L 7.8 0 M 7.8 10 L 1 0"),
    ('y', 9.2, "M 0.8 10 L 4.6 0 M 8.4 10 L 3.4 -3 L 1.6 -4"),
    ('z', 8.6, "M 1.1 10 L 7.4 10 L 1 0 L 7.6 0"),
    ('.', 4.0, "M 2 0 L 2 0.3"),
    (',', 4.0, "M 2.2 0.4 L 1.2 -2.4"),
    (':', 4.0, "M 2 0.2 L 2 0.4 M 2 8 L 2 8.2"),
    (';', 4.0, "M 2.2 0.4 L 1.2 -2.4 M 2 8 L 2 8.2"),
    ('-', 7.0, "M 1.2 5.6 L 5.8 5.6"),
    ('\u{2013}', 9.0, "M 0.6 5.6 L 8.4 5.6"),
    ('\u{2212}', 10.0, "M 1.4 6 L 8.6 6"),
    ('+', 10.0, "M 1.4 6 L 8.6 6 M 5 2.4 L 5 9.6"),
    ('±', 10.0, "M 1.4 7.4 L 8.6 7.4 M 5 3.8 L 5 11 M 1.4 1 L 8.6 1"),
    ('×', 10.0, "M 2 3 L 8 9 M 8 3 L 2 9"),
    ('·', 4.0, "M 2 5.8 L 2 6"),
    ('=', 10.0, "M 1.4 4 L 8.6 4 M 1.4 8 L 8.6 8"),
    ('/', 7.0, "M 0.6 -2 L 6.4 15"),
    ('|', 4.0, "M 2 -3 L 2 15"),
    ('(', 5.6, "a 7.2 6 5.4 9.6 125 235"),
    (')', 5.6, "a -1.6 6 5.4 9.6 55 -55"),
    ('[', 5.6, "M 4.6 15 L 1.8 15 L 1.8 -3 L 4.6 -3"),
    (']', 5.6, "M 1 15 L 3.8 15 L 3.8 -3 L 1 -3"),
    ('<', 10.0, "M 8.4 10 L 1.6 6 L 8.4 2"),
    ('>', 10.0, "M 1.6 10 L 8.4 6 L 1.6 2"),
    ('%', 14.0, "a 3.4 10.6 2.3 3.2 0 360 a 10.6 3.4 2.3 3.2 0 360 M 11 14 L 3 0"),
    ('°', 6.0, "a 3 11.8 2.1 2.1 0 360"),
    ('\'', 3.6, "M 1.8 14.4 L 1.8 10.6"),
    ('"', 6.0, "M 1.8 14.4 L 1.8 10.6 M 4.2 14.4 L 4.2 10.6"),
    ('!', 4.0, "M 2 14 L 2 4.6 M 2 0 L 2 0.3"),
    ('?', 9.0, "a 4.4 10.6 3.2 3.4 165 -60 L 4.6 5.6 L 4.6 4.4 M 4.6 0 L 4.6 0.3"),
    ('*', 8.0, "M 4 14 L 4 8 M 1.4 12.5 L 6.6 9.5 M 6.6 12.5 L 1.4 9.5"),
    ('_', 9.0, "M 0.4 -2.6 L 8.6 -2.6"),
    ('#', 11.0, "M 3 1 L 4.6 13 M 6.6 1 L 8.2 13 M 1.4 9 L 9.8 9 M 1 5 L 9.4 5"),
    ('&', 12.0, "M 11 0 L 3.4 10 A 5.2 11.4 2.4 2.6 215 -50 L 2.6 6.4 A 4.8 3.6 3.6 3.6 130 330 L 10.6 6.4"),
    ('~', 10.0, "a 3.2 5.4 1.8 1.6 180 0 A 6.8 5.4 1.8 1.6 180 360"),
    ('^', 8.0, "M 1.4 10 L 4 14 L 6.6 10"),
    ('²', 6.4, "a 3.2 12.3 1.9 1.9 170 -35 L 1.2 7.4 L 5.2 7.4"),
    ('³', 6.4, "a 3 12.4 1.8 1.7 155 -90 A 3 9.1 2 1.7 90 -155"),
    ('α', 11.0, "M 9.6 10 A 4.6 5 3.6 5 25 335 L 10 0 M 9.6 10 L 8 3"),
    ('β', 10.0, "M 1.6 -4 L 1.6 10.6 A 4.8 10.8 3.2 3.4 180 -90 L 4.6 7.4 A 4.8 3.7 3.8 3.7 90 -140"),
    ('γ', 9.6, "M 0.8 10 L 4.8 0 L 8.8 10 M 4.8 0 L 4.8 -4"),
    ('ρ', 10.2, "M 1.5 -4 L 1.5 5 a 5.3 5 3.8 5 0 360"),
    ('Δ', 11.6, "M 0.8 0 L 5.8 14 L 10.8 0 L 0.8 0"),
    ('∞', 14.0, "a 4 5.6 2.8 2.6 0 360 a 10 5.6 3 2.6 0 360"),
    ('δ', 10.0, "a 5 4.6 3.7 4.6 0 360 M 5 9.2 L 2.6 12 A 4.8 12.4 2.2 1.8 180 40"),
    ('ζ', 9.0, "M 2 14 L 7.6 14 L 2.4 7.4 A 5 3.6 3.4 3.6 120 270 A 6 -1.8 1.8 1.8 90 -120"),
    ('θ', 10.2, "a 5.1 7 3.6 7 0 360 M 1.6 7 L 8.6 7"),
    ('μ', 10.4, "M 1.5 10 L 1.5 -4 M 1.5 4 A 5 4 3.5 4 180 360 L 8.5 10 M 8.5 4 L 8.5 0"),
    ('τ', 9.0, "M 0.8 10 L 8.2 10 M 4.5 10 L 4.5 2 A 6.3 2 1.8 2 180 280"),
    ('φ', 12.0, "a 6 5 4.6 5 0 360 M 6 13.6 L 6 -4"),
    ('ω', 13.2, "M 3.2 10 A 4 4 2.8 4 150 360 L 6.8 7 M 6.8 4 A 9.6 4 2.8 4 180 390"),
    ('→', 14.0, "M 1.4 6 L 12.4 6 M 9 9 L 12.4 6 L 9 3"),
    ('≤', 10.0, "M 8.4 12 L 1.6 8 L 8.4 4 M 1.6 1 L 8.4 1"),
    ('≥', 10.0, "M 1.6 12 L 8.4 8 L 1.6 4 M 1.6 1 L 8.4 1"),
];

/// Drawn for a character without a glyph.
const MISSING: (char, f64, &str) = ('\u{fffd}', 9.0, "M 1.4 0 L 1.4 14 L 7.6 14 L 7.6 0 L 1.4 0");

/// Width of `text` in ems.
pub(crate) fn width(text: &str) -> f64 {
    text.chars().map(|c| glyph(c).1 + TRACKING).sum::<f64>() / EM
}

/// The strokes of `text` in ems, y up, starting at the origin; the pen is lifted between them.
pub(crate) fn strokes(text: &str) -> Vec<[f64; 2]> {
    let mut all = Vec::new();
    let mut pen = 0.0;
    for c in text.chars() {
        let (_, advance, commands) = glyph(c);
        all.extend(outline(commands).iter().map(|p| [(p[0] + pen) / EM, p[1] / EM]));
        pen += advance + TRACKING;
    }
    all
}

fn glyph(c: char) -> (char, f64, &'static str) {
    GLYPHS.iter().find(|g| g.0 == c).copied().unwrap_or(MISSING)
}

fn outline(commands: &str) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    let mut words = commands.split_whitespace();
    while let Some(command) = words.next() {
        let mut number = || words.next().and_then(|w| w.parse::<f64>().ok()).unwrap_or(0.0);
        if ["M", "a"].contains(&command) {
            points.push(LIFTED);
        }
        match command {
            "M" | "L" => points.push([number(), number()]),
            _ => points.extend(arc([number(), number()], [number(), number()], [number(), number()])),
        }
    }
    points
}

fn arc(centre: [f64; 2], radius: [f64; 2], angles: [f64; 2]) -> Vec<[f64; 2]> {
    let turn = angles[1] - angles[0];
    let n = (turn.abs() / 360.0 * SEGMENTS_PER_TURN).ceil().max(1.0) as usize;
    let at = |k: usize| (angles[0] + turn * k as f64 / n as f64).to_radians();
    (0..=n).map(|k| [centre[0] + radius[0] * at(k).cos(), centre[1] + radius[1] * at(k).sin()]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_printable_letter_has_strokes_inside_its_box() {
        for (c, advance, commands) in GLYPHS {
            let points: Vec<_> = outline(commands).into_iter().filter(|p| p[0].is_finite()).collect();
            assert!(!points.is_empty() || *c == ' ', "{c}");
            assert!(
                points.iter().all(|p| (-1.0..=advance + 1.0).contains(&p[0]) && (-5.0..=16.0).contains(&p[1])),
                "{c}"
            );
        }
        assert!(('!'..='~').filter(|c| !"$@\\`{}".contains(*c)).all(|c| glyph(c).0 == c));
        assert!(width("\u{1f600}") > 0.0);
    }
}
