//! Colours and colour scales.
//!
//! The scales run along curves in Oklab (Ottosson 2020, "A perceptual color space for image processing"), in which equal
//! distances look equally different: lightness grows at a constant rate along the sequential scale, and falls at a
//! constant rate on both sides of the middle of the diverging one.
use std::f64::consts::PI;
use std::sync::LazyLock;

/// A colour with opacity, 0 to 255 each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour {
    /// Red.
    pub r: u8,
    /// Green.
    pub g: u8,
    /// Blue.
    pub b: u8,
    /// Opacity.
    pub a: u8,
}

impl Colour {
    /// White paper.
    pub const PAPER: Self = Self::rgb(255, 255, 255);
    /// Text and axes.
    pub const INK: Self = Self::rgb(32, 36, 44);
    /// Secondary text and ticks.
    pub const GREY: Self = Self::rgb(110, 117, 128);
    /// Grid lines.
    pub const GRID: Self = Self::rgb(226, 229, 234);
    /// Bodies.
    pub const BODY: Self = Self::rgb(232, 234, 237);

    /// An opaque colour.
    pub const fn rgb(r: u8, g: u8, b: u8) -> Self {
        Self { r, g, b, a: 255 }
    }

    /// The same colour with opacity `a`.
    pub const fn faded(self, a: u8) -> Self {
        Self { a, ..self }
    }

    /// `#rrggbb`.
    pub fn hex(&self) -> String {
        format!("#{:02x}{:02x}{:02x}", self.r, self.g, self.b)
    }

    /// From 0 for what cannot be seen to 1.
    pub fn opacity(&self) -> f64 {
        f64::from(self.a) / 255.0
    }

    /// This colour under `light`, 1 for unchanged.
    pub(crate) fn lit(self, light: f64) -> Self {
        let shade = |c: u8| (f64::from(c) * light).round().clamp(0.0, 255.0) as u8;
        Self { r: shade(self.r), g: shade(self.g), b: shade(self.b), a: self.a }
    }
}

/// Distinct colours of curves, in order: dark enough on white, light enough on a dark page.
pub const CURVES: [Colour; 6] = [
    Colour::rgb(31, 111, 209),
    Colour::rgb(217, 95, 43),
    Colour::rgb(29, 150, 117),
    Colour::rgb(165, 87, 190),
    Colour::rgb(196, 148, 22),
    Colour::rgb(108, 122, 137),
];

/// A scale from values to colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Colormap {
    /// Dark violet over teal to pale yellow: ordered quantities.
    Sequential,
    /// Blue over near-white at `centre` to red: quantities with a meaningful middle, such as Mach number 1.
    Diverging {
        /// The value in the middle.
        centre: f64,
    },
}

impl Colormap {
    /// The colour of `value` on a scale over `range`; values outside get the colour of the end.
    pub fn colour(&self, value: f64, range: [f64; 2]) -> Colour {
        match self {
            Self::Sequential => looked_up(&SEQUENTIAL, fraction(value, range)),
            Self::Diverging { centre } => {
                // Both arms share one rate, so that equal departures look equally strong.
                let reach = (range[1] - centre).abs().max((centre - range[0]).abs());
                looked_up(&DIVERGING, fraction(value, [centre - reach, centre + reach]))
            }
        }
    }
}

/// Steps into which a scale is divided: finer than colours can tell.
const STEPS: usize = 4096;
static SEQUENTIAL: LazyLock<Vec<Colour>> = LazyLock::new(|| steps(sequential));
static DIVERGING: LazyLock<Vec<Colour>> = LazyLock::new(|| steps(diverging));

fn steps(colour: fn(f64) -> Colour) -> Vec<Colour> {
    (0..=STEPS).map(|k| colour(k as f64 / STEPS as f64)).collect()
}

/// The colour at the fraction `s` of a scale.
fn looked_up(scale: &[Colour], s: f64) -> Colour {
    scale[(s * STEPS as f64).round() as usize]
}

fn fraction(value: f64, range: [f64; 2]) -> f64 {
    let width = range[1] - range[0];
    if width > 0.0 && value.is_finite() { ((value - range[0]) / width).clamp(0.0, 1.0) } else { 0.5 }
}

/// Lightness 0.24 → 0.93 linearly; hue from violet (300°) through blue and teal down to yellow (102°).
fn sequential(s: f64) -> Colour {
    let lightness = 0.24 + 0.69 * s;
    let hue = (302.0 - 200.0 * s).to_radians();
    // Less chroma in the middle, where teal leaves the gamut first.
    let chroma = 0.105 + 0.055 * (PI * (s - 0.02)).cos().powi(2) * if s < 0.5 { 0.45 } else { 1.0 };
    oklab(lightness, chroma * hue.cos(), chroma * hue.sin())
}

/// Blue (hue 255°) and red (30°): lightness 0.42 at both ends, 0.965 in the middle.
fn diverging(s: f64) -> Colour {
    let departure = (2.0 * s - 1.0).abs();
    let hue = if s < 0.5 { 255.0_f64 } else { 30.0 }.to_radians();
    // Chroma rises faster than lightness falls, so that weak departures already show their side.
    let chroma = 0.17 * departure.powf(0.75);
    oklab(0.965 - 0.545 * departure, chroma * hue.cos(), chroma * hue.sin())
}

/// Oklab to sRGB (matrices of the reference), clipped to the gamut.
fn oklab(lightness: f64, a: f64, b: f64) -> Colour {
    let l = (lightness + 0.3963377774 * a + 0.2158037573 * b).powi(3);
    let m = (lightness - 0.1055613458 * a - 0.0638541728 * b).powi(3);
    let s = (lightness - 0.0894841775 * a - 1.2914855480 * b).powi(3);
    let encode = |c: f64| {
        let c = c.clamp(0.0, 1.0);
        let c = if c <= 0.0031308 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (255.0 * c).round() as u8
    };
    Colour::rgb(
        encode(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
        encode(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
        encode(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of the sRGB standard.
    fn luminance(c: Colour) -> f64 {
        let linear = |v: u8| (f64::from(v) / 255.0).powf(2.2);
        0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b)
    }

    #[test]
    fn lightness_grows_along_the_sequential_scale() {
        let scale: Vec<f64> =
            (0..=64).map(|k| luminance(Colormap::Sequential.colour(f64::from(k), [0.0, 64.0]))).collect();
        assert!(scale.windows(2).all(|w| w[0] < w[1]));
    }

    #[test]
    fn the_middle_of_the_diverging_scale_is_the_lightest() {
        let map = Colormap::Diverging { centre: 1.0 };
        let range = [0.0, 1.5];
        assert!(luminance(map.colour(1.0, range)) > luminance(map.colour(1.2, range)));
        assert!(map.colour(0.0, range).b > map.colour(0.0, range).r);
        assert!(map.colour(1.5, range).r > map.colour(1.5, range).b);
        assert_eq!(map.colour(f64::NAN, range), map.colour(1.0, range));
    }
}
