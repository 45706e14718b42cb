//! Encoder of PCD files.

use super::MAX_POINTS;
use super::encoding::Encoding;
use super::error::Error;
use crate::lzf;
use geometry::RigidTransform;
use point_cloud::Point;

/// Borrowed content of a PCD file.
#[derive(Debug, Clone, Copy)]
pub struct PcdView<'a> {
    /// Points, row-major.
    pub points: &'a [Point],
    /// Label of each point, if the cloud has labels.
    pub labels: Option<&'a [u32]>,
    /// Columns; the number of points when the cloud is not organised.
    pub width: usize,
    /// Rows; 1 when the cloud is not organised.
    pub height: usize,
    /// Pose of the sensor: world from sensor.
    pub viewpoint: RigidTransform,
}

/// Encodes a PCD file of version 0.7 with the fields `x y z rgba` and, with labels, `label`.
/// Decoding gives the same cloud in every encoding, up to the bits of a NaN.
///
/// # Errors
/// When the points or labels do not fill the grid, the viewpoint is not finite,
/// or the cloud exceeds the reading limits.
pub fn write(cloud: PcdView<'_>, encoding: Encoding) -> Result<Vec<u8>, Error> {
    check(&cloud)?;
    let mut file = header(&cloud, encoding).into_bytes();
    match encoding {
        Encoding::Ascii => write_text(&cloud, &mut file),
        Encoding::Binary => write_interleaved(&cloud, &mut file),
        Encoding::BinaryCompressed => write_compressed(&cloud, &mut file),
    }
    Ok(file)
}

fn check(cloud: &PcdView<'_>) -> Result<(), Error> {
    let needed = cloud
        .width
        .checked_mul(cloud.height)
        .ok_or(Error::TooLarge)?;
    if needed > MAX_POINTS {
        return Err(Error::TooLarge);
    }
    let n_labels = cloud.labels.map_or(needed, <[u32]>::len);
    for (what, given) in [("points", cloud.points.len()), ("labels", n_labels)] {
        if given != needed {
            return Err(Error::SizeMismatch {
                what,
                given,
                needed,
            });
        }
    }
    let pose = cloud.viewpoint;
    if !pose
        .translation
        .vector
        .iter()
        .chain(pose.rotation.coords.iter())
        .all(|v| v.is_finite())
    {
        return Err(Error::Fields("the viewpoint must be finite"));
    }
    Ok(())
}

fn header(cloud: &PcdView<'_>, encoding: Encoding) -> String {
    let (fields, sizes, types, counts) = match cloud.labels {
        Some(_) => ("x y z rgba label", "4 4 4 4 4", "F F F U U", "1 1 1 1 1"),
        None => ("x y z rgba", "4 4 4 4", "F F F U", "1 1 1 1"),
    };
    let encoding = match encoding {
        Encoding::Ascii => "ascii",
        Encoding::Binary => "binary",
        Encoding::BinaryCompressed => "binary_compressed",
    };
    let (t, q) = (cloud.viewpoint.translation.vector, cloud.viewpoint.rotation);
    format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS {fields}\nSIZE {sizes}\n\
         TYPE {types}\nCOUNT {counts}\nWIDTH {}\nHEIGHT {}\n\
         VIEWPOINT {} {} {} {} {} {} {}\nPOINTS {}\nDATA {encoding}\n",
        cloud.width,
        cloud.height,
        t.x,
        t.y,
        t.z,
        q.w,
        q.i,
        q.j,
        q.k,
        cloud.points.len()
    )
}

fn write_text(cloud: &PcdView<'_>, file: &mut Vec<u8>) {
    for (point_idx, point) in cloud.points.iter().enumerate() {
        for coordinate in [point.x, point.y, point.z] {
            // PCL writes and reads NaN in lower case.
            let text = if coordinate.is_nan() {
                "nan".to_owned()
            } else {
                coordinate.to_string()
            };
            file.extend_from_slice(text.as_bytes());
            file.push(b' ');
        }
        file.extend_from_slice(point.color.0.to_string().as_bytes());
        if let Some(labels) = cloud.labels {
            file.push(b' ');
            file.extend_from_slice(labels[point_idx].to_string().as_bytes());
        }
        file.push(b'\n');
    }
}

fn write_interleaved(cloud: &PcdView<'_>, file: &mut Vec<u8>) {
    for (point_idx, point) in cloud.points.iter().enumerate() {
        for coordinate in [point.x, point.y, point.z] {
            file.extend_from_slice(&coordinate.to_le_bytes());
        }
        file.extend_from_slice(&point.color.0.to_le_bytes());
        if let Some(labels) = cloud.labels {
            file.extend_from_slice(&labels[point_idx].to_le_bytes());
        }
    }
}

fn write_compressed(cloud: &PcdView<'_>, file: &mut Vec<u8>) {
    let mut planes = Vec::with_capacity(20 * cloud.points.len());
    planes.extend(cloud.points.iter().flat_map(|point| point.x.to_le_bytes()));
    planes.extend(cloud.points.iter().flat_map(|point| point.y.to_le_bytes()));
    planes.extend(cloud.points.iter().flat_map(|point| point.z.to_le_bytes()));
    planes.extend(
        cloud
            .points
            .iter()
            .flat_map(|point| point.color.0.to_le_bytes()),
    );
    planes.extend(
        cloud
            .labels
            .unwrap_or_default()
            .iter()
            .flat_map(|label| label.to_le_bytes()),
    );
    let compressed = lzf::compress(&planes);
    // At most 20 bytes for each of MAX_POINTS: both sizes fit.
    file.extend_from_slice(&(compressed.len() as u32).to_le_bytes());
    file.extend_from_slice(&(planes.len() as u32).to_le_bytes());
    file.extend_from_slice(&compressed);
}
