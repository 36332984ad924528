//! Pictures of surfaces in three dimensions: triangles or discs around surface particles, with hidden parts removed.
//!
//! An orthographic view. Triangles are filled with linearly interpolated values; a surface particle of area A is a disc of
//! radius √(A/π) across its normal (a little larger, so that neighbours overlap). A first pass keeps the depth of the
//! nearest surface at every pixel, a second one averages all samples that lie on that surface: discs blend into a smooth
//! field (surface splatting; Zwicker et al. 2001). Light comes from behind the viewer's left shoulder.
use super::ReportError;
use super::axes::draw_title;
use super::canvas::{Area, Bitmap, Canvas, Pen, Text};
use super::colour::{Colormap, Colour};
use super::picture::{bar_room, colour_bar, robust_range};
use crate::math::{Bounds, Vector};

/// Plot area in pixels of the canvas.
const PLOT: Area = Area { x: 30.0, y: 46.0, width: 820.0, height: 560.0 };
/// Samples per unit of canvas; the PNG has the same number of pixels.
const SHARPNESS: f64 = 2.0;
/// Discs reach this far beyond their own area, so that no gaps open between them.
const OVERLAP: f64 = 1.5;
/// Share of the light that comes from everywhere.
const AMBIENT: f64 = 0.6;

/// A surface with a value to show.
#[derive(Clone, Copy, Debug)]
pub enum Shell<'a> {
    /// Triangles with values at their corners.
    Triangles {
        /// Corners.
        points: &'a [Vector<3>],
        /// Three corners each.
        triangles: &'a [[u32; 3]],
        /// One value per corner.
        values: &'a [f64],
        /// Normals at the corners for the light, of any length; empty: those of the triangles.
        normals: &'a [Vector<3>],
    },
    /// Surface particles.
    Splats {
        /// Positions.
        points: &'a [Vector<3>],
        /// Normals of any length.
        normals: &'a [Vector<3>],
        /// Areas.
        areas: &'a [f64],
        /// One value per particle.
        values: &'a [f64],
    },
}

/// How a surface is shown.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceStyle<'a> {
    /// Title.
    pub title: &'a str,
    /// Quantity and unit, beside the colour bar.
    pub quantity: &'a str,
    /// Colours.
    pub map: Colormap,
    /// Values at the ends of the colour bar; absent: nearly all values.
    pub range: Option<[f64; 2]>,
    /// From the eye to the surface.
    pub direction: Vector<3>,
    /// Points upwards in the picture.
    pub up: Vector<3>,
}

/// Draws a surface coloured by its values, as PNG.
pub fn surface_png(shell: &Shell, style: &SurfaceStyle) -> Result<Vec<u8>, ReportError> {
    let values = match *shell {
        Shell::Triangles { values, .. } | Shell::Splats { values, .. } => values,
    };
    let range = style.range.unwrap_or_else(|| robust_range(values));
    let mut canvas = Canvas::new(PLOT.x + PLOT.width + bar_room(style.quantity), PLOT.y + PLOT.height + 24.0);
    draw_title(&mut canvas, style.title, [PLOT.x, 28.0]);
    draw_surface(&mut canvas, PLOT, shell, &SurfaceStyle { range: Some(range), ..*style })?;
    colour_bar(&mut canvas, PLOT, style.map, range, style.quantity);
    canvas.png(SHARPNESS)
}

