//! A hash grid of points, for range searches among interface particles.
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use crate::math::Vector;

const NONE: u32 = u32::MAX;
/// Odd multiplier with well mixed bits (Knuth's golden ratio in 64 bits).
const MIX: u64 = 0x9e37_79b9_7f4a_7c15;

/// Hash function for bin coordinates, with one multiplication per coordinate. The keys come from geometry, not from an
/// adversary.
#[derive(Clone, Copy, Default)]
struct BinHasher(u64);

impl Hasher for BinHasher {
    fn finish(&self) -> u64 {
        self.0 ^ self.0 >> 32
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|b| self.write_i32(i32::from(*b)));
    }

    fn write_i32(&mut self, k: i32) {
        self.0 = (self.0.rotate_left(23) ^ u64::from(k as u32)).wrapping_mul(MIX);
    }
}

/// Points in cubic bins; the points of each bin form a list linked through `next`.
pub struct Grid<const D: usize> {
    size: f64,
    head: HashMap<(i32, i32, i32), u32, BuildHasherDefault<BinHasher>>,
    next: Vec<(u32, u32)>,
}

impl<const D: usize> Grid<D> {
    /// An empty grid whose bins are `size` wide.
    pub fn new(size: f64) -> Self {
        Self { size, head: HashMap::default(), next: Vec::new() }
    }

    /// Adds the point `x` with the number `k`.
    pub fn insert(&mut self, x: &Vector<D>, k: u32) {
        let bin = x.to_3d().map(|c| (c / self.size).floor() as i32);
        let head = self.head.entry((bin[0], bin[1], bin[2])).or_insert(NONE);
        self.next.push((k, *head));
        *head = self.next.len() as u32 - 1;
    }

    /// Calls `f` with the number of every point in the bins that the cube of half-width `reach` around `x` overlaps.
    pub fn near(&self, x: &Vector<D>, reach: f64, mut f: impl FnMut(u32)) {
        let x = x.to_3d();
        let bin = |d: usize, side: f64| if d < D { ((x[d] + side * reach) / self.size).floor() as i32 } else { 0 };
        let (low, high): ([i32; 3], [i32; 3]) =
            (std::array::from_fn(|d| bin(d, -1.0)), std::array::from_fn(|d| bin(d, 1.0)));
        for a in low[0]..=high[0] {
            for b in low[1]..=high[1] {
                for c in low[2]..=high[2] {
                    let mut k = self.head.get(&(a, b, c)).copied().unwrap_or(NONE);
                    while let Some((point, next)) = self.next.get(k as usize) {
                        f(*point);
                        k = *next;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_every_point_within_reach() {
        let points: Vec<Vector<3>> = (0..500).map(|k| Vector::from_fn(|d| ((k * (7 + 3 * d)) as f64).sin())).collect();
        let mut grid = Grid::new(0.15);
        points.iter().zip(0..).for_each(|(x, k)| grid.insert(x, k));
        for x in &points {
            let mut found = 0;
            grid.near(x, 0.2, |k| found += usize::from((points[k as usize] - *x).norm() < 0.2));
            assert_eq!(found, points.iter().filter(|y| (**y - *x).norm() < 0.2).count());
        }
    }
}
