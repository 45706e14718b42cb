//! Stored models, read from their source when objects that they may be are seen.

use crate::snapshot::{Snapshot, SnapshotObject};
use crate::stored_models::StoredModels;
use mesh::TriangleMesh;
use next_best_view::SurfaceModel;
use registration::{ModelCandidate, ModelPose, PoseModel, SegmentView, estimate_pose, identify};
use sensor_noise::DepthNoise;
use service::Failure;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Spacing of the points of a model, metres: that of the smallest cells.
const MODEL_SPACING_M: f64 = 0.003;

/// Stored model, ready to be placed.
struct StoredModel {
    mesh: TriangleMesh,
    surface: Rc<SurfaceModel>,
    pose_model: PoseModel,
}

/// Stored models by name, each read once for each of its versions. An unusable one is kept as the
/// reason.
#[derive(Default)]
pub struct ModelShelf {
    depth_noise: DepthNoise,
    models: BTreeMap<String, (u64, Result<StoredModel, String>)>,
}

/// Stored model in the pose of an object.
pub struct PlacedModel<'a> {
    /// Name of the model.
    pub name: &'a str,
    /// Mesh of the model; one of points alone has no triangles.
    pub mesh: &'a TriangleMesh,
    /// Surface of the model.
    pub surface: &'a Rc<SurfaceModel>,
    /// Pose in the frame of the camera.
    pub pose: ModelPose,
}

impl ModelShelf {
    /// Reads the stored models of the categories that the labelled objects of a snapshot may be,
    /// from a source that is opened when there are any.
    ///
    /// # Errors
    /// If the source does not answer.
    pub fn refresh<S: StoredModels>(
        &mut self,
        snapshot: &Snapshot,
        open: impl FnOnce() -> Result<S, Failure>,
    ) -> Result<(), Failure> {
        let seen = snapshot.objects.iter().filter(|o| !o.points.is_empty());
        let names: Vec<&str> = seen
            .flat_map(SnapshotObject::candidates)
            .map(|c| c.model)
            .collect();
        if names.is_empty() {
            self.models.clear();
            return Ok(());
        }
        let mut source = open()?;
        // While nobody knows it, the camera has the noise that it had.
        self.depth_noise = source.depth_noise().unwrap_or(self.depth_noise);
        let stored = source.versions()?;
        self.models
            .retain(|name, _| stored.iter().any(|(other, _)| other == name));
        for (name, version) in stored {
            let known = self.models.get(&name);
            let has_it = known.is_some_and(|(known, _)| *known == version);
            if has_it || !names.contains(&name.as_str()) {
                continue;
            }
            let model = source.mesh(&name).and_then(|mesh| StoredModel::of(&mesh));
            self.models.insert(name, (version, model));
        }
        Ok(())
    }

    /// Places the model that an object shows, by its categories and by the poses of their models,
    /// in the frame of the camera; `None` where none of them has a model.
    ///
    /// # Errors
    /// The reason, where models are stored and none fits.
    pub fn place(
        &self,
        object: &SnapshotObject,
        scene: &[[f32; 3]],
    ) -> Result<Option<PlacedModel<'_>>, String> {
        let stored = |candidate: ModelCandidate<&str>| {
            let (name, (_, model)) = self.models.get_key_value(candidate.model)?;
            Some(ModelCandidate {
                model: (name.as_str(), model),
                probability: candidate.probability,
            })
        };
        let candidates: Vec<_> = object.candidates().filter_map(stored).collect();
        if candidates.is_empty() {
            return Ok(None);
        }
        let names: Vec<&str> = candidates.iter().map(|one| one.model.0).collect();
        let unused =
            |name: &str, why: String| unused_model(object.label.as_deref(), &names, name, &why);
        let view = SegmentView::new(&object.points, scene, self.depth_noise);
        let view =
            view.map_err(|error| unused(names[0], format!("could not be placed ({error})")))?;
        let mut reason = String::new();
        let found = identify(&candidates, |(name, model)| {
            let pose = match model {
                Ok(model) => estimate_pose(&model.pose_model, &view)
                    .map_err(|error| format!("could not be placed ({error})")),
                Err(error) => Err(format!("cannot be used ({error})")),
            };
            pose.map_err(|why| reason = unused(name, why)).ok()
        });
        match found {
            Some(((name, Ok(model)), pose)) if pose.is_good() => Ok(Some(PlacedModel {
                name,
                mesh: &model.mesh,
                surface: &model.surface,
                pose,
            })),
            Some(((name, _), pose)) => Err(unused(
                name,
                format!("does not fit (contradiction {:.2})", pose.contradiction),
            )),
            None => Err(reason),
        }
    }
}

/// Reason why the stored model `name` is not used for an object with a label, of which there may be
/// no model: `stored` are the models of all categories that it may be of.
fn unused_model(label: Option<&str>, stored: &[&str], name: &str, why: &str) -> String {
    match label {
        Some(label) if !stored.contains(&label) => {
            format!("no model {label:?} is stored, and the model {name:?} {why}")
        }
        _ => format!("the stored model {name:?} {why}"),
    }
}

impl StoredModel {
    fn of(mesh: &TriangleMesh) -> Result<Self, String> {
        let surface = if mesh.triangles.is_empty() {
            let points: Vec<[f32; 3]> = mesh.vertices.iter().map(|v| v.position.into()).collect();
            SurfaceModel::of_points(&points, MODEL_SPACING_M)
        } else {
            SurfaceModel::of_mesh(mesh, MODEL_SPACING_M)
        };
        let surface = surface.map_err(|error| error.to_string())?;
        let pose_model = PoseModel::new(surface.points(), MODEL_SPACING_M);
        Ok(Self {
            mesh: mesh.clone(),
            surface: Rc::new(surface),
            pose_model: pose_model.map_err(|error| error.to_string())?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reason_names_the_model_that_was_tried_and_the_one_that_is_missing() {
        let why = "does not fit (contradiction 0.83)";
        let reason = |stored: &[&str], name| unused_model(Some("mug"), stored, name, why);
        assert_eq!(
            reason(&["teapot"], "teapot"),
            "no model \"mug\" is stored, and the model \"teapot\" does not fit (contradiction 0.83)"
        );
        for name in ["mug", "teapot"] {
            assert_eq!(
                reason(&["mug", "teapot"], name),
                format!("the stored model {name:?} {why}")
            );
        }
    }
}
