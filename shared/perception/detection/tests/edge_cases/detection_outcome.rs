//! Comparison of a detection with the ground truth of a synthetic scene.

use crate::synthetic_scene::SyntheticScene;
use detection::{
    Config, Detection, DetectionInput, Execution, ScenePriors, Table, Workspace, detect,
};
use nalgebra::{Point2, Point3, Unit, Vector3};
use point_cloud::{OrganizedCloud, Point};

/// Label of a pixel without a candidate.
pub(crate) const NO_CANDIDATE: usize = usize::MAX;

pub(crate) struct DetectionOutcome {
    pub(crate) scene: SyntheticScene,
    pub(crate) detection: Detection,
    /// Ground-truth label of each pixel.
    pub(crate) truth: Vec<u16>,
    /// Candidate of each pixel, or [`NO_CANDIDATE`].
    pub(crate) candidate_of: Vec<usize>,
}

/// Detection in a cloud with default settings.
pub(crate) fn detected(
    points: &[Point],
    size: (usize, usize),
    up_in_camera: Option<Unit<Vector3<f64>>>,
) -> Detection {
    detected_with(points, size, up_in_camera, ScenePriors::default())
}

fn detected_with(
    points: &[Point],
    size: (usize, usize),
    up_in_camera: Option<Unit<Vector3<f64>>>,
    priors: ScenePriors<'_>,
) -> Detection {
    let mut detection = Detection::default();
    let frame = DetectionInput {
        cloud: OrganizedCloud::new(points, size.0, size.1).expect("a full grid"),
        up_in_camera,
        priors,
    };
    let (config, mut workspace) = (Config::default(), Workspace::default());
    detect(
        &frame,
        &config,
        &mut workspace,
        &mut detection,
        Execution::default(),
    )
    .expect("an image");
    detection
}

fn size_of(scene: &SyntheticScene) -> (usize, usize) {
    (scene.camera.width as usize, scene.camera.height as usize)
}

impl DetectionOutcome {
    /// Outcome for a scene with unknown up.
    pub(crate) fn of(scene: &SyntheticScene) -> Self {
        Self::with_up(scene, None)
    }

    /// Outcomes for a scene without and with known up.
    pub(crate) fn both(scene: &SyntheticScene) -> [Self; 2] {
        [None, Some(scene.up_in_camera())].map(|up| Self::with_up(scene, up))
    }

    fn with_up(scene: &SyntheticScene, up: Option<Unit<Vector3<f64>>>) -> Self {
        let (points, truth) = scene.render();
        Self::of_points(scene, &points, truth, up)
    }

    pub(crate) fn of_points(
        scene: &SyntheticScene,
        points: &[Point],
        truth: Vec<u16>,
        up: Option<Unit<Vector3<f64>>>,
    ) -> Self {
        let detection = detected(points, size_of(scene), up);
        Self::of_detection(scene, detection, truth)
    }

    /// Outcome for a scene with unknown up and known priors.
    pub(crate) fn with_priors(scene: &SyntheticScene, priors: ScenePriors<'_>) -> Self {
        let (points, truth) = scene.render();
        let detection = detected_with(&points, size_of(scene), None, priors);
        Self::of_detection(scene, detection, truth)
    }

    fn of_detection(scene: &SyntheticScene, detection: Detection, truth: Vec<u16>) -> Self {
        let mut candidate_of = vec![NO_CANDIDATE; truth.len()];
        for (number, candidate) in detection.candidates.iter().enumerate() {
            for &pixel in detection.points_of(candidate) {
                candidate_of[pixel as usize] = number;
            }
        }
        Self {
            scene: scene.clone(),
            detection,
            truth,
            candidate_of,
        }
    }

    pub(crate) fn table(&self) -> &Table {
        self.detection.table().expect("a table")
    }

    /// Height of the table over the floor along a vertical line, metres.
    pub(crate) fn table_height_m(&self, at: [f64; 2]) -> f64 {
        let world_from_camera = self.scene.camera_from_world.inverse();
        let plane = self.table().plane.transformed(&world_from_camera);
        -(plane.offset_m + plane.normal.x * at[0] + plane.normal.y * at[1]) / plane.normal.z
    }

    /// Position in the table's frame of a point given in the world frame.
    pub(crate) fn on_table(&self, place: [f64; 3]) -> Point2<f64> {
        let in_camera = self.scene.camera_from_world * Point3::from(place);
        (self.table().table_from_camera * in_camera).xy()
    }

    /// Area of the outline polygon, square metres.
    pub(crate) fn outline_m2(&self) -> f64 {
        let corners = &self.table().outline.corners;
        let next = corners.iter().cycle().skip(1);
        let twice: f64 = corners
            .iter()
            .zip(next)
            .map(|(a, b)| a.x * b.y - b.x * a.y)
            .sum();
        0.5 * twice
    }

    pub(crate) fn n_candidates(&self) -> usize {
        self.detection.candidates.len()
    }

    fn count(&self, is_counted: impl Fn(u16, usize) -> bool) -> usize {
        let pixels = self.truth.iter().zip(&self.candidate_of);
        pixels
            .filter(|&(&what, &candidate)| is_counted(what, candidate))
            .count()
    }

    /// Candidate with the greatest intersection over union with an object, and that value.
    pub(crate) fn best(&self, object: u16) -> (usize, f64) {
        let overlap = |number: usize| {
            let both = self.count(|what, candidate| what == object && candidate == number);
            let either = self.count(|what, candidate| what == object || candidate == number);
            (number, both as f64 / either as f64)
        };
        let all = (0..self.n_candidates()).map(overlap);
        all.max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((NO_CANDIDATE, 0.0))
    }

    /// Share of the pixels of a label that belong to any candidate.
    pub(crate) fn labelled_share(&self, what: u16) -> f64 {
        let all = self.count(|there, _| there == what);
        self.count(|there, candidate| there == what && candidate != NO_CANDIDATE) as f64
            / all as f64
    }

    /// Assert that exactly these objects are found, each with at least this intersection
    /// over union.
    #[track_caller]
    pub(crate) fn assert_objects(&self, objects: &[u16], overlap_min: f64) {
        let overlaps: Vec<_> = objects
            .iter()
            .map(|&object| (object, self.best(object)))
            .collect();
        let boxes: Vec<_> = self
            .detection
            .candidates
            .iter()
            .map(|c| (c.n_points(), c.support))
            .collect();
        assert_eq!(self.n_candidates(), objects.len(), "{overlaps:?} {boxes:?}");
        assert!(
            overlaps.iter().all(|(_, best)| best.1 >= overlap_min),
            "{overlaps:?} {boxes:?}"
        );
    }
}
