//! Loads on finer and finer clouds, and what they say of their own error.
//!
//! Three clouds of one family, each with half the spacing of the one before: with d₁ and d₂ the last two changes of a load, the
//! observed order is p = log₂(d₁/d₂) (Richardson 1911), the limit f + d₂/(2^p − 1), and the error bar 5/4 of the way to it
//! (Roache 1994, grid convergence index). In space clouds are coarse beside noses and edges, the spacings of a family lie nearer to one another
//! (h, 4/3 h, 2 h, 8/3 h), and an order that three of them show is often an accident: there errors are taken to fall with the spacing alone, so that half a spacing
//! leaves as much as it has changed, |f(h) − f(2h)|; the last change, half of what the coarsest of four clouds tells, and half of what the load from momentum has to go are its floor. Between the orders 1 and 2 first-order errors (at shocks and corners) and second-order ones are
//! both there: the limit is that of f + a h + b h² through the three loads, which lies farther away. Where the gas is faster than sound
//! shocks are captured, whose place jumps from cell to cell: errors are taken to fall with the spacing, whatever three loads show. On families of
//! sections at transonic Mach numbers up to 134,000 particles these bars hold for 212 of 234 loads with a median of 4.9 errors; three times the way to
//! the limit of the observed order holds for 207 with a median of 5.2 (`tests/nightly/shocks.py`). Loads that swing, hardly
//! change, or change faster than the scheme can make them have no order to speak of: their bar is the honest spread, after Eça and
//! Hoekstra (2014).
//!
//! Other parts are what the end of the domain does to the loads, which is the same on all clouds; what loads from wall
//! pressure and from momentum differ by, as far as what the latter may still change by does not explain it; what the last iterations
//! changed; and the digits that are printed. Parts that know nothing of one another add as squares. Where theory has no drag, all that
//! is found is an error (d'Alembert 1752); in space this is the drag of the entropy in the wake, where nothing else could have made any.
//! Where loads stall, changing by less than wall pressure and momentum are apart, the bar is no shorter than that. A load of a section that has
//! moved to the same side twice, by less than half the second time, has not stalled: it converges.
use serde::{Deserialize, Serialize};

use super::loads::Coefficients;

/// Part of the distance to the limit that an error bar is where the order of the loads is known (Roache 1994).
const SAFETY: f64 = 1.25;
/// The same with shocks, where the observed order is not the one that is trusted: the clouds are not in the range where errors fall as a power of
/// the spacing (Oberkampf and Roy, *Verification and Validation in Scientific Computing*, 2010, §8.6).
const SAFETY_OFF: f64 = 2.0;
/// Difference of orders up to which they count as the same, there too.
const SAME_ORDER: f64 = 0.1;
/// Multiple of the last change that an error bar is where loads have no order, in smooth flow and with shocks: it may come again, to either side.
const SPREAD: [f64; 2] = [2.0, 3.0];
/// Orders that a second-order scheme with captured shocks and edges may show.
const ORDERS: [f64; 2] = [0.5, 2.2];
/// Order of the scheme, which no extrapolation goes beyond: in smooth flow, and where shocks are captured, some spacings wide.
const SCHEME_ORDER: [f64; 2] = [2.0, 1.0];
/// Part of the change before the last one that a bar is where the last one is smaller than the scheme can make it: twice h⁴ over h² in smooth
/// flow, and most of the half that an error of first order would have changed by where shocks are captured.
const LUCK: [f64; 2] = [1.0 / 8.0, 0.35];
/// Relative error of a load for a domain that ends a length of the bodies away, of second order in the distance: lift of a section
/// at Mach 0.5 with a vortex in the far field, 0.93 at 64 chords.
const FAR: f64 = 1.0;
/// Part of the difference between loads from wall pressure and from momentum that the error of the first may be, once what the
/// second may still change by is taken off; in space also part of what is left to the second.
const DISAGREEMENT: f64 = 0.5;
/// What lift, drag and moment are off for gas with too much entropy, over the drag of that entropy, at most: seen on wings between 60,000
/// and 700,000 particles (`tests/nightly/bars.py`).
const LOST: [f64; 3] = [2.5, SAFETY, 1.0];
/// Clouds that a bar in space is drawn from.
const IN_SPACE: usize = 4;
/// Part of the error that the coarsest of them tells that a bar is, at least.
const FROM_COARSEST: f64 = 0.5;
/// Least motion of a shock that is told, over the chord.
const MOVED: f64 = 5e-4;
/// Half of the last digit of a load that is printed.
const PRINTED: f64 = 5e-6;
/// Least CL, CD and CM that an error is measured by: a section at no incidence has a lift of zero, and is known well all the same.
pub const LEAST: [f64; 3] = [0.1, 0.01, 0.02];

