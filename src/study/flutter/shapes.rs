//! Shapes of motions in numbers for people: how much each coordinate takes part, and when.
use num_complex::Complex64;

use crate::coupling::Attached;
use crate::geometry::Surface;
use crate::math::Vector;
use crate::record::flutter::Share;

/// A shape of coordinates `names`, whose amplitudes are counted in `units`: the largest is 1 and has the phase 0.
pub(super) fn shares(names: &[String], units: &[f64], shape: &[Complex64]) -> Vec<Share> {
    let own: Vec<Complex64> = shape.iter().zip(units).map(|(q, unit)| q / unit).collect();
    let largest = own.iter().fold(Complex64::new(0.0, 0.0), |most, q| if q.norm() > most.norm() { *q } else { most });
    let share = |(name, q): (&String, &Complex64)| {
        let part = if largest.norm() > 0.0 { q / largest } else { *q };
        // without the sign of a zero
        let phase = if part.norm() > 0.0 { part.arg().to_degrees() + 0.0 } else { 0.0 };
        Share {
            coordinate: name.clone(),
            amplitude: part.norm(),
            phase_deg: if phase == -180.0 { 180.0 } else { phase },
        }
    };
    names.iter().zip(&own).map(share).collect()
}

/// The amplitudes that shares stand for.
pub(crate) fn amplitudes(shares: &[Share]) -> Vec<Complex64> {
    shares.iter().map(Share::phasor).collect()
}

/// Displacements of all points of the surface per unit of each coordinate of a body.
pub(crate) fn moves<const D: usize>(surface: &Surface<D>, body: &Attached<D>, units: &[f64]) -> Vec<Vec<[f64; 3]>> {
    let n = body.structure.len();
    let placement = body.structure.placement(&vec![0.0; n]);
    let mut all = vec![vec![[0.0; 3]; surface.vertices.len()]; n];
    let mut done = vec![false; surface.vertices.len()];
    for element in surface.elements.iter().filter(|e| usize::from(e.body) == body.body) {
        for i in element.vertices.iter().map(|i| *i as usize) {
            if std::mem::replace(&mut done[i], true) {
                continue;
            }
            let x = &surface.vertices[i];
            let bends: Vec<Vector<D>> = body.shapes.iter().map(|shape| shape.at(x)).collect();
            for (k, tangent) in placement.tangents(x, &bends).enumerate() {
                all[k][i] = (tangent * units.get(body.first + k).copied().unwrap_or(1.0)).to_3d();
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_share_is_one_and_has_no_phase() {
        let names = ["plunge", "pitch", "flap"].map(str::to_owned);
        let shape = [Complex64::new(0.0, 0.5), Complex64::new(0.1, 0.0), Complex64::new(0.0, 0.0)];
        let found = shares(&names, &[0.5, 1.0, 1.0], &shape);
        assert_eq!((found[0].amplitude, found[0].phase_deg), (1.0, 0.0));
        assert!((found[1].amplitude - 0.1).abs() < 1e-15 && (found[1].phase_deg + 90.0).abs() < 1e-12);
        assert_eq!((found[2].amplitude, found[2].phase_deg), (0.0, 0.0));
        // the same times any complex number
        let turned = shape.map(|q| q * Complex64::new(-3.0, 2.0));
        let again = shares(&names, &[0.5, 1.0, 1.0], &turned);
        assert!(found.iter().zip(&again).all(|(a, b)| (a.amplitude - b.amplitude).abs() < 1e-14));
        let back = amplitudes(&found);
        assert!((back[0] - 1.0).norm() < 1e-15 && (back[1] - Complex64::new(0.0, -0.1)).norm() < 1e-15);
    }
}
