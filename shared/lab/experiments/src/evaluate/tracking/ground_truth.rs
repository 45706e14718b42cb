//! The truth of a simulated frame as the score needs it.

use evaluation::tracked_frame::GroundTruthObject;
use evaluation::true_shape::{SeenSurface, WholeShape};
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::{Isometry3, Point3, UnitVector3, Vector3};
use simulated_world::{ObjectModel, ObjectState, ObjectTruth};
use std::collections::BTreeMap;

/// An object must be tracked when at least this share of it is seen.
const VISIBLE_MIN: f64 = 0.3;
/// And when at least so many pixels show it.
const VISIBLE_PX_MIN: u32 = 200;
/// And when it lies wholly so far inside of the image, pixels: depth ends before
/// the image does.
const BORDER_PX: f64 = 10.0;

/// Recorded depth that is farther than this outside of an object's box is that of
/// something else, whatever the mask says, metres.
const REACH_M: f64 = 0.005;

/// GroundTruth of one object that lasts from frame to frame.
struct ObjectShape {
    whole: WholeShape,
    seen: SeenSurface,
    half_sides_m: Vector3<f64>,
}

/// All objects of a scene by number.
pub(super) struct GroundTruth {
    camera: PinholeCamera,
    objects: BTreeMap<u16, ObjectShape>,
}

/// Depth and object of each pixel.
pub(super) struct LabelledDepthImage<'a> {
    /// Along the camera's axis, row by row; what is not finite is none.
    pub(super) depth_m: &'a [f32],
    /// Whether the depth is that before the sensor's errors.
    pub(super) is_exact: bool,
    pub(super) mask: &'a [u16],
    pub(super) world_from_camera: RigidTransform,
    pub(super) up_in_world: UnitVector3<f64>,
}

impl GroundTruth {
    pub(super) fn new(camera: PinholeCamera) -> Self {
        Self {
            camera,
            objects: BTreeMap::new(),
        }
    }

    /// Makes an object known by its model.
    pub(super) fn know(&mut self, id: u16, model: &ObjectModel) {
        self.objects.entry(id).or_insert_with(|| {
            let vertices = model.mesh.vertices.iter();
            let points = vertices.map(|vertex| vertex.position.cast());
            ObjectShape::new(points.collect(), model.half_sides_m)
        });
    }

    /// Makes an object known by its model if it is a generated one, else as a box.
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

    /// The objects of a frame. What a pixel shows is added to what was seen of its
    /// object.
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
            if id == 0 || !depth_m.is_finite() {
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

/// Points of the surface of a generated object, by its name: `mug-3`.
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

/// Whether all corners of a box are seen well inside of the image.
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
