//! Position of a cell along the Hilbert curve, in any dimension (Skilling 2004, AIP Conf. Proc. 707).
//!
//! Particles that are neighbours in space become neighbours in memory; residuals are then computed several times faster
//! than in random order.

/// Index along the curve of the cell with integer coordinates `x`, each below 2^`bits`; `D`·`bits` must not exceed 64.
pub fn hilbert_index<const D: usize>(mut x: [u32; D], bits: u32) -> u64 {
    let top = 1u32 << (bits - 1);
    let mut q = top;
    while q > 1 {
        let p = q - 1;
        for d in 0..D {
            // inverts the first coordinate if the bit is set, else exchanges both; without a branch, which could not be
            // predicted
            let set = 0u32.wrapping_sub(u32::from(x[d] & q != 0));
            let t = (x[0] ^ x[d]) & p & !set;
            x[0] ^= t | p & set;
            x[d] ^= t;
        }
        q >>= 1;
    }
    for d in 1..D {
        x[d] ^= x[d - 1];
    }
    // bit b: true if the number of set bits above b is odd
    let mut t = x[D - 1] & (top | (top - 1));
    [1, 2, 4, 8, 16].into_iter().for_each(|s| t ^= t >> s);
    t >>= 1;
    x.iter_mut().for_each(|c| *c ^= t);
    if D == 2 {
        return spread(x[0]) << 1 | spread(x[1]);
    }
    (0..bits).rev().fold(0, |index, b| (0..D).fold(index, |index, d| index << 1 | u64::from(x[d] >> b & 1)))
}

/// Inserts a zero after each bit of `x`.
fn spread(x: u32) -> u64 {
    const STEPS: [(u32, u64); 5] = [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ];
    STEPS.into_iter().fold(u64::from(x), |x, (shift, mask)| (x | x << shift) & mask)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consecutive_cells_of_the_plane_share_an_edge() {
        let mut cells: Vec<[u32; 2]> = (0..4096).map(|k| [k & 63, k >> 6]).collect();
        cells.sort_by_key(|c| hilbert_index(*c, 6));
        assert!(cells.iter().zip(0..).all(|(c, k)| hilbert_index(*c, 6) == k));
        for pair in cells.windows(2) {
            let step: u32 = (0..2).map(|d| pair[0][d].abs_diff(pair[1][d])).sum();
            assert_eq!(step, 1);
        }
    }

    #[test]
    fn consecutive_cells_share_a_face() {
        let mut cells: Vec<[u32; 3]> = (0..512).map(|k| [k & 7, k >> 3 & 7, k >> 6]).collect();
        cells.sort_by_key(|c| hilbert_index(*c, 3));
        for pair in cells.windows(2) {
            let step: u32 = (0..3).map(|d| pair[0][d].abs_diff(pair[1][d])).sum();
            assert_eq!(step, 1);
        }
    }
}
