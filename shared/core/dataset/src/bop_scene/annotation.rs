//! Annotation of a BOP image: camera, and poses of the objects.

use geometry::RigidTransform;
use nalgebra::{Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Deviation of a rotation matrix from orthonormality up to which it is accepted.
const ROTATION_TOLERANCE: f64 = 1e-2;
/// Greatest coordinate of a translation, millimetres.
const TRANSLATION_MAX_MM: f64 = 1e6;
/// Millimetres in a metre.
const MM_PER_M: f64 = 1000.0;

/// Entry of `scene_camera.json`.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct CameraEntry {
    #[serde(rename = "cam_K")]
    intrinsics: [f64; 9],
    #[serde(default = "one")]
    depth_scale: f64,
    #[serde(rename = "cam_R_w2c", skip_serializing_if = "Option::is_none")]
    rotation: Option<[f64; 9]>,
    #[serde(rename = "cam_t_w2c", skip_serializing_if = "Option::is_none")]
    translation_mm: Option<[f64; 3]>,
}

/// Entry of `scene_gt.json`.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct ObjectEntry {
    #[serde(rename = "obj_id")]
    model: u32,
    #[serde(rename = "cam_R_m2c")]
    rotation: [f64; 9],
    #[serde(rename = "cam_t_m2c")]
    translation_mm: [f64; 3],
}

/// Entry of `scene_gt_info.json`.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct VisibilityEntry {
    #[serde(rename = "visib_fract")]
    visible_share: f64,
}

impl CameraEntry {
    /// Entry of an image, for writing.
    pub(super) fn of(image: &BopImage) -> Self {
        let ([fx, fy], [cx, cy]) = (image.focal_px, image.principal_px);
        let pose = image.camera_from_world.as_ref().map(numbers);
        Self {
            intrinsics: [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
            depth_scale: image.depth_scale_mm,
            rotation: pose.map(|(rotation, _)| rotation),
            translation_mm: pose.map(|(_, translation_mm)| translation_mm),
        }
    }
}

impl ObjectEntry {
    /// Entry of an object, for writing.
    pub(super) fn of(object: &BopObject) -> Self {
        let (rotation, translation_mm) = numbers(&object.camera_from_object);
        Self {
            model: object.model,
            rotation,
            translation_mm,
        }
    }
}

impl VisibilityEntry {
    /// Entry of an object, for writing; `None` where its visible share is unknown.
    pub(super) fn of(object: &BopObject) -> Option<Self> {
        let visible_share = object.visible_share?;
        Some(Self { visible_share })
    }
}

/// Row-major rotation matrix and translation in millimetres.
fn numbers(pose: &RigidTransform) -> ([f64; 9], [f64; 3]) {
    let matrix = pose.rotation.to_rotation_matrix();
    let rotation = std::array::from_fn(|i| matrix[(i / 3, i % 3)]);
    (rotation, (pose.translation.vector * MM_PER_M).into())
}

fn one() -> f64 {
    1.0
}

/// Image of a BOP scene with its annotation.
#[derive(Debug, Clone, PartialEq)]
pub struct BopImage {
    /// Number of the image, as in the names of its files.
    pub number: u32,
    /// Focal lengths fx and fy, pixels.
    pub focal_px: [f64; 2],
    /// Principal point cx and cy, pixels from the centre of the first pixel.
    pub principal_px: [f64; 2],
    /// Millimetres in one unit of the depth image.
    pub depth_scale_mm: f64,
    /// Pose of the world in the camera; `None` where the data set has none.
    pub camera_from_world: Option<RigidTransform>,
    /// Objects of the ground truth, in the order of their masks.
    pub objects: Vec<BopObject>,
}

/// Object of the ground truth of a BOP image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BopObject {
    /// Number of the model, as in the name of its file.
    pub model: u32,
    /// Pose of the object in the camera, metres.
    pub camera_from_object: RigidTransform,
    /// Visible share of its silhouette; `None` without `scene_gt_info.json`.
    pub visible_share: Option<f64>,
}

impl BopImage {
    /// Image from its entries in the files; an error is the broken rule.
    pub(super) fn new(
        number: u32,
        camera: &CameraEntry,
        objects: &[ObjectEntry],
        visibility: Option<&[VisibilityEntry]>,
    ) -> Result<Self, &'static str> {
        let [fx, skew, cx, below, fy, cy, ..] = camera.intrinsics;
        if skew != 0.0 || below != 0.0 {
            return Err("its camera matrix must not have a skew");
        }
        let is_focal = |value: f64| (1.0..1e6).contains(&value);
        let is_place = |value: f64| (-1e5..1e5).contains(&value);
        if !is_focal(fx) || !is_focal(fy) || !is_place(cx) || !is_place(cy) {
            return Err("its camera matrix must have focal lengths of 1 to 1 000 000 pixels");
        }
        if !(1e-6..=1e3).contains(&camera.depth_scale) {
            return Err("its depth scale must lie between 0.000001 and 1000 mm");
        }
        let camera_from_world = match (&camera.rotation, &camera.translation_mm) {
            (Some(rotation), Some(translation_mm)) => Some(pose(rotation, translation_mm)?),
            _ => None,
        };
        if visibility.is_some_and(|shares| shares.len() != objects.len()) {
            return Err("scene_gt_info.json must list as many objects as scene_gt.json");
        }
        let object = |(index, raw): (usize, &ObjectEntry)| {
            Ok(BopObject {
                model: raw.model,
                camera_from_object: pose(&raw.rotation, &raw.translation_mm)?,
                visible_share: visibility
                    .map(|shares| share(shares[index].visible_share))
                    .transpose()?,
            })
        };
        Ok(Self {
            number,
            focal_px: [fx, fy],
            principal_px: [cx, cy],
            depth_scale_mm: camera.depth_scale,
            camera_from_world,
            objects: objects
                .iter()
                .enumerate()
                .map(object)
                .collect::<Result<_, &'static str>>()?,
        })
    }
}

fn share(value: f64) -> Result<f64, &'static str> {
    if (0.0..=1.0).contains(&value) {
        Ok(value)
    } else {
        Err("its visible shares (visib_fract) must lie between 0 and 1")
    }
}

/// Pose of a row-major rotation matrix and a translation in millimetres.
fn pose(rotation: &[f64; 9], translation_mm: &[f64; 3]) -> Result<RigidTransform, &'static str> {
    let matrix = Matrix3::from_row_slice(rotation);
    let off = (matrix * matrix.transpose() - Matrix3::identity())
        .abs()
        .max();
    // Written so that numbers that are none are refused.
    if !(off < ROTATION_TOLERANCE && matrix.determinant() > 0.0) {
        return Err("its rotations must be orthonormal matrices of nine numbers");
    }
    if !translation_mm
        .iter()
        .all(|value| value.abs() <= TRANSLATION_MAX_MM)
    {
        return Err("its translations must be within 1 km, in millimetres");
    }
    // The nearest rotation: files have few decimals.
    let rotation = Rotation3::from_matrix(&matrix);
    let translation = Translation3::from(Vector3::from(*translation_mm) / MM_PER_M);
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
    Ok(RigidTransform::from_parts(translation, rotation))
}
