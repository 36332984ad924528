//! Half thickness of NACA sections of the 6-series, mapped from a circle.
//!
//! A section ζ = z + 1/z is the image of a near circle z = exp(ψ + i (φ − ε)) about the unit circle (Theodorsen, NACA report 411, 1931).
//! ε(φ) and ψ(φ) define a family; sections of other thickness have both times one factor (Abbott, von Doenhoff and Stivers, NACA
//! report 824, 1945), here the one that gives the thickness asked for. The functions are those of the program of NASA TM 4741 (Ladson,
//! Brooks, Hill and Sproles 1996), every fifth of its 201 values, joined by cubic splines. Ordinates lie within 4e-5 chord of the
//! published ones (64-010), those of the A-series within 1.3e-4 at the nose (64A010).
//!
//! The A-series is straight from 0.8 chord on. Its published ordinates end with a base; the line goes on along the tangent, and a closed
//! end takes the base off by a parabola.
use std::f64::consts::PI;

use super::super::spline::{End, Spline};
use crate::case::SixSeries;
use crate::math::Vector;

/// Where sections of the A-series become straight.
const STRAIGHT: f64 = 0.8;
/// Intervals of φ from nose to end.
const INTERVALS: usize = 40;
/// ε and ψ at φ = kπ/40 in units of 1e-5.
const FAMILIES: [[[i32; INTERVALS + 1]; 2]; 8] = [
    // 63
    [
        [
            0, 790, 1367, 1601, 1661, 1747, 1884, 2058, 2268, 2517, 2801, 3118, 3465, 3839, 4237, 4657, 5098, 5556,
            6011, 6440, 6832, 7176, 7464, 7690, 7848, 7933, 7938, 7856, 7685, 7423, 7070, 6628, 6103, 5502, 4834, 4106,
            3333, 2527, 1698, 853, 0,
        ],
        [
            15_066, 14_891, 14_497, 14_074, 13_753, 13_610, 13_576, 13_561, 13_547, 13_533, 13_511, 13_475, 13_414,
            13_321, 13_194, 13_028, 12_808, 12_521, 12_160, 11_724, 11_218, 10_650, 10_029, 9363, 8657, 7917, 7153,
            6374, 5591, 4817, 4065, 3350, 2682, 2071, 1527, 1062, 680, 382, 169, 42, 0,
        ],
    ],
    // 64
    [
        [
            0, 1130, 2035, 2557, 2812, 2957, 3090, 3280, 3538, 3862, 4250, 4699, 5208, 5774, 6395, 7070, 7808, 8613,
            9462, 10_321, 11_125, 11_814, 12_386, 12_844, 13_182, 13_389, 13_459, 13_387, 13_166, 12_792, 12_261,
            11_573, 10_735, 9758, 8645, 7403, 6052, 4615, 3113, 1567, 0,
        ],
        [
            25_269, 25_147, 24_730, 24_016, 23_325, 22_956, 22_818, 22_755, 22_730, 22_736, 22_751, 22_755, 22_736,
            22_683, 22_584, 22_426, 22_203, 21_899, 21_449, 20_795, 19_966, 19_009, 17_950, 16_807, 15_596, 14_331,
            13_024, 11_688, 10_338, 8992, 7671, 6398, 5193, 4072, 3051, 2147, 1385, 786, 353, 89, 0,
        ],
    ],
    // 65
    [
        [
            0, 810, 1515, 1795, 1943, 1865, 1715, 1727, 1821, 1983, 2211, 2474, 2772, 3119, 3510, 3938, 4404, 4914,
            5467, 6055, 6653, 7234, 7771, 8244, 8614, 8866, 9017, 9061, 8982, 8765, 8427, 7976, 7368, 6448, 5228, 3991,
            2939, 2059, 1302, 630, 0,
        ],
        [
            17_464, 17_285, 16_808, 16_086, 15_523, 15_278, 15_235, 15_269, 15_350, 15_445, 15_536, 15_615, 15_678,
            15_718, 15_731, 15_713, 15_653, 15_552, 15_393, 15_141, 14_779, 14_295, 13_680, 12_958, 12_154, 11_281,
            10_353, 9389, 8401, 7393, 6385, 5392, 4422, 3481, 2590, 1802, 1154, 650, 289, 72, 0,
        ],
    ],
    // 66
    [
        [
            0, 712, 1340, 1789, 1940, 1741, 1450, 1331, 1350, 1419, 1530, 1689, 1890, 2124, 2390, 2690, 3020, 3378,
            3770, 4202, 4670, 5171, 5730, 6362, 7020, 7644, 8180, 8585, 8850, 8972, 8940, 8745, 8390, 7876, 7190, 6324,
            5290, 4109, 2810, 1427, 0,
        ],
        [
            16_457, 16_386, 16_037, 15_316, 14_604, 14_281, 14_236, 14_280, 14_366, 14_481, 14_601, 14_704, 14_790,
            14_862, 14_917, 14_950, 14_961, 14_948, 14_908, 14_835, 14_725, 14_571, 14_360, 14_067, 13_615, 12_943,
            12_108, 11_183, 10_180, 9106, 7989, 6859, 5733, 4627, 3566, 2579, 1705, 980, 439, 110, 0,
        ],
    ],
    // 67
    [
        [
            0, 835, 1591, 2004, 2259, 2270, 2126, 2030, 1979, 1968, 1997, 2054, 2135, 2245, 2386, 2555, 2752, 2976,
            3232, 3522, 3849, 4213, 4622, 5092, 5610, 6187, 6814, 7450, 8009, 8422, 8659, 8732, 8602, 8025, 6908, 5568,
            4301, 3137, 2049, 1011, 0,
        ],
        [
            18_028, 17_927, 17_403, 16_708, 16_085, 15_583, 15_278, 15_135, 15_048, 14_997, 14_982, 14_986, 15_002,
            15_023, 15_046, 15_070, 15_095, 15_108, 15_110, 15_103, 15_076, 15_026, 14_945, 14_817, 14_628, 14_362,
            13_974, 13_391, 12_560, 11_520, 10_386, 9168, 7840, 6412, 4935, 3536, 2327, 1345, 615, 158, 0,
        ],
    ],
    // 63A
    [
        [
            0, 734, 1405, 1642, 1751, 1787, 1813, 1945, 2134, 2342, 2569, 2832, 3125, 3432, 3759, 4114, 4496, 4879,
            5243, 5594, 5921, 6200, 6422, 6597, 6714, 6755, 6720, 6615, 6441, 6198, 5896, 5555, 5152, 4615, 3959, 3266,
            2589, 1927, 1279, 637, 0,
        ],
        [
            15_517, 15_257, 14_634, 14_058, 13_753, 13_596, 13_521, 13_488, 13_468, 13_447, 13_420, 13_380, 13_322,
            13_239, 13_131, 12_989, 12_792, 12_540, 12_228, 11_851, 11_416, 10_928, 10_395, 9825, 9221, 8590, 7941,
            7288, 6650, 6035, 5441, 4872, 4315, 3741, 3186, 2745, 2464, 2311, 2248, 2238, 2243,
        ],
    ],
    // 64A
    [
        [
            0, 786, 1507, 1776, 1899, 1898, 1846, 1900, 2010, 2144, 2306, 2509, 2749, 3009, 3295, 3618, 3984, 4374,
            4772, 5172, 5554, 5884, 6147, 6357, 6508, 6585, 6586, 6517, 6376, 6161, 5881, 5557, 5168, 4643, 3997, 3309,
            2630, 1963, 1304, 651, 0,
        ],
        [
            15_365, 15_098, 14_473, 13_819, 13_407, 13_170, 13_038, 12_969, 12_949, 12_947, 12_942, 12_937, 12_925,
            12_894, 12_841, 12_762, 12_652, 12_500, 12_281, 11_958, 11_554, 11_088, 10_568, 10_009, 9416, 8793, 8147,
            7495, 6848, 6215, 5604, 5020, 4450, 3859, 3288, 2827, 2524, 2348, 2266, 2242, 2243,
        ],
    ],
    // 65A
    [
        [
            0, 733, 1413, 1676, 1804, 1775, 1642, 1556, 1545, 1598, 1708, 1874, 2075, 2285, 2522, 2802, 3122, 3455,
            3806, 4197, 4610, 5004, 5356, 5670, 5931, 6117, 6227, 6275, 6254, 6147, 5948, 5685, 5343, 4857, 4234, 3546,
            2847, 2141, 1430, 716, 0,
        ],
        [
            14_761, 14_435, 13_785, 13_296, 12_892, 12_476, 12_219, 12_222, 12_279, 12_331, 12_387, 12_435, 12_472,
            12_496, 12_502, 12_487, 12_448, 12_377, 12_266, 12_099, 11_859, 11_534, 11_122, 10_639, 10_107, 9532, 8921,
            8282, 7622, 6949, 6275, 5621, 4985, 4333, 3695, 3156, 2763, 2500, 2341, 2263, 2242,
        ],
    ],
];

