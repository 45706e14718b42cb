//! Ground truth of a frame: reference boxes and visibility of its objects.

use evaluation::tracked_frame::GroundTruthObject;
use evaluation::true_shape::{SeenSurface, WholeShape};
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::{Isometry3, Point3, UnitVector3, Vector3};
use simulated_world::{ObjectModel, ObjectState, ObjectTruth};
use std::collections::BTreeMap;

/// Minimum visible share of an object for which tracking is scored. Chosen; part of the metric
/// definition.
const VISIBLE_MIN: f64 = 0.3;
/// Minimum number of visible pixels of an object for which tracking is scored. Chosen; part of the
/// metric definition.
const VISIBLE_PX_MIN: u32 = 200;
/// Minimum distance of a scored object's box from the image border, pixels: depth ends before the
/// image does. Chosen; part of the metric definition.
const BORDER_PX: f64 = 10.0;

/// Maximum distance of recorded depth outside of an object's box, metres; farther depth belongs to
/// something else, whatever the mask says. Chosen.
const REACH_M: f64 = 0.005;

/// Maximum slope of a face against the image plane for which its points count, as a tangent: 80°.
/// Of steeper faces a depth camera sees next to nothing, and edge fattening covers that. Chosen;
/// part of the metric definition.
const SLOPE_MAX: f64 = 5.7;

/// Shape of one object and its surface seen so far.
struct ObjectShape {
    whole: WholeShape,
    seen: SeenSurface,
    half_sides_m: Vector3<f64>,
}

/// Ground truth of all objects of a scene, by number.
pub(super) struct GroundTruth {
    camera: PinholeCamera,
    objects: BTreeMap<u16, ObjectShape>,
}

/// Depth image with the object number of each pixel.
pub(super) struct LabelledDepthImage<'a> {
    /// Depth along the optical axis, metres, row-major; NaN where invalid.
    pub(super) depth_m: &'a [f32],
    /// True for a depth image without sensor errors.
    pub(super) is_exact: bool,
    pub(super) mask: &'a [u16],
    pub(super) world_from_camera: RigidTransform,
    pub(super) up_in_world: UnitVector3<f64>,
}

impl LabelledDepthImage<'_> {
    /// Slope test: `true` if the surface at a pixel is not seen edge-on. In each direction of the
    /// image, of the two neighbours on the same object the one with less difference counts; a
    /// pixel without such neighbours is resolved.
    fn is_resolved(&self, pixel: usize, camera: &PinholeCamera) -> bool {
        let (width, depth_m) = (camera.width as usize, self.depth_m[pixel]);
        let column = pixel % width;
        let step_m = |neighbour: Option<usize>| {
            let neighbour =
                neighbour.filter(|&other| self.mask.get(other) == Some(&self.mask[pixel]))?;
            let difference_m = (self.depth_m[neighbour] - depth_m).abs();
            difference_m.is_finite().then_some(f64::from(difference_m))
        };
        let slope = |neighbours: [Option<usize>; 2], focal_px: f64| {
            let least_m = neighbours
                .into_iter()
                .filter_map(step_m)
                .min_by(f64::total_cmp);
            least_m.unwrap_or(0.0) * focal_px / f64::from(depth_m)
        };
        let (left, right) = (column > 0, column + 1 < width);
        let along_row = [left.then(|| pixel - 1), right.then(|| pixel + 1)];
        let along_column = [pixel.checked_sub(width), Some(pixel + width)];
        slope(along_row, camera.fx_px).hypot(slope(along_column, camera.fy_px)) <= SLOPE_MAX
    }
}

impl GroundTruth {
    pub(super) fn new(camera: PinholeCamera) -> Self {
        Self {
            camera,
            objects: BTreeMap::new(),
        }
    }

    /// Registers an object with the shape of its model.
    pub(super) fn know(&mut self, id: u16, model: &ObjectModel) {
        self.objects.entry(id).or_insert_with(|| {
            let vertices = model.mesh.vertices.iter();
            let points = vertices.map(|vertex| vertex.position.cast());
            ObjectShape::new(points.collect(), model.half_sides_m)
        });
    }

    /// Adds an object by the name of its generated model, else as a box.
    pub(super) fn know_by_name(&mut self, object: &ObjectTruth) {
        self.objects.entry(object.id).or_insert_with(|| {
            let half_sides_m = object.size_m / 2.0;
            let points = generated_points(object);
            ObjectShape::new(
                points.unwrap_or_else(|| corners(&half_sides_m)),
                half_sides_m,
            )
        });
    }

