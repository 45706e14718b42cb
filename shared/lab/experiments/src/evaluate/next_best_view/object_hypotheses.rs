//! Object hypotheses of an experiment: noisy truth, with missing and false objects, or the
//! segments of detection.

use super::bin_scene::{BinScene, SPACING_M};
use super::captured_view::CapturedView;
use super::object_registration::RegisteredModel;
use super::segment_matching::SceneSegment;
use geometry::RigidTransform;
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use next_best_view::{ExplainedSpace, Hypothesis, PlanningScene, SurfaceModel};
use random::{Random, mix64};
use serde::Serialize;
use service::Failure;

/// Visible share from which on an object counts as seen. Chosen.
pub(super) const SEEN_SHARE: f64 = 0.1;
/// Identity of the first fragment, above those of the objects.
const FIRST_FRAGMENT: u32 = 1000;
/// Least number of points of a fragment. Chosen.
const FRAGMENT_POINTS_MIN: usize = 20;

/// Noise of hypotheses that are made from the truth.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct HypothesisNoise {
    /// Standard deviation of the position along each axis, metres.
    pub(super) translation_m: f64,
    /// Standard deviation of the rotation about each axis, degrees.
    pub(super) rotation_deg: f64,
    /// Share of the objects that are missed.
    pub(super) missing_share: f64,
    /// Number of false objects.
    pub(super) n_false: u32,
}

impl HypothesisNoise {
    /// Exact poses of all objects.
    pub(super) const NONE: Self = Self {
        translation_m: 0.0,
        rotation_deg: 0.0,
        missing_share: 0.0,
        n_false: 0,
    };
    /// Errors of a pose estimate on the depth of a Kinect. Chosen.
    pub(super) const POSES: Self = Self {
        translation_m: 0.005,
        rotation_deg: 3.0,
        ..Self::NONE
    };
    /// Errors of poses and of recognition. Chosen.
    pub(super) const ALL: Self = Self {
        missing_share: 0.1,
        n_false: 1,
        ..Self::POSES
    };
}

/// Hypotheses with models of their own for fragments.
#[derive(Debug, Default)]
pub(super) struct ObjectHypotheses {
    /// Index of the object whose model it is, and pose.
    placed: Vec<(usize, RigidTransform)>,
    /// Fragments, world frame.
    fragments: Vec<SurfaceModel>,
}

impl ObjectHypotheses {
    /// Noisy truth of the objects that `is_known` holds for, the same for one seed.
    pub(super) fn noisy(
        scene: &BinScene,
        noise: &HypothesisNoise,
        seed: u64,
        is_known: impl Fn(usize) -> bool,
    ) -> Self {
        let mut placed = Vec::new();
        for (index, object) in scene.objects.iter().enumerate() {
            // Each object has its own numbers, whichever others are known.
            let mut random = Random::substream(seed, mix64(index as u64));
            let pose = moved(&object.world_from_object, noise, &mut random);
            if random.unit() >= noise.missing_share && is_known(index) {
                placed.push((index, pose));
            }
        }
        let mut random = Random::substream(seed, mix64(u64::MAX));
        for _ in 0..noise.n_false {
            placed.push(false_object(scene, &mut random));
        }
        Self {
            placed,
            fragments: Vec::new(),
        }
    }

