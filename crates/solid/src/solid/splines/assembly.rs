//! Matrices of a body in the spline basis: stiffness, mass, and the springs of the supports.
use super::basis::{Axis, LIVE};
use super::points::{FOUR, Point, Rays, of_surface};
use super::{Body, HeldBox, Mirror, SplineModesError};
use crate::math::Vector;
use crate::math::parallel::sweep_each;
use crate::math::sparse::{Factors, Symmetric};
use crate::physics::solid::{MOST_HISTORY, Material, tangent_product, tensor};

/// Number of splines that differ from zero in a cell.
const LOCAL: usize = LIVE * LIVE * LIVE;
/// Greatest number of coefficients.
const MAX_UNKNOWNS: usize = 60_000;
/// Stiffness of the support springs: this factor times the modulus over the cell length on the surface, over its square
/// inside.
const HOLD: f64 = 100.0;
/// Fractions of the diagonal that are added, one after the other, until the stiffness can be factored; needed for cells
/// that the body hardly touches.
const FLOOR: [f64; 4] = [1e-13, 1e-12, 1e-11, 1e-10];
/// Tolerance of the sides of a box, relative to the size of the body.
const SLACK: f64 = 1e-6;
/// Number of cells whose local matrices are computed in one batch.
const BATCH: usize = 64;

/// Tangent ∂P/∂F of the undeformed material: `a[m][n][i][j]` is the derivative of stress component (m, i) by gradient
/// component (n, j).
type Tangent = [[[[f64; 3]; 3]; 3]; 3];

/// The spline space on the lattice, restricted to the body.
#[derive(Clone, Debug)]
pub(super) struct Space {
    axes: [Axis; 3],
    /// Number of each spline among those whose support meets the body; `u32::MAX` for the others.
    number: Vec<u32>,
    /// Number of splines whose support meets the body.
    pub(super) live: usize,
    /// Cells that meet the body.
    cells: Vec<Cell>,
    /// Number of each cell of the lattice among these; `u32::MAX` for the others.
    cell_number: Vec<u32>,
}

/// A cell with the integration points of the body in it.
#[derive(Clone, Debug, Default)]
struct Cell {
    place: [usize; 3],
    /// Integration points with the density and the material there.
    points: Vec<(Point, f64, u16)>,
    /// Points at which the body is constrained, with the spring stiffness along each axis.
    springs: Vec<(Vector<3>, [f64; 3])>,
}

/// Stiffness and mass matrices of a body.
pub(super) struct Matrices {
    pub(super) space: Space,
    pub(super) volume: f64,
    pub(super) mass_of_body: f64,
    stiffness: Symmetric,
    /// Mass matrix ∫ ρ N N, equal for each direction.
    mass: Symmetric,
}

/// Local matrices of a cell.
#[derive(Clone, Default)]
struct Local {
    stiffness: Vec<[[f64; 3]; 3]>,
    mass: Vec<f64>,
}

impl Space {
    fn counts(&self) -> [usize; 3] {
        std::array::from_fn(|d| self.axes[d].len())
    }

    /// Indices of the splines that differ from zero in a cell, in local order.
    fn of(&self, place: [usize; 3]) -> impl Iterator<Item = usize> {
        let [_, nb, nc] = self.counts();
        let first: [usize; 3] = std::array::from_fn(|d| self.axes[d].first[place[d]]);
        (0..LOCAL).map(move |k| {
            let [i, j, l] = [k / (LIVE * LIVE), k / LIVE % LIVE, k % LIVE];
            ((first[0] + i) * nb + first[1] + j) * nc + first[2] + l
        })
    }

    /// Values and gradients at `x` of the splines that differ from zero in a cell.
    fn at(&self, place: [usize; 3], x: &Vector<3>) -> [[f64; 4]; LOCAL] {
        let [a, b, c]: [[[f64; 2]; LIVE]; 3] = std::array::from_fn(|d| self.axes[d].at(place[d], x[d]));
        std::array::from_fn(|k| {
            let ([u, du], [v, dv], [w, dw]) = (a[k / (LIVE * LIVE)], b[k / LIVE % LIVE], c[k % LIVE]);
            [u * v * w, du * v * w, u * dv * w, u * v * dw]
        })
    }

