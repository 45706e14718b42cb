//! Local surface features: covariances of the points in small overlapping windows.
//!
//! *Source*: surface variation is that of Pauly, Gross and Kobbelt, "Efficient
//! simplification of point-sampled surfaces", 2002; linearity is the dimensionality
//! feature of Demantké, Mallet, David and Vallet 2011.

use crate::projected_points::{LANES, ProjectedPoints};
use std::f32::consts::TAU;

/// Side of a grid cell, metres; a window has three times this side. Chosen on mesh
/// categories: 24 mm windows hold enough points at 1 m to average the depth noise.
const CELL_M: f32 = 0.008;

/// Maximum number of cells along the longest side; larger objects have larger cells.
const N_CELLS_MAX: f32 = 48.0;

/// Minimum number of points in a window.
const N_POINTS_MIN: f32 = 6.0;

/// Cell without points in the dense grid.
const EMPTY: u16 = u16::MAX;

/// Local surface around the points of one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocalSurface {
    /// Number of points in the cell.
    pub(super) n_points: f32,
    /// Height of the window's centroid above the middle of the box, metres.
    pub(super) height_m: f32,
    /// Absolute vertical component of the normal: 1 for a horizontal surface.
    pub(super) tilt: f32,
    /// Square root of the surface variation, 0 for a plane to 0.58 for a ball of points.
    pub(super) roughness: f32,
    /// Linearity, 1 for an edge or a thin rod, 0 for a surface.
    pub(super) linearity: f32,
}

/// Number, sums and sums of products of points, in cells: n x y z, xx xy xz yy, yz zz.
/// Padded to whole vector registers. Single precision suffices, because coordinates are
/// below 25 cells and depth noise is above a twentieth of one.
#[derive(Debug, Clone, Copy, Default)]
struct MomentSums([f32; 12]);

/// Grid of cells over the bounding box of an object, reused from object to object.
#[derive(Debug, Clone, Default)]
pub(super) struct SurfaceGrid {
    /// Index of each cell's sums, row-major in x, y, z, with an empty layer on each side.
    /// Turning the object by quarters about the middle of its box maps cells to cells.
    indices: Vec<u16>,
    sums: Vec<MomentSums>,
    /// Place of each cell with points in `indices`.
    places: Vec<u32>,
}

impl MomentSums {
    #[inline]
    fn add(&mut self, [x, y, z]: [f32; 3]) {
        let point = [
            1.0,
            x,
            y,
            z,
            x * x,
            x * y,
            x * z,
            y * y,
            y * z,
            z * z,
            0.0,
            0.0,
        ];
        self.merge(&Self(point));
    }

    #[inline]
    fn merge(&mut self, other: &Self) {
        for (sum, value) in self.0.iter_mut().zip(other.0) {
            *sum += value;
        }
    }

    fn n_points(&self) -> f32 {
        self.0[0]
    }

    fn mean(&self) -> [f32; 3] {
        let [n, x, y, z, ..] = self.0;
        [x / n, y / n, z / n]
    }

    /// Covariance xx, xy, xz, yy, yz, zz.
    fn covariance(&self) -> [f32; 6] {
        let ([x, y, z], per_point) = (self.mean(), self.n_points().recip());
        let products = [x * x, x * y, x * z, y * y, y * z, z * z];
        std::array::from_fn(|i| self.0[4 + i] * per_point - products[i])
    }
}

impl SurfaceGrid {
    /// Calls `each` with the local surface of every cell whose window has enough points.
    /// `ranges_m` are the sides of the points' bounding box.
    pub(super) fn for_each_surface(
        &mut self,
        points: &ProjectedPoints,
        ranges_m: [(f32, f32); 3],
        mut each: impl FnMut(LocalSurface),
    ) {
        let (shape, cell_m) = self.fill(points, ranges_m);
        for (index, &place) in self.places.iter().enumerate() {
            let window = self.window(place as usize, shape);
            if window.n_points() >= N_POINTS_MIN {
                each(local_surface(&window, self.sums[index].n_points(), cell_m));
            }
        }
    }

    /// Sums over a cell and the 26 cells around it.
    fn window(&self, place: usize, [_, n_y, n_z]: [usize; 3]) -> MomentSums {
        let mut window = MomentSums::default();
        let corner = place - (n_y + 1) * n_z - 1;
        for column in 0..9 {
            let first = corner + (column / 3 * n_y + column % 3) * n_z;
            for &neighbour in &self.indices[first..first + 3] {
                if neighbour != EMPTY {
                    window.merge(&self.sums[usize::from(neighbour)]);
                }
            }
        }
        window
    }