    /// Models that were registered with segments.
    pub(super) fn of_models<'a>(models: impl Iterator<Item = &'a RegisteredModel>) -> Self {
        let placed = models.map(|model| (model.object, model.world_from_object));
        Self {
            placed: placed.collect(),
            fragments: Vec::new(),
        }
    }

    /// Adds the segments of a view on which no model lies, as they were measured.
    pub(super) fn add_unregistered(&mut self, view: &CapturedView) -> Result<(), Failure> {
        let segments = view.segments.segments.iter();
        for segment in segments.filter(|segment| segment.good_model().is_none()) {
            self.add_fragment(segment, view)?;
        }
        Ok(())
    }

    /// Adds the segments of a view that are no object of their own, as they were measured.
    pub(super) fn add_fragments(&mut self, view: &CapturedView) -> Result<(), Failure> {
        let segments = view.segments.segments.iter();
        for segment in segments.filter(|segment| segment.object.is_none()) {
            self.add_fragment(segment, view)?;
        }
        Ok(())
    }

    fn add_fragment(&mut self, segment: &SceneSegment, view: &CapturedView) -> Result<(), Failure> {
        let points = in_world(segment, &view.world_from_camera);
        if points.len() >= FRAGMENT_POINTS_MIN {
            let model = SurfaceModel::of_points(&points, SPACING_M);
            self.fragments.push(model.map_err(Failure::general)?);
        }
        Ok(())
    }

    /// Hypotheses for planning: identities are those of the objects, then the fragments.
    fn hypotheses<'a>(&'a self, scene: &'a BinScene) -> Vec<Hypothesis<'a>> {
        let placed = self.placed.iter().enumerate();
        let placed = placed.map(|(number, (object, pose))| Hypothesis {
            // A false object is none of the true ones, whichever model it has.
            id: number as u32,
            model: &scene.objects[*object].model,
            world_from_object: *pose,
        });
        let fragments = self.fragments.iter().zip(FIRST_FRAGMENT..);
        let fragments = fragments.map(|(model, id)| Hypothesis {
            id,
            model,
            world_from_object: RigidTransform::identity(),
        });
        placed.chain(fragments).collect()
    }

    /// Scene for planning with these hypotheses; its background is the furniture, and the measured
    /// points that no hypothesis explains.
    pub(super) fn planning_scene(
        &self,
        scene: &BinScene,
        measured: &[[f32; 3]],
    ) -> Result<PlanningScene, Failure> {
        let hypotheses = self.hypotheses(scene);
        let mut explained = ExplainedSpace::new(scene.workspace.least);
        for (object, pose) in &self.placed {
            explained.add(&scene.objects[*object].coarse, pose);
        }
        for fragment in &self.fragments {
            explained.add(fragment, &RigidTransform::identity());
        }
        let background: Vec<[f32; 3]> = measured
            .iter()
            .filter(|point| !explained.contains(&Point3::from(**point).cast()))
            .chain(&scene.furniture)
            .copied()
            .collect();
        PlanningScene::new(&hypotheses, &background).map_err(Failure::general)
    }
}

/// Points of a segment in the frame of the world, metres.
fn in_world(segment: &SceneSegment, world_from_camera: &RigidTransform) -> Vec<[f32; 3]> {
    let place = |point: &[f32; 3]| world_from_camera * Point3::from(*point).cast::<f64>();
    let places = segment.in_camera.iter().map(place);
    places.map(|place| place.cast::<f32>().into()).collect()
}

/// Pose with noise, about the object's origin.
fn moved(pose: &RigidTransform, noise: &HypothesisNoise, random: &mut Random) -> RigidTransform {
    let mut vector = |sigma: f64| Vector3::from_fn(|_, _| sigma * random.normal());
    let shift = vector(noise.translation_m);
    let turn = UnitQuaternion::from_scaled_axis(vector(noise.rotation_deg.to_radians()));
    RigidTransform::from_parts(
        Translation3::from(pose.translation.vector + shift),
        turn * pose.rotation,
    )
}

/// Model of one of the objects, at a random pose in the lower half of the workspace.
fn false_object(scene: &BinScene, random: &mut Random) -> (usize, RigidTransform) {
    let (least, greatest) = (scene.workspace.least, scene.workspace.greatest);
    let object = random.below(scene.objects.len());
    let place = Vector3::from_fn(|axis, _| {
        let share = if axis == 2 { 0.4 } else { 0.8 };
        let side_m = greatest[axis] - least[axis];
        least[axis] + side_m * (0.1 + share * random.unit())
    });
    let turn = Vector3::from_fn(|_, _| random.between(-2.0, 2.0));
    let rotation = UnitQuaternion::from_scaled_axis(turn);
    (object, RigidTransform::from_parts(place.into(), rotation))
}
