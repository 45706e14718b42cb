//! Object hypotheses of a snapshot: the stored model of an object in its estimated pose, or the
//! measured points of the object.

use crate::depth_noise::camera_depth_noise;
use crate::plan::planning_frame::PlanningFrame;
use crate::plan::snapshot::{Snapshot, SnapshotObject};
use control_client::{MemoryClient, connect_if_running};
use geometry::RigidTransform;
use mesh::{Triangle, TriangleMesh};
use message::control::{DocumentKind, DocumentName, DocumentReport};
use nalgebra::{Point3, Vector3};
use next_best_view::SurfaceModel;
use object_model::ObjectModel;
use registration::{PoseModel, SegmentView, estimate_pose};
use sensor_noise::DepthNoise;
use service::{CommonArguments, Failure};
use std::collections::BTreeMap;
use std::rc::Rc;

/// Spacing of the points of a model, metres: that of the smallest cells.
const MODEL_SPACING_M: f64 = 0.003;
/// Number of points of the frame around a segment, at most. Chosen.
const N_SCENE_POINTS: usize = 100_000;

/// Object hypothesis of a track.
#[derive(Debug, Clone)]
pub(crate) struct ObjectHypothesis {
    pub(crate) track: u64,
    pub(crate) label: Option<String>,
    pub(crate) source: HypothesisSource,
    pub(crate) surface: Rc<SurfaceModel>,
    pub(crate) plan_from_object: RigidTransform,
    /// Reason why a stored model is not used; empty otherwise.
    pub(crate) note: String,
}

/// Source of the surface of a hypothesis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum HypothesisSource {
    /// Measured points of the track.
    Measured,
    /// Stored model, with the contradiction of its pose: 0 for a perfect fit, up to 2.
    Model { contradiction: f64 },
}

/// Stored model, ready to be placed.
struct PlacedModel {
    surface: Rc<SurfaceModel>,
    pose_model: PoseModel,
}

/// Stored models by name, each read once for each of its versions. An unusable one is kept as the
/// reason.
#[derive(Default)]
pub(crate) struct ModelShelf {
    depth_noise: DepthNoise,
    models: BTreeMap<String, (u64, Result<PlacedModel, String>)>,
}

impl ModelShelf {
    /// Reads the stored models of the labels in a snapshot.
    ///
    /// # Errors
    /// If the memory does not answer.
    pub(crate) fn refresh(
        &mut self,
        common: &CommonArguments,
        snapshot: &Snapshot,
    ) -> Result<(), Failure> {
        let labels: Vec<&str> = snapshot.objects.iter().filter_map(seen_label).collect();
        if labels.is_empty() {
            self.models.clear();
            return Ok(());
        }
        let client = connect_if_running(common)?;
        let client = client.ok_or_else(|| Failure::general("the memory does not run"))?;
        // While perception does not answer, the camera has the noise that it had.
        self.depth_noise = camera_depth_noise(common).unwrap_or(self.depth_noise);
        let mut memory = MemoryClient::of_daemon(common, client);
        let stored = memory.documents(DocumentKind::ObjectModel)?;
        self.models
            .retain(|name, _| stored.iter().any(|report| report.document.name == *name));
        for report in stored {
            let name = &report.document.name;
            if !labels.contains(&name.as_str()) || self.has(&report) {
                continue;
            }
            let model = read_model(&mut memory, name);
            self.models.insert(name.clone(), (report.sequence, model));
        }
        Ok(())
    }

    fn has(&self, report: &DocumentReport) -> bool {
        let known = self.models.get(&report.document.name);
        known.is_some_and(|(sequence, _)| *sequence == report.sequence)
    }

    /// Hypotheses of all objects with measured points, thinned to one point in each cell.
    ///
    /// # Errors
    /// When the points of an object make no surface.
    pub(crate) fn hypotheses(
        &self,
        snapshot: &Snapshot,
        frame: &PlanningFrame,
        cell_m: f64,
    ) -> Result<Vec<ObjectHypothesis>, Failure> {
        let scene = thinned_scene(snapshot);
        let seen = snapshot.objects.iter().filter(|o| !o.points.is_empty());
        let hypothesis = |object: &SnapshotObject| {
            let measured = measured_hypothesis(object, frame, cell_m)?;
            let model = object
                .label
                .as_ref()
                .and_then(|label| self.models.get(label));
            Ok(match model {
                None => measured,
                Some((_, Err(reason))) => ObjectHypothesis {
                    note: reason.clone(),
                    ..measured
                },
                Some((_, Ok(model))) => {
                    let view = SegmentView::new(&object.points, &scene, self.depth_noise);
                    placed(model, view, measured, frame)
                }
            })
        };
        seen.map(hypothesis).collect()
    }
}

