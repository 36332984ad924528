//! Pictures of a run, drawn through the solver's own fit.
use super::cuts;
use super::target::Scene;
use crate::math::{Bounds, Vector};
use crate::physics::Primitive;
use crate::problem::RunError;
use crate::report::{
    Colormap, Dots, PictureStyle, Raster, Scatter, raster_png, scatter_png, write_file, write_pressure,
};
use crate::scheme::start::free_stream;
use crate::study::keeper::{FILM, together};
use crate::study::look::pressure_coefficient;
use crate::study::look::raster::{MARGIN, PIXELS, Plane, around, sampled};

/// Pixels along the longer side of a picture of a film strip.
const FILM_PIXELS: usize = 450;
/// Greatest Mach number in the colours of a film strip, in that of the free stream.
const FILM_RANGE: f64 = 2.0;

/// Parts of the length of a body made of particles that its outline is drawn in.
const BENT: f64 = 60.0;

/// A flow picture: file name, (title, quantity, colours, contours), value of a state.
type Drawn<'a, const D: usize> = (&'a str, (&'a str, &'a str, Colormap, &'a [f64]), Value<'a, D>);
type Value<'a, const D: usize> = &'a (dyn Fn(&Primitive<D>) -> f64 + Sync);

/// Draws all pictures of a run.
pub(crate) fn write<const D: usize>(scene: &Scene<'_, D>) -> Result<(), RunError> {
    if D == 2 { plane(scene) } else { cuts::write(scene) }
}

fn window<const D: usize>(scene: &Scene<'_, D>, margin: f64) -> Bounds<2> {
    around(scene.surface, &scene.view.cloud().tree.bounds(), margin)
}

fn outlines<const D: usize>(scene: &Scene<'_, D>) -> Vec<Vec<Vector<2>>> {
    let Some(surface) = scene.surface else { return Vec::new() };
    let mut all: Vec<(u16, Vec<Vector<2>>)> = Vec::new();
    for chain in surface.chains() {
        let body = surface.element(chain.elements[0]).body;
        // long straight sides bend with what is behind them
        let bends = scene.view.fluid.cloud_motion.law_of(usize::from(body)).is_some_and(|law| law.net().is_some());
        let longest = surface.bounds_of(usize::from(body)).extent().max_abs() / BENT;
        let points = chain.elements.iter().flat_map(|e| {
            let corners = surface.corners(*e);
            let side = corners[D - 1] - corners[0];
            let parts = if bends { (side.norm() / longest).ceil().max(1.0) } else { 1.0 };
            (0..parts as usize).map(move |k| {
                let p = scene.view.carried(usize::from(body), &(corners[0] + side * (k as f64 / parts)));
                Vector([p[0], p[1]])
            })
        });
        match all.last_mut() {
            Some((b, line)) if *b == body => line.extend(points),
            _ => all.push((body, points.collect())),
        }
    }
    all.into_iter().map(|(_, line)| line).collect()
}

fn plane<const D: usize>(scene: &Scene<'_, D>) -> Result<(), RunError> {
    let outlines = outlines(scene);
    let w = window(scene, MARGIN);
    let free = free_stream::<D>(scene.to.case);
    let gas = scene.view.fluid.gas;
    let mach = |q: &Primitive<D>| q.velocity.norm() / gas.sound_speed(q);
    let cp = |q: &Primitive<D>| pressure_coefficient(q, &free);
    let density = |q: &Primitive<D>| q.density;
    let states = sampled((scene.view, scene.surface), &Plane::of_motion(), &w, PIXELS);
    let style = |title: &'static str, quantity: &'static str, map: Colormap, contours: &'static [f64]| {
        (title, quantity, map, contours)
    };
    let second: Drawn<'_, D> = if scene.surface.is_some() {
        ("cp", style("Pressure coefficient", "Cp", Colormap::Diverging { centre: 0.0 }, &[]), &cp)
    } else {
        ("density", style("Density", "density", Colormap::Sequential, &[]), &density)
    };
    let fields = [("mach", style("Mach number", "M", Colormap::Sequential, &[1.0]), &mach as Value<'_, D>), second];
    let field = |(name, (title, quantity, map, contours), value): &Drawn<'_, D>| -> Result<(), RunError> {
        let values = states.2.iter().map(|q| q.as_ref().map_or(f64::NAN, value)).collect();
        let raster = Raster { width: states.0, height: states.1, window: w, values };
        let style = PictureStyle {
            map: *map,
            contours,
            outlines: &outlines,
            ..PictureStyle::plain(title, quantity, ["x", "y"])
        };
        Ok(write_file(&scene.to.out.join(format!("pictures/{name}.png")), &raster_png(&raster, &style)?)?)
    };
    together(4, |k| match k {
        0 | 1 => field(&fields[k]),
        2 => cloud_picture(scene, &outlines),
        _ if scene.surface.is_some() => Ok(write_pressure(scene.to.out)?),
        _ => Ok(()),
    })
}

/// Draws the Mach number at part `part` of a period, in colours that are the same for all of them.
pub(crate) fn write_film<const D: usize>(scene: &Scene<'_, D>, part: u32) -> Result<(), RunError> {
    let (window, gas) = (window(scene, MARGIN), scene.view.fluid.gas);
    let (width, height, states) = sampled((scene.view, scene.surface), &Plane::of_motion(), &window, FILM_PIXELS);
    let mach = |q: &Primitive<D>| q.velocity.norm() / gas.sound_speed(q);
    let values = states.iter().map(|q| q.as_ref().map_or(f64::NAN, mach)).collect();
    let title = format!("Mach number after {part}/{FILM} of the period");
    let style = PictureStyle {
        range: Some([0.0, FILM_RANGE * scene.to.case.flow.reference().mach]),
        contours: &[1.0],
        outlines: &outlines(scene),
        ..PictureStyle::plain(&title, "M", ["x", "y"])
    };
    let png = raster_png(&Raster { width, height, window, values }, &style)?;
    Ok(write_file(&scene.to.out.join(format!("pictures/film-{part}.png")), &png)?)
}

/// Draws the particles near the bodies (plane clouds).
pub(crate) fn write_cloud<const D: usize>(scene: &Scene<'_, D>) -> Result<(), RunError> {
    if D == 2 { cloud_picture(scene, &outlines(scene)) } else { Ok(()) }
}

fn cloud_picture<const D: usize>(scene: &Scene<'_, D>, outlines: &[Vec<Vector<2>>]) -> Result<(), RunError> {
    let cloud = scene.view.cloud();
    let flat = |x: &Vector<D>| Vector([x[0], x[1]]);
    let points: Vec<Vector<2>> = (0..cloud.n_fluid).map(|i| flat(&scene.view.place(i))).collect();
    let finest = cloud.spacing[..cloud.n_fluid].iter().fold(f64::INFINITY, |m, h| m.min(*h));
    let levels: Vec<u32> = cloud.spacing[..cloud.n_fluid].iter().map(|h| (h / finest).log2().round() as u32).collect();
    let interface: Vec<_> = cloud
        .interface_range()
        .enumerate()
        .map(|(w, i)| (flat(&scene.view.place(i)), flat(&scene.view.normal(w))))
        .collect();
    let scatter = Scatter { points: &points, dots: Dots::Level(&levels), interface: &interface, outlines };
    let png = scatter_png(&scatter, window(scene, 0.12), "Particles")?;
    Ok(write_file(&scene.to.out.join("pictures/cloud.png"), &png)?)
}