    fn index(&self, place: [usize; 3]) -> usize {
        (place[0] * self.axes[1].cells() + place[1]) * self.axes[2].cells() + place[2]
    }

    fn cell(&self, x: &Vector<3>) -> [usize; 3] {
        std::array::from_fn(|d| self.axes[d].cell(x[d]))
    }

    /// The nearest cell that meets the body, among the cell of `x` and its neighbours.
    fn near(&self, x: &Vector<3>) -> Option<[usize; 3]> {
        let home = self.cell(x);
        let mut best: Option<(f64, [usize; 3])> = None;
        for k in 0..27usize {
            let step = [k / 9, k / 3 % 3, k % 3];
            let place: [usize; 3] = std::array::from_fn(|d| (home[d] + step[d]).wrapping_sub(1));
            if (0..3).any(|d| place[d] >= self.axes[d].cells()) || self.cell_number[self.index(place)] == u32::MAX {
                continue;
            }
            let off = |d: usize| {
                let ends = &self.axes[d].ends;
                (ends[place[d]] - x[d]).max(x[d] - ends[place[d] + 1]).max(0.0)
            };
            let far: f64 = (0..3).map(|d| off(d).powi(2)).sum();
            if best.is_none_or(|(least, _)| far < least) {
                best = Some((far, place));
            }
        }
        best.map(|(_, place)| place)
    }

    /// Value at `x` of the field with these coefficients.
    pub(super) fn value(&self, coefficients: &[f64], x: &Vector<3>) -> Vector<3> {
        let Some(place) = self.near(x) else { return Vector::ZERO };
        let at = self.at(place, x);
        self.of(place).zip(at).fold(Vector::ZERO, |sum, (spline, [value, ..])| {
            let k = 3 * self.number[spline] as usize;
            sum + Vector::from_fn(|d| coefficients[k + d]) * value
        })
    }

    /// Integration points of the body with their masses.
    pub(super) fn masses(&self) -> impl Iterator<Item = (&Vector<3>, f64)> {
        self.cells.iter().flat_map(|cell| &cell.points).map(|(p, density, _)| (&p.x, p.weight * density))
    }

    /// Numbers of the splines of a cell among those whose support meets the body.
    fn numbers(&self, cell: &Cell) -> [usize; LOCAL] {
        let mut all = [0; LOCAL];
        all.iter_mut().zip(self.of(cell.place)).for_each(|(n, spline)| *n = self.number[spline] as usize);
        all
    }
}

/// A lattice over the body, with breaks at the supports, and the axis of the rays.
fn lattice(body: &Body<'_>, size: f64) -> ([Axis; 3], usize) {
    let bounds = body.surface.bounds();
    let axes = std::array::from_fn(|d| {
        let (mut low, mut high) = (bounds.min[d], bounds.max[d]);
        for mirror in body.mirrors.iter().filter(|m| m.axis == d) {
            if mirror.below { high = mirror.place } else { low = mirror.place }
        }
        let breaks: Vec<f64> = body.held.iter().flat_map(|h| h.place[d]).filter(|x| x.is_finite()).collect();
        Axis::new([low, high], size, &breaks)
    });
    let extent = bounds.extent();
    let free = |d: &usize| !body.mirrors.iter().any(|m| m.axis == *d);
    let along = (0..3).filter(free).min_by(|a, b| extent[*a].total_cmp(&extent[*b])).unwrap_or(2);
    (axes, along)
}

impl Matrices {
    pub(super) fn new(body: &Body<'_>, size: f64) -> Result<Self, SplineModesError> {
        let (axes, along) = lattice(body, size);
        let space = filled(body, axes, along)?;
        let space = held(body, space, along)?;
        let tangents: Vec<Tangent> = body.materials.iter().map(tangent).collect();
        let rows = neighbours(&space);
        let (mut stiffness, mut mass) = (pattern(&rows, 3), pattern(&rows, 1));
        let mut locals = vec![Local::default(); BATCH];
        for batch in space.cells.chunks(BATCH) {
            sweep_each(&mut locals[..batch.len()], |k| local(&space, &batch[k], &tangents));
            for (cell, local) in batch.iter().zip(&locals) {
                scatter(&space.numbers(cell), local, &rows, (&mut stiffness, &mut mass));
            }
        }
        let volume = space.cells.iter().flat_map(|c| &c.points).map(|(p, ..)| p.weight).sum();
        let mass_of_body = space.masses().map(|(_, m)| m).sum();
        Ok(Self { space, volume, mass_of_body, stiffness, mass })
    }

