//! Registration of the models of objects with the segments of a view.

use super::bin_scene::BinScene;
use super::object_recognition::RecognisedObject;
use super::segment_matching::SceneSegment;
use geometry::RigidTransform;
use nalgebra::Point3;
use registration::{
    KdTree, ModelCandidate, ModelPose, PoseModel, SegmentView, estimate_pose, identify,
};
use sensor_noise::DepthNoise;
use service::Failure;

/// Share of the diameter that the nearest-point error of a right pose is below (Hinterstoisser et
/// al. 2012).
const RIGHT_SHARE: f64 = 0.1;

/// Model registered with a segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct RegisteredModel {
    /// Index of the object whose model it is.
    pub(super) object: usize,
    pub(super) world_from_object: RigidTransform,
    /// `true` if the model is probably there.
    pub(super) is_good: bool,
    pub(super) contradiction: f64,
    /// Correctness of the pose that the true model gets; `None` for a segment that covers no
    /// object.
    pub(super) is_true_model_right: Option<bool>,
    /// `true` if the model is that of the object that the segment covers, at a right pose.
    pub(super) is_right: bool,
}

/// Model of one or several equal objects.
#[derive(Debug)]
struct RegistrationModel {
    /// First object with this model.
    object: usize,
    pose_model: PoseModel,
    tree: KdTree,
}

/// Models of the objects of a scene for registration.
#[derive(Debug)]
pub(super) struct RegistrationModels {
    models: Vec<RegistrationModel>,
    /// Index of the model of each object.
    model_of_object: Vec<usize>,
}

impl RegistrationModels {
    /// Models of the objects of a scene; equal objects have one.
    pub(super) fn of(scene: &BinScene) -> Result<Self, Failure> {
        let mut models: Vec<RegistrationModel> = Vec::new();
        let mut model_of_object = Vec::new();
        for (object, of_scene) in scene.objects.iter().enumerate() {
            let is_equal =
                |model: &RegistrationModel| scene.objects[model.object].model == of_scene.model;
            if let Some(known) = models.iter().position(is_equal) {
                model_of_object.push(known);
                continue;
            }
            let (points, spacing_m) = (of_scene.model.points(), of_scene.model.spacing_m());
            model_of_object.push(models.len());
            models.push(RegistrationModel {
                object,
                pose_model: PoseModel::new(points, spacing_m).map_err(Failure::general)?,
                tree: KdTree::new(points),
            });
        }
        Ok(Self {
            models,
            model_of_object,
        })
    }

    /// Models that a segment may show: what recognition leaves over is shared by the models that
    /// it does not name.
    fn candidates(&self, recognised: &[RecognisedObject]) -> Vec<ModelCandidate<usize>> {
        let mut named = vec![None; self.models.len()];
        for recognised in recognised {
            let model = self.model_of_object[recognised.object];
            *named[model].get_or_insert(0.0) += recognised.probability;
        }
        let left: f64 = 1.0 - named.iter().flatten().sum::<f64>();
        let n_others = named.iter().filter(|named| named.is_none()).count();
        let share = left.max(0.0) / n_others.max(1) as f64;
        let candidate = |(model, probability): (usize, &Option<f64>)| ModelCandidate {
            model,
            probability: probability.unwrap_or(share),
        };
        named.iter().enumerate().map(candidate).collect()
    }

    /// Model that a segment shows, by what it is recognised as and by the poses of the models;
    /// `None` when none of them comes to lie on it.
    pub(super) fn register(
        &self,
        scene: &BinScene,
        segment: &SceneSegment,
        frame: &[[f32; 3]],
        world_from_camera: &RigidTransform,
    ) -> Option<RegisteredModel> {
        let view = SegmentView::new(&segment.in_camera, frame, DepthNoise::KINECT_V1).ok()?;
        let estimate = |model: usize| estimate_pose(&self.models[model].pose_model, &view).ok();
        let best = identify(&self.candidates(&segment.recognised), estimate)?;
        let true_model = segment.object.map(|object| self.model_of_object[object]);
        let is_right = |(model, pose): &(usize, ModelPose)| {
            let object = segment.object.filter(|_| Some(*model) == true_model);
            let world_from_model = world_from_camera * pose.camera_from_model;
            object.is_some_and(|object| self.is_right(scene, object, &world_from_model))
        };
        let of_true = true_model.map(|model| {
            let known = (model == best.0).then_some(best.1);
            let pose = known.or_else(|| estimate(model));
            pose.is_some_and(|pose| is_right(&(model, pose)))
        });
        Some(RegisteredModel {
            object: self.models[best.0].object,
            world_from_object: world_from_camera * best.1.camera_from_model,
            is_good: best.1.is_good(),
            contradiction: best.1.contradiction,
            is_true_model_right: of_true,
            is_right: is_right(&best),
        })
    }

    /// `true` if the mean distance of a model's points in an estimated pose from the nearest in
    /// the true one (ADD-S, Hinterstoisser et al. 2012) is below a tenth of the diameter.
    fn is_right(&self, scene: &BinScene, object: usize, estimated: &RigidTransform) -> bool {
        let RegistrationModel {
            pose_model, tree, ..
        } = &self.models[self.model_of_object[object]];
        let of_scene = &scene.objects[object];
        let true_from_estimated = of_scene.world_from_object.inverse() * estimated;
        let distance_m = |point: &[f32; 3]| {
            let place = true_from_estimated * Point3::from(*point).cast::<f64>();
            let nearest = tree.nearest(place.cast::<f32>().into(), f32::INFINITY);
            nearest.map_or(f64::INFINITY, |(_, squared)| f64::from(squared).sqrt())
        };
        let points = of_scene.coarse.points();
        let sum_m: f64 = points.iter().map(distance_m).sum();
        sum_m < RIGHT_SHARE * pose_model.diameter_m() * points.len() as f64
    }
}
