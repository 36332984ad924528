//! Pictures of flows in space: the walls from all sides, and the flow in planes.
//!
//! The Mach number is shown in the plane of symmetry, or in the middle of the bodies where there is none; the axial vorticity and the
//! flow across the stream in a plane behind bodies that lift. Lines there follow v and w less those of the free stream.
use super::target::Scene;
use crate::geometry::Surface;
use crate::math::Vector;
use crate::math::parallel::sweep_each_chunk;
use crate::math::slice::slice;
use crate::physics::Primitive;
use crate::problem::RunError;
use crate::report::{Colormap, PictureStyle, Raster, raster_png, write_file, write_stations, write_surface_views};
use crate::scheme::probe::{Near, Probe};
use crate::scheme::start::free_stream;
use crate::study::keeper::together;
use crate::study::look::raster::{MIDDLE_PIXELS, Plane, middle_window, sampled};
use crate::study::look::{CrossPlane, side_of_symmetry};

/// Draws all pictures of a run in space.
pub(super) fn write<const D: usize>(scene: &Scene<'_, D>) -> Result<(), RunError> {
    let Some(surface) = scene.surface else { return Ok(()) };
    together(4, |k| match k {
        0 => Ok(write_surface_views(scene.to.out)?),
        1 => Ok(write_stations(scene.to.out)?),
        2 => middle(scene, surface),
        _ => wake(scene, surface),
    })
}

/// Mach number in the plane of symmetry or in the middle.
fn middle<const D: usize>(scene: &Scene<'_, D>, surface: &Surface<D>) -> Result<(), RunError> {
    let (domain, b) = (scene.view.cloud().tree.bounds(), surface.bounds());
    let (at, told) = match side_of_symmetry(scene.to.case, &domain) {
        Some((at, _)) => (at, "in the plane of symmetry".to_owned()),
        None => (b.centre()[1], format!("at y = {:.3}, the middle of the span", b.centre()[1])),
    };
    let plane = Plane { axes: [0, D - 1], through: Vector::axis(1) * at };
    let (w, gas) = (middle_window(surface, &domain), scene.view.fluid.gas);
    let (width, height, states) = sampled((scene.view, scene.surface), &plane, &w, MIDDLE_PIXELS);
    let mach = |q: &Primitive<D>| q.velocity.norm() / gas.sound_speed(q);
    let values = states.iter().map(|q| q.as_ref().map_or(f64::NAN, mach)).collect();
    let title = format!("Mach number {told}");
    let outlines = outlines(scene, surface, 1, at);
    let style = PictureStyle { contours: &[1.0], outlines: &outlines, ..PictureStyle::plain(&title, "M", ["x", "z"]) };
    let png = raster_png(&Raster { width, height, window: w, values }, &style)?;
    Ok(write_file(&scene.to.out.join("pictures/mach-middle.png"), &png)?)
}

/// Where the plane across `axis` cuts the bodies, in the two other axes.
fn outlines<const D: usize>(scene: &Scene<'_, D>, surface: &Surface<D>, axis: usize, at: f64) -> Vec<Vec<Vector<2>>> {
    let corners = |e: &crate::geometry::Element<D>| [0, 1, 2].map(|c: usize| e.vertices[c.min(D - 1)]);
    let triangles: Vec<[u32; 3]> = surface.elements.iter().map(corners).collect();
    let mut owner = vec![0; surface.vertices.len()];
    surface.elements.iter().for_each(|e| e.vertices.iter().for_each(|v| owner[*v as usize] = usize::from(e.body)));
    let carried: Vec<Vector<D>> =
        surface.vertices.iter().zip(owner).map(|(x, body)| scene.view.carried(body, x)).collect();
    let flat = |x: Vector<D>| Vector([x[usize::from(axis == 0)], x[D - 1]]);
    let chains = slice(&carried, &triangles, axis, at);
    chains.iter().map(|chain| chain.iter().map(|p| flat(p.point(&carried))).collect()).collect()
}

/// Axial vorticity and flow across the stream behind bodies that lift.
fn wake<const D: usize>(scene: &Scene<'_, D>, surface: &Surface<D>) -> Result<(), RunError> {
    let domain = scene.view.reference().tree.bounds();
    let Some(vortex) = scene.vortex else { return Ok(()) };
    let Some(behind) = CrossPlane::of(scene.to.case, surface, &domain, scene.chord) else { return Ok(()) };
    let free = free_stream::<D>(scene.to.case);
    let plane = Plane { axes: [1, D - 1], through: behind.place(0.0, 0.0) };
    let w = behind.window;
    let (width, height, states) = sampled((scene.view, scene.surface), &plane, &w, MIDDLE_PIXELS);
    let pixel = w.extent()[0] / width as f64;
    let per = scene.chord / free.velocity.norm();
    let probe = Probe::new(scene.view, scene.surface);
    let mut values = vec![f64::NAN; width * height];
    sweep_each_chunk(&mut values, width, |row, values| {
        let mut near = Near::default();
        for (k, value) in values.iter_mut().enumerate() {
            let at = [k, row].map(|c| (c as f64 + 0.5) * pixel);
            let x = plane.place([w.min[0] + at[0], w.min[1] + at[1]]);
            *value = probe.vorticity(&x, &mut near).map_or(f64::NAN, |curl| per * curl[0]);
        }
    });
    let across = |q: &Option<Primitive<D>>| {
        q.as_ref().map_or([f64::NAN; 2], |q| [1, D - 1].map(|d| q.velocity[d] - free.velocity[d]))
    };
    let directions: Vec<[f64; 2]> = states.iter().map(across).collect();
    let units = scene.to.case.flow.units().speed * free.velocity.norm() * scene.chord;
    let title = format!(
        "Axial vorticity behind the tip, x = {:.4}: core at y = {:.4}, z = {:.4}, circulation {:.4} V c",
        vortex.x,
        vortex.y,
        vortex.z,
        vortex.circulation / units
    );
    let style = PictureStyle {
        map: Colormap::Diverging { centre: 0.0 },
        directions: &directions,
        mark: Some(Vector([vortex.y, vortex.z])),
        ..PictureStyle::plain(&title, "ωx c/V", ["y", "z"])
    };
    let png = raster_png(&Raster { width, height, window: w, values }, &style)?;
    Ok(write_file(&scene.to.out.join("pictures/wake.png"), &png)?)
}