    /// The product M x.
    pub(super) fn inertia(&self, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; x.len()];
        for column in 0..self.mass.len() {
            for k in self.mass.first[column]..self.mass.first[column + 1] {
                let (row, value) = (self.mass.row[k], self.mass.value[k]);
                for d in 0..3 {
                    out[3 * row + d] += value * x[3 * column + d];
                    if row != column {
                        out[3 * column + d] += value * x[3 * row + d];
                    }
                }
            }
        }
        out
    }

    /// Factors of K + shift M; `None` when this is not positive definite.
    pub(super) fn factor(&self, shift: f64) -> Option<Factors> {
        FLOOR.iter().find_map(|floor| {
            let mut sum = self.stiffness.clone();
            for column in 0..self.mass.len() {
                for k in self.mass.first[column]..self.mass.first[column + 1] {
                    for d in 0..3 {
                        let at = place_in(&sum, 3 * column + d, 3 * self.mass.row[k] + d);
                        sum.value[at] += shift * self.mass.value[k];
                    }
                }
            }
            (0..sum.len()).for_each(|c| sum.value[sum.first[c]] *= 1.0 + floor);
            sum.factor()
        })
    }
}

/// The spline space with the integration points of the body.
fn filled(body: &Body<'_>, axes: [Axis; 3], along: usize) -> Result<Space, SplineModesError> {
    let cells: usize = axes.iter().map(Axis::cells).product();
    let splines: usize = axes.iter().map(Axis::len).product();
    let mut space = Space {
        number: vec![u32::MAX; splines],
        live: 0,
        cells: Vec::new(),
        cell_number: vec![u32::MAX; cells],
        axes: axes.clone(),
    };
    let rays = Rays::new(body.surface, &axes, along);
    let mut columns = vec![Vec::new(); rays.columns()];
    sweep_each(&mut columns, |column| rays.points(column));
    for point in columns.into_iter().flatten() {
        let place = space.cell(&point.x);
        let index = space.index(place);
        if space.cell_number[index] == u32::MAX {
            space.cell_number[index] = space.cells.len() as u32;
            space.cells.push(Cell { place, ..Cell::default() });
        }
        let material = (body.material)(&point.x);
        let density = body.materials[material].density;
        space.cells[space.cell_number[index] as usize].points.push((point, density, material as u16));
    }
    for k in 0..space.cells.len() {
        for spline in space.of(space.cells[k].place).collect::<Vec<_>>() {
            space.number[spline] = 0;
        }
    }
    for number in space.number.iter_mut().filter(|n| **n == 0) {
        *number = space.live as u32;
        space.live += 1;
    }
    match 3 * space.live {
        0 => Err(SplineModesError::Hollow),
        unknowns if unknowns > MAX_UNKNOWNS => Err(SplineModesError::TooLarge { unknowns, most: MAX_UNKNOWNS }),
        _ => Ok(space),
    }
}

