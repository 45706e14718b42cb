//! Scene describer: simulates one scene, detects, labels and describes its objects.

use super::candidate_label::{CandidateLabel, label, visible_pixels};
use super::scene_sampler::SceneSampler;
use crate::evaluate::recognition::{HypothesisDescriptors, ViewDescriber};
use crate::frame_detector::{FrameDetector, up_in_camera};
use crate::output_files::write;
use constraint::Ternary;
use description::ObjectPoints;
use detection::Candidate;
use evaluation::hypothesis_image::HypothesisImages;
use evaluation::labelled_scenes::LabelledScene;
use evaluation::scene_picture;
use evaluation::segmentation_score::{FIRST_OBJECT_LABEL, Overlaps};
use geometry::PinholeCamera;
use nalgebra::{UnitVector3, Vector3};
use point_cloud::{OrganizedCloud, Point};
use service::Failure;
use simulated_world::{ObjectTruth, SimulatedKinect};
use std::path::Path;
use std::time::Instant;

/// Intrinsics of the camera in all simulated scenes.
const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;
/// Folder of the pictures, inside the output folder.
pub(in super::super) const PICTURES: &str = "scenes";
/// Label of background in the drawn truth.
const NO_OBJECT: u16 = 1;

/// Detected objects and false candidates of one scene.
#[derive(Debug, Default)]
pub(super) struct DescribedScene {
    /// Categories of the objects that show a pixel with depth.
    pub(super) visible: Vec<u32>,
    /// Number of objects without a pixel with depth.
    pub(super) n_hidden: u32,
    /// Detected objects: category and descriptors.
    pub(super) found: Vec<(u32, HypothesisDescriptors)>,
    /// Descriptors of the false candidates: no object, or a smaller part of one.
    pub(super) clutter: Vec<HypothesisDescriptors>,
    /// Categories of the objects that false candidates are parts of.
    pub(super) parts: Vec<u32>,
    /// Total time of describing the scene's objects, milliseconds.
    pub(super) describe_ms: f64,
    /// Reasons of candidates that could not be described.
    pub(super) left_out: Vec<String>,
    /// Name and path of the drawn scene.
    pub(super) picture: Option<(String, String)>,
}

/// Simulator, detector and describer of one worker, with buffers reused from scene to scene.
pub(super) struct SceneDescriber {
    describer: ViewDescriber,
    detector: FrameDetector,
    points: Vec<Point>,
}

/// Simulated frame with its ground truth.
struct LabelledFrame<'a> {
    number: usize,
    mask: &'a [u16],
    /// Category of each object by index; the object's number is one more.
    categories: Vec<u32>,
    /// Number of pixels with depth, by object number.
    visible: Vec<usize>,
    up_in_camera: UnitVector3<f64>,
}

impl SceneDescriber {
    pub(super) fn new(describer: ViewDescriber) -> Self {
        Self {
            describer,
            detector: FrameDetector::default(),
            points: vec![Point::default(); CAMERA.n_pixels()],
        }
    }

    /// Renders, detects and describes one scene; draws it if it is the first of its kind.
    ///
    /// # Errors
    /// If the scene cannot be built or rendered, or the picture cannot be written.
    pub(super) fn describe(
        &mut self,
        sampler: &SceneSampler,
        number: usize,
        out: &Path,
    ) -> Result<DescribedScene, Failure> {
        let world = sampler.world(number)?;
        let mut kinect = SimulatedKinect::new(&world, CAMERA).map_err(Failure::general)?;
        let objects = kinect
            .look(&world, 0, &mut self.points)
            .map_err(Failure::general)?;
        let frame_truth = LabelledFrame {
            number,
            mask: kinect.mask(),
            categories: categories(sampler, &objects)?,
            visible: visible_pixels(kinect.mask(), &self.points, objects.len()),
            up_in_camera: up_in_camera(&world.world_from_camera(), &Vector3::z_axis()),
        };
        let (width, height) = (CAMERA.width as usize, CAMERA.height as usize);
        let cloud = OrganizedCloud::new(&self.points, width, height).map_err(Failure::general)?;
        let up = Some(frame_truth.up_in_camera);
        self.detector.detect(cloud, up);
        let mut described = self.label_and_describe(&frame_truth);
        if let Some(name) = SceneSampler::name_if_first(number) {
            let place = format!("{PICTURES}/{name}.png");
            self.draw(&frame_truth, &out.join(&place))?;
            described.picture = Some((name, place));
        }
        Ok(described)
    }

