//! Intersection over union of oriented boxes.

use geometry::OrientedBox;
use nalgebra::Vector3;

/// Number of samples along each side of a box; the result is accurate to a few percent.
const N_SAMPLES: usize = 12;

/// Intersection over union of two boxes, 0 to 1, by grid sampling in the smaller one; 0
/// when neither has a volume.
pub(super) fn iou(a: &OrientedBox, b: &OrientedBox) -> f64 {
    if !a.bounding_spheres_meet(b, 0.0) {
        return 0.0;
    }
    let (small, large) = if a.volume_m3() <= b.volume_m3() {
        (a, b)
    } else {
        (b, a)
    };
    let common_m3 = small.volume_m3() * share_within(small, large);
    let union_m3 = small.volume_m3() + large.volume_m3() - common_m3;
    if union_m3 > 0.0 {
        common_m3 / union_m3
    } else {
        0.0
    }
}

/// Share of the box `inner` that lies inside `outer`.
fn share_within(inner: &OrientedBox, outer: &OrientedBox) -> f64 {
    let outer_from_inner = outer.frame_from_box.inverse() * inner.frame_from_box;
    let turn = outer_from_inner.rotation.to_rotation_matrix();
    // Steps from the centre to the samples along each side of the inner box.
    let steps: [[Vector3<f64>; N_SAMPLES]; 3] = std::array::from_fn(|side| {
        let half_side = turn.matrix().column(side) * inner.half_sides_m[side];
        std::array::from_fn(|i| half_side * ((2 * i + 1) as f64 / N_SAMPLES as f64 - 1.0))
    });
    let [along_x, along_y, along_z] = steps;
    let mut n_common = 0_u32;
    for z in along_z {
        for y in along_y {
            let row = outer_from_inner.translation.vector + z + y;
            for x in along_x {
                let seen = (row + x).abs();
                let half = &outer.half_sides_m;
                n_common += u32::from(seen.x <= half.x && seen.y <= half.y && seen.z <= half.z);
            }
        }
    }
    f64::from(n_common) / N_SAMPLES.pow(3) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Isometry3;
    use proptest::prelude::*;

    fn upright(centre: Vector3<f64>, half_sides_m: Vector3<f64>) -> OrientedBox {
        OrientedBox {
            frame_from_box: Isometry3::translation(centre.x, centre.y, centre.z),
            half_sides_m,
        }
    }

    fn lengths() -> impl Strategy<Value = Vector3<f64>> {
        prop::array::uniform3(0.02..0.2_f64).prop_map(Vector3::from)
    }

    proptest! {
        #[test]
        fn iou_of_parallel_boxes_matches_intervals(
            half in lengths(), other_half in lengths(),
            shift in prop::array::uniform3(-0.2..0.2_f64),
            turn in prop::array::uniform3(-2.0..2.0_f64),
        ) {
            let shift = Vector3::from(shift);
            let common_m3: f64 = (0..3)
                .map(|i| {
                    let high = half[i].min(shift[i] + other_half[i]);
                    let low = (-half[i]).max(shift[i] - other_half[i]);
                    (high - low).max(0.0)
                })
                .product();
            let (a, b) = (upright(Vector3::zeros(), half), upright(shift, other_half));
            let expected = common_m3 / (a.volume_m3() + b.volume_m3() - common_m3);
            // The same pair in another frame.
            let view = Isometry3::new(Vector3::new(0.3, -0.2, 1.0), turn.into());
            let found = iou(&a.transformed(&view), &b.transformed(&view));
            prop_assert!((found - expected).abs() < 0.15, "{} for {}", found, expected);
            prop_assert!(expected > 0.0 || found < 1e-9);
        }
    }

    #[test]
    fn iou_of_identical_flat_and_non_finite_boxes() {
        let solid = upright(Vector3::zeros(), Vector3::repeat(0.05));
        assert!((iou(&solid, &solid) - 1.0).abs() < 1e-9);
        let flat = upright(Vector3::zeros(), Vector3::new(0.05, 0.05, 0.0));
        assert!(iou(&flat, &flat).abs() < 1e-9);
        let broken = upright(Vector3::repeat(f64::NAN), Vector3::repeat(0.05));
        assert!(iou(&solid, &broken).abs() < 1e-9);
    }
}
