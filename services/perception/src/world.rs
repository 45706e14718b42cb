//! The live world model: the latest scene, for whoever asks.

use message::control::{ObjectReport, ObjectsReport};
use message::{SceneObject, SceneSummary};
use std::sync::{Mutex, PoisonError};

/// The latest scene.
#[derive(Debug, Default)]
pub(crate) struct World(Mutex<(SceneSummary, Vec<SceneObject>)>);

impl World {
    /// Takes a new scene over.
    pub(crate) fn set(&self, summary: &SceneSummary, objects: &[SceneObject]) {
        let mut held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        held.0 = *summary;
        held.1.clear();
        held.1.extend_from_slice(objects);
    }

    /// All objects.
    pub(crate) fn objects(&self) -> ObjectsReport {
        let held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        ObjectsReport::new(&held.0, &held.1)
    }

    /// One object; `None` when there is no such track now.
    pub(crate) fn object(&self, track_id: u64) -> Option<ObjectReport> {
        let held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let object = held.1.iter().find(|object| object.track_id == track_id)?;
        Some(ObjectReport::new(object, held.0.stamps.capture_ns))
    }
}