/// Adds the springs of the supports and planes of symmetry.
fn held(body: &Body<'_>, mut space: Space, along: usize) -> Result<Space, SplineModesError> {
    let sizes = space.axes.iter().map(|a| a.ends.windows(2).map(|e| e[1] - e[0]).fold(f64::INFINITY, f64::min));
    let least = sizes.fold(f64::INFINITY, f64::min);
    let slack = SLACK * body.surface.bounds().extent().norm();
    let young = |x: &Vector<3>| body.materials[(body.material)(x)].moduli.young();
    let within =
        |x: &Vector<3>, h: &HeldBox| (0..3).all(|d| h.place[d][0] - slack <= x[d] && x[d] <= h.place[d][1] + slack);
    let mut found = vec![false; body.held.len()];
    let mut springs: Vec<(Vector<3>, [f64; 3])> = Vec::new();
    let mut put = |x: &Vector<3>, stiffness: f64, fixed: [bool; 3]| {
        springs.push((*x, fixed.map(|f| if f { stiffness } else { 0.0 })));
    };
    let sections: Vec<(Point, Mirror)> =
        body.mirrors.iter().flat_map(|m| section(body, &space.axes, along, m)).collect();
    for (p, mirror) in &sections {
        put(&p.x, HOLD * young(&p.x) / least * p.weight, std::array::from_fn(|d| d == mirror.axis));
    }
    for (k, h) in body.held.iter().enumerate() {
        let mut hold = |x: &Vector<3>, weight: f64, depth: f64| {
            if within(x, h) {
                put(x, HOLD * young(x) / depth * weight, h.fixed);
                found[k] = true;
            }
        };
        of_surface(body.surface, 0.3 * largest(&space.axes), |p| {
            if !body.beyond(&p.x, slack) {
                hold(&p.x, p.weight, least);
            }
        });
        sections.iter().for_each(|(p, _)| hold(&p.x, p.weight, least));
        space.cells.iter().flat_map(|c| &c.points).for_each(|(p, ..)| hold(&p.x, p.weight, least * least));
    }
    if let Some(number) = found.iter().position(|f| !f) {
        return Err(SplineModesError::Unsupported { number });
    }
    for (x, stiffness) in springs {
        if let Some(place) = space.near(&x) {
            let number = space.cell_number[space.index(place)] as usize;
            space.cells[number].springs.push((x, stiffness));
        }
    }
    Ok(space)
}

/// Length of the longest side of a cell.
fn largest(axes: &[Axis; 3]) -> f64 {
    axes.iter().flat_map(|a| a.ends.windows(2).map(|e| e[1] - e[0])).fold(0.0, f64::max)
}

/// Integration points on the section of a body by a plane of symmetry.
fn section(body: &Body<'_>, axes: &[Axis; 3], along: usize, mirror: &Mirror) -> Vec<(Point, Mirror)> {
    let across = 3 - along - mirror.axis;
    let mut flat = axes.clone();
    // one thin cell at the plane: the volume that its rays find, divided by its thickness, is the area
    let thin = SLACK * body.surface.bounds().extent()[mirror.axis];
    let ends = if mirror.below { [mirror.place - thin, mirror.place] } else { [mirror.place, mirror.place + thin] };
    flat[mirror.axis] = Axis::new(ends, thin, &[]);
    let size = (axes[across].ends[1] - axes[across].ends[0]) / FOUR.len() as f64;
    flat[across] = Axis::new([axes[across].ends[0], axes[across].ends[axes[across].cells()]], size, &[]);
    let rays = Rays::new(body.surface, &flat, along);
    let points = (0..rays.columns()).flat_map(|column| rays.points(column));
    points.map(|p| (Point { weight: p.weight / thin, ..p }, *mirror)).collect()
}

/// Tangent ∂P/∂F of the undeformed material.
fn tangent(material: &Material) -> Tangent {
    let mut history = [0.0; MOST_HISTORY];
    material.begin(&mut history[..material.history_len()]);
    let mut all = [[[[0.0; 3]; 3]; 3]; 3];
    for n in 0..3 {
        for j in 0..3 {
            let df = tensor::of(|a, b| if (a, b) == (n, j) { 1.0 } else { 0.0 });
            let dp = tangent_product(material, &tensor::identity(), &df, &history[..material.history_len()], 0.0);
            (0..3).for_each(|m| (0..3).for_each(|i| all[m][n][i][j] = dp[m][i]));
        }
    }
    all
}

/// For each spline, the splines with equal or greater numbers with which it shares a cell.
fn neighbours(space: &Space) -> Vec<Vec<u32>> {
    let mut rows: Vec<Vec<u32>> = vec![Vec::new(); space.live];
    for cell in &space.cells {
        let numbers = space.numbers(cell);
        for i in numbers {
            rows[i].extend(numbers.iter().filter(|j| **j >= i).map(|j| *j as u32));
        }
    }
    rows.iter_mut().for_each(|row| {
        row.sort_unstable();
        row.dedup();
    });
    rows
}

