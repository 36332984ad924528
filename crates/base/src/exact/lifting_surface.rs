//! Lift of thin flat wings in subsonic flow: lifting-surface theory with a vortex lattice.
//!
//! Each panel has a bound vortex at its quarter chord with trailing vortices along x. At the control point at three
//! quarters of the chord of every panel, the downwash Σ w_ij Γ_j balances the angle of attack. Panels are equally
//! spaced along the chord, where the lattice is exact in 2-D, and cosine-spaced along the span. Lift follows from the
//! Kutta-Joukowski theorem, induced drag from the downwash far downstream (Trefftz plane): CDi = CL² / (π A e).
//! Compressibility follows from the Prandtl-Glauert-Göthert rule in 3-D: the wing with x divided by β = √(1 − M²) in
//! incompressible flow has β times the lift slope.
//!
//! An aerofoil with thickness has a larger lift slope than a flat plate, in 2-D by the factor κ. If the induced angle
//! of attack depends on the lift only, as in lifting-line theory, then 1/a = 1/a_flat − (1 − 1/κ) β/2π
//! ([`LiftingSurface::with_section`]).
//!
//! Limits: small angles of attack, planar wings without twist, no tip suction and no roll-up of tip vortices;
//! compressibility is linear, so that β must be much larger than the thickness. Sources: V. M. Falkner, ARC R&M 1910
//! (1943); C. E. Lan, J. Aircraft 11 (1974) 518-527; B. Göthert, NACA TM 1105 (1946).
use super::Error;
use crate::math::dense::Factors;
use std::f64::consts::PI;

/// Distance relative to the sides of a triangle below which a point is regarded as lying on the line of a vortex.
const ON_THE_LINE: f64 = 1e-12;

/// Chord distribution along the span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChordLaw {
    /// Linear from the root chord to the tip chord.
    Straight {
        /// Ratio of the tip chord to the root chord.
        taper: f64,
    },
    /// Elliptic planform.
    Elliptic,
}

/// A flat wing, symmetric about its root. Lengths may have any common unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatWing {
    /// Span from tip to tip.
    pub span: f64,
    /// Chord at the root.
    pub root_chord: f64,
    /// Chord distribution along the span.
    pub chord: ChordLaw,
    /// Sweep angle of the line at the chord fraction `sweep_at`, positive aft (rad).
    pub sweep: f64,
    /// Chord fraction of the line that has the sweep angle.
    pub sweep_at: f64,
}

/// Number of panels of the lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lattice {
    /// Number of panels along the chord.
    pub chordwise: usize,
    /// Number of panels along the half span.
    pub spanwise: usize,
}

/// Results of lifting-surface theory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiftingSurface {
    /// Lift-curve slope dCL/dα per radian, based on the planform area.
    pub lift_slope: f64,
    /// Span efficiency e; 1 for an elliptic lift distribution.
    pub efficiency: f64,
    /// Distance of the neutral point aft of the leading edge of the root.
    pub neutral_point: f64,
    /// Aspect ratio span²/area.
    pub aspect_ratio: f64,
    /// Prandtl-Glauert factor √(1 − M²).
    beta: f64,
}

/// A horseshoe vortex: the ends of its bound part in the plane of the wing, and the control point of its panel.
struct Panel {
    ends: [[f64; 2]; 2],
    control: [f64; 2],
    width: f64,
    strip: usize,
}

impl FlatWing {
    /// Chord at the distance `y` from the root.
    fn chord_at(&self, y: f64) -> f64 {
        let part = (2.0 * y / self.span).min(1.0);
        self.root_chord
            * match self.chord {
                ChordLaw::Straight { taper } => 1.0 + (taper - 1.0) * part,
                ChordLaw::Elliptic => (1.0 - part * part).sqrt(),
            }
    }

    /// Position along x of the chord fraction `part` at the distance `y` from the root.
    fn point(&self, part: f64, y: f64) -> f64 {
        self.sweep_at * self.root_chord + y * self.sweep.tan() + (part - self.sweep_at) * self.chord_at(y)
    }

    /// Planform area of the wing.
    pub fn area(&self) -> f64 {
        self.span
            * self.root_chord
            * match self.chord {
                ChordLaw::Straight { taper } => 0.5 * (1.0 + taper),
                ChordLaw::Elliptic => 0.25 * PI,
            }
    }