    /// Ground-truth objects of a frame; adds the pixels to the surfaces seen so far.
    pub(super) fn of_frame(
        &mut self,
        view: &LabelledDepthImage<'_>,
        objects: &[ObjectTruth],
    ) -> Vec<GroundTruthObject> {
        self.look(view, objects);
        let objects = objects.iter().filter_map(|object| {
            let known = self.objects.get_mut(&object.id)?;
            let pose = &object.world_from_object;
            let (whole_box, symmetry) = known.whole.upright_box(pose, &view.up_in_world)?;
            let camera_from_object = view.world_from_camera.inverse() * pose;
            let is_inside = is_inside(&self.camera, &camera_from_object, &known.half_sides_m);
            Some(GroundTruthObject {
                id: u64::from(object.id),
                world_from_object: *pose,
                whole_box,
                seen_box: known.seen.upright_box(pose, &view.up_in_world),
                symmetry,
                range_m: camera_from_object.translation.vector.norm(),
                is_visible: object.visible_px > 0,
                counts: is_inside
                    && object.visible_fraction() >= VISIBLE_MIN
                    && object.visible_px >= VISIBLE_PX_MIN
                    && object.state != ObjectState::OnFloor,
            })
        });
        objects.collect()
    }

    fn look(&mut self, view: &LabelledDepthImage<'_>, objects: &[ObjectTruth]) {
        let object_from_camera: BTreeMap<u16, Isometry3<f32>> = objects
            .iter()
            .map(|object| {
                let object_from_world = object.world_from_object.inverse();
                let pose = object_from_world * view.world_from_camera;
                (object.id, pose.cast())
            })
            .collect();
        let width = self.camera.width as usize;
        for (pixel, (&id, &depth_m)) in view.mask.iter().zip(view.depth_m).enumerate() {
            if id == 0 || !depth_m.is_finite() || !view.is_resolved(pixel, &self.camera) {
                continue;
            }
            let (Some(known), Some(pose)) =
                (self.objects.get_mut(&id), object_from_camera.get(&id))
            else {
                continue;
            };
            let (column, row) = ((pixel % width) as f64, (pixel / width) as f64);
            let in_camera = self.camera.back_project(column, row, f64::from(depth_m));
            let point = pose * in_camera.cast::<f32>();
            if view.is_exact || known.is_at(&point) {
                known.seen.add(point);
            }
        }
    }
}

impl ObjectShape {
    fn new(points: Vec<Point3<f64>>, half_sides_m: Vector3<f64>) -> Self {
        Self {
            whole: WholeShape::new(points),
            seen: SeenSurface::default(),
            half_sides_m,
        }
    }

    fn is_at(&self, point: &Point3<f32>) -> bool {
        (0..3).all(|axis| f64::from(point[axis]).abs() <= self.half_sides_m[axis] + REACH_M)
    }
}

/// Surface points of a generated object, by its name such as `mug-3`.
fn generated_points(object: &ObjectTruth) -> Option<Vec<Point3<f64>>> {
    let instance = object.name.strip_prefix(&object.category)?;
    let instance = instance.strip_prefix('-')?.parse().ok()?;
    let model = ObjectModel::generated(&object.category, instance).ok()?;
    // A model from a file may have the name of a generated one.
    let is_same = (2.0 * model.half_sides_m - object.size_m).amax() < 1e-4;
    let vertices = model.mesh.vertices.iter();
    is_same.then(|| vertices.map(|vertex| vertex.position.cast()).collect())
}

fn corners(half_sides_m: &Vector3<f64>) -> Vec<Point3<f64>> {
    let corner = |i: usize| {
        let sign = Vector3::from_fn(|axis, _| if i >> axis & 1 == 1 { 1.0 } else { -1.0 });
        Point3::from(half_sides_m.component_mul(&sign))
    };
    (0..8).map(corner).collect()
}

/// True if all corners of a box project well inside the image.
fn is_inside(
    camera: &PinholeCamera,
    camera_from_object: &RigidTransform,
    half_sides_m: &Vector3<f64>,
) -> bool {
    let columns = BORDER_PX..=f64::from(camera.width) - BORDER_PX;
    let rows = BORDER_PX..=f64::from(camera.height) - BORDER_PX;
    corners(half_sides_m).iter().all(|corner| {
        let pixel = camera.project(&(camera_from_object * corner));
        pixel.is_some_and(|pixel| columns.contains(&pixel.x) && rows.contains(&pixel.y))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Upright face from column 20 on, seen under an angle against the image plane.
    #[test]
    fn a_face_seen_edge_on_is_not_resolved() {
        let camera = PinholeCamera {
            width: 40,
            height: 3,
            ..PinholeCamera::KINECT_V1
        };
        let mask: Vec<u16> = (0..120).map(|i| if i % 40 < 20 { 1 } else { 2 }).collect();
        for (slope, is_resolved) in [(0.5, true), (4.0, true), (8.0, false)] {
            let step_m = slope / camera.fx_px as f32;
            let depth_m: Vec<f32> = (0..120)
                .map(|i| 1.0 + step_m * (i % 40 - 20).max(0) as f32)
                .collect();
            let view = LabelledDepthImage {
                depth_m: &depth_m,
                is_exact: true,
                mask: &mask,
                world_from_camera: RigidTransform::identity(),
                up_in_world: Vector3::z_axis(),
            };
            assert!(view.is_resolved(40 + 19, &camera), "beside the face");
            assert_eq!(view.is_resolved(40 + 20, &camera), is_resolved, "{slope}");
            assert_eq!(view.is_resolved(119, &camera), is_resolved, "{slope}");
        }
    }
}