/// Draws a surface as large as it fits into `area`, without title and colour bar.
pub(super) fn draw_surface(
    canvas: &mut Canvas,
    area: Area,
    shell: &Shell,
    style: &SurfaceStyle,
) -> Result<(), ReportError> {
    check(shell)?;
    let (points, values) = match *shell {
        Shell::Triangles { points, values, .. } | Shell::Splats { points, values, .. } => (points, values),
    };
    let range = style.range.unwrap_or_else(|| robust_range(values));
    let view = View::of(points, style, area);
    let mut buffer = Buffer::new((area.width * SHARPNESS) as usize, (area.height * SHARPNESS) as usize);
    for pass in [Pass::Depth, Pass::Colour] {
        match *shell {
            Shell::Triangles { points, triangles, values, normals } => {
                let corners = |t| Corners::of(points, values, normals, t);
                triangles.iter().for_each(|t| fill_triangle(&mut buffer, pass, &view, &corners(t)));
            }
            Shell::Splats { points, normals, areas, values } => {
                for i in 0..points.len() {
                    let splat = Splat { x: points[i], normal: normals[i], area: areas[i], value: values[i] };
                    fill_disc(&mut buffer, pass, &view, &splat);
                }
            }
        }
    }
    canvas.picture(buffer.coloured(style.map, range), area);
    draw_triad(canvas, &view);
    Ok(())
}

fn check(shell: &Shell) -> Result<(), ReportError> {
    let same = |what, found, expected| {
        if found == expected { Ok(()) } else { Err(ReportError::Shape { what, found, expected }) }
    };
    match *shell {
        Shell::Triangles { points, triangles, values, normals } => {
            same("the field on a surface", values.len(), points.len())?;
            same("the normals of a surface", normals.len(), if normals.is_empty() { 0 } else { points.len() })?;
            match triangles.iter().position(|t| t.iter().any(|i| *i as usize >= points.len())) {
                Some(triangle) => Err(ReportError::Triangle { triangle, points: points.len() }),
                None => Ok(()),
            }
        }
        Shell::Splats { points, normals, areas, values } => {
            same("the field on a surface", values.len(), points.len())?;
            same("the normals of a surface", normals.len(), points.len())?;
            same("the areas of a surface", areas.len(), points.len())
        }
    }
}

/// The eye: `x` to the right, `y` up, `z` away from the eye.
struct View {
    axes: [Vector<3>; 3],
    centre: Vector<3>,
    scale: f64,
    area: Area,
}

impl View {
    fn of(points: &[Vector<3>], style: &SurfaceStyle, area: Area) -> Self {
        let axes = axes(&style.direction, &style.up);
        let bounds = seen(points, &style.direction, &style.up);
        let extent = bounds.extent();
        let fit = (area.width / extent[0].max(1e-300)).min(area.height / extent[1].max(1e-300));
        // A margin of 6 % on the tighter side.
        Self { axes, centre: bounds.centre(), scale: 0.88 * fit.min(1e300) * SHARPNESS, area }
    }

    /// Pixel coordinates, y down, and depth in the same unit.
    fn project(&self, x: &Vector<3>) -> Vector<3> {
        let p = Vector(self.axes.map(|a| a.dot(x))) - self.centre;
        let middle = [0.5 * self.area.width * SHARPNESS, 0.5 * self.area.height * SHARPNESS];
        Vector([middle[0] + p[0] * self.scale, middle[1] - p[1] * self.scale, p[2] * self.scale])
    }

    /// A direction in pixel axes.
    fn turn(&self, n: &Vector<3>) -> Vector<3> {
        Vector([self.axes[0].dot(n), -self.axes[1].dot(n), self.axes[2].dot(n)])
    }
}

/// To the right, upwards and away from the eye.
fn axes(direction: &Vector<3>, up: &Vector<3>) -> [Vector<3>; 3] {
    let usable = |v: &Vector<3>| v.is_finite() && v.norm() > 0.0;
    let away = if usable(direction) { direction.unit() } else { Vector([0.0, 1.0, 0.0]) };
    let mut right = cross(&away, up);
    if !usable(&right) || right.norm() < 1e-6 {
        // Looking along `up`: any direction across will do.
        right = cross(&away, &if away[0].abs() < 0.9 { Vector::axis(0) } else { Vector::axis(1) });
    }
    let right = right.unit();
    [right, cross(&right, &away), away]
}