/// Loads on one cloud of a family.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CloudLoads {
    /// Spacing over that of the case.
    pub factor: f64,
    /// Particles, images left out.
    pub particles: usize,
    /// Half-width of the domain in lengths of the bodies.
    pub reach: f64,
    /// True where the gas is faster than sound somewhere: then there are shocks.
    #[serde(default)]
    pub supersonic: bool,
    /// True where theory has no drag: a plane flow without viscosity, nowhere faster than sound, with nothing but the free stream around.
    #[serde(default)]
    pub dragless: bool,
    /// True where the flow came to rest.
    #[serde(default)]
    pub steady: bool,
    /// Lift.
    pub cl: f64,
    /// Drag.
    pub cd: f64,
    /// Moment.
    pub cm: f64,
    /// The same from the momentum of the gas around the bodies.
    pub momentum: Option<Coefficients>,
    /// Drag of entropy that nothing in the flow makes, neither shocks nor friction: an error of the scheme, seen in the wake in space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spurious_drag: Option<f64>,
    /// Where the flow along the walls falls below the speed of sound farthest downstream, on the upper and on the lower side, over the extent of
    /// the body; sections only.
    #[serde(default, skip_serializing_if = "no_places")]
    pub sonic: [Option<f64>; 2],
    /// What the last iterations changed the loads by.
    pub unsettled: Coefficients,
}

fn no_places(places: &[Option<f64>; 2]) -> bool {
    *places == [None; 2]
}

/// What a family of clouds says of one load.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoadEstimate {
    /// Observed order, where the load approaches a limit.
    pub order: Option<f64>,
    /// Its limit, where it has an order.
    pub limit: Option<f64>,
    /// Half width of the error bar around the load on the finest cloud: the root of the sum of the squares of its parts, and no less than
    /// what theory says.
    pub half_width: f64,
    /// Part of the spacing.
    pub spacing: f64,
    /// Part of the end of the domain.
    pub far_field: f64,
    /// Part of what wall pressure and momentum differ by.
    pub momentum: f64,
    /// Part of the last iterations, and of the loads on a finer cloud whose flow came to no rest.
    pub residual: f64,
    /// What the load is off the one that theory knows.
    #[serde(default)]
    pub theory: f64,
}

impl LoadEstimate {
    /// Half width that the clouds alone tell, whatever theory knows.
    pub fn told_by_clouds(&self) -> f64 {
        let parts = [self.spacing, self.far_field, self.momentum, self.residual, PRINTED];
        parts.iter().map(|p| p * p).sum::<f64>().sqrt()
    }
}

/// A family of clouds, and the error bars of the loads on the finest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Convergence {
    /// Coarse to fine.
    pub clouds: Vec<CloudLoads>,
    /// A finer cloud, whose flow came to no rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unsteady: Option<CloudLoads>,
    /// Lift.
    pub cl: LoadEstimate,
    /// Drag.
    pub cd: LoadEstimate,
    /// Moment.
    pub cm: LoadEstimate,
    /// Half width over the load that was asked for.
    pub asked: f64,
    /// What ended the family.
    pub ended_by: FamilyEnd,
}

/// What ends a family of clouds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FamilyEnd {
    /// All error bars are as short as was asked.
    Accuracy,
    /// A finer cloud would have more particles than allowed.
    Particles,
    /// A finer cloud would take more time than allowed.
    Time,
    /// On a finer cloud there is no steady flow.
    Unsteady,
}

