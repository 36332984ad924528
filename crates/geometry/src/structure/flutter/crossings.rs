//! Points of neutral stability: where the growth rate Re λ of a branch changes sign.
use super::{Branch, Crossing, Flutter, Kind, Modes, NEUTRAL, NEWTON, Place, Point, Root, growth};

/// Relative width of the interval of a flutter point, and relative growth rate there, at which its location ends.
const LOCATED: [f64; 2] = [1e-13, 1e-15];

impl Flutter<'_> {
    /// Stability boundaries of the `branches`, and divergence below `upto`, in ascending order of speed. A motion that
    /// is unstable from the start has its boundary at zero when density is varied, and none when speed is varied.
    pub fn crossings(&self, branches: &[Vec<Point>], upto: f64) -> Vec<Crossing> {
        let Some(modes) = &self.modes else { return Vec::new() };
        let mut found = self.divergence(modes, upto);
        for (mode, branch) in branches.iter().enumerate() {
            found.extend(self.begun_at_the_start(modes, mode, branch));
            for bracket in brackets(branch) {
                let Some(root) = self.locate(modes, branch, &bracket) else { continue };
                let (x, frequency) = (root.place.x, root.lambda.im);
                let shape = modes.coordinates(&root.shape);
                let (speed, pressure) = (self.speed(x), self.pressure(x));
                let kappa = frequency / speed;
                let (kind, branch) = (bracket.kind, Branch::Mode(mode));
                found.push(Crossing { kind, branch, mode, x, speed, pressure, frequency, kappa, shape });
            }
        }
        found.sort_by(|a, b| a.x.total_cmp(&b.x));
        found
    }

    /// The root on a branch where its growth rate changes sign.
    fn locate(&self, modes: &Modes, branch: &[Point], bracket: &Bracket) -> Option<Root> {
        let [mut low, mut high] = [modes.root(branch, bracket.low)?, modes.root(branch, bracket.high)?];
        let mut size = [growth(low.lambda), growth(high.lambda)];
        let before = bracket.kind == Kind::Restabilised;
        let mut last = None;
        for _ in 0..2 * NEWTON {
            let (a, b) = (low.place.x, high.place.x);
            if b - a <= LOCATED[0] * b {
                break;
            }
            let secant = (a * size[1] - b * size[0]) / (size[1] - size[0]);
            let x = if bracket.simple && a < secant && secant < b { secant } else { 0.5 * (a + b) };
            let (mut path, arrived) = self.follow(modes, low.clone(), Place { x, on: 1.0 }, b - a);
            let root = path.pop().filter(|_| arrived)?;
            let rate = growth(root.lambda);
            if bracket.simple && rate.abs() <= LOCATED[1] {
                return Some(root);
            }
            let below = (rate > if bracket.simple { 0.0 } else { NEUTRAL }) == before;
            // the value at an end that is retained twice is halved (Illinois method)
            let kept = usize::from(below);
            if last == Some(below) {
                size[kept] *= 0.5;
            }
            size[1 - kept] = rate;
            last = Some(below);
            *(if below { &mut low } else { &mut high }) = root;
        }
        // where roots coalesce, the frequency is smooth on the unstable side
        Some(if before { low } else { high })
    }
}

/// Two points of a branch between which its growth rate changes sign.
struct Bracket {
    kind: Kind,
    low: usize,
    high: usize,
    /// True for decay on one side and growth on the other; otherwise the motion is neutral over an interval.
    simple: bool,
}

fn brackets(branch: &[Point]) -> Vec<Bracket> {
    let rates: Vec<f64> = branch.iter().map(|point| growth(point.lambda)).collect();
    let (grows, decays) = (|k: usize| rates[k] > NEUTRAL, |k: usize| rates[k] < -NEUTRAL);
    let mut found = Vec::new();
    for k in (1..rates.len()).filter(|k| grows(k - 1) != grows(*k)) {
        let kind = if grows(k) { Kind::Flutter } else { Kind::Restabilised };
        // neutral points may be followed by decay
        let sure = match kind {
            Kind::Flutter => (0..k).rev().find(|j| grows(*j) || decays(*j)),
            _ => (k..rates.len()).find(|j| grows(*j) || decays(*j)),
        };
        let sure = sure.filter(|j| decays(*j));
        let (low, high) = match kind {
            Kind::Flutter => (sure.unwrap_or(k - 1), k),
            _ => (k - 1, sure.unwrap_or(k)),
        };
        found.push(Bracket { kind, low, high, simple: sure.is_some() });
    }
    found
}