    /// Lift slope, span efficiency and neutral point at the Mach number `mach` < 1; an error if the Mach number is
    /// outside [0, 1).
    pub fn lift(&self, mach: f64, lattice: Lattice) -> Result<LiftingSurface, Error> {
        if !(0.0..1.0).contains(&mach) {
            return Err(Error::Mach { what: "lifting-surface theory", range: "[0, 1)", mach });
        }
        let beta = (1.0 - mach * mach).sqrt();
        let panels = self.panels(beta, lattice);
        let circulation = circulation(&panels).ok_or(Error::Outside {
            what: "planforms with an area",
            x: self.span,
            y: self.root_chord,
        })?;
        // both halves of the wing at one radian in a stream of unit speed: L = 2 Σ Γ Δy
        let lift: f64 = panels.iter().zip(&circulation).map(|(p, g)| 4.0 * g * p.width).sum();
        let moment: f64 = panels
            .iter()
            .zip(&circulation)
            .map(|(p, g)| 4.0 * g * p.width * 0.5 * (p.ends[0][0] + p.ends[1][0]) * beta)
            .sum();
        let aspect_ratio = self.span * self.span / self.area();
        // division of x by β increases the area by 1/β: the lift slope of that wing is β lift / area, and that of this
        // wing is 1/β times as large
        let slope = lift / self.area();
        let drag = trefftz(&panels, &circulation, lattice.spanwise);
        let efficiency = lift * lift / (PI * self.span * self.span * drag);
        Ok(LiftingSurface { lift_slope: slope, efficiency, neutral_point: moment / lift, aspect_ratio, beta })
    }

    /// Panels of the half wing y > 0 with x divided by β.
    fn panels(&self, beta: f64, lattice: Lattice) -> Vec<Panel> {
        let n = lattice.spanwise as f64;
        // equal angles from root to tip, with control points in their middle
        let station = |k: f64| 0.5 * self.span * (0.5 * PI * k / n).sin();
        let rows = lattice.chordwise as f64;
        let panel = |strip: usize, row: usize| {
            let (y0, y1) = (station(strip as f64), station(strip as f64 + 1.0));
            let middle = station(strip as f64 + 0.5);
            let at = |part: f64, y: f64| [self.point((row as f64 + part) / rows, y) / beta, y];
            Panel { ends: [at(0.25, y0), at(0.25, y1)], control: at(0.75, middle), width: y1 - y0, strip }
        };
        (0..lattice.spanwise)
            .flat_map(|s| (0..lattice.chordwise).map(move |r| (s, r)))
            .map(|(s, r)| panel(s, r))
            .collect()
    }
}

impl LiftingSurface {
    /// Lift slope of this wing with an aerofoil whose 2-D lift slope is `ratio` times that of a flat plate.
    pub fn with_section(&self, ratio: f64) -> f64 {
        1.0 / (1.0 / self.lift_slope - (1.0 - 1.0 / ratio) * self.beta / (2.0 * PI))
    }
}

/// Circulations for which the downwash at all control points is 1; `None` if the system is singular.
fn circulation(panels: &[Panel]) -> Option<Vec<f64>> {
    let n = panels.len();
    let rows: Vec<f64> = panels
        .iter()
        .flat_map(|p| panels.iter().map(|q| -(downwash(&p.control, q.ends) + downwash(&p.control, mirrored(q)))))
        .collect();
    let mut circulation = vec![0.0; n];
    Factors::new(n, rows)?.solve(&vec![1.0; n], &mut circulation);
    circulation.iter().all(|g| g.is_finite()).then_some(circulation)
}

/// Bound vortex of the mirrored panel on the other half of the wing.
fn mirrored(panel: &Panel) -> [[f64; 2]; 2] {
    let [a, b] = panel.ends;
    [[b[0], -b[1]], [a[0], -a[1]]]
}

