//! Random tensors and comparisons for the tests of this module.
use super::tensor::{self, Tensor};

/// Components within ±`size`, which depend on `seed` only.
pub(super) fn random_tensor(seed: u64, size: f64) -> Tensor {
    // splitmix64 (Steele, Lea, Flood 2014)
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(12345);
    tensor::of(|_, _| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0) * size
    })
}

/// A random rotation.
pub(super) fn random_rotation(seed: u64) -> Tensor {
    // three rotations about axes, by arbitrary angles
    let angles = random_tensor(seed, 3.0)[0];
    let turn = |k: usize| {
        let (s, c) = angles[k].sin_cos();
        let (p, q) = ((k + 1) % 3, (k + 2) % 3);
        let mut r = tensor::identity();
        (r[p][p], r[q][q], r[p][q], r[q][p]) = (c, c, -s, s);
        r
    };
    tensor::product(&turn(0), &tensor::product(&turn(1), &turn(2)))
}

/// Maximum difference of components.
pub(super) fn distance(a: &Tensor, b: &Tensor) -> f64 {
    (0..9).fold(0.0, |m, k| {
        let d = (a[k / 3][k % 3] - b[k / 3][k % 3]).abs();
        if d.is_nan() { f64::INFINITY } else { d.max(m) }
    })
}

/// Asserts that no component differs by more than `bar`.
pub(super) fn close(a: &Tensor, b: &Tensor, bar: f64) {
    assert!(distance(a, b) <= bar, "{a:?} is not {b:?}: {:.2e} > {bar:.0e}", distance(a, b));
}