    /// Labels and describes the candidates that fulfil the object rule, upright on the table.
    fn label_and_describe(&mut self, frame_truth: &LabelledFrame<'_>) -> DescribedScene {
        let mut scene = DescribedScene::default();
        for (&category, &n_pixels) in frame_truth.categories.iter().zip(&frame_truth.visible[1..]) {
            if n_pixels > 0 {
                scene.visible.push(category);
            } else {
                scene.n_hidden += 1;
            }
        }
        let detection = self.detector.detection();
        let table = detection.table();
        let up = table.map(|table| up_in_camera(&table.table_from_camera, &Vector3::z_axis()));
        let is_object = |candidate: &&Candidate| candidate.verdict == Ternary::True;
        for candidate in detection.candidates.iter().filter(is_object) {
            let indices = detection.points_of(candidate);
            let begin = Instant::now();
            let descriptors = ObjectPoints::selected(&self.points, indices)
                .and_then(|points| self.describer.describe(points, up.as_ref()));
            scene.describe_ms += begin.elapsed().as_secs_f64() * 1e3;
            let descriptors = match descriptors {
                Ok(descriptors) => descriptors,
                Err(error) => {
                    let number = frame_truth.number;
                    scene.left_out.push(format!(
                        "a candidate of scene {number} cannot be described: {error}"
                    ));
                    continue;
                }
            };
            let category = |id: u16| frame_truth.categories[usize::from(id) - 1];
            match label(indices, frame_truth.mask, &frame_truth.visible) {
                CandidateLabel::Object(id) => scene.found.push((category(id), descriptors)),
                CandidateLabel::Part(id) => {
                    scene.parts.push(category(id));
                    scene.clutter.push(descriptors);
                }
                CandidateLabel::NoObject => scene.clutter.push(descriptors),
            }
        }
        scene
    }

    /// Draws colour, truth and result in one picture.
    fn draw(&self, frame_truth: &LabelledFrame<'_>, path: &Path) -> Result<(), Failure> {
        let (n_objects, detection) = (frame_truth.categories.len(), self.detector.detection());
        let label_of = |(&id, point): (&u16, &Point)| match usize::from(id) {
            _ if !point.is_finite() => 0,
            1.. if usize::from(id) <= n_objects => FIRST_OBJECT_LABEL * id,
            _ => NO_OBJECT,
        };
        let scene = LabelledScene {
            points: self.points.clone(),
            labels: frame_truth
                .mask
                .iter()
                .zip(&self.points)
                .map(label_of)
                .collect(),
            has_part_labels: false,
            width: CAMERA.width as usize,
            height: CAMERA.height as usize,
            up_in_camera: Some(frame_truth.up_in_camera),
        };
        let found = HypothesisImages::of(detection, self.points.len()).ok_or_else(|| {
            Failure::general("detection finds more objects than 16 bits can number")
        })?;
        let overlaps = Overlaps::count(&found.before_psi, &scene.labels);
        let image = scene_picture::draw(&scene, &detection.surfaces, &found, &overlaps);
        write(path, &image.map_err(Failure::general)?)
    }
}

fn categories(sampler: &SceneSampler, objects: &[ObjectTruth]) -> Result<Vec<u32>, Failure> {
    let number_of = |object: &ObjectTruth| {
        let number = sampler.number_of(&object.category);
        number.ok_or_else(|| Failure::general(format!("no set has a category {}", object.category)))
    };
    objects.iter().map(number_of).collect()
}
