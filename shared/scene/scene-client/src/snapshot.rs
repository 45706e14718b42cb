//! Snapshot of the table: one frame with its scene and the measured points of the seen objects.

use crate::scene_table::SceneSurface;
use geometry::{PinholeCamera, Plane, RigidTransform};
use message::{CategoryAnswer, TrackState};
use nalgebra::{Point3, Unit, Vector3};
use point_cloud::Point;
use registration::ModelCandidate;

/// Number of points of the frame around a segment, at most. Chosen.
const N_THINNED_MAX: usize = 100_000;

/// Frame with its scene. Places are in the world, or, where the camera's pose is unknown, in the
/// frame of the camera.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Points of the frame, row-major, camera frame.
    pub points: Vec<Point>,
    /// Camera of the frame.
    pub camera: PinholeCamera,
    /// Pose of the camera; `None` when it is unknown.
    pub world_from_camera: Option<RigidTransform>,
    /// Direction against gravity in the camera frame, as the camera measures it.
    pub up_in_camera: Option<Unit<Vector3<f64>>>,
    /// Support surfaces, the table first.
    pub surfaces: Vec<SceneSurface>,
    /// Tracked objects, by track-id.
    pub objects: Vec<SnapshotObject>,
    /// Run of the source that the frame is of.
    pub session: u64,
    /// Number of the frame in its run.
    pub sequence: u64,
    /// Capture time, nanoseconds of the camera's clock.
    pub capture_ns: u64,
    /// Name of the source.
    pub source_name: String,
}

/// Tracked object of a snapshot.
#[derive(Debug, Clone)]
pub struct SnapshotObject {
    /// Track-id.
    pub track: u64,
    /// Label; `None` for an unknown object.
    pub label: Option<String>,
    /// Most probable categories with their probabilities, 0 to 1.
    pub categories: Vec<(String, f64)>,
    /// State of the track.
    pub state: TrackState,
    /// Middle of its box.
    pub middle_in_world: Point3<f64>,
    /// Measured points, camera frame, metres; empty for an object that is not seen.
    pub points: Vec<[f32; 3]>,
}

impl SnapshotObject {
    /// Answer about the category: certain, probable or unknown.
    pub fn answer(&self) -> CategoryAnswer {
        let label = self.label.as_deref();
        let mut categories = self.categories.iter();
        let own = categories.find(|(name, _)| label == Some(name));
        CategoryAnswer::of(label.is_some(), own.map(|(_, probability)| *probability))
    }

    /// Categories whose models the object may show: its label, and the most probable others. One
    /// without a label is unknown, and shows none.
    pub fn candidates(&self) -> impl Iterator<Item = ModelCandidate<&str>> {
        let label = self.label.as_deref();
        let near = self.categories.iter().filter(move |_| label.is_some());
        let near = near.map(|(name, probability)| (name.as_str(), *probability));
        // A label that is not among the categories counts as sure.
        let is_near = |label: &&str| self.categories.iter().any(|(name, _)| name == label);
        let given = label
            .filter(|label| !is_near(label))
            .map(|label| (label, 1.0));
        given
            .into_iter()
            .chain(near)
            .map(|(model, probability)| ModelCandidate { model, probability })
    }
}

impl Snapshot {
    /// Pose of the camera in the frame of all places: the identity when it is unknown.
    pub fn pose(&self) -> RigidTransform {
        self.world_from_camera.unwrap_or_default()
    }

    /// Plane of the table; `None` without one.
    pub fn table_in_world(&self) -> Option<Plane> {
        let table = self.surfaces.first();
        table.map(|table| table.plane_in_world)
    }

    /// Points of the frame with depth.
    pub fn measured(&self) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(|point| point.is_finite())
    }

    /// Points of the frame with depth, of which so many are left out that they are not too many to
    /// place a model among.
    pub fn thinned(&self) -> Vec<[f32; 3]> {
        let step = self.points.len().div_ceil(N_THINNED_MAX).max(1);
        let measured = self.measured().step_by(step);
        measured.map(|point| [point.x, point.y, point.z]).collect()
    }

    /// Snapshot of points that nothing else is known of.
    pub fn of_points(camera: PinholeCamera, points: Vec<Point>) -> Self {
        Self {
            points,
            camera,
            world_from_camera: None,
            up_in_camera: None,
            surfaces: Vec::new(),
            objects: Vec::new(),
            session: 1,
            sequence: 1,
            capture_ns: 0,
            source_name: String::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Candidates of an object with a label and near categories.
    fn candidates(label: Option<&str>, categories: &[(&str, f64)]) -> Vec<(String, f64)> {
        let object = SnapshotObject {
            track: 1,
            label: label.map(str::to_owned),
            categories: categories
                .iter()
                .map(|(name, probability)| ((*name).to_owned(), *probability))
                .collect(),
            state: TrackState::Tracked,
            middle_in_world: Point3::origin(),
            points: Vec::new(),
        };
        let candidates = object.candidates();
        candidates
            .map(|candidate| (candidate.model.to_owned(), candidate.probability))
            .collect()
    }

    #[test]
    fn a_labelled_object_may_be_of_its_near_categories() {
        let near = [("mug", 0.7), ("cup", 0.2)];
        let owned = near.map(|(name, probability)| (name.to_owned(), probability));
        assert_eq!(candidates(Some("mug"), &near), owned);
        assert_eq!(candidates(None, &near), []);
        let given = candidates(Some("pot"), &near);
        assert_eq!((given.len(), &given[0]), (3, &("pot".to_owned(), 1.0)));
    }
}
