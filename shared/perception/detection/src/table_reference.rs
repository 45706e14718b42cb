//! Table reference of a point cloud: coordinates in the table's frame, and the depth noise
//! measured on the table.

use crate::affine_form::AffineForm;
use crate::table::Table;
use sensor_noise::DepthNoise;

/// Coordinates in the table's frame as affine forms, and the depth noise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TableReference {
    /// Both coordinates on the table and the height over it, metres.
    pub(crate) axes: [AffineForm; 3],
    /// Depth noise measured on the table.
    pub(crate) noise: DepthNoise,
}

impl From<&Table> for TableReference {
    fn from(table: &Table) -> Self {
        Self {
            axes: AffineForm::coordinates_of(&table.table_from_camera),
            noise: table.depth_noise,
        }
    }
}
