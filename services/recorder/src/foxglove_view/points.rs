//! Thinned point cloud for viewers.

use super::{CAMERA, quaternion, vector};
use foxglove::bytes::Bytes;
use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{PackedElementField, PointCloud, Pose, Timestamp};
use message::CloudPoint;

/// Bytes of a point: x, y and z as 32-bit floats, red, green, blue and alpha.
const STRIDE: u32 = 16;

/// Every n-th point with depth, so that there are at most `max_points`.
pub(super) fn cloud(points: &[CloudPoint], max_points: usize, timestamp: Timestamp) -> PointCloud {
    let with_depth = || points.iter().filter(|point| point.z.is_finite());
    let step = with_depth().count().div_ceil(max_points).max(1);
    let mut data = Vec::with_capacity(max_points.min(points.len()) * STRIDE as usize);
    for point in with_depth().step_by(step) {
        for coordinate in [point.x, point.y, point.z] {
            data.extend(coordinate.to_le_bytes());
        }
        let [alpha, red, green, blue] = point.argb.to_be_bytes();
        data.extend([red, green, blue, alpha]);
    }
    PointCloud {
        timestamp: Some(timestamp),
        frame_id: CAMERA.into(),
        pose: Some(Pose {
            position: Some(vector([0.0; 3])),
            orientation: Some(quaternion([0.0, 0.0, 0.0, 1.0])),
        }),
        point_stride: STRIDE,
        fields: fields(),
        data: Bytes::from(data),
    }
}

fn fields() -> Vec<PackedElementField> {
    let (float, byte) = (NumericType::Float32, NumericType::Uint8);
    [
        ("x", 0, float),
        ("y", 4, float),
        ("z", 8, float),
        ("red", 12, byte),
        ("green", 13, byte),
        ("blue", 14, byte),
        ("alpha", 15, byte),
    ]
    .map(|(name, offset, kind)| PackedElementField {
        name: name.into(),
        offset,
        r#type: kind as i32,
    })
    .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cloud_has_at_most_the_wanted_points_and_none_without_depth() {
        let point = |i: u32| CloudPoint {
            z: if i.is_multiple_of(2) {
                f32::NAN
            } else {
                i as f32
            },
            argb: 0xff01_0203,
            ..CloudPoint::default()
        };
        let points: Vec<_> = (0..1000).map(point).collect();
        let n_points = |max| cloud(&points, max, Timestamp::MIN).data.len() / STRIDE as usize;
        assert_eq!([n_points(1), n_points(100), n_points(9999)], [1, 100, 500]);
        let first = &cloud(&points, 9999, Timestamp::MIN).data[8..16];
        assert_eq!(first, [0, 0, 0x80, 0x3f, 1, 2, 3, 255]);
    }
}
