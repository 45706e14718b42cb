//! PCD files of Washington views.

use super::view::CroppedView;
use crate::Error;
use crate::pcd;
use geometry::PinholeCamera;
use point_cloud::Point;

/// Decodes a view's points from its PCD file, with or without `imX imY`. Points that are not
/// finite are dropped.
///
/// *Frame*: camera, metres.
///
/// # Errors
/// When the bytes are not a PCD file this crate reads.
pub fn read_cloud(bytes: &[u8]) -> Result<Vec<Point>, pcd::Error> {
    let mut points = pcd::read(bytes)?.points;
    points.retain(Point::is_finite);
    for point in &mut points {
        // Camera from file: x, y, z from x, -z, y.
        (point.y, point.z) = (-point.z, point.y);
    }
    Ok(points)
}

/// Encodes the points of a view as a binary PCD file with the fields of the dataset. The camera
/// is that of the whole image.
///
/// # Errors
/// When a vector of the view does not fill the cut-out.
pub fn write_cloud(view: &CroppedView, camera: &PinholeCamera) -> Result<Vec<u8>, Error> {
    view.check()?;
    let n_points = view.object_pixels().count();
    let mut file = format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb imX imY\n\
         SIZE 4 4 4 4 4 4\nTYPE F F F F F F\nCOUNT 1 1 1 1 1 1\nWIDTH {n_points}\nHEIGHT 1\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {n_points}\nDATA binary\n"
    )
    .into_bytes();
    file.reserve(24 * n_points);
    for pixel in view.object_pixels() {
        let point = view.point(camera, pixel);
        let (column, row) = view.pixel_in_image(pixel);
        // The bits of a packed colour are stored as those of a float.
        let rgb = f32::from_bits(point.color.0 & 0x00ff_ffff);
        let (im_x, im_y) = ((column + 1) as f32, (row + 1) as f32);
        let fields = [point.x, point.z, -point.y, rgb, im_x, im_y];
        file.extend_from_slice(fields.map(f32::to_le_bytes).as_flattened());
    }
    Ok(file)
}