impl Convergence {
    /// The error bars of the loads on the last of `clouds`, which were to be `asked` over the loads; `None` for fewer than three
    /// clouds, each half as fine as the next, or fewer than four of others. A finer one among those before the last found no steady flow.
    pub fn of(clouds: &[CloudLoads], asked: f64) -> Option<Self> {
        let last = clouds.last()?;
        let unsteady = clouds.iter().find(|finer| finer.factor < last.factor).copied();
        let clouds: Vec<CloudLoads> = clouds.iter().filter(|c| c.factor >= last.factor).copied().collect();
        let [.., a, b, c] = &clouds[..] else { return None };
        let halved = a.factor == 2.0 * b.factor && b.factor == 2.0 * c.factor;
        let four = clouds.last_chunk::<IN_SPACE>().filter(|_| !halved);
        if !halved && four.is_none() {
            return None;
        }
        let of = |load: fn(&CloudLoads) -> f64, part: fn(&Coefficients) -> f64, theory: f64| {
            let found = match four {
                None => estimate([load(a), load(b), load(c)], c.supersonic),
                Some(four) => first_order(four, load, part),
            };
            let far_field = FAR * load(c).abs() / c.reach.powi(2);
            let through = |cloud: &CloudLoads| cloud.momentum.as_ref().map(part);
            let momentum = through(c).map_or(0.0, |value| {
                let change = through(b).map_or(0.0, |b| to_come(through(a), [b, value], c.supersonic));
                let apart = (load(c) - value).abs();
                let last = load(c) - load(b);
                let converges = halved && (load(b) - load(a)) / last >= 2.0;
                let stalled = found.order.is_none() && !converges && last.abs() < apart;
                (DISAGREEMENT * (apart - change).max(0.0)).max(if stalled { apart } else { 0.0 })
            });
            let swing = |finer: &CloudLoads| (load(finer) - load(c)).abs() + part(&finer.unsettled).abs();
            let residual = part(&c.unsettled).abs().max(unsteady.as_ref().map_or(0.0, swing));
            let parts = LoadEstimate { far_field, momentum, residual, theory, ..found };
            LoadEstimate { half_width: parts.told_by_clouds().max(theory), ..parts }
        };
        let [lift, drag, moment] = LOST.map(|lost| lost * c.spurious_drag.unwrap_or(0.0).abs());
        let drag = if c.dragless { c.cd.abs() } else { drag };
        let all = [of(|l| l.cl, |m| m.cl, lift), of(|l| l.cd, |m| m.cd, drag), of(|l| l.cm, |m| m.cm, moment)];
        let values = [c.cl, c.cd, c.cm];
        let short = |k: usize| all[k].half_width <= asked * values[k].abs().max(LEAST[k]);
        let [cl, cd, cm] = all;
        let ended_by = match unsteady {
            _ if (0..3).all(short) => FamilyEnd::Accuracy,
            Some(_) => FamilyEnd::Unsteady,
            None => FamilyEnd::Particles,
        };
        Some(Self { clouds, unsteady, cl, cd, cm, asked, ended_by })
    }

    /// Names of the loads whose error bars are longer than was asked.
    pub fn long_bars(&self) -> Vec<String> {
        let Some(c) = self.clouds.last() else { return Vec::new() };
        let all = [("CL", c.cl, &self.cl), ("CD", c.cd, &self.cd), ("CM", c.cm, &self.cm)];
        let long = all
            .into_iter()
            .zip(LEAST)
            .filter(|((_, value, found), least)| found.half_width > self.asked * value.abs().max(*least));
        long.map(|((name, ..), _)| name.to_owned()).collect()
    }