/// Label of an object that is seen.
fn seen_label(object: &SnapshotObject) -> Option<&str> {
    object
        .label
        .as_deref()
        .filter(|_| !object.points.is_empty())
}

/// Reads a model; the reason why it cannot be used otherwise.
fn read_model(memory: &mut MemoryClient, name: &str) -> Result<PlacedModel, String> {
    let document = DocumentName {
        kind: DocumentKind::ObjectModel,
        name: name.to_owned(),
    };
    let stored = memory
        .document(&document)
        .map_err(|error| error.to_string())?;
    let model = ObjectModel::from_bytes(&stored.content).map_err(|error| error.to_string())?;
    PlacedModel::of(&model)
}

impl PlacedModel {
    fn of(model: &ObjectModel) -> Result<Self, String> {
        let triangle = |vertices: &[u32; 3]| Triangle {
            vertices: *vertices,
            surface: 0,
        };
        let mesh = TriangleMesh {
            vertices: model.mesh.vertices.clone(),
            triangles: model.mesh.triangles.iter().map(triangle).collect(),
            surfaces: Vec::new(),
        };
        let surface = if mesh.triangles.is_empty() {
            let points: Vec<[f32; 3]> = mesh.vertices.iter().map(|v| v.position.into()).collect();
            SurfaceModel::of_points(&points, MODEL_SPACING_M)
        } else {
            SurfaceModel::of_mesh(&mesh, MODEL_SPACING_M)
        };
        let surface = surface.map_err(|error| error.to_string())?;
        let pose_model = PoseModel::new(surface.points(), MODEL_SPACING_M);
        Ok(Self {
            surface: Rc::new(surface),
            pose_model: pose_model.map_err(|error| error.to_string())?,
        })
    }
}

/// Hypothesis of the measured points of an object, about their middle.
fn measured_hypothesis(
    object: &SnapshotObject,
    frame: &PlanningFrame,
    cell_m: f64,
) -> Result<ObjectHypothesis, Failure> {
    let in_plan = |point: &[f32; 3]| frame.plan_from_camera * Point3::from(*point).cast::<f64>();
    let n = object.points.len() as f64;
    let sum = object
        .points
        .iter()
        .fold(Vector3::zeros(), |sum, point| sum + in_plan(point).coords);
    let middle = sum / n;
    let about_middle = |point: &[f32; 3]| (in_plan(point).coords - middle).cast::<f32>().into();
    let points: Vec<[f32; 3]> = object.points.iter().map(about_middle).collect();
    let surface = SurfaceModel::of_points(&points, cell_m).map_err(|error| {
        let track = object.track;
        Failure::general(format!(
            "the points of object {track} cannot be used: {error}"
        ))
    })?;
    Ok(ObjectHypothesis {
        track: object.track,
        label: object.label.clone(),
        source: HypothesisSource::Measured,
        surface: Rc::new(surface),
        plan_from_object: RigidTransform::translation(middle.x, middle.y, middle.z),
        note: String::new(),
    })
}

/// Hypothesis of a model in its estimated pose; the measured one with the reason where the model
/// does not fit.
fn placed(
    model: &PlacedModel,
    view: Result<SegmentView, registration::Error>,
    measured: ObjectHypothesis,
    frame: &PlanningFrame,
) -> ObjectHypothesis {
    let estimated = view.and_then(|view| estimate_pose(&model.pose_model, &view));
    match estimated {
        Ok(pose) if pose.is_good() => ObjectHypothesis {
            source: HypothesisSource::Model {
                contradiction: pose.contradiction,
            },
            surface: model.surface.clone(),
            plan_from_object: frame.plan_from_camera * pose.camera_from_model,
            ..measured
        },
        Ok(pose) => ObjectHypothesis {
            note: format!(
                "its stored model does not fit (contradiction {:.2}); its measured points are used",
                pose.contradiction
            ),
            ..measured
        },
        Err(error) => ObjectHypothesis {
            note: format!(
                "its stored model could not be placed ({error}); its measured points are used"
            ),
            ..measured
        },
    }
}

/// Points of the frame with depth, of which so many are left out that they are not too many.
fn thinned_scene(snapshot: &Snapshot) -> Vec<[f32; 3]> {
    let step = snapshot.points.len().div_ceil(N_SCENE_POINTS).max(1);
    let measured = snapshot.measured().step_by(step);
    measured.map(|point| [point.x, point.y, point.z]).collect()
}