/// Velocity along z, at a point in the plane of the wing, of a horseshoe vortex of unit circulation from `a` to `b`,
/// with trailing vortices along x.
fn downwash(x: &[f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let (ra, rb) = ([x[0] - a[0], x[1] - a[1]], [x[0] - b[0], x[1] - b[1]]);
    let (la, lb) = (ra[0].hypot(ra[1]), rb[0].hypot(rb[1]));
    let bound = [b[0] - a[0], b[1] - a[1]];
    let cross = ra[0] * rb[1] - rb[0] * ra[1];
    let along = |r: [f64; 2], l: f64| (bound[0] * r[0] + bound[1] * r[1]) / l;
    let of_bound = if cross.abs() > ON_THE_LINE * la * lb { (along(ra, la) - along(rb, lb)) / cross } else { 0.0 };
    let trailing = |r: [f64; 2], l: f64| (1.0 + r[0] / l) / r[1];
    (of_bound - trailing(ra, la) + trailing(rb, lb)) / (4.0 * PI)
}

/// Induced drag divided by ½ρU² at an angle of attack of one radian: ∫ Γ w dy with the downwash of the trailing
/// vortices far downstream.
fn trefftz(panels: &[Panel], circulation: &[f64], strips: usize) -> f64 {
    let mut strip = vec![(0.0, 0.0, 0.0, 0.0); strips];
    for (p, g) in panels.iter().zip(circulation) {
        let sum = strip[p.strip].0 + g;
        strip[p.strip] = (sum, p.ends[0][1], p.ends[1][1], p.control[1]);
    }
    let wash = |y: f64| -> f64 {
        let pair = |(g, a, b, _): &(f64, f64, f64, f64)| {
            g * (1.0 / (y - a) - 1.0 / (y - b) + 1.0 / (y + b) - 1.0 / (y + a)) / (2.0 * PI)
        };
        strip.iter().map(pair).sum()
    };
    strip.iter().map(|s| 2.0 * s.0 * wash(s.3) * (s.2 - s.1)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FINE: Lattice = Lattice { chordwise: 8, spanwise: 40 };

    fn rectangle(aspect_ratio: f64) -> FlatWing {
        let chord = ChordLaw::Straight { taper: 1.0 };
        FlatWing { span: aspect_ratio, root_chord: 1.0, chord, sweep: 0.0, sweep_at: 0.0 }
    }

    #[test] // P. F. Jordan, AFOSR TR-73-0078 (1973): 1.790023 for the circular disc; E. O. Tuck, J. Austral. Math. Soc. B 35 (1993): 1.4602 for the square
    fn discs_and_squares_lift_as_known() {
        let disc = FlatWing { span: 2.0, root_chord: 2.0, chord: ChordLaw::Elliptic, sweep: 0.0, sweep_at: 0.5 };
        let found = disc.lift(0.0, FINE).unwrap();
        assert!((found.lift_slope / 1.790023 - 1.0).abs() < 4e-3, "{found:?}");
        let found = rectangle(1.0).lift(0.0, FINE).unwrap();
        assert!((found.lift_slope / 1.4602 - 1.0).abs() < 2e-3, "{found:?}");
    }

    #[test]
    fn long_and_elliptic_wings_follow_the_lifting_line() {
        let long = rectangle(400.0).lift(0.0, Lattice { chordwise: 4, spanwise: 60 }).unwrap();
        assert!((long.lift_slope / (2.0 * PI) - 1.0).abs() < 0.02, "{long:?}");
        // R. T. Jones, NACA TN 817 (1941): 2π A / (A E + 2), where E is the ratio of the semiperimeter to the span
        let ellipse = FlatWing { span: 8.0, root_chord: 1.0, chord: ChordLaw::Elliptic, sweep: 0.0, sweep_at: 0.25 };
        let found = ellipse.lift(0.0, FINE).unwrap();
        let (a, b, c) = (found.aspect_ratio, 4.0_f64, 0.5_f64);
        // a quarter of the perimeter by Ramanujan's formula
        let around = 0.25 * PI * (3.0 * (b + c) - ((3.0 * b + c) * (b + 3.0 * c)).sqrt());
        let edge = 2.0 * PI * a / (a * around / b + 2.0);
        assert!(
            (found.lift_slope / edge - 1.0).abs() < 0.02 && (found.efficiency - 1.0).abs() < 2e-3,
            "{found:?} {edge}"
        );
        // H. Glauert, The Elements of Aerofoil and Airscrew Theory (1926), chapter 11, with 60 terms: 0.951 for a
        // rectangle of aspect ratio 2π, 0.768 for 50; square tips carry less load if the chord is not small compared
        // with the span
        for (aspect_ratio, line) in [(2.0 * PI, 0.9514), (50.0, 0.7679)] {
            let found = rectangle(aspect_ratio).lift(0.0, FINE).unwrap();
            assert!(line < found.efficiency && found.efficiency < line + 0.05, "{found:?}");
        }
    }

    #[test]
    fn compressibility_is_that_of_a_longer_wing() {
        let (mach, beta) = (0.6, 0.8);
        let wing = FlatWing { sweep: 0.3, ..rectangle(6.0) };
        let longer = FlatWing { root_chord: 1.0 / beta, sweep: (0.3_f64.tan() / beta).atan(), ..wing };
        let [fast, slow] = [wing.lift(mach, FINE).unwrap(), longer.lift(0.0, FINE).unwrap()];
        assert!((fast.lift_slope * beta / slow.lift_slope - 1.0).abs() < 1e-12, "{fast:?} {slow:?}");
        assert!((fast.neutral_point / (beta * slow.neutral_point) - 1.0).abs() < 1e-12);
        assert!(
            (fast.with_section(1.0) / fast.lift_slope - 1.0).abs() < 1e-12 && fast.with_section(1.1) > fast.lift_slope
        );
    }
}