    /// Why error bars of a section with shocks are longer than was asked, for people: how far the shocks moved with the last refinement.
    /// `None` where none is long, or nothing moved.
    pub fn moved_shocks(&self) -> Option<String> {
        let long = self.long_bars();
        let [.., before, last] = &self.clouds[..] else { return None };
        let moved = |(side, [a, b]): (&str, [Option<f64>; 2])| {
            let (a, b) = (a?, b?);
            ((a - b).abs() >= MOVED).then(|| format!("on the {side} side from {a:.3} to {b:.3} of the chord"))
        };
        let sides = [("upper", [before.sonic[0], last.sonic[0]]), ("lower", [before.sonic[1], last.sonic[1]])];
        let moved: Vec<String> = sides.into_iter().filter_map(moved).collect();
        (last.supersonic && !long.is_empty() && !moved.is_empty()).then(|| {
            format!("with the last refinement the shock moved {}, and {} with it", moved.join(", "), long.join(", "))
        })
    }

    /// True when all error bars are as short as was asked.
    pub fn reached(&self) -> bool {
        self.ended_by == FamilyEnd::Accuracy
    }

    /// The same family, where time ended it.
    pub fn out_of_time(self) -> Self {
        match self.ended_by {
            FamilyEnd::Particles => Self { ended_by: FamilyEnd::Time, ..self },
            _ => self,
        }
    }

    /// Half widths of all error bars.
    pub fn half_widths(&self) -> Coefficients {
        Coefficients { cl: self.cl.half_width, cd: self.cd.half_width, cm: self.cm.half_width }
    }
}

/// What a load from momentum may still change by: all that it changed by the last time, less where it came nearer at each refinement.
fn to_come(before: Option<f64>, [b, c]: [f64; 2], shocks: bool) -> f64 {
    let last = (c - b).abs();
    let order = before.map_or(0.0, |a| ((b - a) / (c - b)).log2());
    if order >= 1.0 { last / (order.min(SCHEME_ORDER[usize::from(shocks)]).exp2() - 1.0) } else { last }
}

/// The estimate from four clouds, coarse to fine, whose errors are taken to fall with the spacing: of the part of the spacing alone. Momentum
/// is a second evaluation of the same load: half of what it has still to go is the least error.
fn first_order(
    clouds: &[CloudLoads; IN_SPACE],
    load: fn(&CloudLoads) -> f64,
    part: fn(&Coefficients) -> f64,
) -> LoadEstimate {
    let [coarsest, coarser, before, last] = clouds;
    let ratio = |cloud: &CloudLoads| cloud.factor / last.factor - 1.0;
    let way = |cloud: &CloudLoads| (load(last) - load(cloud)).abs() / ratio(cloud);
    let both = last.momentum.as_ref().zip(coarser.momentum.as_ref());
    let second = both.map_or(0.0, |(last, before)| (part(last) - part(before)).abs() / ratio(coarser));
    let change = (load(last) - load(before)).abs();
    let own = (SAFETY * way(coarser)).max(change).max(FROM_COARSEST * way(coarsest));
    let spacing = own.max(DISAGREEMENT * second);
    LoadEstimate { spacing, ..LoadEstimate::default() }
}

