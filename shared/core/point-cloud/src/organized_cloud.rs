//! Organised point cloud: points on the image grid.

use crate::Point;

/// Borrowed organised point cloud: `width x height` points, row-major.
#[derive(Debug, Clone, Copy)]
pub struct OrganizedCloud<'a> {
    points: &'a [Point],
    width: usize,
}

/// Error of a point count that does not match the width and height of the organised cloud.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{n_points} points do not fill a grid of {width}x{height}")]
pub struct SizeMismatch {
    n_points: usize,
    width: usize,
    height: usize,
}

impl<'a> OrganizedCloud<'a> {
    /// Creates an organised view of a slice of points.
    ///
    /// # Errors
    /// When the slice's length is not `width * height`, or a side is zero.
    pub fn new(points: &'a [Point], width: usize, height: usize) -> Result<Self, SizeMismatch> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(points.len()) {
            return Err(SizeMismatch {
                n_points: points.len(),
                width,
                height,
            });
        }
        Ok(Self { points, width })
    }

    /// All points of the cloud, row-major.
    #[inline]
    pub fn points(&self) -> &'a [Point] {
        self.points
    }

    /// Number of columns of the organised cloud.
    #[inline]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows of the organised cloud.
    #[inline]
    pub fn height(&self) -> usize {
        self.points.len() / self.width
    }

    /// One row of points of the organised cloud.
    ///
    /// # Panics
    /// When `row` is outside the image.
    #[inline]
    pub fn row(&self, row: usize) -> &'a [Point] {
        &self.points[row * self.width..(row + 1) * self.width]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_must_be_filled_exactly() {
        let points = [Point::default(); 12];
        let cloud = OrganizedCloud::new(&points, 4, 3).unwrap();
        assert_eq!(
            (cloud.width(), cloud.height(), cloud.row(2).len()),
            (4, 3, 4)
        );
        for (width, height) in [(4, 4), (0, 0), (0, 12), (12, 0), (usize::MAX, 2)] {
            assert!(OrganizedCloud::new(&points, width, height).is_err());
        }
    }
}