/// What points take of the picture, across, up and in depth.
pub(super) fn seen(points: &[Vector<3>], direction: &Vector<3>, up: &Vector<3>) -> Bounds<3> {
    let axes = axes(direction, up);
    let turned: Vec<Vector<3>> =
        points.iter().filter(|x| x.is_finite()).map(|x| Vector(axes.map(|a| a.dot(x)))).collect();
    if turned.is_empty() { Bounds { min: Vector::ZERO, max: Vector::ZERO } } else { Bounds::around(&turned) }
}

fn cross(a: &Vector<3>, b: &Vector<3>) -> Vector<3> {
    Vector([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Pass {
    Depth,
    Colour,
}

/// Nearest depth, and sums of weighted values and light, at every pixel.
struct Buffer {
    width: usize,
    height: usize,
    depth: Vec<f64>,
    sums: Vec<[f64; 3]>,
}

/// What a surface shows at one pixel.
struct Sample {
    depth: f64,
    value: f64,
    light: f64,
    weight: f64,
    /// Samples less than this behind the nearest one belong to the same surface.
    thickness: f64,
}

impl Buffer {
    fn new(width: usize, height: usize) -> Self {
        let n = width * height;
        Self { width, height, depth: vec![f64::INFINITY; n], sums: vec![[0.0; 3]; n] }
    }

    /// Visits the pixels of a box in pixel coordinates.
    fn visit(&mut self, pass: Pass, low: [f64; 2], high: [f64; 2], sample: impl Fn(f64, f64) -> Option<Sample>) {
        let clamp = |x: f64, n: usize| x.clamp(0.0, n as f64) as usize;
        for l in clamp(low[1].floor(), self.height)..clamp(high[1].ceil(), self.height) {
            for k in clamp(low[0].floor(), self.width)..clamp(high[0].ceil(), self.width) {
                if let Some(s) = sample(k as f64 + 0.5, l as f64 + 0.5) {
                    self.add(pass, l * self.width + k, &s);
                }
            }
        }
    }

    fn add(&mut self, pass: Pass, at: usize, s: &Sample) {
        if pass == Pass::Depth {
            self.depth[at] = self.depth[at].min(s.depth);
        } else if s.depth <= self.depth[at] + s.thickness {
            let sum = &mut self.sums[at];
            sum[0] += s.weight * s.value;
            sum[1] += s.weight * s.light;
            sum[2] += s.weight;
        }
    }

    fn coloured(&self, map: Colormap, range: [f64; 2]) -> Bitmap {
        let pixel = |s: &[f64; 3]| match s[2] > 0.0 {
            true if (s[0] / s[2]).is_finite() => map.colour(s[0] / s[2], range).lit(s[1] / s[2]),
            true => Colour::GREY.lit(s[1] / s[2]),
            false => Colour::PAPER.faded(0),
        };
        let rgba = self.sums.iter().map(pixel).flat_map(|c| [c.r, c.g, c.b, c.a]).collect();
        Bitmap { width: self.width, height: self.height, rgba }
    }
}

/// Brightness of a surface with normal `n` in pixel axes; both sides are lit alike.
fn light(n: &Vector<3>) -> f64 {
    let n = n.unit() * if n[2] > 0.0 { -1.0 } else { 1.0 };
    let lamp = Vector([-0.35, -0.55, -0.76]).unit();
    AMBIENT + (1.06 - AMBIENT) * n.dot(&lamp).max(0.0)
}

/// A triangle with the values at its corners.
struct Corners {
    x: [Vector<3>; 3],
    values: [f64; 3],
    /// Normals, where they are not that of the triangle.
    normals: Option<[Vector<3>; 3]>,
}

impl Corners {
    fn of(points: &[Vector<3>], values: &[f64], normals: &[Vector<3>], triangle: &[u32; 3]) -> Self {
        let corners = triangle.map(|i| i as usize);
        let usable = corners.iter().all(|i| normals.get(*i).is_some_and(|n| n.is_finite() && n.norm() > 0.0));
        let normals = usable.then(|| corners.map(|i| normals[i]));
        Self { x: corners.map(|i| points[i]), values: corners.map(|i| values[i]), normals }
    }
}

/// A particle of a surface.
struct Splat {
    x: Vector<3>,
    normal: Vector<3>,
    area: f64,
    value: f64,
}

fn fill_triangle(buffer: &mut Buffer, pass: Pass, view: &View, corners: &Corners) {
    let ([a, b, c], value) = (corners.x.map(|x| view.project(&x)), corners.values);
    let normal = cross(&(b - a), &(c - a));
    if !normal.is_finite() || normal[2] == 0.0 {
        return;
    }
    let shades = corners.normals.map_or([light(&normal); 3], |own| own.map(|n| light(&view.turn(&n))));
    let low = [a[0].min(b[0]).min(c[0]), a[1].min(b[1]).min(c[1])];
    let high = [a[0].max(b[0]).max(c[0]), a[1].max(b[1]).max(c[1])];
    buffer.visit(pass, low, high, |x, y| {
        let side = |p: &Vector<3>, q: &Vector<3>| ((q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])) / normal[2];
        let [u, v, w] = [side(&b, &c), side(&c, &a), side(&a, &b)];
        let inside = u >= 0.0 && v >= 0.0 && w >= 0.0;
        let mix = |f: [f64; 3]| u * f[0] + v * f[1] + w * f[2];
        let (depth, value, light) = (mix([a[2], b[2], c[2]]), mix(value), mix(shades));
        inside.then_some(Sample { depth, value, light, weight: 1.0, thickness: 0.0 })
    });
}

fn fill_disc(buffer: &mut Buffer, pass: Pass, view: &View, splat: &Splat) {
    let Splat { x, normal, area, value } = *splat;
    let (centre, n) = (view.project(&x), view.turn(&normal.unit()));
    let radius = OVERLAP * (area.max(0.0) / std::f64::consts::PI).sqrt() * view.scale;
    if !(centre.is_finite() && n.is_finite() && radius.is_finite()) {
        return;
    }
    // Discs seen edge-on would vanish between pixels.
    let (radius, facing) = (radius.max(0.8), if n[2].abs() < 0.05 { 0.05_f64.copysign(n[2]) } else { n[2] });
    let shade = light(&n);
    let box_of = |s: f64| [centre[0] + s * radius, centre[1] + s * radius];
    buffer.visit(pass, box_of(-1.0), box_of(1.0), |px, py| {
        let (dx, dy) = (px - centre[0], py - centre[1]);
        let dz = -(n[0] * dx + n[1] * dy) / facing;
        let distance = (dx * dx + dy * dy + dz * dz) / (radius * radius);
        let sample =
            Sample { depth: centre[2] + dz, value, light: shade, weight: (-3.0 * distance).exp(), thickness: radius };
        (distance <= 1.0).then_some(sample)
    });
}

/// The three axes in the lower left corner.
fn draw_triad(canvas: &mut Canvas, view: &View) {
    let area = view.area;
    let origin = [area.x + 40.0, area.y + area.height - 52.0];
    for (d, name) in ["x", "y", "z"].into_iter().enumerate() {
        let n = view.turn(&Vector::axis(d));
        let tip = [origin[0] + 30.0 * n[0], origin[1] + 30.0 * n[1]];
        canvas.line(vec![origin, tip], Pen::new(Colour::GREY, 1.6));
        let at = [origin[0] + 39.0 * n[0] - 3.0, origin[1] + 39.0 * n[1] + 4.0];
        // An axis along the view has no length and would hide its neighbours' names.
        if n[0].hypot(n[1]) > 0.15 {
            canvas.text(Text { colour: Colour::GREY, ..Text::new(name, at, 12.0) });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::picture::tests::keep;

    const STYLE: SurfaceStyle<'static> = SurfaceStyle {
        title: "Pressure coefficient on the surface",
        quantity: "Cp",
        map: Colormap::Diverging { centre: 0.0 },
        range: None,
        direction: Vector([-0.5, 0.7, -0.55]),
        up: Vector([0.0, 0.0, 1.0]),
    };

    fn sphere(n: usize, centre: [f64; 3], radius: f64) -> Vec<(Vector<3>, Vector<3>)> {
        let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        (0..n)
            .map(|k| {
                let z = 1.0 - (2.0 * k as f64 + 1.0) / n as f64;
                let (r, angle) = ((1.0 - z * z).sqrt(), golden * k as f64);
                let normal = Vector([r * angle.cos(), r * angle.sin(), z]);
                (Vector(centre) + normal * radius, normal)
            })
            .collect()
    }

    #[test]
    fn splats_close_into_a_surface() {
        let mut all = sphere(4000, [0.0; 3], 1.0);
        all.extend(sphere(4000, [1.6, 0.4, 0.2], 0.8));
        let (points, normals): (Vec<_>, Vec<_>) = all.into_iter().unzip();
        let areas: Vec<f64> =
            (0..8000).map(|k| 4.0 * std::f64::consts::PI * if k < 4000 { 1.0 } else { 0.64 } / 4000.0).collect();
        let values: Vec<f64> = normals.iter().map(|n| 1.0 - 2.25 * (1.0 - n[0] * n[0])).collect();
        let shell = Shell::Splats { points: &points, normals: &normals, areas: &areas, values: &values };
        keep("surface-splats.png", &surface_png(&shell, &STYLE).unwrap());
    }

    #[test]
    fn triangles_hide_what_is_behind() {
        // A swept, tapered wing: 60 × 40 quadrangles on each side.
        let (n, m) = (60, 40);
        let mut points = Vec::new();
        for side in [1.0, -1.0] {
            for k in 0..=n {
                for l in 0..=m {
                    let (s, span) = (k as f64 / n as f64, l as f64 / m as f64);
                    let chord = 1.0 - 0.45 * span;
                    let thickness =
                        0.6 * (0.297 * s.sqrt() - 0.126 * s - 0.352 * s * s + 0.284 * s.powi(3) - 0.103 * s.powi(4));
                    points.push(Vector([0.6 * span + chord * s, 1.5 * span, side * chord * thickness]));
                }
            }
        }
        let mut triangles = Vec::new();
        for face in 0..2_u32 {
            for k in 0..n as u32 {
                for l in 0..m as u32 {
                    let at = |dk: u32, dl: u32| face * 61 * 41 + (k + dk) * 41 + l + dl;
                    triangles.push([at(0, 0), at(1, 0), at(1, 1)]);
                    triangles.push([at(0, 0), at(1, 1), at(0, 1)]);
                }
            }
        }
        let values: Vec<f64> =
            points.iter().map(|x| if x[0] - 0.5 * x[1] < 0.55 { -1.0 } else { -0.2 } + x[2]).collect();
        let shell = Shell::Triangles { points: &points, triangles: &triangles, values: &values, normals: &[] };
        let style = SurfaceStyle { map: Colormap::Sequential, ..STYLE };
        keep("surface-triangles.png", &surface_png(&shell, &style).unwrap());
        let far = [[0, 1, 10_000]];
        let shell = Shell::Triangles { points: &points, triangles: &far, values: &values, normals: &[] };
        assert!(matches!(surface_png(&shell, &STYLE), Err(ReportError::Triangle { triangle: 0, .. })));
    }

    #[test]
    fn strange_views_and_particles_do_no_harm() {
        let points = [Vector([0.0; 3]), Vector([f64::NAN; 3])];
        let normals = [Vector([0.0, 0.0, 1.0]); 2];
        let shell = Shell::Splats { points: &points, normals: &normals, areas: &[1.0, -1.0], values: &[f64::NAN, 1.0] };
        for direction in [Vector([0.0; 3]), Vector([0.0, 0.0, 1.0]), Vector([f64::INFINITY; 3])] {
            assert!(surface_png(&shell, &SurfaceStyle { direction, ..STYLE }).is_ok());
        }
        let nothing = Shell::Splats { points: &[], normals: &[], areas: &[], values: &[] };
        assert!(surface_png(&nothing, &STYLE).is_ok());
    }
}