/// A form of half thickness.
#[derive(Clone, Debug)]
pub(super) struct Six {
    /// ε and ψ of the family against φ from −π to 2π.
    functions: Spline<2>,
    /// Factor of both.
    scale: f64,
    tail: Option<Tail>,
}

/// The straight part: half thickness and slope where it begins, and the base that is taken off.
#[derive(Clone, Copy, Debug)]
struct Tail {
    height: f64,
    slope: f64,
    base: f64,
}

impl Six {
    /// The form with a greatest thickness, closed at x = 1 or as published.
    pub(super) fn new(thickness: f64, series: SixSeries, closed: bool) -> Self {
        let mut form = Self { functions: functions(series), scale: 1.0, tail: None };
        // the thickness is nearly proportional to the factor
        for _ in 0..20 {
            form.scale *= 0.5 * thickness / form.greatest();
        }
        if series.straight {
            let root = STRAIGHT.sqrt();
            let (height, half_slope) = form.at(root);
            let slope = half_slope / (2.0 * root);
            let base = if closed { height + slope * (1.0 - STRAIGHT) } else { 0.0 };
            form.tail = Some(Tail { height, slope, base });
        }
        form
    }

    /// Half thickness and its derivative with respect to s = √x.
    pub(super) fn at(&self, s: f64) -> (f64, f64) {
        let x = s * s;
        if let Some(tail) = &self.tail
            && x > STRAIGHT
        {
            let part = (x - STRAIGHT) / (1.0 - STRAIGHT);
            let value = tail.height + tail.slope * (x - STRAIGHT) - tail.base * part * part;
            return (value, 2.0 * s * (tail.slope - 2.0 * tail.base * part / (1.0 - STRAIGHT)));
        }
        if s >= 1.0 {
            return (0.0, 0.0);
        }
        // at the nose both coordinates vanish: the derivative is their ratio next to it
        let phi = if s > 0.0 { self.parameter(x) } else { 1e-4 };
        let (point, tangent) = self.point(phi);
        if s > 0.0 { (point[1], 2.0 * s * tangent[1] / tangent[0]) } else { (0.0, point[1] / point[0].sqrt()) }
    }

