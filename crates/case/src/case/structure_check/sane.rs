//! Numbers of structures that no body has, though each may be one: angles by their own unit, and unbalance against inertia.
use std::f64::consts::TAU;

use super::Look;
use crate::case::text::rounded;

/// Coordinates that are angles.
const ANGLES: [&str; 4] = ["roll", "pitch", "yaw", "flap"];
/// A full turn, with what degrees are rounded by.
const TURN: f64 = TAU * (1.0 + 1e-12);
/// Keys of an unbalance S/(m b) and of the moment of inertia I/(m b²) about the same axis.
const UNBALANCES: [[&str; 2]; 2] = [["x_alpha", "r_alpha2"], ["flap.x_beta", "flap.r_beta2"]];
/// Digits by which a number is recognised.
const DIGITS: usize = 5;

impl Look<'_, '_> {
    /// Looks for such numbers.
    pub(super) fn sane(&mut self) {
        self.turns();
        self.unbalances();
    }

    /// Angles at the start, and those of springs, are within a turn.
    fn turns(&mut self) {
        let of = |name: &str| {
            ["initial.NAME", "springs.NAME.rest", "springs.NAME.free_play"].map(|k| k.replace("NAME", name))
        };
        for path in ANGLES.iter().flat_map(|name| of(name)).map(|key| self.place(&key)).collect::<Vec<_>>() {
            let Some(angle) = self.draft.number(&path).filter(|a| a.abs() > TURN) else { continue };
            let [degrees, turns] = [angle.to_degrees(), angle / TAU].map(|x| rounded(x, DIGITS));
            let message = format!("`{path}` is {degrees} deg, {turns} turns");
            self.draft.fail(&path, message).allowed("from -360 deg to 360 deg").hint("check its unit and its exponent");
        }
    }

    /// m I > S²: of all bodies with an unbalance S the one whose mass is in a point has the least moment of inertia, S²/m.
    fn unbalances(&mut self) {
        for [unbalance, inertia] in UNBALANCES {
            let (place, other) = (self.place(unbalance), self.place(inertia));
            let (Some(s), Some(i)) = (self.draft.number(&place), self.draft.number(&other)) else { continue };
            if s * s < i {
                continue;
            }
            let name = |key: &str| key.trim_start_matches("flap.").to_owned();
            let (s_name, i_name) = (name(unbalance), name(inertia));
            let message = format!(
                "`{s_name}` is {s}, but with `{i_name}` = {i} no body has its centre of mass that far from the axis: a mass in one point \
                 would have {}",
                rounded(s * s, DIGITS)
            );
            let most = rounded(i.sqrt(), DIGITS);
            self.draft.fail(&place, message).allowed(format!("between -{most} and {most}")).hint(format!(
                "`{i_name}` is about the same axis: that about the centre of mass and the square of `{s_name}`"
            ));
        }
    }
}