/// The estimate from values at spacings 4, 2 and 1, of the part of the spacing alone.
fn estimate([a, b, c]: [f64; 3], shocks: bool) -> LoadEstimate {
    let [before, last] = [b - a, c - b];
    let [most, luck, spread] = [SCHEME_ORDER, LUCK, SPREAD].map(|of| of[usize::from(shocks)]);
    let order = (before / last).log2();
    if (ORDERS[0]..=ORDERS[1]).contains(&order) {
        let way = match order {
            // shocks jump from cell to cell: errors of first order, whatever three loads show
            _ if shocks => last,
            // the limit of f + a h + b h² through the three
            p if 1.0 < p && p < most => (5.0 * last - before) / 3.0,
            p => last / (p.min(most).exp2() - 1.0),
        };
        let known = !shocks || (order - most).abs() <= SAME_ORDER;
        let spacing = if known { SAFETY } else { SAFETY_OFF } * way.abs();
        return LoadEstimate { order: Some(order), limit: Some(c + way), spacing, ..LoadEstimate::default() };
    }
    LoadEstimate { spacing: (spread * last.abs()).max(luck * before.abs()), ..LoadEstimate::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_of_an_order_have_their_limit_within_the_bar() {
        for order in [0.7, 1.0, 2.0] {
            let at = |h: f64| 0.3 + 0.02 * h.powf(order);
            let e = estimate([at(4.0), at(2.0), at(1.0)], false);
            assert!((e.order.unwrap() - order).abs() < 1e-9 && (e.limit.unwrap() - 0.3).abs() < 1e-9, "{e:?}");
            assert!(e.spacing > 0.02 && e.spacing < 0.026, "{e:?}");
        }
        let both = |h: f64| 0.3 + 0.01 * h + 0.01 * h * h;
        let e = estimate([both(4.0), both(2.0), both(1.0)], false);
        assert!((1.0..2.0).contains(&e.order.unwrap()) && (e.limit.unwrap() - 0.3).abs() < 1e-9, "{e:?}");
    }

    #[test]
    fn captured_shocks_leave_an_error_of_first_order() {
        for values in [[0.5, 0.35, 0.3], [0.5, 0.31, 0.309], [0.5, 0.3, 0.21]] {
            let [smooth, shocks] = [false, true].map(|with| estimate(values, with));
            let last = f64::abs(values[2] - values[1]);
            assert!(shocks.spacing >= 1.25 * last && shocks.spacing > smooth.spacing, "{smooth:?}, {shocks:?}");
        }
    }

    #[test]
    fn loads_without_an_order_have_their_spread() {
        for values in [[1.0, 2.0, 1.5], [1.0, 1.1, 1.1], [1.0, 1.1, 1.11], [1.0, 1.1, 1.3], [1.0, 1.0, 1.0]] {
            let e = estimate(values, false);
            assert_eq!((e.order, e.limit), (None, None), "{values:?}");
            assert!(e.spacing >= (values[2] - values[1]).abs() && e.spacing.is_finite(), "{e:?}");
        }
    }

    /// Loads on a cloud with this factor on its spacing, of which only lift counts.
    fn cloud(factor: f64, cl: f64) -> CloudLoads {
        CloudLoads {
            factor,
            particles: 10,
            reach: 1e3,
            supersonic: false,
            dragless: false,
            steady: true,
            cl,
            cd: 0.0,
            cm: 0.0,
            momentum: None,
            spurious_drag: None,
            sonic: [None; 2],
            unsettled: Coefficients::default(),
        }
    }

    /// Those on the four clouds of a family in space.
    fn in_space(load: impl Fn(f64) -> f64) -> [CloudLoads; 4] {
        [8.0 / 3.0, 2.0, 4.0 / 3.0, 1.0].map(|h| cloud(h, load(h)))
    }

    #[test]
    fn bars_in_space_hold_errors_that_fall_with_the_spacing() {
        for error in [|h: f64| h, |h: f64| h * h, |h: f64| 0.5 * h + 0.5 * h * h] {
            let found = Convergence::of(&in_space(|h| 0.3 - 0.01 * error(h)), 0.01).unwrap();
            assert!((0.01..0.04).contains(&found.cl.half_width), "{found:?}");
        }
        assert_eq!(Convergence::of(&in_space(|h| h)[1..], 0.01), None);
    }

    #[test]
    fn a_load_in_space_has_no_shorter_bar_than_its_momentum() {
        let through = |cloud: CloudLoads| {
            let cl = 0.3 - 0.01 * cloud.factor;
            CloudLoads { momentum: Some(Coefficients { cl, ..Coefficients::default() }), ..cloud }
        };
        let found = Convergence::of(&in_space(|_| 0.29).map(through), 0.01).unwrap();
        assert!((found.cl.spacing - 0.005).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn a_load_in_space_that_stands_still_by_chance_keeps_its_bar() {
        // the last two clouds agree, those before do not
        let by_chance = |h: f64| if h < 1.5 { 0.3 } else { 0.3 - 0.01 * (h - 1.0) };
        assert!(Convergence::of(&in_space(by_chance), 0.01).unwrap().cl.half_width > 0.012);
        let mut steps = in_space(|h| if h > 1.2 { 0.3 } else { 0.31 });
        assert!(Convergence::of(&steps, 0.01).unwrap().cl.half_width >= 0.01);
        // what the wake has lost of its total pressure was lost by the scheme
        steps[3] = CloudLoads { spurious_drag: Some(0.004), ..cloud(1.0, 0.3) };
        let found = Convergence::of(&steps, 0.01).unwrap();
        assert!(found.cd.half_width >= 0.005 && found.cl.half_width >= 0.01, "{found:?}");
    }

    #[test]
    fn loads_that_stall_are_no_surer_than_walls_and_momentum_agree() {
        let through = |cloud: CloudLoads, cl: f64| CloudLoads {
            momentum: Some(Coefficients { cl, ..Coefficients::default() }),
            ..cloud
        };
        let clouds = [
            through(cloud(4.0, 0.2731), 0.2776),
            through(cloud(2.0, 0.27306), 0.2741),
            through(cloud(1.0, 0.27307), 0.27318),
        ];
        assert!(Convergence::of(&clouds, 0.01).unwrap().cl.half_width >= 1.1e-4);
        // the same last change and the same difference, after larger changes to the same side
        let clouds = [
            through(cloud(4.0, 0.2700), 0.2776),
            through(cloud(2.0, 0.27300), 0.2741),
            through(cloud(1.0, 0.27301), 0.27312),
        ];
        let found = Convergence::of(&clouds, 0.01).unwrap().cl;
        // an eighth of the change before the last
        assert!(found.momentum == 0.0 && found.half_width < 4e-4, "{found:?}");
    }

    #[test]
    fn bars_are_measured_by_what_was_asked() {
        let clouds = [cloud(4.0, 0.34), cloud(2.0, 0.31), cloud(1.0, 0.3025)];
        assert_eq!(Convergence::of(&clouds[1..], 0.01), None);
        let c = Convergence::of(&clouds, 0.01).unwrap();
        assert!(c.half_widths().cl > 0.0030 && !c.reached(), "{c:?}");
        assert!(Convergence::of(&clouds, 0.02).unwrap().reached());
        let with = |cloud: CloudLoads, cl: f64| CloudLoads {
            momentum: Some(Coefficients { cl, ..Coefficients::default() }),
            ..cloud
        };
        let apart = [clouds[0], with(clouds[1], 0.2905), with(clouds[2], 0.2905)];
        let wider = Convergence::of(&apart, 0.02).unwrap();
        assert!((wider.cl.momentum - 0.006).abs() < 1e-12 && !wider.reached(), "{wider:?}");
        let approaching = [clouds[0], with(clouds[1], 0.2785), with(clouds[2], 0.2905)];
        assert!(Convergence::of(&approaching, 0.02).unwrap().cl.momentum < 1e-12);
        let unsettled = Coefficients { cl: 0.006, ..Coefficients::default() };
        let drag = CloudLoads { dragless: true, cd: 3e-4, ..clouds[2] };
        let found = Convergence::of(&[clouds[0], clouds[1], drag], 0.02).unwrap();
        assert!(found.cd.half_width >= 3e-4 && found.cd.theory == 3e-4 && found.cl == c.cl, "{found:?}");
        let swinging = Convergence::of(&[clouds[0], clouds[1], CloudLoads { unsettled, ..clouds[2] }], 0.02).unwrap();
        assert!(swinging.cl.half_width > c.cl.half_width && !swinging.reached(), "{swinging:?}");
        let finer = CloudLoads { steady: false, unsettled, ..cloud(0.5, 0.32) };
        let back = Convergence::of(&[clouds[0], clouds[1], finer, clouds[2]], 0.02).unwrap();
        assert_eq!((back.clouds.len(), back.ended_by), (3, FamilyEnd::Unsteady));
        assert!(
            (back.cl.residual - 0.0235).abs() < 1e-12 && back.cl.half_width > 0.0235,
            "holds what the finer one swings by"
        );
    }
}