    /// Sums the points by cell; returns the numbers of cells along x, y and z, and
    /// the side of a cell, metres.
    fn fill(&mut self, points: &ProjectedPoints, ranges_m: [(f32, f32); 3]) -> ([usize; 3], f32) {
        let half_m = ranges_m.map(|(low, high)| 0.5 * (high - low));
        let cell_m = CELL_M.max(2.0 * half_m.into_iter().fold(0.0, f32::max) / N_CELLS_MAX);
        let per_m = cell_m.recip();
        // Cells of one half, and the empty layer.
        let n_half = half_m.map(|half_m| (half_m * per_m) as usize + 2);
        let shape = n_half.map(|n| 2 * n);
        let middle_m: [f32; 3] = std::array::from_fn(|axis| ranges_m[axis].0 + half_m[axis]);
        self.indices.clear();
        self.indices.resize(shape.iter().product(), EMPTY);
        self.sums.clear();
        self.places.clear();
        for block in points.blocks() {
            for i in (0..LANES).filter(|&i| !block.x[i].is_nan()) {
                let at = [block.x[i], block.y[i], block.z[i]];
                let at: [f32; 3] = std::array::from_fn(|axis| (at[axis] - middle_m[axis]) * per_m);
                // Rounding must not leave the grid.
                let [x, y, z] = std::array::from_fn(|axis| {
                    let cell = (at[axis] + n_half[axis] as f32) as usize;
                    cell.clamp(1, shape[axis] - 2)
                });
                let place = (x * shape[1] + y) * shape[2] + z;
                self.sums_at(place).add(at);
            }
        }
        (shape, cell_m)
    }

    fn sums_at(&mut self, place: usize) -> &mut MomentSums {
        let mut index = usize::from(self.indices[place]);
        // The longest side has 48 cells, but their number is limited by the points only.
        if index == usize::from(EMPTY) {
            index = self.sums.len().min(usize::from(EMPTY) - 1);
            self.indices[place] = index as u16;
            if index == self.sums.len() {
                self.sums.push(MomentSums::default());
                self.places.push(place as u32);
            }
        }
        &mut self.sums[index]
    }
}

fn local_surface(window: &MomentSums, n_points: f32, cell_m: f32) -> LocalSurface {
    let covariance = window.covariance();
    let [least, middle, largest] = eigenvalues(&covariance);
    let sum = least + middle + largest;
    let share = |part: f32, whole: f32| if whole > 0.0 { part / whole } else { 0.0 };
    LocalSurface {
        n_points,
        height_m: window.mean()[2] * cell_m,
        tilt: vertical_component(&covariance, [least, middle, largest]),
        roughness: share(least, sum).max(0.0).sqrt(),
        linearity: share(largest - middle, largest),
    }
}

/// Eigenvalues of a symmetric 3 x 3 matrix in ascending order, by the trigonometric
/// solution of the characteristic equation (Smith 1961). Values below zero by rounding
/// become zero.
fn eigenvalues(&[xx, xy, xz, yy, yz, zz]: &[f32; 6]) -> [f32; 3] {
    let mean = (xx + yy + zz) / 3.0;
    let (a, b, c) = (xx - mean, yy - mean, zz - mean);
    let off = xy * xy + xz * xz + yz * yz;
    let radius = ((a * a + b * b + c * c + 2.0 * off) / 6.0).sqrt();
    if radius <= f32::MIN_POSITIVE {
        return [mean.max(0.0); 3];
    }
    let determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
    let cosine = (determinant / (2.0 * radius.powi(3))).clamp(-1.0, 1.0);
    let angle = cosine.acos() / 3.0;
    let largest = mean + 2.0 * radius * angle.cos();
    let least = mean + 2.0 * radius * (angle + TAU / 3.0).cos();
    let middle = 3.0 * mean - largest - least;
    [least, middle, largest].map(|value| value.max(0.0))
}

/// Absolute z component of the unit eigenvector of the least eigenvalue, by the
/// eigenvector-eigenvalue identity (Denton, Parke, Tao and Zhang 2021); 0 where that
/// eigenvector is not determined.
fn vertical_component(
    &[xx, xy, _, yy, _, _]: &[f32; 6],
    [least, middle, largest]: [f32; 3],
) -> f32 {
    let minor = (xx - least) * (yy - least) - xy * xy;
    let gaps = (middle - least) * (largest - least);
    if gaps <= f32::MIN_POSITIVE {
        return 0.0;
    }
    (minor / gaps).clamp(0.0, 1.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, SymmetricEigen, Vector3};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn closed_form_equals_the_iterative_solution(
            rows in prop::array::uniform3(prop::array::uniform3(-1.0_f32..1.0)),
        ) {
            let root = Matrix3::from_fn(|i, j| rows[i][j]);
            let m = root * root.transpose();
            let packed = [m[(0, 0)], m[(0, 1)], m[(0, 2)], m[(1, 1)], m[(1, 2)], m[(2, 2)]];
            let eigen = SymmetricEigen::new(m);
            let mut order = [0, 1, 2];
            order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
            let found = eigenvalues(&packed);
            // A double root of the equation has the square root of the rounding error.
            let tolerance = f32::EPSILON.sqrt() * found[2].max(0.1);
            for (value, &i) in found.iter().zip(&order) {
                prop_assert!((value - eigen.eigenvalues[i]).abs() < tolerance, "{found:?}");
            }
            let normal: Vector3<f32> = eigen.eigenvectors.column(order[0]).into();
            // The eigenvector is well determined only where the values differ. The rounding error
            // is that of its square.
            if found[1] - found[0] > 0.1 {
                let vertical = vertical_component(&packed, found);
                prop_assert!((vertical.powi(2) - normal.z.powi(2)).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn degenerate_windows_have_finite_features() {
        for covariance in [
            [0.0; 6],
            [1e-30, 0.0, 0.0, 0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0, 1.0, 0.0, 1.0],
        ] {
            let values = eigenvalues(&covariance);
            assert!(values.iter().all(|value| value.is_finite()), "{values:?}");
            let vertical = vertical_component(&covariance, values);
            assert!((0.0..=1.0).contains(&vertical), "{vertical}");
        }
    }
}
