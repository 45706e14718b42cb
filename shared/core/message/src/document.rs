//! Documents of messages: the one place where shared-memory messages become the typed documents of
//! `scene-document`.
//!
//! Any bit pattern of a message gives a document; what is no number there is null.

mod health;
mod object;
mod rejected;
mod rounding;
mod surface;
#[cfg(test)]
mod tests;

pub use health::health;
pub use object::{near_categories, object};
pub use rounding::rounded;
pub use surface::carrier;

use crate::{SceneObject, SceneSummary, WirePose};
use constraint::{Assumption, Assumptions};
use scene_document::{AssumptionDocument, CameraPoseDocument, SceneDocument};

/// Document of a scene at a time of the monotonic clock, nanoseconds.
pub fn scene(scene: &SceneSummary, objects: &[SceneObject], now_ns: u64) -> SceneDocument {
    let time = scene.time();
    let is_stale = time.is_stale(now_ns);
    let assumptions = Assumptions::from_bits(scene.assumptions);
    let rejected = scene.rejected_candidates();
    SceneDocument {
        scene_age_s: Some(time.age_s(now_ns)),
        capture_stamp_ns: Some(time.capture_ns),
        is_stale,
        note: if is_stale {
            stale_sentence(time.age_s(now_ns))
        } else {
            String::new()
        },
        n_more: scene.n_objects_total.saturating_sub(objects.len() as u32),
        objects: objects
            .iter()
            .map(|one| object(one, time, now_ns))
            .collect(),
        session: scene.session.to_string(),
        frame_sequence: scene.sequence,
        source_name: scene.source_name.as_str().unwrap_or_default().to_owned(),
        received_ns: Some(scene.stamps.received_ns),
        published_ns: Some(scene.stamps.published_ns),
        frames_dropped: scene.frames_dropped,
        n_late: scene.n_late,
        has_table: scene.table().is_some(),
        surfaces: surface::surfaces(scene, objects),
        has_world_pose: has_world_pose(scene),
        camera: camera_pose(&scene.world_from_camera),
        up: up(scene),
        rule: scene.rule.as_str().unwrap_or_default().to_owned(),
        assumptions: assumptions.iter().map(assumption).collect(),
        ignored: rejected
            .iter()
            .map(|one| rejected::rejected(scene, one))
            .collect(),
        n_more_ignored: scene.n_rejected.saturating_sub(rejected.len() as u32),
    }
}

/// Pose of a camera; `None` for one that is no pose.
fn camera_pose(world_from_camera: &WirePose) -> Option<CameraPoseDocument> {
    world_from_camera.checked().map(|_| CameraPoseDocument {
        position_m: world_from_camera.position_m,
        orientation_xyzw: world_from_camera.orientation_xyzw,
    })
}

fn has_world_pose(scene: &SceneSummary) -> bool {
    scene.frame_flags & crate::frame_flag::HAS_WORLD_POSE != 0
}

/// Direction against gravity in the world, as far as it is known.
fn up(scene: &SceneSummary) -> Option<[f64; 3]> {
    if has_world_pose(scene) {
        Some([0.0, 0.0, 1.0])
    } else {
        let [x, y, z, _] = scene.table()?.plane;
        Some([x, y, z])
    }
}

fn assumption(assumption: Assumption) -> AssumptionDocument {
    AssumptionDocument {
        name: assumption.word().into(),
        sentence: assumption.sentence().into(),
    }
}

/// Sentence about a scene that no longer shows the present.
fn stale_sentence(age_s: f64) -> String {
    format!(
        "no frame was processed for {age_s:.1} s: the objects are where they were then, and may be \
         elsewhere now; see the camera in `tabula status`"
    )
}
