//! Viewing rays of a pinhole camera.

/// Viewing rays of all columns and rows, scaled to z = 1.
#[derive(Debug)]
pub(crate) struct PixelRays {
    x: Vec<f32>,
    y: Vec<f32>,
}

impl PixelRays {
    pub(crate) fn new(camera: &geometry::PinholeCamera) -> Self {
        let ray = |column: u32, row: u32| camera.ray(f64::from(column), f64::from(row));
        Self {
            x: (0..camera.width).map(|u| ray(u, 0).x as f32).collect(),
            y: (0..camera.height).map(|v| ray(0, v).y as f32).collect(),
        }
    }

    pub(crate) fn size(&self) -> (usize, usize) {
        (self.x.len(), self.y.len())
    }

    /// x component of the ray of each column.
    pub(crate) fn x(&self) -> &[f32] {
        &self.x
    }

    /// y component of the ray of each row.
    pub(crate) fn y(&self) -> &[f32] {
        &self.y
    }
}