    /// φ of a point of the chord, by bisection: x rises with φ.
    fn parameter(&self, x: f64) -> f64 {
        let (mut low, mut high) = (0.0, PI);
        while high - low > 1e-15 * PI {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if self.point(middle).0[0] < x { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Point of the upper side of unit chord and its derivative with respect to φ.
    fn point(&self, phi: f64) -> (Vector<2>, Vector<2>) {
        let (value, slope) = self.at_phi(phi);
        let (theta, turn) = (phi - value[0], 1.0 - slope[0]);
        let (nose, end) = (self.at_phi(0.0).0[1].cosh(), self.at_phi(PI).0[1].cosh());
        let ((cosh, sinh), (sin, cos)) = ((value[1].cosh(), value[1].sinh()), theta.sin_cos());
        let point = Vector([nose - cosh * cos, sinh * sin]);
        let tangent = Vector([cosh * sin * turn - sinh * cos * slope[1], sinh * cos * turn + cosh * sin * slope[1]]);
        let chord = nose + end;
        (point * (1.0 / chord), tangent * (1.0 / chord))
    }

    /// ε and ψ with their derivatives.
    fn at_phi(&self, phi: f64) -> (Vector<2>, Vector<2>) {
        let place = phi / PI * INTERVALS as f64;
        let k = place.clamp(0.0, (INTERVALS - 1) as f64).floor();
        let (value, slope) = self.functions.at(INTERVALS + k as usize, place - k);
        (value * self.scale, slope * self.scale)
    }

    /// Greatest half thickness.
    fn greatest(&self) -> f64 {
        let (mut low, mut high) = (0.05 * PI, 0.95 * PI);
        // the slope falls through zero
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.point(middle).1[1] > 0.0 { low = middle } else { high = middle }
        }
        self.point(low).0[1]
    }
}

/// ε, odd about nose and end, and ψ, even: mirrored, so that the spline between them knows no end.
fn functions(series: SixSeries) -> Spline<2> {
    let first = if series.straight { 5 } else { 0 };
    let family = &FAMILIES[first + series.place - 3];
    let n = INTERVALS as i32;
    let knots = (-n..=2 * n).map(|k| f64::from(k) * PI / f64::from(n)).collect();
    let at = |k: i32| {
        let (i, side) = if k < 0 {
            (-k, -1.0)
        } else if k > n {
            (2 * n - k, -1.0)
        } else {
            (k, 1.0)
        };
        Vector([side * f64::from(family[0][i as usize]), f64::from(family[1][i as usize])]) * 1e-5
    };
    Spline::over(knots, (-n..=2 * n).map(at).collect(), End::Natural, End::Natural)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(place: usize, straight: bool, thickness: f64, closed: bool) -> Six {
        Six::new(thickness, SixSeries { place, straight }, closed)
    }

    /// Ordinates in % chord of NACA 64-010 and 64A010 (Abbott and von Doenhoff 1959, p. 336; Loftin, NACA report 903, 1948).
    const STATIONS: [f64; 16] =
        [0.5, 0.75, 1.25, 2.5, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 85.0, 90.0, 95.0];
    const PLAIN: [f64; 16] = [
        0.820, 0.989, 1.250, 1.701, 2.343, 3.221, 4.302, 4.864, 4.988, 4.586, 3.820, 2.827, 1.722, 1.176, 0.671, 0.248,
    ];
    const STRAIGHT_END: [f64; 16] = [
        0.804, 0.969, 1.225, 1.688, 2.327, 3.199, 4.272, 4.837, 4.995, 4.684, 4.021, 3.127, 2.103, 1.582, 1.062, 0.541,
    ];

    #[test]
    fn ordinates_are_the_published_ones() {
        for (straight, ordinates, nose, rest) in [(false, PLAIN, 4e-5, 4e-5), (true, STRAIGHT_END, 1.3e-4, 4e-5)] {
            let form = form(4, straight, 0.1, false);
            for (x, y) in STATIONS.into_iter().zip(ordinates) {
                let found = 100.0 * form.at((0.01 * x).sqrt()).0;
                let bound = if x < 5.0 { nose } else { rest };
                assert!((found - y).abs() < 100.0 * bound + 5e-4, "{straight} {x} {y} {found}");
            }
        }
    }

    #[test]
    fn every_family_has_its_thickness_and_true_slopes() {
        for place in 3..=7 {
            for straight in [false, true] {
                if straight && place > 5 {
                    continue;
                }
                for thickness in [0.04, 0.12, 0.21] {
                    let form = form(place, straight, thickness, true);
                    let at = |x: f64| form.at(x.sqrt()).0;
                    let (x, greatest) = (1..1000)
                        .map(|i| (f64::from(i) / 1000.0, at(f64::from(i) / 1000.0)))
                        .fold((0.0, 0.0), |best, p| if p.1 > best.1 { p } else { best });
                    assert!((greatest - 0.5 * thickness).abs() < 1e-6 * thickness, "{place} {thickness} {greatest}");
                    assert!((0.33..0.51).contains(&x), "{place} {thickness} {x}");
                    assert!(form.at(1.0).0.abs() < 1e-15);
                    let (nose, next) = (form.at(0.0).1, form.at(1e-3).1);
                    assert!((nose / next - 1.0).abs() < 5e-3, "{place} {thickness} {nose} {next}");
                    for s in [0.05, 0.3, 0.7, 0.9, 0.97] {
                        let slope = (form.at(s + 1e-6).0 - form.at(s - 1e-6).0) / 2e-6;
                        assert!((slope - form.at(s).1).abs() < 2e-6, "{place} {s} {slope} {:?}", form.at(s));
                    }
                }
            }
        }
    }
}
