//! Latest scene, its labels and the measured depth noise, for the answers to clients.

use crate::memory_replica::HistoryPosition;
use control_protocol::DepthNoiseReport;
use message::{SceneObject, SceneSummary};
use parking_lot::Mutex;
use scene_document::{ObjectDocument, SceneDocument};
use tokio::sync::watch;

/// The latest scene, and the position in the memory's history that its labels include.
#[derive(Debug, Default)]
pub(crate) struct LatestScene {
    /// Newest scene; `None` before the first frame.
    scene: Mutex<Option<(SceneSummary, Vec<SceneObject>)>>,
    position: watch::Sender<HistoryPosition>,
    depth_noise: Mutex<DepthNoiseReport>,
}

impl LatestScene {
    /// Latest scene before the first frame, of a camera with this law of the depth noise.
    pub(crate) fn new(law: &str) -> Self {
        let scene = Self::default();
        law.clone_into(&mut scene.depth_noise.lock().law);
        scene
    }

    /// Sets the measured ratio to the law; a table's depth along the optical axis, metres,
    /// stays until there is another.
    pub(crate) fn set_depth_noise(&self, ratio: Option<f32>, table_depth_m: Option<f64>) {
        let mut held = self.depth_noise.lock();
        held.ratio = ratio.map(f64::from);
        held.table_depth_m = table_depth_m.or(held.table_depth_m);
    }

    /// Report of the depth noise.
    pub(crate) fn depth_noise(&self) -> DepthNoiseReport {
        self.depth_noise.lock().clone()
    }

    /// Replaces the scene, whose labels include a position of the memory's history.
    pub(crate) fn set(
        &self,
        summary: &SceneSummary,
        objects: &[SceneObject],
        position: HistoryPosition,
    ) {
        let mut held = self.scene.lock();
        let (held_summary, held_objects) = held.get_or_insert_default();
        *held_summary = *summary;
        held_objects.clear();
        held_objects.extend_from_slice(objects);
        drop(held);
        self.set_position(position);
    }

    /// Changes the objects of the scene in place.
    pub(crate) fn update(&self, position: HistoryPosition, change: impl FnMut(&mut SceneObject)) {
        if let Some((_, objects)) = &mut *self.scene.lock() {
            objects.iter_mut().for_each(change);
        }
        self.set_position(position);
    }

    fn set_position(&self, position: HistoryPosition) {
        self.position.send_if_modified(|known| {
            let is_new = *known != position;
            *known = position;
            is_new
        });
    }

    /// True if all labels of the scene include a position of the memory's history.
    pub(crate) fn includes(&self, position: HistoryPosition) -> bool {
        self.position.borrow().includes(position)
    }

    /// Waits until all labels of the scene include a position of the memory's history.
    pub(crate) async fn labelled_after(&self, position: HistoryPosition) {
        let mut known = self.position.subscribe();
        while !known.borrow_and_update().includes(position) {
            // The sender is a field of this value.
            let _ = known.changed().await;
        }
    }

    /// Report of all objects of the newest scene at a time of the monotonic clock; `None`
    /// before the first frame.
    pub(crate) fn objects(&self, now_ns: u64) -> Option<SceneDocument> {
        let held = self.scene.lock();
        let (summary, objects) = held.as_ref()?;
        Some(message::document::scene(summary, objects, now_ns))
    }

    /// Report of one object at a time of the monotonic clock; `None` when the track is not
    /// live.
    pub(crate) fn object(&self, track_id: u64, now_ns: u64) -> Option<ObjectDocument> {
        let held = self.scene.lock();
        let (summary, objects) = held.as_ref()?;
        let object = objects.iter().find(|object| object.track_id == track_id)?;
        Some(message::document::object(object, summary.time(), now_ns))
    }
}