/// Zero matrix with blocks of order `d`, lower triangle.
fn pattern(rows: &[Vec<u32>], d: usize) -> Symmetric {
    let mut matrix = Symmetric { first: vec![0], row: Vec::new(), value: Vec::new() };
    for (i, row) in rows.iter().enumerate() {
        for c in 0..d {
            let all = row.iter().flat_map(|j| (0..d).map(move |e| d * *j as usize + e));
            matrix.row.extend(all.filter(|r| *r >= d * i + c));
            matrix.first.push(matrix.row.len());
        }
    }
    matrix.value = vec![0.0; matrix.row.len()];
    matrix
}

/// Position of the entry (row, column) in the values of a matrix.
fn place_in(matrix: &Symmetric, column: usize, row: usize) -> usize {
    let (from, to) = (matrix.first[column], matrix.first[column + 1]);
    from + matrix.row[from..to].partition_point(|r| *r < row)
}

/// Local stiffness and mass matrices of a cell.
fn local(space: &Space, cell: &Cell, tangents: &[Tangent]) -> Local {
    let mut out = Local { stiffness: vec![[[0.0; 3]; 3]; LOCAL * LOCAL], mass: vec![0.0; LOCAL * LOCAL] };
    for (number, tangent) in tangents.iter().enumerate() {
        let own = cell.points.iter().filter(|(.., m)| usize::from(*m) == number);
        let mut products = vec![[[0.0; 3]; 3]; LOCAL * LOCAL];
        let mut any = false;
        for (point, density, _) in own {
            any = true;
            let at = space.at(cell.place, &point.x);
            for i in 0..LOCAL {
                let weighed = at[i].map(|v| v * point.weight);
                for j in 0..=i {
                    let product = &mut products[i * LOCAL + j];
                    (0..3).for_each(|a| (0..3).for_each(|b| product[a][b] += weighed[a + 1] * at[j][b + 1]));
                    out.mass[i * LOCAL + j] += density * weighed[0] * at[j][0];
                }
            }
        }
        for k in (0..LOCAL * LOCAL).filter(|k| any && k % LOCAL <= k / LOCAL) {
            for (m, n) in (0..3).flat_map(|m| (0..3).map(move |n| (m, n))) {
                let sum = |a: usize| (0..3).map(|b| tangent[m][n][a][b] * products[k][a][b]).sum::<f64>();
                out.stiffness[k][m][n] += sum(0) + sum(1) + sum(2);
            }
        }
    }
    for (x, stiffness) in &cell.springs {
        let at = space.at(cell.place, x);
        for (i, j) in (0..LOCAL).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            (0..3).for_each(|d| out.stiffness[i * LOCAL + j][d][d] += stiffness[d] * at[i][0] * at[j][0]);
        }
    }
    out
}

/// Adds the local matrices of a cell to the global ones.
fn scatter(
    numbers: &[usize; LOCAL],
    local: &Local,
    rows: &[Vec<u32>],
    (stiffness, mass): (&mut Symmetric, &mut Symmetric),
) {
    for (i, j) in (0..LOCAL).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let k = i * LOCAL + j;
        // the local block has row i and column j; in the global matrix the greater number is the row
        let (row, column, turned) =
            if numbers[i] >= numbers[j] { (numbers[i], numbers[j], false) } else { (numbers[j], numbers[i], true) };
        let at = rows[column].partition_point(|r| (*r as usize) < row);
        mass.value[mass.first[column] + at] += local.mass[k];
        for (m, n) in (0..3).flat_map(|m| (0..3).map(move |n| (m, n))) {
            if row == column && m < n {
                continue;
            }
            let value = if turned { local.stiffness[k][n][m] } else { local.stiffness[k][m][n] };
            // each column of a diagonal block starts with its diagonal entry
            stiffness.value[stiffness.first[3 * column + n] + 3 * at + m - n] += value;
        }
    }
}
