//! Frequencies against beams, motions as a whole, sharp edges and planes of symmetry.
use super::*;
use crate::geometry::{Shell, cuboid};
use crate::physics::solid::{Law, Moduli};

/// The hull of the corners of a hexahedron, numbered by bits.
fn hexahedron(corner: impl Fn(usize) -> [f64; 3]) -> Surface<3> {
    let vertices = (0..8).map(|k| Vector(corner(k))).collect();
    let shell = Shell { vertices, ..cuboid([1.0; 3]) };
    Surface::new(&[("body".to_string(), shell)])
}

fn slab(low: [f64; 3], high: [f64; 3]) -> Surface<3> {
    hexahedron(|k| std::array::from_fn(|d| if k >> d & 1 == 1 { high[d] } else { low[d] }))
}

fn body<'a>(surface: &'a Surface<3>, materials: &'a [Material], held: &'a [HeldBox]) -> Body<'a> {
    Body { surface, materials, material: &|_| 0, held, mirrors: &[], size: None }
}

fn material(young: f64, poisson: f64, density: f64) -> [Material; 1] {
    [Material::new(density, Moduli::of_young(young, poisson), Law::SaintVenantKirchhoff)]
}

const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

#[test]
fn a_cantilever_fifty_times_as_long_as_thick_swings_as_a_beam() {
    let (surface, steel) = (slab([0.0; 3], [1.0, 0.2, 0.02]), material(2.0e11, 0.0, 8000.0));
    let held = [HeldBox { place: [[f64::NEG_INFINITY, 0.0], ANY, ANY], fixed: [true; 3] }];
    let found = modes(&body(&surface, &steel, &held), 3).unwrap();
    assert!((found.mass - 32.0).abs() < 1e-9, "{}", found.mass);
    let beam = |root: f64| root * root * (2.0e11 * 0.02f64.powi(2) / (12.0 * 8000.0)).sqrt();
    for (mode, root) in found.modes.iter().zip([1.875_104, 4.694_091]) {
        let off = mode.omega / beam(root) - 1.0;
        assert!(off.abs() < 3e-3 && mode.error < 3e-3, "{off} {}", mode.error);
    }
    let tip = found.displacement(0, &Vector([1.0, 0.1, 0.02]));
    // the tip of a cantilever of unit generalised mass moves by 2/√m
    assert!((tip[2].abs() * 32f64.sqrt() - 2.0).abs() < 0.01, "{tip:?}");
}

#[test]
fn a_free_body_has_six_motions_as_a_whole() {
    let (surface, soft) = (slab([0.0; 3], [1.0, 0.8, 0.5]), material(1.0, 0.3, 1.0));
    let found = modes(&body(&surface, &soft, &[]), 7).unwrap();
    let omegas: Vec<f64> = found.modes.iter().map(|m| m.omega).collect();
    assert!(omegas[..6].iter().all(|o| *o == 0.0) && omegas[6] > 0.5, "{omegas:?}");
}

#[test]
fn a_wedge_swings_as_a_tapered_beam() {
    // thickness falls to nothing at the tip: J₁ and I₁ give ω = 5.315 √(E t²/(12 ρ))/L² (Kirchhoff 1879)
    let wedge = hexahedron(|k| {
        let (x, y) = (if k & 1 == 1 { 1.0 } else { 0.0 }, if k & 2 == 2 { 0.05 } else { 0.0 });
        [x, y, (1.0 - x) * if k & 4 == 4 { 0.01 } else { -0.01 }]
    });
    let held = [HeldBox { place: [[f64::NEG_INFINITY, 0.0], ANY, ANY], fixed: [true; 3] }];
    let steel = material(2.0e11, 0.0, 8000.0);
    let found = modes(&body(&wedge, &steel, &held), 1).unwrap();
    assert!((found.mass / (0.5 * 0.02 * 0.05 * 8000.0) - 1.0).abs() < 1e-6, "{}", found.mass);
    let exact = 5.315 * (2.0e11 * 0.02f64.powi(2) / (12.0 * 8000.0)).sqrt();
    let off = found.modes[0].omega / exact - 1.0;
    assert!(off.abs() < 1e-2, "{off}");
}

#[test]
fn half_a_body_at_a_plane_of_symmetry_has_the_symmetric_modes_of_the_whole() {
    let (surface, soft) = (slab([-1.0, 0.0, 0.0], [1.0, 0.2, 0.1]), material(1.0, 0.3, 1.0));
    let mirrors = [Mirror { axis: 0, place: 0.0, below: false }];
    let half = modes(&Body { mirrors: &mirrors, ..body(&surface, &soft, &[]) }, 8).unwrap();
    let whole = modes(&body(&surface, &soft, &[]), 12).unwrap();
    assert!((half.mass - 0.02).abs() < 1e-12, "{}", half.mass);
    let first = half.modes.iter().find(|m| m.omega > 0.0).unwrap().omega;
    let off = whole.modes.iter().map(|m| (m.omega / first - 1.0).abs()).fold(f64::INFINITY, f64::min);
    assert!(off < 5e-3, "{off}");
}

#[test]
fn a_support_beside_the_body_is_told() {
    let (surface, soft) = (slab([0.0; 3], [1.0; 3]), material(1.0, 0.3, 1.0));
    let held = [HeldBox { place: [[2.0, 3.0], ANY, ANY], fixed: [true; 3] }];
    assert_eq!(modes(&body(&surface, &soft, &held), 1).err(), Some(SplineModesError::Unsupported { number: 0 }));
}
