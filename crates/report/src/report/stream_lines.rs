//! Lines along a field of directions on a raster, evenly spread.
//!
//! Lines start in cells that hold none and have none beside them, go both ways by the midpoint rule and end where they come beside
//! another one (after Jobard and Lefer 1997).

/// Side of a cell, pixels.
const CELL: f64 = 14.0;
/// Cells around a start that hold no line.
const APART: i64 = 1;
/// Step along a line, pixels.
const STEP: f64 = 2.0;
/// Steps of a line to each side, at most.
const LONGEST: usize = 1500;
/// Times that a line comes back to a cell of its own, and steps that it stays in one, at most.
const AGAIN: usize = 8;
const LINGER: usize = 30;
/// Points of a line, at least.
const SHORTEST: usize = 14;

/// Directions at the middles of pixels, row by row; what is not finite or zero ends a line.
pub(super) struct Directions<'a> {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) values: &'a [[f64; 2]],
}

impl Directions<'_> {
    /// Lines in pixels, along the field.
    pub(super) fn lines(&self) -> Vec<Vec<[f64; 2]>> {
        let (columns, rows) = (self.cells(self.width), self.cells(self.height));
        let mut used = vec![0_u32; columns * rows];
        let (mut lines, mut own) = (Vec::new(), 0);
        for gx in 0..columns {
            for gy in 0..rows {
                let start = [(gx as f64 + 0.5) * CELL, (gy as f64 + 0.5) * CELL];
                if !free(&used, [columns, rows], [gx, gy]) || self.slope(start).is_none() {
                    continue;
                }
                own += 1;
                used[gy * columns + gx] = own;
                let mut line = self.walk(start, -1.0, own, (&mut used, columns));
                line.reverse();
                line.push(start);
                line.extend(self.walk(start, 1.0, own, (&mut used, columns)));
                lines.extend(Some(line).filter(|line| line.len() >= SHORTEST));
            }
        }
        lines
    }

    fn cells(&self, pixels: usize) -> usize {
        (pixels as f64 / CELL).ceil() as usize
    }

    /// The direction at a place, of length 1.
    fn slope(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let inside = x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64;
        let [u, v] = inside.then(|| self.values[y as usize * self.width + x as usize])?;
        let size = u.hypot(v);
        (size > 0.0 && size.is_finite()).then(|| [u / size, v / size])
    }

    fn walk(&self, from: [f64; 2], sign: f64, own: u32, (used, columns): (&mut [u32], usize)) -> Vec<[f64; 2]> {
        let (mut at, mut line) = (from, Vec::new());
        let (mut last, mut again, mut here) = (usize::MAX, 0, 0);
        let ahead = |p: [f64; 2], d: [f64; 2], s: f64| [p[0] + sign * s * d[0], p[1] + sign * s * d[1]];
        for _ in 0..LONGEST {
            let half = self.slope(at).and_then(|d| self.slope(ahead(at, d, 0.5 * STEP)));
            let Some(next) = half.map(|d| ahead(at, d, STEP)).filter(|p| self.slope(*p).is_some()) else { break };
            let number = (next[1] / CELL) as usize * columns + (next[0] / CELL) as usize;
            let cell = &mut used[number];
            // a line that winds comes back to its own cells, or stays in one
            here = if number == last { here + 1 } else { 0 };
            again += usize::from(number != last && *cell == own);
            if *cell != 0 && *cell != own || again > AGAIN || here > LINGER {
                break;
            }
            (*cell, last) = (own, number);
            at = next;
            line.push(at);
        }
        line
    }
}

/// True when neither a cell nor those around it hold a line.
fn free(used: &[u32], [columns, rows]: [usize; 2], [gx, gy]: [usize; 2]) -> bool {
    let near = |g: usize, n: usize| (g as i64 - APART).max(0) as usize..=((g as i64 + APART) as usize).min(n - 1);
    near(gy, rows).all(|y| near(gx, columns).all(|x| used[y * columns + x] == 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_a_turning_field_are_circles() {
        let n = 300;
        let turning = |k: usize| [150.0 - (k / n) as f64, (k % n) as f64 - 150.0];
        let values: Vec<[f64; 2]> = (0..n * n).map(turning).collect();
        let lines = Directions { width: n, height: n, values: &values }.lines();
        assert!(lines.len() > 5, "{}", lines.len());
        for line in &lines {
            let radius = |p: &[f64; 2]| (p[0] - 150.5).hypot(p[1] - 150.5);
            let first = radius(&line[0]);
            assert!(line.iter().all(|p| (radius(p) - first).abs() < 3.0), "{first}");
        }
        let nothing = vec![[f64::NAN; 2]; 100];
        assert!(Directions { width: 10, height: 10, values: &nothing }.lines().is_empty());
    }
}
